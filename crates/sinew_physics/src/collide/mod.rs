//! Narrow phase: from two placed shapes to a manifold.
//!
//! One file per pair of shapes; each is written for one order of its pair, [`collide`] brings the pair into that
//! order and turns the result round if need be. Inside, positions are relative to one of the two shapes, so that
//! a contact far from the world's origin is as precise as one near it.

mod box_box;
mod box_capsule;
mod box_sphere;
mod capsule_capsule;
mod capsule_sphere;
mod clip;
mod feature;
mod half_space;
mod placed;
mod reduce;

use crate::shape::Shape;
use placed::{Ball, Pill, PlacedBox, Plane};
use sinew_math::{Transform, Vec3};

/// At most this many points describe the contact of two shapes.
pub const MAX_POINTS: usize = 4;

/// One point of a manifold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ManifoldPoint {
    /// Half-way between the two surfaces, in the frame the shapes were given in (world), metres.
    pub position: Vec3,
    /// Gap along the normal, metres; negative when they overlap.
    pub separation: f32,
    /// Which features touch: A's in the low 16 bits, B's in the high ones. The same from step to step while the
    /// same features touch; the other order of the shapes exchanges the halves (`feature.rotate_left(16)`).
    pub feature: u32,
}

/// Where and how two convex shapes touch or are about to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Manifold {
    /// Unit, from A to B.
    pub normal: Vec3,
    /// The points; only the first `count` count.
    pub points: [ManifoldPoint; MAX_POINTS],
    /// How many points, 0..=4.
    pub count: usize,
}

impl Manifold {
    /// The points that count.
    pub fn points(&self) -> &[ManifoldPoint] {
        &self.points[..self.count]
    }

    /// Middle of its points, metres; the origin if there are none.
    pub fn center(&self) -> Vec3 {
        let sum = self.points().iter().fold(Vec3::ZERO, |sum, point| sum + point.position);
        if self.count > 0 { sum / self.count as f32 } else { sum }
    }

    /// Appends a point that lies on one of the surfaces' midplane.
    fn push(&mut self, position: Vec3, separation: f32, feature: u32) {
        self.points[self.count] = ManifoldPoint { position, separation, feature };
        self.count += 1;
    }

    /// Turns the result of (B, A) into that of (A, B).
    fn flip(&mut self) {
        self.normal = -self.normal;
        for point in &mut self.points[..self.count] {
            point.feature = point.feature.rotate_left(16);
        }
    }

    /// Back from coordinates relative to `origin`; drops everything if a number is not finite.
    fn finish(&mut self, origin: Vec3) {
        for point in &mut self.points[..self.count] {
            point.position += origin;
        }
        let sane = |p: &ManifoldPoint| p.position.is_finite() && p.separation.is_finite();
        if !self.normal.is_finite() || !self.points().iter().all(sane) {
            self.count = 0;
        }
    }
}

/// Fills `out` with the contact of two placed shapes: the normal points from `a` to `b`, every point has a
/// separation of at most `margin` (metres, ≥ 0). No points if the shapes are further apart than that, if both are
/// half-spaces, or if a number is not finite. What `out` held before does not matter.
///
/// The order of the shapes does not matter but for rounding: the other one gives the opposite normal, the same
/// points, and features with their halves exchanged.
pub fn collide(
    a: &Shape,
    world_from_a: &Transform,
    b: &Shape,
    world_from_b: &Transform,
    margin: f32,
    out: &mut Manifold,
) {
    *out = Manifold::default();
    if !(world_from_a.is_finite() && world_from_b.is_finite()) {
        return;
    }
    if rank(a) <= rank(b) {
        collide_ranked(a, world_from_a, b, world_from_b, margin, out);
    } else {
        collide_ranked(b, world_from_b, a, world_from_a, margin, out);
        out.flip();
    }
}

/// Order of the shapes in a pair: the file names' order.
fn rank(shape: &Shape) -> u32 {
    match shape {
        Shape::HalfSpace => 0,
        Shape::Box { .. } => 1,
        Shape::Capsule { .. } => 2,
        Shape::Sphere { .. } => 3,
    }
}

/// [`collide`] for `rank(a) <= rank(b)`.
fn collide_ranked(a: &Shape, wa: &Transform, b: &Shape, wb: &Transform, margin: f32, out: &mut Manifold) {
    // B is never the half-space, whose origin may be far away.
    let origin = wb.translation;
    let (wa, wb) =
        (Transform::new(wa.translation - origin, wa.rotation), Transform::new(Vec3::ZERO, wb.rotation));
    match (a, b) {
        (&Shape::HalfSpace, &Shape::Box { half_extents }) => {
            half_space::against_box(&Plane::new(&wa), &PlacedBox::new(half_extents, &wb), margin, out);
        }
        (&Shape::HalfSpace, &Shape::Capsule { half_height, radius }) => {
            half_space::against_capsule(&Plane::new(&wa), &Pill::new(half_height, radius, &wb), margin, out);
        }
        (&Shape::HalfSpace, &Shape::Sphere { radius }) => {
            half_space::against_sphere(&Plane::new(&wa), &Ball::new(radius, &wb), margin, out);
        }
        (&Shape::Box { half_extents: half_a }, &Shape::Box { half_extents: half_b }) => {
            box_box::collide(&PlacedBox::new(half_a, &wa), &PlacedBox::new(half_b, &wb), margin, out);
        }
        (&Shape::Box { half_extents }, &Shape::Capsule { half_height, radius }) => {
            let pill = Pill::new(half_height, radius, &wb);
            box_capsule::collide(&PlacedBox::new(half_extents, &wa), &pill, margin, out);
        }
        (&Shape::Box { half_extents }, &Shape::Sphere { radius }) => {
            box_sphere::collide(&PlacedBox::new(half_extents, &wa), &Ball::new(radius, &wb), margin, out);
        }
        (
            &Shape::Capsule { half_height: height_a, radius: radius_a },
            &Shape::Capsule { half_height: height_b, radius: radius_b },
        ) => {
            let (a, b) = (Pill::new(height_a, radius_a, &wa), Pill::new(height_b, radius_b, &wb));
            capsule_capsule::collide(&a, &b, margin, out);
        }
        (&Shape::Capsule { half_height, radius }, &Shape::Sphere { radius: radius_b }) => {
            let pill = Pill::new(half_height, radius, &wa);
            capsule_sphere::collide(&pill, &Ball::new(radius_b, &wb), margin, out);
        }
        (&Shape::Sphere { radius }, &Shape::Sphere { radius: radius_b }) => {
            // A ball is a capsule without a middle.
            let pill = Pill::new(0.0, radius, &wa);
            capsule_sphere::collide(&pill, &Ball::new(radius_b, &wb), margin, out);
        }
        // The other half of the pairs is brought into this order by `collide`; two half-spaces never meet.
        _ => {}
    }
    out.finish(origin);
}
