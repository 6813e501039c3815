//! What characters of one kind share.

use crate::def::RagdollDef;
use crate::hand_over::SpeedBound;
use crate::mapping::Mapping;
use crate::ragdoll::Flesh;
use sinew_anim::{Clip, LocalTransform, Rig, rest_pose};
use sinew_math::Affine;

/// How a character moves over the ground while its looped clip plays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Locomotion {
    /// Where the clip takes it, and no further.
    InPlace,
    /// The clip walks on the spot; the character advances along its facing at this speed, m/s.
    Forward {
        /// m/s; negative walks backwards.
        speed: f32,
    },
}

/// What a limp character does once it lies still.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AfterSettling {
    /// It gets up by the clip that fits the way it lies; without such a clip it fades to its looped clip, standing.
    GetUp,
    /// It stays where it is.
    StayDown,
}

/// Rig, ragdoll and motions of a kind of character. Immutable once shared.
#[derive(Clone, Debug)]
pub struct CharacterDef {
    /// The file's nodes, skins and meshes.
    pub rig: Rig,
    /// Its bodies and joints; other bodies need another definition, for the mapping was made from these.
    pub ragdoll: RagdollDef,
    /// All motions, for the indices below.
    pub clips: Vec<Clip>,
    /// The clip that loops while the character is animated; `None`: it stands in its rest pose. Default none.
    pub looped: Option<usize>,
    /// Clips that start lying and end standing. Default none.
    pub get_ups: Vec<usize>,
    /// Default in place.
    pub locomotion: Locomotion,
    /// Default get up.
    pub after_settling: AfterSettling,
    /// Seconds for which a limp character may go on moving before it gets up all the same. Default 6.
    pub patience: f32,
    /// Surface and filter of its bodies.
    pub flesh: Flesh,
    /// Bound on the speeds that an animation hands over.
    pub speed_bound: SpeedBound,
    mapping: Mapping,
    rest: Vec<LocalTransform>,
}

impl CharacterDef {
    /// A character without motions. `bind_model` is `RigAnalysis::bind_model`.
    ///
    /// # Panics
    /// As [`Mapping::new`].
    pub fn new(rig: Rig, ragdoll: RagdollDef, bind_model: &[Affine]) -> Self {
        Self {
            mapping: Mapping::new(&rig, &ragdoll, bind_model),
            rest: rest_pose(&rig),
            rig,
            ragdoll,
            clips: Vec::new(),
            looped: None,
            get_ups: Vec::new(),
            locomotion: Locomotion::InPlace,
            after_settling: AfterSettling::GetUp,
            patience: 6.0,
            flesh: Flesh::default(),
            speed_bound: SpeedBound::default(),
        }
    }

    /// The fixed relations between rig and bodies.
    pub fn mapping(&self) -> &Mapping {
        &self.mapping
    }

    /// Rest pose of the file.
    pub fn rest(&self) -> &[LocalTransform] {
        &self.rest
    }

    /// Index of the body that has this role or carries this joint (by name), merged joints included.
    pub fn body_named(&self, name: &str) -> Option<usize> {
        let bodies = &self.ragdoll.bodies;
        let carries = |joint: usize| self.rig.joints.get(joint).is_some_and(|joint| joint.name == name);
        bodies
            .iter()
            .position(|body| body.role == name)
            .or_else(|| bodies.iter().position(|body| body.bone == name))
            .or_else(|| bodies.iter().position(|body| body.merged.iter().any(|&joint| carries(joint))))
    }
}
