//! Position queries: shapes that contain a point, that a probe overlaps, with depth, and the nearest ones.

use super::candidates::Reach;
use super::kind::QueryKind;
use super::kind::sealed::{Ask, Reply};
use super::pair;
use super::probe::Probe;
use crate::body::shape::Shape;
use crate::boxes::{Aabb, Penetration, SurfacePoint};
use crate::convex::Gap;
use crate::id::{BodyId, ShapeId};
use sinew_math::{Transform, Vec3};

/// Shapes that hold a point (world, metres), on their surfaces too; by body and shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContainsPoint(pub Vec3);

impl QueryKind for ContainsPoint {
    type Answer = ShapeId;
}

impl Ask for ContainsPoint {
    type Found = ShapeId;

    fn reach(&self) -> Option<Reach> {
        self.0.is_finite().then_some(Reach::Box(Aabb { min: self.0, max: self.0 }))
    }

    fn ask(&self, id: ShapeId, shape: &Shape, world_from_shape: &Transform) -> Option<ShapeId> {
        (shape.nearest_surface(world_from_shape, self.0).distance <= 0.0).then_some(id)
    }
}

impl Reply for ShapeId {
    fn shape(&self) -> ShapeId {
        *self
    }

    fn rank(&self) -> f32 {
        0.0
    }
}

/// Shapes that a probe overlaps, including touching and containing ones, by body and shape.
#[derive(Clone, Debug, PartialEq)]
pub struct OverlapWith(pub Probe);

impl QueryKind for OverlapWith {
    type Answer = ShapeId;
}

impl Ask for OverlapWith {
    type Found = ShapeId;

    fn reach(&self) -> Option<Reach> {
        self.0.is_valid().then(|| Reach::Box(self.0.aabb()))
    }

    fn ask(&self, id: ShapeId, shape: &Shape, world_from_shape: &Transform) -> Option<ShapeId> {
        pair::overlap(shape, world_from_shape, &self.0).then_some(id)
    }
}

/// Depth of a probe in each shape that it overlaps; the deepest first.
#[derive(Clone, Debug, PartialEq)]
pub struct PenetrationOf(pub Probe);

/// Depth of a probe in a shape of a body, and the shortest way out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPenetration {
    /// The body.
    pub body: BodyId,
    /// Number of the shape in its body.
    pub shape: u32,
    /// Metres, ≥ 0; 0 if it only touches.
    pub depth: f32,
    /// Unit, world: moved by `direction * depth`, the probe only touches the shape. The shortest way out of this shape
    /// alone: it may lead into another one.
    pub direction: Vec3,
}

impl Reply for BodyPenetration {
    fn shape(&self) -> ShapeId {
        ShapeId { body: self.body, shape: self.shape }
    }

    fn rank(&self) -> f32 {
        -self.depth
    }
}

impl QueryKind for PenetrationOf {
    type Answer = BodyPenetration;
}

impl Ask for PenetrationOf {
    type Found = BodyPenetration;

    fn reach(&self) -> Option<Reach> {
        self.0.is_valid().then(|| Reach::Box(self.0.aabb()))
    }

    fn ask(&self, id: ShapeId, shape: &Shape, world_from_shape: &Transform) -> Option<BodyPenetration> {
        let Penetration { depth, direction } = pair::penetration(shape, world_from_shape, &self.0)?;
        Some(BodyPenetration { body: id.body, shape: id.shape, depth, direction })
    }

    fn is_met(&self, _: ShapeId, shape: &Shape, world_from_shape: &Transform) -> bool {
        pair::overlap(shape, world_from_shape, &self.0)
    }
}

/// Shapes that have their surface within a distance of a point, or hold it; the nearest first, and before it those that
/// hold the point, the deepest first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestTo {
    /// Point in the world, metres.
    pub point: Vec3,
    /// Farthest surface that counts, metres, ≥ 0.
    pub within: f32,
}

/// Nearest point of the surface of a shape of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodySurface {
    /// The body.
    pub body: BodyId,
    /// Number of the shape in its body.
    pub shape: u32,
    /// Point on the surface, in the world, metres.
    pub point: Vec3,
    /// Unit, outward.
    pub normal: Vec3,
    /// Distance from the surface along the normal to the query's point or probe, metres; negative inside.
    pub distance: f32,
}

impl BodySurface {
    fn new(id: ShapeId, surface: SurfacePoint, within: f32) -> Option<Self> {
        let SurfacePoint { point, normal, distance } = surface;
        let finite = point.is_finite() && normal.is_finite();
        let near = distance <= within && finite;
        near.then_some(Self { body: id.body, shape: id.shape, point, normal, distance })
    }
}

impl Reply for BodySurface {
    fn shape(&self) -> ShapeId {
        ShapeId { body: self.body, shape: self.shape }
    }

    fn rank(&self) -> f32 {
        self.distance
    }
}

impl QueryKind for NearestTo {
    type Answer = BodySurface;
}

impl Ask for NearestTo {
    type Found = BodySurface;

    fn reach(&self) -> Option<Reach> {
        (self.point.is_finite() && self.within >= 0.0).then_some(Reach::Near(self.point, self.within))
    }

    fn ask(&self, id: ShapeId, shape: &Shape, world_from_shape: &Transform) -> Option<BodySurface> {
        let surface = shape.nearest_surface(world_from_shape, self.point);
        BodySurface::new(id, surface, self.within)
    }
}

/// Shapes that have their surface within a distance of a probe's, or overlap it; the nearest first, and before it those
/// that overlap, the deepest first.
#[derive(Clone, Debug, PartialEq)]
pub struct NearestToShape {
    /// Object from which distances are measured.
    pub probe: Probe,
    /// Farthest surface that counts, metres, ≥ 0.
    pub within: f32,
}

impl QueryKind for NearestToShape {
    type Answer = BodySurface;
}

impl Ask for NearestToShape {
    type Found = BodySurface;

    fn reach(&self) -> Option<Reach> {
        let usable = self.within >= 0.0 && self.probe.is_valid();
        usable.then(|| Reach::Box(self.probe.aabb().expand(self.within)))
    }

    fn ask(&self, id: ShapeId, shape: &Shape, world_from_shape: &Transform) -> Option<BodySurface> {
        let Gap { distance, normal, on_a: point, .. } =
            pair::gap_within(shape, world_from_shape, &self.probe, self.within)?;
        BodySurface::new(id, SurfacePoint { point, normal, distance }, self.within)
    }
}
