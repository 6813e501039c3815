//! The joints of the trees: their rows, the factor, and the exact solve of velocities (RATTLE) and positions (SHAKE).

use super::motion::{ListInertias, Predict};
use super::sweep::Pass;
use super::tree::{self, NONE};
use super::{Coupling, IslandSolver, SolverJoint};
use crate::joint::JointPose;
use crate::spatial::{Vec6, ZERO6, add_scaled, linear};
use sinew_math::dispatch;
use sinew_math::max;

/// Most rounds of position corrections in a pass, likewise with many loops, and the error that needs none, m or rad.
pub(super) const POSITION_CORRECTIONS: usize = 6;
const POSITION_CORRECTIONS_ITERATED: usize = 1;
/// Likewise in heaps: the second round leaves micrometres.
const POSITION_CORRECTIONS_BY_TURNS: usize = 2;
pub(super) const POSITION_TOLERANCE: f32 = 1e-6;
/// Share of the largest coordinate that needs none either: one and a half of its last digits, which is what rounding of two positions
/// makes of a gap.
pub(super) const POSITION_ROUNDING: f32 = 1.5 * f32::EPSILON;

/// Most further solves in `relax`, and the share of the fastest velocity that joints may leave.
pub(super) const REFINEMENTS: usize = 2;
pub(super) const RATE_SHARE: f32 = 1e-4;

impl IslandSolver {
    /// Poses and rows of all joints.
    pub(super) fn refresh_joints(&mut self) {
        for joint in &mut self.joints {
            let (a, b) = (&self.bodies[joint.a as usize].pose, &self.bodies[joint.b as usize].pose);
            joint.pose = JointPose::new(&joint.geometry, a, b);
        }
        self.refresh_rows();
    }

    pub(super) fn refresh_rows(&mut self) {
        for joint in &mut self.joints {
            joint.refresh_rows(&self.velocities, self.h);
        }
    }

    /// Rows of the tree joints and the factor of all trees.
    pub(super) fn factor_joints(&mut self) {
        let inertia = &mut self.scratch.inertia;
        dispatch::run(ListInertias { bodies: &self.bodies[..self.links.len()], list: inertia });
        for &pin in &self.pins.joints {
            self.joints[pin as usize].stiffen(inertia);
        }
        tree::factor(&mut self.links, &self.joints, inertia);
    }

    /// Solves the joint rows exactly.
    pub(super) fn project_joints(&mut self, pass: Pass) {
        if !self.is_articulated() {
            return;
        }
        let solve = pass == Pass::Solve;
        if solve {
            for joint in &mut self.joints {
                joint.bent = ZERO6;
            }
        }
        self.scratch.residuals.clear();
        for link in &self.links {
            let residual = match self.joints.get(link.joint as usize) {
                Some(joint) => joint.residual(&joint.rate(&self.velocities), solve, self.h),
                None => ZERO6,
            };
            self.scratch.residuals.push(residual);
        }
        self.scratch.loop_residuals.clear();
        for &joint in &self.loops.joints {
            let joint = &self.joints[joint as usize];
            self.scratch.loop_residuals.push(joint.residual(&joint.rate(&self.velocities), solve, self.h));
        }
        self.scratch.impulses.clear();
        self.scratch.impulses.resize(self.links.len(), ZERO6);
        if solve {
            self.pull_pins();
        }
        self.solve_trees();
    }

    /// Iterative refinement: between masses of 1 : 100,000 one solve in single precision leaves too much. Not with loops:
    /// redundant rows of a closed chain never agree to the last digit, and to insist makes its drives do work.
    pub(super) fn refine_joints(&mut self) {
        if !self.loops.is_empty() || self.coupling == Coupling::Turns {
            return;
        }
        for _ in 0..REFINEMENTS {
            let fastest = self.velocities.iter().flatten().fold(0.0, |most, x| max(most, x.abs()));
            let mut left = 0.0;
            for joint in &self.joints {
                for rate in &joint.rate(&self.velocities)[..joint.rigid] {
                    left = max(left, rate.abs());
                }
            }
            if left <= RATE_SHARE * fastest {
                break;
            }
            self.project_joints(Pass::Relax);
        }
    }

    /// SHAKE: removes the position error at the pose that the velocities lead to, with the same factor, until it is
    /// small enough (one or two rounds but for violent hits). The factor is that of the substep's beginning: for a body
    /// that turns by more than a radian it may lead away, so a round that does not halve the error is taken back and
    /// the next substep goes on from there.
    ///
    /// Gives the largest error that is left, m or rad.
    pub(super) fn correct_positions(&mut self) -> f32 {
        if !self.is_articulated() {
            return 0.0;
        }
        let moving = self.links.len();
        let mut error = self.predict_errors();
        let rounds = match self.coupling {
            _ if self.loops.are_iterated() => POSITION_CORRECTIONS_ITERATED,
            Coupling::Turns => POSITION_CORRECTIONS_BY_TURNS,
            _ => POSITION_CORRECTIONS,
        };
        for _ in 0..rounds {
            if error < POSITION_TOLERANCE {
                break;
            }
            self.scratch.before.clear();
            self.scratch.before.extend_from_slice(&self.velocities[..moving]);
            self.scratch.impulses.clear();
            self.scratch.impulses.resize(moving, ZERO6);
            self.bend_welds();
            self.solve_trees();
            let left = self.predict_errors();
            let better = left < 0.5 * error;
            if !better {
                if left > error {
                    self.velocities[..moving].copy_from_slice(&self.scratch.before);
                    for joint in &mut self.joints {
                        joint.bent = joint.bent_before;
                    }
                    self.predict_poses();
                }
                break;
            }
            error = left;
        }
        error
    }

    /// Poses that the velocities lead to.
    fn predict_poses(&mut self) {
        let poses = &mut self.scratch.predicted;
        dispatch::run(Predict { bodies: &self.bodies, velocities: &self.velocities, h: self.h, poses });
    }

    /// Residuals that would remove the position errors at the predicted pose; gives the largest error (m or rad).
    fn predict_errors(&mut self) -> f32 {
        self.predict_poses();
        let h = self.h;
        let poses = &self.scratch.predicted;
        let mut largest = 0.0;
        let mut residual = |joint: &mut SolverJoint| {
            let [a, b] = [joint.a, joint.b].map(|body| &poses[body as usize]);
            let error = if joint.is_point() {
                joint.point_error(JointPose::gap(&joint.geometry, a, b))
            } else if joint.rigid > 0 {
                joint.rigid_error(&JointPose::new(&joint.geometry, a, b))
            } else {
                joint.bend_error(&JointPose::new(&joint.geometry, a, b), &self.velocities, h)
            };
            largest = error.iter().fold(largest, |most, error| max(most, error.abs()));
            error.map(|error| -error / h)
        };
        self.scratch.residuals.clear();
        for link in &self.links {
            self.scratch
                .residuals
                .push(self.joints.get_mut(link.joint as usize).map_or(ZERO6, &mut residual));
        }
        self.scratch.loop_residuals.clear();
        for &joint in &self.loops.joints {
            self.scratch.loop_residuals.push(residual(&mut self.joints[joint as usize]));
        }
        largest
    }

    /// The residuals of welds that give, as they stand, are made up for.
    fn bend_welds(&mut self) {
        let h = self.h;
        let bend = |joint: &mut SolverJoint, residual: &Vec6| {
            joint.bent_before = joint.bent;
            if joint.rigid == 0 {
                add_scaled(&mut joint.bent, residual, -h);
            }
        };
        for (link, residual) in self.links.iter().zip(&self.scratch.residuals) {
            if let Some(joint) = self.joints.get_mut(link.joint as usize) {
                bend(joint, residual);
            }
        }
        for (&joint, residual) in self.loops.joints.iter().zip(&self.scratch.loop_residuals) {
            bend(&mut self.joints[joint as usize], residual);
        }
    }

    /// Adds to the velocities the answer of the trees to `scratch.impulses` and `scratch.residuals`, loops closed.
    pub(super) fn solve_trees(&mut self) {
        let s = &mut self.scratch;
        s.dv.resize(self.links.len(), ZERO6);
        for (link, residuals) in self.links.iter().zip(&s.residuals) {
            if let Some(joint) = self.joints.get(link.joint as usize) {
                link.push_gains(joint, residuals, &mut s.impulses);
            }
        }
        tree::solve(&self.links, 0..self.links.len(), &mut s.impulses, &s.residuals, &mut s.dv);
        for (v, dv) in self.velocities.iter_mut().zip(&s.dv) {
            add_scaled(v, dv, 1.0);
        }
        if self.loops.is_empty() {
            return;
        }
        s.residuals.clear();
        let moving = self.links.len();
        self.loops.close(&mut self.joints, &self.links, s);
        for (v, dv) in self.velocities[..moving].iter_mut().zip(&s.dv) {
            add_scaled(v, dv, 1.0);
        }
    }

    /// [`solve_trees`](Self::solve_trees) for `scratch.impulses` alone.
    pub(super) fn answer_impulses(&mut self) {
        if !self.is_articulated() {
            for (i, impulse) in self.scratch.impulses.iter().enumerate() {
                let change = self.bodies[i].velocity_change(impulse);
                add_scaled(&mut self.velocities[i], &change, 1.0);
            }
            return;
        }
        self.scratch.residuals.clear();
        self.scratch.loop_residuals.clear();
        self.scratch.loop_residuals.resize(self.loops.joints.len(), ZERO6);
        self.solve_trees();
    }

    /// The linear force of each tree joint on its child in this substep: what the momentum of the subtree below gained,
    /// less what contacts gave it.
    pub(super) fn store_joint_forces(&mut self) {
        if !self.is_articulated() {
            return;
        }
        let push = &mut self.contact_push;
        for i in 0..self.links.len() {
            let gained = linear(&self.velocities[i]) - linear(&self.unconstrained[i]);
            push[i] = gained * self.bodies[i].mass - push[i];
        }
        for &joint in self.loops.joints.iter().chain(&self.pins.joints) {
            let joint = &mut self.joints[joint as usize];
            let [_, on_b] = joint.rows.impulse(&joint.impulse);
            joint.force = linear(&on_b) / self.h;
            for (body, sign) in [(joint.a, 1.0), (joint.b, -1.0)] {
                if let Some(push) = push.get_mut(body as usize) {
                    *push += linear(&on_b) * sign;
                }
            }
        }
        for (i, link) in self.links.iter().enumerate().rev() {
            if link.joint == NONE {
                continue;
            }
            let total = push[i];
            if (link.parent as usize) < push.len() {
                push[link.parent as usize] += total;
            }
            let joint = &mut self.joints[link.joint as usize];
            let on_b = if joint.b as usize == i { total } else { -total };
            joint.force = on_b / self.h;
        }
    }
}
