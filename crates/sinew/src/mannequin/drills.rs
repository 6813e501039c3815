//! Motions for experiments with animation, in addition to the mannequin's own clips.

use super::gait::{Gait, Path};
use super::keys::{Key, RATE, between, record};
use super::posture::{Foot, Hand, Posture};
use super::skeleton::{Bone, HIPS_ABOVE_HIP, Side};
use super::walk::{self, RUN, WALK};
use crate::anim::{Channel, Clip, Interpolation, Property};
use crate::math::Vec3;

/// A cycle of two steps with locomotion: its clip moves the joint above the hips along a path.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// Linear keys at 30 Hz, starting at the left heel strike.
    pub clip: Clip,
    /// Path along which the clip moves the character.
    pub path: Path,
    /// Speed along the path, m/s.
    pub speed: f32,
    /// Times of the left and right heel strike, clip seconds.
    pub strikes: [f32; 2],
    /// Range of a foot's own cycle in which its ball does not move.
    pub ball_down: [f32; 2],
    /// Range of a foot's own cycle in which its whole sole does not move.
    pub sole_down: [f32; 2],
}

/// Walking along a path, at [`WALK_SPEED`](super::WALK_SPEED).
pub fn walking(path: Path) -> Cycle {
    carried(walk::walk_along(path), path, &WALK)
}

/// Running straight ahead, at [`RUN_SPEED`](super::RUN_SPEED).
pub fn running() -> Cycle {
    carried(walk::run(), Path::Straight, &RUN)
}

/// Adds the motion along `path` to a clip on the spot.
fn carried(mut clip: Clip, path: Path, gait: &Gait) -> Cycle {
    let times: Vec<f32> = (0..=gait.frames).map(|k| k as f32 / RATE).collect();
    let (mut places, mut turns) = (Vec::new(), Vec::new());
    for &time in &times {
        let at = path.at(gait.speed * time);
        places.extend(at.translation.to_array());
        turns.extend([at.rotation.x, at.rotation.y, at.rotation.z, at.rotation.w]);
    }
    for (property, values) in [(Property::Translation, places), (Property::Rotation, turns)] {
        let (joint, interpolation) = (Bone::Root.index(), Interpolation::Linear);
        clip.channels.push(Channel { joint, property, interpolation, times: times.clone(), values });
    }
    let strikes = [0.0, 0.5 * gait.duration()];
    let ball_down = [gait.flat[0], gait.stance];
    Cycle { clip, path, speed: gait.speed, strikes, ball_down, sole_down: gait.flat }
}

/// Time at which the fist of [`punch`] arrives, clip seconds.
pub const PUNCH_ARRIVES: f32 = 0.4;

/// A straight punch with the right hand from a boxer's guard and back to the guard, in 1 s.
pub fn punch() -> Clip {
    let postures = [
        (0.0, guard()),
        (0.22, wound_up()),
        (PUNCH_ARRIVES, struck()),
        (0.46, struck()),
        (0.8, guard()),
        (1.0, guard()),
    ];
    let keys = postures.map(|(at, posture)| Key { at, posture });
    record("punch", RATE as usize, |time| between(&keys, time))
}

fn fist(x: f32, y: f32, z: f32) -> Hand {
    Hand { wrist: Vec3::new(x, y, z), flat: 0.0, fingers_out: 0.0, elbow_out: 12.0 }
}

/// Posture of the guard: left foot in front, both fists in front of the chin.
fn guard() -> Posture {
    Posture {
        pelvis: Vec3::new(0.0, 0.865 + HIPS_ABOVE_HIP, 0.0),
        pelvis_turn: Vec3::new(3.0, -22.0, 0.0),
        spine: Vec3::new(4.0, 4.0, 0.0),
        chest: Vec3::new(4.0, 4.0, 0.0),
        neck: Vec3::new(0.0, 6.0, 0.0),
        head: Vec3::new(-4.0, 6.0, 0.0),
        left_foot: Foot::flat(Side::Left, 0.11, 0.20, 2.0),
        right_foot: Foot::on_ball(Side::Right, -0.13, -0.24, 32.0, 14.0),
        left_hand: fist(0.13, 1.42, 0.36),
        right_hand: fist(-0.10, 1.38, 0.24),
    }
}

/// Posture before the punch: the right side back, the weight on the right leg.
fn wound_up() -> Posture {
    let guard = guard();
    Posture {
        pelvis: guard.pelvis + Vec3::new(0.0, -0.01, -0.03),
        pelvis_turn: Vec3::new(2.0, -32.0, 0.0),
        chest: Vec3::new(2.0, -4.0, 0.0),
        head: Vec3::new(-4.0, 14.0, 0.0),
        left_hand: fist(0.12, 1.42, 0.40),
        right_hand: fist(-0.19, 1.32, 0.10),
        ..guard
    }
}

/// Posture at the hit: the right side forward, its arm nearly straight, the weight over the left foot.
fn struck() -> Posture {
    let guard = guard();
    Posture {
        pelvis: guard.pelvis + Vec3::new(0.01, -0.015, 0.07),
        pelvis_turn: Vec3::new(6.0, 16.0, 0.0),
        spine: Vec3::new(5.0, 10.0, 0.0),
        chest: Vec3::new(5.0, 14.0, 0.0),
        neck: Vec3::new(0.0, -14.0, 0.0),
        head: Vec3::new(-10.0, -14.0, 0.0),
        right_foot: Foot::on_ball(Side::Right, -0.13, -0.24, 12.0, 34.0),
        left_hand: fist(0.17, 1.38, 0.27),
        right_hand: fist(-0.02, 1.42, 0.78),
        ..guard
    }
}
