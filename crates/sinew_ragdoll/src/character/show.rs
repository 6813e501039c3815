//! Data for a renderer: the pose between two steps, and matrices of the skin.

use super::Character;
use super::memory::Shown;
use sinew_anim::LocalTransform;
use sinew_math::{Affine, Transform};

impl Character {
    /// Keeps what is shown now for [`interpolated`](Self::interpolated).
    pub(super) fn keep_shown(&mut self) {
        let mut pose = core::mem::take(&mut self.shown.pose);
        pose.clear();
        pose.extend_from_slice(self.pose());
        self.shown = Shown { pose, world_from_character: self.world_from_character };
    }

    /// Pose and place between the last step (`alpha` 0) and this one (1): `pose` is cleared and gets one local transform per
    /// joint; gives where it stands.
    pub fn interpolated(&self, alpha: f32, pose: &mut Vec<LocalTransform>) -> Transform {
        pose.clear();
        let now = self.pose();
        let (from, to) = (self.shown.world_from_character, self.world_from_character);
        if self.shown.pose.len() != now.len() {
            pose.extend_from_slice(now);
            return to;
        }
        let between = |(a, b): (&LocalTransform, &LocalTransform)| LocalTransform {
            translation: a.translation * (1.0 - alpha) + b.translation * alpha,
            rotation: a.rotation.nlerp(b.rotation, alpha),
            scale: a.scale * (1.0 - alpha) + b.scale * alpha,
        };
        pose.extend(self.shown.pose.iter().zip(now).map(between));
        Transform::new(
            from.translation * (1.0 - alpha) + to.translation * alpha,
            from.rotation.nlerp(to.rotation, alpha),
        )
    }

    /// Matrices of a skin for a renderer, between the last step (`alpha` 0) and this one (1): `palette` is cleared and gets one
    /// for each joint of the skin, from the mesh's bind pose to the world in metres. Each is the upper three rows of a 4×4
    /// matrix that a column vector stands to the right of, **row after row**: `[m00, m01, m02, m03, m10, …, m23]`, the
    /// translation in `m03`, `m13`, `m23`. What was [cut off](Self::detach) shrinks to the point where it was cut. Allocates a pose.
    ///
    /// # Panics
    /// If the rig has no such skin.
    pub fn skin_palette(&self, skin: usize, alpha: f32, palette: &mut Vec<[f32; 12]>) {
        let (mut pose, mut model) = (Vec::new(), Vec::new());
        let place = self.interpolated(alpha, &mut pose);
        let root = self.def.mapping().world_from_model(place);
        sinew_anim::local_to_model(&self.def.rig, &pose, &root, &mut model);
        let skin = &self.def.rig.skins[skin];
        palette.clear();
        palette.extend(skin.joints.iter().zip(&skin.inverse_bind).map(|(&joint, bind)| {
            rows(&self.shrunk_joint(joint, &model).unwrap_or_else(|| model[joint] * *bind))
        }));
    }
}

pub(super) fn rows(m: &Affine) -> [f32; 12] {
    let ([x, y, z], t) = ([m.linear.x_axis, m.linear.y_axis, m.linear.z_axis], m.translation);
    [x.x, y.x, z.x, t.x, x.y, y.y, z.y, t.y, x.z, y.z, z.z, t.z]
}
