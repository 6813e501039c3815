//! Recognises get-up clips by name or by motion.

use super::CharacterDef;
use sinew_anim::{Clip, LocalTransform, Wrap, local_to_model, sample};
use sinew_math::{Affine, Transform, Vec3, max, min};

/// Names of get-up clips, in lower case, without blanks, `-` and `_`.
const NAMES: [&str; 3] = ["getup", "standup", "gettingup"];
/// Largest uprightness of a lying pelvis (1: upright), and its largest height, as a share of its height in the bind
/// pose.
const LYING: [f32; 2] = [0.6, 0.4];
/// Least uprightness and height of a standing pelvis, in the same units as [`LYING`].
const STANDING: [f32; 2] = [0.8, 0.8];

impl CharacterDef {
    /// Returns the indices of those of the clips that are get-ups: clips with the name of a get-up (`get_up`,
    /// `StandUp`, …), and clips that start lying and end standing.
    ///
    /// # Panics
    /// As [`sample`](sinew_anim::sample()).
    pub fn get_ups_among(&self, clips: &[Clip]) -> Vec<usize> {
        (0..clips.len())
            .filter(|&index| is_called_so(&clips[index].name) || self.rises(&clips[index]))
            .collect()
    }

    fn rises(&self, clip: &Clip) -> bool {
        let [start, end] = [0.0, clip.duration].map(|time| self.posture(clip, time));
        start.iter().zip(LYING).all(|(value, most)| *value < most)
            && end.iter().zip(STANDING).all(|(value, least)| *value > least)
    }

    /// Returns the heights of the centre of mass above the lowest body at the start and at the end of a clip, as shares
    /// of this height in the bind pose: about 1 for a standing pose, below 0.5 for a lying one.
    ///
    /// # Panics
    /// As [`sample`](sinew_anim::sample()).
    pub fn heights_in(&self, clip: &Clip) -> [f32; 2] {
        let bind: Vec<Transform> = self.ragdoll.bodies.iter().map(|body| body.character_from_body).collect();
        let least = 1e-3 * self.ragdoll.height;
        let upright = max(self.height_of_mass(&bind), least);
        [0.0, clip.duration].map(|time| self.height_of_mass(&self.bodies_at(clip, time)) / upright)
    }

    /// Returns the height of the centre of mass over the lowest body, metres.
    fn height_of_mass(&self, bodies: &[Transform]) -> f32 {
        let parts = || bodies.iter().zip(&self.ragdoll.bodies);
        let lowest = parts().map(|(body, _)| body.translation.y).fold(f32::INFINITY, min);
        let (moment, mass) = parts().fold((0.0, 0.0), |(moment, mass), (body, def)| {
            (moment + def.mass.mass * (body.translation.y - lowest), mass + def.mass.mass)
        });
        moment / mass
    }

    /// Returns the uprightness of the pelvis (1: upright) at a time of a clip, and its height as a share of its height
    /// in the bind pose.
    fn posture(&self, clip: &Clip, time: f32) -> [f32; 2] {
        let pelvis = self.bodies_at(clip, time)[0];
        let bind = self.ragdoll.bodies[0].character_from_body;
        let up = pelvis.rotation * (bind.rotation.inverse() * Vec3::Y);
        [up.y, pelvis.translation.y / bind.translation.y]
    }

    /// Returns the bodies in the pose of a clip, character space.
    fn bodies_at(&self, clip: &Clip, time: f32) -> Vec<Transform> {
        let mut pose: Vec<LocalTransform> = self.rest().to_vec();
        sample(clip, &self.rig, time, Wrap::Clamp, &mut pose);
        let (mut model, mut bodies) = (Vec::new(), Vec::new());
        local_to_model(&self.rig, &pose, &Affine::IDENTITY, &mut model);
        self.mapping().bodies_from_model(&model, Transform::IDENTITY, &mut bodies);
        bodies
    }
}

fn is_called_so(name: &str) -> bool {
    let plain: String =
        name.chars().filter(|c| !matches!(c, ' ' | '_' | '-')).flat_map(char::to_lowercase).collect();
    NAMES.iter().any(|name| plain.contains(name))
}
