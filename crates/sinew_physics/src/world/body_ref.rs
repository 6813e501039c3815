//! A reference to a body, for queries without repeating its id.

use crate::body::Velocity;
use crate::body::def::{BodyKind, Sleeping};
use crate::body::shape::MassProperties;
use crate::boxes::Aabb;
use crate::id::{BodyId, JointId, ShapeId};
use crate::world::World;
use core::fmt;
use sinew_math::{Transform, Vec3};

/// Reference to a body of a world, for queries; from [`World::get`].
#[derive(Clone, Copy)]
pub struct BodyRef<'a> {
    world: &'a World,
    id: BodyId,
}

impl fmt::Debug for BodyRef<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (kind, transform, velocity) = (self.kind(), self.transform(), self.velocity());
        let mut out = f.debug_struct("BodyRef");
        out.field("id", &self.id).field("kind", &kind);
        out.field("transform", &transform).field("velocity", &velocity).finish_non_exhaustive()
    }
}

impl World {
    /// Returns a reference to a body, or `None` if the id is stale.
    ///
    /// ```
    /// use sinew_physics::{BodyDef, Shape, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default());
    /// let ball = world.add_body(&BodyDef::dynamic(Shape::sphere(0.5)));
    /// assert_eq!(world.get(ball).map(|ball| ball.is_awake()), Some(true));
    /// world.remove_body(ball);
    /// assert!(world.get(ball).is_none());
    /// ```
    #[doc(alias = "RigidBody")]
    #[doc(alias = "body")]
    pub fn get(&self, id: BodyId) -> Option<BodyRef<'_>> {
        self.contains(id).then_some(BodyRef { world: self, id })
    }

    /// Iterates over all bodies, by index.
    #[doc(alias = "RigidBodySet")]
    pub fn bodies(&self) -> impl Iterator<Item = BodyRef<'_>> {
        self.body_ids().map(|id| BodyRef { world: self, id })
    }
}

/// Each method has the effect of the [`World`] method with the same name.
impl<'a> BodyRef<'a> {
    /// Id of the body.
    pub fn id(self) -> BodyId {
        self.id
    }

    /// Kind of the body: static, kinematic or dynamic.
    pub fn kind(self) -> BodyKind {
        self.world.kind(self.id)
    }

    /// Pose of the body's frame, world.
    pub fn transform(self) -> Transform {
        self.world.transform(self.id)
    }

    /// Pose of the body between the last step (`alpha` 0) and this one (1), world.
    pub fn interpolated(self, alpha: f32) -> Transform {
        self.world.interpolated(self.id, alpha)
    }

    /// World position of the centre of mass, metres.
    pub fn center_of_mass(self) -> Vec3 {
        self.world.center_of_mass(self.id)
    }

    /// Velocity of the centre of mass (m/s) and angular velocity (rad/s), world axes.
    pub fn velocity(self) -> Velocity {
        self.world.velocity(self.id)
    }

    /// Velocity of the body's material at a world point, m/s, world axes.
    #[doc(alias = "velocity_at_point")]
    pub fn velocity_at(self, point: Vec3) -> Vec3 {
        self.velocity().at(point - self.center_of_mass())
    }

    /// Mass (kg; 0 unless dynamic), centre (metres) and inertia (kg·m²) in the body's frame.
    pub fn mass(self) -> MassProperties {
        self.world.mass(self.id)
    }

    /// False while the body sleeps.
    pub fn is_awake(self) -> bool {
        self.world.is_awake(self.id)
    }

    /// Permission of the body to fall asleep.
    pub fn sleeping(self) -> Sleeping {
        self.world.sleeping(self.id)
    }

    /// Damping of linear velocity, 1/s.
    pub fn linear_damping(self) -> f32 {
        self.world.linear_damping(self.id)
    }

    /// Damping of angular velocity, 1/s.
    pub fn angular_damping(self) -> f32 {
        self.world.angular_damping(self.id)
    }

    /// Factor on the world's gravity, without unit.
    pub fn gravity_scale(self) -> f32 {
        self.world.gravity_scale(self.id)
    }

    /// User data of the body.
    pub fn user_data(self) -> u64 {
        self.world.user_data(self.id)
    }

    /// Bounds of the body's shapes, world, metres.
    pub fn bounds(self) -> Aabb {
        self.world.bounds(self.id)
    }

    /// Iterates over the shapes of the body.
    pub fn shape_ids(self) -> impl Iterator<Item = ShapeId> {
        self.world.shape_ids(self.id)
    }

    /// Iterates over the joints of the body, by index.
    pub fn joints(self) -> impl Iterator<Item = JointId> + use<'a> {
        self.world.joints_of(self.id)
    }
}
