//! Points and rays against a hull, in its own frame.

use super::Hull;
use sinew_math::Vec3;

impl Hull {
    /// Signed distance of a point to the surface, metres, and the unit outward normal at the closest point of it: exact
    /// for faces, edges and corners. If several points are closest, the one on the first face.
    pub fn distance(&self, p: Vec3) -> (f32, Vec3) {
        self.polytope().distance(p)
    }

    /// Entry of a line from outside: fraction (≥ 0) and normal.
    pub(crate) fn enter(&self, origin: Vec3, direction: Vec3) -> Option<(f32, Vec3)> {
        self.polytope().enter(origin, direction)
    }
}
