//! Objects of user-defined kinds, which apply forces and constraints that shapes and joints do not provide.
//!
//! An object is called twice in each substep, on one thread, in the order of ids: for forces before bodies move, and
//! for corrections after all have moved, before velocities are relaxed. An object may have state, which is part of
//! snapshots and of [`World::hash`], and which [`World::reset`] restores.
//!
//! A world without objects executes exactly as if the feature did not exist.
//!
//! ```
//! use sinew_math::{ReadError, Reader, Vec3, Writer};
//! use sinew_physics::*;
//!
//! /// Holds a body up as a spring from above would, and counts for how long.
//! struct Hover {
//!     body: BodyId,
//!     height: f32,
//!     substeps: u32,
//! }
//!
//! impl PhysicsObject for Hover {
//!     fn kind(&self) -> &'static str {
//!         "hover"
//!     }
//!     fn add_forces(&mut self, forces: &mut Forces<'_>) {
//!         let (place, velocity) = (forces.center_of_mass(self.body), forces.velocity(self.body).linear);
//!         let lift = 400.0 * (self.height - place.y) - 20.0 * velocity.y;
//!         forces.apply_force(self.body, Vec3::Y * lift, place);
//!         self.substeps += 1;
//!     }
//!     fn save(&self, w: &mut Writer) {
//!         w.u32(self.substeps);
//!     }
//!     fn load(&mut self, r: &mut Reader<'_>) -> Result<(), ReadError> {
//!         self.substeps = r.u32()?;
//!         Ok(())
//!     }
//! }
//!
//! let mut world = World::new(WorldDef::default());
//! let shape = ShapeDef { density: 1000.0, ..ShapeDef::new(Shape::Sphere { radius: 0.1 }) };
//! let body = world.add_body(&BodyDef { shapes: vec![shape], ..BodyDef::default() });
//! let hover = world.add_object(Box::new(Hover { body, height: 1.0, substeps: 0 }));
//! for _ in 0..300 {
//!     world.step();
//! }
//! let sag = world.mass(body).mass * 9.81 / 400.0;
//! assert!((world.center_of_mass(body).y - (1.0 - sag)).abs() < 1e-3);
//! assert_eq!(world.object::<Hover>(hover).substeps, 300 * 4);
//! ```

mod lockstep;
mod snapshot;
mod substep;

pub(crate) use lockstep::lockstep;
pub use substep::{Corrections, Forces, Substep};

use crate::arena::{Arena, Item};
use crate::body::def::Sleeping;
use crate::draw::DebugDraw;
use crate::id::{Lineage, ObjectId};
use crate::solver::Grading;
use crate::world::World;
use core::any::Any;
use lockstep::{Places, Roused};
use sinew_math::{ReadError, Reader, Writer};

/// User-defined behaviour in a world. See [the module](self) for the call order and an example.
///
/// The object must ensure that it gives the same bits everywhere: it computes with `sinew_math`, reads no clock, and
/// [`save`](Self::save)s all state that affects its future. The world panics on a non-finite number.
pub trait PhysicsObject: Any + Send + Sync {
    /// Name of the kind, the same in every build, because it is part of snapshots. Two kinds in a world must have
    /// different names.
    fn kind(&self) -> &'static str;

    /// Called first when the object is added to a world, to create its bodies and joints. Not called when a snapshot is
    /// loaded: the snapshot contains them. Default: nothing.
    fn init(&mut self, _world: &mut World) {}

    /// Applies forces, at the start of each substep. Default: nothing.
    fn add_forces(&mut self, _forces: &mut Forces<'_>) {}

    /// Applies corrections in each substep, after bodies and particles have moved. Default: nothing.
    fn satisfy_constraints(&mut self, _corrections: &mut Corrections<'_>) {}

    /// Draws the object, as part of [`World::draw`]. Default: nothing.
    fn draw(&self, _world: &World, _out: &mut dyn DebugDraw) {}

    /// Writes all state that affects the future of the object.
    fn save(&self, w: &mut Writer);

    /// Restores the state that [`save`](Self::save) wrote. The number of bytes is stored separately, so that a mistake
    /// here corrupts nothing else.
    ///
    /// # Errors
    /// If `save` could not have written the bytes. The state is then unspecified, and the world restores the previous
    /// state.
    fn load(&mut self, r: &mut Reader<'_>) -> Result<(), ReadError>;
}

/// Function that creates an object of a kind, into which a snapshot is then loaded.
type Make = fn() -> Box<dyn PhysicsObject>;

/// Objects of a world.
#[derive(Default)]
pub(crate) struct Objects {
    pub(crate) arena: Arena<Box<dyn PhysicsObject>>,
    /// Kinds that snapshots may contain.
    pub(crate) kinds: Vec<(&'static str, Make)>,
    places: Places,
    roused: Vec<Roused>,
}

impl Item for Box<dyn PhysicsObject> {
    type Id = ObjectId;
}

impl Objects {
    /// Returns an empty set of objects for a world.
    pub fn new(lineage: Lineage) -> Self {
        Self { arena: Arena::new(lineage), ..Self::default() }
    }

    /// Returns an empty set with the same registered kinds.
    pub fn without_any(&self) -> Self {
        Self { kinds: self.kinds.clone(), ..Self::default() }
    }

    /// Grading of substeps. Objects act in every substep of the world, so with objects all islands use the world's
    /// substeps.
    pub fn grading(&self) -> Grading {
        if self.is_empty() { Grading::ByContent } else { Grading::None }
    }

    /// Permission of particle groups to sleep: off with objects, which may access groups in every substep.
    pub fn let_sleep(&self) -> Sleeping {
        if self.is_empty() { Sleeping::On } else { Sleeping::Off }
    }

    pub fn is_empty(&self) -> bool {
        self.arena.is_empty()
    }
}
