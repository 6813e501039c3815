//! A detached limb: bodies of its own in the world, and its part of the skin.

use super::CharacterDef;
use super::show::rows;
use crate::drive::hangs_on;
use crate::owner::{OwnerKind, owner};
use sinew_anim::JointIdx;
use sinew_math::{Affine, Mat3, ReadError, Reader, Transform, Vec3, Writer};
use sinew_physics::{BodyId, JointId, World};
use std::sync::Arc;

/// First bytes of a saved limb; the last one is the version.
const MAGIC: &[u8; 8] = b"sinew-l\x01";
/// Number of bytes in which a body or a joint of the skin is saved.
const BODY_BYTES: usize = 12;
const SKIN_BYTES: usize = 56;

/// A limb from [`Character::detach`](super::Character::detach): bodies, joints between them, and the joints of the rig
/// that move the limb's skin. The world simulates the limb without updates, until [`despawn`](Self::despawn).
#[derive(Clone, Debug)]
pub struct Limb {
    def: Arc<CharacterDef>,
    /// Indices of the limb's bodies in the definition, ascending; all others are descendants of the first.
    parts: Vec<usize>,
    bodies: Vec<BodyId>,
    /// Joint from each body, except the first, to the body above it.
    joints: Vec<JointId>,
    skin: Vec<SkinJoint>,
}

/// A joint of the rig, and the body that carries it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SkinJoint {
    joint: JointIdx,
    /// Index of the body among the limb's bodies.
    body: usize,
    body_from_joint: Affine,
}

impl Limb {
    /// Creates a limb from bodies in the world. `world_from_joint` contains the present transform of every joint of the
    /// rig, `poses` those of the limb's bodies.
    pub(super) fn new(
        def: Arc<CharacterDef>,
        parts: Vec<usize>,
        bodies: Vec<BodyId>,
        joints: Vec<JointId>,
        world_from_joint: &[Affine],
        poses: &[Transform],
    ) -> Self {
        let mut skin = Vec::new();
        for (joint, place) in world_from_joint.iter().enumerate() {
            let carrier = def.mapping().body_above(&def.rig, joint);
            if let Some(body) = carrier.and_then(|body| parts.iter().position(|&part| part == body)) {
                let body_from_joint = Affine::from(poses[body].inverse()) * *place;
                skin.push(SkinJoint { joint, body, body_from_joint });
            }
        }
        Self { def, parts, bodies, joints, skin }
    }

    /// Returns the definition of the character to which the limb belonged.
    pub fn def(&self) -> &Arc<CharacterDef> {
        &self.def
    }

    /// Returns the indices of the limb's bodies in the definition, ascending; the first is at the cut.
    pub fn parts(&self) -> &[usize] {
        &self.parts
    }

    /// Returns the limb's bodies in the world, one for each of [`parts`](Self::parts).
    pub fn bodies(&self) -> &[BodyId] {
        &self.bodies
    }

    /// Returns the limb's joints in the world, one for each body but the first: to the body above.
    pub fn joints(&self) -> &[JointId] {
        &self.joints
    }

    /// Returns the joints of the rig whose skin belongs to the limb, ascending. A vertex belongs to the limb if these
    /// joints move it most.
    pub fn skin_joints(&self) -> impl Iterator<Item = JointIdx> {
        self.skin.iter().map(|skin| skin.joint)
    }

    /// Computes the world transform of each of [`skin_joints`](Self::skin_joints), metres, between the last step
    /// (`alpha` 0) and the present one (1): `out` is cleared and filled.
    ///
    /// # Panics
    /// If one of the limb's bodies is missing.
    pub fn world_from_joints(&self, world: &World, alpha: f32, out: &mut Vec<Affine>) {
        let poses: Vec<Affine> =
            self.bodies.iter().map(|&body| Affine::from(world.interpolated(body, alpha))).collect();
        out.clear();
        out.extend(self.skin.iter().map(|skin| poses[skin.body] * skin.body_from_joint));
    }

    /// Computes skinning matrices for a renderer, like [`Character::skin_palette`](super::Character::skin_palette): the
    /// limb is drawn with the whole mesh, whose other parts shrink to the cut. Allocates.
    ///
    /// # Panics
    /// If the rig has no such skin, or one of the limb's bodies is missing.
    pub fn skin_palette(&self, world: &World, skin: usize, alpha: f32, palette: &mut Vec<[f32; 12]>) {
        let mut places = Vec::new();
        self.world_from_joints(world, alpha, &mut places);
        let root = self.def.ragdoll.bodies[self.parts[0]].joint;
        let place =
            |joint: JointIdx| self.skin.iter().position(|skin| skin.joint == joint).map(|at| places[at]);
        let cut = place(root).map_or(Vec3::ZERO, |root| root.translation);
        let skin = &self.def.rig.skins[skin];
        palette.clear();
        palette.extend(
            skin.joints
                .iter()
                .zip(&skin.inverse_bind)
                .map(|(&joint, bind)| rows(&place(joint).map_or(shrunk(cut), |place| place * *bind))),
        );
    }

    /// Detaches a part of the limb, by role or bone, like [`Character::detach`](super::Character::detach). `None` if
    /// the limb does not contain that body, or the body is its first.
    ///
    /// # Panics
    /// If no body of the definition has that name, or one of the limb's bodies is missing.
    pub fn detach(&mut self, world: &mut World, bone: &str) -> Option<Self> {
        let def = self.def.clone();
        let named = def.body_named(bone).unwrap_or_else(|| panic!("no body is called '{bone}'"));
        let first = self.parts.iter().position(|&part| part == named).filter(|&first| first > 0)?;
        cut_joint(world, self.joints[first - 1]);
        let is_off = |&part: &usize| hangs_on(&def.ragdoll, part, named);
        let mut off = Self {
            def: def.clone(),
            parts: Vec::new(),
            bodies: Vec::new(),
            joints: Vec::new(),
            skin: Vec::new(),
        };
        let mut left = off.clone();
        for (index, part) in self.parts.iter().enumerate() {
            let to = if is_off(part) { &mut off } else { &mut left };
            to.parts.push(*part);
            to.bodies.push(self.bodies[index]);
            if index > 0 && index != first {
                to.joints.push(self.joints[index - 1]);
            }
        }
        for skin in &self.skin {
            let part = self.parts[skin.body];
            let to = if is_off(&part) { &mut off } else { &mut left };
            let body = to.parts.iter().position(|&own| own == part).expect("the new limb contains this body");
            to.skin.push(SkinJoint { body, ..*skin });
        }
        *self = left;
        Some(off)
    }

    /// Removes the limb from the world.
    ///
    /// # Panics
    /// If one of the limb's bodies is missing.
    pub fn despawn(self, world: &mut World) {
        for body in self.bodies {
            world.disown_body(body);
            world.remove_body(body);
        }
    }

    /// Takes ownership of the limb's bodies and joints, so that no other call removes them.
    pub(super) fn own(&self, world: &mut World) {
        let owner = owner(&self.def.ragdoll, OwnerKind::Limb);
        world.own_bodies(&owner, &self.bodies, &self.parts);
        world.own_joints(&owner, &self.joints, &self.parts[1..]);
    }

    /// Writes the state that neither the world's snapshot nor the definition contains.
    pub fn save(&self, w: &mut Writer) {
        w.raw(MAGIC);
        w.count(self.parts.len());
        for (&part, body) in self.parts.iter().zip(&self.bodies) {
            w.u32(part as u32);
            w.u64(body.to_bits());
        }
        self.joints.iter().for_each(|joint| w.u64(joint.to_bits()));
        w.count(self.skin.len());
        for skin in &self.skin {
            w.u32(skin.joint as u32);
            w.u32(skin.body as u32);
            let Affine { linear, translation } = skin.body_from_joint;
            [linear.x_axis, linear.y_axis, linear.z_axis, translation].into_iter().for_each(|v| w.vec3(v));
        }
    }

    /// Reads a saved limb of a character with the definition `def`. The limb's bodies come from the world's snapshot of
    /// the same time.
    ///
    /// # Errors
    /// If the bytes are not a saved limb of this definition and version.
    pub fn load(def: &Arc<CharacterDef>, r: &mut Reader<'_>) -> Result<Self, ReadError> {
        if r.raw(MAGIC.len())? != MAGIC {
            return Err(r.error("these bytes are not a limb saved by this version"));
        }
        let def = def.clone();
        let mut limb =
            Self { def, parts: Vec::new(), bodies: Vec::new(), joints: Vec::new(), skin: Vec::new() };
        for _ in 0..r.count(BODY_BYTES)? {
            limb.parts.push(r.u32()? as usize);
            limb.bodies.push(BodyId::from_bits(r.u64()?));
        }
        let count = limb.def.ragdoll.bodies.len();
        let is_sorted = limb.parts.is_sorted_by(|a, b| a < b);
        if limb.parts.is_empty() || !is_sorted || limb.parts.iter().any(|&part| part >= count) {
            return Err(r.error("is a limb of another character"));
        }
        for _ in 1..limb.parts.len() {
            limb.joints.push(JointId::from_bits(r.u64()?));
        }
        for _ in 0..r.count(SKIN_BYTES)? {
            let (joint, body) = (r.u32()? as usize, r.u32()? as usize);
            let mut column = || r.vec3();
            let linear = Mat3::from_cols(column()?, column()?, column()?);
            let body_from_joint = Affine { linear, translation: column()? };
            if joint >= limb.def.rig.joints.len() || body >= limb.parts.len() {
                return Err(r.error("is a limb of another character"));
            }
            limb.skin.push(SkinJoint { joint, body, body_from_joint });
        }
        Ok(limb)
    }
}

/// Removes a joint of a ragdoll from the world.
pub(super) fn cut_joint(world: &mut World, joint: JointId) {
    world.disown_joint(joint);
    world.remove_joint(joint);
}

/// Returns the map that shrinks all points to one point.
pub(super) fn shrunk(to: Vec3) -> Affine {
    Affine { linear: Mat3::ZERO, translation: to }
}
