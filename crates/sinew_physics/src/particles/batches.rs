//! Springs and bends of a net, eight side by side: rows that share no particle.
//!
//! Particles lie in blocks of eight that are far apart in the group: of `8 m` the lanes of block `j` are `j`, `m + j`, `2 m + j` and so
//! on. Rows that join a particle to the one `o` further on are then **aligned**: eight of them, one in each eighth of the group, join
//! block `j` to block `j + o`, lane by lane, without a shuffle. In cloth that is made row by row that holds for both threads,
//! both diagonals and all bends. Rows that cross from one eighth into the next join lanes of block `j` to the next lanes of another: they are **turned**, that is the
//! lanes of this one move up while they are solved. What irregular meshes have beside these is gathered. Aligned rows that follow each other share no block either, so that none waits for the one before.
//!
//! A projection moves particles within the iteration: what is kept is how far each has come since it began, which gives the velocity
//! without cancellation. Rows that hold an attached particle are left to `net.rs`.

use super::{BendDef, Resists, SpringDef};
use sinew_math::Vec3;
use sinew_math::dispatch::Kernel;
use sinew_math::lanes::{Block, LaneMask, Lanes, Vector3, WIDTH};

/// Numbers of a particle: position when the iteration began, way since, weight, backing of the surface that it touches, normal of that, room
/// before it presses.
pub(super) const FIELDS: usize = 12;
pub(super) const WAY: usize = 3;
pub(super) const WEIGHT: usize = 6;
pub(super) const BACKING: usize = 7;
pub(super) const NORMAL: usize = 8;
pub(super) const ROOM: usize = 11;
/// Fields that projections change.
const CHANGED: [usize; 4] = [WAY, WAY + 1, WAY + 2, ROOM];
/// Shares of a spring's ends in the vector whose length it keeps.
const SPRING: [f32; 2] = [-1.0, 1.0];
/// Shares of a bend's particles in the vector whose length it keeps.
const BEND: [f32; 3] = [1.0, -2.0, 1.0];
/// Kinds among which that of eight rows is looked for.
const LATEST: usize = 64;
/// Fewest aligned rows that make a block.
const LEAST_ALIGNED: usize = 4;
/// Blocks that a row to be gathered may still go into.
const OPEN: usize = 32;

/// Constants of eight rows, none across two lines of the cache. Few kinds serve most rows of a cloth, so that they stay in the first cache.
#[derive(Clone, Debug, PartialEq)]
#[repr(align(32))]
struct Kind {
    rest: [f32; WIDTH],
    /// Compliance: 1 over the stiffness, m/N.
    compliance: [f32; WIDTH],
    /// N·s/m.
    damping: [f32; WIDTH],
    /// Least error that a row resists: minus infinity if all, infinity in lanes without a row.
    least: [f32; WIDTH],
    is_damped: bool,
}

impl Kind {
    fn empty() -> Self {
        Self {
            rest: [0.0; WIDTH],
            compliance: [1.0; WIDTH],
            damping: [0.0; WIDTH],
            least: [f32::INFINITY; WIDTH],
            is_damped: false,
        }
    }

    fn set<const K: usize>(&mut self, lane: usize, row: &Row<K>) {
        self.rest[lane] = row.rest;
        self.compliance[lane] = 1.0 / row.stiffness;
        self.damping[lane] = row.damping;
        self.least[lane] = row.least;
        self.is_damped |= row.damping > 0.0;
    }
}

/// Rows of `K` particles each, eight by eight, each with the index of its kind.
#[derive(Clone, Debug)]
struct Rows<const K: usize> {
    aligned: Vec<Run<K>>,
    /// Kinds of aligned rows, run by run.
    aligned_kinds: Vec<u32>,
    /// Blocks of the particles of turned rows, and by how many lanes each lies above that of the first particle.
    turned: Vec<([u32; K], [u8; K], u32)>,
    /// Slots of the particles of rows that are gathered, of each lane.
    gathered: Vec<([[u32; WIDTH]; K], u32)>,
    kinds: Vec<Kind>,
}

/// Aligned rows, one after the other, that share no block.
#[derive(Clone, Debug)]
struct Run<const K: usize> {
    /// Blocks of the particles of the first.
    first: [u32; K],
    count: u32,
}

impl<const K: usize> Run<K> {
    /// True if the blocks of each row follow each other, and those of the next these. Else each end has a stretch of blocks for itself.
    fn is_along(&self) -> bool {
        (1..K).all(|k| self.first[k] == self.first[0] + k as u32)
    }

    /// True if a row in these blocks continues it.
    fn goes_on(&self, blocks: &[u32; K]) -> bool {
        let step = if self.is_along() { K as u32 } else { 1 };
        let follows = (0..K).all(|k| blocks[k] == self.first[k] + step * self.count);
        let meets = |k: usize| (0..k).any(|j| self.first[k].abs_diff(self.first[j]) <= self.count);
        follows && (self.is_along() || !(1..K).any(meets))
    }
}

impl<const K: usize> Default for Rows<K> {
    fn default() -> Self {
        Self {
            aligned: Vec::new(),
            aligned_kinds: Vec::new(),
            turned: Vec::new(),
            gathered: Vec::new(),
            kinds: Vec::new(),
        }
    }
}

impl<const K: usize> Rows<K> {
    fn is_empty(&self) -> bool {
        self.aligned.is_empty() && self.turned.is_empty() && self.gathered.is_empty()
    }

    /// Index of a kind, among the latest if it is there.
    fn kind(&mut self, kind: Kind) -> u32 {
        let latest = self.kinds.iter().rev().take(LATEST).position(|other| *other == kind);
        let index = latest.map_or(self.kinds.len(), |back| self.kinds.len() - 1 - back);
        if latest.is_none() {
            self.kinds.push(kind);
        }
        index as u32
    }
}

/// A row as it is defined.
#[derive(Clone, Copy, Debug)]
struct Row<const K: usize> {
    particles: [u32; K],
    rest: f32,
    stiffness: f32,
    damping: f32,
    least: f32,
}

/// The rows of a group that are solved eight at a time, and its particles as they need them.
#[derive(Clone, Debug, Default)]
pub(super) struct Batches {
    springs: Rows<2>,
    bends: Rows<3>,
    /// Particles, and a block for lanes without a row.
    pub particles: Vec<Block<FIELDS>>,
    /// Number of particles, and of those in a lane.
    count: usize,
    per_lane: usize,
}

impl Batches {
    /// Batches of rows that hold no attached particle, for a group of so many.
    pub fn new(
        count: usize,
        springs: impl Iterator<Item = SpringDef>,
        bends: impl Iterator<Item = BendDef>,
    ) -> Self {
        let per_lane = count.div_ceil(WIDTH);
        let springs = springs.map(|s| Row {
            particles: [s.a, s.b],
            rest: s.rest_length,
            stiffness: s.stiffness,
            damping: s.damping,
            least: if s.resists == Resists::Stretch { 0.0 } else { f32::NEG_INFINITY },
        });
        let bends = bends.map(|b| Row {
            particles: b.particles,
            rest: b.rest,
            stiffness: b.stiffness,
            damping: 0.0,
            least: f32::NEG_INFINITY,
        });
        let (springs, bends) = (arrange(springs, per_lane), arrange(bends, per_lane));
        let blocks = if springs.is_empty() && bends.is_empty() { 0 } else { per_lane + 1 };
        Self { springs, bends, particles: vec![Block::splat([0.0; FIELDS]); blocks], count, per_lane }
    }

    /// True if there are no rows.
    pub fn is_empty(&self) -> bool {
        self.particles.is_empty()
    }

    /// Takes in all particles: where they were when an iteration of `h` seconds began, their velocities since, and their weights.
    pub fn put(&mut self, from: &[Vec3], velocities: &[Vec3], weights: &[f32], h: f32) {
        let lanes = from.chunks(self.per_lane).zip(velocities.chunks(self.per_lane));
        for (lane, ((from, velocities), weights)) in lanes.zip(weights.chunks(self.per_lane)).enumerate() {
            let numbers = from.iter().zip(velocities).zip(weights);
            for (Block(block), ((from, velocity), weight)) in self.particles.iter_mut().zip(numbers) {
                block[0][lane] = from.x;
                block[1][lane] = from.y;
                block[2][lane] = from.z;
                block[WAY][lane] = velocity.x * h;
                block[WAY + 1][lane] = velocity.y * h;
                block[WAY + 2][lane] = velocity.z * h;
                block[WEIGHT][lane] = *weight;
            }
        }
    }

    /// Takes in where a particle was when the iteration began, how far it has come since, and its weight.
    pub fn put_way(&mut self, i: usize, from: Vec3, way: Vec3, weight: f32) {
        let (block, lane) = (&mut self.particles[i % self.per_lane].0, i / self.per_lane);
        let numbers = [from.x, from.y, from.z, way.x, way.y, way.z, weight];
        for (field, number) in numbers.into_iter().enumerate() {
            block[field][lane] = number;
        }
    }

    /// A number of a particle.
    pub fn number_of(&self, i: usize, field: usize) -> f32 {
        self.particles[i % self.per_lane].0[field][i / self.per_lane]
    }

    /// A vector of a particle, by the first of its fields.
    pub fn vector_of(&self, i: usize, field: usize) -> Vec3 {
        Vec3::new(self.number_of(i, field), self.number_of(i, field + 1), self.number_of(i, field + 2))
    }

    /// Takes in the surface that a particle touches, with the impulse onto it after which it presses, N·s².
    pub fn put_surface(&mut self, i: usize, normal: Vec3, backing: f32, room: f32) {
        let (block, lane) = (&mut self.particles[i % self.per_lane].0, i / self.per_lane);
        for (field, number) in [backing, normal.x, normal.y, normal.z, room].into_iter().enumerate() {
            block[BACKING + field][lane] = number;
        }
    }

    /// Tells of each particle how far it has come since the iteration began, metres.
    pub fn ways(&self, mut tell: impl FnMut(usize, Vec3)) {
        let mut i = 0;
        for lane in 0..WIDTH {
            for Block(block) in &self.particles[..usize::min(self.per_lane, self.count - i)] {
                tell(i, Vec3::new(block[WAY][lane], block[WAY + 1][lane], block[WAY + 2][lane]));
                i += 1;
            }
        }
    }

    /// Forgets the surface that a particle touches; gives the room that is left, N·s², negative for what presses.
    pub fn take_surface(&mut self, i: usize) -> f32 {
        let (block, lane) = (&mut self.particles[i % self.per_lane].0, i / self.per_lane);
        block[BACKING][lane] = 0.0;
        block[ROOM][lane]
    }

    /// Projects all rows once, springs first, to be run by `dispatch`.
    pub fn project(&mut self, h: f32, touching: bool) -> Project<'_> {
        Project { batches: self, h, touching }
    }
}

/// Aligned and turned rows in blocks by how far apart their particles are, then the others.
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
        // Neighbours of a thread along which the blocks lie would wait for each other.
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
        if lanes == [0; K] {
            match rows.aligned.last_mut().filter(|run| run.goes_on(&blocks)) {
                Some(run) => run.count += 1,
                None => rows.aligned.push(Run { first: blocks, count: 1 }),
            }
            rows.aligned_kinds.push(kind);
        } else {
            rows.turned.push((blocks, lanes, kind));
        }
    }
    gather(&others, per_lane, &mut rows);
    rows
}

/// Blocks of rows that share no particle: each row goes into the first that has room for it.
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
    // Lanes without a row have a place of their own, after all particles.
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

/// Projects each row once.
pub(super) struct Project<'a> {
    batches: &'a mut Batches,
    /// The iteration, seconds.
    h: f32,
    /// Some particle touches a surface.
    touching: bool,
}

impl Kernel for Project<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { batches: Batches { springs, bends, particles, .. }, h, touching } = self;
        let times = (L::splat(h), L::splat(1.0 / (h * h)));
        project_all::<L, 2>(particles, springs, SPRING, times, touching);
        project_all::<L, 3>(particles, bends, BEND, times, touching);
    }
}

/// Projects each row of a kind once.
#[inline(always)]
fn project_all<L: Lanes, const K: usize>(
    particles: &mut [Block<FIELDS>],
    rows: &Rows<K>,
    shares: [f32; K],
    times: (L, L),
    touching: bool,
) {
    let mut kinds = rows.aligned_kinds.iter().map(|kind| &rows.kinds[*kind as usize]);
    for run in &rows.aligned {
        let (first, count) = (run.first.map(|block| block as usize), run.count as usize);
        if run.is_along() {
            let rows = particles[first[0]..][..K * count].as_chunks_mut::<K>().0;
            for (ends, kind) in rows.iter_mut().zip(&mut kinds) {
                let mut ends = ends.each_mut().map(|Block(numbers)| numbers);
                project::<L, K>(&mut ends, kind, shares, times, touching);
            }
        } else if let Ok(mut sides) = particles.get_disjoint_mut(first.map(|block| block..block + count)) {
            for (row, kind) in (0..count).zip(&mut kinds) {
                let mut ends = sides.each_mut().map(|side| &mut side[row].0);
                project::<L, K>(&mut ends, kind, shares, times, touching);
            }
        }
    }
    for (places, lanes, kind) in &rows.turned {
        let mut ends = turned::<L, K>(particles, places, lanes);
        project::<L, K>(&mut ends.each_mut(), &rows.kinds[*kind as usize], shares, times, touching);
        turn_back::<L, K>(particles, places, lanes, &ends);
    }
    for (slots, kind) in &rows.gathered {
        let mut ends = fetch(particles, slots);
        project::<L, K>(&mut ends.each_mut(), &rows.kinds[*kind as usize], shares, times, touching);
        put_back(particles, slots, &ends);
    }
}

/// Numbers of eight particles.
type Numbers = [[f32; WIDTH]; FIELDS];

/// Copies of blocks, each turned so that its lanes meet those of the first.
#[inline(always)]
fn turned<L: Lanes, const K: usize>(
    particles: &[Block<FIELDS>],
    places: &[u32; K],
    lanes: &[u8; K],
) -> [Numbers; K] {
    let mut ends = [[[0.0; WIDTH]; FIELDS]; K];
    for k in 0..K {
        let Block(from) = &particles[places[k] as usize];
        for field in 0..FIELDS {
            L::load(&from[field]).turn(usize::from(lanes[k])).store(&mut ends[k][field]);
        }
    }
    ends
}

/// Writes what has changed of these: nothing in lanes without a row.
#[inline(always)]
fn turn_back<L: Lanes, const K: usize>(
    particles: &mut [Block<FIELDS>],
    places: &[u32; K],
    lanes: &[u8; K],
    ends: &[Numbers; K],
) {
    for k in 0..K {
        let Block(to) = &mut particles[places[k] as usize];
        for field in CHANGED {
            L::load(&ends[k][field]).turn((WIDTH - usize::from(lanes[k])) % WIDTH).store(&mut to[field]);
        }
    }
}

/// Copies of particles that each have their block and lane.
#[inline(always)]
fn fetch<const K: usize>(particles: &[Block<FIELDS>], slots: &[[u32; WIDTH]; K]) -> [Numbers; K] {
    let mut ends = [[[0.0; WIDTH]; FIELDS]; K];
    for k in 0..K {
        for lane in 0..WIDTH {
            let slot = slots[k][lane] as usize;
            let Block(from) = &particles[slot / WIDTH];
            for field in 0..FIELDS {
                ends[k][field][lane] = from[field][slot % WIDTH];
            }
        }
    }
    ends
}

/// Writes what has changed of these.
#[inline(always)]
fn put_back<const K: usize>(particles: &mut [Block<FIELDS>], slots: &[[u32; WIDTH]; K], ends: &[Numbers; K]) {
    for k in 0..K {
        for lane in 0..WIDTH {
            let slot = slots[k][lane] as usize;
            let Block(to) = &mut particles[slot / WIDTH];
            for field in CHANGED {
                to[field][slot % WIDTH] = ends[k][field][lane];
            }
        }
    }
}

/// A vector of eight particles, from its first field.
#[inline(always)]
fn vector<L: Lanes>(numbers: &Numbers, field: usize) -> Vector3<L> {
    Vector3::load(&numbers[field], &numbers[field + 1], &numbers[field + 2])
}

/// The vector of eight rows: that of their ends, from its first field, by their shares.
#[inline(always)]
fn combined<L: Lanes, const K: usize>(
    ends: &[&mut Numbers; K],
    shares: [f32; K],
    field: usize,
) -> Vector3<L> {
    let mut sum = vector::<L>(ends[0], field) * L::splat(shares[0]);
    for k in 1..K {
        sum = sum + vector::<L>(ends[k], field) * L::splat(shares[k]);
    }
    sum
}

/// True if a particle of the rows touches a surface.
#[inline(always)]
fn any_touching<L: Lanes, const K: usize>(ends: &[&mut Numbers; K]) -> bool {
    let mut most = L::load(&ends[0][BACKING]);
    for k in 1..K {
        most = L::max(most, L::load(&ends[k][BACKING]));
    }
    L::gt(most, L::splat(0.0)).any()
}

/// The surface at one end of eight rows, as a pull on it sees it.
#[derive(Clone, Copy, Debug)]
struct Surface<L> {
    /// Room before it presses, N·s².
    room: L,
    /// Room that the end gains for each unit of the pull.
    gain: L,
    /// Loss of the row by each N·s² that presses and goes on to the body, in units of its error.
    passed: L,
    /// Loss by each unit of a pull that presses all the way.
    lacking: L,
}

impl<L: Lanes> Surface<L> {
    /// For a pull of the end against the vector of its row, with its share in that.
    #[inline(always)]
    fn load(end: &Numbers, apart: Vector3<L>, share: f32) -> Self {
        let gain = apart.dot(vector(end, NORMAL)) * L::splat(-share);
        let passed = L::load(&end[BACKING]) * L::load(&end[WEIGHT]) * gain;
        Self { room: L::load(&end[ROOM]), gain, passed, lacking: passed * gain }
    }
}

/// The error and slope whose quotient is the pull of eight rows. What a pull mends, `slope` for each unit of it without surfaces, changes where a
/// particle comes to press and where it ceases to. Which do is seen by the slope with which the pull begins: one change is met exactly, as by
/// two steps of Newton's method.
#[inline(always)]
fn on_surfaces<L: Lanes, const K: usize>(surfaces: &[Surface<L>; K], error: L, slope: L) -> (L, L) {
    let zero = L::splat(0.0);
    let mut first = slope;
    for s in surfaces {
        // One that has no room left presses if it is pulled onto the surface.
        let brink = L::splat(f32::MIN_POSITIVE).masked(L::lt(s.gain * error, zero));
        first = first - s.lacking.masked(L::lt(s.room, brink));
    }
    let (mut error_left, mut last) = (error, slope);
    for s in surfaces {
        let presses = L::lt(s.room * first + s.gain * error, zero);
        last = last - s.lacking.masked(presses);
        // The part of the pull in which it was not yet so.
        error_left = error_left + s.passed * L::max(L::select(presses, s.room, -s.room), zero);
    }
    (error_left, last)
}

/// Solves eight rows. What their ends make together, by their shares, is the vector whose length is their error and rest. Pulls are counted
/// in this vector, not in its direction, and errors in squares: one division is left.
#[inline(always)]
fn project<L: Lanes, const K: usize>(
    ends: &mut [&mut Numbers; K],
    kind: &Kind,
    shares: [f32; K],
    (h, per_square): (L, L),
    touching: bool,
) {
    let zero = L::splat(0.0);
    let apart = combined::<L, K>(ends, shares, 0) + combined::<L, K>(ends, shares, WAY);
    let square = apart.dot(apart);
    let length = square.sqrt();
    let off = length - L::load(&kind.rest);
    let active = L::gt(off, L::load(&kind.least)) & L::gt(length, L::splat(1e-9));
    let compliance = L::load(&kind.compliance) * per_square;
    let mut most = L::load(&ends[0][WEIGHT]) * L::splat(shares[0] * shares[0]);
    for k in 1..K {
        most = most + L::load(&ends[k][WEIGHT]) * L::splat(shares[k] * shares[k]);
    }
    let (error, slope) = (off * length, square * (most + compliance));
    if !(touching && any_touching::<L, K>(ends)) {
        let mut pull = error / slope;
        if kind.is_damped {
            let way = apart.dot(combined::<L, K>(ends, shares, WAY));
            pull = damped(pull, way, (square * most, square), h * L::load(&kind.damping));
        }
        // Rows without an error, a direction or anything that moves do nothing.
        let pull = pull.masked(active & L::gt(slope, zero));
        for k in 0..K {
            let by = pull * L::splat(-shares[k]) * L::load(&ends[k][WEIGHT]);
            store(vector::<L>(ends[k], WAY) + apart * by, ends[k]);
        }
        return;
    }
    let mut surfaces = [Surface::load(ends[0], apart, shares[0]); K];
    for k in 1..K {
        surfaces[k] = Surface::load(ends[k], apart, shares[k]);
    }
    let (error, slope) = on_surfaces(&surfaces, error, slope);
    let mut pull = error / slope;
    if kind.is_damped {
        let way = apart.dot(combined::<L, K>(ends, shares, WAY));
        pull = damped(pull, way, (slope - square * compliance, square), h * L::load(&kind.damping));
    }
    let pull = pull.masked(active & L::gt(slope, zero));
    for k in 0..K {
        let Surface { room, gain, .. } = surfaces[k];
        let after = room + gain * pull;
        let weight = L::load(&ends[k][WEIGHT]);
        let kept = L::load(&ends[k][BACKING]) * weight * (L::min(after, zero) - L::min(room, zero));
        let by = pull * L::splat(-shares[k]) * weight;
        store(vector::<L>(ends[k], WAY) + apart * by - vector::<L>(ends[k], NORMAL) * kept, ends[k]);
        after.store(&mut ends[k][ROOM]);
    }
}

#[inline(always)]
fn store<L: Lanes>(way: Vector3<L>, end: &mut Numbers) {
    way.x.store(&mut end[WAY]);
    way.y.store(&mut end[WAY + 1]);
    way.z.store(&mut end[WAY + 2]);
}

/// A pull with that which damps the speed that it leaves. The way of the row along itself and its mobility are given times its length and its square,
/// which comes last.
#[inline(always)]
fn damped<L: Lanes>(pull: L, way: L, (mobility, square): (L, L), damping: L) -> L {
    pull + (way - pull * mobility) * damping / (square + damping * mobility)
}
