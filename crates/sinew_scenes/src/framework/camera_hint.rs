//! View of a scene in a picture.

use sinew::math::Vec3;
use sinew::physics::boxes::Aabb;

/// From where a picture looks at a scene, and at what.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraHint {
    /// Toward the camera, any length. Default a little from above and from the right of a viewer who looks along −z.
    pub direction: Vec3,
    /// Bounds of what has to be on the picture, world space, metres. Default whatever moves.
    pub bounds: Option<Aabb>,
    /// Default those of a few bodies.
    pub trails: Trails,
}

/// Choice of whether the ways of the bodies' centres of mass are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trails {
    /// If there are no more than a dozen bodies that move and nothing else.
    Few,
    /// Never.
    None,
}

impl Default for CameraHint {
    fn default() -> Self {
        Self { direction: Vec3::new(0.35, 0.3, 1.0), bounds: None, trails: Trails::Few }
    }
}
