//! Rotation of each bone in the bind pose relative to the anatomical pose.
//!
//! Ranges of motion are measured from a person who stands with arms hanging. Rigs are bound in a T pose, an A pose or
//! another pose, and their joint axes follow no rule; only the positions of the bones are reliable. Each bone is
//! therefore assumed to come from its anatomical direction by the shortest rotation relative to its parent. For arms
//! this is correct in a T pose (palms down) and in an A pose (palms inward), because raising a hanging arm sideways
//! turns the palm down.
//!
//! ```
//! # use sinew_anim::roles::{Role, Side};
//! # use sinew_math::Vec3;
//! # use sinew_ragdoll::build::bones::{Anatomy, Bone, Bones};
//! # let list = vec![
//! #     Bone::new(0, Role::Hips, None, Vec3::new(0.0, 1.0, 0.0)),
//! #     Bone::new(1, Role::UpperLeg(Side::Left), Some(0), Vec3::new(0.1, 0.9, 0.0)),
//! #     Bone::new(2, Role::LowerLeg(Side::Left), Some(1), Vec3::new(0.1, 0.5, 0.0)),
//! # ];
//! # let bones = Bones::new(list, Anatomy::Human, 1.75);
//! use sinew_ragdoll::limits::anatomy::bind_from_anatomical;
//!
//! // A leg that hangs straight down has its anatomical pose.
//! let middles = [Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.1, 0.7, 0.0), Vec3::new(0.1, 0.3, 0.0)];
//! let turned = bind_from_anatomical(&bones, &middles);
//! assert!(turned.iter().all(|turn| turn.to_axis_angle().1 < 1e-3));
//! ```

use crate::build::bones::{Anatomy, Bones};
use crate::build::part::Part;
use sinew_math::{Mat3, Rotation, Vec3};

/// Returns the rotation of each bone from the anatomical pose to the bind pose, character axes. `middles`: centre of
/// each bone's shape.
pub fn bind_from_anatomical(bones: &Bones, middles: &[Vec3]) -> Vec<Rotation> {
    let mut turned: Vec<Rotation> = Vec::with_capacity(bones.list.len());
    for (index, bone) in bones.list.iter().enumerate() {
        let direction = bones.direction(index, Some(middles[index]));
        let parent = bone.parent.map_or(Rotation::IDENTITY, |p| turned[p]);
        let along_parent = || {
            let from = bone.parent.map_or(-Vec3::Y, |p| bones.direction(p, Some(middles[p])));
            Rotation::from_arc(from, direction) * parent
        };
        turned.push(match (bones.anatomy, bone.part) {
            (Anatomy::Creature, _) => Rotation::IDENTITY,
            (_, Part::UpperArm | Part::Thigh) => Rotation::from_arc(-Vec3::Y, direction),
            (_, Part::Forearm | Part::Hand | Part::Shank) => along_parent(),
            (_, Part::Foot) => level_heading(direction).unwrap_or(parent),
            (_, Part::Toes) => parent,
            _ => Rotation::IDENTITY,
        });
    }
    turned
}

/// Returns the rotation to a horizontal foot that points along `direction` seen from above; `None` if `direction` is
/// vertical.
fn level_heading(direction: Vec3) -> Option<Rotation> {
    let forward = Vec3::new(direction.x, 0.0, direction.z);
    let length = forward.length();
    (length > 0.3).then(|| {
        let z = forward / length;
        Rotation::from_mat3(&Mat3::from_cols(Vec3::Y.cross(z), Vec3::Y, z))
    })
}
