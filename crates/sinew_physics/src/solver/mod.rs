//! Substeps of one island, on its own arrays: bodies in tree order, joints, contact rows, limit rows.
//!
//! An island is one task. It copies its data from the world, and `store` and `finalize` copy the results back, so threads never
//! write to shared memory.

mod articulation;
mod body;
pub(crate) mod boundary;
mod contact_rows;
mod contacts;
pub(crate) mod flight;
mod joint;
mod limits;
pub(crate) mod motion;
mod pass;
mod piles;
mod safeguards;
pub(crate) mod strands;
mod sweep;
mod tuning;
mod view;

use crate::body::def::Quality;
use crate::body::external_work::Work;
use crate::runner::TaskRunner;
pub(crate) use crate::solver::body::SolverBody;
use crate::solver::body::advance;
use crate::solver::boundary::groups::TakenGroup;
use crate::solver::joint::SolverJoint;
use crate::solver::limits::row::LimitRow;
use crate::solver::motion::momentum::Momentum;
use crate::solver::pass::{Corrected, Coupling, Pass};
use crate::solver::piles::touch::{Pressing, Touch};
use crate::solver::sweep::dirty::DirtyRows;
use crate::solver::sweep::policy::{HUNG, SweepPolicy};
use crate::solver::tuning::PREDICTIONS;
pub(crate) use crate::solver::view::{Grading, Pace, View};
use crate::spatial::{Vec6, ZERO6, add_scaled, angular, linear};
use articulation::batches::Batches;
use articulation::drives::MotorImpulse;
use articulation::elimination::Inertia;
use articulation::loops::Loops;
use articulation::pins::Pins;
use articulation::response::Response;
use articulation::response_cache::ResponseCache;
use articulation::tree::Link;
use boundary::fields::Attraction;
pub(crate) use boundary::solution::{IslandSolution, Solution, SolvedBody, SolvedJoint};
use contact_rows::ManifoldRows;
use contacts::{Contacts, Substep};
use core::ops::Range;
use limits::blocks::LimitBlocks;
use motion::{IntegratePosition, IntegrateVelocity, RefreshInertia};
use piles::support_depth::SupportDepth;
use sinew_math::dispatch;
use sinew_math::{Transform, Vec3, abs3, normalize_or};
use sweep::conjugate::Conjugate;

/// Solver of one island. The next island reuses the memory, but none of the values.
#[derive(Clone, Debug, Default)]
pub(crate) struct IslandSolver {
    pub bodies: Vec<SolverBody>,
    /// Velocities of all bodies, fixed ones included.
    pub velocities: Vec<Vec6>,
    pub joints: Vec<SolverJoint>,
    pub manifolds: Vec<ManifoldRows>,
    /// Contacts in lanes; empty if the coupling is `Response`.
    contacts: Contacts,
    /// Poses at the start of the step.
    starts: Vec<Transform>,
    /// Pairs of touching bodies; for islands without joints.
    touches: Vec<Touch>,
    /// True for each moving body that touches another one, if neither has joints.
    paired: Vec<bool>,
    /// True if masses of touching bodies differ so much that mass scales are updated in each substep.
    is_unequal: bool,
    /// True if at least one contact point bounces in this substep.
    bounces: bool,
    /// Velocities before the bounce.
    bounced_from: Vec<Vec6>,
    /// One link for each moving body.
    links: Vec<Link>,
    /// Range of the links of each tree.
    trees: Vec<Range<usize>>,
    /// Batches of trees of equal shape; for islands solved by turns.
    batches: Batches,
    coupling: Coupling,
    loops: Loops,
    pins: Pins,
    limits: Vec<LimitRow>,
    limit_blocks: LimitBlocks,
    response: Response,
    response_cache: ResponseCache,
    /// Impulses that contacts and limits applied to each moving body in the current sweeps.
    impulses: Vec<Vec6>,
    /// Linear contact impulse on each moving body in this substep, N s.
    contact_push: Vec<Vec3>,
    /// Velocities after forces, before any constraint.
    unconstrained: Vec<Vec6>,
    /// Velocities after the position update, before `relax`.
    moved: Vec<Vec6>,
    /// Impulses applied to each body after the position update by everything except its joints, minus the impulses of contacts
    /// and loops before the update.
    accounted: Vec<Vec6>,
    /// True if fields or lasting forces act and are evaluated in each substep.
    forces_vary: bool,
    attraction: Attraction,
    scratch: Scratch,
    support: SupportDepth,
    /// Impulses that press on each moving body.
    pressing: Vec<Pressing>,
    quality: Quality,
    policy: SweepPolicy,
    dirty: DirtyRows,
    conjugate: Conjugate,
    /// Sum of the energies of all single changes in the current sweep, J.
    change_energy: f32,
    /// Largest change of a velocity component in the current sweep, m/s or rad/s.
    largest_change: f32,
    /// Kinetic energy before and after forces in this substep, J.
    kinetic_before: f32,
    kinetic_start: f32,
    /// Momentum after forces have acted.
    momentum_start: Momentum,
    /// Work of forces, and of springs and motors, in this substep, J.
    force_work: f32,
    drive_work: f32,
    /// Kinetic energy that the full push of saturated motors would give bodies without joints, and its work with joints, J, in this
    /// substep.
    push_energy: f32,
    push_work: f32,
    /// Work in the step so far.
    pub work: Work,
    /// True if particle springs carry a body that carries a much heavier one.
    pub bears_by_springs: bool,
    /// True if particles or objects applied impulses in this substep.
    pushed_from_outside: bool,
    /// True if objects applied impulses in this step.
    disturbed: bool,
    /// True if a contact surface has a velocity, or a contact has a launch speed.
    driven: bool,
    /// True if poses changed after the values that depend on them were computed.
    displaced: bool,
    /// Largest rate that a hit may give a joint, rad/s. Limits that the joint can reach at this rate get rows.
    hit_rate: f32,
    /// True if the sweeps resolved every limit and contact that the predicted poses violate by far.
    is_settled: bool,
    /// Length of a substep, s; number of substeps in the step; ratio of their length to the world's, a power of two.
    h: f32,
    substeps: u32,
    stretch: f32,
    tally: boundary::tally::Tally,
    /// Largest speed of a body, m/s, and largest turn in a substep, radians.
    max_speed: f32,
    max_turn: f32,
}

#[derive(Clone, Debug, Default)]
struct Scratch {
    inertia: Vec<Inertia<f64>>,
    residuals: Vec<Vec6>,
    loop_residuals: Vec<Vec6>,
    impulses: Vec<Vec6>,
    dv: Vec<Vec6>,
    wanted: Vec<bool>,
    before: Vec<Vec6>,
    /// Predicted poses of all bodies at the end of the substep, kinematic ones included.
    predicted: Vec<Transform>,
    /// Position error of each tree, m or rad; whether it is being corrected; whether the last corrections included it.
    errors: Vec<f32>,
    errors_left: Vec<f32>,
    corrected: Vec<bool>,
    looked_at: Vec<bool>,
    /// Position error of each tree that needs no correction, m or rad.
    tolerances: Vec<f32>,
    /// Velocities within a sweep by turns, after the limits.
    swept: Vec<Vec6>,
    /// Velocities within a sweep by turns, after the contacts.
    contacted: Vec<Vec6>,
    /// Velocities before the sweeps by turns of `relax`.
    relaxed_from: Vec<Vec6>,
    /// Impulses of the limits before a sweep or a conjugate step.
    limits: Vec<f32>,
    /// Velocities from which the joints of the substep are solved.
    started: Vec<Vec6>,
    loads: piles::loads::Scratch,
    pieces: Vec<articulation::piece::Piece>,
    /// Motor impulses of the substep, kept until their work is known.
    motor_impulses: Vec<MotorImpulse>,
    build: boundary::growth::Scratch,
}

impl IslandSolver {
    /// Integrates forces into velocities: damping on the old velocity, gravity, applied forces, fields, speed limits, and the midpoint
    /// spin of the gyroscopic torque. Speed limits act here and never after the solve, where they would open joints.
    pub fn integrate_velocity(&mut self, view: &View<'_>, groups: &mut [TakenGroup]) {
        let h = self.h;
        self.tally.substeps += 1;
        for rows in &mut self.manifolds {
            rows.begin_approach(&self.velocities);
        }
        self.contacts.begin_approach(&self.velocities);
        if self.forces_vary {
            self.add_fields(view, groups);
        }
        self.begin_drives();
        self.kinetic_before = self.kinetic_energy(&self.velocities[..self.links.len()]);
        let moving = self.links.len();
        self.kinetic_start = dispatch::run(IntegrateVelocity {
            bodies: &mut self.bodies[..moving],
            velocities: &mut self.velocities[..moving],
            h,
            max_speed: self.max_speed,
            max_spin: self.max_turn / h,
        });
        self.momentum_start = self.momentum_of_start();
        self.drive_work = 0.0;
        self.pushed_from_outside = false;
        self.bears_by_springs = false;
        self.unconstrained.clear();
        self.unconstrained.extend_from_slice(&self.velocities[..moving]);
        self.contact_push.clear();
        self.contact_push.resize(moving, Vec3::ZERO);
        // Saturated motors push after the gyroscopic torque: a light body with the full push of a motor spins faster than its joints
        // allow, and the gyroscopic torque of that spin would do work.
        self.push_saturated();
    }

    /// Applies the impulses of contacts and limits of the last substep. Impulses that jumped in that substep are impacts and are not
    /// repeated.
    pub fn warm_start(&mut self, runner: &dyn TaskRunner) {
        if !self.has_joints() {
            self.contacts.warm_start(&mut self.velocities, runner);
            return;
        }
        for joint in &mut self.joints {
            joint.impulse = ZERO6;
        }
        if self.coupling == Coupling::Turns {
            self.warm_start_by_turns(runner);
            self.warm_start_loops();
            self.scratch.started.clear();
            self.scratch.started.extend_from_slice(&self.velocities[..self.links.len()]);
            return;
        }
        self.reset_impulses();
        for rows in &mut self.manifolds {
            rows.warm_start(&mut self.impulses);
        }
        for row in &mut self.limits {
            row.warm_start(&self.joints, &mut self.impulses);
        }
        for i in 0..self.links.len() {
            let p = self.impulses[i];
            self.contact_push[i] += linear(&p);
            let change = self.bodies[i].velocity_change(&p);
            add_scaled(&mut self.velocities[i], &change, 1.0);
        }
        self.warm_start_loops();
        self.scratch.started.clear();
        self.scratch.started.extend_from_slice(&self.velocities[..self.links.len()]);
    }

    /// Solves joints exactly, then contacts and limits with bias, then joint positions at the predicted poses (SHAKE).
    ///
    /// Joints come before contacts: in the other order they undo the effect of contacts (823 mm gap, +59 kJ in one step).
    pub fn solve(&mut self, runner: &dyn TaskRunner) {
        if !self.has_joints() {
            self.contacts.pull_approach(&self.velocities);
            self.sweep(Pass::Solve, runner);
            self.fall_back_to_rigid(0.0);
            self.bounces = self.contacts.end_approach(self.h);
            return;
        }
        self.project_joints(Pass::Solve);
        self.drop_bad_warm_start();
        self.saturate_motors();
        for rows in &mut self.manifolds {
            rows.pull_approach(&self.velocities);
        }
        self.contacts.pull_approach(&self.velocities);
        self.sweep(Pass::Solve, runner);
        self.limit_inner_turn();
        let mut torn = self.correct_positions(Corrected::All);
        self.is_settled = !self.predicts();
        let rounds = if self.predicts() { PREDICTIONS } else { 0 };
        for _ in 0..rounds {
            let tightened = self.tighten_limits();
            self.is_settled = !self.predict_contacts() && !tightened;
            if self.is_settled {
                break;
            }
            let changed = self.sweep_again(runner);
            self.limit_inner_turn();
            torn = self.correct_positions(changed);
        }
        self.fall_back_to_rigid(torn);
        if self.coupling == Coupling::Turns {
            self.bounces = self.contacts.end_approach(self.h);
            self.add_drive_work();
            return;
        }
        for rows in &mut self.manifolds {
            rows.end_approach(self.h);
        }
        self.bounces = self.manifolds.iter().any(ManifoldRows::bounces);
        self.bound_position_energy();
        self.add_drive_work();
    }

    /// Integrates velocities into poses, stores the joint forces, and recomputes all data that depend on poses, once for both
    /// `relax` and `solve` of the next substep.
    pub fn integrate_position(&mut self, view: &View<'_>, runner: &dyn TaskRunner) {
        self.read_pins();
        self.store_joint_forces();
        self.add_solve_reactions();
        self.force_work = self.work_of_forces();
        let h = self.h;
        let (moving, fixed) = self.bodies.split_at_mut(self.links.len());
        let (velocities, of_fixed) = self.velocities.split_at_mut(moving.len());
        dispatch::run(IntegratePosition { bodies: moving, velocities, before: &self.unconstrained, h });
        for (body, v) in fixed.iter_mut().zip(of_fixed) {
            body.pose = advance(&body.pose, v, h);
        }
        self.refresh(view, runner);
        self.begin_relax_reactions();
    }

    /// Applies external impulses, one for each moving body, through the trees.
    pub fn apply_impulses(&mut self, impulses: &[Vec6]) {
        if impulses.iter().all(|p| *p == ZERO6) {
            return;
        }
        self.pushed_from_outside = true;
        for (accounted, p) in self.accounted.iter_mut().zip(impulses) {
            add_scaled(accounted, p, 1.0);
        }
        self.scratch.impulses.clear();
        self.scratch.impulses.extend_from_slice(impulses);
        self.answer_impulses();
    }

    /// Removes joint velocities at the new poses (RATTLE), then solves contacts and limits without bias, and friction.
    pub fn relax(&mut self, view: &View<'_>, runner: &dyn TaskRunner) {
        let usual = self.policy;
        if self.bears_by_springs {
            self.policy = usual.at_least(HUNG);
        }
        self.relax_rows(view, runner);
        self.policy = usual;
    }

    /// Performs `relax` with the current policy.
    fn relax_rows(&mut self, view: &View<'_>, runner: &dyn TaskRunner) {
        if core::mem::take(&mut self.displaced) {
            self.refresh(view, runner);
        }
        if !self.has_joints() {
            self.sweep(Pass::Relax, runner);
            self.fall_back_to_rigid(0.0);
            self.bound_energy();
            self.contacts.end_substep(self.h, runner);
            return;
        }
        for rows in &mut self.manifolds {
            rows.begin_relax(&self.velocities, self.h);
        }
        self.project_joints(Pass::Relax);
        self.refine_joints();
        self.sweep(Pass::Relax, runner);
        self.fall_back_to_rigid(0.0);
        if self.coupling == Coupling::Turns {
            self.contacts.end_substep(self.h, runner);
        } else {
            self.bound_energy();
        }
        for rows in &mut self.manifolds {
            rows.end_substep(self.h);
        }
        self.end_limits();
        self.end_loops();
        self.add_motor_work();
        let released = self.release_motors();
        self.add_relax_reactions();
        if released {
            // The rows of released motors act from the next substep on.
            self.renew_rows();
        }
    }

    /// Applies restitution to contacts hit in this substep, then adds the work of kinematic bodies.
    pub fn restitution(&mut self, runner: &dyn TaskRunner) {
        if self.bounces {
            self.bounced_from.clear();
            self.bounced_from.extend_from_slice(&self.velocities[..self.links.len()]);
            self.sweep(Pass::Restitution, runner);
            self.limit_bounce();
            self.fall_back_to_rigid(0.0);
            self.contacts.end_bounce();
            for rows in &mut self.manifolds {
                rows.add_bounce();
            }
        }
        self.add_kinematic_work();
    }

    /// Recomputes rows, inertias, factor and response at the current poses.
    fn refresh(&mut self, view: &View<'_>, runner: &dyn TaskRunner) {
        if !self.has_joints() {
            self.refresh_mass_scale();
            self.refresh_inertia();
            self.place_contacts(view, runner);
            return;
        }
        self.refresh_joints();
        self.refresh_inertia();
        self.factor_joints();
        if self.coupling == Coupling::Turns {
            self.contacts.spoil();
            self.place_contacts(view, runner);
        }
        for rows in &mut self.manifolds {
            rows.refresh_points(&self.bodies, &self.velocities, self.h);
            rows.place(rows.poses(&self.bodies));
        }
        self.choose_limits();
        self.refresh_response();
    }

    /// Updates contacts in lanes to the current poses.
    fn place_contacts(&mut self, view: &View<'_>, runner: &dyn TaskRunner) {
        self.contacts.place(&Substep {
            view,
            bodies: &self.bodies,
            starts: &self.starts,
            velocities: &self.velocities,
            moving: self.links.len(),
            h: self.h,
            runner,
        });
    }

    /// Computes inverse inertias at the present pose. Geometric stiffness `h² k_g` of the joint forces counts only as far as it
    /// exceeds the inertia, as row sums in the principal frame so that the block stays diagonal (Andrews et al. 2017):
    /// without it 1000:1 chains explode, with all of it a double pendulum loses 72 % of its energy in 20 s.
    fn refresh_inertia(&mut self) {
        for body in &mut self.bodies[..self.links.len()] {
            body.excess = Vec3::ZERO;
        }
        let h2 = self.h * self.h;
        for joint in &self.joints {
            for (body, arm, force) in
                [(joint.a, joint.pose.arm_a, -joint.force), (joint.b, joint.pose.arm_b, joint.force)]
            {
                // k_g = max(0, r·f)(1 − r̂ r̂ᵀ), with f the force on this body at its anchor.
                let pull = arm.dot(force);
                if pull > 0.0 && (body as usize) < self.links.len() {
                    let body = &mut self.bodies[body as usize];
                    let axis = body.pose.rotation.inverse() * normalize_or(arm, Vec3::X);
                    let off = abs3(axis);
                    let row = Vec3::new(
                        1.0 - axis.x * axis.x + off.x * (off.y + off.z),
                        1.0 - axis.y * axis.y + off.y * (off.x + off.z),
                        1.0 - axis.z * axis.z + off.z * (off.x + off.y),
                    );
                    body.excess += row * (pull * h2);
                }
            }
        }
        dispatch::run(RefreshInertia(&mut self.bodies[..self.links.len()]));
    }

    /// Finds the bodies that have rows and chooses the members of the response.
    fn refresh_response(&mut self) {
        let wanted = &mut self.scratch.wanted;
        wanted.clear();
        wanted.resize(self.links.len(), false);
        let mut want = |body: u32| {
            if let Some(w) = wanted.get_mut(body as usize) {
                *w = true;
            }
        };
        for rows in &self.manifolds {
            want(rows.a);
            want(rows.b);
        }
        let loops = self.loops.closed_exactly().iter().copied();
        for joint in loops.chain(self.limits.iter().map(|row| row.joint)) {
            want(self.joints[joint as usize].a);
            want(self.joints[joint as usize].b);
        }
        if self.coupling == Coupling::Turns {
            // Contacts between the turns of limits read all velocities.
            wanted.fill(true);
        }
        self.response.choose(&self.links, self.trees.len(), wanted);
        let links = (&self.links[..], &mut self.batches);
        self.loops.respond(&self.joints, &self.bodies, links, &mut self.response);
        self.response_cache.clear();
        self.limit_blocks.clear(self.trees.len());
        for rows in &mut self.manifolds {
            rows.columns = None;
        }
    }

    /// Adds points to contacts of jointed bodies that penetrate far at the predicted poses, at points without rows. Returns true if
    /// there are any. (Without joints no body swings in so fast, and corners that bounce together would gain energy.)
    fn predict_contacts(&mut self) -> bool {
        let mut any = false;
        if !self.has_joints() {
            return any;
        }
        for rows in &mut self.manifolds {
            if rows.predict_points(&self.bodies, &self.velocities, self.h) {
                rows.columns = None;
                any = true;
            }
        }
        any
    }

    /// True if joints connect some bodies of the island.
    fn has_joints(&self) -> bool {
        self.coupling != Coupling::Free
    }

    /// True if contacts are solved in lanes.
    fn is_in_lanes(&self) -> bool {
        self.coupling != Coupling::Response
    }

    /// Work of forces during the motion of this substep, J.
    fn work_of_forces(&self) -> f32 {
        let power = |(body, v): (&SolverBody, &Vec6)| body.force.dot(linear(v)) + body.torque.dot(angular(v));
        let moving = self.bodies[..self.links.len()].iter().zip(&self.velocities);
        self.h * moving.map(power).fold(0.0, |sum, power| sum + power)
    }

    /// True if the substep is longer than the world's and left predicted violations of limits or contacts unresolved, or moved a
    /// joint far beyond a limit.
    pub fn overreaches(&self) -> bool {
        self.stretch > 1.0 && self.predicts() && (!self.is_settled || self.leaps_limits())
    }

    /// Number of substeps of the island in this step.
    pub fn substeps(&self) -> u32 {
        self.substeps
    }

    /// Moving bodies of the island, in tree order.
    pub fn moving_bodies(&self) -> &[SolverBody] {
        &self.bodies[..self.links.len()]
    }
}
