//! Curves beside a world that a picture tells apart.

use sinew::math::Vec3;

/// Curve of several that are compared: a picture gives each a colour of its own, by its place among them, and writes its name in that colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Name in the legend.
    pub name: String,
    /// Its pieces, from and to, world space, metres. Later curves are drawn over earlier ones.
    pub pieces: Vec<[Vec3; 2]>,
}
