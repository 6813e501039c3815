//! Measures the motion of a ragdoll that starts at rest in its bind pose without gravity.

use super::exam::Exam;
use super::{Code, Finding};
use crate::doctor::tuning::{MOVED_LENGTH, MOVED_SHARE, TURNED};
use sinew_math::{Vec3, max};
use sinew_physics::{BodyDef, BodyId, JointDef, ShapeDef, Spring, World, WorldDef};

/// Number of steps in half a second.
const STEPS: u32 = 30;

/// Motion of the bodies without a cause. Positions show more than speeds: a solver that adds no energy corrects errors
/// by position changes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Jitter {
    /// Largest displacement of a body, metres, and the index of the body.
    moved: (f32, usize),
    /// Largest rotation of a body, radians, and the index of the body.
    turned: (f32, usize),
    /// Largest kinetic energy, J.
    energy: f32,
    /// True if a state became not finite.
    is_lost: bool,
}

impl Jitter {
    /// Simulates half a second from rest. The joints come from the definition and are not fitted to the pose.
    pub fn of(exam: &Exam<'_>) -> Self {
        let def = exam.def;
        if !def.bodies.iter().all(|body| super::masses::is_positive(&body.mass)) {
            return Self::default();
        }
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        let place = |body: &crate::def::RagdollBodyDef| BodyDef {
            position: body.character_from_body.translation,
            rotation: body.character_from_body.rotation,
            shapes: vec![ShapeDef::new(body.shape.clone())],
            mass: Some(body.mass),
            ..BodyDef::default()
        };
        let bodies: Vec<BodyId> = def.bodies.iter().map(|body| world.add_body(&place(body))).collect();
        for &(a, b) in &def.disabled_pairs {
            world.disable_pair(bodies[a], bodies[b]);
        }
        for (index, joint) in def.joints.iter().enumerate() {
            let (a, b) = (bodies[joint.parent], bodies[joint.child]);
            let softness = exam.repair.springs.get(index).copied().flatten();
            let rest = joint.frame_parent.inverse()
                * def.bodies[joint.parent].character_from_body.inverse()
                * def.bodies[joint.child].character_from_body
                * joint.frame_child;
            world.add_joint(&JointDef {
                friction_torque: joint.friction_torque,
                spring: softness.map(|softness| Spring { softness, rest }),
                ..JointDef::between(a, b, joint.frame_parent, joint.frame_child, joint.kind)
            });
        }
        let mut seen = Self::default();
        for _ in 0..STEPS {
            world.step();
            for (index, &body) in bodies.iter().enumerate() {
                let (now, then) = (world.transform(body), def.bodies[index].character_from_body);
                let moved = (now.translation - then.translation).length();
                let turned = now.rotation.angle_to(then.rotation);
                seen.is_lost |= !now.is_finite();
                if moved > seen.moved.0 {
                    seen.moved = (moved, index);
                }
                if turned > seen.turned.0 {
                    seen.turned = (turned, index);
                }
            }
            seen.energy = max(seen.energy, world.energy().kinetic);
        }
        seen
    }

    /// Returns a description of significant motion; `None` if there is none.
    pub fn is_notable(&self, exam: &Exam<'_>) -> Option<String> {
        if self.is_lost {
            return Some("left alone without gravity it is lost within half a second".to_owned());
        }
        (self.moved.0 > MOVED_SHARE * exam.size + MOVED_LENGTH || self.turned.0 > TURNED).then(|| {
            let gained = if self.energy < 0.01 {
                String::new()
            } else {
                format!(", with {:.2} J from nothing", self.energy)
            };
            format!(
                "left alone without gravity {} moves by {:.0} mm and {} turns by {:.0}° within half a second{gained}",
                exam.who(self.moved.1),
                1000.0 * self.moved.0,
                exam.who(self.turned.1),
                self.turned.0.to_degrees(),
            )
        })
    }

    /// Returns the finding for motion that no other finding explains.
    pub fn finding(&self, exam: &Exam<'_>, evidence: String) -> Finding {
        exam.finding(Code::MovesByItself, &[self.moved.1], evidence)
    }
}
