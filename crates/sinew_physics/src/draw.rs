//! Lines that a world is drawn with.

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
    /// Outline of a sleeping one.
    Asleep,
    /// Line from a body's centre to a joint's anchor; of a pin, from the anchor to where it is pulled.
    Joint,
    /// A spring between two particles.
    Spring,
    /// A contact normal, 10 cm long.
    Contact,
    /// A line of an object of the user's own.
    Object,
}

/// Receives lines in world space.
pub trait DebugDraw {
    /// A line from `from` to `to`, metres.
    fn line(&mut self, from: Vec3, to: Vec3, kind: DrawKind);
}
