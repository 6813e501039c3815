//! View of a scene in a picture.

use sinew::math::Vec3;
use sinew::physics::boxes::Aabb;

/// Direction and bounds of a scene's view in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraHint {
    /// Direction toward the camera, of any length. Default: a little from above and from the right of a viewer who
    /// looks along −z.
    pub direction: Vec3,
    /// Bounds that must be visible, world space, metres. Default: all moving bodies.
    pub bounds: Option<Aabb>,
    /// Paths drawn in the picture. Default: those of a few bodies.
    pub trails: Trails,
}

/// Drawing mode of the paths of the bodies' centres of mass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trails {
    /// The paths are drawn only if there are at most a dozen moving bodies and nothing else.
    Few,
    /// No paths are drawn.
    None,
}

impl Default for CameraHint {
    fn default() -> Self {
        Self { direction: Vec3::new(0.35, 0.3, 1.0), bounds: None, trails: Trails::Few }
    }
}
