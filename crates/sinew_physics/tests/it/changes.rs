//! Changes of bodies and shapes while the world runs: the next step uses all of them.

use crate::build::{box_body, floor, sphere_body};
use sinew_math::{Random, Range, Reader, Rotation, Transform, Vec3, Writer};
use sinew_physics::*;
use std::collections::BTreeSet;

const G: f32 = 9.81;

fn world() -> World {
    World::new(WorldDef::default())
}

fn run(world: &mut World, steps: usize) {
    (0..steps).for_each(|_| world.step());
}

fn settled(world: &mut World, id: BodyId) {
    (0..600).find(|_| {
        world.step();
        !world.is_awake(id)
    });
    assert!(!world.is_awake(id), "the body must sleep");
}

fn height(world: &World, id: BodyId) -> f32 {
    world.transform(id).translation.y
}

/// Returns a new world that has loaded a snapshot of the given one.
fn reloaded(world: &World) -> World {
    let (mut w, mut shapes) = (Writer::new(), Writer::new());
    world.save(&mut w);
    world.save_shapes(&mut shapes);
    let mut other = World::new(WorldDef::default());
    other.load_shapes(&mut Reader::new(shapes.as_bytes())).expect("saved shapes load");
    other.load(&mut Reader::new(w.as_bytes())).expect("a saved world loads");
    other
}

/// Regression, found by random lives: the tree leaf of the removed shape became the first leaf of a body that has none.
#[test]
fn body_in_a_reused_slot_can_lose_its_last_shape() {
    let mut world = world();
    floor(&mut world);
    let shape_of = |body| ShapeId { body, shape: 0 };
    let first = world.add_body(&sphere_body(0.4, Vec3::Y));
    world.remove_shape(shape_of(first), MassUpdate::Keep);
    world.add_body(&BodyDef { kind: BodyKind::Kinematic, ..sphere_body(0.4, Vec3::X) });
    world.remove_body(first);
    let second = world.add_body(&sphere_body(0.2, Vec3::Y * 2.0));
    world.remove_body(second);
    let third = BodyDef { kind: BodyKind::Kinematic, linear_velocity: Vec3::Y, ..sphere_body(0.4, Vec3::Y) };
    let third = world.add_body(&third);
    run(&mut world, 2);
    world.remove_shape(shape_of(third), MassUpdate::Keep);
    run(&mut world, 2);
}

#[test]
fn damping_and_gravity_scale_set_later_equal_those_in_the_definition() {
    let def = BodyDef {
        linear_velocity: Vec3::X * 3.0,
        angular_velocity: Vec3::Y * 2.0,
        ..sphere_body(0.2, Vec3::ZERO)
    };
    let made = BodyDef { linear_damping: 0.7, angular_damping: 0.3, gravity_scale: 0.5, ..def.clone() };
    let (mut one, mut other) = (world(), world());
    let (a, b) = (one.add_body(&made), other.add_body(&def));
    other.set_linear_damping(b, 0.7);
    other.set_angular_damping(b, 0.3);
    other.set_gravity_scale(b, 0.5);
    assert_eq!((other.linear_damping(b), other.angular_damping(b), other.gravity_scale(b)), (0.7, 0.3, 0.5));
    run(&mut one, 30);
    run(&mut other, 30);
    assert_eq!(one.hash(), other.hash());
    assert!(one.velocity(a).linear.x < 2.2, "damping must slow body a");
}

#[test]
fn sleeping_body_wakes_when_its_gravity_scale_becomes_zero() {
    let mut world = world();
    floor(&mut world);
    let ball = world.add_body(&sphere_body(0.2, Vec3::Y * 0.2));
    settled(&mut world, ball);
    world.set_gravity_scale(ball, 1.0);
    assert!(!world.is_awake(ball), "the ball must sleep while nothing changes");
    world.set_gravity_scale(ball, -1.0);
    let start = height(&world, ball);
    run(&mut world, 60);
    let risen = height(&world, ball) - start;
    assert!((risen - 0.5 * G).abs() < 0.1, "{risen} m in a second");
}

#[test]
fn user_data_is_kept_and_saved() {
    let mut world = world();
    let ball = world.add_body(&sphere_body(0.2, Vec3::ZERO));
    world.set_user_data(ball, u64::MAX - 1);
    assert_eq!(reloaded(&world).user_data(ball), u64::MAX - 1);
}

#[test]
fn changing_the_centre_of_mass_keeps_point_velocities() {
    let mut world = world();
    world.set_gravity(Vec3::ZERO);
    let def = BodyDef {
        linear_velocity: Vec3::new(1.0, 2.0, -1.0),
        angular_velocity: Vec3::new(0.5, -2.0, 1.0),
        rotation: Rotation::from_axis_angle(Vec3::Z, 0.4),
        ..box_body(Vec3::new(0.2, 0.3, 0.4), Vec3::X)
    };
    let block = world.add_body(&def);
    let anchor = world.add_body(&BodyDef::fixed(Shape::sphere(0.1)).at(Vec3::Y * 3.0));
    let joint = world.add_ball(anchor, block, Vec3::X + Vec3::Y * 0.3);
    let (pose, point) = (world.transform(block), Vec3::new(0.7, 0.2, 0.1));
    let before = world.get(block).expect("the body is in the world").velocity_at(point);
    let properties = MassProperties { center: Vec3::new(0.1, -0.2, 0.3), ..world.mass(block) };
    world.set_mass(block, properties);
    let after = world.get(block).expect("the body is in the world").velocity_at(point);
    assert!((before - after).length() < 1e-5, "{before} {after}");
    let moved = (pose.inverse() * world.transform(block)).translation.length();
    assert!(moved < 1e-6, "the body must not move; it moved {moved} m");
    let found = world.mass(block);
    assert!((found.center - properties.center).length() < 1e-6 && found.mass == properties.mass);
    assert!(world.joint_gap(joint) < 1e-5, "the joint must keep its position");
    run(&mut world, 60);
    assert!(world.joint_gap(joint) < 1e-4);
}

/// A mass that is set later acts like a mass in the definition.
#[test]
fn mass_set_later_equals_mass_in_the_definition() {
    let properties = MassProperties {
        mass: 7.0,
        center: Vec3::new(0.05, 0.1, -0.05),
        inertia: Shape::cuboid(Vec3::new(0.3, 0.1, 0.2)).mass_properties(500.0).inertia,
    };
    let def =
        BodyDef { angular_velocity: Vec3::new(3.0, 1.0, 2.0), ..box_body(Vec3::new(0.2, 0.3, 0.4), Vec3::Y) };
    let made = BodyDef { mass: Some(properties), ..def.clone() };
    let (mut one, mut other) = (world(), world());
    let (a, b) = (one.add_body(&made), other.add_body(&def));
    other.set_mass(b, properties);
    // The centre of mass of `def` was the origin; the new mass has another centre.
    let velocity = one.velocity(a);
    other.set_velocity(b, velocity);
    for world in [&mut one, &mut other] {
        floor(world);
        run(world, 45);
    }
    let apart = (one.transform(a).translation - other.transform(b).translation).length();
    assert!(apart < 1e-4, "{apart} m");
    assert_eq!(one.mass(a).mass, other.mass(b).mass);
}

#[test]
fn crate_tips_over_its_ledge_when_its_centre_of_mass_moves() {
    let mut world = world();
    world.add_body(&BodyDef::fixed(Shape::cuboid(Vec3::new(1.0, 0.5, 1.0))).at(Vec3::Y * 0.5));
    let load = world.add_body(&box_body(Vec3::splat(0.5), Vec3::new(0.8, 1.5, 0.0)));
    settled(&mut world, load);
    world.set_mass(load, MassProperties { center: Vec3::X * 0.4, ..world.mass(load) });
    run(&mut world, 120);
    assert!(height(&world, load) < 1.0, "the load must fall; its height is {} m", height(&world, load));
    // A world that has loaded the snapshot has the same state.
    assert_eq!(reloaded(&world).hash(), world.hash());
}

#[test]
fn body_changes_between_all_kinds() {
    use BodyKind::{Dynamic, Kinematic, Static};
    for (from, to) in
        [(Static, Dynamic), (Static, Kinematic), (Kinematic, Static), (Kinematic, Dynamic), (Dynamic, Static)]
    {
        let mut world = world();
        let shape = ShapeDef {
            body_from_shape: Transform::from_translation(Vec3::new(0.3, 0.0, 0.0)),
            ..ShapeDef::new(Shape::cuboid(Vec3::new(0.5, 0.1, 0.5)))
        };
        let plate = world.add_body(&BodyDef { kind: from, ..BodyDef::dynamic(shape).at(Vec3::Y * 5.0) });
        let rider = world.add_body(&sphere_body(0.1, Vec3::new(0.3, 5.2, 0.0)));
        if from == Dynamic {
            world.set_gravity_scale(plate, 0.0);
        } else {
            settled(&mut world, rider);
        }
        world.set_kind(plate, to);
        assert_eq!(world.kind(plate), to);
        let start = height(&world, plate);
        let mut other = reloaded(&world);
        run(&mut world, 30);
        run(&mut other, 30);
        assert_eq!(world.hash(), other.hash(), "{from:?} to {to:?}");
        let fallen = start - height(&world, plate);
        let free = 0.5 * G * (0.5 + 1.0 / 240.0) * 0.5;
        match to {
            Dynamic => assert!((fallen - free).abs() < 0.01, "{fallen} m of {free}"),
            _ => assert_eq!(fallen, 0.0),
        }
        if to == Dynamic {
            let mass = Shape::cuboid(Vec3::new(0.5, 0.1, 0.5)).mass_properties(1000.0);
            assert!((world.mass(plate).mass - mass.mass).abs() < 1e-3);
            assert!(
                (world.mass(plate).center.x - 0.3).abs() < 1e-5,
                "the centre of mass must be that of the shapes"
            );
            assert!(height(&world, rider) < 4.5, "the box on the removed body must fall");
        } else {
            assert!((height(&world, rider) - 5.2).abs() < 0.01, "the box on the body must stay there");
        }
    }
}

#[test]
fn a_body_made_dynamic_again_keeps_its_mass() {
    let mut world = world();
    let given =
        MassProperties { center: Vec3::new(0.0, 0.1, 0.0), ..Shape::sphere(0.3).mass_properties(800.0) };
    let body = world.add_body(&BodyDef { mass: Some(given), ..sphere_body(0.3, Vec3::ZERO) });
    let before = world.mass(body);
    world.set_kind(body, BodyKind::Static);
    assert_eq!(world.mass(body).mass, 0.0);
    let mut world = reloaded(&world);
    run(&mut world, 10);
    world.set_kind(body, BodyKind::Kinematic);
    world.set_kind(body, BodyKind::Dynamic);
    assert_eq!(world.mass(body), before);
    world.set_kind(body, BodyKind::Static);
    let heavy = MassProperties { mass: 90.0, ..given };
    world.set_mass(body, heavy);
    world.set_kind(body, BodyKind::Dynamic);
    assert_eq!(world.mass(body).mass, 90.0);
}

#[test]
fn a_joint_holds_a_body_that_becomes_static_and_back() {
    let mut world = world();
    let (a, b) = (world.add_body(&sphere_body(0.1, Vec3::ZERO)), world.add_body(&sphere_body(0.1, Vec3::X)));
    let joint = world.add_joint(&world.distance(a, b, Vec3::ZERO, Vec3::X, Range { lo: 1.0, hi: 1.0 }));
    world.set_kind(a, BodyKind::Static);
    run(&mut world, 30);
    assert_eq!(world.transform(a).translation, Vec3::ZERO);
    assert!(world.joint_gap(joint) < 1e-4 && height(&world, b) < -0.8, "the joint must let the body swing");
    world.set_kind(a, BodyKind::Dynamic);
    run(&mut world, 60);
    assert!(
        world.joint_gap(joint) < 1e-3 && height(&world, a) < -2.0,
        "the joint must hold while both bodies fall"
    );
}

fn pairs(list: &[(ShapeId, ShapeId)]) -> Vec<(u32, u32)> {
    list.iter().map(|(a, b)| (a.shape, b.shape)).collect()
}

#[test]
fn added_and_removed_shapes_report_touch_events() {
    let mut world = world();
    let plate = |x: f32| ShapeDef {
        body_from_shape: Transform::from_translation(Vec3::X * x),
        ..ShapeDef::new(Shape::cuboid(Vec3::new(0.4, 0.1, 0.4)))
    };
    let shelf = world.add_body(&BodyDef::fixed(plate(0.0)).with(plate(1.0)));
    let balls = [0.0, 1.0, 2.0].map(|x| world.add_body(&sphere_body(0.1, Vec3::new(x, 0.2, 0.0))));
    world.set_gravity_scale(balls[2], 0.0);
    settled(&mut world, balls[1]);
    let third = world.add_shape(shelf, &plate(2.0), MassUpdate::FromShapes);
    assert_eq!((third.shape, world.shape_ids(shelf).count()), (2, 3));
    world.set_gravity_scale(balls[2], 1.0);
    world.step();
    assert_eq!(pairs(&world.events().shapes_begin), [(2, 0)], "the new body must begin a contact");
    run(&mut world, 60);
    assert!((height(&world, balls[2]) - 0.2).abs() < 0.01, "the new body must support the ball");
    // The first shape is removed, and the numbers of the others decrease.
    world.remove_shape(ShapeId { body: shelf, shape: 0 }, MassUpdate::FromShapes);
    assert!(world.is_awake(balls[0]));
    let mut other = reloaded(&world);
    world.step();
    other.step();
    let events = world.events();
    assert_eq!(events.end, [(shelf, balls[0])]);
    assert!(events.begin.is_empty(), "persistent contacts must not begin again: {:?}", events.begin);
    assert_eq!((&events.end, &events.shapes_end), (&other.events().end, &other.events().shapes_end));
    run(&mut world, 60);
    run(&mut other, 60);
    assert_eq!(world.hash(), other.hash());
    assert!(height(&world, balls[0]) < -3.0, "the ball without support must fall");
    for ball in [balls[1], balls[2]] {
        assert!(
            (height(&world, ball) - 0.2).abs() < 0.01,
            "the ball must rest on the new body; height {} m",
            height(&world, ball)
        );
    }
    // A thicker shape lifts the body on it, without an event.
    let first = ShapeId { body: shelf, shape: 0 };
    let thick = ShapeDef { shape: Shape::cuboid(Vec3::new(0.4, 0.104, 0.4)), ..world.shape_def(first) };
    world.set_shape(first, &thick, MassUpdate::FromShapes);
    world.step();
    assert!(world.events().begin.is_empty() && world.events().end.is_empty());
    run(&mut world, 240);
    assert!((height(&world, balls[1]) - 0.204).abs() < 2e-3, "{}", height(&world, balls[1]));
    assert_eq!(world.shape(first), &thick.shape);
}

#[test]
fn masses_follow_shapes_unless_kept() {
    let mut world = world();
    let ball = world.add_body(&sphere_body(0.5, Vec3::ZERO));
    let one = Shape::sphere(0.5).mass_properties(1000.0).mass;
    let beside = ShapeDef {
        body_from_shape: Transform::from_translation(Vec3::X * 2.0),
        ..ShapeDef::new(Shape::sphere(0.5))
    };
    let second = world.add_shape(ball, &beside, MassUpdate::FromShapes);
    assert!((world.mass(ball).mass - 2.0 * one).abs() < 0.1);
    assert!((world.center_of_mass(ball) - Vec3::X).length() < 1e-5);
    assert!((world.body_from_shape(second).translation - Vec3::X * 2.0).length() < 1e-5);
    let kept = world.mass(ball);
    world.add_shape(ball, &beside, MassUpdate::Keep);
    assert_eq!(world.mass(ball), kept);
    world.set_mass_of_shapes(ball);
    assert!((world.mass(ball).mass - 3.0 * one).abs() < 0.1);
    for _ in 0..100 {
        let def = ShapeDef { density: 10.0, ..beside.clone() };
        world.set_shape(second, &def, MassUpdate::Keep);
        world.set_shape(second, &beside, MassUpdate::Keep);
    }
    let mut w = Writer::new();
    world.save(&mut w);
    assert!(w.as_bytes().len() < 2000, "snapshots must not keep surfaces of removed shapes");
}

#[test]
#[should_panic(expected = "positive, finite mass")]
fn removing_the_only_shape_with_mass_panics() {
    let mut world = world();
    let ball = world.add_body(&sphere_body(0.5, Vec3::ZERO));
    world.remove_shape(ShapeId { body: ball, shape: 0 }, MassUpdate::FromShapes);
}

#[test]
#[should_panic(expected = "BodyId 0v0 has no shape 3")]
fn missing_shape_is_named_in_the_panic() {
    let mut world = world();
    let ball = world.add_body(&sphere_body(0.5, Vec3::ZERO));
    world.set_sensing(ShapeId { body: ball, shape: 3 }, Sensing::Sensor);
}

#[test]
#[should_panic(expected = "half-spaces are static bodies")]
fn moving_half_space_is_refused() {
    let mut world = world();
    let ground = floor(&mut world);
    world.set_kind(ground, BodyKind::Kinematic);
}

fn some_shape(random: &mut Random) -> ShapeDef {
    let shape = match random.index(4) {
        0 => Shape::sphere(0.1 + 0.2 * random.unit()),
        1 => Shape::capsule(0.2 * random.unit(), 0.1 + 0.1 * random.unit()),
        2 => Shape::cylinder(0.15, 0.1 + 0.1 * random.unit()),
        _ => Shape::cuboid(Vec3::splat(0.1) + random.in_cube().abs() * 0.2),
    };
    let sensing = if random.unit() < 0.1 { Sensing::Sensor } else { Sensing::Solid };
    let body_from_shape = Transform::new(random.in_cube() * 0.3, random.rotation());
    ShapeDef { body_from_shape, sensing, density: 500.0 + 500.0 * random.unit(), ..ShapeDef::new(shape) }
}

fn change(world: &mut World, random: &mut Random) {
    let ids: Vec<BodyId> = world.body_ids().skip(1).collect();
    let id = ids[random.index(ids.len())];
    let shapes = world.shape_ids(id).count();
    let shape = ShapeId { body: id, shape: random.index(shapes) as u32 };
    let mass = if random.unit() < 0.7 { MassUpdate::FromShapes } else { MassUpdate::Keep };
    match random.index(8) {
        0 | 1 => _ = world.add_shape(id, &some_shape(random), mass),
        2 if shapes > 1 => world.remove_shape(shape, mass),
        2 | 3 => world.set_shape(shape, &some_shape(random), mass),
        4 => {
            let properties = Shape::sphere(0.3).mass_properties(200.0 + 800.0 * random.unit());
            world.set_mass(id, MassProperties { center: random.in_cube() * 0.2, ..properties });
        }
        5 => world.set_mass_of_shapes(id),
        _ => {
            let kind = [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic][random.index(3)];
            world.set_kind(id, kind);
            if kind == BodyKind::Kinematic {
                let target = Transform::new(random.in_cube() + Vec3::Y, random.rotation());
                world.move_to(id, target, 1.0);
            }
        }
    }
}

/// Changes must update all derived data: the other world is loaded anew before each step, so it has no outdated data.
#[test]
fn a_changed_world_equals_a_reloaded_one() {
    let mut random = Random::new(7);
    let mut touched = 0;
    for _ in 0..4 {
        let mut world = world();
        floor(&mut world);
        for i in 0..12 {
            let at = random.in_cube() + Vec3::Y * (1.0 + 0.2 * i as f32);
            world.add_body(&BodyDef::dynamic(some_shape(&mut random)).with(some_shape(&mut random)).at(at));
        }
        let ids: Vec<BodyId> = world.body_ids().skip(1).collect();
        world.add_joint(&world.ball(ids[0], ids[1], Vec3::Y));
        world.add_joint(&world.hinge(ids[2], ids[3], Vec3::Y, Vec3::X));
        let mut told = BTreeSet::new();
        for step in 0..240 {
            if random.unit() < 0.4 {
                change(&mut world, &mut random);
            }
            let mut other = reloaded(&world);
            world.step();
            other.step();
            assert_eq!(world.hash(), other.hash(), "step {step}");
            let (one, two) = (world.events(), other.events());
            assert_eq!((&one.begin, &one.end), (&two.begin, &two.end), "step {step}");
            // A pair touches if its touch has begun and has not ended.
            for pair in &one.begin {
                assert!(told.insert(*pair), "{pair:?} begins twice");
            }
            for pair in &one.end {
                assert!(told.remove(pair), "{pair:?} ends without a begin event");
            }
            touched += told.len();
        }
    }
    assert!(touched > 2000, "only {touched} contacts");
}

#[test]
fn a_kinematic_body_reaches_its_target() {
    let mut world = world();
    let dt = world.def().dt();
    let shape = ShapeDef {
        body_from_shape: Transform::from_translation(Vec3::new(0.4, 0.0, 0.1)),
        ..ShapeDef::new(Shape::cuboid(Vec3::new(0.5, 0.1, 0.2)))
    };
    // The paddle's centre of mass is away from its origin.
    let paddle = world.add_body(&BodyDef::dynamic(shape));
    world.set_kind(paddle, BodyKind::Kinematic);
    let mut random = Random::new(5);
    for _ in 0..20 {
        let target = Transform::new(random.in_cube(), random.rotation());
        world.move_to(paddle, target, dt);
        world.step();
        let off = target.inverse() * world.transform(paddle);
        assert!(off.translation.length() < 1e-5, "pose of the paddle relative to its target: {off:?}");
        assert!(
            off.rotation.angle_to(Rotation::IDENTITY) < 2e-3,
            "pose of the paddle relative to its target: {off:?}"
        );
    }
}

/// Moves are near and far, with small and large rotations, of bodies of every kind, at rest and moving.
#[test]
fn batched_moves_equal_single_moves() {
    let mut random = Random::new(9);
    let mut world = world();
    let dt = world.def().dt();
    let ids: Vec<BodyId> = (0..43)
        .map(|i| {
            let shape = ShapeDef {
                body_from_shape: Transform::new(random.in_cube() * 0.3, random.rotation()),
                ..ShapeDef::new(Shape::cuboid(Vec3::new(0.1, 0.2, 0.3)))
            };
            let id = world.add_body(&BodyDef::dynamic(shape).at(random.in_cube() * 40.0));
            if i % 5 > 0 {
                world.set_kind(id, BodyKind::Kinematic);
            }
            id
        })
        .collect();
    for step in 0..20 {
        let mut near = |from: Transform| {
            let far = [0.0, 1e-6, 0.01, 1.0][random.index(4)];
            let turn = Rotation::from_scaled_axis(random.in_cube() * [0.0, 1e-4, 0.1, 3.0][random.index(4)]);
            let rotation = if random.unit() < 0.3 { random.rotation() } else { turn * from.rotation };
            Transform::new(from.translation + random.in_cube() * far, rotation)
        };
        let before: Vec<Transform> = ids.iter().map(|&id| near(world.transform(id))).collect();
        let now: Vec<Transform> = before.iter().map(|&before| near(before)).collect();
        let mut other = reloaded(&world);
        for (&id, (&before, &now)) in ids.iter().zip(before.iter().zip(&now)) {
            let turn = now.rotation * before.rotation.inverse();
            let to = now.translation + (now.translation - before.translation);
            other.move_to(id, Transform::new(to, turn * now.rotation), dt);
        }
        world.lead_all(&ids, &before, &now, dt);
        assert_eq!(world.hash(), other.hash(), "step {step}");
        world.step();
        other.step();
        assert_eq!(world.hash(), other.hash(), "step {step}");
    }
}

/// Function that returns a joint between two bodies; kinds without an axis ignore the axis.
type Make = fn(&World, BodyId, BodyId, Vec3) -> JointDef;

#[test]
fn joints_built_by_short_methods_lock_the_axes_of_their_kind() {
    let axis = Vec3::new(1.0, 2.0, -2.0);
    let make: [Make; 5] = [
        |world, a, b, _| world.ball(a, b, Vec3::new(0.5, 0.1, 0.0)),
        |world, a, b, axis| world.hinge(a, b, Vec3::new(0.5, 0.1, 0.0), axis),
        |world, a, b, axis| world.slider(a, b, Vec3::new(0.5, 0.1, 0.0), axis),
        |world, a, b, axis| world.universal(a, b, Vec3::new(0.5, 0.1, 0.0), axis),
        |world, a, b, _| world.fixed(a, b),
    ];
    for (kind, make) in make.into_iter().enumerate() {
        let mut world = world();
        let a = world.add_body(&BodyDef::fixed(Shape::sphere(0.1)).at(Vec3::Y * 0.1));
        let b = world.add_body(&BodyDef {
            rotation: Rotation::from_axis_angle(Vec3::Z, 0.7),
            ..box_body(Vec3::new(0.2, 0.3, 0.1), Vec3::X)
        });
        let start = world.transform(b);
        let joint = world.add_joint(&make(&world, a, b, axis));
        assert!(world.joint_gap(joint) < 1e-6, "a joint of kind {kind} must start without a gap");
        run(&mut world, 40);
        assert!(world.joint_gap(joint) < 1e-4, "a joint of kind {kind} must keep its gap closed");
        let (now, unit) = (world.transform(b), axis / 3.0);
        let turned = now.rotation * start.rotation.inverse();
        match kind {
            1 => assert!((turned * unit - unit).length() < 1e-4 && turned.angle_to(Rotation::IDENTITY) > 0.1),
            2 => {
                let way = now.translation - start.translation;
                assert!(way.cross(unit).length() < 1e-4 && way.length() > 0.5, "{way}");
            }
            3 => assert!(world.joint_transform(joint).rotation.twist_angle(Vec3::X).abs() < 1e-3),
            4 => assert!(turned.angle_to(Rotation::IDENTITY) < 2e-3 && now.translation.x > 0.99),
            _ => assert!(
                (now.translation - start.translation).length() > 0.1,
                "the joint must let the body swing"
            ),
        }
    }
}

#[test]
fn a_rope_joint_keeps_its_length() {
    let mut world = world();
    let hook = world.add_body(&BodyDef::fixed(Shape::sphere(0.1)).at(Vec3::Y * 3.0));
    let load = world.add_body(&sphere_body(0.2, Vec3::new(0.5, 3.0, 0.0)));
    world.add_rope(hook, load, Vec3::Y * 3.0, Vec3::new(0.5, 3.0, 0.0), 1.5);
    let farthest = (0..240).fold(0.0_f32, |most, _| {
        world.step();
        sinew_math::max(most, (world.transform(load).translation - Vec3::Y * 3.0).length())
    });
    assert!(
        farthest > 1.49 && farthest < 1.501,
        "the largest distance is {farthest} m, expected the rope's length of 1.5 m"
    );
}

#[test]
fn locked_axes_hold_and_free_axes_move() {
    let all = [
        LockedAxes::TRANSLATION_X,
        LockedAxes::TRANSLATION_Y,
        LockedAxes::TRANSLATION_Z,
        LockedAxes::ROTATION_X,
        LockedAxes::ROTATION_Y,
        LockedAxes::ROTATION_Z,
    ];
    for bits in 1..64_usize {
        let locks =
            (0..6).filter(|i| bits >> i & 1 == 1).fold(LockedAxes::default(), |locks, i| locks | all[i]);
        let mut world = world();
        let ground = world.add_body(&BodyDef::fixed(Shape::sphere(0.1)).at(Vec3::X * 9.0));
        let body = world.add_body(&BodyDef {
            linear_velocity: Vec3::new(1.0, 2.0, 3.0),
            angular_velocity: Vec3::new(0.3, 0.2, 0.1),
            ..sphere_body(0.2, Vec3::ZERO)
        });
        world.add_joint(&world.axis_locks(ground, body, locks));
        run(&mut world, 60);
        let at = world.transform(body);
        let free = [1.0, 2.0 - 0.5 * G * (1.0 + 1.0 / 240.0), 3.0];
        for (i, way) in at.translation.to_array().into_iter().enumerate() {
            let due = if locks.contains(all[i]) { 0.0 } else { free[i] };
            assert!((way - due).abs() < 5e-3, "{locks:?}, axis {i}: moved {way} m, expected {due} m");
        }
        let turned = at.rotation.to_scaled_axis().to_array();
        let locked = (0..3).filter(|i| locks.contains(all[3 + i])).count();
        for (i, angle) in turned.into_iter().enumerate() {
            let due = if locks.contains(all[3 + i]) { 0.0 } else { [0.3, 0.2, 0.1][i] };
            // Two free axes form a universal joint; small swings rotate each other slightly.
            let within = if locked == 1 { 0.02 } else { 2e-3 };
            assert!(
                (angle - due).abs() < within,
                "{locks:?}, axis {i}: rotated {angle} rad, expected {due} rad"
            );
        }
    }
}

/// Object that counts its substeps.
struct Count(u32);

impl PhysicsObject for Count {
    fn kind(&self) -> &'static str {
        "count"
    }
    fn add_forces(&mut self, _: &mut Forces<'_>) {
        self.0 += 1;
    }
    fn save(&self, w: &mut Writer) {
        w.u32(self.0);
    }
    fn load(&mut self, r: &mut Reader<'_>) -> Result<(), sinew_math::ReadError> {
        self.0 = r.u32()?;
        Ok(())
    }
}

#[test]
fn copied_world_has_the_same_future_and_is_independent() {
    let mut world = world();
    floor(&mut world);
    let ids: Vec<BodyId> = (0..8)
        .map(|i| world.add_body(&box_body(Vec3::splat(0.2), Vec3::Y * (0.3 + 0.41 * i as f32))))
        .collect();
    world.add_mover(&MoverDef::default());
    world.register_kind(|| Box::new(Count(0)));
    let count = world.add_object(Box::new(Count(0)));
    run(&mut world, 50);
    let mut copy = world.clone();
    let (before, marked) = (world.hash(), copy.hash());
    assert_eq!(before, marked);
    run(&mut copy, 50);
    assert_eq!(world.hash(), before, "steps of the copy must not change the world");
    run(&mut world, 50);
    assert_eq!(world.hash(), copy.hash());
    assert_eq!(copy.object::<Count>(count).0, world.object::<Count>(count).0);
    copy.remove_body(ids[7]);
    assert!(world.contains(ids[7]) && !copy.contains(ids[7]));
}

#[test]
#[should_panic(expected = "of a registered kind")]
fn a_copy_needs_the_kinds_of_its_objects() {
    let mut world = world();
    world.add_object(Box::new(Count(0)));
    drop(world.clone());
}

#[test]
fn bodies_moved_are_those_whose_pose_changed() {
    let mut world = world();
    floor(&mut world);
    let mut random = Random::new(3);
    for _ in 0..20 {
        world.add_body(&box_body(Vec3::splat(0.2), random.in_cube() * 2.0 + Vec3::Y * 3.0));
    }
    let lift = world.add_body(&BodyDef::kinematic(Shape::sphere(0.2)).at(Vec3::X * 9.0));
    let still = world.add_body(&BodyDef::kinematic(Shape::sphere(0.2)).at(Vec3::X * 12.0));
    world.set_velocity(lift, Velocity { linear: Vec3::Y, ..Velocity::default() });
    let poses = |world: &World| -> Vec<(BodyId, Transform)> {
        world.body_ids().map(|id| (id, world.transform(id))).collect()
    };
    let (mut most, mut least) = (0, usize::MAX);
    for _ in 0..600 {
        let before = poses(&world);
        world.step();
        let moved: BTreeSet<BodyId> = world.bodies_moved().collect();
        assert_eq!(moved.len(), world.bodies_moved().count(), "each moved body must be listed once");
        let changed = before.iter().filter(|(id, pose)| world.transform(*id) != *pose);
        let missed: Vec<_> = changed.filter(|(id, _)| !moved.contains(id)).collect();
        assert!(missed.is_empty(), "bodies whose pose changed are not listed: {missed:?}");
        assert!(moved.contains(&lift) && !moved.contains(&still));
        (most, least) = (most.max(moved.len()), least.min(moved.len()));
    }
    assert_eq!((most, least), (21, 1), "all bodies must move at first, at last only the lift");
    assert_eq!(reloaded(&world).bodies_moved().count(), 0);
}

#[test]
fn body_handle_is_valid_until_the_body_is_removed() {
    let mut world = world();
    let ball = world.add_body(&BodyDef { user_data: 5, ..sphere_body(0.5, Vec3::Y) });
    let found = world.get(ball).expect("the body is in the world");
    assert_eq!((found.id(), found.kind(), found.user_data()), (ball, BodyKind::Dynamic, 5));
    assert_eq!((found.transform(), found.bounds().max.y), (world.transform(ball), 1.5));
    assert!(format!("{found:?}").starts_with("BodyRef { id: BodyId 0v0, kind: Dynamic"), "{found:?}");
    assert_eq!(world.bodies().map(BodyRef::id).collect::<Vec<_>>(), [ball]);
    world.remove_body(ball);
    assert!(world.get(ball).is_none());
    world.add_body(&sphere_body(0.5, Vec3::Y));
    assert!(world.get(ball).is_none(), "the old handle must not refer to the new body in its slot");
}

#[test]
fn setting_the_velocity_of_a_static_body_has_no_effect() {
    let mut world = world();
    let def = BodyDef { kind: BodyKind::Static, linear_velocity: Vec3::X, ..sphere_body(0.5, Vec3::ZERO) };
    let ground = world.add_body(&def);
    assert_eq!(world.velocity(ground), Velocity::default());
    world.set_velocity(ground, Velocity { linear: Vec3::Z * 9.0, ..Velocity::default() });
    assert_eq!(world.velocity(ground), Velocity::default());
    let ball = world.add_body(&sphere_body(0.2, Vec3::Y * 0.7));
    run(&mut world, 30);
    let slide = world.transform(ball).translation;
    assert!(
        slide.x.abs() < 1e-4 && slide.z.abs() < 1e-4,
        "the static floor must not carry the body along; it moved {slide}"
    );
}
