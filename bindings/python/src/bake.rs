//! Bakes: the simulated motion of a character as arrays, and as a clip in a file.

use crate::arrays::{affine, array, floats, poses, push_pose, vec3};
use crate::character_settings::edited;
use crate::collider::{Collider, parted, world_of};
use crate::drive::{Drive, body_named};
use crate::errors::{Cancelled, bad, guarded, of_file, refused};
use crate::field::Field;
use crate::ragdoll::quality_dict;
use crate::world::world_def;
use core::ops::ControlFlow;
use numpy::{PyArray1, PyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use sinew::anim::{KeyBound, Rig};
use sinew::formats::{UsdInput, UsdText, append_clip, write_atomic, write_gltf, write_usda};
use sinew::math::{Affine, Transform, Vec3};
use sinew::physics::{FieldDef, FieldKind, Wind, WorldDef};
use sinew::ragdoll::bake::KEY_BOUND;
use sinew::ragdoll::quality::{judge_bake, toppled};
use sinew::ragdoll::{
    BakeHit, BakeInput, BakeReturn, Baked, CharacterDef, CharacterEvent, HitEffect, State, Verdict,
    bake_together,
};
use sinew_bindings::{CharacterFile, FallOptions, random_fall};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// Character with its motions.
#[pyclass(frozen, module = "sinew")]
pub struct Character {
    pub file: Arc<CharacterFile>,
    pub def: Arc<CharacterDef>,
}

/// Result of a bake: poses, events, metrics, and a clip.
#[pyclass(frozen, module = "sinew")]
pub struct Bake {
    file: Arc<CharacterFile>,
    def: Arc<CharacterDef>,
    baked: Baked,
    fps: f32,
    hits: Vec<BakeHit>,
    verdict: Verdict,
    reasons: Vec<String>,
}

/// Character of a bake, with its hits and drives.
#[pyclass(frozen, module = "sinew")]
pub struct Actor {
    file: Arc<CharacterFile>,
    def: Arc<CharacterDef>,
    hits: Vec<BakeHit>,
    flinches: bool,
    limp_at: Option<f32>,
    drives: Vec<Py<Drive>>,
    returns: Option<BakeReturn>,
    place: Transform,
    phase: f32,
    name: String,
    /// True if a limp character that stays upright is pushed over; only in a bake of one character.
    topples: bool,
    /// Velocity that a character's highest point gets when it goes limp at its time, m/s.
    topple_velocity: Vec3,
}

/// Hit of a bake: time in seconds, body by role or joint, impulse in N·s.
type Hit<'py> = (f32, String, Bound<'py, PyAny>);

#[pymethods]
impl Actor {
    /// Creates the actor from Python's arguments.
    #[new]
    #[pyo3(signature = (character, *, hits=None, flinch=false, limp_at=None, drives=None, return_at=None, return_seconds=0.5, topple=None, topple_velocity=None, pose=None, phase=0.0, name="sinew"))]
    fn new(
        character: &Character,
        hits: Option<Vec<Hit<'_>>>,
        flinch: bool,
        limp_at: Option<f32>,
        drives: Option<Vec<Py<Drive>>>,
        return_at: Option<f32>,
        return_seconds: f32,
        topple: Option<bool>,
        topple_velocity: Option<&Bound<'_, PyAny>>,
        pose: Option<&Bound<'_, PyAny>>,
        phase: f32,
        name: &str,
    ) -> PyResult<Self> {
        let hits = hits.unwrap_or_default();
        let hits = hits.iter().map(|hit| character.hit(hit)).collect::<PyResult<Vec<_>>>()?;
        let drives = drives.unwrap_or_default();
        if let Some(wrong) =
            [limp_at, return_at, Some(phase)].into_iter().flatten().find(|time| !time.is_finite())
        {
            return Err(bad(format!("times must be finite, not {wrong}")));
        }
        if !(0.0..f32::INFINITY).contains(&return_seconds) {
            return Err(bad(format!("return_seconds must not be negative, not {return_seconds}")));
        }
        let place = match pose {
            Some(pose) => poses(&floats(pose, &[Some(7)], "pose")?, "pose")?[0],
            None => Transform::IDENTITY,
        };
        let nothing = hits.is_empty() && limp_at.is_none() && drives.is_empty();
        let velocity = topple_velocity.map(|given| vec3(given, "topple_velocity")).transpose()?;
        Ok(Self {
            file: character.file.clone(),
            def: character.def.clone(),
            hits,
            flinches: flinch,
            limp_at: limp_at.or(nothing.then_some(0.5)),
            drives,
            returns: return_at.map(|time| BakeReturn { time, seconds: return_seconds }),
            place,
            phase,
            name: name.to_owned(),
            topples: topple.unwrap_or(nothing && return_at.is_none() && velocity.is_none()),
            topple_velocity: velocity.unwrap_or(Vec3::ZERO),
        })
    }
}

/// World and duration of a bake, from Python's arguments.
struct Stage {
    colliders: Vec<Collider>,
    fields: Vec<FieldDef>,
    world: WorldDef,
    key_bound: KeyBound,
    seconds: f32,
    fps: f32,
}

/// Makes the settings of the world of a bake from Python's arguments.
fn bake_world(
    gravity: Option<&Bound<'_, PyAny>>,
    dt: f64,
    substeps: u32,
    quality: &str,
) -> PyResult<WorldDef> {
    let gravity = gravity.map(|gravity| vec3(gravity, "gravity")).transpose()?;
    world_def(gravity, dt, substeps, quality, true)
}

/// Bakes characters in one world. A character that meets no other has the same bits as alone.
#[pyfunction]
#[pyo3(signature = (actors, *, seconds=10.0, fps=30.0, world=None, wind=None, fields=None, gravity=None, dt=1.0/60.0, substeps=4, quality="balanced", key_error=None, progress=None))]
pub fn bake(
    py: Python<'_>,
    actors: Vec<Py<Actor>>,
    seconds: f32,
    fps: f32,
    world: Option<&Bound<'_, PyAny>>,
    wind: Option<&Bound<'_, PyAny>>,
    fields: Option<Vec<Py<Field>>>,
    gravity: Option<&Bound<'_, PyAny>>,
    dt: f64,
    substeps: u32,
    quality: &str,
    key_error: Option<(f32, f32)>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<Bake>> {
    let settings = bake_world(gravity, dt, substeps, quality)?;
    let stage = Stage::new(seconds, fps, world, wind, fields, settings, key_error)?;
    let actors: Vec<&Actor> = actors.iter().map(|actor| actor.get()).collect();
    stage.bake(py, &actors, progress)
}

impl Stage {
    fn new(
        seconds: f32,
        fps: f32,
        world: Option<&Bound<'_, PyAny>>,
        wind: Option<&Bound<'_, PyAny>>,
        fields: Option<Vec<Py<Field>>>,
        settings: WorldDef,
        key_error: Option<(f32, f32)>,
    ) -> PyResult<Self> {
        check_length(seconds, fps)?;
        let wind = wind.map(|wind| vec3(wind, "wind")).transpose()?;
        let wind = wind.map(|velocity| FieldDef::new(FieldKind::Wind(Wind { velocity, ..Wind::default() })));
        let others = fields.unwrap_or_default();
        let fields = wind.into_iter().chain(others.iter().map(|field| field.get().def.clone())).collect();
        let key_bound = match key_error {
            None => KEY_BOUND,
            Some((distance, angle)) if distance >= 0.0 && angle >= 0.0 => KeyBound { distance, angle },
            Some(wrong) => return Err(bad(format!("key_error must not be negative, not {wrong:?}"))),
        };
        Ok(Self { colliders: world_of(world)?, fields, world: settings, key_bound, seconds, fps })
    }

    fn bake(&self, py: Python<'_>, actors: &[&Actor], progress: Option<Py<PyAny>>) -> PyResult<Vec<Bake>> {
        let (bodies, movers) = parted(&self.colliders);
        let drives = actors.iter().map(|actor| {
            actor.drives.iter().map(|drive| drive.get().in_bake(&actor.def)).collect::<PyResult<Vec<_>>>()
        });
        let drives = drives.collect::<PyResult<Vec<_>>>()?;
        let inputs = actors.iter().zip(&drives).enumerate().map(|(index, (actor, drives))| {
            let of_stage = index == 0;
            BakeInput {
                world_from_character: actor.place,
                phase: actor.phase,
                world: self.world.clone(),
                bodies: if of_stage { &bodies } else { &[] },
                movers: if of_stage { &movers } else { &[] },
                fields: if of_stage { &self.fields } else { &[] },
                drives,
                returns: actor.returns,
                hits: &actor.hits,
                hit_effect: if actor.flinches { HitEffect::FlinchesOrFalls } else { HitEffect::Falls },
                limp_at: actor.limp_at,
                seconds: self.seconds,
                fps: self.fps,
                key_bound: self.key_bound,
                topple: actor.topple_velocity,
                name: &actor.name,
                ..BakeInput::new(actor.def.clone())
            }
        });
        let inputs: Vec<BakeInput<'_>> = inputs.collect();
        let mut watch = Watch { progress, seconds: self.seconds, told: Instant::now(), error: None };
        let baked = py.detach(|| refused(|| bake_together(&inputs, &mut |time| watch.see(time))))?;
        let Some(mut baked) = baked else {
            return Err(watch.error.unwrap_or_else(|| Cancelled::new_err("the bake was cancelled")));
        };
        if let ([actor], [input]) = (actors, &inputs[..])
            && actor.topples
            && let Some(pushed) = py.detach(|| refused(|| toppled(input, &baked[0])))?
        {
            baked = vec![py.detach(|| refused(|| sinew::ragdoll::bake(&pushed)))?];
        }
        let made = |(actor, baked): (&&Actor, Baked)| {
            let (verdict, reasons) = judge_bake(&baked.quality);
            let (file, def, hits) = (actor.file.clone(), actor.def.clone(), actor.hits.clone());
            Bake { file, def, baked, fps: self.fps, hits, verdict, reasons }
        };
        Ok(actors.iter().zip(baked).map(made).collect())
    }
}

/// Shortest time between two calls of the user's function, seconds of wall time.
const REPORT_INTERVAL: f32 = 0.05;

/// Reports a bake's progress to Python, and checks whether to continue.
struct Watch {
    progress: Option<Py<PyAny>>,
    seconds: f32,
    told: Instant,
    error: Option<PyErr>,
}

impl Watch {
    fn see(&mut self, time: f32) -> ControlFlow<()> {
        if self.told.elapsed().as_secs_f32() < REPORT_INTERVAL {
            return ControlFlow::Continue(());
        }
        let share = if self.seconds > 0.0 { (time / self.seconds).min(1.0) } else { 1.0 };
        let goes_on = Python::attach(|py| {
            py.check_signals()?;
            match &self.progress {
                Some(progress) => {
                    let answer = progress.call1(py, (share,))?;
                    Ok(answer.is_none(py) || answer.is_truthy(py)?)
                }
                None => Ok(true),
            }
        });
        self.told = Instant::now();
        match goes_on {
            Ok(true) => ControlFlow::Continue(()),
            Ok(false) => ControlFlow::Break(()),
            Err(error) => {
                self.error = Some(error);
                ControlFlow::Break(())
            }
        }
    }
}

#[pymethods]
impl Character {
    /// Roles of the character's bodies.
    #[getter]
    fn roles(&self) -> Vec<&str> {
        self.def.ragdoll.bodies.iter().map(|body| body.role.as_str()).collect()
    }

    /// Names of the joints, in the order of arrays of poses.
    #[getter]
    fn joints(&self) -> Vec<&str> {
        self.def.rig.joints.iter().map(|joint| joint.name.as_str()).collect()
    }

    /// Pose at which the character stands as in its file, (7,): the file's positions times its unit are then
    /// world positions.
    #[getter]
    fn place_in_file<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        let mut numbers = Vec::new();
        push_pose(&mut numbers, &self.def.mapping().character_from_model().to_rigid().inverse());
        PyArray1::from_vec(py, numbers)
    }

    /// Height by which the looped clip is raised onto its floor, metres.
    #[getter]
    fn raised(&self) -> f32 {
        self.def.raised()
    }

    /// Simulates the character: walking, hit, falling, getting up. Without any action, it goes limp after half a
    /// second.
    #[pyo3(signature = (*, seconds=10.0, fps=30.0, hits=None, flinch=false, limp_at=None, drives=None, return_at=None, return_seconds=0.5, topple=None, topple_velocity=None, world=None, wind=None, fields=None, gravity=None, dt=1.0/60.0, substeps=4, quality="balanced", key_error=None, pose=None, phase=0.0, name="sinew", progress=None))]
    fn bake(
        slf: PyRef<'_, Self>,
        py: Python<'_>,
        seconds: f32,
        fps: f32,
        hits: Option<Vec<Hit<'_>>>,
        flinch: bool,
        limp_at: Option<f32>,
        drives: Option<Vec<Py<Drive>>>,
        return_at: Option<f32>,
        return_seconds: f32,
        topple: Option<bool>,
        topple_velocity: Option<&Bound<'_, PyAny>>,
        world: Option<&Bound<'_, PyAny>>,
        wind: Option<&Bound<'_, PyAny>>,
        fields: Option<Vec<Py<Field>>>,
        gravity: Option<&Bound<'_, PyAny>>,
        dt: f64,
        substeps: u32,
        quality: &str,
        key_error: Option<(f32, f32)>,
        pose: Option<&Bound<'_, PyAny>>,
        phase: f32,
        name: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bake> {
        let actor = Actor::new(
            &slf,
            hits,
            flinch,
            limp_at,
            drives,
            return_at,
            return_seconds,
            topple,
            topple_velocity,
            pose,
            phase,
            name,
        )?;
        let settings = bake_world(gravity, dt, substeps, quality)?;
        let stage = Stage::new(seconds, fps, world, wind, fields, settings, key_error)?;
        let mut baked = stage.bake(py, &[&actor], progress)?;
        Ok(baked.pop().expect("one for each"))
    }

    /// Returns a copy with other settings of falls, hits, getting up and motions.
    #[pyo3(signature = (**settings))]
    fn edited(&self, settings: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let def = Arc::new(edited(&self.def, settings)?);
        Ok(Self { file: self.file.clone(), def })
    }

    /// Returns a copy scaled by a factor: a child, a giant. A bake of it has no clip for the file.
    fn scaled(&self, factor: f32) -> PyResult<Self> {
        let def = Arc::new(refused(|| self.def.scaled(factor))?);
        Ok(Self { file: self.file.clone(), def })
    }

    /// Radius of a mover that keeps all bodies on its side of a wall while the looped clip plays, metres.
    #[getter]
    fn swept_radius(&self) -> f32 {
        self.def.swept_radius()
    }

    /// Names of the clips: the file's own, and Sinew's get-ups.
    #[getter]
    fn clips(&self) -> Vec<&str> {
        self.def.motions().clips.iter().map(|clip| clip.name.as_str()).collect()
    }

    /// Simulates a random fall: pose within the limits, ground and hit from the seed; the same bits on every
    /// machine.
    #[pyo3(signature = (seed, *, seconds=3.0, fps=30.0, impulse=120.0))]
    fn random_fall(&self, py: Python<'_>, seed: u64, seconds: f32, fps: f32, impulse: f32) -> PyResult<Bake> {
        check_length(seconds, fps)?;
        if !(0.0..f32::INFINITY).contains(&impulse) {
            return Err(bad("the impulse must be finite and at least 0"));
        }
        let options = FallOptions { seconds, fps, impulse };
        let fall = py.detach(|| guarded(|| random_fall(&self.def, seed, &options)))?;
        let (file, def) = (self.file.clone(), self.def.clone());
        Ok(Bake {
            file,
            def,
            baked: fall.baked,
            fps,
            hits: vec![fall.hit],
            verdict: fall.verdict,
            reasons: fall.reasons,
        })
    }
}

impl Character {
    fn hit(&self, (time, name, impulse): &Hit<'_>) -> PyResult<BakeHit> {
        let body = body_named(&self.def, name)?;
        if !time.is_finite() {
            return Err(bad(format!("the time of a hit must be finite, not {time}")));
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

pub fn state_name(state: State) -> &'static str {
    match state {
        State::Animated => "animated",
        State::Limp => "limp",
        State::Preparing => "preparing",
        State::GettingUp => "getting up",
        State::Flinching => "flinching",
        State::Powered => "powered",
    }
}

/// Converts `WentLimp` to `went_limp`.
pub fn event_name(event: &CharacterEvent) -> String {
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

    /// Positions of all joints relative to their parents, (frames, joints, 3), units of the file.
    #[getter]
    fn translations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let joints = self.baked.frames.iter().flat_map(|frame| &frame.pose);
        array(py, joints.flat_map(|joint| joint.translation.to_array()).collect(), &self.shape(3))
    }

    /// Rotations of all joints relative to their parents, (frames, joints, 4), x y z w.
    #[getter]
    fn rotations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let joints = self.baked.frames.iter().flat_map(|frame| &frame.pose);
        let rotations = joints.flat_map(|joint| {
            let q = joint.rotation;
            [q.x, q.y, q.z, q.w]
        });
        array(py, rotations.collect(), &self.shape(4))
    }

    /// Positions of all joints in the world, (frames, joints, 3), metres.
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

    /// Index of each joint's parent, -1 for roots.
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

    /// Metrics, with the names in docs/contract.md.
    #[getter]
    fn quality<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        quality_dict(py, &self.baked.quality)
    }

    /// Verdict: good, usable or bad.
    #[getter]
    fn verdict(&self) -> &'static str {
        self.verdict.name()
    }

    /// Reasons for the verdict, one sentence each.
    #[getter]
    fn reasons(&self) -> Vec<&str> {
        self.reasons.iter().map(String::as_str).collect()
    }

    /// Number of simulated steps.
    #[getter]
    fn steps(&self) -> u64 {
        self.baked.steps
    }

    /// Number of bodies of the ragdoll.
    #[getter]
    fn bodies(&self) -> usize {
        self.baked.bodies
    }

    /// Largest error of the clip's keys against the frames: metres and radians.
    #[getter]
    fn key_error(&self) -> (f32, f32) {
        (self.baked.key_error.distance, self.baked.key_error.angle)
    }

    /// Number of keys before and after the reduction.
    #[getter]
    fn keys(&self) -> (usize, usize) {
        self.baked.keys.into()
    }

    /// Matrix from the file's model space to the world, (3, 4).
    #[getter]
    fn world_from_model<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        affine(py, &self.baked.world_from_model)
    }

    /// Hash of the final state.
    #[getter]
    fn hash(&self) -> u64 {
        self.baked.hash
    }

    /// The file with the clip; if `mesh` is false, only the bones and the clip.
    #[pyo3(signature = (*, mesh=true))]
    fn glb<'py>(&self, py: Python<'py>, mesh: bool) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &py.detach(|| self.bytes(mesh))?))
    }

    /// The character, its motion and its ragdoll as USD text (.usda), and notes on losses, one sentence each.
    #[pyo3(signature = (*, physics=true))]
    fn usda(&self, py: Python<'_>, physics: bool) -> PyResult<(String, Vec<String>)> {
        let input = UsdInput {
            rig: &self.def.rig,
            clip: &self.baked.clip,
            fps: self.fps,
            world_from_model: self.baked.world_from_model,
            ragdoll: physics.then_some(&self.def.ragdoll),
        };
        let UsdText { text, notes } = py.detach(|| guarded(|| write_usda(&input)))?;
        Ok((text, notes))
    }

    /// Writes the file of `glb` atomically.
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
        let clip = self.baked.clip_for_file(&self.def);
        let written = if mesh {
            append_clip(&self.file.document, &clip, &clip.name, None)
        } else {
            let bones = Rig { meshes: Vec::new(), skins: Vec::new(), ..self.def.rig.clone() };
            write_gltf(&bones, std::slice::from_ref(&clip))
        };
        written.map_err(|error| of_file(error.with_file(&self.file.name)))
    }
}
