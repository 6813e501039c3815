//! Distances of points and ray entries for a hull, in its own frame.

use super::Hull;
use sinew_math::Vec3;

impl Hull {
    /// Returns the signed distance of a point to the surface, metres, and the unit outward normal at the closest point
    /// of the surface. The distance is exact for faces, edges and corners, except for rounding. If several points are
    /// closest, the point on the first of their faces is used.
    pub fn distance(&self, p: Vec3) -> (f32, Vec3) {
        self.polytope().distance(p)
    }

    /// Returns the fraction (≥ 0) and the normal at which a ray from outside enters the hull.
    pub(crate) fn enter(&self, origin: Vec3, direction: Vec3) -> Option<(f32, Vec3)> {
        self.polytope().enter(origin, direction)
    }
}
