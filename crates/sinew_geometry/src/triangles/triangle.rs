//! One triangle of a surface: its closest point, and the entry of a line.

use crate::boxes::Aabb;
use sinew_math::triangle::{Nearest, nearest};
use sinew_math::{Vec3, max, max3, min3, normalize_or};

/// A one-sided triangle: solid on the side from which its corners are counter-clockwise.
#[derive(Clone, Copy, Debug, Default)]
pub struct Triangle {
    /// Corners, counter-clockwise seen from outside, metres.
    pub corners: [Vec3; 3],
    /// Unit normal toward the outside.
    pub normal: Vec3,
    /// Names of the corners, shared by adjacent triangles.
    pub vertices: [u32; 3],
    /// Active edges: bit k for the edge from corner k to the next, if the surface ends or bends down there.
    pub active: u8,
}

/// Feature of a triangle: its face, an edge or a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Interior of the triangle.
    Face,
    /// Edge from the corner with this index, 0..3, to the next one.
    Edge(usize),
    /// Corner with this index, 0..3.
    Corner(usize),
}

impl Part {
    /// Returns the feature at a parameter of an edge, 0..=1 from its first corner to its second; the ends are corners.
    pub fn on_edge(edge: usize, share: f32) -> Self {
        match share {
            t if t <= 0.0 => Self::Corner(edge),
            t if t >= 1.0 => Self::Corner((edge + 1) % 3),
            _ => Self::Edge(edge),
        }
    }
}

impl Triangle {
    /// Creates a triangle and computes its normal.
    #[inline]
    pub fn new(corners: [Vec3; 3], vertices: [u32; 3], active: u8) -> Self {
        Self { corners, normal: normal(&corners), vertices, active }
    }

    /// Height of a point over the triangle's plane, metres.
    #[inline]
    pub fn height(&self, p: Vec3) -> f32 {
        (p - self.corners[0]).dot(self.normal)
    }

    /// True if the edge with this index, 0..3, can cause contacts.
    #[inline]
    pub fn is_active(&self, edge: usize) -> bool {
        self.active >> edge & 1 == 1
    }

    /// Returns the vertices of an edge, the smaller one first.
    pub fn edge_vertices(&self, edge: usize) -> (u32, u32) {
        super::ordered(self.vertices[edge], self.vertices[(edge + 1) % 3])
    }

    /// Returns the feature that extends furthest along a direction, within `tolerance`, metres.
    pub fn support(&self, direction: Vec3, tolerance: f32) -> Part {
        let along = self.corners.map(|corner| corner.dot(direction));
        let top = max(max(along[0], along[1]), along[2]);
        match along.map(|x| x >= top - tolerance) {
            [true, true, true] => Part::Face,
            [true, true, false] => Part::Edge(0),
            [false, true, true] => Part::Edge(1),
            [true, false, true] => Part::Edge(2),
            [true, ..] => Part::Corner(0),
            [_, true, _] => Part::Corner(1),
            _ => Part::Corner(2),
        }
    }

    /// Returns the triangle moved by `offset`, metres.
    #[inline]
    pub fn moved(&self, offset: Vec3) -> Self {
        Self { corners: self.corners.map(|corner| corner + offset), ..*self }
    }
}

/// Unit normal of a triangle, toward the side from which the corners are counter-clockwise; +y if the corners are
/// collinear.
pub fn normal(&[a, b, c]: &[Vec3; 3]) -> Vec3 {
    normalize_or((b - a).cross(c - a), Vec3::Y)
}

pub(crate) fn bounds(&[a, b, c]: &[Vec3; 3]) -> Aabb {
    Aabb { min: min3(min3(a, b), c), max: max3(max3(a, b), c) }
}

/// Returns the point of a triangle closest to `p`, and its feature.
pub fn closest_on_triangle(corners: &[Vec3; 3], p: Vec3) -> (Vec3, Part) {
    let [a, b, c] = *corners;
    match nearest(corners, p) {
        Nearest::Corner(corner) => (corners[corner], Part::Corner(corner)),
        Nearest::Edge(0, along) => (a + (b - a) * along, Part::Edge(0)),
        Nearest::Edge(1, along) => (b + (c - b) * along, Part::Edge(1)),
        Nearest::Edge(_, along) => (a + (c - a) * along, Part::Edge(2)),
        Nearest::Face(v, w) => (a + (b - a) * v + (c - a) * w, Part::Face),
    }
}

/// Returns the share of `direction` (≥ 0, may exceed 1) at which a line from `origin` enters a triangle from its
/// outside.
///
/// The line crosses the triangle if it passes all sides with the same orientation. For the neighbouring triangle, the
/// sign of the orientation at the common side is exactly opposite, so no line passes between two triangles.
pub(crate) fn enter_triangle(corners: &[Vec3; 3], origin: Vec3, direction: Vec3) -> Option<f32> {
    let [a, b, c] = corners.map(|corner| corner - origin);
    let beside = |p: Vec3, q: Vec3| direction.dot(p.cross(q));
    if beside(a, b) > 0.0 || beside(b, c) > 0.0 || beside(c, a) > 0.0 {
        return None;
    }
    let normal = (b - a).cross(c - a);
    let (toward, away) = (direction.dot(normal), a.dot(normal));
    (toward < 0.0 && away <= 0.0).then(|| away / toward)
}
