//! Bodies in flight: no contact or joint acts on them, so a step integrates eight of them side by side without a solve.
//!
//! The angular momentum in world axes changes only by torque and damping. [`middle_of_spin`] computes spin and rotation
//! from it, substep by substep.

use super::boundary::solution::SolvedBody;
use super::motion::{Turn, divided, middle_of_spin, over, within};
use crate::body::Velocity;
use crate::body::def::Quality;
use crate::context::StepContext;
use crate::island::Island;
use crate::slices::for_each_mut;
use crate::solver::tuning::MOST_FLIGHT_TURN;
use crate::solver::view::{View, lasting_force};
use crate::stage::Counter;
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{LaneMask, Lanes, Vector3, WIDTH};
use sinew_math::{Rotation, Transform, Vec3, min};

/// Eight numbers, one for each body in a flock.
pub(super) type Eight = [f32; WIDTH];

/// True for an island of one body on which only gravity and the forces and torques of this step act.
pub(crate) fn flies(island: &Island<'_>, view: &View<'_>) -> bool {
    let &[body] = island.bodies else { return false };
    let held = !(island.joints.is_empty() && island.contacts.is_empty() && island.groups.is_empty());
    let has_own_substeps = view.quality(body) == Quality::Exact;
    !held && !has_own_substeps && view.fields.is_empty() && view.bodies.at(body).forces.list.is_empty()
}

/// All bodies in flight, eight in each flock.
#[derive(Clone, Debug, Default)]
pub(crate) struct Flight {
    flocks: Vec<Flock>,
    count: usize,
}

impl Flight {
    /// Removes all bodies.
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

    /// Steps all bodies.
    pub fn run(&mut self, view: &View<'_>, context: &StepContext<'_>) {
        let (h, substeps) = (view.pace.h, view.pace.substeps);
        let [max_speed, max_spin] = [view.def.max_speed, min(view.def.max_turn, MOST_FLIGHT_TURN) / h];
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
    /// Bit set of the lanes whose bodies exceeded the world's speed limits.
    limited: u8,
}

pub(super) const ZERO: Eight = [0.0; WIDTH];

/// Writes a vector into a lane.
pub(super) fn put(v: Vec3, to: &mut [Eight; 3], lane: usize) {
    for (row, number) in to.iter_mut().zip(v.to_array()) {
        row[lane] = number;
    }
}

/// Reads the vector of a lane.
pub(super) fn take(from: &[Eight; 3], lane: usize) -> Vec3 {
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
        limited: 0,
    };

    fn write(&mut self, lane: usize, index: u32, view: &View<'_>) {
        let body = view.bodies.at(index);
        let Transform { translation, rotation } = body.world_from_principal;
        let (force, torque) = lasting_force(body, view);
        let spin = rotation.inverse().turn(body.velocity.angular);
        self.bodies[lane] = index;
        self.limited &= !(1 << lane);
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
            is_limited: self.limited >> lane & 1 == 1,
            pose: Transform::new(take(&self.position, lane), rotation),
            velocity: Velocity { linear: take(&self.velocity, lane), angular: rotation.turn(spin) },
        }
    }
}

/// Kernel that steps a flock.
struct Fly<'a> {
    flock: &'a mut Flock,
    /// Length of the substep, seconds.
    h: f32,
    substeps: u32,
    /// Limits of speed and spin, m/s and rad/s.
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
        let mut rotation = Turn { vector: Vector3::<L>::load(x, y, z), real: L::load(w) };
        for _ in 0..substeps {
            velocity = divided(velocity, slower) + push;
            let linear_share = within(velocity, max_speed);
            velocity = velocity * linear_share;
            momentum = divided(momentum, calmer) + torque;
            let spin = over(rotation.turned_back(momentum), inertia);
            let share = within(spin, max_spin);
            momentum = momentum * share;
            flock.limited |= (L::gt(one, share) | L::gt(one, linear_share)).bits();
            let middle = middle_of_spin(spin * share, inertia, h);
            position = position + velocity * h;
            rotation = rotation.then_own(Turn::by_half_angles(middle * (h * L::splat(0.5))));
        }
        store(position, &mut flock.position);
        store(velocity, &mut flock.velocity);
        store(momentum, &mut flock.momentum);
        let [x, y, z, w] = &mut flock.rotation;
        rotation.vector.x.store(x);
        rotation.vector.y.store(y);
        rotation.vector.z.store(z);
        rotation.real.store(w);
    }
}

#[inline(always)]
pub(super) fn store<L: Lanes>(v: Vector3<L>, to: &mut [Eight; 3]) {
    v.x.store(&mut to[0]);
    v.y.store(&mut to[1]);
    v.z.store(&mut to[2]);
}

#[inline(always)]
pub(super) fn load<L: Lanes>(rows: &[Eight; 3]) -> Vector3<L> {
    Vector3::load(&rows[0], &rows[1], &rows[2])
}
