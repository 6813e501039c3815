//! Injected faults, each of a kind that the search must find.

use crate::life::Life;
use crate::run::run;
use crate::watch::Fault;
use core::ops::Range;
use sinew_math::{Transform, Vec3};
use sinew_physics::*;
use std::time::{Duration, Instant};

/// Fault that is injected into a world or its events.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plant {
    /// A snapshot without the times at rest.
    ForgottenField,
    /// A race between threads.
    ThreadOrder,
    NotANumber,
    EventTwice,
    EndForgotten,
    EnergyFromNothing,
    ThroughTheFloor,
}

impl Plant {
    pub const ALL: [Self; 7] = [
        Self::ForgottenField,
        Self::ThreadOrder,
        Self::NotANumber,
        Self::EventTwice,
        Self::EndForgotten,
        Self::EnergyFromNothing,
        Self::ThroughTheFloor,
    ];
}

/// Number of steps at the end of a life in which faults are injected.
pub const LAST: u32 = 15;

impl Plant {
    /// Changes a twin that was just created.
    pub fn in_twin(self, world: &mut World) {
        if self == Self::ForgottenField {
            // Waking restarts the time at rest of a body, as loading a snapshot without this time would.
            let rested: Vec<BodyId> = world.body_ids().filter(|&id| world.is_awake(id)).collect();
            rested.into_iter().for_each(|id| world.wake(id));
        }
    }

    /// Changes each world after a step.
    pub fn in_all(self, is_due: bool, world: &mut World) {
        if self == Self::ThroughTheFloor {
            return sink(world);
        }
        let dynamic = world.body_ids().filter(|&id| world.kind(id) == BodyKind::Dynamic).last();
        let Some(id) = dynamic.filter(|_| is_due) else { return };
        if self == Self::EnergyFromNothing {
            let v = world.velocity(id);
            world.set_velocity(id, Velocity { linear: v.linear * 1.5 + Vec3::Y, ..v });
        }
    }

    /// Changes, after a step, the world that runs on two threads.
    pub fn in_threads(self, is_due: bool, world: &mut World) {
        if self != Self::ThreadOrder || !is_due {
            return;
        }
        let moving = world.body_ids().find(|&id| world.kind(id) == BodyKind::Dynamic && world.is_awake(id));
        if let Some(id) = moving {
            let v = world.velocity(id);
            // Changes the last bit, as adding numbers in another order can.
            let x = f32::from_bits(v.linear.x.to_bits() ^ 1);
            world.set_velocity(id, Velocity { linear: Vec3 { x, ..v.linear }, ..v });
        }
    }

    /// Returns additional events of a step.
    pub fn events(self, is_due: bool, told: &Events) -> Events {
        let mut more = Events::default();
        match self {
            Self::EventTwice if is_due => more.begin.extend(told.begin.first().copied()),
            Self::EndForgotten if is_due => more.sensor_begin.extend(told.end.first().copied()),
            _ => {}
        }
        more
    }

    /// Replaces a velocity after a step, because no method of a world produces one that is not finite.
    pub fn seen(self, is_due: bool, velocity: Velocity) -> Velocity {
        if self == Self::NotANumber && is_due && velocity.linear.y < 0.0 {
            return Velocity { linear: Vec3 { y: f32::NAN, ..velocity.linear }, ..velocity };
        }
        velocity
    }
}

/// Holds a body below the floor, as if it had fallen through.
fn sink(world: &mut World) {
    let dynamic = world.body_ids().find(|&id| world.kind(id) == BodyKind::Dynamic);
    if let Some(id) = dynamic {
        let pose = world.transform(id);
        let translation = Vec3::new(pose.translation.x, -1.0, pose.translation.z);
        world.set_transform(id, Transform { translation, ..pose });
    }
}

impl Plant {
    /// Returns whether a fault that a life has found is of the injected kind.
    pub fn is_found(self, fault: &Fault) -> bool {
        match self {
            Self::ForgottenField | Self::ThreadOrder => matches!(fault, Fault::Differs(_)),
            Self::NotANumber => matches!(fault, Fault::NotFinite(_)),
            Self::EventTwice => matches!(fault, Fault::Event(_)),
            Self::EndForgotten => matches!(fault, Fault::Touch(_) | Fault::Event(_)),
            Self::EnergyFromNothing => matches!(fault, Fault::Energy(..)),
            Self::ThroughTheFloor => matches!(fault, Fault::Below(_)),
        }
    }

    /// Returns the seeds of the lives that find this fault, each with its running time, the fastest first.
    pub fn found_in(self, seeds: Range<u64>) -> Vec<(Duration, u64)> {
        let found = |seed| {
            let began = Instant::now();
            let outcome = run(&Life::of(seed), Some(self), false);
            let failure = outcome.result.err()?;
            self.is_found(&failure.fault).then(|| (began.elapsed(), seed))
        };
        let mut all: Vec<_> = seeds.filter_map(found).collect();
        all.sort();
        all
    }
}
