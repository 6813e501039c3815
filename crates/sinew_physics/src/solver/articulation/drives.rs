//! Drives act along a joint's directions in addition to the locked ones: springs, soft welds, motors, dry friction.
//! Each is a row with compliance in the tree factor, so any stiffness is stable.

use crate::joint::def::{Gains, Motor};
use crate::joint::{DIRECTIONS, JointPose, JointRows, TWIST, displacement, locked_error, open_row};
use crate::solver::IslandSolver;
use crate::solver::articulation::soft_row::SoftRow;
use crate::solver::joint::SolverJoint;
use crate::solver::pass::Pass;
use crate::solver::tuning::{
    CLOSING_SPEED, CLOSING_SPIN, MOST_BENT_ANGLE, MOST_BENT_LENGTH, MOTOR_SHARE, SATURATION_ROUNDS,
    STICK_SPEED, STICK_SPIN,
};
use crate::spatial::{Vec6, ZERO6, add_scaled, angular, dot, linear};
use sinew_math::{Transform, clamp, max};

/// Impulse of a motor within a substep, N·s or N·m·s.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct MotorImpulse {
    joint: usize,
    direction: usize,
    impulse: f32,
}

impl Motor {
    /// Largest force (N) or torque (N·m) in a direction.
    pub(crate) fn cap(&self, direction: usize) -> f32 {
        if direction < TWIST { self.max_force } else { self.max_torque }
    }

    fn rate(&self, direction: usize) -> f32 {
        let v = if direction < TWIST { self.velocity.linear } else { self.velocity.angular };
        [v.x, v.y, v.z][direction % TWIST]
    }
}

impl SolverJoint {
    /// Updates the rows and their softness for the present pose.
    pub(in crate::solver) fn refresh_rows(&mut self, velocities: &[Vec6], h: f32) {
        let motor = |i: usize| self.drive.motor.is_some_and(|m| m.cap(i) > 0.0) && self.saturated[i] == 0;
        let always = self.drive.spring.is_some() || self.drive.friction > 0.0;
        let open = core::array::from_fn(|i| always || motor(i));
        self.rows = JointRows::new(&self.geometry, &self.pose, open);
        self.rigid = if self.drive.weld.is_some() { 0 } else { self.rows.locked };
        self.left_open = ZERO6;
        for row in 0..self.rows.locked {
            let most = if self.rows.turns(row) { CLOSING_SPIN } else { CLOSING_SPEED };
            self.left_open[row] = self.rows.error[row] - clamp(self.rows.error[row], -most * h, most * h);
        }
        self.soft = [SoftRow::default(); DIRECTIONS];
        self.driven = [SoftRow::default(); DIRECTIONS];
        if self.rigid < self.rows.count {
            let rates = self.anchor_rates(velocities);
            for row in self.rigid..self.rows.count {
                let direction = self.rows.direction(row);
                if self.drive.motor.is_some() && row >= self.rows.locked && self.saturated[direction] == 0 {
                    self.driven[row] = self.motor_row(direction, h);
                }
                self.soft[row] = self.soft_row(row, rates, h);
            }
        }
    }

    fn soft_row(&self, row: usize, rates: [f32; 2], h: f32) -> SoftRow {
        let direction = self.rows.direction(row);
        let mut soft = SoftRow::default();
        if row < self.rows.locked {
            if let Some(weld) = self.drive.weld {
                soft.add_spring(weld, [self.mass[direction]; 2], self.rows.error[row], 0.0, h);
            }
        } else if let Some(spring) = self.drive.spring {
            let x = displacement(&self.geometry.kind, &self.pose, direction, &spring.rest);
            soft.add_spring(spring.softness, [self.mass[direction]; 2], x, 0.0, h);
        }
        if self.drive.friction > 0.0 {
            // Dry friction is the viscosity τ/|ω| at the present rate. It is implicit, so it cannot overshoot.
            let least = if direction >= TWIST { STICK_SPIN } else { STICK_SPEED };
            let rate = max(rates[usize::from(direction >= TWIST)], least);
            soft.add_viscosity(h * self.drive.friction / rate, 0.0);
        }
        soft.add(&self.driven[row]);
        // A spring without stiffness and damping would be a row of infinite compliance.
        soft.gain = max(soft.gain, 1e-12);
        soft
    }

    /// Row of the motor in a direction, without its cap.
    fn motor_row(&self, direction: usize, h: f32) -> SoftRow {
        let mut row = SoftRow::default();
        let Some(motor) = self.drive.motor.filter(|motor| motor.cap(direction) > 0.0) else { return row };
        let (mass, rate) = (self.mass[direction], motor.rate(direction));
        match motor.gains {
            Gains::Velocity => row.add_viscosity(mass / MOTOR_SHARE, rate),
            Gains::Position(softness) => {
                let x = displacement(&self.geometry.kind, &self.pose, direction, &motor.target);
                row.add_spring(softness, [mass, self.least_mass[direction]], x, rate, h);
            }
        }
        row
    }

    /// Relative speed of the anchors, m/s, and relative angular speed of the bodies, rad/s.
    pub(in crate::solver) fn anchor_rates(&self, velocities: &[Vec6]) -> [f32; 2] {
        let (a, b) = (&velocities[self.a as usize], &velocities[self.b as usize]);
        let turn = angular(b) - angular(a);
        let slide =
            (linear(b) + angular(b).cross(self.pose.arm_b)) - (linear(a) + angular(a).cross(self.pose.arm_a));
        [slide.length(), turn.length()]
    }

    /// Rate of an open direction.
    pub(in crate::solver) fn open_rate(&self, direction: usize, velocities: &[Vec6]) -> f32 {
        let row = open_row(&self.geometry.kind, &self.pose, direction);
        dot(&row.a, &velocities[self.a as usize]) + dot(&row.b, &velocities[self.b as usize])
    }

    /// Returns true if the motor is saturated in any direction.
    fn pushes(&self) -> bool {
        self.drive.motor.is_some() && self.saturated != [0; DIRECTIONS]
    }

    /// Directions in which the motor acts.
    fn motor_directions(&self) -> impl Iterator<Item = usize> + use<> {
        let (kind, motor) = (self.geometry.kind, self.drive.motor);
        crate::joint::open_directions(kind).filter(move |&i| motor.is_some_and(|m| m.cap(i) > 0.0))
    }

    /// Largest impulse of the motor within a substep.
    fn motor_cap(&self, direction: usize, h: f32) -> f32 {
        self.drive.motor.map_or(0.0, |motor| motor.cap(direction) * h)
    }

    /// Marks the directions in which the motor of a linear pin (a hand, a grip) exceeds its cap, which happens because a
    /// pin resists contacts and stops with its inertia. Pins that also turn bodies are drives, which may hold with more
    /// than the cap.
    pub(in crate::solver) fn note_exceeded(&mut self, h: f32) {
        self.exceeded = [0; DIRECTIONS];
        if self.drive.motor.is_none_or(|motor| motor.max_torque > 0.0) {
            return;
        }
        for row in self.rows.locked..self.rows.count {
            let (direction, impulse) = (self.rows.direction(row), self.impulse[row]);
            if self.saturated[direction] == 0 && impulse.abs() > self.motor_cap(direction, h) {
                self.exceeded[direction] = if impulse > 0.0 { 1 } else { -1 };
            }
        }
    }

    /// Impulses of the motor on A and on B if it is saturated in that direction.
    pub(in crate::solver) fn push_of_motor(&self, direction: usize, h: f32) -> Option<[Vec6; 2]> {
        if self.saturated[direction] == 0 || self.drive.motor.is_none() {
            return None;
        }
        let impulse = f32::from(self.saturated[direction]) * self.motor_cap(direction, h);
        let row = open_row(&self.geometry.kind, &self.pose, direction);
        Some([row.a.map(|x| x * impulse), row.b.map(|x| x * impulse)])
    }

    /// Rate change that rows at the given rate request. `solve` removes the position error within the substep and applies the soft
    /// rows. `relax` stops the rigid rows and leaves the soft rows unchanged; otherwise they would act twice.
    pub(in crate::solver) fn residual(&self, rate: &Vec6, solve: bool, h: f32) -> Vec6 {
        let mut out = ZERO6;
        for row in 0..self.rows.count {
            out[row] = match (solve, row < self.rigid) {
                (true, true) => -(self.rows.error[row] - self.left_open[row]) / h - rate[row],
                (true, false) => self.wanted(row) - rate[row],
                (false, true) => -rate[row],
                (false, false) => 0.0,
            };
        }
        out
    }

    /// Rate of a soft row that moves no mass.
    pub(in crate::solver) fn wanted(&self, row: usize) -> f32 {
        self.soft[row].wanted(self.start_rate[self.rows.direction(row)])
    }

    /// Compliance Γ of a row.
    pub(in crate::solver) fn compliance(&self, row: usize) -> f32 {
        if row < self.rigid { 0.0 } else { self.soft[row].compliance() }
    }

    /// Gain 1/Γ of a row that is not rigid.
    pub(in crate::solver) fn gain(&self, row: usize) -> f32 {
        self.soft[row].gain
    }

    /// Returns true for a ball joint: the anchors are locked together and all rotations are open.
    pub(in crate::solver) fn is_point(&self) -> bool {
        self.rigid == TWIST && self.rows.locked == TWIST && self.rows.locks_point()
    }

    /// Computes `J v`, row by row. Bodies outside `velocities` are at rest.
    pub(in crate::solver) fn rate(&self, velocities: &[Vec6]) -> Vec6 {
        let of = |body: u32| velocities.get(body as usize).unwrap_or(&ZERO6);
        self.rows.rate(of(self.a), of(self.b))
    }

    /// Position error of a soft weld at other poses of the bodies, beyond the prediction of its rows and the corrections so far. Without
    /// this, a rotating body on a soft weld would drift outward by `½ ω² r h²` in each substep, and a damper takes long to pull it back.
    fn bend_error(&self, pose: &JointPose, velocities: &[Vec6], h: f32) -> Vec6 {
        let mut bend = ZERO6;
        if self.drive.weld.is_none() {
            return bend;
        }
        let error = locked_error(&self.geometry, pose);
        let rate = self.rate(velocities);
        for row in 0..self.rows.locked {
            let bent = error[row] - (self.rows.error[row] + h * rate[row]);
            // An angle that jumped by a full turn is no displacement.
            let most = if self.rows.turns(row) { MOST_BENT_ANGLE } else { MOST_BENT_LENGTH };
            bend[row] = if bent.abs() < most { bent - self.bent[row] } else { 0.0 };
        }
        bend
    }

    /// Position errors to correct at predicted poses of the bodies, to which `velocities` lead.
    pub(in crate::solver) fn position_error(&self, poses: &[Transform], velocities: &[Vec6], h: f32) -> Vec6 {
        let [a, b] = [self.a, self.b].map(|body| &poses[body as usize]);
        let pose = JointPose::new(&self.geometry, a, b);
        if self.rigid == 0 {
            return self.bend_error(&pose, velocities, h);
        }
        let mut error = locked_error(&self.geometry, &pose);
        self.leave_open(&mut error);
        error
    }

    /// Subtracts the part of the rigid rows' errors that this substep may leave open.
    #[inline(always)]
    pub(in crate::solver) fn leave_open(&self, error: &mut Vec6) {
        for row in 0..self.rigid {
            error[row] -= self.left_open[row];
        }
    }
}

impl IslandSolver {
    /// Updates the rates of the soft rows and motors, before the forces of a substep act.
    pub(in crate::solver) fn begin_drives(&mut self) {
        for joint in &mut self.joints {
            if joint.rigid < joint.rows.count {
                let rate = joint.rate(&self.velocities);
                for row in joint.rigid..joint.rows.count {
                    joint.start_rate[joint.rows.direction(row)] = rate[row];
                }
            }
            if joint.drive.motor.is_some() {
                for i in joint.motor_directions() {
                    joint.start_rate[i] = joint.open_rate(i, &self.velocities);
                }
            }
        }
    }

    /// Applies the full impulse of all saturated motors to their bodies, after the forces of a substep.
    pub(in crate::solver) fn push_saturated(&mut self) {
        (self.push_energy, self.push_work) = (0.0, 0.0);
        if !self.joints.iter().any(SolverJoint::pushes) {
            return;
        }
        self.push_again();
        let free = self.kinetic_energy(&self.unconstrained);
        self.push_energy = self.kinetic_energy(&self.velocities[..self.links.len()]) - free;
    }

    /// Applies the impulses of [`push_saturated`](Self::push_saturated) again, to velocities that were reset to those before it.
    pub(in crate::solver) fn push_again(&mut self) {
        for j in 0..self.joints.len() {
            if self.joints[j].pushes() {
                for i in 0..DIRECTIONS {
                    self.push_motor(j, i);
                }
            }
        }
    }

    fn push_motor(&mut self, j: usize, direction: usize) {
        let joint = &self.joints[j];
        let Some(pushes) = joint.push_of_motor(direction, self.h) else { return };
        for (body, push) in [joint.a as usize, joint.b as usize].into_iter().zip(pushes) {
            if body < self.links.len() {
                let change = self.bodies[body].velocity_change(&push);
                add_scaled(&mut self.velocities[body], &change, 1.0);
            }
        }
    }

    /// Adds the work of the drives in this substep: impulse times the rate after it. Kinetic energy rises by at most that amount, less half
    /// of the energy of the velocity change itself. Work that motors absorb is not counted.
    pub(in crate::solver) fn add_drive_work(&mut self) {
        let (mut given, mut by_motors) = (0.0, 0.0);
        for joint in self.joints.iter().filter(|joint| joint.rigid < joint.rows.count) {
            let rate = joint.rate(&self.velocities);
            for row in joint.rigid..joint.rows.count {
                let before = joint.start_rate[joint.rows.direction(row)];
                let rate = rate[row] + joint.bent[row] / self.h;
                if joint.drive.motor.is_some() {
                    by_motors += joint.soft[row].work(before, rate);
                } else {
                    given += joint.soft[row].impulse(before, rate) * rate;
                }
            }
        }
        for row in &self.limits {
            given += row.soft_work(&self.joints[row.joint as usize], &self.velocities);
        }
        self.push_work = self.work_of_saturated();
        by_motors += self.push_work;
        self.drive_work += max(by_motors, 0.0) + given;
        self.note_motor_impulses();
    }

    /// Kinetic energy that saturated motors add, J: impulse times the mean of the rates before and after it. The energy that they would add
    /// to bodies without joints may be a thousand times as large.
    pub(in crate::solver) fn work_of_saturated(&self) -> f32 {
        let mut sum = 0.0;
        for joint in self.joints.iter().filter(|joint| joint.pushes()) {
            for i in joint.motor_directions().filter(|&i| joint.saturated[i] != 0) {
                let impulse = f32::from(joint.saturated[i]) * joint.motor_cap(i, self.h);
                sum += 0.5 * impulse * (joint.start_rate[i] + joint.open_rate(i, &self.velocities));
            }
        }
        sum
    }

    /// Passes the motor impulses of this substep to `see`: joint, direction, impulse, and the rate of the coming motion.
    fn each_motor_impulse(&self, mut see: impl FnMut(usize, usize, f32, f32)) {
        for (j, joint) in self.joints.iter().enumerate().filter(|(_, joint)| joint.drive.motor.is_some()) {
            let rate = joint.rate(&self.velocities);
            for row in joint.rows.locked..joint.rows.count {
                let direction = joint.rows.direction(row);
                let impulse = joint.driven[row].impulse(joint.start_rate[direction], rate[row]);
                see(j, direction, impulse, rate[row]);
            }
            for i in joint.motor_directions().filter(|&i| joint.saturated[i] != 0) {
                let impulse = f32::from(joint.saturated[i]) * joint.motor_cap(i, self.h);
                see(j, i, impulse, joint.open_rate(i, &self.velocities));
            }
        }
    }

    /// Work of the motors along the coming displacement of the bodies, J: force times distance. The sum of kinetic and potential energy
    /// rises by at most that amount.
    pub(in crate::solver) fn work_of_motors(&self) -> f32 {
        let mut sum = 0.0;
        self.each_motor_impulse(|_, _, impulse, rate| sum += impulse * rate);
        sum
    }

    /// Keeps the impulses of motors until [`add_motor_work`](Self::add_motor_work).
    fn note_motor_impulses(&mut self) {
        let mut noted = core::mem::take(&mut self.scratch.motor_impulses);
        noted.clear();
        self.each_motor_impulse(|joint, direction, impulse, _| {
            noted.push(MotorImpulse { joint, direction, impulse });
        });
        self.scratch.motor_impulses = noted;
    }

    /// Adds the work of the motors at the end of this substep, J: impulse times the final rate of the bodies. The sum of kinetic and
    /// potential energy rises by at most that amount, less half of the energy of the velocity change itself. The rates between the passes
    /// include the motions that close joints, stops and contacts, so they are not used: with them, a stop that pushes a limb back against
    /// its muscle would appear to take work from the muscle.
    pub(in crate::solver) fn add_motor_work(&mut self) {
        for &MotorImpulse { joint, direction, impulse } in &self.scratch.motor_impulses {
            let joint = &self.joints[joint];
            let rate = joint.open_rate(direction, &self.velocities);
            self.work.drives += impulse * rate;
        }
    }

    /// Energy that springs absorb, J, at `s` times the present velocities: the coefficients of `s²` and `s`.
    pub(in crate::solver) fn resistance_of_springs(&self) -> (f32, f32) {
        let (mut square, mut linear) = (0.0, 0.0);
        let passive = |joint: &&SolverJoint| joint.rigid < joint.rows.count && joint.drive.motor.is_none();
        for joint in self.joints.iter().filter(passive) {
            let rate = joint.rate(&self.velocities);
            for row in joint.rigid..joint.rows.count {
                let (soft, before) = (&joint.soft[row], joint.start_rate[joint.rows.direction(row)]);
                let rate = rate[row] + joint.bent[row] / self.h;
                square += soft.gain * rate * rate;
                linear += (soft.carry * before + soft.push) * rate;
            }
        }
        (square, linear)
    }

    /// Saturates motors that request more than their caps: from now on they push with the cap. The joints of the substep are then solved
    /// again from `started`, the velocities before them. A motor stays saturated until it requests less, see
    /// [`release_motors`](Self::release_motors). Without that memory, the wrong motors of a chain saturate.
    pub(in crate::solver) fn saturate_motors(&mut self) {
        if self.joints.iter().all(|joint| joint.drive.motor.is_none()) {
            return;
        }
        for _ in 0..SATURATION_ROUNDS {
            let mut changed = false;
            self.scratch.started.swap_with_slice(&mut self.velocities[..self.links.len()]);
            // `velocities` now holds the velocities at the beginning, `started` those after the joint solve.
            for j in 0..self.joints.len() {
                if self.joints[j].drive.motor.is_none() {
                    continue;
                }
                for i in 0..DIRECTIONS {
                    let asked = self.asked_of_motor(j, i);
                    if self.joints[j].saturated[i] == 0 && asked.abs() > self.joints[j].motor_cap(i, self.h) {
                        self.joints[j].saturated[i] = if asked > 0.0 { 1 } else { -1 };
                        self.push_motor(j, i);
                        changed = true;
                    }
                }
            }
            if !changed {
                self.scratch.started.swap_with_slice(&mut self.velocities[..self.links.len()]);
                return;
            }
            self.scratch.started.clear();
            self.scratch.started.extend_from_slice(&self.velocities[..self.links.len()]);
            for joint in &mut self.joints {
                joint.impulse = ZERO6;
            }
            self.renew_rows();
            self.project_joints(Pass::Solve);
        }
    }

    /// Rebuilds rows, factor and response at the same pose, since the set of saturated motors has changed.
    pub(in crate::solver) fn renew_rows(&mut self) {
        self.refresh_rows();
        self.factor_joints();
        self.refresh_response();
    }

    /// Impulse that a motor requests at the velocities in `scratch.started`; 0 where there is no motor.
    fn asked_of_motor(&self, j: usize, direction: usize) -> f32 {
        let joint = &self.joints[j];
        if !joint.motor_directions().any(|i| i == direction) {
            return 0.0;
        }
        let row = open_row(&joint.geometry.kind, &joint.pose, direction);
        let velocity = |body: u32| match self.scratch.started.get(body as usize) {
            Some(v) => v,
            None => &self.velocities[body as usize],
        };
        let rate = dot(&row.a, velocity(joint.a)) + dot(&row.b, velocity(joint.b));
        joint.motor_row(direction, self.h).impulse(joint.start_rate[direction], rate)
    }

    /// Releases saturated motors that no longer request their cap, and saturates pins that contacts have pushed beyond their caps, for the
    /// next substep. Returns true if any changed. The rows change when they are refreshed.
    pub(in crate::solver) fn release_motors(&mut self) -> bool {
        let mut released = false;
        for joint in self.joints.iter_mut().filter(|joint| joint.drive.motor.is_some()) {
            let exceeded = joint.exceeded;
            for i in 0..DIRECTIONS {
                if core::mem::take(&mut joint.exceeded[i]) != 0 && joint.motor_cap(i, self.h) > 0.0 {
                    joint.saturated[i] = exceeded[i];
                    released = true;
                } else if joint.saturated[i] != 0 {
                    let rate = joint.open_rate(i, &self.velocities);
                    let asked = joint.motor_row(i, self.h).impulse(rate, rate);
                    if asked * f32::from(joint.saturated[i]) < joint.motor_cap(i, self.h) {
                        joint.saturated[i] = 0;
                        released = true;
                    }
                }
            }
        }
        released
    }
}
