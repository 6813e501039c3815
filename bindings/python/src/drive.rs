//! Drives, which move the bodies of a character in addition to gravity and contacts.

use crate::errors::bad;
use pyo3::prelude::*;
use sinew::ragdoll::{BakeDrive, CharacterDef, DriveMode, Muscle, Part, Pin};

/// Drive of a bone, of a bone and its descendants, or of the whole character, from a given time on.
#[pyclass(frozen, module = "sinew")]
pub struct Drive {
    pub mode: DriveMode,
    kind: String,
    #[pyo3(get)]
    pub time: f32,
    #[pyo3(get)]
    pub bone: Option<String>,
    #[pyo3(get)]
    pub below: bool,
    #[pyo3(get)]
    pub half_life: f32,
}

#[pymethods]
impl Drive {
    /// Creates a drive; `mode` is keyed, powered, pinned or limp.
    #[new]
    #[pyo3(signature = (mode, *, time=0.0, bone=None, below=false, half_life=0.1, hertz=5.0, damping_ratio=1.0, strength=1.0, pin_hertz=3.0, pin_force=400.0, pin_torque=100.0))]
    fn new(
        mode: &str,
        time: f32,
        bone: Option<String>,
        below: bool,
        half_life: f32,
        hertz: f32,
        damping_ratio: f32,
        strength: f32,
        pin_hertz: f32,
        pin_force: f32,
        pin_torque: f32,
    ) -> PyResult<Self> {
        let numbers = [half_life, hertz, damping_ratio, strength, pin_hertz, pin_force, pin_torque];
        if numbers.iter().any(|number| !(0.0..f32::INFINITY).contains(number)) || strength > 1.0 {
            return Err(bad("the numbers of a drive must be finite and at least 0, its strength at most 1"));
        }
        if !time.is_finite() {
            return Err(bad(format!("the time of a drive must be finite, not {time}")));
        }
        let muscle = Muscle { hertz, damping_ratio, strength };
        let pin = Pin { hertz: pin_hertz, damping_ratio: 1.0, max_force: pin_force, max_torque: pin_torque };
        let drive = match mode {
            "keyed" => DriveMode::Keyed,
            "powered" => DriveMode::Powered(muscle),
            "pinned" => DriveMode::Pinned(muscle, pin),
            "limp" => DriveMode::Limp,
            other => return Err(bad(format!("a drive is keyed, powered, pinned or limp, not '{other}'"))),
        };
        Ok(Self { mode: drive, kind: mode.to_owned(), time, bone, below, half_life })
    }

    /// Mode: keyed, powered, pinned or limp.
    #[getter]
    fn mode(&self) -> &str {
        &self.kind
    }

    fn __repr__(&self) -> String {
        let bone = self.bone.as_deref().unwrap_or("all");
        format!("Drive({:?}, time={}, bone={bone:?}, below={})", self.kind, self.time, self.below)
    }
}

impl Drive {
    /// Returns the part of the character that the drive moves.
    pub fn part(&self, def: &CharacterDef) -> PyResult<Part<'_>> {
        let Some(bone) = &self.bone else { return Ok(Part::All) };
        body_named(def, bone)?;
        Ok(if self.below { Part::From(bone) } else { Part::Named(bone) })
    }

    /// Converts the drive for a bake.
    pub fn in_bake(&self, def: &CharacterDef) -> PyResult<BakeDrive<'_>> {
        Ok(BakeDrive { time: self.time, part: self.part(def)?, mode: self.mode, half_life: self.half_life })
    }
}

/// Returns the index of the body with a role or joint name.
pub fn body_named(def: &CharacterDef, name: &str) -> PyResult<usize> {
    def.body_named(name).ok_or_else(|| {
        let roles: Vec<&str> = def.ragdoll.bodies.iter().map(|body| body.role.as_str()).collect();
        bad(format!("no body is called '{name}'; there are {}", roles.join(", ")))
    })
}
