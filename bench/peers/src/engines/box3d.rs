//! Box3D with its defaults.
//!
//! On an Intel Xeon it takes 0.68 of Rapier's time for the pile of humanoids, 1.05 for the pyramid, 1.61 for the chain
//! of 100 links; another commit on a Zen 4 took 0.59, 0.94 and 1.44.

use crate::engine::{
    BodyState, Description, Effort, Engine, OverlapTester, RayCaster, Simulation, Unsupported, circular_cone,
    joint_frames,
};
use crate::ffi::box3d::{Body, BoxPair, Joint, Motion, Shape, Surface, World, version};
use crate::parry::triangles;
use crate::scenes::{BoxPairs, DT, RayScene};
use core::ops::Range;
use sinew::math::{Rotation, Transform, Vec3, trig};
use sinew::physics::ray::Ray;
use sinew::physics::{BodyDef, BodyKind, JointKind, Sensing, ShapeDef, Sleeping};
use sinew_scenes::blueprint::{Blueprint, BlueprintJoint};

/// Number of substeps of a step, as in Box3D's samples and manual.
const SUBSTEPS: i32 = 4;

/// Distance below which Box3D's own overlap tests report an overlap (`B3_OVERLAP_SLOP`), metres.
const OVERLAP_SLOP: f32 = 5e-4;

/// Half sizes of the box that replaces a half-space, metres; its upper face is the plane.
const HALF_SPACE: Vec3 = Vec3::new(1000.0, 10.0, 1000.0);

/// Number of sides of the hull that replaces a cylinder or a cone.
const SIDES: usize = 24;

/// Rotation from our joint frames to Box3D's: x becomes z, because Box3D's hinges, cones and twists are about z.
const Z_TO_X: Rotation = Rotation { x: 0.5, y: 0.5, z: 0.5, w: 0.5 };

/// Engine Box3D.
pub struct Box3d;

impl Engine for Box3d {
    fn describe(&self) -> Description {
        let lanes = if cfg!(target_arch = "x86_64") { "SSE2" } else { "NEON or scalar" };
        Description {
            name: "box3d",
            // The crate does not state the commit of its copy of Box3D.
            version: format!("{}, C source in crate box3d-sys 0.1.16", version()),
            flags: format!(
                "Release: -O3 -DNDEBUG -ffp-contract=off, {lanes} (4 lanes), BOX3D_VALIDATE=OFF, no LTO"
            ),
            settings: format!("defaults: {SUBSTEPS} substeps, continuous on, 1 worker"),
        }
    }

    fn build_at(&self, scene: &Blueprint, effort: Effort) -> Result<Box<dyn Simulation>, Unsupported> {
        let substeps = match effort {
            Effort::Default => SUBSTEPS,
            Effort::Substeps(substeps) => substeps as i32,
            Effort::Quality(_) => return Err(Unsupported::new("an effort as a quality: use substeps")),
        };
        let mut world = World::new(scene.gravity);
        refuse_rolling_on_boxes(scene)?;
        for def in &scene.bodies {
            add_body(&mut world, def, scene.sleeping)?;
        }
        for def in &scene.joints {
            let frames = joint_frames(scene, def).map(|frame| frame * Transform::new(Vec3::ZERO, Z_TO_X));
            world.add_joint([def.a, def.b], frames, joint(def)?);
        }
        scene.apart.iter().for_each(|&(a, b)| world.part([a, b]));
        Ok(Box::new(Box3dWorld { world, bodies: scene.bodies.len(), substeps }))
    }

    fn build_rays(&self, scene: &RayScene) -> Result<Box<dyn RayCaster>, Unsupported> {
        let mut world = World::new(Vec3::ZERO);
        for place in &scene.boxes {
            add_body(&mut world, &place.fixed(), Sleeping::On)?;
        }
        world.step(DT, SUBSTEPS);
        Ok(Box::new(Box3dRays { world, rays: scene.rays.clone() }))
    }

    fn build_boxes(&self, pairs: &BoxPairs) -> Result<Box<dyn OverlapTester>, Unsupported> {
        let pair = |pair: &crate::scenes::BoxPair| {
            let places = [pair.a, pair.b];
            BoxPair::new(places.map(|place| place.half_extents), places.map(|place| place.world_from_box))
        };
        Ok(Box::new(Box3dBoxes { pairs: pairs.pairs.iter().map(pair).collect() }))
    }
}

fn add_body(world: &mut World, def: &BodyDef, sleeping: Sleeping) -> Result<(), Unsupported> {
    let body = world.add_body(&Body {
        motion: match def.kind {
            BodyKind::Static => Motion::Static,
            BodyKind::Kinematic => Motion::Kinematic,
            BodyKind::Dynamic => Motion::Dynamic,
        },
        world_from_body: Transform::new(def.position, def.rotation),
        linear_damping: def.linear_damping,
        angular_damping: def.angular_damping,
        gravity_scale: def.gravity_scale,
        may_sleep: sleeping == Sleeping::On,
    });
    for part in &def.shapes {
        if part.sensing == Sensing::Sensor {
            return Err(Unsupported::new("sensors that are not mapped yet"));
        }
        world.add_shape(body, &shape(part)?, &surface(part))?;
    }
    if let (BodyKind::Dynamic, Some(mass)) = (def.kind, &def.mass) {
        world.set_mass(body, mass);
    }
    if def.kind != BodyKind::Static {
        world.set_velocity(body, def.linear_velocity, def.angular_velocity);
    }
    Ok(())
}

/// Refuses rolling resistance on boxes: Box3D multiplies the larger share of two shapes by the larger of their radii, which all
/// shapes but meshes have, so bodies on large boxes meet more resistance than stated.
fn refuse_rolling_on_boxes(scene: &Blueprint) -> Result<(), Unsupported> {
    let mut shapes = scene.bodies.iter().flat_map(|def| def.shapes.iter().map(move |part| (def.kind, part)));
    let rolls = shapes.clone().any(|(_, part)| part.material.rolling != 0.0);
    let has_no_radius = |part: &ShapeDef| triangles(&part.shape).is_some();
    if rolls && shapes.any(|(kind, part)| kind != BodyKind::Dynamic && !has_no_radius(part)) {
        return Err(Unsupported::new("rolling resistance on a static shape other than a mesh"));
    }
    Ok(())
}

/// Returns the radius that Box3D uses as the lever of rolling resistance, metres.
fn rolling_radius(shape: &sinew::physics::Shape) -> f32 {
    use sinew::physics::Shape as Ours;
    match *shape {
        Ours::Sphere { radius } | Ours::Capsule { radius, .. } => radius,
        _ => 0.25 * shape.inner_radius(),
    }
}

fn shape(def: &ShapeDef) -> Result<Shape, Unsupported> {
    use sinew::physics::Shape as Ours;
    let body_from_shape = def.body_from_shape;
    let hull = |points: &[Vec3]| Shape::Hull {
        points: points.iter().map(|point| body_from_shape.point(*point)).collect(),
    };
    Ok(match def.shape {
        Ours::Box { half_extents } => Shape::Box { half_extents, body_from_box: body_from_shape },
        Ours::Sphere { radius } => Shape::Sphere { center: body_from_shape.translation, radius },
        Ours::Capsule { half_height, radius } => {
            let ends = [-half_height, half_height].map(|y| body_from_shape.point(Vec3::Y * y));
            Shape::Capsule { ends, radius }
        }
        Ours::TaperedCapsule { .. } => return Err(Unsupported::new("no tapered capsules")),
        Ours::Cylinder { half_height, radius } => {
            hull(&[ring(-half_height, radius), ring(half_height, radius)].concat())
        }
        Ours::Cone { half_height, radius } => {
            hull(&[ring(-half_height, radius).as_slice(), &[Vec3::Y * half_height]].concat())
        }
        Ours::Hull(ref of) => hull(of.vertices()),
        Ours::HalfSpace => {
            let below = Transform::from_translation(Vec3::NEG_Y * HALF_SPACE.y);
            Shape::Box { half_extents: HALF_SPACE, body_from_box: body_from_shape * below }
        }
        Ours::Mesh(_) | Ours::HeightField(_) => {
            let (mut vertices, triangles) = triangles(&def.shape).expect("it has triangles");
            vertices.iter_mut().for_each(|vertex| *vertex = body_from_shape.point(*vertex));
            Shape::Mesh { vertices, triangles }
        }
    })
}

/// Returns the corners of a polygon for a circle about y: Box3D has round solids only as hulls.
fn ring(y: f32, radius: f32) -> [Vec3; SIDES] {
    core::array::from_fn(|side| {
        let (sin, cos) = trig::sin_cos(core::f32::consts::TAU * side as f32 / SIDES as f32);
        Vec3::new(radius * cos, y, radius * sin)
    })
}

fn surface(def: &ShapeDef) -> Surface {
    Surface {
        density: def.density,
        friction: def.material.friction,
        restitution: def.material.restitution,
        rolling: def.material.rolling / rolling_radius(&def.shape),
        layers: def.filter.layers,
        mask: def.filter.mask,
        group: def.filter.group,
    }
}

fn joint(def: &BlueprintJoint) -> Result<Joint, Unsupported> {
    let friction = def.friction_torque;
    Ok(match def.kind {
        JointKind::Ball { limit: None } => Joint::Spherical { cone: None, twist: None, friction },
        JointKind::Ball { limit: Some(limit) } => Joint::Spherical {
            cone: Some(circular_cone(&limit)?),
            twist: Some([limit.twist.lo, limit.twist.hi]),
            friction,
        },
        JointKind::Hinge { limit } => {
            Joint::Revolute { limit: limit.map(|range| [range.lo, range.hi]), friction }
        }
        JointKind::Fixed => Joint::Weld,
        _ => return Err(Unsupported::new("a kind of joint that is not mapped yet")),
    })
}

struct Box3dWorld {
    world: World,
    bodies: usize,
    substeps: i32,
}

impl Simulation for Box3dWorld {
    fn step(&mut self) {
        self.world.step(DT, self.substeps);
    }

    fn states(&self, out: &mut Vec<BodyState>) {
        out.clear();
        out.extend((0..self.bodies).map(|place| {
            let [linear_velocity, angular_velocity] = self.world.velocity(place);
            BodyState { world_from_body: self.world.pose(place), linear_velocity, angular_velocity }
        }));
    }

    fn is_awake(&self) -> bool {
        self.world.awake_bodies() > 0
    }
}

struct Box3dRays {
    world: World,
    rays: Vec<Ray>,
}

impl RayCaster for Box3dRays {
    fn count_hits(&mut self, range: Range<usize>) -> usize {
        self.rays[range].iter().filter(|ray| self.world.meets_ray(ray)).count()
    }
}

/// Pairs of boxes whose distance is computed by GJK: Box3D has no other public test of two boxes without a manifold.
struct Box3dBoxes {
    pairs: Vec<BoxPair>,
}

impl OverlapTester for Box3dBoxes {
    fn count_overlaps(&mut self, range: Range<usize>) -> usize {
        self.pairs[range].iter().filter(|pair| pair.distance() < OVERLAP_SLOP).count()
    }
}
