//! A whole run, from walk to walk, as a clip.

use crate::actor::{floor, in_centimetres_and_z_up, shared, somewhere, walker};
use sinew_anim::{Wrap, local_to_model, rest_pose, sample};
use sinew_math::{Affine, Vec3};
use sinew_ragdoll::{BakeInput, Baked, CharacterDef, Hit, State, bake};
use std::sync::Arc;

fn baked(def: &Arc<CharacterDef>, impulse: Vec3, fps: f32) -> Baked {
    let body = def.body_named("chest").expect("it has a chest");
    let (bodies, hits) = ([floor()], [Hit { time: 0.8, body, impulse }]);
    let input = BakeInput {
        bodies: &bodies,
        hits: &hits,
        seconds: 9.0,
        fps,
        world_from_character: somewhere(),
        ..BakeInput::new(def.clone())
    };
    bake(&input)
}

const PUSH: Vec3 = Vec3::new(-30.0, 0.0, -70.0);

#[test]
fn figures_are_inside_the_limits() {
    let quality = baked(&shared(walker()), PUSH, 30.0).quality;
    assert_eq!(quality.nan, 0);
    assert!(quality.energy_gain_max < 0.01, "{quality:?}");
    assert!(quality.joint_gap_p99_m < 1e-3 && quality.joint_gap_max_m < 5e-3, "{quality:?}");
    assert!(quality.limit_overshoot_p99_deg < 2.0 && quality.limit_overshoot_max_deg < 4.0, "{quality:?}");
    assert!(quality.penetration_rest_max_m < 5e-3, "{quality:?}");
    assert!(quality.work_in_j > 0.0);
    let (touched, settled, up) = (quality.first_contact_s, quality.settled_s, quality.up_s);
    assert!(touched.is_some() && settled.is_some() && up.is_some(), "{quality:?}");
    assert!(touched < settled && settled < up, "{quality:?}");
}

#[test]
fn the_clip_shows_what_happened() {
    for def in [walker(), in_centimetres_and_z_up()] {
        let def = shared(def);
        let baked = baked(&def, PUSH, 25.0);
        assert_eq!(baked.frames.len(), 226);
        // Whether it has to be rolled over first is its own affair.
        let needed = baked.frames.iter().filter(|frame| frame.state != State::Preparing);
        let mut states: Vec<_> = needed.map(|frame| frame.state).collect();
        states.dedup();
        assert_eq!(states, [State::Animated, State::Limp, State::GettingUp, State::Animated]);
        let hips = def.ragdoll.bodies[0].joint;
        let mut heights = Vec::new();
        for frame in &baked.frames {
            let mut pose = rest_pose(&def.rig);
            sample(&baked.clip, &def.rig, frame.time, Wrap::Clamp, &mut pose);
            let (mut played, mut shown) = (Vec::new(), Vec::new());
            local_to_model(&def.rig, &pose, &baked.world_from_model, &mut played);
            local_to_model(&def.rig, &frame.pose, &baked.world_from_model, &mut shown);
            for (a, b) in played.iter().zip(&shown) {
                assert!((a.translation - b.translation).length() < 1e-4, "at {} s", frame.time);
            }
            heights.push(played[hips].translation.y);
        }
        let lowest = heights.iter().copied().fold(f32::INFINITY, sinew_math::min);
        assert!(heights[0] > 0.8 && lowest < 0.25 && heights[225] > 0.8, "{heights:?}");
    }
}

#[test]
fn only_the_pelvis_and_turns_are_keyed() {
    let def = shared(walker());
    let baked = baked(&def, PUSH, 30.0);
    let hips = def.ragdoll.bodies[0].joint;
    for channel in &baked.clip.channels {
        let is_turn = channel.property == sinew_anim::Property::Rotation;
        assert!(is_turn || channel.joint == hips, "joint {} has {:?}", channel.joint, channel.property);
        for pair in channel.values.chunks_exact(4).collect::<Vec<_>>().windows(2).filter(|_| is_turn) {
            let dot: f32 = pair[0].iter().zip(pair[1]).map(|(a, b)| a * b).sum();
            assert!(dot > 0.0, "keys take the short way");
        }
    }
}

#[test]
fn starts_where_the_files_character_stands() {
    let def = shared(walker());
    let first = &baked(&def, PUSH, 30.0).frames[0];
    let mut walking = rest_pose(&def.rig);
    sample(&def.motions().clips[0], &def.rig, 0.0, Wrap::Loop, &mut walking);
    let (mut expected, mut model) = (Vec::new(), Vec::new());
    local_to_model(&def.rig, &walking, &Affine::IDENTITY, &mut expected);
    local_to_model(&def.rig, &first.pose, &Affine::IDENTITY, &mut model);
    for (a, b) in expected.iter().zip(&model) {
        // Within what built clips keep: 47 bits of a rotation.
        assert!((a.translation - b.translation).length() < 1e-4);
    }
}

#[test]
fn it_is_a_simulation_not_a_choreography() {
    let def = shared(walker());
    let limp_pose = |impulse: Vec3| {
        let baked = baked(&def, impulse, 30.0);
        assert!(baked.quality.energy_gain_max < 0.01 && baked.quality.nan == 0);
        (
            baked.hash,
            baked.frames.iter().rfind(|frame| frame.state == State::Limp).expect("it fell").pose.clone(),
        )
    };
    let (hash, pose) = limp_pose(PUSH);
    let (again, same) = limp_pose(PUSH);
    assert_eq!((hash, &pose), (again, &same), "the same run twice");
    let sideways = Vec3::new(PUSH.z, 0.0, -PUSH.x);
    for other in [PUSH * 1.01, sideways] {
        assert_ne!(pose, limp_pose(other).1, "pushed by {other}");
    }
}

#[test]
fn frame_rate_changes_nothing_but_the_frames() {
    let def = shared(walker());
    let hashes = [24.0, 60.0, 144.0].map(|fps| {
        let baked = baked(&def, PUSH, fps);
        (baked.hash, baked.steps)
    });
    assert!(hashes.iter().all(|hash| *hash == hashes[0]), "{hashes:?}");
}
