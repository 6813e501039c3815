//! Writes eight contacts to a block: converts manifolds to geometry about the centres of their bodies, in lanes. Each lane has the same
//! bits as `Geometry` and `weights` compute for its contact.

use super::block::{Block, Eight, HELD, Memory, NONE, ZERO8, gather, store3};
use super::geometry::FAR;
use super::prepare::Source;
use super::record::{FRICTION, IMPULSES, POINTS, SHAPE, fields};
use crate::solver::contact_rows::Softness;
use crate::solver::tuning::{DEAD_ZONE, WEIGHT_EVENLY, WEIGHT_OF_LOAD};
use sinew_math::lanes::{LaneMask, Lanes, Vector3, WIDTH};

/// Input that is collected lane by lane before all lanes are written together.
struct Each {
    places: [u32; WIDTH],
    /// 1 if both bodies are moved by contacts.
    both_move: Eight,
    softness: Eight,
    bias: Eight,
    push_speed: Eight,
    /// Separation below which points bear load.
    bearing: Eight,
    /// Velocity of B's surface minus that of A's, then its spin.
    surface: [Eight; 6],
}

/// Normal and friction directions of eight manifolds.
struct Axes<L> {
    normal: Vector3<L>,
    tangents: [Vector3<L>; 2],
}

/// Writes a block except for the responses of its rows. Returns true if a contact of the block may bounce.
#[inline(always)]
pub(super) fn write<L: Lanes, const N: usize, const T: usize>(
    block: &mut Block<N, T>,
    memory: &mut Memory<N>,
    edges: &[u32],
    source: &Source<'_>,
) -> bool {
    let each = write_ends(block, memory, edges, source);
    let axes = write_shape::<L, N, T>(block, memory, &each, source);
    write_softness::<L, N>(memory, &each, &source.soft);
    write_friction::<L, N, T>(block, memory, &axes, &each, source);
    (block.rolling, memory.bounce, block.is_stale) = (NONE, NONE, false);
    L::gt(L::load(&memory.restitution), L::splat(0.0)).any()
}

/// Writes bodies and contacts. Empty lanes repeat the last contact with its bodies flagged as held.
#[inline(always)]
fn write_ends<const N: usize, const T: usize>(
    block: &mut Block<N, T>,
    memory: &mut Memory<N>,
    edges: &[u32],
    source: &Source<'_>,
) -> Each {
    let mut each = Each {
        places: [0; WIDTH],
        both_move: ZERO8,
        softness: ZERO8,
        bias: ZERO8,
        push_speed: ZERO8,
        bearing: [f32::INFINITY; WIDTH],
        surface: [ZERO8; 6],
    };
    for lane in 0..WIDTH {
        let is_empty = lane >= edges.len();
        let place = edges[if is_empty { edges.len() - 1 } else { lane }];
        let edge = &source.edges[place as usize];
        each.places[lane] = place;
        each.softness[lane] = edge.firmness.softness;
        each.bias[lane] = edge.firmness.bias;
        each.push_speed[lane] = edge.firmness.push_speed;
        let mut both_move = !is_empty;
        for end in 0..2 {
            let moves = (edge.bodies[end] as usize) < source.of.moving;
            both_move &= moves;
            block.bodies[end][lane] = edge.bodies[end] | if moves && !is_empty { 0 } else { HELD };
        }
        each.both_move[lane] = if both_move { 1.0 } else { 0.0 };
        memory.contacts[lane] = if is_empty { NONE } else { edge.contact };
        if edge.extra != NONE {
            each.take_extra(lane, source, place);
        }
    }
    each
}

impl Each {
    fn take_extra(&mut self, lane: usize, source: &Source<'_>, place: u32) {
        let extra = &source.extras[source.edges[place as usize].extra as usize];
        let surface = extra.velocity.to_array().into_iter().chain(extra.spin.to_array());
        for (row, number) in self.surface.iter_mut().zip(surface) {
            row[lane] = number;
        }
        if extra.rolls {
            self.bearing[lane] = source.records[place as usize].slop();
        }
    }
}

/// Writes points, separations, and the point at which friction acts.
#[inline(always)]
fn write_shape<L: Lanes, const N: usize, const T: usize>(
    block: &mut Block<N, T>,
    memory: &mut Memory<N>,
    each: &Each,
    source: &Source<'_>,
) -> Axes<L> {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let [nx, ny, nz, round_a, round, slop, share, count] = fields::<L>(source.records, &each.places, SHAPE);
    let normal = Vector3::new(nx, ny, nz);
    let tangent = any_orthonormal(normal);
    let center_a = centers::<L>(source, &block.bodies[0]);
    store3(center_a - centers::<L>(source, &block.bodies[1]), &mut block.offset);
    let (mut at, mut gaps, mut there) = ([normal; N], [zero; N], [L::lt(zero, zero); N]);
    let (mut now, mut load) = ([zero; N], zero);
    let stretch = L::splat(source.of.stretch);
    for row in 0..N.div_ceil(2) {
        let [x, y, z, gap, u, v, w, next] = fields::<L>(source.records, &each.places, POINTS + row);
        let impulses = fields::<L>(source.records, &each.places, IMPULSES + row);
        let points = [(Vector3::new(x, y, z), gap), (Vector3::new(u, v, w), next)];
        for k in 0..usize::min(N, 2) {
            let i = 2 * row + k;
            let (point, gap) = points[k];
            there[i] = L::lt(L::splat(i as f32), count);
            at[i] = point + normal * (share * gap) - center_a;
            gaps[i] = gap;
            let [last, before, lasting] = [impulses[4 * k], impulses[4 * k + 1], impulses[4 * k + 3]];
            now[i] = last;
            load = L::select(there[i], load + last, load);
            (last * stretch).store(&mut block.impulse[i]);
            (before * stretch).store(&mut memory.before[i]);
            (lasting * stretch).store(&mut memory.lasting[i]);
            zero.store(&mut memory.total[i]);
        }
    }
    // Smoothed shares of the load, for the points that bear load.
    let (bearing, mut heirs) = (L::load(&each.bearing), zero);
    for i in 0..N {
        heirs = heirs + one.masked(there[i] & L::le(gaps[i], bearing));
    }
    let (loaded, nobody) = (L::gt(load, zero), L::eq(heirs, zero));
    let mut center = Vector3::splat(sinew_math::Vec3::ZERO);
    let (mut arms, mut weights) = ([normal; N], [zero; N]);
    for i in 0..N {
        let even = L::select(nobody, one / count, (one / heirs).masked(L::le(gaps[i], bearing)));
        let part = L::select(loaded, now[i] / load, even);
        weights[i] = L::splat(WEIGHT_OF_LOAD) * part + L::splat(WEIGHT_EVENLY) * even;
        center = select3(there[i], center + at[i] * weights[i], center);
        // Unused points repeat the first point and are too far to touch.
        arms[i] = select3(there[i], at[i] - normal * round_a, arms[0]);
        let gap = L::select(there[i], gaps[i], L::splat(FAR));
        store3(arms[i], &mut block.arms[i]);
        gap.store(&mut memory.start[i]);
        gap.store(&mut block.separation[i]);
    }
    let mut lever = zero;
    let middle = center - normal * round_a;
    for i in 0..N {
        let arm = (arms[i] - middle).length() * weights[i];
        lever = L::select(there[i] & L::gt(count, one), lever + arm, lever);
    }
    store3(normal, &mut block.normal);
    store3(tangent, &mut block.tangent);
    store3(center, &mut block.center);
    round.store(&mut memory.round);
    lever.store(&mut block.lever);
    (L::splat(DEAD_ZONE) * slop).store(&mut memory.dead_zone);
    Axes { normal, tangents: [tangent, normal.cross(tangent)] }
}

/// Writes the softness of the contacts.
#[inline(always)]
fn write_softness<L: Lanes, const N: usize>(memory: &mut Memory<N>, each: &Each, soft: &[Softness; 2]) {
    let both_move = L::gt(L::load(&each.both_move), L::splat(0.0));
    let [moving, fixed] = soft;
    let bias_rate = L::load(&each.bias) * pick::<L>(both_move, moving.bias_rate, fixed.bias_rate);
    bias_rate.store(&mut memory.bias_rate);
    memory.push_speed = each.push_speed;
    // The mean response of the points scales the softness; the division of their sum is done here.
    let softness = L::load(&each.softness) * pick::<L>(both_move, moving.impulse_scale, fixed.impulse_scale)
        / pick::<L>(both_move, moving.mass_scale, fixed.mass_scale)
        / L::splat((N * N) as f32);
    softness.store(&mut memory.softness);
}

#[inline(always)]
fn pick<L: Lanes>(mask: L::Mask, a: f32, b: f32) -> L {
    L::select(mask, L::splat(a), L::splat(b))
}

/// Writes surface velocities, coefficients of friction and restitution, and the friction of the last substep.
#[inline(always)]
fn write_friction<L: Lanes, const N: usize, const T: usize>(
    block: &mut Block<N, T>,
    memory: &mut Memory<N>,
    axes: &Axes<L>,
    each: &Each,
    source: &Source<'_>,
) {
    let zero = L::splat(0.0);
    let [x, y, z, twist, sliding, holding, restitution, launch] =
        fields::<L>(source.records, &each.places, FRICTION);
    let stretch = L::splat(source.of.stretch);
    let friction = Vector3::new(x, y, z) * stretch;
    let [vx, vy, vz, wx, wy, wz] = &each.surface;
    let velocity = Vector3::<L>::load(vx, vy, vz);
    for k in 0..2 {
        friction.dot(axes.tangents[k]).store(&mut block.friction[k]);
        axes.tangents[k].dot(velocity).store(&mut block.surface[k]);
        zero.store(&mut memory.total_friction[k]);
    }
    axes.normal.dot(Vector3::<L>::load(wx, wy, wz)).store(&mut block.surface[2]);
    (twist * stretch).store(&mut block.twist);
    zero.store(&mut block.load);
    zero.store(&mut block.last_load);
    sliding.store(&mut block.sliding);
    holding.store(&mut block.holding);
    restitution.store(&mut memory.restitution);
    launch.store(&mut memory.launch);
}

/// Centres of eight bodies in the world at the start of the step, metres.
#[inline(always)]
fn centers<L: Lanes>(source: &Source<'_>, bodies: &[u32; WIDTH]) -> Vector3<L> {
    let [x, y, z, ..] = gather::<L>(source.centers, bodies);
    Vector3::new(x, y, z)
}

#[inline(always)]
fn select3<L: Lanes>(mask: L::Mask, a: Vector3<L>, b: Vector3<L>) -> Vector3<L> {
    Vector3::new(L::select(mask, a.x, b.x), L::select(mask, a.y, b.y), L::select(mask, a.z, b.z))
}

/// `sinew_math::any_orthonormal` in each lane.
#[inline(always)]
fn any_orthonormal<L: Lanes>(n: Vector3<L>) -> Vector3<L> {
    let one = L::splat(1.0);
    let sign = L::select(L::ge(n.z, L::splat(0.0)), one, -one);
    let a = -one / (sign + n.z);
    Vector3::new(one + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x)
}
