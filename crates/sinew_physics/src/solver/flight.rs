//! Bodies in flight: nothing touches or holds them, so that a step of eight of them side by side is all their own motion.
//!
//! The angular momentum stays as it is in the world but for torque and damping; spin and rotation follow from it, substep by substep,
//! by the midpoint of [`gyroscopic`](super::gyroscopic).

use super::build::{View, lasting_force};
use super::solution::SolvedBody;
use super::{MIDPOINT_STEPS, MIDPOINT_TOLERANCE, MOST_HALF_TURN};
use crate::body::Velocity;
use crate::islands::Island;
use crate::slices::for_each_mut;
use crate::stage::Counter;
use crate::step::StepContext;
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{LaneMask, Lanes, Vector3, WIDTH};
use sinew_math::{Rotation, Transform, Vec3, min};

type Eight = [f32; WIDTH];

/// Most that a body turns within a substep, should the world's limit allow more, radians: what the series for sine and cosine reach.
const MOST_TURN: f32 = 3.0;

/// True of an island of one body on which nothing acts but gravity and the forces and torques of this step.
pub(crate) fn flies(island: &Island<'_>, view: &View<'_>) -> bool {
    let &[body] = island.bodies else { return false };
    let held = !(island.joints.is_empty() && island.contacts.is_empty() && island.groups.is_empty());
    !held && view.fields.is_empty() && view.bodies.at(body).forces.list.is_empty()
}

/// All bodies in flight, eight to a flock.
#[derive(Clone, Debug, Default)]
pub(crate) struct Flight {
    flocks: Vec<Flock>,
    count: usize,
}

impl Flight {
    /// Begins with none.
    pub fn clear(&mut self) {
        self.flocks.clear();
        self.count = 0;
    }

    /// Adds a body of the world.
    pub fn add(&mut self, body: u32, view: &View<'_>) {
        let lane = self.count % WIDTH;
        if lane == 0 {
            self.flocks.push(Flock::EMPTY);
        }
        self.count += 1;
        if let Some(flock) = self.flocks.last_mut() {
            flock.write(lane, body, view);
        }
    }

    /// Takes all of them through a step.
    pub fn run(&mut self, view: &View<'_>, context: &StepContext<'_>) {
        let (h, substeps) = (view.pace.h, view.pace.substeps);
        let [max_speed, max_spin] = [view.def.max_speed, min(view.def.max_turn, MOST_TURN) / h];
        for_each_mut(context.runner, &mut self.flocks, |flock| {
            dispatch::run(Fly { flock, h, substeps, max_speed, max_spin });
        });
        if context.profiler.is_counting() {
            for _ in 0..self.count {
                context.profiler.count(Counter::Bodies, 1);
                context.profiler.count(Counter::BodySubsteps, u64::from(substeps));
            }
        }
    }

    /// Poses and velocities after the step, in the order in which bodies were added.
    pub fn solved(&self) -> impl Iterator<Item = SolvedBody> {
        (0..self.count).map(|i| self.flocks[i / WIDTH].read(i % WIDTH))
    }
}

/// Eight bodies in flight.
#[derive(Clone, Debug)]
struct Flock {
    /// Indices in the world.
    bodies: [u32; WIDTH],
    position: [Eight; 3],
    rotation: [Eight; 4],
    velocity: [Eight; 3],
    /// Angular momentum, world axes, N·m·s.
    momentum: [Eight; 3],
    /// Principal moments, kg·m².
    inertia: [Eight; 3],
    /// Acceleration by gravity and the forces of this step, m/s².
    acceleration: [Eight; 3],
    /// Torque of this step, world axes, N·m.
    torque: [Eight; 3],
    linear_damping: Eight,
    angular_damping: Eight,
}

const ZERO: Eight = [0.0; WIDTH];

fn put(v: Vec3, to: &mut [Eight; 3], lane: usize) {
    for (row, number) in to.iter_mut().zip(v.to_array()) {
        row[lane] = number;
    }
}

fn take(from: &[Eight; 3], lane: usize) -> Vec3 {
    Vec3::from_array([from[0][lane], from[1][lane], from[2][lane]])
}

impl Flock {
    const EMPTY: Self = Self {
        bodies: [0; WIDTH],
        position: [ZERO; 3],
        rotation: [ZERO, ZERO, ZERO, [1.0; WIDTH]],
        velocity: [ZERO; 3],
        momentum: [ZERO; 3],
        inertia: [[1.0; WIDTH]; 3],
        acceleration: [ZERO; 3],
        torque: [ZERO; 3],
        linear_damping: ZERO,
        angular_damping: ZERO,
    };

    fn write(&mut self, lane: usize, index: u32, view: &View<'_>) {
        let body = view.bodies.at(index);
        let Transform { translation, rotation } = body.world_from_principal;
        let (force, torque) = lasting_force(body, view);
        let spin = rotation.inverse().turn(body.velocity.angular);
        self.bodies[lane] = index;
        put(translation, &mut self.position, lane);
        for (row, number) in self.rotation.iter_mut().zip([rotation.x, rotation.y, rotation.z, rotation.w]) {
            row[lane] = number;
        }
        put(body.velocity.linear, &mut self.velocity, lane);
        put(rotation.turn(spin * body.inertia), &mut self.momentum, lane);
        put(body.inertia, &mut self.inertia, lane);
        put(force / body.mass, &mut self.acceleration, lane);
        put(torque, &mut self.torque, lane);
        self.linear_damping[lane] = body.linear_damping;
        self.angular_damping[lane] = body.angular_damping;
    }

    fn read(&self, lane: usize) -> SolvedBody {
        let [x, y, z, w] = self.rotation.map(|row| row[lane]);
        let rotation = Rotation::from_xyzw(x, y, z, w);
        let spin = rotation.inverse().turn(take(&self.momentum, lane)) / take(&self.inertia, lane);
        SolvedBody {
            index: self.bodies[lane],
            pose: Transform::new(take(&self.position, lane), rotation),
            velocity: Velocity { linear: take(&self.velocity, lane), angular: rotation.turn(spin) },
        }
    }
}

/// A step of a flock.
struct Fly<'a> {
    flock: &'a mut Flock,
    /// Substep, seconds.
    h: f32,
    substeps: u32,
    /// Limits, m/s and rad/s.
    max_speed: f32,
    max_spin: f32,
}

impl Kernel for Fly<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { flock, h, substeps, max_speed, max_spin } = self;
        let one = L::splat(1.0);
        let h = L::splat(h);
        let inertia = load::<L>(&flock.inertia);
        let torque = load::<L>(&flock.torque) * h;
        let push = load::<L>(&flock.acceleration) * h;
        let slower = one + h * L::load(&flock.linear_damping);
        let calmer = one + h * L::load(&flock.angular_damping);
        let mut position = load::<L>(&flock.position);
        let mut velocity = load::<L>(&flock.velocity);
        let mut momentum = load::<L>(&flock.momentum);
        let [x, y, z, w] = &flock.rotation;
        let (mut vector, mut real) = (Vector3::<L>::load(x, y, z), L::load(w));
        for _ in 0..substeps {
            velocity = divided(velocity, slower) + push;
            velocity = velocity * within(velocity, max_speed);
            momentum = divided(momentum, calmer) + torque;
            let spin = over(turn_back(vector, real, momentum), inertia);
            let share = within(spin, max_spin);
            momentum = momentum * share;
            let middle = middle_of_spin(spin * share, inertia, h);
            position = position + velocity * h;
            let half = h * L::splat(0.5);
            let angle = half * middle.length();
            let by = middle * (half * sin_over(angle));
            (vector, real) = turn(vector, real, by, cos(angle));
        }
        store(position, &mut flock.position);
        store(velocity, &mut flock.velocity);
        store(momentum, &mut flock.momentum);
        let [x, y, z, w] = &mut flock.rotation;
        vector.x.store(x);
        vector.y.store(y);
        vector.z.store(z);
        real.store(w);
    }
}

/// The spin of the middle of a substep, principal axes: eight times [`gyroscopic`](super::gyroscopic).
#[inline(always)]
fn middle_of_spin<L: Lanes>(start: Vector3<L>, i: Vector3<L>, h: L) -> Vector3<L> {
    let half = h * L::splat(0.5);
    let tolerance = start.dot(start) * L::splat(MIDPOINT_TOLERANCE);
    let mut m = start;
    let mut done = L::lt(half, half);
    for _ in 0..MIDPOINT_STEPS {
        let angle = L::min(half * m.length(), L::splat(MOST_HALF_TURN));
        let tau = half * (sin_over(angle) / cos(angle));
        let [x, y, z] = (m * tau).to_array();
        // Columns of I + τ (m× I − (I m)×).
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
        if done.all() {
            break;
        }
    }
    m
}

/// `sin(x)/x` to 5e-8 for |x| below 1.6.
#[inline(always)]
fn sin_over<L: Lanes>(x: L) -> L {
    series(x * x, [1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0, -1.0 / 39_916_800.0, 0.0])
}

/// Cosine of x to 1e-8 for |x| below 1.6.
#[inline(always)]
fn cos<L: Lanes>(x: L) -> L {
    let last = 1.0 / 479_001_600.0;
    series(x * x, [1.0, -0.5, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40_320.0, -1.0 / 3_628_800.0, last])
}

#[inline(always)]
fn series<L: Lanes>(x: L, terms: [f32; 7]) -> L {
    let mut sum = L::splat(terms[6]);
    for k in (0..6).rev() {
        sum = sum * x + L::splat(terms[k]);
    }
    sum
}

/// A rotation after turning by another, which is given in the rotation's own axes.
#[inline(always)]
fn turn<L: Lanes>(vector: Vector3<L>, real: L, by: Vector3<L>, by_real: L) -> (Vector3<L>, L) {
    let v = vector * by_real + by * real + vector.cross(by);
    let w = real * by_real - vector.dot(by);
    let scale = L::splat(1.0) / (v.dot(v) + w * w).sqrt();
    (v * scale, w * scale)
}

/// A vector by the inverse of a rotation.
#[inline(always)]
fn turn_back<L: Lanes>(vector: Vector3<L>, real: L, v: Vector3<L>) -> Vector3<L> {
    let across = v.cross(vector) * L::splat(2.0);
    v + across * real + across.cross(vector)
}

/// Factor, 1 at most, that makes a vector no longer than `most`.
#[inline(always)]
fn within<L: Lanes>(v: Vector3<L>, most: f32) -> L {
    let (length, most) = (v.length(), L::splat(most));
    let long = L::gt(length, most);
    L::select(long, most / L::select(long, length, most), L::splat(1.0))
}

#[inline(always)]
fn times<L: Lanes>(a: Vector3<L>, b: Vector3<L>) -> Vector3<L> {
    Vector3::new(a.x * b.x, a.y * b.y, a.z * b.z)
}

#[inline(always)]
fn over<L: Lanes>(a: Vector3<L>, b: Vector3<L>) -> Vector3<L> {
    Vector3::new(a.x / b.x, a.y / b.y, a.z / b.z)
}

#[inline(always)]
fn divided<L: Lanes>(a: Vector3<L>, by: L) -> Vector3<L> {
    Vector3::new(a.x / by, a.y / by, a.z / by)
}

#[inline(always)]
fn store<L: Lanes>(v: Vector3<L>, to: &mut [Eight; 3]) {
    v.x.store(&mut to[0]);
    v.y.store(&mut to[1]);
    v.z.store(&mut to[2]);
}

#[inline(always)]
fn load<L: Lanes>(rows: &[Eight; 3]) -> Vector3<L> {
    Vector3::load(&rows[0], &rows[1], &rows[2])
}
