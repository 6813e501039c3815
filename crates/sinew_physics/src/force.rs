//! Forces, torques and impulses that the user gives bodies: for one step, until changed, or at once.
//!
//! World axes and SI units, unless said otherwise. A force `F` at a point `p` moves the centre of mass `c` as if it acted
//! there, and turns the body besides: `a = F/m`, `τ = (p − c) × F`, `α = I⁻¹ τ` (Newton, Euler). Several add up. Only
//! dynamic bodies feel any of them; a sleeping one wakes.

use crate::body::Body;
use crate::def::BodyKind;
use crate::id::BodyId;
use crate::world::World;
use sinew_math::{Mat3, ReadError, Reader, Sym3, Transform, Vec3, Writer, max, min, skew};

/// Force and torque about the centre of mass, world axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// N.
    pub force: Vec3,
    /// N·m.
    pub torque: Vec3,
}

/// Which axes a lasting force is given in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ForceFrame {
    /// The world's: it keeps its direction when the body turns, as a pull from far away does. Default.
    #[default]
    World,
    /// The body's: it turns with the body, as a thruster does.
    Body,
}

/// A force that acts on a body in every substep until it is changed or taken away.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceDef {
    /// N, in the axes of `frame`.
    pub force: Vec3,
    /// N·m, in the axes of `frame`, beside what `force` turns by its lever.
    pub torque: Vec3,
    /// Where `force` acts, metres in the body's frame: the point goes along with the body. `None`, the default: at the
    /// centre of mass.
    pub point: Option<Vec3>,
    /// Axes of `force` and `torque`. Default the world's.
    pub frame: ForceFrame,
}

impl ForceDef {
    pub(crate) fn is_finite(&self) -> bool {
        self.force.is_finite() && self.torque.is_finite() && self.point.is_none_or(Vec3::is_finite)
    }
}

/// A lasting force of a body of a [`World`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ForceId {
    body: BodyId,
    number: u32,
}

impl ForceId {
    /// The body that it acts on.
    pub fn body(self) -> BodyId {
        self.body
    }
}

/// Bytes of the shortest force.
const FORCE_BYTES: usize = 4 + 12 + 12 + 1 + 1;

/// The lasting forces of a body, by the number of their ids, ascending.
#[derive(Clone, Debug, Default)]
pub(crate) struct BodyForces {
    pub list: Vec<(u32, ForceDef)>,
    /// Number of the next one.
    pub next: u32,
}

impl BodyForces {
    pub fn save(&self, w: &mut Writer) {
        w.u32(self.next);
        w.count(self.list.len());
        for (number, def) in &self.list {
            w.u32(*number);
            w.vec3(def.force);
            w.vec3(def.torque);
            w.bool(def.point.is_some());
            if let Some(point) = def.point {
                w.vec3(point);
            }
            w.bool(def.frame == ForceFrame::Body);
        }
    }

    pub fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut forces = Self { list: Vec::new(), next: r.u32()? };
        for _ in 0..r.count(FORCE_BYTES)? {
            let (number, force, torque) = (r.u32()?, r.vec3()?, r.vec3()?);
            let point = if r.bool()? { Some(r.vec3()?) } else { None };
            let frame = if r.bool()? { ForceFrame::Body } else { ForceFrame::World };
            forces.list.push((number, ForceDef { force, torque, point, frame }));
        }
        let known = forces.list.last().is_none_or(|&(number, _)| number < forces.next);
        if !(known && forces.list.is_sorted_by(|a, b| a.0 < b.0)) {
            return Err(r.error("lasting forces are out of order"));
        }
        Ok(forces)
    }

    fn place(&self, id: ForceId) -> usize {
        self.list.binary_search_by_key(&id.number, |&(number, _)| number).expect("the force is there")
    }

    /// Their sum in the given pose of the body's principal frame.
    pub fn sum(&self, body: &Body, world_from_principal: Transform) -> Wrench {
        let mut sum = Wrench::default();
        let world_from_body = world_from_principal.rotation * body.principal_from_body.rotation;
        for (_, def) in &self.list {
            let turned = |v: Vec3| match def.frame {
                ForceFrame::World => v,
                ForceFrame::Body => world_from_body * v,
            };
            let force = turned(def.force);
            sum.force += force;
            sum.torque += turned(def.torque);
            if let Some(point) = def.point {
                let arm = world_from_principal.rotation * body.principal_from_body.point(point);
                sum.torque += arm.cross(force);
            }
        }
        sum
    }
}

/// Change of a velocity by an impulse, with its direction if it is beyond all measure: the next step slows the body to what its world
/// allows.
fn finite_change(impulse: Vec3, change: impl Fn(Vec3) -> Vec3) -> Vec3 {
    // Beyond the first, products with arms and inverse masses may not be finite; beyond the second, squares of sums are not.
    const HUGE: f32 = 1e15;
    const MOST: f32 = 1e30;
    const SCALE: f32 = 1e-20;
    let largest = |v: Vec3| max(max(v.x.abs(), v.y.abs()), v.z.abs());
    if largest(impulse) <= HUGE {
        return change(impulse);
    }
    let small = change(impulse * SCALE);
    small * min(1.0 / SCALE, MOST / max(largest(small), f32::MIN_POSITIVE))
}

impl World {
    /// Impulse (N·s) at a world point: changes the velocity at once, `Δv = J/m`, `Δω = I⁻¹ ((p − c) × J)`. No effect on
    /// static and kinematic bodies.
    #[track_caller]
    pub fn apply_impulse(&mut self, id: BodyId, impulse: Vec3, point: Vec3) {
        assert!(impulse.is_finite() && point.is_finite(), "an impulse is finite");
        self.wake_body(id.index);
        let body = self.expect_mut(id);
        let arm = point - body.center();
        body.velocity.linear += finite_change(impulse, |impulse| impulse * body.inverse_mass());
        body.velocity.angular +=
            finite_change(impulse, |impulse| body.inverse_inertia_mul(arm.cross(impulse)));
    }

    /// Impulse (N·s) at the centre of mass: `Δv = J/m`, without spin.
    #[track_caller]
    pub fn apply_impulse_at_center(&mut self, id: BodyId, impulse: Vec3) {
        self.apply_impulse(id, impulse, self.center_of_mass(id));
    }

    /// Angular impulse (N·m·s): `Δω = I⁻¹ L`.
    #[track_caller]
    pub fn apply_angular_impulse(&mut self, id: BodyId, impulse: Vec3) {
        assert!(impulse.is_finite(), "an impulse is finite");
        self.wake_body(id.index);
        let body = self.expect_mut(id);
        body.velocity.angular += finite_change(impulse, |impulse| body.inverse_inertia_mul(impulse));
    }

    /// Force (N) at a world point, constant over the next step and gone after it. The torque is that about the centre of
    /// mass as it lies now.
    #[track_caller]
    pub fn apply_force(&mut self, id: BodyId, force: Vec3, point: Vec3) {
        assert!(force.is_finite() && point.is_finite(), "a force is finite");
        let torque = (point - self.center_of_mass(id)).cross(force);
        self.apply_wrench(id, Wrench { force, torque });
    }

    /// Force (N) at the centre of mass for the next step.
    #[track_caller]
    pub fn apply_force_at_center(&mut self, id: BodyId, force: Vec3) {
        assert!(force.is_finite(), "a force is finite");
        self.apply_wrench(id, Wrench { force, torque: Vec3::ZERO });
    }

    /// Torque (N·m) for the next step.
    #[track_caller]
    pub fn apply_torque(&mut self, id: BodyId, torque: Vec3) {
        assert!(torque.is_finite(), "a torque is finite");
        self.apply_wrench(id, Wrench { force: Vec3::ZERO, torque });
    }

    fn apply_wrench(&mut self, id: BodyId, Wrench { force, torque }: Wrench) {
        self.wake_body(id.index);
        let body = self.expect_mut(id);
        if body.kind == BodyKind::Dynamic {
            body.force += force;
            body.torque += torque;
        }
    }

    /// Gives a body a force that lasts until it is changed or taken away; the body wakes. A body that stays where it is
    /// all the same may sleep under it.
    ///
    /// # Panics
    /// If a number is not finite.
    #[track_caller]
    pub fn add_force(&mut self, body: BodyId, def: &ForceDef) -> ForceId {
        assert!(def.is_finite(), "a force is finite");
        self.wake_body(body.index);
        let forces = &mut self.expect_mut(body).forces;
        let number = forces.next;
        forces.next += 1;
        forces.list.push((number, *def));
        ForceId { body, number }
    }

    /// Changes a lasting force; the body wakes.
    ///
    /// # Panics
    /// If a number is not finite, or the force is not there.
    pub fn set_force(&mut self, id: ForceId, def: &ForceDef) {
        assert!(def.is_finite(), "a force is finite");
        self.wake_body(id.body.index);
        let forces = &mut self.expect_mut(id.body).forces;
        let place = forces.place(id);
        forces.list[place].1 = *def;
    }

    /// Takes a lasting force away; the body wakes.
    ///
    /// # Panics
    /// If the force is not there.
    pub fn remove_force(&mut self, id: ForceId) {
        self.wake_body(id.body.index);
        let forces = &mut self.expect_mut(id.body).forces;
        let place = forces.place(id);
        forces.list.remove(place);
    }

    /// A lasting force as it is now.
    ///
    /// # Panics
    /// If the force is not there.
    pub fn force(&self, id: ForceId) -> ForceDef {
        let forces = &self.expect(id.body).forces;
        forces.list[forces.place(id)].1
    }

    /// The lasting forces of a body, in the order in which they came.
    #[track_caller]
    pub fn forces_of(&self, body: BodyId) -> impl Iterator<Item = ForceId> {
        self.expect(body).forces.list.iter().map(move |&(number, _)| ForceId { body, number })
    }

    /// A bullet of `mass` (kg) and `velocity` (m/s) strikes a body at a world point and lodges there: gives the impulse
    /// (N·s) that it left in the body.
    ///
    /// The hit is perfectly inelastic: afterwards bullet and struck point move with one velocity. With `r` from the centre
    /// of mass to the point and `u` the point's velocity before, the velocity that the pair gains against each other by a
    /// unit impulse is `K = (1/m + 1/M) 1 − [r]× I⁻¹ [r]×`, and the impulse is
    ///
    /// ```text
    /// J = K⁻¹ (velocity − u)        through the centre: J = m M / (m + M) (velocity − u)
    /// ```
    ///
    /// (Mirtich, "Impulse-based Dynamic Simulation", 1996, §3.3, without rebound). It is less than `mass × velocity`: what
    /// is missing is the momentum that the bullet keeps, since it flies on with the body. Body and bullet together have the
    /// momentum that they had before, so a free block leaves at `m v / (m + M)`.
    ///
    /// **The bullet's mass does not join the body**: from then on the body weighs what it weighed. Where it should, count
    /// the bullet by a body of its own, held by a fixed joint. Joints of the body spread the blow in the next step; they do
    /// not make it heavier here. Nothing happens to static and kinematic bodies: the impulse given back is then what
    /// stops the bullet.
    ///
    /// # Panics
    /// If a number is not finite, or the mass not positive.
    #[track_caller]
    pub fn hit_by(&mut self, id: BodyId, mass: f32, velocity: Vec3, point: Vec3) -> Vec3 {
        assert!(mass > 0.0 && mass < f32::INFINITY, "a bullet's mass is positive and finite");
        assert!(velocity.is_finite() && point.is_finite(), "a bullet's velocity and place are finite");
        let body = self.expect(id);
        let arm = point - body.center();
        let turn = skew(arm);
        let columns = [Vec3::X, Vec3::Y, Vec3::Z].map(|e| body.inverse_inertia_mul(turn * e));
        // K times the mass that it would be through the centre: of the size of 1, whatever the masses.
        let reduced = 1.0 / (1.0 / mass + body.inverse_mass());
        let gained = Mat3::IDENTITY - turn * Mat3::from_cols(columns[0], columns[1], columns[2]) * reduced;
        let impulse = Sym3::from_mat3(&gained).inverse() * (velocity - body.velocity.at(arm)) * reduced;
        self.apply_impulse(id, impulse, point);
        impulse
    }
}
