//! Shapes as parts of bodies, and their filters.

use crate::body::contact_rule::ContactRule;
use crate::body::material::Material;
use sinew_geometry::DefError;
use sinew_math::Transform;

pub use sinew_geometry::{MassProperties, Shape};

/// Collision filter of a shape. Two shapes collide if each one's mask contains the other's layer, and they are not in
/// the same negative group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
#[doc(alias = "collision layer")]
#[doc(alias = "CollisionLayers")]
#[doc(alias = "InteractionGroups")]
#[doc(alias = "collision group")]
pub struct Filter {
    /// Bits of the shape's layers. Default 1.
    pub layers: u32,
    /// Bits of the layers that the shape collides with. Default all.
    pub mask: u32,
    /// Group of the shape: two shapes in the same positive group always collide, in the same negative group never.
    /// Default 0: none.
    pub group: i32,
}

impl Default for Filter {
    fn default() -> Self {
        Self { layers: 1, mask: u32::MAX, group: 0 }
    }
}

impl Filter {
    /// True if two shapes collide.
    pub fn meets(self, other: Self) -> bool {
        if self.group != 0 && self.group == other.group {
            return self.group > 0;
        }
        self.layers & other.mask != 0 && other.layers & self.mask != 0
    }

    /// True if the shape collides with no other shape, regardless of the filter of the other.
    pub fn meets_none(self) -> bool {
        self.group <= 0 && (self.layers == 0 || self.mask == 0)
    }
}

/// A shape as part of a body.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(alias = "Collider")]
#[doc(alias = "ColliderBuilder")]
#[doc(alias = "fixture")]
pub struct ShapeDef {
    /// Geometry of the shape.
    pub shape: Shape,
    /// Pose of the shape in the body's frame.
    pub body_from_shape: Transform,
    /// Density, kg/m³, ≥ 0. Default 1000. Has no effect if the body's mass is given.
    pub density: f32,
    /// Material of the surface.
    pub material: Material,
    /// Collision filter of the shape.
    pub filter: Filter,
    /// Effect on touching shapes: solid or sensor.
    pub sensing: Sensing,
    /// Rule for the shape's contacts. Default: they push.
    pub rule: ContactRule,
}

/// Effect of a shape on the shapes that touch it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(alias = "trigger")]
#[doc(alias = "sensor")]
#[doc(alias = "is_trigger")]
pub enum Sensing {
    /// The shape pushes others. Default.
    #[default]
    Solid,
    /// The shape only reports others.
    Sensor,
}

impl ShapeDef {
    /// Checks that the numbers of the definition are valid; the error phrase names the problem.
    ///
    /// # Errors
    /// Returns a phrase that names the problem, in lower case.
    pub fn check(&self) -> Result<(), DefError> {
        self.shape.check()?;
        self.material.check()?;
        self.rule.check()?;
        let placed = self.body_from_shape.is_finite();
        // The comparison is false for NaN.
        let dense = (0.0..f32::INFINITY).contains(&self.density);
        if placed && dense {
            Ok(())
        } else {
            Err(DefError::new("a shape's pose and density must be finite, density not negative"))
        }
    }

    /// Creates a shape at the body's origin, with defaults.
    pub fn new(shape: Shape) -> Self {
        Self {
            shape,
            body_from_shape: Transform::IDENTITY,
            density: 1000.0,
            material: Material::default(),
            filter: Filter::default(),
            sensing: Sensing::Solid,
            rule: ContactRule::Push,
        }
    }
}

/// Converts with [`ShapeDef::new`].
impl From<Shape> for ShapeDef {
    fn from(shape: Shape) -> Self {
        Self::new(shape)
    }
}
