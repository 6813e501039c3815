//! World methods that change mass, damping, gravity scale and user data of bodies.

use crate::body::def::BodyKind;
use crate::body::shape::MassProperties;
use crate::body::{expect_solid, principal_frame};
use crate::contact::recycled::Recycled;
use crate::id::BodyId;
use crate::world::World;
use sinew_math::Transform;

impl World {
    /// Sets a body's mass (kg), centre of mass (metres) and inertia (kg·m² about the centre), both in the body's frame.
    /// Its pose and the velocities of its points do not change; the body wakes, with touching and jointed bodies. A
    /// non-dynamic body gets these values when it [becomes](Self::set_kind) dynamic.
    ///
    /// ```
    /// use sinew_physics::{BodyDef, MassProperties, Shape, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default());
    /// let ball = world.add_body(&BodyDef::dynamic(Shape::sphere(0.5)));
    /// let heavy = Shape::sphere(0.5).mass_properties(7800.0);
    /// world.set_mass(ball, MassProperties { center: sinew_math::Vec3::Y * -0.3, ..heavy });
    /// assert_eq!(world.mass(ball).mass, heavy.mass);
    /// assert_eq!(world.center_of_mass(ball).y, -0.3);
    /// ```
    ///
    /// # Panics
    /// If a number is not finite, or mass or moments are not positive.
    #[doc(alias = "set_mass_properties")]
    #[doc(alias = "inertia tensor")]
    #[doc(alias = "center of mass")]
    #[track_caller]
    pub fn set_mass(&mut self, id: BodyId, properties: MassProperties) {
        let finite =
            properties.mass.is_finite() && properties.center.is_finite() && properties.inertia.is_finite();
        assert!(finite, "a body's mass, centre and inertia must be finite, not {properties:?} ({id:?})");
        let (moments, body_from_principal) = principal_frame(&properties);
        expect_solid(properties.mass, moments);
        self.mark_changed(id);
        let body = self.bodies.at_mut(id.index);
        if body.kind == BodyKind::Dynamic {
            (body.mass, body.inertia) = (properties.mass, moments);
        } else {
            body.laid_by = Some((properties.mass, moments));
        }
        self.put_principal_frame(id, body_from_principal.inverse());
    }

    /// Gives a body the mass, centre and inertia by its shapes' densities, like [`set_mass`](Self::set_mass).
    ///
    /// # Panics
    /// If the shapes have no mass.
    #[doc(alias = "recompute_mass_properties_from_colliders")]
    #[track_caller]
    pub fn set_mass_of_shapes(&mut self, id: BodyId) {
        self.set_mass(id, self.expect(id).mass_of_shapes());
    }

    /// Moves the principal frame of an awake body and converts the data stored in that frame.
    pub(super) fn put_principal_frame(&mut self, id: BodyId, principal_from_body: Transform) {
        let index = id.index;
        let body = self.bodies.at_mut(index);
        let old = body.principal_from_body;
        if old == principal_from_body {
            return;
        }
        body.set_principal_frame(principal_from_body);
        let new_from_old = principal_from_body * old.inverse();
        for &joint in self.activity.joints_of.body(index) {
            let joint = self.joints.at_mut(joint);
            let frame = if joint.a == index { &mut joint.frame_a } else { &mut joint.frame_b };
            *frame = new_from_old * *frame;
        }
        // Manifolds are stored in the frames of their bodies.
        let returned = self.activity.returned_mut();
        for contact in self.contacts.iter_mut().chain(returned).filter(|contact| contact.key.has(index)) {
            contact.kept = Recycled::default();
        }
        self.renew_bounds(id);
    }

    /// Recomputes the bounds of a body's shapes in the broad-phase trees.
    pub(super) fn renew_bounds(&mut self, id: BodyId) {
        self.broad.proxies.remove(id.index);
        self.broad.proxies.add(id.index, self.bodies.at(id.index));
    }

    /// Damping of linear velocity, 1/s.
    #[track_caller]
    pub fn linear_damping(&self, id: BodyId) -> f32 {
        self.expect(id).linear_damping
    }

    /// Sets the damping of linear velocity, 1/s: the share of the velocity lost per second.
    ///
    /// # Panics
    /// If the damping is not finite.
    #[track_caller]
    pub fn set_linear_damping(&mut self, id: BodyId, damping: f32) {
        assert!(damping.is_finite(), "a body's damping must be finite, not {damping:?} ({id:?})");
        self.expect_mut(id).linear_damping = damping;
    }

    /// Damping of angular velocity, 1/s.
    #[track_caller]
    pub fn angular_damping(&self, id: BodyId) -> f32 {
        self.expect(id).angular_damping
    }

    /// Sets the damping of angular velocity, 1/s: the share of the velocity lost per second.
    ///
    /// # Panics
    /// If the damping is not finite.
    #[track_caller]
    pub fn set_angular_damping(&mut self, id: BodyId, damping: f32) {
        assert!(damping.is_finite(), "a body's damping must be finite, not {damping:?} ({id:?})");
        self.expect_mut(id).angular_damping = damping;
    }

    /// Factor on the world's gravity for a body, without unit.
    #[track_caller]
    pub fn gravity_scale(&self, id: BodyId) -> f32 {
        self.expect(id).gravity_scale
    }

    /// Sets the factor on the world's gravity for a body, without unit; the body wakes if it changes. 0 disables
    /// gravity.
    ///
    /// # Panics
    /// If the factor is not finite.
    #[track_caller]
    pub fn set_gravity_scale(&mut self, id: BodyId, scale: f32) {
        assert!(scale.is_finite(), "a body's gravity scale must be finite, not {scale:?} ({id:?})");
        if core::mem::replace(&mut self.expect_mut(id).gravity_scale, scale) != scale {
            self.wake_body(id.index);
        }
    }

    /// Sets the user data of a body, such as an index or the bits of an entity. Part of snapshots.
    #[track_caller]
    pub fn set_user_data(&mut self, id: BodyId, user_data: u64) {
        self.expect_mut(id).user_data = user_data;
    }
}
