//! A character from a file in one call.

use crate::anim::{NoSkin, RigAnalysis};
use crate::formats::{self, Document, read_bytes, read_ragdoll_settings, settings_path};
use crate::motions::{BuiltinError, OwnMotions, own_motions, set_motions_with_builtin};
use crate::ragdoll::build::BuildReport;
use crate::ragdoll::{
    AfterSettling, BuildOptions, CharacterDef, MotionError, Opening, Settings, SettingsError,
};
use crate::source::CharacterSource;
use std::path::Path;

/// A character read from a file.
#[derive(Clone, Debug)]
pub struct LoadedCharacter {
    /// Definition for [`Character::spawn`](crate::ragdoll::Character::spawn), which takes it in an `Arc`.
    pub def: CharacterDef,
    /// Roles of the rig's joints, its unit and its axes.
    pub analysis: RigAnalysis,
    /// Assumptions, chosen clips, and missing motions, one sentence each.
    pub notes: Vec<String>,
    /// Remarks of the ragdoll builder on single bodies.
    pub report: BuildReport,
}

/// Reason why a file gives no character.
#[derive(Debug, thiserror::Error)]
pub enum LoadCharacterError {
    /// The file cannot be read.
    #[error(transparent)]
    Format(#[from] formats::Error),
    /// The file has no skin.
    #[error("{file}: {source}")]
    NoSkin {
        /// The file.
        file: String,
        /// The reason.
        source: NoSkin,
    },
    /// The rig allows no ragdoll, or the settings next to it do not fit.
    #[error("{file}: {source}")]
    Settings {
        /// The file.
        file: String,
        /// The reason.
        source: SettingsError,
    },
    /// A clip cannot be played.
    #[error("{file}: {source}")]
    Motion {
        /// The file.
        file: String,
        /// The reason.
        source: MotionError,
    },
}

/// Makes a character from a GLB, glTF or VRM file: reads it, finds the roles of its joints, builds the ragdoll, and
/// chooses walk, idle and get-ups among its clips ([`own_motions`]). A human that lacks one of these gets the built-in
/// ones ([`set_motions_with_builtin`]); any other character without a get-up stays down. If the file has several
/// characters, the one with the most vertices is used. Settings in `NAME.ragdoll.json` next to the file are applied.
///
/// ```no_run
/// use sinew::prelude::*;
/// use std::sync::Arc;
///
/// let hero = sinew::load_character("hero.glb")?;
/// for note in &hero.notes {
///     println!("{note}");
/// }
/// let mut world = World::new(WorldDef::default());
/// world.add_body(&BodyDef::fixed(Shape::HalfSpace));
/// let mut hero = Character::spawn(&mut world, &Arc::new(hero.def), Transform::IDENTITY);
/// hero.set_move(Vec3::Z * 1.2); // m/s
/// # Ok::<(), sinew::LoadCharacterError>(())
/// ```
///
/// # Errors
/// If the file cannot be read, has no skin, or gives no ragdoll; if the settings do not fit; if a clip is unplayable.
pub fn load_character(path: impl AsRef<Path>) -> Result<LoadedCharacter, LoadCharacterError> {
    let path = path.as_ref();
    let document = crate::load(path)?;
    let beside = settings_path(path);
    let settings = match beside.is_file() {
        true => {
            let read = read_bytes(&beside).and_then(|bytes| read_ragdoll_settings(&bytes));
            read.map_err(|error| error.with_file(beside.display().to_string()))?
        }
        false => Settings::default(),
    };
    character_of(document, &path.display().to_string(), &settings)
}

/// Makes a character from a file in memory, like [`load_character`] from one on disk. `name` is the file's name:
/// errors start with it, and its words help to classify the character.
///
/// # Errors
/// As [`load_character`].
pub fn character_of(
    document: Document,
    name: &str,
    settings: &Settings,
) -> Result<LoadedCharacter, LoadCharacterError> {
    let file = || name.to_owned();
    let no_skin = |source| LoadCharacterError::NoSkin { file: file(), source };
    let refused = |source| LoadCharacterError::Settings { file: file(), source };
    let mut notes = Vec::new();
    let mut source = CharacterSource::new(document, name).map_err(no_skin)?;
    notes.extend(source.keep_largest().map_err(no_skin)?);
    source.correct(settings).map_err(refused)?;
    notes.extend(source.analysis.unit_guess.iter().map(|guess| guess.note.clone()));
    notes.extend(source.analysis.notes.iter().cloned());
    let springs = source.springs(settings, settings.springs.unwrap_or_default());
    source.document.rig.springs = springs.map_err(refused)?;
    let garments = source.garments(settings).map_err(refused)?;
    let (ragdoll, report) = source.build(settings, &BuildOptions::default()).map_err(refused)?;
    let CharacterSource { document: Document { rig, clips, .. }, analysis, .. } = source;
    let mut def = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
    def.set_garments(&garments);
    let found = set_motions(&mut def, &analysis, clips);
    notes.extend(found.map_err(|source| LoadCharacterError::Motion { file: file(), source })?);
    Ok(LoadedCharacter { def, analysis, notes, report })
}

/// Gives a character its own clips and, if it is a human, built-in ones for the motions that they lack; returns notes.
fn set_motions(
    def: &mut CharacterDef,
    analysis: &RigAnalysis,
    clips: Vec<crate::anim::Clip>,
) -> Result<Vec<String>, MotionError> {
    let OwnMotions { motions, mut notes } = own_motions(def, analysis, clips);
    let (walks, gets_up) = (motions.looped.is_some(), !motions.get_ups.is_empty());
    match set_motions_with_builtin(def, analysis, motions.clone()) {
        Ok(()) => {
            def.set_opening(Opening::Looped);
            let lacks = [(walks, "walks"), (gets_up, "gets up")].into_iter().filter(|(has, _)| !has);
            notes.extend(lacks.map(|(_, what)| format!("it {what} by the built-in motions")));
            return Ok(notes);
        }
        Err(BuiltinError::Motion(error)) => return Err(error),
        Err(_) if gets_up => {}
        Err(error) => {
            notes.push(format!("it stays down after a fall: {error}"));
            def.after_settling = AfterSettling::StayDown;
        }
    }
    def.set_motions(motions)?;
    Ok(notes)
}
