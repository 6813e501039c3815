//! Ranges of motion by joint, degrees: clinical ranges (AAOS and the sources that agree with it within 10°), expressed
//! in the joint's axes. Left side; the right side is its mirror image.
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
//! use sinew_ragdoll::limits::table::{Motion, entry};
//!
//! let knee = entry(&bones, 2);
//! assert_eq!(knee.motion, Motion::Hinge(-2.0, 142.0));
//! ```

use crate::build::bones::{Anatomy, Bones};
use crate::build::part::{Part, Side};

/// Range of motion of a joint, from the anatomical pose (standing, arms hanging, palms inward, feet level).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// Swing within an elliptic cone, and twist. The angles are about the [`Axes`] of the joint.
    Ball(Cone),
    /// A cone like that of `Ball`, without twist.
    Universal(Cone),
    /// Bend about one axis between these two angles; 0 is straight.
    Hinge(f32, f32),
}

/// An elliptic swing cone about its own centre, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Centre: swing about y and z.
    pub center: [f32; 2],
    /// Half-angles about y and z, from the centre.
    pub half: [f32; 2],
    /// Range of twist about x.
    pub twist: [f32; 2],
}

/// Directions of a joint's axes in the anatomical pose, left side: x along the child bone, y the flexion axis, z = x ×
/// y.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// x up, y to the left: bending forward is +y.
    Upright,
    /// x down, y to the right: flexion (forward) is +y, adduction (inward) is +z, inward rotation is +x.
    Hanging,
    /// x down, y back: bending toward the palm is +y, toward the little finger +z.
    Palm,
    /// x down the shank, y to the left: plantar flexion is +y, turning the sole outward is +z.
    Sole,
    /// Directions of the bones in the bind pose.
    Bind,
}

/// Entry of the table for one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Axes of the angles of `motion`.
    pub axes: Axes,
    /// Range of motion.
    pub motion: Motion,
    /// Largest torque of the muscles about the joint for 75 kg at 1.75 m, N·m (DeepMimic and dm_control humanoids).
    pub torque: f32,
}

const fn ball(axes: Axes, center: [f32; 2], half: [f32; 2], twist: [f32; 2], torque: f32) -> Entry {
    Entry { axes, motion: Motion::Ball(Cone { center, half, twist }), torque }
}

const SHOULDER: Entry = ball(Axes::Hanging, [45.0, -60.0], [95.0, 80.0], [-80.0, 80.0], 100.0);
const SHOULDER_UNDER_CLAVICLE: Entry = ball(Axes::Hanging, [40.0, -40.0], [75.0, 65.0], [-80.0, 80.0], 100.0);
const CLAVICLE: Entry = ball(Axes::Bind, [0.0; 2], [25.0, 20.0], [-10.0, 10.0], 100.0);
const ELBOW: Entry = Entry { axes: Axes::Hanging, motion: Motion::Hinge(0.0, 145.0), torque: 60.0 };
/// The elbow is a hinge, so the wrist's twist represents the forearm's rotation (palm up to palm down).
const WRIST: Entry = ball(Axes::Palm, [0.0, 6.0], [75.0, 30.0], [-85.0, 85.0], 20.0);
const HIP: Entry = ball(Axes::Hanging, [50.0, -8.0], [72.0, 37.0], [-45.0, 40.0], 200.0);
const KNEE: Entry = Entry { axes: Axes::Sole, motion: Motion::Hinge(-2.0, 142.0), torque: 150.0 };
const ANKLE: Entry = Entry {
    axes: Axes::Sole,
    motion: Motion::Universal(Cone { center: [15.0, 0.0], half: [35.0, 25.0], twist: [0.0; 2] }),
    torque: 90.0,
};
const TOES: Entry = Entry { axes: Axes::Hanging, motion: Motion::Hinge(-40.0, 65.0), torque: 20.0 };
const LIMB: Entry = ball(Axes::Bind, [0.0; 2], [50.0, 50.0], [-20.0, 20.0], 60.0);
const TAIL: Entry = ball(Axes::Bind, [0.0; 2], [25.0, 25.0], [-10.0, 10.0], 40.0);
const CREATURE_NECK: Entry = ball(Axes::Bind, [0.0; 2], [40.0, 40.0], [-30.0, 30.0], 50.0);

/// Returns the table's entry for the joint between a bone and its parent.
pub fn entry(bones: &Bones, bone: usize) -> Entry {
    let part = bones.list[bone].part;
    if bones.anatomy == Anatomy::Creature {
        return match part {
            Part::Neck | Part::Head => CREATURE_NECK,
            Part::Pelvis | Part::Spine | Part::Tail => TAIL,
            _ => LIMB,
        };
    }
    let parent = bones.list[bone].parent.map(|p| bones.list[p].part);
    match part {
        Part::Spine => spine(count(bones, &[Part::Spine])),
        Part::Neck | Part::Head => neck(count(bones, &[Part::Neck, Part::Head])),
        // Use a hinge only between the two halves of a limb; between other bones its axis would be meaningless.
        Part::Forearm if parent != Some(Part::UpperArm) => LIMB,
        Part::Shank if parent != Some(Part::Thigh) => LIMB,
        Part::Toes if parent != Some(Part::Foot) => LIMB,
        Part::UpperArm if parent == Some(Part::Clavicle) => SHOULDER_UNDER_CLAVICLE,
        Part::UpperArm => SHOULDER,
        Part::Clavicle => CLAVICLE,
        Part::Forearm => ELBOW,
        Part::Hand => WRIST,
        Part::Thigh => HIP,
        Part::Shank => KNEE,
        Part::Foot => ANKLE,
        Part::Toes => TOES,
        Part::Tail => TAIL,
        Part::Pelvis | Part::Limb => LIMB,
    }
}

fn count(bones: &Bones, parts: &[Part]) -> f32 {
    let is = |part: Part| parts.contains(&part);
    bones.list.iter().filter(|bone| is(bone.part) && bone.side == Side::Middle).count() as f32
}

/// Returns the entry of one of `n` spine joints. The whole spine flexes 83, extends 30, bends sideways 35 and twists 45
/// degrees. Each joint has an equal part, plus a fifth more swing, because the joints never reach their ends together.
fn spine(n: f32) -> Entry {
    let half = [1.2 * 0.5 * (83.0 + 30.0) / n, 1.2 * 35.0 / n];
    ball(Axes::Upright, [0.5 * (83.0 - 30.0) / n, 0.0], half, [-45.0 / n, 45.0 / n], 200.0)
}

/// Returns the entry of one of `n` neck joints. The whole neck nods 48, bends sideways 40 and twists 70 degrees,
/// divided as for the spine.
fn neck(n: f32) -> Entry {
    let more = if n > 1.0 { 1.2 } else { 1.0 };
    let twist = if n > 1.0 { 76.0 / n } else { 70.0 };
    ball(Axes::Upright, [0.0; 2], [more * 48.0 / n, more * 40.0 / n], [-twist, twist], 50.0)
}
