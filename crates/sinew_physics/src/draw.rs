//! Interface for debug drawing: a world draws itself as lines.

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
    /// Line from a body's centre to a joint's anchor; for a pin, from the anchor to its target.
    Joint,
    /// A spring between two particles.
    Spring,
    /// A contact normal, 10 cm long.
    Contact,
    /// A line of an object of the user's own kind.
    Object,
}

/// Receives lines in world space.
pub trait DebugDraw {
    /// Draws a line from `from` to `to`, world, metres.
    fn line(&mut self, from: Vec3, to: Vec3, kind: DrawKind);
}
