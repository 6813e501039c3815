//! A ragdoll as plain data, in metres and kilograms, written by `ragdoll build` and loaded by games.
//!
//! ```
//! # let rig = sinew::mannequin::mannequin().rig;
//! # let analysis = sinew_anim::analyze(&rig)?;
//! # let (def, _) = sinew_ragdoll::build(&rig, &analysis, &sinew_ragdoll::BuildOptions::default())?;
//! let head = def.bodies.iter().find(|body| body.role == "head").expect("the body exists");
//! assert!(head.character_from_body.translation.y > 0.8 * def.height);
//! assert!((3.0..8.0).contains(&head.mass.mass), "{} kg", head.mass.mass);
//! let sum: f32 = def.bodies.iter().map(|body| body.mass.mass).sum();
//! assert!((sum - def.total_mass).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use sinew_math::{Transform, Vec3};
use sinew_physics::{JointKind, MassProperties, Shape};

/// One body of a ragdoll.
#[derive(Clone, Debug, PartialEq)]
pub struct RagdollBodyDef {
    /// Name of the rig joint that carries the body, or `joint N` if the file gives none.
    pub bone: String,
    /// Index of this joint in the rig.
    pub joint: usize,
    /// Further rig joints that move rigidly with the body (merged twist, finger, helper joints), by index.
    pub merged: Vec<usize>,
    /// VRM 1 humanoid bone name, or else `spine_n`, `tail_n`, `limb_n_m`.
    pub role: String,
    /// Confidence of the role, 0..=1.
    pub confidence: f32,
    /// Geometry, metres, in the body's frame.
    pub shape: Shape,
    /// Body frame in character space at the bind pose: metres, +Y up, facing +Z, feet at y = 0. The shape sits at the
    /// body's origin, along its axes.
    pub character_from_body: Transform,
    /// Mass, kg; centre of mass in the body's frame, and inertia about this centre.
    pub mass: MassProperties,
}

/// One joint of a ragdoll.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RagdollJointDef {
    /// Index of the parent body.
    pub parent: usize,
    /// Index of the child body.
    pub child: usize,
    /// Joint frame in the parent body's frame; its x axis is the twist (or hinge) axis, at the cone's centre.
    pub frame_parent: Transform,
    /// Joint frame in the child body's frame.
    pub frame_child: Transform,
    /// Kind of the joint, with its limits: a ball, hinge, universal or fixed joint.
    pub kind: JointKind,
    /// Friction torque, N·m.
    pub friction_torque: f32,
}

/// A ragdoll: bodies parent before child, joints in the same order (`joints[i].child == i + 1`).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RagdollDef {
    /// Bodies; the first is the pelvis.
    pub bodies: Vec<RagdollBodyDef>,
    /// Joints.
    pub joints: Vec<RagdollJointDef>,
    /// Pairs of bodies that do not collide, in addition to jointed pairs.
    pub disabled_pairs: Vec<(usize, usize)>,
    /// Names of the rig joints that carry no body.
    pub dropped_bones: Vec<String>,
    /// Total mass, kg.
    pub total_mass: f32,
    /// Height in the bind pose, metres.
    pub height: f32,
    /// Scale, metres per file unit.
    pub unit_scale: f32,
    /// The file's up axis, derived from the skeleton: unit, along an axis.
    pub up_axis: Vec3,
    /// Rotation from model space (file) to character space (+Y up, facing +Z).
    pub character_from_model: Transform,
}
