//! Copies of a world.

use crate::world::World;
use sinew_math::{Reader, Writer};

/// Copies a world; the copy has the same future, bit for bit, including new ids. Shapes with data are shared, not
/// copied. [`World::save`] needs less memory if a snapshot suffices.
///
/// ```
/// use sinew_physics::{BodyDef, Shape, World, WorldDef};
///
/// let mut world = World::new(WorldDef::default());
/// let ball = world.add_body(&BodyDef::dynamic(Shape::sphere(0.5)));
/// let mut guess = world.clone(); // where will it be in a second?
/// (0..60).for_each(|_| guess.step());
/// assert!(guess.transform(ball).translation.y < -4.0);
/// assert_eq!(world.transform(ball).translation.y, 0.0);
/// ```
///
/// # Panics
/// If the world has an object of an [unregistered](World::register_kind) kind, or one that rejects its own saved state:
/// objects are copied by their state.
impl Clone for World {
    fn clone(&self) -> Self {
        let mut copy = Self {
            def: self.def.clone(),
            bodies: self.bodies.clone(),
            joints: self.joints.clone(),
            contacts: self.contacts.clone(),
            activity: self.activity.clone(),
            groups: self.groups.clone(),
            fields: self.fields.clone(),
            functions: self.functions.clone(),
            library: self.library.clone(),
            owners: self.owners.clone(),
            objects: self.objects.without_any(),
            movers: self.movers.copy(),
            parted: self.parted.clone(),
            meetings: self.meetings.clone(),
            events: self.events.clone(),
            broad: self.broad.clone(),
            parts: self.parts.clone(),
            pinches: self.pinches.clone(),
            islands: self.islands.clone(),
            sleepers: self.sleepers,
            steps: self.steps,
            pending_nanoseconds: self.pending_nanoseconds,
            work: self.work,
            around: Vec::new(),
            marked: self.marked.clone(),
        };
        let mut objects = Writer::new();
        self.objects.save(&mut objects);
        let taken = copy.objects.load(&mut Reader::new(objects.as_bytes()));
        taken.expect("every object is of a registered kind and takes its own state");
        copy
    }
}
