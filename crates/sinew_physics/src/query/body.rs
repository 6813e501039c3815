//! Queries about one body: bounds, nearest surface, points inside.

use crate::body::shape::Shape;
use crate::boxes::{Aabb, Penetration, SurfacePoint};
use crate::id::BodyId;
use crate::world::World;
use sinew_math::{Transform, Vec3};

impl World {
    /// Returns the bounds of all shapes of a body at its current pose, including sensors; for a body without shapes,
    /// the origin of its frame.
    #[track_caller]
    pub fn bounds(&self, id: BodyId) -> Aabb {
        let place = self.transform(id).translation;
        let bounds = self.shapes(id).map(|(shape, frame)| shape.aabb(&frame));
        bounds.reduce(|a, b| a.merge(&b)).unwrap_or(Aabb { min: place, max: place })
    }

    /// Returns the nearest point on the surface of a body to a point (world), over all shapes of the body; `None` for a
    /// body without shapes. A point inside several shapes is measured in the one that contains it deepest.
    #[track_caller]
    pub fn nearest_surface(&self, id: BodyId, point: Vec3) -> Option<SurfacePoint> {
        let of_shape = |(shape, frame): (Shape, Transform)| shape.nearest_surface(&frame, point);
        self.shapes(id).map(of_shape).reduce(|a, b| if b.distance < a.distance { b } else { a })
    }

    /// True if a point (world) is in a body or on its surface.
    pub fn contains_point(&self, id: BodyId, point: Vec3) -> bool {
        self.nearest_surface(id, point).is_some_and(|nearest| nearest.distance <= 0.0)
    }

    /// Returns the depth of a point (world) in a body, and the direction of the shortest way out; `None` if the point
    /// is outside. The way leads out of the shape that contains the point deepest.
    #[track_caller]
    pub fn point_penetration(&self, id: BodyId, point: Vec3) -> Option<Penetration> {
        let SurfacePoint { distance, normal, .. } = self.nearest_surface(id, point)?;
        (distance <= 0.0).then_some(Penetration { depth: -distance, direction: normal })
    }
}
