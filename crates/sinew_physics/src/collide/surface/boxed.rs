//! Box against a triangle: separating axes (one of the triangle, three of the box, nine of edges), then the faces or edges that
//! meet; the closest points where they pass each other.

use super::{Teller, When};
use crate::collide::ManifoldPoint;
use crate::collide::feature::{self, WHOLE, pair};
use crate::collide::placed::{PlacedBox, Segment, sign};
use crate::triangles::{Part, closest_on_triangle};
use sinew_math::{Vec3, max, min};

/// Edges whose sine is below this are taken as parallel.
const PARALLEL_SINE: f32 = 0.005;
/// Of ways out those are not taken that lead through the triangle: below this cosine to its normal.
const LEAST_COSINE: f32 = -0.02;

/// A direction from the triangle to the box and the gap along it.
#[derive(Clone, Copy)]
struct Axis {
    normal: Vec3,
    separation: f32,
    of: AxisOf,
}

#[derive(Clone, Copy)]
enum AxisOf {
    /// Of the box, by its axis.
    Face(usize),
    /// An edge of the triangle and an axis of the box.
    Edges(usize, usize),
}

/// `gap` is that along the triangle's normal, at most the margin.
pub(super) fn meet(placed: &PlacedBox, gap: f32, teller: &mut Teller<'_>) -> Option<Part> {
    let axis = match best_axis(placed, teller) {
        Best::Apart => return None,
        Best::Axis(axis) => Some(axis),
        Best::None => None,
    };
    let tolerance = teller.solid.tolerance();
    // The triangle's own face holds best, and says what the surface is like: another axis must be clearly better.
    let other = axis.filter(|axis| axis.separation > gap + tolerance + 0.05 * gap.abs());
    let Some(axis) = other else {
        let over = teller.over_face(Vec3::ZERO);
        let nearest = over.corners().iter().fold(f32::INFINITY, |y, c| min(teller.triangle.height(c.at), y));
        // Apart, the two may still pass each other beside the face.
        if gap <= 0.0 || nearest <= gap + tolerance {
            return teller.face_points(&over, When::Now).then_some(Part::Face);
        }
        return closest(placed, teller);
    };
    let told = match axis.of {
        AxisOf::Face(k) => box_face(placed, k, &axis, teller),
        AxisOf::Edges(i, j) => edges(placed, i, j, &axis, teller),
    };
    told.or_else(|| if axis.separation > 0.0 { closest(placed, teller) } else { None })
}

enum Best {
    /// Farther apart than the margin.
    Apart,
    Axis(Axis),
    None,
}

/// The axis, beside the triangle's own, along which box and triangle are farthest apart.
fn best_axis(placed: &PlacedBox, teller: &Teller<'_>) -> Best {
    let triangle = teller.triangle;
    let mut best: Option<Axis> = None;
    let mut apart = false;
    let mut consider = |direction: Vec3, half: f32, of: AxisOf| {
        let [a, b, c] = triangle.corners.map(|corner| corner.dot(direction));
        let (low, high) = (min(min(a, b), c), max(max(a, b), c));
        for (normal, separation) in [(direction, -half - high), (-direction, low - half)] {
            apart |= separation > teller.margin;
            let leads_out = normal.dot(triangle.normal) >= LEAST_COSINE;
            if leads_out && best.is_none_or(|best| separation > best.separation) {
                best = Some(Axis { normal, separation, of });
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
                // Only what both edges bound is a way out over them.
                consider(direction, placed.half_width(direction), AxisOf::Edges(i, j));
            }
        }
    }
    match best {
        _ if apart => Best::Apart,
        Some(axis) => Best::Axis(axis),
        None => Best::None,
    }
}

/// The triangle cut to the prism over a face of the box.
fn box_face(placed: &PlacedBox, k: usize, axis: &Axis, teller: &mut Teller<'_>) -> Option<Part> {
    let outward = -axis.normal;
    let side = sign(placed.axes[k].dot(outward));
    let tolerance = teller.solid.tolerance();
    let part = teller.triangle.support(axis.normal, tolerance);
    let mut corners = [Vec3::ZERO; 8];
    let mut count = 3;
    corners[..3].copy_from_slice(&teller.triangle.corners);
    for u in [(k + 1) % 3, (k + 2) % 3] {
        for direction in [placed.axes[u], -placed.axes[u]] {
            count = cut(&mut corners, count, |p| p.dot(direction) - placed.half[u] - tolerance);
        }
    }
    let mut points = [ManifoldPoint::default(); 8];
    let (mut told, mut nearest) = (0, f32::INFINITY);
    for (index, &corner) in corners[..count].iter().enumerate() {
        let separation = corner.dot(outward) - placed.half[k];
        nearest = min(separation, nearest);
        if separation <= teller.margin {
            let of_surface = super::name::part(teller.triangle, part) ^ ((index as u16) << 10);
            points[told] = ManifoldPoint {
                position: corner + axis.normal * (0.5 * separation),
                separation,
                feature: pair(of_surface, feature::face(k, side)),
            };
            told += 1;
        }
    }
    if told == 0 || (axis.separation > 0.0 && nearest > axis.separation + tolerance) {
        return None;
    }
    teller.tell(axis.normal, part, When::Now, &points[..told]);
    Some(part)
}

/// Cuts a convex polygon down to where `beyond` is not positive; gives how many corners are left.
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

/// The closest points of an edge of each.
fn edges(placed: &PlacedBox, i: usize, j: usize, axis: &Axis, teller: &mut Teller<'_>) -> Option<Part> {
    let corners = teller.triangle.corners;
    let edge = Segment { ends: [corners[i], corners[(i + 1) % 3]] };
    let index = placed.support(-axis.normal) & !(1 << j);
    let of_box = Segment { ends: [placed.vertex(index), placed.vertex(index | 1 << j)] };
    let (s, t) = of_box.closest_to_segment(&edge);
    let inside = |x: f32| x > 0.0 && x < 1.0;
    if axis.separation > 0.0 && !(inside(s) && inside(t)) {
        return None;
    }
    let part = match t {
        t if t <= 0.0 => Part::Corner(i),
        t if t >= 1.0 => Part::Corner((i + 1) % 3),
        _ => Part::Edge(i),
    };
    let position = (of_box.at(s) + edge.at(t)) * 0.5;
    teller.point(axis.normal, part, position, axis.separation, feature::edge(j, index));
    Some(part)
}

/// The closest points of a box and a triangle that are apart, by trying corners and edges.
fn closest(placed: &PlacedBox, teller: &mut Teller<'_>) -> Option<Part> {
    let corners = teller.triangle.corners;
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
                consider(of_box.at(s), edge.at(t), Part::Edge(k), feature::edge(axis, index));
            }
        }
    }
    let (square, on_box, on_triangle, part, feature) = best;
    let separation = square.sqrt();
    // The direction between points that all but coincide is noise.
    if separation > teller.margin || separation <= 1e-5 * placed.half.length() {
        return None;
    }
    let normal = (on_box - on_triangle) / separation;
    teller.point(normal, part, (on_box + on_triangle) * 0.5, separation, feature);
    Some(part)
}
