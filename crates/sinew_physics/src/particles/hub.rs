//! Bodies in the linear system of the springs: particles attached to one body move with the body.
//!
//! Such a body, a **hub**, is one tree node with six degrees of freedom. It gathers inertia and momentum of all its
//! particles, `S = M + Σ Gᵀ Iᵢ G` with `G = (1, −[r]×)`. The particle that connects it to the next node toward the root
//! has the inertia `(G S⁻¹ Gᵀ)⁻¹`. A rope that continues from one point of a body to another thus pulls through the
//! body. If the points were solved separately, each with its share of the body's inertia, they would separate under
//! tension within the solve, and a plank bridge on ropes would stretch and gain energy.
//!
//! Several groups attached to one body are solved together: each adds the **shares** of the others to `S` and to the
//! momentum. If the body is the root of their trees, the shares do not depend on its velocity, and the solution is
//! exact. If springs close loops, the shares belong to the previous round's velocities.

use super::added_mass::AddedMass;
use super::contact::ObstacleBody;
use crate::spatial::{
    Mat6, UNITS, Vec6, ZERO6, ZERO66, add_scaled, angular, dot, join, linear, spd_inverse, wrench,
};
use sinew_math::{Mat3, Sym3, Vec3};

/// Inertia and pull of a group's particles on their body, including the particles' subtrees, about the body's centre of
/// mass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Share {
    inertia: Mat6,
    /// Momentum relative to the predicted velocity, N·s and N·m·s.
    pull: Vec6,
}

impl Share {
    pub const NONE: Self = Self { inertia: ZERO66, pull: ZERO6 };

    /// Adds a load at a point: inertia, kg, and momentum relative to the predicted velocity, N·s.
    fn add_at(&mut self, arm: Vec3, inertia: Sym3, pull: Vec3) {
        self.add_inertia(arm, inertia);
        add_scaled(&mut self.pull, &wrench(arm, pull), 1.0);
    }

    fn add_inertia(&mut self, arm: Vec3, inertia: Sym3) {
        for (row, axis) in self.inertia.iter_mut().zip(UNITS) {
            add_scaled(row, &wrench(arm, inertia * velocity_at(&axis, arm)), 1.0);
        }
    }

    /// Adds another share.
    pub fn add(&mut self, other: &Self) {
        for (row, more) in self.inertia.iter_mut().zip(&other.inertia) {
            add_scaled(row, more, 1.0);
        }
        add_scaled(&mut self.pull, &other.pull, 1.0);
    }

    /// Merit function at a velocity relative to the predicted one, J, and the sum of the magnitudes of its terms, J.
    fn merit(&self, gained: &Vec6) -> (f32, f32) {
        let mut own = 0.0;
        for (row, along) in self.inertia.iter().zip(gained) {
            own += 0.5 * along * dot(row, gained);
        }
        let given = dot(&self.pull, gained);
        (own - given, own + given.abs())
    }
}

/// A body that particles are attached to, in one iteration.
#[derive(Clone, Debug)]
pub(super) struct Hub {
    /// Centre of mass, world, metres.
    center: Vec3,
    /// Mass, kg, and inertia about the centre of mass, kg·m², world axes.
    mass: f32,
    inertia: Sym3,
    /// Mass that moves with the body.
    added: AddedMass,
    /// Shares from other groups, and from this group.
    pub others: Share,
    pub own: Share,
    /// Velocity at the end of the iteration without springs and particles; and `free`, with the body's subtrees.
    coming: Vec6,
    free: Vec6,
    /// Velocity gained per impulse, including the particles' inertia.
    response: Mat6,
    /// Inertia at the point that connects the hub to the next node, kg.
    seen: Sym3,
    /// Velocity from the solve, and that before the last Newton step.
    pub velocity: Vec6,
    pub last_velocity: Vec6,
    /// Velocity from the previous solve.
    found: Vec6,
}

impl Hub {
    pub fn new() -> Self {
        Self {
            center: Vec3::ZERO,
            mass: 1.0,
            inertia: Sym3::IDENTITY,
            added: AddedMass::default(),
            others: Share::NONE,
            own: Share::NONE,
            coming: ZERO6,
            free: ZERO6,
            response: ZERO66,
            seen: Sym3::IDENTITY,
            velocity: ZERO6,
            last_velocity: ZERO6,
            found: ZERO6,
        }
    }

    /// Sets the hub to a movable body; `gained` is the body's velocity change by other forces, m/s.
    pub fn take(&mut self, body: &ObstacleBody, gained: Vec3, added: &AddedMass) {
        self.center = body.center;
        (self.mass, self.inertia) = body.inertia();
        self.added = *added;
        self.coming = join(body.linear_velocity + gained, body.angular_velocity);
        self.velocity = self.coming;
    }

    /// Velocity of a point of the body without springs, m/s.
    pub fn coming_at(&self, point: Vec3) -> Vec3 {
        velocity_at(&self.coming, point - self.center)
    }

    /// Velocity of a point of the body after the solve, m/s.
    pub fn velocity_at(&self, point: Vec3) -> Vec3 {
        velocity_at(&self.velocity, point - self.center)
    }

    /// Gathers the inertia of the particles: point and inertia of each with its subtree. The point `link` connects the
    /// hub to the next node.
    pub fn factor(&mut self, particles: impl Iterator<Item = (Vec3, Sym3)>, link: Vec3) {
        let mut whole = ZERO66;
        let turning = self.inertia.to_mat3();
        for (k, axis) in [turning.x_axis, turning.y_axis, turning.z_axis].into_iter().enumerate() {
            whole[k][k] = self.mass;
            whole[3 + k] = join(Vec3::ZERO, axis);
        }
        self.added.add_to(&mut whole);
        self.own.inertia = ZERO66;
        for (point, inertia) in particles {
            self.own.add_inertia(point - self.center, inertia);
        }
        for share in [&self.own, &self.others] {
            for (row, more) in whole.iter_mut().zip(&share.inertia) {
                add_scaled(row, more, 1.0);
            }
        }
        self.response = spd_inverse(&whole, 6).unwrap_or(ZERO66);
        let arm = link - self.center;
        let column = |axis: Vec3| velocity_at(&self.respond(&wrench(arm, axis)), arm);
        let (x, y, z) = (column(Vec3::X), column(Vec3::Y), column(Vec3::Z));
        self.seen = Sym3::from_mat3(&Mat3::from_cols(x, y, z)).inverse();
    }

    /// Gathers the loads: point, inertia and momentum of each particle with its subtree. `WHOLE`: including the body's
    /// own momentum and the shares of other groups.
    pub fn gather<const WHOLE: bool>(&mut self, particles: impl Iterator<Item = (Vec3, Sym3, Vec3)>) {
        let mut pull = ZERO6;
        for (point, inertia, momentum) in particles {
            let arm = point - self.center;
            let coming = if WHOLE { inertia * velocity_at(&self.coming, arm) } else { Vec3::ZERO };
            add_scaled(&mut pull, &wrench(arm, momentum - coming), 1.0);
        }
        self.free = ZERO6;
        if WHOLE {
            self.own.pull = pull;
            add_scaled(&mut pull, &self.others.pull, 1.0);
            self.free = self.coming;
        }
        let gained = self.respond(&pull);
        add_scaled(&mut self.free, &gained, 1.0);
        self.velocity = self.free;
    }

    /// Adds a load at a point (kg and kg·m/s) to this group's share.
    pub fn add_at(&mut self, point: Vec3, inertia: Sym3, momentum: Vec3) {
        let arm = point - self.center;
        self.own.add_at(arm, inertia, momentum - inertia * velocity_at(&self.coming, arm));
    }

    /// Inertia at the point that connects the hub to the next node, for a pull at that point, kg.
    pub fn seen(&self) -> Sym3 {
        self.seen
    }

    /// Momentum that belongs to the inertia `seen` at `point`, kg·m/s.
    pub fn momentum_seen_at(&self, point: Vec3) -> Vec3 {
        self.seen * velocity_at(&self.free, point - self.center)
    }

    /// Sets the body's velocity to its free velocity plus the response to the impulse at `point` that gives the point
    /// this velocity.
    pub fn follow(&mut self, point: Vec3, velocity: Vec3) {
        let pull = wrench(point - self.center, self.seen * velocity - self.momentum_seen_at(point));
        self.velocity = self.free;
        let gained = self.respond(&pull);
        add_scaled(&mut self.velocity, &gained, 1.0);
    }

    /// Stores the velocity, to compare with that of the next solve.
    pub fn remember(&mut self) {
        self.found = self.velocity;
    }

    /// Change of the velocity since `remember`, relative to the change from the predicted velocity: the square root of
    /// the ratio of their energies.
    pub fn change(&self) -> f32 {
        let energy_from = |from: &Vec6| {
            let mut gained = self.velocity;
            add_scaled(&mut gained, from, -1.0);
            self.mass * linear(&gained).length_squared()
                + angular(&gained).dot(self.inertia * angular(&gained))
        };
        let all = energy_from(&self.coming);
        if all > 0.0 { (energy_from(&self.found) / all).sqrt() } else { 0.0 }
    }

    /// Merit function, J, and the sum of the magnitudes of its terms, J: see `merit` in `system.rs`.
    pub fn merit(&self) -> (f32, f32) {
        let mut gained = self.velocity;
        add_scaled(&mut gained, &self.coming, -1.0);
        let (along, turn) = (linear(&gained), angular(&gained));
        let own = 0.5 * (self.mass * along.length_squared() + turn.dot(self.inertia * turn))
            + self.added.energy(&gained);
        let (others, size) = self.others.merit(&gained);
        (own + others, own + size)
    }

    fn respond(&self, pull: &Vec6) -> Vec6 {
        let mut gained = ZERO6;
        for (gained, row) in gained.iter_mut().zip(&self.response) {
            *gained = dot(row, pull);
        }
        gained
    }
}

fn velocity_at(v: &Vec6, arm: Vec3) -> Vec3 {
    linear(v) + angular(v).cross(arm)
}
