//! From tracks to one pose and one step of the root.

use super::Animator;
use crate::inertial::Motion;
use crate::pose::{BlendLayer, Pose};
use crate::set::AnimationSet;
use core::cmp::Ordering;
use sinew_math::{Rotation, Transform, Vec3};

/// What a track's root has done, and the share that it has in the whole.
#[derive(Clone, Copy, Debug)]
pub(super) struct WeightedMotion {
    weight: f32,
    way: Vec3,
    /// Scaled axis.
    turn: Vec3,
}

impl WeightedMotion {
    /// As poses are ordered: by weight, and then by content, so that the order of tracks does not matter to the bit.
    fn order(&self, other: &Self) -> Ordering {
        let numbers = |m: &Self| [m.way.x, m.way.y, m.way.z, m.turn.x, m.turn.y, m.turn.z].map(f32::to_bits);
        other.weight.total_cmp(&self.weight).then_with(|| numbers(self).cmp(&numbers(other)))
    }
}

/// An empty list with the memory of another: nothing is in it whose life would matter.
fn recycled<'a>(layers: Vec<BlendLayer<'_>>) -> Vec<BlendLayer<'a>> {
    layers.into_iter().map_while(|_| None).collect()
}

impl Animator {
    /// The pose of all tracks as they are, without what transitions leave.
    pub(super) fn compose(&mut self, set: &AnimationSet, pose: &mut Pose) {
        for slot in self.slots.iter_mut().filter(|slot| slot.track.def.weight > 0.0) {
            let time = slot.track.playhead.clip_time();
            set.clip(slot.track.def.clip).clip.sample(time, &mut slot.cursor, &mut slot.pose);
        }
        let mut next = Some(0);
        while let Some(layer) = next {
            self.compose_layer(set, layer, pose);
            let layers = self.slots.iter().map(|slot| slot.track.def.layer);
            next = layers.filter(|&other| other > layer).min();
        }
    }

    fn compose_layer(&mut self, set: &AnimationSet, layer: u8, pose: &mut Pose) {
        let room = &mut self.room;
        let mut layers = recycled(core::mem::take(&mut room.layers));
        let of_kind = |is_difference: bool| {
            self.slots.iter().filter_map(move |slot| {
                let def = &slot.track.def;
                let counts = def.layer == layer && set.clip(def.clip).is_difference() == is_difference;
                let mask = def.mask.map(|mask| set.mask(mask));
                counts.then_some(BlendLayer { pose: &slot.pose, weight: def.weight, mask })
            })
        };
        layers.extend(of_kind(false));
        if layer == 0 {
            room.blender.blend(set.skeleton().rest(), &layers, pose);
        } else if !layers.is_empty() {
            room.below.copy_from(pose);
            room.cover.blend(&room.below, &layers, pose);
        }
        layers.clear();
        layers.extend(of_kind(true));
        room.blender.add(&layers, pose);
        room.layers = recycled(layers);
    }

    /// The pose after an update of `seconds`. `begins` is the time of a transition that begins with it: then `room.start`
    /// holds where the new motion was before the update.
    pub(super) fn finish_pose(&mut self, set: &AnimationSet, seconds: f32, begins: Option<f32>) {
        let mut now = core::mem::take(&mut self.room.now);
        self.compose(set, &mut now);
        if let Some(time) = begins {
            let old = Motion { now: &self.pose, other: &self.previous, seconds: self.previous_seconds };
            self.inertia.start(old, Motion { now: &self.room.start, other: &now, seconds }, time);
        }
        self.inertia.apply(seconds, &mut now);
        if seconds > 0.0 {
            core::mem::swap(&mut self.previous, &mut self.pose);
            self.previous_seconds = if self.has_pose { seconds } else { 0.0 };
            self.has_pose = true;
        }
        core::mem::swap(&mut self.pose, &mut now);
        self.room.now = now;
    }

    /// The mean step of the root.
    pub(super) fn blend_motions(&mut self) {
        let motions = &mut self.room.motions;
        motions.clear();
        motions.extend(self.slots.iter().filter(|slot| slot.track.def.layer == 0).map(|slot| {
            WeightedMotion {
                weight: slot.track.def.weight,
                way: slot.motion.translation,
                turn: slot.motion.rotation.to_scaled_axis(),
            }
        }));
        motions.sort_unstable_by(WeightedMotion::order);
        let (mut way, mut turn, mut total) = (Vec3::ZERO, Vec3::ZERO, 0.0);
        for motion in &*motions {
            way += motion.way * motion.weight;
            turn += motion.turn * motion.weight;
            total += motion.weight;
        }
        let share = 1.0 / sinew_math::max(total, super::FILL_BELOW);
        self.root_motion = Transform::new(way * share, Rotation::from_scaled_axis(turn * share));
    }
}
