//! Reports garments of a character, and those inferred from joint names.

use super::number;
use super::springs_report::listed;
use super::table::{counted, shown};
use serde_json::{Value, json};
use sinew::anim::garments::{Backstop, MeshSheet};
use sinew::anim::{Garment, JointIdx, Rig, guess_garments};
use sinew::ragdoll::{CharacterDef, RagdollDef};
use std::fmt::Write as _;

/// Garments that a character wears in a bake.
pub struct GarmentsReport {
    names: Vec<String>,
    bones: usize,
    particles: usize,
    /// Joints of requested garments that are not worn.
    left_out: Vec<String>,
}

impl GarmentsReport {
    /// Creates the report on the garments of a character.
    pub fn of(character: &CharacterDef) -> Self {
        let garments = character.garments();
        let name = |&joint: &JointIdx| character.rig.joints[joint].name.clone();
        Self {
            names: garments.source().iter().map(|garment| garment.name.clone()).collect(),
            bones: garments.joints().len(),
            particles: garments.particles().sum(),
            left_out: garments.left_out().iter().map(name).collect(),
        }
    }

    /// Returns the JSON object of the report.
    pub fn to_json(&self) -> Value {
        json!({
            "names": self.names,
            "bones": self.bones,
            "particles": self.particles,
            "left_out": self.left_out,
        })
    }

    /// Returns notes, one sentence each.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.bones > 0 {
            let bones = counted(self.bones, "bone moves", "bones move");
            notes.push(format!(
                "{bones} with {}, of {} particles; --no-garments turns them off",
                counted(self.names.len(), "garment", "garments"),
                self.particles
            ));
        }
        if !self.left_out.is_empty() {
            let names = listed(&self.left_out);
            notes.push(format!(
                "no garment on {names}: bodies of the ragdoll move them, no body holds them, or they have no length"
            ));
        }
        notes
    }
}

/// Returns the JSON list of the garments inferred from a rig's joint names.
pub fn garments_json(rig: &Rig) -> Value {
    let name = |joint: JointIdx| rig.joints[joint].name.as_str();
    let garment = |garment: &Garment| {
        let chains: Vec<&str> = garment.columns.iter().map(|column| name(column.joints[0])).collect();
        json!({ "name": garment.name, "closed": garment.closed, "chains": chains, "joints": garment.joints().count() })
    };
    guess_garments(rig).iter().map(garment).collect()
}

/// Returns the text of the garments inferred from a rig's joint names; empty without any.
pub fn garments_text(rig: &Rig) -> String {
    let mut text = String::new();
    for garment in guess_garments(rig) {
        let tops: Vec<String> =
            garment.columns.iter().map(|column| rig.joints[column.joints[0]].name.clone()).collect();
        let round = if garment.closed { "all round" } else { "open" };
        let chains = counted(garment.columns.len(), "chain", "chains");
        let _ = writeln!(text, "\nGarment by names: {}, {round}, {chains}: {}", garment.name, listed(&tops));
    }
    text
}

/// Returns the JSON list of garments requested by settings.
pub fn worn_json(garments: &[Garment]) -> Value {
    let garment = |garment: &Garment| {
        let sheet = garment.sheet.as_ref();
        let backstop = garment.backstop.map(|backstop| {
            json!({ "distance_m": number(backstop.distance), "radius_m": number(backstop.radius) })
        });
        json!({
            "name": garment.name,
            "mesh": sheet.map(|sheet| &sheet.name),
            "chains": garment.columns.len(),
            "vertices": sheet.map(|sheet| sheet.vertices),
            "particles": sheet.map(|sheet| sheet.joints.len()),
            "held": sheet.map(held),
            "longest_edge_m": sheet.map(|sheet| number(sheet.longest_edge)),
            "spacing_m": number(garment.spacing),
            "backstop": backstop,
        })
    };
    garments.iter().map(garment).collect()
}

/// Returns the number of particles of a sheet that bodies hold.
fn held(sheet: &MeshSheet) -> usize {
    sheet.held.iter().filter(|held| **held).count()
}

/// Returns sentences on garments requested by settings, one or two for each.
pub fn worn_notes(garments: &[Garment]) -> Vec<String> {
    garments.iter().enumerate().flat_map(|(index, garment)| worn_note(index, garment)).collect()
}

fn worn_note(index: usize, garment: &Garment) -> Vec<String> {
    let name = if garment.name.is_empty() { format!("garments[{index}]") } else { shown(&garment.name) };
    let spacing = number(garment.spacing);
    let cloth = match &garment.sheet {
        Some(sheet) => format!(
            "cloth of the mesh {} with {}: {}, {} held, {spacing} m apart at most if there may be as many",
            shown(&sheet.name),
            counted(sheet.vertices, "vertex", "vertices"),
            counted(sheet.joints.len(), "particle", "particles"),
            held(sheet)
        ),
        None => format!(
            "cloth on {}, its particles {spacing} m apart at most",
            counted(garment.columns.len(), "chain", "chains")
        ),
    };
    let backstops = match garment.backstop {
        None => "no backstops".to_owned(),
        Some(Backstop { distance, radius }) => {
            format!("backstops {} m below it at rest, of {} m", number(distance), number(radius))
        }
    };
    let coarse = garment.sheet.iter().filter(|sheet| sheet.longest_edge > DRAWN_COARSER * garment.spacing);
    let coarse = coarse.map(|sheet| {
        format!(
            "{name} is drawn in triangles of up to {} m: movement of the cloth between its vertices is not drawn, so bodies that press on it there show through; use a finer mesh \
             in the file",
            number(sheet.longest_edge)
        )
    });
    [format!("{name} is {cloth}; {backstops}")].into_iter().chain(coarse).collect()
}

/// Ratio of a mesh's longest edge to its particle spacing above which the drawn triangles are visibly coarser
/// than the cloth: slightly more than a square cell's diagonal.
const DRAWN_COARSER: f32 = 1.5;

/// Returns advice on garments inferred from joint names; `None` if there are none, or ragdoll bodies move them.
pub fn proposal(rig: &Rig, ragdoll: &RagdollDef) -> Option<String> {
    let has_body = |joint: JointIdx| ragdoll.bodies.iter().any(|body| body.bone == rig.joints[joint].name);
    let garments = guess_garments(rig);
    let could = garments.iter().filter(|garment| !garment.joints().any(has_body));
    let names: Vec<String> = could.map(|garment| garment.name.clone()).collect();
    (!names.is_empty()).then(|| {
        format!("{} could be worn as cloth, by the names of bones: \"garments\": \"names\" in the settings enables them", listed(&names))
    })
}
