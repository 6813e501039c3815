//! Changes under springs: far away and back, falls, teleports, pauses, sizes, rates. Bounds on the speed of tips, stated before anything was measured:
//!
//! - **The law's**: a tip that is held at its bone's length about a joint moves along the bone by no more than the joint (or the head, which may push it), and across it by
//!   no more than in the frame before and what stiffness and gravity give across the bone: the root of both squares; a tenth more for a way that is bent, a fifth
//!   between ticks (ADR 0020).
//! - **Easing**: the animated tip's speed, and 1/0.3 s of each angle that a bone above it was off by, over that bone's distance.
//! - **Coming back**: the change of a tip's velocity is that of its joint, what drag takes, and the part of stiffness and gravity across the bone.

use super::{place_at, still};
use sinew_anim::{LocalTransform, SpringBone, SpringChain, local_to_model, rest_pose};
use sinew_math::{Affine, Reader, Rotation, Transform, Vec3, Writer, max, min, trig};
use sinew_physics::{BodyDef, Shape, World, WorldDef};
use sinew_ragdoll::{Character, CharacterDef, Detail, SpringSwing, State};
use sinew_scenes::maned::{HAIR, maned};
use std::sync::Arc;

/// Slack of numbers, m/s.
const ROUNDING: f32 = 0.005;

/// Spring bone as it is shown, in the world.
#[derive(Clone, Copy)]
struct Seen {
    joint: Vec3,
    tip: Vec3,
    /// Stiffness and gravity across the bone, m/s.
    across: f32,
    /// Turn from the pose, radians.
    off: f32,
    drag: f32,
    chain: usize,
}

/// Velocities of a bone in a frame, m/s.
#[derive(Clone, Copy, Default)]
struct Motion {
    tip: Vec3,
    joint: Vec3,
    /// Velocity with which the head would take the tip along.
    head: Vec3,
}

/// Bones of a pose with springs, chain by chain, and the head.
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
        let parent = model[def.rig.joints[bone.joint].parent.expect("a bone hangs on something")];
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

/// Slack that the bounds leave to the fastest tip of a frame, m/s; negative: it was too fast.
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

/// Eyes on springs.
struct Watch {
    rate: f32,
    bones: Vec<Seen>,
    head: Affine,
    motions: Vec<Motion>,
    /// Highest speed of a tip, and of one as the head alone would carry it, m/s.
    fastest: f32,
    carried: f32,
}

impl Watch {
    fn new(rate: f32) -> Self {
        let (bones, motions) = (Vec::new(), Vec::new());
        Self { rate, bones, head: Affine::IDENTITY, motions, fastest: 0.0, carried: 0.0 }
    }

    /// Sees the next frame from where the character was put.
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

    /// Sees the next frame from where the character has become larger, about the origin.
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
        // A bone that grows takes its tip along.
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

/// A character with hair that walks over a floor, at a frame rate.
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

/// Far away for a time, and back: least slacks of easing, of the first twentieth of a second after the return and of the law in the first third.
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
    assert_eq!(is_away, seconds > 3.5, "after {seconds} s at {rate}");
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
    assert!(off > 0.05, "it swings again: {off} rad");
    (watch, least)
}

#[test]
fn far_away_and_back_no_tip_jumps() {
    for rate in [30, 60, 240] {
        for seconds in [0.1, 4.0] {
            let (watch, least) = away_and_back(rate, seconds);
            println!(
                "{rate} a second, {seconds} s away: {least:.3?}, fastest {} of {}",
                watch.fastest, watch.carried
            );
            assert!(
                least.easing > 0.0 && least.law > 0.0 && least.back > 0.0,
                "{rate}, {seconds}: {least:?} m/s"
            );
        }
    }
}

#[test]
fn springs_that_are_far_away_cost_nothing() {
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
    // 18 frames are 0.3 s: 1/e is left, at every rate.
    assert!((most(&swing) / began - trig::exp(-1.0)).abs() < 1e-3, "{} of {began}", most(&swing));
    for frame in 78..360 {
        swing.ease(&still(&def, &pose, at(frame), 1.0 / 60.0));
    }
    assert!(swing.is_away() && swing.turns().is_empty());
    // Nothing that a step computes is computed: not a bit of all that it keeps, state and scratch, changes.
    let bits = format!("{swing:?}");
    for frame in 360..600 {
        swing.ease(&still(&def, &pose, at(frame), 1.0 / 60.0));
    }
    assert_eq!(format!("{swing:?}"), bits);
}

#[test]
fn easing_goes_on_from_numbers_that_are_none() {
    let def = maned(&HAIR);
    let pose = rest_pose(&def.rig);
    let mut swing = SpringSwing::new();
    for frame in 0..60_u8 {
        let at = Affine::from(place_at(f32::from(frame) / 60.0));
        swing.step(&still(&def, &pose, at, 1.0 / 60.0));
    }
    // A clip without numbers for a bone in the frame in which it begins.
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
fn what_begins_far_away_comes_near_at_rest() {
    let (mut world, mut character) = walking(60);
    character.set_level_of_detail(&mut world, Detail::Keyed);
    for frame in 0..30 {
        step(&mut world, &mut character);
        assert_eq!(character.pose(), character.pose_without_springs());
        assert!(frame == 0 || core::ptr::eq(character.pose(), character.pose_without_springs()));
    }
    // Hit bodies are near enough.
    character.set_level_of_detail(&mut world, Detail::HitBodies);
    step(&mut world, &mut character);
    assert_eq!(character.pose(), character.pose_without_springs());
    for _ in 0..10 {
        step(&mut world, &mut character);
    }
    assert_ne!(character.pose(), character.pose_without_springs());
}

#[test]
fn a_snapshot_on_the_way_to_afar_goes_on_alike() {
    let bytes = |character: &Character| {
        let mut w = Writer::new();
        character.save(&mut w);
        w.into_bytes()
    };
    // In the middle of easing, away, and one step after the return.
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
            assert_eq!(bytes(&copy), bytes(&character), "{eased} {near}, frame {frame}");
            assert_eq!(copy.pose(), character.pose());
        }
        let cut = &bytes(&character)[..bytes(&character).len() - 9];
        assert!(copy.load(&mut Reader::new(cut)).is_err());
    }
}

#[test]
fn snapshots_of_before_the_distance_are_read() {
    // One byte said whether they swing, and what followed is the same.
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
    // A phase, 13 tips, ways and turns, a stride, and whole frames of what does not swing.
    assert_eq!((bytes[0], (bytes.len() - 9 - 40 * bones) % 96), (1, 0));
    assert!(SpringSwing::load(def.springs(), &mut Reader::new(&[4])).is_err());
}

/// Least slack of the law about every change of a character's state, of a life with a hit while it walks: (change, slack, m/s).
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
fn no_tip_is_too_fast_where_bodies_take_over_and_give_back() {
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
fn no_tip_is_too_fast_where_one_without_a_mover_goes_limp() {
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
        assert!(!(50..80).contains(&frame) || slack.law > 0.0, "frame {frame}: {slack:?} m/s");
    }
    assert_eq!(character.state(), State::Limp);
}

#[test]
fn no_tip_is_too_fast_after_a_teleport() {
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
                // A cut: nobody saw the way.
                watch = Watch::new(rate as f32);
            }
            let slack = watch.look(&character);
            let since = frame >= rate && frame < rate + rate / 5;
            assert!(!since || slack.law > 0.0, "{rate}, {reset}, frame {frame}: {slack:?} m/s");
            assert!(!since || reset || slack.back > -0.2, "{rate}, frame {frame}: {slack:?} m/s");
        }
    }
}

/// Springs alone, at times and sizes of a list: frames' lengths in seconds of the world, how far its time goes in them, and size.
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
        // In slow motion the eye has as many frames.
        watch.rate = if seconds > 0.0 { 1.0 / seconds } else { rate };
        let slack = watch.frame(def, root, &shown, &pose);
        least = min(least, slack.law);
    }
    (least, swing.turns().to_vec())
}

#[test]
fn a_pause_is_nothing() {
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
        assert!(slack > 0.0, "at {rate}: {slack} m/s");
    }
}

#[test]
fn slow_motion_moves_no_tip_too_fast() {
    let def = maned(&HAIR);
    // A second at 60 a second, then 60 frames each at a quarter of the time, at a tenth, and so on.
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
        // A twentieth of a bone's length.
        assert!(slack > 0.0 && off < 0.05, "{segments}: {slack} m/s, {off} rad");
    }
}

#[test]
fn a_change_of_size_moves_no_tip_too_fast() {
    let def = maned(&HAIR);
    // At once to twice the size and back: what hangs stays as it hangs; and slowly, by itself.
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
        assert!(slack > 0.0, "{rate} a second: {slack} m/s");
        assert!(turns.iter().all(|turn| turn.is_finite()));
    }
}
