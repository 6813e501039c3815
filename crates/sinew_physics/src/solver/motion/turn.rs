//! Rotations of eight bodies side by side, and the spin of a free body through a substep.

use crate::solver::tuning::{MIDPOINT_STEPS, MIDPOINT_TOLERANCE, MOST_HALF_TURN};
use sinew_math::lanes::{LaneMask, Lanes, Real, Vector3, WIDTH};
use sinew_math::{Rotation, Vec3};

/// Half of the angle up to which the series of a rotation are accurate, radians. Bodies that turn farther are rotated individually.
pub const MOST_SERIES: f32 = 1.5;

/// Eight [rotations](Rotation), or one.
#[derive(Clone, Copy)]
pub struct Turn<R> {
    pub vector: Vector3<R>,
    pub real: R,
}

impl<R: Real> Turn<R> {
    /// Returns this rotation followed by `by`, which is given in this rotation's own axes.
    #[inline(always)]
    pub fn then_own(self, by: Self) -> Self {
        let vector = self.vector * by.real + by.vector * self.real + self.vector.cross(by.vector);
        Self { vector, real: self.real * by.real - self.vector.dot(by.vector) }.normalized()
    }

    /// Returns the product of two rotations without normalisation; `first` is applied first.
    #[inline(always)]
    pub fn product(self, first: Self) -> Self {
        let (a, b) = (self.vector, first.vector);
        let vector = b * self.real + a * first.real + a.cross(b);
        Self { vector, real: self.real * first.real - a.x * b.x - (a.y * b.y + a.z * b.z) }
    }

    /// Returns this rotation followed by `by`, which is given in world axes.
    #[inline(always)]
    pub fn then(self, by: Self) -> Self {
        by.then_own(self)
    }

    #[inline(always)]
    fn normalized(self) -> Self {
        let Self { vector, real } = self;
        let scale = R::splat(1.0) / (vector.dot(vector) + real * real).sqrt();
        Self { vector: vector * scale, real: real * scale }
    }

    #[inline(always)]
    pub fn inverse(self) -> Self {
        Self { vector: -self.vector, real: self.real }
    }

    /// Rotates a vector.
    #[inline(always)]
    pub fn turned(self, v: Vector3<R>) -> Vector3<R> {
        let across = self.vector.cross(v) * R::splat(2.0);
        v + across * self.real + self.vector.cross(across)
    }

    /// Rotates one axis by each of the rotations.
    #[inline(always)]
    pub fn turned_axis(self, axis: Vec3) -> Vector3<R> {
        self.turned(Vector3::new(R::splat(axis.x), R::splat(axis.y), R::splat(axis.z)))
    }

    /// Rotates a vector by the inverse.
    #[inline(always)]
    pub fn turned_back(self, v: Vector3<R>) -> Vector3<R> {
        self.inverse().turned(v)
    }

    /// Rotation about `half` by twice its length, radians; valid up to twice [`MOST_SERIES`].
    #[inline(always)]
    pub fn by_half_angles(half: Vector3<R>) -> Self {
        let angle = half.length();
        Self { vector: half * sin_over(angle), real: cos(angle) }
    }

    /// Returns the columns of the rotation matrix: the images of the three axes.
    #[inline(always)]
    fn columns(self) -> [Vector3<R>; 3] {
        let [x, y, z] = self.vector.to_array();
        let (w, one, two) = (self.real, R::splat(1.0), R::splat(2.0));
        [
            Vector3::new(one - two * (y * y + z * z), two * (x * y + w * z), two * (x * z - w * y)),
            Vector3::new(two * (x * y - w * z), one - two * (x * x + z * z), two * (y * z + w * x)),
            Vector3::new(two * (x * z + w * y), two * (y * z - w * x), one - two * (x * x + y * y)),
        ]
    }

    /// Rotates a tensor with principal moments `d` to world axes: diagonal, and xy, xz, yz.
    #[inline(always)]
    pub fn rotated_diagonal(self, d: Vector3<R>) -> [Vector3<R>; 2] {
        let [x, y, z] = self.columns();
        let diagonal = Vector3::new(
            x.x * x.x * d.x + y.x * y.x * d.y + z.x * z.x * d.z,
            x.y * x.y * d.x + y.y * y.y * d.y + z.y * z.y * d.z,
            x.z * x.z * d.x + y.z * y.z * d.y + z.z * z.z * d.z,
        );
        let off = Vector3::new(
            x.y * x.z * d.x + y.y * y.z * d.y + z.y * z.z * d.z,
            x.x * x.z * d.x + y.x * y.z * d.y + z.x * z.z * d.z,
            x.x * x.y * d.x + y.x * y.y * d.y + z.x * z.y * d.z,
        );
        [diagonal, off]
    }
}

impl<L: Lanes> Turn<L> {
    /// Rotations in double precision with 2 over their squared length, for [`turn`](Rotation::turn).
    #[inline(always)]
    pub fn exact(self) -> Exact<L> {
        let vector = widen(self.vector);
        let real = self.real.widen();
        let square = vector.x * vector.x + vector.y * vector.y + vector.z * vector.z + real * real;
        Exact { vector, real, scale: L::Wide::splat(2.0) / square }
    }

    /// Converts spins to angular momenta, for inertias of 1/`moments`.
    #[inline(always)]
    pub fn angular_momentum(self, spin: Vector3<L>, moments: Vector3<L>) -> Vector3<L> {
        let exact = self.exact();
        exact.turned(times(exact.turned_back(spin), moments))
    }

    #[inline(always)]
    pub fn store(self) -> [Rotation; WIDTH] {
        let vector = vectors(self.vector);
        let mut real = [0.0; WIDTH];
        self.real.store(&mut real);
        let mut out = [Rotation::IDENTITY; WIDTH];
        for k in 0..WIDTH {
            out[k] = Rotation::from_xyzw(vector[k].x, vector[k].y, vector[k].z, real[k]);
        }
        out
    }
}

/// Computes eight times [`Rotation::turn`], corrected for quaternion lengths that differ from 1.
#[derive(Clone, Copy)]
pub struct Exact<L: Lanes> {
    vector: Vector3<L::Wide>,
    real: L::Wide,
    scale: L::Wide,
}

impl<L: Lanes> Exact<L> {
    /// Rotates a vector.
    #[inline(always)]
    pub fn turned(self, v: Vector3<L>) -> Vector3<L> {
        let v = widen(v);
        let across = self.vector.cross(v);
        narrow(v + (across * self.real + self.vector.cross(across)) * self.scale)
    }

    /// Rotates a vector by the inverse.
    #[inline(always)]
    pub fn turned_back(self, v: Vector3<L>) -> Vector3<L> {
        Self { vector: -self.vector, ..self }.turned(v)
    }
}

#[inline(always)]
pub fn widen<L: Lanes>(v: Vector3<L>) -> Vector3<L::Wide> {
    Vector3::new(v.x.widen(), v.y.widen(), v.z.widen())
}

#[inline(always)]
pub fn narrow<L: Lanes>(v: Vector3<L::Wide>) -> Vector3<L> {
    Vector3::new(L::narrow(v.x), L::narrow(v.y), L::narrow(v.z))
}

/// Angular velocity at the midpoint of a substep of a free body, from that at its beginning; principal axes.
///
/// The implicit midpoint `I (m − ω) + τ m × I m = 0` conserves energy and the length of the momentum to rounding. With the Cayley map for
/// the rotation, `2 atan(τ|m|)` about `m`, it conserves the momentum itself (after Austin, Krishnaprasad and Wang 1993), for any `τ`. With
/// `τ = tan(½h|m|) / |m|` the angle is `h|m|`, so `m` is the actual spin that joints and contacts use. An explicit gyroscopic torque would
/// explode; without the torque, tops move wrongly.
#[inline(always)]
pub fn middle_of_spin<L: Lanes>(start: Vector3<L>, i: Vector3<L>, h: L) -> Vector3<L> {
    let half = h * L::splat(0.5);
    let tolerance = start.dot(start) * L::splat(MIDPOINT_TOLERANCE);
    let mut m = start;
    let mut done = L::eq(i.x, i.y) & L::eq(i.y, i.z);
    for _ in 0..MIDPOINT_STEPS {
        if done.all() {
            break;
        }
        let angle = L::min(half * m.length(), L::splat(MOST_HALF_TURN));
        let tau = half * (sin_over(angle) / cos(angle));
        let [x, y, z] = (m * tau).to_array();
        // Columns of the Jacobian I + τ (m× I − (I m)×), ignoring the dependency of τ on m.
        let a = Vector3::new(i.x, z * (i.x - i.z), y * (i.y - i.x));
        let b = Vector3::new(z * (i.z - i.y), i.y, x * (i.y - i.x));
        let c = Vector3::new(y * (i.z - i.y), x * (i.x - i.z), i.z);
        let error = times(m - start, i) + m.cross(times(m, i)) * tau;
        let across = b.cross(c);
        let change = Vector3::new(error.dot(across), a.dot(error.cross(c)), a.dot(b.cross(error)));
        let change = divided(change, a.dot(across));
        let next = m - change;
        m = Vector3::new(
            L::select(done, m.x, next.x),
            L::select(done, m.y, next.y),
            L::select(done, m.z, next.z),
        );
        done = done | L::le(change.dot(change), tolerance);
    }
    m
}

/// Computes `sin(x)/x` to 5e-8 for |x| below 1.6.
#[inline(always)]
fn sin_over<R: Real>(x: R) -> R {
    series(x * x, [1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0, -1.0 / 39_916_800.0, 0.0])
}

/// Computes the cosine of x to 1e-8 for |x| below 1.6.
#[inline(always)]
fn cos<R: Real>(x: R) -> R {
    let last = 1.0 / 479_001_600.0;
    series(x * x, [1.0, -0.5, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40_320.0, -1.0 / 3_628_800.0, last])
}

#[inline(always)]
fn series<R: Real>(x: R, terms: [f32; 7]) -> R {
    let mut sum = R::splat(terms[6]);
    for k in (0..6).rev() {
        sum = sum * x + R::splat(terms[k]);
    }
    sum
}

/// Scale for numbers whose squares exceed the range of `f32`.
const OF_HUGE: f32 = 1e-20;

/// Factor, at most 1, that limits the length of a vector to `most`.
#[inline(always)]
pub fn within<L: Lanes>(v: Vector3<L>, most: f32) -> L {
    let largest = L::max(L::max(v.x.abs(), v.y.abs()), v.z.abs());
    let scale = L::select(L::gt(largest, L::splat(1e18)), L::splat(OF_HUGE), L::splat(1.0));
    let (length, most) = ((v * scale).length(), L::splat(most) * scale);
    let long = L::gt(length, most);
    L::select(long, most / L::select(long, length, most), L::splat(1.0))
}

#[inline(always)]
pub fn times<R: Real>(a: Vector3<R>, b: Vector3<R>) -> Vector3<R> {
    Vector3::new(a.x * b.x, a.y * b.y, a.z * b.z)
}

#[inline(always)]
pub fn over<R: Real>(a: Vector3<R>, b: Vector3<R>) -> Vector3<R> {
    Vector3::new(a.x / b.x, a.y / b.y, a.z / b.z)
}

#[inline(always)]
pub fn divided<R: Real>(a: Vector3<R>, by: R) -> Vector3<R> {
    Vector3::new(a.x / by, a.y / by, a.z / by)
}

#[inline(always)]
pub fn vectors<L: Lanes>(v: Vector3<L>) -> [Vec3; WIDTH] {
    let [mut x, mut y, mut z] = [[0.0; WIDTH]; 3];
    v.x.store(&mut x);
    v.y.store(&mut y);
    v.z.store(&mut z);
    let mut out = [Vec3::ZERO; WIDTH];
    for k in 0..WIDTH {
        out[k] = Vec3::new(x[k], y[k], z[k]);
    }
    out
}
