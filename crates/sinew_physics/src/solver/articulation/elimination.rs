//! Eliminates a joint's open directions from the articulated inertia of its child (Featherstone 1983), at the joint's anchor. The inertia
//! in the locked directions is added to the parent unchanged. An open direction is eliminated by a pivot that includes the gains `G = 1/Γ`
//! of springs, motors and friction.
//!
//! With inertia `I` and impulse `p` of the child at the anchor, the velocities `V = V_p + u` of child and parent
//! there, and an open direction `s` of gain `g`:
//! ```text
//! w = I s        d = sᵀw + g        u = (sᵀp − wᵀV_p)/d
//! I −= w wᵀ/d    p −= w sᵀp/d
//! ```
//! Several directions are eliminated one after the other, or three rotations together with a 3×3 pivot.
//!
//! Residuals are not eliminated. Residuals of rows with gains are impulses on both bodies. If locked rows request a
//! velocity `t` of the child at the anchor, the parent gets `−I' t`, with `I'` the inertia that the parent gets. The
//! child then follows `t` in the same way as it follows its parent ([`Elimination::follow`]). With `p − I t` instead,
//! the solve would contain the difference of two large numbers.
//!
//! The code is generic over [`Real`]: one tree, or eight of the same shape side by side. Numbers that are equal in all lanes are broadcast
//! by [`Spread`].

use crate::solver::tuning::LEAST_PIVOT;
use sinew_math::Vec3;
use sinew_math::lanes::{Real, Vector3};

/// A number as stored in memory: one for all lanes, or one for each lane.
pub(crate) trait Spread<R>: Copy {
    /// Loads the number into the lanes.
    fn spread(self) -> R;
}

impl<R: Real> Spread<R> for f32 {
    #[inline(always)]
    fn spread(self) -> R {
        R::splat(self)
    }
}

impl<R: Real> Spread<R> for f64 {
    #[inline(always)]
    fn spread(self) -> R {
        R::splat_wide(self)
    }
}

#[inline(always)]
fn spread<N: Spread<R>, R: Real>(v: Vector3<N>) -> Vector3<R> {
    Vector3::new(v.x.spread(), v.y.spread(), v.z.spread())
}

/// Symmetric 3×3 matrix: xx, xy, xz, yy, yz, zz.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Symmetric<R>(pub [R; 6]);

/// 3×3 matrix, row by row.
pub(crate) type Matrix<R> = [Vector3<R>; 3];

#[inline(always)]
fn spread_rows<N: Spread<R>, R: Real>(m: &Matrix<N>) -> Matrix<R> {
    [spread(m[0]), spread(m[1]), spread(m[2])]
}

/// Converts to double precision: in trees with mass ratios of 1 : 100,000, cancellation uses up all digits of `f32`.
#[inline(always)]
pub(crate) fn wide(v: Vec3) -> Vector3<f64> {
    Vector3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z))
}

#[inline(always)]
pub(crate) fn zero<R: Real>() -> Vector3<R> {
    let zero = R::splat(0.0);
    Vector3::new(zero, zero, zero)
}

#[inline(always)]
fn zeros<R: Real>() -> Matrix<R> {
    [zero(), zero(), zero()]
}

/// Computes `mᵀ v`.
#[inline(always)]
pub(crate) fn transposed_times<R: Real>(m: &Matrix<R>, v: Vector3<R>) -> Vector3<R> {
    m[0] * v.x + m[1] * v.y + m[2] * v.z
}

/// Computes `m v`.
#[inline(always)]
pub(crate) fn times<R: Real>(m: &Matrix<R>, v: Vector3<R>) -> Vector3<R> {
    Vector3::new(m[0].dot(v), m[1].dot(v), m[2].dot(v))
}

#[inline(always)]
pub(crate) fn columns<R: Real>(m: &Matrix<R>) -> Matrix<R> {
    let [a, b, c] = *m;
    [Vector3::new(a.x, b.x, c.x), Vector3::new(a.y, b.y, c.y), Vector3::new(a.z, b.z, c.z)]
}

/// Computes `1/pivot`, or zero if the pivot is not safely positive.
#[inline(always)]
fn reciprocal<R: Real>(pivot: R, of: R) -> R {
    let safe = R::gt(pivot, of * R::splat(LEAST_PIVOT));
    (R::splat(1.0) / pivot).masked(safe)
}

impl<N: Copy> Symmetric<N> {
    #[inline(always)]
    fn spread<R: Real>(&self) -> Symmetric<R>
    where
        N: Spread<R>,
    {
        let [a, b, c, d, e, f] = self.0;
        Symmetric([a.spread(), b.spread(), c.spread(), d.spread(), e.spread(), f.spread()])
    }
}

impl<R: Real> Symmetric<R> {
    #[inline(always)]
    pub fn zero() -> Self {
        Self([R::splat(0.0); 6])
    }

    #[inline(always)]
    pub fn rows(&self) -> Matrix<R> {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        [Vector3::new(xx, xy, xz), Vector3::new(xy, yy, yz), Vector3::new(xz, yz, zz)]
    }

    #[inline(always)]
    pub fn times(&self, v: Vector3<R>) -> Vector3<R> {
        times(&self.rows(), v)
    }

    #[inline(always)]
    pub fn plus(&self, other: &Self) -> Self {
        let ([a, b, c, d, e, f], [g, h, i, j, k, l]) = (self.0, other.0);
        Self([a + g, b + h, c + i, d + j, e + k, f + l])
    }

    #[inline(always)]
    pub fn minus(&self, other: &Self) -> Self {
        let ([a, b, c, d, e, f], [g, h, i, j, k, l]) = (self.0, other.0);
        Self([a - g, b - h, c - i, d - j, e - k, f - l])
    }

    /// Inertia of a direction-dependent mass, about a point at distance vector `r` from the mass.
    #[inline(always)]
    pub fn at(&self, r: Vector3<R>) -> Inertia<R> {
        let [a0, a1, a2] = self.rows();
        let coupling = [a0.cross(r), a1.cross(r), a2.cross(r)];
        let [x, y, z] = columns(&coupling);
        let [x, y, z] = [x.cross(r), y.cross(r), z.cross(r)];
        Inertia { mass: *self, coupling, rotation: Symmetric([x.x, y.x, z.x, y.y, z.y, z.z]) }
    }

    /// Adds `v vᵀ k`.
    #[inline(always)]
    pub fn add_outer(&mut self, v: Vector3<R>, k: R) {
        let u = v * k;
        *self = self.plus(&Self([u.x * v.x, u.x * v.y, u.x * v.z, u.y * v.y, u.y * v.z, u.z * v.z]));
    }

    /// Inverse of a positive definite matrix by LDLᵀ. A pivot that is not safely positive contributes nothing.
    #[inline(always)]
    pub fn inverse(&self) -> Self {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        let d0 = reciprocal(xx, xx);
        let (l10, l20) = (xy * d0, xz * d0);
        let d1 = reciprocal(yy - l10 * xy, yy);
        let t = yz - l20 * xy;
        let l21 = t * d1;
        let d2 = reciprocal(zz - l20 * xz - l21 * t, zz);
        // The rows of L⁻¹ below its unit diagonal are (−l10) and (l10 l21 − l20, −l21).
        let i20 = l10 * l21 - l20;
        let (a, b, c) = (i20 * d2, l21 * d2, l10 * d1);
        Self([d0 + l10 * c + i20 * a, -(c + a * l21), a, d1 + l21 * b, -b, d2])
    }
}

/// Articulated-body inertia (Featherstone) of a body and the links below it about a reference point: momentum `A v + C ω`, angular momentum `Cᵀ v + B ω`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inertia<R> {
    pub mass: Symmetric<R>,
    /// Rows of C.
    pub coupling: Matrix<R>,
    pub rotation: Symmetric<R>,
}

/// Velocity or impulse: linear and angular part.
pub(crate) type Twist<R> = [Vector3<R>; 2];

impl<R: Real> Inertia<R> {
    /// Inertia of one body about its centre.
    #[inline(always)]
    pub fn of_body(mass: R, rotation: Symmetric<R>) -> Self {
        let none = R::splat(0.0);
        Self { mass: Symmetric([mass, none, none, mass, none, mass]), coupling: zeros(), rotation }
    }

    #[inline(always)]
    pub fn zero() -> Self {
        Self { mass: Symmetric::zero(), coupling: zeros(), rotation: Symmetric::zero() }
    }

    /// Returns the same inertia about a point `r` away from the present reference point.
    #[inline(always)]
    pub fn shifted(&self, r: Vector3<R>) -> Self {
        let [a0, a1, a2] = self.mass.rows();
        let [c0, c1, c2] = self.coupling;
        let coupling = [c0 + a0.cross(r), c1 + a1.cross(r), c2 + a2.cross(r)];
        // B + Cᵀ[r] + [r]ᵀC'
        let [x0, x1, x2] = columns(&self.coupling);
        let [x0, x1, x2] = [x0.cross(r), x1.cross(r), x2.cross(r)];
        let [y0, y1, y2] = columns(&coupling);
        let [y0, y1, y2] = [y0.cross(r), y1.cross(r), y2.cross(r)];
        let more = Symmetric([x0.x + y0.x, x0.y + y1.x, x0.z + y2.x, x1.y + y1.y, x1.z + y2.y, x2.z + y2.z]);
        Self { mass: self.mass, coupling, rotation: self.rotation.plus(&more) }
    }

    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        self.mass = self.mass.plus(&other.mass);
        for (row, other) in self.coupling.iter_mut().zip(other.coupling) {
            *row = *row + other;
        }
        self.rotation = self.rotation.plus(&other.rotation);
    }

    /// Adds the inertia of a spring, `j jᵀ k` with `j = (force, torque)`.
    #[inline(always)]
    pub fn add_row(&mut self, force: Vector3<R>, torque: Vector3<R>, k: R) {
        self.mass.add_outer(force, k);
        self.rotation.add_outer(torque, k);
        for (row, f) in self.coupling.iter_mut().zip(force.to_array()) {
            *row = *row + torque * (f * k);
        }
    }

    /// Momentum of a velocity.
    #[inline(always)]
    pub fn times(&self, [v, w]: Twist<R>) -> Twist<R> {
        let ([p, l], [q, m]) = (self.times_part(false, v), self.times_part(true, w));
        [p + q, l + m]
    }

    /// Momentum of a pure translation or of a pure rotation.
    #[inline(always)]
    fn times_part(&self, turns: bool, way: Vector3<R>) -> Twist<R> {
        if turns {
            [times(&self.coupling, way), self.rotation.times(way)]
        } else {
            [self.mass.times(way), transposed_times(&self.coupling, way)]
        }
    }

    /// Eliminates an open direction with the given gain. `start` is the inertia before any elimination. Returns `I s` and `1/d`.
    #[inline(always)]
    pub fn eliminate(&mut self, start: &Self, (turns, way): (bool, Vector3<R>), gain: R) -> (Twist<R>, R) {
        let [force, torque] = self.times_part(turns, way);
        let pivot = (if turns { torque } else { force }).dot(way) + gain;
        let inverse = reciprocal(pivot, start.along(turns, way));
        self.add_row(force, torque, -inverse);
        ([force, torque], inverse)
    }

    /// Inertia in the direction `way`: its mass for a translation, its moment of inertia for a rotation (`turns`).
    #[inline(always)]
    fn along(&self, turns: bool, way: Vector3<R>) -> R {
        (if turns { &self.rotation } else { &self.mass }).times(way).dot(way)
    }
}

/// Elimination of a joint's open directions.
pub(crate) trait Elimination<N> {
    /// Ascends: converts an impulse on the child at its centre to one on the parent at the parent's centre. Replaces `kept` by the values
    /// that the descent needs.
    fn ascend<R: Real>(&self, impulse: Twist<R>, kept: &mut [R; 6]) -> Twist<R>
    where
        N: Spread<R>;

    /// Descends: computes the velocity of the child at its centre from the velocity of the parent at the parent's centre.
    fn descend<R: Real>(&self, parent: Twist<R>, kept: &[R; 6]) -> Twist<R>
    where
        N: Spread<R>;

    /// Descends from a velocity at the anchor: that of the anchor on the parent, or the requested velocity of the child.
    fn follow<R: Real>(&self, anchor: Twist<R>, kept: &[R; 6]) -> Twist<R>
    where
        N: Spread<R>;

    /// Descends with the parent at rest.
    fn descend_alone<R: Real>(&self, kept: &[R; 6]) -> Twist<R>
    where
        N: Spread<R>;
}

/// Motions that a [`Swivel`] leaves open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Freedom {
    /// All motions: the body is the free root of its tree.
    All,
    /// All rotations and no translation.
    Rotation,
    /// All rotations, with gains, and no translation.
    DrivenRotation,
}

/// Three open rotations, eliminated together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Swivel<N> {
    freedom: Freedom,
    /// World arms from the centres of mass of child and parent to the anchor.
    arm: Vector3<N>,
    parent_arm: Vector3<N>,
    /// Articulated inertia of the child about the anchor.
    inertia: Inertia<N>,
    /// G.
    pub gain: Symmetric<N>,
    /// (B + G)⁻¹, and rows of C (B + G)⁻¹. For a free body also the inverse of the remaining mass.
    pivot: Symmetric<N>,
    coupled: Matrix<N>,
    free: Symmetric<N>,
}

impl<R: Real> Swivel<R> {
    /// Creates a swivel whose child has this articulated inertia about its centre.
    #[inline(always)]
    pub fn new(freedom: Freedom, [arm, parent_arm]: [Vector3<R>; 2], child: &Inertia<R>) -> Self {
        Self {
            freedom,
            arm,
            parent_arm,
            inertia: child.shifted(arm),
            gain: Symmetric::zero(),
            pivot: Symmetric::zero(),
            coupled: zeros(),
            free: Symmetric::zero(),
        }
    }

    /// Creates a swivel whose child has this articulated inertia about the anchor.
    #[inline(always)]
    pub fn at_anchor(freedom: Freedom, inertia: Inertia<R>) -> Self {
        let (arm, parent_arm, gain) = (zero(), zero(), Symmetric::zero());
        let (pivot, coupled, free) = (Symmetric::zero(), zeros(), Symmetric::zero());
        Self { freedom, arm, parent_arm, inertia, gain, pivot, coupled, free }
    }

    /// Vector from the parent's centre of mass to the anchor.
    #[inline(always)]
    pub fn parent_arm(&self) -> Vector3<R> {
        self.parent_arm
    }

    /// (B + G)⁻¹ and rows of C (B + G)⁻¹; valid after [`factor`](Self::factor).
    #[inline(always)]
    pub fn pivots(&self) -> (Symmetric<R>, Matrix<R>) {
        (self.pivot, self.coupled)
    }

    /// Inverse of a free body's remaining mass; valid after [`factor`](Self::factor).
    #[inline(always)]
    pub fn inverse_mass(&self) -> Symmetric<R> {
        self.free
    }

    /// Inertia of the child about the anchor in the direction `way`: mass, or moment of inertia if `turns`.
    #[inline(always)]
    pub fn weight(&self, turns: bool, way: Vector3<R>) -> R {
        self.inertia.along(turns, way)
    }

    /// Factors and returns the articulated inertia that the parent gets, about its centre.
    #[inline(always)]
    pub fn factor(&mut self) -> Inertia<R> {
        let i = self.inertia;
        let turned = match self.freedom {
            Freedom::DrivenRotation => i.rotation.plus(&self.gain),
            _ => i.rotation,
        };
        self.pivot = turned.inverse();
        let [cx, cy, cz] = i.coupling;
        let [x, y, z] = [self.pivot.times(cx), self.pivot.times(cy), self.pivot.times(cz)];
        self.coupled = [x, y, z];
        let taken = Symmetric([x.dot(cx), x.dot(cy), x.dot(cz), y.dot(cy), y.dot(cz), z.dot(cz)]);
        let mass = i.mass.minus(&taken);
        match self.freedom {
            Freedom::All => {
                self.free = mass.inverse();
                Inertia::zero()
            }
            Freedom::Rotation => mass.at(-self.parent_arm),
            Freedom::DrivenRotation => {
                // C Y G, and G Y B.
                let coupling = [self.gain.times(x), self.gain.times(y), self.gain.times(z)];
                let ([gx, gy, gz], [_, by, bz]) = (self.gain.rows(), i.rotation.rows());
                let first = i.rotation.times(self.pivot.times(gx));
                let (second, third) = (self.pivot.times(gy), self.pivot.times(gz));
                let rotation =
                    Symmetric([first.x, first.y, first.z, second.dot(by), second.dot(bz), third.dot(bz)]);
                Inertia { mass, coupling, rotation }.shifted(-self.parent_arm)
            }
        }
    }
}

impl<N: Copy> Elimination<N> for Swivel<N> {
    #[inline(always)]
    fn ascend<R: Real>(&self, [force, torque]: Twist<R>, kept: &mut [R; 6]) -> Twist<R>
    where
        N: Spread<R>,
    {
        let torque = torque - spread(self.arm).cross(force);
        let force = force - times(&spread_rows(&self.coupled), torque);
        [kept[0], kept[1], kept[2]] = torque.to_array();
        [kept[3], kept[4], kept[5]] = force.to_array();
        let at = spread(self.parent_arm).cross(force);
        if self.freedom == Freedom::DrivenRotation {
            // The inertia is B + G minus B.
            return [force, self.gain.spread().times(self.pivot.spread().times(torque)) + at];
        }
        [force, at]
    }

    #[inline(always)]
    fn descend<R: Real>(&self, [v, w]: Twist<R>, kept: &[R; 6]) -> Twist<R>
    where
        N: Spread<R>,
    {
        let at = match self.freedom {
            Freedom::All => self.free.spread().times(Vector3::new(kept[3], kept[4], kept[5])),
            _ => v + w.cross(spread(self.parent_arm)),
        };
        self.follow([at, w], kept)
    }

    #[inline(always)]
    fn follow<R: Real>(&self, [at, w]: Twist<R>, kept: &[R; 6]) -> Twist<R>
    where
        N: Spread<R>,
    {
        let mut torque = Vector3::new(kept[0], kept[1], kept[2]);
        if self.freedom == Freedom::DrivenRotation {
            torque = torque + self.gain.spread().times(w);
        }
        let w = self.pivot.spread().times(torque) - transposed_times(&spread_rows(&self.coupled), at);
        [at + spread(self.arm).cross(w), w]
    }

    #[inline(always)]
    fn descend_alone<R: Real>(&self, kept: &[R; 6]) -> Twist<R>
    where
        N: Spread<R>,
    {
        if self.freedom == Freedom::All {
            return self.descend([zero(), zero()], kept);
        }
        let w = self.pivot.spread().times(Vector3::new(kept[0], kept[1], kept[2]));
        [spread(self.arm).cross(w), w]
    }
}

/// An open direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Opening<N> {
    turns: bool,
    /// Axis along which the child slides, or about which it turns.
    way: Vector3<N>,
    gain: N,
    /// `I s` and `1/d`.
    momentum: Twist<N>,
    inverse: N,
}

/// Open directions that are eliminated one after the other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sequence<N> {
    /// World arms from the centres of mass of child and parent to the anchor.
    arm: Vector3<N>,
    parent_arm: Vector3<N>,
    /// Articulated inertia of the child about the anchor.
    inertia: Inertia<N>,
    openings: [Opening<N>; 6],
    open: usize,
}

impl<R: Real> Sequence<R> {
    /// Creates a sequence without open directions whose child has this articulated inertia about its centre.
    #[inline(always)]
    pub fn new([arm, parent_arm]: [Vector3<R>; 2], child: &Inertia<R>) -> Self {
        let none = R::splat(0.0);
        let opening =
            Opening { turns: false, way: zero(), gain: none, momentum: [zero(), zero()], inverse: none };
        Self { arm, parent_arm, inertia: child.shifted(arm), openings: [opening; 6], open: 0 }
    }

    /// Opens a direction, in which the child moves by `way` and a spring or motor resists with `gain`.
    #[inline(always)]
    pub fn push(&mut self, turns: bool, way: Vector3<R>, gain: R) {
        let opening = &mut self.openings[self.open];
        (opening.turns, opening.way, opening.gain) = (turns, way, gain);
        self.open += 1;
    }

    /// Vector from the parent's centre of mass to the anchor.
    #[inline(always)]
    pub fn parent_arm(&self) -> Vector3<R> {
        self.parent_arm
    }

    /// Inertia of the child about the anchor in the direction `way`: mass, or moment of inertia if `turns`.
    #[inline(always)]
    pub fn weight(&self, turns: bool, way: Vector3<R>) -> R {
        self.inertia.along(turns, way)
    }

    /// Factors and returns the articulated inertia that the parent gets, about its centre.
    #[inline(always)]
    pub fn factor(&mut self) -> Inertia<R> {
        let mut left = self.inertia;
        for open in &mut self.openings[..self.open] {
            (open.momentum, open.inverse) = left.eliminate(&self.inertia, (open.turns, open.way), open.gain);
        }
        left.shifted(-self.parent_arm)
    }
}

impl<N: Copy> Elimination<N> for Sequence<N> {
    #[inline(always)]
    fn ascend<R: Real>(&self, [force, torque]: Twist<R>, kept: &mut [R; 6]) -> Twist<R>
    where
        N: Spread<R>,
    {
        let mut left = [force, torque - spread(self.arm).cross(force)];
        for (open, kept) in self.openings[..self.open].iter().zip(kept) {
            let along = spread(open.way).dot(left[usize::from(open.turns)]);
            *kept = along * open.inverse.spread();
            let [p, l] = open.momentum;
            left = [left[0] - spread(p) * *kept, left[1] - spread(l) * *kept];
        }
        let [force, torque] = left;
        [force, torque + spread(self.parent_arm).cross(force)]
    }

    #[inline(always)]
    fn descend<R: Real>(&self, [v, w]: Twist<R>, kept: &[R; 6]) -> Twist<R>
    where
        N: Spread<R>,
    {
        self.follow([v + w.cross(spread(self.parent_arm)), w], kept)
    }

    #[inline(always)]
    fn follow<R: Real>(&self, [mut v, mut w]: Twist<R>, kept: &[R; 6]) -> Twist<R>
    where
        N: Spread<R>,
    {
        for (open, &kept) in self.openings[..self.open].iter().zip(kept).rev() {
            let [p, l] = open.momentum;
            let resisted = (spread(p).dot(v) + spread(l).dot(w)) * open.inverse.spread();
            let by = spread(open.way) * (kept - resisted);
            if open.turns {
                w = w + by;
            } else {
                v = v + by;
            }
        }
        [v + spread(self.arm).cross(w), w]
    }

    #[inline(always)]
    fn descend_alone<R: Real>(&self, kept: &[R; 6]) -> Twist<R>
    where
        N: Spread<R>,
    {
        self.descend([zero(), zero()], kept)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_math::{Random, Rotation, Sym3};

    /// An open direction: rotational or not, its axis, its gain.
    type Open = (bool, Vector3<f64>, f64);

    /// Returns a random body of `mass`, kg.
    fn body(random: &mut Random, mass: f32) -> Inertia<f64> {
        let size = random.range(0.05, 0.5);
        let moments = Vec3::new(random.range(0.5, 1.0), random.range(0.5, 1.0), random.range(0.5, 1.0))
            * (mass * size * size);
        let Sym3 { diagonal: d, off: o } = Sym3::from_rotated_diagonal(random.rotation(), moments);
        Inertia::of_body(f64::from(mass), Symmetric([d.x, o.z, o.y, d.y, o.x, d.z].map(f64::from)))
    }

    fn vector(random: &mut Random) -> Vector3<f64> {
        wide(random.direction() * random.range(0.1, 0.5))
    }

    /// Checks the joint of two free bodies: locked directions do not move, gains alone push the open directions, and momentum is conserved
    /// between the bodies.
    fn check(
        joint: &impl Elimination<f64>,
        through: &Inertia<f64>,
        ([arm, parent_arm], open): ([Vector3<f64>; 2], &[Open]),
        [child, parent]: [&Inertia<f64>; 2],
        random: &mut Random,
    ) {
        let mut whole = *parent;
        whole.add(through);
        let mut root = Swivel::new(Freedom::All, [zero(); 2], &whole);
        root.factor();
        let pushes = [[vector(random), vector(random)], [vector(random), vector(random)]];
        let (mut kept, mut kept_by_root) = ([0.0; 6], [0.0; 6]);
        let [f, t] = joint.ascend(pushes[0], &mut kept);
        root.ascend([pushes[1][0] + f, pushes[1][1] + t], &mut kept_by_root);
        let of_parent = root.descend_alone(&kept_by_root);
        let of_child = joint.descend(of_parent, &kept);

        let slide = (of_child[0] + of_child[1].cross(arm)) - (of_parent[0] + of_parent[1].cross(parent_arm));
        let motion = [slide, of_child[1] - of_parent[1]];
        let gained = child.times(of_child);
        let force = gained[0] - pushes[0][0];
        let on_child = [force, gained[1] - pushes[0][1] - arm.cross(force)];
        let mut held = motion;
        for &(turns, way, gain) in open {
            let part = usize::from(turns);
            let rate = motion[part].dot(way);
            held[part] = held[part] - way * rate;
            assert!((on_child[part].dot(way) + gain * rate).abs() < 2e-4, "{open:?}");
        }
        let scale = of_child[0].length() + of_child[1].length() + of_parent[1].length() + 1e-3;
        assert!(held[0].length() + held[1].length() < 1e-4 * scale, "{open:?}: {held:?}");
        let lost = parent.times(of_parent);
        let sums =
            [lost[0] - pushes[1][0] + force, lost[1] - pushes[1][1] + on_child[1] + parent_arm.cross(force)];
        assert!(sums[0].length() + sums[1].length() < 2e-4, "{open:?}: {sums:?}");
    }

    #[test]
    fn elimination_locks_rows_drives_open_ones_and_conserves_momentum() {
        let mut random = Random::new(3);
        for round in 0..400 {
            let (light, heavy) = (1.0, random.range(1.0, 100.0));
            let (child, parent) = if round % 2 == 0 { (light, heavy) } else { (heavy, light) };
            let (child, parent) = (body(&mut random, child), body(&mut random, parent));
            let arms = [vector(&mut random), vector(&mut random)];
            let frame: Rotation = random.rotation();
            let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| wide(frame * axis));
            let mut open = Vec::new();
            for k in 0..6 {
                if (round % 64) & (1 << k) != 0 {
                    let gain =
                        if random.range(0.0, 1.0) < 0.5 { 0.0 } else { f64::from(random.range(0.0, 2.0)) };
                    open.push((k >= 3, axes[k % 3], gain));
                }
            }
            let mut sequence = Sequence::new(arms, &child);
            for &(turns, way, gain) in &open {
                sequence.push(turns, way, gain);
            }
            let through = sequence.factor();
            check(&sequence, &through, (arms, &open), [&child, &parent], &mut random);

            let driven = round % 3 == 0;
            let freedom = if driven { Freedom::DrivenRotation } else { Freedom::Rotation };
            let mut swivel = Swivel::new(freedom, arms, &child);
            let gain = if driven { [0.3, 0.0, 20.0] } else { [0.0; 3] };
            let open: Vec<_> = (0..3).map(|k| (true, axes[k], gain[k])).collect();
            for &(_, axis, gain) in &open {
                swivel.gain.add_outer(axis, gain);
            }
            let through = swivel.factor();
            check(&swivel, &through, (arms, &open), [&child, &parent], &mut random);
        }
    }

    #[test]
    fn zero_pivot_locks_the_direction_without_nan() {
        let flat = Symmetric([1.0, 1.0, 0.0, 1.0, 0.0, f64::NAN]);
        assert!(flat.inverse().0.iter().take(2).all(|x| x.is_finite()));
        assert_eq!(Symmetric::<f64>::zero().inverse().0, [0.0; 6]);
        assert_eq!(reciprocal(f64::INFINITY, f64::INFINITY), 0.0);
    }
}
