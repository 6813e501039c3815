//! Motion of the island's bodies, eight side by side: forces to velocities, velocities to poses, inertias, energies.

use super::articulated::{Inertia, Symmetric};
use super::{MIDPOINT_STEPS, MIDPOINT_TOLERANCE, MOST_HALF_TURN, SolverBody, advance};
use crate::spatial::{Vec6, ZERO6};
use sinew_math::dispatch::Kernel;
use sinew_math::lanes::{LaneMask, Lanes, Real, Vector3, WIDTH};
use sinew_math::{Rotation, Sym3, Transform, Vec3};

/// Half of the angle up to which the series of a turn are exact, radians. Beyond it, bodies are turned one by one.
const MOST_SERIES: f32 = 1.5;

/// A field of eight bodies, one in each lane.
macro_rules! field {
    ($eight:expr, $($path:tt)+) => {{
        let mut row = [0.0; WIDTH];
        for k in 0..WIDTH {
            row[k] = $eight[k].$($path)+;
        }
        L::load(&row)
    }};
}

/// A vector of eight bodies, one in each lane.
macro_rules! vector {
    ($eight:expr, $($path:tt)+) => {
        Vector3::<L>::new(field!($eight, $($path)+.x), field!($eight, $($path)+.y), field!($eight, $($path)+.z))
    };
}

/// The rotations of eight bodies, one in each lane.
macro_rules! rotation {
    ($eight:expr, $($path:tt)+) => {
        Turn::<L> { vector: vector!($eight, $($path)+), real: field!($eight, $($path)+.w) }
    };
}

/// Eight bodies from the `first` on; the last of all stands for those that are not there.
#[inline(always)]
fn eight_from<T>(all: &[T], first: usize) -> [&T; WIDTH] {
    let mut eight = [&all[first]; WIDTH];
    for (k, one) in eight.iter_mut().enumerate().skip(1) {
        *one = &all[usize::min(first + k, all.len() - 1)];
    }
    eight
}

/// Linear and angular velocities of eight bodies from the `first` on; zero of those that are not there.
#[inline(always)]
fn velocities_from<L: Lanes>(all: &[Vec6], first: usize) -> [Vector3<L>; 2] {
    let mut rows = [L::splat(0.0); WIDTH];
    for (row, v) in rows.iter_mut().zip(&all[first..]) {
        *row = L::load(v);
    }
    let [x, y, z, u, v, w, ..] = L::transpose(rows);
    [Vector3::new(x, y, z), Vector3::new(u, v, w)]
}

#[inline(always)]
fn store_velocities<L: Lanes>([linear, angular]: [Vector3<L>; 2], to: &mut [Vec6]) {
    let zero = L::splat(0.0);
    let fields = [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z, zero, zero];
    for (row, v) in L::transpose(fields).into_iter().zip(to) {
        row.store(v);
    }
}

#[inline(always)]
fn vectors<L: Lanes>(v: Vector3<L>) -> [Vec3; WIDTH] {
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

/// Eight [rotations](Rotation), or one.
#[derive(Clone, Copy)]
pub(super) struct Turn<R> {
    pub vector: Vector3<R>,
    pub real: R,
}

impl<R: Real> Turn<R> {
    /// After turning by another, which is given in this one's own axes.
    #[inline(always)]
    pub fn then_own(self, by: Self) -> Self {
        let vector = self.vector * by.real + by.vector * self.real + self.vector.cross(by.vector);
        Self { vector, real: self.real * by.real - self.vector.dot(by.vector) }.normalized()
    }

    /// After turning by another, which is given in the axes of the world.
    #[inline(always)]
    fn then(self, by: Self) -> Self {
        by.then_own(self)
    }

    #[inline(always)]
    fn normalized(self) -> Self {
        let Self { vector, real } = self;
        let scale = R::splat(1.0) / (vector.dot(vector) + real * real).sqrt();
        Self { vector: vector * scale, real: real * scale }
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        Self { vector: -self.vector, real: self.real }
    }

    /// A vector after the rotation.
    #[inline(always)]
    fn turned(self, v: Vector3<R>) -> Vector3<R> {
        let across = self.vector.cross(v) * R::splat(2.0);
        v + across * self.real + self.vector.cross(across)
    }

    /// A vector before the rotation.
    #[inline(always)]
    pub fn turned_back(self, v: Vector3<R>) -> Vector3<R> {
        self.inverse().turned(v)
    }

    /// Turn about `half` by twice its length, radians, up to twice [`MOST_SERIES`].
    #[inline(always)]
    pub fn by_half_angles(half: Vector3<R>) -> Self {
        let angle = half.length();
        Self { vector: half * sin_over(angle), real: cos(angle) }
    }

    /// Where the axes go.
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

    /// A tensor with principal moments `d` in the axes of the world: diagonal, and xy, xz, yz.
    #[inline(always)]
    fn rotated_diagonal(self, d: Vector3<R>) -> [Vector3<R>; 2] {
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
    /// Rotations with twice the digits and what is over their squared length: for [`turn`](Rotation::turn).
    #[inline(always)]
    fn exact(self) -> Exact<L> {
        let vector = widen(self.vector);
        let real = self.real.widen();
        let square = vector.x * vector.x + vector.y * vector.y + vector.z * vector.z + real * real;
        Exact { vector, real, scale: L::Wide::splat(2.0) / square }
    }

    /// Angular momenta for spins, or as much of them as inertias of 1/`moments` give.
    #[inline(always)]
    fn angular_momentum(self, spin: Vector3<L>, moments: Vector3<L>) -> Vector3<L> {
        let exact = self.exact();
        exact.turned(times(exact.turned_back(spin), moments))
    }

    #[inline(always)]
    fn store(self) -> [Rotation; WIDTH] {
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

/// Eight times [`Rotation::turn`]: without what the quaternions' lengths are off from 1 by.
#[derive(Clone, Copy)]
struct Exact<L: Lanes> {
    vector: Vector3<L::Wide>,
    real: L::Wide,
    scale: L::Wide,
}

impl<L: Lanes> Exact<L> {
    #[inline(always)]
    fn turned(self, v: Vector3<L>) -> Vector3<L> {
        let v = widen(v);
        let across = self.vector.cross(v);
        narrow(v + (across * self.real + self.vector.cross(across)) * self.scale)
    }

    #[inline(always)]
    fn turned_back(self, v: Vector3<L>) -> Vector3<L> {
        Self { vector: -self.vector, ..self }.turned(v)
    }
}

#[inline(always)]
fn widen<L: Lanes>(v: Vector3<L>) -> Vector3<L::Wide> {
    Vector3::new(v.x.widen(), v.y.widen(), v.z.widen())
}

#[inline(always)]
fn narrow<L: Lanes>(v: Vector3<L::Wide>) -> Vector3<L> {
    Vector3::new(L::narrow(v.x), L::narrow(v.y), L::narrow(v.z))
}

/// Forces to velocities, and the momenta that bodies have from then on. Gives their kinetic energy, J.
pub(super) struct IntegrateVelocity<'a> {
    pub bodies: &'a mut [SolverBody],
    pub velocities: &'a mut [Vec6],
    /// Substep, seconds.
    pub h: f32,
    /// Limits, m/s and rad/s.
    pub max_speed: f32,
    pub max_spin: f32,
}

impl Kernel for IntegrateVelocity<'_> {
    type Output = f32;

    #[inline(always)]
    fn run<L: Lanes>(self) -> f32 {
        let Self { bodies, velocities, max_speed, max_spin, .. } = self;
        let (h, one) = (L::splat(self.h), L::splat(1.0));
        let mut energy = 0.0;
        for first in (0..bodies.len()).step_by(WIDTH) {
            let eight = eight_from(bodies, first);
            let [linear, angular] = velocities_from::<L>(velocities, first);
            let (rotation, inertia) = (rotation!(eight, pose.rotation), vector!(eight, inertia));
            let mass = field!(eight, mass);
            let push = h * (one / (mass * field!(eight, ballast)));
            let linear =
                divided(linear, one + h * field!(eight, linear_damping)) + vector!(eight, force) * push;
            let [diagonal, off] =
                [vector!(eight, inverse_inertia.diagonal), vector!(eight, inverse_inertia.off)];
            let torque = vector!(eight, torque) * h;
            let angular = divided(angular, one + h * field!(eight, angular_damping))
                + Vector3::new(
                    diagonal.x * torque.x + off.z * torque.y + off.y * torque.z,
                    off.z * torque.x + diagonal.y * torque.y + off.x * torque.z,
                    off.y * torque.x + off.x * torque.y + diagonal.z * torque.z,
                );
            // Geometric stiffness beyond the inertia acts as inertia: the spin it takes part in is shared with it.
            let total = inertia + vector!(eight, excess);
            let exact = rotation.exact();
            let spin = over(times(exact.turned_back(angular), inertia), total);
            let spin = spin * within(spin, max_spin);
            let linear = linear * within(linear, max_speed);
            let momentum = times(spin, inertia);
            let kinetic = mass * linear.dot(linear) + momentum.dot(spin);
            let momentum = exact.turned(momentum);
            let middle = rotation.turned(middle_of_spin(spin, inertia, h));

            let mut energies = [0.0; WIDTH];
            (kinetic * L::splat(0.5)).store(&mut energies);
            store_velocities([linear, middle], &mut velocities[first..]);
            let momenta = vectors(momentum);
            for ((body, momentum), of_one) in bodies[first..].iter_mut().zip(momenta).zip(energies) {
                body.momentum = momentum;
                energy += of_one;
            }
        }
        energy
    }
}

/// Velocities to poses. Momenta go on as they are, with what impulses gave since the velocities `before`; spins follow from them.
pub(super) struct IntegratePosition<'a> {
    pub bodies: &'a mut [SolverBody],
    pub velocities: &'a mut [Vec6],
    pub before: &'a [Vec6],
    /// Substep, seconds.
    pub h: f32,
}

impl Kernel for IntegratePosition<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { bodies, velocities, before, h } = self;
        for first in (0..bodies.len()).step_by(WIDTH) {
            let eight = eight_from(bodies, first);
            let [linear, angular] = velocities_from::<L>(velocities, first);
            let [_, unconstrained] = velocities_from::<L>(before, first);
            let (rotation, inertia) = (rotation!(eight, pose.rotation), vector!(eight, inertia));
            // What impulses gave. Geometric stiffness is no inertia of the body.
            let given = rotation.angular_momentum(angular - unconstrained, inertia);
            let momentum = vector!(eight, momentum) + given;
            let position = vector!(eight, pose.translation);
            let poses =
                advanced(position, rotation, [linear, angular], h, &velocities[first..], eight_poses(&eight));
            let rotation = rotations_of::<L>(&poses);
            let exact = rotation.exact();
            let spin = exact.turned(over(exact.turned_back(momentum), inertia));
            store_velocities([linear, spin], &mut velocities[first..]);
            for (body, pose) in bodies[first..].iter_mut().zip(poses) {
                body.pose = pose;
            }
        }
    }
}

/// Poses to which velocities lead within `h` seconds, body by body.
pub(super) struct Predict<'a> {
    pub bodies: &'a [SolverBody],
    pub velocities: &'a [Vec6],
    pub h: f32,
    pub poses: &'a mut Vec<Transform>,
}

impl Kernel for Predict<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { bodies, velocities, h, poses } = self;
        poses.clear();
        for first in (0..bodies.len()).step_by(WIDTH) {
            let eight = eight_from(bodies, first);
            let rotation = rotation!(eight, pose.rotation);
            let position = vector!(eight, pose.translation);
            let velocity = velocities_from::<L>(velocities, first);
            let ahead = advanced(position, rotation, velocity, h, &velocities[first..], eight_poses(&eight));
            poses.extend_from_slice(&ahead[..usize::min(WIDTH, bodies.len() - first)]);
        }
    }
}

#[inline(always)]
fn eight_poses(eight: &[&SolverBody; WIDTH]) -> [Transform; WIDTH] {
    let mut poses = [Transform::IDENTITY; WIDTH];
    for (pose, body) in poses.iter_mut().zip(eight) {
        *pose = body.pose;
    }
    poses
}

#[inline(always)]
fn rotations_of<L: Lanes>(eight: &[Transform; WIDTH]) -> Turn<L> {
    rotation!(eight, rotation)
}

/// Eight times [`advance`].
#[inline(always)]
fn advanced<L: Lanes>(
    position: Vector3<L>,
    rotation: Turn<L>,
    [linear, angular]: [Vector3<L>; 2],
    h: f32,
    velocities: &[Vec6],
    before: [Transform; WIDTH],
) -> [Transform; WIDTH] {
    let half = angular * L::splat(0.5 * h);
    let positions = vectors(position + linear * L::splat(h));
    let rotations = rotation.then(Turn::by_half_angles(half)).store();
    let mut poses = before;
    let is_fast = !L::le(half.length(), L::splat(MOST_SERIES));
    let is_fast = is_fast.bits();
    for k in 0..WIDTH {
        poses[k] = if is_fast & 1 << k == 0 {
            Transform::new(positions[k], rotations[k])
        } else {
            advance(&before[k], velocities.get(k).unwrap_or(&ZERO6), h)
        };
    }
    poses
}

/// What geometric stiffness adds to the moments beyond the inertia, from all of it, and inverse inertias in the axes of the world.
pub(super) struct RefreshInertia<'a>(pub &'a mut [SolverBody]);

impl Kernel for RefreshInertia<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let bodies = self.0;
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        for first in (0..bodies.len()).step_by(WIDTH) {
            let eight = eight_from(bodies, first);
            let inertia = vector!(eight, inertia);
            let excess = vector!(eight, excess) - inertia;
            let excess = Vector3::new(L::max(excess.x, zero), L::max(excess.y, zero), L::max(excess.z, zero));
            let total = (inertia + excess) * field!(eight, ballast);
            let inverse = Vector3::new(one / total.x, one / total.y, one / total.z);
            let [diagonal, off] = rotation!(eight, pose.rotation).rotated_diagonal(inverse);
            let (excess, diagonal, off) = (vectors(excess), vectors(diagonal), vectors(off));
            for (k, body) in bodies[first..].iter_mut().take(WIDTH).enumerate() {
                body.excess = excess[k];
                body.inverse_inertia = Sym3 { diagonal: diagonal[k], off: off[k] };
            }
        }
    }
}

/// Masses and inertias at the centres of mass, world axes, geometric stiffness and ballast included.
pub(super) struct ListInertias<'a> {
    pub bodies: &'a [SolverBody],
    pub list: &'a mut Vec<Inertia<f64>>,
}

impl Kernel for ListInertias<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { bodies, list } = self;
        list.clear();
        for first in (0..bodies.len()).step_by(WIDTH) {
            let eight = eight_from(bodies, first);
            let moments = (vector!(eight, inertia) + vector!(eight, excess)) * field!(eight, ballast);
            let [diagonal, off] = rotation!(eight, pose.rotation).rotated_diagonal(moments);
            let (diagonal, off) = (vectors(diagonal), vectors(off));
            for (k, body) in bodies[first..].iter().take(WIDTH).enumerate() {
                let (d, o) = (diagonal[k], off[k]);
                let tensor = Symmetric([
                    f64::from(d.x),
                    f64::from(o.z),
                    f64::from(o.y),
                    f64::from(d.y),
                    f64::from(o.x),
                    f64::from(d.z),
                ]);
                list.push(Inertia::of_body(f64::from(body.mass * body.ballast), tensor));
            }
        }
    }
}

/// Kinetic energy with the given velocities, J.
pub(super) struct KineticEnergy<'a> {
    pub bodies: &'a [SolverBody],
    pub velocities: &'a [Vec6],
}

impl Kernel for KineticEnergy<'_> {
    type Output = f32;

    #[inline(always)]
    fn run<L: Lanes>(self) -> f32 {
        let Self { bodies, velocities } = self;
        let mut sum = 0.0;
        for first in (0..bodies.len()).step_by(WIDTH) {
            let eight = eight_from(bodies, first);
            let [linear, angular] = velocities_from::<L>(velocities, first);
            let spin = rotation!(eight, pose.rotation).turned_back(angular);
            let kinetic =
                field!(eight, mass) * linear.dot(linear) + times(spin, vector!(eight, inertia)).dot(spin);
            let mut energies = [0.0; WIDTH];
            (kinetic * L::splat(0.5)).store(&mut energies);
            for energy in energies {
                sum += energy;
            }
        }
        sum
    }
}

/// Momentum and angular momentum about their centres that bodies gained since the velocities `before`, N·s and N·m·s.
pub(super) struct ListGains<'a> {
    pub bodies: &'a [SolverBody],
    pub velocities: &'a [Vec6],
    pub before: &'a [Vec6],
    pub list: &'a mut Vec<Vec6>,
}

impl Kernel for ListGains<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { bodies, velocities, before, list } = self;
        list.clear();
        list.resize(bodies.len(), ZERO6);
        for first in (0..bodies.len()).step_by(WIDTH) {
            let eight = eight_from(bodies, first);
            let [linear, angular] = velocities_from::<L>(velocities, first);
            let [linear_before, angular_before] = velocities_from::<L>(before, first);
            let rotation = rotation!(eight, pose.rotation);
            let turned = rotation.angular_momentum(angular - angular_before, vector!(eight, inertia));
            let pushed = (linear - linear_before) * field!(eight, mass);
            store_velocities([pushed, turned], &mut list[first..]);
        }
    }
}

/// Angular velocity in the middle of a substep that turns a free body as its inertia lets it, from that at its beginning; principal
/// axes.
///
/// The implicit midpoint `I (m − ω) + τ m × I m = 0` keeps energy and the length of the momentum to
/// rounding, and with the Cayley map for the turn, `2 atan(τ|m|)` about `m`, the momentum itself (after Austin,
/// Krishnaprasad and Wang 1993), whatever `τ`. With `τ = tan(½h|m|) / |m|` that turn is `h|m|`: `m` is the spin that joints
/// and contacts feel, no slower one. The explicit torque explodes; leaving it out makes wrong tops.
#[inline(always)]
pub(super) fn middle_of_spin<L: Lanes>(start: Vector3<L>, i: Vector3<L>, h: L) -> Vector3<L> {
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
        // Columns of the Jacobian I + τ (m× I − (I m)×), but for what τ changes with m.
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

/// `sin(x)/x` to 5e-8 for |x| below 1.6.
#[inline(always)]
fn sin_over<R: Real>(x: R) -> R {
    series(x * x, [1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0, -1.0 / 39_916_800.0, 0.0])
}

/// Cosine of x to 1e-8 for |x| below 1.6.
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

/// Factor, 1 at most, that makes a vector no longer than `most`.
#[inline(always)]
pub(super) fn within<L: Lanes>(v: Vector3<L>, most: f32) -> L {
    let (length, most) = (v.length(), L::splat(most));
    let long = L::gt(length, most);
    L::select(long, most / L::select(long, length, most), L::splat(1.0))
}

#[inline(always)]
pub(super) fn times<R: Real>(a: Vector3<R>, b: Vector3<R>) -> Vector3<R> {
    Vector3::new(a.x * b.x, a.y * b.y, a.z * b.z)
}

#[inline(always)]
pub(super) fn over<R: Real>(a: Vector3<R>, b: Vector3<R>) -> Vector3<R> {
    Vector3::new(a.x / b.x, a.y / b.y, a.z / b.z)
}

#[inline(always)]
pub(super) fn divided<R: Real>(a: Vector3<R>, by: R) -> Vector3<R> {
    Vector3::new(a.x / by, a.y / by, a.z / by)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::{angular, join, linear};
    use sinew_math::Random;
    use sinew_math::dispatch::{Level, run_at};

    const H: f32 = 1.0 / 240.0;
    const MAX_SPEED: f32 = 4000.0;
    const MAX_SPIN: f32 = 377.0;

    fn random_vector(random: &mut Random, most: f32) -> Vec3 {
        random.direction() * random.range(0.0, most)
    }

    fn random_body(random: &mut Random) -> SolverBody {
        let inertia = Vec3::new(random.range(0.5, 1.0), random.range(0.5, 1.0), random.range(0.5, 1.0));
        let rotation = random.rotation();
        SolverBody {
            index: 0,
            pose: Transform::new(random_vector(random, 10.0), rotation),
            mass: random.range(0.1, 50.0),
            inertia: inertia * random.range(0.01, 2.0),
            excess: Vec3::ZERO,
            ballast: 1.0,
            inverse_inertia: Sym3::from_rotated_diagonal(rotation, Vec3::ONE / inertia),
            force: random_vector(random, 100.0),
            torque: random_vector(random, 5.0),
            momentum: Vec3::ZERO,
            linear_damping: random.range(0.0, 0.5),
            angular_damping: random.range(0.0, 0.5),
        }
    }

    fn random_island(count: usize) -> (Vec<SolverBody>, Vec<Vec6>) {
        let mut random = Random::new(11);
        let bodies = (0..count).map(|_| random_body(&mut random)).collect();
        // Some turn by more than the series are for.
        let fastest = |k: usize| if k.is_multiple_of(5) { 1500.0 } else { 30.0 };
        let velocity =
            |k: usize| join(random_vector(&mut random, 20.0), random_vector(&mut random, fastest(k)));
        (bodies, (0..count).map(velocity).collect())
    }

    /// All kernels, one after the other; the bits of all that they write.
    fn substep(level: Level, bodies: &mut [SolverBody], velocities: &mut [Vec6]) -> Vec<u32> {
        let mut bits = Vec::new();
        let energy = run_at(
            level,
            IntegrateVelocity { bodies, velocities, h: H, max_speed: MAX_SPEED, max_spin: MAX_SPIN },
        );
        let before = velocities.to_vec();
        for v in &mut *velocities {
            *v = v.map(|x| x * 1.125);
        }
        let mut gains = Vec::new();
        run_at(level, ListGains { bodies, velocities, before: &before, list: &mut gains });
        let mut poses = Vec::new();
        run_at(level, Predict { bodies, velocities, h: H, poses: &mut poses });
        run_at(level, IntegratePosition { bodies, velocities, before: &before, h: H });
        assert!(poses.iter().zip(&*bodies).all(|(pose, body)| *pose == body.pose), "what was predicted");
        run_at(level, RefreshInertia(bodies));
        let after = run_at(level, KineticEnergy { bodies, velocities });
        bits.extend([energy, after].map(f32::to_bits));
        bits.extend(velocities.iter().chain(&gains).flatten().map(|x| x.to_bits()));
        for body in bodies {
            let Transform { translation, rotation } = body.pose;
            let inverse = body.inverse_inertia;
            let vectors = [translation, rotation.vector(), body.momentum, inverse.diagonal, inverse.off];
            bits.extend(vectors.iter().flat_map(|v| v.to_array()).map(f32::to_bits));
        }
        bits
    }

    #[test]
    fn all_levels_have_the_same_bits() {
        let (bodies, velocities) = random_island(21);
        let results: Vec<_> = Level::available()
            .map(|level| substep(level, &mut bodies.clone(), &mut velocities.clone()))
            .collect();
        assert!(results.windows(2).all(|pair| pair[0] == pair[1]));
    }

    #[test]
    fn a_body_has_the_bits_that_it_has_alone() {
        let (mut bodies, mut velocities) = random_island(21);
        let alone: Vec<_> = bodies
            .iter()
            .zip(&velocities)
            .map(|(body, v)| {
                let (mut body, mut v) = ([body.clone()], [*v]);
                substep(Level::best(), &mut body, &mut v);
                (body[0].pose, v[0])
            })
            .collect();
        substep(Level::best(), &mut bodies, &mut velocities);
        let together = bodies.iter().map(|body| body.pose).zip(velocities);
        assert!(together.eq(alone));
    }

    #[test]
    fn poses_and_momenta_are_those_of_the_formulas() {
        let (mut bodies, mut velocities) = random_island(21);
        let before = bodies.clone();
        let kernel = IntegrateVelocity {
            bodies: &mut bodies,
            velocities: &mut velocities,
            h: H,
            max_speed: MAX_SPEED,
            max_spin: MAX_SPIN,
        };
        run_at(Level::best(), kernel);
        for (k, (body, v)) in bodies.iter().zip(&velocities).enumerate() {
            assert!(angular(v).length() <= MAX_SPIN * 1.001, "body {k}");
            // The middle of the spin turns with the momentum of its beginning: I m + τ m × I m is what the momentum was.
            let r = body.pose.rotation;
            let (m, momentum) = (r.inverse() * angular(v), r.inverse() * body.momentum);
            let l = m * body.inertia;
            let along = (0.5 * H * m.length()).min(MOST_HALF_TURN);
            let tau = sinew_math::trig::tan(along) / m.length();
            let off = (l + m.cross(l) * tau - momentum).length() / momentum.length();
            assert!(off < 2e-5 || along == MOST_HALF_TURN, "body {k}: {off}");
        }
        let forces = velocities.clone();
        let kernel =
            IntegratePosition { bodies: &mut bodies, velocities: &mut velocities, before: &forces, h: H };
        run_at(Level::best(), kernel);
        for (k, (body, was)) in bodies.iter().zip(&before).enumerate() {
            let there = advance(&was.pose, &forces[k], H);
            assert!((body.pose.translation - there.translation).length() < 1e-5, "body {k}");
            assert!(body.pose.rotation.angle_to(there.rotation) < 1e-6, "body {k}");
            let spun = body.angular_momentum(angular(&velocities[k]));
            assert!((spun - body.momentum).length() < 1e-5 * body.momentum.length(), "body {k}");
            assert_eq!(linear(&velocities[k]), linear(&forces[k]), "body {k}");
        }
    }
}
