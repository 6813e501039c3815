//! Batches: joint trees of one shape, up to eight side by side, one in each lane.
//!
//! Factor and solve are those of [`tree`](super::tree), but the elimination of a joint is kept as it is, a pivot and what it couples,
//! instead of as 6×6 matrices of a link: in lanes that is the shorter way. A shape is which link hangs on which and how many
//! rotations each joint holds, so that figures of one kind share a batch, whatever their sizes and poses.
//!
//! Heaps of figures are solved so ([`Coupling::Turns`](super::Coupling)). Trees that are held by fixed bodies, that have motors, or
//! joints that do not hold a point, are solved one by one.

mod answer;
mod factor;
mod node;
mod solve;
mod turn;

use super::contacts::Contacts;
use super::response::Push;
use super::sweep::Unrest;
use super::tree::{Link, NONE};
use super::{SolverBody, SolverJoint};
use crate::joint::TWIST;
use crate::spatial::{Vec6, angular};
use answer::AnswerRows;
use core::ops::Range;
use node::{Kind, Node, Site};
use sinew_math::lanes::WIDTH;
use sinew_math::{dispatch, max};
use solve::{SolveBatch, Way};
use turn::TurnOfBatch;

/// Batches, from the last one on, in which room is looked for: more would cost more than half-empty ones where all shapes differ.
const OPEN: usize = 16;
/// Most links of a tree in a batch: what the factor knows of them lies on the stack.
const MOST_LINKS: usize = 32;

/// Most that a link turns for its batch to stand, rad: directions are off by as much, and joints by that share of what they move.
const STANDING_TURN: f32 = 0.01;

/// Batches of an island.
#[derive(Clone, Debug, Default)]
pub(super) struct Batches {
    /// Batches in use, and memory of earlier steps behind them.
    batches: Vec<Batch>,
    used: usize,
    /// Batch and lane of each tree; `NONE` of those that are solved alone.
    places: Vec<(u32, u32)>,
    /// Links of the trees that are solved alone.
    pub alone: Vec<Range<usize>>,
    shape: Vec<Site>,
    /// Per tree.
    standing: Vec<Standing>,
    /// Memory for solves.
    ways: Vec<Way>,
}

/// Velocities in a sweep by turns.
pub(super) struct TurnVelocities<'a> {
    /// Velocities before the sweep, and after the limits had their turn.
    pub before: &'a [Vec6],
    pub limited: &'a [Vec6],
    /// Velocities after the contacts had their turn.
    pub now: &'a mut [Vec6],
}

/// Up to eight trees of one shape.
#[derive(Clone, Debug)]
pub(super) struct Batch {
    /// Number of each tree and its first link, lane by lane; lanes that are not filled repeat the first tree.
    trees: [u32; WIDTH],
    first: [usize; WIDTH],
    lanes: usize,
    nodes: Vec<Node>,
}

/// Whether a tree stands as an earlier substep of the step left it.
#[derive(Clone, Copy, Debug, Default)]
struct Standing {
    /// It has several links, and no springs, which ask for something else wherever they are.
    may: bool,
    /// Angle that a link may have turned by since the tree was factored, rad.
    turned: f32,
    now: bool,
}

impl Batches {
    /// For so many trees, also if there are none now: memory goes on to the next island.
    pub fn make_room(&mut self, trees: usize) {
        self.places.clear();
        self.places.reserve(trees);
        self.standing.clear();
        self.standing.reserve(trees);
        self.alone.clear();
        self.alone.reserve(trees + 1);
    }

    /// Begins with none: all trees are solved alone.
    pub fn clear(&mut self, links: usize) {
        self.used = 0;
        self.ways.resize(MOST_LINKS, Way::NONE);
        self.places.clear();
        self.standing.clear();
        self.alone.clear();
        self.alone.push(0..links);
    }

    /// Puts all trees that can share a batch into one.
    pub fn form(&mut self, links: &[Link], joints: &[SolverJoint], trees: &[Range<usize>]) {
        self.clear(links.len());
        self.alone.clear();
        for (number, range) in trees.iter().enumerate() {
            self.standing.push(Standing::default());
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
            self.standing[number].may = range.len() > 1 && !is_sprung(&links[range.clone()], joints);
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

    /// Makes `shape` that of a tree. False if it cannot be in a batch.
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

    /// Another batch, of the shape that was read.
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

    /// Writes the velocity change of every body from impulses on the bodies and residuals of the rows that joints hold; no list of
    /// residuals means none.
    pub fn solve(&mut self, impulses: &[Vec6], residuals: &[Vec6], dv: &mut [Vec6]) {
        let ways = &mut self.ways[..];
        for batch in &self.batches[..self.used] {
            dispatch::run(SolveBatch { batch, ways, impulses, residuals, dv });
        }
    }

    /// Trees take on what impulses of limits, and of contacts in this sweep, make of the velocities before it; who did not know of it is
    /// told. `impulses` are those of limits, and get those of contacts. Gives the largest change that the contacts did not know of.
    pub fn take_turns(
        &mut self,
        impulses: &mut [Vec6],
        velocities: &mut TurnVelocities<'_>,
        contacts: &mut Contacts,
        unrest: &mut Unrest,
    ) -> f32 {
        let (ways, mut most) = (&mut self.ways[..], 0.0);
        for batch in &self.batches[..self.used] {
            let turn = TurnOfBatch { batch, ways, impulses, velocities, contacts, unrest };
            most = max(most, dispatch::run(turn));
        }
        most
    }

    /// Makes columns, `stride` apart from each other, the velocity changes of all links of a tree from impulses: each column from those
    /// on one or two links, which are given with their places. False if the tree is solved alone.
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

    /// Takes on arms, axes and inertias at the present pose, and factors all trees.
    pub fn factor(&mut self, links: &[Link], joints: &[SolverJoint], bodies: &[SolverBody]) {
        let Self { batches, used, standing, .. } = self;
        for batch in &mut batches[..*used] {
            if batch.gather((links, joints, bodies), standing) {
                dispatch::run(factor::Factor(&mut batch.nodes));
            }
        }
    }

    /// Before bodies move by their velocities for `h` seconds: which trees stand after that, of those that are not barred.
    pub fn choose_standing(&mut self, trees: &[Range<usize>], velocities: &[Vec6], h: f32, barred: &[bool]) {
        for (tree, standing) in self.standing.iter_mut().enumerate().filter(|(_, standing)| standing.may) {
            standing.turned += most_turn(&velocities[trees[tree].clone()], h);
            standing.now = standing.turned <= STANDING_TURN && !barred[tree];
        }
    }

    /// All trees are factored anew.
    pub fn let_none_stand(&mut self) {
        self.standing.iter_mut().for_each(|standing| standing.now = false);
    }

    /// True of a tree that stands.
    pub fn stand(&self, tree: usize) -> bool {
        self.standing.get(tree).is_some_and(|standing| standing.now)
    }

    /// True if all trees are solved alone.
    pub fn are_none(&self) -> bool {
        self.used == 0
    }

    /// True of a tree that shares a batch.
    pub fn have(&self, tree: usize) -> bool {
        self.places.get(tree).is_some_and(|place| place.0 != NONE)
    }

    /// Bytes that are filled.
    pub fn bytes(&self) -> usize {
        self.batches[..self.used].iter().map(|batch| size_of_val(&batch.nodes[..])).sum()
    }
}

impl Batch {
    /// Takes on trees that do not stand. False if all do.
    fn gather(
        &mut self,
        (links, joints, bodies): (&[Link], &[SolverJoint], &[SolverBody]),
        standing: &mut [Standing],
    ) -> bool {
        let Self { trees, first, lanes, nodes } = self;
        let mut any = false;
        for lane in 0..*lanes {
            let standing = &mut standing[trees[lane] as usize];
            if standing.now {
                continue;
            }
            (standing.turned, any) = (0.0, true);
            for (i, node) in nodes.iter_mut().enumerate() {
                let local = first[lane] + i;
                node.write_body(lane, &bodies[local]);
                if let Some(joint) = joints.get(links[local].joint as usize) {
                    node.write_joint(lane, joint, joint.b as usize == local);
                }
            }
        }
        if any {
            nodes.iter_mut().for_each(|node| node.fill(*lanes));
        }
        any
    }
}

/// Most that one of these velocities turns a body by in `h` seconds, rad.
fn most_turn(velocities: &[Vec6], h: f32) -> f32 {
    velocities.iter().map(|v| angular(v).length_squared()).fold(0.0, max).sqrt() * h
}

/// True if springs act in a tree.
fn is_sprung(links: &[Link], joints: &[SolverJoint]) -> bool {
    links.iter().filter_map(|link| joints.get(link.joint as usize)).any(|joint| joint.drive.spring.is_some())
}

/// Elimination of a joint in a batch; `None` if it has to be solved alone.
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
