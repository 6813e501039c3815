//! Kinematic character movers: capsules that walk, climb steps, ride, push and fall, without a body of their own.
//!
//! The stage `movers` is the last of a step: bodies have come to where they are, and each mover in order of its id moves among
//! them. `docs/mover.md` has the order of a move and the settings by symptom.

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
    /// Feet, world.
    position: Vec3,
    /// Feet before the last step, world.
    previous: Vec3,
    /// Velocity, m/s: on the ground beside the ground's own, in the air in the world.
    velocity: Vec3,
    /// Velocity that is wanted beside the ground's, m/s.
    walk: Vec3,
    /// Radians by which what it stood on turned it.
    yaw: f32,
    /// Speed of the jump that is due, m/s; 0: none.
    jump: f32,
    ground: Option<Footing>,
}

/// Footing of a mover: the surface that bears it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Footing {
    on: Bearer,
    point: Vec3,
    normal: Vec3,
    /// Velocity with which the ground takes the mover along, m/s: that of its surface there at the end of the step, or as near to it as friction comes.
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
    /// Body and the number of its shape; `None` on another mover.
    pub shape: Option<crate::ShapeId>,
    /// The other mover, if it stands on one.
    pub mover: Option<MoverId>,
    /// Point at which it is borne, world, metres.
    pub point: Vec3,
    /// Unit, from the ground to the mover.
    pub normal: Vec3,
    /// Velocity of the ground's surface there, of a belt's too, m/s.
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

    /// Its settings; position and height are those it was made with or was given last.
    pub fn def(&self) -> &MoverDef {
        &self.def
    }

    /// Lowest point of the capsule, world, metres.
    pub fn position(&self) -> Vec3 {
        self.position
    }

    /// Feet between the last step (`alpha` 0) and this one (1), for drawing.
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

    /// Half extents of its bounds, metres.
    fn half_extents(&self) -> Vec3 {
        abs3(self.def.up * self.half_height()) + Vec3::splat(self.def.radius)
    }

    /// Velocity in the world, m/s; that of the ground is in it.
    pub fn velocity(&self) -> Vec3 {
        self.velocity + self.ground.map_or(Vec3::ZERO, |footing| footing.velocity)
    }

    /// Velocity that it was told to walk with, m/s, beside the ground's.
    pub fn walk(&self) -> Vec3 {
        self.walk
    }

    /// Angle by which what it stood on has turned it about up so far, radians.
    pub fn yaw(&self) -> f32 {
        self.yaw
    }

    /// True if something bears it that is not too steep.
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
    /// None, of a world.
    pub fn new(lineage: Lineage) -> Self {
        Self { all: Arena::new(lineage), ..Self::default() }
    }

    /// The same movers, for a copy of their world.
    pub fn copy(&self) -> Self {
        Self { all: self.all.clone(), ..Self::default() }
    }

    /// Nobody stands on a body that is taken out.
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

/// Moves all movers, each in order of its id, among bodies that have come to where they are.
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

/// Velocity of a body's surface at a point, of what runs along it too.
fn surface_velocity(body: &Body, shape: u32, point: Vec3) -> Vec3 {
    body.velocity.at(point - body.center()) + body.surface_velocity(shape as usize, point).linear
}
