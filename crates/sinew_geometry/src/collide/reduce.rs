//! Reduces many points in one plane to a few that support the shape equally well.

use super::manifold::{MAX_POINTS, Manifold, ManifoldPoint};
use sinew_math::Vec3;

/// Appends at most four of `points` to `out`: the deepest, the one furthest from the deepest, and on each side of the
/// line between these two the one that spans the largest triangle. Separations within `tolerance` count as equal, and
/// the first among equals is chosen, so that rounding does not change the choice from step to step.
pub(super) fn push_best(points: &[ManifoldPoint], tolerance: f32, out: &mut Manifold) {
    if points.len() <= MAX_POINTS {
        for p in points {
            out.push(p.position, p.separation, p.feature);
        }
        return;
    }
    let deepest = best(points, tolerance, |p| -p.separation);
    let origin = points[deepest].position;
    // Lengths and areas are compared with one per cent of slack for the same reason.
    let furthest = best_relative(points, |p| (p.position - origin).length());
    let (line, normal) = (points[furthest].position - origin, out.normal);
    let area = |p: &ManifoldPoint| line.cross(p.position - origin).dot(normal);
    let left = best_relative(points, area);
    let right = best_relative(points, |p| -area(p));
    let mut chosen = [deepest, furthest, left, right];
    // Sorts the chosen points in the order of the polygon, each once.
    chosen.sort_unstable();
    let smallest_area = 1e-6 * line.dot(line);
    let mut previous = usize::MAX;
    for index in chosen {
        let spans = index == deepest || index == furthest || area(&points[index]).abs() > smallest_area;
        if index != previous && spans {
            let p = &points[index];
            out.push(p.position, p.separation, p.feature);
        }
        previous = index;
    }
}

fn best(points: &[ManifoldPoint], tolerance: f32, score: impl Fn(&ManifoldPoint) -> f32) -> usize {
    let mut top = score(&points[0]);
    for p in points {
        top = sinew_math::max(score(p), top);
    }
    points.iter().position(|p| score(p) >= top - tolerance).unwrap_or(0)
}

fn best_relative(points: &[ManifoldPoint], score: impl Fn(&ManifoldPoint) -> f32) -> usize {
    let mut top = 0.0;
    for p in points {
        top = sinew_math::max(score(p), top);
    }
    best(points, 0.01 * top, score)
}

/// Returns the midpoint of a gap, from the point on the surface to which `normal` points.
pub(super) fn midway(on_far_surface: Vec3, normal: Vec3, separation: f32) -> Vec3 {
    on_far_surface - normal * (0.5 * separation)
}
