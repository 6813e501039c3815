//! Drives of a ragdoll, compared with closed forms, balances of force, momentum and energy, and results at other step
//! rates.

use crate::actor::{floor, shared, walker};
use crate::in_world::{level, run};
use sinew_math::{Random, Reader, Rotation, Sym3, Transform, Vec3, Writer, max};
use sinew_physics::{BodyDef, JointKind, MassProperties, Shape, Sleeping, Velocity, World, WorldDef};
use sinew_ragdoll::hand_over::{SpeedBound, body_velocity};
use sinew_ragdoll::{
    BodySettings, BodyState, Character, DriveMode, Drives, FallQuality, Muscle, Part, Pin, Preset,
    QualityMeter, Ragdoll, RagdollBodyDef, RagdollDef, RagdollJointDef,
};

const G: f32 = 9.81;

fn body(role: &str, at: Vec3, mass: f32) -> RagdollBodyDef {
    let inertia = Sym3::from_diagonal(Vec3::splat(0.02 * mass));
    RagdollBodyDef {
        bone: role.to_owned(),
        joint: 0,
        merged: Vec::new(),
        role: role.to_owned(),
        confidence: 1.0,
        shape: Shape::Sphere { radius: 0.05 },
        character_from_body: Transform::from_translation(at),
        mass: MassProperties { mass, center: Vec3::ZERO, inertia },
    }
}

/// Returns a heavy body, and an arm of 2 kg whose centre is 0.3 m from its hinge about z. Moment of inertia about the
/// hinge: 0.22 kg m².
fn arm() -> RagdollDef {
    let axis = Rotation::from_arc(Vec3::X, Vec3::Z);
    RagdollDef {
        bodies: vec![body("hips", Vec3::ZERO, 50.0), body("leftUpperArm", Vec3::X * 0.4, 2.0)],
        joints: vec![RagdollJointDef {
            parent: 0,
            child: 1,
            frame_parent: Transform::new(Vec3::X * 0.1, axis),
            frame_child: Transform::new(Vec3::X * -0.3, axis),
            kind: JointKind::Hinge { limit: None },
            friction_torque: 0.0,
        }],
        total_mass: 52.0,
        height: 1.75,
        ..RagdollDef::default()
    }
}

const ARM_MOMENT: f32 = 2.0 * 0.02 + 2.0 * 0.09;

/// A ragdoll at rest in its bind pose at `at`, with drives.
struct Driven {
    world: World,
    def: RagdollDef,
    ragdoll: Ragdoll,
    drives: Drives,
    targets: Vec<Transform>,
}

impl Driven {
    fn new(def: RagdollDef, at: Transform, rate: u64) -> Self {
        let step_nanoseconds = 1_000_000_000 / rate;
        let mut world =
            World::new(WorldDef { sleeping: Sleeping::Off, step_nanoseconds, ..WorldDef::default() });
        let targets: Vec<Transform> = def.bodies.iter().map(|body| at * body.character_from_body).collect();
        let states: Vec<BodyState> = targets
            .iter()
            .map(|&world_from_body| BodyState { world_from_body, velocity: Velocity::default() })
            .collect();
        let ragdoll = Ragdoll::spawn(&mut world, &def, &states, &BodySettings::default());
        let drives = Drives::new(&def);
        Self { world, def, ragdoll, drives, targets }
    }

    /// Returns the mannequin, one metre above the ground.
    fn mannequin() -> Self {
        Self::new(walker().ragdoll, Transform::from_translation(Vec3::Y), 60)
    }

    fn step(&mut self) {
        let still = vec![Velocity::default(); self.targets.len()];
        self.step_at(&still);
    }

    fn step_at(&mut self, velocities: &[Velocity]) {
        self.drives.apply(&mut self.world, &self.def, &self.ragdoll, &self.targets, velocities);
        self.world.step();
    }

    fn run(&mut self, seconds: f32) {
        for _ in 0..(seconds / self.world.def().dt()).round() as usize {
            self.step();
        }
    }

    /// Returns the angle of the arm's hinge, radians.
    fn bend(&self) -> f32 {
        let seen = self.world.joint_transform(self.ragdoll.joints[0]).rotation;
        sinew_math::limits::hinge_angle(seen)
    }

    fn weight(&self) -> f32 {
        self.def.bodies.iter().map(|body| body.mass.mass).sum::<f32>() * G
    }

    fn index(&self, role: &str) -> usize {
        self.def.bodies.iter().position(|body| body.role == role).expect("the mannequin has the part")
    }
}

fn powered(hertz: f32) -> DriveMode {
    DriveMode::Powered(Muscle { hertz, ..Muscle::ALIVE })
}

fn omega2(hertz: f32) -> f32 {
    (core::f32::consts::TAU * hertz) * (core::f32::consts::TAU * hertz)
}

#[test]
fn powered_arm_sags_by_moment_over_stiffness() {
    for hertz in [2.0, 5.0, 20.0] {
        let mut driven = Driven::new(arm(), Transform::IDENTITY, 60);
        driven.drives.set(0, DriveMode::Keyed, 0.0);
        driven.drives.set(1, powered(hertz), 0.0);
        driven.run(5.0);
        let sag = -driven.bend();
        let expected = 2.0 * G * 0.3 * sinew_math::trig::cos(sag) / (ARM_MOMENT * omega2(hertz));
        assert!((sag - expected).abs() < 0.02 * expected, "{hertz} Hz: sag {sag}, expected {expected}");
    }
}

#[test]
fn motor_torque_stays_below_its_cap() {
    let mut driven = Driven::new(arm(), Transform::IDENTITY, 60);
    let cap = sinew_ragdoll::torque_caps(&driven.def)[1];
    let scaled = 100.0 * 52.0 / 75.0;
    assert!(
        (cap - scaled).abs() < 0.01 * scaled,
        "largest torque {cap} N·m at a shoulder that carries 52 kg"
    );
    driven.drives.set(0, DriveMode::Keyed, 0.0);
    // The arm needs 5.9 N m to be held; a twentieth of its strength is less.
    let weak = Muscle { strength: 0.05, ..Muscle::STIFF };
    driven.drives.set(1, DriveMode::Powered(weak), 0.0);
    let mut hardest = 0.0;
    for _ in 0..120 {
        driven.step();
        hardest = max(hardest, driven.world.reaction(driven.ragdoll.joints[0]).torque.length());
    }
    assert!(hardest < 0.05 * cap * 1.001 && hardest > 0.049 * cap, "{hardest} N m of {}", 0.05 * cap);
    assert!(driven.bend() < -0.2, "a weak arm sinks");
    driven.drives.set(1, DriveMode::Powered(Muscle::STIFF), 0.0);
    driven.run(2.0);
    assert!(driven.bend().abs() < 0.02, "with full strength the arm must rise: {}", driven.bend());
}

#[test]
fn pins_carry_and_report_the_weight() {
    for (hertz, damping_ratio) in [(3.0, 1.0), (20.0, 1.0), (20.0, 2.0)] {
        let mut driven = Driven::mannequin();
        let pin = Pin { hertz, damping_ratio, ..Pin::FIRM };
        driven.drives.set_all(DriveMode::Pinned(Muscle::ALIVE, pin), 0.0);
        driven.run(4.0);
        let sag = G / omega2(hertz);
        for (body, target) in driven.targets.iter().enumerate() {
            let id = driven.ragdoll.bodies[body];
            let center = driven.def.bodies[body].mass.center;
            let sunk = target.point(center) - driven.world.center_of_mass(id);
            assert!(
                (sunk - Vec3::Y * sag).length() < 0.02 * sag + 2e-5,
                "{hertz} Hz, body {body}: sunk by {sunk}"
            );
        }
        let carried: Vec3 =
            (0..driven.targets.len()).map(|b| driven.drives.pin_force(&driven.world, b).force).sum();
        let weight = driven.weight();
        assert!(
            (carried - Vec3::Y * weight).length() < 0.01 * weight,
            "the pins carry {carried} N of a weight of {weight} N"
        );
        assert!((driven.drives.pin_effort(&driven.world).0 - weight).abs() < 0.01 * weight);
    }
}

#[test]
fn pelvis_pin_carries_the_whole_weight() {
    let mut driven = Driven::mannequin();
    driven.drives.set_all(DriveMode::Powered(Muscle::STIFF), 0.0);
    driven.drives.set(0, DriveMode::Pinned(Muscle::STIFF, Pin { hertz: 8.0, ..Pin::FIRM }), 0.0);
    driven.run(6.0);
    let force = driven.drives.pin_force(&driven.world, 0).force;
    let weight = driven.weight();
    assert!((force - Vec3::Y * weight).length() < 0.01 * weight, "{force} N of {weight}");
    let center = driven.def.bodies[0].mass.center;
    let sunk = driven.targets[0].point(center).y - driven.world.center_of_mass(driven.ragdoll.bodies[0]).y;
    let expected = G / omega2(8.0);
    assert!((sunk - expected).abs() < 0.05 * expected, "sunk by {sunk}, expected {expected}");
}

#[test]
fn keyed_bodies_follow_exactly_and_carry_the_others() {
    let mut driven = Driven::mannequin();
    driven.drives.set(0, DriveMode::Keyed, 0.0);
    driven.drives.set_from(&driven.def.clone(), driven.index("leftUpperArm"), DriveMode::Keyed, 0.0);
    let starts = driven.targets.clone();
    for step in 1..=120 {
        let time = step as f32 / 60.0;
        let turn = Rotation::from_axis_angle(Vec3::Y, 0.8 * time);
        let along = Transform::new(Vec3::new(0.3 * time, 0.1 * time, 0.0), turn);
        for (target, start) in driven.targets.iter_mut().zip(&starts) {
            *target = along * *start;
        }
        driven.step();
        for (body, target) in driven.targets.iter().enumerate() {
            let is = driven.world.transform(driven.ragdoll.bodies[body]);
            if driven.drives.mode(body) == DriveMode::Keyed {
                assert!((is.translation - target.translation).length() < 2e-6, "body {body}");
                assert!(is.rotation.angle_to(target.rotation) < 1e-3, "body {body}");
            }
        }
        for &joint in &driven.ragdoll.joints {
            assert!(driven.world.joint_gap(joint) < 1e-4, "{}", driven.world.joint_gap(joint));
        }
    }
    // A released body keeps the velocity of its keyed motion.
    let led = driven.world.velocity(driven.ragdoll.bodies[0]).linear;
    assert!((led.y - 0.1).abs() < 1e-3, "{led}");
    driven.drives.set_all(DriveMode::Limp, 0.0);
    driven.step();
    let free = driven.world.velocity(driven.ragdoll.bodies[0]).linear;
    assert!((free - led).length() < 1.0, "{free} after {led}");
}

#[test]
fn keyed_hand_pushes_a_ball() {
    let mut driven = Driven::new(arm(), Transform::IDENTITY, 60);
    driven.drives.set_all(DriveMode::Keyed, 0.0);
    let ball = BodyDef { gravity_scale: 0.0, ..BodyDef::dynamic(Shape::Sphere { radius: 0.1 }) };
    let ball = driven.world.add_body(&ball.at(Vec3::new(0.7, 0.0, 0.0)));
    for step in 1..=60 {
        for (target, body) in driven.targets.iter_mut().zip(&driven.def.bodies) {
            *target = Transform::from_translation(Vec3::X * (step as f32 / 60.0)) * body.character_from_body;
        }
        driven.step();
    }
    assert!(driven.world.center_of_mass(ball).x > 1.5, "{}", driven.world.center_of_mass(ball));
    let hand = driven.world.transform(driven.ragdoll.bodies[1]).translation;
    assert!((hand - Vec3::X * 1.4).length() < 1e-5, "{hand}");
}

#[test]
fn drive_blending_is_independent_of_the_rate() {
    let end = |rate: u64| {
        let mut driven = Driven::new(arm(), Transform::IDENTITY, rate);
        driven.drives.set(0, DriveMode::Keyed, 0.0);
        driven.drives.set(1, powered(6.0), 0.0);
        driven.run(1.0);
        driven.drives.set(1, DriveMode::Limp, 0.3);
        driven.run(0.9);
        let falling = driven.bend();
        driven.drives.set(1, powered(6.0), 0.2);
        driven.run(0.4);
        (falling, driven.bend())
    };
    let [slow, middle, fast] = [30, 60, 120].map(end);
    assert!(fast.0 < -0.05 && fast.1 > fast.0, "the character must fall and get up: {fast:?}");
    for other in [slow, middle] {
        assert!((other.0 - fast.0).abs() < 0.05 * fast.0.abs(), "other events {other:?}, expected {fast:?}");
        assert!((other.1 - fast.1).abs() < 0.05 * fast.0.abs(), "other events {other:?}, expected {fast:?}");
    }
}

#[test]
fn drives_add_no_energy_beyond_their_work() {
    for mode in
        [DriveMode::Powered(Muscle::STIFF), DriveMode::Pinned(Muscle::ALIVE, Pin::FIRM), DriveMode::Keyed]
    {
        let mut driven = Driven::mannequin();
        driven.world.add_body(&floor());
        driven.drives.set_all(powered(4.0), 0.0);
        driven.drives.set_from(&driven.def.clone(), driven.index("leftUpperArm"), mode, 0.1);
        driven.drives.set(0, mode, 0.1);
        let mut meter = QualityMeter::new(&driven.def, 2.0);
        let starts = driven.targets.clone();
        for step in 1..=120 {
            let time = step as f32 / 60.0;
            let sway =
                Transform::from_translation(Vec3::new(0.2, 0.1, 0.1) * sinew_math::trig::sin(3.0 * time));
            for (target, start) in driven.targets.iter_mut().zip(&starts) {
                *target = sway * *start;
            }
            let velocity = Velocity {
                linear: Vec3::new(0.6, 0.3, 0.3) * sinew_math::trig::cos(3.0 * time),
                ..Velocity::default()
            };
            let velocities = vec![velocity; starts.len()];
            driven.drives.apply(
                &mut driven.world,
                &driven.def,
                &driven.ragdoll,
                &driven.targets,
                &velocities,
            );
            meter.before_step(&driven.world);
            driven.world.step();
            meter.after_step(&driven.world, &driven.ragdoll);
        }
        let quality = meter.quality();
        assert!(quality.energy_gain_max < 0.01, "{mode:?}: {}", quality.energy_gain_max);
        assert!(quality.nan == 0 && quality.joint_gap_max_m < 1e-3, "{mode:?}: {}", quality.joint_gap_max_m);
        assert!(quality.work_in_j != 0.0);
    }
}

#[test]
fn hit_arm_yields_and_returns_while_the_rest_stays() {
    let farthest = |impulse: f32| {
        let mut driven = Driven::mannequin();
        driven.drives.set_all(DriveMode::Pinned(Muscle::ALIVE, Pin { hertz: 8.0, ..Pin::FIRM }), 0.0);
        driven.run(1.0);
        let arm = driven.index("leftLowerArm");
        let [leg, hand] = ["rightUpperLeg", "leftHand"].map(|role| driven.index(role));
        let place = |driven: &Driven, body: usize| driven.world.center_of_mass(driven.ragdoll.bodies[body]);
        let rest: Vec<Vec3> = (0..driven.targets.len()).map(|body| place(&driven, body)).collect();
        driven.drives.hit(&driven.def, arm, impulse);
        driven.world.apply_impulse_at_center(driven.ragdoll.bodies[arm], Vec3::NEG_Z * 30.0);
        let (mut far, mut leg_far) = (0.0, 0.0);
        for _ in 0..120 {
            driven.step();
            far = max(far, (place(&driven, arm) - rest[arm]).length());
            leg_far = max(leg_far, (place(&driven, leg) - rest[leg]).length());
        }
        assert!(
            (place(&driven, hand) - rest[hand]).length() < 2e-3,
            "the character must return within two seconds"
        );
        assert!((driven.drives.vigour(arm) - 1.0).abs() < 0.02);
        (far, leg_far)
    };
    let (firm, _) = farthest(0.0);
    let (weak, leg) = farthest(30.0);
    assert!(weak > 1.5 * firm && weak > 0.05, "displaced by {weak} m with weakening, {firm} m without");
    assert!(leg < 0.2 * weak, "the leg moved by {leg} m");
}

#[test]
fn hit_weakening_halves_from_joint_to_joint() {
    let def = walker().ragdoll;
    let mut drives = Drives::new(&def);
    let index = |role: &str| def.bodies.iter().position(|body| body.role == role).expect("it has it");
    let mass: f32 = def.bodies.iter().map(|body| body.mass.mass).sum();
    drives.hit(&def, index("leftHand"), 0.1 * mass);
    for (role, share) in [("leftHand", 0.5), ("leftLowerArm", 0.75), ("leftUpperArm", 0.875)] {
        assert!((drives.vigour(index(role)) - share).abs() < 1e-5, "{role}: {}", drives.vigour(index(role)));
    }
    assert!(drives.vigour(index("rightFoot")) > 0.99);
}

#[test]
fn drives_saved_during_a_blend_continue_identically() {
    let mut driven = Driven::mannequin();
    driven.world.add_body(&floor());
    driven.drives.set_all(DriveMode::Pinned(Muscle::ALIVE, Pin::SOFT), 0.0);
    driven.drives.set(0, DriveMode::Keyed, 0.1);
    driven.run(1.0);
    driven.drives.set_all(DriveMode::Powered(Muscle::RELAXED), 0.4);
    driven.drives.hit(&driven.def, 3, 10.0);
    driven.run(0.2);
    let (mut world, mut drives) = (Writer::new(), Writer::new());
    driven.world.save(&mut world);
    driven.drives.save(&mut drives);
    driven.run(1.0);
    let hash = driven.world.hash();
    let mut other = Drives::new(&driven.def);
    other.load(&mut Reader::new(drives.as_bytes())).expect("the saved state is valid");
    driven.world.load(&mut Reader::new(world.as_bytes())).expect("the saved state is valid");
    driven.drives = other;
    driven.run(1.0);
    assert_eq!(driven.world.hash(), hash);
    for cut in 0..drives.as_bytes().len() {
        let mut other = Drives::new(&driven.def);
        let before = other.clone();
        assert!(other.load(&mut Reader::new(&drives.as_bytes()[..cut])).is_err(), "{cut} bytes");
        assert_eq!(other, before);
    }
}

#[test]
fn drives_do_not_allocate_after_warm_up() {
    let mut driven = Driven::mannequin();
    driven.drives.set_all(DriveMode::Pinned(Muscle::ALIVE, Pin::FIRM), 0.1);
    driven.drives.set(0, DriveMode::Keyed, 0.0);
    let still = vec![Velocity::default(); driven.targets.len()];
    let (mut of_drives, mut of_steps) = (0, 0);
    for i in 0..120 {
        driven.targets[2].translation.x += if i % 20 < 10 { 2e-3 } else { -2e-3 };
        driven.drives.hit(&driven.def, 2, 5.0);
        let Driven { world, def, ragdoll, drives, targets } = &mut driven;
        let counted = allocation_counter::measure(|| drives.apply(world, def, ragdoll, targets, &still));
        let stepped = allocation_counter::measure(|| world.step());
        if i >= 60 {
            of_drives += counted.count_total;
            of_steps += stepped.count_total;
        }
    }
    assert_eq!((of_drives, of_steps), (0, 0));
}

/// Returns a body held by its first part, and a tail of `count` parts, each half as heavy as the previous one.
fn tail(count: usize) -> RagdollDef {
    let mut def = RagdollDef { bodies: vec![body("hips", Vec3::ZERO, 20.0)], ..RagdollDef::default() };
    for i in 1..=count {
        let mass = 4.0 / (1 << i) as f32;
        def.bodies.push(body(&format!("tail_{i}"), Vec3::Z * (0.3 * i as f32), mass));
        def.joints.push(RagdollJointDef {
            parent: i - 1,
            child: i,
            frame_parent: Transform::from_translation(Vec3::Z * 0.15),
            frame_child: Transform::from_translation(Vec3::Z * -0.15),
            kind: JointKind::Ball { limit: None },
            friction_torque: 0.0,
        });
    }
    def.total_mass = def.bodies.iter().map(|body| body.mass.mass).sum();
    def
}

#[test]
fn creature_strength_follows_the_carried_moment() {
    let def = tail(3);
    let caps = sinew_ragdoll::torque_caps(&def);
    assert_eq!(caps[0], 0.0);
    // The last part carries three times 0.5 kg at 0.15 m.
    assert!((caps[3] - 3.0 * G * 0.5 * 0.15).abs() < 1e-4, "{caps:?}");
    // The first part carries 2, 1 and 0.5 kg at 0.15, 0.45 and 0.75 m.
    assert!((caps[1] - 3.0 * G * (2.0 * 0.15 + 0.45 + 0.5 * 0.75)).abs() < 1e-3, "{caps:?}");
    let mut driven = Driven::new(def, Transform::IDENTITY, 60);
    driven.drives.set(0, DriveMode::Keyed, 0.0);
    for part in 1..4 {
        driven.drives.set(part, DriveMode::Powered(Muscle::STIFF), 0.0);
    }
    driven.run(3.0);
    let end = driven.world.transform(driven.ragdoll.bodies[3]).translation;
    assert!((end - Vec3::Z * 0.9).length() < 0.03, "the tail is not level: {end}");
}

#[test]
fn released_drives_remove_their_joints() {
    let mut driven = Driven::mannequin();
    let (bodies, joints) = (driven.world.body_ids().count(), driven.world.joint_ids().count());
    driven.drives.set_all(DriveMode::Pinned(Muscle::ALIVE, Pin::FIRM), 0.0);
    driven.drives.set(2, DriveMode::Keyed, 0.0);
    driven.run(0.1);
    assert!(driven.world.joint_ids().count() > joints);
    let Driven { world, ragdoll, drives, .. } = &mut driven;
    drives.release(world, ragdoll);
    assert_eq!((world.body_ids().count(), world.joint_ids().count()), (bodies, joints));
    assert!(ragdoll.joints.iter().all(|&joint| world.joint(joint).motor.is_none()));
    assert!(ragdoll.bodies.iter().all(|&body| world.mass(body).mass > 0.0));
}

#[test]
fn a_target_beyond_a_stop_is_held_at_the_stop() {
    let mut driven = Driven::mannequin();
    driven.drives.set_all(DriveMode::Powered(Muscle::STIFF), 0.0);
    driven.drives.set(0, DriveMode::Keyed, 0.0);
    // The target bends the knees the wrong way by 60 degrees.
    for role in ["leftLowerLeg", "rightLowerLeg"] {
        let body = driven.index(role);
        let joint = driven.def.joints[body - 1];
        let pivot = (driven.targets[body] * joint.frame_child).translation;
        let axis = (driven.targets[body] * joint.frame_child).rotation * Vec3::X;
        let back = Rotation::from_axis_angle(axis, -1.0);
        let about = Transform::new(pivot - back * pivot, back);
        driven.targets[body] = about * driven.targets[body];
    }
    for _ in 0..120 {
        driven.step();
        for &joint in &driven.ragdoll.joints {
            assert!(driven.world.joint_overshoot(joint).to_degrees() < 2.0);
        }
    }
    let knee = driven.ragdoll.bodies[driven.index("leftLowerLeg")];
    let spin = driven.world.velocity(knee).angular;
    assert!(spin.length() < 0.02, "the tail oscillates at {spin} rad/s");
}

#[test]
fn a_weak_motor_that_lifts_is_not_slowed_by_long_steps() {
    // Holding the arm takes 5.9 N m. The rest of the motor's torque lifts it, equally at 30 and at 120 steps a second.
    let lifted = |rate: u64| {
        let mut driven = Driven::new(arm(), Transform::IDENTITY, rate);
        driven.drives.set(0, DriveMode::Keyed, 0.0);
        driven.drives.set(1, powered(3.0), 0.0);
        let up = Rotation::from_axis_angle(Vec3::Z, 0.5);
        let pivot = Vec3::X * 0.1;
        let about = Transform::new(pivot - up * pivot, up);
        driven.targets[1] = about * driven.targets[1];
        driven.run(0.5);
        driven.bend()
    };
    let [slow, fast] = [30, 240].map(lifted);
    assert!(fast > 0.3 && (slow - fast).abs() < 0.02 * fast, "{slow} and {fast}");
}

/// Returns a random drive mode with random gains; `modes` limits it to modes that can follow a jumping pose.
fn some_mode(random: &mut Random, modes: usize) -> DriveMode {
    let muscle = Muscle {
        hertz: random.range(0.5, 30.0),
        damping_ratio: random.range(0.2, 3.0),
        strength: random.range(0.0, 1.0),
    };
    let pin = Pin { hertz: random.range(0.5, 30.0), damping_ratio: random.range(0.2, 2.0), ..Pin::FIRM };
    match random.index(modes) {
        0 => DriveMode::Limp,
        1 | 2 => DriveMode::Powered(muscle),
        3..6 => DriveMode::Pinned(muscle, pin),
        _ => DriveMode::Keyed,
    }
}

/// Applies random changes of mode and random hits. The pose sways if `jumps` is `None`; otherwise it jumps by this
/// distance from step to step. Returns the quality and the largest body speed, m/s.
fn random_drive_run(seed: u64, jumps: Option<f32>) -> (FallQuality, f32) {
    let mut fastest: f32 = 0.0;
    let mut random = Random::new(seed);
    let mut driven = Driven::mannequin();
    driven.world.add_body(&floor());
    let mut meter = QualityMeter::new(&driven.def, 5.0);
    let starts = driven.targets.clone();
    let mut velocities = vec![Velocity::default(); starts.len()];
    for step in 1..=300 {
        if step % 15 == 1 {
            let mode = some_mode(&mut random, if jumps.is_some() { 6 } else { 7 });
            let (body, half_life) = (random.index(starts.len()), random.range(0.0, 0.3));
            match random.index(3) {
                0 => driven.drives.set_all(mode, half_life),
                1 => driven.drives.set_from(&driven.def.clone(), body, mode, half_life),
                _ => driven.drives.set(body, mode, half_life),
            }
        }
        if step % 40 == 20 {
            let body = random.index(starts.len());
            let impulse = random.in_cube() * (5.0 * driven.def.bodies[body].mass.mass);
            driven.drives.hit(&driven.def, body, impulse.length());
            driven.world.apply_impulse_at_center(driven.ragdoll.bodies[body], impulse);
        }
        let sway = sinew_math::trig::sin(0.05 * step as f32);
        let about = match jumps {
            Some(far) if step % 40 == 20 => Some(Transform::new(
                random.in_cube() * far,
                Rotation::from_scaled_axis(random.in_cube() * (3.0 * far)),
            )),
            Some(_) => None,
            None => {
                Some(Transform::new(Vec3::splat(0.2 * sway), Rotation::from_axis_angle(Vec3::Y, 0.6 * sway)))
            }
        };
        if let Some(about) = about {
            for (body, start) in starts.iter().enumerate() {
                let (before, after) = (driven.targets[body], about * *start);
                driven.targets[body] = after;
                if jumps.is_none() {
                    let center = driven.def.bodies[body].mass.center;
                    velocities[body] =
                        body_velocity(before, after, center, 1.0 / 60.0, SpeedBound::default());
                }
            }
        }
        let Driven { world, def, ragdoll, drives, targets } = &mut driven;
        drives.apply(world, def, ragdoll, targets, &velocities);
        meter.before_step(world);
        world.step();
        meter.after_step(world, ragdoll);
        for &body in &ragdoll.bodies {
            fastest = fastest.max(world.velocity(body).linear.length());
        }
    }
    (meter.quality(), fastest)
}

#[test]
fn random_drive_changes_stay_stable() {
    let mut opened = 0;
    for seed in 0..8 {
        for jumps in [None, Some(0.05)] {
            let (q, fastest) = random_drive_run(seed, jumps);
            assert_eq!(q.nan, 0);
            assert!(q.joint_gap_p99_m < 1e-4, "{seed}, {jumps:?}: {}", q.joint_gap_p99_m);
            // Pins to a pose that jumps within a step act like impacts, and their work is counted inaccurately.
            // Therefore only speeds must stay bounded, and a joint may open for a step. Of 60 such seeds the largest
            // gaps have a median of 1.3 µm and a maximum of 1.2 mm (1.1 in the previous build). The largest speeds have
            // a median of 24 m/s and a maximum of 63, the second is 46 (previous builds: median 23, maximum 43 to 54).
            // For a pose without jumps, added energy is the work of motors (at most 3e-5 of the measure, of 24 seeds;
            // 0.30 while saturated motors pushed before the forces). The largest speeds then have a median of 24 m/s
            // and a maximum of 57.
            let (gap, gain) = if jumps.is_some() { (0.05, f32::INFINITY) } else { (5e-3, 0.01) };
            let speed = 70.0;
            opened += usize::from(q.joint_gap_max_m > 0.01);
            assert!(fastest < speed, "seed {seed}, {jumps:?}: fastest {fastest} m/s");
            assert!(q.joint_gap_max_m < gap, "{seed}, {jumps:?}: {}", q.joint_gap_max_m);
            assert!(q.energy_gain_max < gain, "{seed}, {jumps:?}: {}", q.energy_gain_max);
        }
    }
    assert!(opened <= 1, "{opened} joints are open");
}

/// Random lives found this case: pins to the old position of a teleported body threw the whole body at 38 m/s.
#[test]
fn teleported_powered_character_is_not_thrown() {
    let def = shared(walker());
    for steps in [0, 2, 60] {
        let mut world = level();
        let mut character = Character::spawn(&mut world, &def, Transform::IDENTITY);
        character.set_drive(&mut world, Part::From("rightUpperLeg"), DriveMode::Keyed, 0.0);
        character.set_preset(&mut world, Preset::Powered);
        run(&mut world, &mut character, steps);
        character.teleport(&mut world, Transform::from_translation(Vec3::new(1.0, 0.0, 0.5)));
        for step in 0..30 {
            run(&mut world, &mut character, 1);
            for &body in character.bodies() {
                let speed = world.velocity(body).linear.length();
                assert!(speed < 6.0, "{steps} steps, step {step}: {speed} m/s");
            }
        }
    }
}
