//! Rows of joint limits: unilateral, outside the tree factor, visited by the sweeps.

use crate::joint::{JointPose, LimitImpulse, MAX_LIMITS, MAX_STOPS, Stop, each_stop, turns};
use crate::solver::IslandSolver;
use crate::solver::articulation::tree::NONE;
use crate::solver::joint::SolverJoint;
use crate::solver::limits::row::LimitRow;
use crate::solver::limits::row::{Hardness, share};
use crate::solver::tuning::{HIT_LEVER, LIMIT_LEAP, LIMIT_MARGIN_ANGLE, LIMIT_MARGIN_LENGTH};
use crate::spatial::{angular, linear};
use sinew_math::{Vec3, max, min};

impl IslandSolver {
    /// Makes rows for the limits that may be reached within the substep.
    pub(in crate::solver) fn choose_limits(&mut self) {
        // The impulses of the substep so far still count, so that `relax` can take back excess impulses of `solve`.
        for joint in &mut self.joints {
            joint.limit_impulse = [Vec3::ZERO; MAX_LIMITS];
        }
        for row in self.limits.drain(..).filter(|row| !matches!(row.hardness, Hardness::Soft(..))) {
            self.joints[row.joint as usize].limit_impulse[row.limit] += row.axis * row.impulse;
        }
        self.hit_rate = 0.0;
        if !(self.manifolds.is_empty() && self.contacts.is_empty()) {
            for v in &self.velocities[..self.links.len()] {
                self.hit_rate = max(self.hit_rate, angular(v).length() + linear(v).length() / HIT_LEVER);
            }
        }
        let limits = &mut self.limits;
        for (index, joint) in self.joints.iter().enumerate() {
            let [slide, turn] = joint.anchor_rates(&self.velocities);
            let reach = [
                LIMIT_MARGIN_LENGTH + 2.0 * self.h * slide,
                LIMIT_MARGIN_ANGLE + 2.0 * self.h * max(turn, self.hit_rate),
            ];
            let (soft, zone) = (joint.drive.limit_softness, joint.drive.soft_zone);
            let looked_for = [reach[0], max(reach[1], zone.map_or(0.0, |zone| zone.width))];
            each_stop(&joint.geometry.kind, &joint.pose, looked_for, |place, stop| {
                if stop.slack < reach[usize::from(turns(stop.limit))] {
                    let hardness = soft.map_or(Hardness::Hard, |soft| Hardness::Soft(soft, 1.0));
                    let axis = joint.pose.rotation_a * stop.axis;
                    let impulse = share(joint.limit_impulse[stop.limit], axis);
                    let impulse = if soft.is_some() { 0.0 } else { impulse };
                    limits.push(LimitRow::new((index, joint), place, &stop, hardness, impulse));
                }
                let zone = zone.filter(|zone| turns(stop.limit) && stop.slack < zone.width);
                if let (Some(zone), None) = (zone, soft) {
                    let early = Stop { slack: stop.slack - zone.width, ..stop };
                    // Damping grows with depth: full damping at the edge of the zone would act like an impact.
                    let depth = min(-early.slack / zone.width, 1.0);
                    let hardness = Hardness::Soft(zone.softness, depth);
                    limits.push(LimitRow::new((index, joint), place, &early, hardness, 0.0));
                }
            });
        }
        for joint in &mut self.joints {
            joint.slack_before = core::mem::replace(&mut joint.least_slack, 0.0);
        }
        for row in self.limits.iter().filter(|row| row.hardness == Hardness::Hard && turns(row.limit)) {
            let least = &mut self.joints[row.joint as usize].least_slack;
            *least = min(*least, row.slack);
        }
    }

    /// True if a rotation went beyond a hard limit by more than `LIMIT_LEAP` within the substep.
    pub(in crate::solver) fn leaps_limits(&self) -> bool {
        self.joints.iter().any(|joint| joint.least_slack < joint.slack_before - LIMIT_LEAP)
    }

    /// Checks limits at the predicted poses. A limit row is linear: a limb that turns by much of a radian within the substep may end far
    /// beyond the limit, leave a cone on a side that its row does not face, or circle outside the cone as fast as the row pulls it back.
    /// Each such limit gets another row, linearised at the [predicted](Self::correct_positions) pose with corrected joints. Returns true if
    /// there is one: the sweeps must run again.
    pub(in crate::solver) fn tighten_limits(&mut self) -> bool {
        let known = self.limits.len();
        let poses = &self.scratch.predicted;
        // Rows of a joint are contiguous.
        let mut looked_at = NONE;
        let (mut predicted, mut there) = (None, [None; MAX_STOPS]);
        for i in 0..known {
            let row = &self.limits[i];
            if row.hardness != Hardness::Hard {
                continue;
            }
            let joint = &self.joints[row.joint as usize];
            if !self.is_looked_at(joint) || !row.may_pass(joint, &self.velocities, self.h) {
                continue;
            }
            if looked_at != row.joint {
                looked_at = row.joint;
                let [a, b] = [joint.a, joint.b].map(|body| &poses[body as usize]);
                let pose = JointPose::new(&joint.geometry, a, b);
                // Only stops without slack are violated.
                there = [None; MAX_STOPS];
                each_stop(&joint.geometry.kind, &pose, [0.0; 2], |place, stop| there[place] = Some(stop));
                predicted = Some(pose);
            }
            let (Some(predicted), Some(stop)) = (&predicted, &there[row.stop]) else { continue };
            let beyond = row.allowed(self.h) - stop.slack;
            if beyond < row.slack() {
                continue;
            }
            let of_stop = stop.row(&joint.geometry.kind, predicted);
            let rate = of_stop.rate(joint, &self.velocities) + beyond / self.h;
            let axis = predicted.rotation_a * stop.axis;
            let hardness = Hardness::Predicted(rate);
            self.limits.push(LimitRow {
                axis,
                row: of_stop,
                hardness,
                block: NONE,
                impulse: 0.0,
                ..row.clone()
            });
        }
        self.limits.len() > known
    }

    /// True if the positions of a tree of the joint were corrected after limits were last checked.
    fn is_looked_at(&self, joint: &SolverJoint) -> bool {
        [joint.a, joint.b].iter().any(|&body| {
            self.links.get(body as usize).is_some_and(|link| self.scratch.looked_at[link.tree as usize])
        })
    }

    /// True if a joint is beyond a hard stop that pushes it back.
    pub(in crate::solver) fn stops_push_back(&self) -> bool {
        self.limits.iter().any(|row| {
            let soft = matches!(row.hardness, Hardness::Soft(..));
            !soft && row.slack < 0.0 && row.impulse > 0.0
        })
    }

    /// Stores the limit impulses of this substep for the next warm start.
    pub(in crate::solver) fn end_limits(&mut self) {
        for joint in &mut self.joints {
            for limit in &mut joint.limits {
                *limit = LimitImpulse { now: Vec3::ZERO, before: limit.now };
            }
        }
        for row in self.limits.iter().filter(|row| !matches!(row.hardness, Hardness::Soft(..))) {
            let joint = &mut self.joints[row.joint as usize];
            joint.limits[row.limit].now += joint.pose.rotation_a.inverse() * (row.axis * row.impulse);
        }
    }
}
