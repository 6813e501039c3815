//! The floor of a clip: the height of its lowest drawn point, which may differ from that of the rest pose.

use super::{CharacterDef, Locomotion, MotionSet};
use crate::character::tuning::OWN_FLOOR;
use crate::def::RagdollDef;
use crate::mapping::carries_character;
use crate::skin::surface::{Surface, may_stand};
use sinew_anim::take::Take;
use sinew_anim::{Channel, Clip, Interpolation, LocalTransform, Property, Rig, local_to_model};
use sinew_math::{Affine, Vec3, min};

/// Number of evenly spaced poses of a looped clip in which its lowest point is measured.
const LOOKS: usize = 24;
/// Words in the names of clips in the air or in water. The lowest point of such a clip is not on a floor.
const ALOFT: [&str; 7] = ["fly", "flies", "hover", "swim", "float", "glide", "jump"];

/// Heights by which clips are raised to the floor of the rest pose, metres: that of the looped clip, and that of each
/// get-up clip with the clip's index.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Raised {
    pub looped: f32,
    pub get_ups: Vec<(usize, f32)>,
}

impl Raised {
    /// Measures the clips. The floor of the looped clip is at its lowest drawn point; the floor of a get-up clip is at
    /// the lowest drawn point of its last pose.
    pub fn of(def: &CharacterDef, motions: &MotionSet) -> Self {
        let mut surface = Surface::of(&def.rig, &def.ragdoll);
        let may_stand = may_stand(&def.ragdoll);
        let stands: Vec<usize> = surface.sample.clone();
        surface.sample = stands
            .into_iter()
            .filter(|&vertex| surface.owner(vertex).is_some_and(|body| may_stand[body]))
            .collect();
        if surface.sample.is_empty() || def.rig.joints.is_empty() {
            return Self::default();
        }
        let least = OWN_FLOOR * def.ragdoll.height;
        let raise = |lowest: f32| if lowest.abs() > least && lowest.is_finite() { -lowest } else { 0.0 };
        let low = |clip: &Clip, from: usize| {
            let duration = f64::from(clip.duration);
            let frame_time = if duration > 0.0 { duration / LOOKS as f64 } else { 1.0 };
            let take = Take::of(&def.rig, clip, frame_time);
            let first = if from == 0 { 0 } else { take.frames() - 1 };
            let heights = (first..take.frames()).map(|frame| lowest(def, &surface, take.pose(frame)));
            heights.fold(f32::INFINITY, min)
        };
        let stands = |role: &str| role == "hips" || role.starts_with("limb");
        let has_legs = def.ragdoll.bodies.iter().any(|body| stands(&body.role));
        let looped = motions.looped.filter(|_| motions.locomotion != Locomotion::Exact);
        let looped = looped.map_or(0.0, |index| {
            let clip = &motions.clips[index];
            let raised = raise(low(clip, 0));
            // The lowest point of a character without legs, or of a clip in the air, need not be on the floor. Such a
            // clip is raised if it is below the floor, but never lowered.
            if raised < 0.0 && (!has_legs || is_aloft(&clip.name)) { 0.0 } else { raised }
        });
        let get_ups = motions.get_ups.iter().map(|&clip| (clip, raise(low(&motions.clips[clip], LOOKS))));
        Self { looped, get_ups: get_ups.collect() }
    }

    /// Returns the height by which a clip is raised, metres; for a clip that is not a get-up, the height of the looped
    /// clip.
    pub fn of_clip(&self, index: usize) -> f32 {
        self.get_ups.iter().find(|(clip, _)| *clip == index).map_or(self.looped, |(_, raised)| *raised)
    }
}

fn is_aloft(name: &str) -> bool {
    let name = name.to_lowercase();
    ALOFT.iter().any(|word| name.contains(word))
}

/// Returns the height of the lowest drawn point over the floor of the rest pose, metres.
fn lowest(def: &CharacterDef, surface: &Surface, pose: &[LocalTransform]) -> f32 {
    let (mut model, mut palette) = (Vec::new(), Vec::new());
    local_to_model(&def.rig, pose, &Affine::IDENTITY, &mut model);
    surface.palette(&model, &mut palette);
    let root = def.mapping().character_from_model();
    let heights = surface.sample.iter().map(|&vertex| root.point(surface.place(&palette, vertex)).y);
    heights.fold(f32::INFINITY, min)
}

/// Returns a clip whose rig roots are moved in model space: by `by` if they carry the character, otherwise, such as a
/// floor in the file, by `beside`.
pub(crate) fn moved(rig: &Rig, ragdoll: &RagdollDef, clip: &Clip, by: Vec3, beside: Vec3) -> Clip {
    let mut moved = clip.clone();
    let carries = carries_character(rig, ragdoll);
    for (joint, root) in rig.joints.iter().enumerate().filter(|(_, joint)| joint.parent.is_none()) {
        let by = if carries[joint] { by } else { beside };
        if by == Vec3::ZERO {
            continue;
        }
        let own = moved
            .channels
            .iter_mut()
            .find(|channel| channel.joint == joint && channel.property == Property::Translation);
        match own {
            Some(channel) => {
                let is_cubic = channel.interpolation == Interpolation::CubicSpline;
                for (index, place) in channel.values.chunks_exact_mut(3).enumerate() {
                    // A cubic key has three entries; the first and the last are slopes.
                    if !is_cubic || index % 3 == 1 {
                        place.iter_mut().zip(by.to_array()).for_each(|(number, by)| *number += by);
                    }
                }
            }
            None => moved.channels.push(Channel {
                joint,
                property: Property::Translation,
                interpolation: Interpolation::Linear,
                times: vec![0.0],
                values: (root.rest.translation + by).to_array().to_vec(),
            }),
        }
    }
    moved
}
