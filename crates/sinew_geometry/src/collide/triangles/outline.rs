//! Side of a shape that faces a triangle, clipped to the prism over the triangle.

use super::name;
use crate::convex::feature::MOST_CORNERS;
use crate::triangles::Triangle;
use sinew_math::Vec3;

/// Largest number of corners of an outline: those of a shape's side, and one more for each side of the triangle.
pub(super) const MAX_CORNERS: usize = MOST_CORNERS + 3;

/// A corner of an outline.
#[derive(Clone, Copy, Default)]
pub(super) struct Corner {
    pub at: Vec3,
    /// Feature of the shape.
    pub of_shape: u16,
    /// Feature of the surface.
    pub of_surface: u16,
    /// Edge on which the line from this corner to the next lies.
    pub side: Side,
}

/// Origin of a line of an outline.
#[derive(Clone, Copy, Default, PartialEq)]
pub(super) enum Side {
    /// An edge of the shape, by its feature.
    Shape(u16),
    /// An edge of the triangle, by its index.
    Triangle(usize),
    #[default]
    None,
}

/// A point, a line, or a convex polygon of a shape that faces a triangle.
#[derive(Clone, Copy)]
pub(super) struct Outline {
    corners: [Corner; MAX_CORNERS],
    count: usize,
    /// Feature of the shape from which the outline was made, if it is a face.
    pub face: u16,
}

impl Default for Outline {
    fn default() -> Self {
        Self { corners: [Corner::default(); MAX_CORNERS], count: 0, face: 0 }
    }
}

impl Outline {
    pub fn corners(&self) -> &[Corner] {
        &self.corners[..self.count]
    }

    pub fn push(&mut self, corner: Corner) {
        // Rounding could produce one more corner on a sliver; that corner is dropped.
        if self.count < MAX_CORNERS {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }

    pub fn moved(mut self, by: Vec3) -> Self {
        for corner in &mut self.corners[..self.count] {
            corner.at += by;
        }
        self
    }

    /// Returns the part over and under the triangle (Sutherland & Hodgman 1974). The prism is widened by `tolerance`,
    /// so that rounding does not change the names of corners on its edges.
    pub fn cut(mut self, triangle: &Triangle, tolerance: f32) -> Self {
        for edge in 0..3 {
            let (from, to) = (triangle.corners[edge], triangle.corners[(edge + 1) % 3]);
            let outward = sinew_math::normalize_or((to - from).cross(triangle.normal), Vec3::ZERO);
            let beyond = |p: Vec3| (p - from).dot(outward) - tolerance;
            // Usually all corners are on one side of the edge; then the copy of the outline is avoided.
            let kept = self.corners().iter().filter(|corner| beyond(corner.at) <= 0.0).count();
            if kept == 0 {
                self.count = 0;
                break;
            }
            if kept < self.count {
                self = self.cut_by(triangle, edge, beyond);
            }
        }
        self
    }

    /// Removes the part of the outline beyond an edge of the triangle.
    fn cut_by(&self, triangle: &Triangle, edge: usize, beyond: impl Fn(Vec3) -> f32) -> Self {
        let mut out = Self { face: self.face, ..Self::default() };
        let lines = if self.count == 2 { 1 } else { self.count };
        for (k, from) in self.corners().iter().enumerate() {
            let d0 = beyond(from.at);
            if d0 <= 0.0 {
                out.push(*from);
            }
            if k >= lines {
                continue;
            }
            let to = &self.corners[(k + 1) % self.count];
            let d1 = beyond(to.at);
            if (d0 <= 0.0) != (d1 <= 0.0) {
                let at = from.at + (to.at - from.at) * (d0 / (d0 - d1));
                let (of_shape, of_surface) = match from.side {
                    Side::Shape(feature) => (feature, name::edge(triangle, edge)),
                    Side::Triangle(other) => (self.face, name::corner(triangle, other, edge)),
                    Side::None => (self.face, name::edge(triangle, edge)),
                };
                // Where the outline crosses outward, it continues along this edge of the triangle.
                let side = if d0 <= 0.0 { Side::Triangle(edge) } else { from.side };
                out.push(Corner { at, of_shape, of_surface, side });
            }
        }
        out
    }
}
