//! Kinds of the user's own: objects that push bodies and particles, and hold them where the world's own shapes and
//! joints cannot.
//!
//! An object is asked twice in each substep, on one thread, in the order of ids: for forces before anything moves, and
//! for corrections when everything has moved, before velocities are relaxed. It may have state, which goes into
//! snapshots and so into [`World::hash`], and comes back with [`World::reset`].
//!
//! A world without objects takes the way that it would take if there were no such thing.
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

/// Behaviour in a world of a kind of the user's own. See [the module](self) for when it is asked, and for an example.
///
/// The same bits everywhere are the object's own business as well: it computes with `sinew_math`, reads no clock, and
/// keeps what decides its future in what it [`save`](Self::save)s. A number that is not finite panics where it is handed
/// to the world.
pub trait PhysicsObject: Any + Send + Sync {
    /// Name of the kind, the same in every build: it goes into snapshots. Two kinds in a world have two names.
    fn kind(&self) -> &'static str;

    /// When it is added to a world, before anything else: makes the bodies and joints that it needs. Not called when a
    /// snapshot is loaded: those are in it. Default: nothing.
    fn init(&mut self, _world: &mut World) {}

    /// At the beginning of each substep: pushes. Default: nothing.
    fn add_forces(&mut self, _forces: &mut Forces<'_>) {}

    /// In each substep when bodies and particles have moved: puts right what must not be as it is. Default: nothing.
    fn satisfy_constraints(&mut self, _corrections: &mut Corrections<'_>) {}

    /// Draws itself, as part of [`World::draw`]. Default: nothing.
    fn draw(&self, _world: &World, _out: &mut dyn DebugDraw) {}

    /// Writes the state that decides its future.
    fn save(&self, w: &mut Writer);

    /// Brings back what [`save`](Self::save) wrote, all of it; how many bytes that were is known, so that a mistake
    /// here breaks nothing else.
    ///
    /// # Errors
    /// If the bytes are none that `save` writes. The state may be anything then: the world puts it back.
    fn load(&mut self, r: &mut Reader<'_>) -> Result<(), ReadError>;
}

/// Makes an object of some kind, for a snapshot to be loaded into.
type Make = fn() -> Box<dyn PhysicsObject>;

/// The objects of a world.
#[derive(Default)]
pub(crate) struct Objects {
    pub(crate) arena: Arena<Box<dyn PhysicsObject>>,
    /// Kinds that snapshots may bring.
    pub(crate) kinds: Vec<(&'static str, Make)>,
    places: Places,
    roused: Vec<Roused>,
}

impl Item for Box<dyn PhysicsObject> {
    type Id = ObjectId;
}

impl Objects {
    /// None, of a world.
    pub fn new(lineage: Lineage) -> Self {
        Self { arena: Arena::new(lineage), ..Self::default() }
    }

    /// Objects of the same kinds and world, none yet.
    pub fn without_any(&self) -> Self {
        Self { kinds: self.kinds.clone(), ..Self::default() }
    }

    /// They act in every substep of the world's, so that with any all islands take those.
    pub fn grading(&self) -> Grading {
        if self.is_empty() { Grading::ByContent } else { Grading::None }
    }

    /// Permission of particle groups to sleep: objects see and push them in every substep.
    pub fn let_sleep(&self) -> Sleeping {
        if self.is_empty() { Sleeping::On } else { Sleeping::Off }
    }

    pub fn is_empty(&self) -> bool {
        self.arena.is_empty()
    }
}
