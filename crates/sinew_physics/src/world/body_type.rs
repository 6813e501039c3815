//! Changes of a body's kind: static, kinematic or dynamic.

use crate::body::def::BodyKind;
use crate::body::shape::Shape;
use crate::body::{Velocity, expect_solid, principal_frame};
use crate::id::BodyId;
use crate::world::World;
use sinew_math::Vec3;

impl World {
    /// Makes a body static, kinematic or dynamic; the body wakes, with its touching and jointed bodies. Pose and
    /// velocity do not change, except that a static body has no velocity: a kinematic body that becomes dynamic keeps
    /// its velocity. While the body is not dynamic its mass is 0. When it becomes dynamic, it gets its previous mass,
    /// or the one set by [`set_mass`](Self::set_mass) since, or otherwise the mass by its shapes' densities. Joints
    /// between two non-dynamic bodies have no effect.
    ///
    /// ```
    /// use sinew_physics::{BodyDef, BodyKind, Shape, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default());
    /// let brick = world.add_body(&BodyDef::fixed(Shape::sphere(0.1)));
    /// world.step();
    /// assert_eq!(world.transform(brick).translation.y, 0.0);
    /// world.set_kind(brick, BodyKind::Dynamic);
    /// world.step();
    /// assert!(world.transform(brick).translation.y < 0.0);
    /// ```
    ///
    /// # Panics
    /// If a body with a half-space would move, or a body without mass would become dynamic.
    #[doc(alias = "set_body_type")]
    #[doc(alias = "motion type")]
    #[track_caller]
    pub fn set_kind(&mut self, id: BodyId, kind: BodyKind) {
        let body = self.expect(id);
        if body.kind == kind {
            return;
        }
        let moves = kind != BodyKind::Static;
        let endless = body.shapes.iter().any(|shape| shape.shape == Shape::HalfSpace);
        assert!(!(moves && endless), "half-spaces are static bodies ({id:?})");
        let mut weight =
            if body.kind == BodyKind::Dynamic { Some((body.mass, body.inertia)) } else { body.laid_by };
        let mut principal_from_body = body.principal_from_body;
        if kind == BodyKind::Dynamic && weight.is_none() {
            let properties = body.mass_of_shapes();
            let (moments, body_from_principal) = principal_frame(&properties);
            expect_solid(properties.mass, moments);
            weight = Some((properties.mass, moments));
            principal_from_body = body_from_principal.inverse();
        }
        let was_static = body.kind == BodyKind::Static;
        self.mark_changed(id);
        let body = self.bodies.at_mut(id.index);
        body.kind = kind;
        (body.force, body.torque) = (Vec3::ZERO, Vec3::ZERO);
        (body.mass, body.inertia, body.laid_by) = match (kind, weight) {
            (BodyKind::Dynamic, Some((mass, moments))) => (mass, moments, None),
            _ => (0.0, Vec3::ZERO, weight),
        };
        if !moves {
            body.velocity = Velocity::default();
            body.previous = body.world_from_principal;
        }
        self.activity.change_kind(id.index, self.bodies.at(id.index));
        self.put_principal_frame(id, principal_from_body);
        if was_static == moves {
            self.renew_bounds(id);
        } else {
            self.broad.proxies.refresh(id.index, self.bodies.at(id.index));
        }
    }
}
