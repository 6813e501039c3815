//! Friction of limp joints.
//!
//! ```
//! # let rig = sinew::mannequin::mannequin().rig;
//! # let analysis = sinew_anim::analyze(&rig)?;
//! use sinew_ragdoll::{BuildOptions, build};
//!
//! let (def, _) = build(&rig, &analysis, &BuildOptions::default())?;
//! let of = |role| {
//!     let joint = def.joints.iter().find(|joint| def.bodies[joint.child].role == role);
//!     joint.expect("the body exists").friction_torque
//! };
//! assert!(of("leftUpperLeg") > of("leftHand"), "N·m of a hip and of a wrist");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::JointPlan;
use crate::build::bones::{Anatomy, Bones};
use crate::fit::Fit;
use crate::tuning::{GRAVITY, SHARE_OF_LOAD};
use sinew_math::{Vec3, max, min};
use sinew_physics::MassProperties;

/// Returns the friction torque of each joint, N·m. `plans` contain the table's torques for the total mass.
pub fn friction_torques(
    bones: &Bones,
    fits: &[Fit],
    masses: &[MassProperties],
    plans: &[JointPlan],
) -> Vec<f32> {
    let table = plans.iter().map(|plan| plan.def.friction_torque);
    match bones.anatomy {
        Anatomy::Human => table.collect(),
        Anatomy::Creature => {
            let of = |(plan, table): (&JointPlan, f32)| {
                max(table, SHARE_OF_LOAD * load(bones, fits, masses, plan.def.child))
            };
            plans.iter().zip(table).map(of).collect()
        }
    }
}

/// Returns the largest gravity torque at a bone's joint, N·m: that of the subtree below or that of the rest of the
/// body, whichever is less. The joint carries both equally.
fn load(bones: &Bones, fits: &[Fit], masses: &[MassProperties], bone: usize) -> f32 {
    let pivot = bones.list[bone].head;
    let mut below = vec![false; bones.list.len()];
    let (mut hanging, mut rest) = (Vec3::ZERO, Vec3::ZERO);
    for body in 0..bones.list.len() {
        // Parents precede their children.
        below[body] = body == bone || bones.list[body].parent.is_some_and(|parent| below[parent]);
        let center = fits[body].character_from_body.point(masses[body].center);
        let moment = (center - pivot) * masses[body].mass;
        if below[body] {
            hanging += moment;
        } else {
            rest += moment;
        }
    }
    GRAVITY * min(hanging.length(), rest.length())
}
