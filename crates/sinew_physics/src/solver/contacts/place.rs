//! Updates the values that depend on body poses: separations, target rates of the points in a pass, and responses of rows.

use super::block::{Block, Bounce, HELD, Memory, Motion, NONE, ZERO8, gather, load3, packed, store3, times};
use crate::solver::contact_rows::NEVER;
use crate::solver::pass::Pass;
use crate::solver::tuning::{POINT_PROXIMAL, RELAX_TURN};
use crate::spatial::Vec6;
use sinew_math::lanes::{Lanes, Vector3};

/// Motion of each body since the step began: translation (x, y, z), then rotation (x, y, z, w).
pub(super) struct Moved<'a>(pub &'a [Vec6]);

/// Change of a direction, in the axes of a body, by the body's rotation since the step began: `Rᵀ n − n`.
#[inline(always)]
fn leaned<L: Lanes>(rotation: [L; 4], n: Vector3<L>) -> Vector3<L> {
    let (two, u) = (L::splat(2.0), Vector3::new(rotation[0], rotation[1], rotation[2]));
    let across = u.cross(n);
    (u.cross(across) - across * rotation[3]) * two
}

/// Computes separations at the present poses, with the normals and points of the step's beginning.
#[inline(always)]
pub(super) fn measure<L: Lanes, const N: usize, const T: usize>(
    block: &mut Block<N, T>,
    memory: &Memory<N>,
    moved: &Moved<'_>,
) {
    let n = load3::<L>(&block.normal);
    let [ax, ay, az, au, av, aw, a_real, _] = gather::<L>(moved.0, &block.bodies[0]);
    let [bx, by, bz, bu, bv, bw, b_real, _] = gather::<L>(moved.0, &block.bodies[1]);
    let lean_a = leaned([au, av, aw, a_real], n);
    let lean_b = leaned([bu, bv, bw, b_real], n);
    let shared = n.dot(Vector3::new(bx - ax, by - ay, bz - az)) + lean_b.dot(load3::<L>(&block.offset));
    let (along, round) = (lean_b.dot(n), L::load(&memory.round));
    let lean = lean_b - lean_a;
    for i in 0..N {
        let start = L::load(&memory.start[i]);
        let turned = lean.dot(load3::<L>(&block.arms[i])) + (start + round) * along;
        (start + shared + turned).store(&mut block.separation[i]);
    }
}

/// Sets the target rate and softness of each point in a pass.
#[inline(always)]
pub(super) fn aim<L: Lanes, const N: usize, const T: usize>(
    block: &mut Block<N, T>,
    memory: &Memory<N>,
    bounces: &[Bounce<N>],
    pass: Pass,
    h: f32,
) {
    if pass == Pass::Solve {
        block.floor = [ZERO8; N];
    }
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let launch = -L::load(&memory.launch);
    let softness = softness_at_center::<L, N, T>(block, memory);
    for i in 0..N {
        let s = L::load(&block.separation[i]);
        let apart = L::gt(s, zero);
        let closes = s / L::splat(h);
        let (target, soft) = if pass == Pass::Solve {
            let overlap = L::min(s + L::load(&memory.dead_zone), zero);
            let push = L::max(L::load(&memory.bias_rate) * overlap, -L::load(&memory.push_speed));
            let bias = L::min(push, launch) - softness * L::load(&memory.lasting[i]);
            (L::select(apart, closes, bias), L::select(apart, zero, softness))
        } else {
            (L::select(apart, closes, launch), zero)
        };
        target.store(&mut block.target[i]);
        let response = L::load(&block.response[packed(i, i)]) * L::splat(1.0 + POINT_PROXIMAL) + soft;
        let moves = L::gt(response, zero);
        (one / L::select(moves, response, one)).masked(moves).store(&mut block.gain[i]);
    }
    if memory.bounce != NONE && pass != Pass::Solve {
        let bounce = &bounces[memory.bounce as usize];
        for i in 0..N {
            // A point that will bounce but has not touched yet is not braked; a point that was hit leaves with its rebound speed.
            let comes = L::gt(L::load(&block.separation[i]), zero)
                & L::gt(L::load(&memory.restitution), zero)
                & L::eq(L::load(&block.impulse[i]), zero);
            let rebound = L::load(&bounce.rebound[i]);
            let mut target = L::select(comes, L::splat(NEVER), L::load(&block.target[i]));
            if pass == Pass::Restitution {
                target = L::select(L::gt(rebound, zero), -rebound, target);
            }
            target.store(&mut block.target[i]);
        }
    }
}

/// Raises the lower bounds of impulses in `relax`. It may take back excess impulses of `solve`, except from bodies that turned by more than
/// a small angle since: an impulse taken back at another pose adds energy (a hand went from 70 to 2,700 rad/s).
#[inline(always)]
pub(super) fn raise_floor<L: Lanes, const N: usize, const T: usize>(
    block: &mut Block<N, T>,
    velocities: &[Vec6],
    h: f32,
) {
    let most = L::splat(RELAX_TURN / h);
    let [a, b] = [
        Motion::<L>::gather(velocities, &block.bodies[0]).angular.length(),
        Motion::<L>::gather(velocities, &block.bodies[1]).angular.length(),
    ];
    let whirls = L::ge(a, most) | L::ge(b, most);
    for i in 0..N {
        L::load(&block.impulse[i]).masked(whirls).store(&mut block.floor[i]);
    }
}

/// Softness of the block, computed at the manifold's centre; computed at each point, a 1 kg foot under 69 kg sinks by 7 mm.
#[inline(always)]
fn softness_at_center<L: Lanes, const N: usize, const T: usize>(
    block: &Block<N, T>,
    memory: &Memory<N>,
) -> L {
    let mut sum = L::splat(0.0);
    for i in 0..N {
        for j in 0..N {
            sum = sum + L::load(&block.response[packed(i, j)]);
        }
    }
    L::load(&memory.softness) * sum
}

/// Computes the levers of the points, and the responses of all rows to each other, from arms, masses and inertias.
#[inline(always)]
pub(super) fn respond<L: Lanes, const N: usize, const T: usize>(block: &mut Block<N, T>) {
    let zero = L::splat(0.0);
    let n = load3::<L>(&block.normal);
    let lever = load3::<L>(&block.offset).cross(n);
    let mass = L::load(&block.mass[0]) + L::load(&block.mass[1]);
    let none = Vector3::new(zero, zero, zero);
    let (mut arms, mut turned) = ([[none; 2]; N], [[none; 2]; N]);
    for i in 0..N {
        let arm = load3::<L>(&block.arms[i]).cross(n);
        store3(arm, &mut block.levers[i]);
        arms[i] = [arm, arm + lever];
        turned[i] = [times(&block.inertia[0], arms[i][0]), times(&block.inertia[1], arms[i][1])];
    }
    for i in 0..N {
        for j in 0..=i {
            let answer = mass + arms[i][0].dot(turned[j][0]) + arms[i][1].dot(turned[j][1]);
            answer.store(&mut block.response[packed(i, j)]);
        }
    }
    let t0 = load3::<L>(&block.tangent);
    let t1 = n.cross(t0);
    let arm_a = load3::<L>(&block.center);
    let arm_b = arm_a + load3::<L>(&block.offset);
    let [a0, a1] = [arm_a.cross(t0), arm_a.cross(t1)];
    let [b0, b1] = [arm_b.cross(t0), arm_b.cross(t1)];
    let (ia0, ia1) = (times(&block.inertia[0], a0), times(&block.inertia[0], a1));
    let (ib0, ib1) = (times(&block.inertia[1], b0), times(&block.inertia[1], b1));
    let raised = L::splat(1.0 + POINT_PROXIMAL);
    ((mass + a0.dot(ia0) + b0.dot(ib0)) * raised).store(&mut block.tangent_response[0]);
    (a0.dot(ia1) + b0.dot(ib1)).store(&mut block.tangent_response[1]);
    ((mass + a1.dot(ia1) + b1.dot(ib1)) * raised).store(&mut block.tangent_response[2]);
    let spin = times(&block.inertia[0], n) + times(&block.inertia[1], n);
    (n.dot(spin) * raised).store(&mut block.twist_response);
    n.dot(ia0 + ib0).store(&mut block.twist_to_tangents[0]);
    n.dot(ia1 + ib1).store(&mut block.twist_to_tangents[1]);
}

/// Stores inverse masses and inertias of the bodies of a block: mass, then xx, yy, zz, yz, xz, xy. Fixed bodies and empty lanes have zeros.
#[inline(always)]
pub(super) fn take_inertias<L: Lanes, const N: usize, const T: usize>(
    block: &mut Block<N, T>,
    inverse: &[Vec6],
) {
    for end in 0..2 {
        let rows = gather::<L>(inverse, &block.bodies[end]);
        let held = block.bodies[end].map(|body| if body & HELD == 0 { 0.0 } else { 1.0 });
        let moves = L::eq(L::load(&held), L::splat(0.0));
        rows[0].masked(moves).store(&mut block.mass[end]);
        for k in 0..6 {
            rows[1 + k].masked(moves).store(&mut block.inertia[end][k]);
        }
    }
}
