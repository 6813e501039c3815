//! A joint as stored by the world: its definition and its state.

pub mod def;
mod incidence;
mod rows;
mod snapshot;

use crate::arena::Item;
use crate::body::owner::OwnerMark;
use crate::id::JointId;
use crate::spatial::{Vec6, ZERO6};
use def::{
    Gains, JointCollision, JointDef, JointKind, JointState, Motor, SixDof, SoftZone, Softness, Spring,
    Strength,
};
pub(crate) use incidence::Incidence;
use rows::locked_count;
pub(crate) use rows::{
    DIRECTIONS, JointGeometry, JointPose, JointRows, MAX_LIMITS, MAX_STOPS, Row, Stop, TWIST, anchor_gap,
    displacement, each_stop, locked_error, locks, open_directions, open_row, overshoot, stops, turns,
};
use sinew_math::{Transform, Vec3};

/// Impulse of a limit in the last substep and the one before, N·s or N·m·s, in frame A. A vector, because the axis of a
/// cone rotates, and an impulse about the previous axis must not act about the current one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LimitImpulse {
    pub now: Vec3,
    pub before: Vec3,
}

impl LimitImpulse {
    /// Scales the impulses for substeps that are `times` as long.
    pub fn of_substeps(self, times: f32) -> Self {
        Self { now: self.now * times, before: self.before * times }
    }
}

/// Softness of the welds and limits, springs, motor and friction of a joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointDrive {
    pub weld: Option<Softness>,
    pub limit_softness: Option<Softness>,
    pub soft_zone: Option<SoftZone>,
    pub spring: Option<Spring>,
    pub motor: Option<Motor>,
    pub friction: f32,
}

impl JointDrive {
    fn new(def: &JointDef) -> Self {
        Self {
            weld: def.weld,
            limit_softness: def.limit_softness,
            soft_zone: def.soft_zone,
            spring: def.spring,
            motor: def.motor,
            friction: def.friction_torque,
        }
    }

    /// True if the free directions have only friction and the stops are hard.
    pub fn is_limp(&self) -> bool {
        let Self { weld, limit_softness, soft_zone, spring, motor, friction: _ } = self;
        weld.is_none()
            && limit_softness.is_none()
            && soft_zone.is_none()
            && spring.is_none()
            && motor.is_none()
    }

    /// True if a row depends on the mass that the joint moves.
    pub fn needs_mass(&self) -> bool {
        self.weld.is_some() || self.spring.is_some() || self.motor.is_some()
    }
}

impl Softness {
    /// Stiffness and damping for a mass (kg or kg·m²).
    pub(crate) fn of_mass(self, mass: f32) -> (f32, f32) {
        match self {
            Self::Stiffness { stiffness, damping } => (stiffness, damping),
            Self::Frequency { hertz, damping_ratio } => {
                let omega = 2.0 * core::f32::consts::PI * hertz;
                (mass * omega * omega, 2.0 * damping_ratio * omega * mass)
            }
        }
    }
}

/// Sign of a saturated motor's push, by direction: −1, 1, or 0 if the motor is below its cap.
pub(crate) type Saturation = [i8; DIRECTIONS];

#[derive(Clone, Debug)]
pub(crate) struct Joint {
    /// Indices of the two bodies.
    pub a: u32,
    pub b: u32,
    /// Joint frame in the principal frames of the bodies.
    pub frame_a: Transform,
    pub frame_b: Transform,
    pub kind: JointKind,
    pub drive: JointDrive,
    pub strength: Strength,
    pub collision: JointCollision,
    pub state: JointState,
    pub limits: [LimitImpulse; MAX_LIMITS],
    pub saturated: Saturation,
    /// Impulses of the last substep by direction, N·s and N·m·s, if the joint closes one of many loops.
    pub warm_impulse: Vec6,
    /// Linear force on body B in the last substep, N, world axes: geometric stiffness needs it.
    pub force: Vec3,
    /// Effective mass that springs and motors moved in the last step, by direction, kg or kg·m².
    pub mass: Vec6,
    /// Mean force over the last step on body B, N, and mean torque about its anchor, N·m, world axes.
    pub reaction: Vec6,
    /// Owner of the joint; `None` if the joint is the user's.
    pub owner: Option<OwnerMark>,
}

impl Item for Joint {
    type Id = JointId;
}

impl Joint {
    pub fn new(
        def: &JointDef,
        a: u32,
        b: u32,
        principal_from_a: Transform,
        principal_from_b: Transform,
    ) -> Self {
        def.check();
        Self {
            a,
            b,
            frame_a: principal_from_a * def.frame_a,
            frame_b: principal_from_b * def.frame_b,
            kind: def.kind,
            drive: JointDrive::new(def),
            strength: def.strength,
            collision: def.collision,
            state: def.state,
            limits: [LimitImpulse::default(); MAX_LIMITS],
            saturated: [0; DIRECTIONS],
            warm_impulse: ZERO6,
            force: Vec3::ZERO,
            mass: ZERO6,
            reaction: ZERO6,
            owner: None,
        }
    }

    /// Applies another definition; keeps stored impulses where their meaning is unchanged.
    pub fn redefine(&mut self, def: &JointDef, principal_from_a: Transform, principal_from_b: Transform) {
        let new = Self::new(def, self.a, self.b, principal_from_a, principal_from_b);
        let new = Self { owner: self.owner, ..new };
        let same = core::mem::discriminant(&self.kind) == core::mem::discriminant(&new.kind);
        *self = if same {
            Self {
                limits: self.limits,
                saturated: self.saturation_under(new.drive.motor),
                warm_impulse: self.warm_impulse,
                force: self.force,
                mass: self.mass,
                reaction: self.reaction,
                ..new
            }
        } else {
            new
        };
    }

    pub fn geometry(&self) -> JointGeometry {
        JointGeometry { frame_a: self.frame_a, frame_b: self.frame_b, kind: self.kind }
    }

    pub fn is_enabled(&self) -> bool {
        self.state == JointState::Enabled
    }

    /// Energy stored in welds, springs and soft limits, J.
    pub(crate) fn elastic_energy(&self, pose: &JointPose) -> f32 {
        let half = |softness: Softness, direction: usize, x: f32| {
            0.5 * softness.of_mass(self.mass[direction]).0 * x * x
        };
        let mut sum = 0.0;
        if let Some(weld) = self.drive.weld {
            let rows = JointRows::new(&self.geometry(), pose, [false; DIRECTIONS]);
            for row in 0..rows.locked {
                sum += half(weld, rows.direction(row), rows.error[row]);
            }
        }
        if let Some(spring) = self.drive.spring {
            for i in open_directions(self.kind) {
                sum += half(spring.softness, i, displacement(&self.kind, pose, i, &spring.rest));
            }
        }
        if let Some(Softness::Stiffness { stiffness, .. }) = self.drive.limit_softness {
            for stop in stops(&self.kind, pose).into_iter().flatten().filter(|stop| stop.slack < 0.0) {
                sum += 0.5 * stiffness * stop.slack * stop.slack;
            }
        }
        sum
    }

    /// Largest number of rows of the joint.
    pub fn most_rows(&self) -> usize {
        let drive = &self.drive;
        let driven = drive.spring.is_some() || drive.motor.is_some() || drive.friction > 0.0;
        locked_count(&self.kind) + if driven { open_directions(self.kind).count() } else { 0 }
    }

    /// True if the joint has no locked direction and no stop: only springs, motors and friction in all six directions.
    pub fn leaves_all_free(&self) -> bool {
        self.kind == JointKind::SixDof(SixDof::FREE)
    }

    /// True if the joint keeps its two bodies from colliding.
    pub fn parts_bodies(&self) -> bool {
        self.is_enabled() && self.collision == JointCollision::Disabled
    }

    /// True if the load in the last step exceeded the joint's strength.
    pub fn is_overloaded(&self) -> bool {
        crate::spatial::linear(&self.reaction).length() > self.strength.force
            || crate::spatial::angular(&self.reaction).length() > self.strength.torque
    }

    /// Replaces the motor. A new motor keeps the old one's saturation state, if it is of the same kind and has caps.
    pub fn set_motor(&mut self, motor: Option<Motor>) {
        self.saturated = self.saturation_under(motor);
        self.drive.motor = motor;
    }

    fn saturation_under(&self, motor: Option<Motor>) -> Saturation {
        let aims = |motor: &Option<Motor>| motor.map(|m| matches!(m.gains, Gains::Velocity));
        if aims(&motor) != aims(&self.drive.motor) {
            return [0; DIRECTIONS];
        }
        let capped = |i: usize| motor.is_some_and(|m| m.cap(i) < f32::INFINITY);
        core::array::from_fn(|i| if capped(i) { self.saturated[i] } else { 0 })
    }
}
