//! Sweeps a ball along a line against a shape.

use crate::body::shape::Shape;
use crate::boxes::Aabb;
use crate::triangles::{Part, Triangle, closest_on_triangle};
use sinew_math::{Vec3, max, max3, min3};

/// Contact of a swept ball with a shape, in the shape's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    /// Share of the path before contact, 0..=1.
    pub fraction: f32,
    /// Centre of the ball at contact.
    pub at: Vec3,
    /// Normal of the surface, unit length, outward.
    pub normal: Vec3,
    /// Remaining gap, metres; negative if the sweep starts inside.
    pub gap: f32,
}

impl Meeting {
    /// Signed distance of a point from the plane of the ball's centre at contact, plus the remaining gap, metres.
    pub fn height(&self, point: Vec3) -> f32 {
        self.gap + (point - self.at).dot(self.normal)
    }
}

/// Largest number of iterations. Each at least doubles the correct digits, except for grazing paths.
const ROUNDS: u32 = 32;

/// First contact of a ball that moves from `from` to `to` (the shape's frame) with the shape, while it approaches;
/// `None` if there is none. For a mesh or height field, the first triangle hit from outside.
pub(super) fn sweep_ball(shape: &Shape, radius: f32, from: Vec3, to: Vec3) -> Option<Meeting> {
    let Some(surface) = shape.surface() else {
        return approach(|at| shape.local_distance(at), radius, from, to);
    };
    let mut first: Option<Meeting> = None;
    let region = Aabb { min: min3(from, to), max: max3(from, to) }.expand(radius + SUNK);
    surface.overlapping(&region, |triangle| {
        if triangle.height(from) < -SUNK {
            return;
        }
        let meeting = approach(|at| over_triangle(&triangle, at), radius, from, to);
        if let Some(meeting) = meeting
            && is_felt(&triangle, meeting.at)
            && first.is_none_or(|best| meeting.fraction < best.fraction)
        {
            first = Some(meeting);
        }
    });
    first
}

/// True if the nearest feature can be hit: contacts at an internal edge are left to its two faces.
fn is_felt(triangle: &Triangle, at: Vec3) -> bool {
    match closest_on_triangle(&triangle.corners, at).1 {
        Part::Face => true,
        Part::Edge(edge) => triangle.is_active(edge),
        Part::Corner(corner) => triangle.is_active(corner) || triangle.is_active((corner + 2) % 3),
    }
}

/// Depth behind a triangle up to which a particle rests on it, metres.
const SUNK: f32 = 1e-4;

/// Returns the signed distance from a triangle, negative behind it, and the direction away from the triangle.
fn over_triangle(triangle: &Triangle, at: Vec3) -> (f32, Vec3) {
    let (point, part) = closest_on_triangle(&triangle.corners, at);
    let distance = (at - point).length();
    match part {
        Part::Face => (triangle.height(at), triangle.normal),
        _ if distance <= SUNK => (distance, triangle.normal),
        _ => (distance, (at - point) / distance),
    }
}

/// Computes [`sweep_ball`] from a convex solid's signed distance and outward normal. The whole solid is behind the
/// plane at the closest point, so the ball can advance at least to that plane (Newton's method on the distance, from
/// the side on which it never overshoots).
fn approach(distance: impl Fn(Vec3) -> (f32, Vec3), radius: f32, from: Vec3, to: Vec3) -> Option<Meeting> {
    let length = (to - from).length();
    if length < 1e-12 {
        return None;
    }
    let along = (to - from) / length;
    let touching = 1e-5 + 1e-6 * max(from.length(), to.length());
    let mut travelled = 0.0;
    let mut meeting = None;
    for _ in 0..ROUNDS {
        let at = from + along * travelled;
        let (away, normal) = distance(at);
        let (gap, closing) = (away - radius, -along.dot(normal));
        if closing <= 0.0 {
            return None;
        }
        meeting = Some(Meeting { fraction: travelled / length, at, normal, gap });
        if gap <= touching {
            break;
        }
        travelled += gap / closing;
        if travelled > length {
            return None;
        }
    }
    meeting
}
