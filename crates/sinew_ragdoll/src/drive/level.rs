//! Strengths of drives in a form that can be blended: stiffness and damping for a unit of mass, and largest forces and
//! torques.

use super::{Drive, DriveMode, Muscle, Pin};
use crate::tuning::{KEYED_AFTER, LEAST_HERTZ};
use sinew_math::{max, trig};
use sinew_physics::Softness;

/// A spring for a unit of mass: `hertz²` and `2 ζ hertz`, which are stiffness over `(2π)²` and damping over `2π`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Spring {
    pub stiffness: f32,
    pub damping: f32,
}

impl Spring {
    fn new(hertz: f32, damping_ratio: f32) -> Self {
        Self { stiffness: hertz * hertz, damping: 2.0 * damping_ratio * hertz }
    }

    /// Returns the spring with `share` of its stiffness and the same damping ratio; `None` if the result is zero.
    pub fn softness(self, share: f32) -> Option<Softness> {
        let hertz = (self.stiffness * share).sqrt();
        let damping_ratio = self.damping / (2.0 * max(self.stiffness.sqrt(), 1e-6));
        (hertz > LEAST_HERTZ).then_some(Softness::Frequency { hertz, damping_ratio })
    }

    fn approach(&mut self, goal: Self, share: f32) {
        approach(&mut self.stiffness, goal.stiffness, share);
        approach(&mut self.damping, goal.damping, share);
    }
}

/// Pin that holds a body during its blend to keyed.
const KEYING: Pin = Pin { hertz: 30.0, damping_ratio: 1.0, max_force: 1e5, max_torque: 2e4 };

/// Current strength of a body's drive: the springs of its muscle and pin, and their largest forces and torques.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Level {
    pub muscle: Spring,
    /// Share of the joint's largest torque, 0..=1.
    pub strength: f32,
    pub pin: Spring,
    /// Largest force, N, and largest torque, N·m, of the pin.
    pub force: f32,
    pub torque: f32,
}

impl Level {
    pub fn of(mode: DriveMode) -> Self {
        let muscle = |m: Muscle| Self {
            muscle: Spring::new(m.hertz, m.damping_ratio),
            strength: m.strength,
            ..Self::default()
        };
        let pinned = |m: Muscle, p: Pin| Self {
            pin: Spring::new(p.hertz, p.damping_ratio),
            force: p.max_force,
            torque: p.max_torque,
            ..muscle(m)
        };
        match mode {
            DriveMode::Limp => Self::default(),
            DriveMode::Powered(m) => muscle(m),
            DriveMode::Pinned(m, p) => pinned(m, p),
            DriveMode::Keyed => pinned(Muscle::STIFF, KEYING),
        }
    }
}

impl Drive {
    /// Advances the blend by `dt` seconds. Returns true if the body becomes keyed.
    pub(super) fn pass(&mut self, dt: f32, recovery: f32) -> bool {
        self.since += dt;
        let share = if self.half_life > 0.0 {
            -trig::exp_m1(-core::f32::consts::LN_2 * dt / self.half_life)
        } else {
            1.0
        };
        let (goal, level) = (Level::of(self.mode), &mut self.level);
        level.muscle.approach(goal.muscle, share);
        level.pin.approach(goal.pin, share);
        for (x, goal) in [
            (&mut level.strength, goal.strength),
            (&mut level.force, goal.force),
            (&mut level.torque, goal.torque),
        ] {
            approach(x, goal, share);
        }
        self.weakness *= if recovery > 0.0 { trig::exp(-dt / recovery) } else { 0.0 };
        self.mode == DriveMode::Keyed && (self.keyed || self.since >= KEYED_AFTER * self.half_life)
    }
}

fn approach(x: &mut f32, goal: f32, share: f32) {
    *x = if share < 1.0 { *x + (goal - *x) * share } else { goal };
}
