//! Files of characters and ragdolls, by their paths.

use crate::Failure;
use sinew::anim::{Hints, RigAnalysis, analyze_hinted};
use sinew::formats::{
    Document, MotionFormat, MotionOptions, ReadOptions, load_gltf, load_motion, no_files, read_bytes,
    read_gltf, read_mjcf, read_ragdoll, read_ragdoll_settings, settings_path, write_gltf, write_motion,
};
use sinew::math::Vec3;
use sinew::motions::{BuiltinError, set_motions_with_builtin};
use sinew::ragdoll::build::takes;
use sinew::ragdoll::settings::{Unit, analyze_with};
use sinew::ragdoll::{
    AfterSettling, BuildOptions, BuildReport, CharacterDef, Locomotion, MotionSet, RagdollDef, Repair,
    Settings, build_moving,
};
use std::path::Path;

/// A rigged character: the file, and who is what in it.
#[derive(Clone, Debug)]
pub struct CharacterFile {
    /// As the user named it.
    pub name: String,
    /// Its rig, clips and bytes.
    pub document: Document,
    /// Analysis of its joints.
    pub analysis: RigAnalysis,
    /// Settings beside the file, or none.
    pub settings: Settings,
}

/// Wishes of a build that differ from what file and settings say; `None` leaves it to them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wishes {
    /// Mass of the whole, kg.
    pub mass: Option<f32>,
    /// Height of the whole, metres.
    pub height: Option<f32>,
    /// Kind of shapes, whose masses, and the source of limits.
    pub options: BuildOptions,
}

impl CharacterFile {
    /// Reads a GLB, glTF, VRM or FBX with a skinned character, and the settings beside it. As the commands of `sinew` read it,
    /// but for the unit of a file in doubt, which they also ask its neighbours for.
    ///
    /// # Errors
    /// Names the file, what is wrong with it, and where.
    pub fn load(path: &Path) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let is_fbx = matches!(MotionFormat::of(&read_bytes(path)?), Ok(MotionFormat::Fbx));
        let document = if is_fbx {
            let file = load_motion(path, &MotionOptions::default())?;
            let bytes = write_motion(&file.rig, &file.clips, &file.events);
            let read = |bytes: Vec<u8>| read_gltf(&bytes, ReadOptions::default(), &mut no_files);
            bytes.and_then(read).map_err(|error| error.with_file(&name))?
        } else {
            load_gltf(path, ReadOptions::default())?
        };
        let beside = settings_path(path);
        let settings = if beside.is_file() {
            let read = read_bytes(&beside).and_then(|bytes| read_ragdoll_settings(&bytes));
            read.map_err(|error| error.with_file(beside.display().to_string()))?
        } else {
            Settings::default()
        };
        Self::new(name, document, settings)
    }

    fn new(name: String, document: Document, settings: Settings) -> Result<Self, Failure> {
        let stem = Path::new(&name).file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let hints = Hints {
            name: stem.unwrap_or_default(),
            // Readers turn every format so that +Y is up.
            up: Some(Vec3::Y),
            exporter: document.generator().to_owned(),
            ..Hints::of_clips(&document.rig, &document.clips)
        };
        let failed = |error: &dyn core::fmt::Display| Failure::file(&name, error);
        let analysis = analyze_hinted(&document.rig, &hints).map_err(|error| failed(&error))?;
        let analysis = analyze_with(&document.rig, &analysis, &settings).map_err(|error| failed(&error))?;
        Ok(Self { name, document, analysis, settings })
    }

    /// The ragdoll of the character, and what the build says of it.
    ///
    /// # Errors
    /// Names the file and what is wrong with it or with a wish.
    pub fn build(&self, wishes: &Wishes) -> Result<(RagdollDef, BuildReport), Failure> {
        let rig = &self.document.rig;
        let mut settings = self.settings.clone();
        settings.mass = wishes.mass.or(settings.mass);
        settings.unit = wishes.height.map(Unit::Height).or(settings.unit);
        let failed = |error: &dyn core::fmt::Display| Failure::file(&self.name, error);
        let analysis = analyze_with(rig, &self.analysis, &settings).map_err(|error| failed(&error))?;
        let moves = takes(rig, &self.document.clips);
        build_moving(rig, &analysis, &moves, &wishes.options, &settings).map_err(|error| failed(&error))
    }

    /// The character with its own clips; by what it gets up it may be given Sinew's own motions, if it is a humanoid. One that has
    /// none stays down. `looped`: name of the clip that plays until it falls.
    ///
    /// # Errors
    /// The ragdoll is another rig's, there is no such clip, or a clip cannot be played.
    pub fn character(&self, ragdoll: &RagdollDef, looped: Option<&str>) -> Result<CharacterDef, Failure> {
        let failed = |error: &dyn core::fmt::Display| Failure::file(&self.name, error);
        let (rig, clips) = (&self.document.rig, &self.document.clips);
        let ragdoll = ragdoll.clone().for_rig(rig).map_err(|error| failed(&error))?;
        let mut def = CharacterDef::new(rig.clone(), ragdoll, &self.analysis.bind_model);
        let get_ups = def.get_ups_among(clips);
        let looped = match looped {
            None => {
                let called =
                    |word: &str| clips.iter().position(|clip| clip.name.to_lowercase().contains(word));
                let first = (0..clips.len()).find(|index| !get_ups.contains(index));
                called("walk").or_else(|| called("idle")).or(first)
            }
            Some(name) => {
                let found = clips.iter().position(|clip| clip.name == name);
                Some(found.ok_or_else(|| failed(&format!("no clip is called '{name}'")))?)
            }
        };
        let get_ups: Vec<usize> = get_ups.into_iter().filter(|&clip| Some(clip) != looped).collect();
        let clips = clips.clone();
        let own =
            MotionSet { clips, looped, get_ups, locomotion: Locomotion::ByClip, ..MotionSet::default() };
        if own.get_ups.is_empty() {
            match set_motions_with_builtin(&mut def, &self.analysis, own.clone()) {
                Ok(()) => return Ok(def),
                Err(BuiltinError::Motion(error)) => return Err(failed(&error)),
                Err(BuiltinError::Retarget(_) | BuiltinError::InFloor(_)) => {}
            }
            def.after_settling = AfterSettling::StayDown;
        }
        def.set_motions(own).map_err(|error| failed(&error))?;
        Ok(def)
    }
}

/// The mannequin that comes with Sinew, as if it had been read from a file.
pub fn embedded() -> CharacterFile {
    let mannequin = sinew::mannequin::mannequin();
    let bytes = write_gltf(&mannequin.rig, &mannequin.clips).expect("the mannequin is a glTF");
    let document = read_gltf(&bytes, ReadOptions::default(), &mut no_files).expect("which can be read");
    CharacterFile::new("mannequin".to_owned(), document, Settings::default()).expect("and has a skin")
}

/// Any file that a ragdoll comes from, by its name: a definition (`.json`), an MJCF model (`.xml`), or a character, of which it
/// is built.
///
/// # Errors
/// Names the file, what is wrong with it, and where.
pub fn load_ragdoll(path: &Path) -> Result<Repair, Failure> {
    let name = path.display().to_string();
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    let named = |error: sinew::formats::Error| error.with_file(&name);
    match extension.as_deref() {
        Some("json") => Ok(Repair::new(read_ragdoll(&read_bytes(path)?).map_err(named)?)),
        Some("xml") => {
            let model = read_mjcf(&read_bytes(path)?).and_then(|model| model.to_ragdoll()).map_err(named)?;
            Ok(Repair { springs: model.springs, ..Repair::new(model.def) })
        }
        _ => {
            let (def, _) = CharacterFile::load(path)?.build(&Wishes::default())?;
            Ok(Repair { reference: Some(def.clone()), ..Repair::new(def) })
        }
    }
}
