//! Effective masses of joint springs and motors, computed with each side of the joint as one rigid piece.

use crate::joint::{DIRECTIONS, JointRows, TWIST};
use crate::solver::IslandSolver;
use crate::solver::articulation::piece::Piece;
use crate::solver::articulation::tree::{Link, NONE};
use crate::solver::joint::SolverJoint;
use crate::solver::tuning::{LEAST_ROW_MASS, LEAST_ROW_MOMENT};
use crate::spatial::{Vec6, ZERO6, ZERO66, spd_inverse};
use sinew_math::{Vec3, max};

impl IslandSolver {
    /// Computes the masses of all joints that need them when the step begins.
    pub(in crate::solver) fn find_joint_masses(&mut self) {
        if self.joints.iter().all(|joint| !joint.drive.needs_mass()) {
            return;
        }
        self.sum_pieces();
        self.share_out();
        let pieces = &self.scratch.pieces;
        for j in 0..self.joints.len() {
            if !self.joints[j].drive.needs_mass() {
                continue;
            }
            let joint = &self.joints[j];
            let rows = JointRows::new(&joint.geometry, &joint.pose, [true; DIRECTIONS]);
            let (mut response, mut alone) = (ZERO66, ZERO66);
            let jacobians = [JointRows::on_a, JointRows::on_b];
            for (side, on_side) in [joint.a, joint.b].into_iter().zip(jacobians) {
                let on_side: [Vec6; DIRECTIONS] = core::array::from_fn(|row| on_side(&rows, row));
                let on_side = &on_side[..rows.count];
                let Some(link) = self.links.get(side as usize) else { continue };
                let center = self.bodies[side as usize].pose.translation;
                // One side is the subtree below this joint. The other side is the rest of the tree, unless a fixed body
                // holds the tree.
                let (piece, reference) = if let Some(piece) = self.pins.piece(j) {
                    (Some(piece), self.reference(link.tree))
                } else if link.joint as usize == j {
                    (Some(pieces[side as usize]), self.reference(link.tree))
                } else if self.is_tree_joint(j) {
                    let child = if side == joint.a { joint.b } else { joint.a };
                    let root = self.root(link.tree);
                    let free = self.links[root].joint == NONE;
                    let rest = pieces[root].minus(&pieces[child as usize]);
                    (free.then_some(rest), self.reference(link.tree))
                } else {
                    (Some(Piece::of(&self.bodies[side as usize], center)), center)
                };
                if let Some(piece) = piece {
                    piece.add_response(on_side, center - reference, &mut response);
                }
                if joint.drive.motor.is_some() {
                    let own = Piece::of(&self.bodies[side as usize], center);
                    own.add_response(on_side, Vec3::ZERO, &mut alone);
                }
            }
            let joint = &mut self.joints[j];
            joint.mass = masses(joint, &rows, &response, Together::Rotations);
            joint.least_mass = joint.mass;
            if joint.drive.motor.is_some() {
                joint.least_mass = masses(joint, &rows, &alone, Together::Nothing);
            }
        }
    }

    /// Sums the piece of each link: the link with all links below it.
    fn sum_pieces(&mut self) {
        self.scratch.pieces.clear();
        for (i, link) in self.links.iter().enumerate() {
            let reference = self.reference(link.tree);
            self.scratch.pieces.push(Piece::of(&self.bodies[i], reference));
        }
        for i in (0..self.links.len()).rev() {
            let parent = self.links[i].parent as usize;
            if parent < self.links.len() {
                self.scratch.pieces[parent] = self.scratch.pieces[parent].plus(&self.scratch.pieces[i]);
            }
        }
    }

    fn is_tree_joint(&self, joint: usize) -> bool {
        let of =
            |body: u32| self.links.get(body as usize).is_some_and(|link: &Link| link.joint as usize == joint);
        of(self.joints[joint].a) || of(self.joints[joint].b)
    }

    fn root(&self, tree: u32) -> usize {
        self.links.partition_point(|link| link.tree < tree)
    }

    pub(in crate::solver) fn reference(&self, tree: u32) -> Vec3 {
        self.bodies[self.root(tree)].pose.translation
    }
}

/// Open rows that are locked while the mass along one of them is computed.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Together {
    Nothing,
    /// For a rotation, the other open rotations.
    Rotations,
}

/// Effective mass along each row, by direction, with the rigid rows locked. Open rotations are driven together, so the mass of each is
/// computed with the other two locked. The axes of a shoulder are not along the arm: if the others were free, the arm could evade a row
/// by spinning about itself, and the mass along that row would be almost zero.
fn masses(joint: &SolverJoint, rows: &JointRows, response: &[Vec6; DIRECTIONS], together: Together) -> Vec6 {
    let rigid = if joint.drive.weld.is_some() { 0 } else { rows.locked };
    let turns =
        |row: usize| together == Together::Rotations && row >= rows.locked && rows.direction(row) >= TWIST;
    let mut out = ZERO6;
    for row in rigid..rows.count {
        let is_held = |k: usize| k < rigid || (turns(row) && turns(k) && k != row);
        let mut list = [0; DIRECTIONS];
        let mut count = 0;
        for k in (0..rows.count).filter(|&k| is_held(k)).chain([row]) {
            list[count] = k;
            count += 1;
        }
        let mut held = ZERO66;
        for i in 0..count {
            for k in 0..count {
                held[i][k] = response[list[i]][list[k]];
            }
        }
        let inverse = spd_inverse(&held, count);
        let alone = response[row][row];
        // If the rows are dependent (gimbal lock), use the mass of the row alone.
        let mass = inverse.map_or(if alone > 0.0 { 1.0 / alone } else { 0.0 }, |m| m[count - 1][count - 1]);
        let least = if rows.turns(row) { LEAST_ROW_MOMENT } else { LEAST_ROW_MASS };
        out[rows.direction(row)] = max(mass, least);
    }
    out
}
