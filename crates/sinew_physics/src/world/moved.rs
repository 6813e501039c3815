//! Bodies that the last step moved.

use crate::id::BodyId;
use crate::world::World;

impl World {
    /// Iterates over the bodies that the last step moved, each once, in unspecified order: a renderer must update only
    /// these. Bodies that fell asleep in the step are included for the last time. Bodies teleported by
    /// [`set_transform`](Self::set_transform) are not included, and there are none after [`load`](Self::load), until a
    /// step is taken.
    ///
    /// ```
    /// use sinew_physics::{BodyDef, Shape, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default());
    /// world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    /// let ball = world.add_body(&BodyDef::dynamic(Shape::sphere(0.5)));
    /// world.step();
    /// for id in world.bodies_moved() {
    ///     assert_eq!(id, ball); // and draw it at `world.transform(id)`
    /// }
    /// ```
    #[doc(alias = "body move events")]
    #[doc(alias = "active_bodies")]
    pub fn bodies_moved(&self) -> impl Iterator<Item = BodyId> {
        let moved = |index: &u32| {
            let body = self.bodies.try_at(*index);
            body.is_some_and(|body| !body.is_awake() || body.previous != body.world_from_principal)
        };
        let led = self.activity.kinematic().iter().copied();
        let all = self.islands.moved().map(|solved| solved.chain(led));
        all.into_iter().flatten().filter(moved).map(|index| self.bodies.id(index))
    }
}
