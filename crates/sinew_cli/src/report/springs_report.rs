//! Springs of a character, and what a file says of them.

use super::number;
use super::table::{Table, counted, shown};
use serde_json::{Value, json};
use sinew::anim::springs::{ColliderShape, LimitKind, Side, SpringBone, SpringChain, Springs};
use sinew::anim::{JointIdx, Rig};
use sinew::ragdoll::{CharacterDef, RagdollDef};

/// Most names of joints in a note.
const MOST_NAMES: usize = 6;

/// Springs that a character wears in a bake.
pub struct SpringsReport {
    chains: usize,
    bones: usize,
    /// Names of joints that were to swing and do not.
    left_out: Vec<String>,
}

impl SpringsReport {
    /// Springs of a character.
    pub fn of(character: &CharacterDef) -> Self {
        let springs = character.springs();
        let name = |&joint: &JointIdx| character.rig.joints[joint].name.clone();
        Self {
            chains: springs.source().chains.len(),
            bones: springs.joints().len(),
            left_out: springs.left_out().iter().map(name).collect(),
        }
    }

    /// Keys of a report.
    pub fn to_json(&self) -> Value {
        json!({ "chains": self.chains, "bones": self.bones, "left_out": self.left_out })
    }

    /// Notes for a person, a sentence each.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.bones > 0 {
            let bones = counted(self.bones, "spring bone swings", "spring bones swing");
            notes.push(format!(
                "{bones}, in {}; --no-springs leaves them",
                counted(self.chains, "chain", "chains")
            ));
        }
        if !self.left_out.is_empty() {
            let names = listed(&self.left_out);
            notes.push(format!(
                "no springs for {names}: bodies of the ragdoll move them, or they have no length"
            ));
        }
        notes
    }
}

/// The first few names.
pub fn listed(names: &[String]) -> String {
    let first: Vec<String> = names.iter().take(MOST_NAMES).map(|name| shown(name)).collect();
    let more = names.len().saturating_sub(MOST_NAMES);
    if more == 0 { first.join(", ") } else { format!("{} and {more} more", first.join(", ")) }
}

/// Springs of a file: each chain with its joints, and the settings of its first bone.
pub fn springs_json(rig: &Rig) -> Value {
    let chain = |chain: &SpringChain| {
        let bone = &chain.bones[0];
        let names: Vec<&str> = chain.bones.iter().map(|bone| rig.joints[bone.joint].name.as_str()).collect();
        json!({
            "name": chain.name,
            "joints": names,
            "stiffness": number(bone.stiffness),
            "gravity": bone.gravity.to_array().map(number),
            "drag": number(bone.drag),
            "radius": number(bone.radius),
            "limit": bone.limit.map(|limit| limit_name(limit.kind)),
            "center": chain.center.map(|joint| rig.joints[joint].name.as_str()),
            "colliders": chain.colliders,
        })
    };
    rig.springs.chains.iter().map(chain).collect()
}

/// Colliders of a file's springs, in the order that chains refer to.
pub fn colliders_json(rig: &Rig) -> Value {
    let collider = |collider: &sinew::anim::SpringCollider| {
        let (shape, radius, keeps) = described(&collider.shape);
        json!({
            "joint": rig.joints[collider.joint].name,
            "shape": shape,
            "radius": radius.map(number),
            "inside": keeps == Side::Inside,
        })
    };
    rig.springs.colliders.iter().map(collider).collect()
}

/// The chains as a table, their settings in the file's units.
pub fn springs_table(rig: &Rig) -> Table {
    let titles = ["spring", "bones", "stiffness", "gravity", "drag", "radius", "limit", "colliders"];
    let mut table = Table::titled(&titles);
    for chain in &rig.springs.chains {
        let first = &chain.bones[0];
        let root = &rig.joints[first.joint].name;
        let name = if chain.name.is_empty() { root } else { &chain.name };
        let span = |value: fn(&SpringBone) -> f32| {
            let values = chain.bones.iter().map(value);
            let (low, high) =
                values.fold((f32::INFINITY, 0.0_f32), |(low, high), x| (low.min(x), high.max(x)));
            if low == high { format!("{low}") } else { format!("{low} to {high}") }
        };
        table.row([
            shown(name),
            chain.bones.len().to_string(),
            span(|bone| bone.stiffness),
            span(|bone| bone.gravity.length()),
            span(|bone| bone.drag),
            span(|bone| bone.radius),
            first.limit.map_or("", |limit| limit_name(limit.kind)).to_owned(),
            chain.colliders.len().to_string(),
        ]);
    }
    table
}

/// Joints that by the names of a rig without springs could swing and that no body of its ragdoll moves, as advice; nothing where there are
/// none.
pub fn proposal(rig: &Rig, springs: &Springs, ragdoll: &RagdollDef) -> Option<String> {
    let name = |bone: &SpringBone| rig.joints[bone.joint].name.clone();
    let has_body = |bone: &SpringBone| ragdoll.bodies.iter().any(|body| body.bone == name(bone));
    let swings = |chain: &&SpringChain| !chain.bones.iter().all(has_body);
    let roots: Vec<String> =
        springs.chains.iter().filter(swings).map(|chain| name(&chain.bones[0])).collect();
    (!roots.is_empty()).then(|| {
        format!(
            "{} could swing, by their names: --guess-springs of 'sinew bake', or \"springs\": \"names\" in the settings, lets them",
            listed(&roots)
        )
    })
}

fn limit_name(kind: LimitKind) -> &'static str {
    match kind {
        LimitKind::Cone { .. } => "cone",
        LimitKind::Hinge { .. } => "hinge",
        LimitKind::Spherical { .. } => "spherical",
    }
}

fn described(shape: &ColliderShape) -> (&'static str, Option<f32>, Side) {
    match *shape {
        ColliderShape::Sphere { radius, keeps, .. } => ("sphere", Some(radius), keeps),
        ColliderShape::Capsule { radius, keeps, .. } => ("capsule", Some(radius), keeps),
        ColliderShape::Plane { .. } => ("plane", None, Side::Outside),
    }
}
