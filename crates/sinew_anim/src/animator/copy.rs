//! Copies an animator into existing memory.

use super::{Animator, Slot};

impl Animator {
    /// Makes this animator a copy of another animator of the same set, for instance to predict poses. Unlike `clone`,
    /// it allocates only for more tracks or joints than before.
    ///
    /// # Panics
    /// If the rigs of the two animators have different numbers of joints.
    pub fn copy_from(&mut self, other: &Self) {
        self.room.spare.extend(self.slots.drain(..).map(Slot::emptied));
        for from in &other.slots {
            let mut slot = self.room.spare.pop().unwrap_or_else(|| from.clone());
            slot.copy_from(from);
            self.slots.push(slot);
        }
        self.next_id = other.next_id;
        self.interrupted.clone_from(&other.interrupted);
        self.last_fired.clone_from(&other.last_fired);
        self.awaits_transition = other.awaits_transition;
        self.inertia.copy_from(&other.inertia);
        (self.root_inertia, self.root_velocity) = (other.root_inertia, other.root_velocity);
        self.pose.copy_from(&other.pose);
        self.previous.copy_from(&other.previous);
        (self.previous_seconds, self.has_pose) = (other.previous_seconds, other.has_pose);
        match (&mut self.fed, &other.fed) {
            (Some(fed), Some(other)) => fed.copy_from(other),
            (fed, other) => fed.clone_from(other),
        }
        self.events.clone_from(&other.events);
        self.root_motion = other.root_motion;
        // The buffer is empty between updates.
    }
}

impl Slot {
    fn copy_from(&mut self, other: &Self) {
        self.track = other.track;
        self.cursor.copy_from(&other.cursor);
        self.pose.copy_from(&other.pose);
        (self.motion, self.is_crossfaded) = (other.motion, other.is_crossfaded);
        self.crossfade.copy_from(&other.crossfade);
    }
}
