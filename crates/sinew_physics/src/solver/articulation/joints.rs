//! Joints of the trees: rows, factor, and the exact solve of velocities (RATTLE) and positions (SHAKE).

use crate::joint::JointPose;
use crate::solver::IslandSolver;
use crate::solver::articulation::tree::{self, NONE};
use crate::solver::joint::SolverJoint;
use crate::solver::motion::{FindErrors, ListInertias, Predict};
use crate::solver::pass::{Corrected, Coupling, Pass};
use crate::solver::tuning::{
    POSITION_CORRECTIONS, POSITION_CORRECTIONS_ITERATED, POSITION_ROUNDING, POSITION_TOLERANCE, RATE_SHARE,
    REFINEMENTS, WORTH_ANOTHER,
};
use crate::spatial::{Vec6, ZERO6, add_scaled, largest, linear};
use sinew_math::{Transform, Vec3, abs3, dispatch, max, min};

impl IslandSolver {
    /// Recomputes poses and rows of all joints.
    pub(in crate::solver) fn refresh_joints(&mut self) {
        for joint in &mut self.joints {
            let (a, b) = (&self.bodies[joint.a as usize].pose, &self.bodies[joint.b as usize].pose);
            joint.pose = JointPose::new(&joint.geometry, a, b);
        }
        self.refresh_rows();
    }

    pub(in crate::solver) fn refresh_rows(&mut self) {
        for joint in &mut self.joints {
            joint.refresh_rows(&self.velocities, self.h);
        }
    }

    /// Factors all trees.
    pub(in crate::solver) fn factor_joints(&mut self) {
        let inertia = &mut self.scratch.inertia;
        dispatch::run(ListInertias { bodies: &self.bodies[..self.links.len()], list: inertia });
        for &pin in &self.pins.joints {
            self.joints[pin as usize].stiffen(inertia);
        }
        for range in &self.batches.alone {
            tree::factor(&mut self.links, range.clone(), &self.joints, inertia);
        }
        self.batches.factor(&self.links, &self.joints, &self.bodies);
    }

    /// Writes to `scratch.dv` the velocity changes of all trees from `scratch.impulses`, which it overwrites, and `scratch.residuals`. An empty
    /// list of residuals means zero.
    pub(in crate::solver) fn answer_trees(&mut self) {
        let Self { links, batches, scratch: s, .. } = self;
        s.dv.resize(links.len(), ZERO6);
        for range in &batches.alone {
            tree::solve(links, range.clone(), &mut s.impulses, &s.residuals, &mut s.dv);
        }
        batches.solve(&s.impulses, &s.residuals, &mut s.dv);
    }

    /// Solves the joint rows exactly.
    pub(in crate::solver) fn project_joints(&mut self, pass: Pass) {
        if !self.has_joints() {
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

    /// Refines the solution iteratively: with masses of 1 : 100,000 one solve in single precision leaves too large an
    /// error. Islands with loops are excluded: the redundant rows of a closed chain never agree to the last digit, and
    /// refinement would add energy through its drives.
    pub(in crate::solver) fn refine_joints(&mut self) {
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

    /// Removes position errors at the predicted poses (SHAKE) with the factor of the substep's start, tree by tree until
    /// they are small enough: in one or two rounds, except after violent hits. While a body turns by much of a radian, a
    /// round may raise the error and the next may lower it again. A tree therefore keeps its best round, and stops when a
    /// round gains little. Trees with loops between them, and all trees of an island that is not solved by turns, stop
    /// together.
    ///
    /// Returns the largest remaining error, m or rad.
    pub(in crate::solver) fn correct_positions(&mut self, of: Corrected) -> f32 {
        if !self.has_joints() {
            return 0.0;
        }
        let rounds = match self.coupling {
            _ if self.loops.are_iterated() => POSITION_CORRECTIONS_ITERATED,
            _ => POSITION_CORRECTIONS,
        };
        self.choose_corrected(of);
        self.find_tolerances();
        let mut errors = core::mem::take(&mut self.scratch.errors);
        let tolerances = core::mem::take(&mut self.scratch.tolerances);
        self.predict(of == Corrected::All);
        self.find_errors(&mut errors);
        self.scratch.before.clear();
        self.scratch.before.extend_from_slice(&self.velocities[..self.links.len()]);
        for joint in &mut self.joints {
            joint.bent_before = joint.bent;
        }
        for _ in 0..rounds {
            self.leave_corrected(|tree| errors[tree] < tolerances[tree]);
            if !self.scratch.corrected.contains(&true) {
                break;
            }
            self.scratch.impulses.clear();
            self.scratch.impulses.resize(self.links.len(), ZERO6);
            self.bend_welds();
            self.solve_trees();
            self.tell_corrections();
            self.predict(false);
            let mut left = core::mem::take(&mut self.scratch.errors_left);
            left.clear();
            left.extend_from_slice(&errors);
            self.find_errors(&mut left);
            self.keep_best(&left, &mut errors);
            self.scratch.errors_left = left;
        }
        self.take_back();
        let most = errors.iter().fold(0.0, |most, error| max(most, *error));
        (self.scratch.errors, self.scratch.tolerances) = (errors, tolerances);
        most
    }

    /// Writes the error of each tree that needs no correction: the rounding error of its positions, but at least [`POSITION_TOLERANCE`]. Trees
    /// that stop together have the tolerance of the one with the largest.
    fn find_tolerances(&mut self) {
        let apart = self.trees_stop_apart();
        let tolerances = &mut self.scratch.tolerances;
        tolerances.clear();
        tolerances.extend(self.trees.iter().map(|range| {
            let positions = self.bodies[range.clone()].iter().map(|body| abs3(body.pose.translation));
            let reach = positions.fold(Vec3::ZERO, |most, at| {
                Vec3::new(max(most.x, at.x), max(most.y, at.y), max(most.z, at.z))
            });
            max(POSITION_TOLERANCE, POSITION_ROUNDING * max(reach.x, max(reach.y, reach.z)))
        }));
        if !apart {
            let most = tolerances.iter().fold(0.0, |most, tolerance| max(most, *tolerance));
            tolerances.fill(most);
        }
    }

    /// True if each tree ends its position corrections by its own error.
    fn trees_stop_apart(&self) -> bool {
        self.coupling == Coupling::Turns && self.loops.is_empty()
    }

    /// Chooses the trees to correct and clears their residuals.
    fn choose_corrected(&mut self, of: Corrected) {
        let s = &mut self.scratch;
        let trees = self.trees.len();
        s.corrected.clear();
        match of {
            Corrected::All => s.corrected.resize(trees, true),
            Corrected::Changed => s.corrected.extend((0..trees).map(|tree| self.dirty.has_changed(tree))),
        }
        s.errors.resize(trees, 0.0);
        s.looked_at.clear();
        s.looked_at.extend_from_slice(&s.corrected);
        s.residuals.clear();
        s.residuals.resize(self.links.len(), ZERO6);
    }

    /// Ends the correction of trees for which `is_done` is true.
    fn leave_corrected(&mut self, is_done: impl Fn(usize) -> bool) {
        let s = &mut self.scratch;
        for (tree, range) in self.trees.iter().enumerate() {
            if s.corrected[tree] && is_done(tree) {
                s.corrected[tree] = false;
                s.residuals[range.clone()].fill(ZERO6);
            }
        }
    }

    /// Marks the trees that a correction changed, so that limits visit them.
    fn tell_corrections(&mut self) {
        if self.coupling != Coupling::Turns {
            return;
        }
        for (tree, range) in self.trees.iter().enumerate().filter(|(tree, _)| self.scratch.corrected[*tree]) {
            let mut most = 0.0;
            for change in &self.scratch.dv[range.clone()] {
                most = max(most, largest(change));
            }
            self.dirty.mark(tree as u32, most);
        }
    }

    /// Stores the velocities of trees whose error is the least so far. Ends the correction of trees whose error shrank by little.
    fn keep_best(&mut self, left: &[f32], errors: &mut [f32]) {
        for tree in (0..self.trees.len()).filter(|&tree| left[tree] < errors[tree]) {
            if !self.scratch.corrected[tree] {
                continue;
            }
            let range = self.trees[tree].clone();
            self.scratch.before[range.clone()].copy_from_slice(&self.velocities[range.clone()]);
            let of_links = self.links[range].iter().map(|link| link.joint);
            for joint in of_links.chain(self.loops.joints.iter().copied()) {
                if let Some(joint) = self.joints.get_mut(joint as usize) {
                    joint.bent_before = joint.bent;
                }
            }
        }
        self.leave_corrected(|tree| left[tree] < errors[tree] && left[tree] > WORTH_ANOTHER * errors[tree]);
        for (error, left) in errors.iter_mut().zip(left) {
            *error = min(*error, *left);
        }
    }

    /// Restores the velocities of the best round of each tree.
    fn take_back(&mut self) {
        for tree in 0..self.trees.len() {
            let range = self.trees[tree].clone();
            if self.velocities[range.clone()] == self.scratch.before[range.clone()] {
                continue;
            }
            self.velocities[range.clone()].copy_from_slice(&self.scratch.before[range.clone()]);
            for link in &self.links[range.clone()] {
                if let Some(joint) = self.joints.get_mut(link.joint as usize) {
                    joint.bent = joint.bent_before;
                }
            }
            for &joint in &self.loops.joints {
                let joint = &mut self.joints[joint as usize];
                joint.bent = joint.bent_before;
            }
            let (bodies, velocities) = (&self.bodies[range.clone()], &self.velocities[range.clone()]);
            let poses = &mut self.scratch.predicted[range];
            dispatch::run(Predict { bodies, velocities, h: self.h, poses });
        }
    }

    /// Predicts the poses at the end of the substep, of all bodies or of the trees being corrected.
    fn predict(&mut self, all: bool) {
        let Self { bodies, velocities, scratch, trees, h, .. } = self;
        scratch.predicted.resize(bodies.len(), Transform::IDENTITY);
        let mut predict = |range: core::ops::Range<usize>| {
            let (bodies, velocities) = (&bodies[range.clone()], &velocities[range.clone()]);
            dispatch::run(Predict { bodies, velocities, h: *h, poses: &mut scratch.predicted[range] });
        };
        if all {
            predict(0..bodies.len());
        } else {
            for (_, range) in trees.iter().enumerate().filter(|(tree, _)| scratch.corrected[*tree]) {
                predict(range.clone());
            }
        }
    }

    /// Computes the residuals that remove the position errors of the trees being corrected at their predicted poses, and writes the largest
    /// error of each tree (m or rad).
    fn find_errors(&mut self, errors: &mut [f32]) {
        let apart = self.trees_stop_apart();
        let Self { velocities, joints, links, loops, trees, h, scratch: s, .. } = self;
        let (h, poses) = (*h, &s.predicted[..]);
        // The residuals were used where loops were closed.
        s.residuals.resize(links.len(), ZERO6);
        for (tree, range) in trees.iter().enumerate().filter(|(tree, _)| s.corrected[*tree]) {
            let residuals = &mut s.residuals[range.clone()];
            let links = &links[range.clone()];
            errors[tree] = dispatch::run(FindErrors { links, joints, poses, velocities, h, residuals });
        }
        s.loop_residuals.clear();
        if apart {
            return;
        }
        let mut most = errors.iter().fold(0.0, |most, error| max(most, *error));
        for &joint in &loops.joints {
            let error = joints[joint as usize].position_error(poses, velocities, h);
            most = error.iter().fold(most, |most, error| max(most, error.abs()));
            s.loop_residuals.push(error.map(|error| -error / h));
        }
        errors.fill(most);
    }

    /// Records in `bent` the part of the motion of soft welds that the residuals correct.
    fn bend_welds(&mut self) {
        let h = self.h;
        let bend = |joint: &mut SolverJoint, residual: &Vec6| {
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

    /// Adds to the velocities the response of the trees to `scratch.impulses` and `scratch.residuals`, then closes loops.
    pub(in crate::solver) fn solve_trees(&mut self) {
        let s = &mut self.scratch;
        for (link, residuals) in self.links.iter().zip(&s.residuals) {
            if let Some(joint) = self.joints.get(link.joint as usize) {
                link.push_gains(joint, residuals, &mut s.impulses);
            }
        }
        self.answer_trees();
        let s = &mut self.scratch;
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
    pub(in crate::solver) fn answer_impulses(&mut self) {
        if !self.has_joints() {
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

    /// Stores the linear force of each tree joint on its child in this substep: the momentum gained by the subtree below minus the
    /// impulses of contacts on it, over the length of the substep.
    pub(in crate::solver) fn store_joint_forces(&mut self) {
        if !self.has_joints() {
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
