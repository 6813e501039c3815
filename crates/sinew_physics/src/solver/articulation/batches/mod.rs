//! Batches: joint trees of one shape, up to eight side by side, one in each lane.
//!
//! Factor and solve are those of [`tree`](crate::solver::articulation::tree), but the elimination of a joint is stored as its pivot and
//! coupling instead of as 6×6 matrices of a link, which needs fewer operations in lanes. Two trees have the same shape if each link has the
//! same parent and each joint locks the same number of rotations. Ragdolls of one kind therefore share a batch, for any sizes and
//! poses.
//!
//! Only islands solved by [turns](crate::solver::Coupling::Turns) use batches. Trees held by fixed bodies, trees with motors, and trees
//! with joints that do not lock a point are solved one by one.

mod answer;
mod factor;
mod node;
mod solve;
mod turn;

use crate::joint::TWIST;
use crate::solver::articulation::response::Push;
use crate::solver::articulation::tree::{Link, NONE};
use crate::solver::sweep::dirty::DirtyRows;
use crate::solver::{SolverBody, SolverJoint};
use crate::spatial::Vec6;
use answer::AnswerRows;
use core::ops::Range;
use node::{Kind, Node, Site};
use sinew_math::lanes::WIDTH;
use sinew_math::{dispatch, max};
use solve::{SolveBatch, Way};
use turn::TurnOfBatch;

/// Number of most recent batches searched for a free lane. If all shapes differ, a longer search costs more than half-empty batches.
const OPEN: usize = 16;
/// Largest number of links of a batched tree: the factor keeps their inertias on the stack.
const MOST_LINKS: usize = 32;

/// Batches of an island.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct Batches {
    /// Batches in use, followed by unused batches whose memory is kept.
    batches: Vec<Batch>,
    used: usize,
    /// Batch and lane of each tree; `NONE` for a tree that is solved alone.
    places: Vec<(u32, u32)>,
    /// Link ranges of the trees that are solved one by one.
    pub alone: Vec<Range<usize>>,
    shape: Vec<Site>,
    /// Work memory of the solves.
    ways: Vec<Way>,
}

/// Velocities in a sweep by turns.
pub(in crate::solver) struct TurnVelocities<'a> {
    /// Velocities before the sweep, with the changes made by the limits in this sweep.
    pub before: &'a [Vec6],
    pub limited: &'a [Vec6],
    /// Velocities with the changes made by the contacts in this sweep.
    pub now: &'a mut [Vec6],
}

/// Up to eight trees of one shape.
#[derive(Clone, Debug)]
pub(in crate::solver) struct Batch {
    /// Index of each tree and of its first link, lane by lane; unused lanes repeat the first tree.
    trees: [u32; WIDTH],
    first: [usize; WIDTH],
    lanes: usize,
    nodes: Vec<Node>,
}

impl Batches {
    /// Reserves memory for `trees` trees, also if this island has none: the memory is reused for the next island.
    pub fn make_room(&mut self, trees: usize) {
        self.places.clear();
        self.places.reserve(trees);
        self.alone.clear();
        self.alone.reserve(trees + 1);
    }

    /// Removes all batches, so that all trees are solved one by one.
    pub fn clear(&mut self, links: usize) {
        self.used = 0;
        self.ways.resize(MOST_LINKS, Way::NONE);
        self.places.clear();
        self.alone.clear();
        self.alone.push(0..links);
    }

    /// Forms batches of trees with equal shapes.
    pub fn form(&mut self, links: &[Link], joints: &[SolverJoint], trees: &[Range<usize>]) {
        self.clear(links.len());
        self.alone.clear();
        for (number, range) in trees.iter().enumerate() {
            if !self.read_shape(links, joints, range) {
                self.places.push((NONE, NONE));
                match self.alone.last_mut() {
                    Some(last) if last.end == range.start => last.end = range.end,
                    _ => self.alone.push(range.clone()),
                }
                continue;
            }
            let shape = &self.shape;
            let fits = |batch: &Batch| {
                let same = |(node, site): (&Node, &Site)| node.site == *site;
                batch.lanes < WIDTH
                    && batch.nodes.len() == shape.len()
                    && batch.nodes.iter().zip(shape).all(same)
            };
            let from = self.used.saturating_sub(OPEN);
            let place = self.batches[from..self.used].iter().rposition(fits);
            let place = place.map_or_else(|| self.open(), |place| from + place);
            let batch = &mut self.batches[place];
            self.places.push((place as u32, batch.lanes as u32));
            batch.trees[batch.lanes..].fill(number as u32);
            batch.first[batch.lanes..].fill(range.start);
            batch.lanes += 1;
        }
        for batch in &mut self.batches[..self.used] {
            let (tree, first) = (batch.trees[0], batch.first[0]);
            batch.trees[batch.lanes..].fill(tree);
            batch.first[batch.lanes..].fill(first);
        }
    }

    /// Reads the shape of a tree into `shape`. Returns false if the tree cannot be in a batch.
    fn read_shape(&mut self, links: &[Link], joints: &[SolverJoint], range: &Range<usize>) -> bool {
        self.shape.clear();
        if range.len() > MOST_LINKS {
            return false;
        }
        for link in &links[range.clone()] {
            let site = match joints.get(link.joint as usize) {
                None => Some(Site { parent: NONE, kind: Kind::Root }),
                Some(joint) if link.parent as usize >= range.start && (link.parent as usize) < range.end => {
                    let parent = link.parent - range.start as u32;
                    kind_of(joint).map(|kind| Site { parent, kind })
                }
                Some(_) => None,
            };
            match site {
                Some(site) => self.shape.push(site),
                None => return false,
            }
        }
        true
    }

    /// Opens another batch for the shape that was read last.
    fn open(&mut self) -> usize {
        if self.used == self.batches.len() {
            let (trees, first) = ([0; WIDTH], [0; WIDTH]);
            self.batches.push(Batch { trees, first, lanes: 0, nodes: Vec::with_capacity(MOST_LINKS) });
        }
        let batch = &mut self.batches[self.used];
        batch.lanes = 0;
        batch.nodes.resize(self.shape.len(), Node::EMPTY);
        for (node, site) in batch.nodes.iter_mut().zip(&self.shape) {
            node.site = *site;
        }
        self.used += 1;
        self.used - 1
    }

    /// Writes the velocity change of every body, from impulses on the bodies and residuals of the locked joint rows. An empty list of
    /// residuals means zero residuals.
    pub fn solve(&mut self, impulses: &[Vec6], residuals: &[Vec6], dv: &mut [Vec6]) {
        let ways = &mut self.ways[..];
        for batch in &self.batches[..self.used] {
            dispatch::run(SolveBatch { batch, ways, impulses, residuals, dv });
        }
    }

    /// Solves the trees for the impulses that limits and contacts applied in this sweep, starting from the velocities before it, and
    /// records how far the bodies moved. `impulses` holds those of the limits; the contact impulses are added. Returns the largest velocity
    /// change, without the changes by the contacts.
    pub fn take_turns(
        &mut self,
        impulses: &mut [Vec6],
        velocities: &mut TurnVelocities<'_>,
        dirty: &mut DirtyRows,
    ) -> f32 {
        let (ways, mut most) = (&mut self.ways[..], 0.0);
        for batch in &self.batches[..self.used] {
            let turn = TurnOfBatch { batch, ways, impulses, velocities, dirty };
            most = max(most, dispatch::run(turn));
        }
        most
    }

    /// Writes columns, `stride` apart: the velocity changes of all links of a tree from impulses on one or two links, given by their
    /// indices. Returns false if the tree is solved alone.
    pub fn answer(
        &mut self,
        tree: u32,
        pushes: &[[Push<'_>; 2]],
        (columns, stride): (&mut [Vec6], usize),
    ) -> bool {
        let Some(&(place, lane)) = self.places.get(tree as usize) else { return false };
        let Some(batch) = self.batches.get(place as usize) else { return false };
        let (ways, lane) = (&mut self.ways[..], lane as usize);
        dispatch::run(AnswerRows { batch, lane, ways, pushes, columns, stride });
        true
    }

    /// Reads arms, axes and inertias at the current poses and factors all trees.
    pub fn factor(&mut self, links: &[Link], joints: &[SolverJoint], bodies: &[SolverBody]) {
        for batch in &mut self.batches[..self.used] {
            batch.gather(links, joints, bodies);
            dispatch::run(factor::Factor(&mut batch.nodes));
        }
    }

    /// Returns true if the tree is in a batch.
    pub fn have(&self, tree: usize) -> bool {
        self.places.get(tree).is_some_and(|place| place.0 != NONE)
    }

    /// Size of the memory in use, bytes.
    pub fn bytes(&self) -> usize {
        self.batches[..self.used].iter().map(|batch| size_of_val(&batch.nodes[..])).sum()
    }
}

impl Batch {
    fn gather(&mut self, links: &[Link], joints: &[SolverJoint], bodies: &[SolverBody]) {
        let Self { first, lanes, nodes, .. } = self;
        for (i, node) in nodes.iter_mut().enumerate() {
            for lane in 0..*lanes {
                let local = first[lane] + i;
                node.write_body(lane, &bodies[local]);
                if let Some(joint) = joints.get(links[local].joint as usize) {
                    node.write_joint(lane, joint, joint.b as usize == local);
                }
            }
            node.fill(*lanes);
        }
    }
}

/// Elimination kind of a joint in a batch; `None` if its tree has to be solved alone.
fn kind_of(joint: &SolverJoint) -> Option<Kind> {
    let rows = &joint.rows;
    if joint.rigid != rows.locked || !rows.locks_point() || joint.drive.motor.is_some() {
        return None;
    }
    Some(match rows.locked - TWIST {
        0 if rows.count == rows.locked => Kind::Point,
        0 => Kind::DrivenPoint,
        held => Kind::Axes { held },
    })
}
