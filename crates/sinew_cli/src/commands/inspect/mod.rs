//! `sinew inspect`: shows the content of a file.

mod clips;

use crate::failure::{Failure, Result};
use crate::input::motion::Motion;
use crate::input::settings_arg::{assumed, unit};
use crate::report::garments_report::{garments_json, garments_text, worn_json, worn_notes};
use crate::report::ragdoll_report::axis_name;
use crate::report::springs_report::{colliders_json, links_json, links_text, springs_json, springs_text};
use crate::report::table::{Table, counted, shown};
use crate::report::{Report, number};
use clips::{ClipFacts, clip_table, event_table};
use serde_json::{Value, json};
use sinew::anim::{Garment, SpringLink};
use sinew::formats::gltf::SpringFormat;
use sinew::formats::{read_bytes, read_ragdoll_settings, settings_path};
use sinew::math::Vec3;
use sinew::ragdoll::settings::analyze_with;
use sinew::ragdoll::{Settings, SettingsError};
use std::fmt::Write;
use std::path::PathBuf;

/// Show the content of a file: joints, clips, events, springs, units, and the bone role of each joint, with confidence
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  sinew inspect character.glb
  sinew inspect walk.bvh
  sinew inspect avatar.vrm       # its springs and their settings among the rest
  sinew inspect character.glb --json | jq '.joints[] | select(.role == \"hips\")'")]
pub struct Inspect {
    /// A glTF, GLB, VRM, VRMA, BVH, FBX or DeepMimic file; it need not hold a character
    file: PathBuf,
    /// Length of one unit of the file: m, dm, cm, mm, in, ft, or metres as a number; by default it is guessed
    #[arg(long, value_name = "UNIT", value_parser = unit, allow_negative_numbers = true)]
    unit: Option<f32>,
}

impl Inspect {
    /// Reads the file and describes its content.
    pub fn run(&self) -> Result<Report> {
        let mut motion = Motion::load_in(&self.file, self.unit)?;
        let (mut links, mut worn, mut trouble) = (Vec::new(), Vec::new(), Vec::new());
        match self.settings() {
            Ok(settings) => {
                let mut tell = |failure: Failure| trouble.push(failure.to_string());
                self.correct(&mut motion, settings.as_ref()).unwrap_or_else(&mut tell);
                self.links(&motion, settings.as_ref()).map_or_else(&mut tell, |found| links = found);
                self.worn(&motion, settings.as_ref()).map_or_else(&mut tell, |found| worn = found);
            }
            Err(failure) => trouble.push(failure.to_string()),
        }
        let content = Content { clips: ClipFacts::of(&motion), motion: &motion, links, worn, trouble };
        Ok(Report { json: content.to_json(), text: content.to_text() })
    }

    /// Reads the settings next to the file, if any.
    fn settings(&self) -> Result<Option<Settings>> {
        let path = settings_path(&self.file);
        if !path.is_file() {
            return Ok(None);
        }
        let read = read_bytes(&path).and_then(|bytes| read_ragdoll_settings(&bytes));
        Ok(Some(read.map_err(|error| error.with_file(path.display().to_string()))?))
    }

    /// Applies the settings to roles and unit, as `ragdoll build` does; `--unit` overrides.
    fn correct(&self, motion: &mut Motion, settings: Option<&Settings>) -> Result<()> {
        let (Some(settings), Some(analysis)) = (settings, &motion.analysis) else { return Ok(()) };
        let analysis =
            analyze_with(&motion.file.rig, analysis, settings).map_err(|error| self.failure(error))?;
        motion.analysis = Some(self.unit.map_or(analysis.clone(), |unit| analysis.with_unit_scale(unit)));
        Ok(())
    }

    /// Converts an error in the settings.
    fn failure(&self, error: SettingsError) -> Failure {
        let name = settings_path(&self.file).display().to_string();
        match error {
            SettingsError::Setting { what, place } => Failure::at(&name, what, &place),
            SettingsError::Build(error) => Failure::of_file(&name, error),
        }
    }

    /// Returns the links across strands requested by the settings.
    fn links(&self, motion: &Motion, settings: Option<&Settings>) -> Result<Vec<SpringLink>> {
        let Some(settings) = settings else { return Ok(motion.file.rig.springs.links.clone()) };
        let up = motion.analysis.as_ref().map_or(Vec3::Y, |analysis| analysis.up_axis);
        let springs = settings.springs_of(settings.springs.unwrap_or_default(), &motion.file.rig, up);
        Ok(springs.map_err(|error| self.failure(error))?.links)
    }

    /// Returns the garments requested by the settings.
    fn worn(&self, motion: &Motion, settings: Option<&Settings>) -> Result<Vec<Garment>> {
        let (Some(settings), Some(analysis)) = (settings, &motion.analysis) else { return Ok(Vec::new()) };
        let mut rig = motion.file.rig.clone();
        // The settings define the unit.
        let analysis = analyze_with(&rig, analysis, settings).map_err(|error| self.failure(error))?;
        let nodes = rig.joints.len();
        let laid = settings.garments.lay_sheets(&mut rig, &analysis, nodes);
        laid.map_err(|error| self.failure(error))?;
        settings.garments.garments(&rig).map_err(|error| self.failure(error))
    }
}

/// Content of an inspected file.
struct Content<'a> {
    motion: &'a Motion,
    clips: Vec<ClipFacts<'a>>,
    /// Links of the file's springs, and errors in the settings for links and garments.
    links: Vec<SpringLink>,
    /// Garments requested by the settings.
    worn: Vec<Garment>,
    trouble: Vec<String>,
}

impl Content<'_> {
    fn to_json(&self) -> Value {
        let Motion { name, file, analysis } = self.motion;
        let joints: Vec<Value> = (0..file.rig.joints.len()).map(|joint| self.joint_json(joint)).collect();
        let (vertices, triangles) = self.mesh_size();
        let analysis = analysis.as_ref();
        json!({
            "file": name,
            "container": file.format.name(),
            "generator": file.generator,
            "extensions": file.extensions,
            "meshes": file.rig.meshes.len(),
            "vertices": vertices,
            "triangles": triangles,
            "skins": file.rig.skins.len(),
            "unit_scale": analysis.map(|analysis| number(analysis.unit_scale)),
            "up_axis": analysis.map(|analysis| axis_name(analysis.up_axis)),
            "height_m": analysis.map(|analysis| number(analysis.height)),
            "humanoid": analysis.map(|analysis| analysis.humanoid),
            "joints": joints,
            "clips": self.clips.iter().map(ClipFacts::to_json).collect::<Vec<_>>(),
            "spring_format": file.spring_format.map(SpringFormat::name),
            "springs": springs_json(&file.rig),
            "spring_colliders": colliders_json(&file.rig),
            "spring_links": links_json(&file.rig, &self.links),
            "garments": garments_json(&file.rig),
            "worn": worn_json(&self.worn),
            "notes": self.notes(),
            "warnings": self.warnings(),
        })
    }

    fn joint_json(&self, joint: usize) -> Value {
        let own = &self.motion.file.rig.joints[joint];
        let guess = self.motion.analysis.as_ref().and_then(|analysis| analysis.roles[joint]);
        json!({
            "name": own.name,
            "parent": own.parent,
            "role": guess.map(|guess| guess.role.name()),
            "confidence": guess.map(|guess| number(guess.confidence)),
            "rests_on": guess.map(|guess| guess.basis.name()),
            "has_body": self.has_body(joint),
        })
    }

    fn to_text(&self) -> String {
        let Motion { name, file, .. } = self.motion;
        let rig = &file.rig;
        let (vertices, triangles) = self.mesh_size();
        let mut text = format!("{}: {}", shown(name), file.format.name());
        if !file.generator.is_empty() {
            let _ = write!(text, ", written by {}", shown(&file.generator));
        }
        if let Some(frame_time) = file.frame_time {
            let _ = write!(text, ", {} frames a second", (1.0e3 / frame_time).round() / 1e3);
        }
        let _ = writeln!(
            text,
            "\n{} with {vertices} vertices and {triangles} triangles, {}, {}, {}",
            counted(rig.meshes.len(), "mesh", "meshes"),
            counted(rig.skins.len(), "skin", "skins"),
            counted(rig.joints.len(), "joint", "joints"),
            counted(file.clips.len(), "clip", "clips")
        );
        text += &self.body_text();
        if !self.clips.is_empty() {
            text += "\nClips\n";
            text += &clip_table(&self.clips).to_text();
        }
        if let Some(events) = event_table(&self.clips) {
            text += "\nEvents\n";
            text += &events.to_text();
        }
        text += &springs_text(rig, file.spring_format.map(SpringFormat::name));
        text += &links_text(rig, &self.links);
        text += &garments_text(rig);
        if !rig.joints.is_empty() {
            text += "\nJoints\n";
            text += &self.joint_table().to_text();
        }
        for note in self.notes().iter().chain(&self.warnings()) {
            let _ = writeln!(text, "\nnote: {}", shown(note));
        }
        text
    }

    fn body_text(&self) -> String {
        let Some(analysis) = &self.motion.analysis else {
            return "no skin: nothing to build a ragdoll from\n".into();
        };
        let kind = if analysis.humanoid { "a humanoid" } else { "a creature" };
        let (height, unit, bodies) = (analysis.height, analysis.unit_scale, analysis.kept.len());
        let up = axis_name(analysis.up_axis);
        let body = format!("{kind} of {height:.2} m, {up} up, one unit is {unit} m");
        if self.motion.has_skin() {
            format!("{body}; {bodies} joints get a body (*)\n")
        } else {
            format!("{body}; a skeleton without skin\n")
        }
    }

    /// Returns the joints as a tree, in file order.
    fn joint_table(&self) -> Table {
        let joints = &self.motion.file.rig.joints;
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); joints.len()];
        let mut open: Vec<(usize, usize)> = Vec::new();
        for (index, joint) in joints.iter().enumerate().rev() {
            match joint.parent {
                Some(parent) => children[parent].push(index),
                None => open.push((index, 0)),
            }
        }
        let mut table = Table::titled(&["joint", "role", "confidence", "rests on"]);
        while let Some((index, depth)) = open.pop() {
            open.extend(children[index].iter().map(|&child| (child, depth + 1)));
            let joint = &joints[index];
            // Limits the indentation: a chain of thousands of joints would fill the page with spaces.
            let indent = "  ".repeat(depth.min(DEEPEST_INDENT));
            let star = if self.has_body(index) { " *" } else { "" };
            let guess = self.motion.analysis.as_ref().and_then(|analysis| analysis.roles[index]);
            let role = guess.map_or(String::new(), |guess| guess.role.name());
            let confidence = guess.map_or(String::new(), |guess| format!("{:.2}", guess.confidence));
            let rests_on = guess.map_or(String::new(), |guess| guess.basis.name().to_owned());
            table.row([format!("{indent}{}{star}", shown(&joint.name)), role, confidence, rests_on]);
        }
        table
    }

    fn has_body(&self, joint: usize) -> bool {
        let kept =
            self.motion.analysis.as_ref().filter(|_| self.motion.has_skin()).map(|analysis| &analysis.kept);
        kept.is_some_and(|kept| kept.iter().any(|bone| bone.joint == joint))
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = self.motion.analysis.as_ref().map_or_else(Vec::new, assumed);
        notes.extend(worn_notes(&self.worn));
        notes
    }

    /// Returns warnings of parts that could not be read or played.
    fn warnings(&self) -> Vec<String> {
        let unplayable = self.clips.iter().filter_map(ClipFacts::warning);
        self.motion.file.notes.iter().cloned().chain(unplayable).chain(self.trouble.clone()).collect()
    }

    /// Returns the numbers of vertices and triangles of all meshes.
    fn mesh_size(&self) -> (usize, usize) {
        let primitives = self.motion.file.rig.meshes.iter().flat_map(|mesh| &mesh.primitives);
        primitives.fold((0, 0), |(vertices, triangles), primitive| {
            (vertices + primitive.positions.len(), triangles + primitive.indices.len() / 3)
        })
    }
}

const DEEPEST_INDENT: usize = 24;
