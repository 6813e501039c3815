//! Data of an examination: the ragdoll that is examined, and one finding.

use super::code::{Code, Severity};
use crate::def::RagdollDef;
use crate::skin::Flaw;
use sinew_physics::{Softness, WorldDef};

/// A ragdoll to examine and repair.
#[derive(Clone, Debug, PartialEq)]
pub struct Repair {
    /// The ragdoll.
    pub def: RagdollDef,
    /// Spring or motor of each joint, in the order of the joints; `None` for a limp one. May be shorter than the
    /// joints.
    pub springs: Vec<Option<Softness>>,
    /// Ragdoll built from its rig, if that is at hand: it shows what the definition lacks.
    pub reference: Option<RagdollDef>,
    /// Flaws of its skin ([`SkinQuality::flaws`](crate::SkinQuality::flaws)), where it was measured.
    pub skin: Vec<Flaw>,
    /// Length of a substep, seconds. Default: that of a default world, 1/240.
    pub substep: f32,
}

impl Repair {
    /// A limp ragdoll without its rig.
    pub fn new(def: RagdollDef) -> Self {
        let world = WorldDef::default();
        let substep = world.dt() / world.substeps as f32;
        Self { def, springs: Vec::new(), reference: None, skin: Vec::new(), substep }
    }
}

/// Something that is wrong with a ragdoll.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Kind of the finding.
    pub code: Code,
    /// Severity of the finding.
    pub severity: Severity,
    /// Indices of the bodies concerned, the most important first.
    pub bodies: Vec<usize>,
    /// Names of their bones; of a body that is missing, its role.
    pub bones: Vec<String>,
    /// Measured evidence, a sentence with both bodies' names.
    pub evidence: String,
    /// Recommended action, one sentence.
    pub fix: String,
    /// True if [`cure`](super::cure) fixed it; false from [`doctor`](super::doctor()).
    pub fixed: bool,
}
