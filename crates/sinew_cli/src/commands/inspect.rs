//! `sinew inspect`: what is in a file.

use crate::failure::Result;
use crate::ragdoll_report::axis_name;
use crate::report::{Report, number};
use crate::table::{Table, shown};
use serde_json::{Value, json};
use sinew::anim::{RigAnalysis, analyze};
use sinew::formats::{Container, Document, ReadOptions, load_gltf};
use std::fmt::Write;
use std::path::PathBuf;

/// Show what is in a file: joints, clips, units, and which joint is which bone, with confidence
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  sinew inspect character.glb
  sinew inspect character.glb --json | jq '.joints[] | select(.role == \"hips\")'")]
pub struct Inspect {
    /// A glTF, GLB or VRM file; it need not hold a character
    file: PathBuf,
}

impl Inspect {
    /// Reads the file and describes it.
    pub fn run(&self) -> Result<Report> {
        let name = self.file.display().to_string();
        let document = load_gltf(&self.file, ReadOptions::default())?;
        let analysis = analyze(&document.rig).ok();
        let content = Content { name: &name, document: &document, analysis: analysis.as_ref() };
        Ok(Report { json: content.to_json(), text: content.to_text() })
    }
}

/// A file that was read.
struct Content<'a> {
    name: &'a str,
    document: &'a Document,
    /// `None` where nothing is skinned, so that there is no body to understand.
    analysis: Option<&'a RigAnalysis>,
}

impl Content<'_> {
    fn to_json(&self) -> Value {
        let Document { rig, clips, warnings, .. } = self.document;
        let joints: Vec<Value> = (0..rig.joints.len()).map(|joint| self.joint_json(joint)).collect();
        let clips: Vec<Value> = clips
            .iter()
            .map(|clip| json!({"name": clip.name, "duration_s": number(clip.duration), "channels": clip.channels.len()}))
            .collect();
        let (vertices, triangles) = self.mesh_size();
        json!({
            "file": self.name,
            "container": self.container(),
            "generator": self.document.generator(),
            "extensions": self.document.extensions(),
            "meshes": rig.meshes.len(),
            "vertices": vertices,
            "triangles": triangles,
            "skins": rig.skins.len(),
            "unit_scale": self.analysis.map(|analysis| number(analysis.unit_scale)),
            "up_axis": self.analysis.map(|analysis| axis_name(analysis.up_axis)),
            "height_m": self.analysis.map(|analysis| number(analysis.height)),
            "humanoid": self.analysis.map(|analysis| analysis.humanoid),
            "joints": joints,
            "clips": clips,
            "notes": self.notes(),
            "warnings": warnings,
        })
    }

    fn joint_json(&self, joint: usize) -> Value {
        let own = &self.document.rig.joints[joint];
        let guess = self.analysis.and_then(|analysis| analysis.roles[joint]);
        json!({
            "name": own.name,
            "parent": own.parent,
            "role": guess.map(|guess| guess.role.name()),
            "confidence": guess.map(|guess| number(guess.confidence)),
            "has_body": self.has_body(joint),
        })
    }

    fn to_text(&self) -> String {
        let Document { rig, clips, warnings, .. } = self.document;
        let (vertices, triangles) = self.mesh_size();
        let mut text = format!("{}: {}", shown(self.name), self.container());
        if !self.document.generator().is_empty() {
            let _ = write!(text, ", written by {}", shown(self.document.generator()));
        }
        let _ = writeln!(
            text,
            "\n{} with {vertices} vertices and {triangles} triangles, {}, {}, {}",
            counted(rig.meshes.len(), "mesh", "meshes"),
            counted(rig.skins.len(), "skin", "skins"),
            counted(rig.joints.len(), "joint", "joints"),
            counted(clips.len(), "clip", "clips")
        );
        text += &self.body_text();
        if !clips.is_empty() {
            text += "\nClips\n";
            text += &self.clip_table().to_text();
        }
        if !rig.joints.is_empty() {
            text += "\nJoints\n";
            text += &self.joint_table().to_text();
        }
        for note in self.notes().iter().chain(warnings) {
            let _ = writeln!(text, "\nnote: {}", shown(note));
        }
        text
    }

    fn body_text(&self) -> String {
        let Some(analysis) = self.analysis else {
            return "no skin: nothing to build a ragdoll from\n".into();
        };
        let kind = if analysis.humanoid { "a humanoid" } else { "a creature" };
        let (height, unit, bodies) = (analysis.height, analysis.unit_scale, analysis.kept.len());
        let up = axis_name(analysis.up_axis);
        format!("{kind} of {height:.2} m, {up} up, one unit is {unit} m; {bodies} joints get a body (*)\n")
    }

    fn clip_table(&self) -> Table {
        let mut table = Table::titled(&["name", "seconds", "channels"]);
        for clip in &self.document.clips {
            table.row([shown(&clip.name), format!("{:.2}", clip.duration), clip.channels.len().to_string()]);
        }
        table
    }

    /// The joints as a tree, in file order.
    fn joint_table(&self) -> Table {
        let joints = &self.document.rig.joints;
        let mut depths: Vec<usize> = Vec::with_capacity(joints.len());
        let mut table = Table::titled(&["joint", "role", "confidence"]);
        for (index, joint) in joints.iter().enumerate() {
            let depth = joint.parent.map_or(0, |parent| depths[parent] + 1);
            depths.push(depth);
            // A chain of thousands would fill the page with spaces.
            let indent = "  ".repeat(depth.min(DEEPEST_INDENT));
            let star = if self.has_body(index) { " *" } else { "" };
            let guess = self.analysis.and_then(|analysis| analysis.roles[index]);
            let role = guess.map_or(String::new(), |guess| guess.role.name());
            let confidence = guess.map_or(String::new(), |guess| format!("{:.2}", guess.confidence));
            table.row([format!("{indent}{}{star}", shown(&joint.name)), role, confidence]);
        }
        table
    }

    fn has_body(&self, joint: usize) -> bool {
        self.analysis.is_some_and(|analysis| analysis.kept.iter().any(|bone| bone.joint == joint))
    }

    fn notes(&self) -> &[String] {
        self.analysis.map_or(&[], |analysis| &analysis.notes)
    }

    fn container(&self) -> &'static str {
        match self.document.container {
            Container::Glb => "glb",
            Container::Gltf => "gltf",
        }
    }

    /// Vertices and triangles of all meshes.
    fn mesh_size(&self) -> (usize, usize) {
        let primitives = self.document.rig.meshes.iter().flat_map(|mesh| &mesh.primitives);
        primitives.fold((0, 0), |(vertices, triangles), primitive| {
            (vertices + primitive.positions.len(), triangles + primitive.indices.len() / 3)
        })
    }
}

const DEEPEST_INDENT: usize = 24;

fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}
