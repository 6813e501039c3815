//! Characters from rigged files, by Sinew's own reader of glTF.

use crate::CharacterBody;
use bevy_app::{App, FixedPreUpdate, Plugin};
use bevy_asset::io::Reader;
use bevy_asset::{Asset, AssetApp, AssetLoader, Assets, Handle, LoadContext};
use bevy_ecs::prelude::*;
use bevy_reflect::TypePath;
use sinew::formats::{ReadOptions, no_files, read_gltf};
use sinew::ragdoll::{AfterSettling, CharacterDef, MotionError, MotionSet, Settings};
use sinew::{LoadCharacterError, LoadedCharacter, character_of};
use std::sync::Arc;

/// Reads characters from GLB files. Needs Bevy's `AssetPlugin`.
#[derive(Clone, Copy, Debug, Default)]
pub struct SinewGltfPlugin;

impl Plugin for SinewGltfPlugin {
    fn build(&self, app: &mut App) {
        app.init_asset::<CharacterFile>().register_asset_loader(CharacterLoader);
        app.add_systems(FixedPreUpdate, make_characters);
    }
}

/// A kind of character read from a GLB: `asset_server.load("knight.glb")`. Load the same file as a Bevy scene to draw it.
#[derive(Asset, TypePath, Clone, Debug)]
pub struct CharacterFile {
    /// Rig, ragdoll and motions.
    pub def: Arc<CharacterDef>,
    /// Notes about the file and the ragdoll, one line each.
    pub notes: Vec<String>,
}

/// Makes an entity a character once the file is loaded: insert the component together with `SceneRoot` or `WorldAssetRoot` of the same
/// file.
#[derive(Component, Clone, Debug)]
#[require(bevy_transform::components::Transform)]
pub struct CharacterScene(pub Handle<CharacterFile>);

/// Names of the clips that a character plays, for `AssetServer::load_with_settings`; an unknown name is an error. The other clips are
/// chosen among those of the file like by [`sinew::load_character`]; a humanoid without one gets the built-in clip.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct CharacterSettings {
    /// Clip that loops while the character walks.
    pub walk: Option<String>,
    /// Clip that loops while the character stands.
    pub idle: Option<String>,
    /// Clips that start lying and end standing.
    pub get_ups: Vec<String>,
}

/// Reason why a file contains no valid character.
#[derive(Debug, thiserror::Error)]
pub enum CharacterFileError {
    /// The bytes cannot be read.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// The file is not a valid GLB.
    #[error(transparent)]
    Format(#[from] sinew::formats::Error),
    /// The file has no skin, allows no ragdoll, or has a clip that cannot be played.
    #[error(transparent)]
    Character(#[from] LoadCharacterError),
    /// One of the named clips cannot be played.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// The settings name a missing clip.
    #[error("no clip is called `{0}`")]
    NoClip(String),
}

/// Reader of [`CharacterFile`]s.
#[derive(Clone, Copy, Debug, Default, TypePath)]
pub struct CharacterLoader;

impl AssetLoader for CharacterLoader {
    type Asset = CharacterFile;
    type Settings = CharacterSettings;
    type Error = CharacterFileError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        settings: &CharacterSettings,
        context: &mut LoadContext<'_>,
    ) -> Result<CharacterFile, CharacterFileError> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        read_character(&bytes, &context.path().to_string(), settings)
    }

    fn extensions(&self) -> &[&str] {
        &["glb", "vrm"]
    }
}

/// Reads a kind of character from the bytes of a GLB, like [`sinew::character_of`]. `name` is the name of the file: errors start with it,
/// and its words help to classify the character.
///
/// # Errors
/// If the bytes are no GLB with a skin, or the settings do not fit the file.
pub fn read_character(
    bytes: &[u8],
    name: &str,
    settings: &CharacterSettings,
) -> Result<CharacterFile, CharacterFileError> {
    let document = read_gltf(bytes, ReadOptions::default(), &mut no_files)?;
    let mut notes = document.warnings.clone();
    let LoadedCharacter { mut def, notes: more, report, .. } =
        character_of(document, name, &Settings::default())?;
    notes.extend(more);
    notes.extend(report.notes);
    if *settings != CharacterSettings::default() {
        let motions = chosen(def.motions().clone(), settings)?;
        if !settings.get_ups.is_empty() {
            def.after_settling = AfterSettling::GetUp;
        }
        def.set_motions(motions)?;
    }
    Ok(CharacterFile { def: Arc::new(def), notes })
}

/// Returns motions with the named clips in place of the chosen ones.
fn chosen(mut motions: MotionSet, settings: &CharacterSettings) -> Result<MotionSet, CharacterFileError> {
    let named = |name: &String| {
        let index = motions.clips.iter().position(|clip| clip.name == *name);
        index.ok_or_else(|| CharacterFileError::NoClip(name.clone()))
    };
    let walk = settings.walk.as_ref().map(named).transpose()?;
    let idle = settings.idle.as_ref().map(named).transpose()?;
    let get_ups: Vec<usize> = settings.get_ups.iter().map(named).collect::<Result<_, _>>()?;
    motions.looped = walk.or(motions.looped);
    motions.idle = idle.or(motions.idle);
    if !get_ups.is_empty() {
        motions.get_ups = get_ups;
    }
    Ok(motions)
}

fn make_characters(
    mut commands: Commands,
    files: Res<Assets<CharacterFile>>,
    waiting: Query<(Entity, &CharacterScene), Without<CharacterBody>>,
) {
    for (entity, CharacterScene(handle)) in &waiting {
        if let Some(file) = files.get(handle) {
            commands.entity(entity).insert(CharacterBody(file.def.clone()));
        }
    }
}
