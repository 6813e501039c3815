//! Jolt with its defaults, through the safe crate `oxijolt`.

mod filters;

use crate::engine::{
    BodyState, ClothSimulation, Description, Engine, ParticleState, RayCaster, Simulation, Unsupported,
    circular_cone,
};
use crate::scenes::{ClothScene, DT, RayScene};
use core::ops::Range;
use filters::Filters;
use oxijolt::{
    BodyId, BodySettings, CompoundChild, FixedConstraintSettings, HingeConstraintSettings, Inertia,
    PhysicsWorld, PointConstraintSettings, Quat, QueryFilter, RVec3, RayCast, SoftBodyBendType,
    SoftBodySettings, SoftBodySharedSettings, SoftBodyVertex, SoftBodyVertexAttributes, SoftBodyVertexState,
    SwingTwistConstraintSettings, WorldSettings,
};
use sinew::math::{Rotation, Transform, Vec3, min};
use sinew::physics::{BodyDef, BodyKind, JointKind, MassProperties, Sensing, Shape, ShapeDef, Sleeping};
use sinew_scenes::blueprint::{Blueprint, BlueprintJoint};

/// Of Jolt 5.6.0, as the crate bundles it.
const JOLT_COMMIT: &str = "e77f1755";

/// Room for contacts, in body pairs and in manifolds: a step that finds no room is not measured but stops the run.
const MAX_CONTACTS: u32 = 65_536;

/// Scratch memory of a step, bytes; only what is used of it is ever touched.
const SCRATCH: u32 = 256 << 20;

/// Jolt rounds the edges of boxes by this for speed, metres (its default).
const CONVEX_RADIUS: f32 = 0.05;

/// Half sizes of the box that stands for a half-space, metres; its upper face is the plane.
const HALF_SPACE: Vec3 = Vec3::new(900.0, 10.0, 900.0);

/// Of all links of the cloth, m/N. With the 1e-5 of Jolt's samples, made for particles of 1 kg, this cloth of 2 g
/// particles explodes at its first contact.
const CLOTH_COMPLIANCE: f32 = 5e-3;

/// This engine.
pub struct Jolt;

impl Engine for Jolt {
    fn describe(&self) -> Description {
        let settings = WorldSettings::default().single_threaded();
        let (velocity, position) = PhysicsWorld::new(settings)
            .map_or((0, 0), |world| (world.velocity_steps(), world.position_steps()));
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

    fn build(&self, scene: &Blueprint) -> Result<Box<dyn Simulation>, Unsupported> {
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
        Ok(Box::new(JoltWorld { world, bodies }))
    }

    fn build_cloth(&self, scene: &ClothScene) -> Result<Box<dyn ClothSimulation>, Unsupported> {
        let layers = oxijolt::CollisionLayers::default();
        let mut world = new_world(Vec3::new(0.0, -9.81, 0.0), 16, layers)?;
        for obstacle in scene.obstacles() {
            let settings = body(&obstacle, Sleeping::Off)?;
            world.create_body(&shape(&obstacle)?, &settings).map_err(refused)?;
        }
        let settings = SoftBodySettings::default()
            .linear_damping(scene.damping)
            .friction(scene.friction)
            .vertex_radius(scene.particle_radius)
            .allow_sleeping(false);
        let cloth = world.create_soft_body(&cloth(scene)?, &settings).map_err(refused)?;
        Ok(Box::new(JoltCloth { world, cloth }))
    }

    fn build_rays(&self, scene: &RayScene) -> Result<Box<dyn RayCaster>, Unsupported> {
        let layers = oxijolt::CollisionLayers::default();
        let mut world = new_world(Vec3::ZERO, scene.boxes.len(), layers)?;
        for place in &scene.boxes {
            let def = place.fixed();
            world.create_body(&shape(&def)?, &body(&def, Sleeping::On)?).map_err(refused)?;
        }
        world.optimize_broad_phase();
        let rays =
            scene.rays.iter().map(|ray| RayCast::new(point(ray.origin), vector(ray.direction))).collect();
        Ok(Box::new(JoltRays { world, rays }))
    }

    // `OrientedBox::Overlaps`, the fastest of all (18 to 24 ns), is C++ only: neither oxijolt nor the C API below it
    // has it, nor any other test of two shapes that are in no world.
}

fn refused(error: impl core::fmt::Display) -> Unsupported {
    Unsupported::new(error.to_string())
}

fn new_world(
    gravity: Vec3,
    bodies: usize,
    layers: oxijolt::CollisionLayers,
) -> Result<PhysicsWorld, Unsupported> {
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
        BodyKind::Dynamic => with_mass(BodySettings::new_dynamic(), &mass(def)),
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

/// As given, or that of the shapes: Jolt's shapes have no density of their own.
fn mass(def: &BodyDef) -> MassProperties {
    def.mass.unwrap_or_else(|| mass_of_shapes(&def.shapes, |shape| shape.density))
}

fn mass_of_shapes(shapes: &[ShapeDef], density: impl Fn(&ShapeDef) -> f32) -> MassProperties {
    shapes.iter().fold(MassProperties::default(), |sum, part| {
        sum.combine(&part.shape.mass_properties(density(part)).transformed(&part.body_from_shape))
    })
}

fn with_mass(settings: BodySettings, properties: &MassProperties) -> BodySettings {
    let rows = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (properties.inertia * axis).to_array());
    settings.mass_and_inertia(properties.mass, Inertia::Tensor(rows))
}

fn shape(def: &BodyDef) -> Result<oxijolt::Shape, Unsupported> {
    let parts: Vec<_> = def.shapes.iter().map(|part| shape_alone(&part.shape)).collect::<Result<_, _>>()?;
    let shape = match (&def.shapes[..], parts) {
        // A body without shapes has some in Jolt; its layer keeps it from meeting anything.
        ([], _) => return oxijolt::Shape::new_sphere(CONVEX_RADIUS).map_err(refused),
        ([only], mut parts)
            if only.body_from_shape == Transform::IDENTITY && only.shape != Shape::HalfSpace =>
        {
            parts.remove(0)
        }
        (defs, parts) => {
            let child = |(def, shape)| {
                let place = body_from_shape(def);
                CompoundChild {
                    shape,
                    position: vector(place.translation),
                    rotation: quaternion(place.rotation),
                    user_data: 0,
                }
            };
            let children: Vec<_> = defs.iter().zip(&parts).map(child).collect();
            oxijolt::Shape::new_compound(&children).map_err(refused)?
        }
    };
    if def.kind == BodyKind::Static {
        return Ok(shape);
    }
    // Jolt's shapes all have the same density.
    let offset = mass(def).center - mass_of_shapes(&def.shapes, |_| 1.0).center;
    if offset.length() < 1e-6 {
        return Ok(shape);
    }
    oxijolt::Shape::new_offset_center_of_mass(&shape, vector(offset)).map_err(refused)
}

fn shape_alone(shape: &Shape) -> Result<oxijolt::Shape, Unsupported> {
    let rounded_box = |half: Vec3| {
        let radius = min(CONVEX_RADIUS, 0.5 * half.min_element());
        oxijolt::Shape::new_box_with_convex_radius(vector(half), radius)
    };
    match *shape {
        Shape::Box { half_extents } => rounded_box(half_extents),
        Shape::Sphere { radius } => oxijolt::Shape::new_sphere(radius),
        Shape::Capsule { half_height, radius } => oxijolt::Shape::new_capsule(half_height, radius),
        Shape::HalfSpace => rounded_box(HALF_SPACE),
    }
    .map_err(refused)
}

fn body_from_shape(def: &ShapeDef) -> Transform {
    match def.shape {
        Shape::HalfSpace => def.body_from_shape * Transform::from_translation(Vec3::NEG_Y * HALF_SPACE.y),
        _ => def.body_from_shape,
    }
}

fn add_joint(world: &mut PhysicsWorld, [a, b]: [BodyId; 2], def: &BlueprintJoint) -> Result<(), Unsupported> {
    let Transform { translation, rotation } = def.world_from_joint;
    let at = point(translation);
    // oxijolt takes no axis that is off 1 by more than 2.5e-7.
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

/// Jolt's own links for a sheet of triangles: edges, shear along both diagonals, and distances over every edge that two
/// triangles share (58,806 in all).
fn cloth(scene: &ClothScene) -> Result<SoftBodySharedSettings, Unsupported> {
    let pinned = scene.pinned();
    let places = (0..scene.side).flat_map(|row| (0..scene.side).map(move |column| (row, column)));
    let vertices = places
        .map(|(row, column)| {
            let vertex = SoftBodyVertex::new(vector(scene.position(row, column)));
            let is_pinned = pinned.contains(&scene.index(row, column));
            SoftBodyVertex { inverse_mass: if is_pinned { 0.0 } else { 1.0 / scene.particle_mass }, ..vertex }
        })
        .collect();
    let cells = (1..scene.side).flat_map(|row| (1..scene.side).map(move |column| (row, column)));
    let faces = cells
        .flat_map(|(row, column)| {
            let corner = |r: usize, c: usize| scene.index(row - r, column - c) as u32;
            [[corner(1, 1), corner(0, 1), corner(0, 0)], [corner(1, 1), corner(0, 0), corner(1, 0)]]
        })
        .collect();
    let attributes = SoftBodyVertexAttributes::default()
        .compliance(CLOTH_COMPLIANCE)
        .shear_compliance(CLOTH_COMPLIANCE)
        .bend_compliance(Some(CLOTH_COMPLIANCE));
    SoftBodySharedSettings::builder(vertices, faces)
        .create_constraints(SoftBodyBendType::Distance, attributes)
        .build()
        .map_err(refused)
}

/// # Panics
/// If Jolt had to drop contacts.
fn step(world: &mut PhysicsWorld) {
    let report = world.step(DT).expect("a step of 1/60 s is within bounds");
    assert!(report.is_complete(), "Jolt had room for all contacts: {report:?}");
}

struct JoltWorld {
    world: PhysicsWorld,
    bodies: Vec<BodyId>,
}

impl Simulation for JoltWorld {
    fn step(&mut self) {
        step(&mut self.world);
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
}

struct JoltCloth {
    world: PhysicsWorld,
    cloth: BodyId,
}

impl ClothSimulation for JoltCloth {
    fn step(&mut self) {
        step(&mut self.world);
    }

    fn particles(&self, out: &mut Vec<ParticleState>) {
        let cloth = self.world.soft_body(self.cloth).expect("the cloth is never removed");
        out.clear();
        out.extend(cloth.vertices().into_iter().map(
            |SoftBodyVertexState { position: p, velocity, .. }| ParticleState {
                position: Vec3::new(p.x, p.y, p.z),
                velocity: from_vector(velocity),
            },
        ));
    }
}

/// oxijolt looks up the hit's normal and layer too, which costs it some of Jolt's lead.
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
