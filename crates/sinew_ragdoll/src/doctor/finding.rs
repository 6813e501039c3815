//! Data of an examination: the ragdoll to examine, and one finding.

use super::code::{Code, Severity};
use crate::def::RagdollDef;
use crate::skin::Flaw;
use sinew_physics::{Softness, WorldDef};

/// A ragdoll to examine and repair.
#[derive(Clone, Debug, PartialEq)]
pub struct Repair {
    /// The ragdoll.
    pub def: RagdollDef,
    /// Spring or motor of each joint, in the order of the joints; `None` for a limp joint. The list may be shorter than
    /// the list of joints.
    pub springs: Vec<Option<Softness>>,
    /// Ragdoll built from the definition's rig, if available: it shows what the definition lacks.
    pub reference: Option<RagdollDef>,
    /// Flaws of the ragdoll's skin ([`SkinQuality::flaws`](crate::SkinQuality::flaws)), if it was measured.
    pub skin: Vec<Flaw>,
    /// Length of a substep, seconds. Default: 1/240, as in a default world.
    pub substep: f32,
}

impl Repair {
    /// Creates a limp ragdoll without its rig.
    pub fn new(def: RagdollDef) -> Self {
        let world = WorldDef::default();
        let substep = world.dt() / world.substeps as f32;
        Self { def, springs: Vec::new(), reference: None, skin: Vec::new(), substep }
    }
}

/// A defect of a ragdoll.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Kind of the finding.
    pub code: Code,
    /// Severity of the finding.
    pub severity: Severity,
    /// Indices of the bodies concerned, the most important first.
    pub bodies: Vec<usize>,
    /// Names of these bodies' bones; for a missing body, its role.
    pub bones: Vec<String>,
    /// Measured evidence: a sentence with both bodies' names.
    pub evidence: String,
    /// Recommended action, one sentence.
    pub fix: String,
    /// True if [`cure`](super::cure) fixed it; false from [`doctor`](super::doctor()).
    pub fixed: bool,
}
