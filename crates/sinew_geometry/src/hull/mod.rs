//! Convex hulls: solids with flat faces, built from points.
//!
//! Hulls are immutable; shapes share them by [`Arc`](std::sync::Arc). All positions are in the hull's own frame,
//! metres.

mod build;
mod bytes;
mod grid;
mod mass;
mod merge;
mod polytope;
mod query;
mod quick;
mod solids;
mod topology;

use crate::boxes::Aabb;
use core::fmt;
pub(crate) use polytope::{Polytope, Room};
use sinew_math::{Sym3, Vec3, max};
pub(crate) use solids::BoxPolytope;
#[cfg(test)]
pub(crate) use solids::TrianglePolytope;
use topology::Outline;
pub(crate) use topology::{Plane, Topology};

/// Largest number of faces of a hull.
pub const MAX_FACES: usize = 128;
/// Largest number of corners of a hull: with three faces at each corner, [`MAX_FACES`] faces have this many corners.
pub const MAX_VERTICES: usize = 2 * MAX_FACES - 4;

/// Reason why points have no hull.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HullError {
    /// A coordinate is NaN or infinite.
    NotFinite,
    /// Fewer than four different points.
    TooFewPoints,
    /// All points lie on a line.
    Collinear,
    /// All points lie in a plane.
    Coplanar,
    /// The hull is thinner than 1/10,000 of its longest side.
    TooThin,
    /// The longest side is below 1 µm or above 1,000 km.
    Size,
}

impl fmt::Display for HullError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "a coordinate is not finite",
            Self::TooFewPoints => "a hull needs four different points",
            Self::Collinear => "all points lie on a line",
            Self::Coplanar => "all points lie in a plane",
            Self::TooThin => "the hull is thinner than 1/10,000 of its longest side",
            Self::Size => "the longest side must be between 1e-6 and 1e6 metres",
        })
    }
}

impl core::error::Error for HullError {}

/// A convex solid with at most [`MAX_FACES`] flat faces.
#[derive(Clone, Debug)]
pub struct Hull {
    vertices: Vec<Vec3>,
    planes: Vec<Plane>,
    outline: Outline,
    areas: Vec<f32>,
    bounds: Aabb,
    volume: f32,
    /// Centre of mass at uniform density, metres.
    center: Vec3,
    /// Inertia about the centre at density 1, kg·m².
    inertia: Sym3,
    inner_radius: f32,
    bounding_radius: f32,
    content_hash: u64,
}

/// A face of a [`Hull`].
#[derive(Clone, Copy, Debug)]
pub struct HullFace<'a> {
    hull: &'a Hull,
    index: usize,
}

impl Hull {
    /// Builds the smallest convex solid that contains all points (metres), by quickhull with exact decisions.
    ///
    /// Points are snapped to a grid of at most 2⁻²² of the longest side of their bounds, on which all decisions are
    /// exact. Triangles that are in one plane, within 2e-6 of that side, become one polygon. No point is further
    /// outside the hull than 1e-5 of that side. Order and duplicates of the points do not matter.
    ///
    /// A hull that would have more than [`MAX_FACES`] faces is **simplified**. Quickhull adds the furthest outside
    /// point first, and stops at 252, 128 or 66 corners: at the largest of these numbers that gives few enough faces.
    /// Points of the cloud may then be outside the hull; [`distance`](Self::distance) returns how far (about 5 % of the
    /// radius for a ball of 10,000 points).
    ///
    /// # Errors
    /// [`HullError`], if the points span no solid, a coordinate is not finite, or the longest side is out of range.
    pub fn new(points: &[Vec3]) -> Result<Self, HullError> {
        build::build(points)
    }

    /// Returns the corners, sorted by x, then y, then z.
    #[inline]
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// Iterates over the faces, 4..=[`MAX_FACES`].
    pub fn faces(&self) -> impl ExactSizeIterator<Item = HullFace<'_>> {
        (0..self.planes.len()).map(|index| HullFace { hull: self, index })
    }

    /// Iterates over the edges as pairs of corner indices, each once.
    pub fn edges(&self) -> impl Iterator<Item = [usize; 2]> {
        let topology = self.topology();
        topology.edge_numbers().map(move |edge| topology.ends(edge))
    }

    /// Volume, m³.
    #[inline]
    pub fn volume(&self) -> f32 {
        self.volume
    }

    /// Centre of the volume, metres.
    #[inline]
    pub fn center(&self) -> Vec3 {
        self.center
    }

    /// Inertia about the centre at a density of 1 kg/m³, kg·m².
    pub fn inertia(&self) -> Sym3 {
        self.inertia
    }

    /// Bounds in the hull's own frame, metres.
    #[inline]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Radius of the largest ball around the centre that fits inside, metres.
    #[inline]
    pub fn inner_radius(&self) -> f32 {
        self.inner_radius
    }

    /// Radius of the smallest ball around the origin that contains the hull, metres.
    #[inline]
    pub fn bounding_radius(&self) -> f32 {
        self.bounding_radius
    }

    /// Index of the corner furthest along a direction; the first among equals.
    pub fn support(&self, direction: Vec3) -> usize {
        support(&self.vertices, direction)
    }

    /// Hash of the corners and faces, the same on every machine.
    pub fn content_hash(&self) -> u64 {
        self.content_hash
    }

    pub(crate) fn topology(&self) -> Topology<'_> {
        self.outline.topology()
    }
}

/// Compares corners and faces; all other data is derived from them.
impl PartialEq for Hull {
    fn eq(&self, other: &Self) -> bool {
        self.content_hash == other.content_hash
            && self.vertices == other.vertices
            && self.outline == other.outline
    }
}

impl<'a> HullFace<'a> {
    /// Outward unit normal.
    #[inline]
    pub fn normal(&self) -> Vec3 {
        self.hull.planes[self.index].normal
    }

    /// Distance of the face's plane from the origin along the normal, metres.
    #[inline]
    pub fn offset(&self) -> f32 {
        self.hull.planes[self.index].offset
    }

    /// Area, m².
    #[inline]
    pub fn area(&self) -> f32 {
        self.hull.areas[self.index]
    }

    /// Iterates over the indices of the face's corners, counter-clockwise from outside.
    pub fn corners(&self) -> impl ExactSizeIterator<Item = usize> + Clone + use<'a> {
        self.hull.outline.topology().corners(self.index)
    }
}

/// Index of the point furthest along a direction; the first among equals.
pub(crate) fn support(vertices: &[Vec3], direction: Vec3) -> usize {
    let (mut best, mut reach) = (0, f32::NEG_INFINITY);
    for (index, vertex) in vertices.iter().enumerate() {
        let along = vertex.dot(direction);
        if along > reach {
            (best, reach) = (index, along);
        }
    }
    best
}

/// Largest coordinate of points along a direction.
pub(crate) fn reach(vertices: &[Vec3], direction: Vec3) -> f32 {
    vertices.iter().fold(f32::NEG_INFINITY, |reach, v| max(v.dot(direction), reach))
}
