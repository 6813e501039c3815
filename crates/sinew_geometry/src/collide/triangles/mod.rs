//! Mesh or height field against a convex shape: several manifolds, without contacts at internal edges.
//!
//! Each triangle near the shape is tested separately ([`round`], [`boxed`], [`other`]). The contacts are then filtered
//! ([`claims`]): a contact with a face voids contacts at the edges and corners of that face, and a contact with an edge
//! voids contacts at its corners. So shapes do not catch on edges within a floor. The remaining contacts are merged by
//! normal and reduced to four points each ([`patch`]).

mod boxed;
mod claims;
mod name;
mod other;
mod outline;
mod patch;
mod round;
mod seams;
mod solid;

pub use patch::{MAX_PARTS, Patch};
pub use seams::Ground;

use super::ManifoldPoint;
use super::feature::{self, pair};
use crate::boxes::Aabb;
use crate::convex::support::Core;
use crate::shape::Shape;
use crate::triangles::{Part, Surface, Triangle};
use outline::Outline;
use sinew_math::{Transform, Vec3, min};
use solid::Solid;

/// Motion of a shape relative to a surface in the coming step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Motion {
    /// Velocity of the shape's centre relative to the surface, world, m/s.
    pub velocity: Vec3,
    /// Duration of the motion, seconds.
    pub dt: f32,
    /// Largest separation at which points are reported, metres.
    pub margin: f32,
}

/// Contact with one triangle: points along one normal.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    /// Normal from the surface to the shape.
    normal: Vec3,
    /// Feature of the triangle that is touched.
    part: Part,
    /// Time of the contact.
    when: When,
    /// Displacement of the shape until then, metres.
    shift: Vec3,
    triangle: Triangle,
    /// Index of the candidate's first point in the list of all points.
    first: u32,
    count: u32,
    /// Smallest separation of the points, metres.
    nearest: f32,
    /// True if the candidate is valid: no other contact voids it.
    holds: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum When {
    /// At the present position of the shape.
    Now,
    /// When the shape has moved over the triangle, or is pushed out along its normal. Voids no other contact.
    Soon,
}

/// Buffers that calls of [`collide_surface`] reuse, to avoid allocations.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    candidates: Vec<Candidate>,
    points: Vec<ManifoldPoint>,
    claims: claims::Claims,
    merging: patch::Merging,
}

/// Fills `out` with the contacts of a placed surface and a placed convex shape; normals point from the surface to the
/// shape. `ground` returns the visible normals where other shapes continue the surface: see [`Ground`].
pub fn collide_surface(
    surface: &Surface<'_>,
    world_from_surface: &Transform,
    shape: &Shape,
    world_from_shape: &Transform,
    motion: &Motion,
    ground: Option<&Ground<'_>>,
    scratch: &mut Scratch,
    out: &mut Patch,
) {
    out.clear();
    if !(world_from_surface.is_finite() && world_from_shape.is_finite() && motion.velocity.is_finite()) {
        return;
    }
    let to_surface = world_from_surface.rotation.inverse();
    let middle = middle(shape);
    let center = world_from_surface.inverse_point(world_from_shape.point(middle));
    let Some(core) = Core::of(shape) else { return };
    let rotation = (to_surface * world_from_shape.rotation).normalize();
    let frame = Transform::new(-(rotation * middle), rotation);
    let solid = Solid::new(shape, &core, &frame);
    let local = Motion { velocity: to_surface * motion.velocity, ..*motion };
    scratch.candidates.clear();
    scratch.points.clear();
    let around = shape.aabb(&frame).expand(motion.margin);
    let around = Aabb { min: around.min + center, max: around.max + center };
    surface.overlapping(&around, |triangle| {
        // The shape's centre is the origin, so that points near it are precise even far from the surface's origin.
        meet(&triangle.moved(-center), &solid, &local, scratch);
    });
    if scratch.candidates.is_empty() {
        push_out_from_behind(surface, center, shape, &solid, scratch);
    }
    scratch.claims.void_features(&mut scratch.candidates, solid.tolerance());
    if let Some(ground) = ground {
        let world_from_center = *world_from_surface * Transform::from_translation(center);
        let bounds = (&solid, motion.margin);
        seams::use_visible_normals(
            ground,
            &world_from_center,
            bounds,
            &mut scratch.candidates,
            &mut scratch.points,
        );
    }
    patch::merge(&scratch.candidates, &scratch.points, solid.tolerance(), &mut scratch.merging, out);
    out.finish(world_from_surface, center);
}

/// Returns a point well inside a shape, in the shape's frame. A triangle faces the shape if this point is in front of
/// it.
fn middle(shape: &Shape) -> Vec3 {
    match *shape {
        Shape::Hull(ref hull) => hull.center(),
        Shape::Cone { half_height, .. } => Vec3::new(0.0, -0.5 * half_height, 0.0),
        _ => Vec3::ZERO,
    }
}

/// Tests the shape against one triangle and records the contacts.
fn meet(triangle: &Triangle, solid: &Solid<'_>, motion: &Motion, scratch: &mut Scratch) {
    // The centre must be in front of the triangle, because triangles are one-sided.
    let height = triangle.height(Vec3::ZERO);
    let gap = height - solid.depth(triangle.normal);
    if height <= 0.0 || gap > motion.margin {
        return;
    }
    let mut recorder = Recorder { triangle, solid, margin: motion.margin, scratch };
    let part = match solid {
        Solid::PlacedSphere(radius) => round::sphere(*radius, &mut recorder),
        Solid::PlacedCapsule(pill) => round::capsule(pill, &mut recorder),
        Solid::Box(placed) => boxed::meet(placed, gap, &mut recorder),
        Solid::Other(posed) => other::other(posed, gap, &mut recorder),
    };
    let closing = -motion.velocity.dot(triangle.normal);
    if part != Some(Part::Face) && closing > 0.0 && gap > 0.0 {
        // Adds a contact with the face that the shape will reach in this step, so that a shape at the foot of a ramp
        // does not penetrate the ramp before it is over it.
        let time = min(gap / closing, motion.dt);
        recorder.face(motion.velocity * time, When::Soon);
    }
}

/// Records a contact at the closest triangle if the shape's centre is behind the surface, by at most its inner radius.
fn push_out_from_behind(
    surface: &Surface<'_>,
    center: Vec3,
    shape: &Shape,
    solid: &Solid<'_>,
    scratch: &mut Scratch,
) {
    let Some(closest) = surface.closest(center, shape.inner_radius()) else { return };
    let (distance, _) = closest.signed(center);
    if distance >= 0.0 {
        return;
    }
    let triangle = closest.triangle.moved(-center);
    let separation = distance - solid.depth(triangle.normal);
    let mut recorder = Recorder { triangle: &triangle, solid, margin: 0.0, scratch };
    let point = ManifoldPoint {
        position: triangle.normal * (0.5 * distance),
        separation,
        feature: pair(name::FACE, feature::WHOLE),
    };
    recorder.record(triangle.normal, Part::Face, When::Now, &[point]);
}

/// Records the contacts of one triangle.
struct Recorder<'a> {
    triangle: &'a Triangle,
    solid: &'a Solid<'a>,
    margin: f32,
    scratch: &'a mut Scratch,
}

impl Recorder<'_> {
    /// Returns the side of the shape that faces the triangle, clipped to the prism over the triangle after a motion by
    /// `shift`.
    fn over_face(&self, shift: Vec3) -> Outline {
        let outline = self.solid.outline(self.triangle.normal).moved(shift);
        outline.cut(self.triangle, self.solid.tolerance()).moved(-shift)
    }

    /// Records contacts of the part of the shape that is over the triangle after a motion by `shift`. Returns false if
    /// there are none.
    fn face(&mut self, shift: Vec3, when: When) -> bool {
        let over = self.over_face(shift);
        let has_points = self.face_points(&over, when);
        if let Some(candidate) = self.scratch.candidates.last_mut().filter(|_| has_points) {
            candidate.shift = shift;
        }
        has_points
    }

    /// Records the corners of the outline over the triangle that are within the margin. Returns false if there are
    /// none.
    fn face_points(&mut self, over: &Outline, when: When) -> bool {
        let (normal, radius) = (self.triangle.normal, self.solid.radius());
        let mut points = [ManifoldPoint::default(); outline::MAX_CORNERS];
        let mut count = 0;
        for corner in over.corners() {
            let separation = self.triangle.height(corner.at) - radius;
            if separation <= self.margin {
                points[count] = ManifoldPoint {
                    position: corner.at - normal * (radius + 0.5 * separation),
                    separation,
                    feature: pair(corner.of_surface, corner.of_shape),
                };
                count += 1;
            }
        }
        self.record(normal, Part::Face, when, &points[..count]);
        count > 0
    }

    /// Records points as a candidate, if there are any.
    fn record(&mut self, normal: Vec3, part: Part, when: When, points: &[ManifoldPoint]) {
        if points.is_empty() {
            return;
        }
        let nearest = points.iter().fold(f32::INFINITY, |least, p| min(p.separation, least));
        self.scratch.candidates.push(Candidate {
            normal,
            part,
            when,
            shift: Vec3::ZERO,
            triangle: *self.triangle,
            first: self.scratch.points.len() as u32,
            count: points.len() as u32,
            nearest,
            holds: true,
        });
        self.scratch.points.extend_from_slice(points);
    }

    /// Records a contact along the triangle's normal, for a shape that overlaps the rim of the triangle while its
    /// facing side is not over the triangle. The contact does not void features of other triangles.
    fn lift(&mut self, gap: f32, position: Vec3) {
        let feature = pair(name::FACE, feature::WHOLE);
        let point = ManifoldPoint { position, separation: gap, feature };
        self.record(self.triangle.normal, Part::Face, When::Soon, &[point]);
    }

    /// Records a single point between a feature of the triangle and the shape.
    fn point(&mut self, normal: Vec3, part: Part, position: Vec3, separation: f32, of_shape: u16) {
        let feature = pair(name::part(self.triangle, part), of_shape);
        self.record(normal, part, When::Now, &[ManifoldPoint { position, separation, feature }]);
    }
}

/// Gives the surface's names to the points of a manifold that was computed with a plane in place of the surface.
/// `of_surface` selects the surface's half of a feature.
pub fn name_as_face(manifold: &mut super::Manifold, of_surface: Half) {
    for point in &mut manifold.points[..manifold.count] {
        point.feature |= u32::from(name::FACE) << of_surface.shift();
    }
}

/// Gives the name of hidden sides to the points of a manifold: such points report that two shapes touch, but do not
/// push. `of_surface` selects the surface's half of a feature.
pub fn name_as_hidden(manifold: &mut super::Manifold, of_surface: Half) {
    for point in &mut manifold.points[..manifold.count] {
        point.feature &= !(0xffff << of_surface.shift());
        point.feature |= u32::from(name::HIDDEN) << of_surface.shift();
    }
}

/// True if a manifold has the [name of hidden sides](name_as_hidden).
pub fn is_hidden(manifold: &super::Manifold) -> bool {
    let hidden = u32::from(name::HIDDEN);
    manifold.points().iter().any(|point| point.feature & 0xffff == hidden || point.feature >> 16 == hidden)
}

/// True if all points of a manifold are on faces of the surface.
pub fn is_on_face(manifold: &super::Manifold, of_surface: Half) -> bool {
    manifold.points().iter().all(|point| name::is_face((point.feature >> of_surface.shift()) as u16))
}

/// Half of a contact point's feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Half {
    /// Low 16 bits: the feature of A.
    OfA,
    /// High 16 bits: the feature of B.
    OfB,
}

impl Half {
    fn shift(self) -> u32 {
        match self {
            Self::OfA => 0,
            Self::OfB => 16,
        }
    }
}
