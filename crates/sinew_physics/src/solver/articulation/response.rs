//! Articulated inverse inertia: the velocity changes of all bodies of a tree from an impulse on one, while the joints
//! hold. A contact solved with the mass of its link alone sinks: a 1 kg foot under 69 kg sinks by 72 mm.

use crate::solver::articulation::tree::{Link, NONE};
use crate::spatial::{Mat6, Vec6, ZERO66, add_scaled, dot};
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::Lanes;

/// Links whose response is computed, called members: the bodies of each tree that have rows, and their ancestors.
#[derive(Clone, Debug, Default)]
pub(crate) struct Response {
    /// Position of each body among the members of its tree, or `NONE`.
    slot: Vec<u32>,
    /// Members of all trees, tree after tree, parents first.
    members: Vec<u32>,
    /// Position of the parent of each member; 0 for a root.
    above: Vec<u32>,
    trees: Vec<Members>,
    /// Columns of the rows that [close](Self::close) loops, and the inverse of their mutual response, tree after tree.
    columns: Vec<Vec6>,
    inverses: Vec<f32>,
}

/// Members of one tree, and the rows that close loops in it.
#[derive(Clone, Copy, Debug, Default)]
struct Members {
    first: usize,
    count: usize,
    /// Number of rows that close loops, start of their columns, and start of their inverse.
    rows: usize,
    columns: usize,
    inverse: usize,
}

impl Response {
    /// Chooses the members: `wanted` bodies and all bodies between them and the root. Links of a tree are contiguous.
    pub fn choose(&mut self, links: &[Link], tree_count: usize, wanted: &[bool]) {
        self.columns.clear();
        self.inverses.clear();
        self.slot.clear();
        self.slot.resize(links.len(), NONE);
        for i in (0..links.len()).rev() {
            let parent = links[i].parent as usize;
            if (wanted[i] || self.slot[i] != NONE) && parent < links.len() {
                self.slot[parent] = 0;
            }
            if wanted[i] {
                self.slot[i] = 0;
            }
        }
        self.members.clear();
        self.above.clear();
        self.trees.clear();
        self.trees.resize(tree_count, Members::default());
        let mut i = 0;
        for (tree, entry) in self.trees.iter_mut().enumerate() {
            entry.first = self.members.len();
            while i < links.len() && links[i].tree as usize == tree {
                if self.slot[i] != NONE {
                    self.slot[i] = (self.members.len() - entry.first) as u32;
                    self.members.push(i as u32);
                    let parent = self.slot.get(links[i].parent as usize);
                    self.above.push(parent.map_or(0, |&place| place));
                }
                i += 1;
            }
            entry.count = self.members.len() - entry.first;
        }
    }

    /// Size of the data in use, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.members[..]) + size_of_val(&self.slot[..]) + size_of_val(&self.columns[..])
    }

    /// Members of a tree, parents first.
    pub fn members(&self, tree: u32) -> &[u32] {
        let tree = &self.trees[tree as usize];
        &self.members[tree.first..tree.first + tree.count]
    }

    /// Position of a body among the members of its tree; `None` for fixed bodies.
    pub fn slot(&self, body: u32) -> Option<usize> {
        self.slot.get(body as usize).map(|&slot| slot as usize)
    }

    /// Closes the loops of a tree: its response becomes `W − U S⁻¹ Uᵀ`, with one column of U for each row of `inverse`, which is S⁻¹.
    pub fn close(&mut self, tree: u32, columns: &[Vec6], inverse: &[f32]) {
        let members = &mut self.trees[tree as usize];
        members.rows = columns.len() / members.count;
        (members.columns, members.inverse) = (self.columns.len(), self.inverses.len());
        self.columns.extend_from_slice(columns);
        self.inverses.extend_from_slice(inverse);
    }

    /// Writes columns, `stride` apart: the velocity changes of all members of a tree from the impulses on one or two of them, given by
    /// their positions. The columns must be zero before.
    pub fn answer_all(
        &self,
        links: &[Link],
        tree: u32,
        pushes: &[[Push<'_>; 2]],
        (columns, stride): (&mut [Vec6], usize),
        lanes: &mut Vec<AnswerLanes>,
    ) {
        let tree = &self.trees[tree as usize];
        let range = tree.first..tree.first + tree.count;
        let (members, above) = (&self.members[range.clone()], &self.above[range]);
        lanes.clear();
        lanes.resize(tree.count, AnswerLanes::NONE);
        dispatch::run(AnswerAll { links, members, above, pushes, lanes, columns, stride });
        for (k, pushes) in pushes.iter().enumerate() {
            for &(slot, impulse) in pushes.iter().flatten() {
                self.close_answer(tree, slot, impulse, &mut columns[k * stride..][..tree.count]);
            }
        }
    }

    /// Subtracts the reaction of closed loops from the response to an impulse.
    fn close_answer(&self, tree: &Members, slot: usize, impulse: &Vec6, out: &mut [Vec6]) {
        if tree.rows == 0 {
            return;
        }
        let columns = &self.columns[tree.columns..tree.columns + tree.rows * tree.count];
        for row in 0..tree.rows {
            let line = &self.inverses[tree.inverse + row * tree.rows..][..tree.rows];
            let asked = |(k, s): (usize, &f32)| s * dot(&columns[k * tree.count + slot], impulse);
            let given: f32 = line.iter().enumerate().map(asked).fold(0.0, |sum, x| sum + x);
            for (out, column) in out.iter_mut().zip(&columns[row * tree.count..]) {
                add_scaled(out, column, -given);
            }
        }
    }
}

/// Impulse on a member of a tree, with its position.
pub(crate) type Push<'a> = Option<(usize, &'a Vec6)>;

/// Impulses on a member of a tree, then its velocity changes, one column in each lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AnswerLanes {
    numbers: Mat6,
    /// True if an impulse acts on the member or on a member below it.
    is_pushed: bool,
}

impl AnswerLanes {
    const NONE: Self = Self { numbers: ZERO66, is_pushed: false };
}

/// Computes the velocity changes of the members of a tree from impulses on one or two of them, eight columns in lanes: a pass up to the
/// root transmits impulses, and a pass down to the leaves computes velocity changes (Featherstone 2008, 7.3).
struct AnswerAll<'a> {
    links: &'a [Link],
    members: &'a [u32],
    above: &'a [u32],
    pushes: &'a [[Push<'a>; 2]],
    lanes: &'a mut [AnswerLanes],
    columns: &'a mut [Vec6],
    stride: usize,
}

impl Kernel for AnswerAll<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { links, members, above, pushes, lanes, columns, stride } = self;
        for (k, pushes) in pushes.iter().enumerate() {
            for &(slot, impulse) in pushes.iter().flatten() {
                for (row, number) in lanes[slot].numbers.iter_mut().zip(impulse) {
                    row[k] += number;
                }
                lanes[slot].is_pushed = true;
            }
        }
        for place in (1..members.len()).rev() {
            if lanes[place].is_pushed {
                let through = links[members[place] as usize].passed_up_all::<L>(&lanes[place].numbers);
                let parent = &mut lanes[above[place] as usize];
                for (sum, through) in parent.numbers.iter_mut().zip(through) {
                    (L::load(sum) + through).store(sum);
                }
                parent.is_pushed = true;
            }
        }
        let none = L::splat(0.0);
        for place in 0..members.len() {
            let link = &links[members[place] as usize];
            let mut change = [none; 6];
            if lanes[place].is_pushed {
                change = link.alone_all::<L>(&lanes[place].numbers);
            }
            if place > 0 {
                let carried = link.carried_all::<L>(&lanes[above[place] as usize].numbers);
                for (change, carried) in change.iter_mut().zip(carried) {
                    *change = *change + carried;
                }
            }
            for (row, change) in lanes[place].numbers.iter_mut().zip(change) {
                change.store(row);
            }
            let [x, y, z, u, v, w] = change;
            let of_columns = L::transpose([x, y, z, u, v, w, none, none]);
            for (k, column) in of_columns.into_iter().enumerate().take(pushes.len()) {
                column.store(&mut columns[k * stride + place]);
            }
        }
    }
}
