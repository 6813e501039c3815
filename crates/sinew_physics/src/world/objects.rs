//! The objects of a world: made, asked, taken out.

use crate::draw::DebugDraw;
use crate::id::ObjectId;
use crate::user_object::PhysicsObject;
use crate::world::World;
use core::any::Any;

impl World {
    /// Adds an object of the user's own: [`init`](PhysicsObject::init) is called at once, the rest from the next step on.
    pub fn add_object(&mut self, mut object: Box<dyn PhysicsObject>) -> ObjectId {
        object.init(self);
        self.objects.arena.insert(object)
    }

    /// Takes an object out and gives it back; bodies that it made remain.
    #[track_caller]
    pub fn remove_object(&mut self, id: ObjectId) -> Box<dyn PhysicsObject> {
        self.objects.arena.take(id)
    }

    /// An object.
    ///
    /// # Panics
    /// If it is of another type.
    #[track_caller]
    pub fn object<T: PhysicsObject>(&self, id: ObjectId) -> &T {
        let object = self.objects.arena.expect(id);
        let object: &dyn Any = object.as_ref();
        object.downcast_ref().unwrap_or_else(|| panic!("{id:?} is no {}", core::any::type_name::<T>()))
    }

    /// An object, to be changed.
    ///
    /// # Panics
    /// If it is of another type.
    #[track_caller]
    pub fn object_mut<T: PhysicsObject>(&mut self, id: ObjectId) -> &mut T {
        let object = self.objects.arena.expect_mut(id);
        let object: &mut dyn Any = object.as_mut();
        object.downcast_mut().unwrap_or_else(|| panic!("{id:?} is no {}", core::any::type_name::<T>()))
    }

    /// All objects, by index.
    pub fn object_ids(&self) -> impl Iterator<Item = ObjectId> {
        self.objects.arena.ids()
    }

    /// True if the id names an object that is there.
    pub fn contains_object(&self, id: ObjectId) -> bool {
        self.objects.arena.get(id).is_some()
    }

    pub(crate) fn draw_objects(&self, out: &mut dyn DebugDraw) {
        for (_, object) in self.objects.arena.iter() {
            object.draw(self, out);
        }
    }

    /// Lets [`load`](Self::load) make objects of a kind that it finds in a snapshot and the world does not have: in a
    /// new world, or when an object was taken out since. A kind that is told again replaces the one told before.
    pub fn register_kind(&mut self, make: fn() -> Box<dyn PhysicsObject>) {
        let kind = make().kind();
        self.objects.kinds.retain(|&(known, _)| known != kind);
        self.objects.kinds.push((kind, make));
    }
}
