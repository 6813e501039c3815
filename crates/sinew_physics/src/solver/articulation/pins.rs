//! Pins: springs and motors between a body and a fixed body that leave all six directions open. A pin closes no loop: with rows `J` of
//! gains `G` its impulse is `λ = G (r − J dv)`, so the body moves as if it had `Jᵀ G J` more inertia and were pushed by `Jᵀ G r`. Both are
//! added to the factor of its tree, which stays exact, linear in time, and stable for any stiffness.

use crate::solver::IslandSolver;
use crate::solver::articulation::elimination::{Inertia, wide};
use crate::solver::articulation::piece::Piece;
use crate::solver::articulation::tree::NONE;
use crate::solver::joint::SolverJoint;
use crate::spatial::{Vec6, ZERO6, add_scaled, angular, dot, linear};

/// The pins of an island.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct Pins {
    /// Indices of the pins among the joints of the island.
    pub joints: Vec<u32>,
    /// For each moving body: index of the nearest pin in `joints`, and the number of joints between. `NONE` if there is no pin, or if the
    /// fixed body that holds the tree is nearer.
    nearest: Vec<(u32, u32)>,
    /// Piece that each pin carries.
    pieces: Vec<Piece>,
}

impl Pins {
    pub fn clear(&mut self) {
        self.joints.clear();
    }

    pub fn make_room(&mut self, bodies: usize, joints: usize) {
        self.joints.clear();
        self.joints.reserve(joints);
        self.pieces.clear();
        self.pieces.reserve(joints);
        self.nearest.clear();
        self.nearest.reserve(bodies);
    }

    /// Piece that a pin carries; `None` if the joint is not a pin.
    pub fn piece(&self, joint: usize) -> Option<Piece> {
        let place = self.joints.binary_search(&(joint as u32)).ok()?;
        self.pieces.get(place).copied()
    }
}

impl SolverJoint {
    /// Index of the moving body of a pin; `moving` is the number of moving bodies.
    fn pinned(&self, moving: usize) -> usize {
        (if (self.a as usize) < moving { self.a } else { self.b }) as usize
    }

    /// Jacobian of a row on the moving body of a pin.
    fn on_pinned(&self, body: usize, row: usize) -> Vec6 {
        if self.a as usize == body { self.rows.on_a(row) } else { self.rows.on_b(row) }
    }

    /// Adds `Jᵀ G J` of a pin to the inertia of its body.
    pub(in crate::solver) fn stiffen(&self, inertia: &mut [Inertia<f64>]) {
        let body = self.pinned(inertia.len());
        for row in 0..self.rows.count {
            let j = self.on_pinned(body, row);
            inertia[body].add_row(wide(linear(&j)), wide(angular(&j)), f64::from(self.gain(row)));
        }
    }
}

impl IslandSolver {
    /// Assigns each body to the nearest pin of its tree, the first one if several are equally near. The fixed body that holds the tree
    /// counts as one joint beyond its own joint.
    pub(in crate::solver) fn share_out(&mut self) {
        self.pins.nearest.clear();
        self.pins.pieces.clear();
        if self.pins.joints.is_empty() {
            return;
        }
        let moving = self.links.len();
        for link in &self.links {
            let held = link.joint != NONE && link.parent as usize >= moving;
            self.pins.nearest.push((NONE, if held { 1 } else { u32::MAX - 1 }));
        }
        for (place, &pin) in self.pins.joints.iter().enumerate() {
            let body = self.joints[pin as usize].pinned(moving);
            if self.pins.nearest[body].1 > 0 {
                self.pins.nearest[body] = (place as u32, 0);
            }
        }
        for up in [true, false] {
            for k in 0..moving {
                let i = if up { moving - 1 - k } else { k };
                let parent = self.links[i].parent as usize;
                if parent < moving {
                    let (from, to) = if up { (i, parent) } else { (parent, i) };
                    let (pin, away) = self.pins.nearest[from];
                    if away + 1 < self.pins.nearest[to].1 {
                        self.pins.nearest[to] = (pin, away + 1);
                    }
                }
            }
        }
        for &pin in &self.pins.joints {
            // A second pin on the same body carries the same piece.
            let body = self.joints[pin as usize].pinned(moving);
            let first = self.pins.joints[self.pins.nearest[body].0 as usize] == pin;
            let reference = self.reference(self.links[body].tree);
            let own = Piece::of(&self.bodies[body], reference);
            self.pins.pieces.push(if first { Piece::default() } else { own });
        }
        for (i, &(pin, _)) in self.pins.nearest.iter().enumerate() {
            if pin != NONE {
                let piece = Piece::of(&self.bodies[i], self.reference(self.links[i].tree));
                let sum = &mut self.pins.pieces[pin as usize];
                *sum = sum.plus(&piece);
            }
        }
    }

    /// Adds `Jᵀ G r` of all pins to the impulses on the trees.
    pub(in crate::solver) fn pull_pins(&mut self) {
        for &pin in &self.pins.joints {
            let joint = &self.joints[pin as usize];
            let residual = joint.residual(&joint.rate(&self.velocities), true, self.h);
            let of_rows = core::array::from_fn(|row| {
                if row < joint.rows.count { residual[row] / joint.compliance(row) } else { 0.0 }
            });
            joint.push(&of_rows, &mut self.scratch.impulses, 1.0);
        }
    }

    /// Computes the impulses of the pins after `solve`, from the rows at the resulting velocities.
    pub(in crate::solver) fn read_pins(&mut self) {
        for &pin in &self.pins.joints {
            let joint = &mut self.joints[pin as usize];
            let rate = joint.rate(&self.velocities);
            for row in 0..joint.rows.count {
                let before = joint.start_rate[joint.rows.direction(row)];
                joint.impulse[row] = joint.soft[row].impulse(before, rate[row]);
            }
            joint.note_exceeded(self.h);
        }
    }

    /// Computes the impulses of the pins after `relax`, in which a pin resists every change as inertia does.
    pub(in crate::solver) fn settle_pins(&mut self) {
        let moving = self.links.len();
        for &pin in &self.pins.joints {
            let joint = &mut self.joints[pin as usize];
            let body = joint.pinned(moving);
            let mut change = self.velocities[body];
            add_scaled(&mut change, &self.moved[body], -1.0);
            let mut resisted = ZERO6;
            for row in 0..joint.rows.count {
                resisted[row] = dot(&joint.on_pinned(body, row), &change) / joint.compliance(row);
            }
            add_scaled(&mut joint.impulse, &resisted, -1.0);
        }
    }

    /// Adds the work of kinematic bodies. They push bodies that touch them and pull bodies jointed to them, along their prescribed motion:
    /// their work is that of their reactions along this motion.
    pub(in crate::solver) fn add_kinematic_work(&mut self) {
        let moving = self.links.len();
        if self.velocities[moving..].iter().all(|v| *v == ZERO6) {
            return;
        }
        let mut given = self.contacts.work_of_kinematic(&self.velocities, moving);
        for rows in &self.manifolds {
            let push = rows.total_push();
            for (body, push) in [(rows.a as usize, &push.0), (rows.b as usize, &push.1)] {
                if body >= moving {
                    given -= dot(push, &self.velocities[body]);
                }
            }
        }
        for joint in &mut self.joints {
            let mut on_b = joint.reaction;
            add_scaled(&mut on_b, &joint.accounted, -1.0);
            joint.accounted = joint.reaction;
            for (body, arm, sign) in
                [(joint.a as usize, joint.pose.arm_a, 1.0), (joint.b as usize, joint.pose.arm_b, -1.0)]
            {
                if body >= moving {
                    let v = &self.velocities[body];
                    let anchor = linear(v) + angular(v).cross(arm);
                    given += sign * (linear(&on_b).dot(anchor) + angular(&on_b).dot(angular(v)));
                }
            }
        }
        self.work.kinematic += given;
    }
}
