//! Curves drawn beside a world and compared in a picture.

use sinew::math::Vec3;

/// One of several compared curves. A picture gives each a colour by its index, and writes its name in that colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Name in the legend.
    pub name: String,
    /// Line segments of the curve, world space, metres. Later curves are drawn over earlier ones.
    pub pieces: Vec<[Vec3; 2]>,
}
