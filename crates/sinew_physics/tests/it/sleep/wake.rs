//! What wakes a sleeping body, and what does not.

use super::{ENOUGH, Nap, all_asleep, linear, nap, run, slab, steps_to_sleep};
use crate::build::{ball, box_body, joint, sphere_body};
use sinew_math::{Range, Reader, Transform, Vec3, Writer};
use sinew_physics::ray::Ray;
use sinew_physics::*;

/// Checks that `act` wakes a crate that sleeps on a floor, immediately or within the next step.
fn wakes(what: &str, act: impl FnOnce(&mut Nap)) {
    let mut nap = nap();
    act(&mut nap);
    nap.world.step();
    assert!(nap.world.is_awake(nap.sleeper), "{what} must wake the crate");
}

/// Checks that after `act` a crate that sleeps on a floor still sleeps at the same position.
fn leaves_asleep(what: &str, act: impl FnOnce(&mut Nap)) {
    let mut nap = nap();
    let at = nap.world.transform(nap.sleeper);
    act(&mut nap);
    run(&mut nap.world, 30);
    assert!(
        !nap.world.is_awake(nap.sleeper) && nap.world.transform(nap.sleeper) == at,
        "{what} must not wake the crate"
    );
}

#[test]
fn changes_of_a_body_wake_it() {
    let tiny = Vec3::Y * 1e-6;
    wakes("a push", |nap| nap.world.apply_force_at_center(nap.sleeper, tiny));
    wakes("a push at a point", |nap| nap.world.apply_force(nap.sleeper, tiny, Vec3::X));
    wakes("a torque", |nap| nap.world.apply_torque(nap.sleeper, tiny));
    wakes("an impulse", |nap| nap.world.apply_impulse_at_center(nap.sleeper, tiny));
    wakes("an angular impulse", |nap| nap.world.apply_angular_impulse(nap.sleeper, tiny));
    wakes("a bullet", |nap| {
        nap.world.apply_bullet_impact(nap.sleeper, 0.01, Vec3::X, Vec3::Y * 0.2);
    });
    wakes("a velocity", |nap| nap.world.set_velocity(nap.sleeper, Velocity::default()));
    wakes("a position", |nap| nap.world.set_transform(nap.sleeper, nap.world.transform(nap.sleeper)));
    wakes("`wake`", |nap| nap.world.wake(nap.sleeper));
    wakes("an explosion", |nap| nap.world.explode(&Explosion::new(Vec3::X, 2.0, 1.0)));
    leaves_asleep("an explosion far away", |nap| nap.world.explode(&Explosion::new(Vec3::X * 9.0, 2.0, 1.0)));
}

#[test]
fn lasting_forces_wake_when_added_changed_or_removed() {
    let Nap { mut world, sleeper, .. } = nap();
    let def = ForceDef { force: Vec3::Y, ..ForceDef::default() };
    let id = world.add_force(sleeper, &def);
    assert!(world.is_awake(sleeper), "adding a lasting force must wake the body");
    steps_to_sleep(&mut world);
    world.set_force(id, &ForceDef { force: Vec3::X, ..def });
    assert!(world.is_awake(sleeper), "changing a lasting force must wake the body");
    steps_to_sleep(&mut world);
    world.remove_force(id);
    assert!(world.is_awake(sleeper), "removing a lasting force must wake the body");
}

#[test]
fn gravity_wakes_when_it_changes() {
    wakes("less gravity", |nap| nap.world.set_gravity(Vec3::Y * -1.6));
    leaves_asleep("the same gravity", |nap| nap.world.set_gravity(nap.world.def().gravity));
    let gravity = FieldDef::new(FieldKind::Uniform(UniformGravity { acceleration: Vec3::X }));
    wakes("a new field", |nap| {
        nap.world.add_field(&gravity);
    });
    let Nap { mut world, sleeper, .. } = nap();
    let field = world.add_field(&gravity);
    steps_to_sleep(&mut world);
    world.set_field(field, &FieldDef::new(FieldKind::Drag(Drag::default())));
    assert!(world.is_awake(sleeper), "changing a field must wake the body");
    steps_to_sleep(&mut world);
    world.remove_field(field);
    assert!(world.is_awake(sleeper), "removing a field must wake the body");
}

#[test]
fn removing_a_support_wakes_the_bodies_above() {
    wakes("removing the floor", |nap| nap.world.remove_body(nap.floor));
    wakes("moving the floor away", |nap| {
        nap.world.set_transform(nap.floor, Transform::from_translation(Vec3::Y * -5.0));
    });
    wakes("disabling the pair with the floor", |nap| nap.world.disable_pair(nap.sleeper, nap.floor));
    let mut nap = nap();
    nap.world.remove_body(nap.floor);
    run(&mut nap.world, 60);
    let fall = 0.2 - nap.world.center_of_mass(nap.sleeper).y;
    assert!((fall - 0.5 * 9.81 * (1.0 + 1.0 / 240.0)).abs() < 1e-2, "the crate fell by {fall} m");
}

#[test]
fn an_awake_body_wakes_bodies_on_contact() {
    let Nap { mut world, sleeper, .. } = nap();
    let ball = world.add_body(&sphere_body(0.1, Vec3::Y * 1.5));
    let mut woke = None;
    for step in 0..60 {
        world.step();
        if woke.is_none() && world.is_awake(sleeper) {
            woke = Some((step, world.transform(ball).translation.y));
        }
    }
    // A fall of 1 m takes 27.1 steps.
    let (step, height) = woke.expect("the falling body must wake it");
    assert!(
        (25..=28).contains(&step) && (height - 0.5).abs() < 0.1,
        "woke in step {step} at a height of {height} m"
    );
}

#[test]
fn a_moving_kinematic_body_wakes_its_contacts() {
    let mut world = World::new(WorldDef::default());
    let lift = world.add_body(&slab(1.0, Vec3::ZERO));
    let passenger = world.add_body(&box_body(Vec3::splat(0.1), Vec3::Y * 0.15));
    steps_to_sleep(&mut world);
    world.set_velocity(lift, linear(Vec3::Y * -0.5));
    world.step();
    assert!(world.is_awake(passenger), "removing the carrier must wake the passenger");
    run(&mut world, 60);
    let gap = world.center_of_mass(passenger).y - world.center_of_mass(lift).y;
    assert!((gap - 0.15).abs() < 5e-3, "the passenger must ride along; it is {gap} m above");
    world.set_velocity(lift, Velocity::default());
    steps_to_sleep(&mut world);

    let ram = world.add_body(&BodyDef {
        linear_velocity: Vec3::X,
        position: world.center_of_mass(passenger) - Vec3::X * 1.0,
        ..slab(0.2, Vec3::ZERO)
    });
    run(&mut world, 30);
    assert!(!world.is_awake(passenger), "a ram 0.2 m away must not wake the passenger");
    run(&mut world, 20);
    assert!(world.is_awake(passenger) && world.velocity(passenger).linear.x > 0.9);
    let ahead = world.center_of_mass(passenger).x - world.center_of_mass(ram).x;
    assert!(ahead > 0.295, "the body must be pushed along; it is {ahead} m ahead");
}

/// Returns a world with a ball that hangs asleep on a kinematic hook, by a hinge about z.
fn hanging() -> (World, BodyId, BodyId, JointId) {
    let mut world = World::new(WorldDef::default());
    let hook = world.add_body(&slab(0.05, Vec3::ZERO));
    let bob = world.add_body(&sphere_body(0.1, Vec3::Y * -0.5));
    let at = Transform::new(Vec3::ZERO, sinew_math::Rotation::from_axis_angle(Vec3::Y, -1.5707964));
    let joint = joint(&world, hook, bob, at, JointKind::Hinge { limit: None });
    let joint = world.add_joint(&joint);
    steps_to_sleep(&mut world);
    (world, hook, bob, joint)
}

#[test]
fn a_moved_anchor_wakes_jointed_bodies() {
    let (mut world, hook, bob, _) = hanging();
    world.set_velocity(hook, linear(Vec3::X * 0.01));
    world.step();
    assert!(world.is_awake(bob), "an anchor that starts to move must wake the bob");
    let (mut world, hook, bob, _) = hanging();
    world.set_transform(hook, Transform::from_translation(Vec3::X * 0.1));
    assert!(world.is_awake(bob), "moving the anchor must wake the bob");
}

#[test]
fn a_joint_wakes_its_bodies_when_it_changes() {
    type Change = fn(&mut JointDef);
    let changes: [(&str, Change); 5] = [
        ("a limit", |def| def.kind = JointKind::Hinge { limit: Some(Range::new(0.1, 0.5)) }),
        ("a spring", |def| {
            let softness = Softness::Frequency { hertz: 2.0, damping_ratio: 1.0 };
            def.spring = Some(Spring { softness, rest: Transform::IDENTITY });
        }),
        ("friction", |def| def.friction_torque = 1.0),
        ("its state", |def| def.state = JointState::Disabled),
        ("its strength", |def| def.strength = Strength { force: 1.0, ..Strength::UNBREAKABLE }),
    ];
    for (what, change) in changes {
        let (mut world, _, bob, id) = hanging();
        let mut def = world.joint(id);
        change(&mut def);
        world.set_joint(id, &def);
        assert!(world.is_awake(bob), "changing {what} must wake the bob");
    }
    let (mut world, _, bob, id) = hanging();
    world.set_joint_state(id, JointState::Disabled);
    assert!(world.is_awake(bob), "disabling the joint must wake the bob");
    let (mut world, _, bob, id) = hanging();
    world.remove_joint(id);
    assert!(world.is_awake(bob), "removing the joint must wake the bob");
    let (mut world, hook, bob, _) = hanging();
    let second = ball(&world, hook, bob, Vec3::ZERO);
    world.add_joint(&second);
    assert!(world.is_awake(bob), "a new joint must wake the bob");
}

#[test]
fn setting_another_motor_target_wakes_the_body() {
    let (mut world, _, bob, id) = hanging();
    let motor = Motor::spin(0.0, 10.0);
    world.set_motor(id, Some(motor));
    assert!(world.is_awake(bob), "a new motor must wake the bob");
    steps_to_sleep(&mut world);
    world.set_motor(id, Some(motor));
    assert!(!world.is_awake(bob), "setting the same motor again must not wake the bob");
    world.set_motor(id, Some(Motor::spin(1.0, 10.0)));
    assert!(world.is_awake(bob), "another target must wake the bob");
}

#[test]
fn a_broken_joint_wakes_both_bodies() {
    let (mut world, _, bob, id) = hanging();
    let def = JointDef { strength: Strength { force: 1.0, ..Strength::UNBREAKABLE }, ..world.joint(id) };
    world.set_joint(id, &def);
    world.step();
    assert_eq!(world.events().broken, [id]);
    run(&mut world, 30);
    assert!(world.is_awake(bob) && world.center_of_mass(bob).y < -1.5, "the bob must fall");
}

fn wall(x: f32) -> BodyDef {
    BodyDef { kind: BodyKind::Static, ..box_body(Vec3::splat(0.2), Vec3::new(x, 0.2, 0.0)) }
}

#[test]
fn overlapping_bodies_wake_a_body() {
    wakes("a new static body", |nap| {
        nap.world.add_body(&wall(0.35));
    });
    wakes("a static body that is moved to its position", |nap| {
        let id = nap.world.add_body(&wall(5.0));
        nap.world.set_transform(id, Transform::from_translation(Vec3::new(0.35, 0.2, 0.0)));
    });
    wakes("a ghost that becomes solid", |nap| {
        let mut ghost = wall(0.35);
        ghost.shapes[0].rule = ContactRule::Ghost;
        let body = nap.world.add_body(&ghost);
        nap.world.step();
        assert!(!nap.world.is_awake(nap.sleeper) && nap.world.events().begin == [(nap.sleeper, body)]);
        nap.world.set_contact_rule(ShapeId { body, shape: 0 }, ContactRule::Push);
    });
}

#[test]
fn changes_without_effect_wake_nothing() {
    leaves_asleep("a new static body", |nap| {
        nap.world.add_body(&wall(0.4));
    });
    leaves_asleep("a static body that is moved beside it", |nap| {
        let id = nap.world.add_body(&wall(5.0));
        nap.world.set_transform(id, Transform::from_translation(Vec3::new(0.4, 0.2, 0.0)));
    });
    leaves_asleep("a kinematic body that rests against it", |nap| {
        nap.world.add_body(&slab(0.2, Vec3::new(0.4, 0.2, 0.0)));
    });
    leaves_asleep("disabling a pair with another body", |nap| {
        let other = nap.world.add_body(&wall(0.43));
        nap.world.disable_pair(nap.sleeper, other);
    });
    leaves_asleep("a query", |nap| {
        let ray = Ray { origin: Vec3::Y, direction: -Vec3::Y };
        assert!(nap.world.query().any(&ray));
        assert_eq!(nap.world.neighbors(nap.sleeper).collect::<Vec<_>>(), [nap.floor]);
        assert_eq!(nap.world.neighbors(nap.floor).collect::<Vec<_>>(), [nap.sleeper]);
        assert!(nap.world.penetration(nap.sleeper) < 1e-3 && nap.world.energy().kinetic == 0.0);
    });
    leaves_asleep("a snapshot", |nap| {
        let mut bytes = Writer::new();
        nap.world.save(&mut bytes);
        let hash = nap.world.hash();
        nap.world.load(&mut Reader::new(bytes.as_bytes())).expect("the snapshot must load");
        assert_eq!(nap.world.hash(), hash);
    });
    leaves_asleep("a neighbour that falls asleep", |nap| {
        nap.world.add_body(&box_body(Vec3::splat(0.2), Vec3::new(0.43, 0.2, 0.0)));
        run(&mut nap.world, ENOUGH);
        assert!(all_asleep(&nap.world));
    });
    leaves_asleep("a joint between others", |nap| {
        let [a, b] = [3.0, 4.0].map(|x| nap.world.add_body(&box_body(Vec3::splat(0.2), Vec3::X * x)));
        let joint = ball(&nap.world, a, b, Vec3::X * 3.5);
        nap.world.add_joint(&joint);
    });
}
