//! Spring bones through changes: level of detail, falls, teleports, pauses, sizes, rates. The bounds on the speed of
//! tips were set before measuring:
//!
//! - **Law**: along the bone, a tip moves no faster than its joint (or than the head, which may push it). Across the
//!   bone, it moves no faster than in the previous frame, plus what stiffness and gravity add. The bound is the root of
//!   the sum of both squares, plus a tenth for curved paths, plus a fifth between ticks (ADR 0020).
//! - **Easing**: the speed of the animated tip, plus for each bone above it 1/0.3 s times its angle from the pose times
//!   the tip's distance from that bone.
//! - **Return**: the change of a tip's velocity is that of its joint, plus the loss by drag, plus the part of stiffness
//!   and gravity across the bone.

use super::{place_at, still};
use sinew_anim::{LocalTransform, SpringBone, SpringChain, local_to_model, rest_pose};
use sinew_math::{Affine, Reader, Rotation, Transform, Vec3, Writer, max, min, trig};
use sinew_physics::{BodyDef, Shape, World, WorldDef};
use sinew_ragdoll::{Character, CharacterDef, Detail, SpringSwing, State};
use sinew_scenes::maned::{HAIR, maned};
use std::sync::Arc;

/// Tolerance for rounding, m/s.
const ROUNDING: f32 = 0.005;

/// A drawn spring bone, in the world.
#[derive(Clone, Copy)]
struct Seen {
    joint: Vec3,
    tip: Vec3,
    /// Stiffness and gravity across the bone, m/s.
    across: f32,
    /// Rotation from the pose, radians.
    off: f32,
    drag: f32,
    chain: usize,
}

/// Velocities of a bone in a frame, m/s.
#[derive(Clone, Copy, Default)]
struct Motion {
    tip: Vec3,
    joint: Vec3,
    /// Velocity of the tip if it moved rigidly with the head.
    head: Vec3,
}

/// Returns the bones of a pose with springs, chain by chain, and the head.
fn seen(
    def: &CharacterDef,
    root: Affine,
    shown: &[LocalTransform],
    plain: &[LocalTransform],
) -> (Vec<Seen>, Affine) {
    let mut model = Vec::new();
    local_to_model(&def.rig, shown, &root, &mut model);
    let springs = def.springs().source();
    let bone = |chain: usize, bone: &SpringBone| {
        let at = model[bone.joint];
        let (joint, tip) = (at.translation, at.point(bone.tail));
        let parent = model[def.rig.joints[bone.joint].parent.expect("a bone has a parent")];
        let rest = parent.vector(plain[bone.joint].rotation * bone.tail).normalize();
        let along = (tip - joint).normalize();
        let force = rest * bone.stiffness + bone.gravity;
        let off = shown[bone.joint].rotation.angle_to(plain[bone.joint].rotation);
        Seen { joint, tip, across: (force - along * force.dot(along)).length(), off, drag: bone.drag, chain }
    };
    let bones = |(index, chain): (usize, &SpringChain)| {
        chain.bones.iter().map(move |b| bone(index, b)).collect::<Vec<_>>()
    };
    (springs.chains.iter().enumerate().flat_map(bones).collect(), model[springs.colliders[0].joint])
}

/// Margin of the fastest tip of a frame below each bound, m/s; negative if the tip was too fast.
#[derive(Clone, Copy, Debug)]
struct Slack {
    law: f32,
    easing: f32,
    back: f32,
}

impl Slack {
    const ALL: Self = Self { law: f32::INFINITY, easing: f32::INFINITY, back: f32::INFINITY };

    fn least(self, other: Self) -> Self {
        Self {
            law: min(self.law, other.law),
            easing: min(self.easing, other.easing),
            back: min(self.back, other.back),
        }
    }
}

/// Records the speeds of spring bones.
struct Watch {
    rate: f32,
    bones: Vec<Seen>,
    head: Affine,
    motions: Vec<Motion>,
    /// Largest speed of a tip, and of a tip carried rigidly by the head, m/s.
    fastest: f32,
    carried: f32,
}

impl Watch {
    fn new(rate: f32) -> Self {
        let (bones, motions) = (Vec::new(), Vec::new());
        Self { rate, bones, head: Affine::IDENTITY, motions, fastest: 0.0, carried: 0.0 }
    }

    /// Moves the last frame along with a displaced character.
    fn carry(&mut self, moved: Transform) {
        self.head = Affine::from(moved) * self.head;
        for bone in &mut self.bones {
            (bone.joint, bone.tip) = (moved.point(bone.joint), moved.point(bone.tip));
        }
        for motion in &mut self.motions {
            for v in [&mut motion.tip, &mut motion.joint, &mut motion.head] {
                *v = moved.rotation * *v;
            }
        }
    }

    /// Scales the last frame about the origin along with the character.
    fn resize(&mut self, factor: f32) {
        let larger =
            Affine::from_scale_rotation_translation(Vec3::splat(factor), Rotation::IDENTITY, Vec3::ZERO);
        self.head = larger * self.head;
        for bone in &mut self.bones {
            (bone.joint, bone.tip) = (bone.joint * factor, bone.tip * factor);
        }
        for motion in &mut self.motions {
            for v in [&mut motion.tip, &mut motion.joint, &mut motion.head] {
                *v *= factor;
            }
        }
    }

    fn look(&mut self, character: &Character) -> Slack {
        let root = character.world_from_model();
        self.frame(character.def(), root, character.pose(), character.pose_without_springs())
    }

    fn frame(
        &mut self,
        def: &CharacterDef,
        root: Affine,
        shown: &[LocalTransform],
        plain: &[LocalTransform],
    ) -> Slack {
        let (now, head) = seen(def, root, shown, plain);
        let way = head * self.head.inverse();
        let mut motions = vec![Motion::default(); now.len()];
        let mut slack = Slack::ALL;
        for (k, (was, is)) in self.bones.iter().zip(&now).enumerate() {
            motions[k] = Motion {
                tip: (is.tip - was.tip) * self.rate,
                joint: (is.joint - was.joint) * self.rate,
                head: (way.point(was.tip) - was.tip) * self.rate,
            };
            slack = slack.least(self.slack(k, was, is, &motions[k]));
            self.fastest = max(self.fastest, motions[k].tip.length());
            self.carried = max(self.carried, motions[k].head.length());
        }
        (self.bones, self.head, self.motions) = (now, head, motions);
        slack
    }

    fn slack(&self, k: usize, was: &Seen, is: &Seen, motion: &Motion) -> Slack {
        let (had, speed, ticks) = (&self.motions[k], motion.tip.length(), max(1.0, 60.0 / self.rate));
        let force = max(was.across, is.across) * ticks;
        let bent = if self.rate == 60.0 { 1.1 } else { 1.2 };
        // A growing bone carries its tip along.
        let length = (is.tip - is.joint).length();
        let grown = (length - (was.tip - was.joint).length()).abs() * self.rate;
        let (carried, across) = (max(motion.joint.length(), motion.head.length()), had.tip.length() + force);
        let law = bent * (carried * carried + across * across).sqrt() + grown;
        let above = self.bones[..=k].iter().filter(|bone| bone.chain == was.chain);
        let easing: f32 = above.map(|bone| bone.off * (was.tip - bone.joint).length() / 0.3).sum();
        let change = (motion.tip - had.tip).length();
        let carried = max((motion.joint - had.joint).length(), (motion.head - had.head).length());
        let taken = 1.0 - trig::pow(1.0 - is.drag, ticks);
        let about = (motion.tip - motion.joint).length();
        let jumps = if self.rate == 60.0 { 0.0 } else { 0.2 * speed };
        let back = bent * (carried + taken * had.tip.length() + force)
            + about * about / (length * self.rate)
            + jumps;
        Slack {
            law: law + ROUNDING - speed,
            easing: motion.head.length() + easing + ROUNDING - speed,
            back: back + ROUNDING - change,
        }
    }
}

/// Returns a character with hair that walks over a floor, and its world, at a frame rate.
fn walking(rate: u64) -> (World, Character) {
    let mut world = World::new(WorldDef { step_nanoseconds: 1_000_000_000 / rate, ..WorldDef::default() });
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let character = Character::spawn(&mut world, &Arc::new(maned(&HAIR)), Transform::IDENTITY);
    (world, character)
}

fn step(world: &mut World, character: &mut Character) {
    world.step();
    character.update(world);
}

/// Simulates a period at low detail, and the return. Returns the smallest margins: of easing, of the first twentieth of
/// a second after the return, and of the law in the first third.
fn away_and_back(rate: u64, seconds: f32) -> (Watch, Slack) {
    let (mut world, mut character) = walking(rate);
    let (mut watch, frames) =
        (Watch::new(rate as f32), |seconds: f32| (seconds * rate as f32).round() as u32);
    let mut least = Slack::ALL;
    for _ in 0..frames(1.5) {
        step(&mut world, &mut character);
        watch.look(&character);
    }
    character.set_level_of_detail(&mut world, Detail::Keyed);
    for _ in 0..frames(seconds) {
        step(&mut world, &mut character);
        least.easing = min(least.easing, watch.look(&character).easing);
    }
    let is_away = core::ptr::eq(character.pose(), character.pose_without_springs());
    assert_eq!(is_away, seconds > 3.5, "after {seconds} s at {rate} Hz");
    character.set_level_of_detail(&mut world, Detail::Full);
    for frame in 0..frames(0.33) {
        step(&mut world, &mut character);
        let slack = watch.look(&character);
        least.law = min(least.law, slack.law);
        if frame <= frames(0.05) {
            least.back = min(least.back, slack.back);
        }
    }
    let off = watch.bones.iter().map(|bone| bone.off).fold(0.0, max);
    assert!(off > 0.05, "the hair does not swing again: {off} rad");
    (watch, least)
}

#[test]
fn tips_do_not_jump_on_changes_of_detail() {
    for rate in [30, 60, 240] {
        for seconds in [0.1, 4.0] {
            let (watch, least) = away_and_back(rate, seconds);
            println!(
                "{rate} a second, {seconds} s away: {least:.3?}, fastest {} of {}",
                watch.fastest, watch.carried
            );
            assert!(
                least.easing > 0.0 && least.law > 0.0 && least.back > 0.0,
                "{rate} Hz, {seconds} s: margins {least:?} m/s"
            );
        }
    }
}

#[test]
fn distant_springs_are_not_simulated() {
    let def = maned(&HAIR);
    let pose = rest_pose(&def.rig);
    let mut swing = SpringSwing::new();
    let at = |frame: u16| Affine::from(place_at(f32::from(frame) / 60.0));
    for frame in 0..60 {
        swing.step(&still(&def, &pose, at(frame), 1.0 / 60.0));
    }
    let most = |swing: &SpringSwing| {
        let joints = def.springs().joints().zip(swing.turns());
        joints.map(|(joint, &turn)| pose[joint].rotation.angle_to(turn)).fold(0.0, max)
    };
    let began = most(&swing);
    for frame in 60..78 {
        swing.ease(&still(&def, &pose, at(frame), 1.0 / 60.0));
    }
    // 18 frames are 0.3 s, after which 1/e remains at every rate.
    assert!((most(&swing) / began - trig::exp(-1.0)).abs() < 1e-3, "{} of {began}", most(&swing));
    for frame in 78..360 {
        swing.ease(&still(&def, &pose, at(frame), 1.0 / 60.0));
    }
    assert!(swing.is_away() && swing.turns().is_empty());
    // A step computes nothing: no bit of state or scratch memory changes.
    let bits = format!("{swing:?}");
    for frame in 360..600 {
        swing.ease(&still(&def, &pose, at(frame), 1.0 / 60.0));
    }
    assert_eq!(format!("{swing:?}"), bits);
}

#[test]
fn easing_recovers_from_non_finite_clips() {
    let def = maned(&HAIR);
    let pose = rest_pose(&def.rig);
    let mut swing = SpringSwing::new();
    for frame in 0..60_u8 {
        let at = Affine::from(place_at(f32::from(frame) / 60.0));
        swing.step(&still(&def, &pose, at, 1.0 / 60.0));
    }
    // A clip has non-finite values for a bone in the frame in which easing starts.
    let first = def.springs().joints().next().expect("it has springs");
    let mut broken = pose.clone();
    broken[first].rotation = Rotation::from_scaled_axis(Vec3::splat(f32::NAN));
    swing.ease(&still(&def, &broken, Affine::IDENTITY, 1.0 / 60.0));
    swing.ease(&still(&def, &pose, Affine::IDENTITY, 1.0 / 60.0));
    assert!(swing.turns().iter().all(|turn| turn.is_finite()) && !swing.is_away());
    let mut w = Writer::new();
    swing.save(&mut w);
    let mut bytes = w.into_bytes();
    assert!(SpringSwing::load(def.springs(), &mut Reader::new(&bytes)).is_ok());
    bytes[1..5].copy_from_slice(&f32::INFINITY.to_le_bytes());
    assert!(SpringSwing::load(def.springs(), &mut Reader::new(&bytes)).is_err());
    for _ in 0..300 {
        swing.ease(&still(&def, &pose, Affine::IDENTITY, 1.0 / 60.0));
    }
    assert!(swing.is_away());
}

#[test]
fn character_created_far_away_starts_at_rest() {
    let (mut world, mut character) = walking(60);
    character.set_level_of_detail(&mut world, Detail::Keyed);
    for frame in 0..30 {
        step(&mut world, &mut character);
        assert_eq!(character.pose(), character.pose_without_springs());
        assert!(frame == 0 || core::ptr::eq(character.pose(), character.pose_without_springs()));
    }
    // The level with hit bodies counts as near.
    character.set_level_of_detail(&mut world, Detail::HitBodies);
    step(&mut world, &mut character);
    assert_eq!(character.pose(), character.pose_without_springs());
    for _ in 0..10 {
        step(&mut world, &mut character);
    }
    assert_ne!(character.pose(), character.pose_without_springs());
}

#[test]
fn snapshot_during_easing_continues_identically() {
    let bytes = |character: &Character| {
        let mut w = Writer::new();
        character.save(&mut w);
        w.into_bytes()
    };
    // Test during easing, while far away, and one step after the return.
    for (eased, near, back) in [(30, 0, 20), (600, 0, 20), (600, 0, 0), (600, 1, 20), (30, 1, 20)] {
        let (mut world, mut character) = walking(144);
        (0..101).for_each(|_| step(&mut world, &mut character));
        character.set_level_of_detail(&mut world, Detail::Keyed);
        (0..eased).for_each(|_| step(&mut world, &mut character));
        if near > 0 {
            character.set_level_of_detail(&mut world, Detail::Full);
            step(&mut world, &mut character);
        }
        let mut copy = Character::new(character.def().clone(), Transform::IDENTITY, 0.0);
        copy.load(&mut Reader::new(&bytes(&character))).unwrap();
        assert_eq!(copy.pose(), character.pose(), "{eased} {near}");
        let mut other = world.clone();
        for frame in 0..60 {
            if frame == back {
                character.set_level_of_detail(&mut world, Detail::Full);
                copy.set_level_of_detail(&mut other, Detail::Full);
            }
            step(&mut world, &mut character);
            step(&mut other, &mut copy);
            assert_eq!(
                bytes(&copy),
                bytes(&character),
                "easing {eased}, near {near}, frame {frame}: other bytes"
            );
            assert_eq!(copy.pose(), character.pose());
        }
        let cut = &bytes(&character)[..bytes(&character).len() - 9];
        assert!(copy.load(&mut Reader::new(cut)).is_err());
    }
}

#[test]
fn old_snapshots_without_easing_are_read() {
    // Old snapshots stored one byte that tells whether springs swing; the rest is unchanged.
    let def = maned(&HAIR);
    let saved = |swing: &SpringSwing| {
        let mut w = Writer::new();
        swing.save(&mut w);
        w.into_bytes()
    };
    let mut swing = SpringSwing::new();
    assert_eq!(saved(&swing), [0]);
    swing.step(&still(&def, &rest_pose(&def.rig), Affine::IDENTITY, 1.0 / 60.0));
    let bones = def.springs().joints().len();
    let bytes = saved(&swing);
    // The bytes are a phase, 13 tips, displacements and rotations, a step length, and whole frames for bones that do
    // not swing.
    assert_eq!((bytes[0], (bytes.len() - 9 - 40 * bones) % 96), (1, 0));
    assert!(SpringSwing::load(def.springs(), &mut Reader::new(&[4])).is_err());
}

/// Returns the smallest margin of the law around each change of state, for a character that is hit while it walks:
/// (state, margin, m/s).
fn life(rate: u64) -> (Watch, Vec<(State, f32)>) {
    let (mut world, mut character) = walking(rate);
    let mut watch = Watch::new(rate as f32);
    character.set_move(Vec3::Z * 1.2);
    let (chest, tenth) = (character.def().body_named("chest").unwrap(), rate as usize / 10);
    let (mut states, mut slacks) = (vec![(0, State::Animated)], Vec::new());
    for frame in 0..20 * rate as usize {
        if frame == rate as usize {
            character.hit(&mut world, chest, Vec3::new(30.0, 0.0, -90.0));
        }
        step(&mut world, &mut character);
        slacks.push(watch.look(&character).law);
        if states.last().unwrap().1 != character.state() {
            states.push((frame, character.state()));
        }
    }
    let about = |&(frame, state): &(usize, State)| {
        let frames = &slacks[usize::max(frame, tenth) - tenth..frame + tenth];
        (state, frames.iter().copied().fold(f32::INFINITY, min))
    };
    let least = states.iter().map(about).collect();
    println!(
        "{rate} a second, all of its life: {:.3} m/s left",
        slacks.iter().copied().fold(f32::INFINITY, min)
    );
    (watch, least)
}

#[test]
fn tip_speed_is_bounded_at_hand_over() {
    for rate in [60, 240] {
        let (watch, changes) = life(rate);
        println!("{rate} a second: {changes:.3?}, fastest {}", watch.fastest);
        for state in [State::Limp, State::GettingUp, State::Animated] {
            assert!(changes.iter().any(|change| change.0 == state), "{changes:?}");
        }
        assert!(changes.iter().all(|change| change.1 > 0.0), "{changes:?} m/s");
    }
}

#[test]
fn tip_speed_is_bounded_when_going_limp_without_a_mover() {
    let (mut world, character) = walking(60);
    character.despawn(&mut world);
    let mut character = Character::new(Arc::new(maned(&HAIR)), Transform::IDENTITY, 0.3);
    let mut watch = Watch::new(60.0);
    for frame in 0..120 {
        if frame == 60 {
            character.go_limp(&mut world);
        }
        step(&mut world, &mut character);
        let slack = watch.look(&character);
        assert!(!(50..80).contains(&frame) || slack.law > 0.0, "frame {frame}: margins {slack:?} m/s");
    }
    assert_eq!(character.state(), State::Limp);
}

#[test]
fn tip_speed_is_bounded_after_a_teleport() {
    let moved = Transform::new(Vec3::new(40.0, 0.0, -7.0), Rotation::from_axis_angle(Vec3::Y, 2.0));
    for (rate, reset) in [(60, false), (60, true), (240, false), (240, true)] {
        let (mut world, mut character) = walking(rate);
        let mut watch = Watch::new(rate as f32);
        for frame in 0..2 * rate {
            if frame == rate {
                let to = moved * character.world_from_character();
                character.teleport(&mut world, to);
                watch.carry(moved);
                if reset {
                    character.reset_springs();
                }
            }
            step(&mut world, &mut character);
            if frame == rate && reset {
                assert_eq!(character.pose(), character.pose_without_springs());
                // This is a cut, so the displacement is not counted.
                watch = Watch::new(rate as f32);
            }
            let slack = watch.look(&character);
            let since = frame >= rate && frame < rate + rate / 5;
            assert!(
                !since || slack.law > 0.0,
                "{rate} Hz, reset {reset}, frame {frame}: margins {slack:?} m/s"
            );
            assert!(!since || reset || slack.back > -0.2, "{rate} Hz, frame {frame}: margins {slack:?} m/s");
        }
    }
}

/// Steps springs alone, for a list of frame lengths (seconds of the world), advances of world time, and sizes.
fn alone(def: &CharacterDef, frames: impl Iterator<Item = (f32, f32)>, rate: f32) -> (f32, Vec<Rotation>) {
    let pose = rest_pose(&def.rig);
    let (mut swing, mut watch, mut time, mut size) = (SpringSwing::new(), Watch::new(rate), 0.0, 1.0);
    let mut least = f32::INFINITY;
    for (seconds, larger) in frames {
        time += seconds;
        if larger != size {
            swing.resize(def.springs(), Vec3::ZERO, larger / size);
            watch.resize(larger / size);
            size = larger;
        }
        let at = place_at(time);
        let root =
            Affine::from_scale_rotation_translation(Vec3::splat(size), at.rotation, at.translation * size);
        swing.step(&still(def, &pose, root, seconds));
        let mut shown = pose.clone();
        def.springs().joints().zip(swing.turns()).for_each(|(joint, &turn)| shown[joint].rotation = turn);
        // In slow motion there are as many drawn frames per second.
        watch.rate = if seconds > 0.0 { 1.0 / seconds } else { rate };
        let slack = watch.frame(def, root, &shown, &pose);
        least = min(least, slack.law);
    }
    (least, swing.turns().to_vec())
}

#[test]
fn pause_does_not_change_springs() {
    let def = maned(&HAIR);
    for rate in [30.0_f32, 60.0, 90.0, 240.0] {
        let second = rate as usize;
        let frames = |pause: usize| {
            let of = move |seconds: f32, count: usize| core::iter::repeat_n((seconds, 1.0), count);
            of(1.0 / rate, second + 1).chain(of(0.0, pause)).chain(of(1.0 / rate, second / 4))
        };
        let (_, due) = alone(&def, frames(0), rate);
        let (slack, turns) = alone(&def, frames(7), rate);
        assert_eq!(turns, due, "at {rate}");
        assert!(slack > 0.0, "at {rate} Hz: margin {slack} m/s");
    }
}

#[test]
fn tip_speed_is_bounded_in_slow_motion() {
    let def = maned(&HAIR);
    // The run has a second at 60 frames a second, then 60 frames each at a quarter of the time, at a tenth, and so on.
    let rates = [60_u16, 240, 600, 60, 20, 60];
    let frames = |segments: usize| {
        rates[..segments].iter().flat_map(|&rate| core::iter::repeat_n((1.0 / f32::from(rate), 1.0), 60))
    };
    let mut ticks = 0;
    for segments in 1..=rates.len() {
        ticks += 3600 / usize::from(rates[segments - 1]);
        let (slack, turns) = alone(&def, frames(segments), 60.0);
        let (_, due) = alone(&def, core::iter::repeat_n((1.0 / 60.0, 1.0), ticks), 60.0);
        let off = turns.iter().zip(&due).map(|(turn, due)| turn.angle_to(*due)).fold(0.0, max);
        println!("{segments}: {slack} m/s left, {off} rad from 60 a second all the time");
        // The tolerance is a twentieth of a bone's length.
        assert!(slack > 0.0 && off < 0.05, "{segments} segments: margin {slack} m/s, off by {off} rad");
    }
}

#[test]
fn tip_speed_is_bounded_on_changes_of_size() {
    let def = maned(&HAIR);
    // The size doubles and halves in one frame, with hair that keeps its shape, and then changes slowly.
    let size = |seconds: f32| match seconds {
        0.0..1.0 => 1.0,
        1.0..2.0 => 2.0,
        2.0..3.0 => 0.5,
        _ => 0.5 + 0.5 * min(seconds - 3.0, 1.0),
    };
    for rate in [60_u16, 240] {
        let seconds = |frame: u16| f32::from(frame) / f32::from(rate);
        let frames = (0..5 * rate).map(|frame| (seconds(1), size(seconds(frame))));
        let (slack, turns) = alone(&def, frames, f32::from(rate));
        println!("{rate} a second: {slack} m/s left");
        assert!(slack > 0.0, "{rate} Hz: margin {slack} m/s");
        assert!(turns.iter().all(|turn| turn.is_finite()));
    }
}
