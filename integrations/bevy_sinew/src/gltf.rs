//! Characters from rigged files, by Sinew's own reader of glTF.

use crate::CharacterBody;
use bevy_app::{App, FixedPreUpdate, Plugin};
use bevy_asset::io::Reader;
use bevy_asset::{Asset, AssetApp, AssetLoader, Assets, Handle, LoadContext};
use bevy_ecs::prelude::*;
use bevy_reflect::TypePath;
use sinew::anim::{Clip, NoSkin, analyze};
use sinew::formats::{ReadOptions, no_files, read_gltf};
use sinew::motions::{BuiltinError, set_motions_with_builtin};
use sinew::ragdoll::{
    AfterSettling, BuildError, BuildOptions, CharacterDef, Locomotion, MotionError, MotionSet, build,
};
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

/// Makes the entity a character once the file is loaded: insert it together with `SceneRoot` or `WorldAssetRoot` of the same file.
#[derive(Component, Clone, Debug)]
#[require(bevy_transform::components::Transform)]
pub struct CharacterScene(pub Handle<CharacterFile>);

/// Names of the clips that a character plays, for `AssetServer::load_with_settings`; an unknown name is an error.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct CharacterSettings {
    /// Clip that loops while it walks. Default: the built-in walk.
    pub walk: Option<String>,
    /// Clip that loops while it stands. Default: none.
    pub idle: Option<String>,
    /// Clips that start lying and end standing. Default: those detected in the file, or else the built-in ones.
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
    /// The file has no skin.
    #[error(transparent)]
    Analysis(#[from] NoSkin),
    /// No ragdoll can be built from its joints.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// One of its clips cannot be played.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// The character is not a humanoid, or one of its clips cannot be played.
    #[error(transparent)]
    Builtin(#[from] BuiltinError),
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
        _: &mut LoadContext<'_>,
    ) -> Result<CharacterFile, CharacterFileError> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        read_character(&bytes, settings)
    }

    fn extensions(&self) -> &[&str] {
        &["glb", "vrm"]
    }
}

/// Creates a kind of character from the bytes of a GLB. Missing motions of humanoids are replaced by built-in ones.
///
/// # Errors
/// If the bytes are no GLB with a skin, or the settings do not fit it.
pub fn read_character(
    bytes: &[u8],
    settings: &CharacterSettings,
) -> Result<CharacterFile, CharacterFileError> {
    let document = read_gltf(bytes, ReadOptions::default(), &mut no_files)?;
    let analysis = analyze(&document.rig)?;
    let (ragdoll, report) = build(&document.rig, &analysis, &BuildOptions::default())?;
    let mut def = CharacterDef::new(document.rig, ragdoll, &analysis.bind_model);
    let motions = motions(&def, document.clips, settings)?;
    if analysis.humanoid {
        match set_motions_with_builtin(&mut def, &analysis, motions.clone()) {
            Err(BuiltinError::InFloor(_)) => {
                def.after_settling = AfterSettling::StayDown;
                def.set_motions(motions)?;
            }
            other => other?,
        }
    } else {
        def.set_motions(motions)?;
    }
    let notes = [document.warnings, analysis.notes, report.notes].concat();
    Ok(CharacterFile { def: Arc::new(def), notes })
}

fn motions(
    def: &CharacterDef,
    clips: Vec<Clip>,
    settings: &CharacterSettings,
) -> Result<MotionSet, CharacterFileError> {
    let named = |name: &String| {
        let index = clips.iter().position(|clip| clip.name == *name);
        index.ok_or_else(|| CharacterFileError::NoClip(name.clone()))
    };
    let looped = settings.walk.as_ref().map(named).transpose()?;
    let idle = settings.idle.as_ref().map(named).transpose()?;
    let get_ups = match settings.get_ups.as_slice() {
        [] => def.get_ups_among(&clips),
        names => names.iter().map(named).collect::<Result<_, _>>()?,
    };
    Ok(MotionSet { clips, looped, idle, get_ups, locomotion: Locomotion::ByClip, ..MotionSet::default() })
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
