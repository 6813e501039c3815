//! Kinematic character movers: capsules that walk, climb steps, ride, push and fall, without a body of their own.
//!
//! The stage `movers` is the last of a step: bodies have their new poses, and the movers move among them in order of
//! their ids. `docs/mover.md` lists the order of a move, and the settings by symptom.

mod crowd;
mod def;
mod obstacle;
mod planes;
mod press;
mod segment;
mod snapshot;
mod sweep;
mod tuning;
mod walk;
mod world;

pub use def::MoverDef;

use crate::arena::{Arena, Item};
use crate::body::Body;
use crate::body::material::Material;
use crate::id::{BodyId, Lineage, MoverId};
use crate::world::World;
use crowd::Crowd;
use obstacle::Obstacle;
use press::Press;
use sinew_math::{Vec3, abs3};

/// State of a mover.
#[derive(Clone, Debug)]
pub struct Mover {
    pub(crate) def: MoverDef,
    /// Position of the feet, world, metres.
    position: Vec3,
    /// Position of the feet before the last step, world, metres.
    previous: Vec3,
    /// Velocity, m/s: relative to the ground while on it, in the world while in the air.
    velocity: Vec3,
    /// Wanted velocity relative to the ground, m/s.
    walk: Vec3,
    /// Angle by which the ground has rotated the mover, radians.
    yaw: f32,
    /// Speed of the pending jump, m/s; 0: none.
    jump: f32,
    ground: Option<Footing>,
}

/// Footing of a mover: the surface that supports it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Footing {
    on: Bearer,
    point: Vec3,
    normal: Vec3,
    /// Velocity with which the ground carries the mover, m/s. Follows the velocity of the ground's surface, as far as
    /// friction allows.
    velocity: Vec3,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Bearer {
    Shape { body: BodyId, shape: u32 },
    Mover(MoverId),
}

/// Ground under a mover.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoverGround {
    /// Body and shape number; `None` on another mover.
    pub shape: Option<crate::ShapeId>,
    /// Other mover, if the mover stands on one.
    pub mover: Option<MoverId>,
    /// Contact point, world, metres.
    pub point: Vec3,
    /// Unit normal from the ground to the mover, world.
    pub normal: Vec3,
    /// Velocity of the ground's surface there, including that of a belt, m/s.
    pub velocity: Vec3,
    /// Material of the ground; the default on another mover.
    pub material: Material,
}

impl Mover {
    fn new(def: &MoverDef) -> Self {
        Self {
            position: def.position,
            previous: def.position,
            velocity: Vec3::ZERO,
            walk: Vec3::ZERO,
            yaw: 0.0,
            jump: 0.0,
            ground: None,
            def: def.clone(),
        }
    }

    /// Settings of the mover; position and height are the last ones set explicitly.
    pub fn def(&self) -> &MoverDef {
        &self.def
    }

    /// Lowest point of the capsule, world, metres.
    pub fn position(&self) -> Vec3 {
        self.position
    }

    /// Returns the feet's position between the last step (`alpha` 0) and this one (1), for drawing, metres.
    pub fn interpolated(&self, alpha: f32) -> Vec3 {
        self.previous * (1.0 - alpha) + self.position * alpha
    }

    /// Centre of the capsule, world, metres.
    pub fn center(&self) -> Vec3 {
        self.position + self.def.up * (0.5 * self.def.height)
    }

    /// Half the length of the capsule's axis, metres.
    pub fn half_height(&self) -> f32 {
        0.5 * self.def.height - self.def.radius
    }

    /// Half extents of the mover's bounds, metres.
    fn half_extents(&self) -> Vec3 {
        abs3(self.def.up * self.half_height()) + Vec3::splat(self.def.radius)
    }

    /// Velocity in the world, m/s, including the velocity of the ground.
    pub fn velocity(&self) -> Vec3 {
        self.velocity + self.ground.map_or(Vec3::ZERO, |footing| footing.velocity)
    }

    /// Wanted walking velocity, m/s, relative to the ground.
    pub fn walk(&self) -> Vec3 {
        self.walk
    }

    /// Total angle about up by which the ground has rotated the mover, radians.
    pub fn yaw(&self) -> f32 {
        self.yaw
    }

    /// True if walkable ground supports the mover.
    pub fn is_grounded(&self) -> bool {
        self.ground.is_some()
    }

    fn put(&mut self, center: Vec3) {
        self.position = center - self.def.up * (0.5 * self.def.height);
    }
}

/// All movers of a world, and memory for their stage.
#[derive(Default)]
pub(crate) struct Movers {
    pub all: Arena<Mover>,
    crowd: Crowd,
    obstacles: Vec<Obstacle>,
    presses: Vec<Press>,
}

impl Item for Mover {
    type Id = MoverId;
}

impl Movers {
    /// Returns an empty set of movers for a world.
    pub fn new(lineage: Lineage) -> Self {
        Self { all: Arena::new(lineage), ..Self::default() }
    }

    /// Returns the movers for a copy of their world.
    pub fn copy(&self) -> Self {
        Self { all: self.all.clone(), ..Self::default() }
    }

    /// Clears footings on a removed body.
    pub fn forget(&mut self, body: BodyId) {
        let stands = |mover: &Mover| {
            mover
                .ground
                .is_some_and(|footing| matches!(footing.on, Bearer::Shape { body: on, .. } if on == body))
        };
        for (_, mover) in self.all.iter_mut() {
            if stands(mover) {
                mover.leave_ground();
            }
        }
    }
}

/// Moves all movers, in order of their ids, among bodies at their new poses.
pub(crate) fn movers(world: &mut World) {
    if world.movers.all.is_empty() {
        return;
    }
    let mut movers = core::mem::take(&mut world.movers);
    let dt = world.def.dt();
    let extents = |(index, mover): (u32, &Mover)| (index, mover.center(), mover.half_extents());
    movers.crowd.sort(|| movers.all.iter().map(extents));
    for index in 0..movers.all.slot_count() as u32 {
        if let Some(mover) = movers.all.try_at(index) {
            world.work.movers += press::work_of_weight(&world.bodies, mover, world.def.gravity);
            walk::advance(world, &mut movers, index, dt);
            press::apply(world, &mut movers.presses);
        }
    }
    world.movers = movers;
}

/// Velocity of a body's surface at a point, m/s, including the surface velocity of the shape, such as that of a belt.
fn surface_velocity(body: &Body, shape: u32, point: Vec3) -> Vec3 {
    body.velocity.at(point - body.center()) + body.surface_velocity(shape as usize, point).linear
}
