//! Springs and bends of a net, eight side by side: rows that share no particle.
//!
//! Particles lie in blocks of eight that are far apart in the group: of `8 m` the lanes of block `j` are `j`, `m + j`, `2 m + j` and so
//! on. Rows that join a particle to the one `o` further on are then **aligned**: eight of them, one in each eighth of the group, join
//! block `j` to block `j + o`, lane by lane, without a shuffle. In cloth that is made row by row that holds for both threads,
//! both diagonals and all bends, but for those that cross from one eighth into the next. Those, and what irregular meshes
//! have, are gathered. Aligned rows that follow each other share no block either, so that none waits for the one before.
//!
//! A projection moves particles within the iteration: what is kept is how far each has come since it began, which gives the velocity
//! without cancellation. Rows that hold an attached particle are left to `net.rs`.

use super::{BendDef, Resists, SpringDef};
use sinew_math::Vec3;
use sinew_math::dispatch::Kernel;
use sinew_math::lanes::{Block, LaneMask, Lanes, Vector3, WIDTH};

/// Numbers of a particle: position when the iteration began, way since, weight, backing of the surface that it touches, normal of that, room
/// before it presses.
const FIELDS: usize = 12;
const WAY: usize = 3;
const WEIGHT: usize = 6;
const BACKING: usize = 7;
const NORMAL: usize = 8;
const ROOM: usize = 11;
/// Fewest aligned rows that make a block.
const LEAST_ALIGNED: usize = 4;
/// Blocks that a row to be gathered may still go into.
const OPEN: usize = 32;

/// Eight rows of `K` particles each.
#[derive(Clone, Debug)]
struct Rows<const K: usize> {
    /// Blocks of the particles of aligned rows.
    blocks: [u32; K],
    /// Slots of the particles of rows that are gathered, of each lane.
    slots: Option<[[u32; WIDTH]; K]>,
    rest: [f32; WIDTH],
    /// Compliance: 1 over the stiffness, m/N.
    compliance: [f32; WIDTH],
    /// N·s/m.
    damping: [f32; WIDTH],
    /// Least error that a row resists: minus infinity if all, infinity in lanes without a row.
    least: [f32; WIDTH],
    is_damped: bool,
}

impl<const K: usize> Rows<K> {
    fn empty() -> Self {
        Self {
            blocks: [0; K],
            slots: None,
            rest: [0.0; WIDTH],
            compliance: [1.0; WIDTH],
            damping: [0.0; WIDTH],
            least: [f32::INFINITY; WIDTH],
            is_damped: false,
        }
    }

    fn set(&mut self, lane: usize, row: &Row<K>) {
        self.rest[lane] = row.rest;
        self.compliance[lane] = 1.0 / row.stiffness;
        self.damping[lane] = row.damping;
        self.least[lane] = row.least;
        self.is_damped |= row.damping > 0.0;
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
    springs: Vec<Rows<2>>,
    bends: Vec<Rows<3>>,
    /// Particles, and a block for lanes without a row.
    particles: Vec<Block<FIELDS>>,
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

/// Aligned rows in blocks by how far apart their particles are, then the others.
fn arrange<const K: usize>(rows: impl Iterator<Item = Row<K>>, per_lane: usize) -> Vec<Rows<K>> {
    let mut keyed: Vec<([i64; K], u32, usize, usize, Row<K>)> = Vec::new();
    let mut others = Vec::new();
    for (order, row) in rows.enumerate() {
        let places = row.particles.map(|i| i as usize);
        let lane = places[0] / per_lane;
        if places.iter().any(|place| place / per_lane != lane) {
            others.push(row);
            continue;
        }
        let mut steps = [0; K];
        for k in 1..K {
            steps[k] = places[k] as i64 - places[k - 1] as i64;
        }
        let block = places[0] % per_lane;
        // Neighbours of a thread along which the blocks lie would wait for each other.
        let turn = if steps[1].abs() == 1 { block % K } else { 0 };
        keyed.push((steps, turn as u32, block, order, row));
    }
    keyed.sort_by_key(|&(steps, turn, block, order, _)| (steps, turn, block, order));
    let mut blocks = Vec::new();
    for aligned in keyed.chunk_by(|p, q| (p.0, p.2) == (q.0, q.2)) {
        if aligned.len() < LEAST_ALIGNED {
            others.extend(aligned.iter().map(|entry| entry.4));
            continue;
        }
        let mut rows = Rows::empty();
        rows.blocks = aligned[0].4.particles.map(|i| (i as usize % per_lane) as u32);
        for &(.., row) in aligned {
            let lane = row.particles[0] as usize / per_lane;
            if rows.least[lane] == f32::INFINITY {
                rows.set(lane, &row);
            } else {
                others.push(row);
            }
        }
        blocks.push(rows);
    }
    gather(&others, per_lane, &mut blocks);
    blocks
}

/// Blocks of rows that share no particle: each row goes into the first that has room for it.
fn gather<const K: usize>(rows: &[Row<K>], per_lane: usize, out: &mut Vec<Rows<K>>) {
    let mut open: Vec<Vec<Row<K>>> = Vec::new();
    for &row in rows {
        let meets = |other: &Row<K>| other.particles.iter().any(|i| row.particles.contains(i));
        match open.iter().position(|block| !block.iter().any(meets)) {
            Some(at) => open[at].push(row),
            None => open.push(vec![row]),
        }
        if let Some(full) = open.iter().position(|block| block.len() == WIDTH) {
            out.push(gathered(&open.remove(full), per_lane));
        } else if open.len() > OPEN {
            out.push(gathered(&open.remove(0), per_lane));
        }
    }
    out.extend(open.iter().map(|block| gathered(block, per_lane)));
}

fn gathered<const K: usize>(block: &[Row<K>], per_lane: usize) -> Rows<K> {
    let mut rows = Rows::empty();
    // Lanes without a row have a place of their own, after all particles.
    let mut slots = [core::array::from_fn(|lane| (per_lane * WIDTH + lane) as u32); K];
    for (lane, row) in block.iter().enumerate() {
        rows.set(lane, row);
        for (slot, &i) in slots.iter_mut().zip(&row.particles) {
            slot[lane] = (i as usize % per_lane * WIDTH + i as usize / per_lane) as u32;
        }
    }
    rows.slots = Some(slots);
    rows
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
        let Batches { springs, bends, particles, .. } = self.batches;
        let times = (L::splat(self.h), L::splat(1.0 / (self.h * self.h)));
        for rows in springs.iter() {
            match &rows.slots {
                None => project_springs::<L, _>(particles, rows, &rows.blocks, times, self.touching),
                Some(slots) => project_springs::<L, _>(particles, rows, slots, times, self.touching),
            }
        }
        for rows in bends.iter() {
            match &rows.slots {
                None => project_bends::<L, _>(particles, rows, &rows.blocks, times, self.touching),
                Some(slots) => project_bends::<L, _>(particles, rows, slots, times, self.touching),
            }
        }
    }
}

/// Places of eight particles.
trait Place {
    /// One number of each.
    fn load<L: Lanes>(&self, particles: &[Block<FIELDS>], field: usize) -> L;

    /// Writes one number of each.
    fn store<L: Lanes>(&self, value: L, particles: &mut [Block<FIELDS>], field: usize);
}

/// All in one block.
impl Place for u32 {
    #[inline(always)]
    fn load<L: Lanes>(&self, particles: &[Block<FIELDS>], field: usize) -> L {
        L::load(&particles[*self as usize].0[field])
    }

    #[inline(always)]
    fn store<L: Lanes>(&self, value: L, particles: &mut [Block<FIELDS>], field: usize) {
        value.store(&mut particles[*self as usize].0[field]);
    }
}

/// Each in its block and lane.
impl Place for [u32; WIDTH] {
    #[inline(always)]
    fn load<L: Lanes>(&self, particles: &[Block<FIELDS>], field: usize) -> L {
        let mut numbers = [0.0; WIDTH];
        for lane in 0..WIDTH {
            let slot = self[lane] as usize;
            numbers[lane] = particles[slot / WIDTH].0[field][slot % WIDTH];
        }
        L::load(&numbers)
    }

    #[inline(always)]
    fn store<L: Lanes>(&self, value: L, particles: &mut [Block<FIELDS>], field: usize) {
        let mut numbers = [0.0; WIDTH];
        value.store(&mut numbers);
        for lane in 0..WIDTH {
            let slot = self[lane] as usize;
            particles[slot / WIDTH].0[field][slot % WIDTH] = numbers[lane];
        }
    }
}

/// One vector of eight particles, from its first field.
#[inline(always)]
fn vector<L: Lanes>(particles: &[Block<FIELDS>], place: &impl Place, field: usize) -> Vector3<L> {
    Vector3::new(
        place.load(particles, field),
        place.load(particles, field + 1),
        place.load(particles, field + 2),
    )
}

#[inline(always)]
fn project_springs<L: Lanes, P: Place>(
    particles: &mut [Block<FIELDS>],
    rows: &Rows<2>,
    places: &[P; 2],
    times: (L, L),
    touching: bool,
) {
    let ends = [Particle::load(particles, &places[0]), Particle::load(particles, &places[1])];
    let way = ends[1].way - ends[0].way;
    let apart = ends[1].from - ends[0].from + way;
    project::<L, P, 2>(particles, (rows, places), ends, (apart, way), [-1.0, 1.0], times, touching);
}

#[inline(always)]
fn project_bends<L: Lanes, P: Place>(
    particles: &mut [Block<FIELDS>],
    rows: &Rows<3>,
    places: &[P; 3],
    times: (L, L),
    touching: bool,
) {
    let two = L::splat(2.0);
    let ends = [
        Particle::load(particles, &places[0]),
        Particle::load(particles, &places[1]),
        Particle::load(particles, &places[2]),
    ];
    let way = ends[0].way - ends[1].way * two + ends[2].way;
    let apart = ends[0].from - ends[1].from * two + ends[2].from + way;
    project::<L, P, 3>(particles, (rows, places), ends, (apart, way), [1.0, -2.0, 1.0], times, touching);
}

/// Eight particles.
#[derive(Clone, Copy)]
struct Particle<L> {
    from: Vector3<L>,
    way: Vector3<L>,
    weight: L,
}

impl<L: Lanes> Particle<L> {
    #[inline(always)]
    fn load(particles: &[Block<FIELDS>], place: &impl Place) -> Self {
        let (from, way) = (vector(particles, place, 0), vector(particles, place, WAY));
        Self { from, way, weight: place.load(particles, WEIGHT) }
    }

    #[inline(always)]
    fn store(&self, particles: &mut [Block<FIELDS>], place: &impl Place) {
        place.store(self.way.x, particles, WAY);
        place.store(self.way.y, particles, WAY + 1);
        place.store(self.way.z, particles, WAY + 2);
    }
}

/// Surfaces that eight particles touch.
#[derive(Clone, Copy, Debug)]
struct Surface<L> {
    normal: Vector3<L>,
    backing: L,
    room: L,
}

impl<L: Lanes> Surface<L> {
    #[inline(always)]
    fn load(particles: &[Block<FIELDS>], place: &impl Place) -> Self {
        Self {
            normal: vector(particles, place, NORMAL),
            backing: place.load(particles, BACKING),
            room: place.load(particles, ROOM),
        }
    }

    /// The part of an impulse along the normal that goes on to the bodies.
    #[inline(always)]
    fn handed_on(&self, along: L) -> L {
        let zero = L::splat(0.0);
        (L::min(self.room + along, zero) - L::min(self.room, zero)) * self.backing
    }

    /// Mobility, 1/kg, of a particle of some weight that is pulled by a force of which so much is along the normal and whose square is `square`, while
    /// it has some room.
    #[inline(always)]
    fn mobility(&self, (weight, along, square): (L, L, L), room: L) -> L {
        let zero = L::splat(0.0);
        let presses = L::lt(room, zero) | (L::lt(along, zero) & L::le(room, zero));
        weight * (square - along * (along * self.backing).masked(presses))
    }

    /// Length that a particle of some weight comes along that force by as many times an impulse.
    #[inline(always)]
    fn moved(&self, (weight, along, square): (L, L, L), impulse: L) -> L {
        weight * (square * impulse - along * self.handed_on(along * impulse))
    }

    /// The part of an impulse along a unit `direction`, times the length of the iteration, N·s², that is left to particles: the rest presses them onto
    /// their surface and goes on.
    #[inline(always)]
    fn pass_on(&mut self, direction: Vector3<L>, impulse: L) -> Vector3<L> {
        let along = direction.dot(self.normal) * impulse;
        let handed_on = self.handed_on(along);
        self.room = self.room + along;
        direction * impulse - self.normal * handed_on
    }
}

/// True if a particle of the rows touches a surface.
#[inline(always)]
fn any_touching<L: Lanes, P: Place, const K: usize>(particles: &[Block<FIELDS>], places: &[P; K]) -> bool {
    let mut any = false;
    for place in places {
        any |= L::gt(place.load::<L>(particles, BACKING), L::splat(0.0)).any();
    }
    any
}

/// The impulse, N·s², that takes eight rows by `error` along their `direction`, and the mobility there, 1/kg. Mobility changes where a particle comes to
/// press and where it ceases to: a second step of Newton's method, exact for one such change.
#[inline(always)]
fn impulse_on_surfaces<L: Lanes, const K: usize>(
    surfaces: &[Surface<L>; K],
    ends: &[Particle<L>; K],
    (direction, error): (Vector3<L>, L),
    shares: [f32; K],
    compliance: L,
) -> (L, L) {
    let zero = L::splat(0.0);
    // Ends are pulled against the error.
    let sign = L::select(L::lt(error, zero), L::splat(1.0), L::splat(-1.0));
    let mut pulls = [(zero, zero, zero); K];
    let mut mobility = zero;
    for k in 0..K {
        let share = sign * L::splat(shares[k]);
        let along = direction.dot(surfaces[k].normal) * share;
        pulls[k] = (ends[k].weight, along, L::splat(shares[k] * shares[k]));
        mobility = mobility + surfaces[k].mobility(pulls[k], surfaces[k].room);
    }
    let first = error.abs() / (mobility + compliance);
    let mut left = error.abs() - compliance * first;
    mobility = zero;
    for k in 0..K {
        left = left - surfaces[k].moved(pulls[k], first);
        mobility = mobility + surfaces[k].mobility(pulls[k], surfaces[k].room + pulls[k].1 * first);
    }
    let impulse = first + left / (mobility + compliance);
    (zero - sign * impulse, mobility)
}

/// Solves eight rows. `apart` is the vector whose length is their error and rest, `way` how far it has come in the iteration, and
/// each end moves it by its share.
#[inline(always)]
fn project<L: Lanes, P: Place, const K: usize>(
    particles: &mut [Block<FIELDS>],
    (rows, places): (&Rows<K>, &[P; K]),
    mut ends: [Particle<L>; K],
    (apart, way): (Vector3<L>, Vector3<L>),
    shares: [f32; K],
    (h, per_square): (L, L),
    touching: bool,
) {
    let length = apart.dot(apart).sqrt();
    let direction = apart * (L::splat(1.0) / length);
    let error = length - L::load(&rows.rest);
    let active = L::gt(error, L::load(&rows.least)) & L::gt(length, L::splat(1e-9));
    let compliance = L::load(&rows.compliance) * per_square;
    let mut surfaces = None;
    let (mut impulse, mut sum);
    if touching && any_touching::<L, P, K>(particles, places) {
        let mut found = [Surface::load(particles, &places[0]); K];
        for k in 1..K {
            found[k] = Surface::load(particles, &places[k]);
        }
        (impulse, sum) = impulse_on_surfaces(&found, &ends, (direction, error), shares, compliance);
        surfaces = Some(found);
    } else {
        sum = L::splat(0.0);
        for k in 0..K {
            sum = sum + ends[k].weight * L::splat(shares[k] * shares[k]);
        }
        impulse = error / (sum + compliance);
    }
    if rows.is_damped {
        // Damping of the speed that this leaves.
        let left = way.dot(direction) - impulse * sum;
        let damping = h * L::load(&rows.damping);
        impulse = impulse + left * damping / (L::splat(1.0) + damping * sum);
    }
    // Rows without an error, a direction or anything that moves do nothing.
    let active = active & L::gt(sum, L::splat(0.0));
    let impulse = impulse.masked(active);
    let direction =
        Vector3::new(direction.x.masked(active), direction.y.masked(active), direction.z.masked(active));
    for k in 0..K {
        let on_end = impulse * L::splat(-shares[k]);
        match &mut surfaces {
            Some(surfaces) => {
                ends[k].way = ends[k].way + surfaces[k].pass_on(direction, on_end) * ends[k].weight;
                places[k].store(surfaces[k].room, particles, ROOM);
            }
            None => ends[k].way = ends[k].way + direction * (on_end * ends[k].weight),
        }
        ends[k].store(particles, &places[k]);
    }
}
