//! Conversion of frame times to whole steps.

use crate::world::World;
use core::time::Duration;

/// Steps taken by an update, the remaining time, and the time dropped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Update {
    /// Number of steps taken.
    pub steps: u32,
    /// Remaining time until the next step, as a share of a step, 0..1: for [`World::interpolated`] and
    /// [`ParticleGroup::interpolated`](crate::particles::ParticleGroup::interpolated).
    pub alpha: f32,
    /// Time dropped because more than [`WorldDef::catch_up_steps`](crate::WorldDef::catch_up_steps) steps were due: the
    /// world stays behind by this time. Zero while the host keeps up.
    pub dropped: Duration,
}

impl World {
    /// Takes all whole steps that fit in the given and the stored time, on the calling thread. Time is counted in whole
    /// nanoseconds, so the state after step k does not depend on the frame rate.
    ///
    /// For a frame time as floating-point seconds use `Duration::from_secs_f32(seconds)`, which panics if the seconds
    /// are negative or not finite.
    ///
    /// ```
    /// use core::time::Duration;
    /// use sinew_physics::{BodyDef, Shape, ShapeDef, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default());
    /// let shapes = vec![ShapeDef::new(Shape::Sphere { radius: 0.1 })];
    /// let ball = world.add_body(&BodyDef { shapes, ..BodyDef::default() });
    /// let frame = world.update(Duration::from_secs_f32(0.040));
    /// assert_eq!(frame.steps, 2); // of 1/60 s
    /// let drawn = world.interpolated(ball, frame.alpha);
    /// assert!(drawn.translation.y < 0.0);
    /// ```
    pub fn update(&mut self, time: Duration) -> Update {
        self.update_with(time, World::step)
    }

    /// Takes the same steps as [`update`](Self::update), each by a call of `step`: for threads and profiling
    /// ([`step_with`](Self::step_with)), for forces in every step instead of a frame's first only, and for the
    /// [`events`](Self::events) of every step instead of the last only.
    ///
    /// ```
    /// # use core::time::Duration;
    /// # use sinew_physics::{World, WorldDef};
    /// # let mut world = World::new(WorldDef::default());
    /// let mut hits = 0;
    /// world.update_with(Duration::from_millis(33), |world| {
    ///     world.step();
    ///     hits += world.events().begin.len();
    /// });
    /// ```
    ///
    /// # Panics
    /// If a call of `step` does not take exactly one step.
    pub fn update_with(&mut self, time: Duration, mut step: impl FnMut(&mut World)) -> Update {
        let length = u128::from(self.def.step_nanoseconds);
        let pending = u128::from(self.pending_nanoseconds) + time.as_nanos();
        let due = pending / length;
        let steps = u128::min(due, u128::from(self.def.catch_up_steps)) as u32;
        self.pending_nanoseconds = (pending % length) as u64;
        let expected = self.steps + u64::from(steps);
        for _ in 0..steps {
            step(self);
        }
        assert_eq!(self.steps, expected, "each call takes one step");
        let alpha = self.pending_nanoseconds as f32 / self.def.step_nanoseconds as f32;
        Update { steps, alpha, dropped: nanoseconds((due - u128::from(steps)) * length) }
    }
}

/// Converts nanoseconds to a duration; saturates at the longest duration.
fn nanoseconds(count: u128) -> Duration {
    const SECOND: u128 = 1_000_000_000;
    u64::try_from(count / SECOND).map_or(Duration::MAX, |s| Duration::new(s, (count % SECOND) as u32))
}
