//! Joints inside the island: tree rows for the exact solve, loop rows and limit rows for the sweeps.

use super::contact_rows::IMPACT_JUMP;
use super::response::Response;
use super::sweep::Pass;
use super::tree::{self, Link, NONE};
use super::{IslandSolver, STICK_RATE, SolverJoint, advance};
use crate::joint::{JointPose, JointRows, LimitImpulse, MAX_LIMITS, limit_states, rigid_error};
use crate::spatial::{Vec6, ZERO6, ZERO66, add_scaled, angular, dot, join, linear};
use sinew_math::{Vec3, max, min};

/// Fastest angular velocity with which a violated limit pushes back, rad/s.
const LIMIT_PUSH: f32 = 4.0;
/// A limit closer than this gets a row even at rest, radians.
const LIMIT_MARGIN: f32 = 0.15;
/// Most rounds of position corrections in a pass, and the error that needs none, m or rad.
const POSITION_CORRECTIONS: usize = 6;
const POSITION_TOLERANCE: f32 = 1e-6;
/// A limit may end a substep this far beyond where it should, radians, before its row is tightened.
const LIMIT_SLACK: f32 = 0.01;
/// A hit turns linear speed into rotation over at least this lever, metres.
const LEVER: f32 = 0.2;
/// In `relax` a limit with less room than this holds, radians.
const LIMIT_TOUCH: f32 = 1e-4;

impl IslandSolver {
    /// Poses of all joints.
    pub(super) fn refresh_joints(&mut self) {
        for joint in &mut self.joints {
            let (a, b) = (&self.bodies[joint.a as usize].pose, &self.bodies[joint.b as usize].pose);
            joint.pose = JointPose::new(&joint.geometry, a, b);
        }
        for rows in &mut self.loops {
            let joint = &self.joints[rows.joint as usize];
            rows.rows = JointRows::new(&joint.geometry, &joint.pose, false);
        }
    }

    /// Rows of the tree joints and the factor of all trees.
    pub(super) fn factor_joints(&mut self) {
        let inertia = &mut self.scratch.inertia;
        inertia.clear();
        for (i, link) in self.links.iter_mut().enumerate() {
            let body = &self.bodies[i];
            let mut m = ZERO66;
            let r = body.pose.rotation;
            let angular = sinew_math::Sym3::from_rotated_diagonal(r, body.inertia + body.excess).to_mat3();
            for k in 0..3 {
                m[k][k] = body.mass;
                let row = angular.row(k);
                m[3 + k][3..].copy_from_slice(&[row.x, row.y, row.z]);
            }
            inertia.push(m);
            if link.joint == NONE {
                link.rows = 0;
                continue;
            }
            let joint = &self.joints[link.joint as usize];
            let friction = joint.friction_torque > 0.0;
            let rows = JointRows::new(&joint.geometry, &joint.pose, friction);
            let child_is_b = joint.b as usize == i;
            link.rows = rows.count;
            link.rigid = rows.rigid;
            (link.child, link.parent_rows) = if child_is_b { (rows.b, rows.a) } else { (rows.a, rows.b) };
            // Dry friction as the viscosity τ/|ω| of the present rate: c λ = −h τ ω/|ω|, implicit, so it cannot overshoot.
            let rate = relative_rate(&self.velocities, joint).length();
            link.compliance = ZERO6;
            for row in link.rigid..link.rows {
                link.compliance[row] = max(rate, STICK_RATE) / (joint.friction_torque * self.h);
            }
        }
        tree::factor(&mut self.links, inertia);
    }

    /// Solves the joint rows exactly. Rigid rows: `solve` removes the position error within the substep, `relax` stops.
    /// Friction rows: `solve` resists the rate, `relax` leaves it as it is, or friction would count twice.
    pub(super) fn project_joints(&mut self, pass: Pass) {
        if self.joints.is_empty() {
            return;
        }
        self.scratch.residuals.clear();
        for (i, link) in self.links.iter().enumerate() {
            let mut residual = ZERO6;
            if link.joint != NONE {
                let rate = link.rate(&self.velocities[i], &self.velocities[link.parent as usize]);
                let joint = &self.joints[link.joint as usize];
                let error = rigid_error(&joint.geometry, &joint.pose);
                for row in 0..link.rows {
                    residual[row] = match (pass, row < link.rigid) {
                        (Pass::Solve, true) => -error[row] / self.h - rate[row],
                        (Pass::Solve, false) | (_, true) => -rate[row],
                        (_, false) => 0.0,
                    };
                }
            }
            self.scratch.residuals.push(residual);
        }
        self.scratch.impulses.clear();
        self.scratch.impulses.resize(self.links.len(), ZERO6);
        self.solve_trees();
    }

    /// SHAKE: removes the position error at the pose that the velocities lead to, with the same factor, until it is
    /// small enough (one or two rounds but for violent hits). The factor is that of the substep's beginning: for a body
    /// that turns by more than a radian it may lead away, so a round that does not halve the error is taken back and
    /// the next substep goes on from there.
    pub(super) fn correct_positions(&mut self) {
        if self.joints.is_empty() {
            return;
        }
        let moving = self.links.len();
        let mut error = self.predict_errors();
        for _ in 0..POSITION_CORRECTIONS {
            if error < POSITION_TOLERANCE {
                break;
            }
            self.scratch.before.clear();
            self.scratch.before.extend_from_slice(&self.velocities[..moving]);
            self.scratch.impulses.clear();
            self.scratch.impulses.resize(moving, ZERO6);
            self.solve_trees();
            let left = self.predict_errors();
            let better = left < 0.5 * error;
            if !better {
                if left > error {
                    self.velocities[..moving].copy_from_slice(&self.scratch.before);
                }
                break;
            }
            error = left;
        }
    }

    /// Residuals that would remove the position errors at the predicted pose; gives the largest error (m or rad).
    fn predict_errors(&mut self) -> f32 {
        let h = self.h;
        let mut largest = 0.0;
        self.scratch.residuals.clear();
        for link in &self.links {
            let mut residual = ZERO6;
            if link.joint != NONE {
                let joint = &self.joints[link.joint as usize];
                let pose =
                    |body: u32| advance(&self.bodies[body as usize].pose, &self.velocities[body as usize], h);
                let predicted = JointPose::new(&joint.geometry, &pose(joint.a), &pose(joint.b));
                let error = rigid_error(&joint.geometry, &predicted);
                for row in 0..link.rigid {
                    residual[row] = -error[row] / h;
                    largest = max(largest, error[row].abs());
                }
            }
            self.scratch.residuals.push(residual);
        }
        largest
    }

    /// Adds to the velocities the answer of the trees to `scratch.impulses` and `scratch.residuals`.
    pub(super) fn solve_trees(&mut self) {
        let s = &mut self.scratch;
        s.dv.clear();
        s.dv.resize(self.links.len(), ZERO6);
        tree::solve(&self.links, &mut s.impulses, &mut s.residuals, &mut s.dv);
        for (v, dv) in self.velocities.iter_mut().zip(&s.dv) {
            add_scaled(v, dv, 1.0);
        }
    }

    /// The linear force of each tree joint on its child in this substep: what the momentum of the subtree below gained,
    /// less what contacts gave it.
    pub(super) fn store_joint_forces(&mut self) {
        if self.joints.is_empty() {
            return;
        }
        let push = &mut self.contact_push;
        for i in 0..self.links.len() {
            let gained = linear(&self.velocities[i]) - linear(&self.unconstrained[i]);
            push[i] = gained * self.bodies[i].mass - push[i];
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

    /// Rows for the limits that may be reached within the substep.
    pub(super) fn choose_limits(&mut self) {
        // Impulses of the substep so far go on counting, so that `relax` can take back what `solve` gave too much.
        for joint in &mut self.joints {
            joint.limit_impulse = [Vec3::ZERO; MAX_LIMITS];
        }
        for row in self.limits.drain(..) {
            self.joints[row.joint as usize].limit_impulse[row.slot] += row.axis * row.impulse;
        }
        self.hit_rate = 0.0;
        if !self.manifolds.is_empty() {
            for v in &self.velocities[..self.links.len()] {
                self.hit_rate = max(self.hit_rate, angular(v).length() + linear(v).length() / LEVER);
            }
        }
        for (index, joint) in self.joints.iter().enumerate() {
            let states = limit_states(&joint.geometry.kind, joint.pose.relative());
            let rate = max(relative_rate(&self.velocities, joint).length(), self.hit_rate);
            let reach = LIMIT_MARGIN + 2.0 * self.h * rate;
            for (slot, state) in states.into_iter().enumerate() {
                let Some(state) = state else { continue };
                if state.room < reach {
                    let axis = joint.pose.rotation_a * state.axis;
                    self.limits.push(LimitRow {
                        joint: index as u32,
                        slot,
                        room: state.room,
                        axis,
                        effective: 0.0,
                        rate: 0.0,
                        foreseen: false,
                        impulse: share(joint.limit_impulse[slot], axis),
                    });
                }
            }
        }
    }

    /// Looks where the velocities lead: a limit row is linear, and a limb that turns by much of a radian within the
    /// substep may end up far beyond, or leave a cone on a side that its row does not face. For each such limit comes
    /// one more row, linearised at the pose that the velocities lead to; the sweeps must then run again.
    pub(super) fn tighten_limits(&mut self) -> bool {
        let known = self.limits.len();
        for i in 0..known {
            let row = &self.limits[i];
            let joint = &self.joints[row.joint as usize];
            let pose = |body: u32| {
                advance(&self.bodies[body as usize].pose, &self.velocities[body as usize], self.h)
            };
            let predicted = JointPose::new(&joint.geometry, &pose(joint.a), &pose(joint.b));
            let Some(state) = limit_states(&joint.geometry.kind, predicted.relative())[row.slot] else {
                continue;
            };
            let beyond = min(row.room, 0.0) - state.room;
            if row.foreseen || beyond < LIMIT_SLACK {
                continue;
            }
            let axis = predicted.rotation_a * state.axis;
            let rate = axis.dot(relative_rate(&self.velocities, joint));
            let mut row =
                LimitRow { axis, rate: rate + beyond / self.h, impulse: 0.0, foreseen: true, ..row.clone() };
            row.respond(&self.joints, &self.links, &self.response);
            self.limits.push(row);
        }
        self.limits.len() > known
    }

    /// Limit impulses of this substep become memory.
    pub(super) fn end_limits(&mut self) {
        for joint in &mut self.joints {
            for limit in &mut joint.limits {
                *limit = LimitImpulse { now: Vec3::ZERO, before: limit.now };
            }
        }
        for row in &self.limits {
            let joint = &mut self.joints[row.joint as usize];
            joint.limits[row.slot].now += joint.pose.rotation_a.inverse() * (row.axis * row.impulse);
        }
    }
}

/// Angular velocity of B seen from A, world axes.
fn relative_rate(velocities: &[Vec6], joint: &SolverJoint) -> Vec3 {
    angular(&velocities[joint.b as usize]) - angular(&velocities[joint.a as usize])
}

/// The part of an impulse vector that a unilateral row about `axis` can have given.
fn share(impulse: Vec3, axis: Vec3) -> f32 {
    max(impulse.dot(axis), 0.0) / axis.length_squared()
}

/// A limit near its stop: `axis · (ω_b − ω_a) ≥ −room/h`.
#[derive(Clone, Debug)]
pub(super) struct LimitRow {
    pub joint: u32,
    /// Which limit of the joint.
    pub slot: usize,
    /// Radians.
    pub room: f32,
    /// Gradient of the room, world axes.
    pub axis: Vec3,
    /// Response of the row to its own impulse.
    effective: f32,
    /// Rate that a foreseen row asks for, rad/s.
    rate: f32,
    /// Linearised at the end of the substep rather than at its start; lives through `solve` only.
    foreseen: bool,
    /// Of this substep, ≥ 0.
    pub impulse: f32,
}

impl LimitRow {
    /// Starts with the last substep's impulse, or with the one before if it jumped up since.
    pub fn warm_start(&mut self, joints: &[SolverJoint], impulses: &mut [Vec6]) {
        let joint = &joints[self.joint as usize];
        let limit = joint.limits[self.slot];
        let axis = joint.pose.rotation_a.inverse() * self.axis;
        let (now, before) = (share(limit.now, axis), share(limit.before, axis));
        self.impulse = if now > IMPACT_JUMP * before { before } else { now };
        let row = join(Vec3::ZERO, self.axis);
        add_row(impulses, joint.b, &row, self.impulse);
        add_row(impulses, joint.a, &row, -self.impulse);
    }

    pub fn respond(&mut self, joints: &[SolverJoint], links: &[Link], response: &Response) {
        let joint = &joints[self.joint as usize];
        let row = join(Vec3::ZERO, self.axis);
        self.effective = pair_response(joint, links, response, &row, &row);
    }

    /// The row's new impulse less the old one, for the present velocities.
    pub fn visit(&mut self, joints: &[SolverJoint], velocities: &[Vec6], pass: Pass, h: f32) -> Option<Vec6> {
        if self.effective < 1e-9 {
            return None;
        }
        let joint = &joints[self.joint as usize];
        let w = relative_rate(velocities, joint);
        let wanted = match pass {
            Pass::Solve if self.foreseen => self.rate,
            Pass::Solve if self.room < 0.0 => min(-self.room / h, LIMIT_PUSH),
            Pass::Solve => -self.room / h,
            _ if self.room > LIMIT_TOUCH => -self.room / h,
            _ => 0.0,
        };
        let new = max(self.impulse + (wanted - self.axis.dot(w)) / self.effective, 0.0);
        let change = new - self.impulse;
        self.impulse = new;
        (change != 0.0).then(|| join(Vec3::ZERO, self.axis * change))
    }
}

/// A joint that closes a loop: soft rows in the sweeps, as stiff as the substep allows.
#[derive(Clone, Debug)]
pub(super) struct LoopRows {
    pub joint: u32,
    pub rows: JointRows,
    effective: Vec6,
    /// Of this substep, row by row.
    pub impulse: Vec6,
}

impl LoopRows {
    pub fn new(joint: u32, rows: JointRows, impulse: Vec6) -> Self {
        Self { joint, rows, effective: ZERO6, impulse }
    }

    /// Starts from the last substep's impulses.
    pub fn warm_start(&self, joints: &[SolverJoint], impulses: &mut [Vec6]) {
        let joint = &joints[self.joint as usize];
        for row in 0..self.rows.rigid {
            add_row(impulses, joint.a, &self.rows.a[row], self.impulse[row]);
            add_row(impulses, joint.b, &self.rows.b[row], self.impulse[row]);
        }
    }

    pub fn respond(&mut self, joints: &[SolverJoint], links: &[Link], response: &Response) {
        let joint = &joints[self.joint as usize];
        let (a, b) = (joint.a as usize, joint.b as usize);
        for row in 0..self.rows.rigid {
            let (ja, jb) = (&self.rows.a[row], &self.rows.b[row]);
            self.effective[row] = dot(ja, &response.at(links, a, a, ja))
                + dot(ja, &response.at(links, a, b, jb))
                + dot(jb, &response.at(links, b, a, ja))
                + dot(jb, &response.at(links, b, b, jb));
        }
    }

    /// Change of impulse of one row: a soft constraint at a quarter of the substep rate, ζ = 2, in `solve`; rigid in `relax`.
    pub fn visit(&mut self, row: usize, joint: &SolverJoint, velocities: &[Vec6], pass: Pass, h: f32) -> f32 {
        if self.effective[row] < 1e-9 {
            return 0.0;
        }
        let rate = dot(&self.rows.a[row], &velocities[joint.a as usize])
            + dot(&self.rows.b[row], &velocities[joint.b as usize]);
        let change = match pass {
            Pass::Solve => {
                let soft = super::contact_rows::Softness::new(0.25 / h, 2.0, h);
                let bias = soft.bias_rate * self.rows.error[row];
                -soft.mass_scale * (rate + bias) / self.effective[row]
                    - soft.impulse_scale * self.impulse[row]
            }
            _ => -rate / self.effective[row],
        };
        self.impulse[row] += change;
        change
    }
}

/// Adds `row · impulse` to a body, if it moves.
pub(super) fn add_row(impulses: &mut [Vec6], body: u32, row: &Vec6, impulse: f32) {
    if let Some(p) = impulses.get_mut(body as usize) {
        add_scaled(p, row, impulse);
    }
}

/// Rate of `row` (on B, its opposite on A) per impulse along `column`.
fn pair_response(joint: &SolverJoint, links: &[Link], response: &Response, row: &Vec6, column: &Vec6) -> f32 {
    let (a, b) = (joint.a as usize, joint.b as usize);
    dot(row, &response.at(links, b, b, column)) + dot(row, &response.at(links, a, a, column))
        - dot(row, &response.at(links, a, b, column))
        - dot(row, &response.at(links, b, a, column))
}
