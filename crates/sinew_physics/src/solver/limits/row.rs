//! Row of a joint limit: its slack, its requested rate and its impulse.

use crate::joint::def::Softness;
use crate::joint::{Row, Stop, turns};
use crate::solver::articulation::tree::NONE;
use crate::solver::body::{SolverBody, add_row, free_response};
use crate::solver::joint::SolverJoint;
use crate::solver::pass::Pass;
use crate::solver::tuning::{
    IMPACT_JUMP, LIMIT_BEND, LIMIT_PUSH_SPEED, LIMIT_PUSH_SPIN, LIMIT_SLACK_ANGLE, LIMIT_SLACK_LENGTH,
    REDUNDANCY,
};
use crate::spatial::{Vec6, angular, dot};
use sinew_math::{Vec3, clamp, max, min};

/// Hardness of a limit row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Hardness {
    /// A hard stop.
    Hard,
    /// A hard stop linearised at the predicted pose of the end of the substep; the number is the smallest rate of the slack. It exists in
    /// `solve` only.
    Predicted(f32),
    /// A spring that acts when no slack is left, with a share of its damping.
    Soft(Softness, f32),
}

/// A limit near its stop: `J v ≥ −slack/h`.
#[derive(Clone, Debug)]
pub(in crate::solver) struct LimitRow {
    pub joint: u32,
    /// Index of the stop in the joint, and of the limit that stores its impulse.
    pub(super) stop: usize,
    pub(super) limit: usize,
    /// Remaining motion before the stop, radians or metres; negative beyond it.
    pub(super) slack: f32,
    pub(super) hardness: Hardness,
    /// Gradient of the slack, world axes.
    pub(super) axis: Vec3,
    pub row: Row,
    /// Index of the block that contains the row.
    pub block: u32,
    /// Response of the row to its own unit impulse; known once it has a column.
    pub(super) effective: f32,
    /// Impulse of this substep: ≥ 0 after a visit; a conjugate step may make it negative until the next visit.
    pub impulse: f32,
}

/// Impulse of a unilateral row about `axis` that best matches an impulse vector.
pub(super) fn share(impulse: Vec3, axis: Vec3) -> f32 {
    max(impulse.dot(axis), 0.0) / axis.length_squared()
}

impl LimitRow {
    pub(super) fn new(
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
            slack: stop.slack,
            hardness,
            axis: joint.pose.rotation_a * stop.axis,
            row: stop.row(&joint.geometry.kind, &joint.pose),
            block: NONE,
            effective: 0.0,
            impulse,
        }
    }

    /// Starts with the impulse of the last substep, or with the one before it if the impulse jumped.
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

    /// Adds the row's impulse, times `sign`, to those of its bodies.
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

    /// Required slack at the end of a substep, radians or metres: 0, or negative if the joint must return from far beyond the stop.
    pub(super) fn allowed(&self, h: f32) -> f32 {
        min(self.slack + self.most_push() * h, 0.0)
    }

    /// Largest rate of return, rad/s or m/s.
    pub(super) fn most_push(&self) -> f32 {
        if turns(self.limit) { LIMIT_PUSH_SPIN } else { LIMIT_PUSH_SPEED }
    }

    /// Tolerance of the slack at the end of a substep, radians or metres.
    pub(super) fn slack(&self) -> f32 {
        if turns(self.limit) { LIMIT_SLACK_ANGLE } else { LIMIT_SLACK_LENGTH }
    }

    /// False if the velocities cannot exceed the allowed slack by more than the tolerance: the linearised row does not exceed it, and the
    /// bodies turn too little for the error of the row to matter.
    pub(super) fn may_pass(&self, joint: &SolverJoint, velocities: &[Vec6], h: f32) -> bool {
        if !turns(self.limit) {
            return true;
        }
        let [a, b] = [joint.a, joint.b].map(|body| angular(&velocities[body as usize]));
        let turn2 = max(a.length_squared(), b.length_squared()) * (h * h);
        let ahead = self.slack + h * (b - a).dot(self.axis);
        self.allowed(h) - ahead + LIMIT_BEND * turn2 >= LIMIT_SLACK_ANGLE
    }

    /// Stores the response of the row to its own impulse.
    pub fn take_response(&mut self, own: f32, joint: &SolverJoint, bodies: &[SolverBody], moving: usize) {
        let Row { a, b } = &self.row;
        self.effective = own + REDUNDANCY * free_response(bodies, moving, [(joint.a, a), (joint.b, b)]);
    }

    /// Adds to the impulse of this substep; the caller applies it to the bodies. Returns the rate that the change causes by itself.
    pub fn apply(&mut self, more: f32) -> f32 {
        self.impulse += more;
        more.abs() * self.effective
    }

    /// Rate below which the row pushes in a pass, if it has no impulse yet.
    pub fn threshold(&self, pass: Pass, h: f32) -> f32 {
        match self.hardness {
            Hardness::Soft(..) if pass != Pass::Solve => f32::NEG_INFINITY,
            Hardness::Soft(..) => -self.slack / h,
            _ => self.wanted(pass, f32::NEG_INFINITY, h),
        }
    }

    /// Updates the impulse for a rate and returns the change.
    pub fn change(&mut self, pass: Pass, rate: f32, h: f32) -> f32 {
        if self.effective < 1e-9 {
            return 0.0;
        }
        let new = match self.hardness {
            Hardness::Soft(softness, damped) => {
                let (stiffness, damping) = softness.of_mass(1.0 / self.effective);
                // Implicit: λ = −h (k (slack + h v) + c v), never pulling.
                let gain = h * (h * stiffness + damped * damping);
                let pull = gain * rate + h * stiffness * self.slack + self.impulse;
                self.impulse - pull / (1.0 + gain * self.effective)
            }
            _ => self.impulse + (self.wanted(pass, rate, h) - rate) / self.effective,
        };
        let change = max(new, 0.0) - self.impulse;
        self.impulse += change;
        change
    }

    /// Work of the spring of a soft row in a substep, J.
    pub fn soft_work(&self, joint: &SolverJoint, velocities: &[Vec6]) -> f32 {
        let is_soft = matches!(self.hardness, Hardness::Soft(..));
        if is_soft { self.impulse * self.row.rate(joint, velocities) } else { 0.0 }
    }

    /// Rate that a stop requests at the given rate. In `relax` a limb that approaches the stop is not accelerated: an impulse taken back at
    /// another pose adds energy.
    pub(super) fn wanted(&self, pass: Pass, rate: f32, h: f32) -> f32 {
        match (pass, self.hardness) {
            (Pass::Solve, Hardness::Predicted(rate)) => rate,
            (Pass::Solve, _) if self.slack < 0.0 => min(-self.slack / h, self.most_push()),
            (Pass::Solve, _) => -self.slack / h,
            _ => clamp(rate, min(-self.slack / h, 0.0), 0.0),
        }
    }
}

impl Row {
    pub(super) fn rate(&self, joint: &SolverJoint, velocities: &[Vec6]) -> f32 {
        dot(&self.a, &velocities[joint.a as usize]) + dot(&self.b, &velocities[joint.b as usize])
    }
}
