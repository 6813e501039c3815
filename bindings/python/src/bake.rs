//! Bakes: a stretch of a character's life as arrays, and as a clip in a file.

use crate::arrays::{array, floats, poses, vec3};
use crate::errors::{bad, guarded, of_file, refused};
use crate::ragdoll::quality_dict;
use numpy::{PyArray1, PyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use sinew::anim::Rig;
use sinew::formats::{append_clip, load_world, write_atomic, write_gltf};
use sinew::math::Affine;
use sinew::physics::{BodyDef, Shape};
use sinew::ragdoll::quality::judge_bake;
use sinew::ragdoll::{BakeHit, BakeInput, Baked, CharacterDef, CharacterEvent, State, Verdict, bake};
use sinew_bindings::{CharacterFile, FallOptions, random_fall};
use std::path::PathBuf;
use std::sync::Arc;

/// Character with its motions.
#[pyclass(frozen, module = "sinew")]
pub struct Character {
    pub file: Arc<CharacterFile>,
    pub def: Arc<CharacterDef>,
}

/// Outcome of a bake: poses, events, figures, and a clip.
#[pyclass(frozen, module = "sinew")]
pub struct Bake {
    file: Arc<CharacterFile>,
    def: Arc<CharacterDef>,
    baked: Baked,
    hits: Vec<BakeHit>,
    verdict: Verdict,
    reasons: Vec<String>,
}

/// Hit of a bake: time in seconds, body by role or joint, impulse in N·s.
type Hit<'py> = (f32, String, Bound<'py, PyAny>);

#[pymethods]
impl Character {
    /// Roles of its bodies.
    #[getter]
    fn roles(&self) -> Vec<&str> {
        self.def.ragdoll.bodies.iter().map(|body| body.role.as_str()).collect()
    }

    /// Simulates it: walking, hit, falling, getting up. Without a hit it goes limp after half a second.
    #[pyo3(signature = (*, seconds=10.0, fps=30.0, hits=None, limp_at=None, world=None, pose=None, phase=0.0, name="sinew"))]
    fn bake(
        &self,
        py: Python<'_>,
        seconds: f32,
        fps: f32,
        hits: Option<Vec<Hit<'_>>>,
        limp_at: Option<f32>,
        world: Option<PathBuf>,
        pose: Option<&Bound<'_, PyAny>>,
        phase: f32,
        name: &str,
    ) -> PyResult<Bake> {
        check_length(seconds, fps)?;
        let hits = hits.unwrap_or_default();
        let hits = hits.iter().map(|hit| self.hit(hit)).collect::<PyResult<Vec<_>>>()?;
        let bodies = match world {
            None => vec![BodyDef::fixed(Shape::HalfSpace)],
            Some(path) => load_world(&path).map_err(of_file)?,
        };
        let mut input = BakeInput {
            bodies: &bodies,
            hits: &hits,
            limp_at: limp_at.or(if hits.is_empty() { Some(0.5) } else { None }),
            seconds,
            fps,
            phase,
            name,
            ..BakeInput::new(self.def.clone())
        };
        if let Some(pose) = pose {
            input.world_from_character = poses(&floats(pose, &[Some(7)], "pose")?, "pose")?[0];
        }
        let baked = py.detach(|| refused(|| bake(&input)))?;
        let (verdict, reasons) = judge_bake(&baked.quality);
        Ok(Bake { file: self.file.clone(), def: self.def.clone(), baked, hits, verdict, reasons })
    }

    /// A random fall: pose within the limits, ground and hit by the seed; the same bits on every machine.
    #[pyo3(signature = (seed, *, seconds=3.0, fps=30.0, impulse=120.0))]
    fn random_fall(&self, py: Python<'_>, seed: u64, seconds: f32, fps: f32, impulse: f32) -> PyResult<Bake> {
        check_length(seconds, fps)?;
        if !(0.0..f32::INFINITY).contains(&impulse) {
            return Err(bad("an impulse is not negative, and finite"));
        }
        let options = FallOptions { seconds, fps, impulse };
        let fall = py.detach(|| guarded(|| random_fall(&self.def, seed, &options)))?;
        let (file, def) = (self.file.clone(), self.def.clone());
        Ok(Bake {
            file,
            def,
            baked: fall.baked,
            hits: vec![fall.hit],
            verdict: fall.verdict,
            reasons: fall.reasons,
        })
    }
}

impl Character {
    fn hit(&self, (time, name, impulse): &Hit<'_>) -> PyResult<BakeHit> {
        let body = self.def.body_named(name).ok_or_else(|| {
            let roles: Vec<&str> = self.def.ragdoll.bodies.iter().map(|body| body.role.as_str()).collect();
            bad(format!("no body is called '{name}'; there are {}", roles.join(", ")))
        })?;
        if !time.is_finite() {
            return Err(bad(format!("the time of a hit is finite, not {time}")));
        }
        Ok(BakeHit { time: *time, body, impulse: vec3(impulse, "the impulse of a hit")? })
    }
}

fn check_length(seconds: f32, fps: f32) -> PyResult<()> {
    if !(0.0..=3600.0).contains(&seconds) || !(1.0..=1000.0).contains(&fps) {
        return Err(bad(format!(
            "0 to 3,600 seconds and 1 to 1,000 frames a second, not {seconds} and {fps}"
        )));
    }
    Ok(())
}

fn state_name(state: State) -> &'static str {
    match state {
        State::Animated => "animated",
        State::Limp => "limp",
        State::Preparing => "preparing",
        State::GettingUp => "getting up",
        State::Flinching => "flinching",
        State::Powered => "powered",
    }
}

/// `WentLimp` becomes `went_limp`.
fn event_name(event: &CharacterEvent) -> String {
    let text = format!("{event:?}");
    let mut name = String::new();
    for (at, c) in text.chars().take_while(|c| c.is_alphanumeric()).enumerate() {
        if c.is_uppercase() && at > 0 {
            name.push('_');
        }
        name.extend(c.to_lowercase());
    }
    name
}

#[pymethods]
impl Bake {
    /// Times of frames, seconds.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_vec(py, self.baked.frames.iter().map(|frame| frame.time).collect())
    }

    /// State at each frame.
    #[getter]
    fn states(&self) -> Vec<&'static str> {
        self.baked.frames.iter().map(|frame| state_name(frame.state)).collect()
    }

    /// Places of all joints in their parents, (frames, joints, 3), units of the file.
    #[getter]
    fn translations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let joints = self.baked.frames.iter().flat_map(|frame| &frame.pose);
        array(py, joints.flat_map(|joint| joint.translation.to_array()).collect(), &self.shape(3))
    }

    /// Rotations of all joints in their parents, (frames, joints, 4), x y z w.
    #[getter]
    fn rotations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let joints = self.baked.frames.iter().flat_map(|frame| &frame.pose);
        let rotations = joints.flat_map(|joint| {
            let q = joint.rotation;
            [q.x, q.y, q.z, q.w]
        });
        array(py, rotations.collect(), &self.shape(4))
    }

    /// Places of all joints in the world, (frames, joints, 3), metres.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let mut model: Vec<Affine> = Vec::new();
        let mut numbers = Vec::new();
        for frame in &self.baked.frames {
            sinew::anim::local_to_model(&self.def.rig, &frame.pose, &self.baked.world_from_model, &mut model);
            numbers.extend(model.iter().flat_map(|joint| joint.translation.to_array()));
        }
        array(py, numbers, &self.shape(3))
    }

    /// Joint above each, -1 for roots.
    #[getter]
    fn parents<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let joints = self.def.rig.joints.iter();
        PyArray1::from_vec(py, joints.map(|joint| joint.parent.map_or(-1, |parent| parent as i64)).collect())
    }

    /// Events, each with its time in seconds.
    #[getter]
    fn events(&self) -> Vec<(f32, String)> {
        self.baked.events.iter().map(|(time, event)| (*time, event_name(event))).collect()
    }

    /// Hits: time in seconds, role of the body, impulse in N·s.
    #[getter]
    fn hits(&self) -> Vec<(f32, &str, [f32; 3])> {
        let role = |body: usize| self.def.ragdoll.bodies[body].role.as_str();
        self.hits.iter().map(|hit| (hit.time, role(hit.body), hit.impulse.to_array())).collect()
    }

    /// Figures, by the names of docs/contract.md.
    #[getter]
    fn quality<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        quality_dict(py, &self.baked.quality)
    }

    /// Verdict: good, usable or bad.
    #[getter]
    fn verdict(&self) -> &'static str {
        self.verdict.name()
    }

    /// Reasons for it, a sentence each.
    #[getter]
    fn reasons(&self) -> Vec<&str> {
        self.reasons.iter().map(String::as_str).collect()
    }

    /// Hash of the state at the end.
    #[getter]
    fn hash(&self) -> u64 {
        self.baked.hash
    }

    /// The file with the clip in it, or the bones alone with the clip if there is to be no mesh.
    #[pyo3(signature = (*, mesh=true))]
    fn glb<'py>(&self, py: Python<'py>, mesh: bool) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &py.detach(|| self.bytes(mesh))?))
    }

    /// Writes that file, whole or not at all.
    #[pyo3(signature = (path, *, mesh=true))]
    fn save(&self, py: Python<'_>, path: PathBuf, mesh: bool) -> PyResult<()> {
        py.detach(|| write_atomic(&path, &self.bytes(mesh)?).map_err(of_file))
    }
}

impl Bake {
    fn shape(&self, width: usize) -> [usize; 3] {
        [self.baked.frames.len(), self.def.rig.joints.len(), width]
    }

    fn bytes(&self, mesh: bool) -> PyResult<Vec<u8>> {
        let clip = &self.baked.clip;
        let written = if mesh {
            append_clip(&self.file.document, clip, &clip.name, None)
        } else {
            let bones = Rig { meshes: Vec::new(), skins: Vec::new(), ..self.def.rig.clone() };
            write_gltf(&bones, std::slice::from_ref(clip))
        };
        written.map_err(|error| of_file(error.with_file(&self.file.name)))
    }
}
