//! Reactions of the joints: the momentum that the subtree below each joint gained, minus the impulses of contacts, loops and particles;
//! torques are about the anchor of B. The reactions are summed in two parts, since the pose changes between `solve` and `relax`: with the
//! arms of the new pose, the torque of the `solve` impulses would be 3 % too high for an arm that turns at 3 rad/s.

use crate::joint::DIRECTIONS;
use crate::solver::IslandSolver;
use crate::solver::articulation::tree::NONE;
use crate::solver::motion::ListGains;
use crate::spatial::{Vec6, ZERO6, add_scaled, angular, join, linear};
use sinew_math::Vec3;
use sinew_math::dispatch;

/// Start time of the measured momentum gains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Since {
    /// After the forces of the substep have acted.
    Forces,
    /// After the bodies have moved.
    Motion,
}

impl IslandSolver {
    /// Adds the reactions of `solve`, with arms and axes of the pose at the substep's beginning.
    pub(in crate::solver) fn add_solve_reactions(&mut self) {
        if !self.has_joints() {
            return;
        }
        self.sum_gains(Since::Forces);
        self.take_pushes();
        self.take_saturated();
        self.pass_down();
        self.add_loop_reactions(1.0);
    }

    /// Subtracts the impulses of the saturated motors of loops and pins, and adds them to their reactions. The impulses of the motors of
    /// tree joints are part of the joints' impulses on their subtrees.
    fn take_saturated(&mut self) {
        let sums = &mut self.scratch.impulses;
        for &joint in self.loops.joints.iter().chain(&self.pins.joints) {
            let joint = &mut self.joints[joint as usize];
            for direction in 0..DIRECTIONS {
                let Some([on_a, on_b]) = joint.push_of_motor(direction, self.h) else { continue };
                for (body, push) in [(joint.a, on_a), (joint.b, on_b)] {
                    if let Some(sum) = sums.get_mut(body as usize) {
                        add_scaled(sum, &push, -1.0);
                    }
                }
                joint.add_reaction(&on_b, joint.pose.arm_b);
            }
        }
    }

    /// Begins the reactions of `relax` at the new pose; the present momentum and the impulses of contacts and loops so far do not count.
    pub(in crate::solver) fn begin_relax_reactions(&mut self) {
        if !self.has_joints() {
            return;
        }
        let moving = self.links.len();
        self.moved.clear();
        self.moved.extend_from_slice(&self.velocities[..moving]);
        self.scratch.impulses.clear();
        self.scratch.impulses.resize(moving, ZERO6);
        self.take_pushes();
        core::mem::swap(&mut self.accounted, &mut self.scratch.impulses);
        self.add_loop_reactions(-1.0);
    }

    /// Adds the reactions of `relax`.
    pub(in crate::solver) fn add_relax_reactions(&mut self) {
        if !self.has_joints() {
            return;
        }
        self.settle_pins();
        self.sum_gains(Since::Motion);
        self.take_pushes();
        for (gained, accounted) in self.scratch.impulses.iter_mut().zip(&self.accounted) {
            add_scaled(gained, accounted, -1.0);
        }
        self.pass_down();
        self.add_loop_reactions(1.0);
    }

    /// Sums the momentum that each moving body gained about its centre, N·s and N·m·s.
    fn sum_gains(&mut self, since: Since) {
        let before = match since {
            Since::Forces => &self.unconstrained,
            Since::Motion => &self.moved,
        };
        let moving = self.links.len();
        dispatch::run(ListGains {
            bodies: &self.bodies[..moving],
            velocities: &self.velocities[..moving],
            before: &before[..moving],
            list: &mut self.scratch.impulses,
        });
    }

    /// Subtracts the impulses of contacts, loops and pins in this substep.
    fn take_pushes(&mut self) {
        let sums = &mut self.scratch.impulses;
        for rows in &self.manifolds {
            rows.add_impulses(sums, -1.0);
        }
        self.contacts.add_impulses(sums, -1.0);
        for &joint in self.loops.joints.iter().chain(&self.pins.joints) {
            let joint = &self.joints[joint as usize];
            joint.push(&joint.impulse, sums, -1.0);
        }
    }

    /// Adds the impulses of loop joints and pins, times `sign`.
    fn add_loop_reactions(&mut self, sign: f32) {
        for &joint in self.loops.joints.iter().chain(&self.pins.joints) {
            let joint = &mut self.joints[joint as usize];
            let [_, on_b] = joint.rows.impulse(&joint.impulse);
            joint.add_reaction(&on_b.map(|x| sign * x), joint.pose.arm_b);
        }
    }

    /// Sums from leaf to root: the impulse of a joint on its child is the child's gain plus the impulses of the joints below.
    fn pass_down(&mut self) {
        for i in (0..self.links.len()).rev() {
            let link = &self.links[i];
            if link.joint == NONE {
                continue;
            }
            let on_child = self.scratch.impulses[i];
            let (index, parent) = (link.joint as usize, link.parent as usize);
            let joint = &self.joints[index];
            let child_is_b = joint.b as usize == i;
            let (arm, other) = if child_is_b {
                (joint.pose.arm_b, joint.pose.arm_a)
            } else {
                (joint.pose.arm_a, joint.pose.arm_b)
            };
            // Torque at the anchor, then the same at the parent's centre.
            let torque = angular(&on_child) - arm.cross(linear(&on_child));
            if parent < self.links.len() {
                let through = join(linear(&on_child), torque + other.cross(linear(&on_child)));
                add_scaled(&mut self.scratch.impulses[parent], &through, 1.0);
            }
            let sign = if child_is_b { 1.0 } else { -1.0 };
            add_scaled(&mut self.joints[index].reaction, &join(linear(&on_child), torque), sign);
        }
    }
}

impl crate::solver::SolverJoint {
    /// Adds the impulses of the joint's rows, times `sign`, to those of the bodies.
    pub(in crate::solver) fn push(&self, of_rows: &Vec6, impulses: &mut [Vec6], sign: f32) {
        let [on_a, on_b] = self.rows.impulse(of_rows);
        for (body, push, sign) in [(self.a, on_a, -sign), (self.b, on_b, sign)] {
            if let Some(sum) = impulses.get_mut(body as usize) {
                add_scaled(sum, &push, sign);
            }
        }
    }

    /// Adds the reaction to an impulse on B at its centre; `arm` points from the centre to the anchor, world axes.
    pub(in crate::solver) fn add_reaction(&mut self, on_b: &Vec6, arm: Vec3) {
        let torque = angular(on_b) - arm.cross(linear(on_b));
        add_scaled(&mut self.reaction, &join(linear(on_b), torque), 1.0);
    }
}
