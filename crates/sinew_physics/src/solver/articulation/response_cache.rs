//! Columns of the response: the velocity changes of all members of a row's trees from a unit impulse of the row. They are computed once
//! for a pose, for rows that are not idle. An impulse then adds a multiple of a column. The responses between rows are dot products with
//! columns.

use crate::collide::MAX_POINTS;
use crate::joint::Row;
use crate::solver::articulation::batches::Batches;
use crate::solver::articulation::response::{AnswerLanes, Response};
use crate::solver::articulation::tree::Link;
use crate::spatial::{Vec6, ZERO6, add_scaled, dot, largest};
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{Lanes, WIDTH};

/// The columns of all rows that were not idle at the present pose.
#[derive(Clone, Debug, Default)]
pub(crate) struct ResponseCache {
    /// Columns, one after the other; [`CoveredBodies`] defines the entries of a column.
    entries: Vec<Vec6>,
    lanes: Vec<AnswerLanes>,
}

/// Place of contiguous columns of the same bodies: start and stride, in entries.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CachedColumns {
    start: usize,
    stride: usize,
}

impl CachedColumns {
    /// Index of the first entry of column `k`.
    pub fn column(&self, k: usize) -> usize {
        self.start + k * self.stride
    }
}

/// Bodies that the columns of two bodies' rows cover: the members of the tree of A, then those of the tree of B if it is a different
/// tree. Fixed bodies have no entries.
#[derive(Clone, Copy, Debug)]
struct CoveredBodies<'a> {
    members: [&'a [u32]; 2],
    /// Entries of A and B in a column.
    places: [Option<usize>; 2],
}

impl<'a> CoveredBodies<'a> {
    fn new(response: &'a Response, links: &[Link], bodies: [u32; 2]) -> Self {
        let trees = bodies.map(|body| links.get(body as usize).map(|link| link.tree));
        let members = |tree: Option<u32>| tree.map_or(&[][..], |tree| response.members(tree));
        let one = trees[0] == trees[1];
        let members = [members(trees[0]), if one { &[] } else { members(trees[1]) }];
        let second = if one { 0 } else { members[0].len() };
        let [a, b] = bodies.map(|body| response.slot(body));
        Self { members, places: [a, b.map(|slot| second + slot)] }
    }

    /// Number of entries of a column.
    fn len(&self) -> usize {
        self.members[0].len() + self.members[1].len()
    }
}

/// Changes of the impulses of rows with contiguous columns.
#[derive(Clone, Debug)]
pub(crate) struct Change {
    /// Index of the first entry of the first row's column.
    column: usize,
    count: usize,
    by: [f32; MAX_POINTS],
    /// Sums of the impulses on A and on B.
    pub push: [Vec6; 2],
}

impl Change {
    /// Creates an empty list of changes for rows from a column on.
    pub fn from_column(column: usize) -> Self {
        Self { column, count: 0, by: [0.0; MAX_POINTS], push: [ZERO6; 2] }
    }

    /// Adds the change of the next row.
    pub fn add(&mut self, [on_a, on_b]: [&Vec6; 2], by: f32) {
        self.by[self.count] = by;
        self.count += 1;
        add_scaled(&mut self.push[0], on_a, by);
        add_scaled(&mut self.push[1], on_b, by);
    }

    pub fn is_zero(&self) -> bool {
        self.by.iter().all(|by| *by == 0.0)
    }
}

impl ResponseCache {
    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// Size of the data in use, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.entries[..])
    }

    /// Index of the entry at which the next column will start.
    pub fn end(&self) -> usize {
        self.entries.len()
    }

    /// Entries from index `start` on.
    pub fn from(&self, start: usize) -> &[Vec6] {
        &self.entries[start..]
    }

    /// Appends contiguous columns for rows of two bodies. Each row is given by its Jacobians on A and on B.
    pub(in crate::solver) fn add<'a>(
        &mut self,
        response: &Response,
        (links, batches): (&[Link], &mut Batches),
        bodies: [u32; 2],
        rows: impl Iterator<Item = [&'a Vec6; 2]>,
    ) -> CachedColumns {
        let (start, stride) = (self.end(), CoveredBodies::new(response, links, bodies).len());
        let mut rows = rows.map(|row| (bodies, row));
        loop {
            let (mut some, mut count) = ([(bodies, [&ZERO6; 2]); WIDTH], 0);
            for (place, row) in some.iter_mut().zip(rows.by_ref()) {
                *place = row;
                count += 1;
            }
            if count == 0 {
                return CachedColumns { start, stride };
            }
            self.add_all(response, (links, batches), &some[..count]);
        }
    }

    /// Entries of a column for its two bodies; zero for a body without an entry.
    pub fn ends(&self, column: usize, places: [Option<usize>; 2]) -> [Vec6; 2] {
        places.map(|place| place.map_or(ZERO6, |place| self.entries[column + place]))
    }

    /// Appends the columns of up to eight rows of one or two trees. Returns the index of the first entry and the stride.
    pub(in crate::solver) fn add_all(
        &mut self,
        response: &Response,
        (links, batches): (&[Link], &mut Batches),
        rows: &[([u32; 2], [&Vec6; 2])],
    ) -> (usize, usize) {
        let reach = CoveredBodies::new(response, links, rows[0].0);
        let (start, stride) = (self.end(), reach.len());
        self.entries.resize(start + rows.len() * stride, ZERO6);
        let mut first = start;
        for members in reach.members {
            let Some(&member) = members.first() else { continue };
            let tree = links[member as usize].tree;
            let on = |body: u32, impulse| {
                let link = links.get(body as usize).filter(|link| link.tree == tree);
                link.and_then(|_| response.slot(body)).map(|slot| (slot, impulse))
            };
            let mut pushes = [[None; 2]; WIDTH];
            for (pushes, &([a, b], [on_a, on_b])) in pushes.iter_mut().zip(rows) {
                *pushes = [on(a, on_a), on(b, on_b)];
            }
            let (columns, pushes) = (&mut self.entries[first..], &pushes[..rows.len()]);
            if !batches.answer(tree, pushes, (columns, stride)) {
                let columns = &mut self.entries[first..];
                response.answer_all(links, tree, pushes, (columns, stride), &mut self.lanes);
            }
            first += members.len();
        }
        (start, stride)
    }

    /// Places of the bodies of a row in its column.
    pub fn places(response: &Response, links: &[Link], bodies: [u32; 2]) -> [Option<usize>; 2] {
        CoveredBodies::new(response, links, bodies).places
    }

    /// Rate change of a row by a unit impulse of the column's row; `places` are the indices of its bodies in the column.
    pub fn answer(&self, column: usize, places: [Option<usize>; 2], row: &Row) -> f32 {
        let [a, b] = places.map(|place| place.map(|place| &self.entries[column + place]));
        a.map_or(0.0, |on_a| dot(&row.a, on_a)) + b.map_or(0.0, |on_b| dot(&row.b, on_b))
    }

    /// Adds to the velocities the response to changes of the impulses of rows of one or two trees. Returns the largest change.
    pub fn push_all(
        &self,
        response: &Response,
        links: &[Link],
        bodies: [u32; 2],
        (columns, by): (&[usize; WIDTH], &[f32; WIDTH]),
        velocities: &mut [Vec6],
    ) -> f32 {
        let reach = CoveredBodies::new(response, links, bodies);
        let (mut starts, mut shares, mut count) = ([0; WIDTH], [0.0; WIDTH], 0);
        for (&column, &by) in columns.iter().zip(by).filter(|(_, by)| **by != 0.0) {
            (starts[count], shares[count]) = (column, by);
            count += 1;
        }
        let (entries, starts, by) = (&self.entries[..], &starts[..count], &shares[..count]);
        dispatch::run(PushAll { entries, starts, by, members: reach.members, velocities })
    }

    /// Adds to the velocities the response to changes of the impulses of rows of two bodies.
    pub fn push(
        &self,
        response: &Response,
        links: &[Link],
        bodies: [u32; 2],
        change: &Change,
        velocities: &mut [Vec6],
    ) {
        let reach = CoveredBodies::new(response, links, bodies);
        let (stride, by) = (reach.len(), &change.by[..change.count]);
        let columns = &self.entries[change.column..change.column + by.len() * stride];
        dispatch::run(Push { columns, stride, by, members: reach.members, velocities });
    }
}

/// Adds columns times the changes of their rows to velocities.
struct Push<'a> {
    columns: &'a [Vec6],
    stride: usize,
    by: &'a [f32],
    members: [&'a [u32]; 2],
    velocities: &'a mut [Vec6],
}

impl Kernel for Push<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { columns, stride, by, members, velocities } = self;
        let mut start = 0;
        for members in members {
            let rows = |k: usize| &columns[k * stride + start..][..members.len()];
            match *by {
                [x] => add::<L, 1>(members, [rows(0)], [x], velocities),
                [x, y] => add::<L, 2>(members, [rows(0), rows(1)], [x, y], velocities),
                [x, y, z] => add::<L, 3>(members, [rows(0), rows(1), rows(2)], [x, y, z], velocities),
                [x, y, z, w] => {
                    add::<L, 4>(members, [rows(0), rows(1), rows(2), rows(3)], [x, y, z, w], velocities);
                }
                _ => {}
            }
            start += members.len();
        }
    }
}

/// Adds columns at arbitrary indices times the changes of their rows to velocities.
struct PushAll<'a> {
    entries: &'a [Vec6],
    starts: &'a [usize],
    by: &'a [f32],
    members: [&'a [u32]; 2],
    velocities: &'a mut [Vec6],
}

impl Kernel for PushAll<'_> {
    type Output = f32;

    #[inline(always)]
    fn run<L: Lanes>(self) -> f32 {
        let Self { entries, starts, by, members, velocities } = self;
        let mut most = L::splat(0.0);
        let mut place = 0;
        for members in members {
            for &body in members {
                let mut change = L::splat(0.0);
                for (&start, &by) in starts.iter().zip(by) {
                    change = change + L::load(&entries[start + place]) * L::splat(by);
                }
                let velocity = &mut velocities[body as usize];
                (L::load(velocity) + change).store(velocity);
                most = L::max(most, change.abs());
                place += 1;
            }
        }
        let mut by = ZERO6;
        most.store(&mut by);
        largest(&by)
    }
}

/// Adds `N` columns times changes to the velocities of members.
#[inline(always)]
fn add<L: Lanes, const N: usize>(
    members: &[u32],
    columns: [&[Vec6]; N],
    by: [f32; N],
    velocities: &mut [Vec6],
) {
    let by = by.map(L::splat);
    for (place, &body) in members.iter().enumerate() {
        let velocity = &mut velocities[body as usize];
        let mut sum = L::load(velocity);
        for (column, by) in columns.iter().zip(by) {
            sum = sum + L::load(&column[place]) * by;
        }
        sum.store(velocity);
    }
}
