//! Position queries: shapes that contain a point, shapes that overlap a probe, penetration depths, and nearest shapes.

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

/// Finds the shapes that contain a point (world, metres), inside or on the surface; by body and shape.
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

/// Finds the shapes that a probe overlaps, including touching and containing ones, by body and shape.
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

/// Finds the depth of a probe in each shape that it overlaps; the deepest first.
#[derive(Clone, Debug, PartialEq)]
pub struct PenetrationOf(pub Probe);

/// Depth of a probe in a shape, and the shortest way out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPenetration {
    /// The body.
    pub body: BodyId,
    /// Number of the shape in its body.
    pub shape: u32,
    /// Depth of the probe, metres, ≥ 0; 0 if it only touches.
    pub depth: f32,
    /// Unit direction of the shortest way out, world: after a displacement by `direction * depth`, the probe only
    /// touches the shape. The way leads out of this shape alone, and may lead into another one.
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

/// Finds the shapes that contain a point, or whose surface is within a distance of the point. Shapes that contain it
/// come first, the deepest first; then the others, the nearest first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestTo {
    /// Point in the world, metres.
    pub point: Vec3,
    /// Largest distance of a surface that counts, metres, ≥ 0.
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
    /// Unit normal, outward, world.
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

/// Finds the shapes that overlap a probe, or whose surface is within a distance of the probe. Overlapping shapes come
/// first, the deepest first; then the others, the nearest first.
#[derive(Clone, Debug, PartialEq)]
pub struct NearestToShape {
    /// Probe from which distances are measured.
    pub probe: Probe,
    /// Largest distance of a surface that counts, metres, ≥ 0.
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
