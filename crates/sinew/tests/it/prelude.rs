//! Tests that the prelude is enough for a first program, and that short constructors equal their long forms.

use sinew::prelude::*;

#[test]
fn velocities_are_built_from_one_part() {
    let way = Vec3::new(1.0, 2.0, 3.0);
    assert_eq!(Velocity::linear(way), Velocity { linear: way, angular: Vec3::ZERO });
    assert_eq!(Velocity::angular(way), Velocity { linear: Vec3::ZERO, angular: way });
}

#[test]
fn transform_times_a_point_is_the_transformed_point() {
    let turn = Rotation::from_axis_angle(Vec3::Y, 0.7);
    let (place, point) = (Transform::new(Vec3::new(1.0, 0.0, -2.0), turn), Vec3::new(0.5, 1.0, 2.0));
    assert_eq!(place * point, place.point(point));
    assert_eq!((place * place) * point, (place * place).point(point));
}

#[test]
fn height_field_of_few_samples_carries_a_ball() {
    let hill =
        HeightFieldDef::from_fn(5, 3, 2.0, |column, row| if (column, row) == (2, 1) { 1.0 } else { 0.0 });
    assert_eq!((hill.heights.len(), hill.heights[5 + 2], hill.spacing), (15, 1.0, [2.0, 2.0]));
    assert_eq!(hill, HeightFieldDef::new(5, 3, 2.0, hill.heights.clone()));
    let field = HeightField::new(hill).expect("the samples are a valid height field");
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HeightField(field.into())));
    let ball = BodyDef::dynamic(Shape::Sphere { radius: 0.25 }).at(Vec3::new(1.0, 2.0, 1.0));
    let ball = world.add_body(&ball);
    for _ in 0..120 {
        world.step();
    }
    assert!(world.transform(ball).translation.y > 0.2, "the ball lies on the field");
}

/// Checks that the prelude alone has every name used here.
#[test]
fn joints_and_contacts_are_named() {
    let _: Option<(JointState, JointCollision, SixDof, ContactRule, OneWay, Detail)> = None;
}
