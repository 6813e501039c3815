//! Converts between poses of the rig and poses of the bodies, for every joint of the file.
//!
//! There are three spaces: the **model** space of the file (file units, its own up axis), the **character** space of
//! the ragdoll (metres, +Y up, facing +Z) and the world. A body keeps its offset from its bone in the bind pose.
//!
//! Root motion must be stored in one way; otherwise a clip that moves a root node above the pelvis could not blend with
//! a ragdoll that moves the pelvis. So all poses here are **flat**: nodes above the pelvis stay in their rest pose, and
//! the *heads* below them (usually only the pelvis) carry all motion.
//!
//! ```
//! # let rig = sinew::mannequin::mannequin().rig;
//! # let analysis = sinew_anim::analyze(&rig)?;
//! # let (def, _) = sinew_ragdoll::build(&rig, &analysis, &sinew_ragdoll::BuildOptions::default())?;
//! use sinew_math::{Transform, Vec3};
//! use sinew_ragdoll::Mapping;
//!
//! let mapping = Mapping::new(&rig, &def, &analysis.bind_model);
//! let (place, mut bodies) = (Transform::from_translation(Vec3::X * 5.0), Vec::new());
//! mapping.bodies_from_model(&analysis.bind_model, place, &mut bodies);
//! for (body, pose) in def.bodies.iter().zip(&bodies) {
//!     let due = place * body.character_from_body;
//!     assert!((pose.translation - due.translation).length() < 1e-4, "{}", body.bone);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod heads;
mod physical;

pub use physical::Physical;

use crate::def::RagdollDef;
use heads::Head;
pub(crate) use heads::carries_character;
use sinew_anim::{JointIdx, LocalTransform, Rig};
use sinew_math::{Affine, Rotation, Transform, Vec3};

/// Manner in which a joint follows its body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Follow {
    /// The joint takes the body's rotation; its position follows from the parent, because joints do not stretch.
    Turn,
    /// The joint takes the body's rotation and position: the pelvis, and joints that the rig parents differently from
    /// the anatomy.
    Move,
}

/// Body that a rig joint follows, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Driven {
    body: usize,
    follow: Follow,
}

/// The fixed relations between a rig and its ragdoll.
#[derive(Clone, Debug, PartialEq)]
pub struct Mapping {
    /// Transform from model space (file units) to character space (metres).
    character_from_model: Affine,
    model_from_character: Affine,
    /// Rigid part of this transform, metres, and its scale in metres per file unit.
    place_of_model: Transform,
    unit_scale: f32,
    /// Joint of each body, and the body's frame in the bone's rigid frame, metres.
    bones: Vec<(JointIdx, Transform)>,
    /// Joints with a body and all their ancestors, ascending, each with its parent.
    bearing: Vec<(JointIdx, Option<JointIdx>)>,
    /// Body of each joint of the rig.
    driven: Vec<Option<Driven>>,
    /// Joints that carry root motion, the pelvis first.
    heads: Vec<Head>,
    /// Nodes above the heads, ascending.
    carriers: Vec<JointIdx>,
    /// Joints that no body moves and that have no driven descendant.
    free: Vec<JointIdx>,
    /// For each joint of the rig, true if a body moves it or one of its descendants.
    moves_bodies: Vec<bool>,
}

impl Mapping {
    /// Creates the mapping of a rig, its ragdoll, and the bind pose in model space (`RigAnalysis::bind_model`).
    ///
    /// # Panics
    /// If the definition has no body or names joints that the rig does not have, or `bind_model` does not have one
    /// entry per joint.
    pub fn new(rig: &Rig, def: &RagdollDef, bind_model: &[Affine]) -> Self {
        assert_eq!(bind_model.len(), rig.joints.len(), "the bind pose has one transform per joint");
        assert!(!def.bodies.is_empty(), "a ragdoll has bodies");
        let character_from_model = character_from_model(def);
        let bones = def.bodies.iter().map(|body| {
            let bone = (character_from_model * bind_model[body.joint]).to_rigid();
            (body.joint, bone.inverse() * body.character_from_body)
        });
        let heads = heads::find(rig, def);
        let (driven, carriers) = (driven(rig, def), heads::carriers(rig, &heads));
        let keeps = |joint: JointIdx| carriers.contains(&joint) || heads.iter().any(|h| h.joint == joint);
        let moves_bodies = moves_bodies(rig, &driven);
        Self {
            free: free(rig, def, &driven, &moves_bodies, keeps),
            moves_bodies,
            character_from_model,
            model_from_character: character_from_model.inverse(),
            place_of_model: def.character_from_model,
            unit_scale: def.unit_scale,
            bones: bones.collect(),
            bearing: bearing(rig, def),
            driven,
            carriers,
            heads,
        }
    }

    /// Returns the transform from model space (file units) to character space (metres, +Y up, facing +Z).
    pub fn character_from_model(&self) -> Affine {
        self.character_from_model
    }

    /// Returns the transform from model space to the world, for a character at `world_from_character`.
    pub fn world_from_model(&self, world_from_character: Transform) -> Affine {
        Affine::from(world_from_character) * self.character_from_model
    }

    /// Returns the joints that carry root motion, the pelvis first.
    pub fn heads(&self) -> impl Iterator<Item = JointIdx> {
        self.heads.iter().map(|head| head.joint)
    }

    /// Returns the joints that no body moves and that move no body: fingers, face, end helpers. On a limp character
    /// they still follow its clips, except toes, whose walking motion makes no sense in a lying pose.
    pub fn free(&self) -> &[JointIdx] {
        &self.free
    }

    /// Returns true if the joint is above the pelvis: in a flat pose it is at rest.
    pub fn carries(&self, joint: JointIdx) -> bool {
        self.carriers.binary_search(&joint).is_ok()
    }

    /// Returns true if a body moves the joint or one of its descendants, so that physics determines it.
    pub fn moves_bodies(&self, joint: JointIdx) -> bool {
        self.moves_bodies[joint]
    }

    /// Returns the body that carries a joint from above: the nearest body that moves the joint or one of its ancestors.
    pub(crate) fn body_above(&self, rig: &Rig, joint: JointIdx) -> Option<usize> {
        let mut at = Some(joint);
        while let Some(joint) = at {
            if let Some(driven) = self.driven[joint] {
                return Some(driven.body);
            }
            at = rig.joints[joint].parent;
        }
        None
    }

    /// Computes the world pose of every body for a model pose: `bodies` is cleared and filled.
    ///
    /// # Panics
    /// If `model` is shorter than the rig has joints.
    pub fn bodies_from_model(
        &self,
        model: &[Affine],
        world_from_character: Transform,
        bodies: &mut Vec<Transform>,
    ) {
        bodies.clear();
        bodies.extend(self.bones.iter().map(|&(joint, bone_from_body)| {
            world_from_character * self.bone(&model[joint]) * bone_from_body
        }));
    }

    /// Computes the world pose of every body for the local transforms of all joints: equal to
    /// [`bodies_from_model`](Self::bodies_from_model) up to rounding, at a quarter of its cost. `bodies` is cleared and
    /// filled. Returns false, with undefined contents, if an ancestor joint of a body has a non-uniform scale. `frames`
    /// is scratch memory.
    ///
    /// # Panics
    /// If `pose` is shorter than the rig has joints.
    pub fn bodies_from_pose(
        &self,
        pose: &[LocalTransform],
        world_from_character: Transform,
        frames: &mut Vec<(Transform, f32)>,
        bodies: &mut Vec<Transform>,
    ) -> bool {
        bodies.clear();
        frames.resize(pose.len(), (Transform::IDENTITY, 1.0));
        let root = (world_from_character * self.place_of_model, self.unit_scale);
        for &(joint, parent) in &self.bearing {
            let (local, above) = (&pose[joint], parent.map_or(&root, |parent| &frames[parent]));
            let scale = local.scale.x;
            if !(scale > 0.0 && scale == local.scale.y && scale == local.scale.z) {
                return false;
            }
            let place = above.0.point(local.translation * above.1);
            let frame = (Transform::new(place, above.0.rotation * local.rotation), above.1 * scale);
            frames[joint] = frame;
        }
        for (joint, bone_from_body) in &self.bones {
            bodies.push(frames[*joint].0 * *bone_from_body);
        }
        true
    }

    /// Returns the rigid frame of a bone in character space, metres.
    fn bone(&self, model: &Affine) -> Transform {
        (self.character_from_model * *model).to_rigid()
    }

    /// Returns a rigid motion in character space as the equivalent affine map of model space.
    fn in_model(&self, motion: Transform) -> Affine {
        self.model_from_character * Affine::from(motion) * self.character_from_model
    }
}

/// Returns the transform from model space (file units) to character space (metres).
pub fn character_from_model(def: &RagdollDef) -> Affine {
    let turn = def.character_from_model;
    Affine::from_scale_rotation_translation(Vec3::splat(def.unit_scale), turn.rotation, turn.translation)
}

/// Returns the local transform of `local_affine` with the scale of `like`: a rig's local transforms cannot contain
/// shear.
fn with_scale_of(like: &LocalTransform, local_affine: &Affine) -> LocalTransform {
    let s = like.scale;
    let unscaled = |column: Vec3, scale: f32| if scale.abs() > 1e-12 { column / scale } else { column };
    let m = &local_affine.linear;
    let columns = sinew_math::Mat3::from_cols(
        unscaled(m.x_axis, s.x),
        unscaled(m.y_axis, s.y),
        unscaled(m.z_axis, s.z),
    );
    LocalTransform {
        translation: local_affine.translation,
        // Use the sign nearer to the replaced pose, so that keys made from this pose do not change sign.
        rotation: Rotation::from_mat3_lossy(&columns).toward(like.rotation),
        scale: s,
    }
}

/// Returns the joints with a body and all their ancestors, ascending, each with its parent.
fn bearing(rig: &Rig, def: &RagdollDef) -> Vec<(JointIdx, Option<JointIdx>)> {
    let mut bears = vec![false; rig.joints.len()];
    for body in &def.bodies {
        let mut at = Some(body.joint);
        while let Some(joint) = at.filter(|&joint| !core::mem::replace(&mut bears[joint], true)) {
            at = rig.joints[joint].parent;
        }
    }
    (0..rig.joints.len())
        .filter(|&joint| bears[joint])
        .map(|joint| (joint, rig.joints[joint].parent))
        .collect()
}

/// Returns the body that each joint of the rig follows, and how; `None` for a joint without a body.
fn driven(rig: &Rig, def: &RagdollDef) -> Vec<Option<Driven>> {
    let mut driven: Vec<Option<Driven>> = vec![None; rig.joints.len()];
    let body_of = |joint: JointIdx| def.bodies.iter().position(|body| body.joint == joint);
    let above = |joint: JointIdx| {
        let mut at = rig.joints[joint].parent;
        while let Some(joint) = at {
            if let Some(body) = body_of(joint) {
                return Some(body);
            }
            at = rig.joints[joint].parent;
        }
        None
    };
    for (body, bone) in def.bodies.iter().enumerate() {
        let parent = def.joints.iter().find(|joint| joint.child == body).map(|joint| joint.parent);
        let follow =
            if parent.is_some() && above(bone.joint) == parent { Follow::Turn } else { Follow::Move };
        driven[bone.joint] = Some(Driven { body, follow });
        // A merged joint below its body follows as its child; elsewhere in the rig it must be moved explicitly.
        for &merged in &bone.merged {
            if above(merged) != Some(body) && body_of(merged).is_none() {
                driven[merged] = Some(Driven { body, follow: Follow::Move });
            }
        }
    }
    driven
}

/// Returns, for each joint, true if it or one of its descendants is driven.
fn moves_bodies(rig: &Rig, driven: &[Option<Driven>]) -> Vec<bool> {
    let mut moves: Vec<bool> = driven.iter().map(Option::is_some).collect();
    for joint in (0..moves.len()).rev() {
        if let Some(parent) = rig.joints[joint].parent.filter(|_| moves[joint]) {
            moves[parent] = true;
        }
    }
    moves
}

/// Returns the joints that no body moves and that have no driven descendant, except those of feet and those that
/// `keeps` excludes.
fn free(
    rig: &Rig,
    def: &RagdollDef,
    driven: &[Option<Driven>],
    moves_bodies: &[bool],
    keeps: impl Fn(JointIdx) -> bool,
) -> Vec<JointIdx> {
    let is_foot = |body: usize| {
        let role = &def.bodies[body].role;
        role.ends_with("Foot") || role.ends_with("Toes")
    };
    let mut on: Vec<Option<usize>> = Vec::with_capacity(rig.joints.len());
    for (joint, node) in rig.joints.iter().enumerate() {
        let own = driven[joint].map(|driven| driven.body);
        on.push(own.or_else(|| node.parent.and_then(|parent| on[parent])));
    }
    let is_free = |&joint: &JointIdx| {
        !moves_bodies[joint] && !keeps(joint) && on[joint].is_some_and(|body| !is_foot(body))
    };
    (0..rig.joints.len()).filter(is_free).collect()
}
