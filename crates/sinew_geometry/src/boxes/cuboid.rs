//! Queries of axis-aligned and oriented boxes.

use super::{Aabb, Obb, Penetration, PlacedBox, SurfacePoint};
use crate::boxes::distance_beyond;
use crate::mass::box_inertia;
use crate::ray::{Ray, RayHit};
use crate::shape::{MassProperties, Shape};
use sinew_math::{Rotation, Sym3, Transform, Vec3, max3, min3};

/// A box: [`Aabb`], [`Obb`] or [`PlacedBox`]. Points, distances and directions are in the space that contains the box.
///
/// Every result is computed from [`placed`](Self::placed), in the documented order of operations, so that batch code
/// can give the same bits.
pub trait Cuboid {
    /// Returns the box with its axes computed.
    fn placed(&self) -> PlacedBox;

    /// True if the point is in the box or on its surface: `|(p − c)·aₖ| ≤ hₖ` along each axis, without tolerance.
    fn contains_point(&self, point: Vec3) -> bool {
        self.placed().holds(point)
    }

    /// Distance from the surface to the point, metres; negative inside, 0 on the surface.
    fn signed_distance(&self, point: Vec3) -> f32 {
        self.nearest_surface(point).distance
    }

    /// Returns the closest point of the surface, with the distance to it.
    fn nearest_surface(&self, point: Vec3) -> SurfacePoint {
        self.placed().nearest_surface(point)
    }

    /// Returns the closest point of the solid box; for a point inside, the point itself except for rounding.
    fn closest_point(&self, point: Vec3) -> Vec3 {
        self.placed().closest(point)
    }

    /// Returns the depth of a point in the box and the direction of the shortest way out; `None` if the point is
    /// outside.
    fn point_penetration(&self, point: Vec3) -> Option<Penetration> {
        let SurfacePoint { distance, normal, .. } = self.nearest_surface(point);
        (distance <= 0.0).then_some(Penetration { depth: -distance, direction: normal })
    }

    /// Returns the first point of the ray that is in the box, and the normal there; `None` if the ray misses the box or
    /// a number is not finite. For a start inside the box, the rules of [`Shape::cast_ray`] apply.
    fn cast_ray(&self, ray: &Ray) -> Option<RayHit> {
        self.cast_half_line(ray).filter(|hit| hit.fraction <= 1.0)
    }

    /// Like [`cast_ray`](Self::cast_ray), for a ray without an end; the fraction counts lengths of the ray's direction.
    fn cast_half_line(&self, ray: &Ray) -> Option<RayHit> {
        if !(ray.origin.is_finite() && ray.direction.is_finite()) {
            return None;
        }
        let placed = self.placed();
        let shape = Shape::Box { half_extents: placed.half };
        let (origin, direction) = (placed.local_point(ray.origin), placed.local_vector(ray.direction));
        let (fraction, normal) = shape.cast_local(origin, direction)?;
        Some(RayHit { fraction, point: ray.at(fraction), normal: placed.vector(normal) })
    }

    /// Returns the eight corners. Bit k of a corner's index is set if the corner is on the positive side of axis k.
    fn corners(&self) -> [Vec3; 8] {
        let placed = self.placed();
        core::array::from_fn(|index| placed.vertex(index))
    }

    /// Volume, m³.
    fn volume(&self) -> f32 {
        let h = self.placed().half;
        8.0 * h.x * h.y * h.z
    }

    /// Surface area, m²; for a rectangle the area of both sides.
    fn surface_area(&self) -> f32 {
        let h = self.placed().half;
        8.0 * (h.x * h.y + h.y * h.z + h.z * h.x)
    }

    /// Inertia of a solid box of this mass (kg, ≥ 0) about its centre, in the axes of its space, kg·m². Boxes without
    /// volume have inertia too.
    ///
    /// # Panics
    /// If the mass is negative or not finite.
    fn inertia(&self, mass: f32) -> Sym3 {
        assert!((0.0..f32::INFINITY).contains(&mass), "a mass must be finite and not negative");
        let PlacedBox { axes: [x, y, z], half, .. } = self.placed();
        let d = box_inertia(half, mass);
        Sym3::outer(x) * d.x + Sym3::outer(y) * d.y + Sym3::outer(z) * d.z
    }

    /// Mass, centre and inertia of a solid box of `density` (kg/m³), in its space.
    ///
    /// # Panics
    /// If the density is negative or not finite.
    fn mass_properties(&self, density: f32) -> MassProperties {
        assert!((0.0..f32::INFINITY).contains(&density), "a density must be finite and not negative");
        let mass = density * self.volume();
        MassProperties { mass, center: self.placed().center, inertia: self.inertia(mass) }
    }
}

impl Cuboid for PlacedBox {
    fn placed(&self) -> PlacedBox {
        *self
    }
}

impl Cuboid for Obb {
    fn placed(&self) -> PlacedBox {
        PlacedBox::new(self.half_extents, &self.to_transform())
    }
}

/// Points are compared with the stored corners. Overlaps with other kinds of shapes, and rays, use the centre, which is
/// rounded to `f32`.
impl Cuboid for Aabb {
    fn placed(&self) -> PlacedBox {
        PlacedBox::new(self.half_extents(), &Transform::new(self.center(), Rotation::IDENTITY))
    }

    fn contains_point(&self, point: Vec3) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }

    fn nearest_surface(&self, point: Vec3) -> SurfacePoint {
        let (below, above) = (self.min - point, point - self.max);
        let (distance, normal) = distance_beyond(max3(below, above), above - below);
        SurfacePoint { point: point - normal * distance, normal, distance }
    }

    fn closest_point(&self, point: Vec3) -> Vec3 {
        max3(min3(point, self.max), self.min)
    }
}
