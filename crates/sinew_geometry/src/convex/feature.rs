//! Supporting features: the faces, edges and corners at which convex solids touch, as polygons with names.

use crate::collide::feature::{self, WHOLE};
use crate::collide::placed::{largest_axis, sign};
use crate::hull::Hull;
use crate::revolved::TruncatedCone;
use core::f32::consts::FRAC_1_SQRT_2;
use sinew_math::{Vec3, normalize_or};

/// Largest number of corners of a feature; a face with more corners is represented by this many.
pub const MOST_CORNERS: usize = 32;

/// Least cosine between the normal of a hull's face and a direction that the face counts as facing: about 26°.
const FACES: f32 = 0.9;

/// A corner of a feature.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Corner {
    /// Position, metres.
    pub point: Vec3,
    /// Name of the corner.
    pub name: u16,
    /// Name of the side from this corner to the next.
    pub side: u16,
}

/// A convex polygon, counter-clockwise seen from outside, or an edge, or a corner. Names do not change for the same
/// part of the solid, so that contact points can be matched across steps.
#[derive(Clone, Copy, Debug)]
pub struct Feature {
    corners: [Corner; MOST_CORNERS],
    count: usize,
    /// Name of the polygon.
    pub name: u16,
    /// Outward unit normal; 0 for an edge or a corner.
    pub normal: Vec3,
}

impl Feature {
    /// Creates a corner without its own name.
    pub fn of_point(point: Vec3) -> Self {
        Self::new(&[Corner { point, name: WHOLE, side: WHOLE }], WHOLE, Vec3::ZERO)
    }

    /// Creates an edge without its own name.
    pub fn of_edge(ends: [Vec3; 2]) -> Self {
        let corner = |index: usize| Corner { point: ends[index], name: feature::end(index), side: WHOLE };
        Self::new(&[corner(0), corner(1)], WHOLE, Vec3::ZERO)
    }

    /// Creates a feature from its corners, at most [`MOST_CORNERS`]; `normal` is 0 for fewer than three.
    pub fn new(corners: &[Corner], name: u16, normal: Vec3) -> Self {
        let mut feature =
            Self { corners: [Corner::default(); MOST_CORNERS], count: corners.len(), name, normal };
        feature.corners[..corners.len()].copy_from_slice(corners);
        feature
    }

    /// Returns the corners in order: one for a corner, two for an edge, up to [`MOST_CORNERS`] for a face.
    #[inline]
    pub fn corners(&self) -> &[Corner] {
        &self.corners[..self.count]
    }

    /// True if the feature is a polygon, with a normal.
    #[inline]
    pub fn is_face(&self) -> bool {
        self.count > 2
    }

    /// Converts the feature to another frame.
    pub fn mapped(mut self, point: impl Fn(Vec3) -> Vec3, vector: impl Fn(Vec3) -> Vec3) -> Self {
        for corner in &mut self.corners[..self.count] {
            corner.point = point(corner.point);
        }
        self.normal = vector(self.normal);
        self
    }

    /// Returns the face of a box that faces along `direction`.
    pub fn of_box(half: Vec3, direction: Vec3) -> Self {
        let axis = largest_axis(direction);
        let side = sign(direction[axis]);
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        // Counter-clockwise about the axis; reversed for the negative side.
        let mut turns = [(false, false), (true, false), (true, true), (false, true)];
        if side < 0.0 {
            turns.reverse();
        }
        let index = |(on_u, on_v): (bool, bool)| {
            usize::from(side > 0.0) << axis | usize::from(on_u) << u | usize::from(on_v) << v
        };
        let corners: [Corner; 4] = core::array::from_fn(|k| {
            let (this, next) = (index(turns[k]), index(turns[(k + 1) % 4]));
            let along = if (this ^ next) >> u & 1 == 1 { u } else { v };
            let at = |axis: usize| if this >> axis & 1 == 1 { half[axis] } else { -half[axis] };
            Corner {
                point: Vec3::new(at(0), at(1), at(2)),
                name: feature::vertex(this),
                side: feature::edge(along, this),
            }
        });
        let mut normal = Vec3::ZERO;
        normal[axis] = side;
        Self::new(&corners, feature::face(axis, side), normal)
    }

    /// Returns the feature of a hull that extends furthest along `direction`: a face that nearly faces that direction,
    /// otherwise an edge across it, otherwise a corner.
    pub fn of_hull(hull: &Hull, direction: Vec3) -> Self {
        let (polytope, vertices) = (hull.polytope(), hull.vertices());
        let topology = polytope.topology;
        let tolerance = 0.01 * hull.inner_radius();
        let face = polytope.face_at_support(direction, tolerance);
        let normal = polytope.planes[face].normal;
        if normal.dot(direction) >= FACES {
            let sides = topology.sides(face);
            let count = usize::min(sides.len(), MOST_CORNERS);
            let mut corners = [Corner::default(); MOST_CORNERS];
            for (k, corner) in corners[..count].iter_mut().enumerate() {
                let side = sides.start + k * sides.len() / count;
                let vertex = topology.ends(side)[0];
                let (name, side) = (feature::vertex(vertex), feature::half_edge(topology, side));
                *corner = Corner { point: vertices[vertex], name, side };
            }
            return Self::new(&corners[..count], feature::face_number(face), normal);
        }
        let reach = polytope.reach(direction) - tolerance;
        let reaches = |corner: usize| vertices[corner].dot(direction) >= reach;
        let corner = |k: usize| Corner { point: vertices[k], name: feature::vertex(k), side: WHOLE };
        match topology
            .edge_numbers()
            .map(|side| topology.ends(side))
            .find(|ends| ends.map(reaches) == [true; 2])
        {
            Some([from, to]) => Self::new(&[corner(from), corner(to)], WHOLE, Vec3::ZERO),
            None => Self::new(&[corner(polytope.support(direction))], WHOLE, Vec3::ZERO),
        }
    }

    /// Returns the feature of a cylinder or cone that extends furthest along `direction`: an end as an octagon, or the
    /// line along its side.
    pub fn of_truncated_cone(cone: &TruncatedCone, direction: Vec3) -> Self {
        let side = cone.side_normal();
        let out = normalize_or(Vec3::new(direction.x, 0.0, direction.z), Vec3::X);
        // The limit is half-way between the normals of the side and of an end.
        let facing = direction.x * out.x + direction.z * out.z;
        let along_side = facing * side.x + direction.y * side.y;
        let end = sign(direction.y);
        let radius = if end < 0.0 { cone.bottom } else { cone.top };
        if direction.y.abs() > along_side && radius > 0.0 {
            return end_of_truncated_cone(end * cone.half_height, radius, direction, out);
        }
        let low = out * cone.bottom - Vec3::Y * cone.half_height;
        let high = out * cone.top + Vec3::Y * cone.half_height;
        Self::of_edge([low, high])
    }
}

/// Sine of the angle to the axis below which an end touches flat, and its octagon is fixed to the solid. Above it, a
/// corner of the octagon is where the end extends furthest, so that a tilted solid rolls on its rim.
const LEANING: f32 = 0.01;

/// Returns the octagon of an end: eight points of its rim.
fn end_of_truncated_cone(y: f32, radius: f32, direction: Vec3, out: Vec3) -> Feature {
    let leans = direction.x * direction.x + direction.z * direction.z > LEANING * LEANING;
    let first = if leans { out } else { Vec3::X };
    // A quarter turn from `first`, counter-clockwise seen from outside.
    let end = sign(y);
    let quarter = Vec3::new(end * first.z, 0.0, -end * first.x);
    let corners: [Corner; 8] = core::array::from_fn(|k| {
        let (cos, sin) = EIGHTHS[k];
        let point = (first * cos + quarter * sin) * radius + Vec3::new(0.0, y, 0.0);
        let (name, side) = (feature::vertex(k), feature::edge(0, k));
        Corner { point, name: name + end_offset(end), side: side + end_offset(end) }
    });
    Feature::new(&corners, feature::face(1, end), Vec3::new(0.0, end, 0.0))
}

/// Offset that distinguishes the names of the two ends.
fn end_offset(end: f32) -> u16 {
    if end < 0.0 { 0 } else { 0x10 }
}

/// Cosines and sines of eighths of a turn.
const EIGHTHS: [(f32, f32); 8] = [
    (1.0, 0.0),
    (FRAC_1_SQRT_2, FRAC_1_SQRT_2),
    (0.0, 1.0),
    (-FRAC_1_SQRT_2, FRAC_1_SQRT_2),
    (-1.0, 0.0),
    (-FRAC_1_SQRT_2, -FRAC_1_SQRT_2),
    (0.0, -1.0),
    (FRAC_1_SQRT_2, -FRAC_1_SQRT_2),
];
