//! Particles that bodies or places in the world hold.

use super::forest::Freedom;
use super::{Part, ParticleGroup};
use sinew_math::{Sym3, Vec3};

/// The point that holds an attached particle, in one substep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Anchor {
    /// At the end of the substep, world, metres.
    pub position: Vec3,
    /// With which it has come there, m/s.
    pub velocity: Vec3,
    /// Velocity that the forces on the body will add to `velocity` within the next substep, m/s. The springs push for the interval to
    /// come, so they must know what else pulls in it, or a hung body would hang lower by `g h²`.
    pub gained: Vec3,
    /// Inverse mass of the point, 1/kg: velocity gained per impulse there, `I/m − [r]× J⁻¹ [r]×`. Zero if nothing
    /// moves it.
    pub inverse_mass: Sym3,
}

impl ParticleGroup {
    /// Puts attached particles where their anchors were, with the velocity that brings them to where those are, and
    /// with their inertia.
    pub(super) fn hold(&mut self, part: Part, anchors: &[Anchor]) {
        let [from, _] = part.shares();
        for (k, (a, anchor)) in self.attachments.iter().zip(anchors).enumerate() {
            let (i, velocity) = (a.particle as usize, self.anchor_velocities[k]);
            let before = anchor.position - anchor.velocity * (part.whole * (1.0 - from));
            self.positions[i] = before;
            self.previous[i] = before;
            if anchor.inverse_mass == Sym3::ZERO {
                self.system.freedom[i] = Freedom::Fixed;
                self.velocities[i] = velocity;
                self.weights[i] = 0.0;
                continue;
            }
            let of_body = anchor.inverse_mass.inverse();
            let coming = velocity + anchor.gained * (1.0 / part.of as f32);
            self.system.inertia[i] += of_body;
            self.system.momentum[i] += of_body * coming;
            let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z];
            let inverse = self.system.inertia[i].inverse();
            self.weights[i] = (x.dot(inverse * x) + y.dot(inverse * y) + z.dot(inverse * z)) / 3.0;
        }
    }

    /// Adds the impulse of each attachment: all that acts on its particle and does not change that one's momentum. The particle
    /// ends where its anchor is.
    pub(super) fn let_go(&mut self, part: Part, anchors: &[Anchor]) {
        let (h, [_, to]) = (part.h(), part.shares());
        for (k, (a, anchor)) in self.attachments.iter().zip(anchors).enumerate() {
            let i = a.particle as usize;
            let lost = self.begun[i] + self.accelerations[i] * h - self.velocities[i];
            let impulse = self.reactions[i] + lost * self.masses[i];
            self.attachment_impulses[k] += impulse;
            self.anchor_velocities[k] +=
                anchor.gained * (1.0 / part.of as f32) + anchor.inverse_mass * impulse;
            self.positions[i] = anchor.position - anchor.velocity * (part.whole * (1.0 - to));
        }
    }
}
