//! Manifolds that are kept: as long as two bodies hardly move against each other, the same features touch, and only their
//! distance is worked out anew, from points that are fixed in the bodies.

use crate::body::Body;
use crate::body::shape::Shape;
use crate::collide::{MAX_POINTS, Manifold};
use crate::contact::ContactKey;
use crate::contact::tuning::SPECULATIVE_SLOPS;
use crate::contact::tuning::{RECYCLED_HALF_TURN, RECYCLED_SLIP};
use sinew_math::{ReadError, Reader, Rotation, Transform, Vec3, Writer};

/// From this cosine on, a normal is that of a face, to rounding.
const ON_FACE: f32 = 0.999_999;

/// A manifold as it was found, in the frames of its bodies. Part of the state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Recycled {
    /// Number of points; none if there is nothing to keep to.
    count: usize,
    /// Rotation of B seen from A when the manifold was found.
    a_from_b: Rotation,
    /// The normal, in the frame of the body whose face it is of.
    normal: Vec3,
    of_b: bool,
    /// Within which points were looked for, metres.
    margin: f32,
    /// Slop of the two shapes, metres.
    slop: f32,
    /// Place of each point on the surfaces of A and B, in their frames.
    points: [[Vec3; 2]; MAX_POINTS],
}

/// True if a direction in the frame of a solid is that of the normal of one of its faces.
fn is_of_face(shape: &Shape, direction: Vec3) -> bool {
    match shape {
        Shape::Box { .. } => direction.abs().cmpgt(Vec3::splat(ON_FACE)).any(),
        Shape::Hull(hull) => hull.faces().any(|face| face.normal().dot(direction) > ON_FACE),
        _ => false,
    }
}

impl Recycled {
    /// Record of a manifold that was just found. Only of what lies on a face of a solid with flat faces: other
    /// points are found as soon as renewed, and what rolls has others from step to step.
    pub fn new([a, b]: [&Body; 2], key: ContactKey, (margin, slop): (f32, f32), manifold: &Manifold) -> Self {
        let shapes = [(a, key.shape_a), (b, key.shape_b)].map(|(body, shape)| &body.shapes[shape as usize]);
        let is_flat = |shape: &Shape| matches!(shape, Shape::Box { .. } | Shape::Hull(_));
        if manifold.count == 0 || !shapes.iter().all(|shape| is_flat(&shape.shape)) {
            return Self::default();
        }
        let [pose_a, pose_b] = [a.world_from_principal, b.world_from_principal];
        let n = manifold.normal;
        let of_face = |side: usize, pose: &Transform, n: Vec3| {
            let shape_from_world = (pose.rotation * shapes[side].principal_from_shape.rotation).inverse();
            is_of_face(&shapes[side].shape, shape_from_world * n)
        };
        let of_b = !of_face(0, &pose_a, n);
        if of_b && !of_face(1, &pose_b, -n) {
            return Self::default();
        }
        let mut points = [[Vec3::ZERO; 2]; MAX_POINTS];
        for (kept, point) in points.iter_mut().zip(manifold.points()) {
            let half = n * (0.5 * point.separation);
            *kept =
                [pose_a.inverse_point(point.position - half), pose_b.inverse_point(point.position + half)];
        }
        let frame = if of_b { pose_b } else { pose_a };
        Self {
            count: manifold.count,
            a_from_b: pose_a.rotation.inverse() * pose_b.rotation,
            normal: frame.rotation.inverse() * n,
            of_b,
            margin,
            slop,
            points,
        }
    }

    /// Brings a manifold to where the bodies are, if they have hardly moved against each other since it was found; false if it
    /// has to be found anew, and then it is as it was.
    pub fn renew(&self, [a, b]: [&Body; 2], margin: f32, manifold: &mut Manifold) -> bool {
        if self.count == 0 || self.count != manifold.count || margin > self.margin {
            return false;
        }
        let [pose_a, pose_b] = [a.world_from_principal, b.world_from_principal];
        let a_from_b = pose_a.rotation.inverse() * pose_b.rotation;
        if a_from_b.dot(self.a_from_b).abs() < RECYCLED_HALF_TURN {
            return false;
        }
        let normal = if self.of_b { pose_b } else { pose_a }.rotation * self.normal;
        let offset = pose_b.translation - pose_a.translation;
        let most = RECYCLED_SLIP * self.slop * (RECYCLED_SLIP * self.slop);
        let mut renewed = *manifold;
        renewed.normal = normal;
        for (point, [on_a, on_b]) in renewed.points[..self.count].iter_mut().zip(&self.points) {
            let arm = pose_a.rotation * *on_a;
            let gap = offset + pose_b.rotation * *on_b - arm;
            point.separation = gap.dot(normal);
            point.position = pose_a.translation + (arm + gap * 0.5);
            let slip = (gap - normal * point.separation).length_squared();
            // Not finite is not within either.
            let holds = slip <= most && point.separation <= margin;
            if !holds {
                return false;
            }
        }
        *manifold = renewed;
        true
    }

    /// Least margin within which points are looked for, metres; 0 if there is nothing to keep to.
    pub fn least_margin(&self) -> f32 {
        if self.count > 0 { SPECULATIVE_SLOPS * self.slop } else { 0.0 }
    }

    /// It no longer holds.
    pub fn drop(&mut self) {
        self.count = 0;
    }

    pub fn save(&self, w: &mut Writer) {
        w.count(self.count);
        if self.count == 0 {
            return;
        }
        w.rotation(self.a_from_b);
        w.vec3(self.normal);
        w.bool(self.of_b);
        w.f32(self.margin);
        w.f32(self.slop);
        for [on_a, on_b] in &self.points[..self.count] {
            w.vec3(*on_a);
            w.vec3(*on_b);
        }
    }

    pub fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let count = r.count(24)?;
        if count > MAX_POINTS {
            return Err(r.error("a contact keeps too many points"));
        }
        if count == 0 {
            return Ok(Self::default());
        }
        let (a_from_b, normal, of_b) = (r.rotation()?, r.vec3()?, r.bool()?);
        let (margin, slop) = (r.f32()?, r.f32()?);
        let mut points = [[Vec3::ZERO; 2]; MAX_POINTS];
        for kept in &mut points[..count] {
            *kept = [r.vec3()?, r.vec3()?];
        }
        Ok(Self { count, a_from_b, normal, of_b, margin, slop, points })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::def::{BodyDef, BodyKind};
    use crate::body::shape::ShapeDef;
    use crate::collide::collide;
    use crate::contact::slop;
    use sinew_math::Random;

    const MARGIN: f32 = 0.02;

    fn found([a, b]: [&Body; 2]) -> Manifold {
        let [(shape_a, from_a), (shape_b, from_b)] =
            [a, b].map(|body| (&body.shapes[0].shape, body.world_from_shape(0)));
        let mut manifold = Manifold::default();
        collide(shape_a, &from_a, shape_b, &from_b, MARGIN, &mut manifold);
        manifold
    }

    fn put(body: &mut Body, shift: Vec3, turn: Vec3) {
        let Transform { translation, rotation } = body.world_from_principal;
        body.world_from_principal =
            Transform::new(translation + shift, Rotation::from_scaled_axis(turn) * rotation);
    }

    /// Boxes that lie on each other and are moved a little: points that are kept are as far apart as points found anew. Where
    /// they are is not compared: edges that are nearly parallel cross somewhere else at once.
    #[test]
    fn kept_points_are_as_far_apart_as_new_ones() {
        let mut random = Random::new(14);
        let key = ContactKey { a: 0, b: 1, shape_a: 0, shape_b: 0, part: 0 };
        let (mut kept, mut dropped, mut same) = (0, 0, 0);
        for case in 0..4_000 {
            let mut boxed = |at: Vec3| {
                let half_extents = Vec3::new(0.3, 0.3, 0.3) + random.in_cube() * 0.1;
                let shapes = vec![ShapeDef::new(Shape::Box { half_extents })];
                Body::new(&BodyDef { kind: BodyKind::Dynamic, position: at, shapes, ..BodyDef::default() })
            };
            let (mut a, mut b) = (boxed(Vec3::ZERO), boxed(Vec3::Y * 0.6));
            put(&mut b, random.in_cube() * 0.1, random.in_cube() * 0.02);
            let mut manifold = found([&a, &b]);
            if manifold.count == 0 {
                continue;
            }
            let of = Recycled::new([&a, &b], key, (MARGIN, slop(0.4)), &manifold);
            // Both together, and B a little, or more than is allowed.
            let (shift, turn) = (random.in_cube(), random.in_cube());
            for body in [&mut a, &mut b] {
                let around =
                    Transform::new(Vec3::ZERO, Rotation::from_scaled_axis(turn)) * body.world_from_principal;
                body.world_from_principal = Transform::new(around.translation + shift, around.rotation);
            }
            let most = [0.1, 0.5, 20.0][random.index(3)];
            put(&mut b, random.in_cube() * (2e-3 * most), random.in_cube() * (2e-3 * most));
            let before = manifold;
            if !of.renew([&a, &b], MARGIN, &mut manifold) {
                assert_eq!(manifold, before, "case {case}");
                dropped += 1;
                continue;
            }
            kept += 1;
            let anew = found([&a, &b]);
            // The face of the other box may be as good: tilted by up to 3 degrees, with names of its own.
            assert!(anew.normal.dot(manifold.normal) > 0.998, "case {case}: {anew:?}, {manifold:?}");
            for point in manifold.points() {
                if let Some(other) = anew.points().iter().find(|other| other.feature == point.feature) {
                    same += 1;
                    let off = (other.separation - point.separation).abs();
                    assert!(off < 2e-4, "case {case}: {off} m, {anew:?}, {manifold:?}");
                }
            }
        }
        assert!(kept > 1_000 && dropped > 500 && same > 3 * kept, "{kept} {dropped} {same}");
    }
}
