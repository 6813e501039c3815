//! Definitions to a serde format and back (feature `serde`). JSON has no infinity, so it is the hardest format.

use serde_json::{from_str, to_string};
use sinew_math::{Range, Rotation, SwingTwistLimit, Transform, Vec3};
use sinew_physics::particles::{AttachmentDef, AttachmentTarget, RopeDef};
use sinew_physics::*;
use std::sync::Arc;

#[track_caller]
fn check_round_trip<T>(value: &T) -> String
where
    T: ::serde::Serialize + for<'de> ::serde::Deserialize<'de> + PartialEq + core::fmt::Debug,
{
    let text = to_string(value).expect("the value must serialize");
    assert_eq!(&from_str::<T>(&text).expect("the text must deserialize"), value, "{text}");
    text
}

#[test]
fn definitions_round_trip() {
    check_round_trip(&WorldDef { gravity: Vec3::new(0.1, -3.7, 0.0), ..WorldDef::default() });
    let corners: Vec<Vec3> =
        (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32)).collect();
    let heights = vec![0.0, 0.5, 0.25, 1.0];
    let field = HeightFieldDef { columns: 2, rows: 2, spacing: [1.0, 2.0], heights, holes: Vec::new() };
    let shapes = [
        Shape::cuboid(Vec3::new(0.1, 0.2, 0.3)),
        Shape::TaperedCapsule { half_height: 0.3, radius_bottom: 0.1, radius_top: 0.2 },
        Shape::HalfSpace,
        Shape::hull(&corners).expect("the hull is valid"),
        Shape::mesh(&corners, &[[0, 1, 2], [1, 3, 2]]).expect("the mesh is valid"),
        Shape::HeightField(Arc::new(HeightField::new(field).expect("the height field is valid"))),
    ];
    for shape in shapes {
        let rule = ContactRule::Yields(Yields { max_force: 10.0, max_impulse: f32::INFINITY });
        let shape = ShapeDef { rule, sensing: Sensing::Sensor, ..ShapeDef::new(shape) };
        let rotation = Rotation::from_axis_angle(Vec3::Y, 0.3);
        let mass = Some(Shape::sphere(0.2).mass_properties(3.0));
        check_round_trip(&BodyDef { rotation, mass, user_data: u64::MAX, ..BodyDef::kinematic(shape) });
    }
}

#[test]
fn joints_and_fields_round_trip() {
    let mut world = World::new(WorldDef::default());
    let (a, b) = (
        world.add_body(&BodyDef::fixed(Shape::sphere(0.1))),
        world.add_body(&BodyDef::dynamic(Shape::sphere(0.1))),
    );
    let hinge = world.hinge(a, b, Vec3::X, Vec3::Y).limited(Range { lo: -1.0, hi: 1.0 });
    let hinge = JointDef { motor: Some(Motor::push(0.5, f32::INFINITY)), ..hinge };
    check_round_trip(&hinge);
    let swing = Range { lo: -0.5, hi: 0.5 };
    let limit = Some(SwingTwistLimit { swing_y: swing, swing_z: swing, twist: swing });
    check_round_trip(&JointDef { kind: JointKind::Ball { limit }, ..world.fixed(a, b) });
    let read: JointDef =
        from_str(&to_string(&hinge).expect("the value must serialize")).expect("the text must deserialize");
    let joint = world.add_joint(&read);
    assert_eq!(world.joint(joint).kind, hinge.kind, "the joint's definition must keep its kind");
    check_round_trip(&FieldDef::new(FieldKind::Wind(Wind::default())));
    check_round_trip(&MoverDef::default());
    check_round_trip(&ForceDef { point: Some(Vec3::X), ..ForceDef::default() });
    let rope = RopeDef { from: Vec3::ZERO, to: Vec3::X, links: 3, mass: 1.0, stiffness: 10.0, radius: 0.01 };
    check_round_trip(&rope);
    let mut group = rope.build().group;
    let target = AttachmentTarget::Body { body: b, point: Vec3::Y };
    group.attachments.push(AttachmentDef { particle: 0, target });
    check_round_trip(&group);
    check_round_trip(&Transform::new(Vec3::X, Rotation::IDENTITY));
}

#[test]
fn missing_fields_have_defaults() {
    let def: BodyDef = from_str(r#"{"position": [0, 2, 0], "gravity_scale": 0.5}"#)
        .expect("missing fields must get their defaults");
    assert_eq!(def, BodyDef { gravity_scale: 0.5, ..BodyDef::default().at(Vec3::Y * 2.0) });
    let hull: Result<Shape, _> = from_str(r#"{"Hull": [[0, 0, 0], [1, 0, 0]]}"#);
    assert!(hull.expect_err("two points must not make a hull").to_string().contains("hull"));
}
