//! Convex polytopes with borrowed corners: a hull, a box or a triangle, in any frame.

use super::topology::{Plane, Topology};
use super::{Hull, MAX_FACES, MAX_VERTICES, reach, support};
use crate::boxes::segment::Segment;
use sinew_math::{Transform, Vec3, min};

/// Corners, planes and topology of a convex polytope. A triangle has two faces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Polytope<'a> {
    /// A point inside.
    pub center: Vec3,
    pub vertices: &'a [Vec3],
    pub planes: &'a [Plane],
    pub topology: Topology<'a>,
    /// Radius of an inscribed ball, the scale of tolerances, metres. Infinite if the other shape sets the scale.
    pub thickness: f32,
}

impl Hull {
    /// Returns the polytope in the hull's own frame.
    pub(crate) fn polytope(&self) -> Polytope<'_> {
        Polytope {
            center: self.center,
            vertices: &self.vertices,
            planes: &self.planes,
            topology: self.topology(),
            thickness: self.inner_radius,
        }
    }
}

/// Buffer for a polytope in another frame.
pub(crate) struct Room {
    vertices: [Vec3; MAX_VERTICES],
    planes: [Plane; MAX_FACES],
}

impl Room {
    pub const EMPTY: Self = Self {
        vertices: [Vec3::ZERO; MAX_VERTICES],
        planes: [Plane { normal: Vec3::ZERO, offset: 0.0 }; MAX_FACES],
    };
}

impl<'a> Polytope<'a> {
    /// Returns the polytope in another frame.
    pub fn seen_from<'b>(&self, frame_from_this: &Transform, room: &'b mut Room) -> Polytope<'b>
    where
        'a: 'b,
    {
        let (m, shift) = (frame_from_this.rotation.to_mat3(), frame_from_this.translation);
        for (to, &from) in room.vertices.iter_mut().zip(self.vertices) {
            *to = m * from + shift;
        }
        for (to, from) in room.planes.iter_mut().zip(self.planes) {
            let normal = m * from.normal;
            *to = Plane { normal, offset: from.offset + normal.dot(shift) };
        }
        Polytope {
            center: m * self.center + shift,
            vertices: &room.vertices[..self.vertices.len()],
            planes: &room.planes[..self.planes.len()],
            topology: self.topology,
            thickness: self.thickness,
        }
    }

    /// Index of the corner furthest along a direction; the first among equals.
    pub fn support(&self, direction: Vec3) -> usize {
        support(self.vertices, direction)
    }

    /// Largest coordinate along a direction, from the origin.
    pub fn reach(&self, direction: Vec3) -> f32 {
        reach(self.vertices, direction)
    }

    /// Returns the edge of a half-edge.
    pub fn edge(&self, side: usize) -> Segment {
        Segment { ends: self.topology.ends(side).map(|corner| self.vertices[corner]) }
    }

    /// Index of the face whose normal is closest to a direction; the first among equals.
    pub fn facing(&self, direction: Vec3) -> usize {
        let (mut best, mut most) = (0, f32::NEG_INFINITY);
        for (face, plane) in self.planes.iter().enumerate() {
            let along = plane.normal.dot(direction);
            if along > most {
                (best, most) = (face, along);
            }
        }
        best
    }

    /// Index of the face whose normal is closest to a direction, among the faces at the corners furthest along it
    /// (within `tolerance`).
    pub fn face_at_support(&self, direction: Vec3, tolerance: f32) -> usize {
        let least = self.reach(direction) - tolerance;
        let reaches = |corner: usize| self.vertices[corner].dot(direction) >= least;
        let (mut best, mut most) = (0, f32::NEG_INFINITY);
        for (face, plane) in self.planes.iter().enumerate() {
            let along = plane.normal.dot(direction);
            if along > most && self.topology.corners(face).any(reaches) {
                (best, most) = (face, along);
            }
        }
        best
    }

    /// Returns the height over the highest plane at a point, positive outside, and the normal of that plane.
    pub fn highest_plane(&self, p: Vec3) -> (f32, Vec3) {
        let (mut highest, mut normal) = (f32::NEG_INFINITY, Vec3::Y);
        for plane in self.planes {
            let height = plane.height(p);
            if height > highest {
                (highest, normal) = (height, plane.normal);
            }
        }
        (highest, normal)
    }

    /// Returns the point of the surface closest to `p`, on a face that faces `p`; returns `p` itself if it is inside.
    pub fn closest(&self, p: Vec3) -> Vec3 {
        let (mut best, mut closest) = (f32::INFINITY, p);
        // Because of rounding, a point on a face may count as just below that face and just above the plane of a
        // neighbouring face.
        let lowest = -1e-6 * ((p - self.center).length() + p.length());
        for (face, plane) in self.planes.iter().enumerate() {
            let height = plane.height(p);
            // The distance to a face is at least the distance to its plane.
            if height <= lowest || height * height >= best {
                continue;
            }
            let on_face = self.closest_on_face(face, p);
            let squared = (p - on_face).length_squared();
            if squared < best {
                (best, closest) = (squared, on_face);
            }
        }
        closest
    }

    /// Returns the point of a face closest to `p`: its projection, or a point on an edge beyond which `p` is.
    fn closest_on_face(&self, face: usize, p: Vec3) -> Vec3 {
        let plane = &self.planes[face];
        let (mut best, mut closest) = (f32::INFINITY, p - plane.normal * plane.height(p));
        for side in self.topology.sides(face) {
            let edge = self.edge(side);
            let [from, to] = edge.ends;
            if (to - from).cross(p - from).dot(plane.normal) >= 0.0 {
                continue;
            }
            let on_edge = edge.at(edge.closest(p));
            let squared = (p - on_edge).length_squared();
            if squared < best {
                (best, closest) = (squared, on_edge);
            }
        }
        closest
    }

    /// Returns the signed distance of a point, and the unit outward normal at the closest point of the surface.
    pub fn distance(&self, p: Vec3) -> (f32, Vec3) {
        let (highest, normal) = self.highest_plane(p);
        if highest <= 0.0 {
            return (highest, normal);
        }
        let span = p - self.closest(p);
        let distance = span.length();
        // Rounding dominates the direction between close points; at distant corners the error would be millimetres.
        let noise = 1e-4 * (p - self.center).length();
        if distance > noise { (distance, span / distance) } else { (distance, normal) }
    }

    /// Returns the fraction (≥ 0) and the normal at which a ray from outside enters. A convex solid is the intersection
    /// of the half-spaces of its faces.
    pub fn enter(&self, origin: Vec3, direction: Vec3) -> Option<(f32, Vec3)> {
        let (mut first, mut last) = (f32::NEG_INFINITY, f32::INFINITY);
        let mut normal = Vec3::ZERO;
        for plane in self.planes {
            let (height, rate) = (plane.height(origin), plane.normal.dot(direction));
            if rate == 0.0 {
                if height > 0.0 {
                    return None;
                }
                continue;
            }
            let at = -height / rate;
            if rate > 0.0 {
                last = min(at, last);
            } else if at > first {
                (first, normal) = (at, plane.normal);
            }
        }
        (first <= last && first >= 0.0).then_some((first, normal))
    }
}
