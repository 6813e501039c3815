//! Any convex shape against a triangle: direction and gap by GJK and EPA, with the triangle as a thin solid.

use super::{Recorder, When, name};
use crate::collide::feature::{WHOLE, pair};
use crate::collide::features::manifold_of_features;
use crate::collide::{MAX_POINTS, Manifold, ManifoldPoint};
use crate::convex::feature::{Corner, Feature};
use crate::convex::support::{Core, Posed, Support, wide};
use crate::convex::{advance, apart_along, closeness, meet};
use crate::triangles::{Part, Triangle};
use sinew_math::{DVec3, Transform, Vec3, max, min};

/// Records the contact of the shape and the triangle; returns the part of the triangle in contact. `gap` is the gap
/// along the triangle's normal, at most the margin.
pub(super) fn other(posed: &Posed<'_, Core<'_>>, gap: f32, recorder: &mut Recorder<'_>) -> Option<Part> {
    let thin = Thin(recorder.triangle);
    let triangle = Posed::new(&thin, &Transform::IDENTITY, Vec3::ZERO);
    let mut between = meet(&triangle, posed);
    if between.distance < 0.0 {
        // For a solid without thickness, EPA's depth is less accurate than the gap along its direction.
        between.distance = apart_along(&triangle, posed, wide(between.normal)) as f32;
    }
    if between.distance > recorder.margin {
        return None;
    }
    let tolerance = recorder.solid.tolerance();
    // The face is used if the direction of GJK or EPA leads through the triangle, or if the gap along the triangle's
    // own normal is about as large: the face is the most stable choice and represents the surface.
    let outward = between.normal.dot(recorder.triangle.normal);
    let backward = outward < 0.0 && between.distance <= 0.0;
    let as_good = gap + tolerance + 0.05 * max(-gap, 0.0);
    if backward || between.distance <= as_good {
        let over = recorder.over_face(Vec3::ZERO);
        let lowest = over.corners().iter().fold(f32::INFINITY, |y, c| min(recorder.triangle.height(c.at), y));
        let lowest_recorded = lowest - recorder.solid.radius();
        // Separated shapes may pass beside the face. For overlapping ones, a round side may be over the triangle even
        // if the line that represents it is not.
        let shows = lowest_recorded <= max(between.distance + tolerance, 0.0);
        if shows && recorder.face_points(&over, When::Now) {
            if between.distance <= 0.0 && lowest_recorded > as_good {
                deepest(&triangle, posed, gap, lowest_recorded, recorder);
            }
            return Some(Part::Face);
        }
        if between.distance <= 0.0 {
            recorder.lift(gap, (between.on_a + between.on_b) * 0.5);
            return None;
        }
    }
    let part = recorder.triangle.support(between.normal, tolerance);
    let mut manifold = Manifold::default();
    manifold_of_features(&triangle, posed, &between, recorder.margin, &mut manifold);
    let mut points = [ManifoldPoint::default(); MAX_POINTS];
    for (named, point) in points.iter_mut().zip(manifold.points()) {
        let of_surface = name::part(recorder.triangle, part) ^ (point.feature as u16 & 0xf) << 10;
        *named = ManifoldPoint { feature: pair(of_surface, (point.feature >> 16) as u16), ..*point };
    }
    let nearest = manifold.points().iter().fold(f32::INFINITY, |least, p| min(p.separation, least));
    if nearest > between.distance + tolerance {
        // Round sides extend further than the corners and lines that represent them.
        let feature = pair(name::part(recorder.triangle, part), WHOLE);
        let position = (between.on_a + between.on_b) * 0.5;
        if manifold.count == 0 {
            manifold.normal = between.normal;
        }
        manifold.count = usize::min(manifold.count, MAX_POINTS - 1) + 1;
        points[manifold.count - 1] = ManifoldPoint { position, separation: between.distance, feature };
    }
    recorder.record(manifold.normal, part, When::Now, &points[..manifold.count]);
    Some(part)
}

/// Records the deepest point of the shape under the triangle if its separation is below `lowest_recorded`. The point
/// may be missing on the facing side if that side extends down beside the triangle. It is found by moving the shape out
/// along the normal and casting it back: it is the first point that touches.
fn deepest(
    triangle: &Posed<'_, Thin<'_>>,
    posed: &Posed<'_, Core<'_>>,
    gap: f32,
    lowest_recorded: f32,
    recorder: &mut Recorder<'_>,
) {
    let (normal, tolerance) = (recorder.triangle.normal, recorder.solid.tolerance());
    let out = normal * (tolerance - gap);
    let hit = advance(-out, closeness(posed.solid.thinnest(), out), |way| {
        let moved = Posed { solid: posed.solid, axes: posed.axes, center: posed.center + wide(out + way) };
        Some(meet(&moved, triangle))
    });
    let Some(hit) = hit else { return };
    let separation = (hit.fraction - 1.0) * out.length();
    if separation < lowest_recorded - tolerance {
        let feature = pair(name::FACE, WHOLE);
        let position = hit.point + normal * (0.5 * separation);
        recorder.record(normal, Part::Face, When::Now, &[ManifoldPoint { position, separation, feature }]);
    }
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
        self.0.corners.iter().fold(0.0, |reach, corner| max(corner.length(), reach))
    }

    fn thinnest(&self) -> f32 {
        // A surface has no thickness.
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
