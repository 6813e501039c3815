//! Crossfades between two playing motions, which may be far apart.
//!
//! The mean of two opposite rotations is undefined, and every choice of hemispheres has a jump there. Unlike a blend, a
//! crossfade has state: at the start it chooses the shorter rotation from the old pose to the new one, and keeps that
//! direction. The joint turns about one axis at the speed of the easing (Shoemake, "Animating rotation with quaternion
//! curves", 1985), so its acceleration is at most `6 |x₀|/t₁² + 3 |v₀|/t₁` for a distance `x₀` and a relative speed
//! `v₀`.

use crate::playback::inertial::logarithm;
use crate::pose::{Mask, Pose};
use crate::rig::LocalTransform;
use sinew_math::{ReadError, Reader, Rotation, Vec3, Writer};

/// Rotations from a track's pose to the pose that it replaces, joint by joint.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Crossfade {
    /// Rotations from the track's pose to the other pose, each with the sign closest to that of the previous update;
    /// empty before the first update.
    turns: Vec<Rotation>,
}

/// Sums of the weights blended so far, joint by joint.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Weights(Vec<f32>);

impl Weights {
    pub fn clear(&mut self, joints: usize) {
        self.0.clear();
        self.0.resize(joints, 0.0);
    }

    pub fn add(&mut self, weight: f32, mask: Option<&Mask>) {
        for (joint, sum) in self.0.iter_mut().enumerate() {
            *sum += weight * mask.map_or(1.0, |mask| mask.get(joint));
        }
    }

    /// Share of `full` by which the joint's sum of weights falls short of it.
    fn missing(&self, joint: usize, full: f32) -> f32 {
        let sum = self.0[joint];
        if sum < full { 1.0 - sum / full } else { 0.0 }
    }
}

impl Crossfade {
    /// Copies another crossfade into existing memory.
    pub fn copy_from(&mut self, other: &Self) {
        self.turns.clone_from(&other.turns);
    }

    /// Resets the crossfade for use by another track.
    pub fn clear(&mut self) {
        self.turns.clear();
    }

    /// Moves `shown`, whose joints have the sums `weights`, toward a track's pose by the share of the track's weight in
    /// the sum.
    pub fn mix(
        &mut self,
        to: &Pose,
        weight: f32,
        mask: Option<&Mask>,
        weights: &mut Weights,
        shown: &mut Pose,
    ) {
        let is_first = self.turns.is_empty();
        if is_first {
            self.turns.resize(to.len(), Rotation::IDENTITY);
        }
        for (joint, turn) in self.turns.iter_mut().enumerate() {
            let (a, b) = (shown.get(joint), to.get(joint));
            let between = a.rotation * b.rotation.inverse();
            *turn = if is_first { between.positive() } else { between.toward(*turn) };
            let own = weight * mask.map_or(1.0, |mask| mask.get(joint));
            let sum = weights.0[joint] + own;
            if own > 0.0 {
                shown.set(joint, &toward(&a, &b, *turn, own / sum));
            }
            weights.0[joint] = sum;
        }
    }

    pub fn save(&self, out: &mut Writer) {
        out.count(self.turns.len());
        self.turns.iter().for_each(|&turn| out.rotation(turn));
    }

    /// Reads a crossfade that [`save`](Self::save) wrote, for a rig of `joints` joints.
    pub fn load(bytes: &mut Reader<'_>, joints: usize) -> Result<Self, ReadError> {
        let count = bytes.count(16)?;
        if count != 0 && count != joints {
            return Err(bytes.error("a crossfade is of another number of joints"));
        }
        let turn = |_| {
            let turn = bytes.rotation()?;
            let length = turn.length();
            if length > 0.99 && length < 1.01 { Ok(turn) } else { Err(bytes.error("no rotation")) }
        };
        Ok(Self { turns: (0..count).map(turn).collect::<Result<_, _>>()? })
    }
}

/// Interpolates from `a` to `b` by a share, exact at both ends; `turn` is the rotation from `b` to `a`.
fn toward(a: &LocalTransform, b: &LocalTransform, turn: Rotation, share: f32) -> LocalTransform {
    if share >= 1.0 || a == b {
        return *b;
    }
    let line = |a: Vec3, b: Vec3| a + (b - a) * share;
    let left = Rotation::from_scaled_axis(logarithm(turn) * (1.0 - share));
    LocalTransform {
        translation: line(a.translation, b.translation),
        rotation: (left * b.rotation).normalize(),
        scale: line(a.scale, b.scale),
    }
}

/// Blends in another pose where the sum of weights is below `full`, on the hemisphere of `shown`.
pub(super) fn fill(from: &Pose, full: f32, weights: &Weights, shown: &mut Pose) {
    for joint in 0..shown.len() {
        let missing = weights.missing(joint, full);
        if missing > 0.0 {
            let (a, b) = (shown.get(joint), from.get(joint));
            let rotation = a.rotation.nlerp(b.rotation, missing);
            let line = |a: Vec3, b: Vec3| a + (b - a) * missing;
            let (translation, scale) = (line(a.translation, b.translation), line(a.scale, b.scale));
            shown.set(joint, &LocalTransform { translation, rotation, scale });
        }
    }
}
