//! Tests of a probe against one shape of the world: the interface between queries and shape pairs.

use super::probe::Probe;
use super::triangles;
use crate::body::shape::Shape;
use crate::boxes::Penetration;
use crate::convex::{Gap, ShapeHit, cast_shape, gap};
use sinew_math::{Transform, Vec3};

/// Returns the gap from the shape to the probe. For a mesh or height field, `None` if the gap is beyond `within`,
/// metres.
pub(super) fn gap_within(
    shape: &Shape,
    world_from_shape: &Transform,
    probe: &Probe,
    within: f32,
) -> Option<Gap> {
    match shape.surface() {
        Some(surface) => triangles::gap_within(&surface, world_from_shape, probe, within),
        None => gap(shape, world_from_shape, &probe.shape, &probe.world_from_shape),
    }
}

/// True if the shape and the probe have a point in common.
pub(super) fn overlap(shape: &Shape, world_from_shape: &Transform, probe: &Probe) -> bool {
    penetration(shape, world_from_shape, probe).is_some()
}

/// Returns the depth of the overlap and the shortest way of the probe out of the shape, if they overlap.
pub(super) fn penetration(shape: &Shape, world_from_shape: &Transform, probe: &Probe) -> Option<Penetration> {
    let gap = gap_within(shape, world_from_shape, probe, 0.0)?;
    (gap.distance <= 0.0).then_some(Penetration { depth: -gap.distance, direction: gap.normal })
}

/// Returns the first touch of a moving probe with the shape.
pub(super) fn cast(
    shape: &Shape,
    world_from_shape: &Transform,
    probe: &Probe,
    way: Vec3,
) -> Option<ShapeHit> {
    match shape.surface() {
        Some(surface) => triangles::cast(&surface, world_from_shape, probe, way),
        None => cast_shape(&probe.shape, &probe.world_from_shape, way, shape, world_from_shape),
    }
}
