//! Rapier with its defaults.

use crate::engine::{
    BodyState, ClothSimulation, Description, Effort, Engine, OverlapTester, ParticleState, RayCaster,
    Simulation, Unsupported, circular_cone, joint_frames,
};
use crate::parry::{from_pose, from_vector, pose, shape, vector};
use crate::scenes::{BoxPairs, ClothScene, DT, PlacedBox, RayScene};
use core::ops::Range;
use rapier3d::control::{CharacterAutostep, CharacterLength, KinematicCharacterController};
use rapier3d::prelude::*;
use sinew::math::{Transform, Vec3};
use sinew::physics::{BodyDef, BodyKind, JointKind, ShapeDef, Sleeping};
use sinew_scenes::blueprint::{Blueprint, BlueprintJoint};
use sinew_scenes::walks::{Terrain, Walker, capsule};

/// Name of this build.
pub const NAME: &str = if cfg!(feature = "simd8") { "rapier_simd8" } else { "rapier" };

/// Engine Rapier.
pub struct Rapier;

impl Engine for Rapier {
    fn describe(&self) -> Description {
        let parameters = IntegrationParameters::default();
        let lanes = if cfg!(feature = "simd8") { ", feature simd8" } else { "" };
        Description {
            name: NAME,
            version: rapier3d::VERSION.into(),
            flags: format!("{}{lanes}", env!("PEERS_FLAGS")),
            settings: format!(
                "defaults: {} solver iterations, {} internal, {} stabilization, {} CCD substep; cones by coupled axes",
                parameters.num_solver_iterations,
                parameters.num_internal_pgs_iterations,
                parameters.num_internal_stabilization_iterations,
                parameters.max_ccd_substeps,
            ),
        }
    }

    fn build_at(&self, scene: &Blueprint, effort: Effort) -> Result<Box<dyn Simulation>, Unsupported> {
        let mut world = world(scene.gravity);
        match effort {
            Effort::Default => {}
            Effort::Substeps(substeps) => {
                world.integration_parameters.num_solver_iterations = substeps as usize;
            }
            Effort::Quality(_) => return Err(Unsupported::new("an effort as a quality: use substeps")),
        }
        let mut bodies = Vec::with_capacity(scene.bodies.len());
        for def in &scene.bodies {
            let handle = world.insert_body(body(def, scene.sleeping));
            for shape in &def.shapes {
                world.insert_collider(collider(shape, def)?, Some(handle));
            }
            bodies.push(handle);
        }
        for def in &scene.joints {
            world.insert_impulse_joint(bodies[def.a], bodies[def.b], joint(def, scene)?);
        }
        for &(a, b) in &scene.apart {
            // A joint without locked axes disables a pair without a hook of the user.
            let parted = GenericJointBuilder::new(JointAxesMask::empty()).contacts_enabled(false);
            world.insert_impulse_joint(bodies[a], bodies[b], parted);
        }
        Ok(Box::new(RapierWorld { world, bodies }))
    }

    fn build_cloth(&self, scene: &ClothScene) -> Result<Box<dyn ClothSimulation>, Unsupported> {
        let mut world = world(Vec3::new(0.0, -9.81, 0.0));
        for place in &scene.boxes {
            world.insert_collider(static_box(place).friction(scene.friction), None);
        }
        for &(center, radius) in &scene.spheres {
            let ball = ColliderBuilder::ball(radius).translation(vector(center));
            world.insert_collider(ball.friction(scene.friction), None);
        }
        // Rapier numbers cloth particles fastest along its second direction, we along a row, in x.
        let [along_rows, to_next_row] = [Vec3::X, Vec3::Z].map(|axis| vector(axis * scene.spacing));
        let surface = ColliderBuilder::ball(0.1).friction(scene.friction);
        let cloth =
            SoftBodyBuilder::cloth(vector(scene.corner), to_next_row, along_rows, scene.side, scene.side)
                .particle_radius(scene.particle_radius)
                .particle_mass(scene.particle_mass)
                .linear_damping(scene.damping)
                .surface_collider(surface)
                .can_sleep(false)
                .pinned_particles(scene.pinned().map(|i| i as u32));
        let cloth = world.insert_soft_body(cloth);
        Ok(Box::new(RapierCloth { world, cloth }))
    }

    fn build_rays(&self, scene: &RayScene) -> Result<Box<dyn RayCaster>, Unsupported> {
        let mut world = world(Vec3::ZERO);
        for place in &scene.boxes {
            world.insert_collider(static_box(place), None);
        }
        // This step builds the tree for rays.
        world.step();
        let rays = scene.rays.iter().map(|ray| Ray::new(vector(ray.origin), vector(ray.direction))).collect();
        Ok(Box::new(RapierRays { world, rays }))
    }

    fn build_boxes(&self, pairs: &BoxPairs) -> Result<Box<dyn OverlapTester>, Unsupported> {
        let placed =
            |place: &PlacedBox| (pose(place.world_from_box), Cuboid::new(vector(place.half_extents)));
        let pairs = pairs.pairs.iter().map(|pair| [placed(&pair.a), placed(&pair.b)]).collect();
        Ok(Box::new(ParryBoxes { pairs }))
    }
}

fn world(gravity: Vec3) -> PhysicsWorld {
    let mut world = PhysicsWorld::new();
    world.gravity = vector(gravity);
    world.integration_parameters.dt = DT;
    world
}

fn static_box(place: &PlacedBox) -> ColliderBuilder {
    let half = place.half_extents;
    ColliderBuilder::cuboid(half.x, half.y, half.z).position(pose(place.world_from_box))
}

fn body(def: &BodyDef, sleeping: Sleeping) -> RigidBodyBuilder {
    let kind = match def.kind {
        BodyKind::Static => RigidBodyType::Fixed,
        BodyKind::Kinematic => RigidBodyType::KinematicVelocityBased,
        BodyKind::Dynamic => RigidBodyType::Dynamic,
    };
    let builder = RigidBodyBuilder::new(kind)
        .pose(pose(Transform::new(def.position, def.rotation)))
        .linvel(vector(def.linear_velocity))
        .angvel(vector(def.angular_velocity))
        .linear_damping(def.linear_damping)
        .angular_damping(def.angular_damping)
        .gravity_scale(def.gravity_scale)
        .can_sleep(sleeping == Sleeping::On);
    match def.mass {
        None => builder,
        Some(given) => {
            let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| vector(given.inertia * axis));
            let inertia = Matrix::from_cols(axes[0], axes[1], axes[2]);
            let center = vector(given.center);
            builder
                .additional_mass_properties(MassProperties::with_inertia_matrix(center, given.mass, inertia))
        }
    }
}

fn collider(def: &ShapeDef, body: &BodyDef) -> Result<ColliderBuilder, Unsupported> {
    if def.filter.group != 0 {
        return Err(Unsupported::new("collision groups"));
    }
    if def.material.rolling != 0.0 {
        return Err(Unsupported::new("rolling resistance"));
    }
    let [layers, mask] = [def.filter.layers, def.filter.mask].map(Group::from_bits_retain);
    // A given mass replaces that of the shapes.
    let density = if body.mass.is_some() { 0.0 } else { def.density };
    Ok(ColliderBuilder::new(shape(&def.shape)?)
        .position(pose(def.body_from_shape))
        .density(density)
        .friction(def.material.friction)
        .restitution(def.material.restitution)
        .collision_groups(InteractionGroups::new(layers, mask, InteractionTestMode::And)))
}

fn joint(def: &BlueprintJoint, scene: &Blueprint) -> Result<GenericJointBuilder, Unsupported> {
    if def.friction_torque != 0.0 {
        return Err(Unsupported::new("friction of joints, which is not mapped yet"));
    }
    let free_rotation = JointAxesMask::LIN_AXES;
    let cone = JointAxesMask::ANG_Y | JointAxesMask::ANG_Z;
    let builder = match def.kind {
        JointKind::Ball { limit: None } => GenericJointBuilder::new(free_rotation),
        JointKind::Ball { limit: Some(limit) } => {
            let half_angle = circular_cone(&limit)?;
            GenericJointBuilder::new(free_rotation)
                .coupled_axes(cone)
                .limits(JointAxis::AngY, [-half_angle, half_angle])
                .limits(JointAxis::AngX, [limit.twist.lo, limit.twist.hi])
        }
        JointKind::Hinge { limit } => {
            let builder = GenericJointBuilder::new(free_rotation | cone);
            match limit {
                None => builder,
                Some(range) => builder.limits(JointAxis::AngX, [range.lo, range.hi]),
            }
        }
        JointKind::Fixed => GenericJointBuilder::new(free_rotation | JointAxesMask::ANG_AXES),
        _ => return Err(Unsupported::new("a kind of joint that is not mapped yet")),
    };
    let [frame1, frame2] = joint_frames(scene, def).map(pose);
    Ok(builder.local_frame1(frame1).local_frame2(frame2).contacts_enabled(false))
}

struct RapierWorld {
    world: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
}

impl Simulation for RapierWorld {
    fn step(&mut self) {
        self.world.step();
    }

    fn states(&self, out: &mut Vec<BodyState>) {
        out.clear();
        out.extend(self.bodies.iter().map(|&handle| {
            let body = &self.world.bodies[handle];
            BodyState {
                world_from_body: from_pose(body.position()),
                linear_velocity: from_vector(body.linvel()),
                angular_velocity: from_vector(body.angvel()),
            }
        }));
    }

    fn is_awake(&self) -> bool {
        let bodies = self.bodies.iter().map(|&handle| &self.world.bodies[handle]);
        bodies.filter(|body| body.is_dynamic()).any(|body| !body.is_sleeping())
    }
}

struct RapierCloth {
    world: PhysicsWorld,
    cloth: SoftBodyHandle,
}

impl ClothSimulation for RapierCloth {
    fn step(&mut self) {
        self.world.step();
    }

    fn particles(&self, out: &mut Vec<ParticleState>) {
        let cloth = &self.world.soft_bodies[self.cloth];
        out.clear();
        out.extend((0..cloth.num_particles()).map(|i| ParticleState {
            position: from_vector(cloth.particle_position(i)),
            velocity: from_vector(cloth.particle_velocity(i)),
        }));
    }
}

struct RapierRays {
    world: PhysicsWorld,
    rays: Vec<Ray>,
}

impl RayCaster for RapierRays {
    fn count_hits(&mut self, range: Range<usize>) -> usize {
        let hits = |ray: &&Ray| self.world.cast_ray(ray, 1.0, true, QueryFilter::default()).is_some();
        self.rays[range].iter().filter(hits).count()
    }
}

/// Pairs of boxes for Rapier's collision library, called like by its users.
struct ParryBoxes {
    pairs: Vec<[(Pose, Cuboid); 2]>,
}

impl OverlapTester for ParryBoxes {
    fn count_overlaps(&mut self, range: Range<usize>) -> usize {
        let overlap = |[a, b]: &&[(Pose, Cuboid); 2]| {
            parry3d::query::intersection_test(&a.0, &a.1, &b.0, &b.1).is_ok_and(|result| result.intersecting)
        };
        self.pairs[range].iter().filter(overlap).count()
    }
}

/// A capsule moved by Rapier's controller, with its defaults except for [`capsule`]: step and snap height, slopes, accelerations.
struct RapierWalker {
    world: PhysicsWorld,
    controller: KinematicCharacterController,
    shape: Capsule,
    /// Pose of the capsule's centre.
    pose: Pose,
    velocity: Vec3,
    is_grounded: bool,
}

/// Returns a walker of Rapier with its feet at a point on a terrain.
///
/// # Panics
/// If Rapier lacks a shape of the terrain.
pub fn walker(on: &Terrain, feet: Vec3) -> Box<dyn Walker> {
    let def = capsule();
    let mut world = world(Vec3::new(0.0, -9.81, 0.0));
    for body in &on.bodies {
        let handle = world
            .insert_body(RigidBodyBuilder::fixed().pose(pose(Transform::new(body.position, body.rotation))));
        for part in &body.shapes {
            let solid = ColliderBuilder::new(shape(&part.shape).expect("Rapier has the shapes of walks"));
            let place = pose(part.body_from_shape);
            world.insert_collider(solid.position(place), Some(handle));
        }
    }
    // This step builds the tree for queries.
    world.step();
    let step = CharacterLength::Absolute(def.step_height);
    let controller = KinematicCharacterController {
        autostep: Some(CharacterAutostep { max_height: step, ..CharacterAutostep::default() }),
        snap_to_ground: Some(step),
        max_slope_climb_angle: def.slope_limit,
        min_slope_slide_angle: def.slope_limit,
        ..KinematicCharacterController::default()
    };
    let center = feet + Vec3::Y * (0.5 * def.height);
    Box::new(RapierWalker {
        world,
        controller,
        shape: Capsule::new_y(0.5 * def.height - def.radius, def.radius),
        pose: pose(Transform::from_translation(center)),
        velocity: Vec3::ZERO,
        is_grounded: false,
    })
}

impl Walker for RapierWalker {
    fn feet(&self) -> Vec3 {
        from_pose(&self.pose).translation - Vec3::Y * (0.5 * capsule().height)
    }

    fn is_grounded(&self) -> bool {
        self.is_grounded
    }

    fn step(&mut self, wish: Vec3) {
        let def = capsule();
        let most = if self.is_grounded { def.ground_acceleration } else { def.air_acceleration } * DT;
        let level = Vec3::new(self.velocity.x, 0.0, self.velocity.z);
        let change = if !self.is_grounded && wish == Vec3::ZERO { Vec3::ZERO } else { wish - level };
        let length = change.length();
        self.velocity += if length > most { change * (most / length) } else { change };
        // As in Rapier's examples, the walker starts to fall from rest while the ground carries it.
        self.velocity.y = if self.is_grounded { 0.0 } else { self.velocity.y } - 9.81 * DT;
        let queries = self.world.query_pipeline();
        let wanted = vector(self.velocity * DT);
        let moved = self.controller.move_shape(DT, &queries, &self.shape, &self.pose, wanted, |_| {});
        self.pose.translation += moved.translation;
        self.is_grounded = moved.grounded;
        // Obstacles stop the walker's velocity.
        let went = from_vector(moved.translation) / DT;
        let [before, after] = [self.velocity, went].map(|v| Vec3::new(v.x, 0.0, v.z).length());
        if after < before {
            self.velocity = Vec3::new(went.x, self.velocity.y, went.z);
        }
    }
}
