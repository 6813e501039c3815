//! Reads files of characters.

use crate::bake::Character;
use crate::drive::Drive;
use crate::errors::{bad, failed, guarded, of_file};
use crate::ragdoll::Ragdoll;
use crate::rig_arrays;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use sinew::formats::{append_clips, read_ragdoll_settings};
use sinew::ragdoll::{AfterSettling, BuildOptions, DriveMode, LimitSource, Locomotion, Sex, ShapeChoice};
use sinew_bindings::{Corrections, Motions, Wishes};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Rigged character as read from a file.
#[pyclass(frozen, module = "sinew")]
pub struct CharacterFile {
    pub file: Arc<sinew_bindings::CharacterFile>,
}

/// Makes corrections of a character from the arguments of a loading function.
fn corrections(
    settings: Option<&Bound<'_, PyAny>>,
    roles: Option<HashMap<String, String>>,
    ignore: Option<Vec<String>>,
    bodies: Option<HashMap<String, bool>>,
    [unit, height, mass]: [Option<f32>; 3],
) -> PyResult<Corrections> {
    let settings = settings.map(|given| {
        let py = given.py();
        let whole = PyDict::new(py);
        whole.set_item("sinew", "ragdoll-settings")?;
        whole.set_item("version", 1)?;
        whole.call_method1("update", (given,))?;
        let text: String = py.import("json")?.call_method1("dumps", (whole,))?.extract()?;
        read_ragdoll_settings(text.as_bytes()).map_err(|error| bad(format!("settings: {error}")))
    });
    // Sorts the entries, because the order of a dictionary must not affect the bits.
    let sorted = |map: Option<HashMap<String, String>>| {
        let mut list: Vec<_> = map.unwrap_or_default().into_iter().collect();
        list.sort();
        list
    };
    let mut bodies: Vec<_> = bodies.unwrap_or_default().into_iter().collect();
    bodies.sort();
    Ok(Corrections {
        settings: settings.transpose()?,
        roles: sorted(roles),
        ignore: ignore.unwrap_or_default(),
        bodies,
        unit,
        height,
        mass,
    })
}

/// Reads a GLB, glTF, VRM or FBX with a skinned character, and the settings beside it.
#[pyfunction]
#[pyo3(signature = (path, *, settings=None, roles=None, ignore=None, bodies=None, unit=None, height=None, mass=None))]
pub fn load(
    py: Python<'_>,
    path: PathBuf,
    settings: Option<&Bound<'_, PyAny>>,
    roles: Option<HashMap<String, String>>,
    ignore: Option<Vec<String>>,
    bodies: Option<HashMap<String, bool>>,
    unit: Option<f32>,
    height: Option<f32>,
    mass: Option<f32>,
) -> PyResult<CharacterFile> {
    let given = corrections(settings, roles, ignore, bodies, [unit, height, mass])?;
    let load = || guarded(|| sinew_bindings::CharacterFile::load(&path, &given));
    let file = py.detach(load)?.map_err(failed)?;
    Ok(CharacterFile { file: Arc::new(file) })
}

/// Reads a character from the bytes of a GLB, VRM or FBX, or of a glTF that contains its buffers.
#[pyfunction]
#[pyo3(signature = (data, *, name="character", settings=None, roles=None, ignore=None, bodies=None, unit=None, height=None, mass=None))]
pub fn load_bytes(
    py: Python<'_>,
    data: &[u8],
    name: &str,
    settings: Option<&Bound<'_, PyAny>>,
    roles: Option<HashMap<String, String>>,
    ignore: Option<Vec<String>>,
    bodies: Option<HashMap<String, bool>>,
    unit: Option<f32>,
    height: Option<f32>,
    mass: Option<f32>,
) -> PyResult<CharacterFile> {
    let given = corrections(settings, roles, ignore, bodies, [unit, height, mass])?;
    let read = || guarded(|| sinew_bindings::CharacterFile::read(data, name, &given));
    let file = py.detach(read)?.map_err(failed)?;
    Ok(CharacterFile { file: Arc::new(file) })
}

/// Makes a character from arrays: joints with their rest pose, skinned meshes, clips.
#[pyfunction]
#[pyo3(signature = (joints, parents, translations, rotations, *, scales=None, inverse_bind=None, meshes=None, clips=None, name="character", settings=None, roles=None, ignore=None, bodies=None, unit=None, height=None, mass=None))]
pub fn load_arrays(
    py: Python<'_>,
    joints: Vec<String>,
    parents: &Bound<'_, PyAny>,
    translations: &Bound<'_, PyAny>,
    rotations: &Bound<'_, PyAny>,
    scales: Option<&Bound<'_, PyAny>>,
    inverse_bind: Option<&Bound<'_, PyAny>>,
    meshes: Option<Vec<Bound<'_, PyDict>>>,
    clips: Option<&Bound<'_, PyDict>>,
    name: &str,
    settings: Option<&Bound<'_, PyAny>>,
    roles: Option<HashMap<String, String>>,
    ignore: Option<Vec<String>>,
    bodies: Option<HashMap<String, bool>>,
    unit: Option<f32>,
    height: Option<f32>,
    mass: Option<f32>,
) -> PyResult<CharacterFile> {
    let given = corrections(settings, roles, ignore, bodies, [unit, height, mass])?;
    let mut rig = rig_arrays::skeleton(joints, parents, [translations, rotations], scales)?;
    rig_arrays::skin(&mut rig, inverse_bind, &meshes.unwrap_or_default())?;
    let clips = clips.map(|clips| rig_arrays::clips(&rig, clips)).transpose()?.unwrap_or_default();
    let make = || guarded(|| sinew_bindings::CharacterFile::of_rig(&rig, &clips, name, &given));
    let file = py.detach(make)?.map_err(failed)?;
    Ok(CharacterFile { file: Arc::new(file) })
}

/// Returns the built-in mannequin, 1.75 m, with a walk and two get-ups.
#[pyfunction]
pub fn mannequin(py: Python<'_>) -> PyResult<CharacterFile> {
    let file = py.detach(|| guarded(sinew_bindings::embedded))?;
    Ok(CharacterFile { file: Arc::new(file) })
}

#[pymethods]
impl CharacterFile {
    /// Name of the file.
    #[getter]
    fn name(&self) -> &str {
        &self.file.name
    }

    /// Names of all joints.
    #[getter]
    fn joints(&self) -> Vec<&str> {
        self.file.document.rig.joints.iter().map(|joint| joint.name.as_str()).collect()
    }

    /// Names of all clips.
    #[getter]
    fn clips(&self) -> Vec<&str> {
        self.file.document.clips.iter().map(|clip| clip.name.as_str()).collect()
    }

    /// Joint of each role that was recognised.
    #[getter]
    fn roles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let roles = PyDict::new(py);
        for (joint, guess) in self.file.document.rig.joints.iter().zip(&self.file.analysis.roles) {
            if let Some(guess) = guess {
                roles.set_item(guess.role.name(), &joint.name)?;
            }
        }
        Ok(roles)
    }

    /// Assumptions about the file, one sentence each.
    #[getter]
    fn notes(&self) -> Vec<&str> {
        self.file.analysis.notes.iter().map(String::as_str).collect()
    }

    /// Builds the ragdoll of the character.
    #[pyo3(signature = (*, mass=None, height=None, shapes="auto", sex="male", limits="anatomy"))]
    fn build(
        &self,
        py: Python<'_>,
        mass: Option<f32>,
        height: Option<f32>,
        shapes: &str,
        sex: &str,
        limits: &str,
    ) -> PyResult<Ragdoll> {
        let options = BuildOptions {
            mass: None,
            shapes: match shapes {
                "auto" => ShapeChoice::Auto,
                "box" => ShapeChoice::Box,
                "capsule" => ShapeChoice::Capsule,
                other => return Err(bad(format!("shapes are auto, box or capsule, not '{other}'"))),
            },
            sex: match sex {
                "male" => Sex::Male,
                "female" => Sex::Female,
                other => return Err(bad(format!("sex is male or female, not '{other}'"))),
            },
            limits: match limits {
                "anatomy" => LimitSource::Anatomy,
                "clips" => LimitSource::Clips,
                other => return Err(bad(format!("limits are anatomy or clips, not '{other}'"))),
            },
        };
        if height.is_some_and(|height| !(height > 0.0 && height < f32::INFINITY)) {
            return Err(bad("the height must be positive and finite"));
        }
        let wishes = Wishes { mass, height, options };
        let (def, report) = py.detach(|| guarded(|| self.file.build(&wishes)))?.map_err(failed)?;
        Ok(Ragdoll::built(def, report))
    }

    /// Returns the character with its motions, for bakes and worlds.
    #[pyo3(signature = (ragdoll=None, *, clip=None, exact=false, builtin_motions=true, gets_up=true, falling=None))]
    fn character(
        &self,
        py: Python<'_>,
        ragdoll: Option<&Ragdoll>,
        clip: Option<String>,
        exact: bool,
        builtin_motions: bool,
        gets_up: bool,
        falling: Option<&Drive>,
    ) -> PyResult<Character> {
        let motions = Motions {
            looped: clip,
            locomotion: if exact { Locomotion::Exact } else { Locomotion::ByClip },
            builtin: builtin_motions,
            after_settling: if gets_up { AfterSettling::GetUp } else { AfterSettling::StayDown },
            falling: falling.map_or(DriveMode::Limp, |drive| drive.mode),
        };
        let made = py.detach(|| {
            guarded(|| {
                let def = match ragdoll {
                    Some(ragdoll) => ragdoll.repair.def.clone(),
                    None => self.file.build(&Wishes::default())?.0,
                };
                self.file.character(&def, &motions)
            })
        })?;
        Ok(Character { file: self.file.clone(), def: Arc::new(made.map_err(failed)?) })
    }

    /// Returns the file as a GLB that includes the files it refers to; for a character from arrays, the GLB
    /// made of them.
    fn glb<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let written = py.detach(|| append_clips(&self.file.document, &[]));
        Ok(PyBytes::new(py, &written.map_err(|error| of_file(error.with_file(&self.file.name)))?))
    }

    fn __repr__(&self) -> String {
        let (joints, clips) = (self.file.document.rig.joints.len(), self.file.document.clips.len());
        format!("CharacterFile({:?}, {joints} joints, {clips} clips)", self.file.name)
    }
}
