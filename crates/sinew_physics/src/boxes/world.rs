//! Questions to the world about points and regions.

use super::{Aabb, Capsule, Cuboid, Obb, Overlap, Penetration, PlacedBox, Sphere, SurfacePoint};
use crate::convex;
use crate::id::BodyId;
use crate::proxies::{Owner, thick};
use crate::shape::Shape;
use crate::triangles::overlaps_box;
use crate::world::World;
use core::ops::ControlFlow;
use sinew_math::{Transform, Vec3};

impl World {
    /// Bounds of all shapes of a body at its present pose, sensors among them; of a body without shapes the point where its
    /// frame is.
    pub fn bounds(&self, id: BodyId) -> Aabb {
        let place = self.transform(id).translation;
        let bounds = self.shapes(id).map(|(shape, frame)| shape.aabb(&frame));
        bounds.reduce(|a, b| a.merge(&b)).unwrap_or(Aabb { min: place, max: place })
    }

    /// Where the surface of a body is closest to a point (world), over all its shapes; `None` of a body without shapes. A
    /// point that several shapes hold is measured in the one that holds it deepest.
    pub fn nearest_surface(&self, id: BodyId, point: Vec3) -> Option<SurfacePoint> {
        let of_shape = |(shape, frame): (Shape, Transform)| {
            let (distance, normal) = shape.signed_distance(&frame, point);
            SurfacePoint { point: point - normal * distance, normal, distance }
        };
        self.shapes(id).map(of_shape).reduce(|a, b| if b.distance < a.distance { b } else { a })
    }

    /// Whether a point (world) is in a body or on its surface.
    pub fn contains_point(&self, id: BodyId, point: Vec3) -> bool {
        self.nearest_surface(id, point).is_some_and(|nearest| nearest.distance <= 0.0)
    }

    /// How deep a point (world) is in a body and in which direction the way out is shortest; `None` if it is outside. The
    /// way leads out of the shape that holds the point deepest.
    pub fn point_penetration(&self, id: BodyId, point: Vec3) -> Option<Penetration> {
        let SurfacePoint { distance, normal, .. } = self.nearest_surface(id, point)?;
        (distance <= 0.0).then_some(Penetration { depth: -distance, direction: normal })
    }

    /// Bodies with a shape that overlaps a region, by index; what touches overlaps.
    pub fn bodies_in(&self, region: &impl Cuboid) -> impl Iterator<Item = BodyId> {
        let region = region.placed();
        let reach = Vec3::from_array([Vec3::X, Vec3::Y, Vec3::Z].map(|axis| region.half_width(axis)));
        let bounds = thick(&Aabb::reaching(region.center, reach));
        let mut found = Vec::new();
        let _ = self.broad.proxies.overlapping(&bounds, |Owner { body, shape }| {
            let (at, shape) = (self.bodies.at(body), shape as usize);
            if meets(&region, &at.shapes[shape].shape, &at.world_from_shape(shape)) {
                found.push(body);
            }
            ControlFlow::<()>::Continue(())
        });
        found.sort_unstable();
        found.dedup();
        found.into_iter().map(|index| self.id_at(index))
    }
}

/// Whether a triangle of a surface and a region overlap.
fn surface_meets(region: &PlacedBox, shape: &Shape, world_from_shape: &Transform) -> bool {
    let reach = |axis: Vec3| region.half_width(world_from_shape.rotation * axis);
    let half = Vec3::new(reach(Vec3::X), reach(Vec3::Y), reach(Vec3::Z));
    let bounds = Aabb::reaching(world_from_shape.inverse_point(region.center), half);
    let mut meets = false;
    if let Some(surface) = shape.surface() {
        surface.overlapping(&bounds, |triangle| {
            let corners = triangle.corners.map(|corner| region.local_point(world_from_shape.point(corner)));
            meets = meets || overlaps_box(region.half, &corners);
        });
    }
    meets
}

/// Whether a placed shape and a region overlap.
fn meets(region: &PlacedBox, shape: &Shape, world_from_shape: &Transform) -> bool {
    let Transform { translation: center, rotation } = *world_from_shape;
    match *shape {
        Shape::Box { half_extents } => region.overlaps(&Obb { center, rotation, half_extents }.placed()),
        Shape::Sphere { radius } => region.overlaps(&Sphere { center, radius }),
        Shape::Capsule { half_height, radius } => {
            let reach = rotation * Vec3::Y * half_height;
            region.overlaps(&Capsule { ends: [center - reach, center + reach], radius })
        }
        Shape::TaperedCapsule { .. } | Shape::Cylinder { .. } | Shape::Cone { .. } => {
            convex::meets_box(shape, world_from_shape, region)
        }
        Shape::HalfSpace => {
            let normal = rotation * Vec3::Y;
            normal.dot(region.center - center) <= region.half_width(normal)
        }
        Shape::Mesh(_) | Shape::HeightField(_) => surface_meets(region, shape, world_from_shape),
    }
}
