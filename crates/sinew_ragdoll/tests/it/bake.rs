//! Bakes of a character from walk to walk.

use crate::actor::{floor, in_centimetres_and_z_up, shared, somewhere, walker};
use core::ops::ControlFlow;
use sinew_anim::{KeyBound, Wrap, analyze, local_to_model, rest_pose, sample};
use sinew_math::Transform;
use sinew_math::{Affine, Vec3, max};
use sinew_physics::{BodyDef, FieldDef, FieldKind, Shape, Wind};
use sinew_ragdoll::bake::KEY_BOUND;
use sinew_ragdoll::quality::judge_bake;
use sinew_ragdoll::settings::BoneSettings;
use sinew_ragdoll::{
    AfterSettling, BakeDrive, BakeHit, BakeInput, BakeMover, BakeReturn, Baked, BuildOptions, CharacterDef,
    CharacterEvent, DriveMode, HitEffect, Locomotion, MotionSet, Part, Settings, State, Verdict, bake,
    bake_together, build_with,
};
use sinew_scenes::mannequin::{Mannequin, mannequin};
use std::sync::Arc;

fn baked(def: &Arc<CharacterDef>, impulse: Vec3, fps: f32) -> Baked {
    baked_within(def, impulse, fps, KEY_BOUND)
}

fn baked_within(def: &Arc<CharacterDef>, impulse: Vec3, fps: f32, key_bound: KeyBound) -> Baked {
    let body = def.body_named("chest").expect("the character has a chest");
    let (bodies, hits) = ([floor()], [BakeHit { time: 0.8, body, impulse }]);
    let input = BakeInput {
        bodies: &bodies,
        hits: &hits,
        seconds: 9.0,
        fps,
        key_bound,
        world_from_character: somewhere(),
        ..BakeInput::new(def.clone())
    };
    bake(&input)
}

const PUSH: Vec3 = Vec3::new(-30.0, 0.0, -70.0);

#[test]
fn quality_of_a_baked_fall_is_within_the_limits() {
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
fn clip_matches_the_simulated_frames() {
    for def in [walker(), in_centimetres_and_z_up()] {
        let def = shared(def);
        let baked = baked(&def, PUSH, 25.0);
        assert_eq!(baked.frames.len(), 226);
        // The fall decides whether the character must be rolled over first.
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
                assert!((a.translation - b.translation).length() < 1.01e-4, "at {} s", frame.time);
            }
            heights.push(played[hips].translation.y);
        }
        let lowest = heights.iter().copied().fold(f32::INFINITY, sinew_math::min);
        assert!(heights[0] > 0.8 && lowest < 0.25 && heights[225] > 0.8, "{heights:?}");
    }
}

#[test]
fn only_pelvis_translation_and_rotations_have_keys() {
    let def = shared(walker());
    let baked = baked(&def, PUSH, 30.0);
    let hips = def.ragdoll.bodies[0].joint;
    for channel in &baked.clip.channels {
        let is_turn = channel.property == sinew_anim::Property::Rotation;
        assert!(is_turn || channel.joint == hips, "joint {} has {:?}", channel.joint, channel.property);
        for pair in channel.values.chunks_exact(4).collect::<Vec<_>>().windows(2).filter(|_| is_turn) {
            let dot: f32 = pair[0].iter().zip(pair[1]).map(|(a, b)| a * b).sum();
            assert!(dot > 0.0, "consecutive keys must be in one hemisphere");
        }
    }
}

#[test]
fn baked_clip_starts_in_the_pose_of_the_looped_clip() {
    let def = shared(walker());
    let first = &baked(&def, PUSH, 30.0).frames[0];
    let mut walking = rest_pose(&def.rig);
    sample(&def.motions().clips[0], &def.rig, 0.0, Wrap::Loop, &mut walking);
    let (mut expected, mut model) = (Vec::new(), Vec::new());
    local_to_model(&def.rig, &walking, &Affine::IDENTITY, &mut expected);
    local_to_model(&def.rig, &first.pose, &Affine::IDENTITY, &mut model);
    for (a, b) in expected.iter().zip(&model) {
        // Tolerance: built clips keep 47 bits of a rotation.
        assert!((a.translation - b.translation).length() < 1e-4);
    }
}

#[test]
fn equal_hits_give_equal_poses_and_other_hits_give_others() {
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
fn frame_rate_changes_only_the_number_of_frames() {
    let def = shared(walker());
    let hashes = [24.0, 60.0, 144.0].map(|fps| {
        let baked = baked(&def, PUSH, fps);
        (baked.hash, baked.steps)
    });
    assert!(hashes.iter().all(|hash| *hash == hashes[0]), "{hashes:?}");
}

/// Returns the largest distance (metres) and angle between the joints of the clip and of the frames, at the frames'
/// times.
fn off(def: &CharacterDef, baked: &Baked) -> [f32; 2] {
    let mut worst = [0.0, 0.0];
    let root = def.mapping().character_from_model();
    for frame in &baked.frames {
        let mut pose = rest_pose(&def.rig);
        sample(&baked.clip, &def.rig, frame.time, Wrap::Clamp, &mut pose);
        let (mut played, mut shown) = (Vec::new(), Vec::new());
        local_to_model(&def.rig, &pose, &root, &mut played);
        local_to_model(&def.rig, &frame.pose, &root, &mut shown);
        for (a, b) in played.iter().zip(&shown) {
            let (a, b) = (a.to_rigid(), b.to_rigid());
            worst[0] = max(worst[0], (a.translation - b.translation).length());
            worst[1] = max(worst[1], a.rotation.angle_to(b.rotation));
        }
    }
    worst
}

#[test]
fn key_error_stays_within_the_bound_at_any_rate() {
    for def in [walker(), in_centimetres_and_z_up()] {
        let def = shared(def);
        for fps in [24.0, 25.0, 30.0, 120.0] {
            let baked = baked(&def, PUSH, fps);
            assert_eq!(baked.frames.len(), (9.0 * fps) as usize + 1);
            let [distance, angle] = off(&def, &baked);
            println!(
                "{fps}: {:?} keys, {distance} m, {}°, told {:?}",
                baked.keys,
                angle.to_degrees(),
                baked.key_error
            );
            // Keys at the frames' own times differ from the frames by rounding only.
            assert!(distance <= 1.01 * KEY_BOUND.distance && angle <= 1.01 * KEY_BOUND.angle);
            assert!((distance - baked.key_error.distance).abs() < 4e-6, "{distance} {:?}", baked.key_error);
            assert!((angle - baked.key_error.angle).abs() < 4e-6, "{angle} {:?}", baked.key_error);
            let count: usize = baked.clip.channels.iter().map(|channel| channel.times.len()).sum();
            assert_eq!(baked.keys[1], count);
            assert!(baked.keys[1] < baked.keys[0], "{:?}", baked.keys);
            let last = baked.frames.last().expect("frames").time;
            assert!((baked.clip.duration - last).abs() < 1e-6 && (last - 9.0).abs() < 1.0 / fps);
        }
    }
}

#[test]
fn bake_with_the_bound_all_keys_keeps_every_key() {
    let def = shared(walker());
    let all = baked_within(&def, PUSH, 30.0, KeyBound::ALL_KEYS);
    assert!(all.clip.channels.iter().all(|channel| channel.times.len() == all.frames.len()));
    assert_eq!(all.keys[0], all.keys[1]);
    let coarse = baked_within(&def, PUSH, 30.0, KeyBound { distance: 2e-3, angle: 3.5e-3 });
    assert_eq!((all.hash, &all.frames), (coarse.hash, &coarse.frames));
    assert!(4 * coarse.keys[1] < 3 * coarse.keys[0], "{:?}", coarse.keys);
}

#[test]
fn weak_hit_bakes_a_flinch() {
    let def = shared(walker());
    let body = def.body_named("rightHand").expect("the character has hands");
    let chest = def.body_named("chest").expect("the character has a chest");
    let run = |hit_effect: HitEffect| {
        let hits = [
            BakeHit { time: 0.5, body, impulse: Vec3::X * -5.0 },
            BakeHit { time: 2.0, body: chest, impulse: Vec3::Z * -80.0 },
        ];
        let (bodies, seconds) = ([floor()], 3.0);
        bake(&BakeInput { bodies: &bodies, hits: &hits, hit_effect, seconds, ..BakeInput::new(def.clone()) })
    };
    let states = |baked: &Baked| {
        let mut states: Vec<_> = baked.frames.iter().map(|frame| frame.state).collect();
        states.dedup();
        states
    };
    let flinched = run(HitEffect::FlinchesOrFalls);
    assert_eq!(states(&flinched), [State::Animated, State::Flinching, State::Animated, State::Limp]);
    assert!(flinched.events.iter().any(|(_, event)| *event == CharacterEvent::Flinched { body }));
    assert!(flinched.quality.nan == 0 && flinched.quality.energy_gain_max < 0.01, "{:?}", flinched.quality);
    assert_eq!(states(&run(HitEffect::Falls))[..2], [State::Animated, State::Limp]);
}

/// Returns the mannequin with stylised proportions: head, hands and feet nearly twice as large, masses computed from
/// their shapes.
fn stylised() -> CharacterDef {
    let Mannequin { rig, clips, motions } = mannequin();
    let analysis = analyze(&rig).expect("the mannequin has a skin");
    let large = BoneSettings { scale: Some(1.8), ..BoneSettings::default() };
    let bones = ["head", "hand", "foot"].map(|role| (role.to_owned(), large)).to_vec();
    let settings = Settings { bones, ..Settings::default() };
    let (ragdoll, _) =
        build_with(&rig, &analysis, &BuildOptions::default(), &settings).expect("a body that can be built");
    let mut def = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
    let locomotion = Locomotion::Forward { speed: motions.walk_speed };
    let set = MotionSet { clips, looped: Some(motions.walk), locomotion, ..MotionSet::default() };
    def.set_motions(set).expect("the mannequin's clips can be played");
    def
}

/// Hits from all sides during a travelling clip. A bake of this character once exceeded a joint limit by 22°, although
/// none of its drops did.
#[test]
fn a_figure_with_large_feet_and_head_keeps_its_limits_in_a_bake() {
    let def = shared(stylised());
    for (body, impulse) in [
        ("head", Vec3::Z * -60.0),
        ("head", Vec3::X * 60.0),
        ("chest", Vec3::new(0.0, 40.0, 120.0)),
        ("leftFoot", Vec3::X * -50.0),
        ("rightFoot", Vec3::new(0.0, 60.0, -40.0)),
        ("hips", Vec3::Z * 150.0),
    ] {
        let hits = [BakeHit {
            time: 0.6,
            body: def.body_named(body).expect("the character has this part"),
            impulse,
        }];
        let bodies = [floor()];
        let input = BakeInput { bodies: &bodies, hits: &hits, seconds: 4.0, ..BakeInput::new(def.clone()) };
        let baked = bake(&input);
        assert!(baked.quality.first_contact_s.is_some(), "{body}, impulse {impulse}: no contact");
        let (verdict, reasons) = judge_bake(&baked.quality);
        assert_eq!(verdict, Verdict::Good, "{body}, impulse {impulse}: {reasons:?}");
    }
}

/// Returns the world positions of all joints, frame by frame.
fn places(def: &CharacterDef, baked: &Baked) -> Vec<Vec<Vec3>> {
    let mut model = Vec::new();
    let of = |frame: &sinew_ragdoll::bake::Frame| {
        local_to_model(&def.rig, &frame.pose, &baked.world_from_model, &mut model);
        model.iter().map(|joint| joint.translation).collect()
    };
    baked.frames.iter().map(of).collect()
}

fn farthest(a: &[Vec3], b: &[Vec3]) -> f32 {
    a.iter().zip(b).fold(0.0, |most, (a, b)| max(most, (*a - *b).length()))
}

/// Returns the walker with `exact` playback of its clip.
fn exact() -> Arc<CharacterDef> {
    let mut def = walker();
    let motions = MotionSet { locomotion: Locomotion::Exact, ..def.motions().clone() };
    def.set_motions(motions).expect("the motions were accepted before");
    shared(def)
}

#[test]
fn returned_character_rejoins_its_clip() {
    let (def, bodies) = (exact(), [floor()]);
    let own = BakeInput { bodies: &bodies, seconds: 5.0, ..BakeInput::new(def.clone()) };
    let fallen = BakeInput {
        limp_at: Some(1.0),
        returns: Some(BakeReturn { time: 3.0, seconds: 0.6 }),
        ..own.clone()
    };
    let (own, back) = (places(&def, &bake(&own)), places(&def, &bake(&fallen)));
    let away: Vec<f32> = own.iter().zip(&back).map(|(a, b)| farthest(a, b)).collect();
    assert!(away[..31].iter().all(|&away| away < 1e-4), "before the fall: {:?}", &away[..31]);
    assert!(away[70] > 0.3, "while down: {}", away[70]);
    assert!(away[91..].iter().all(|&away| away < 2e-3), "distances after the return: {:?}", &away[91..]);
    let own_step = (1..own.len()).map(|frame| farthest(&own[frame], &own[frame - 1])).fold(0.0, max);
    for frame in 70..100 {
        let step = farthest(&back[frame], &back[frame - 1]);
        assert!(step < own_step + 0.25, "frame {frame}: a joint moves {step} m, in its clip {own_step} m");
    }
}

#[test]
fn exact_playback_ignores_the_ground() {
    let def = exact();
    let ground = [floor().at(Vec3::Y * -0.4)];
    let on = BakeInput { bodies: &ground, seconds: 1.0, ..BakeInput::new(def.clone()) };
    let in_the_air = bake(&BakeInput { bodies: &[], ..on.clone() });
    assert_eq!(bake(&on).frames, in_the_air.frames);
    assert_eq!(def.raised(), 0.0);
}

#[test]
fn timed_drives_move_parts_and_return_them() {
    let (def, bodies) = (exact(), [floor()]);
    let drive = |time, mode| BakeDrive { time, part: Part::From("leftUpperArm"), mode, half_life: 0.05 };
    let drives = [drive(0.5, DriveMode::Limp), drive(2.0, DriveMode::Keyed)];
    let own = BakeInput { bodies: &bodies, seconds: 4.0, ..BakeInput::new(def.clone()) };
    let driven = bake(&BakeInput { drives: &drives, ..own.clone() });
    let (own, there) = (places(&def, &bake(&own)), places(&def, &driven));
    let hand = def.rig.joints.iter().position(|joint| joint.name == "leftHand").expect("the body exists");
    let away: Vec<f32> = own.iter().zip(&there).map(|(a, b)| (a[hand] - b[hand]).length()).collect();
    assert!(away[..14].iter().all(|&away| away < 0.02), "{:?}", &away[..14]);
    assert!(away[15..60].iter().any(|&away| away > 0.05), "{:?}", &away[15..60]);
    assert!(away[110..].iter().all(|&away| away < 0.02), "{:?}", &away[110..]);
    assert_eq!(driven.quality.nan, 0);
}

#[test]
fn moving_body_pushes_and_wind_blows_the_baked_character() {
    let mut def = walker();
    // With the default, clips would move the character and the plough would pass through it.
    def.after_settling = AfterSettling::StayDown;
    let (def, bodies) = (shared(def), [floor()]);
    let still =
        BakeInput { bodies: &bodies, limp_at: Some(0.1), seconds: 4.0, ..BakeInput::new(def.clone()) };
    let plough = Shape::Box { half_extents: Vec3::new(3.0, 1.0, 0.2) };
    let at = |z: f32| Transform::from_translation(Vec3::new(0.0, 1.0, z));
    let poses = [at(5.0), at(-3.0)];
    let movers = [BakeMover { body: BodyDef::fixed(plough), times: &[1.5, 3.5], poses: &poses }];
    let air = Wind { velocity: Vec3::X * 60.0, ..Wind::default() };
    let fields = [FieldDef::new(FieldKind::Wind(air))];
    let end = |input: &BakeInput<'_>| places(&def, &bake(input)).pop().expect("there are frames")[1];
    let lies = end(&still);
    let shoved = end(&BakeInput { movers: &movers, ..still.clone() });
    assert!((shoved - lies).length() > 0.3, "the plough moved the character only from {lies} to {shoved}");
    assert!(
        end(&BakeInput { fields: &fields, ..still.clone() }).x > lies.x + 0.1,
        "the wind must move the character by more than 0.1 m"
    );
}

#[test]
fn joint_bake_shares_one_world_and_can_be_cancelled() {
    let (def, bodies) = (shared(walker()), [floor()]);
    let at = |x: f32| Transform::from_translation(Vec3::X * x);
    let one = BakeInput { bodies: &bodies, limp_at: Some(0.3), seconds: 2.0, ..BakeInput::new(def.clone()) };
    let two = BakeInput { bodies: &[], world_from_character: at(0.4), limp_at: Some(0.6), ..one.clone() };
    let far = BakeInput { world_from_character: at(40.0), ..two.clone() };
    let go_on = &mut |_: f32| ControlFlow::Continue(());
    let met = bake_together(&[one.clone(), two.clone()], go_on).expect("nothing stops the motion");
    let apart = bake_together(&[one.clone(), far], go_on).expect("nothing stops the motion");
    assert_ne!(met[0].frames, apart[0].frames, "they collide");
    assert_eq!(
        met,
        bake_together(&[one.clone(), two], go_on).expect("nothing stops the motion"),
        "a second bake must be identical"
    );
    let mut event_count = 0;
    let stopped = bake_together(&[one], &mut |time| {
        event_count += 1;
        if time > 0.5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert!(stopped.is_none() && event_count == 31, "{event_count} steps");
}
