//! Sweep queries: rays and moving shapes.

use super::Query;
use super::candidates::Reach;
use super::kind::QueryKind;
use super::kind::sealed::{Ask, Reply};
use super::pair;
use super::probe::Probe;
use super::rays;
use crate::body::shape::Shape;
use crate::boxes::{Aabb, Penetration};
use crate::convex::{ShapeHit, closeness};
use crate::id::{BodyId, ShapeId};
use crate::ray::{Ray, RayHit};
use sinew_math::{Transform, Vec3, max, normalize_or};

/// First hit of a ray or a moved shape on a shape of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyHit {
    /// The body.
    pub body: BodyId,
    /// Number of the shape in its body.
    pub shape: u32,
    /// Fraction of the sweep before the hit, 0..=1; 0 if the sweep starts inside.
    pub fraction: f32,
    /// Contact point, world, metres; for a start inside, the start of the ray or the centre of the overlap.
    pub point: Vec3,
    /// Unit outward normal of the hit shape, world; for a start inside, opposite to the sweep.
    pub normal: Vec3,
    /// Depth and shortest way out for a start inside; otherwise `None`.
    pub start: Option<Penetration>,
}

impl BodyHit {
    /// Creates a hit from the answer of one shape; `None` if a number is not finite.
    fn new(id: ShapeId, hit: RayHit, start: Option<Penetration>) -> Option<Self> {
        let RayHit { fraction, point, normal } = hit;
        // Changes −0 to 0.
        let fraction = max(fraction, 0.0);
        let finite = fraction.is_finite() && point.is_finite() && normal.is_finite();
        finite.then_some(Self { body: id.body, shape: id.shape, fraction, point, normal, start })
    }
}

impl Reply for BodyHit {
    fn shape(&self) -> ShapeId {
        ShapeId { body: self.body, shape: self.shape }
    }

    fn rank(&self) -> f32 {
        self.fraction
    }
}

/// Finds the shapes hit by a ray, from its start to its end; the first hit comes first.
impl QueryKind for Ray {
    type Answer = BodyHit;
}

impl Ask for Ray {
    type Found = BodyHit;

    fn reach(&self) -> Option<Reach> {
        let point = Aabb { min: self.origin, max: self.origin };
        (self.origin.is_finite() && self.direction.is_finite()).then_some(Reach::Swept(point, self.direction))
    }

    fn ask(&self, id: ShapeId, shape: &Shape, world_from_shape: &Transform) -> Option<BodyHit> {
        let hit = shape.cast_ray(world_from_shape, self)?;
        let start = || {
            let (distance, direction) = shape.signed_distance(world_from_shape, self.origin);
            (distance <= 0.0).then_some(Penetration { depth: -distance, direction })
        };
        BodyHit::new(id, hit, if hit.fraction == 0.0 { start() } else { None })
    }

    fn first_each<P: Fn(BodyId, u32) -> bool>(
        query: &Query<'_, P>,
        rays: &[Self],
        hits: &mut [Option<BodyHit>],
    ) {
        rays::first_each(query, rays, hits);
    }

    fn is_met(&self, _: ShapeId, shape: &Shape, world_from_shape: &Transform) -> bool {
        shape.cast_ray(world_from_shape, self).is_some()
    }
}

/// Finds the shapes hit by a probe that moves without rotation; the first hit comes first.
#[derive(Clone, Debug, PartialEq)]
#[doc(alias = "sweep test")]
#[doc(alias = "cast_shape")]
pub struct ShapeCast {
    /// Probe at the start of its motion.
    pub probe: Probe,
    /// Displacement of the probe, metres.
    pub translation: Vec3,
}

impl QueryKind for ShapeCast {
    type Answer = BodyHit;
}

impl Ask for ShapeCast {
    type Found = BodyHit;

    fn reach(&self) -> Option<Reach> {
        let usable = self.translation.length() < f32::INFINITY && self.probe.is_valid();
        usable.then(|| {
            // The cast may report a hit up to this distance before contact.
            let early = 2.0 * closeness(self.probe.shape.bounding_radius(), self.translation);
            Reach::Swept(self.probe.aabb().expand(early), self.translation)
        })
    }

    fn ask(&self, id: ShapeId, shape: &Shape, world_from_shape: &Transform) -> Option<BodyHit> {
        let ShapeHit { fraction, point, normal } =
            pair::cast(shape, world_from_shape, &self.probe, self.translation)?;
        let hit = RayHit { fraction, point, normal };
        let start =
            if fraction == 0.0 { pair::penetration(shape, world_from_shape, &self.probe) } else { None };
        let Some(start) = start else { return BodyHit::new(id, hit, None) };
        let normal = normalize_or(-self.translation, start.direction);
        BodyHit::new(id, RayHit { normal, ..hit }, Some(start))
    }
}
