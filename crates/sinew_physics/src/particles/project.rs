//! Projection of rows of a net, eight side by side.
//!
//! A row keeps the length `l` of a vector `d` at `r`: `d` is the sum of its particles' positions times their shares
//! `s`, −1 and 1 for a spring. A particle of weight `w` moves by
//! `Δx = −s w ((1 − r/l) / S + β v·d/l²) d / (1 + β Σ s² w)` with `S = Σ s² w + α/h²`, `β` the damping times the
//! iteration length, and `v` the change of `d` since the iteration's start. For a single row that is a step of implicit
//! Euler. Without damping a single factor per particle, its **gain** `−s w / S`, contains everything that is constant
//! within a run of rows: eight springs take 51 AVX2 instructions.
//!
//! Rows on surfaces of yielding bodies include these in their pull (`solve_on_surfaces`).

use super::batches::{BACKING, Batches, FIELDS, Kind, NORMAL, ROOM, Rows, Run, SURFACE_FIELDS, WAY};
use sinew_math::dispatch::Kernel;
use sinew_math::lanes::{Block, LaneMask, Lanes, Vector3, WIDTH};

/// Shares of a spring's ends in the vector whose length it keeps.
const SPRING: [f32; 2] = [-1.0, 1.0];
/// Shares of a bend's particles in the vector whose length it keeps.
const BEND: [f32; 3] = [1.0, -2.0, 1.0];

/// Records of `F` numbers for eight particles.
type Numbers<const F: usize> = [[f32; WIDTH]; F];

/// Projects each row once, springs first.
pub(super) struct Project<'a> {
    pub batches: &'a mut Batches,
    /// Length of the iteration, seconds.
    pub h: f32,
    /// True if a particle touches a surface.
    pub touching: bool,
}

impl Kernel for Project<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { batches: Batches { springs, bends, particles, surfaces, .. }, h, touching } = self;
        if touching {
            project::<L, 2, true>(particles, surfaces, springs, SPRING, h);
            project::<L, 3, true>(particles, surfaces, bends, BEND, h);
        } else {
            project::<L, 2, false>(particles, surfaces, springs, SPRING, h);
            project::<L, 3, false>(particles, surfaces, bends, BEND, h);
        }
    }
}

/// Projects each row of `K` particles once, with surfaces if `TOUCHING`.
#[inline(always)]
fn project<L: Lanes, const K: usize, const TOUCHING: bool>(
    particles: &mut [Block<FIELDS>],
    surfaces: &mut [Block<SURFACE_FIELDS>],
    rows: &Rows<K>,
    shares: [f32; K],
    h: f32,
) {
    for run in &rows.aligned {
        let kind = &rows.kinds[run.kind as usize];
        let solver = Solver::<L, K>::new(kind, shares, h);
        match (kind.is_damped, kind.is_even) {
            _ if TOUCHING => solver.solve_aligned_touching(particles, surfaces, run),
            (false, false) => solver.solve_aligned::<false, false>(particles, run),
            (false, true) => solver.solve_aligned::<false, true>(particles, run),
            (true, false) => solver.solve_aligned::<true, false>(particles, run),
            (true, true) => solver.solve_aligned::<true, true>(particles, run),
        }
    }
    for run in &rows.turned {
        let solver = Solver::<L, K>::new(&rows.kinds[run.kind as usize], shares, h);
        let lanes = run.lanes.map(usize::from);
        for row in 0..run.count {
            let places = run.places(row);
            let mut ends = turned::<L, K, FIELDS>(particles, &places, &lanes);
            if TOUCHING {
                let mut beneath = turned::<L, K, SURFACE_FIELDS>(surfaces, &places, &lanes);
                solver.solve_touching(&mut ends.each_mut(), &mut beneath.each_mut());
                turn_back::<L, K, SURFACE_FIELDS, ROOM>(surfaces, &places, &lanes, &beneath);
            } else {
                solver.solve(&mut ends.each_mut());
            }
            turn_back::<L, K, FIELDS, WAY>(particles, &places, &lanes, &ends);
        }
    }
    for (slots, kind) in &rows.gathered {
        let solver = Solver::<L, K>::new(&rows.kinds[*kind as usize], shares, h);
        let mut ends = fetch(particles, slots);
        if TOUCHING {
            let mut beneath = fetch(surfaces, slots);
            solver.solve_touching(&mut ends.each_mut(), &mut beneath.each_mut());
            put_back::<K, SURFACE_FIELDS, ROOM>(surfaces, slots, &beneath);
        } else {
            solver.solve(&mut ends.each_mut());
        }
        put_back::<K, FIELDS, WAY>(particles, slots, &ends);
    }
}

/// Solves rows of one kind in an iteration.
struct Solver<'a, L, const K: usize> {
    kind: &'a Kind<K>,
    shares: [f32; K],
    /// Length of the iteration, seconds.
    h: f32,
    /// Target length, metres.
    rest: L,
    /// Error above which a row acts, metres.
    least: L,
    /// `1/S`, kg.
    inertia: L,
    /// `β`, kg.
    damping: L,
    /// Gain of each particle: its displacement along the row's vector per unit of the undamped relative error. With
    /// damping: per unit of the impulse `(1 − r/l) / S + β v·d/l²`.
    gains: [L; K],
}

impl<'a, L: Lanes, const K: usize> Solver<'a, L, K> {
    #[inline(always)]
    fn new(kind: &'a Kind<K>, shares: [f32; K], h: f32) -> Self {
        let zero = L::splat(0.0);
        let mut solver = Self {
            kind,
            shares,
            h,
            rest: L::load(&kind.rest),
            least: L::load(&kind.least),
            inertia: zero,
            damping: L::load(&kind.damping) * L::splat(h),
            gains: [zero; K],
        };
        let (one, mobility) = (L::splat(1.0), solver.mobility());
        solver.inertia = one / (mobility + solver.compliance());
        let scale = if kind.is_damped { one / (one + solver.damping * mobility) } else { solver.inertia };
        for k in 0..K {
            solver.gains[k] = L::load(&kind.weights[k]) * L::splat(-shares[k]) * scale;
        }
        solver
    }

    /// Compliance over the square of the iteration, 1/kg.
    #[inline(always)]
    fn compliance(&self) -> L {
        L::load(&self.kind.compliance) * L::splat(1.0 / (self.h * self.h))
    }

    /// Speed that a row gains per unit impulse along it, without surfaces, 1/kg.
    #[inline(always)]
    fn mobility(&self) -> L {
        let (shares, weights) = (self.shares, &self.kind.weights);
        let mut sum = L::load(&weights[0]) * L::splat(shares[0] * shares[0]);
        for k in 1..K {
            sum = sum + L::load(&weights[k]) * L::splat(shares[k] * shares[k]);
        }
        sum
    }

    /// Solves aligned rows, one after the other.
    #[inline(always)]
    fn solve_aligned<const DAMPED: bool, const EVEN: bool>(
        &self,
        particles: &mut [Block<FIELDS>],
        run: &Run<K>,
    ) {
        let (first, count) = (run.first.map(|block| block as usize), run.count as usize);
        if run.is_along() {
            for ends in particles[first[0]..][..K * count].as_chunks_mut::<K>().0 {
                self.solve_free::<DAMPED, EVEN>(&mut ends.each_mut().map(|Block(numbers)| numbers));
            }
        } else if let Ok(sides) = particles.get_disjoint_mut(first.map(|block| block..block + count)) {
            // Slices of equal length, so that the compiled loop has no index check.
            let mut sides = sides.map(|side| &mut side[..count]);
            for row in 0..count {
                self.solve_free::<DAMPED, EVEN>(&mut sides.each_mut().map(|side| &mut side[row].0));
            }
        } else {
            debug_assert!(false, "rows of a run share blocks: {run:?}");
        }
    }

    /// Solves aligned rows that may touch surfaces, one after the other.
    #[inline(always)]
    fn solve_aligned_touching(
        &self,
        particles: &mut [Block<FIELDS>],
        surfaces: &mut [Block<SURFACE_FIELDS>],
        run: &Run<K>,
    ) {
        let (first, count) = (run.first.map(|block| block as usize), run.count as usize);
        let blocks = first.map(|block| block..block + count);
        if run.is_along() {
            let ends = particles[first[0]..][..K * count].as_chunks_mut::<K>().0;
            let beneath = surfaces[first[0]..][..K * count].as_chunks_mut::<K>().0;
            for (ends, beneath) in ends.iter_mut().zip(beneath) {
                let mut ends = ends.each_mut().map(|Block(numbers)| numbers);
                self.solve_touching(&mut ends, &mut beneath.each_mut().map(|Block(numbers)| numbers));
            }
        } else if let (Ok(mut sides), Ok(mut beneath)) =
            (particles.get_disjoint_mut(blocks.clone()), surfaces.get_disjoint_mut(blocks))
        {
            for row in 0..count {
                let mut ends = sides.each_mut().map(|side| &mut side[row].0);
                self.solve_touching(&mut ends, &mut beneath.each_mut().map(|side| &mut side[row].0));
            }
        } else {
            debug_assert!(false, "rows of a run share blocks: {run:?}");
        }
    }

    /// Solves eight rows that touch nothing.
    #[inline(always)]
    fn solve(&self, ends: &mut [&mut Numbers<FIELDS>; K]) {
        if self.kind.is_damped {
            self.solve_free::<true, false>(ends);
        } else {
            self.solve_free::<false, false>(ends);
        }
    }

    /// Solves eight rows without surfaces, damped or not. With equal weights, particles of equal shares move equally,
    /// and those of opposite shares oppositely.
    #[inline(always)]
    fn solve_free<const DAMPED: bool, const EVEN: bool>(&self, ends: &mut [&mut Numbers<FIELDS>; K]) {
        let way = combined::<L, K>(ends, self.shares, WAY);
        let apart = combined::<L, K>(ends, self.shares, 0) + way;
        let square = apart.dot(apart);
        let length = square.sqrt();
        let off = length - self.rest;
        let error = if DAMPED {
            (off * length * self.inertia + apart.dot(way) * self.damping) / square
        } else {
            off / length
        };
        let error = error.masked(L::gt(off, self.least));
        let first = apart * (error * self.gains[0]);
        for k in 0..K {
            let way = vector::<L, FIELDS>(ends[k], WAY);
            let way = if k == 0 || EVEN && self.shares[k] == self.shares[0] {
                way + first
            } else if EVEN && self.shares[k] == -self.shares[0] {
                way - first
            } else {
                way + apart * (error * self.gains[k])
            };
            store(way, ends[k]);
        }
    }

    /// Solves eight rows that may touch surfaces.
    #[inline(always)]
    fn solve_touching(
        &self,
        ends: &mut [&mut Numbers<FIELDS>; K],
        beneath: &mut [&mut Numbers<SURFACE_FIELDS>; K],
    ) {
        if any_touching::<L, K>(beneath) {
            self.solve_on_surfaces(ends, beneath);
        } else {
            self.solve(ends);
        }
    }

    /// Solves eight rows, some of which touch surfaces. Pulls are in units of the row's vector instead of its
    /// direction, and errors are squared: only one division remains.
    #[inline(always)]
    fn solve_on_surfaces(
        &self,
        ends: &mut [&mut Numbers<FIELDS>; K],
        beneath: &mut [&mut Numbers<SURFACE_FIELDS>; K],
    ) {
        let zero = L::splat(0.0);
        let (shares, weights) = (self.shares, self.kind.weights.each_ref().map(L::load));
        let way = combined::<L, K>(ends, shares, WAY);
        let apart = combined::<L, K>(ends, shares, 0) + way;
        let square = apart.dot(apart);
        let length = square.sqrt();
        let off = length - self.rest;
        let compliance = square * self.compliance();
        let mut surfaces = [Surface::load(beneath[0], weights[0], apart, shares[0]); K];
        for k in 1..K {
            surfaces[k] = Surface::load(beneath[k], weights[k], apart, shares[k]);
        }
        let (error, slope) = on_surfaces(&surfaces, off * length, square * self.mobility() + compliance);
        let mut pull = error / slope;
        if self.kind.is_damped {
            let (mobility, damping) = (slope - compliance, self.damping);
            pull = pull + (apart.dot(way) - pull * mobility) * damping / (square + damping * mobility);
        }
        let pull = pull.masked(L::gt(off, self.least) & L::gt(slope, zero));
        for k in 0..K {
            let Surface { room, gain, .. } = surfaces[k];
            let after = room + gain * pull;
            let passed = L::min(after, zero) - L::min(room, zero);
            let kept = L::load(&beneath[k][BACKING]) * weights[k] * passed;
            let by = pull * L::splat(-shares[k]) * weights[k];
            let normal = vector::<L, SURFACE_FIELDS>(beneath[k], NORMAL);
            store(vector::<L, FIELDS>(ends[k], WAY) + apart * by - normal * kept, ends[k]);
            after.store(&mut beneath[k][ROOM]);
        }
    }
}

/// Sum of a vector of the rows' ends, which starts at field `field`, weighted by their shares.
#[inline(always)]
fn combined<L: Lanes, const K: usize>(
    ends: &[&mut Numbers<FIELDS>; K],
    shares: [f32; K],
    field: usize,
) -> Vector3<L> {
    let mut sum = vector::<L, FIELDS>(ends[0], field) * L::splat(shares[0]);
    for k in 1..K {
        sum = sum + vector::<L, FIELDS>(ends[k], field) * L::splat(shares[k]);
    }
    sum
}

/// Copies blocks, each rotated so that its lanes match those of the first one, which is not rotated.
#[inline(always)]
fn turned<L: Lanes, const K: usize, const F: usize>(
    blocks: &[Block<F>],
    places: &[usize; K],
    lanes: &[usize; K],
) -> [Numbers<F>; K] {
    let mut ends = [[[0.0; WIDTH]; F]; K];
    for k in 0..K {
        let Block(from) = &blocks[places[k]];
        for field in 0..F {
            let numbers = L::load(&from[field]);
            let numbers = if k == 0 { numbers } else { numbers.turn(lanes[k]) };
            numbers.store(&mut ends[k][field]);
        }
    }
    ends
}

/// Writes the copies of `turned` back from field `FROM` on; lanes without a row are unchanged.
#[inline(always)]
fn turn_back<L: Lanes, const K: usize, const F: usize, const FROM: usize>(
    blocks: &mut [Block<F>],
    places: &[usize; K],
    lanes: &[usize; K],
    ends: &[Numbers<F>; K],
) {
    for k in 0..K {
        let Block(to) = &mut blocks[places[k]];
        for field in FROM..F {
            let numbers = L::load(&ends[k][field]);
            let numbers = if k == 0 { numbers } else { numbers.turn((WIDTH - lanes[k]) % WIDTH) };
            numbers.store(&mut to[field]);
        }
    }
}

/// Copies the records of particles, each from its own block and lane.
#[inline(always)]
fn fetch<const K: usize, const F: usize>(blocks: &[Block<F>], slots: &[[u32; WIDTH]; K]) -> [Numbers<F>; K] {
    let mut ends = [[[0.0; WIDTH]; F]; K];
    for k in 0..K {
        for lane in 0..WIDTH {
            let slot = slots[k][lane] as usize;
            let Block(from) = &blocks[slot / WIDTH];
            for field in 0..F {
                ends[k][field][lane] = from[field][slot % WIDTH];
            }
        }
    }
    ends
}

/// Writes the copies of `fetch` back from field `FROM` on.
#[inline(always)]
fn put_back<const K: usize, const F: usize, const FROM: usize>(
    blocks: &mut [Block<F>],
    slots: &[[u32; WIDTH]; K],
    ends: &[Numbers<F>; K],
) {
    for k in 0..K {
        for lane in 0..WIDTH {
            let slot = slots[k][lane] as usize;
            let Block(to) = &mut blocks[slot / WIDTH];
            for field in FROM..F {
                to[field][slot % WIDTH] = ends[k][field][lane];
            }
        }
    }
}

/// Loads a vector of eight particles that starts at field `field`.
#[inline(always)]
fn vector<L: Lanes, const F: usize>(numbers: &Numbers<F>, field: usize) -> Vector3<L> {
    Vector3::load(&numbers[field], &numbers[field + 1], &numbers[field + 2])
}

/// Writes the displacement of eight particles.
#[inline(always)]
fn store<L: Lanes>(way: Vector3<L>, end: &mut Numbers<FIELDS>) {
    way.x.store(&mut end[WAY]);
    way.y.store(&mut end[WAY + 1]);
    way.z.store(&mut end[WAY + 2]);
}

/// True if a particle of the rows touches a surface.
#[inline(always)]
fn any_touching<L: Lanes, const K: usize>(beneath: &[&mut Numbers<SURFACE_FIELDS>; K]) -> bool {
    let mut most = L::load(&beneath[0][BACKING]);
    for k in 1..K {
        most = L::max(most, L::load(&beneath[k][BACKING]));
    }
    L::gt(most, L::splat(0.0)).any()
}

/// Effect of the surface at one end of eight rows on a pull.
#[derive(Clone, Copy, Debug)]
struct Surface<L> {
    /// Room before the particle presses, N·s².
    room: L,
    /// Change of the room per unit of the pull.
    gain: L,
    /// Loss of the row per N·s² pressed onto the body, in units of its error.
    passed: L,
    /// Loss of the row per unit of a pull that presses completely.
    lacking: L,
}

impl<L: Lanes> Surface<L> {
    /// Loads the surface of an end with inverse mass `weight` and this `share` in the row's vector `apart`.
    #[inline(always)]
    fn load(beneath: &Numbers<SURFACE_FIELDS>, weight: L, apart: Vector3<L>, share: f32) -> Self {
        let gain = apart.dot(vector(beneath, NORMAL)) * L::splat(-share);
        let passed = L::load(&beneath[BACKING]) * weight * gain;
        Self { room: L::load(&beneath[ROOM]), gain, passed, lacking: passed * gain }
    }
}

/// Returns error and slope, whose quotient is the pull of eight rows. The effect of a pull, `slope` per unit without
/// surfaces, changes where a particle starts or stops pressing. The initial slope predicts which particles do: a single
/// change is exact, like two Newton steps.
#[inline(always)]
fn on_surfaces<L: Lanes, const K: usize>(surfaces: &[Surface<L>; K], error: L, slope: L) -> (L, L) {
    let zero = L::splat(0.0);
    let mut first = slope;
    for s in surfaces {
        // A particle without room presses if it is pulled onto the surface.
        let brink = L::splat(f32::MIN_POSITIVE).masked(L::lt(s.gain * error, zero));
        first = first - s.lacking.masked(L::lt(s.room, brink));
    }
    let (mut error_left, mut last) = (error, slope);
    for s in surfaces {
        let presses = L::lt(s.room * first + s.gain * error, zero);
        last = last - s.lacking.masked(presses);
        // Adds the part of the pull before that change.
        error_left = error_left + s.passed * L::max(L::select(presses, s.room, -s.room), zero);
    }
    (error_left, last)
}
