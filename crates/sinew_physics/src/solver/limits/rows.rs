//! Rows of joint limits: unilateral, outside the tree factor, visited by the sweeps.

use crate::joint::def::Softness;
use crate::joint::{JointPose, LimitImpulse, MAX_LIMITS, MAX_STOPS, Row, Stop, each_stop, turns};
use crate::solver::articulation::tree::NONE;
use crate::solver::sweep::Pass;
use crate::solver::tuning::{
    HIT_LEVER, IMPACT_JUMP, LIMIT_BEND, LIMIT_MARGIN_ANGLE, LIMIT_MARGIN_LENGTH, LIMIT_PUSH_SPEED,
    LIMIT_PUSH_SPIN, LIMIT_SLACK_ANGLE, LIMIT_SLACK_LENGTH, REDUNDANCY,
};
use crate::solver::{IslandSolver, SolverBody, SolverJoint, free_response};
use crate::spatial::{Vec6, add_scaled, angular, dot, linear};
use sinew_math::{Vec3, clamp, max, min};

/// Hardness of a limit row.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Hardness {
    /// A stop.
    Hard,
    /// A stop that a foreseen pose asks for: linearised at the end of the substep rather than at its start, to reach at
    /// least this rate; lives through `solve` only.
    Foreseen(f32),
    /// A spring that pushes while there is no room, with this share of its damping.
    Soft(Softness, f32),
}

/// A limit near its stop: `J v ≥ −room/h`.
#[derive(Clone, Debug)]
pub(in crate::solver) struct LimitRow {
    pub joint: u32,
    /// Index of the joint's stop, and of the limit whose memory it has.
    stop: usize,
    limit: usize,
    /// Radians or metres.
    room: f32,
    hardness: Hardness,
    /// Gradient of the room, world axes.
    axis: Vec3,
    pub row: Row,
    /// Index of the block that it is in.
    pub block: u32,
    /// Response of the row to its own impulse, with its column.
    effective: f32,
    /// Impulse of this substep: ≥ 0 after a visit, less between sweeps by what a conjugate step asked too much.
    pub impulse: f32,
}

impl IslandSolver {
    /// Rows for the limits that may be reached within the substep.
    pub(in crate::solver) fn choose_limits(&mut self) {
        // Impulses of the substep so far go on counting, so that `relax` can take back what `solve` gave too much.
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
                if stop.room < reach[usize::from(turns(stop.limit))] {
                    let hardness = soft.map_or(Hardness::Hard, |soft| Hardness::Soft(soft, 1.0));
                    let axis = joint.pose.rotation_a * stop.axis;
                    let impulse = share(joint.limit_impulse[stop.limit], axis);
                    let impulse = if soft.is_some() { 0.0 } else { impulse };
                    limits.push(LimitRow::new((index, joint), place, &stop, hardness, impulse));
                }
                let zone = zone.filter(|zone| turns(stop.limit) && stop.room < zone.width);
                if let (Some(zone), None) = (zone, soft) {
                    let early = Stop { room: stop.room - zone.width, ..stop };
                    // Damping comes with depth: all of it at once would be a blow at the zone's edge.
                    let depth = min(-early.room / zone.width, 1.0);
                    let hardness = Hardness::Soft(zone.softness, depth);
                    limits.push(LimitRow::new((index, joint), place, &early, hardness, 0.0));
                }
            });
        }
    }

    /// Looks where the velocities lead: a limit row is linear, and a limb that turns by much of a radian within the
    /// substep may end up far beyond, leave a cone on a side that its row does not face, or whirl around outside of it as
    /// fast as the row would bring it back. For each such limit comes
    /// one more row, linearised at the pose that the velocities lead to ([predicted](Self::correct_positions) with the joints
    /// corrected); the sweeps must then run again.
    pub(in crate::solver) fn tighten_limits(&mut self) -> bool {
        let known = self.limits.len();
        let poses = &self.scratch.predicted;
        // Rows of a joint are neighbours.
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
                // What is to be beyond has no room.
                there = [None; MAX_STOPS];
                each_stop(&joint.geometry.kind, &pose, [0.0; 2], |place, stop| there[place] = Some(stop));
                predicted = Some(pose);
            }
            let (Some(predicted), Some(stop)) = (&predicted, &there[row.stop]) else { continue };
            let beyond = row.allowed(self.h) - stop.room;
            if beyond < row.slack() {
                continue;
            }
            let of_stop = stop.row(&joint.geometry.kind, predicted);
            let rate = of_stop.rate(joint, &self.velocities) + beyond / self.h;
            let axis = predicted.rotation_a * stop.axis;
            let hardness = Hardness::Foreseen(rate);
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

    /// True if positions of a joint's trees have been corrected since limits were last looked at.
    fn is_looked_at(&self, joint: &SolverJoint) -> bool {
        [joint.a, joint.b].iter().any(|&body| {
            self.links.get(body as usize).is_some_and(|link| self.scratch.looked_at[link.tree as usize])
        })
    }

    /// True if some hard stop was passed and pushes back.
    pub(in crate::solver) fn stops_push_back(&self) -> bool {
        self.limits.iter().any(|row| {
            let soft = matches!(row.hardness, Hardness::Soft(..));
            !soft && row.room < 0.0 && row.impulse > 0.0
        })
    }

    /// Limit impulses of this substep become memory.
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

/// The part of an impulse vector that a unilateral row about `axis` can have given.
fn share(impulse: Vec3, axis: Vec3) -> f32 {
    max(impulse.dot(axis), 0.0) / axis.length_squared()
}

impl LimitRow {
    fn new(
        (index, joint): (usize, &SolverJoint),
        place: usize,
        stop: &Stop,
        hardness: Hardness,
        impulse: f32,
    ) -> Self {
        Self {
            joint: index as u32,
            stop: place,
            limit: stop.limit,
            room: stop.room,
            hardness,
            axis: joint.pose.rotation_a * stop.axis,
            row: stop.row(&joint.geometry.kind, &joint.pose),
            block: NONE,
            effective: 0.0,
            impulse,
        }
    }

    /// Starts with the last substep's impulse, or with the one before if it jumped up since.
    pub fn warm_start(&mut self, joints: &[SolverJoint], impulses: &mut [Vec6]) {
        self.impulse = 0.0;
        if self.hardness != Hardness::Hard {
            return;
        }
        let joint = &joints[self.joint as usize];
        let limit = joint.limits[self.limit];
        let axis = joint.pose.rotation_a.inverse() * self.axis;
        let (now, before) = (share(limit.now, axis), share(limit.before, axis));
        self.impulse = if now > IMPACT_JUMP * before { before } else { now };
        self.add_impulses(joints, impulses, 1.0);
    }

    /// Adds its present impulse, times `sign`, to those of its bodies.
    pub fn add_impulses(&self, joints: &[SolverJoint], impulses: &mut [Vec6], sign: f32) {
        self.add_to(joints, impulses, sign * self.impulse);
    }

    /// Adds an impulse of this row to those of its bodies.
    #[inline]
    pub fn add_to(&self, joints: &[SolverJoint], impulses: &mut [Vec6], impulse: f32) {
        if impulse != 0.0 {
            let joint = &joints[self.joint as usize];
            add_row(impulses, joint.a, &self.row.a, impulse);
            add_row(impulses, joint.b, &self.row.b, impulse);
        }
    }

    /// Room that it should have at the end of a substep, radians or metres: none, or less where it must come back from far beyond.
    fn allowed(&self, h: f32) -> f32 {
        min(self.room + self.most_push() * h, 0.0)
    }

    /// Fastest rate with which it pushes back, rad/s or m/s.
    fn most_push(&self) -> f32 {
        if turns(self.limit) { LIMIT_PUSH_SPIN } else { LIMIT_PUSH_SPEED }
    }

    /// Room by which it may end a substep beyond where it should, radians or metres.
    fn slack(&self) -> f32 {
        if turns(self.limit) { LIMIT_SLACK_ANGLE } else { LIMIT_SLACK_LENGTH }
    }

    /// False if the velocities cannot lead beyond where it should be by more than the slack: along its own line they do not, and its
    /// bodies turn by too little for another.
    fn may_pass(&self, joint: &SolverJoint, velocities: &[Vec6], h: f32) -> bool {
        if !turns(self.limit) {
            return true;
        }
        let [a, b] = [joint.a, joint.b].map(|body| angular(&velocities[body as usize]));
        let turn2 = max(a.length_squared(), b.length_squared()) * (h * h);
        let ahead = self.room + h * (b - a).dot(self.axis);
        self.allowed(h) - ahead + LIMIT_BEND * turn2 >= LIMIT_SLACK_ANGLE
    }

    /// Takes on what it answers to its own impulse.
    pub fn take_response(&mut self, own: f32, joint: &SolverJoint, bodies: &[SolverBody], moving: usize) {
        let Row { a, b } = &self.row;
        self.effective = own + REDUNDANCY * free_response(bodies, moving, [(joint.a, a), (joint.b, b)]);
    }

    /// Adds to the impulse of this substep; the caller puts it on the bodies. Gives the speed that it makes by itself.
    pub fn give(&mut self, more: f32) -> f32 {
        self.impulse += more;
        more.abs() * self.effective
    }

    /// Rate below which it has something to give in a pass, if it gives nothing yet.
    pub fn threshold(&self, pass: Pass, h: f32) -> f32 {
        match self.hardness {
            Hardness::Soft(..) if pass != Pass::Solve => f32::NEG_INFINITY,
            Hardness::Soft(..) => -self.room / h,
            _ => self.wanted(pass, f32::NEG_INFINITY, h),
        }
    }

    /// Changes its impulse as this rate asks for; by how much.
    pub fn change(&mut self, pass: Pass, rate: f32, h: f32) -> f32 {
        if self.effective < 1e-9 {
            return 0.0;
        }
        let new = match self.hardness {
            Hardness::Soft(softness, damped) => {
                let (stiffness, damping) = softness.of_mass(1.0 / self.effective);
                // Implicit: λ = −h (k (room + h v) + c v), never pulling.
                let gain = h * (h * stiffness + damped * damping);
                let pull = gain * rate + h * stiffness * self.room + self.impulse;
                self.impulse - pull / (1.0 + gain * self.effective)
            }
            _ => self.impulse + (self.wanted(pass, rate, h) - rate) / self.effective,
        };
        let change = max(new, 0.0) - self.impulse;
        self.impulse += change;
        change
    }

    /// Energy that the spring of a soft row gives in a substep, J.
    pub fn soft_work(&self, joint: &SolverJoint, velocities: &[Vec6]) -> f32 {
        let is_soft = matches!(self.hardness, Hardness::Soft(..));
        if is_soft { self.impulse * self.row.rate(joint, velocities) } else { 0.0 }
    }

    /// Rate that a stop asks for at the present one. In `relax` a limb on its way to the stop is not hurried there: to
    /// take an impulse back at another pose than it was given at gives energy.
    fn wanted(&self, pass: Pass, rate: f32, h: f32) -> f32 {
        match (pass, self.hardness) {
            (Pass::Solve, Hardness::Foreseen(rate)) => rate,
            (Pass::Solve, _) if self.room < 0.0 => min(-self.room / h, self.most_push()),
            (Pass::Solve, _) => -self.room / h,
            _ => clamp(rate, min(-self.room / h, 0.0), 0.0),
        }
    }
}

impl Row {
    fn rate(&self, joint: &SolverJoint, velocities: &[Vec6]) -> f32 {
        dot(&self.a, &velocities[joint.a as usize]) + dot(&self.b, &velocities[joint.b as usize])
    }
}

/// Adds `row · impulse` to a body, if it moves.
pub(in crate::solver) fn add_row(impulses: &mut [Vec6], body: u32, row: &Vec6, impulse: f32) {
    if let Some(p) = impulses.get_mut(body as usize) {
        add_scaled(p, row, impulse);
    }
}
