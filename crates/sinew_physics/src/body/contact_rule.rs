//! Rules applied to a shape's contacts before solving: push, ignore or modify.

use crate::body::Velocity;
use crate::body::material::{ContactMaterial, Material};
use crate::collide::ManifoldPoint;
use crate::id::ShapeId;
use sinew_geometry::DefError;
use sinew_math::{Vec3, normalize_or};

/// Rule for the contacts of a shape. Contacts of two shapes push only if both rules allow it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(alias = "one-way platform")]
pub enum ContactRule {
    /// Contacts push. Default.
    #[default]
    Push,
    /// Contacts are reported but do not push.
    Ghost,
    /// Contacts push from one side only.
    OneWay(OneWay),
    /// While the body is kinematic, its contacts push with limited force: for bodies moved by an animation clip. Movers
    /// pass through.
    Yields(Yields),
    /// A user function decides on each contact.
    Modified {
        /// Number of the modifier, as [registered](crate::World::register_modifier).
        modifier: u32,
    },
}

impl ContactRule {
    /// Checks that the numbers of the rule are valid; the error phrase names the problem.
    ///
    /// # Errors
    /// Returns a phrase that names the problem, in lower case.
    pub fn check(&self) -> Result<(), DefError> {
        match self {
            Self::OneWay(one_way) => one_way.check(),
            Self::Yields(yields) => yields.check(),
            Self::Push | Self::Ghost | Self::Modified { .. } => Ok(()),
        }
    }
}

/// A platform that is solid from one side and open from the others.
///
/// The decision made when two shapes first come near each other lasts while they touch. A body that came from below
/// passes until it is out on any side; a body resting on top stays there, even if it tips over the edge.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct OneWay {
    /// Direction from the platform to the bodies it holds up, in the shape's frame; non-zero, of any length. Default
    /// +y.
    pub direction: Vec3,
    /// Largest angle between the contact's normal and that direction at which the contact is solid, radians, 0 to π.
    /// Default 45°.
    pub tolerance: f32,
}

impl Default for OneWay {
    fn default() -> Self {
        Self { direction: Vec3::Y, tolerance: core::f32::consts::FRAC_PI_4 }
    }
}

impl OneWay {
    fn check(&self) -> Result<(), DefError> {
        // The comparison is false for NaN.
        let length = self.direction.length();
        if !(length > 0.0 && length < f32::INFINITY) {
            return Err(DefError::new("the direction of a one-way shape must be finite and not 0"));
        }
        if !(0.0..=core::f32::consts::PI).contains(&self.tolerance) {
            return Err(DefError::new(
                "the tolerance of a one-way shape must be an angle of 0 to 180 degrees",
            ));
        }
        Ok(())
    }

    /// True if the platform is solid against a body in direction `normal` from the platform, in its frame.
    pub(crate) fn holds(&self, normal: Vec3) -> bool {
        normalize_or(self.direction, Vec3::Y).dot(normal) >= sinew_math::trig::cos(self.tolerance)
    }
}

/// Limits on the effect of a kinematic body on dynamic ones. Beyond the limits the two bodies pass through each other
/// until they are separate. On a dynamic body this rule has no effect.
///
/// A hand stops a flying object and throws it back, kicks a ball, and passes through a crate of 50 kg.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Yields {
    /// Largest force on a body that does not approach by itself, N: averaged over a step, as if that body were free.
    /// Default 150.
    #[cfg_attr(feature = "serde", serde(with = "sinew_math::unlimited"))]
    pub max_force: f32,
    /// Largest momentum of an approaching body that the kinematic body stops, N·s. Default 60.
    #[cfg_attr(feature = "serde", serde(with = "sinew_math::unlimited"))]
    pub max_impulse: f32,
}

impl Default for Yields {
    fn default() -> Self {
        Self { max_force: 150.0, max_impulse: 60.0 }
    }
}

impl Yields {
    fn check(&self) -> Result<(), DefError> {
        // The comparison is false for NaN.
        if [self.max_force, self.max_impulse].iter().all(|x| (0.0..f32::INFINITY).contains(x)) {
            return Ok(());
        }
        Err(DefError::new(
            "the force and the impulse of a shape that yields must not be negative, and finite",
        ))
    }
}

/// One side of a contact, as passed to a modifier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactSide {
    /// Shape on this side of the contact.
    pub shape: ShapeId,
    /// User data of the shape's body.
    pub user_data: u64,
    /// Material of the shape.
    pub material: Material,
    /// Velocity of the shape's body, world axes.
    pub velocity: Velocity,
    /// Centre of mass of the shape's body, world, metres.
    pub center: Vec3,
}

/// A contact as passed to a modifier, at the step's start.
#[derive(Clone, Copy, Debug)]
pub struct FoundContact<'a> {
    /// Sides of the contact; the one with the smaller body index is first.
    pub sides: [ContactSide; 2],
    /// Normal from the first side to the second, unit length, world axes.
    pub normal: Vec3,
    /// Points of the contact, at least one.
    pub points: &'a [ManifoldPoint],
    /// Number of steps taken before this one.
    pub step: u64,
}

/// Function that sets the material of a contact, given the combined material; `None` disables the push in this step.
///
/// The function must be pure, so that a snapshot determines the future. The type is a function pointer instead of a
/// closure, because the function must not have state. For the same bits everywhere it must use only `+ − × ÷ √` and
/// `sinew_math`. The step calls it in the order of contacts, once for each side that uses it, the first side first. An
/// invalid material (negative, not finite) is ignored.
pub type ContactModifier = fn(&FoundContact<'_>, ContactMaterial) -> Option<ContactMaterial>;
