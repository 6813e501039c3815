//! Motion of the island's bodies, eight side by side: velocity and position integration, inertias, energies.

use super::articulation::elimination::{Inertia, Symmetric};
use crate::solver::body::{SolverBody, advance};
use crate::spatial::{Vec6, ZERO6};
use sinew_math::dispatch::Kernel;
use sinew_math::lanes::{LaneMask, Lanes, Vector3, WIDTH};
use sinew_math::{Sym3, Transform};

pub(in crate::solver) mod momentum;
#[cfg(test)]
mod tests;
mod turn;

pub(crate) use turn::Turn;
use turn::{MOST_SERIES, vectors};
pub(super) use turn::{divided, middle_of_spin, narrow, over, times, widen, within};

/// Loads a field of eight bodies, one in each lane.
macro_rules! field {
    ($eight:expr, $($path:tt)+) => {{
        let mut row = [0.0; WIDTH];
        for k in 0..WIDTH {
            row[k] = $eight[k].$($path)+;
        }
        L::load(&row)
    }};
}

/// Loads a vector of eight bodies, one in each lane.
macro_rules! vector {
    ($eight:expr, $($path:tt)+) => {
        Vector3::<L>::new(field!($eight, $($path)+.x), field!($eight, $($path)+.y), field!($eight, $($path)+.z))
    };
}

/// Loads the rotations of eight bodies, one in each lane.
macro_rules! rotation {
    ($eight:expr, $($path:tt)+) => {
        Turn::<L> { vector: vector!($eight, $($path)+), real: field!($eight, $($path)+.w) }
    };
}

mod gaps;

pub(super) use gaps::FindErrors;

/// Returns eight bodies from index `first` on; the last body is repeated beyond the end.
#[inline(always)]
fn eight_from<T>(all: &[T], first: usize) -> [&T; WIDTH] {
    let mut eight = [&all[first]; WIDTH];
    for (k, one) in eight.iter_mut().enumerate().skip(1) {
        *one = &all[usize::min(first + k, all.len() - 1)];
    }
    eight
}

/// Linear and angular velocities of eight bodies from index `first` on; zero beyond the end.
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

/// Integrates forces to velocities and stores the resulting momenta. Returns the kinetic energy, J.
pub(super) struct IntegrateVelocity<'a> {
    pub bodies: &'a mut [SolverBody],
    pub velocities: &'a mut [Vec6],
    /// Length of the substep, seconds.
    pub h: f32,
    /// Limits of speed and spin, m/s and rad/s.
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
            let push = h * (one / (mass * field!(eight, mass_scale)));
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
            // Geometric stiffness beyond the inertia acts as inertia, so the spin is distributed over both.
            let total = inertia + vector!(eight, excess);
            let exact = rotation.exact();
            let spin = over(times(exact.turned_back(angular), inertia), total);
            let [share, linear_share] = [within(spin, max_spin), within(linear, max_speed)];
            let limited = (L::gt(one, share) | L::gt(one, linear_share)).bits();
            let [spin, linear] = [spin * share, linear * linear_share];
            let momentum = times(spin, inertia);
            let kinetic = mass * linear.dot(linear) + momentum.dot(spin);
            let momentum = exact.turned(momentum);
            let middle = rotation.turned(middle_of_spin(spin, inertia, h));

            let mut energies = [0.0; WIDTH];
            (kinetic * L::splat(0.5)).store(&mut energies);
            store_velocities([linear, middle], &mut velocities[first..]);
            let momenta = vectors(momentum);
            for (k, body) in bodies[first..].iter_mut().take(WIDTH).enumerate() {
                body.momentum = momenta[k];
                body.is_limited |= limited >> k & 1 == 1;
                energy += energies[k];
            }
        }
        energy
    }
}

/// Integrates velocities to poses. Impulses since the velocities `before` are added to the momenta, from which the spins follow.
pub(super) struct IntegratePosition<'a> {
    pub bodies: &'a mut [SolverBody],
    pub velocities: &'a mut [Vec6],
    pub before: &'a [Vec6],
    /// Length of the substep, seconds.
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
            // Momentum added by impulses. Geometric stiffness does not count as inertia here.
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

/// Predicts the poses to which velocities lead within `h` seconds, body by body.
pub(super) struct Predict<'a> {
    pub bodies: &'a [SolverBody],
    pub velocities: &'a [Vec6],
    pub h: f32,
    pub poses: &'a mut [Transform],
}

impl Kernel for Predict<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { bodies, velocities, h, poses } = self;
        for first in (0..bodies.len()).step_by(WIDTH) {
            let eight = eight_from(bodies, first);
            let rotation = rotation!(eight, pose.rotation);
            let position = vector!(eight, pose.translation);
            let velocity = velocities_from::<L>(velocities, first);
            let ahead = advanced(position, rotation, velocity, h, &velocities[first..], eight_poses(&eight));
            for (pose, ahead) in poses[first..].iter_mut().zip(ahead) {
                *pose = ahead;
            }
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

/// Computes [`advance`] for eight bodies.
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

/// Computes the part of the geometric stiffness (held in `excess` until now) that exceeds the inertia, and the inverse inertias in world
/// axes.
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
            let total = (inertia + excess) * field!(eight, mass_scale);
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

/// Computes masses and inertias at the centres of mass, world axes, including geometric stiffness and mass scaling.
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
            let moments = (vector!(eight, inertia) + vector!(eight, excess)) * field!(eight, mass_scale);
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
                list.push(Inertia::of_body(f64::from(body.mass * body.mass_scale), tensor));
            }
        }
    }
}

/// Computes the kinetic energy with the given velocities, J.
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

/// Computes the momentum, N·s, and the angular momentum about their centres, N·m·s, that bodies gained since the velocities `before`.
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
