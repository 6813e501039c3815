//! Scenes as plain data, so that Sinew and other engines build them from the same description.
//!
//! Metres, kilograms, y up, gravity 9.81 m/s² down, steps of 1/60 s. Unless a scene says otherwise: friction 0.6,
//! restitution 0, density 1000 kg/m³.

pub(crate) mod arch;
mod boxes;
mod chains;
mod figure;
mod grids;
mod humanoids;
pub(crate) mod loads;
mod stands;
pub(crate) mod waves;

pub use arch::arch;
pub use boxes::{
    box_heap, box_pyramid, box_pyramid_of, box_rain, box_rain_of, boxes_10000, large_pyramid,
    large_pyramid_of,
};
pub use chains::{chain_100_links, chain_hang, chain_swing, hanging_rope, heavy_rope};
pub use figure::{ragdoll_column, ragdoll_on_boxes, ragdoll_pile, ragdolls, rain};
pub use grids::{joint_grid, joint_grid_of, net};
pub use humanoids::{crowd_pile, humanoid, humanoid_lying, humanoid_pile, roots};
pub use stands::{cards, jenga, stack_mass_ratio, stack_ratio};
pub use waves::{mesh_drop, rocks, wave_pile};

use crate::parts::{GRAVITY, ghost};
use sinew::math::{Random, Rotation, Transform, Vec3, trig};
use sinew::physics::{
    BodyDef, BodyId, BodyKind, JointDef, JointId, JointKind, ShapeDef, Sleeping, World, WorldDef,
};

/// A scene as data, independent of any engine.
#[derive(Clone, Debug)]
pub struct Blueprint {
    /// Name of the scene.
    pub name: &'static str,
    /// Gravitational acceleration, m/s².
    pub gravity: Vec3,
    /// Sleeping mode of the bodies.
    pub sleeping: Sleeping,
    /// Number of steps of 1/60 s in a run.
    pub steps: u32,
    /// All bodies; joints refer to them by index. A body whose shapes have filter mask 0 collides with nothing.
    pub bodies: Vec<BodyDef>,
    /// All joints.
    pub joints: Vec<BlueprintJoint>,
    /// Pairs of bodies that do not collide, besides those with a joint.
    pub apart: Vec<(usize, usize)>,
}

/// A joint of a [`Blueprint`]: its angles are zero in the start pose, and its two bodies do not collide.
#[derive(Clone, Copy, Debug)]
pub struct BlueprintJoint {
    /// Index of the first body, the parent if there is one.
    pub a: usize,
    /// Index of the second body.
    pub b: usize,
    /// Anchor and axes in the start pose; hinges and twists are about x.
    pub world_from_joint: Transform,
    /// Kind of the joint: its free motions.
    pub kind: JointKind,
    /// Torque that resists the free motions, N·m.
    pub friction_torque: f32,
}

/// Ids of a [`Blueprint`]'s bodies and joints in a world, in the blueprint's order.
#[derive(Clone, Debug, Default)]
pub struct Built {
    /// Ids of the bodies, in the blueprint's order.
    pub bodies: Vec<BodyId>,
    /// Ids of the joints, in the blueprint's order.
    pub joints: Vec<JointId>,
}

impl Blueprint {
    /// Creates a blueprint without bodies, with Earth's gravity.
    fn new(name: &'static str, sleeping: Sleeping, steps: u32) -> Self {
        let gravity = Vec3::NEG_Y * GRAVITY;
        Self { name, gravity, sleeping, steps, bodies: Vec::new(), joints: Vec::new(), apart: Vec::new() }
    }

    /// Builds a new world with this scene. Returns the world, its bodies and its joints.
    pub fn build(&self) -> (World, Vec<BodyId>, Vec<JointId>) {
        let Self { gravity, sleeping, .. } = *self;
        let mut world = World::new(WorldDef { gravity, sleeping, ..WorldDef::default() });
        let Built { bodies, joints } = self.build_into(&mut world);
        (world, bodies, joints)
    }

    /// Adds the scene's bodies and joints to a world, which keeps its own gravity and sleeping mode.
    pub fn build_into(&self, world: &mut World) -> Built {
        let bodies: Vec<_> = self.bodies.iter().map(|def| world.add_body(def)).collect();
        let joint = |joint: &BlueprintJoint| {
            let [a, b] = [joint.a, joint.b].map(|place| (bodies[place], pose(&self.bodies[place])));
            let def = JointDef::new(a.0, b.0, a.1, b.1, joint.world_from_joint, joint.kind);
            world.add_joint(&JointDef { friction_torque: joint.friction_torque, ..def })
        };
        let joints = self.joints.iter().map(joint).collect();
        self.apart.iter().for_each(|&(a, b)| world.disable_pair(bodies[a], bodies[b]));
        Built { bodies, joints }
    }

    /// Moves the whole scene.
    pub fn moved(mut self, by: Vec3) -> Self {
        for body in &mut self.bodies {
            body.position += by;
        }
        for joint in &mut self.joints {
            joint.world_from_joint.translation += by;
        }
        self
    }

    /// Perturbs the start: each moving body is displaced by up to `most` metres, depending on `seed`. Joints move with
    /// their second bodies. Heaps are chaotic: results differ between starts.
    pub fn perturbed(mut self, seed: u64, most: f32) -> Self {
        let mut random = Random::new(seed);
        let aside: Vec<Vec3> = self.bodies.iter().map(|_| in_box(&mut random, -most, most)).collect();
        for place in self.dynamic().collect::<Vec<_>>() {
            self.bodies[place].position += aside[place];
        }
        for joint in &mut self.joints {
            if self.bodies[joint.b].kind == BodyKind::Dynamic {
                joint.world_from_joint.translation += aside[joint.b];
            }
        }
        self
    }

    /// Indices of the moving bodies.
    pub fn dynamic(&self) -> impl Iterator<Item = usize> {
        (0..self.bodies.len()).filter(|&place| self.bodies[place].kind == BodyKind::Dynamic)
    }

    /// Adds a body and returns its index.
    fn body(&mut self, def: BodyDef) -> usize {
        self.bodies.push(def);
        self.bodies.len() - 1
    }

    /// Adds an unlimited ball joint.
    fn ball(&mut self, a: usize, b: usize, anchor: Vec3) {
        let world_from_joint = Transform::from_translation(anchor);
        let kind = JointKind::Ball { limit: None };
        self.joints.push(BlueprintJoint { a, b, world_from_joint, kind, friction_torque: 0.0 });
    }
}

fn pose(def: &BodyDef) -> Transform {
    Transform::new(def.position, def.rotation)
}

/// Makes a body collide with nothing and have the given mass, with the inertia of its one shape.
fn weighed_ghost(mass: f32, def: BodyDef) -> BodyDef {
    let ShapeDef { ref shape, density, .. } = def.shapes[0];
    BodyDef { mass: Some(shape.mass_properties(density).scaled_to(mass)), ..ghost(def) }
}

/// Makes a body lose 5 % of its speeds per second; all piles use this.
fn damped(def: BodyDef) -> BodyDef {
    BodyDef { linear_damping: 0.05, angular_damping: 0.05, ..def }
}

/// Vector of three random numbers in `lo..hi`, x first.
pub fn in_box(random: &mut Random, lo: f32, hi: f32) -> Vec3 {
    let mut next = || random.range(lo, hi);
    Vec3::new(next(), next(), next())
}

/// Returns a uniform random rotation (Shoemake 1992). Uses exactly three numbers, without rejection, so that other
/// programs can draw the same.
pub fn rotation(random: &mut Random) -> Rotation {
    let [u, v, w] = [random.unit(), random.unit(), random.unit()];
    let (sin_v, cos_v) = trig::sin_cos(core::f32::consts::TAU * v);
    let (sin_w, cos_w) = trig::sin_cos(core::f32::consts::TAU * w);
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    Rotation::from_xyzw(a * sin_v, a * cos_v, b * sin_w, b * cos_w).normalize()
}
