//! Regions in which fields act, and how they fade toward their borders.

use crate::body::shape::Shape;
use sinew_geometry::DefError;
use sinew_math::{Transform, Vec3};

/// Fall-off of a field's strength toward the border of its region, by `u`: 1 at full strength, 0 at the border.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Fade {
    /// Full strength up to the border. Default.
    #[default]
    None,
    /// Strength `u`.
    Linear,
    /// Strength `u² (3 − 2u)`: smooth at both ends.
    Smooth,
    /// Strength `u²`.
    Square,
}

impl Fade {
    /// Strength at `u`, 0..=1.
    pub fn strength(self, u: f32) -> f32 {
        match self {
            Self::None => 1.0,
            Self::Linear => u,
            Self::Smooth => u * u * (3.0 - 2.0 * u),
            Self::Square => u * u,
        }
    }
}

/// Region in which a field acts.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Region {
    /// The field acts in the whole world. Default.
    #[default]
    Everywhere,
    /// Inside a shape: the field has full strength deeper than `margin` below the surface, and fades to 0 at the
    /// surface.
    Inside {
        /// Shape of the region, or a half-space.
        shape: Shape,
        /// Pose of the shape in the world.
        world_from_shape: Transform,
        /// Depth at which the field has full strength, metres, ≥ 0. For a ball that fades from its centre, the ball's
        /// radius.
        margin: f32,
        /// Decrease of the strength over the margin.
        fade: Fade,
    },
}

impl Region {
    /// Returns a ball in which the field fades from the centre to the surface.
    pub fn ball(center: Vec3, radius: f32, fade: Fade) -> Self {
        Self::Inside {
            shape: Shape::Sphere { radius },
            world_from_shape: Transform::from_translation(center),
            margin: radius,
            fade,
        }
    }

    /// Strength at a world point, 0..=1; 0 outside.
    pub fn weight(&self, point: Vec3) -> f32 {
        match self {
            Self::Everywhere => 1.0,
            Self::Inside { shape, world_from_shape, margin, fade } => {
                let depth = -shape.signed_distance(world_from_shape, point).0;
                if depth < 0.0 {
                    0.0
                } else if depth >= *margin {
                    1.0
                } else {
                    fade.strength(depth / margin)
                }
            }
        }
    }

    /// Shape whose inside is the region; `None` for the whole world.
    pub(crate) fn shape(&self) -> Option<&Shape> {
        match self {
            Self::Everywhere => None,
            Self::Inside { shape, .. } => Some(shape),
        }
    }

    pub(super) fn check(&self) -> Result<(), DefError> {
        match self {
            Self::Everywhere => Ok(()),
            Self::Inside { shape, world_from_shape, margin, .. } => {
                shape.check()?;
                let valid = super::def::is_pose(world_from_shape) && super::def::not_negative(*margin);
                if valid {
                    Ok(())
                } else {
                    Err(DefError::new("a region's pose must be one, and its margin finite"))
                }
            }
        }
    }
}
