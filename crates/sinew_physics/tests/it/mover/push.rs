//! Pushes between movers and dynamic bodies.

use super::{depth, level, settle};
use sinew_math::{Reader, Rotation, Transform, Vec3, Writer};
use sinew_physics::*;

fn crate_of(world: &mut World, mass: f32, at: Vec3, friction: f32) -> BodyId {
    let half = 0.4;
    let mut def = BodyDef::dynamic(Shape::Box { half_extents: Vec3::splat(half) }).at(at);
    def.shapes[0].density = mass / (8.0 * half * half * half);
    def.shapes[0].material.friction = friction;
    world.add_body(&def)
}

/// Floor and crate have friction 0.6, so a crate of `m` kg needs `0.6 m g`: 800 N move crates of up to 136 kg.
#[test]
fn push_force_bounds_what_a_mover_moves() {
    for (mass, moves) in [(10.0, true), (60.0, true), (110.0, true), (170.0, false), (1000.0, false)] {
        let mut world = level();
        let crate_ = crate_of(&mut world, mass, Vec3::new(1.5, 0.4, 0.0), 0.6);
        let id = world.add_mover(&MoverDef { step_height: 0.2, ..MoverDef::default() });
        settle(&mut world, id);
        world.set_mover_walk(id, Vec3::X * 2.0);
        for _ in 0..240 {
            world.step();
            assert!(
                depth(&world, id) < 2e-3,
                "a crate of {mass} kg is {} m inside the mover",
                depth(&world, id)
            );
        }
        let at = world.transform(crate_).translation;
        assert_eq!(at.x > 2.0, moves, "a crate of {mass} kg is at {at}");
        assert!(moves || at.x < 1.6, "a crate of {mass} kg is at {at}");
        let behind = at.x - 0.4 - 0.3 - world.mover(id).position().x;
        assert!((-0.002..0.08).contains(&behind), "a crate of {mass} kg: the mover is {behind} m behind it");
    }
}

/// A ball of 200 kg at 5 m/s hits a standing mover of 80 kg: they share the momentum, and the mover is never faster
/// than after an elastic hit.
#[test]
fn a_heavy_ball_pushes_a_mover_by_momentum() {
    for speed in [2.0, 5.0, 15.0, 30.0] {
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        let mut def = BodyDef::dynamic(Shape::Sphere { radius: 0.5 }).at(Vec3::new(-4.0, 0.9, 0.0));
        def.shapes[0].density = 200.0 / (4.0 / 3.0 * core::f32::consts::PI * 0.125);
        def.linear_velocity = Vec3::X * speed;
        let ball = world.add_body(&def);
        let id = world.add_mover(&MoverDef::default());
        let mut fastest = 0.0_f32;
        for _ in 0..(8.0 / (speed * world.def().dt())) as usize {
            world.step();
            let now = world.mover(id).velocity().x;
            fastest = if now > fastest { now } else { fastest };
            assert!(
                depth(&world, id) < 0.01,
                "a ball at {speed} m/s is {} m inside the mover",
                depth(&world, id)
            );
        }
        let after = world.velocity(ball).linear.x;
        let momentum = 200.0 * after + 80.0 * world.mover(id).velocity().x;
        assert!(
            (momentum - 200.0 * speed).abs() < 0.01 * 200.0 * speed,
            "total momentum {momentum} N·s, expected {} N·s",
            200.0 * speed
        );
        let common = 200.0 / 280.0 * speed;
        assert!(
            (fastest - common).abs() < 0.05 * common,
            "{speed} m/s: fastest {fastest}, common speed {common}"
        );
    }
}

#[test]
fn a_light_ball_bounces_off_a_mover() {
    let mut world = level();
    let mut def = BodyDef::dynamic(Shape::Sphere { radius: 0.1 }).at(Vec3::new(-4.0, 1.2, 0.0));
    def.shapes[0].density = 0.4 / (4.0 / 3.0 * core::f32::consts::PI * 0.001);
    def.linear_velocity = Vec3::X * 20.0;
    let ball = world.add_body(&def);
    let id = world.add_mover(&MoverDef::default());
    for _ in 0..120 {
        world.step();
        assert!(world.transform(ball).translation.x < 0.0, "the ball must bounce off the mover");
    }
    assert!(world.mover(id).position().x < 0.05, "{}", world.mover(id).position());
}

#[test]
fn weight_of_a_mover_tips_a_plank() {
    let mut world = level();
    let beam = Shape::Box { half_extents: Vec3::new(0.1, 0.1, 1.0) };
    world.add_body(&BodyDef::fixed(beam).at(Vec3::Y * 0.1));
    let mut def = BodyDef::dynamic(Shape::Box { half_extents: Vec3::new(2.0, 0.05, 0.6) })
        .at(Vec3::new(0.0, 0.26, 0.0));
    def.shapes[0].density = 20.0 / (8.0 * 2.0 * 0.05 * 0.6);
    let plank = world.add_body(&def);
    for _ in 0..120 {
        world.step();
    }
    let id = world.add_mover(&MoverDef::at(Vec3::new(1.2, 0.36, 0.0)));
    for _ in 0..240 {
        world.step();
    }
    let end = world.transform(plank).point(Vec3::new(2.0, 0.0, 0.0)).y;
    assert!(end < 0.1, "the plank's end must tip down; it is at height {end} m");
    assert!(world.mover(id).is_grounded() && depth(&world, id) < 2e-3, "{}", depth(&world, id));
}

#[test]
fn a_load_on_a_movers_head_falls_when_it_walks_away() {
    let mut world = level();
    let id = world.add_mover(&MoverDef { radius: 0.5, ..MoverDef::default() });
    settle(&mut world, id);
    let lid = crate_of(&mut world, 10.0, Vec3::Y * 2.25, 0.6);
    for _ in 0..240 {
        world.step();
        assert!(world.transform(lid).translation.y > 2.1, "{}", world.transform(lid).translation);
    }
    world.set_mover_walk(id, Vec3::X * 4.0);
    for _ in 0..240 {
        world.step();
    }
    assert!(world.transform(lid).translation.y < 0.5, "{}", world.transform(lid).translation);
}

#[test]
fn flying_bodies_below_lets_pass_pass_a_mover() {
    let after = |lets_pass: f32, mass: f32| {
        let mut world = level();
        let id = world.add_mover(&MoverDef { lets_pass, ..MoverDef::default() });
        settle(&mut world, id);
        let shape = Shape::Sphere { radius: 0.1 };
        let mut ball = BodyDef::dynamic(shape.clone()).at(Vec3::new(-2.0, 1.0, 0.0));
        ball.mass = Some(shape.mass_properties(mass / shape.mass_properties(1.0).mass));
        ball.linear_velocity = Vec3::X * 20.0;
        let ball = world.add_body(&ball);
        for _ in 0..8 {
            world.step();
        }
        let mut w = Writer::new();
        world.save(&mut w);
        let mut other = World::new(WorldDef::default());
        other.load(&mut Reader::new(w.as_bytes())).expect("the snapshot must load");
        for _ in 0..10 {
            world.step();
            other.step();
            assert_eq!(world.hash(), other.hash());
        }
        (world.velocity(ball).linear.x, world.mover(id).position().length())
    };
    let (speed, moved) = after(60.0, 0.5);
    assert!(speed == 20.0 && moved < 0.01, "the ball passed at {speed} m/s, the mover moved {moved} m");
    assert!(
        after(0.0, 0.5).0 < 1.0 && after(60.0, 5.0).0 < 19.0,
        "a ball with more momentum than `lets_pass` must be slowed"
    );
}

/// A door of 16 kg at 3 m/s at its centre has less momentum than the mover lets pass; on its hinge it does not pass.
#[test]
fn a_hinged_door_never_passes_a_mover() {
    let swing = |is_hung: bool| {
        let mut world = level();
        let id = world.add_mover(&MoverDef { lets_pass: 60.0, ..MoverDef::default() });
        settle(&mut world, id);
        let post = BodyDef::fixed(Shape::Sphere { radius: 0.02 }).at(Vec3::new(-0.5, 1.1, -0.9));
        let post = world.add_body(&post);
        let leaf = Shape::Box { half_extents: Vec3::new(0.45, 1.0, 0.02) };
        let mut def = BodyDef::dynamic(leaf.clone()).at(Vec3::new(-0.05, 1.1, -0.9));
        def.mass = Some(leaf.mass_properties(16.0 / leaf.mass_properties(1.0).mass));
        (def.linear_velocity, def.angular_velocity) = (Vec3::Z * 3.0, Vec3::NEG_Y * (3.0 / 0.45));
        let door = world.add_body(&def);
        if is_hung {
            let hinge = Transform::from_translation(Vec3::NEG_X * 0.45);
            let upright = Transform::new(Vec3::ZERO, Rotation::from_arc(Vec3::X, Vec3::Y));
            let kind = JointKind::Hinge { limit: None };
            world.add_joint(&JointDef::between(post, door, upright, hinge * upright, kind));
        }
        let (mut deepest, mut farthest) = (0.0, f32::NEG_INFINITY);
        for _ in 0..240 {
            world.step();
            deepest = sinew_math::max(deepest, depth(&world, id));
            farthest = sinew_math::max(farthest, world.transform(door).translation.z);
        }
        (deepest, farthest, world.mover(id).position().z)
    };
    let (deepest, farthest, moved) = swing(true);
    assert!(deepest < 0.005, "the door leaf is {deepest} m inside the mover");
    // Without the mover, the centre of the door would swing to -0.45 m.
    assert!((-0.85..-0.46).contains(&farthest), "the door leaf reaches {farthest} m");
    assert!(moved > 0.01, "the leaf must push the mover; it moved {moved} m");
    let (deepest, ..) = swing(false);
    assert!(deepest > 0.05, "a released leaf must enter the mover; depth {deepest} m");
}

#[test]
fn the_work_of_a_push_is_reported() {
    let mut world = level();
    let id = world.add_mover(&MoverDef::at(Vec3::X * -1.2));
    let load = crate_of(&mut world, 30.0, Vec3::Y * 0.4, 0.6);
    settle(&mut world, id);
    world.set_mover_walk(id, Vec3::X * 1.5);
    let mut work = 0.0;
    for _ in 0..180 {
        world.step();
        work += world.work().movers;
    }
    let (way, speed) = (world.transform(load).translation.x, world.velocity(load).linear.length());
    let expected = 30.0 * (0.6 * 9.81 * way + 0.5 * speed * speed);
    assert!(
        way > 1.0 && (work / expected - 1.0).abs() < 0.05,
        "work {work} J over {way} m, expected {expected} J"
    );
}

/// The energy of a seesaw rises by the work of the mover's weight.
#[test]
fn the_work_of_a_movers_weight_is_reported() {
    let mut world = World::new(WorldDef::default());
    let post = world.add_body(&BodyDef::fixed(Shape::Sphere { radius: 0.05 }).at(Vec3::new(-2.0, 0.0, 0.0)));
    let half_extents = Vec3::new(0.5, 0.05, 0.5);
    let mut def = BodyDef::dynamic(Shape::Box { half_extents }).at(Vec3::Y * 1.95);
    def.shapes[0].density = 200.0 / (8.0 * 0.5 * 0.05 * 0.5);
    let board = world.add_body(&def);
    let hinge = world.hinge(post, board, Vec3::Y * 1.95, Vec3::Z);
    world.add_joint(&hinge);
    world.add_mover(&MoverDef::at(Vec3::new(0.3, 2.01, 0.0)));
    let start = world.energy();
    let (mut work, mut rise) = (0.0, 0.0);
    for step in 1..=20 {
        world.step();
        work += world.work().movers;
        let now = world.energy();
        rise = now.kinetic - start.kinetic + now.potential - start.potential;
        // A substep moves bodies at the speed that they have at its end.
        let late = 0.3 * work / step as f32;
        assert!(
            rise < work + 0.1 && work < rise + late + 0.1,
            "step {step}: the energy rose by {rise} J, work {work} J"
        );
    }
    assert!(rise > 20.0, "the seesaw must tip; its energy rose by {rise} J");
}
