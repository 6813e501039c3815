//! Integrates forces to velocities, and velocities to poses, including the joint impulses.

use super::super::articulation::elimination::zero;
use super::super::flight::{load, store};
use super::super::motion::{divided, middle_of_spin, over, times, within};
use super::joints::StrandEnds;
use super::link::{Link, load_turn, store_turn};
use super::substep::Pace;
use sinew_math::lanes::{LaneMask, Lanes, Vector3};

/// Kinetic energies of a strand, J.
#[derive(Clone, Copy)]
pub(super) struct Kinetic<L> {
    /// Energies before and after the forces have acted.
    pub before: L,
    pub start: L,
}

/// Integrates forces to velocities, like [`IntegrateVelocity`](super::super::motion::IntegrateVelocity) for bodies of
/// islands.
#[inline(always)]
pub(super) fn integrate_velocity<L: Lanes>(links: &mut [Link], pace: &Pace) -> Kinetic<L> {
    let (h, one) = (L::splat(pace.h), L::splat(1.0));
    let mut twice = Kinetic { before: L::splat(0.0), start: L::splat(0.0) };
    for link in links {
        let (turn, inertia) = (load_turn::<L>(&link.rotation), load::<L>(&link.inertia));
        let exact = turn.exact();
        let total = inertia + load(&link.excess);
        let mass = L::load(&link.mass);
        let velocity = load::<L>(&link.velocity);
        let spin = exact.turned_back(load(&link.spin));
        twice.before = twice.before + (mass * velocity.dot(velocity) + times(spin, inertia).dot(spin));
        let velocity =
            divided(velocity, one + h * L::load(&link.linear_damping)) + load(&link.acceleration) * h;
        let given = over(turn.turned_back(load::<L>(&link.torque) * h), total);
        let spin = divided(spin, one + h * L::load(&link.angular_damping)) + given;
        // Geometric stiffness beyond the inertia acts as inertia, so the spin is distributed over both.
        let spin = over(times(spin, inertia), total);
        let [share, linear_share] = [within(spin, pace.max_spin), within(velocity, pace.max_speed)];
        link.limited |= (L::gt(one, share) | L::gt(one, linear_share)).bits();
        let [spin, velocity] = [spin * share, velocity * linear_share];
        let momentum = times(spin, inertia);
        twice.start = twice.start + (mass * velocity.dot(velocity) + momentum.dot(spin));
        store(exact.turned(momentum), &mut link.momentum);
        let middle = turn.turned(middle_of_spin(spin, inertia, h));
        store(velocity, &mut link.velocity);
        store(velocity, &mut link.start_velocity);
        store(middle, &mut link.spin);
        store(middle, &mut link.start_spin);
    }
    let half = L::splat(0.5);
    Kinetic { before: twice.before * half, start: twice.start * half }
}

/// Moves the links to the [predicted](super::joints::descend_ahead) poses and stores the joint impulses, from the end of the strand on. The
/// joint impulses are added to the momenta, from which the spins follow.
#[inline(always)]
pub(super) fn integrate_position<L: Lanes>(links: &mut [Link], ends: &mut StrandEnds<'_, L>, pace: &Pace) {
    let rate = L::splat(1.0 / pace.h);
    let of_cuts = ends.take_given();
    let mut below = [zero::<L>(); 2];
    for (i, link) in links.iter_mut().enumerate().rev() {
        let [force, torque] = below;
        below = [ends.tips.below(i, force, of_cuts[0]), ends.tips.below(i, torque, of_cuts[1])];
        let given = gains::<L>(link);
        let momentum = load::<L>(&link.momentum) + given[1];
        let [force, torque] = [given[0] + below[0], given[1] + below[1]];
        if i > 0 || ends.joins_first() {
            store(force * rate, &mut link.force);
            below = push::<L>(link, [force, torque]);
        }
        let rotation = load_turn::<L>(&link.ahead_rotation);
        let exact = rotation.exact();
        let spin = exact.turned(over(exact.turned_back(momentum), load(&link.inertia)));
        link.position = link.ahead;
        store_turn(rotation, &mut link.rotation);
        store(spin, &mut link.spin);
        store(spin, &mut link.start_spin);
        link.start_velocity = link.velocity;
    }
}

/// Adds the joint impulses of `relax`. Returns the kinetic energy, J.
#[inline(always)]
pub(super) fn end_substep<L: Lanes>(links: &mut [Link], ends: &mut StrandEnds<'_, L>) -> L {
    let of_cuts = ends.take_given();
    let mut below = [zero::<L>(); 2];
    let mut twice = L::splat(0.0);
    for (i, link) in links.iter_mut().enumerate().rev() {
        let [force, torque] = below;
        below = [ends.tips.below(i, force, of_cuts[0]), ends.tips.below(i, torque, of_cuts[1])];
        let (velocity, mass) = (load::<L>(&link.velocity), L::load(&link.mass));
        let (turn, inertia) = (load_turn::<L>(&link.rotation), load::<L>(&link.inertia));
        let spin = turn.turned_back(load(&link.spin));
        let momentum = times(spin, inertia);
        twice = twice + (mass * velocity.dot(velocity) + momentum.dot(spin));
        if i > 0 || ends.joins_first() {
            let force = (velocity - load(&link.start_velocity)) * mass;
            let given = times(turn.turned_back(load::<L>(&link.spin) - load(&link.start_spin)), inertia);
            below = push::<L>(link, [force + below[0], turn.turned(given) + below[1]]);
        }
    }
    twice * L::splat(0.5)
}

/// Momentum and angular momentum (about the centre) that a body gained since the `start` velocities.
#[inline(always)]
fn gains<L: Lanes>(link: &Link) -> [Vector3<L>; 2] {
    let exact = load_turn::<L>(&link.rotation).exact();
    let velocity = load::<L>(&link.velocity) - load(&link.start_velocity);
    let spin = load::<L>(&link.spin) - load(&link.start_spin);
    let turned = exact.turned(times(exact.turned_back(spin), load(&link.inertia)));
    [velocity * L::load(&link.mass), turned]
}

/// Adds the impulse of the joint on the body, about its centre. Returns the impulse on the parent, about the parent's centre.
#[inline(always)]
fn push<L: Lanes>(link: &mut Link, [force, torque]: [Vector3<L>; 2]) -> [Vector3<L>; 2] {
    let torque = torque - load::<L>(&link.arm).cross(force);
    store(load::<L>(&link.pushed) + force, &mut link.pushed);
    store(load::<L>(&link.turned) + torque, &mut link.turned);
    [force, torque + load::<L>(&link.parent_arm).cross(force)]
}

/// Work of the forces along the coming displacement of the bodies, J.
#[inline(always)]
pub(super) fn work_of_forces<L: Lanes>(links: &[Link], pace: &Pace) -> L {
    let mut power = L::splat(0.0);
    for link in links {
        let force = load::<L>(&link.acceleration) * L::load(&link.mass);
        power = power + (force.dot(load(&link.velocity)) + load::<L>(&link.torque).dot(load(&link.spin)));
    }
    power * L::splat(pace.h)
}
