//! Metrics of falls, and the standard tests of every ragdoll.

use crate::actor::{floor, walker};
use sinew_math::{Rotation, Transform, Vec3};
use sinew_physics::{Quality, Serial, Threads, Velocity, World, WorldDef};
use sinew_ragdoll::quality::{GateReport, gate_on};
use sinew_ragdoll::ragdoll::fitted;
use sinew_ragdoll::{
    BodySettings, BodyState, QualityMeter, Ragdoll, RagdollBodyDef, Verdict, drop_test, gate,
};

#[test]
fn mannequin_passes_drops_and_a_wall_impact() {
    let report = drop_test(&walker().ragdoll);
    for (drop, quality) in report.drops.iter().chain([&report.wall]).enumerate() {
        assert_eq!(quality.nan, 0, "drop {drop}");
        assert!(quality.energy_gain_max < 0.01, "drop {drop}: {quality:?}");
        assert!(quality.joint_gap_max_m < 5e-3 && quality.joint_gap_p99_m < 1e-3, "drop {drop}: {quality:?}");
        assert!(quality.limit_overshoot_max_deg < 4.0, "drop {drop}: {quality:?}");
        assert!(quality.penetration_rest_max_m < 5e-3, "drop {drop}: {quality:?}");
    }
    assert!(report.drop.asleep_s.is_some_and(|asleep| asleep < 6.0), "{:?}", report.drop);
    assert_ne!(report.verdict, Verdict::Bad, "{:?}", report.reasons);
}

#[test]
fn random_falls_get_good_verdicts() {
    let report = gate(&walker().ragdoll, 6);
    assert_eq!(report.verdicts.iter().sum::<usize>(), 6);
    assert_eq!(report.misses, []);
    assert!(report.worst.joint_gap_max_m < 5e-3, "{report:?}");
}

/// Neither the number of threads nor the split into ranges changes a fall.
#[test]
fn falls_are_independent_of_threads_and_ranges() {
    let def = walker().ragdoll;
    let whole = gate(&def, 4);
    assert_eq!(whole.spawns, 4);
    for threads in [2, 3, 8] {
        assert_eq!(gate_on(&def, 0..4, &Threads::new(threads)), whole, "{threads} threads");
    }
    let parts = [0..1, 1..1, 1..4].map(|falls| gate_on(&def, falls, &Serial));
    assert_eq!(parts.into_iter().reduce(GateReport::and), Some(whole));
}

/// In free fall the meter agrees with closed forms.
#[test]
fn meter_detects_added_energy() {
    let def = walker().ragdoll;
    let measure = |kick: f32| {
        let mut world = World::new(WorldDef::default());
        let states: Vec<_> = def
            .bodies
            .iter()
            .map(|body| BodyState {
                world_from_body: Transform::from_translation(Vec3::Y * 50.0) * body.character_from_body,
                velocity: Velocity { linear: Vec3::X * 2.0, angular: Vec3::ZERO },
            })
            .collect();
        let ragdoll = Ragdoll::spawn(&mut world, &def, &states, &BodySettings::default());
        let mut meter = QualityMeter::new(&def, 0.5);
        for step in 0..30 {
            meter.before_step(&world);
            world.step();
            if step == 20 {
                // Velocities are changed without informing the meter.
                for &body in &ragdoll.bodies {
                    let v = world.velocity(body);
                    world.set_velocity(body, Velocity { linear: v.linear * kick, ..v });
                }
            }
            meter.after_step(&world, &ragdoll);
        }
        meter.quality()
    };
    let honest = measure(1.0);
    assert!(honest.energy_gain_max < 1e-3, "{honest:?}");
    assert!(honest.joint_gap_max_m < 1e-4 && honest.limit_overshoot_max_deg < 0.5, "{honest:?}");
    // Speeds times √1.1 give a tenth more kinetic energy.
    let gain = measure(1.1_f32.sqrt()).energy_gain_max;
    assert!((gain - 0.1).abs() < 0.01, "{gain}");
}

/// Spawns the walker in its bind pose.
fn spawn(world: &mut World, body_settings: &BodySettings) -> Ragdoll {
    let def = walker().ragdoll;
    let at = |body: &RagdollBodyDef| BodyState {
        world_from_body: body.character_from_body,
        ..BodyState::default()
    };
    let states: Vec<_> = def.bodies.iter().map(at).collect();
    Ragdoll::spawn(world, &def, &states, body_settings)
}

#[test]
fn despawning_removes_bodies_and_joints() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&floor());
    let ragdoll = spawn(&mut world, &BodySettings::default());
    world.step();
    ragdoll.despawn(&mut world);
    assert_eq!((world.body_ids().count(), world.joint_ids().count()), (1, 0));
    world.step();
}

#[test]
fn ragdoll_sets_its_own_substep_quality() {
    let mut world = World::new(WorldDef::default());
    let ragdoll =
        spawn(&mut world, &BodySettings { quality: Some(Quality::Exact), ..BodySettings::default() });
    let has = |world: &World, quality| ragdoll.bodies.iter().all(|&body| world.quality(body) == quality);
    assert!(has(&world, Some(Quality::Exact)));
    ragdoll.set_quality(&mut world, Some(Quality::Fast));
    assert!(has(&world, Some(Quality::Fast)));
    ragdoll.set_quality(&mut world, None);
    assert!(has(&world, None));
}

/// Joints fitted to any body poses are consistent with them.
#[test]
fn fitted_joints_match_any_pose() {
    let def = walker().ragdoll;
    let mut random = sinew_math::Random::new(3);
    for _ in 0..50 {
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        let states: Vec<_> = def
            .bodies
            .iter()
            .map(|body| {
                let bind = body.character_from_body;
                let turn = Rotation::from_scaled_axis(random.direction() * 0.8);
                let place = Transform::new(bind.translation + random.in_cube(), turn * bind.rotation);
                BodyState { world_from_body: place, ..BodyState::default() }
            })
            .collect();
        let ragdoll = Ragdoll::spawn(&mut world, &def, &states, &BodySettings::default());
        for (index, &joint) in ragdoll.joints.iter().enumerate() {
            assert!(world.joint_gap(joint) < 1e-5, "joint {index}");
            let overshoot = world.joint_overshoot(joint).to_degrees();
            assert!(overshoot < 0.1, "joint {index}: overshoot {overshoot}°");
        }
    }
}

#[test]
fn pose_within_the_limits_changes_no_limit() {
    let def = walker().ragdoll;
    for joint in &def.joints {
        let pose = |body: usize| def.bodies[body].character_from_body;
        let same = fitted(joint, pose(joint.parent), pose(joint.child));
        assert_eq!(same.kind, joint.kind);
        let moved = (same.frame_parent.translation - joint.frame_parent.translation).length();
        assert!(moved < 1e-5, "{moved}");
    }
}
