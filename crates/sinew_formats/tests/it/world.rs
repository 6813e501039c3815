//! World files: the example of the documentation, round trips, errors.

use sinew_formats::{read_world, write_world};
use sinew_math::{Random, Rotation, Sym3, Transform, Vec3};
use sinew_physics::{
    BodyDef, BodyKind, Combine, CombineRules, ContactRule, Filter, Hull, MassProperties, Material, OneWay,
    Quality, Sensing, Shape, ShapeDef, Sleeping, World, WorldDef, Yields,
};
use std::sync::Arc;

/// Returns the first block of JSON in a module's documentation.
pub fn documented_example(source: &str) -> String {
    first_json(source.lines().map(|line| line.strip_prefix("//!").unwrap_or_default()))
}

fn first_json<'a>(lines: impl Iterator<Item = &'a str>) -> String {
    lines.skip_while(|l| l.trim() != "```json").skip(1).take_while(|l| l.trim() != "```").collect()
}

#[test]
fn documented_example_is_read() {
    let text = documented_example(include_str!("../../src/world.rs"));
    let bodies = read_world(text.as_bytes()).unwrap();
    assert_eq!(bodies.len(), 3);
    assert_eq!(bodies[0].kind, BodyKind::Static);
    assert_eq!(bodies[0].shapes, [ShapeDef::new(Shape::HalfSpace)]);
    let ramp = &bodies[1];
    assert_eq!(ramp.rotation, Rotation::from_axis_angle(Vec3::X, 20_f32.to_radians()));
    assert_eq!(ramp.shapes[0].material, Material { friction: 0.05, ..Material::default() });
    assert_eq!(bodies[2].kind, BodyKind::Dynamic);
    assert_eq!(bodies[2].linear_velocity, Vec3::new(0.0, 0.0, -1.0));
    assert_eq!(bodies[2].shapes[0].density, 7800.0);
    assert_eq!(bodies[2].shapes[1].material.restitution, 0.4);
    assert_eq!(bodies[2].shapes[2].body_from_shape.translation, Vec3::new(0.0, -0.3, 0.0));
}

const RUBBER: Material = Material { friction: 0.9, restitution: 0.7, rolling: 0.002, ..Material::DEFAULT };

#[test]
fn example_of_the_page_is_read_and_stands() {
    let text = first_json(include_str!("../../../../docs/world.md").lines());
    let bodies = read_world(text.as_bytes()).unwrap();
    let kinds: Vec<BodyKind> = bodies.iter().map(|body| body.kind).collect();
    use BodyKind::{Dynamic, Kinematic, Static};
    assert_eq!(kinds, [Static, Static, Dynamic, Kinematic, Dynamic]);
    assert_eq!(bodies[2].shapes[1].material, RUBBER);
    assert_eq!((bodies[2].user_data, bodies[2].angular_damping), (7, 0.1));
    let door = bodies[3].shapes[1].clone();
    assert_eq!((door.sensing, door.filter), (Sensing::Sensor, Filter { layers: 2, mask: 1, group: 0 }));
    assert_eq!(bodies[4].mass.map(|mass| mass.mass), Some(0.01));
    assert_eq!(read_world(write_world(&bodies).as_bytes()).unwrap(), bodies);

    // A set-up that reads back equal gives the same world to the last bit, also after steps.
    let [mut world, mut again] =
        [bodies.clone(), read_world(write_world(&bodies).as_bytes()).unwrap()].map(|bodies| {
            let mut world = World::new(WorldDef::default());
            for body in &bodies {
                world.add_body(body);
            }
            world
        });
    for _ in 0..60 {
        assert_eq!(world.hash(), again.hash());
        world.step();
        again.step();
    }
}

/// Checks that every key on the page is known, and every known shape and kind is on the page.
#[test]
fn page_lists_every_key_and_kind() {
    let page = include_str!("../../../../docs/world.md");
    let complaint = |json: &str| read_world(json.as_bytes()).unwrap_err().what;
    let body = complaint(r#"{"sinew":"world","version":1,"bodies":[{"?":0}]}"#);
    let shape = complaint(r#"{"sinew":"world","version":1,"bodies":[{"shapes":[{"?":0}]}]}"#);
    for complaint in [body, shape] {
        let known = complaint.split("known are ").nth(1).expect("the error lists the known keys");
        for key in known.split(", ") {
            assert!(page.contains(&format!("`{key}`")), "{key} is not on the page");
        }
    }
    for word in [
        "box",
        "sphere",
        "capsule",
        "tapered_capsule",
        "cylinder",
        "cone",
        "hull",
        "half_space",
        "static",
        "kinematic",
        "dynamic",
        "friction",
        "restitution",
        "rolling",
        "static_friction",
        "surface_velocity",
        "surface_spin",
        "combine",
        "tag",
        "average",
        "geometric_mean",
        "minimum",
        "multiply",
        "maximum",
        "push",
        "ghost",
        "one_way",
        "direction",
        "tolerance",
    ] {
        assert!(page.contains(&format!("`{word}`")), "{word} is not on the page");
    }
}

fn random_shape(random: &mut Random, kind: BodyKind) -> ShapeDef {
    let radius = random.range(0.001, 3.0);
    let shape = match random.index(if kind == BodyKind::Static { 5 } else { 4 }) {
        0 => Shape::Box { half_extents: (random.in_cube() + Vec3::splat(1.1)) * 1e-3 },
        1 => Shape::Sphere { radius },
        2 => Shape::Capsule { half_height: random.unit(), radius },
        3 => {
            let points: Vec<Vec3> = (0..12).map(|_| random.in_cube() * radius).collect();
            Shape::Hull(Arc::new(Hull::new(&points).expect("a solid")))
        }
        _ => Shape::HalfSpace,
    };
    ShapeDef {
        shape,
        body_from_shape: Transform::new(random.in_cube(), random.rotation()),
        density: random.range(0.1, 1e4),
        material: random_material(random),
        filter: Filter {
            layers: random.bits() as u32,
            mask: random.bits() as u32,
            group: random.bits() as i32,
        },
        sensing: [Sensing::Solid, Sensing::Sensor][random.index(2)],
        rule: match random.index(4) {
            0 => ContactRule::Push,
            1 => ContactRule::Ghost,
            2 => ContactRule::Yields(Yields { max_force: random.unit(), max_impulse: random.unit() }),
            _ => ContactRule::OneWay(OneWay { direction: random.direction(), tolerance: random.unit() }),
        },
    }
}

fn random_material(random: &mut Random) -> Material {
    let rules = [
        None,
        Some(Combine::Average),
        Some(Combine::GeometricMean),
        Some(Combine::Minimum),
        Some(Combine::Multiply),
        Some(Combine::Maximum),
    ];
    let friction = random.unit();
    let mut rule = || rules[random.index(rules.len())];
    let combine = CombineRules { friction: rule(), restitution: rule(), rolling: rule() };
    let moves = if random.index(2) == 0 { Vec3::ZERO } else { random.in_cube() };
    Material {
        friction,
        static_friction: (random.index(2) == 0).then(|| friction + random.unit()),
        restitution: random.unit(),
        rolling: random.unit(),
        surface_velocity: moves,
        surface_spin: -moves,
        combine,
        tag: random.bits() as u32,
    }
}

fn random_body(random: &mut Random) -> BodyDef {
    let kind = [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic][random.index(3)];
    let principal = Vec3::new(random.range(0.1, 2.0), random.range(0.1, 2.0), random.range(0.1, 2.0));
    BodyDef {
        kind,
        position: random.in_cube() * 1e4,
        rotation: random.rotation(),
        linear_velocity: random.in_cube(),
        angular_velocity: random.in_cube() * 1e-20,
        linear_damping: random.unit(),
        angular_damping: random.unit(),
        gravity_scale: random.range(-2.0, 2.0),
        shapes: (0..=random.index(3)).map(|_| random_shape(random, kind)).collect(),
        mass: (random.index(2) == 0).then(|| MassProperties {
            mass: random.range(1e-6, 1e6),
            center: random.in_cube(),
            inertia: Sym3::from_rotated_diagonal(random.rotation(), principal),
        }),
        sleeping: [Sleeping::On, Sleeping::Off][random.index(2)],
        quality: [None, Some(Quality::Fast), Some(Quality::Balanced), Some(Quality::Exact)][random.index(4)],
        user_data: random.bits(),
    }
}

#[test]
fn written_files_read_back_equal() {
    let mut random = Random::new(7);
    let bodies: Vec<_> = (0..200).map(|_| random_body(&mut random)).collect();
    let text = write_world(&bodies);
    assert_eq!(read_world(text.as_bytes()).unwrap(), bodies);
    assert!(text.starts_with("{\n  \"sinew\": \"world\",\n  \"version\": 1,\n"));
    assert_eq!(read_world(write_world(&[]).as_bytes()).unwrap(), []);
}

#[test]
fn defaults_are_not_written() {
    let shapes = vec![ShapeDef::new(Shape::Box { half_extents: Vec3::new(1.0, 0.1, 2.5) })];
    let text = write_world(&[BodyDef { kind: BodyKind::Static, shapes, ..BodyDef::default() }]);
    assert!(
        text.contains(
            r#"{ "kind": "static", "shapes": [{ "type": "box", "half_extents": [1, 0.1, 2.5] }] }"#
        ),
        "{text}"
    );
}

#[test]
fn errors_name_the_place() {
    let world = |bodies: &str| format!(r#"{{"sinew":"world","version":1,"bodies":[{bodies}]}}"#);
    for (json, expected) in [
        (r#"{"sinew":"ragdoll","version":1}"#.into(), "this is a `ragdoll` file, not a `world` (sinew)"),
        (
            r#"{"sinew":"world","version":2}"#.into(),
            "version 2 is newer than 1, the last one known (version)",
        ),
        (r#"{"sinew":"world","version":1}"#.into(), "`bodies` is missing (top level)"),
        ("[]".into(), "must be an object (top level)"),
        (
            world(r#"{"shapes":[]},{"shapes":[{"type":"box","half_extents":[1,-2,1]}]}"#),
            "must be more than 0 (bodies[1].shapes[0].half_extents[1])",
        ),
        (
            world(r#"{"shapes":[{"type":"box","half_extents":[1,2]}]}"#),
            "must have 3 numbers, has 2 (bodies[0].shapes[0].half_extents)",
        ),
        (
            world(r#"{"shapes":[{"type":"sphere","radius":1e39}]}"#),
            "number is too large (bodies[0].shapes[0].radius)",
        ),
        (
            world(r#"{"shapes":[{"type":"sphere","radius":1,"half_height":1}]}"#),
            "a shape of this type has no `half_height` (bodies[0].shapes[0].half_height)",
        ),
        (world(r#"{"shapes":[{"type":"hull"}]}"#), "`points` is missing (bodies[0].shapes[0])"),
        (
            world(r#"{"shapes":[{"type":"hull","points":[[0,0,0],[1,0,0],[0,1]]}]}"#),
            "must have 3 numbers, has 2 (bodies[0].shapes[0].points[2])",
        ),
        (
            world(r#"{"shapes":[{"type":"hull","points":[[0,0,0],[1,0,0],[0,1,0]]}]}"#),
            "a hull needs four different points (bodies[0].shapes[0].points)",
        ),
        (
            world(r#"{"shapes":[{"type":"hull","points":[[0,0,0],[1,0,0],[0,1,0],[1,1,0]]}]}"#),
            "all points lie in a plane (bodies[0].shapes[0].points)",
        ),
        (
            world(r#"{"kind":"dynamic","shapes":[{"type":"half_space"}]}"#),
            "only a static body can be a half_space (bodies[0].shapes[0])",
        ),
        (
            world(r#"{"kind":"dynamic","shapes":[]}"#),
            "a dynamic body needs a mass, or a solid shape with a density above 0 (bodies[0])",
        ),
        (
            world(r#"{"rotation":[0,0,0,2],"shapes":[]}"#),
            "quaternion must have length 1 (bodies[0].rotation)",
        ),
        (
            world(r#"{"mass":{"kg":1,"inertia":[1,1,-1,0,0,0]},"shapes":[]}"#),
            "must be positive definite (bodies[0].mass.inertia)",
        ),
    ] {
        assert_eq!(read_world(json.as_bytes()).unwrap_err().to_string(), expected);
    }
    let error = read_world(world(r#"{"shape":[]}"#).as_bytes()).unwrap_err();
    assert!(error.what.starts_with("unknown key `shape`; known are name, kind,"), "{error}");
}

#[test]
fn errors_of_materials_and_contacts_name_the_place() {
    for (surface, expected) in [
        (r#""material":"ice""#, "there is no material `ice` (bodies[0].shapes[0].material)"),
        (
            r#""material":{"friction":0.5,"static_friction":0.4}"#,
            "must not be less than `friction` (bodies[0].shapes[0].material.static_friction)",
        ),
        (
            r#""material":{"combine":{"rolling":"sum"}}"#,
            "unknown rule `sum`; known are average, geometric_mean, minimum, multiply, maximum \
             (bodies[0].shapes[0].material.combine.rolling)",
        ),
        (
            r#""contacts":{"one_way":{"direction":[0,0,0]}}"#,
            "the direction of a one-way shape must be finite and not 0 (bodies[0].shapes[0].contacts.one_way)",
        ),
        (
            r#""contacts":"spirit""#,
            "must be push, ghost, or an object with `one_way` or `yields` (bodies[0].shapes[0].contacts)",
        ),
    ] {
        let shape = format!(r#"{{"type":"sphere","radius":1,{surface}}}"#);
        let json = format!(r#"{{"sinew":"world","version":1,"bodies":[{{"shapes":[{shape}]}}]}}"#);
        assert_eq!(read_world(json.as_bytes()).unwrap_err().to_string(), expected);
    }
}

#[test]
fn surfaces_read_back_as_equal_shapes() {
    let shapes = r#"{"type":"mesh","vertices":[[0,0,0],[0,0,1],[1,0,0],[1,0.5,1]],"triangles":[[0,1,2],[2,1,3]]},
        {"type":"height_field","columns":3,"rows":2,"spacing":[1,2],"heights":[0,1,0,0,2,0],"holes":[1]}"#;
    let text = format!(r#"{{"sinew":"world","version":1,"bodies":[{{"shapes":[{shapes}]}}]}}"#);
    let bodies = read_world(text.as_bytes()).unwrap();
    assert!(matches!(&bodies[0].shapes[0].shape, Shape::Mesh(mesh) if mesh.triangle_count() == 2));
    assert!(
        matches!(&bodies[0].shapes[1].shape, Shape::HeightField(field) if field.triangles().count() == 2)
    );
    assert_eq!(read_world(write_world(&bodies).as_bytes()).unwrap(), bodies);
    let refused = |shape: &str| {
        let text = format!(r#"{{"sinew":"world","version":1,"bodies":[{{"shapes":[{shape}]}}]}}"#);
        read_world(text.as_bytes()).unwrap_err().to_string()
    };
    for (shape, expected) in [
        (r#"{"type":"mesh","vertices":[[0,0,0]],"triangles":[[0,0,1]]}"#, "triangles[0][2]"),
        (r#"{"type":"mesh","vertices":[[0,0,0]],"triangles":[[0,0]]}"#, "must have 3 indices, has 2"),
        (r#"{"type":"mesh","vertices":[[0,0,0]],"triangles":[[0,0,0]]}"#, "no triangle has an area"),
        (r#"{"type":"mesh","vertices":[],"triangles":[]}"#, "there are no triangles"),
        (
            r#"{"type":"mesh","radius":1,"vertices":[[0,0,0],[1,0,0],[0,0,1]],"triangles":[[0,1,2]]}"#,
            "radius",
        ),
        (
            r#"{"type":"height_field","columns":4000000000,"rows":4000000000,"spacing":[1,1],"heights":[]}"#,
            "at most 2²⁶ cells",
        ),
        (r#"{"type":"height_field","columns":3,"rows":3,"spacing":[1,1],"heights":[0]}"#, "1 heights"),
    ] {
        let said = refused(shape);
        assert!(said.contains(expected), "{said}");
    }
    let dynamic = text.replace(r#"{"shapes""#, r#"{"kind":"dynamic","shapes""#);
    assert!(read_world(dynamic.as_bytes()).unwrap_err().to_string().contains("needs a mass"));
}
