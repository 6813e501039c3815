//! Springs of a rig: hair, tails, ears, straps, skirts. They are stated by the file (`VRMC_springBone`, VRM 0's
//! secondary animation) or guessed from names ([`guess_springs`]).
//!
//! Plain data: `sinew_ragdoll::springs` simulates them. Laws, units and names follow
//! [VRMC_springBone 1.0](https://github.com/vrm-c/vrm-specification/tree/master/specification/VRMC_springBone-1.0), so
//! that a file's numbers are used unchanged.

mod guess;

pub use guess::guess_springs;

use crate::garments::GarmentColumn;
use crate::rig::JointIdx;
use crate::tuning::SPRING_LINK_SHARE;
use sinew_math::{Rotation, Vec3};

/// Springs of a character. Default: none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Springs {
    /// Chains of swinging bones.
    pub chains: Vec<SpringChain>,
    /// Colliders that chains refer to by index.
    pub colliders: Vec<SpringCollider>,
    /// Links across strands.
    pub links: Vec<SpringLink>,
}

/// Link that keeps the tips of two bones at their distance in the bind pose, so that the strands of a skirt stay
/// together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringLink {
    /// Joints of the two bones, both in chains. A joint that does not swing has no link.
    pub joints: [JointIdx; 2],
    /// Share of the distance error corrected per 1/60 s, 0..=1.
    pub share: f32,
    /// False: the link limits only the largest distance of the tips, like cloth. True: also the smallest.
    pub holds_apart: bool,
}

impl Default for SpringLink {
    /// Settings that correct half of the error per 1/60 s, only when the tips move apart; joints 0 and 0.
    fn default() -> Self {
        Self { joints: [0; 2], share: SPRING_LINK_SHARE, holds_apart: false }
    }
}

impl SpringLink {
    /// Returns links with these settings between neighbouring strands, joint by joint; `closed` also links the last
    /// strand to the first.
    pub fn across(self, strands: &[GarmentColumn], closed: bool) -> Vec<Self> {
        let last = if closed && strands.len() > 2 { Some([strands.len() - 1, 0]) } else { None };
        let pairs = (1..strands.len()).map(|k| [k - 1, k]).chain(last);
        let link = |(&a, &b): (&JointIdx, &JointIdx)| Self { joints: [a, b], ..self };
        pairs.flat_map(|[a, b]| strands[a].joints.iter().zip(&strands[b].joints).map(link)).collect()
    }
}

impl Springs {
    /// True if there are no chains.
    pub fn is_empty(&self) -> bool {
        self.chains.is_empty()
    }

    /// True if a bone of a chain rotates about the joint.
    pub fn swings(&self, joint: JointIdx) -> bool {
        self.chains.iter().flat_map(|chain| &chain.bones).any(|bone| bone.joint == joint)
    }

    /// Number of bones of all chains.
    pub fn bone_count(&self) -> usize {
        self.chains.iter().map(|chain| chain.bones.len()).sum()
    }
}

/// Chain of swinging bones with its colliders.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpringChain {
    /// Name in the file, or `""`.
    pub name: String,
    /// Bones, from the root to the tip; no joint is in two chains.
    pub bones: Vec<SpringBone>,
    /// Joint in whose space inertia acts; `None`: the world. The joint is above the chain.
    pub center: Option<JointIdx>,
    /// Indices into [`Springs::colliders`].
    pub colliders: Vec<usize>,
    /// True: the character's own ragdoll bodies are colliders, too. Default false, because a file lists its colliders.
    pub hits_body: bool,
}

/// Bone that swings about its joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringBone {
    /// Joint that rotates.
    pub joint: JointIdx,
    /// Tip of the bone in the joint's own space, file units. Zero: the bone does not swing.
    pub tail: Vec3,
    /// Speed at which the spring moves the tip toward the rest pose, file units per second, ≥ 0.
    pub stiffness: f32,
    /// Velocity that gravity gives the tip, file units per second, in the file's axes.
    pub gravity: Vec3,
    /// Share of the tip's motion lost in 1/60 s, 0..=1.
    pub drag: f32,
    /// Radius of the tip against colliders, file units, ≥ 0.
    pub radius: f32,
    /// Limit of the bone's rotation from the rest pose.
    pub limit: Option<SpringLimit>,
}

impl Default for SpringBone {
    /// Defaults of VRMC_springBone: stiffness 1, drag 0.5, no gravity, radius or limit; joint 0, length 0.
    fn default() -> Self {
        Self {
            joint: 0,
            tail: Vec3::ZERO,
            stiffness: 1.0,
            gravity: Vec3::ZERO,
            drag: 0.5,
            radius: 0.0,
            limit: None,
        }
    }
}

/// Limit of the direction of a bone (`VRMC_springBone_limit`).
///
/// Directions are in a frame whose +Y is the bone at rest: the joint's axes, rotated the shortest way so that +Y lies
/// along the bone, then by [`rotation`](Self::rotation).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringLimit {
    /// Shape of the allowed region.
    pub kind: LimitKind,
    /// Rotation of the frame, in its own axes.
    pub rotation: Rotation,
}

/// Shape of a limit, angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LimitKind {
    /// Cone: the direction is within `angle` of +Y.
    Cone {
        /// Angle, 0..=π.
        angle: f32,
    },
    /// Hinge: the direction is within `angle` of +Y in the plane perpendicular to X.
    Hinge {
        /// Angle, 0..=π.
        angle: f32,
    },
    /// Spherical: the rotation of the direction about X and its elevation out of the plane perpendicular to X are
    /// limited separately.
    Spherical {
        /// Largest rotation about X, 0..=π.
        phi: f32,
        /// Largest elevation, 0..=π/2.
        theta: f32,
    },
}

/// Shape that keeps the tips of springs outside or inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringCollider {
    /// Joint that carries the collider.
    pub joint: JointIdx,
    /// Shape, in the joint's own space.
    pub shape: ColliderShape,
}

/// Shape of a collider in the space of its joint, file units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColliderShape {
    /// A ball.
    Sphere {
        /// Centre of the ball.
        offset: Vec3,
        /// Radius, ≥ 0.
        radius: f32,
        /// Side on which tips stay.
        keeps: Side,
    },
    /// A capsule.
    Capsule {
        /// Centre of the cap at one end.
        offset: Vec3,
        /// Centre of the cap at the other end.
        tail: Vec3,
        /// Radius, ≥ 0.
        radius: f32,
        /// Side on which tips stay.
        keeps: Side,
    },
    /// An infinite plane; tips stay on the side of its normal.
    Plane {
        /// A point of the plane.
        offset: Vec3,
        /// Unit normal of the plane.
        normal: Vec3,
    },
}

/// Side of a collider's surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// Tips stay outside of the surface. Default.
    #[default]
    Outside,
    /// Tips stay inside of the surface.
    Inside,
}
