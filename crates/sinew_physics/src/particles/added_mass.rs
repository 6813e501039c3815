//! Mass added to a body that particles are attached to: mass of bodies resting on it or jointed to it.
//!
//! Springs are solved before body contacts, with a plank's own mass only. With a box of twenty times that mass on the
//! plank, the load would act on the springs one substep late: the plank would hang lower by `g h² M/m`, and stiff ropes
//! would throw both upward. Therefore each substep measures the effect of the impulse `p` from the springs: the body
//! gained the velocity `d` and transmitted `w = p − m d`. With `m + w wᵀ/(w·d)`, the symmetric rank-one update of
//! quasi-Newton methods, the next substep uses the mass that responds to `p` with `d`; at rest this is exact. Rotations
//! are excluded: at the turning points of a swing, their ratio is noise.

use super::contact::ObstacleBody;
use super::tuning::{LEAST_ADDED, MOST_ADDED};
use crate::spatial::{Mat6, Vec6, add_scaled, join, linear};
use sinew_math::{ReadError, Reader, Sym3, Vec3, Writer, max};

/// Mass added to that of a body, along the direction of an impulse.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct AddedMass {
    /// Transmitted momentum `w`, kg·m/s, and `power`, twice its energy `w·d`, J; 0 without added mass.
    momentum: Vec3,
    power: f32,
}

impl AddedMass {
    /// Estimates the added mass from the velocity that a body of `mass` kg gained by an impulse.
    pub fn of(mass: f32, pushed: Vec3, gained: Vec3) -> Self {
        let own = gained * mass;
        let momentum = pushed - own;
        let power = momentum.dot(gained);
        let least = momentum.length_squared() / (mass * MOST_ADDED);
        let added = Self { momentum, power: max(power, least) };
        if power > LEAST_ADDED * own.dot(gained) && added.is_some() { added } else { Self::default() }
    }

    /// True if there is an added mass.
    pub fn is_some(&self) -> bool {
        self.momentum.is_finite() && self.power > 0.0 && self.power < f32::INFINITY
    }

    /// Added mass along the impulse, kg; 0 without added mass.
    pub fn mass(&self) -> f32 {
        if self.is_some() { self.momentum.length_squared() / self.power } else { 0.0 }
    }

    /// Adds the mass to an inertia.
    pub fn add_to(&self, inertia: &mut Mat6) {
        if self.is_some() {
            let whole = join(self.momentum, Vec3::ZERO);
            for (row, along) in inertia.iter_mut().zip(whole) {
                add_scaled(row, &whole, along / self.power);
            }
        }
    }

    /// Kinetic energy of the added mass at a velocity of the body, J.
    pub fn energy(&self, velocity: &Vec6) -> f32 {
        if !self.is_some() {
            return 0.0;
        }
        let along = self.momentum.dot(linear(velocity));
        0.5 * along * along / self.power
    }

    /// Velocity that the added mass removes from a body's response to an impulse, m/s, by Sherman and Morrison.
    fn kept(&self, body: &ObstacleBody, impulse: Vec3) -> Vec3 {
        if !self.is_some() {
            return Vec3::ZERO;
        }
        let own = self.momentum * body.inverse_mass;
        own * (own.dot(impulse) / (self.power + own.dot(self.momentum)))
    }

    /// Computes [`ObstacleBody::response_at`] with the added mass.
    pub fn response_at(&self, body: &ObstacleBody, point: Vec3) -> Sym3 {
        let whole = body.response_at(point);
        if !self.is_some() {
            return whole;
        }
        let own = self.momentum * body.inverse_mass;
        whole - Sym3::outer(own) * (1.0 / (self.power + own.dot(self.momentum)))
    }

    /// Computes [`ObstacleBody::push`] with the added mass.
    pub fn push(&self, body: &mut ObstacleBody, point: Vec3, impulse: Vec3) {
        body.push(point, impulse);
        body.linear_velocity -= self.kept(body, impulse);
    }

    pub(super) fn save(&self, out: &mut Writer) {
        out.vec3(self.momentum);
        out.f32(self.power);
    }

    pub(super) fn load(input: &mut Reader<'_>) -> Result<Self, ReadError> {
        let added = Self { momentum: input.vec3()?, power: input.f32()? };
        if added.is_some() { Ok(added) } else { Err(input.error("an added mass is finite and positive")) }
    }
}
