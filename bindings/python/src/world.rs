//! One world, with arrays in and out.

use crate::arrays::{array, elements, floats, poses, push_pose, push_velocity, vec3, vectors, velocities};
use crate::bake::Character;
use crate::collider::{Collider, parted};
use crate::errors::{SinewError, bad, guarded, refused};
use crate::field::{Field, fade_named};
use crate::live::{LiveCharacter, one_pose};
use crate::mover::Mover;
use crate::particles::{LiveParticles, Particles};
use crate::ragdoll::Ragdoll;
use numpy::{PyArray1, PyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use sinew::math::hash::hash_bytes;
use sinew::math::{Range, Reader, Rotation, Transform, Vec3, Writer};
use sinew::physics::ray::Ray;
use sinew::physics::stage::NoProfiler;
use sinew::physics::{
    BodyDef, BodyHit, BodyId, BodyKind, Explosion, FieldId, JointDef, JointId, JointKind, Material, Motor,
    MoverDef, Occlusion, OverlapWith, Probe, Quality, Shape, ShapeDef, Sleeping, Softness, Threads, Velocity,
    Wind, WorldDef,
};
use sinew::ragdoll::BodyState;

/// World of bodies and joints. Metres, kilograms, seconds, radians; +Y is up.
#[pyclass(module = "sinew")]
pub struct World {
    pub world: sinew::physics::World,
    /// Characters that are updated with the world; `None`: removed.
    pub characters: Vec<Option<sinew::ragdoll::Character>>,
    threads: Threads,
    /// Keyframed bodies.
    keyed: Vec<(BodyId, Collider)>,
}

/// Ids of bodies or joints.
type Ids<'py> = Bound<'py, PyArray1<u64>>;

/// Body id of a ray without a hit.
const NO_BODY: u64 = u64::MAX;

/// Makes the settings of a world from Python's arguments.
pub fn world_def(
    gravity: Option<Vec3>,
    dt: f64,
    substeps: u32,
    quality: &str,
    sleeping: bool,
) -> PyResult<WorldDef> {
    if !(1e-9..1e9).contains(&dt) {
        return Err(bad(format!("dt must be positive and finite, not {dt} s")));
    }
    let default = WorldDef::default();
    let def = WorldDef {
        gravity: gravity.unwrap_or(default.gravity),
        step_nanoseconds: (dt * 1e9).round() as u64,
        substeps,
        quality: match quality {
            "fast" => Quality::Fast,
            "balanced" => Quality::Balanced,
            "exact" => Quality::Exact,
            other => return Err(bad(format!("quality is fast, balanced or exact, not '{other}'"))),
        },
        sleeping: if sleeping { Sleeping::On } else { Sleeping::Off },
        ..default
    };
    def.check().map_err(|what| bad(what.to_string()))?;
    Ok(def)
}

/// Makes a shape from its name and sizes, in metres.
pub fn shape(kind: &str, size: &[f32]) -> PyResult<Shape> {
    let shape = match (kind, size) {
        ("box", &[x, y, z]) => Shape::Box { half_extents: Vec3::new(x, y, z) },
        ("sphere", &[radius]) => Shape::Sphere { radius },
        ("capsule", &[radius, half_height]) => Shape::Capsule { half_height, radius },
        ("cylinder", &[radius, half_height]) => Shape::Cylinder { half_height, radius },
        ("cone", &[radius, half_height]) => Shape::Cone { half_height, radius },
        ("half_space", &[]) => Shape::HalfSpace,
        _ => {
            let known = "box (x, y, z), sphere (radius), capsule, cylinder, cone (radius, half height), half_space ()";
            return Err(bad(format!("no shape '{kind}' of {} sizes; there are {known}", size.len())));
        }
    };
    shape.check().map_err(|what| bad(what.to_string()))?;
    Ok(shape)
}

/// Returns contact points as arrays.
pub fn contact_dict<'py>(py: Python<'py>, world: &sinew::physics::World) -> PyResult<Bound<'py, PyDict>> {
    let (mut a, mut b) = (Vec::new(), Vec::new());
    let (mut positions, mut normals, mut separations, mut impulses) = (vec![], vec![], vec![], vec![]);
    for contact in world.contacts() {
        for point in contact.points() {
            a.push(contact.a.body.to_bits());
            b.push(contact.b.body.to_bits());
            positions.extend(point.position.to_array());
            normals.extend(contact.normal.to_array());
            separations.push(point.separation);
            impulses.push(point.impulse);
        }
    }
    let count = a.len();
    let dict = PyDict::new(py);
    dict.set_item("a", PyArray1::from_vec(py, a))?;
    dict.set_item("b", PyArray1::from_vec(py, b))?;
    dict.set_item("position", array(py, positions, &[count, 3])?)?;
    dict.set_item("normal", array(py, normals, &[count, 3])?)?;
    dict.set_item("separation", PyArray1::from_vec(py, separations))?;
    dict.set_item("impulse", PyArray1::from_vec(py, impulses))?;
    Ok(dict)
}

impl World {
    pub fn body(&self, bits: u64) -> PyResult<BodyId> {
        let id = BodyId::from_bits(bits);
        if self.world.contains(id) { Ok(id) } else { Err(bad(format!("there is no body {bits:#x}"))) }
    }

    fn joint(&self, bits: u64) -> PyResult<JointId> {
        let id = JointId::from_bits(bits);
        if self.world.contains_joint(id) { Ok(id) } else { Err(bad(format!("there is no joint {bits:#x}"))) }
    }

    /// Returns the bodies with these ids; all bodies if none are given.
    fn bodies(&self, ids: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<BodyId>> {
        match ids {
            None => Ok(self.world.body_ids().collect()),
            Some(ids) => {
                let ids: Vec<u64> = elements(ids, &[None], "bodies")?;
                ids.into_iter().map(|bits| self.body(bits)).collect()
            }
        }
    }

    /// Returns the state of the world, followed by the states of its characters.
    fn state(&self) -> Writer {
        let mut w = Writer::new();
        self.world.save(&mut w);
        self.characters.iter().flatten().for_each(|character| character.save(&mut w));
        w
    }

    fn bits<'py>(py: Python<'py>, ids: &[BodyId]) -> Ids<'py> {
        PyArray1::from_vec(py, ids.iter().map(|id| id.to_bits()).collect())
    }
}

#[pymethods]
impl World {
    /// Creates a world; `threads` affects the duration of a step, not its result.
    #[new]
    #[pyo3(signature = (*, gravity=None, dt=1.0/60.0, substeps=4, quality="balanced", sleeping=true, threads=1))]
    fn new(
        gravity: Option<&Bound<'_, PyAny>>,
        dt: f64,
        substeps: u32,
        quality: &str,
        sleeping: bool,
        threads: usize,
    ) -> PyResult<Self> {
        let gravity = gravity.map(|gravity| vec3(gravity, "gravity")).transpose()?;
        let def = world_def(gravity, dt, substeps, quality, sleeping)?;
        let world = sinew::physics::World::new(def);
        let threads = Threads::new(threads.clamp(1, 256));
        Ok(Self { world, characters: Vec::new(), threads, keyed: Vec::new() })
    }

    /// Adds a body with one shape and returns its id.
    #[pyo3(signature = (kind, size, *, pose=None, velocity=None, body="dynamic", density=1000.0, friction=0.6, restitution=0.0))]
    fn add_body(
        &mut self,
        kind: &str,
        size: Vec<f32>,
        pose: Option<&Bound<'_, PyAny>>,
        velocity: Option<&Bound<'_, PyAny>>,
        body: &str,
        density: f32,
        friction: f32,
        restitution: f32,
    ) -> PyResult<u64> {
        let material = Material { friction, restitution, ..Material::DEFAULT };
        let mut def = BodyDef {
            kind: match body {
                "dynamic" => BodyKind::Dynamic,
                "static" => BodyKind::Static,
                "kinematic" => BodyKind::Kinematic,
                other => return Err(bad(format!("a body is dynamic, static or kinematic, not '{other}'"))),
            },
            shapes: vec![ShapeDef { density, material, ..ShapeDef::new(shape(kind, &size)?) }],
            ..BodyDef::default()
        };
        if let Some(pose) = pose {
            let pose = poses(&floats(pose, &[Some(7)], "pose")?, "pose")?[0];
            (def.position, def.rotation) = (pose.translation, pose.rotation);
        }
        if let Some(velocity) = velocity {
            let velocity = velocities(&floats(velocity, &[Some(6)], "velocity")?)[0];
            (def.linear_velocity, def.angular_velocity) = (velocity.linear, velocity.angular);
        }
        Ok(refused(|| self.world.add_body(&def))?.to_bits())
    }

    /// Adds a static plane, y = height, solid below; returns its id.
    #[pyo3(signature = (height=0.0))]
    fn add_floor(&mut self, height: f32) -> PyResult<u64> {
        let def = BodyDef::fixed(Shape::HalfSpace).at(Vec3::Y * height);
        Ok(refused(|| self.world.add_body(&def))?.to_bits())
    }

    /// Adds a collider and returns its id; a keyframed one follows its keys from the world's time 0 on.
    fn add_collider(&mut self, collider: &Collider) -> PyResult<u64> {
        let id = match parted(std::slice::from_ref(collider)).1.first() {
            Some(mover) => refused(|| mover.enter(&mut self.world))?,
            None => refused(|| self.world.add_body(&collider.def))?,
        };
        if collider.keys.is_some() {
            self.keyed.push((id, collider.clone()));
        }
        Ok(id.to_bits())
    }

    /// Adds a field and returns its id.
    fn add_field(&mut self, field: PyRef<'_, Field>) -> PyResult<u64> {
        Ok(refused(|| self.world.add_field(&field.def))?.to_bits())
    }

    /// Adds wind, m/s, and returns its id; gusts with a speed (m/s), a length (m) and a time (s) may be added.
    #[pyo3(signature = (velocity, *, gust_speed=0.0, gust_length=3.0, gust_time=1.0, seed=0))]
    fn add_wind(
        &mut self,
        velocity: &Bound<'_, PyAny>,
        gust_speed: f32,
        gust_length: f32,
        gust_time: f32,
        seed: u64,
    ) -> PyResult<u64> {
        let usual = Wind::default();
        let (density, drag, lift) = (usual.density, usual.drag, usual.lift);
        let wind = Field::wind(velocity, density, drag, lift, gust_speed, gust_length, gust_time, seed)?;
        Ok(refused(|| self.world.add_field(&wind.def))?.to_bits())
    }

    /// Explodes at a point: everything within the radius, metres, gets an impulse per area, N·s/m² at the centre.
    #[pyo3(signature = (center, radius, impulse, *, fade="linear", sheltered=false))]
    fn explode(
        &mut self,
        center: &Bound<'_, PyAny>,
        radius: f32,
        impulse: f32,
        fade: &str,
        sheltered: bool,
    ) -> PyResult<()> {
        let occlusion = if sheltered { Occlusion::Static } else { Occlusion::None };
        let fade = fade_named(fade)?;
        let blast = Explosion { fade, occlusion, ..Explosion::new(vec3(center, "center")?, radius, impulse) };
        blast.check().map_err(|what| bad(what.to_string()))?;
        refused(|| self.world.explode(&blast))
    }

    /// Adds particles: a rope, cloth or a soft ball.
    fn add_particles(slf: &Bound<'_, Self>, particles: PyRef<'_, Particles>) -> PyResult<LiveParticles> {
        let mut world = slf.borrow_mut();
        let def = particles.in_world(&world)?;
        let group = refused(|| world.world.add_particles(&def))?;
        Ok(LiveParticles { world: slf.clone().unbind(), group, triangles: particles.triangles().to_vec() })
    }

    /// Adds a mover: an upright capsule, given by its lowest point, that walks, climbs steps and jumps.
    #[pyo3(signature = (position, *, radius=0.3, height=1.8, mass=80.0, push_force=800.0, step_height=0.35))]
    fn add_mover(
        slf: &Bound<'_, Self>,
        position: &Bound<'_, PyAny>,
        radius: f32,
        height: f32,
        mass: f32,
        push_force: f32,
        step_height: f32,
    ) -> PyResult<Mover> {
        let position = vec3(position, "position")?;
        let def = MoverDef { position, radius, height, mass, push_force, step_height, ..MoverDef::default() };
        let id = refused(|| slf.borrow_mut().world.add_mover(&def))?;
        Ok(Mover { world: slf.clone().unbind(), id })
    }

    /// Removes a field.
    fn remove_field(&mut self, field: u64) -> PyResult<()> {
        let id = FieldId::from_bits(field);
        if !self.world.contains_field(id) {
            return Err(bad(format!("there is no field {field:#x}")));
        }
        refused(|| self.world.remove_field(id))
    }

    /// Adds a ragdoll to the world and returns the ids of its bodies and joints. `poses` (n, 7) are those of its bodies; without them the
    /// ragdoll stands at `pose` in its bind pose.
    #[pyo3(signature = (ragdoll, *, pose=None, poses=None, velocities=None))]
    fn add_ragdoll<'py>(
        &mut self,
        py: Python<'py>,
        ragdoll: &Ragdoll,
        pose: Option<&Bound<'py, PyAny>>,
        poses: Option<&Bound<'py, PyAny>>,
        velocities: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Ids<'py>, Ids<'py>)> {
        let def = &ragdoll.repair.def;
        let count = Some(def.bodies.len());
        let bind = def.bodies.iter().map(|body| body.character_from_body);
        let places: Vec<Transform> = match (poses, pose) {
            (Some(poses), _) => crate::arrays::poses(&floats(poses, &[count, Some(7)], "poses")?, "poses")?,
            (None, Some(pose)) => {
                let place = crate::arrays::poses(&floats(pose, &[Some(7)], "pose")?, "pose")?[0];
                bind.map(|body| place * body).collect()
            }
            (None, None) => bind.collect(),
        };
        let speeds = match velocities {
            None => vec![Velocity::default(); def.bodies.len()],
            Some(given) => crate::arrays::velocities(&floats(given, &[count, Some(6)], "velocities")?),
        };
        let state = |(world_from_body, velocity)| BodyState { world_from_body, velocity };
        let states: Vec<BodyState> = places.into_iter().zip(speeds).map(state).collect();
        let spawned =
            guarded(|| sinew::ragdoll::Ragdoll::spawn(&mut self.world, def, &states, &Default::default()))?;
        let joints = spawned.joints.iter().map(|joint| joint.to_bits()).collect();
        Ok((Self::bits(py, &spawned.bodies), PyArray1::from_vec(py, joints)))
    }

    /// Adds a character that stands at a pose, `phase` seconds into its looped clip; it is updated after every step.
    #[pyo3(signature = (character, *, pose=None, phase=0.0))]
    fn add_character(
        slf: &Bound<'_, Self>,
        character: &Character,
        pose: Option<&Bound<'_, PyAny>>,
        phase: f32,
    ) -> PyResult<LiveCharacter> {
        let place = pose.map(one_pose).transpose()?.unwrap_or(Transform::IDENTITY);
        let mut world = slf.borrow_mut();
        let World { world: physics, characters, .. } = &mut *world;
        let def = character.def.clone();
        let made = refused(|| {
            let mut made = sinew::ragdoll::Character::new(def.clone(), place, phase);
            made.enter(physics);
            made
        })?;
        characters.push(Some(made));
        let index = characters.len() - 1;
        Ok(LiveCharacter { world: slf.clone().unbind(), index, def: character.def.clone() })
    }

    /// Removes a body with its joints.
    fn remove_body(&mut self, body: u64) -> PyResult<()> {
        let body = self.body(body)?;
        refused(|| self.world.remove_body(body))
    }

    /// Joins two bodies at their present poses: `ball`, `hinge`, `slider`, `fixed`; a hinge or slider may have a range.
    #[pyo3(signature = (kind, a, b, anchor, *, axis=None, range=None))]
    fn add_joint(
        &mut self,
        kind: &str,
        a: u64,
        b: u64,
        anchor: &Bound<'_, PyAny>,
        axis: Option<&Bound<'_, PyAny>>,
        range: Option<(f32, f32)>,
    ) -> PyResult<u64> {
        let (a, b, anchor) = (self.body(a)?, self.body(b)?, vec3(anchor, "anchor")?);
        let axis = axis.map(|axis| vec3(axis, "axis")).transpose()?.unwrap_or(Vec3::X);
        if axis == Vec3::ZERO {
            return Err(bad("the axis of a joint is zero"));
        }
        let limit = range.map(|(lo, hi)| Range { lo, hi });
        let world = &self.world;
        let def = match kind {
            "ball" => world.ball(a, b, anchor),
            "hinge" => JointDef { kind: JointKind::Hinge { limit }, ..world.hinge(a, b, anchor, axis) },
            "slider" => JointDef { kind: JointKind::Slider { limit }, ..world.slider(a, b, anchor, axis) },
            "fixed" => world.fixed(a, b),
            other => return Err(bad(format!("a joint is a ball, hinge, slider or fixed, not '{other}'"))),
        };
        if limit.is_some() && !matches!(kind, "hinge" | "slider") {
            return Err(bad(format!("a {kind} has no range")));
        }
        Ok(refused(|| self.world.add_joint(&def))?.to_bits())
    }

    /// Removes a joint.
    fn remove_joint(&mut self, joint: u64) -> PyResult<()> {
        let joint = self.joint(joint)?;
        guarded(|| self.world.remove_joint(joint))
    }

    /// Drives a joint toward a rotation (scaled axis) by a spring with a frequency in Hz and a largest torque in N·m; 0 Hz removes the
    /// drive.
    #[pyo3(signature = (joint, target, *, hertz, damping_ratio=1.0, max_torque=f32::INFINITY))]
    fn drive_joint(
        &mut self,
        joint: u64,
        target: &Bound<'_, PyAny>,
        hertz: f32,
        damping_ratio: f32,
        max_torque: f32,
    ) -> PyResult<()> {
        let joint = self.joint(joint)?;
        let drive = motor(vec3(target, "target")?, Softness::Frequency { hertz, damping_ratio }, max_torque);
        refused(|| self.world.set_motor(joint, (hertz != 0.0).then_some(drive)))
    }

    /// Takes steps, without the GIL.
    #[pyo3(signature = (count=1))]
    fn step(&mut self, py: Python<'_>, count: u32) -> PyResult<()> {
        let Self { world, characters, threads, keyed } = self;
        keyed.retain(|(id, _)| world.contains(*id));
        let one = || {
            for (id, collider) in keyed.iter() {
                for mover in parted(std::slice::from_ref(collider)).1 {
                    mover.lead(*id, world);
                }
            }
            world.step_with(threads, &NoProfiler);
            characters.iter_mut().flatten().for_each(|character| character.update(world));
        };
        py.detach(|| guarded(|| std::iter::repeat_with(one).take(count as usize).for_each(drop)))
    }

    /// Number of steps since the world was created.
    #[getter]
    fn step_count(&self) -> u64 {
        self.world.step_count()
    }

    /// Seconds since the world was created.
    #[getter]
    fn time(&self) -> f64 {
        self.world.time()
    }

    /// Ids of all bodies.
    #[getter]
    fn body_ids<'py>(&self, py: Python<'py>) -> Ids<'py> {
        Self::bits(py, &self.world.body_ids().collect::<Vec<_>>())
    }

    /// Ids of all joints.
    #[getter]
    fn joint_ids<'py>(&self, py: Python<'py>) -> Ids<'py> {
        PyArray1::from_vec(py, self.world.joint_ids().map(JointId::to_bits).collect())
    }

    /// Poses of bodies, (n, 7): position, and quaternion x y z w.
    #[pyo3(signature = (bodies=None))]
    fn poses<'py>(
        &self,
        py: Python<'py>,
        bodies: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let bodies = self.bodies(bodies)?;
        let mut numbers = Vec::with_capacity(7 * bodies.len());
        bodies.iter().for_each(|&body| push_pose(&mut numbers, &self.world.transform(body)));
        array(py, numbers, &[bodies.len(), 7])
    }

    /// Velocities of bodies, (n, 6): of the centre of mass, m/s, and angular velocity, rad/s.
    #[pyo3(signature = (bodies=None))]
    fn velocities<'py>(
        &self,
        py: Python<'py>,
        bodies: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let bodies = self.bodies(bodies)?;
        let mut numbers = Vec::with_capacity(6 * bodies.len());
        bodies.iter().for_each(|&body| push_velocity(&mut numbers, &self.world.velocity(body)));
        array(py, numbers, &[bodies.len(), 6])
    }

    /// Sets poses of bodies.
    fn set_poses(&mut self, bodies: &Bound<'_, PyAny>, poses: &Bound<'_, PyAny>) -> PyResult<()> {
        let bodies = self.bodies(Some(bodies))?;
        let numbers = floats(poses, &[Some(bodies.len()), Some(7)], "poses")?;
        let places = crate::arrays::poses(&numbers, "poses")?;
        guarded(|| {
            bodies.iter().zip(&places).for_each(|(&body, &place)| self.world.set_transform(body, place))
        })
    }

    /// Sets velocities of bodies.
    fn set_velocities(&mut self, bodies: &Bound<'_, PyAny>, velocities: &Bound<'_, PyAny>) -> PyResult<()> {
        let bodies = self.bodies(Some(bodies))?;
        let numbers = floats(velocities, &[Some(bodies.len()), Some(6)], "velocities")?;
        let speeds = crate::arrays::velocities(&numbers);
        guarded(|| {
            bodies.iter().zip(&speeds).for_each(|(&body, &speed)| self.world.set_velocity(body, speed))
        })
    }

    /// Applies an impulse to a body, N·s, at a point in the world; by default at its centre of mass.
    #[pyo3(signature = (body, impulse, *, point=None))]
    fn push(
        &mut self,
        body: u64,
        impulse: &Bound<'_, PyAny>,
        point: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let (body, impulse) = (self.body(body)?, vec3(impulse, "impulse")?);
        let point = point.map(|point| vec3(point, "point")).transpose()?;
        let point = point.unwrap_or_else(|| self.world.center_of_mass(body));
        guarded(|| self.world.apply_impulse(body, impulse, point))
    }

    /// First hit of each ray: arrays `body`, `fraction`, `point`, `normal`. Without a hit the body is 2**64 - 1 and the fraction 1.
    fn ray<'py>(
        &self,
        py: Python<'py>,
        origins: &Bound<'py, PyAny>,
        ways: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let origins = vectors(&floats(origins, &[None, Some(3)], "origins")?);
        let ways = vectors(&floats(ways, &[Some(origins.len()), Some(3)], "ways")?);
        let rays: Vec<Ray> =
            origins.iter().zip(&ways).map(|(&origin, &direction)| Ray { origin, direction }).collect();
        let mut hits: Vec<Option<BodyHit>> = vec![None; rays.len()];
        guarded(|| self.world.query().first_each(&rays, &mut hits))?;
        let (mut bodies, mut fractions, mut points, mut normals) = (vec![], vec![], vec![], vec![]);
        for (ray, hit) in rays.iter().zip(&hits) {
            bodies.push(hit.map_or(NO_BODY, |hit| hit.body.to_bits()));
            fractions.push(hit.map_or(1.0, |hit| hit.fraction));
            points.extend(hit.map_or(ray.origin + ray.direction, |hit| hit.point).to_array());
            normals.extend(hit.map_or(Vec3::ZERO, |hit| hit.normal).to_array());
        }
        let dict = PyDict::new(py);
        dict.set_item("body", PyArray1::from_vec(py, bodies))?;
        dict.set_item("fraction", PyArray1::from_vec(py, fractions))?;
        dict.set_item("point", array(py, points, &[rays.len(), 3])?)?;
        dict.set_item("normal", array(py, normals, &[rays.len(), 3])?)?;
        Ok(dict)
    }

    /// Ids of the bodies that a shape at a pose would overlap.
    fn overlap<'py>(
        &self,
        py: Python<'py>,
        kind: &str,
        size: Vec<f32>,
        pose: &Bound<'py, PyAny>,
    ) -> PyResult<Ids<'py>> {
        let shape = shape(kind, &size)?;
        let pose = poses(&floats(pose, &[Some(7)], "pose")?, "pose")?[0];
        let mut bodies = Vec::new();
        refused(|| self.world.query().bodies(&OverlapWith(Probe::new(shape, pose)), &mut bodies))?;
        bodies.sort_unstable();
        Ok(Self::bits(py, &bodies))
    }

    /// Contact points of the last step: arrays `a`, `b`, `position`, `normal`, `separation`, `impulse`.
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        contact_dict(py, &self.world)
    }

    /// Events of the last step: arrays (n, 2) of pairs of bodies: `begin` and `end` of touching, and `hit`.
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let events = self.world.events();
        let hits: Vec<(BodyId, BodyId)> = events.hits.iter().map(|hit| (hit.a.body, hit.b.body)).collect();
        let dict = PyDict::new(py);
        for (name, pairs) in [("begin", &events.begin), ("end", &events.end), ("hit", &hits)] {
            let bits = pairs.iter().flat_map(|(a, b)| [a.to_bits(), b.to_bits()]).collect();
            dict.set_item(name, array::<u64>(py, bits, &[pairs.len(), 2])?)?;
        }
        Ok(dict)
    }

    /// Distance between the anchors of a joint, metres.
    fn joint_gap(&self, joint: u64) -> PyResult<f32> {
        Ok(self.world.joint_gap(self.joint(joint)?))
    }

    /// Rotation of a joint, as a scaled axis, radians.
    fn joint_turn<'py>(&self, py: Python<'py>, joint: u64) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let turn = self.world.joint_transform(self.joint(joint)?).rotation.to_scaled_axis();
        Ok(PyArray1::from_vec(py, turn.to_array().to_vec()))
    }

    /// Hash of the complete state, characters included.
    fn hash(&self) -> u64 {
        if self.characters.iter().flatten().next().is_none() {
            return self.world.hash();
        }
        hash_bytes(self.state().as_bytes())
    }

    /// The state as bytes, with the states of the characters.
    fn save<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, self.state().as_bytes())
    }

    /// Restores a saved state; the characters must be those at the time of saving.
    fn load(&mut self, state: &[u8]) -> PyResult<()> {
        let mut world = self.world.clone();
        let mut characters = self.characters.clone();
        let mut r = Reader::new(state);
        let loaded = guarded(|| {
            world.load(&mut r).map_err(|what| what.to_string())?;
            let mut each = characters.iter_mut().flatten();
            each.try_for_each(|character| character.load(&mut r).map_err(|what| what.to_string()))
        })?;
        loaded.map_err(|what| SinewError::new_err(format!("not a state of this world: {what}")))?;
        (self.world, self.characters) = (world, characters);
        Ok(())
    }

    fn __repr__(&self) -> String {
        let (bodies, joints) = (self.world.body_ids().count(), self.world.joint_ids().count());
        format!("World({bodies} bodies, {joints} joints, {:.3} s)", self.world.time())
    }
}

/// Makes a motor toward a rotation, given as a scaled axis.
pub fn motor(target: Vec3, softness: Softness, max_torque: f32) -> Motor {
    let target = Transform::new(Vec3::ZERO, Rotation::from_scaled_axis(target));
    Motor { max_force: 0.0, max_torque, ..Motor::toward(target, softness) }
}
