//! World methods for objects: adding, queries, removal.

use crate::draw::DebugDraw;
use crate::id::ObjectId;
use crate::user_object::PhysicsObject;
use crate::world::World;
use core::any::Any;

impl World {
    /// Adds an object of the user's own kind. Calls [`init`](PhysicsObject::init) now, and the other methods from the
    /// next step on.
    pub fn add_object(&mut self, mut object: Box<dyn PhysicsObject>) -> ObjectId {
        object.init(self);
        self.objects.arena.insert(object)
    }

    /// Removes an object and returns it; the bodies that it created remain.
    #[track_caller]
    pub fn remove_object(&mut self, id: ObjectId) -> Box<dyn PhysicsObject> {
        self.objects.arena.take(id)
    }

    /// Returns an object.
    ///
    /// # Panics
    /// If the object is of another type.
    #[track_caller]
    pub fn object<T: PhysicsObject>(&self, id: ObjectId) -> &T {
        let object = self.objects.arena.expect(id);
        let object: &dyn Any = object.as_ref();
        object.downcast_ref().unwrap_or_else(|| panic!("{id:?} is no {}", core::any::type_name::<T>()))
    }

    /// Returns an object, mutable.
    ///
    /// # Panics
    /// If the object is of another type.
    #[track_caller]
    pub fn object_mut<T: PhysicsObject>(&mut self, id: ObjectId) -> &mut T {
        let object = self.objects.arena.expect_mut(id);
        let object: &mut dyn Any = object.as_mut();
        object.downcast_mut().unwrap_or_else(|| panic!("{id:?} is no {}", core::any::type_name::<T>()))
    }

    /// Iterates over all objects, by index.
    pub fn object_ids(&self) -> impl Iterator<Item = ObjectId> {
        self.objects.arena.ids()
    }

    /// True if the id names an existing object.
    pub fn contains_object(&self, id: ObjectId) -> bool {
        self.objects.arena.get(id).is_some()
    }

    pub(crate) fn draw_objects(&self, out: &mut dyn DebugDraw) {
        for (_, object) in self.objects.arena.iter() {
            object.draw(self, out);
        }
    }

    /// Registers a kind of objects. [`load`](Self::load) can then create an object of this kind if a snapshot contains
    /// one that the world does not have: in a new world, or after an object was removed. A repeated registration
    /// replaces the earlier one.
    pub fn register_kind(&mut self, make: fn() -> Box<dyn PhysicsObject>) {
        let kind = make().kind();
        self.objects.kinds.retain(|&(known, _)| known != kind);
        self.objects.kinds.push((kind, make));
    }
}
