//! Contacts in lanes and joint trees by turns, for heaps of figures: a sweep visits all blocks with the bodies' own masses, then the
//! limits with what their two bodies answer through the trees, then the trees are solved exactly with what both gave.
//!
//! Each of the three lessens the energy of the error, whatever the others did (block Gauss-Seidel), and the sweeps are conjugate
//! steps. The exact response of all links, which small islands sweep with, costs more than it saves where hundreds of contacts
//! couple dozens of trees.

use super::response::{load, product};
use super::sweep::Pass;
use super::tree::{Link, NONE, store};
use super::{Coupling, IslandSolver, SolverBody};
use crate::spatial::{
    Mat6, Vec6, ZERO6, ZERO66, add_scaled, angular, join, largest, linear, mul_transposed, transpose,
};
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::Lanes;
use sinew_math::max;

/// How links answer to impulses on themselves, joints of their tree included: the diagonal blocks of the response.
#[derive(Clone, Debug, Default)]
pub(super) struct OwnResponse {
    blocks: Vec<Mat6>,
    /// Answers of both bodies of a joint to a unit of a limit row, in the order in which rows asked.
    pub answers: Vec<[Vec6; 2]>,
    /// Impulses of the limit rows, for conjugate steps.
    limits: Vec<f32>,
}

/// From the roots to the leaves: `W_c = L_c + A_c W_p A_cᵀ` with `A_c` what a link takes on from its parent.
struct Fill<'a> {
    blocks: &'a mut Vec<Mat6>,
    links: &'a [Link],
}

impl Kernel for Fill<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { blocks, links } = self;
        blocks.clear();
        for link in links {
            let mut own = load::<L>(link.response_with_parent_held());
            let mut block = ZERO66;
            if let Some(above) = blocks.get(link.parent as usize) {
                let carry = link.carry::<L>();
                store(product(&carry, above), &mut block);
                let through = product(&carry, &transpose(&block));
                for (own, add) in own.iter_mut().zip(through) {
                    *own = *own + add;
                }
            }
            store(own, &mut block);
            blocks.push(block);
        }
    }
}

impl OwnResponse {
    /// At the present pose.
    pub fn fill(&mut self, links: &[Link]) {
        dispatch::run(Fill { blocks: &mut self.blocks, links });
        self.answers.clear();
    }

    /// Answers of two jointed bodies to impulses on both.
    pub fn answer(&self, links: &[Link], bodies: [u32; 2], row: [&Vec6; 2]) -> [Vec6; 2] {
        let is_above =
            |child: u32, parent: u32| links.get(child as usize).is_some_and(|link| link.parent == parent);
        let (child, parent) = if is_above(bodies[0], bodies[1]) { (0, 1) } else { (1, 0) };
        let mut answers = [ZERO6; 2];
        let Some(link) = links.get(bodies[child] as usize) else { return answers };
        if !is_above(bodies[child], bodies[parent]) {
            // A joint that closes a loop: each body by itself.
            for end in 0..2 {
                if let Some(block) = self.blocks.get(bodies[end] as usize) {
                    answers[end] = mul_transposed(block, row[end]);
                }
            }
            return answers;
        }
        answers[child] = mul_transposed(link.response_with_parent_held(), row[child]);
        if let Some(block) = self.blocks.get(bodies[parent] as usize) {
            let mut on_parent = *row[parent];
            add_scaled(&mut on_parent, &link.carry_up(row[child]), 1.0);
            answers[parent] = mul_transposed(block, &on_parent);
            let carried = link.carry_down(&answers[parent]);
            add_scaled(&mut answers[child], &carried, 1.0);
        }
        answers
    }
}

/// What gave a body this change of velocity, if nothing held it.
fn impulse_of(body: &SolverBody, change: &Vec6) -> Vec6 {
    let r = body.pose.rotation;
    let inertia = (body.inertia + body.excess) * body.ballast;
    let spin = r * ((r.inverse() * angular(change)) * inertia);
    join(linear(change) * (body.mass * body.ballast), spin)
}

impl IslandSolver {
    /// Sweeps over blocks, limits and trees.
    pub(super) fn sweep_by_turns(&mut self, pass: Pass) {
        let sweeps = self.effort.of_turns(pass);
        if self.contacts.is_empty() && self.limits.is_empty() {
            return;
        }
        self.contacts.begin_pass(pass, &self.velocities, self.h);
        let conjugate = pass != Pass::Restitution;
        let mut limits = core::mem::take(&mut self.own.limits);
        for done in 1..=sweeps.most {
            if conjugate {
                limits.clear();
                limits.extend(self.limits.iter().map(|row| row.impulse));
                self.contacts.before_conjugate(&self.velocities, &limits);
            }
            self.note_velocities();
            let rows = self.contacts.tally().manifolds as usize + self.limits.len();
            self.tally.sweep(pass, done, rows);
            let swept = self.contacts.sweep_once(pass, sweeps, done, &mut self.velocities);
            self.take_impulses_of_contacts();
            let energy = swept.energy + self.visit_limits_of_pairs(pass);
            let change = max(swept.largest, self.solve_trees_with_impulses());
            if done == sweeps.most || (done > 1 && change < sweeps.tolerance) {
                break;
            }
            if conjugate {
                limits.clear();
                limits.extend(self.limits.iter().map(|row| row.impulse));
                self.contacts.after_conjugate(energy, &mut self.velocities, &mut limits);
                for (row, &impulse) in self.limits.iter_mut().zip(&limits) {
                    row.impulse = impulse;
                }
            }
        }
        self.own.limits = limits;
    }

    fn note_velocities(&mut self) {
        let moving = self.links.len();
        self.scratch.before.clear();
        self.scratch.before.extend_from_slice(&self.velocities[..moving]);
    }

    /// From the changes of velocities, which the contacts made with the bodies' own masses.
    fn take_impulses_of_contacts(&mut self) {
        self.impulses.clear();
        for (i, before) in self.scratch.before.iter().enumerate() {
            let change: Vec6 = core::array::from_fn(|k| self.velocities[i][k] - before[k]);
            let impulse = if change == ZERO6 { ZERO6 } else { impulse_of(&self.bodies[i], &change) };
            self.impulses.push(impulse);
        }
    }

    /// Visits the limit rows. Gives the energy of their changes.
    fn visit_limits_of_pairs(&mut self, pass: Pass) -> f32 {
        let mut energy = 0.0;
        for i in 0..self.limits.len() {
            let joint = &self.joints[self.limits[i].joint as usize];
            let bodies = [joint.a, joint.b];
            let rate = self.limits[i].rate(joint, &self.velocities);
            if self.limits[i].is_idle(pass, rate, self.h) {
                continue;
            }
            let row = &mut self.limits[i];
            let at = row.column.unwrap_or(self.own.answers.len());
            if row.column.is_none() {
                let answers = self.own.answer(&self.links, bodies, row.ends());
                row.column = Some(at);
                row.weigh(joint, &self.bodies, self.links.len(), &answers);
                self.own.answers.push(answers);
            }
            let answers = &self.own.answers[at];
            let change = row.change(pass, rate, self.h);
            if change == 0.0 {
                continue;
            }
            energy += change * change * row.effective();
            for (end, &body) in bodies.iter().enumerate() {
                if (body as usize) < self.links.len() {
                    add_scaled(&mut self.velocities[body as usize], &answers[end], change);
                    add_scaled(&mut self.impulses[body as usize], row.ends()[end], change);
                }
            }
        }
        energy
    }

    /// Velocities from those before the sweep and the impulses of it, exactly. Gives the largest change by what the sweep did not
    /// know of.
    fn solve_trees_with_impulses(&mut self) -> f32 {
        let moving = self.links.len();
        for (push, p) in self.contact_push.iter_mut().zip(&self.impulses) {
            *push += linear(p);
        }
        self.scratch.impulses.clear();
        self.scratch.impulses.extend_from_slice(&self.impulses);
        let swept = core::mem::take(&mut self.moved);
        let mut swept = swept;
        swept.clear();
        swept.extend_from_slice(&self.velocities[..moving]);
        self.velocities[..moving].copy_from_slice(&self.scratch.before);
        self.answer_impulses();
        let mut most = 0.0;
        for (i, swept) in swept.iter().enumerate() {
            let change: Vec6 = core::array::from_fn(|k| self.velocities[i][k] - swept[k]);
            let change = largest(&change);
            self.contacts.stir(i, change);
            most = max(most, change);
        }
        self.moved = swept;
        most
    }

    /// Puts the starting impulses of contacts and limits on the bodies, as if nothing held them.
    pub(super) fn warm_start_coupled(&mut self) {
        self.note_velocities();
        self.contacts.warm_start(&mut self.velocities);
        self.take_impulses_of_contacts();
        let mut impulses = core::mem::take(&mut self.scratch.dv);
        impulses.clear();
        impulses.resize(self.links.len(), ZERO6);
        for row in &mut self.limits {
            row.warm_start(&self.joints, &mut impulses);
        }
        for (i, p) in impulses.iter().enumerate() {
            self.contact_push[i] += linear(p) + linear(&self.impulses[i]);
            if *p != ZERO6 {
                let change = self.bodies[i].velocity_change(p);
                add_scaled(&mut self.velocities[i], &change, 1.0);
            }
        }
        self.scratch.dv = impulses;
    }

    /// Whether a link is part of a tree of joints.
    pub(super) fn is_jointed(&self, body: u32) -> bool {
        self.coupling != Coupling::Free
            && self.links.get(body as usize).is_some_and(|link| {
                let next = self.links.get(body as usize + 1);
                link.joint != NONE || next.is_some_and(|next| next.tree == link.tree)
            })
    }
}
