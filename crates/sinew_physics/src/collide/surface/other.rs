//! Any convex shape against a triangle: direction and gap by GJK and EPA, the triangle being a thin solid.

use super::{Teller, When, name};
use crate::collide::feature::pair;
use crate::collide::features::manifold_of_features;
use crate::collide::{MAX_POINTS, Manifold, ManifoldPoint};
use crate::convex::feature::{Corner, Feature};
use crate::convex::meet;
use crate::convex::support::{Core, Posed, Support, wide};
use crate::triangles::{Part, Triangle};
use sinew_math::{DVec3, Transform, Vec3};

/// `gap` is that along the triangle's normal, at most the margin.
pub(super) fn other(posed: &Posed<'_, Core>, gap: f32, teller: &mut Teller<'_>) -> Option<Part> {
    let thin = Thin(teller.triangle);
    let triangle = Posed::new(&thin, &Transform::IDENTITY, Vec3::ZERO);
    let between = meet(&triangle, posed);
    if between.distance > teller.margin {
        return None;
    }
    let tolerance = teller.solid.tolerance();
    // The way out leads through the triangle, or its own face is as good: that holds best, and says what the surface is like.
    let outward = between.normal.dot(teller.triangle.normal);
    if outward < 0.0 || between.distance <= gap + tolerance + 0.05 * gap.abs() {
        let over = teller.over_face(Vec3::ZERO);
        return teller.face_points(&over, When::Now).then_some(Part::Face);
    }
    let part = teller.triangle.support(between.normal, tolerance);
    let mut manifold = Manifold::default();
    manifold_of_features(&triangle, posed, &between, teller.margin, &mut manifold);
    let mut points = [ManifoldPoint::default(); MAX_POINTS];
    for (named, point) in points.iter_mut().zip(manifold.points()) {
        let of_surface = name::part(teller.triangle, part) ^ (point.feature as u16 & 0xf) << 10;
        *named = ManifoldPoint { feature: pair(of_surface, (point.feature >> 16) as u16), ..*point };
    }
    teller.tell(manifold.normal, part, When::Now, &points[..manifold.count]);
    Some(part)
}

/// A triangle as a solid without thickness.
struct Thin<'a>(&'a Triangle);

impl Support for Thin<'_> {
    fn support(&self, direction: DVec3) -> DVec3 {
        let [a, b, c] = self.0.corners.map(wide);
        let further = |p: DVec3, q: DVec3| if q.dot(direction) > p.dot(direction) { q } else { p };
        further(further(a, b), c)
    }

    fn rounding(&self) -> f32 {
        0.0
    }

    fn reach(&self) -> f32 {
        self.0.corners.iter().fold(0.0, |reach, corner| sinew_math::max(corner.length(), reach))
    }

    fn thinnest(&self) -> f32 {
        // Nothing is thin about what the surface keeps out.
        f32::INFINITY
    }

    fn feature(&self, direction: Vec3) -> Feature {
        let corner = |k: usize| Corner {
            point: self.0.corners[k],
            name: crate::collide::feature::vertex(k),
            side: crate::collide::feature::edge(0, k << 1),
        };
        let edge = |k: usize| Feature::new(&[corner(k), corner((k + 1) % 3)], 0, Vec3::ZERO);
        match self.0.support(direction, 1e-4 * self.reach()) {
            Part::Face => Feature::new(&[corner(0), corner(1), corner(2)], name::FACE, self.0.normal),
            Part::Edge(k) => edge(k),
            Part::Corner(k) => Feature::new(&[corner(k)], 0, Vec3::ZERO),
        }
    }
}
