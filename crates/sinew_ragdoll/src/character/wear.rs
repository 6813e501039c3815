//! Springs that a character wears, over the pose that clips or bodies give it.

use super::Character;
use crate::springs::SpringStep;
use sinew_physics::World;

impl Character {
    /// Takes its springs forward by a step of the world, about the pose that it has now.
    pub(super) fn wear(&mut self, world: &World) {
        let def = self.def.clone();
        let rig = def.springs();
        if rig.is_empty() {
            return;
        }
        let place = self.world_from_character;
        let mut bodies = core::mem::take(&mut self.scratch.after);
        bodies.clear();
        self.swung.clear();
        self.swung.extend_from_slice(if self.planting.is_over() { &self.pose } else { &self.planted });
        if rig.meets_bodies() {
            let pose = core::mem::take(&mut self.swung);
            self.bodies_of(&pose, place, &mut bodies);
            self.swung = pose;
        }
        let own = match (&self.ragdoll, &self.presence) {
            (Some(ragdoll), _) => ragdoll.bodies.as_slice(),
            (None, Some(presence)) => presence.bodies.as_slice(),
            (None, None) => &[],
        };
        self.swing.step(&SpringStep {
            rig,
            pose: &self.swung,
            world_from_model: def.mapping().world_from_model(place),
            bodies: &bodies,
            world: Some((world, own)),
            seconds: world.def().dt(),
        });
        self.scratch.after = bodies;
        self.show_springs();
    }

    /// Turns the bones of the springs as they swing, in the pose that is shown.
    pub(super) fn show_springs(&mut self) {
        for (joint, &turn) in self.def.springs().joints().zip(self.swing.turns()) {
            self.swung[joint].rotation = turn;
        }
    }

    /// Has its springs start over at rest with the next step: after a cut, where the way from the place before is none.
    pub fn reset_springs(&mut self) {
        self.swing.reset();
    }
}
