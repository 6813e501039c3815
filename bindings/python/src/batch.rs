//! Many worlds with the same ragdoll or model, which are stepped together.

use crate::arrays::{array, elements, floats, poses, push_pose, push_velocity, vectors, velocities};
use crate::errors::{bad, guarded, refused};
use crate::ragdoll::{Model, Ragdoll};
use crate::world::{contact_dict, motor, world_def};
use numpy::{PyArray1, PyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sinew::math::{Transform, Vec3};
use sinew::physics::{
    BodyDef, BodyId, BodyKind, JointId, Shape, Softness, TaskRunner, Threads, Velocity, World, WorldDef,
};
use sinew::ragdoll::{BodySettings, BodyState, RagdollDef};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Worlds with one ragdoll or model each, on a floor. Each world has the same bits as alone, for any number of threads.
#[pyclass(module = "sinew")]
pub struct BatchWorlds {
    worlds: Vec<Mutex<World>>,
    /// Body ids, equal in all worlds because they were created alike.
    bodies: Vec<BodyId>,
    joints: Vec<JointId>,
    names: Vec<String>,
    threads: Threads,
}

/// A ragdoll or model in a world: its moving bodies, their joints, and their names.
type Figure = (Vec<BodyId>, Vec<JointId>, Vec<String>);

fn spawn_ragdoll(world: &mut World, def: &RagdollDef) -> Figure {
    let state = |world_from_body| BodyState { world_from_body, velocity: Velocity::default() };
    let states: Vec<BodyState> = def.bodies.iter().map(|body| state(body.character_from_body)).collect();
    let spawned = sinew::ragdoll::Ragdoll::spawn(world, def, &states, &BodySettings::default());
    let names = def.bodies.iter().map(|body| body.role.clone()).collect();
    (spawned.bodies, spawned.joints, names)
}

fn spawn_model(world: &mut World, model: &Model) -> Figure {
    let spawned = model.model.spawn(world);
    let moving = |id: &BodyId| world.kind(*id) == BodyKind::Dynamic;
    let named = model.model.bodies.iter().zip(&spawned.bodies).filter(|(_, id)| moving(id));
    let (names, bodies) = named.map(|(body, &id)| (body.name.clone(), id)).unzip();
    (bodies, spawned.joints, names)
}

impl BatchWorlds {
    /// Runs `work` on every world, on all threads, without the GIL.
    fn each(&self, py: Python<'_>, work: impl Fn(usize, &mut World) + Sync) -> PyResult<()> {
        let next = AtomicUsize::new(0);
        let task = || {
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let Some(world) = self.worlds.get(index) else { break };
                work(index, &mut world.lock().unwrap_or_else(PoisonError::into_inner));
            }
        };
        py.detach(|| guarded(|| self.threads.run(self.threads.count(), &task)))
    }

    /// Collects `width` numbers of each world, world by world.
    fn gather<T: Copy + Default + Send>(
        &self,
        py: Python<'_>,
        width: usize,
        of: impl Fn(&World, &mut Vec<T>) + Sync,
    ) -> PyResult<Vec<T>> {
        let mut all = vec![T::default(); width * self.worlds.len()];
        if width == 0 {
            return Ok(all);
        }
        let rows: Vec<Mutex<&mut [T]>> = all.chunks_exact_mut(width).map(Mutex::new).collect();
        self.each(py, |index, world| {
            let mut numbers = Vec::with_capacity(width);
            of(world, &mut numbers);
            rows[index].lock().unwrap_or_else(PoisonError::into_inner).copy_from_slice(&numbers);
        })?;
        drop(rows);
        Ok(all)
    }

    /// Returns the indices of the given worlds; all if none are given.
    fn chosen(&self, worlds: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<usize>> {
        let count = self.worlds.len();
        let Some(worlds) = worlds else { return Ok((0..count).collect()) };
        let numbers: Vec<i64> = elements(worlds, &[None], "worlds")?;
        let known = |&number: &i64| usize::try_from(number).ok().filter(|&number| number < count);
        let checked = |number: &i64| {
            known(number).ok_or_else(|| bad(format!("world {number} is out of range: the batch has {count}")))
        };
        numbers.iter().map(checked).collect()
    }
}

#[pymethods]
impl BatchWorlds {
    /// Creates `count` worlds with a ragdoll or a model in each; `threads` 0 uses all threads of the machine.
    #[new]
    #[pyo3(signature = (figure, count, *, floor=true, dt=1.0/60.0, substeps=4, quality="balanced", sleeping=false, threads=0))]
    fn new(
        py: Python<'_>,
        figure: &Bound<'_, PyAny>,
        count: usize,
        floor: bool,
        dt: f64,
        substeps: u32,
        quality: &str,
        sleeping: bool,
        threads: usize,
    ) -> PyResult<Self> {
        let def: WorldDef = world_def(None, dt, substeps, quality, sleeping)?;
        let (ragdoll, model) = (figure.cast::<Ragdoll>().ok(), figure.cast::<Model>().ok());
        let (ragdoll, model) = (ragdoll.map(|it| it.get()), model.map(|it| it.get()));
        if ragdoll.is_none() && model.is_none() {
            return Err(bad("a figure is a Ragdoll or a Model"));
        }
        let make = || {
            let mut world = World::new(def.clone());
            let figure = match (ragdoll, model) {
                (Some(ragdoll), _) => spawn_ragdoll(&mut world, &ragdoll.repair.def),
                (None, Some(model)) => spawn_model(&mut world, model),
                (None, None) => unreachable!("one was given"),
            };
            if floor {
                world.add_body(&BodyDef::fixed(Shape::HalfSpace));
            }
            world.mark();
            (world, figure)
        };
        let count = if count > 0 { count } else { return Err(bad("at least one world is needed")) };
        let cores = std::thread::available_parallelism().map_or(1, core::num::NonZero::get);
        let threads = if threads == 0 { cores } else { threads.min(256) };
        py.detach(|| {
            guarded(|| {
                let (first, (bodies, joints, names)) = make();
                // Ids are stored as bits without a world, because those of one world are valid in all.
                let bodies = bodies.into_iter().map(|id| BodyId::from_bits(id.to_bits())).collect();
                let joints = joints.into_iter().map(|id| JointId::from_bits(id.to_bits())).collect();
                let mut worlds = vec![Mutex::new(first)];
                worlds.extend((1..count).map(|_| Mutex::new(make().0)));
                Self { worlds, bodies, joints, names, threads: Threads::new(threads) }
            })
        })
    }

    fn __len__(&self) -> usize {
        self.worlds.len()
    }

    /// Names of the figure's bodies: roles of a ragdoll, or names of the model.
    #[getter]
    fn bodies(&self) -> Vec<&str> {
        self.names.iter().map(String::as_str).collect()
    }

    /// Number of the figure's joints.
    #[getter]
    fn joint_count(&self) -> usize {
        self.joints.len()
    }

    /// Number of threads.
    #[getter]
    fn threads(&self) -> usize {
        self.threads.count()
    }

    /// Takes steps of all worlds, in parallel and without the GIL.
    #[pyo3(signature = (count=1))]
    fn step(&mut self, py: Python<'_>, count: u32) -> PyResult<()> {
        self.each(py, |_, world| (0..count).for_each(|_| world.step()))
    }

    /// Resets worlds to their initial states; then moves figures to `poses` (m, n, 7) and `velocities` (m, n, 6), if given.
    #[pyo3(signature = (worlds=None, *, poses=None, velocities=None))]
    fn reset(
        &mut self,
        worlds: Option<&Bound<'_, PyAny>>,
        poses: Option<&Bound<'_, PyAny>>,
        velocities: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let chosen = self.chosen(worlds)?;
        let (rows, count) = (Some(chosen.len()), Some(self.bodies.len()));
        let places = poses
            .map(|given| crate::arrays::poses(&floats(given, &[rows, count, Some(7)], "poses")?, "poses"));
        let speeds = velocities.map(|given| floats(given, &[rows, count, Some(6)], "velocities"));
        let (places, speeds) =
            (places.transpose()?, speeds.transpose()?.map(|numbers| self::velocities(&numbers)));
        let count = self.bodies.len();
        guarded(|| {
            for (row, &index) in chosen.iter().enumerate() {
                let world = self.worlds[index].get_mut().unwrap_or_else(PoisonError::into_inner);
                world.reset();
                for (at, &body) in self.bodies.iter().enumerate() {
                    if let Some(places) = &places {
                        world.set_transform(body, places[row * count + at]);
                    }
                    if let Some(speeds) = &speeds {
                        world.set_velocity(body, speeds[row * count + at]);
                    }
                }
            }
        })
    }

    /// Applies an impulse to a body of each world, N·s, (worlds, 3), at its centre of mass.
    fn push(&mut self, body: usize, impulses: &Bound<'_, PyAny>) -> PyResult<()> {
        let impulses = vectors(&floats(impulses, &[Some(self.worlds.len()), Some(3)], "impulses")?);
        let id =
            *self.bodies.get(body).ok_or_else(|| bad(format!("no body {body} of {}", self.bodies.len())))?;
        guarded(|| {
            for (world, &impulse) in self.worlds.iter_mut().zip(&impulses).filter(|(_, i)| **i != Vec3::ZERO)
            {
                world.get_mut().unwrap_or_else(PoisonError::into_inner).apply_impulse_at_center(id, impulse);
            }
        })
    }

    /// Drives all joints toward rotations (worlds, joints, 3), scaled axes, by springs with damping and a largest torque: `stiffness`
    /// N·m/rad, `damping` N·m·s/rad and `max_torques` N·m, per joint. A spring without stiffness and damping applies no torque.
    #[pyo3(signature = (targets, *, stiffness, damping, max_torques))]
    fn drive(
        &mut self,
        py: Python<'_>,
        targets: &Bound<'_, PyAny>,
        stiffness: &Bound<'_, PyAny>,
        damping: &Bound<'_, PyAny>,
        max_torques: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let joints = self.joints.len();
        let shape = [Some(self.worlds.len()), Some(joints), Some(3)];
        let targets = vectors(&floats(targets, &shape, "targets")?);
        let by_joint = |given: &Bound<'_, PyAny>, name: &str| -> PyResult<Vec<f32>> {
            let numbers = floats(given, &[Some(joints)], name)?;
            if numbers.iter().all(|&number| number >= 0.0) {
                Ok(numbers)
            } else {
                Err(bad(format!("{name} is negative")))
            }
        };
        let stiffness = by_joint(stiffness, "stiffness")?;
        let damping = by_joint(damping, "damping")?;
        let torques = by_joint(max_torques, "max_torques")?;
        self.each(py, |index, world| {
            for (at, &joint) in self.joints.iter().enumerate() {
                let softness = Softness::Stiffness { stiffness: stiffness[at], damping: damping[at] };
                let is_driven = stiffness[at] > 0.0 || damping[at] > 0.0;
                let drive = motor(targets[index * joints + at], softness, torques[at]);
                world.set_motor(joint, is_driven.then_some(drive));
            }
        })
    }

    /// Poses of the figures, (worlds, bodies, 7).
    fn poses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let count = self.bodies.len();
        let numbers = self.gather(py, 7 * count, |world, out| {
            self.bodies.iter().for_each(|&body| push_pose(out, &world.transform(body)));
        })?;
        array(py, numbers, &[self.worlds.len(), count, 7])
    }

    /// Velocities of the figures, (worlds, bodies, 6).
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let count = self.bodies.len();
        let numbers = self.gather(py, 6 * count, |world, out| {
            self.bodies.iter().for_each(|&body| push_velocity(out, &world.velocity(body)));
        })?;
        array(py, numbers, &[self.worlds.len(), count, 6])
    }

    /// Rotations of the joints, (worlds, joints, 3), scaled axes, radians.
    fn joint_turns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let count = self.joints.len();
        let numbers = self.gather(py, 3 * count, |world, out| {
            let turn = |joint: JointId| world.joint_transform(joint).rotation.to_scaled_axis().to_array();
            self.joints.iter().for_each(|&joint| out.extend(turn(joint)));
        })?;
        array(py, numbers, &[self.worlds.len(), count, 3])
    }

    /// Largest distance between the anchors of a joint, metres, world by world.
    fn joint_gaps<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let numbers = self.gather(py, 1, |world, out| {
            out.push(self.joints.iter().fold(0.0, |gap, &joint| f32::max(gap, world.joint_gap(joint))));
        })?;
        Ok(PyArray1::from_vec(py, numbers))
    }

    /// Deepest overlap of a contact in the last step, metres, world by world.
    fn depths<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let numbers = self.gather(py, 1, |world, out| {
            let mut depth = 0.0;
            for contact in world.contacts() {
                depth =
                    contact.points().iter().fold(depth, |depth, point| f32::max(depth, -point.separation));
            }
            out.push(depth);
        })?;
        Ok(PyArray1::from_vec(py, numbers))
    }

    /// Hashes of the worlds.
    fn hashes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u64>>> {
        let numbers = self.gather(py, 1, |world, out| out.push(world.hash()))?;
        Ok(PyArray1::from_vec(py, numbers))
    }

    /// Contact points of one world, as in `World`.
    fn contacts<'py>(&self, py: Python<'py>, world: usize) -> PyResult<Bound<'py, PyDict>> {
        let count = self.worlds.len();
        let world = self
            .worlds
            .get(world)
            .ok_or_else(|| bad(format!("world {world} is out of range: the batch has {count}")))?;
        contact_dict(py, &world.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Poses of each figure's initial state moved by a rigid motion, (worlds, 7); for `reset`.
    fn carried<'py>(
        &self,
        py: Python<'py>,
        motions: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let motions = poses(&floats(motions, &[None, Some(7)], "motions")?, "motions")?;
        let at_first = refused(|| {
            let mut world = self.worlds[0].lock().unwrap_or_else(PoisonError::into_inner).clone();
            world.reset();
            self.bodies.iter().map(|&body| world.transform(body)).collect::<Vec<Transform>>()
        })?;
        let mut numbers = Vec::new();
        for motion in &motions {
            at_first.iter().for_each(|&pose| push_pose(&mut numbers, &(*motion * pose)));
        }
        array(py, numbers, &[motions.len(), self.bodies.len(), 7])
    }
}
