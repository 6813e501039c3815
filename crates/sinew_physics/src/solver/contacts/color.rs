//! Graph colouring of contacts, to solve them side by side: contacts of one colour share no moving body.

use crate::solver::sweep::policy::Firmness;

/// Number of colours of one round: bits of a mask.
const COLORS: u32 = u64::BITS;
/// Number of block classes, by number of points.
const CLASSES: usize = 3;

/// A contact to be coloured.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    /// Index in the world's contact array.
    pub contact: u32,
    /// Local indices of the bodies.
    pub bodies: [u32; 2],
    /// Class of the contact's block.
    pub class: u32,
    pub firmness: Firmness,
    /// Index of the contact's extra data, or `NONE`; only few contacts have extra data.
    pub extra: u32,
    color: u32,
}

impl Edge {
    pub fn new(contact: u32, bodies: [u32; 2], class: u32, firmness: Firmness, extra: u32) -> Self {
        Self { contact, bodies, class, firmness, extra, color: 0 }
    }
}

/// Work memory of the colouring.
#[derive(Clone, Debug, Default)]
pub(super) struct Coloring {
    pub edges: Vec<Edge>,
    /// Indices of the edges, sorted by colour, class and index.
    sorted: Vec<u32>,
    /// End of each run of one colour and class in `sorted`.
    ends: Vec<usize>,
    /// Colours of each moving body in this round, as bits.
    used: Vec<u64>,
    pending: Vec<u32>,
    left: Vec<u32>,
}

impl Coloring {
    pub fn clear(&mut self) {
        self.edges.clear();
    }

    /// Reserves memory for `bodies` bodies and `edges` edges.
    pub fn make_room(&mut self, bodies: usize, edges: usize) {
        self.edges.clear();
        self.edges.reserve(edges);
        for list in [&mut self.sorted, &mut self.pending, &mut self.left] {
            list.clear();
            list.reserve(edges);
        }
        self.used.clear();
        self.used.reserve(bodies);
        self.ends.clear();
        self.ends.reserve(COLORS as usize * CLASSES);
    }

    /// Colours the edges by first fit in their order, then sorts them by colour and class. Bodies from `moving` on are
    /// fixed. Contacts with fixed bodies get the last colours, so that the sweep corrects them last. Returns the number
    /// of colours.
    pub fn color(&mut self, moving: usize) -> u32 {
        let is_free = |edge: &Edge| edge.bodies.iter().all(|&body| (body as usize) < moving);
        let (count, free) = (self.edges.len() as u32, self.edges.partition_point(is_free) as u32);
        let mut colors = 0;
        for places in [0..free, free..count] {
            colors += self.round(places, moving, colors);
            while !self.left.is_empty() {
                let mut pending = core::mem::take(&mut self.pending);
                core::mem::swap(&mut pending, &mut self.left);
                colors += self.round(pending.iter().copied(), moving, colors);
                self.pending = pending;
            }
        }
        self.sort(colors);
        colors
    }

    /// Sorts the edges by counting; keeps their order within a run.
    fn sort(&mut self, colors: u32) {
        let Self { edges, sorted, ends, .. } = self;
        ends.clear();
        ends.resize(colors as usize * CLASSES, 0);
        for edge in edges.iter() {
            ends[edge.run()] += 1;
        }
        let mut start = 0;
        for end in ends.iter_mut() {
            // `end` is the start of the run until the run is filled.
            start += core::mem::replace(end, start);
        }
        sorted.clear();
        sorted.resize(edges.len(), 0);
        for (place, edge) in edges.iter().enumerate() {
            let end = &mut ends[edge.run()];
            sorted[*end] = place as u32;
            *end += 1;
        }
    }

    /// Assigns colours from `first` on to the edges `places`, up to the number of bits in a mask, and leaves the remaining edges. Returns the
    /// number of colours used.
    fn round(&mut self, places: impl Iterator<Item = u32>, moving: usize, first: u32) -> u32 {
        let Self { edges, used, left, .. } = self;
        used.clear();
        used.resize(moving, 0);
        left.clear();
        let mut count = 0;
        for place in places {
            let edge = &mut edges[place as usize];
            let [a, b] = edge.bodies.map(|body| used.get(body as usize).copied().unwrap_or(0));
            let color = (a | b).trailing_ones();
            if color == COLORS {
                left.push(place);
                continue;
            }
            for &body in &edge.bodies {
                if let Some(used) = used.get_mut(body as usize) {
                    *used |= 1 << color;
                }
            }
            edge.color = first + color;
            count = u32::max(count, color + 1);
        }
        count
    }

    /// Indices of the edges of each colour, class by class.
    pub fn runs(&self) -> impl Iterator<Item = [&[u32]; CLASSES]> {
        self.ends.chunks_exact(CLASSES).scan(0, |start, ends| {
            Some(core::array::from_fn(|class| {
                let from = core::mem::replace(start, ends[class]);
                &self.sorted[from..ends[class]]
            }))
        })
    }
}

impl Edge {
    /// Number of the edge's run, by colour and class.
    fn run(&self) -> usize {
        self.color as usize * CLASSES + self.class as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_math::Random;

    #[test]
    fn edges_of_one_color_share_no_moving_body() {
        let mut random = Random::new(5);
        let mut coloring = Coloring::default();
        for case in 0..200 {
            let (moving, fixed) = (1 + random.index(60), random.index(3));
            coloring.clear();
            for contact in 0..random.index(400) as u32 {
                let a = random.index(moving) as u32;
                // One body is a hub with more contacts than a round has colours.
                let b = if random.unit() < 0.4 { 0 } else { random.index(moving + fixed) as u32 };
                if a != b {
                    let class = random.index(CLASSES) as u32;
                    coloring.edges.push(Edge::new(contact, [a, b], class, Firmness::FREE, u32::MAX));
                }
            }
            coloring.edges.sort_by_key(|edge| edge.bodies.iter().any(|&body| body as usize >= moving));
            let count = coloring.edges.len();
            let colors = coloring.color(moving);
            assert_eq!(coloring.runs().flatten().map(<[u32]>::len).sum::<usize>(), count);
            for (color, runs) in coloring.runs().enumerate() {
                for (class, run) in runs.into_iter().enumerate() {
                    let here = |&place: &u32| {
                        let edge = &coloring.edges[place as usize];
                        (edge.color, edge.class) == (color as u32, class as u32)
                    };
                    assert!(run.iter().all(here) && run.is_sorted(), "case {case}");
                }
            }
            let mut last_moving = 0;
            for color in 0..colors {
                let mut seen = vec![false; moving];
                for edge in coloring.edges.iter().filter(|edge| edge.color == color) {
                    for &body in edge.bodies.iter().filter(|&&body| (body as usize) < moving) {
                        assert!(!core::mem::replace(&mut seen[body as usize], true), "case {case}");
                    }
                    if edge.bodies.iter().all(|&body| (body as usize) < moving) {
                        last_moving = color;
                    }
                }
            }
            for edge in &coloring.edges {
                let is_fixed = edge.bodies.iter().any(|&body| body as usize >= moving);
                assert!(
                    !is_fixed || edge.color > last_moving || last_moving == 0,
                    "case {case}: constraints to fixed bodies must come last"
                );
            }
        }
    }
}
