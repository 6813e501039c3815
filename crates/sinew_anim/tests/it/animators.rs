//! Tests of tracks, ramps, layers, sync groups and their events.

use crate::{cases, stage};
use sinew_anim::{
    AnimatedClip, AnimationSet, Animator, Channel, Clip, ClipEvent, ClipId, Easing, EndAction, EventPolicy,
    Fill, FiredBy, Interpolation, LoopMode, Markers, Mask, Pose, Property, Skeleton, TrackDef, Transition,
};
use sinew_math::{Random, Rotation, Vec3};

fn ids(set: &AnimationSet) -> Vec<ClipId> {
    set.clips().collect()
}

fn angle(a: &Pose, b: &Pose) -> f32 {
    a.iter().zip(b.iter()).map(|(a, b)| a.rotation.angle_to(b.rotation)).fold(0.0, sinew_math::max)
}

/// Returns a set with one clip of `duration` seconds that has `events`.
fn eventful(duration: f32, events: Vec<ClipEvent>) -> AnimationSet {
    let mut set = AnimationSet::new(Skeleton::new(&stage::rig()));
    let clip = stage::build(&stage::swaying(&mut Random::new(3), duration), Fill::Rest);
    set.add_clip(AnimatedClip { events, ..clip });
    set
}

#[test]
fn single_track_shows_its_clip() {
    let set = stage::set(1);
    let clip = ids(&set)[0];
    let mut animator = Animator::new(&set);
    animator.play(&set, &TrackDef { start: 0.3, speed: -2.0, ..TrackDef::new(clip) });
    let mut expected = Pose::new(stage::JOINTS);
    for i in 0..50 {
        animator.update(&set, 0.01);
        let time = (0.3 - 0.02 * (i + 1) as f32).rem_euclid(1.0);
        set.clip(clip).clip.sample(time, &mut sinew_anim::Cursor::new(), &mut expected);
        assert!(angle(animator.pose(), &expected) < 1e-3, "step {i}");
    }
}

/// One clip in two tracks with different weights and speeds.
#[test]
fn one_clip_in_two_tracks_blends_both_times() {
    let set = stage::set(2);
    let clip = ids(&set)[0];
    let mut both = Animator::new(&set);
    both.play(&set, &TrackDef { weight: 0.7, ..TrackDef::new(clip) });
    let slow = both.play(&set, &TrackDef { weight: 0.3, speed: 0.93, ..TrackDef::new(clip) });
    let mut alone = [1.0, 0.93].map(|speed| {
        let mut animator = Animator::new(&set);
        animator.play(&set, &TrackDef { speed, ..TrackDef::new(clip) });
        animator
    });
    both.update(&set, 0.0);
    let mut apart: f32 = 0.0;
    for step in 0..600 {
        both.update(&set, 1.0 / 60.0);
        alone.iter_mut().for_each(|animator| animator.update(&set, 1.0 / 60.0));
        let [fast, late] = [0, 1].map(|i| alone[i].pose());
        for joint in 0..stage::JOINTS {
            let [a, b, mean] = [fast, late, both.pose()].map(|pose| pose.get(joint).rotation);
            // The mean of two rotations lies on the arc between them.
            let expected = a.nlerp(b, 0.3);
            assert!(mean.angle_to(expected) < 1e-3, "step {step}, joint {joint} differs");
        }
        apart = sinew_math::max(apart, angle(fast, late));
    }
    assert!(apart > 0.3, "the clips must drift apart; distance {apart}");
    // With equal speed and time, both tracks give the same bits.
    both.set_speed(slow, 1.0);
    let time = both.tracks().next().expect("two play").playhead().clip_time();
    both.seek(slow, time);
    let fast = both.tracks().next().expect("two play").id();
    both.seek(fast, time);
    alone[0] = Animator::new(&set);
    alone[0].play(&set, &TrackDef { start: time, ..TrackDef::new(clip) });
    for _ in 0..100 {
        both.update(&set, 1.0 / 60.0);
        alone[0].update(&set, 1.0 / 60.0);
        assert_eq!(both.pose(), alone[0].pose());
    }
}

#[test]
fn track_order_does_not_change_the_pose() {
    let set = stage::set(3);
    let mut random = Random::new(4);
    for _ in 0..20 {
        let mut defs: Vec<TrackDef> = (0..5)
            .map(|_| TrackDef {
                weight: random.index(3) as f32 * 0.4,
                speed: random.range(-2.0, 2.0),
                layer: random.index(2) as u8,
                ..TrackDef::new(ids(&set)[random.index(3)])
            })
            .collect();
        let play = |defs: &[TrackDef]| {
            let mut animator = Animator::new(&set);
            for def in defs {
                animator.play(&set, def);
            }
            (0..7).for_each(|_| animator.update(&set, 0.031));
            animator
        };
        let first = play(&defs);
        defs.reverse();
        let second = play(&defs);
        assert_eq!(first.pose(), second.pose());
        assert_eq!(first.root_motion(), second.root_motion());
    }
}

#[test]
fn ramps_end_on_time_with_their_action() {
    let set = stage::set(5);
    let clip = ids(&set)[0];
    for then in [EndAction::Hold, EndAction::Stop, EndAction::Pause, EndAction::Restart] {
        for steps in [1, 3, 60] {
            let mut animator = Animator::new(&set);
            let track = animator.play(&set, &TrackDef { start: 0.2, ..TrackDef::new(clip) });
            animator.fade(track, 0.25, 0.5, Easing::Smooth, then);
            for _ in 0..steps {
                animator.update(&set, 0.75 / steps as f32);
            }
            let Some(track) = animator.track(track) else {
                assert_eq!(then, EndAction::Stop);
                assert_eq!(animator.pose(), set.skeleton().rest());
                continue;
            };
            assert_eq!(track.def().weight, 0.25);
            let time = match then {
                EndAction::Pause => 0.7,
                EndAction::Restart => 0.45,
                _ => 0.95,
            };
            assert!(
                (track.playhead().clip_time() - time).abs() < 1e-5,
                "end action {then:?} in {steps} steps"
            );
            assert_eq!(track.is_paused(), then == EndAction::Pause);
        }
    }
    // Halfway through the time the eased weight is one half.
    let mut animator = Animator::new(&set);
    let track = animator.play(&set, &TrackDef { weight: 0.0, ..TrackDef::new(clip) });
    animator.fade(track, 1.0, 1.0, Easing::In, EndAction::Hold);
    animator.update(&set, 0.5);
    assert_eq!(animator.track(track).map(|track| track.def().weight), Some(0.25));
}

#[test]
fn one_shot_clip_takes_its_end_action() {
    let set = stage::set(6);
    let def = TrackDef { loop_mode: LoopMode::Once, ..TrackDef::new(ids(&set)[0]) };
    let after = |at_end, seconds: f32, steps: u32| {
        let mut animator = Animator::new(&set);
        let id = animator.play(&set, &TrackDef { at_end, ..def });
        (0..steps).for_each(|_| animator.update(&set, seconds / steps as f32));
        animator.track(id).map(|track| track.playhead().clip_time())
    };
    for steps in [1, 4, 100] {
        assert_eq!(after(EndAction::Hold, 1.25, steps), Some(1.0));
        assert_eq!(after(EndAction::Pause, 1.25, steps), Some(1.0));
        assert_eq!(after(EndAction::Stop, 1.25, steps), None);
        let again = after(EndAction::Restart, 2.25, steps).expect("the track restarts");
        assert!((again - 0.25).abs() < 1e-4, "restarted at {again} s in {steps} steps");
    }
}

/// Returns the events of a sequence of updates: seconds since the start, event number, and true if it was
/// interrupted.
fn fired(animator: &mut Animator, set: &AnimationSet, steps: &[f32]) -> Vec<(f64, u32, bool)> {
    let (mut out, mut now) = (Vec::new(), 0.0);
    for &step in steps {
        animator.update_with(set, step, |fired, event| {
            assert!((0.0..=f64::from(step)).contains(&fired.seconds));
            out.push((now + fired.seconds, event.payload.parse().expect("a number"), fired.is_interrupted));
        });
        now += f64::from(step);
    }
    out
}

fn numbered(time: f32, number: u32) -> ClipEvent {
    ClipEvent { payload: number.to_string(), ..ClipEvent::new(time, "step") }
}

#[test]
fn event_times_are_independent_of_the_steps() {
    let set = eventful(1.0, vec![numbered(0.0, 0), numbered(0.25, 1), numbered(1.0, 2)]);
    let def = TrackDef { speed: 2.0, ..TrackDef::new(ids(&set)[0]) };
    let mut random = Random::new(7);
    let whole = {
        let mut animator = Animator::new(&set);
        animator.play(&set, &def);
        fired(&mut animator, &set, &[4.0])
    };
    // Events occur at 0, and then in each cycle of half a second; end and start of a loop are one time.
    assert_eq!(whole.len(), 1 + 8 + 16);
    for (i, &(seconds, number, _)) in whole.iter().enumerate().filter(|(_, event)| event.1 == 1) {
        let lap = ((seconds - 0.125) / 0.5).round();
        assert!((seconds - 0.125 - 0.5 * lap).abs() < 1e-9, "event {i}, {number}");
    }
    for _ in 0..cases(20_000) {
        let mut animator = Animator::new(&set);
        animator.play(&set, &def);
        let mut left = 4 * 64;
        let mut steps = Vec::new();
        while left > 0 {
            let step = random.index(40).min(left);
            steps.push(step as f32 / 64.0);
            left -= step;
        }
        let parts = fired(&mut animator, &set, &steps);
        assert_eq!(parts.len(), whole.len());
        for (a, b) in parts.iter().zip(&whole) {
            assert!((a.0 - b.0).abs() < 1e-9 && a.1 == b.1, "{a:?} is not {b:?}");
        }
    }
}

#[test]
fn track_below_the_weight_threshold_fires_no_events() {
    let policy = EventPolicy { min_weight: 0.5, ..EventPolicy::default() };
    let events = (0..10).map(|i| ClipEvent { policy, ..numbered(0.1 * i as f32, i) }).collect();
    let set = eventful(1.0, events);
    for steps in [1, 7] {
        let mut animator = Animator::new(&set);
        let track = animator.play(&set, &TrackDef { weight: 0.0, ..TrackDef::new(ids(&set)[0]) });
        animator.fade(track, 1.0, 1.0, Easing::Linear, EndAction::Hold);
        // The weight exceeds one half at 0.5 s for any number of steps: the sixth event is the first to fire,
        // up to rounding.
        let numbers: Vec<u32> = fired(&mut animator, &set, &vec![0.98 / steps as f32; steps])
            .iter()
            .map(|event| event.1)
            .collect();
        assert_eq!(numbers, [5, 6, 7, 8, 9], "in {steps} steps");
    }
}

#[test]
fn interrupted_track_fires_its_remaining_events() {
    let on_interrupt = EventPolicy { on_interrupt: true, ..EventPolicy::default() };
    let put_right = |time, number| ClipEvent { policy: on_interrupt, ..numbered(time, number) };
    let set = eventful(1.0, vec![put_right(0.2, 0), numbered(0.6, 1), put_right(0.8, 2)]);
    let def = TrackDef { loop_mode: LoopMode::Once, ..TrackDef::new(ids(&set)[0]) };
    let mut animator = Animator::new(&set);
    let track = animator.play(&set, &def);
    let mut all = fired(&mut animator, &set, &[0.5]);
    animator.stop(&set, track);
    all.extend(fired(&mut animator, &set, &[0.5]));
    assert_eq!(all.iter().map(|e| (e.1, e.2)).collect::<Vec<_>>(), [(0, false), (2, true)]);
    // A fade-out that stops the track also ends on time; an ended clip fires no more events.
    let track = animator.play(&set, &def);
    animator.fade(track, 0.0, 0.5, Easing::Linear, EndAction::Stop);
    let all = fired(&mut animator, &set, &[2.0]);
    assert_eq!(
        all.iter().map(|e| (e.0, e.1, e.2)).collect::<Vec<_>>(),
        [(f64::from(0.2_f32), 0, false), (0.5, 2, true)]
    );
    let track = animator.play(&set, &def);
    let all = fired(&mut animator, &set, &[2.0]);
    assert_eq!(all.len(), 3);
    animator.stop(&set, track);
    assert!(fired(&mut animator, &set, &[0.1]).is_empty());
}

/// Returns a set with walk and run: 1 s and 0.6 s, with left and right footsteps at different times.
fn gaits(policy: EventPolicy) -> AnimationSet {
    let mut set = AnimationSet::new(Skeleton::new(&stage::rig()));
    for (duration, left, right) in [(1.0, 0.1, 0.6), (0.6, 0.2, 0.55)] {
        let clip = stage::build(&stage::swaying(&mut Random::new(8), duration), Fill::Rest);
        let events = vec![
            ClipEvent { policy, ..numbered(left, 0) },
            ClipEvent { policy, name: "right".to_owned(), ..numbered(right, 1) },
        ];
        set.add_clip(AnimatedClip { events, markers: Markers::new(vec![left, right]), ..clip });
    }
    set
}

#[test]
fn sync_group_aligns_footsteps() {
    let policy = EventPolicy { min_weight: 0.0, fired_by: FiredBy::OnePerGroup, ..EventPolicy::default() };
    let set = gaits(policy);
    let mut animator = Animator::new(&set);
    let [walk, run] = [0, 1].map(|i| TrackDef { sync_group: Some(0), ..TrackDef::new(ids(&set)[i]) });
    let walk = animator.play(&set, &TrackDef { start: 0.37, ..walk });
    let run = animator.play(&set, &TrackDef { weight: 0.0, ..run });
    animator.fade(walk, 0.0, 6.0, Easing::Linear, EndAction::Hold);
    animator.fade(run, 1.0, 6.0, Easing::Linear, EndAction::Hold);
    let mut steps = Vec::new();
    for _ in 0..600 {
        animator.update_with(&set, 0.01, |fired, event| steps.push((fired.track, event.payload.clone())));
        let time = |id| f64::from(animator.track(id).expect("the track exists").playhead().clip_time());
        // Between the same two footsteps, both clips are at the same fraction.
        let share = |time: f64, left: f64, right: f64, length: f64| {
            let since_left = (time - left).rem_euclid(length);
            let half = right - left;
            if since_left < half { since_left / half } else { 1.0 + (since_left - half) / (length - half) }
        };
        let (a, b) = (share(time(walk), 0.1, 0.6, 1.0), share(time(run), 0.2, 0.55, 0.6));
        let apart = (a - b).abs();
        assert!(apart.min(2.0 - apart) < 1e-4, "{a} and {b}");
    }
    // Left and right alternate, none is repeated although both clips have them, and the run fires the last
    // ones.
    assert!(steps.windows(2).all(|pair| pair[0].1 != pair[1].1), "{steps:?}");
    assert!(steps[0].0 == walk && steps[steps.len() - 1].0 == run);
    // The step frequency rises from 2 to 2 / 0.6 per second.
    let mean = 0.5 * (2.0 + 2.0 / 0.6) * 6.0;
    assert!((steps.len() as f64 - mean).abs() < 2.0, "{} steps", steps.len());
}

#[test]
fn track_that_joins_a_group_takes_its_phase() {
    let set = gaits(EventPolicy::default());
    let mut animator = Animator::new(&set);
    let [walk, run] = [0, 1].map(|i| TrackDef { sync_group: Some(3), ..TrackDef::new(ids(&set)[i]) });
    animator.play(&set, &walk);
    animator.update(&set, 0.35);
    let run = animator.play(&set, &TrackDef { weight: 0.1, ..run });
    // Both clips are halfway from left to right.
    let time = animator.track(run).expect("the track exists").playhead().clip_time();
    assert!((time - 0.375).abs() < 1e-4, "{time}");
}

#[test]
fn masks_and_layers_affect_only_their_joints() {
    let mut set = stage::set(9);
    let upper =
        set.add_mask((0..stage::JOINTS).map(|joint| if joint < 4 { 0.0 } else { 1.0 }).collect::<Mask>());
    let [below, above] = [0, 1].map(|i| ids(&set)[i]);
    let mut animator = Animator::new(&set);
    animator.play(&set, &TrackDef::new(below));
    animator.play(&set, &TrackDef { layer: 1, mask: Some(upper), ..TrackDef::new(above) });
    animator.update(&set, 0.4);
    let mut poses = [Pose::new(stage::JOINTS), Pose::new(stage::JOINTS)];
    for (pose, clip) in poses.iter_mut().zip([below, above]) {
        set.clip(clip).clip.sample(0.4, &mut sinew_anim::Cursor::new(), pose);
    }
    for joint in 0..stage::JOINTS {
        let expected = poses[usize::from(joint >= 4)].get(joint).rotation;
        assert!(animator.pose().get(joint).rotation.angle_to(expected) < 1e-3, "joint {joint}");
    }
}

#[test]
fn additive_clips_apply_in_joint_space() {
    let rig = stage::rig();
    let mut random = Random::new(10);
    let (base, lean) = (stage::swaying(&mut random, 1.0), stage::swaying(&mut random, 1.0));
    let reference = sinew_anim::rest_pose(&rig);
    let mut set = AnimationSet::new(Skeleton::new(&rig));
    let base = set.add_clip(stage::build(&base, Fill::Rest));
    let added = set.add_clip(stage::build(&lean.difference_from(&reference), Fill::Identity));
    let lean = set.add_clip(stage::build(&lean, Fill::Rest));
    let sample = |clip| {
        let mut pose = Pose::new(stage::JOINTS);
        set.clip(clip).clip.sample(0.3, &mut sinew_anim::Cursor::new(), &mut pose);
        pose
    };
    for weight in [0.0, 1.0] {
        let mut animator = Animator::new(&set);
        animator.play(&set, &TrackDef::new(base));
        animator.play(&set, &TrackDef { weight, ..TrackDef::new(added) });
        animator.update(&set, 0.3);
        for joint in 0..stage::JOINTS {
            let turn = reference[joint].rotation.inverse() * sample(lean).get(joint).rotation;
            let turn = if weight == 0.0 { Rotation::IDENTITY } else { turn };
            let expected = sample(base).get(joint).rotation * turn;
            let local = animator.pose().get(joint);
            assert!(local.rotation.angle_to(expected) < 2e-3, "joint {joint}");
            assert!((local.translation - reference[joint].translation).length() < 1e-6);
        }
    }
}

/// Walk and run have footstep events on opposite sides of their sync markers, while the leading clip changes
/// constantly.
#[test]
fn footstep_is_reported_once_for_any_leading_clip() {
    let policy = EventPolicy { min_weight: 0.0, fired_by: FiredBy::OnePerGroup, ..EventPolicy::default() };
    let mut set = AnimationSet::new(Skeleton::new(&stage::rig()));
    for (duration, left, right, late) in [(1.0, 0.02, 0.5, 0.03), (0.6, 0.04, 0.3, -0.03)] {
        let clip = stage::build(&stage::swaying(&mut Random::new(8), duration), Fill::Rest);
        let event =
            |time, number| ClipEvent { policy, name: "footstep".to_owned(), ..numbered(time + late, number) };
        let events = vec![event(left, 0), event(right, 1)];
        set.add_clip(AnimatedClip { events, markers: Markers::new(vec![left, right]), ..clip });
    }
    let mut random = Random::new(3);
    for run in 0..200 {
        let mut animator = Animator::new(&set);
        // The time is between two footsteps.
        let backward = if run % 2 == 0 { 1.0 } else { -1.0 };
        let tracks = [0, 1].map(|i| {
            let def =
                TrackDef { sync_group: Some(0), speed: backward, start: 0.25, ..TrackDef::new(ids(&set)[i]) };
            animator.play(&set, &def)
        });
        let mut steps = Vec::new();
        for _ in 0..60 {
            animator.set_weight(tracks[0], random.range(0.01, 1.0));
            animator.set_weight(tracks[1], random.range(0.01, 1.0));
            let seconds = random.range(0.0, 0.04);
            animator.update_with(&set, seconds, |_, event| steps.push(event.payload.clone()));
        }
        assert!(
            steps.windows(2).all(|pair| pair[0] != pair[1]),
            "steps must alternate between left and right: {steps:?}"
        );
        // The number of passed markers, with a tolerance of one at the current time.
        let place = animator.track(tracks[0]).expect("the track exists").playhead();
        let laps = place.lap() as f32 + place.clip_time() - 0.25;
        assert!((steps.len() as f32 - 2.0 * laps.abs()).abs() < 1.2, "{} steps in {laps} laps", steps.len());
    }
}

#[test]
fn crossfade_leaves_one_track() {
    let set = stage::set(12);
    let mut animator = Animator::new(&set);
    animator.play(&set, &TrackDef::new(ids(&set)[0]));
    animator.update(&set, 0.1);
    let fade = Transition::Crossfade { seconds: 0.4, easing: Easing::Smooth };
    let to = animator.transition(&set, &TrackDef::new(ids(&set)[1]), fade);
    animator.update(&set, 0.2);
    assert_eq!(animator.tracks().map(|track| track.def().weight).collect::<Vec<_>>(), [0.5, 0.5]);
    animator.update(&set, 0.3);
    assert_eq!(
        animator.tracks().map(|track| (track.id(), track.def().weight)).collect::<Vec<_>>(),
        [(to, 1.0)]
    );
}

/// Returns a clip of 1 s in which joints do not move.
fn held(rotation: impl Fn(usize) -> Rotation) -> AnimatedClip {
    let channel = |joint: usize| {
        let Rotation { x, y, z, w } = rotation(joint);
        let (property, interpolation) = (Property::Rotation, Interpolation::Linear);
        Channel { joint, property, interpolation, times: vec![0.0], values: vec![x, y, z, w] }
    };
    let channels = (0..stage::JOINTS).map(channel).collect();
    stage::build(&Clip { name: "held".to_owned(), duration: 1.0, channels }, Fill::Rest)
}

#[test]
fn crossfade_rotates_about_one_axis_with_its_easing() {
    // Poses are up to 175° apart, on opposite sides of half a turn from the rest pose.
    let axis = Vec3::new(1.0, 2.0, 2.0) / 3.0;
    let apart = |joint: usize| 0.3 * joint as f32;
    let around = |angle: f32| Rotation::from_axis_angle(axis, angle);
    let mut set = AnimationSet::new(Skeleton::new(&stage::rig()));
    let from = set.add_clip(held(|joint| around(3.0 - 0.5 * apart(joint))));
    let to = set.add_clip(held(|joint| around(3.0 + 0.5 * apart(joint))));
    let mut animator = Animator::new(&set);
    animator.play(&set, &TrackDef::new(from));
    animator.update(&set, 0.1);
    let fade = Transition::Crossfade { seconds: 1.0, easing: Easing::Smooth };
    animator.transition(&set, &TrackDef::new(to), fade);
    for step in 1..=20 {
        animator.update(&set, 0.05);
        let share = Easing::Smooth.at(0.05 * step as f32);
        for joint in 0..stage::JOINTS {
            let expected = around(3.0 + (share - 0.5) * apart(joint));
            let found = animator.pose().get(joint).rotation;
            assert!(
                found.angle_to(expected) < 2e-3,
                "joint {joint}, blend share {share}: rotation {found:?}"
            );
        }
    }
}

#[test]
fn nested_crossfades_are_continuous() {
    let set = stage::set(21);
    let mut animator = Animator::new(&set);
    animator.play(&set, &TrackDef::new(ids(&set)[0]));
    animator.update(&set, 0.01);
    let mut last = animator.pose().clone();
    for i in 0..120 {
        if i % 5 == 3 {
            let fade = Transition::Crossfade { seconds: 0.3, easing: Easing::Smooth };
            animator.transition(&set, &TrackDef::new(ids(&set)[i % 3]), fade);
        }
        animator.update(&set, 0.001);
        for (joint, (a, b)) in last.iter().zip(animator.pose().iter()).enumerate() {
            assert!(a.rotation.angle_to(b.rotation) < 0.03, "joint {joint} differs in update {i}");
        }
        last.copy_from(animator.pose());
    }
}

#[test]
#[should_panic = "the weight must be at least 0"]
fn negative_or_non_finite_weights_panic() {
    let set = stage::set(13);
    Animator::new(&set).play(&set, &TrackDef { weight: f32::NAN, ..TrackDef::new(ids(&set)[0]) });
}

#[test]
#[should_panic = "seconds must be finite and at least 0"]
fn negative_time_step_panics() {
    let set = stage::set(13);
    Animator::new(&set).update(&set, -0.1);
}
