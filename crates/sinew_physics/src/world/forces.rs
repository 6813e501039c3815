//! World methods for forces and impulses.

use crate::body::def::BodyKind;
use crate::body::force::{ForceDef, ForceId, Wrench, finite_change};
use crate::id::BodyId;
use crate::world::World;
use sinew_math::{Mat3, Sym3, Vec3, skew};

impl World {
    /// Applies an impulse (N·s) at a world point: changes the velocity immediately, `Δv = J/m`, `Δω = I⁻¹ ((p − c) ×
    /// J)`. An impulse does not move static and kinematic bodies; the next step reports its effect on a kinematic body
    /// in [`Events::pushed`](crate::Events::pushed).
    #[track_caller]
    pub fn apply_impulse(&mut self, id: BodyId, impulse: Vec3, point: Vec3) {
        assert!(
            impulse.is_finite() && point.is_finite(),
            "an impulse must be finite, not {impulse:?} and {point:?} ({id:?})"
        );
        self.wake_body(id.index);
        let dt = self.def.dt();
        let body = self.expect_mut(id);
        let arm = point - body.center();
        if body.kind == BodyKind::Kinematic {
            return body.note_push(impulse / dt, arm.cross(impulse) / dt);
        }
        body.velocity.linear += finite_change(impulse, |impulse| impulse * body.inverse_mass());
        body.velocity.angular +=
            finite_change(impulse, |impulse| body.inverse_inertia_mul(arm.cross(impulse)));
    }

    /// Applies an impulse (N·s) at the centre of mass: `Δv = J/m`, without spin.
    #[track_caller]
    pub fn apply_impulse_at_center(&mut self, id: BodyId, impulse: Vec3) {
        self.apply_impulse(id, impulse, self.center_of_mass(id));
    }

    /// Applies an angular impulse (N·m·s): `Δω = I⁻¹ L`.
    #[track_caller]
    pub fn apply_angular_impulse(&mut self, id: BodyId, impulse: Vec3) {
        assert!(impulse.is_finite(), "an impulse must be finite, not {impulse:?} ({id:?})");
        self.wake_body(id.index);
        let dt = self.def.dt();
        let body = self.expect_mut(id);
        if body.kind == BodyKind::Kinematic {
            return body.note_push(Vec3::ZERO, impulse / dt);
        }
        body.velocity.angular += finite_change(impulse, |impulse| body.inverse_inertia_mul(impulse));
    }

    /// Applies a force (N) at a world point; it is constant over the next step and cleared after it. The torque is
    /// about the centre of mass at its current position.
    #[track_caller]
    pub fn apply_force(&mut self, id: BodyId, force: Vec3, point: Vec3) {
        assert!(
            force.is_finite() && point.is_finite(),
            "a force must be finite, not {force:?} and {point:?} ({id:?})"
        );
        let torque = (point - self.center_of_mass(id)).cross(force);
        self.apply_wrench(id, Wrench { force, torque });
    }

    /// Applies a force (N) at the centre of mass for the next step.
    #[track_caller]
    pub fn apply_force_at_center(&mut self, id: BodyId, force: Vec3) {
        assert!(force.is_finite(), "a force must be finite, not {force:?} ({id:?})");
        self.apply_wrench(id, Wrench { force, torque: Vec3::ZERO });
    }

    /// Applies a torque (N·m) for the next step.
    #[track_caller]
    pub fn apply_torque(&mut self, id: BodyId, torque: Vec3) {
        assert!(torque.is_finite(), "a torque must be finite, not {torque:?} ({id:?})");
        self.apply_wrench(id, Wrench { force: Vec3::ZERO, torque });
    }

    fn apply_wrench(&mut self, id: BodyId, Wrench { force, torque }: Wrench) {
        self.wake_body(id.index);
        let body = self.expect_mut(id);
        match body.kind {
            BodyKind::Static => {}
            BodyKind::Kinematic => body.note_push(force, torque),
            BodyKind::Dynamic => {
                body.force += force;
                body.torque += torque;
            }
        }
    }

    /// Adds a force that acts on a body until it is changed or removed; the body wakes. A body that does not move under
    /// the force may fall asleep.
    ///
    /// # Panics
    /// If a number is not finite.
    #[track_caller]
    #[doc(alias = "constant force")]
    pub fn add_force(&mut self, body: BodyId, def: &ForceDef) -> ForceId {
        assert!(def.is_finite(), "a force must be finite, not {def:?} ({body:?})");
        self.wake_body(body.index);
        let forces = &mut self.expect_mut(body).forces;
        let number = forces.next;
        forces.next += 1;
        forces.list.push((number, *def));
        ForceId::new(body, number)
    }

    /// Changes a lasting force; the body wakes.
    ///
    /// # Panics
    /// If a number is not finite, or the force does not exist.
    pub fn set_force(&mut self, id: ForceId, def: &ForceDef) {
        assert!(def.is_finite(), "a force must be finite, not {def:?} ({id:?})");
        self.wake_body(id.body().index);
        let forces = &mut self.expect_mut(id.body()).forces;
        let place = forces.place(id);
        forces.list[place].1 = *def;
    }

    /// Removes a lasting force; the body wakes.
    ///
    /// # Panics
    /// If the force does not exist.
    pub fn remove_force(&mut self, id: ForceId) {
        self.wake_body(id.body().index);
        let forces = &mut self.expect_mut(id.body()).forces;
        let place = forces.place(id);
        forces.list.remove(place);
    }

    /// Returns the current definition of a lasting force.
    ///
    /// # Panics
    /// If the force does not exist.
    pub fn force(&self, id: ForceId) -> ForceDef {
        let forces = &self.expect(id.body()).forces;
        forces.list[forces.place(id)].1
    }

    /// Iterates over the lasting forces of a body, in the order of creation.
    #[track_caller]
    pub fn forces_of(&self, body: BodyId) -> impl Iterator<Item = ForceId> {
        self.expect(body).forces.list.iter().map(move |&(number, _)| ForceId::new(body, number))
    }

    /// Applies the impact of a bullet of `mass` (kg) and `velocity` (m/s) that hits a body at a world point and stays
    /// in it. Returns the impulse (N·s) on the body.
    ///
    /// The hit is perfectly inelastic: afterwards the bullet and the hit point have the same velocity. With `r` from
    /// the centre of mass to the point and `u` the velocity of the point before the hit, the relative velocity per unit
    /// impulse is `K = (1/m + 1/M) 1 − [r]× I⁻¹ [r]×`, and the impulse is
    ///
    /// ```text
    /// J = K⁻¹ (velocity − u)        through the centre: J = m M / (m + M) (velocity − u)
    /// ```
    ///
    /// (Mirtich, "Impulse-based Dynamic Simulation", 1996, §3.3, without rebound). The impulse is less than `mass ×
    /// velocity`, because the bullet keeps a part of its momentum and moves on with the body. The total momentum is
    /// conserved, so a free block leaves at `m v / (m + M)`.
    ///
    /// **The bullet's mass is not added to the body.** For that, model the bullet as a body with a fixed joint. Joints
    /// of the body transmit the impact in the next step; they do not increase its mass here. Static and kinematic
    /// bodies do not react: the returned impulse is then the one that stops the bullet.
    ///
    /// # Panics
    /// If a number is not finite, or the mass not positive.
    #[track_caller]
    pub fn apply_bullet_impact(&mut self, id: BodyId, mass: f32, velocity: Vec3, point: Vec3) -> Vec3 {
        assert!(
            mass > 0.0 && mass < f32::INFINITY,
            "a bullet's mass is positive and finite, not {mass:?} ({id:?})"
        );
        assert!(
            velocity.is_finite() && point.is_finite(),
            "a bullet's velocity and place must be finite, not {velocity:?} and {point:?} ({id:?})"
        );
        let body = self.expect(id);
        let arm = point - body.center();
        let turn = skew(arm);
        let columns = [Vec3::X, Vec3::Y, Vec3::Z].map(|e| body.inverse_inertia_mul(turn * e));
        // K times the effective mass of a central hit: of order 1 for all masses.
        let reduced = 1.0 / (1.0 / mass + body.inverse_mass());
        let gained = Mat3::IDENTITY - turn * Mat3::from_cols(columns[0], columns[1], columns[2]) * reduced;
        let impulse = Sym3::from_mat3(&gained).inverse() * (velocity - body.velocity.at(arm)) * reduced;
        self.apply_impulse(id, impulse, point);
        impulse
    }
}
