//! Eight manifolds of one colour, side by side. No two of them push the same body, so a sweep can solve them together.

use crate::slices::SharedRows;
use crate::spatial::Vec6;
use sinew_math::lanes::{Lanes, Vector3, WIDTH};

/// One number for each of the eight manifolds.
pub(super) type Eight = [f32; WIDTH];
/// One vector for each of the eight manifolds.
pub(super) type Eight3 = [Eight; 3];

pub(super) const ZERO8: Eight = [0.0; WIDTH];

/// Flag in the index of a body that contacts do not move, and in those of empty lanes.
pub(super) const HELD: u32 = 1 << 31;
/// Marks an empty lane, which has no contact.
pub(super) const NONE: u32 = u32::MAX;

/// Index of `(i, j)` of a symmetric matrix in its packed lower triangle, row by row.
#[inline(always)]
pub(super) const fn packed(i: usize, j: usize) -> usize {
    if i >= j { i * (i + 1) / 2 + j } else { j * (j + 1) / 2 + i }
}

/// Data of eight manifolds with up to `N` points that sweeps read and write; their responses to each other are `T = N (N + 1) / 2` numbers.
///
/// Points stay at their positions at the start of the step; the lanes of a body that turns fast are rewritten. World axes,
/// metres, kilograms, seconds.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub(super) struct Block<const N: usize, const T: usize> {
    /// Local indices of bodies A and B, with the flag [`HELD`].
    pub bodies: [[u32; WIDTH]; 2],
    /// Unit normal, from A to B.
    pub normal: Eight3,
    /// First direction of friction; the second is `normal × tangent`.
    pub tangent: Eight3,
    /// Vector from the centre of mass of B to that of A; an arm of A plus this is the arm of B.
    pub offset: Eight3,
    /// Inverse masses.
    pub mass: [Eight; 2],
    /// Inverse inertias: xx, yy, zz, yz, xz, xy.
    pub inertia: [[Eight; 6]; 2],
    /// Arm of each point crossed with the normal, about the centre of A.
    pub levers: [Eight3; N],
    /// Vector from the centre of A to the point at which friction acts.
    pub center: Eight3,
    /// Velocity bias of each point in this pass, m/s: the point may approach at up to this rate.
    pub target: [Eight; N],
    /// Response of the points' rates to their impulses, packed.
    pub response: [Eight; T],
    /// Inverse of each point's response to its own impulse, softness included.
    pub gain: [Eight; N],
    /// Response of the tangents (00, 01, 11), of the twist, and of the twist to the tangents.
    pub tangent_response: [Eight; 3],
    pub twist_response: Eight,
    pub twist_to_tangents: [Eight; 2],
    /// Normal impulses of this substep, and their lower bounds in `relax`.
    pub impulse: [Eight; N],
    pub floor: [Eight; N],
    pub friction: [Eight; 2],
    pub twist: Eight,
    /// Impulses before the last sweep with a conjugate step, and the search direction.
    pub was: Impulses<N>,
    pub direction: Impulses<N>,
    /// Sum of the normal impulses that limit friction, and that sum in the last substep.
    pub load: Eight,
    pub last_load: Eight,
    /// Coefficients of sliding and static friction.
    pub sliding: Eight,
    pub holding: Eight,
    /// Weighted distance of the points from the centre: lever arm of the twist friction.
    pub lever: Eight,
    /// Velocity of B's surface minus A's along both tangents, and its spin about the normal.
    pub surface: Eight3,
    /// Index of the rolling resistance of the block's manifolds, or [`NONE`].
    pub rolling: u32,
    /// True if a lane was rewritten, so that the responses have to be recomputed.
    pub is_stale: bool,
    /// Vector from the centre of A to each point. Sweeps read neither the arms nor the separations.
    pub arms: [Eight3; N],
    /// Separation of each point at the present poses; negative if the surfaces overlap.
    pub separation: [Eight; N],
}

/// Data of eight manifolds that is used once a substep.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub(super) struct Memory<const N: usize> {
    /// Indices in the world's contact array.
    pub contacts: [u32; WIDTH],
    /// Separations at the start of the step, and the sum of the radii of both shapes' roundings.
    pub start: [Eight; N],
    pub round: Eight,
    /// Overlap that is not corrected, metres.
    pub dead_zone: Eight,
    /// Rate at which overlap is corrected, 1/s, and the largest push-out speed, m/s.
    pub bias_rate: Eight,
    pub push_speed: Eight,
    /// Softness as a share of the response at the manifold's centre.
    pub softness: Eight,
    /// Prescribed separation speed of the surfaces, m/s.
    pub launch: Eight,
    pub restitution: Eight,
    /// Normal impulses of the second last substep, their sums over all substeps, and the lasting load.
    pub before: [Eight; N],
    pub total: [Eight; N],
    pub lasting: [Eight; N],
    /// Friction impulses of all substeps, along both tangents.
    pub total_friction: [Eight; 2],
    /// Index of the approach and rebound of the block's points, or [`NONE`] if no point may bounce.
    pub bounce: u32,
}

/// Approach and rebound of the points of eight manifolds, some of which may bounce.
#[derive(Clone, Debug)]
pub(super) struct Bounce<const N: usize> {
    /// Normal rate and gap at the start of the substep, m/s and metres; the gap of an overlapping point is 0.
    pub rate: [Eight; N],
    pub gap: [Eight; N],
    /// Speed toward the surface added by forces before contacts, m/s.
    pub pull: [Eight; N],
    /// Speed at which a point leaves, m/s; 0 if it does not bounce.
    pub rebound: [Eight; N],
    /// Normal impulses before the bounce.
    pub held: [Eight; N],
}

/// Rolling resistance of eight manifolds.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub(super) struct Rolling {
    /// Lever arm, metres: the largest torque is this times the load.
    pub lever: Eight,
    /// Inverse response of the relative spin to a torque: xx, yy, zz, yz, xz, xy; and its trace.
    pub inverse: [Eight; 6],
    pub trace: Eight,
    /// Impulse of the torque, world axes, N·m·s.
    pub impulse: Eight3,
}

impl<const N: usize, const T: usize> Block<N, T> {
    /// Creates a block of empty lanes.
    pub fn empty() -> Self {
        Self {
            bodies: [[HELD; WIDTH]; 2],
            normal: [ZERO8; 3],
            tangent: [ZERO8; 3],
            offset: [ZERO8; 3],
            mass: [ZERO8; 2],
            inertia: [[ZERO8; 6]; 2],
            levers: [[ZERO8; 3]; N],
            center: [ZERO8; 3],
            target: [ZERO8; N],
            response: [ZERO8; T],
            gain: [ZERO8; N],
            tangent_response: [ZERO8; 3],
            twist_response: ZERO8,
            twist_to_tangents: [ZERO8; 2],
            impulse: [ZERO8; N],
            floor: [ZERO8; N],
            friction: [ZERO8; 2],
            twist: ZERO8,
            was: Impulses::ZERO,
            direction: Impulses::ZERO,
            load: ZERO8,
            last_load: ZERO8,
            sliding: ZERO8,
            holding: ZERO8,
            lever: ZERO8,
            surface: [ZERO8; 3],
            rolling: NONE,
            is_stale: true,
            arms: [[ZERO8; 3]; N],
            separation: [ZERO8; N],
        }
    }
}

impl<const N: usize> Bounce<N> {
    /// Bounce of manifolds without bouncing points.
    pub const NONE: Self =
        Self { rate: [ZERO8; N], gap: [ZERO8; N], pull: [ZERO8; N], rebound: [ZERO8; N], held: [ZERO8; N] };
}

impl<const N: usize> Memory<N> {
    /// Creates the memory of empty lanes.
    pub fn empty() -> Self {
        Self {
            contacts: [NONE; WIDTH],
            start: [ZERO8; N],
            round: ZERO8,
            dead_zone: ZERO8,
            bias_rate: ZERO8,
            push_speed: ZERO8,
            softness: ZERO8,
            launch: ZERO8,
            restitution: ZERO8,
            before: [ZERO8; N],
            total: [ZERO8; N],
            lasting: [ZERO8; N],
            total_friction: [ZERO8; 2],
            bounce: NONE,
        }
    }
}

/// Loads one vector for each of eight manifolds.
#[inline(always)]
pub(super) fn load3<L: Lanes>(from: &Eight3) -> Vector3<L> {
    Vector3::load(&from[0], &from[1], &from[2])
}

#[inline(always)]
pub(super) fn store3<L: Lanes>(v: Vector3<L>, to: &mut Eight3) {
    v.x.store(&mut to[0]);
    v.y.store(&mut to[1]);
    v.z.store(&mut to[2]);
}

/// Multiplies symmetric matrices (xx, yy, zz, yz, xz, xy) by vectors.
#[inline(always)]
pub(super) fn times<L: Lanes>(m: &[Eight; 6], v: Vector3<L>) -> Vector3<L> {
    let (xx, yy, zz) = (L::load(&m[0]), L::load(&m[1]), L::load(&m[2]));
    let (yz, xz, xy) = (L::load(&m[3]), L::load(&m[4]), L::load(&m[5]));
    Vector3::new(
        xx * v.x + xy * v.y + xz * v.z,
        xy * v.x + yy * v.y + yz * v.z,
        xz * v.x + yz * v.y + zz * v.z,
    )
}

/// A list with one row for each body.
pub(super) trait OfBodies {
    fn row(&self, body: usize) -> &Vec6;
}

impl OfBodies for [Vec6] {
    #[inline(always)]
    fn row(&self, body: usize) -> &Vec6 {
        &self[body]
    }
}

impl OfBodies for SharedRows<'_, Vec6> {
    #[inline(always)]
    fn row(&self, body: usize) -> &Vec6 {
        self.get(body)
    }
}

/// A writable list with one row for each body.
pub(super) trait WrittenOfBodies {
    fn row_mut(&mut self, body: usize) -> &mut Vec6;
}

impl WrittenOfBodies for [Vec6] {
    #[inline(always)]
    fn row_mut(&mut self, body: usize) -> &mut Vec6 {
        &mut self[body]
    }
}

impl WrittenOfBodies for SharedRows<'_, Vec6> {
    #[inline(always)]
    fn row_mut(&mut self, body: usize) -> &mut Vec6 {
        self.get_mut(body)
    }
}

/// Gathers eight rows of a list by the bodies' indices, field by field.
#[inline(always)]
pub(super) fn gather<L: Lanes>(rows: &(impl OfBodies + ?Sized), bodies: &[u32; WIDTH]) -> [L; WIDTH] {
    let [a, b, c, d, e, f, g, h] = *bodies;
    L::transpose([
        at(rows, a),
        at(rows, b),
        at(rows, c),
        at(rows, d),
        at(rows, e),
        at(rows, f),
        at(rows, g),
        at(rows, h),
    ])
}

#[inline(always)]
fn at<L: Lanes>(rows: &(impl OfBodies + ?Sized), body: u32) -> L {
    L::load(rows.row((body & !HELD) as usize))
}

/// Velocities of eight bodies.
#[derive(Clone, Copy)]
pub(super) struct Motion<L> {
    pub linear: Vector3<L>,
    pub angular: Vector3<L>,
}

impl<L: Lanes> Motion<L> {
    #[inline(always)]
    pub fn gather(velocities: &(impl OfBodies + ?Sized), bodies: &[u32; WIDTH]) -> Self {
        Self::of_columns(gather::<L>(velocities, bodies))
    }

    /// Converts rows to velocities.
    #[inline(always)]
    pub fn of(rows: [L; WIDTH]) -> Self {
        Self::of_columns(L::transpose(rows))
    }

    #[inline(always)]
    fn of_columns([x, y, z, u, v, w, _, _]: [L; WIDTH]) -> Self {
        Self { linear: Vector3::new(x, y, z), angular: Vector3::new(u, v, w) }
    }

    /// Writes the velocities of bodies that contacts move.
    #[inline(always)]
    pub fn scatter(self, velocities: &mut (impl WrittenOfBodies + ?Sized), bodies: &[u32; WIDTH]) {
        let rows = self.rows();
        for k in 0..WIDTH {
            if bodies[k] & HELD == 0 {
                rows[k].store(velocities.row_mut(bodies[k] as usize));
            }
        }
    }

    /// Converts to one row for each body.
    #[inline(always)]
    pub fn rows(self) -> [L; WIDTH] {
        let Self { linear: v, angular: w } = self;
        let zero = L::splat(0.0);
        L::transpose([v.x, v.y, v.z, w.x, w.y, w.z, zero, zero])
    }

    /// Applies an impulse and a torque; `inertia` and `mass` are inverse.
    #[inline(always)]
    pub fn push(&mut self, mass: L, inertia: &[Eight; 6], impulse: Vector3<L>, torque: Vector3<L>) {
        self.linear = self.linear + impulse * mass;
        self.angular = self.angular + times(inertia, torque);
    }

    /// Largest component of the change since `before`.
    #[inline(always)]
    pub fn change(self, before: Self) -> L {
        let (v, w) = ((self.linear - before.linear).abs(), (self.angular - before.angular).abs());
        L::max(L::max(L::max(v.x, v.y), L::max(v.z, w.x)), L::max(w.y, w.z))
    }
}

/// Impulses of all rows of a block.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub(super) struct Impulses<const N: usize> {
    pub normal: [Eight; N],
    pub friction: [Eight; 2],
    pub twist: Eight,
}

impl<const N: usize> Impulses<N> {
    pub const ZERO: Self = Self { normal: [ZERO8; N], friction: [ZERO8; 2], twist: ZERO8 };
}
