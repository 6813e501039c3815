//! Impulses from substep to substep: warm start, stored impulses, bounce.

use super::block::{Block, Bounce, Memory, Motion, NONE, Rolling, load3, store3};
use super::visit::sum;
use crate::slices::SharedRows;
use crate::solver::tuning::{BOUNCE_SPEED, IMPACT_JUMP, LASTING};
use crate::spatial::Vec6;
use sinew_math::lanes::{Lanes, Vector3};

/// Applies the starting impulses to the bodies: those of the last substep. If these increased sharply, scales them down
/// to the sum of the substep before, since an impact must not be repeated. At rest the load moves between points, so
/// sums over all points are compared.
#[inline(always)]
pub(super) fn warm_start<L: Lanes, const N: usize, const T: usize>(
    block: &mut Block<N, T>,
    memory: &mut Memory<N>,
    rolling: &mut SharedRows<'_, Rolling>,
    velocities: &mut SharedRows<'_, Vec6>,
) {
    let now = sum::<L, N>(&block.impulse);
    // A conjugate step may leave slightly negative impulses.
    let before = L::max(sum::<L, N>(&memory.before), L::splat(0.0));
    let jumps = L::gt(now, L::splat(IMPACT_JUMP) * before);
    let one = L::splat(1.0);
    let share = L::select(jumps, before / L::select(jumps, now, one), one);
    now.store(&mut block.last_load);
    memory.before = block.impulse;
    for i in 0..N {
        (L::load(&block.impulse[i]) * share).store(&mut block.impulse[i]);
    }
    for i in 0..2 {
        (L::load(&block.friction[i]) * share).store(&mut block.friction[i]);
    }
    (L::load(&block.twist) * share).store(&mut block.twist);
    if block.rolling != NONE {
        let rolling = rolling.get_mut(block.rolling as usize);
        store3(load3::<L>(&rolling.impulse) * share, &mut rolling.impulse);
    }
    let given = Given::<L>::of(block, |place| rolling.get(place));
    for end in 0..2 {
        let mut motion = Motion::<L>::gather(velocities, &block.bodies[end]);
        let sign = L::splat(if end == 0 { -1.0 } else { 1.0 });
        let (mass, inertia) = (L::load(&block.mass[end]), &block.inertia[end]);
        motion.push(mass, inertia, given.impulse * sign, given.torques[end] * sign);
        motion.scatter(velocities, &block.bodies[end]);
    }
}

/// Total impulses of all rows of a block: impulse on B, and torques about both centres; A gets the opposite impulse.
struct Given<L> {
    impulse: Vector3<L>,
    torques: [Vector3<L>; 2],
}

impl<L: Lanes> Given<L> {
    #[inline(always)]
    fn of<'r, const N: usize, const T: usize>(
        block: &Block<N, T>,
        rolling: impl Fn(usize) -> &'r Rolling,
    ) -> Self {
        let zero = L::splat(0.0);
        let (n, t0) = (load3::<L>(&block.normal), load3::<L>(&block.tangent));
        let (mut push, mut levers) = (zero, Vector3::new(zero, zero, zero));
        for i in 0..N {
            let given = L::load(&block.impulse[i]);
            push = push + given;
            levers = levers + load3::<L>(&block.arms[i]) * given;
        }
        let friction = t0 * L::load(&block.friction[0]) + n.cross(t0) * L::load(&block.friction[1]);
        let mut turn = n * L::load(&block.twist);
        if block.rolling != NONE {
            turn = turn + load3::<L>(&rolling(block.rolling as usize).impulse);
        }
        let impulse = n * push + friction;
        let on_a = levers.cross(n) + load3::<L>(&block.center).cross(friction) + turn;
        Self { impulse, torques: [on_a, on_a + load3::<L>(&block.offset).cross(impulse)] }
    }
}

/// Adds the total impulses of a block, times `sign`, to those of its bodies.
#[inline(always)]
pub(super) fn add_impulses<L: Lanes, const N: usize, const T: usize>(
    block: &Block<N, T>,
    rolling: &[Rolling],
    impulses: &mut [Vec6],
    sign: f32,
) {
    let given = Given::<L>::of(block, |place| &rolling[place]);
    for end in 0..2 {
        let mut sum = Motion::<L>::gather(impulses, &block.bodies[end]);
        let sign = L::splat(if end == 0 { -sign } else { sign });
        sum.linear = sum.linear + given.impulse * sign;
        sum.angular = sum.angular + given.torques[end] * sign;
        sum.scatter(impulses, &block.bodies[end]);
    }
}

/// Stores the impulses of this substep for the next one.
#[inline(always)]
pub(super) fn end_substep<L: Lanes, const N: usize, const T: usize>(
    block: &Block<N, T>,
    memory: &mut Memory<N>,
    h: f32,
) {
    let rate = L::splat(h / (h + LASTING));
    for i in 0..N {
        let now = L::load(&block.impulse[i]);
        (L::load(&memory.total[i]) + now).store(&mut memory.total[i]);
        let lasting = L::load(&memory.lasting[i]);
        (lasting + (now - lasting) * rate).store(&mut memory.lasting[i]);
    }
    for i in 0..2 {
        (L::load(&memory.total_friction[i]) + L::load(&block.friction[i]))
            .store(&mut memory.total_friction[i]);
    }
}

/// Normal rates of the points.
#[inline(always)]
fn rates<L: Lanes, const N: usize, const T: usize>(block: &Block<N, T>, velocities: &[Vec6]) -> [L; N] {
    let (n, offset) = (load3::<L>(&block.normal), load3::<L>(&block.offset));
    let a = Motion::<L>::gather(velocities, &block.bodies[0]);
    let b = Motion::<L>::gather(velocities, &block.bodies[1]);
    let shared = n.dot(b.linear - a.linear) + b.angular.dot(offset.cross(n));
    let turning = b.angular - a.angular;
    let mut rates = [shared; N];
    for i in 0..N {
        rates[i] = shared + turning.dot(load3::<L>(&block.levers[i]));
    }
    rates
}

/// Records the approach of the points at the start of the substep.
#[inline(always)]
pub(super) fn begin_approach<L: Lanes, const N: usize, const T: usize>(
    block: &Block<N, T>,
    bounce: &mut Bounce<N>,
    velocities: &[Vec6],
) {
    let zero = L::splat(0.0);
    let rates = rates::<L, N, T>(block, velocities);
    for i in 0..N {
        rates[i].store(&mut bounce.rate[i]);
        L::max(L::load(&block.separation[i]), zero).store(&mut bounce.gap[i]);
        zero.store(&mut bounce.pull[i]);
    }
}

/// Records the speed toward the surface added by forces.
#[inline(always)]
pub(super) fn pull_approach<L: Lanes, const N: usize, const T: usize>(
    block: &Block<N, T>,
    bounce: &mut Bounce<N>,
    velocities: &[Vec6],
) {
    let rates = rates::<L, N, T>(block, velocities);
    for i in 0..N {
        L::max(L::load(&bounce.rate[i]) - rates[i], L::splat(0.0)).store(&mut bounce.pull[i]);
    }
}

/// Marks points that approached fast and were hit: they bounce as high as their speed at the surface allows. A velocity
/// of symplectic Euler is that of half a substep ago, and forces continue to accelerate the point between its present
/// position and the surface.
#[inline(always)]
pub(super) fn end_approach<L: Lanes, const N: usize, const T: usize>(
    block: &Block<N, T>,
    bounce: &mut Bounce<N>,
    restitution: L,
    h: f32,
) {
    let (zero, half) = (L::splat(0.0), L::splat(0.5));
    for i in 0..N {
        let (pull, gap) = (L::load(&bounce.pull[i]), L::load(&bounce.gap[i]));
        let now = L::load(&bounce.rate[i]) - half * pull;
        let square = now * now + L::splat(2.0) * (pull / L::splat(h)) * gap;
        let speed = square.sqrt().masked(L::lt(now, zero));
        let bounces = L::gt(L::load(&block.impulse[i]), zero)
            & L::gt(speed, L::splat(BOUNCE_SPEED))
            & L::gt(restitution, zero);
        (restitution * speed + half * pull).masked(bounces).store(&mut bounce.rebound[i]);
    }
}

/// Adds the bounce impulses of this substep to the sums, and restores the impulses to those before the bounce.
#[inline(always)]
pub(super) fn end_bounce<L: Lanes, const N: usize, const T: usize>(
    block: &mut Block<N, T>,
    memory: &mut Memory<N>,
    bounce: &Bounce<N>,
) {
    for i in 0..N {
        let added = L::load(&block.impulse[i]) - L::load(&bounce.held[i]);
        (L::load(&memory.total[i]) + added).store(&mut memory.total[i]);
    }
    block.impulse = bounce.held;
}
