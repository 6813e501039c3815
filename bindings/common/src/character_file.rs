//! Reads character and ragdoll files by path.

use crate::Failure;
use sinew::CharacterSource;
use sinew::anim::weights::lost_weights;
use sinew::anim::{Clip, Garment, Rig, RigAnalysis};
use sinew::formats::{
    Document, MotionFile, MotionFormat, MotionOptions, ReadOptions, load_gltf, load_motion, no_files,
    read_bytes, read_gltf, read_model, read_motion, read_ragdoll, read_ragdoll_settings, settings_path,
    write_gltf, write_motion,
};
use sinew::motions::{BuiltinError, looped_among, set_motions_with_builtin};
use sinew::ragdoll::build::{joint_name, takes};
use sinew::ragdoll::settings::{BodyWish, BoneSettings, Unit, analyze_with, role_named};
use sinew::ragdoll::{
    AfterSettling, BuildOptions, BuildReport, CharacterDef, DriveMode, GroundContact, Locomotion, MotionSet,
    RagdollDef, Repair, Settings, build_moving,
};
use std::path::Path;

/// A rigged character: the file, and the roles of the rig's joints.
#[derive(Clone, Debug)]
pub struct CharacterFile {
    /// Name given by the user.
    pub name: String,
    /// Rig, clips and bytes of the file. The rig may have added ankles and sheet joints that the file lacks.
    pub document: Document,
    /// Analysis of the rig's joints.
    pub analysis: RigAnalysis,
    /// Settings beside the file or given by the user, if any.
    pub settings: Settings,
    /// Garments from the settings.
    pub garments: Vec<Garment>,
}

/// User settings that override those beside the file.
#[derive(Clone, Debug, Default)]
pub struct Corrections {
    /// Settings instead of those beside the file.
    pub settings: Option<Settings>,
    /// Joints and their roles.
    pub roles: Vec<(String, String)>,
    /// Joints that, with all their descendants, do not belong to the body.
    pub ignore: Vec<String>,
    /// Bones, by role or joint, and true for each that gets its own body.
    pub bodies: Vec<(String, bool)>,
    /// Length of the file's unit, metres.
    pub unit: Option<f32>,
    /// Height of the character, metres.
    pub height: Option<f32>,
    /// Total mass, kg.
    pub mass: Option<f32>,
}

impl Corrections {
    fn over(&self, beside: Settings) -> Result<Settings, Failure> {
        let mut settings = self.settings.clone().unwrap_or(beside);
        for (joint, role) in &self.roles {
            let role = role_named(role).map_err(Failure::argument)?;
            settings
                .bones
                .push((joint.clone(), BoneSettings { role: Some(role), ..BoneSettings::default() }));
        }
        settings.ignore.extend(self.ignore.iter().cloned());
        for (bone, has) in &self.bodies {
            let body = Some(if *has { BodyWish::Keep } else { BodyWish::Drop });
            settings.bones.push((bone.clone(), BoneSettings { body, ..BoneSettings::default() }));
        }
        let positive = |number: Option<f32>, what: &str| match number {
            Some(number) if !(number > 0.0 && number < f32::INFINITY) => {
                Err(Failure::argument(format!("the {what} must be positive and finite, not {number}")))
            }
            other => Ok(other),
        };
        let (unit, height) = (positive(self.unit, "unit")?, positive(self.height, "height")?);
        if unit.is_some() && height.is_some() {
            return Err(Failure::argument("unit and height set the same: give one of the two"));
        }
        settings.unit = unit.map(Unit::Scale).or(height.map(Unit::Height)).or(settings.unit);
        settings.mass = positive(self.mass, "mass")?.or(settings.mass);
        Ok(settings)
    }
}

/// Build options that override the file and its settings; `None` keeps their values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wishes {
    /// Total mass, kg.
    pub mass: Option<f32>,
    /// Height of the character, metres.
    pub height: Option<f32>,
    /// Kind of shapes, source of masses, and source of limits.
    pub options: BuildOptions,
}

/// Motions of a character before, during and after a fall.
#[derive(Clone, Debug)]
pub struct Motions {
    /// Name of the clip that plays until the fall; `None`: the file's walk, else its idle, else its first clip.
    pub looped: Option<String>,
    /// Motion over the ground while that clip plays. Default: by the clip.
    pub locomotion: Locomotion,
    /// Adds Sinew's own get-up motions if the file has none. Default: true.
    pub builtin: bool,
    /// Action after the character lies still. Default: get up.
    pub after_settling: AfterSettling,
    /// Drive of the bodies during the fall. Default: limp.
    pub falling: DriveMode,
}

impl Default for Motions {
    fn default() -> Self {
        Self {
            looped: None,
            locomotion: Locomotion::ByClip,
            builtin: true,
            after_settling: AfterSettling::GetUp,
            falling: DriveMode::Limp,
        }
    }
}

impl CharacterFile {
    /// Reads a GLB, glTF, VRM or FBX with a skinned character, and the settings beside it, like the commands of `sinew`. The commands also
    /// use neighbouring files to find an uncertain unit.
    ///
    /// # Errors
    /// If the file is invalid; the error names the file, the problem and its position.
    pub fn load(path: &Path, corrections: &Corrections) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let is_fbx = matches!(MotionFormat::of(&read_bytes(path)?), Ok(MotionFormat::Fbx));
        let document = if is_fbx {
            of_motion(load_motion(path, &MotionOptions::default())?, &name)?
        } else {
            load_gltf(path, ReadOptions::default())?
        };
        let beside = settings_path(path);
        let settings = if corrections.settings.is_none() && beside.is_file() {
            let read = read_bytes(&beside).and_then(|bytes| read_ragdoll_settings(&bytes));
            read.map_err(|error| error.with_file(beside.display().to_string()))?
        } else {
            Settings::default()
        };
        Self::new(name, document, corrections.over(settings)?)
    }

    /// [`load`](Self::load) for bytes in memory. `name` is the name of the file: error messages start with it, and its words help to
    /// classify the character. A glTF must contain its buffers.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn read(bytes: &[u8], name: &str, corrections: &Corrections) -> Result<Self, Failure> {
        let named = |error: sinew::formats::Error| error.with_file(name);
        let document = if matches!(MotionFormat::of(bytes), Ok(MotionFormat::Fbx)) {
            of_motion(read_motion(bytes, &MotionOptions::default(), &mut no_files).map_err(named)?, name)?
        } else {
            read_gltf(bytes, ReadOptions::default(), &mut no_files).map_err(named)?
        };
        Self::new(name.to_owned(), document, corrections.over(Settings::default())?)
    }

    /// [`load`](Self::load) for a rig and clips created by code.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn of_rig(rig: &Rig, clips: &[Clip], name: &str, corrections: &Corrections) -> Result<Self, Failure> {
        let bytes = write_gltf(rig, clips).map_err(|error| error.with_file(name))?;
        Self::read(&bytes, name, corrections)
    }

    fn new(name: String, document: Document, settings: Settings) -> Result<Self, Failure> {
        let failed = |error: &dyn core::fmt::Display| Failure::file(&name, error);
        if let Some(joint) = lost_weights(&document.rig) {
            let bone = joint_name(&document.rig, joint);
            let what = format!(
                "all vertices hang on one bone, {bone}: the weights of the skin were lost, and it cannot bend"
            );
            return Err(failed(&what));
        }
        let mut source = CharacterSource::new(document, &name).map_err(|error| failed(&error))?;
        let note = source.keep_largest().map_err(|error| failed(&error))?;
        source.correct(&settings).map_err(|error| failed(&error))?;
        source.analysis.notes.extend(note);
        let springs = source.springs(&settings, settings.springs.unwrap_or_default());
        source.document.rig.springs = springs.map_err(|error| failed(&error))?;
        let garments = source.garments(&settings).map_err(|error| failed(&error))?;
        let CharacterSource { document, analysis, .. } = source;
        Ok(Self { name, document, analysis, settings, garments })
    }

    /// Builds the ragdoll of the character; also returns the report of the build.
    ///
    /// # Errors
    /// If the file or an option is invalid; the error names the file and the problem.
    pub fn build(&self, wishes: &Wishes) -> Result<(RagdollDef, BuildReport), Failure> {
        let rig = &self.document.rig;
        let mut settings = self.settings.clone();
        settings.mass = wishes.mass.or(settings.mass);
        settings.unit = wishes.height.map(Unit::Height).or(settings.unit);
        let failed = |error: &dyn core::fmt::Display| Failure::file(&self.name, error);
        let corrected = match wishes.height {
            Some(_) => Some(analyze_with(rig, &self.analysis, &settings).map_err(|error| failed(&error))?),
            None => None,
        };
        let moves = takes(rig, &self.document.clips);
        build_moving(rig, corrected.as_ref().unwrap_or(&self.analysis), &moves, &wishes.options, &settings)
            .map_err(|error| failed(&error))
    }

    /// Returns the character with its own clips, built as in `sinew bake`. A humanoid can get Sinew's get-up motions. A character without
    /// get-ups stays down.
    ///
    /// # Errors
    /// If the ragdoll belongs to another rig, the clip does not exist, or a clip cannot be played.
    pub fn character(&self, ragdoll: &RagdollDef, motions: &Motions) -> Result<CharacterDef, Failure> {
        let failed = |error: &dyn core::fmt::Display| Failure::file(&self.name, error);
        let (rig, clips) = (&self.document.rig, &self.document.clips);
        let ragdoll = ragdoll.clone().for_rig(rig).map_err(|error| failed(&error))?;
        let mut def = CharacterDef::new(rig.clone(), ragdoll, &self.analysis.bind_model);
        def.ground_contact = GroundContact::Enforced;
        let looped = match &motions.looped {
            None => looped_among(rig, &self.analysis, clips),
            Some(name) => {
                let found = clips.iter().position(|clip| clip.name == *name);
                Some(found.ok_or_else(|| unknown_clip(name, clips))?)
            }
        };
        let mut get_ups = def.get_ups_among(clips);
        get_ups.retain(|&clip| Some(clip) != looped);
        let clips = clips.clone();
        let own =
            MotionSet { clips, looped, get_ups, locomotion: motions.locomotion, ..MotionSet::default() };
        self.give_motions(&mut def, own, motions.builtin && motions.after_settling == AfterSettling::GetUp)?;
        if motions.after_settling == AfterSettling::StayDown {
            def.after_settling = AfterSettling::StayDown;
        }
        def.set_garments(&self.garments);
        def.falling = motions.falling;
        Ok(def)
    }

    fn give_motions(&self, def: &mut CharacterDef, own: MotionSet, builtin: bool) -> Result<(), Failure> {
        let failed = |error: &dyn core::fmt::Display| Failure::file(&self.name, error);
        if own.get_ups.is_empty() {
            let given = builtin.then(|| set_motions_with_builtin(def, &self.analysis, own.clone()));
            match given {
                // Sinew's walk replaces neither the file's walk nor its locomotion.
                Some(Ok(())) => return Ok(()),
                Some(Err(BuiltinError::Motion(error))) => return Err(failed(&error)),
                Some(Err(BuiltinError::Retarget(_) | BuiltinError::InFloor(_))) | None => {}
            }
            def.after_settling = AfterSettling::StayDown;
        }
        def.set_motions(own).map_err(|error| failed(&error))
    }
}

/// Returns the error for a clip name that the file does not have.
fn unknown_clip(name: &str, clips: &[Clip]) -> Failure {
    let names: Vec<&str> = clips.iter().map(|clip| clip.name.as_str()).collect();
    let known = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
    Failure::argument(format!("no clip is called '{name}'; there are {known}"))
}

/// Converts a motion file to a glTF document.
fn of_motion(file: MotionFile, name: &str) -> Result<Document, Failure> {
    let bytes = write_motion(&file.rig, &file.clips, &file.events);
    let read = |bytes: Vec<u8>| read_gltf(&bytes, ReadOptions::default(), &mut no_files);
    Ok(bytes.and_then(read).map_err(|error| error.with_file(name))?)
}

/// Returns the built-in mannequin, as if it had been read from a file.
pub fn embedded() -> CharacterFile {
    let mannequin = sinew::mannequin::mannequin();
    let bytes = write_gltf(&mannequin.rig, &mannequin.clips).expect("the mannequin is a glTF");
    let document = read_gltf(&bytes, ReadOptions::default(), &mut no_files).expect("which can be read");
    CharacterFile::new("mannequin".to_owned(), document, Settings::default()).expect("and has a skin")
}

/// Reads a ragdoll from a file, by its extension: a definition (`.json`), an MJCF or URDF model (`.xml`, `.urdf`), or a character, whose
/// ragdoll is built.
///
/// # Errors
/// If the file is invalid; the error names the file, the problem and its position.
pub fn load_ragdoll(path: &Path) -> Result<Repair, Failure> {
    let name = path.display().to_string();
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    let named = |error: sinew::formats::Error| error.with_file(&name);
    match extension.as_deref() {
        Some("json") => Ok(Repair::new(read_ragdoll(&read_bytes(path)?).map_err(named)?)),
        Some("xml" | "urdf") => {
            let model = read_model(&read_bytes(path)?).and_then(|model| model.to_ragdoll()).map_err(named)?;
            Ok(Repair { springs: model.springs, ..Repair::new(model.def) })
        }
        _ => {
            let (def, _) = CharacterFile::load(path, &Corrections::default())?.build(&Wishes::default())?;
            Ok(Repair { reference: Some(def.clone()), ..Repair::new(def) })
        }
    }
}
