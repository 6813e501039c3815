//! A character file before its ragdoll is built.

use crate::anim::legs::add_ankles;
use crate::anim::{
    Clip, Garment, Hints, JointIdx, NoSkin, Rig, RigAnalysis, Springs, analyze_hinted, characters,
};
use crate::formats::Document;
use crate::math::Vec3;
use crate::ragdoll::build::{BuildReport, takes};
use crate::ragdoll::settings::{SpringSource, analyze_with};
use crate::ragdoll::{BuildError, BuildOptions, RagdollDef, Settings, SettingsError, build_moving};
use std::path::Path;

/// Returns the hints for the analysis of a character's file: its name or path, clips and exporter.
///
/// # Panics
/// As [`Hints::of_clips`].
pub fn character_hints(name: &str, rig: &Rig, clips: &[Clip], exporter: &str) -> Hints {
    let stem = Path::new(name).file_stem().map(|stem| stem.to_string_lossy().into_owned());
    Hints {
        name: stem.unwrap_or_default(),
        // Readers convert every format to +Y up.
        up: Some(Vec3::Y),
        exporter: exporter.to_owned(),
        ..Hints::of_clips(rig, clips)
    }
}

/// A character file and its analysis, for running the stages of [`load_character`](crate::load_character) one by one:
/// [`new`](Self::new), then [`hint`](Self::hint) and [`keep`](Self::keep) as needed, [`correct`](Self::correct), and
/// [`build`](Self::build).
#[derive(Clone, Debug)]
pub struct CharacterSource {
    /// Rig, clips and JSON of the file.
    pub document: Document,
    /// Analysis of the rig's joints.
    pub analysis: RigAnalysis,
    /// Joints of the garments in the settings and joints to ignore, which with all below are not part of the body.
    pub worn: Vec<JointIdx>,
}

impl CharacterSource {
    /// Analyses a file. `name` is its name or path, whose words help to classify the character.
    ///
    /// # Errors
    /// If no vertex is bound to a joint.
    pub fn new(document: Document, name: &str) -> Result<Self, NoSkin> {
        let hints = character_hints(name, &document.rig, &document.clips, document.generator());
        let analysis = analyze_hinted(&document.rig, &hints)?;
        Ok(Self { document, analysis, worn: Vec::new() })
    }

    /// Repeats the analysis with other hints, if they differ from the current ones.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn hint(&mut self, hints: &Hints) -> Result<(), NoSkin> {
        if *hints != self.analysis.hints {
            self.analysis = analyze_hinted(&self.document.rig, hints)?;
        }
        Ok(())
    }

    /// Returns the number of vertices of each character in the file.
    pub fn characters(&self) -> Vec<usize> {
        let rig = &self.document.rig;
        let vertices = |own: Vec<usize>| {
            let primitives = own.into_iter().flat_map(|mesh| &rig.meshes[mesh].primitives);
            primitives.map(|primitive| primitive.positions.len()).sum()
        };
        characters(rig).into_iter().map(vertices).collect()
    }

    /// Returns the index of the character with the most vertices; of equal ones, the first. `None` without characters.
    pub fn largest(&self) -> Option<usize> {
        let vertices = self.characters();
        (0..vertices.len()).reduce(|a, b| if vertices[b] > vertices[a] { b } else { a })
    }

    /// Removes the meshes of all characters but the one with this index.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    ///
    /// # Panics
    /// If there is no such character.
    #[track_caller]
    pub fn keep(&mut self, character: usize) -> Result<(), NoSkin> {
        let rig = &mut self.document.rig;
        let all = characters(rig);
        assert!(
            character < all.len(),
            "character {character} is out of range: the file has {} characters",
            all.len()
        );
        let is_others =
            |mesh: usize| all.iter().any(|meshes| meshes.contains(&mesh)) && !all[character].contains(&mesh);
        let mut index = 0;
        rig.meshes.retain(|_| {
            index += 1;
            !is_others(index - 1)
        });
        self.analysis = analyze_hinted(rig, &self.analysis.hints)?;
        Ok(())
    }

    /// [`keep`](Self::keep)s the character with the most vertices; returns a note if there are several.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn keep_largest(&mut self) -> Result<Option<String>, NoSkin> {
        let count = self.characters().len();
        let Some(largest) = self.largest().filter(|_| count > 1) else { return Ok(None) };
        self.keep(largest)?;
        Ok(Some(format!("the file contains {count} characters; the one with the most vertices is used")))
    }

    /// Applies settings to roles and unit, makes cloth of the meshes listed as garments, and gives legs without feet an ankle.
    ///
    /// # Errors
    /// If the settings do not fit the rig.
    pub fn correct(&mut self, settings: &Settings) -> Result<(), SettingsError> {
        self.apply(settings)?;
        if let Some(up) = settings.up_axis {
            self.analysis.hints.up = Some(up);
        }
        if settings.garments.has_meshes() {
            let nodes = self.document.node_count();
            settings.garments.lay_sheets(&mut self.document.rig, &self.analysis, nodes)?;
            let notes = core::mem::take(&mut self.analysis.notes);
            let analysis = analyze_hinted(&self.document.rig, &self.analysis.hints);
            self.analysis = analysis.map_err(|NoSkin| BuildError::NoSkin)?;
            self.apply(settings)?;
            self.analysis.notes = notes;
        }
        add_ankles(&mut self.document.rig, &mut self.analysis);
        Ok(())
    }

    fn apply(&mut self, settings: &Settings) -> Result<(), SettingsError> {
        self.analysis = analyze_with(&self.document.rig, &self.analysis, settings)?;
        self.worn = settings.ignored_joints(&self.document.rig)?;
        Ok(())
    }

    /// Builds the ragdoll, with limits learned from the clips if the options ask for them.
    ///
    /// # Errors
    /// If the rig allows no ragdoll, or the settings do not fit it.
    pub fn build(
        &self,
        settings: &Settings,
        options: &BuildOptions,
    ) -> Result<(RagdollDef, BuildReport), SettingsError> {
        let moves = takes(&self.document.rig, &self.document.clips);
        build_moving(&self.document.rig, &self.analysis, &moves, options, settings)
    }

    /// Returns the springs of a source, changed by the settings.
    ///
    /// # Errors
    /// If the settings do not fit the rig.
    pub fn springs(&self, settings: &Settings, source: SpringSource) -> Result<Springs, SettingsError> {
        settings.springs_of(source, &self.document.rig, self.analysis.up_axis)
    }

    /// Returns the garments of the settings.
    ///
    /// # Errors
    /// If the settings do not fit the rig.
    pub fn garments(&self, settings: &Settings) -> Result<Vec<Garment>, SettingsError> {
        settings.garments.garments(&self.document.rig)
    }
}
