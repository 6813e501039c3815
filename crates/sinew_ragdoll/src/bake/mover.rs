//! Keyframed bodies of a bake: a door, a lift, a swinging beam.

use sinew_math::Transform;
use sinew_physics::{BodyDef, BodyId, BodyKind, World};

/// Body that follows keys regardless of obstacles.
#[derive(Clone, Debug)]
pub struct BakeMover<'a> {
    /// The body; it is kinematic, and the keys determine its pose and velocity.
    pub body: BodyDef,
    /// Times of the keys, seconds from the start, ascending; at least one.
    pub times: &'a [f32],
    /// Pose of the body in the world at each time, interpolated linearly between keys. The body is at rest before the
    /// first and after the last key.
    pub poses: &'a [Transform],
}

impl BakeMover<'_> {
    pub(super) fn check(&self) {
        let (times, poses) = (self.times, self.poses);
        assert!(!times.is_empty() && times.len() == poses.len(), "each key of a mover has a time and a pose");
        let ascend = times.iter().all(|time| time.is_finite()) && times.is_sorted();
        assert!(ascend, "times of a mover's keys are finite and ascend");
        assert!(poses.iter().all(|pose| pose.is_finite()), "poses of a mover's keys are finite");
    }

    /// Returns the pose of the body at a time, world.
    fn pose(&self, time: f32) -> Transform {
        let after = self.times.partition_point(|&key| key <= time);
        let (Some(before), true) = (after.checked_sub(1), after < self.times.len()) else {
            return self.poses[after.min(self.times.len() - 1)];
        };
        let share = (time - self.times[before]) / (self.times[after] - self.times[before]);
        let (a, b) = (&self.poses[before], &self.poses[after]);
        let translation = a.translation * (1.0 - share) + b.translation * share;
        Transform::new(translation, a.rotation.nlerp(b.rotation, share))
    }

    /// Adds the body to a world.
    ///
    /// # Panics
    /// If the body is not valid.
    pub fn enter(&self, world: &mut World) -> BodyId {
        let at = self.pose(0.0);
        let (position, rotation) = (at.translation, at.rotation);
        world.add_body(&BodyDef { kind: BodyKind::Kinematic, position, rotation, ..self.body.clone() })
    }

    /// Moves the body to its pose at the end of the next step of the world.
    ///
    /// # Panics
    /// If the body does not exist.
    pub fn lead(&self, id: BodyId, world: &mut World) {
        let dt = world.def().dt();
        world.move_to(id, self.pose(world.time() as f32 + dt), dt);
    }
}
