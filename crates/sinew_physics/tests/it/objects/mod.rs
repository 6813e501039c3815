//! Objects of the user: when they are called, which effects they can have, and that they change nothing else.

mod kinds;
mod state;

pub use state::inhabited;

use crate::build::{ball, box_body, capsule_body, floor, sphere_body};
use kinds::{Bump, Counter, Leash, Once, OnceMoved, Spring, Thrust};
use sinew_math::{Transform, Vec3, max};
use sinew_physics::particles::{GroupDef, ParticleDef, RopeDef};
use sinew_physics::*;

fn weightless() -> World {
    World::new(WorldDef { gravity: Vec3::ZERO, sleeping: Sleeping::Off, ..WorldDef::default() })
}

/// Returns a world with loose boxes on the floor, a chain, and a rope.
pub fn mixed() -> World {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    for i in 0..8 {
        let side = 0.03 * i as f32;
        world.add_body(&box_body(Vec3::splat(0.15), Vec3::new(side, 0.2 + 0.35 * i as f32, -side)));
    }
    let hook = BodyDef { kind: BodyKind::Static, position: Vec3::new(2.0, 2.0, 0.0), ..BodyDef::default() };
    let mut last = world.add_body(&hook);
    for i in 0..5 {
        let at = Vec3::new(2.0, 2.0, 0.15 + 0.3 * i as f32);
        let link = world.add_body(&capsule_body(0.1, 0.03, at));
        world.add_joint(&ball(&world, last, link, at - Vec3::Z * 0.15));
        last = link;
    }
    let (from, to) = (Vec3::new(-2.0, 1.0, 0.0), Vec3::new(-1.0, 1.0, 0.0));
    world.add_particles(
        &RopeDef { from, to, links: 10, mass: 0.2, stiffness: 1e3, radius: 0.02 }.build().group,
    );
    world
}

fn poses(world: &World) -> Vec<Transform> {
    world.body_ids().map(|id| world.transform(id)).collect()
}

fn particles(world: &World) -> Vec<Vec3> {
    world.group_ids().flat_map(|id| world.particles(id).positions()).copied().collect()
}

/// Runs one step with an object that acts once, and removes the object.
fn act_once(world: &mut World, act: impl FnOnce(&mut Forces<'_>) + Send + Sync + 'static) {
    let id = world.add_object(Box::new(Once { act: Some(act) }));
    world.step();
    world.remove_object(id);
}

/// Runs one step with an object that acts once after all bodies have moved, and removes the object.
fn act_once_moved(world: &mut World, act: impl FnOnce(&mut Corrections<'_>) + Send + Sync + 'static) {
    let id = world.add_object(Box::new(OnceMoved { act: Some(act) }));
    world.step();
    world.remove_object(id);
}

#[test]
fn objects_without_effect_change_nothing() {
    let (mut with, mut without) = (mixed(), mixed());
    let counter = with.add_object(Box::new(Counter::default()));
    for step in 1..=240 {
        with.step();
        without.step();
        assert!(poses(&with) == poses(&without) && particles(&with) == particles(&without), "step {step}");
    }
    assert_eq!(
        with.object::<Counter>(counter).asked,
        240 * 4 * 2,
        "the object must be called twice in each substep"
    );
}

#[test]
fn force_of_an_object_acts_in_each_substep() {
    let mut world = weightless();
    let body = world.add_body(&sphere_body(0.1, Vec3::X));
    let mass = world.mass(body).mass;
    let stiffness = 40.0 * mass;
    world.add_object(Box::new(Spring { body, place: Vec3::ZERO, stiffness }));
    // x'' = −ω² x by symplectic Euler: x_n = cos((n + ½) θ) / cos(θ/2) with 2 sin(θ/2) = ω h.
    let h = f64::from(world.def().dt()) / 4.0;
    let theta = 2.0 * (0.5 * 40f64.sqrt() * h).asin();
    for step in 1..=300u32 {
        world.step();
        let expected = ((f64::from(step * 4) + 0.5) * theta).cos() / (0.5 * theta).cos();
        let x = f64::from(world.transform(body).translation.x);
        assert!((x - expected).abs() < 2e-4, "step {step}: {x}, expected {expected}");
    }
}

/// The force of an object adds once to the world's own forces: gravity as a field, and a lasting force.
#[test]
fn an_objects_force_adds_to_fields_and_lasting_forces() {
    let mut world = weightless();
    let body = world.add_body(&sphere_body(0.1, Vec3::ZERO));
    let weight = world.mass(body).mass * 9.81;
    let gravity = UniformGravity { acceleration: Vec3::NEG_Y * 9.81 };
    world.add_field(&FieldDef::new(FieldKind::Uniform(gravity)));
    world.add_force(body, &ForceDef { force: Vec3::X * weight, ..ForceDef::default() });
    world.add_object(Box::new(Thrust { body, force: Vec3::new(-weight, weight, 0.0) }));
    world.add_object(Box::new(Thrust { body, force: Vec3::Z * weight }));
    for _ in 0..60 {
        world.step();
    }
    let time = world.time() as f32;
    let moved = world.velocity(body).linear - Vec3::Z * (9.81 * time);
    assert!(moved.length() < 1e-4, "the forces must cancel; the body moved by {moved}");
}

#[test]
fn forces_and_impulses_match_newtons_laws() {
    let mut world = weightless();
    let body = world.add_body(&box_body(Vec3::new(0.1, 0.2, 0.3), Vec3::ZERO));
    let (mass, h) = (world.mass(body).mass, world.def().dt() / 4.0);
    act_once(&mut world, move |forces| {
        forces.apply_force_at_center(body, Vec3::new(30.0, 0.0, 0.0));
        forces.apply_impulse(body, Vec3::new(0.0, 2.0, 0.0), Vec3::ZERO);
        forces.apply_torque(body, Vec3::new(0.0, 0.0, 5.0));
    });
    // The force acts in one of the four substeps.
    let Velocity { linear, angular } = world.velocity(body);
    assert!((linear - Vec3::new(30.0 * h, 2.0, 0.0) / mass).length() < 1e-6, "linear velocity {linear}");
    let moment = mass / 3.0 * (0.01 + 0.04);
    assert!((angular - Vec3::Z * (5.0 * h / moment)).length() < 1e-6, "angular velocity {angular}");
    // Away from the centre the impulse also rotates the body: p × with an arm of 0.3 m.
    act_once_moved(&mut world, move |corrections| {
        let point = corrections.center_of_mass(body) + Vec3::Z * 0.3;
        corrections.apply_impulse(body, Vec3::X, point);
    });
    let gained = world.velocity(body).angular.y - angular.y;
    assert!(
        (gained - 0.3 / (mass / 3.0 * (0.01 + 0.09))).abs() < 1e-3,
        "the impulse added a spin of {gained} rad/s"
    );
}

#[test]
fn objects_see_poses_of_the_current_substep() {
    let mut world = weightless();
    let mut def = sphere_body(0.1, Vec3::ZERO);
    def.linear_velocity = Vec3::X;
    let thrown = world.add_body(&def);
    let carried = world.add_body(&BodyDef { kind: BodyKind::Kinematic, position: Vec3::Y, ..def });
    let h = world.def().dt() / 4.0;
    world.step();
    act_once(&mut world, move |forces| {
        assert!((forces.center_of_mass(thrown).x - 4.0 * h).abs() < 1e-6);
        assert!((forces.time() - f64::from(4.0 * h)).abs() < 1e-8);
    });
    act_once_moved(&mut world, move |corrections| {
        for id in [thrown, carried] {
            assert!((corrections.transform(id).translation.x - 9.0 * h).abs() < 1e-6);
            assert_eq!(corrections.velocity(id).linear, Vec3::X);
        }
        assert!((corrections.time() - f64::from(9.0 * h)).abs() < 1e-8);
        assert_eq!(corrections.body_ids().collect::<Vec<_>>(), [thrown, carried]);
    });
}

#[test]
fn body_on_a_leash_swings_like_a_pendulum() {
    let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
    let amplitude = 0.2f32;
    let (sin, cos) = (sinew_math::trig::sin(amplitude), sinew_math::trig::cos(amplitude));
    let body = world.add_body(&sphere_body(0.05, Vec3::new(sin, -cos, 0.0)));
    world.add_object(Box::new(Leash { body, place: Vec3::ZERO, length: 1.0 }));
    let (mut before, mut passes, mut error) = (sin, Vec::new(), 0.0);
    for _ in 0..1200 {
        world.step();
        let at = world.center_of_mass(body);
        error = max(error, (at.length() - 1.0).abs());
        if before > 0.0 && at.x <= 0.0 {
            passes.push(world.time() as f32 - at.x / (at.x - before) * world.def().dt());
        }
        before = at.x;
    }
    assert!(error < 1e-5, "the length is off by {error} m");
    let period = (passes[passes.len() - 1] - passes[0]) / (passes.len() - 1) as f32;
    // Period of a point mass on a thread: 2π √(l/g) (1 + θ²/16).
    let expected = core::f32::consts::TAU * (1.0f32 / 9.81).sqrt() * (1.0 + amplitude * amplitude / 16.0);
    assert!((period / expected - 1.0).abs() < 1e-3, "period {period} s, expected {expected} s");
}

#[test]
fn corrections_act_through_joints() {
    let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
    let hook = world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() });
    let (mut last, mut joints) = (hook, Vec::new());
    for i in 0..6 {
        let at = Vec3::X * (0.1 + 0.2 * i as f32);
        let link = world.add_body(&capsule_body(0.05, 0.02, at));
        joints.push(world.add_joint(&ball(&world, last, link, at - Vec3::X * 0.1)));
        last = link;
    }
    // The centre of the last link, 1.1 m from the hook, also hangs on a thread of 0.2 m.
    let (place, length) = (Vec3::new(1.1, 0.2, 0.0), 0.2);
    world.add_object(Box::new(Leash { body: last, place, length }));
    let (mut off, mut gap) = (0.0, 0.0);
    for _ in 0..300 {
        world.step();
        off = max(off, ((world.center_of_mass(last) - place).length() - length).abs());
        gap = joints.iter().fold(gap, |gap, &joint| max(gap, world.joint_gap(joint)));
    }
    assert!(off < 1e-3 && gap < 1e-3, "the tether is off by {off} m, the joints by {gap} m");
}

#[test]
fn responses_include_joints() {
    let mut world = weightless();
    let hook = world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() });
    let rod = world.add_body(&box_body(Vec3::new(0.5, 0.05, 0.05), Vec3::X * 0.5));
    let free = world.add_body(&sphere_body(0.1, Vec3::Y * 3.0));
    world.add_joint(&ball(&world, hook, rod, Vec3::ZERO));
    let mass = |id| world.mass(id).mass;
    let (rod_mass, free_mass) = (mass(rod), mass(free));
    act_once(&mut world, move |forces| {
        assert_eq!(forces.response(hook, Vec3::ZERO, Vec3::Y), 0.0);
        let of_free = forces.response(free, Vec3::Y * 3.0, Vec3::Y);
        assert!((of_free * free_mass - 1.0).abs() < 1e-5);
        // At the end of the rod, about the hook: l²/I; along the rod nearly 0.
        let moment = rod_mass / 3.0 * (0.25 + 0.0025) + rod_mass * 0.25;
        let across = forces.response(rod, Vec3::X, Vec3::Y);
        assert!((across * moment - 1.0).abs() < 1e-3, "{across} for {}", 1.0 / moment);
        assert!(forces.response(rod, Vec3::X, Vec3::X).abs() < 1e-3 / rod_mass);
    });
}

#[test]
fn particles_rest_on_a_users_obstacle() {
    let mut world = World::new(WorldDef::default());
    let at = |i: usize| Vec3::new(0.01 * (i as f32 - 4.0), 0.8 + 0.1 * i as f32, 0.0);
    let particle = |i| ParticleDef { position: at(i), velocity: Vec3::ZERO, mass: 0.01, radius: 0.02 };
    let group =
        world.add_particles(&GroupDef { particles: (0..9).map(particle).collect(), ..GroupDef::default() });
    world.add_object(Box::new(Bump { center: Vec3::ZERO, radius: 0.5, group }));
    let mut nearest = f32::INFINITY;
    for _ in 0..90 {
        world.step();
        for at in world.particles(group).positions() {
            nearest = sinew_math::min(nearest, at.length());
        }
    }
    assert!(nearest > 0.52 - 1e-5, "no particle may be inside; nearest {nearest} m");
    // The middle particle rests on top, the others slide down.
    let middle = world.particles(group).positions()[4];
    assert!((middle - Vec3::Y * 0.52).length() < 1e-3, "the middle particle is at {middle}");
}

#[test]
fn objects_wake_a_body_only_by_a_push() {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let body = world.add_body(&box_body(Vec3::splat(0.2), Vec3::Y * 0.2));
    let asleep = |world: &mut World| {
        for _ in 0..120 {
            world.step();
        }
        assert!(!world.is_awake(body));
        world.transform(body)
    };
    let rest = asleep(&mut world);
    act_once(&mut world, move |forces| {
        assert_eq!(forces.velocity(body), Velocity::default());
        forces.apply_force_at_center(body, Vec3::ZERO);
        forces.apply_impulse(body, Vec3::ZERO, Vec3::ONE);
    });
    assert!(!world.is_awake(body), "an object that applies nothing must not wake the body");
    act_once(&mut world, move |forces| forces.apply_force_at_center(body, Vec3::X));
    assert!(world.is_awake(body) && world.transform(body) == rest);
    assert_eq!(world.velocity(body), Velocity::default(), "a force must act from the next step on");
    asleep(&mut world);
    let mass = world.mass(body).mass;
    act_once(&mut world, move |forces| forces.apply_impulse(body, Vec3::Y * mass, rest.translation));
    assert!(world.is_awake(body));
    assert!(
        (world.velocity(body).linear - Vec3::Y).length() < 1e-5,
        "the sleeping body must keep the impulse"
    );
    asleep(&mut world);
    act_once_moved(&mut world, move |corrections| {
        corrections.correct(body, Vec3::Y * mass, rest.translation);
    });
    assert!(world.is_awake(body));
}

#[test]
fn objects_cannot_apply_nonfinite_numbers() {
    let (mut world, body) = one_body();
    let group = world.add_particles(&GroupDef {
        particles: vec![ParticleDef { position: Vec3::Y, velocity: Vec3::ZERO, mass: 1.0, radius: 0.1 }],
        ..GroupDef::default()
    });
    type Push = fn(&mut Forces<'_>, BodyId, Vec3);
    type Correct = fn(&mut Corrections<'_>, BodyId, GroupId, Vec3);
    let pushes: [Push; 7] = [
        |forces, id, bad| forces.apply_force(id, bad, Vec3::ZERO),
        |forces, id, bad| forces.apply_force(id, Vec3::X, bad),
        |forces, id, bad| forces.apply_force_at_center(id, bad),
        |forces, id, bad| forces.apply_torque(id, bad),
        |forces, id, bad| forces.apply_impulse(id, bad, Vec3::ZERO),
        |forces, id, bad| forces.apply_impulse(id, Vec3::X, bad),
        |forces, id, bad| {
            forces.response(id, bad, Vec3::X);
        },
    ];
    let corrections: [Correct; 4] = [
        |corrections, id, _, bad| corrections.apply_impulse(id, bad, Vec3::ZERO),
        |corrections, id, _, bad| corrections.correct(id, bad, Vec3::ZERO),
        |corrections, id, _, bad| corrections.correct(id, Vec3::X, bad),
        |corrections, _, group, bad| corrections.move_particle(group, 0, bad),
    ];
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY].map(|x| Vec3::new(0.0, x, 0.0)) {
        for (i, push) in pushes.into_iter().enumerate() {
            act_once(&mut world, move |forces| assert!(panics(|| push(forces, body, bad)), "push {i}"));
        }
        for (i, correct) in corrections.into_iter().enumerate() {
            act_once_moved(&mut world, move |it| {
                assert!(panics(|| correct(it, body, group, bad)), "correction {i}");
            });
        }
    }
    assert!(world.transform(body).is_finite() && world.particles(group).positions()[0].is_finite());
}

fn one_body() -> (World, BodyId) {
    let mut world = weightless();
    let body = world.add_body(&sphere_body(0.1, Vec3::ZERO));
    (world, body)
}

fn panics(act: impl FnOnce()) -> bool {
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(act)).is_err()
}
