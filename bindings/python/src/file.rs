//! Files of characters.

use crate::bake::Character;
use crate::errors::{bad, failed, guarded};
use crate::ragdoll::Ragdoll;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sinew::ragdoll::{BuildOptions, LimitSource, Sex, ShapeChoice};
use sinew_bindings::Wishes;
use std::path::PathBuf;
use std::sync::Arc;

/// Rigged character as it was read.
#[pyclass(frozen, module = "sinew")]
pub struct CharacterFile {
    pub file: Arc<sinew_bindings::CharacterFile>,
}

/// Reads a GLB, glTF, VRM or FBX with a skinned character, and the settings beside it.
#[pyfunction]
pub fn load(py: Python<'_>, path: PathBuf) -> PyResult<CharacterFile> {
    let file = py.detach(|| guarded(|| sinew_bindings::CharacterFile::load(&path)))?.map_err(failed)?;
    Ok(CharacterFile { file: Arc::new(file) })
}

/// The mannequin that comes with Sinew, 1.75 m, with a walk and two ways to get up.
#[pyfunction]
pub fn mannequin(py: Python<'_>) -> PyResult<CharacterFile> {
    let file = py.detach(|| guarded(sinew_bindings::embedded))?;
    Ok(CharacterFile { file: Arc::new(file) })
}

#[pymethods]
impl CharacterFile {
    /// As it was named.
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

    /// Joint of each role that was found.
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

    /// Assumptions about the file, a sentence each.
    #[getter]
    fn notes(&self) -> Vec<&str> {
        self.file.analysis.notes.iter().map(String::as_str).collect()
    }

    /// Builds its ragdoll.
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
            return Err(bad("a height is positive and finite"));
        }
        let wishes = Wishes { mass, height, options };
        let (def, report) = py.detach(|| guarded(|| self.file.build(&wishes)))?.map_err(failed)?;
        Ok(Ragdoll::built(def, report))
    }

    /// The character with its motions, ready to be baked.
    #[pyo3(signature = (ragdoll=None, *, clip=None))]
    fn character(
        &self,
        py: Python<'_>,
        ragdoll: Option<&Ragdoll>,
        clip: Option<&str>,
    ) -> PyResult<Character> {
        let made = py.detach(|| {
            guarded(|| {
                let def = match ragdoll {
                    Some(ragdoll) => ragdoll.repair.def.clone(),
                    None => self.file.build(&Wishes::default())?.0,
                };
                self.file.character(&def, clip)
            })
        })?;
        Ok(Character { file: self.file.clone(), def: Arc::new(made.map_err(failed)?) })
    }

    fn __repr__(&self) -> String {
        let (joints, clips) = (self.file.document.rig.joints.len(), self.file.document.clips.len());
        format!("CharacterFile({:?}, {joints} joints, {clips} clips)", self.file.name)
    }
}
