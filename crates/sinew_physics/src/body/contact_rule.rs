//! Rules for a shape's contacts before they are solved: they push, let pass, or are changed.

use crate::body::Velocity;
use crate::body::material::{ContactMaterial, Material};
use crate::collide::ManifoldPoint;
use crate::id::ShapeId;
use sinew_geometry::DefError;
use sinew_math::{Vec3, normalize_or};

/// Rule for the contacts of a shape. Contacts of two shapes push only if both rules let them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(alias = "one-way platform")]
pub enum ContactRule {
    /// They push. Default.
    #[default]
    Push,
    /// They are told of, as all contacts are, but do not push.
    Ghost,
    /// They push what comes from one side.
    OneWay(OneWay),
    /// They push with limited force as long as their body is kinematic: what moves as a clip has it. Movers pass through.
    Yields(Yields),
    /// They push as a function of the user's says.
    Modified {
        /// Its number, as [registered](crate::World::register_modifier).
        modifier: u32,
    },
}

impl ContactRule {
    /// Checks that the numbers of the rule are valid; the phrase says what is wrong.
    ///
    /// # Errors
    /// What is wrong, in lower case.
    pub fn check(&self) -> Result<(), DefError> {
        match self {
            Self::OneWay(one_way) => one_way.check(),
            Self::Yields(yields) => yields.check(),
            Self::Push | Self::Ghost | Self::Modified { .. } => Ok(()),
        }
    }
}

/// A platform that is solid from one side and lets pass what comes from the others.
///
/// What is decided when two shapes come near each other stays while they touch: what has come from below passes until it
/// is out, on whichever side, and what lies on top goes on lying there, also when it tips over the edge.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct OneWay {
    /// From the platform to what it holds up, in the shape's frame; not 0. Its length does not matter. Default +y.
    pub direction: Vec3,
    /// Largest angle between the contact's normal and that direction with which the contact is solid, radians, 0 to π.
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
        // Written so that NaN fails.
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

    /// True if it is solid against what lies along `normal` from it, in its frame.
    pub(crate) fn holds(&self, normal: Vec3) -> bool {
        normalize_or(self.direction, Vec3::Y).dot(normal) >= sinew_math::trig::cos(self.tolerance)
    }
}

/// Bounds of what a kinematic body does to dynamic ones that it meets; beyond them the two pass through each other until they
/// are apart. A dynamic body with this rule pushes as any other does.
///
/// What flies into a hand is stopped and thrown back, a ball is kicked, a crate of 50 kg is let be: the hand goes through it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Yields {
    /// Most force with which it shoves what does not come by itself, N: over a step, and as if that were free. Default 150.
    #[cfg_attr(feature = "serde", serde(with = "sinew_math::unlimited"))]
    pub max_force: f32,
    /// Most momentum of what comes by itself that it stops, N·s. Default 60.
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
        // Written so that NaN fails.
        if [self.max_force, self.max_impulse].iter().all(|x| (0.0..f32::INFINITY).contains(x)) {
            return Ok(());
        }
        Err(DefError::new(
            "the force and the impulse of a shape that yields must not be negative, and finite",
        ))
    }
}

/// One side of a contact that a modifier looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactSide {
    /// The shape.
    pub shape: ShapeId,
    /// The user's number on its body.
    pub user_data: u64,
    /// Its material.
    pub material: Material,
    /// Velocity of its body, world axes.
    pub velocity: Velocity,
    /// Centre of mass of its body, world, metres.
    pub center: Vec3,
}

/// A contact that a modifier looks at, as the step finds it.
#[derive(Clone, Copy, Debug)]
pub struct FoundContact<'a> {
    /// The two sides; the one with the smaller body index is the first.
    pub sides: [ContactSide; 2],
    /// From the first to the second, unit length, world axes.
    pub normal: Vec3,
    /// At least one.
    pub points: &'a [ManifoldPoint],
    /// Steps that the world took before this one.
    pub step: u64,
}

/// Function that sets the material of a contact; `None`: it does not push in this step. It is given what the two materials make of it.
///
/// A pure function of what it is given, so that a snapshot holds all that decides. A plain function, not a closure: there is
/// nothing that it could remember. For the same bits everywhere it must be made of `+ − × ÷ √` and `sinew_math`. It is called
/// in the order of contacts, once for each side that asks for it, the first side's first. An answer that is no valid material
/// (negative, not finite) is not taken.
pub type ContactModifier = fn(&FoundContact<'_>, ContactMaterial) -> Option<ContactMaterial>;
