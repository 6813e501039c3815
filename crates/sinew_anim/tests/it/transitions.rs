//! Transitions have no pops: velocity does not jump, and acceleration stays within a budget given by offset and time.

use crate::{rigs, stage};
use needs_data::needs_data;
use sinew_anim::{
    AnimatedClip, AnimationSet, Animator, BuiltClip, ClipBuildOptions, ClipId, Cursor, Decay, Easing,
    LocalTransform, LoopMode, Pose, Skeleton, TrackDef, Transition,
};
use sinew_math::{Random, Rotation, Vec3};

const DT: f32 = 1.0 / 60.0;
const BLEND: f32 = 0.3;
/// Number of updates of a transition, plus two.
const WINDOW: usize = 20;

#[test]
fn decay_starts_with_its_velocity_and_ends_at_rest() {
    let mut random = Random::new(1);
    let mut longest: f32 = 0.0;
    for _ in 0..2_000 {
        let (offset, velocity) = (random.in_cube() * random.unit(), random.in_cube() * (8.0 * random.unit()));
        let decay = Decay { offset, velocity };
        let seconds = random.range(0.1, 1.0);
        assert!((decay.at(0.0, seconds) - offset).length() < 1e-6);
        let h = 1e-3 * seconds;
        let start = (decay.at(h, seconds) - decay.at(0.0, seconds)) / h;
        let shortened = decay.shortened(seconds);
        let budget = 6.0 * offset.length() / (shortened * shortened) + 4.0 * velocity.length() / shortened;
        assert!(
            (start - velocity).length() < h * budget + 1e-3,
            "start velocity {start}, expected {velocity}"
        );
        assert_eq!(decay.at(seconds, seconds), Vec3::ZERO);
        assert!(decay.at(seconds - h, seconds).length() < 1e-5);
        // Second differences over a hundredth of the time approximate the acceleration.
        let h = 0.01 * seconds;
        for i in 1..100 {
            let at = |k: usize| decay.at(h * k as f32, seconds);
            let peak = (at(i + 1) - at(i) * 2.0 + at(i - 1)).length() / (h * h);
            assert!(
                peak < budget * 1.01 + 0.05,
                "the peak {peak} exceeds the bound {budget}: {decay:?} in {seconds} s"
            );
            longest = sinew_math::max(longest, peak / budget);
        }
    }
    assert!(longest > 0.8, "the bound is loose; longest blend {longest}");
}

#[test]
fn returning_offset_does_not_overshoot() {
    for (size, speed) in [(0.5, 0.0), (0.5, -2.0), (0.5, -8.0), (0.3, -4.9)] {
        let decay = Decay { offset: Vec3::X * size, velocity: Vec3::X * speed };
        assert!((0..=300).all(|i| decay.at(0.001 * i as f32, 0.3).x > -1e-6), "{decay:?}");
    }
    assert!(Decay { offset: Vec3::X * 0.5, velocity: Vec3::X * -9.0 }.shortened(0.3) < 0.28);
}

/// Returns a set with the looped clips of a rig.
fn set_of(file: &str) -> AnimationSet {
    let (rig, clips) = rigs::load(&format!("rigs/{file}"));
    let mut set = AnimationSet::new(Skeleton::new(&rig));
    for clip in &clips {
        let built = BuiltClip::build(clip, &rig, &ClipBuildOptions::default()).expect("an open clip");
        set.add_clip(AnimatedClip::from(built));
    }
    set
}

fn turn(from: Rotation, to: Rotation) -> Vec3 {
    (to * from.inverse()).to_scaled_axis()
}

/// Angular and linear rate of a joint, per second or per second squared.
#[derive(Clone, Copy, Default)]
struct Rates {
    turn: Vec3,
    way: Vec3,
}

fn velocity(a: &LocalTransform, b: &LocalTransform) -> Rates {
    Rates { turn: turn(a.rotation, b.rotation) / DT, way: (b.translation - a.translation) / DT }
}

fn change(a: Rates, b: Rates) -> [f32; 2] {
    [(b.turn - a.turn).length() / DT, (b.way - a.way).length() / DT]
}

/// Returns the accelerations of a joint over a sequence of poses (two fewer than poses).
fn accelerations(poses: &[Pose], joint: usize) -> Vec<[f32; 2]> {
    let rates: Vec<Rates> = poses.windows(2).map(|w| velocity(&w[0].get(joint), &w[1].get(joint))).collect();
    rates.windows(2).map(|w| change(w[0], w[1])).collect()
}

/// A clip played alone, with the 99th percentile of its joints' accelerations.
struct Alone {
    poses: Vec<Pose>,
    p99: Vec<[f32; 2]>,
}

impl Alone {
    fn new(set: &AnimationSet, clip: ClipId) -> Self {
        let built = &set.clip(clip).clip;
        let mut cursor = Cursor::new();
        let steps = (built.duration() / DT) as usize + 2 * WINDOW + 4;
        let pose = |i: usize| {
            let mut pose = Pose::new(built.joints());
            built.sample(i as f32 * DT, &mut cursor, &mut pose);
            pose
        };
        let poses: Vec<Pose> = (0..steps).map(pose).collect();
        let inside = &poses[..poses.len() - 2 * WINDOW];
        let p99 = |joint| {
            let all = accelerations(inside, joint);
            [0, 1].map(|kind| {
                let mut sorted: Vec<f32> = all.iter().map(|a| a[kind]).collect();
                sorted.sort_by(f32::total_cmp);
                sorted[(sorted.len() - 1) * 99 / 100]
            })
        };
        Self { p99: (0..built.joints()).map(p99).collect(), poses }
    }

    /// Returns the largest accelerations of a joint near the poses from `first` on.
    fn peak(&self, joint: usize, first: usize) -> [f32; 2] {
        let window = &self.poses[first.saturating_sub(2)..(first + WINDOW + 2).min(self.poses.len())];
        accelerations(window, joint)
            .into_iter()
            .fold([0.0; 2], |worst, a| [0, 1].map(|i| sinew_math::max(worst[i], a[i])))
    }
}

/// Returns the largest ratio of acceleration to budget for a pair of clips, and its joint.
fn worst_of_pair(
    set: &AnimationSet,
    alone: &[Alone],
    clips: [usize; 2],
    transition: Transition,
) -> (f32, usize) {
    let [from, to] = clips.map(|i| set.clips().nth(i).expect("a clip"));
    let def = |clip| TrackDef { loop_mode: LoopMode::Once, ..TrackDef::new(clip) };
    let mut animator = Animator::new(set);
    let first = 2 + (set.clip(from).clip.duration() / DT * 0.4) as usize;
    animator.play(set, &TrackDef { start: (first - 2) as f32 * DT, ..def(from) });
    let mut poses = Vec::new();
    for i in 0..WINDOW + 2 {
        if i == 3 {
            animator.transition(set, &def(to), transition);
        }
        animator.update(set, if i == 0 { 0.0 } else { DT });
        poses.push(animator.pose().clone());
    }
    let (a, b) = (&alone[clips[0]], &alone[clips[1]]);
    let (mut worst, mut where_) = (0.0, 0);
    for joint in 0..set.skeleton().len() {
        let peak = accelerations(&poses, joint)
            .into_iter()
            .fold([0.0; 2], |worst, a| [0, 1].map(|i| sinew_math::max(worst[i], a[i])));
        let own = [a.peak(joint, first), b.peak(joint, 0)];
        let budget = budget([a, b], joint, first, transition);
        for kind in 0..2 {
            let p99 = sinew_math::max(a.p99[joint][kind], b.p99[joint][kind]);
            let clips = sinew_math::max(1.2 * p99, sinew_math::max(own[0][kind], own[1][kind]));
            let size = if kind == 0 { 0.5 } else { 0.01 };
            let ratio = peak[kind] / (clips + budget[kind] + size);
            if ratio > worst {
                (worst, where_) = (ratio, joint);
            }
        }
    }
    (worst, where_)
}

/// Returns the budget `6 |x₀|/t₁² + 4 |v₀|/t₁` for rotation and translation, from the offset at the start of the
/// transition. For a crossfade, whose clips diverge, the largest offset during the transition counts.
fn budget([a, b]: [&Alone; 2], joint: usize, first: usize, transition: Transition) -> [f32; 2] {
    let is_inertial = matches!(transition, Transition::Inertial { .. });
    let lasting = if is_inertial { 1 } else { WINDOW };
    let mut most = [0.0_f32; 2];
    for k in 0..lasting {
        let from = [k, k + 1].map(|i| a.poses[(first + i).min(a.poses.len() - 1)].get(joint));
        let before = a.poses[first + k - 1].get(joint);
        let to = [k, k + 1].map(|i| b.poses[i.min(b.poses.len() - 1)].get(joint));
        let (old, new) = (velocity(&before, &from[0]), velocity(&to[0], &to[1]));
        let offsets = [turn(to[0].rotation, from[0].rotation), from[0].translation - to[0].translation];
        let velocities = [old.turn - new.turn, old.way - new.way];
        for kind in 0..2 {
            let decay = Decay { offset: offsets[kind], velocity: velocities[kind] };
            let time = if is_inertial { decay.shortened(BLEND) } else { BLEND };
            let sum = 6.0 * decay.offset.length() / (time * time) + 4.0 * decay.velocity.length() / time;
            most[kind] = sinew_math::max(most[kind], sum);
        }
    }
    most
}

fn no_pops(file: &str, transition: Transition, allowed: f32) {
    let set = set_of(file);
    let alone: Vec<Alone> = set.clips().map(|clip| Alone::new(&set, clip)).collect();
    let (mut worst, mut pairs, mut beyond) = ((0.0, String::new()), 0, 0);
    let stride = if alone.len() < 20 || std::env::var_os("SINEW_FULL").is_some() { 1 } else { 7 };
    let names: Vec<&str> = set.clips().map(|clip| set.clip(clip).clip.name()).collect();
    for from in 0..alone.len() {
        // With many clips only some pairs are tested, but all pairs with `SINEW_FULL` set.
        for to in (0..alone.len()).filter(|&to| to != from && (from + to) % stride == 0) {
            let (ratio, joint) = worst_of_pair(&set, &alone, [from, to], transition);
            pairs += 1;
            beyond += u32::from(ratio > 1.0);
            if ratio > worst.0 {
                worst = (ratio, format!("{} to {}, joint {joint}", names[from], names[to]));
            }
        }
    }
    println!("{file}, {transition:?}: {pairs} pairs, {beyond} beyond 1, worst {worst:?}");
    assert!(worst.0 <= allowed, "{file}: {worst:?}");
}

const INERTIAL: Transition = Transition::Inertial { seconds: BLEND };
const CROSSFADE: Transition = Transition::Crossfade { seconds: BLEND, easing: Easing::Smooth };

#[needs_data]
#[test]
fn no_pair_of_mannequiny_pops() {
    no_pops("mannequiny.glb", INERTIAL, 1.0);
    no_pops("mannequiny.glb", CROSSFADE, 1.0);
}

#[needs_data]
#[test]
fn no_pair_of_the_knight_pops() {
    no_pops("kaykit_Knight.glb", INERTIAL, 1.0);
    no_pops("kaykit_Knight.glb", CROSSFADE, 1.0);
}

#[test]
fn nested_transitions_do_not_pop() {
    let set = stage::set(4);
    let clips: Vec<ClipId> = set.clips().collect();
    let mut animator = Animator::new(&set);
    animator.play(&set, &TrackDef::new(clips[0]));
    let mut poses = Vec::new();
    for i in 0..120 {
        if i % 7 == 5 {
            animator.transition(&set, &TrackDef::new(clips[i % 3]), INERTIAL);
        }
        animator.update(&set, DT);
        poses.push(animator.pose().clone());
    }
    for joint in 0..stage::JOINTS {
        for (i, pair) in accelerations(&poses, joint).iter().enumerate() {
            // Swings of up to 0.8 rad at up to 1.5 Hz, offsets up to 3 rad.
            assert!(
                pair[0] < 6.0 * 3.0 / (BLEND * BLEND) + 4.0 * 15.0 / BLEND,
                "joint {joint}, update {i}: accelerations {pair:?}"
            );
        }
    }
    let last = animator.pose().clone();
    animator.update(&set, 0.0);
    assert_eq!(*animator.pose(), last, "an update of zero length must not change the pose");
}
