//! The linear system of a step over the springs of a group, solved repeatedly until the springs' linearisation is
//! consistent.
//!
//! The unknowns are the velocities at the end of the step: `(M + h² K + h D) v⁺ = M v + h f` (Baraff & Witkin 1998),
//! with the axial stiffness `k n nᵀ`, the geometric stiffness `k max(0, 1 − L₀/L) (I − n nᵀ)` and the axial damping of
//! each spring. At rest the right-hand side is zero, so that a chain hangs exactly where its forces balance, for
//! any length of the step.

use super::SpringDef;
use super::conjugate::Conjugate;
use super::forest::Forest;
use super::hub::Hub;
use super::load::Load;
use sinew_math::{Sym3, Vec3};

/// Largest number of Newton iterations.
const NEWTON_ROUNDS: u32 = 16;
/// Largest number of times that a Newton step is halved.
const HALVINGS: u32 = 8;
/// Rounding error of the energy that a Newton step must lower, as a share of the energy's terms, a ratio.
const MERIT_ROUNDING: f64 = 1e-7;

/// Freedom of a particle in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Freedom {
    /// The particle moves freely.
    #[default]
    Free,
    /// Free perpendicular to a unit normal. Along the normal the particle has the surface's speed (m/s); the surface
    /// yields by `yielding` per impulse, 1/kg: 0 if the speed is prescribed.
    Along { normal: Vec3, speed: f32, yielding: f32 },
    /// The velocity of the particle is given.
    Fixed,
}

impl Freedom {
    /// Energy that a particle with this velocity transfers to its surface, J.
    fn merit(&self, velocity: Vec3) -> f32 {
        match *self {
            Self::Along { normal, speed, yielding } if yielding > 0.0 => {
                let pushed = normal.dot(velocity) - speed;
                0.5 * pushed * pushed / yielding
            }
            _ => 0.0,
        }
    }
}

/// Linear system of a step, by particle and by spring.
#[derive(Clone, Debug, Default)]
pub(super) struct System {
    /// Inertia of each particle, kg: its own, plus its anchor's if there are no trees.
    pub inertia: Vec<Sym3>,
    /// Momentum of each particle at the end of the step without springs and contacts, kg·m/s.
    pub momentum: Vec<Vec3>,
    /// Inertia that contacts add, kg.
    pub added_inertia: Vec<Sym3>,
    /// Momentum that contacts add, kg·m/s.
    pub added_momentum: Vec<Vec3>,
    /// Freedom of each particle. The solve reads the velocity of a fixed particle from the velocities.
    pub freedom: Vec<Freedom>,
    /// Bodies that particles are attached to.
    pub hubs: Vec<Hub>,
    /// Position of each attached particle on its body, world, metres.
    pub points: Vec<Vec3>,
    pub(super) loads: Vec<Load>,
    /// Velocities and spring impulses before the last Newton step.
    last_velocities: Vec<Vec3>,
    last_impulses: Vec<Vec3>,
    /// Inertia and momentum of each particle with its subtree.
    pub(super) gathered_inertia: Vec<Sym3>,
    pub(super) gathered_momentum: Vec<Vec3>,
    /// Impulse of the parent spring on each particle, relative to its linearisation, N·s.
    pub(super) tensions: Vec<Vec3>,
    /// Inverse of each particle's inertia including that spring, 1/kg; and velocity gained per impulse with the
    /// parent's velocity fixed, 1/kg (`responses`).
    pub(super) inverses: Vec<Sym3>,
    pub(super) responses: Vec<Sym3>,
    pub(super) conjugate: Conjugate,
}

impl System {
    pub fn new(particles: usize, springs: usize, hubs: usize) -> Self {
        let (matrices, vectors) = (vec![Sym3::ZERO; particles], vec![Vec3::ZERO; particles]);
        Self {
            inertia: matrices.clone(),
            momentum: vectors.clone(),
            added_inertia: matrices.clone(),
            added_momentum: vectors.clone(),
            freedom: vec![Freedom::Free; particles],
            hubs: vec![Hub::new(); hubs],
            points: vectors.clone(),
            loads: vec![Load::default(); springs],
            last_velocities: vectors.clone(),
            last_impulses: vectors.clone(),
            gathered_inertia: matrices.clone(),
            gathered_momentum: vectors.clone(),
            tensions: vectors,
            inverses: matrices.clone(),
            responses: matrices,
            conjugate: Conjugate::new(particles, hubs),
        }
    }

    /// Evaluates the springs of the forest for a step of `h` seconds.
    pub fn load_springs(&mut self, forest: &Forest, springs: &[SpringDef], positions: &[Vec3], h: f32) {
        for spring in forest.solved_springs() {
            let s = &springs[spring as usize];
            let from_a = positions[s.b as usize] - positions[s.a as usize];
            self.loads[spring as usize] = Load::new(s, from_a, h);
        }
    }

    /// Computes the velocities at the end of the step, and the corresponding spring impulses, by Newton's method:
    /// springs are linearised again at the positions of the last velocities until they agree.
    ///
    /// Otherwise the linearisation would stretch a link of a whip that rotates far within the step, and store energy
    /// from nothing. A Newton step is shortened until it lowers the energy that the solution minimises (`merit`).
    pub fn settle_springs(
        &mut self,
        forest: &Forest,
        springs: &[SpringDef],
        positions: &[Vec3],
        h: f32,
        (velocities, impulses): (&mut [Vec3], &mut [Vec3]),
    ) {
        self.solve(forest, springs, h, velocities);
        self.spring_impulses(forest, springs, h, velocities, impulses);
        let mut merit = None;
        for _ in 0..NEWTON_ROUNDS {
            if !self.follow_springs(forest, springs, (positions, velocities), h) {
                return;
            }
            let before = merit.unwrap_or_else(|| self.merit(forest, springs, (positions, velocities), h));
            self.last_velocities.copy_from_slice(velocities);
            self.hubs.iter_mut().for_each(|hub| hub.last_velocity = hub.velocity);
            self.last_impulses.copy_from_slice(impulses);
            self.solve(forest, springs, h, velocities);
            self.spring_impulses(forest, springs, h, velocities, impulses);
            let mut after = self.merit(forest, springs, (positions, velocities), h);
            for _ in 0..HALVINGS {
                if after.0 <= before.0 + MERIT_ROUNDING * before.1 {
                    break;
                }
                for (now, last) in velocities.iter_mut().zip(&self.last_velocities) {
                    *now = (*now + *last) * 0.5;
                }
                for hub in &mut self.hubs {
                    hub.velocity = core::array::from_fn(|k| (hub.velocity[k] + hub.last_velocity[k]) * 0.5);
                }
                for (now, last) in impulses.iter_mut().zip(&self.last_impulses) {
                    *now = (*now + *last) * 0.5;
                }
                after = self.merit(forest, springs, (positions, velocities), h);
            }
            merit = Some(after);
        }
    }

    /// Returns the energy that the velocities at the end of the step minimise, J, and the sum of the magnitudes of its
    /// terms, J: `½ v·M v − p·v`, plus the springs' energy at the end of the step.
    fn merit(
        &self,
        forest: &Forest,
        springs: &[SpringDef],
        (positions, velocities): (&[Vec3], &[Vec3]),
        h: f32,
    ) -> (f64, f64) {
        let (mut sum, mut size) = (0.0, 0.0);
        for (i, &v) in velocities.iter().enumerate() {
            if self.freedom[i] != Freedom::Fixed {
                let own = 0.5 * v.dot((self.inertia[i] + self.added_inertia[i]) * v);
                let given = (self.momentum[i] + self.added_momentum[i]).dot(v);
                let surface = self.freedom[i].merit(v);
                sum += f64::from(own) - f64::from(given) + f64::from(surface);
                size += f64::from(own) + f64::from(given.abs()) + f64::from(surface);
            }
        }
        for hub in &self.hubs {
            let (own, terms) = hub.merit();
            sum += f64::from(own);
            size += f64::from(terms);
        }
        for spring in forest.solved_springs() {
            let s = &springs[spring as usize];
            let energy = self.loads[spring as usize].energy(s, at_end(s, positions, velocities, h).0);
            sum += energy;
            size += energy;
        }
        (sum, size)
    }

    /// Linearises the springs again at the positions of these velocities, if any of them differs from its prediction;
    /// returns true if so.
    fn follow_springs(
        &mut self,
        forest: &Forest,
        springs: &[SpringDef],
        (positions, velocities): (&[Vec3], &[Vec3]),
        h: f32,
    ) -> bool {
        let bent = forest.solved_springs().any(|spring| {
            let s = &springs[spring as usize];
            let (from_a, ahead) = at_end(s, positions, velocities, h);
            self.loads[spring as usize].is_bent(s, from_a, ahead, h)
        });
        if bent {
            for spring in forest.solved_springs() {
                let s = &springs[spring as usize];
                let (from_a, ahead) = at_end(s, positions, velocities, h);
                self.loads[spring as usize].linearise(s, from_a, ahead, h);
            }
        }
        bent
    }

    /// Computes the sum of the springs' impulses on each particle, N·s.
    fn spring_impulses(
        &self,
        forest: &Forest,
        springs: &[SpringDef],
        h: f32,
        velocities: &[Vec3],
        sums: &mut [Vec3],
    ) {
        sums.fill(Vec3::ZERO);
        for spring in forest.solved_springs() {
            let s = &springs[spring as usize];
            let (a, b) = (s.a as usize, s.b as usize);
            let impulse = self.loads[spring as usize].impulse(h, velocities[a], velocities[b]);
            sums[a] += impulse;
            sums[b] -= impulse;
        }
    }
}

/// Returns the vector from A to B of a spring at the end of the step, and A's velocity relative to B's.
fn at_end(s: &SpringDef, positions: &[Vec3], velocities: &[Vec3], h: f32) -> (Vec3, Vec3) {
    let [a, b] = [s.a as usize, s.b as usize];
    let ahead = velocities[a] - velocities[b];
    (positions[b] - positions[a] - ahead * h, ahead)
}
