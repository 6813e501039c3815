//! Worlds and their bodies.

use crate::border::{
    Handle, Outcome, SinewStatus, elements, error, exclusive, fill, free, give, give_handle, guard, refused,
    room, shared,
};
use crate::types::{SinewBodyId, SinewPose, SinewShape, SinewVec3, SinewVelocity, body_kind};
use sinew::math::Vec3;
use sinew::physics::{
    BodyDef, BodyId, Filter, MassProperties, Material, Quality, Serial, ShapeDef, Sleeping, TaskRunner,
    Threads, World, WorldDef,
};

/// World with bodies and joints. One thread at a time may use it.
pub struct SinewWorld {
    pub(crate) world: Handle<World>,
    /// Thread pool of the last step that used more than one thread.
    threads: Option<Threads>,
}

/// Settings of a world; `sinew_world_def_default` fills them in.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct SinewWorldDef {
    /// Gravitational acceleration, m/s². Default (0, -9.81, 0).
    pub gravity: SinewVec3,
    /// Length of a step, nanoseconds. Default 16,666,667, a sixtieth of a second.
    pub step_nanoseconds: u64,
    /// Substeps of a step, at least 1. Default 4.
    pub substeps: u32,
    /// Quality of a step: 0 fast, 1 balanced, 2 exact. Default 1.
    pub quality: u32,
    /// 1 if bodies at rest may fall asleep, else 0. Default 1.
    pub sleeping: u32,
}

/// Definition of a body; `sinew_body_def_default` fills it in.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct SinewBodyDef {
    /// One of `SinewBodyKind`. Default dynamic.
    pub kind: u32,
    /// Pose in the world.
    pub pose: SinewPose,
    /// Velocity, m/s and rad/s.
    pub velocity: SinewVelocity,
    /// Shapes, each around the body's origin.
    pub shapes: *const SinewShape,
    /// Number of shapes.
    pub shape_count: usize,
    /// Mass, kg, distributed over the shapes; with 0, the default, the mass is computed from `density`.
    pub mass: f32,
    /// Density, kg/m³. Default 1,000.
    pub density: f32,
    /// Coefficient of Coulomb friction, at least 0. Default 0.6.
    pub friction: f32,
    /// Coefficient of restitution, 0 to 1. Default 0.
    pub restitution: f32,
    /// Bits of the layers to which the shapes belong. Default 1.
    pub layers: u32,
    /// Bits of the layers with which the shapes collide. Default all.
    pub mask: u32,
    /// Data of the user.
    pub user_data: u64,
}

/// Fills in the default settings of a world.
///
/// # Safety
/// `def` is null or points to room for one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_def_default(def: *mut SinewWorldDef) -> SinewStatus {
    guard(|| {
        let WorldDef { gravity, step_nanoseconds, substeps, .. } = WorldDef::default();
        let default =
            SinewWorldDef { gravity: gravity.into(), step_nanoseconds, substeps, quality: 1, sleeping: 1 };
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { give(def, "def", default) }
    })
}

/// Fills in the defaults of a body: dynamic, at the origin, without a shape.
///
/// # Safety
/// `def` is null or points to room for one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_body_def_default(def: *mut SinewBodyDef) -> SinewStatus {
    guard(|| {
        let (material, filter, shape) =
            (Material::DEFAULT, Filter::default(), ShapeDef::new(sinew::physics::Shape::HalfSpace));
        let default = SinewBodyDef {
            kind: 0,
            pose: SinewPose::default(),
            velocity: SinewVelocity::default(),
            shapes: core::ptr::null(),
            shape_count: 0,
            mass: 0.0,
            density: shape.density,
            friction: material.friction,
            restitution: material.restitution,
            layers: filter.layers,
            mask: filter.mask,
            user_data: 0,
        };
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { give(def, "def", default) }
    })
}

impl SinewWorldDef {
    fn read(&self) -> Outcome<WorldDef> {
        let bad = |what: String| error(SinewStatus::BadArgument, what);
        let quality = match self.quality {
            0 => Quality::Fast,
            1 => Quality::Balanced,
            2 => Quality::Exact,
            other => return Err(bad(format!("there is no quality {other}"))),
        };
        let sleeping = match self.sleeping {
            0 => Sleeping::Off,
            1 => Sleeping::On,
            other => return Err(bad(format!("sleeping must be 0 or 1, not {other}"))),
        };
        let def = WorldDef {
            gravity: self.gravity.read("gravity")?,
            step_nanoseconds: self.step_nanoseconds,
            substeps: self.substeps,
            quality,
            sleeping,
            ..WorldDef::default()
        };
        def.check().map_err(|what| bad(what.to_string()))?;
        Ok(def)
    }
}

impl SinewBodyDef {
    /// # Safety
    /// `shapes` is null or points to `shape_count` shapes.
    unsafe fn read(&self) -> Outcome<BodyDef> {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let shapes = unsafe { elements(self.shapes, self.shape_count, "shapes") }?;
        let material =
            Material { friction: self.friction, restitution: self.restitution, ..Material::DEFAULT };
        let filter = Filter { layers: self.layers, mask: self.mask, group: 0 };
        let shape = |shape: &SinewShape| -> Outcome<ShapeDef> {
            Ok(ShapeDef { density: self.density, material, filter, ..ShapeDef::new(shape.read()?) })
        };
        let pose = self.pose.read("the pose")?;
        let velocity = self.velocity.read("the velocity")?;
        let mut def = BodyDef {
            kind: body_kind(self.kind)?,
            position: pose.translation,
            rotation: pose.rotation,
            linear_velocity: velocity.linear,
            angular_velocity: velocity.angular,
            shapes: shapes.iter().map(shape).collect::<Outcome<_>>()?,
            user_data: self.user_data,
            ..BodyDef::default()
        };
        if self.mass != 0.0 {
            def.mass = Some(self.spread(&def)?);
        }
        Ok(def)
    }

    /// Distributes `mass` over the shapes, in proportion to their masses.
    fn spread(&self, def: &BodyDef) -> Outcome<MassProperties> {
        if !(self.mass > 0.0 && self.mass < f32::INFINITY) {
            return Err(error(
                SinewStatus::BadArgument,
                format!("the mass must be positive and finite, not {} kg", self.mass),
            ));
        }
        let by_density = refused(|| {
            let mut world = World::new(WorldDef::default());
            let shapes = def.shapes.iter().map(|shape| ShapeDef { density: 1.0, ..shape.clone() });
            let id = world.add_body(&BodyDef { shapes: shapes.collect(), ..BodyDef::default() });
            world.mass(id)
        })?;
        let factor = self.mass / by_density.mass;
        Ok(MassProperties { mass: self.mass, inertia: by_density.inertia * factor, ..by_density })
    }
}

impl SinewWorld {
    pub(crate) fn of(world: World) -> Self {
        Self { world: Handle::new(world), threads: None }
    }
}

/// Returns the body of an id, if it exists.
pub(crate) fn body(world: &World, id: SinewBodyId) -> Outcome<BodyId> {
    let body = BodyId::from_bits(id.bits);
    if world.contains(body) {
        Ok(body)
    } else {
        Err(error(SinewStatus::StaleId, format!("no body {:#x}", id.bits)))
    }
}

/// Creates a world. `def` may be null for the defaults.
///
/// # Safety
/// `def` is null or points to settings, `world` is null or points to room for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_new(
    def: *const SinewWorldDef,
    world: *mut *mut SinewWorld,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let def = unsafe { def.as_ref() }.map_or_else(|| Ok(WorldDef::default()), SinewWorldDef::read)?;
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { give_handle(world, "world", SinewWorld::of(World::new(def))) }
    })
}

/// Frees a world; null is allowed.
///
/// # Safety
/// `world` is null or came from `sinew_world_new` and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_free(world: *mut SinewWorld) {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    unsafe { free(world) }
}

/// Takes steps on the given number of threads, which does not affect the result. 0 and 1 use only the calling thread.
///
/// # Safety
/// `world` is null or a world that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_step(world: *mut SinewWorld, steps: u32, threads: u32) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let SinewWorld { world, threads: pool } = unsafe { exclusive(world, "world") }?;
        let count = threads.min(256) as usize;
        if count > 1 && pool.as_ref().is_none_or(|pool| pool.count() != count) {
            *pool = Some(Threads::new(count));
        }
        let runner: &dyn TaskRunner = match pool {
            Some(pool) if count > 1 => pool,
            _ => &Serial,
        };
        world.change(|world| {
            for _ in 0..steps {
                world.step_with(runner, &sinew::physics::stage::NoProfiler);
            }
            Ok(())
        })
    })
}

/// Stores the number of steps since the world was created in `steps`.
///
/// # Safety
/// `world` is null or a world that no other thread changes, `steps` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_step_count(world: *const SinewWorld, steps: *mut u64) -> SinewStatus {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    guard(|| unsafe { give(steps, "steps", shared(world, "world")?.world.get()?.step_count()) })
}

/// Adds a body; stores its id in `id`.
///
/// # Safety
/// `world` is null or a world that no other thread uses, `def` null or a definition with valid `shapes`, `id` null or room for one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_add_body(
    world: *mut SinewWorld,
    def: *const SinewBodyDef,
    id: *mut SinewBodyId,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let (world, def) = unsafe { (exclusive(world, "world")?, shared(def, "def")?.read()?) };
        room(id, "id")?;
        let added = world.world.change(|world| refused(|| world.add_body(&def)))?;
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { give(id, "id", added.into()) }
    })
}

/// Removes a body with its joints.
///
/// # Safety
/// `world` is null or a world that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_remove_body(world: *mut SinewWorld, id: SinewBodyId) -> SinewStatus {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    guard(|| unsafe {
        exclusive(world, "world")?.world.change(|world| {
            let body = body(world, id)?;
            refused(|| world.remove_body(body))
        })
    })
}

/// Stores the ids of all bodies in `ids`, ascending by index.
///
/// # Safety
/// `world` is null or a world that no other thread changes, `ids` has room for `capacity`, `count` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_bodies(
    world: *const SinewWorld,
    ids: *mut SinewBodyId,
    capacity: usize,
    count: *mut usize,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let world = unsafe { shared(world, "world") }?.world.get()?;
        let all: Vec<SinewBodyId> = world.body_ids().map(SinewBodyId::from).collect();
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { fill(&all, ids, capacity, count) }
    })
}

/// Stores the poses of bodies in the world in `poses`, one for each id.
///
/// # Safety
/// `world` is null or a world that no other thread changes; `ids` and `poses` have `count` elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_poses(
    world: *const SinewWorld,
    ids: *const SinewBodyId,
    count: usize,
    poses: *mut SinewPose,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let (world, ids) = unsafe { (shared(world, "world")?.world.get()?, elements(ids, count, "ids")?) };
        let pose = |&id: &SinewBodyId| Ok(world.transform(body(world, id)?).into());
        let all: Vec<SinewPose> = ids.iter().map(pose).collect::<Outcome<_>>()?;
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { fill(&all, poses, count, &mut 0) }
    })
}

/// Stores the velocities of bodies in `velocities`, one for each id.
///
/// # Safety
/// As `sinew_world_poses`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_velocities(
    world: *const SinewWorld,
    ids: *const SinewBodyId,
    count: usize,
    velocities: *mut SinewVelocity,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let (world, ids) = unsafe { (shared(world, "world")?.world.get()?, elements(ids, count, "ids")?) };
        let velocity = |&id: &SinewBodyId| Ok(world.velocity(body(world, id)?).into());
        let all: Vec<SinewVelocity> = ids.iter().map(velocity).collect::<Outcome<_>>()?;
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { fill(&all, velocities, count, &mut 0) }
    })
}

/// Moves a body to a pose without passing through the space between.
///
/// # Safety
/// `world` is null or a world that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_set_pose(
    world: *mut SinewWorld,
    id: SinewBodyId,
    pose: SinewPose,
) -> SinewStatus {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    guard(|| unsafe {
        let pose = pose.read("the pose")?;
        exclusive(world, "world")?.world.change(|world| {
            let body = body(world, id)?;
            world.set_transform(body, pose);
            Ok(())
        })
    })
}

/// Sets the velocity of a body; ignored for static bodies.
///
/// # Safety
/// `world` is null or a world that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_set_velocity(
    world: *mut SinewWorld,
    id: SinewBodyId,
    velocity: SinewVelocity,
) -> SinewStatus {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    guard(|| unsafe {
        let velocity = velocity.read("the velocity")?;
        exclusive(world, "world")?.world.change(|world| {
            let body = body(world, id)?;
            world.set_velocity(body, velocity);
            Ok(())
        })
    })
}

/// Applies an impulse, N·s, world axes, to a dynamic body at a point in the world, or at its centre of mass if `point` is null.
///
/// # Safety
/// `world` is null or a world that no other thread uses, `point` is null or points to one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_push(
    world: *mut SinewWorld,
    id: SinewBodyId,
    impulse: SinewVec3,
    point: *const SinewVec3,
) -> SinewStatus {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    guard(|| unsafe {
        let impulse = impulse.read("the impulse")?;
        let point: Option<Vec3> = point.as_ref().map(|point| point.read("the point")).transpose()?;
        exclusive(world, "world")?.world.change(|world| {
            let body = body(world, id)?;
            world.apply_impulse(body, impulse, point.unwrap_or_else(|| world.center_of_mass(body)));
            Ok(())
        })
    })
}
