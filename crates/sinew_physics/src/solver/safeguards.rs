//! Safeguards that keep violent hits from adding energy. Rows are linear and valid at the pose at which they were built. A hit that turns a
//! limb by a large part of a radian within a substep leaves that pose, and impulses that were right before can add energy. No safeguard
//! acts at rest or in ordinary falls.

use crate::joint::DIRECTIONS;
use crate::solver::IslandSolver;
use crate::solver::articulation::tree::NONE;
use crate::solver::body::SolverBody;
use crate::solver::contact_rows::ManifoldRows;
use crate::solver::motion::KineticEnergy;
use crate::solver::motion::momentum::{Momentum, RigidMotion, center_of_mass};
use crate::solver::pass::{Coupling, Pass};
use crate::solver::tuning::{DIVERGED_SPEED, DIVERGED_SPIN, ENERGY_SLACK, MAX_INNER_TURN, TORN};
use crate::spatial::{Vec6, ZERO6, angular, difference, linear};
use sinew_math::dispatch;
use sinew_math::{Vec3, max, min};

impl IslandSolver {
    /// Drops the warm start of a substep if it adds energy. Impulses that support weights remove energy; impulses of an impact, repeated at
    /// another pose, may add energy.
    pub(in crate::solver) fn drop_bad_warm_start(&mut self) {
        let moving = self.links.len();
        let before = self.kinetic_energy(&self.unconstrained) + self.push_energy;
        let rise = self.kinetic_energy(&self.velocities[..moving]) - before;
        if rise <= ENERGY_SLACK * max(before, self.mass()) {
            return;
        }
        self.velocities[..moving].copy_from_slice(&self.unconstrained);
        self.push_again();
        self.scratch.started.copy_from_slice(&self.velocities[..moving]);
        self.forget_impulses();
        self.project_joints(Pass::Solve);
    }

    fn forget_impulses(&mut self) {
        self.contact_push.fill(Vec3::ZERO);
        for rows in &mut self.manifolds {
            rows.forget();
        }
        self.contacts.forget();
        for joint in &mut self.joints {
            joint.impulse = ZERO6;
            joint.bent = ZERO6;
        }
        for row in &mut self.limits {
            row.impulse = 0.0;
        }
    }

    /// Kinetic energy of the moving bodies with the given velocities, joules.
    pub(in crate::solver) fn kinetic_energy(&self, velocities: &[Vec6]) -> f32 {
        dispatch::run(KineticEnergy { bodies: &self.bodies[..velocities.len()], velocities })
    }

    /// Total mass of the moving bodies, kg.
    pub(in crate::solver) fn mass(&self) -> f32 {
        self.bodies[..self.links.len()].iter().fold(0.0, |sum, body| sum + body.mass)
    }

    /// Slows the inner motion of trees with links that would turn too far within the substep. One factor for the whole tree moves it
    /// towards the rigid motion with the same momentum. Joints stay satisfied, since their rows are linear, and momentum is conserved;
    /// clamping single links would tear the joints. Only whips in violent hits are slowed.
    pub(in crate::solver) fn limit_inner_turn(&mut self) {
        let most = MAX_INNER_TURN / self.h;
        let mut first = 0;
        while first < self.links.len() {
            let tree = self.links[first].tree;
            let count = self.links[first..].iter().take_while(|link| link.tree == tree).count();
            let range = first..first + count;
            let fast = self.velocities[range.clone()].iter().any(|v| angular(v).length() > most);
            if count > 1 && fast {
                self.limit_inner_turn_of(range, most);
            }
            first += count;
        }
    }

    fn limit_inner_turn_of(&mut self, range: core::ops::Range<usize>, most: f32) {
        let rigid = if self.links[range.start].joint == NONE {
            RigidMotion::of(&self.bodies[range.clone()], &self.velocities[range.clone()])
        } else {
            RigidMotion::default() // held by a fixed body
        };
        let mut keep: f32 = 1.0;
        for v in &self.velocities[range.clone()] {
            let inner = (angular(v) - rigid.angular).length();
            let room = max(most - rigid.angular.length(), 0.0);
            keep = min(keep, if inner > room { room / inner } else { 1.0 });
        }
        self.dirty.mark(self.links[range.start].tree, most);
        for i in range {
            let rigid = rigid.at(self.bodies[i].pose.translation);
            for (v, r) in self.velocities[i].iter_mut().zip(rigid) {
                *v = r + (*v - r) * keep;
            }
        }
    }

    /// Falls back to a rigid motion if the solution is invalid: not finite, beyond all limits, or leaving joints open by `torn`, m or rad.
    /// This happens with rows that contradict each other (a body dragged into the floor, conflicting joints), and where a blow gives a light
    /// body a spin whose tangent leads far beyond its joint. The island then moves as one rigid piece for this pass, with its momentum after
    /// the forces: no joint opens, and no energy is added.
    pub(in crate::solver) fn fall_back_to_rigid(&mut self, torn: f32) {
        let moving = self.links.len();
        let most = [DIVERGED_SPEED * self.max_speed, DIVERGED_SPIN];
        let sane = |v: &Vec6| (0..DIRECTIONS).all(|k| v[k].abs() < most[k / 3]);
        let sane = self.velocities[..moving].iter().all(sane);
        if sane && torn < TORN {
            return;
        }
        let rigid = self.slide_as_one();
        for (body, v) in self.bodies.iter().zip(&mut self.velocities[..moving]) {
            *v = rigid.at(body.pose.translation);
        }
        self.forget_impulses();
    }

    /// Rigid motion of the island with the momentum of the given velocities; at rest if the island touches or is jointed to a fixed body.
    fn motion_as_one(&self, velocities: &[Vec6]) -> RigidMotion {
        if self.is_held() { RigidMotion::default() } else { RigidMotion::of(&self.bodies, velocities) }
    }

    /// Rigid motion of the island with its momentum after the forces, at the present poses.
    fn meant_as_one(&self) -> RigidMotion {
        if self.is_held() {
            RigidMotion::default()
        } else {
            RigidMotion::with_momentum(&self.bodies, &self.momentum_start)
        }
    }

    /// [`Self::meant_as_one`], but an island that only touches fixed bodies slides along them: it loses the part of its velocity that leads
    /// into them, and its spin.
    fn slide_as_one(&self) -> RigidMotion {
        let moving = self.links.len();
        let is_jointed =
            self.joints.iter().any(|joint| [joint.a, joint.b].iter().any(|&end| end as usize >= moving));
        if !self.is_held() || is_jointed || self.coupling != Coupling::Response {
            return self.meant_as_one();
        }
        let (mass, center) = center_of_mass(&self.bodies[..moving]);
        let mut linear = self.momentum_start.linear / mass;
        // Twice, for a floor and a wall that are not at right angles.
        for rows in self.manifolds.iter().chain(&self.manifolds) {
            if let Some(outward) = rows.outward(moving) {
                linear += outward * max(-linear.dot(outward), 0.0);
            }
        }
        RigidMotion { center, linear, angular: Vec3::ZERO }
    }

    /// True if the island touches or is jointed to a fixed body.
    fn is_held(&self) -> bool {
        self.bodies.len() > self.links.len()
    }

    /// Momentum of the moving bodies after the forces have acted.
    pub(in crate::solver) fn momentum_of_start(&self) -> Momentum {
        let mut momentum = Momentum::default();
        let center = center_of_mass(&self.bodies[..self.links.len()]).1;
        for (body, v) in self.bodies.iter().zip(&self.velocities[..self.links.len()]) {
            momentum.add(body, center, linear(v), body.momentum);
        }
        momentum
    }

    /// Limits the energy that the solve adds. Rigid joints and stops cannot add energy, springs and motors at most their work. Energy added
    /// by rounding, redundant rows, or stops at a mispredicted pose is removed from the motion relative to the rigid motion of the island:
    /// joints stay satisfied, since their rows are linear, and momentum is conserved.
    ///
    /// The potential energy by which soft contacts raise a standing body counts as added: otherwise a heavy leg on a light foot rocks
    /// higher and higher, by 0.1 J for each edge that sinks in and rises again. A small amount is allowed where a body is crushed, since a
    /// hand under a thigh must get out.
    pub(in crate::solver) fn bound_energy(&mut self) {
        let moving = self.links.len();
        if self.pushed_from_outside || !self.is_passive() {
            return;
        }
        let after = self.kinetic_energy(&self.velocities[..moving]);
        let slack = ENERGY_SLACK * max(self.kinetic_start, self.mass());
        let mut allowed = self.kinetic_start + self.drive_work;
        let mut most = allowed + slack;
        if self.has_joints() && !self.manifolds.is_empty() {
            let lift = if self.manifolds.iter().any(ManifoldRows::is_deep) { slack } else { 0.0 };
            allowed = min(allowed, self.kinetic_before + self.force_work + self.drive_work + lift);
            most = min(most, allowed);
        }
        if after <= most {
            return;
        }
        // Momentum is corrected to that after the forces, for any motion inside the island.
        let (now, meant) = (self.motion_as_one(&self.velocities[..moving]), self.meant_as_one());
        let s = &mut self.scratch;
        s.dv.clear();
        s.before.clear();
        for (body, v) in self.bodies.iter().zip(&self.velocities[..moving]) {
            s.dv.push(difference(v, &now.at(body.pose.translation)));
            s.before.push(meant.at(body.pose.translation));
        }
        let inner = self.kinetic_energy(&self.scratch.dv);
        let share = max(allowed - self.kinetic_energy(&self.scratch.before), 0.0) / inner;
        let keep = if share < 1.0 { share.sqrt() } else { 1.0 };
        for (i, v) in self.velocities[..moving].iter_mut().enumerate() {
            let (meant, inner) = (&self.scratch.before[i], &self.scratch.dv[i]);
            *v = core::array::from_fn(|k| meant[k] + inner[k] * keep);
        }
    }

    /// Limits the energy of position corrections. Violated stops push back, joints opened by rounding close, and springs may resist this.
    /// The energy that springs absorb has to come from kinetic energy or from motors. If there is too little, the motion relative to the
    /// rigid motion is slowed, and the rest of the correction follows later. Joints with larger gaps are closed at any cost.
    pub(in crate::solver) fn bound_position_energy(&mut self) {
        if self.pushed_from_outside || !self.is_passive() || !self.has_joints() {
            return;
        }
        let (square, mut linear) = self.resistance_of_springs();
        let held = self.is_held() && self.manifolds.is_empty();
        let pushed = max(self.work_of_saturated(), 0.0);
        let mut there = self.kinetic_start + pushed;
        if held {
            linear -= self.work_of_forces();
            there = self.kinetic_before + max(self.work_of_motors(), 0.0);
        }
        let slack = ENERGY_SLACK * max(there, self.mass());
        if square + linear <= slack || !(self.stops_push_back() || self.joints_close_in_time()) {
            return;
        }
        let moving = self.links.len();
        let now = self.motion_as_one(&self.velocities[..moving]);
        if !held {
            let before = self.motion_as_one(&self.unconstrained);
            let inner = |(body, v): (&SolverBody, &Vec6)| difference(v, &before.at(body.pose.translation));
            self.scratch.dv.clear();
            self.scratch.dv.extend(self.bodies.iter().zip(&self.unconstrained).map(inner));
            there = self.kinetic_energy(&self.scratch.dv) + pushed;
        }
        let there = there + slack;
        if square + linear <= there {
            return;
        }
        // Solve square s² + linear s = there by the form without cancellation.
        let root = (linear * linear + 4.0 * square * there).sqrt();
        let keep =
            if linear > 0.0 { 2.0 * there / (linear + root) } else { (root - linear) / (2.0 * square) };
        let keep = min(keep, 1.0);
        for (body, v) in self.bodies.iter().zip(&mut self.velocities[..moving]) {
            let rigid = now.at(body.pose.translation);
            *v = core::array::from_fn(|k| rigid[k] + (v[k] - rigid[k]) * keep);
        }
    }

    /// True if no joint is left open by more than the substep allows.
    fn joints_close_in_time(&self) -> bool {
        !self.joints.iter().any(|joint| joint.left_open[..joint.rigid].iter().any(|left| *left != 0.0))
    }

    /// Limits the energy of bounces. Points that bounce together, each with its own speed, may request more energy than the impact had. The
    /// velocities then change only by the share of the bounce that the energy allows: momentum is conserved, and separating points continue
    /// to separate.
    pub(in crate::solver) fn limit_bounce(&mut self) {
        if self.pushed_from_outside || !self.is_passive() {
            return;
        }
        let moving = self.links.len();
        let allowed = self.kinetic_start + self.force_work.abs() + max(self.push_work, 0.0);
        let start = self.kinetic_energy(&self.bounced_from);
        let after = self.kinetic_energy(&self.velocities[..moving]);
        if after <= allowed || start >= allowed {
            return;
        }
        // The energy along the bounce is E(0) + b s + a s², where a is the energy of the change itself.
        let s = &mut self.scratch;
        s.dv.clear();
        s.dv.extend(self.velocities.iter().zip(&self.bounced_from).map(|(v, from)| difference(v, from)));
        let a = self.kinetic_energy(&self.scratch.dv);
        let b = after - start - a;
        let room = allowed - start;
        let root = (b * b + 4.0 * a * room).sqrt();
        let share = if b > 0.0 { 2.0 * room / (b + root) } else { (root - b) / (2.0 * a) };
        let share = sinew_math::clamp(share, 0.0, 1.0);
        for (v, from) in self.velocities.iter_mut().zip(&self.bounced_from) {
            *v = core::array::from_fn(|k| from[k] + (v[k] - from[k]) * share);
        }
    }

    /// True if no kinematic body or moving surface drives the rows.
    pub(in crate::solver) fn is_passive(&self) -> bool {
        !self.driven && self.velocities[self.links.len()..].iter().all(|v| *v == ZERO6)
    }

    /// Limits the energy that `relax` adds. It cannot add any, except by impulses that are taken back at another pose, in violent hits. The
    /// velocities then change only by the share along which energy falls; joints stay satisfied all the way.
    ///
    /// [`bound_energy`](Self::bound_energy) does not cover this: it lets `relax` return the energy that `solve` lost, and removes none from
    /// the rigid motion of the island. Without this limit, equally many of 400 random worlds pass, but two of the failing ones explode (to
    /// 8e4 and 2e14 times their energy), and a ragdoll thrown at a wall sinks in by 10 mm instead of 1.
    pub(in crate::solver) fn keep_energy(&mut self) {
        let moving = self.links.len();
        let before = &self.scratch.before[..moving];
        let start = self.kinetic_energy(before);
        let rise = self.kinetic_energy(&self.velocities[..moving]) - start;
        if rise <= ENERGY_SLACK * max(start, self.mass()) {
            return;
        }
        // The energy along the change is E(0) + b s + a s², where a is the energy of the change itself.
        let s = &mut self.scratch;
        s.dv.clear();
        s.dv.extend(self.velocities.iter().zip(&s.before).map(|(v, before)| difference(v, before)));
        let a = self.kinetic_energy(&self.scratch.dv);
        let b = rise - a;
        let share = sinew_math::clamp(-b / (2.0 * a), 0.0, 1.0);
        for (v, before) in self.velocities.iter_mut().zip(&self.scratch.before) {
            *v = core::array::from_fn(|k| before[k] + (v[k] - before[k]) * share);
        }
    }
}
