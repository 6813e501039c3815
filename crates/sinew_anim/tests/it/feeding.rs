//! Checks that a clip whose pose is supplied by the caller behaves like a played clip.

use crate::stage;
use sinew_anim::{AnimationSet, Animator, Clip, ClipId, Fill, Pose, Skeleton, TrackDef, Transition};
use sinew_math::{Random, Reader, Writer};

const DT: f32 = 1.0 / 60.0;

/// Returns a set with a motion, another motion, and a clip without channels.
fn set() -> (AnimationSet, [ClipId; 3]) {
    let (mut set, mut random) = (AnimationSet::new(Skeleton::new(&stage::rig())), Random::new(5));
    let sways = [1.0, 0.8].map(|duration| stage::swaying(&mut random, duration));
    let [a, b] = sways.map(|clip| set.add_clip(stage::build(&clip, Fill::Rest)));
    let empty = Clip { name: "from outside".to_owned(), duration: 1.0, channels: Vec::new() };
    let empty = set.add_clip(stage::build(&empty, Fill::Rest));
    (set, [a, b, empty])
}

/// Returns the largest angle between joints, radians.
fn apart(a: &Pose, b: &Pose) -> f32 {
    a.iter().zip(b.iter()).map(|(a, b)| a.rotation.angle_to(b.rotation)).fold(0.0, sinew_math::max)
}

/// Returns two animators after `steps` updates: one plays the motion, and the other is fed the pose of the
/// first.
fn twins(set: &AnimationSet, [played, _, empty]: [ClipId; 3], steps: usize) -> [Animator; 2] {
    let mut twins = [Animator::new(set), Animator::new(set)];
    twins[0].play(set, &TrackDef::new(played));
    twins[1].play(set, &TrackDef::new(empty));
    for _ in 0..steps {
        go_on(set, empty, &mut twins);
    }
    twins
}

fn go_on(set: &AnimationSet, empty: ClipId, [player, fed]: &mut [Animator; 2]) {
    player.update(set, DT);
    fed.feed(set, empty, player.pose());
    fed.update(set, DT);
}

#[test]
fn fed_clip_shows_the_given_pose() {
    let (set, clips) = set();
    let mut twins = twins(&set, clips, 0);
    for step in 0..90 {
        go_on(&set, clips[2], &mut twins);
        let off = apart(twins[0].pose(), twins[1].pose());
        assert!(off < 1e-3, "step {step}: off by {off} rad");
    }
}

#[test]
fn prediction_extrapolates_the_fed_pose() {
    let (set, clips) = set();
    // The time is between two keys, where the speeds before and after it are equal.
    let [player, fed] = twins(&set, clips, 22);
    let mut ahead = [player.clone(), fed.clone()];
    ahead[1].copy_from(&fed);
    ahead.iter_mut().for_each(|animator| animator.update(&set, DT));
    let (moved, off) = (apart(player.pose(), ahead[0].pose()), apart(ahead[0].pose(), ahead[1].pose()));
    assert!(off < 0.2 * moved, "off by {off} rad after a motion of {moved} rad");
    // The extrapolation is limited in time.
    let mut alone = fed;
    (0..12).for_each(|_| alone.update(&set, DT));
    let last = alone.pose().clone();
    alone.update(&set, DT);
    assert_eq!(alone.pose(), &last);
}

#[test]
fn transition_inherits_the_speed_of_the_fed_pose() {
    let (set, [played, other, empty]) = set();
    let mut twins = twins(&set, [other, played, empty], 0);
    // At first the fed animator plays the other motion itself.
    twins[1] = twins[0].clone();
    let mut outside = Animator::new(&set);
    outside.play(&set, &TrackDef::new(played));
    for step in 0..60 {
        outside.update(&set, DT);
        twins[1].feed(&set, empty, outside.pose());
        if step == 20 {
            for (animator, clip) in twins.iter_mut().zip([played, empty]) {
                let start = DT * 20.0;
                let def = TrackDef { start, ..TrackDef::new(clip) };
                animator.transition(&set, &def, Transition::Inertial { seconds: 0.3 });
            }
        }
        twins.iter_mut().for_each(|animator| animator.update(&set, DT));
        let off = apart(twins[0].pose(), twins[1].pose());
        assert!(off < 2e-3, "step {step}: off by {off} rad");
    }
}

#[test]
fn loaded_animator_can_be_fed() {
    let (set, clips) = set();
    let [_, fed] = twins(&set, clips, 20);
    let mut out = Writer::new();
    fed.save(&set, &mut out);
    let bytes = out.into_bytes();
    let mut loaded =
        Animator::load(&set, &mut Reader::new(&bytes)).expect("the saved animator can be loaded");
    let mut fed = fed;
    for _ in 0..3 {
        fed.update(&set, DT);
        loaded.update(&set, DT);
        assert_eq!(fed.pose(), loaded.pose());
    }
    for end in 0..bytes.len() {
        assert!(
            Animator::load(&set, &mut Reader::new(&bytes[..end])).is_err(),
            "a snapshot of {end} bytes must be refused"
        );
    }
}
