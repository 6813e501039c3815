//! Lines for drawing a world.

use sinew_math::Vec3;

/// Meaning of a line; the host chooses the colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawKind {
    /// Outline of a static shape.
    Static,
    /// Outline of a kinematic shape.
    Kinematic,
    /// Outline of an awake dynamic shape.
    Awake,
    /// Outline of a sleeping dynamic shape.
    Asleep,
    /// Line from a body's centre to a joint's anchor; for a pin, from the anchor to the point that pulls it.
    Joint,
    /// A spring between two particles.
    Spring,
    /// A contact normal, 10 cm long.
    Contact,
    /// A line of a user-defined object.
    Object,
}

/// Receives lines in world space.
pub trait DebugDraw {
    /// Draws a line from `from` to `to`, metres.
    fn line(&mut self, from: Vec3, to: Vec3, kind: DrawKind);
}
