//! Velocity of the root during an inertial transition.

use sinew_math::{ReadError, Reader, Vec3, Writer};

/// Velocity of the root, in model axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct RootVelocity {
    /// Linear velocity, file units per second.
    pub linear: Vec3,
    /// Angular velocity, radians per second.
    pub angular: Vec3,
}

/// Excess of the old root's velocity over the new one's. It decays like the offsets of the pose,
/// `x₀ (1 − 10 τ³ + 15 τ⁴ − 6 τ⁵)`, the quintic of [`Decay`](crate::Decay) without initial velocity. The root moves
/// half as far as with a constant excess.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct RootInertia {
    offset: RootVelocity,
    seconds: f32,
    elapsed: f32,
}

impl RootInertia {
    pub fn new(from: RootVelocity, to: RootVelocity, seconds: f32) -> Self {
        let offset = RootVelocity { linear: from.linear - to.linear, angular: from.angular - to.angular };
        Self { offset, seconds, elapsed: 0.0 }
    }

    /// Advances time by `seconds`; returns translation and rotation (scaled axis) that the offset adds in this time.
    pub fn advance(&mut self, seconds: f32) -> (Vec3, Vec3) {
        let before = self.lasted();
        self.elapsed += seconds;
        let time = self.lasted() - before;
        (self.offset.linear * time, self.offset.angular * time)
    }

    /// Integral of the decay, seconds: time in which the full offset would cover the same distance.
    fn lasted(&self) -> f32 {
        if self.seconds <= 0.0 {
            return 0.0;
        }
        let t = if self.elapsed < self.seconds { self.elapsed / self.seconds } else { 1.0 };
        self.seconds * t * (1.0 - t * t * t * (2.5 - t * (3.0 - t)))
    }

    pub fn save(&self, out: &mut Writer) {
        self.offset.save(out);
        out.f32(self.seconds);
        out.f32(self.elapsed);
    }

    pub fn load(bytes: &mut Reader<'_>) -> Result<Self, ReadError> {
        let (offset, seconds, elapsed) = (RootVelocity::load(bytes)?, bytes.f32()?, bytes.f32()?);
        if !(seconds >= 0.0 && seconds.is_finite() && elapsed >= 0.0 && elapsed.is_finite()) {
            return Err(bytes.error("a transition's time is negative or not finite"));
        }
        Ok(Self { offset, seconds, elapsed })
    }
}

impl RootVelocity {
    pub fn save(&self, out: &mut Writer) {
        out.vec3(self.linear);
        out.vec3(self.angular);
    }

    pub fn load(bytes: &mut Reader<'_>) -> Result<Self, ReadError> {
        let velocity = Self { linear: bytes.vec3()?, angular: bytes.vec3()? };
        if velocity.linear.is_finite() && velocity.angular.is_finite() {
            return Ok(velocity);
        }
        Err(bytes.error("a root's velocity is not finite"))
    }
}
