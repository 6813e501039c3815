//! Seams: places where solids abut, and which of their faces are visible there. In a floor of boxes, each box hides the
//! side of its neighbour, so a shape that slides over the floor must not touch those sides.

use crate::boxes::Aabb;
use crate::shape::Shape;
use crate::triangles::{Surface, Triangle, closest_on_triangle};
use sinew_math::{Transform, Vec3, max, normalize_or};

/// Largest number of faces of a solid around a point. If more faces meet there, [`Faces::around`] returns `None`.
const MOST: usize = 8;
/// Least cosine between the normals of faces that are merged.
const SAME: f32 = 0.999;
/// Sine of the angle out of a face up to which a direction counts as along the face.
const ALONG: f32 = 0.03;
/// Tolerance for rounding: sine of the angle out of a face up to which a direction counts as not leaving the solid, and
/// least length of a sum of normals.
const FLAT: f32 = 1e-3;
/// Least cosine between the result of [`Faces::shown`] and the queried normal.
const AVERSE: f32 = -0.3;

/// Faces of a solid, or of a surface, around a point.
#[derive(Clone, Copy, Debug)]
pub struct Faces {
    /// Outward unit normals, world.
    normals: [Vec3; MOST],
    /// Height of the point over each face, metres.
    heights: [f32; MOST],
    count: usize,
    /// Mask of faces that other solids hide.
    hidden: u8,
}

impl Faces {
    /// Returns the faces within `reach` (metres) of a point in the world; an empty set if the point is deeper inside.
    /// `None` if the point is further outside, if more than eight faces are near, or if the shape has no flat faces.
    pub fn around(shape: &Shape, world_from_shape: &Transform, point: Vec3, reach: f32) -> Option<Self> {
        let mut faces = Self { normals: [Vec3::ZERO; MOST], heights: [0.0; MOST], count: 0, hidden: 0 };
        let p = world_from_shape.inverse_point(point);
        let inside = match shape {
            Shape::HalfSpace => faces.take(Vec3::Y, p.y, reach),
            Shape::Box { half_extents } => Vec3::AXES.into_iter().all(|axis| {
                let (x, half) = (p.dot(axis), half_extents.dot(axis));
                faces.take(axis, x - half, reach) && faces.take(-axis, -x - half, reach)
            }),
            Shape::Hull(hull) => hull
                .faces()
                .all(|face| faces.take(face.normal(), face.normal().dot(p) - face.offset(), reach)),
            _ => shape.surface().is_some_and(|surface| faces.take_surface(&surface, p, reach)),
        };
        faces.normals[..faces.count]
            .iter_mut()
            .for_each(|normal| *normal = world_from_shape.rotation * *normal);
        inside.then_some(faces)
    }

    /// Number of faces.
    #[inline]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Adds a face if the point is within `reach` of its plane. Returns false if the point is further outside, or if
    /// there is no room for the face.
    fn take(&mut self, normal: Vec3, height: f32, reach: f32) -> bool {
        if height > reach {
            return false;
        }
        if height >= -reach {
            if self.count == MOST {
                return false;
            }
            (self.normals[self.count], self.heights[self.count]) = (normal, height);
            self.count += 1;
        }
        true
    }

    /// Adds the triangles around a point, and a vertical side for each edge there at which the surface ends or bends
    /// down. Returns true if there are triangles and all faces fit.
    fn take_surface(&mut self, surface: &Surface<'_>, p: Vec3, reach: f32) -> bool {
        let mut fits = true;
        surface.overlapping(&Aabb::reaching(p, Vec3::splat(reach)), |triangle| {
            let (nearest, _) = closest_on_triangle(&triangle.corners, p);
            if (nearest - p).length() <= reach {
                fits &= self.take_triangle(&triangle, p, reach);
            }
        });
        fits && self.count > 0
    }

    fn take_triangle(&mut self, triangle: &Triangle, p: Vec3, reach: f32) -> bool {
        let mut fits = self.take_new(triangle.normal, triangle.height(p), reach);
        for edge in (0..3).filter(|&edge| triangle.is_active(edge)) {
            let (from, to) = (triangle.corners[edge], triangle.corners[(edge + 1) % 3]);
            let out = normalize_or((to - from).cross(triangle.normal), Vec3::ZERO);
            fits &= self.take_new(out, out.dot(p - from), reach);
        }
        fits
    }

    /// Adds a face unless an earlier one has nearly the same normal.
    fn take_new(&mut self, normal: Vec3, height: f32, reach: f32) -> bool {
        let is_known = self.normals[..self.count].iter().any(|known| known.dot(normal) > SAME);
        is_known || self.take(normal, height, reach)
    }

    /// Marks the faces that another solid hides around the point. A face is hidden if every direction along it leads
    /// into the other solid.
    pub fn hide_behind(&mut self, other: &Self) {
        for face in 0..self.count {
            if self.is_behind(face, other) {
                self.hidden |= 1 << face;
            }
        }
    }

    fn is_behind(&self, face: usize, other: &Self) -> bool {
        let normal = self.normals[face];
        let others = &other.normals[..other.count];
        // A face that both solids share is visible on both.
        if others.iter().any(|out| out.dot(normal) > SAME) {
            return false;
        }
        let edges = || self.normals[..self.count].iter().filter(|edge| edge.dot(normal).abs() < SAME);
        let leads_out = |way: Vec3| {
            let lies_in = edges().all(|edge| edge.dot(way) <= FLAT);
            lies_in && others.iter().any(|out| out.dot(way) > ALONG)
        };
        if edges().next().is_none() {
            let one =
                normalize_or(normal.cross(if normal.x.abs() < 0.6 { Vec3::X } else { Vec3::Y }), Vec3::ZERO);
            let two = normal.cross(one);
            return ![one, -one, two, -two].into_iter().any(leads_out);
        }
        !edges().any(|edge| {
            let along = normalize_or(normal.cross(*edge), Vec3::ZERO);
            let inward = normalize_or(normal * normal.dot(*edge) - *edge, Vec3::ZERO);
            [along, -along, inward].into_iter().any(leads_out)
        })
    }

    /// True if another solid hides one of the faces.
    #[inline]
    pub fn has_hidden(&self) -> bool {
        self.hidden != 0
    }

    /// Returns the unit normal nearest to `normal` among the non-negative combinations of the visible faces' normals,
    /// and the height of the point over the supporting plane with that normal, metres. `None` if all faces are hidden,
    /// or if the nearest normal points away from `normal`.
    pub fn shown(&self, normal: Vec3) -> Option<(Vec3, f32)> {
        let shown = |face: &usize| self.hidden >> face & 1 == 0;
        let mut best: Option<(f32, Vec3, f32)> = None;
        let mut consider = |sum: Vec3, height: f32| {
            let length = sum.length();
            let cosine = sum.dot(normal) / max(length, f32::MIN_POSITIVE);
            if length > FLAT && best.is_none_or(|(most, ..)| cosine > most) {
                best = Some((cosine, sum / length, height / length));
            }
        };
        for i in (0..self.count).filter(shown) {
            let (p, of_p) = (self.normals[i], self.normals[i].dot(normal));
            consider(p, self.heights[i]);
            for j in (0..i).filter(shown) {
                let (q, of_q) = (self.normals[j], self.normals[j].dot(normal));
                let c = p.dot(q);
                let (a, b) = (of_p - c * of_q, of_q - c * of_p);
                if a > 0.0 && b > 0.0 {
                    consider(p * a + q * b, self.heights[i] * a + self.heights[j] * b);
                }
                for k in (0..j).filter(shown) {
                    let r = self.normals[k];
                    let span = p.dot(q.cross(r));
                    let shares = [normal.dot(q.cross(r)), normal.dot(r.cross(p)), normal.dot(p.cross(q))]
                        .map(|x| x * span);
                    if shares.iter().all(|share| *share > 0.0) {
                        let [a, b, c] = shares;
                        let height = self.heights[i] * a + self.heights[j] * b + self.heights[k] * c;
                        consider(p * a + q * b + r * c, height);
                    }
                }
            }
        }
        best.filter(|(cosine, ..)| *cosine > AVERSE).map(|(_, shown, height)| (shown, height))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_math::{Random, Rotation};

    fn cube() -> Shape {
        Shape::cuboid(Vec3::splat(0.5))
    }

    #[test]
    fn abutting_box_hides_only_the_common_side() {
        let mut random = Random::new(5);
        for case in 0..200 {
            let frame = Transform::new(random.in_cube() * 5.0, random.rotation());
            let beside = |by: Vec3| frame * Transform::from_translation(by);
            let raised = random.range(0.0, 0.003);
            let around = |by: Vec3, p: Vec3| Faces::around(&cube(), &beside(by), frame.point(p), 0.0045);
            let seam = Vec3::new(0.5, 0.5, random.range(-0.3, 0.3));
            let (up, side) = (frame.rotation * Vec3::Y, frame.rotation * Vec3::X);
            let mut left = around(Vec3::ZERO, seam).expect("a face is near the point");
            assert_eq!(left.count(), 2);
            left.hide_behind(&around(Vec3::new(1.0, raised, 0.0), seam).expect("a face is near the point"));
            let tilted = (up + side * random.range(0.01, 3.0)).normalize();
            let (normal, height) = left.shown(tilted).expect("the top is visible");
            assert!(
                (normal - up).length() < 1e-5 && height.abs() < 1e-5,
                "case {case}: normal {normal}, height {height}"
            );
            // A wall that stands on the floor and continues below it.
            for below in [0.5, 0.0] {
                let foot = Vec3::new(0.5, 0.5, seam.z);
                let at = Vec3::new(1.0, 1.0 - below, 0.0);
                let mut wall = around(at, foot).expect("a face is near the point");
                wall.hide_behind(&around(Vec3::ZERO, foot).expect("a face is near the point"));
                let (normal, _) = wall.shown(-side).expect("the side is visible");
                assert!((normal + side).length() < 1e-5, "case {case}, {below} below: normal {normal}");
            }
            // A single box shows all faces.
            let alone = around(Vec3::ZERO, seam).expect("a face is near the point");
            let (normal, _) = alone.shown(tilted).expect("the edge is visible");
            assert!((normal - tilted).length() < 1e-5, "case {case}: normal {normal}, expected {tilted}");
        }
    }

    #[test]
    fn enclosed_box_shows_no_face_and_coincident_box_shows_all() {
        let at = Transform::new(Vec3::ZERO, Rotation::from_axis_angle(Vec3::Z, 0.3));
        let edge = at.point(Vec3::new(0.5, 0.5, 0.0));
        let faces = || Faces::around(&cube(), &at, edge, 0.004).expect("a face is near the point");
        let mut twin = faces();
        twin.hide_behind(&faces());
        assert!(twin.shown(at.rotation * Vec3::X).is_some());
        let large = Shape::cuboid(Vec3::splat(0.6));
        let mut buried = faces();
        buried.hide_behind(&Faces::around(&large, &at, edge, 0.004).expect("a face is near the point"));
        assert!(buried.shown(at.rotation * Vec3::X).is_none());
    }
}
