//! Owners of bodies and joints. World methods refuse to remove an owned body or joint.

use crate::body::owner::Owner;
use crate::id::{BodyId, JointId};
use crate::world::World;

impl World {
    /// Assigns bodies to an owner, `bodies[i]` as its part `parts[i]`. From then on [`remove_body`](Self::remove_body)
    /// panics for these bodies and names the method to use instead. For code that depends on its bodies, such as
    /// characters; it releases them by [`disown_body`](Self::disown_body) before it removes them. Ownership does not
    /// affect a step, and is part of snapshots.
    ///
    /// ```should_panic
    /// use sinew_physics::{BodyDef, Owner, Shape, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default());
    /// let wheel = world.add_body(&BodyDef::dynamic(Shape::sphere(0.3)));
    /// let car = Owner {
    ///     name: "car".into(),
    ///     calls: "`Car::scrap` takes all of it out".into(),
    ///     parts: vec!["front wheel".into()],
    /// };
    /// world.own_bodies(&car, &[wheel], &[0]);
    /// world.remove_body(wheel); // "BodyId 0v0 is the car's front wheel: `Car::scrap` takes all of it out"
    /// ```
    ///
    /// # Panics
    /// If the lists differ in length, or the owner has no such part.
    #[track_caller]
    pub fn own_bodies(&mut self, owner: &Owner, bodies: &[BodyId], parts: &[usize]) {
        assert_eq!(bodies.len(), parts.len(), "each body is a part");
        let number = self.owners.number(owner);
        for (&body, &part) in bodies.iter().zip(parts) {
            self.expect_mut(body).owner = Some(self.owners.mark(number, part));
        }
    }

    /// Assigns joints to an owner, `joints[i]` as the joint of its part `parts[i]`, as [`own_bodies`](Self::own_bodies)
    /// does with bodies.
    ///
    /// # Panics
    /// If the lists differ in length, or the owner has no such part.
    #[track_caller]
    pub fn own_joints(&mut self, owner: &Owner, joints: &[JointId], parts: &[usize]) {
        assert_eq!(joints.len(), parts.len(), "each joint holds a part");
        let number = self.owners.number(owner);
        for (&joint, &part) in joints.iter().zip(parts) {
            self.joints.expect_mut(joint).owner = Some(self.owners.mark(number, part));
        }
    }

    /// Releases a body from its owner.
    #[track_caller]
    pub fn disown_body(&mut self, body: BodyId) {
        self.expect_mut(body).owner = None;
    }

    /// Releases a joint from its owner.
    #[track_caller]
    pub fn disown_joint(&mut self, joint: JointId) {
        self.joints.expect_mut(joint).owner = None;
    }

    /// Returns the owner of a body and the name of the part; `None` if the body has no owner.
    #[track_caller]
    pub fn body_owner(&self, body: BodyId) -> Option<(&Owner, &str)> {
        self.expect(body).owner.map(|mark| self.owners.of(mark))
    }

    /// Returns the owner of a joint and the name of the joint's part; `None` if the joint has no owner.
    #[track_caller]
    pub fn joint_owner(&self, joint: JointId) -> Option<(&Owner, &str)> {
        self.joints.expect(joint).owner.map(|mark| self.owners.of(mark))
    }

    /// Panics if a body has an owner.
    #[track_caller]
    pub(super) fn expect_own_body(&self, body: BodyId) {
        if let Some((owner, part)) = self.body_owner(body) {
            panic!("{body:?} is the {}'s {part}: {}", owner.name, owner.calls);
        }
    }

    /// Panics if a joint has an owner.
    #[track_caller]
    pub(super) fn expect_own_joint(&self, joint: JointId) {
        if let Some((owner, part)) = self.joint_owner(joint) {
            panic!("{joint:?} holds the {}'s {part}: {}", owner.name, owner.calls);
        }
    }
}
