//! Blows passed on through joints before the step that follows.

use crate::character::tuning::PASSES_ON;
use crate::def::{RagdollDef, RagdollJointDef};
use crate::ragdoll::Ragdoll;
use sinew_math::{Sym3, Vec3};
use sinew_physics::{BodyKind, Velocity, World};

/// A body on which joints pull.
struct Pulled {
    center: Vec3,
    velocity: Velocity,
    inverse_mass: f32,
    inverse_inertia: Sym3,
}

impl Pulled {
    fn at(&self, point: Vec3) -> Vec3 {
        self.velocity.at(point - self.center)
    }

    fn pull(&mut self, impulse: Vec3, point: Vec3) {
        self.velocity.linear += impulse * self.inverse_mass;
        self.velocity.angular += self.inverse_inertia * (point - self.center).cross(impulse);
    }

    /// Change of velocity of a point for an impulse there.
    fn response(&self, point: Vec3) -> Sym3 {
        let arm = point - self.center;
        let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z]
            .map(|axis| axis * self.inverse_mass + (self.inverse_inertia * arm.cross(axis)).cross(arm));
        Sym3 { diagonal: Vec3::new(x.x, y.y, z.z), off: Vec3::new(y.z, x.z, x.y) }
    }
}

/// Has the joints of a ragdoll pass on the velocities of its bodies, so that their anchors go together: what was struck takes along what hangs
/// on it. The step would do that, but looks before for what may be met by how fast each body is: a hand whose arm was struck would be
/// in the thigh by then. Momentum stays; what the joints hold back is left as it is.
pub(super) fn pass_on(world: &mut World, def: &RagdollDef, ragdoll: &Ragdoll) {
    let pulled = |&id| {
        let (mass, turn) = (world.mass(id), world.transform(id).rotation);
        let moves = world.kind(id) == BodyKind::Dynamic;
        Pulled {
            center: world.center_of_mass(id),
            velocity: world.velocity(id),
            inverse_mass: if moves { 1.0 / mass.mass } else { 0.0 },
            inverse_inertia: if moves { mass.inertia.inverse().rotated(turn) } else { Sym3::ZERO },
        }
    };
    let mut bodies: Vec<Pulled> = ragdoll.bodies.iter().map(pulled).collect();
    let anchor = |joint: &RagdollJointDef| {
        let (parent, child) = (joint.parent, joint.child);
        let point = world.transform(ragdoll.bodies[parent]).point(joint.frame_parent.translation);
        let response = bodies[parent].response(point) + bodies[child].response(point);
        (parent, child, point, response.inverse())
    };
    let anchors: Vec<(usize, usize, Vec3, Sym3)> = def.joints.iter().map(anchor).collect();
    for _ in 0..PASSES_ON {
        for &(parent, child, point, mass) in anchors.iter().chain(anchors.iter().rev()) {
            let impulse = mass * (bodies[child].at(point) - bodies[parent].at(point));
            bodies[parent].pull(impulse, point);
            bodies[child].pull(-impulse, point);
        }
    }
    for (&id, body) in ragdoll.bodies.iter().zip(&bodies) {
        if world.kind(id) == BodyKind::Dynamic {
            world.set_velocity(id, body.velocity);
        }
    }
}
