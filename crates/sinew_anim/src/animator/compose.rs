//! Combines tracks into one pose and one root motion.

use super::root_inertia::{RootInertia, RootVelocity};
use super::{Animator, FILL_BELOW, Slot, crossfade};
use crate::playback::inertial::Motion;
use crate::pose::{BlendLayer, Pose};
use crate::set::AnimationSet;
use core::cmp::Ordering;
use sinew_math::{Rotation, Transform, Vec3};

/// Motion of a track's root in this update, and its weight in the mean.
#[derive(Clone, Copy, Debug)]
pub(super) struct WeightedMotion {
    weight: f32,
    way: Vec3,
    /// Rotation as a scaled axis.
    turn: Vec3,
}

impl WeightedMotion {
    /// Sorts motions like poses: by weight, then by content, so that the order of tracks does not change the bits.
    fn order(&self, other: &Self) -> Ordering {
        let numbers = |m: &Self| [m.way.x, m.way.y, m.way.z, m.turn.x, m.turn.y, m.turn.z].map(f32::to_bits);
        other.weight.total_cmp(&self.weight).then_with(|| numbers(self).cmp(&numbers(other)))
    }
}

/// Returns an empty list that reuses the memory of `layers`.
fn recycled<'a>(layers: Vec<BlendLayer<'_>>) -> Vec<BlendLayer<'a>> {
    layers.into_iter().map_while(|_| None).collect()
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Pose,
    Difference,
}

/// Returns the tracks of a layer that are blended together.
fn layers_of<'a>(
    slots: &'a [Slot],
    set: &'a AnimationSet,
    layer: u8,
    kind: Kind,
) -> impl Iterator<Item = BlendLayer<'a>> {
    slots.iter().filter_map(move |slot| {
        let def = &slot.track.def;
        let is_of_kind = set.clip(def.clip).is_difference() == (kind == Kind::Difference);
        let mask = def.mask.map(|mask| set.mask(mask));
        let counts = def.layer == layer && is_of_kind && !slot.is_crossfaded;
        counts.then_some(BlendLayer { pose: &slot.pose, weight: def.weight, mask })
    })
}

impl Animator {
    /// Computes the pose of all tracks, before transitions are added.
    pub(super) fn compose(&mut self, set: &AnimationSet, pose: &mut Pose) {
        for slot in self.slots.iter_mut().filter(|slot| slot.track.def.weight > 0.0) {
            let (clip, time) = (slot.track.def.clip, slot.track.playhead.clip_time());
            match self.fed.as_ref().filter(|fed| fed.clip == clip) {
                Some(fed) => fed.sample(&mut slot.pose),
                None => set.clip(clip).clip.sample(time, &mut slot.cursor, &mut slot.pose),
            }
        }
        let mut next = Some(0);
        while let Some(layer) = next {
            self.compose_layer(set, layer, pose);
            let layers = self.slots.iter().map(|slot| slot.track.def.layer);
            next = layers.filter(|&other| other > layer).min();
        }
    }

    fn compose_layer(&mut self, set: &AnimationSet, layer: u8, pose: &mut Pose) {
        if self.slots.iter().any(|slot| slot.is_crossfaded && slot.track.def.layer == layer) {
            self.crossfade_layer(set, layer, pose);
        } else {
            self.blend_layer(set, layer, pose);
        }
        let mut layers = recycled(core::mem::take(&mut self.room.layers));
        layers.extend(layers_of(&self.slots, set, layer, Kind::Difference));
        self.room.blender.add(&layers, pose);
        self.room.layers = recycled(layers);
    }

    fn blend_layer(&mut self, set: &AnimationSet, layer: u8, pose: &mut Pose) {
        let room = &mut self.room;
        let mut layers = recycled(core::mem::take(&mut room.layers));
        layers.extend(layers_of(&self.slots, set, layer, Kind::Pose));
        if layer == 0 {
            room.blender.blend(set.skeleton().rest(), &layers, pose);
        } else if !layers.is_empty() {
            room.below.copy_from(pose);
            room.cover.blend(&room.below, &layers, pose);
        }
        room.layers = recycled(layers);
    }

    /// Blends a layer with crossfades: first the tracks that crossfades replace, then each target track in the order
    /// of its start.
    fn crossfade_layer(&mut self, set: &AnimationSet, layer: u8, pose: &mut Pose) {
        let room = &mut self.room;
        room.below.copy_from(if layer == 0 { set.skeleton().rest() } else { pose });
        let mut layers = recycled(core::mem::take(&mut room.layers));
        layers.extend(layers_of(&self.slots, set, layer, Kind::Pose));
        room.pure.blend(&room.below, &layers, pose);
        room.weights.clear(pose.len());
        layers.iter().for_each(|layer| room.weights.add(layer.weight, layer.mask));
        room.layers = recycled(layers);
        for slot in self.slots.iter_mut().filter(|slot| slot.is_crossfaded && slot.track.def.layer == layer) {
            let def = &slot.track.def;
            // The pose of a track without weight was not sampled.
            if def.weight > 0.0 {
                let mask = def.mask.map(|mask| set.mask(mask));
                slot.crossfade.mix(&slot.pose, def.weight, mask, &mut room.weights, pose);
            }
        }
        crossfade::fill(&room.below, if layer == 0 { FILL_BELOW } else { 1.0 }, &room.weights, pose);
    }

    /// Turns a crossfaded track into an ordinary one when no track that it replaces remains.
    pub(super) fn settle_crossfades(&mut self, set: &AnimationSet) {
        for i in 0..self.slots.len() {
            let layer = self.slots[i].track.def.layer;
            let is_below = |(j, slot): (usize, &Slot)| {
                let of_layer =
                    slot.track.def.layer == layer && !set.clip(slot.track.def.clip).is_difference();
                of_layer && j != i && (!slot.is_crossfaded || j < i)
            };
            if self.slots[i].is_crossfaded && !self.slots.iter().enumerate().any(is_below) {
                self.slots[i].is_crossfaded = false;
                self.slots[i].crossfade.clear();
            }
        }
    }

    /// Computes the pose after an update of `seconds`. `begins` is the time of a transition that starts with this
    /// update; `room.start` then holds the new motion before the update.
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

    /// Computes the mean step of the root in an update of `seconds`, plus the remaining velocity of the old motion in
    /// a transition. `begins` is the time of a transition that starts with this update.
    pub(super) fn move_root(&mut self, seconds: f32, begins: Option<f32>) {
        let (mut way, mut turn) = self.mean_motion();
        if seconds > 0.0 {
            if let Some(time) = begins {
                let to = RootVelocity { linear: way / seconds, angular: turn / seconds };
                self.root_inertia = RootInertia::new(self.root_velocity, to, time);
            }
            let (left_way, left_turn) = self.root_inertia.advance(seconds);
            way += left_way;
            turn += left_turn;
            self.root_velocity = RootVelocity { linear: way / seconds, angular: turn / seconds };
        }
        self.root_motion = Transform::new(way, Rotation::from_scaled_axis(turn));
    }

    /// Returns the mean translation and rotation (scaled axis) of the tracks of layer 0.
    fn mean_motion(&mut self) -> (Vec3, Vec3) {
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
        let share = 1.0 / sinew_math::max(total, FILL_BELOW);
        (way * share, turn * share)
    }
}
