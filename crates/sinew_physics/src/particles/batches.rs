//! Springs and bends of a net in batches of eight rows that share no particle.
//!
//! Particles are stored in blocks of eight that are far apart in the group: of `8 m` particles the lanes of block `j`
//! are `j`, `m + j`, `2 m + j` and so on. Rows between a particle and the one `o` further on are then **aligned**:
//! eight of them, one in each eighth of the group, connect block `j` to block `j + o`, lane by lane, without a shuffle.
//! In cloth built row by row that covers both threads, both diagonals and all bends. Rows that cross from one eighth
//! into the next connect lanes of block `j` to the next lanes of another block. They are **turned**: the lanes of that
//! block are rotated while they are solved. The remaining rows of irregular meshes are gathered. Consecutive aligned
//! rows share no block, so that none waits for the previous one.
//!
//! A projection moves particles within the iteration. The displacement since the start is stored, which gives the
//! velocity without cancellation. Rows with an attached particle are solved in `net.rs`.

use super::project::Project;
use super::{BendDef, Resists, SpringDef};
use sinew_math::lanes::{Block, WIDTH};
use sinew_math::{Vec3, max};

/// Numbers per particle: position at the start of the iteration, and displacement since, which projections change.
/// Eight particles take three cache lines.
pub(super) const FIELDS: usize = 6;
pub(super) const WAY: usize = 3;
/// Numbers per surface that a particle touches: backing, normal, and room before it presses, which projections change.
pub(super) const SURFACE_FIELDS: usize = 5;
pub(super) const BACKING: usize = 0;
pub(super) const NORMAL: usize = 1;
pub(super) const ROOM: usize = 4;
/// Number of recent kinds that are searched for the kind of eight rows.
const LATEST: usize = 64;
/// Smallest number of aligned rows that form a block.
const LEAST_ALIGNED: usize = 4;
/// Number of open blocks that are tested for a gathered row.
const OPEN: usize = 32;

/// Constants of eight rows, aligned to cache lines. Most rows of a cloth share a few kinds.
#[derive(Clone, Debug, PartialEq)]
#[repr(align(32))]
pub(super) struct Kind<const K: usize> {
    pub rest: [f32; WIDTH],
    /// Compliance, the inverse of the stiffness, m/N.
    pub compliance: [f32; WIDTH],
    /// Damping, N·s/m.
    pub damping: [f32; WIDTH],
    /// Error above which a row acts, metres; infinity in lanes without a row.
    pub least: [f32; WIDTH],
    /// Inverse masses of the particles, 1/kg.
    pub weights: [[f32; WIDTH]; K],
    pub is_damped: bool,
    /// True if the particles of each row have equal weights.
    pub is_even: bool,
}

impl<const K: usize> Kind<K> {
    fn empty() -> Self {
        Self {
            rest: [0.0; WIDTH],
            compliance: [1.0; WIDTH],
            damping: [0.0; WIDTH],
            least: [f32::INFINITY; WIDTH],
            weights: [[0.0; WIDTH]; K],
            is_damped: false,
            is_even: true,
        }
    }

    fn set(&mut self, lane: usize, row: &Row<K>) {
        self.rest[lane] = row.rest;
        self.compliance[lane] = 1.0 / row.stiffness;
        self.damping[lane] = row.damping;
        // A row without a length has no direction.
        self.least[lane] = max(row.least, 1e-9 - row.rest);
        for k in 0..K {
            self.weights[k][lane] = row.weights[k];
        }
        self.is_damped |= row.damping > 0.0;
        self.is_even &= row.weights.iter().all(|weight| *weight == row.weights[0]);
    }
}

/// Rows of `K` particles each, in blocks of eight, each block with the index of its kind.
#[derive(Clone, Debug)]
pub(super) struct Rows<const K: usize> {
    pub aligned: Vec<Run<K>>,
    pub turned: Vec<Run<K>>,
    /// Particle slots of gathered rows, per lane.
    pub gathered: Vec<([[u32; WIDTH]; K], u32)>,
    pub kinds: Vec<Kind<K>>,
}

/// Consecutive aligned or turned rows of one kind that share no block.
#[derive(Clone, Debug)]
pub(super) struct Run<const K: usize> {
    /// Blocks of the particles of the first row.
    pub first: [u32; K],
    /// Lane rotation of each particle relative to the first of its row: zero if aligned.
    pub lanes: [u8; K],
    /// Index of the kind of all rows.
    pub kind: u32,
    pub count: u32,
}

impl<const K: usize> Run<K> {
    /// True if the blocks of each row are consecutive and the rows are contiguous. Otherwise each end of the rows has
    /// its own range of blocks.
    #[inline(always)]
    pub fn is_along(&self) -> bool {
        (1..K).all(|k| self.first[k] == self.first[0] + k as u32)
    }

    /// Blocks of the particles of row number `row`.
    #[inline(always)]
    pub fn places(&self, row: u32) -> [usize; K] {
        self.first.map(|block| (block + self.step() * row) as usize)
    }

    /// Number of blocks between consecutive rows.
    #[inline(always)]
    fn step(&self) -> u32 {
        if self.is_along() { K as u32 } else { 1 }
    }

    /// True if the single row `next` continues this run.
    fn goes_on(&self, next: &Self) -> bool {
        let follows = (0..K).all(|k| next.first[k] == self.first[k] + self.step() * self.count);
        let meets = |k: usize| (0..k).any(|j| self.first[k].abs_diff(self.first[j]) <= self.count);
        let is_like = (next.lanes, next.kind) == (self.lanes, self.kind);
        is_like && follows && (self.is_along() || !(1..K).any(meets))
    }
}

impl<const K: usize> Default for Rows<K> {
    fn default() -> Self {
        Self { aligned: Vec::new(), turned: Vec::new(), gathered: Vec::new(), kinds: Vec::new() }
    }
}

impl<const K: usize> Rows<K> {
    fn is_empty(&self) -> bool {
        self.aligned.is_empty() && self.turned.is_empty() && self.gathered.is_empty()
    }

    /// Returns the index of a kind; reuses one of the latest if equal.
    fn kind(&mut self, kind: Kind<K>) -> u32 {
        let latest = self.kinds.iter().rev().take(LATEST).position(|other| *other == kind);
        let index = latest.map_or(self.kinds.len(), |back| self.kinds.len() - 1 - back);
        if latest.is_none() {
            self.kinds.push(kind);
        }
        index as u32
    }
}

/// A row of the definition.
#[derive(Clone, Copy, Debug)]
struct Row<const K: usize> {
    particles: [u32; K],
    /// Inverse masses of the particles, 1/kg.
    weights: [f32; K],
    rest: f32,
    stiffness: f32,
    damping: f32,
    least: f32,
}

/// Rows of a group that are solved eight at a time, and its particles in the same layout.
#[derive(Clone, Debug, Default)]
pub(super) struct Batches {
    pub springs: Rows<2>,
    pub bends: Rows<3>,
    /// Blocks of the particles, and a block for lanes without a row.
    pub particles: Vec<Block<FIELDS>>,
    /// Surfaces that the particles touch, in the same layout.
    pub surfaces: Vec<Block<SURFACE_FIELDS>>,
    /// Number of particles, and number of particles per lane (`per_lane`).
    count: usize,
    per_lane: usize,
}

impl Batches {
    /// Creates batches of rows without attached particles, for particles of these masses, kg.
    pub fn new(
        masses: &[f32],
        springs: impl Iterator<Item = SpringDef>,
        bends: impl Iterator<Item = BendDef>,
    ) -> Self {
        let (count, per_lane) = (masses.len(), masses.len().div_ceil(WIDTH));
        let weight = |i: u32| 1.0 / masses[i as usize];
        let springs = springs.map(|s| Row {
            particles: [s.a, s.b],
            weights: [s.a, s.b].map(weight),
            rest: s.rest_length,
            stiffness: s.stiffness,
            damping: s.damping,
            least: if s.resists == Resists::Stretch { 0.0 } else { f32::NEG_INFINITY },
        });
        let bends = bends.map(|b| Row {
            particles: b.particles,
            weights: b.particles.map(weight),
            rest: b.rest,
            stiffness: b.stiffness,
            damping: 0.0,
            least: f32::NEG_INFINITY,
        });
        let (springs, bends) = (arrange(springs, per_lane), arrange(bends, per_lane));
        let blocks = if springs.is_empty() && bends.is_empty() { 0 } else { per_lane + 1 };
        let particles = vec![Block::splat([0.0; FIELDS]); blocks];
        let surfaces = vec![Block::splat([0.0; SURFACE_FIELDS]); blocks];
        Self { springs, bends, particles, surfaces, count, per_lane }
    }

    /// True if there are no rows.
    pub fn is_empty(&self) -> bool {
        self.particles.is_empty()
    }

    /// Loads all particles: positions at the start of an iteration of `h` seconds, and displacements at `velocities`.
    pub fn put(&mut self, from: &[Vec3], velocities: &[Vec3], h: f32) {
        let lanes = from.chunks(self.per_lane).zip(velocities.chunks(self.per_lane));
        for (lane, (from, velocities)) in lanes.enumerate() {
            let numbers = from.iter().zip(velocities);
            for (Block(block), (from, velocity)) in self.particles.iter_mut().zip(numbers) {
                block[0][lane] = from.x;
                block[1][lane] = from.y;
                block[2][lane] = from.z;
                block[WAY][lane] = velocity.x * h;
                block[WAY + 1][lane] = velocity.y * h;
                block[WAY + 2][lane] = velocity.z * h;
            }
        }
    }

    /// Loads a particle's position at the start of the iteration, and its displacement since, metres.
    pub fn put_way(&mut self, i: usize, from: Vec3, way: Vec3) {
        let (block, lane) = (&mut self.particles[i % self.per_lane].0, i / self.per_lane);
        let numbers = [from.x, from.y, from.z, way.x, way.y, way.z];
        for (field, number) in numbers.into_iter().enumerate() {
            block[field][lane] = number;
        }
    }

    /// Returns field number `field` of a particle.
    pub fn number_of(&self, i: usize, field: usize) -> f32 {
        self.particles[i % self.per_lane].0[field][i / self.per_lane]
    }

    /// Returns a vector of a particle that starts at field `field`.
    pub fn vector_of(&self, i: usize, field: usize) -> Vec3 {
        Vec3::new(self.number_of(i, field), self.number_of(i, field + 1), self.number_of(i, field + 2))
    }

    /// Loads the surface that a particle touches. `room` is the impulse toward the surface times the iteration, N·s²,
    /// beyond which the particle presses.
    pub fn put_surface(&mut self, i: usize, normal: Vec3, backing: f32, room: f32) {
        let (block, lane) = (&mut self.surfaces[i % self.per_lane].0, i / self.per_lane);
        for (field, number) in [backing, normal.x, normal.y, normal.z, room].into_iter().enumerate() {
            block[field][lane] = number;
        }
    }

    /// Passes each particle's index and displacement since the start of the iteration, metres, to `tell`.
    pub fn ways(&self, mut tell: impl FnMut(usize, Vec3)) {
        let mut i = 0;
        for lane in 0..WIDTH {
            for Block(block) in &self.particles[..usize::min(self.per_lane, self.count - i)] {
                tell(i, Vec3::new(block[WAY][lane], block[WAY + 1][lane], block[WAY + 2][lane]));
                i += 1;
            }
        }
    }

    /// Clears the surface that a particle touches; returns its remaining room, N·s², negative if it presses.
    pub fn take_surface(&mut self, i: usize) -> f32 {
        let (block, lane) = (&mut self.surfaces[i % self.per_lane].0, i / self.per_lane);
        block[BACKING][lane] = 0.0;
        block[ROOM][lane]
    }

    /// Kernel that projects all rows once, springs first; run it through `dispatch`.
    pub fn project(&mut self, h: f32, touching: bool) -> Project<'_> {
        Project { batches: self, h, touching }
    }
}

/// Puts aligned and turned rows in blocks by the index distance of their particles, then the other rows.
fn arrange<const K: usize>(rows: impl Iterator<Item = Row<K>>, per_lane: usize) -> Rows<K> {
    let mut keyed: Vec<([i64; K], u32, usize, usize, Row<K>)> = Vec::new();
    let mut others = Vec::new();
    for (order, row) in rows.enumerate() {
        let places = row.particles.map(|i| i as usize);
        let blocks = places.map(|place| place % per_lane);
        if (1..K).any(|k| blocks[..k].contains(&blocks[k])) {
            others.push(row);
            continue;
        }
        let mut steps = [0; K];
        for k in 1..K {
            steps[k] = places[k] as i64 - places[k - 1] as i64;
        }
        let block = blocks[0];
        // Consecutive rows along a thread of cloth would wait for each other.
        let color = if steps[1].abs() == 1 { block % K } else { 0 };
        keyed.push((steps, color as u32, block, order, row));
    }
    keyed.sort_by_key(|&(steps, color, block, order, _)| (steps, color, block, order));
    let mut rows = Rows::default();
    for aligned in keyed.chunk_by(|p, q| (p.0, p.2) == (q.0, q.2)) {
        if aligned.len() < LEAST_ALIGNED {
            others.extend(aligned.iter().map(|entry| entry.4));
            continue;
        }
        let mut kind = Kind::empty();
        let places = aligned[0].4.particles.map(|i| i as usize);
        let blocks = places.map(|place| (place % per_lane) as u32);
        let lanes = places.map(|place| ((WIDTH + place / per_lane - places[0] / per_lane) % WIDTH) as u8);
        for &(.., row) in aligned {
            let lane = row.particles[0] as usize / per_lane;
            if kind.least[lane] == f32::INFINITY {
                kind.set(lane, &row);
            } else {
                others.push(row);
            }
        }
        let kind = rows.kind(kind);
        let runs = if lanes == [0; K] { &mut rows.aligned } else { &mut rows.turned };
        let next = Run { first: blocks, lanes, kind, count: 1 };
        match runs.last_mut().filter(|run| run.goes_on(&next)) {
            Some(run) => run.count += 1,
            None => runs.push(next),
        }
    }
    gather(&others, per_lane, &mut rows);
    rows
}

/// Fills blocks of rows that share no particle: each row goes into the first block with space for it.
fn gather<const K: usize>(rows: &[Row<K>], per_lane: usize, out: &mut Rows<K>) {
    let mut open: Vec<Vec<Row<K>>> = Vec::new();
    for &row in rows {
        let meets = |other: &Row<K>| other.particles.iter().any(|i| row.particles.contains(i));
        match open.iter().position(|block| !block.iter().any(meets)) {
            Some(at) => open[at].push(row),
            None => open.push(vec![row]),
        }
        if let Some(full) = open.iter().position(|block| block.len() == WIDTH) {
            push_gathered(&open.remove(full), per_lane, out);
        } else if open.len() > OPEN {
            push_gathered(&open.remove(0), per_lane, out);
        }
    }
    for block in &open {
        push_gathered(block, per_lane, out);
    }
}

fn push_gathered<const K: usize>(block: &[Row<K>], per_lane: usize, out: &mut Rows<K>) {
    let mut kind = Kind::empty();
    // Lanes without a row use a dummy particle after all real particles.
    let mut slots = [core::array::from_fn(|lane| (per_lane * WIDTH + lane) as u32); K];
    for (lane, row) in block.iter().enumerate() {
        kind.set(lane, row);
        for (slot, &i) in slots.iter_mut().zip(&row.particles) {
            slot[lane] = (i as usize % per_lane * WIDTH + i as usize / per_lane) as u32;
        }
    }
    let kind = out.kind(kind);
    out.gathered.push((slots, kind));
}
