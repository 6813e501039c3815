//! Jolt with its defaults, through the safe crate `oxijolt`.
//!
//! Compared with earlier results of Jolt 5.5.1 with link-time optimisation on a Zen 4, this Jolt 5.6.0 without it on an
//! Intel Xeon takes about as long relative to Rapier for joints (pile of humanoids 0.79 of Rapier's time, then 0.72;
//! chain 0.98, then 1.01), but longer for stacks of boxes (pyramid of 15 layers 1.40, then 0.98 to 1.10) and rays (0.9,
//! then 0.6). This crate is not the cause: one function of Jolt takes 51 % of the pyramid's time, the velocity solver
//! of a contact, which has new friction in 5.6, and Jolt's tree and boxes take 86 % of the rays' time. Caches are not
//! the cause either: pyramids of 6 and 11 layers have 1.43 and 1.44.

mod cloth;
mod filters;
mod shapes;

use crate::engine::{
    BodyState, ClothSimulation, Description, Effort, Engine, RayCaster, Simulation, Unsupported,
    circular_cone,
};
use crate::scenes::{ClothScene, DT, RayScene};
use core::ops::Range;
use filters::Filters;
use oxijolt::{
    BodyId, BodySettings, CollisionLayers, FixedConstraintSettings, HingeConstraintSettings, PhysicsWorld,
    PointConstraintSettings, Quat, QueryFilter, RVec3, RayCast, SwingTwistConstraintSettings, WorldSettings,
};
use shapes::{CONVEX_RADIUS, shape, with_mass};
use sinew::math::{Rotation, Transform, Vec3};
use sinew::physics::{BodyDef, BodyKind, JointKind, Sensing, Sleeping};
use sinew_scenes::blueprint::{Blueprint, BlueprintJoint};

/// Commit of Jolt 5.6.0 that the crate bundles.
const JOLT_COMMIT: &str = "e77f1755";

/// Capacity for contacts, in body pairs and in manifolds: a step that exceeds it is not measured but stops the run.
const MAX_CONTACTS: u32 = 65_536;

/// Scratch memory of a step, bytes; only the used part is touched.
const SCRATCH: u32 = 256 << 20;

/// Engine Jolt.
pub struct Jolt;

impl Engine for Jolt {
    fn describe(&self) -> Description {
        let world = PhysicsWorld::new(WorldSettings::default().single_threaded())
            .expect("Jolt makes a world with its default settings");
        let (velocity, position) = (world.velocity_steps(), world.position_steps());
        let lanes = if cfg!(target_arch = "x86_64") { "-mavx2 -mfma" } else { "NEON" };
        Description {
            name: "jolt",
            version: format!("5.6.0, commit {JOLT_COMMIT}, in crate oxijolt 1.5.0"),
            flags: format!("Release: -O3 -DNDEBUG {lanes} -ffp-contract=fast, no LTO, no profiler"),
            settings: format!(
                "defaults: {velocity} velocity and {position} position steps, 1 collision step, discrete motion, \
                 convex radius min({CONVEX_RADIUS} m, half the smallest half extent), single-threaded job system"
            ),
        }
    }

    fn build_at(&self, scene: &Blueprint, effort: Effort) -> Result<Box<dyn Simulation>, Unsupported> {
        let substeps = match effort {
            Effort::Default => 1,
            Effort::Substeps(substeps) => substeps,
            Effort::Quality(_) => return Err(Unsupported::new("an effort as a quality: use substeps")),
        };
        let filters = Filters::new(scene)?;
        let mut world = new_world(scene.gravity, scene.bodies.len(), filters.layers())?;
        let mut bodies = Vec::with_capacity(scene.bodies.len());
        for (place, def) in scene.bodies.iter().enumerate() {
            let mut settings = body(def, scene.sleeping)?.object_layer(filters.layer(place));
            if let Some(group) = filters.group(place) {
                settings = settings.collision_group(group?);
            }
            bodies.push(world.create_body(&shape(def)?, &settings).map_err(refused)?);
        }
        for def in &scene.joints {
            add_joint(&mut world, [bodies[def.a], bodies[def.b]], def)?;
        }
        world.optimize_broad_phase();
        Ok(Box::new(JoltWorld { world, bodies, substeps }))
    }

    fn build_cloth(&self, scene: &ClothScene) -> Result<Box<dyn ClothSimulation>, Unsupported> {
        cloth::build(scene)
    }

    fn build_rays(&self, scene: &RayScene) -> Result<Box<dyn RayCaster>, Unsupported> {
        let mut world = new_world(Vec3::ZERO, scene.boxes.len(), CollisionLayers::default())?;
        for place in &scene.boxes {
            let def = place.fixed();
            world.create_body(&shape(&def)?, &body(&def, Sleeping::On)?).map_err(refused)?;
        }
        world.optimize_broad_phase();
        let rays =
            scene.rays.iter().map(|ray| RayCast::new(point(ray.origin), vector(ray.direction))).collect();
        Ok(Box::new(JoltRays { world, rays }))
    }

    // `OrientedBox::Overlaps`, the fastest test of all (18 to 24 ns), is C++ only: neither oxijolt nor the C interface below it has that test,
    // nor any other test of two shapes outside a world.
}

fn refused(error: impl core::fmt::Display) -> Unsupported {
    Unsupported::new(error.to_string())
}

/// Returns an empty world with room for `bodies`.
fn new_world(gravity: Vec3, bodies: usize, layers: CollisionLayers) -> Result<PhysicsWorld, Unsupported> {
    let settings = WorldSettings::default()
        .single_threaded()
        .gravity(vector(gravity))
        .layers(layers)
        .max_bodies(bodies as u32)
        .max_body_pairs(MAX_CONTACTS)
        .max_contact_constraints(MAX_CONTACTS)
        .temp_allocator_size(SCRATCH);
    PhysicsWorld::new(settings).map_err(refused)
}

fn body(def: &BodyDef, sleeping: Sleeping) -> Result<BodySettings, Unsupported> {
    let settings = match def.kind {
        BodyKind::Static => BodySettings::new_static(),
        BodyKind::Kinematic => BodySettings::new_kinematic(),
        BodyKind::Dynamic => with_mass(BodySettings::new_dynamic(), def),
    };
    let material = def.shapes.first().map(|shape| shape.material).unwrap_or_default();
    if def.shapes.iter().any(|shape| shape.material != material || shape.sensing == Sensing::Sensor) {
        return Err(Unsupported::new("sensors and bodies of several materials"));
    }
    if material.rolling != 0.0 {
        return Err(Unsupported::new("rolling resistance"));
    }
    Ok(settings
        .position(point(def.position))
        .rotation(quaternion(def.rotation))
        .linear_velocity(vector(def.linear_velocity))
        .angular_velocity(vector(def.angular_velocity))
        .linear_damping(def.linear_damping)
        .angular_damping(def.angular_damping)
        .gravity_factor(def.gravity_scale)
        .friction(material.friction)
        .restitution(material.restitution)
        .allow_sleeping(sleeping == Sleeping::On))
}

fn add_joint(world: &mut PhysicsWorld, [a, b]: [BodyId; 2], def: &BlueprintJoint) -> Result<(), Unsupported> {
    if def.friction_torque != 0.0 {
        return Err(Unsupported::new("friction of joints, which is not mapped yet"));
    }
    let Transform { translation, rotation } = def.world_from_joint;
    let at = point(translation);
    // oxijolt refuses axes whose length is off 1 by more than 2.5e-7.
    let [x, y] = [Vec3::X, Vec3::Y].map(|axis| vector((rotation * axis).normalize()));
    match def.kind {
        JointKind::Ball { limit: None } => {
            world.create_constraint(a, b, &PointConstraintSettings::new(at)).map(drop)
        }
        JointKind::Ball { limit: Some(limit) } => {
            let half_angle = circular_cone(&limit)?;
            let settings = SwingTwistConstraintSettings::new(at, x, y)
                .half_cone_angles(half_angle, half_angle)
                .twist_limits(limit.twist.lo, limit.twist.hi);
            world.create_constraint(a, b, &settings).map(drop)
        }
        JointKind::Hinge { limit } => {
            let free = HingeConstraintSettings::new(at, x, y);
            let settings = match limit {
                None => free,
                Some(range) => free.limits(range.lo, range.hi),
            };
            world.create_constraint(a, b, &settings).map(drop)
        }
        JointKind::Fixed => world.create_constraint(a, b, &FixedConstraintSettings::new(at, x, y)).map(drop),
        _ => return Err(Unsupported::new("a kind of joint that is not mapped yet")),
    }
    .map_err(refused)
}

/// Takes one step of 1/60 s in `substeps` collision steps.
///
/// # Panics
/// If Jolt had to drop contacts.
fn step(world: &mut PhysicsWorld, substeps: u32) {
    let report =
        world.step_with_collision_steps(DT, substeps).expect("steps of 1/3840 s and more are within bounds");
    assert!(report.is_complete(), "Jolt had room for all contacts: {report:?}");
}

struct JoltWorld {
    world: PhysicsWorld,
    bodies: Vec<BodyId>,
    substeps: u32,
}

impl Simulation for JoltWorld {
    fn step(&mut self) {
        step(&mut self.world, self.substeps);
    }

    fn states(&self, out: &mut Vec<BodyState>) {
        out.clear();
        out.extend(self.bodies.iter().map(|&id| {
            let body = self.world.body(id).expect("bodies are never removed");
            let (p, q) = (body.position(), body.rotation());
            BodyState {
                world_from_body: Transform::new(
                    Vec3::new(p.x, p.y, p.z),
                    Rotation::from_xyzw(q.x, q.y, q.z, q.w),
                ),
                linear_velocity: from_vector(body.linear_velocity()),
                angular_velocity: from_vector(body.angular_velocity()),
            }
        }));
    }

    fn is_awake(&self) -> bool {
        self.bodies.iter().any(|&id| self.world.body(id).is_ok_and(|body| body.is_active()))
    }
}

/// Rays in a world of Jolt. oxijolt also looks up the hit's normal and layer: less than a tenth of the time.
struct JoltRays {
    world: PhysicsWorld,
    rays: Vec<RayCast>,
}

impl RayCaster for JoltRays {
    fn count_hits(&mut self, range: Range<usize>) -> usize {
        let filter = QueryFilter::new();
        let hits = |ray: &&RayCast| matches!(self.world.cast_ray(ray, &filter), Ok(Some(_)));
        self.rays[range].iter().filter(hits).count()
    }
}

fn vector(v: Vec3) -> oxijolt::Vec3 {
    oxijolt::Vec3::new(v.x, v.y, v.z)
}

fn from_vector(v: oxijolt::Vec3) -> Vec3 {
    Vec3::new(v.x, v.y, v.z)
}

fn point(v: Vec3) -> RVec3 {
    RVec3::new(v.x, v.y, v.z)
}

fn quaternion(r: Rotation) -> Quat {
    Quat::from_xyzw(r.x, r.y, r.z, r.w)
}
