//! The linear system of a step: elimination along the trees, and conjugate gradients where springs close loops.
//!
//! A tree is factored from the leaves to the roots and solved for any momenta in two passes. A spring that closes a
//! loop connects nodes that elimination separates. The trees' factor then contains that spring as well, with its other
//! end fixed, and is the preconditioner of conjugate gradients (Hestenes and Stiefel 1952; Concus, Golub and O'Leary
//! 1976) over the whole system: with `M z = r`, `A d` differs from `M d` only by the terms of the closing springs, so
//! that the trees are never multiplied. A few loops take a few iterations; nets take as many as they are wide.

use super::SpringDef;
use super::conjugate::{Conjugate, dot};
use super::forest::{Forest, NO_HUB};
use super::system::{Freedom, System};
use crate::particles::tuning::{CONJUGATE_ROUNDS, CONJUGATE_TOLERANCE, NO_SPEED};
use sinew_math::{Sym3, Vec3};

impl System {
    /// Computes the velocities at the end of the step. Those on entry are used for fixed particles, and as the initial
    /// guess if springs close loops.
    pub fn solve(&mut self, forest: &Forest, springs: &[SpringDef], h: f32, velocities: &mut [Vec3]) {
        self.factor(forest);
        if forest.closings().is_empty() {
            self.load_momenta(forest, springs, h, velocities);
            self.substitute::<true>(forest, velocities);
            return;
        }
        let mut conjugate = core::mem::take(&mut self.conjugate);
        self.solve_loops(&mut conjugate, (forest, springs), h, velocities);
        self.conjugate = conjugate;
    }

    /// Computes the velocities if springs close loops.
    fn solve_loops(
        &mut self,
        of: &mut Conjugate,
        (forest, springs): (&Forest, &[SpringDef]),
        h: f32,
        velocities: &mut [Vec3],
    ) {
        // The first solve uses the contributions of the closing springs' other ends at the current velocities.
        self.load_momenta(forest, springs, h, velocities);
        self.pass_across(forest, velocities, &mut of.passed);
        for (momentum, passed) in self.gathered_momentum.iter_mut().zip(&of.passed) {
            *momentum += *passed;
        }
        of.residual.copy_from_slice(&of.passed);
        self.substitute::<true>(forest, velocities);
        // The residual is the change of these contributions.
        self.pass_across(forest, velocities, &mut of.passed);
        of.start(self.hubs.iter().map(|hub| &hub.velocity));
        let most = self.conjugate_tolerance(velocities);
        let mut last = f64::INFINITY;
        for _ in 0..CONJUGATE_ROUNDS {
            let found = self.precondition(of, forest);
            of.turn((found / last) as f32, self.hubs.iter().map(|hub| &hub.velocity));
            self.pass_across(forest, &of.direction, &mut of.passed);
            let taken = dot(&of.needed, &of.direction) - dot(&of.passed, &of.direction);
            // The comparison is false for NaN, which ends the loop, too.
            let goes_on = found > most && taken > 0.0;
            if !goes_on {
                break;
            }
            of.go((found / taken) as f32, velocities);
            last = found;
        }
        for (kept, hub) in of.hubs.iter().zip(&mut self.hubs) {
            hub.velocity = kept[0];
        }
    }

    /// Twice the energy of the largest error of the velocities that is accepted, J.
    fn conjugate_tolerance(&self, velocities: &[Vec3]) -> f64 {
        let energies = velocities.iter().zip(&self.inertia).map(|(v, inertia)| {
            f64::from((*inertia * *v).dot(*v)) + f64::from(inertia.diagonal.x * NO_SPEED * NO_SPEED)
        });
        energies.sum::<f64>() * CONJUGATE_TOLERANCE
    }

    /// Solves the preconditioner for the residual; returns the dot product of the residual and the solution, J.
    fn precondition(&mut self, of: &mut Conjugate, forest: &Forest) -> f64 {
        self.gathered_momentum.copy_from_slice(&of.residual);
        self.substitute::<false>(forest, &mut of.gain);
        dot(&of.residual, &of.gain)
    }

    /// Computes the momentum that each end of a closing spring gets from the other end's velocity, kg·m/s.
    fn pass_across(&self, forest: &Forest, velocities: &[Vec3], passed: &mut [Vec3]) {
        passed.fill(Vec3::ZERO);
        for &(k, ends) in forest.closings() {
            let ([a, b], block) = (ends.map(|i| i as usize), &self.loads[k as usize].block);
            passed[a] += *block * velocities[b];
            passed[b] += *block * velocities[a];
        }
    }

    /// Computes the velocities of particles that no springs of the forest connect.
    pub fn solve_apart(&mut self, particles: &[u32], velocities: &mut [Vec3]) {
        for &i in particles {
            let i = i as usize;
            self.gathered_momentum[i] = self.momentum[i] + self.added_momentum[i];
            self.gathered_inertia[i] = self.inertia[i] + self.added_inertia[i];
            self.inverses[i] = self.gathered_inertia[i].inverse();
            self.responses[i] = constrained(&self.inverses[i], &self.freedom[i]);
            let own = self.gathered_inertia[i];
            velocities[i] = self.velocity::<true>(i, &own, Vec3::ZERO, velocities);
        }
    }

    /// Factors the trees: each parent includes the inertia of its descendants.
    fn factor(&mut self, forest: &Forest) {
        for i in 0..self.inertia.len() {
            self.gathered_inertia[i] = self.inertia[i] + self.added_inertia[i];
        }
        for tie in forest.ties() {
            self.gathered_inertia[tie.particle as usize] += self.loads[tie.spring as usize].block;
        }
        for &(k, ends) in forest.closings() {
            for end in ends {
                self.gathered_inertia[end as usize] += self.loads[k as usize].block;
            }
        }
        for link in forest.links() {
            let (child, parent) = (link.child as usize, link.parent as usize);
            let block = self.loads[link.spring as usize].block;
            self.factor_hub(forest, child);
            let inertia = self.below(forest, child);
            self.inverses[child] = (inertia + block).inverse();
            self.responses[child] = constrained(&self.inverses[child], &self.freedom[child]);
            let gained = gained_by_parent(&inertia, &self.inverses[child], &block, &self.freedom[child]);
            self.gathered_inertia[parent] += gained;
        }
        for &root in forest.roots() {
            let root = root as usize;
            if !self.factor_hub(forest, root) {
                self.inverses[root] = self.gathered_inertia[root].inverse();
                self.responses[root] = constrained(&self.inverses[root], &self.freedom[root]);
            }
        }
    }

    /// Loads the momenta of particles, contacts, linearised springs and fixed ends, without those of hubs; and the
    /// spring forces along the trees.
    fn load_momenta(&mut self, forest: &Forest, springs: &[SpringDef], h: f32, velocities: &[Vec3]) {
        for i in 0..velocities.len() {
            self.gathered_momentum[i] = self.momentum[i] + self.added_momentum[i];
        }
        for tie in forest.ties() {
            let (i, load) = (tie.particle as usize, self.loads[tie.spring as usize]);
            let force = if springs[tie.spring as usize].a == tie.particle { load.force } else { -load.force };
            self.gathered_momentum[i] += force * h + load.block * velocities[tie.held as usize];
        }
        for &(k, [a, b]) in forest.closings() {
            let impulse = self.loads[k as usize].force * h;
            self.gathered_momentum[a as usize] += impulse;
            self.gathered_momentum[b as usize] -= impulse;
        }
        for link in forest.links() {
            self.tensions[link.child as usize] = {
                let force = self.loads[link.spring as usize].force;
                if springs[link.spring as usize].a == link.child { force * h } else { -force * h }
            };
        }
    }

    /// Computes the velocities for the gathered momenta. `WHOLE`: including the pull of tree springs, the velocities of
    /// bodies and surfaces, and prescribed ones; otherwise the response to the momenta alone.
    fn substitute<const WHOLE: bool>(&mut self, forest: &Forest, velocities: &mut [Vec3]) {
        if !WHOLE {
            velocities.fill(Vec3::ZERO);
        }
        for link in forest.links() {
            let (child, parent) = (link.child as usize, link.parent as usize);
            let block = self.loads[link.spring as usize].block;
            if self.pull_hub::<WHOLE>(forest, child) {
                self.gathered_momentum[child] =
                    self.hubs[forest.hub_of(child)].momentum_seen_at(self.points[child]);
            }
            if WHOLE {
                self.gathered_momentum[child] += self.tensions[child];
                self.gathered_momentum[parent] -= self.tensions[child];
            }
            let inertia = self.below(forest, child);
            let velocity = self.velocity::<WHOLE>(child, &inertia, Vec3::ZERO, velocities);
            let momentum = self.passed_on::<WHOLE>(child, (&inertia, &block), velocity);
            self.gathered_momentum[parent] += momentum;
        }
        for &root in forest.roots() {
            let root = root as usize;
            if self.pull_hub::<WHOLE>(forest, root) {
                self.move_hub(forest, root, velocities);
            } else {
                let own = self.gathered_inertia[root];
                velocities[root] = self.velocity::<WHOLE>(root, &own, Vec3::ZERO, velocities);
            }
        }
        for link in forest.links().iter().rev() {
            let (child, block) = (link.child as usize, self.loads[link.spring as usize].block);
            let inertia = self.below(forest, child);
            let parent = velocities[link.parent as usize];
            velocities[child] = self.velocity::<WHOLE>(child, &inertia, parent, velocities);
            if self.is_in_hub(forest, child) {
                let (hub, point) = (&mut self.hubs[forest.hub_of(child)], self.points[child]);
                hub.follow(point, velocities[child]);
                if WHOLE {
                    hub.add_at(point, block, self.tensions[child] + block * parent);
                }
                self.move_hub(forest, child, velocities);
            }
        }
    }

    /// Inertia of a child with its descendants, kg; for a child on a movable body, the inertia of that point of the
    /// body.
    fn below(&self, forest: &Forest, child: usize) -> Sym3 {
        if self.is_in_hub(forest, child) {
            self.hubs[forest.hub_of(child)].seen()
        } else {
            self.gathered_inertia[child]
        }
    }

    /// True if particle `i` is attached to a movable body.
    fn is_in_hub(&self, forest: &Forest, i: usize) -> bool {
        forest.hub_of(i) != NO_HUB && self.freedom[i] != Freedom::Fixed
    }

    /// Gathers the inertia of all particles on the movable body of particle `i`, as seen at that particle; returns
    /// false if there is no such body.
    fn factor_hub(&mut self, forest: &Forest, i: usize) -> bool {
        if !self.is_in_hub(forest, i) {
            return false;
        }
        let held = |&i: &u32| (self.points[i as usize], self.gathered_inertia[i as usize]);
        let hub = forest.hub_of(i);
        self.hubs[hub].factor(forest.hubs()[hub].iter().map(held), self.points[i]);
        true
    }

    /// Gathers the loads of the movable body of particle `i`; returns false if there is no such body.
    fn pull_hub<const WHOLE: bool>(&mut self, forest: &Forest, i: usize) -> bool {
        if !self.is_in_hub(forest, i) {
            return false;
        }
        let hub = forest.hub_of(i);
        let held = |&i: &u32| {
            let i = i as usize;
            (self.points[i], self.gathered_inertia[i], self.gathered_momentum[i])
        };
        self.hubs[hub].gather::<WHOLE>(forest.hubs()[hub].iter().map(held));
        true
    }

    /// Sets the velocities of all particles on the body of particle `i` to those of its points.
    fn move_hub(&self, forest: &Forest, i: usize, velocities: &mut [Vec3]) {
        let hub = forest.hub_of(i);
        for &held in &forest.hubs()[hub] {
            velocities[held as usize] = self.hubs[hub].velocity_at(self.points[held as usize]);
        }
    }

    /// Velocity of particle `i`, m/s, for its subtree's momentum and `inertia` (kg) and its `parent`'s velocity (m/s).
    ///
    /// The pull of a stiff spring exceeds the subtree's momentum many thousand times, and its rounding error would be
    /// as large as that momentum. The computation therefore uses the momentum relative to the parent's velocity.
    fn velocity<const WHOLE: bool>(
        &self,
        i: usize,
        inertia: &Sym3,
        parent: Vec3,
        velocities: &[Vec3],
    ) -> Vec3 {
        let free = || {
            let more = self.gathered_momentum[i] - *inertia * parent;
            parent + self.responses[i] * more
        };
        match self.freedom[i] {
            Freedom::Free => free(),
            Freedom::Along { normal, speed, yielding } => {
                let along = self.inverses[i] * normal;
                let speed = if WHOLE { speed } else { 0.0 };
                free() + along * ((speed - normal.dot(parent)) / (normal.dot(along) + yielding))
            }
            Freedom::Fixed => velocities[i],
        }
    }

    /// Momentum that a child transmits to its parent, kg·m/s: the spring's block times the child's velocity while the
    /// parent is at rest. For a stiff spring, it is computed as the momentum that the child does not keep.
    fn passed_on<const WHOLE: bool>(
        &self,
        child: usize,
        (inertia, block): (&Sym3, &Sym3),
        velocity: Vec3,
    ) -> Vec3 {
        if self.freedom[child] == Freedom::Fixed || !is_stiff(block, inertia) {
            return *block * velocity;
        }
        let momentum = self.gathered_momentum[child];
        let pushed = match self.freedom[child] {
            Freedom::Along { normal, speed, yielding } => {
                let along = self.inverses[child] * normal;
                let speed = if WHOLE { speed } else { 0.0 };
                normal * ((speed - along.dot(momentum)) / (normal.dot(along) + yielding))
            }
            Freedom::Free | Freedom::Fixed => Vec3::ZERO,
        };
        momentum + pushed - *inertia * velocity
    }
}

/// Inverse inertia of a particle on a surface that yields by `c` per impulse along its normal. With the free particle's
/// inverse inertia `W`, it is `W − W n nᵀ W / (n·W n + c)` (Sherman and Morrison 1950).
///
/// Inverting the sum `W⁻¹ + n nᵀ / c` instead fails: if the body outweighs the particle by thousands, 32-bit rounding
/// destroys the particle's tangential part.
fn constrained(inverse: &Sym3, freedom: &Freedom) -> Sym3 {
    match freedom {
        Freedom::Free => *inverse,
        Freedom::Along { normal, yielding, .. } => {
            let along = *inverse * *normal;
            *inverse - Sym3::outer(along) * (1.0 / (normal.dot(along) + yielding))
        }
        Freedom::Fixed => Sym3::ZERO,
    }
}

/// True if a spring's block outweighs the inertia below it; then the form with the smaller terms is the accurate one.
fn is_stiff(block: &Sym3, inertia: &Sym3) -> bool {
    let size = |m: &Sym3| m.to_mat3().x_axis.x + m.to_mat3().y_axis.y + m.to_mat3().z_axis.z;
    size(block) > size(inertia)
}

/// Inertia that a parent gains from a child. With the child's inertia S, the spring's block B and the child's response
/// W, it is `B − B W B`. For a free child that equals `S (S + B)⁻¹ B` and `S − S (S + B)⁻¹ S`; the function uses the
/// form without cancellation.
fn gained_by_parent(inertia: &Sym3, inverse: &Sym3, block: &Sym3, freedom: &Freedom) -> Sym3 {
    let stiff = is_stiff(block, inertia);
    let free = || {
        let last = if stiff { inertia } else { block };
        let product = Sym3::from_mat3(&(inertia.to_mat3() * inverse.to_mat3() * last.to_mat3()));
        if stiff { *inertia - product } else { product }
    };
    match freedom {
        Freedom::Free => free(),
        Freedom::Along { normal, yielding, .. } => {
            let along = *inverse * *normal;
            let back = if stiff { *normal - *inertia * along } else { *block * along };
            free() + Sym3::outer(back) * (1.0 / (normal.dot(along) + yielding))
        }
        Freedom::Fixed => *block,
    }
}
