//! Box against a triangle: 13 separating axes (the triangle's normal, three face normals of the box, nine cross
//! products of edges), then the faces or edges in contact, or the closest points if the box is beside the triangle.

use super::{Recorder, When};
use crate::collide::ManifoldPoint;
use crate::collide::feature::{self, WHOLE, pair};
use crate::collide::placed::{PlacedBox, Segment, sign};
use crate::triangles::{Part, closest_on_triangle};
use sinew_math::{Vec3, max, min};

/// Sine below which edges count as parallel.
const PARALLEL_SINE: f32 = 0.005;
/// Least cosine between a separating axis and the triangle's normal, so that no axis pushes the box through the
/// triangle.
const LEAST_COSINE: f32 = -0.02;

/// Cosine between the contact normal and the normal of a box face above which the face counts as resting on the edge.
const LIES_COSINE: f32 = 0.9;

/// A direction from the triangle to the box and the gap along it.
#[derive(Clone, Copy)]
struct Axis {
    normal: Vec3,
    separation: f32,
    of: AxisOf,
}

#[derive(Clone, Copy)]
enum AxisOf {
    /// A face of the box, by its axis.
    Face(usize),
    /// An edge of the triangle and an axis of the box.
    Edges(usize, usize),
}

/// Records the contact of the box and the triangle; returns the part of the triangle in contact. `gap` is the gap along
/// the triangle's normal, at most the margin.
pub(super) fn meet(placed: &PlacedBox, gap: f32, recorder: &mut Recorder<'_>) -> Option<Part> {
    let Axes { widest, best } = axes(placed, recorder);
    if widest > recorder.margin {
        return None;
    }
    let tolerance = recorder.solid.tolerance();
    // The triangle's own face is the most stable and represents the surface, so another axis must be clearly better.
    let found = match best.filter(|best| best.separation > gap + tolerance + 0.05 * max(-gap, 0.0)) {
        None => face(gap, widest, recorder),
        // The shapes are apart only along a direction that leads through the triangle: the box is beside its rim.
        Some(axis) if axis.separation <= 0.0 && widest > 0.0 => None,
        Some(axis) => match axis.of {
            AxisOf::Face(k) => box_face(placed, k, &axis, recorder),
            AxisOf::Edges(i, j) => edges(placed, i, j, &axis, recorder),
        },
    };
    if found.is_some() {
        return found;
    }
    if max(widest, gap) > 0.0 {
        return closest(placed, recorder);
    }
    if best.is_none_or(|best| best.separation <= gap) {
        let middle = recorder.triangle.corners.iter().sum::<Vec3>() / 3.0;
        recorder.lift(gap, closest_on_triangle(&recorder.triangle.corners, placed.closest(middle)).0);
    }
    None
}

/// Records the part of the box over the triangle. Returns `None` and records nothing if the box is beside the triangle,
/// so that the points would not give their distance.
fn face(gap: f32, widest: f32, recorder: &mut Recorder<'_>) -> Option<Part> {
    let over = recorder.over_face(Vec3::ZERO);
    let nearest = over.corners().iter().fold(f32::INFINITY, |y, c| min(recorder.triangle.height(c.at), y));
    let beside = max(gap, widest) > 0.0 && nearest > gap + recorder.solid.tolerance();
    (!beside && recorder.face_points(&over, When::Now)).then_some(Part::Face)
}

/// Results of the separating axes other than the triangle's own.
struct Axes {
    /// The largest gap along any of these axes, metres.
    widest: f32,
    /// The axis with the largest gap among those that do not push the box through the triangle.
    best: Option<Axis>,
}

fn axes(placed: &PlacedBox, recorder: &Recorder<'_>) -> Axes {
    let triangle = recorder.triangle;
    let mut axes = Axes { widest: f32::NEG_INFINITY, best: None };
    let mut consider = |direction: Vec3, half: f32, of: AxisOf| {
        let [a, b, c] = triangle.corners.map(|corner| corner.dot(direction));
        let (low, high) = (min(min(a, b), c), max(max(a, b), c));
        for (normal, separation) in [(direction, -half - high), (-direction, low - half)] {
            axes.widest = max(separation, axes.widest);
            let leads_out = normal.dot(triangle.normal) >= LEAST_COSINE;
            if leads_out && axes.best.is_none_or(|best| separation > best.separation) {
                axes.best = Some(Axis { normal, separation, of });
            }
        }
    };
    for k in 0..3 {
        consider(placed.axes[k], placed.half[k], AxisOf::Face(k));
    }
    for i in 0..3 {
        let along = triangle.corners[(i + 1) % 3] - triangle.corners[i];
        let length = along.length();
        for j in 0..3 {
            let across = along.cross(placed.axes[j]);
            let sine = across.length();
            if sine > PARALLEL_SINE * length {
                let direction = across / sine;
                consider(direction, placed.half_width(direction), AxisOf::Edges(i, j));
            }
        }
    }
    axes
}

/// Records the triangle clipped to the prism over a face of the box.
fn box_face(placed: &PlacedBox, k: usize, axis: &Axis, recorder: &mut Recorder<'_>) -> Option<Part> {
    let outward = -axis.normal;
    let side = sign(placed.axes[k].dot(outward));
    let tolerance = recorder.solid.tolerance();
    let part = recorder.triangle.support(axis.normal, tolerance);
    let mut corners = [Vec3::ZERO; 8];
    let mut count = 3;
    corners[..3].copy_from_slice(&recorder.triangle.corners);
    for u in [(k + 1) % 3, (k + 2) % 3] {
        for direction in [placed.axes[u], -placed.axes[u]] {
            count = cut(&mut corners, count, |p| p.dot(direction) - placed.half[u] - tolerance);
        }
    }
    let mut points = [ManifoldPoint::default(); 8];
    let (mut count_near, mut nearest) = (0, f32::INFINITY);
    for (index, &corner) in corners[..count].iter().enumerate() {
        let separation = corner.dot(outward) - placed.half[k];
        nearest = min(separation, nearest);
        if separation <= recorder.margin {
            let of_surface = super::name::part(recorder.triangle, part) ^ ((index as u16) << 10);
            points[count_near] = ManifoldPoint {
                position: corner + axis.normal * (0.5 * separation),
                separation,
                feature: pair(of_surface, feature::face(k, side)),
            };
            count_near += 1;
        }
    }
    if count_near == 0 || (axis.separation > 0.0 && nearest > axis.separation + tolerance) {
        return None;
    }
    recorder.record(axis.normal, part, When::Now, &points[..count_near]);
    Some(part)
}

/// Clips a convex polygon to the region where `beyond` is not positive; returns the number of remaining corners.
fn cut(corners: &mut [Vec3; 8], count: usize, beyond: impl Fn(Vec3) -> f32) -> usize {
    let was = *corners;
    let mut left = 0;
    let mut push = |p: Vec3| {
        if left < corners.len() {
            corners[left] = p;
            left += 1;
        }
    };
    for k in 0..count {
        let (from, to) = (was[k], was[(k + 1) % count]);
        let (d0, d1) = (beyond(from), beyond(to));
        if d0 <= 0.0 {
            push(from);
        }
        if (d0 <= 0.0) != (d1 <= 0.0) {
            push(from + (to - from) * (d0 / (d0 - d1)));
        }
    }
    left
}

/// Records the closest points of an edge of the triangle and an edge of the box.
fn edges(placed: &PlacedBox, i: usize, j: usize, axis: &Axis, recorder: &mut Recorder<'_>) -> Option<Part> {
    let corners = recorder.triangle.corners;
    let edge = Segment { ends: [corners[i], corners[(i + 1) % 3]] };
    let index = placed.support(-axis.normal) & !(1 << j);
    let of_box = Segment { ends: [placed.vertex(index), placed.vertex(index | 1 << j)] };
    let (s, t) = of_box.closest_to_segment(&edge);
    let inside = |x: f32| x > 0.0 && x < 1.0;
    // Another part of the triangle may extend further along the axis than this edge. Then the edges' closest points do
    // not have this distance.
    let across = (of_box.at(s) - edge.at(t)).dot(axis.normal) - axis.separation;
    let bound = across.abs() <= recorder.solid.tolerance();
    if axis.separation > 0.0 && !(inside(s) && inside(t) && bound) {
        return None;
    }
    // If the edges are further apart than the gap along the axis, the shapes touch at other features.
    let apart = (of_box.at(s) - edge.at(t)).length();
    let tolerance = recorder.solid.tolerance();
    if axis.separation > -tolerance && apart > axis.separation.abs() + tolerance {
        return None;
    }
    let part = Part::on_edge(i, t);
    let under = under_face(placed, &edge, axis.normal, super::name::part(recorder.triangle, part));
    let under = under.as_ref().map_or(&[][..], |points| within(points, recorder.margin));
    let near = |point: &ManifoldPoint| point.separation <= axis.separation + recorder.solid.tolerance();
    if under.iter().any(near) {
        recorder.record(axis.normal, part, When::Now, under);
    } else {
        let position = (of_box.at(s) + edge.at(t)) * 0.5;
        recorder.point(axis.normal, part, position, axis.separation, feature::edge(j, index));
    }
    Some(part)
}

/// Returns those of two points that are within the margin.
fn within(points: &[ManifoldPoint; 2], margin: f32) -> &[ManifoldPoint] {
    match points.each_ref().map(|point| point.separation <= margin) {
        [true, true] => points,
        [true, false] => &points[..1],
        [false, true] => &points[1..],
        [false, false] => &[],
    }
}

/// Returns both ends of the part of a triangle's edge under a box face, if the face rests on the edge. With only one
/// point, where the edges cross, the box would never stop rocking from side to side.
fn under_face(
    placed: &PlacedBox,
    edge: &Segment,
    normal: Vec3,
    of_surface: u16,
) -> Option<[ManifoldPoint; 2]> {
    let (k, side) = placed.facing(-normal);
    let outward = placed.axes[k] * side;
    let slope = -outward.dot(normal);
    if slope < LIES_COSINE {
        return None;
    }
    let base = usize::from(side > 0.0) << k;
    // Parameters of the ends along the edge, and the box's feature above each.
    let mut ends = [(0.0, feature::face(k, side)), (1.0, feature::face(k, side))];
    for u in [(k + 1) % 3, (k + 2) % 3] {
        let along = 3 - k - u;
        let [from, to] = edge.ends.map(|end| end.dot(placed.axes[u]));
        for (low, limit) in [(true, -placed.half[u]), (false, placed.half[u])] {
            // `comes` is true if the edge enters the face's prism through this side, false if it leaves there.
            let (comes, steps) = ((from < to) == low, to - from);
            if steps.abs() <= f32::MIN_POSITIVE {
                // Parallel to the side: the whole edge is beyond the side, or no part of it.
                if from.abs() > placed.half[u] {
                    return None;
                }
                continue;
            }
            let share = (limit - from) / steps;
            let end = &mut ends[usize::from(!comes)];
            if (share > end.0) == comes {
                *end = (share, feature::edge(along, base | usize::from(!low) << u));
            }
        }
    }
    if ends[0].0 >= ends[1].0 {
        return None;
    }
    Some(ends.map(|(share, of_box)| {
        let at = edge.at(share);
        let separation = (at.dot(outward) - placed.half[k]) / slope;
        let position = at + normal * (0.5 * separation);
        ManifoldPoint { position, separation, feature: pair(of_surface, of_box) }
    }))
}

/// Records the closest points of a separated box and triangle, by testing all corners and edges.
fn closest(placed: &PlacedBox, recorder: &mut Recorder<'_>) -> Option<Part> {
    let corners = recorder.triangle.corners;
    let mut best = (f32::INFINITY, Vec3::ZERO, Vec3::ZERO, Part::Face, WHOLE);
    let mut consider = |on_box: Vec3, on_triangle: Vec3, part: Part, feature: u16| {
        let square = (on_box - on_triangle).length_squared();
        if square < best.0 {
            best = (square, on_box, on_triangle, part, feature);
        }
    };
    for index in 0..8 {
        let on_box = placed.vertex(index);
        let (point, part) = closest_on_triangle(&corners, on_box);
        consider(on_box, point, part, feature::vertex(index));
    }
    for (k, &corner) in corners.iter().enumerate() {
        consider(placed.closest(corner), corner, Part::Corner(k), WHOLE);
        let edge = Segment { ends: [corner, corners[(k + 1) % 3]] };
        for axis in 0..3 {
            for index in (0..8).filter(|index| index >> axis & 1 == 0) {
                let of_box = Segment { ends: [placed.vertex(index), placed.vertex(index | 1 << axis)] };
                let (s, t) = of_box.closest_to_segment(&edge);
                consider(of_box.at(s), edge.at(t), Part::on_edge(k, t), feature::edge(axis, index));
            }
        }
    }
    let (square, on_box, on_triangle, part, feature) = best;
    let separation = square.sqrt();
    // The direction between nearly coincident points is noise.
    if separation > recorder.margin || separation <= 1e-5 * placed.half.length() {
        return None;
    }
    let normal = (on_box - on_triangle) / separation;
    recorder.point(normal, part, (on_box + on_triangle) * 0.5, separation, feature);
    Some(part)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_math::Transform;

    #[test]
    fn edge_under_a_box_face_is_clipped_to_the_face() {
        let placed = PlacedBox::new(Vec3::new(2.0, 0.5, 1.0), &Transform::IDENTITY);
        let under = |from: Vec3, to: Vec3| {
            let points = under_face(&placed, &Segment { ends: [from, to] }, Vec3::Y, 0)?;
            Some(points.map(|point| point.position))
        };
        let at = |x: f32, z: f32| Vec3::new(x, -0.5, z);
        assert_eq!(under(at(-3.0, 0.9), at(1.0, 0.9)), Some([at(-2.0, 0.9), at(1.0, 0.9)]));
        assert_eq!(under(at(-3.0, -1.5), at(1.0, 2.5)), Some([at(-2.0, -0.5), at(-0.5, 1.0)]));
        for beside in [1.1, -1.1] {
            assert_eq!(under(at(-3.0, beside), at(1.0, beside)), None);
            assert_eq!(under(at(-3.0, beside), at(1.0, beside * 1.001)), None);
        }
    }

    #[test]
    fn points_beyond_the_margin_are_dropped() {
        let [near, far] = [0.01, 0.5].map(|separation| ManifoldPoint { separation, ..Default::default() });
        assert_eq!(within(&[near, near], 0.1), &[near, near]);
        assert_eq!(within(&[near, far], 0.1), &[near]);
        assert_eq!(within(&[far, near], 0.1), &[near]);
        assert_eq!(within(&[far, far], 0.1), &[]);
    }
}
