//! Clean-up of captures: injected defects are found and removed, and nothing else changes.

use crate::mocap::{actor, character};
use crate::toy;
use core::f32::consts::TAU;
use needs_data::needs_data;
use sinew_anim::cleanup::{SpikeSettings, despike, project_limits, remove_penetration, smooth};
use sinew_anim::contact::{lowest, sole_points};
use sinew_anim::learned_limits::learn_limits;
use sinew_anim::legs::Legs;
use sinew_anim::retarget::{Body, RetargetOptions, retarget};
use sinew_anim::{LocalTransform, Take};
use sinew_math::{Random, Rotation, Vec3, trig};

const FRAME: f64 = 1.0 / 120.0;

/// Returns a take of two joints that swing smoothly, 240 frames.
fn swinging() -> Take {
    let pose = |frame: usize| {
        let t = frame as f32 / 120.0;
        let turn = |axis: Vec3, hz: f32| Rotation::from_axis_angle(axis, 0.6 * trig::sin(TAU * hz * t));
        let local = |translation: Vec3, rotation: Rotation| LocalTransform {
            translation,
            rotation,
            scale: Vec3::ONE,
        };
        [local(Vec3::new(t, 1.0, 0.0), turn(Vec3::X, 1.0)), local(Vec3::Y, turn(Vec3::Z, 1.7))]
    };
    Take { frame_time: FRAME, joints: 2, poses: (0..240).flat_map(pose).collect() }
}

fn farthest(a: &Take, b: &Take) -> f32 {
    let off = |(x, y): (&LocalTransform, &LocalTransform)| {
        sinew_math::max(x.rotation.angle_to(y.rotation), (x.translation - y.translation).length())
    };
    a.poses.iter().zip(&b.poses).map(off).fold(0.0, sinew_math::max)
}

#[test]
fn only_spikes_are_removed() {
    let clean = swinging();
    let mut take = clean.clone();
    assert_eq!(despike(&mut take, &SpikeSettings::default()), []);
    assert_eq!(take, clean);
    let mut random = Random::new(2);
    let mut put: Vec<(usize, usize, usize)> = Vec::new();
    for k in 0..12 {
        let (joint, frame, frames) = (k % 2, 10 + 18 * k + random.index(5), 1 + random.index(4));
        let away = Rotation::from_axis_angle(random.direction(), random.range(0.7, 2.5));
        for frame in frame..frame + frames {
            let local = &mut take.pose_mut(frame)[joint];
            local.rotation = local.rotation * away;
        }
        put.push((joint, frame, frames));
    }
    let mut found: Vec<_> = despike(&mut take, &SpikeSettings::default())
        .into_iter()
        .map(|spike| (spike.joint, spike.frame, spike.frames))
        .collect();
    put.sort_unstable();
    found.sort_unstable();
    assert_eq!(found, put);
    assert!(farthest(&take, &clean) < 0.01, "{}", farthest(&take, &clean));
}

/// A displacement for one frame is also a spike; a lasting one is a cut.
#[test]
fn position_spikes_are_removed_and_cuts_stay() {
    let clean = swinging();
    let mut take = clean.clone();
    take.pose_mut(50)[0].translation += Vec3::new(0.0, 0.3, 0.0);
    let found = despike(&mut take, &SpikeSettings::default());
    assert!(
        found.len() == 1 && (found[0].joint, found[0].frame) == (0, 50) && found[0].shift > 0.25,
        "{found:?}"
    );
    assert!(farthest(&take, &clean) < 1e-3);
    for frame in 100..240 {
        take.pose_mut(frame)[1].rotation =
            take.pose(frame)[1].rotation * Rotation::from_axis_angle(Vec3::Y, 1.0);
    }
    assert_eq!(despike(&mut take, &SpikeSettings::default()), []);
}

/// Smoothing scales a sine by `exp(−2 (π f σ)²)`.
#[test]
fn smoothing_follows_its_formula() {
    for (hz, sigma) in [(2.0_f32, 0.03_f32), (8.0, 0.02), (20.0, 0.02)] {
        let angle = |frame: usize| 0.1 * trig::sin(TAU * hz * frame as f32 / 120.0);
        let local = |frame: usize| LocalTransform {
            rotation: Rotation::from_axis_angle(Vec3::X, angle(frame)),
            ..LocalTransform::default()
        };
        let mut take = Take { frame_time: FRAME, joints: 1, poses: (0..480).map(local).collect() };
        let report = smooth(&mut take, sigma);
        let x = core::f32::consts::PI * hz * sigma;
        let kept = trig::exp(-2.0 * x * x);
        for frame in 60..420 {
            let found = take.pose(frame)[0].rotation.twist_angle(Vec3::X);
            assert!((found - kept * angle(frame)).abs() < 1e-3, "{hz} Hz: {found}, {}", kept * angle(frame));
        }
        assert!(report.largest_turn > 0.08 * (1.0 - kept) && report.mean_turn < report.largest_turn);
    }
    let (mut take, clean) = (swinging(), swinging());
    for sigma in [0.0, 1e-3, f32::NAN] {
        assert_eq!(smooth(&mut take, sigma).largest_turn, 0.0);
        assert_eq!(take, clean);
    }
}

#[test]
fn joints_are_projected_into_their_limits() {
    let rig = toy::chain(2, Vec3::Y);
    let clean = swinging();
    let limits = learn_limits(&rig, &[&clean]);
    let mut take = clean.clone();
    // One frame in two hundred may slightly exceed the learned limits.
    let report = project_limits(&mut take, &limits);
    assert!(report.iter().all(|excess| excess.frames < 12 && excess.largest < 0.01), "{report:?}");
    for frame in 100..120 {
        let local = &mut take.pose_mut(frame)[1];
        local.rotation = Rotation::from_axis_angle(Vec3::Z, 1.0);
    }
    let report = project_limits(&mut take, &limits);
    let bent = report.iter().find(|excess| excess.joint == 1).unwrap();
    assert!(bent.frames >= 20 && (bent.largest - 0.4).abs() < 0.01, "{report:?}");
    assert!(project_limits(&mut take, &limits).is_empty());
}

#[needs_data]
#[test]
fn body_is_lifted_out_of_the_floor() {
    let (walk, (rig, analysis)) = (actor("cmu_12_01_walk.bvh"), character("mannequiny.glb"));
    let (actor, body) =
        (Body { rig: &walk.rig, analysis: &walk.analysis }, Body { rig: &rig, analysis: &analysis });
    let mut take = retarget(actor, &walk.clip, body, &RetargetOptions::default()).unwrap().take;
    let (root, legs) = (analysis.character_from_file(), Legs::of(&rig, &analysis).unwrap());
    let floor = analysis.floor - 1e-3;
    let clean = take.clone();
    let report = remove_penetration(&rig, &root, &legs, floor, 0.1, &mut take);
    assert_eq!((report.frames, report.raised), (0, 0.0));
    assert_eq!(take, clean);
    let report = remove_penetration(&rig, &root, &legs, floor + 0.05, 0.1, &mut take);
    assert!(report.frames > 200 && (0.045..0.06).contains(&report.deepest), "{report:?}");
    assert!(report.raised >= report.deepest);
    let low = |take: &Take| {
        sole_points(&rig, &root, &legs.feet, take).iter().map(lowest).fold(9.0, sinew_math::min)
    };
    assert!(low(&take) > floor + 0.05 - 1e-4, "{}", low(&take) - floor);
}

/// Clean-up changes real captures little, and a second pass changes nothing.
#[needs_data]
#[test]
fn second_cleanup_of_a_capture_changes_nothing() {
    for name in ["cmu_12_01_walk.bvh", "cmu_01_01_jumps.bvh", "cmu_02_03_run_iclone.bvh"] {
        let found = actor(name);
        let clean = Take::of(&found.rig, &found.clip, FRAME);
        let mut take = clean.clone();
        let spikes = despike(&mut take, &SpikeSettings::default());
        println!("{name}: {} spikes in {} joint frames: {spikes:.2?}", spikes.len(), take.poses.len());
        assert!(spikes.len() * 2000 < take.poses.len(), "{name}: {spikes:?}");
        assert_eq!(despike(&mut take, &SpikeSettings::default()), [], "{name}");
        let report = smooth(&mut take, 0.01);
        assert!(report.mean_turn < 0.01 && report.largest_turn < 0.6, "{name}: {report:?}");
    }
}
