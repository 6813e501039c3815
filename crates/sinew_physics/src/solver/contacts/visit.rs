//! One visit of a block in a sweep: friction, then the normal rows, block by block in impulse space.

use super::block::{Block, Eight, HELD, Motion, NONE, Rolling, load3, packed, store3, times};
use super::disk;
use crate::slices::{Places, SharedRows};
use crate::solver::pass::Pass;
use crate::solver::tuning::{IMPACT_JUMP, MANIFOLD_ROUNDS, POINT_PROXIMAL, SLIP_SPEED};
use crate::spatial::Vec6;
use sinew_math::lanes::{LaneMask, Lanes, Vector3, WIDTH};

/// State of a sweep over blocks.
pub(super) struct Sweep<'a> {
    pub velocities: SharedRows<'a, Vec6>,
    pub rolling: SharedRows<'a, Rolling>,
    pub pass: Pass,
    /// Conjugate step applied to the blocks.
    pub step: Step,
    /// True if friction is limited by the present impulses.
    pub updates_friction_bound: bool,
    /// Largest change of a velocity component in the sweep so far, lane by lane, m/s or rad/s.
    pub largest: Eight,
    /// Sum of the energies of the blocks' changes, lane by lane, J.
    pub energy: Eight,
}

impl Sweep<'_> {
    /// Visits a block.
    #[inline(always)]
    pub fn visit_block<L: Lanes, const N: usize, const T: usize>(&mut self, block: &mut Block<N, T>) {
        block.step::<L>(self.step);
        let places = [self.places(&block.bodies[0]), self.places(&block.bodies[1])];
        let before = [self.motion(&places[0]), self.motion(&places[1])];
        let mut ends: [Motion<L>; 2] = before;
        if self.pass == Pass::Relax {
            if self.updates_friction_bound {
                update_friction_bound::<L, N, T>(block);
            }
            let energy = visit_friction(block, &mut ends);
            self.add_energy(energy);
            if block.rolling != NONE {
                visit_rolling(block, self.rolling.get_mut(block.rolling as usize), &mut ends);
            }
        }
        let energy = visit_normal(block, &mut ends);
        self.add_energy(energy);
        let changes = [ends[0].change(before[0]), ends[1].change(before[1])];
        let largest = L::max(changes[0], changes[1]);
        L::max(L::load(&self.largest), largest).store(&mut self.largest);
        if L::gt(largest, L::splat(0.0)).any() {
            self.write(&block.bodies[0], &places[0], ends[0]);
            self.write(&block.bodies[1], &places[1], ends[1]);
        }
    }

    #[inline(always)]
    fn places(&self, bodies: &[u32; WIDTH]) -> Places {
        Places::new(bodies.map(|body| body & !HELD), self.velocities.len())
    }

    #[inline(always)]
    fn motion<L: Lanes>(&self, places: &Places) -> Motion<L> {
        let rows = &self.velocities;
        Motion::of([
            L::load(rows.at(places, 0)),
            L::load(rows.at(places, 1)),
            L::load(rows.at(places, 2)),
            L::load(rows.at(places, 3)),
            L::load(rows.at(places, 4)),
            L::load(rows.at(places, 5)),
            L::load(rows.at(places, 6)),
            L::load(rows.at(places, 7)),
        ])
    }

    /// Writes the velocities of moving bodies.
    #[inline(always)]
    fn write<L: Lanes>(&mut self, bodies: &[u32; WIDTH], places: &Places, motion: Motion<L>) {
        // Uses copies, so that writes through the rows cannot change them.
        let (mut velocities, places) = (self.velocities, *places);
        let rows = motion.rows();
        for k in 0..WIDTH {
            if bodies[k] & HELD == 0 {
                rows[k].store(velocities.at_mut(&places, k));
            }
        }
    }

    #[inline(always)]
    fn add_energy<L: Lanes>(&mut self, energy: L) {
        (L::load(&self.energy) + energy).store(&mut self.energy);
    }
}

#[inline(always)]
pub(super) fn sum<L: Lanes, const N: usize>(rows: &[Eight; N]) -> L {
    let mut sum = L::load(&rows[0]);
    for i in 1..N {
        sum = sum + L::load(&rows[i]);
    }
    sum
}

/// Limits friction by the final normal impulses of the last substep, unless this is a hit. After a few sweeps the impulses of this substep
/// may still be uneven; the sum of the last substep is not, since it supported the body.
#[inline(always)]
fn update_friction_bound<L: Lanes, const N: usize, const T: usize>(block: &mut Block<N, T>) {
    let (now, last) = (sum::<L, N>(&block.impulse), L::load(&block.last_load));
    let jump = L::splat(IMPACT_JUMP);
    let lasts = L::le(now, jump * last) & L::le(last, jump * now);
    L::select(lasts, last, now).store(&mut block.load);
}

#[inline(always)]
fn visit_normal<L: Lanes, const N: usize, const T: usize>(
    block: &mut Block<N, T>,
    ends: &mut [Motion<L>; 2],
) -> L {
    let (n, offset) = (load3::<L>(&block.normal), load3::<L>(&block.offset));
    let zero = L::splat(0.0);
    let (a, b) = (ends[0], ends[1]);
    let lever = offset.cross(n);
    let turning = b.angular - a.angular;
    let shared = n.dot(b.linear - a.linear) + b.angular.dot(lever);
    let none = Vector3::new(zero, zero, zero);
    let (mut levers, mut rates, mut given) = ([none; N], [zero; N], [zero; N]);
    for i in 0..N {
        levers[i] = load3::<L>(&block.levers[i]);
        rates[i] = shared + turning.dot(levers[i]) + L::load(&block.target[i]);
        given[i] = L::load(&block.impulse[i]);
    }
    let old = given;
    let points = Points::new(block, &rates, &given);
    // Alternates directions: one direction alone would leave a small motion toward the first side.
    if N == 1 {
        points.visit::<true>(0, &mut given);
    } else {
        const { assert!(MANIFOLD_ROUNDS.is_multiple_of(2)) };
        for _ in 0..MANIFOLD_ROUNDS / 2 {
            for i in 0..N {
                points.visit::<true>(i, &mut given);
            }
            for i in (0..N).rev() {
                points.visit::<false>(i, &mut given);
            }
        }
    }
    let (mut push, mut torque, mut energy) = (zero, none, zero);
    for i in 0..N {
        let change = given[i] - old[i];
        let mut answer = zero;
        for j in 0..N {
            answer = answer + L::load(&block.response[packed(i, j)]) * (given[j] - old[j]);
        }
        energy = energy + change * answer;
        push = push + change;
        torque = torque + levers[i] * change;
        given[i].store(&mut block.impulse[i]);
    }
    let impulse = n * push;
    ends[0].push(L::load(&block.mass[0]), &block.inertia[0], -impulse, -torque);
    ends[1].push(L::load(&block.mass[1]), &block.inertia[1], impulse, torque + lever * push);
    energy
}

/// The points of a block in a visit. Each is a linear function for its own impulse: its value without impulses of the other points, and the
/// share that each of them subtracts. This reduces the dependency between consecutive points to a product, a difference and a maximum,
/// without a rate.
struct Points<L, const N: usize> {
    alone: [L; N],
    /// Coefficients, row by row; the diagonal is the share of the point's own impulse that stays.
    taken: [[L; N]; N],
    floor: [L; N],
}

impl<L: Lanes, const N: usize> Points<L, N> {
    #[inline(always)]
    fn new<const T: usize>(block: &Block<N, T>, rates: &[L; N], given: &[L; N]) -> Self {
        let zero = L::splat(0.0);
        let mut points = Self { alone: [zero; N], taken: [[zero; N]; N], floor: [zero; N] };
        for i in 0..N {
            let (gain, mut alone) = (L::load(&block.gain[i]), -rates[i]);
            for j in 0..N {
                let response = L::load(&block.response[packed(i, j)]);
                alone = alone + response * given[j];
                points.taken[i][j] = response * gain;
            }
            points.alone[i] = alone * gain;
            points.taken[i][i] = points.taken[i][i] * L::splat(POINT_PROXIMAL);
            points.floor[i] = L::load(&block.floor[i]);
        }
        points
    }

    /// Sets the new impulse of a point; the previous point in the visiting order contributes last. Callers loop over constants, so that the
    /// values stay in registers.
    #[inline(always)]
    fn visit<const FORWARD: bool>(&self, i: usize, given: &mut [L; N]) {
        let mut new = self.alone[i] + self.taken[i][i] * given[i];
        for step in 1..N {
            let j = (if FORWARD { i + step } else { i + N - step }) % N;
            new = new - self.taken[i][j] * given[j];
        }
        given[i] = L::max(new, self.floor[i]);
    }
}

#[inline(always)]
fn visit_friction<L: Lanes, const N: usize, const T: usize>(
    block: &mut Block<N, T>,
    ends: &mut [Motion<L>; 2],
) -> L {
    let (n, t0) = (load3::<L>(&block.normal), load3::<L>(&block.tangent));
    let t1 = n.cross(t0);
    let arm_a = load3::<L>(&block.center);
    let arm_b = arm_a + load3::<L>(&block.offset);
    let (a, b) = (ends[0], ends[1]);
    let slides = (b.linear + b.angular.cross(arm_b)) - (a.linear + a.angular.cross(arm_a));
    let rates = [t0.dot(slides) + L::load(&block.surface[0]), t1.dot(slides) + L::load(&block.surface[1])];
    let k = [
        L::load(&block.tangent_response[0]),
        L::load(&block.tangent_response[1]),
        L::load(&block.tangent_response[2]),
    ];
    let old = [L::load(&block.friction[0]), L::load(&block.friction[1])];
    let wanted = [k[0] * old[0] + k[1] * old[1] - rates[0], k[1] * old[0] + k[2] * old[1] - rates[1]];
    let (load, sliding, holding) = (L::load(&block.load), L::load(&block.sliding), L::load(&block.holding));
    let mut new = disk::least_energy(k, wanted, holding * load);
    let mut grip = holding;
    let holds_more = L::gt(holding, sliding);
    let limit = L::splat(SLIP_SPEED);
    if holds_more.any() {
        let slip = [k[0] * new[0] + k[1] * new[1] - wanted[0], k[1] * new[0] + k[2] * new[1] - wanted[1]];
        let slips = holds_more & L::gt(slip[0] * slip[0] + slip[1] * slip[1], limit * limit);
        let slid = disk::least_energy(k, wanted, sliding * load);
        new = [L::select(slips, slid[0], new[0]), L::select(slips, slid[1], new[1])];
        grip = L::select(slips, sliding, holding);
    }
    new[0].store(&mut block.friction[0]);
    new[1].store(&mut block.friction[1]);
    let change = [new[0] - old[0], new[1] - old[1]];
    let impulse = t0 * change[0] + t1 * change[1];
    let (mut torque_a, mut torque_b) = (arm_a.cross(impulse), arm_b.cross(impulse));
    if N > 1 {
        let [k0, k1] = [L::load(&block.twist_to_tangents[0]), L::load(&block.twist_to_tangents[1])];
        let rate =
            n.dot(b.angular - a.angular) + L::load(&block.surface[2]) + k0 * change[0] + k1 * change[1];
        let twisted = n * visit_twist(block, rate, grip, load);
        torque_a = torque_a + twisted;
        torque_b = torque_b + twisted;
    }
    ends[0].push(L::load(&block.mass[0]), &block.inertia[0], -impulse, -torque_a);
    ends[1].push(L::load(&block.mass[1]), &block.inertia[1], impulse, torque_b);
    let answer = [k[0] * change[0] + k[1] * change[1], k[1] * change[0] + k[2] * change[1]];
    change[0] * answer[0] + change[1] * answer[1]
}

/// Visits the twist, after the tangents: a light body turns far about a contact beside its centre, and a joint solve of both overshoots
/// more in each sweep. Returns the change.
#[inline(always)]
fn visit_twist<L: Lanes, const N: usize, const T: usize>(
    block: &mut Block<N, T>,
    rate: L,
    grip: L,
    load: L,
) -> L {
    let (zero, limit) = (L::splat(0.0), L::splat(SLIP_SPEED));
    let (k, lever) = (L::load(&block.twist_response), L::load(&block.lever));
    let turns = L::gt(k, L::splat(1e-12));
    let old = L::load(&block.twist);
    let wanted = old - rate / L::select(turns, k, L::splat(1.0));
    let held = grip * lever * load;
    let slip = L::max(wanted.abs() - held, zero) * k * lever;
    let most = L::select(L::gt(slip, limit), L::load(&block.sliding) * lever * load, held);
    let new = L::select(turns, L::min(L::max(wanted, -most), most), old);
    new.store(&mut block.twist);
    new - old
}

/// Applies a torque against the relative spin, limited to the lever arm times the load.
#[inline(always)]
fn visit_rolling<L: Lanes, const N: usize, const T: usize>(
    block: &Block<N, T>,
    rolling: &mut Rolling,
    ends: &mut [Motion<L>; 2],
) {
    let spin = ends[1].angular - ends[0].angular;
    let old = load3::<L>(&rolling.impulse);
    let answer = times(&rolling.inverse, spin);
    let most = L::load(&rolling.lever) * L::load(&block.load);
    let new = disk::step_in_ball(old, spin, answer, L::load(&rolling.trace), most);
    store3(new, &mut rolling.impulse);
    let change = new - old;
    let zero = L::splat(0.0);
    let none = Vector3::new(zero, zero, zero);
    ends[0].push(zero, &block.inertia[0], none, -change);
    ends[1].push(zero, &block.inertia[1], none, change);
}

/// Conjugate step of a block, applied before its visit in a sweep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Step {
    #[default]
    None,
    /// Stores the block's impulses.
    Begin,
    /// Moves by a share of the search direction and stores the result. The new direction is that share plus the change of the last sweep.
    GoOn(f32),
}
