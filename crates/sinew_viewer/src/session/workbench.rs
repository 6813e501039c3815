//! A ragdoll on the workbench: built from a file's rig or read from a file, then edited and dropped again.

use super::subject::NamedFile;
use super::takes;
use sinew::anim::{Clip, Hints, Rig, RigAnalysis, analyze_hinted};
use sinew::formats::{MotionFile, ReadOptions, append_clip, no_files, read_gltf, write_gltf, write_ragdoll};
use sinew::math::{Affine, Range, SwingTwistLimit, Transform};
use sinew::motions::{own_motions, set_motions_with_builtin};
use sinew::physics::{AxisMotion, BodyId, JointKind};
use sinew::ragdoll::doctor::Finding;
use sinew::ragdoll::settings::BoneSettings;
use sinew::ragdoll::{
    BuildOptions, CharacterDef, Mapping, MotionSet, RagdollDef, Repair, Settings, build_with, doctor,
};
use sinew_scenes::fallen::{fall_of_bodies, fall_of_character};
use sinew_scenes::scenes::Instance;

/// A ragdoll that the user edits.
#[derive(Clone, Debug)]
pub struct Workbench {
    name: String,
    source: Source,
    /// Edits so far, by the name of the body's bone.
    wishes: Vec<(String, BoneSettings)>,
    def: RagdollDef,
    findings: Vec<Finding>,
    report: Vec<String>,
}

/// Source of a ragdoll.
#[derive(Clone, Debug)]
enum Source {
    /// A rig, from which the ragdoll is rebuilt after each edit.
    Rig(Box<Character>),
    /// A definition, whose numbers the edits change.
    Bodies(Box<RagdollDef>),
}

#[derive(Clone, Debug)]
struct Character {
    rig: Rig,
    analysis: RigAnalysis,
    clips: Vec<Clip>,
    notes: Vec<String>,
    /// Motions of the character that falls: its own, and built-in ones for those that it lacks.
    motions: MotionSet,
}

impl Workbench {
    /// Builds the ragdoll of a file's character; the error is one line.
    pub(super) fn of_character(file: MotionFile, name: &str) -> Result<Self, String> {
        let hints = Hints { exporter: file.generator.clone(), ..Hints::of_clips(&file.rig, &file.clips) };
        let analysis = analyze_hinted(&file.rig, &hints).map_err(|error| error.to_string())?;
        let (rig, clips, notes) = (file.rig, file.clips, file.notes);
        let motions = MotionSet::default();
        let source = Source::Rig(Box::new(Character { rig, analysis, clips, notes, motions }));
        let mut made = Self::made(source, name, Vec::new())?;
        if let Source::Rig(character) = &mut made.source {
            character.find_motions(&made.def);
        }
        Ok(made)
    }

    /// Creates the workbench of a ragdoll without its rig.
    pub(super) fn of_bodies(def: RagdollDef, name: &str) -> Self {
        let source = Source::Bodies(Box::new(def));
        Self::made(source, name, Vec::new()).expect("a definition without settings is unchanged")
    }

    fn made(source: Source, name: &str, wishes: Vec<(String, BoneSettings)>) -> Result<Self, String> {
        let (def, mut report) = match &source {
            Source::Rig(character) => character.built(&wishes)?,
            Source::Bodies(def) => (changed(def, &wishes)?, Vec::new()),
        };
        let size = format!("{:.2} m, {:.1} kg", def.height, def.total_mass);
        let about = match &source {
            Source::Rig(character) => {
                let (joints, clips) = (character.rig.joints.len(), character.clips.len());
                format!("{} bodies of {joints} joints, {clips} clips", def.bodies.len())
            }
            Source::Bodies(_) => format!("{} bodies, {} joints", def.bodies.len(), def.joints.len()),
        };
        report.splice(0..0, [about, size]);
        let findings = doctor(&Repair::new(def.clone()));
        Ok(Self { name: name.to_owned(), source, wishes, def, findings, report })
    }

    /// Returns the current ragdoll.
    pub fn def(&self) -> &RagdollDef {
        &self.def
    }

    /// Problems found by the doctor, the worst first.
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// Returns lines that describe the ragdoll.
    pub fn report(&self) -> &[String] {
        &self.report
    }

    /// Returns true if the ragdoll is built from a rig, so that roles and shapes can be changed too.
    pub fn has_rig(&self) -> bool {
        matches!(self.source, Source::Rig(_))
    }

    /// Returns the edits of a body so far.
    pub fn wish(&self, body: usize) -> BoneSettings {
        let bone = self.def.bodies.get(body).map(|body| &body.bone);
        let found = self.wishes.iter().find(|(name, _)| Some(name) == bone);
        found.map(|(_, wish)| *wish).unwrap_or_default()
    }

    /// Replaces the edits of a body and rebuilds the ragdoll with all edits. If that fails, nothing changes.
    ///
    /// # Errors
    /// One line: the reason for the failure.
    pub fn set_wish(&mut self, body: usize, wish: BoneSettings) -> Result<(), String> {
        let bone = self.def.bodies.get(body).map(|body| body.bone.clone()).ok_or("there is no such body")?;
        let mut wishes = self.wishes.clone();
        wishes.retain(|(name, _)| *name != bone);
        if wish != BoneSettings::default() {
            wishes.push((bone, wish));
        }
        *self = Self::made(self.source.clone(), &self.name, wishes)?;
        Ok(())
    }

    /// Returns the falling ragdoll, and its bodies if no character lists them.
    pub(super) fn fall(&self) -> (Instance, Vec<BodyId>) {
        match &self.source {
            Source::Rig(it) => (fall_of_character(it.def(&self.def)), Vec::new()),
            Source::Bodies(_) => fall_of_bodies(&self.def),
        }
    }

    /// Writes poses as a clip in a GLB, `NAME-played.glb`: into the file itself if `original` is a GLB, else with the clips of
    /// the file. `poses` are world from joint, every `dt` seconds.
    ///
    /// # Errors
    /// One line: there is no rig, or nothing was played.
    pub(super) fn to_glb(
        &self,
        poses: &[Vec<Affine>],
        dt: f32,
        original: Option<&[u8]>,
    ) -> Result<NamedFile, String> {
        let Source::Rig(it) = &self.source else { return Err("a ragdoll file has no rig to play on".into()) };
        if poses.len() < 2 {
            return Err("nothing has been played yet".into());
        }
        let mapping = Mapping::new(&it.rig, &self.def, &it.analysis.bind_model);
        let world_from_model = mapping.world_from_model(Transform::IDENTITY);
        let clip = takes::clip_of(&it.rig, poses, &world_from_model, dt);
        let document =
            original.and_then(|bytes| read_gltf(bytes, ReadOptions::default(), &mut no_files).ok());
        let written = match document {
            Some(document) => append_clip(&document, &clip, &clip.name, None),
            None => write_gltf(&it.rig, &[&it.clips[..], &[clip]].concat()),
        };
        let bytes = written.map_err(|error| error.to_string())?;
        let stem = self.name.rsplit_once('.').map_or(&*self.name, |(stem, _)| stem);
        Ok(NamedFile { name: format!("{stem}-played.glb"), bytes })
    }

    /// Returns the name of the file of [`to_file`](Self::to_file).
    pub fn to_file_name(&self) -> String {
        let stem = self.name.strip_suffix(".sinew.json").or_else(|| Some(self.name.rsplit_once('.')?.0));
        format!("{}.sinew.json", stem.unwrap_or(&self.name))
    }

    /// Returns the ragdoll as a file, `NAME.sinew.json`.
    pub fn to_file(&self) -> NamedFile {
        NamedFile { name: self.to_file_name(), bytes: write_ragdoll(&self.def).into_bytes() }
    }
}

impl Character {
    /// Chooses walk, idle and get-ups among the clips, and built-in motions for those that are missing.
    fn find_motions(&mut self, ragdoll: &RagdollDef) {
        let mut def = self.def(ragdoll);
        let own = own_motions(&def, &self.analysis, self.clips.clone()).motions;
        let is_filled = set_motions_with_builtin(&mut def, &self.analysis, own.clone()).is_ok();
        self.motions = if is_filled { def.motions().clone() } else { own };
    }

    /// Returns the definition of the character with a ragdoll.
    fn def(&self, ragdoll: &RagdollDef) -> CharacterDef {
        let mut def = CharacterDef::new(self.rig.clone(), ragdoll.clone(), &self.analysis.bind_model);
        // Clips that cannot be played are left out: the character can still fall.
        if self.motions.clips.is_empty() || def.set_motions(self.motions.clone()).is_err() {
            return CharacterDef::new(self.rig.clone(), ragdoll.clone(), &self.analysis.bind_model);
        }
        def
    }

    /// Builds the ragdoll with those edits; returns it with notes on the build.
    fn built(&self, wishes: &[(String, BoneSettings)]) -> Result<(RagdollDef, Vec<String>), String> {
        let settings = Settings { bones: wishes.to_vec(), ..Settings::default() };
        let built = build_with(&self.rig, &self.analysis, &BuildOptions::default(), &settings);
        let (def, report) = built.map_err(|error| error.to_string())?;
        let notes = self.notes.iter().chain(&self.analysis.notes).chain(&report.notes);
        Ok((def, notes.cloned().collect()))
    }
}

/// Returns a definition with the requested masses and limits. Such changes need no rig.
fn changed(def: &RagdollDef, wishes: &[(String, BoneSettings)]) -> Result<RagdollDef, String> {
    let mut def = def.clone();
    for (bone, wish) in wishes {
        if wish.role.is_some() || wish.shape.is_some() || wish.scale.is_some() || wish.body.is_some() {
            return Err("roles and shapes are made from a rig, and this file has none".to_owned());
        }
        let found = def.bodies.iter().position(|body| body.bone == *bone);
        let body = found.ok_or_else(|| format!("there is no body of '{bone}'"))?;
        if let Some(mass) = wish.mass {
            let weight = &mut def.bodies[body].mass;
            let factor = mass / weight.mass;
            def.total_mass += mass - weight.mass;
            weight.mass = mass;
            weight.inertia = weight.inertia * factor;
        }
        if let Some(joint) = def.joints.iter_mut().find(|joint| joint.child == body) {
            joint.friction_torque = wish.friction_torque.unwrap_or(joint.friction_torque);
            let [y, z, twist] = limits(&joint.kind);
            let wanted = [wish.swing_y.or(y), wish.swing_z.or(z), wish.twist.or(twist)];
            joint.kind = limited(joint.kind, wanted);
        }
    }
    Ok(def)
}

/// Returns the ranges of a joint, radians: swing about y, swing about z, twist or the angle of a hinge; `None` for unlimited
/// ones.
pub fn limits(kind: &JointKind) -> [Option<Range>; 3] {
    match *kind {
        JointKind::Ball { limit: Some(limit) } => {
            [Some(limit.swing_y), Some(limit.swing_z), Some(limit.twist)]
        }
        JointKind::Universal { limit: Some(limit) } => [Some(limit.swing_y), Some(limit.swing_z), None],
        JointKind::Hinge { limit } => [None, None, limit],
        JointKind::SixDof(six) => [six.swing_y, six.swing_z, six.twist].map(|motion| match motion {
            AxisMotion::Limited(range) => Some(range),
            AxisMotion::Locked | AxisMotion::Free => None,
        }),
        _ => [None; 3],
    }
}

/// Returns a joint with these ranges in place of its own.
fn limited(kind: JointKind, [y, z, twist]: [Option<Range>; 3]) -> JointKind {
    let of = |limit: SwingTwistLimit| SwingTwistLimit {
        swing_y: y.unwrap_or(limit.swing_y),
        swing_z: z.unwrap_or(limit.swing_z),
        twist: twist.unwrap_or(limit.twist),
    };
    match kind {
        JointKind::Ball { limit } => JointKind::Ball { limit: limit.map(of) },
        JointKind::Universal { limit } => JointKind::Universal { limit: limit.map(of) },
        JointKind::Hinge { limit } => JointKind::Hinge { limit: twist.or(limit) },
        JointKind::SixDof(mut six) => {
            for (motion, range) in [(&mut six.swing_y, y), (&mut six.swing_z, z), (&mut six.twist, twist)] {
                if let (AxisMotion::Limited(_), Some(range)) = (*motion, range) {
                    *motion = AxisMotion::Limited(range);
                }
            }
            JointKind::SixDof(six)
        }
        other => other,
    }
}
