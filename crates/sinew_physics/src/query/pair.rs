//! A probe against one shape of the world.

use super::probe::Probe;
use crate::boxes::Penetration;
use crate::collide::{Manifold, collide};
use crate::shape::Shape;
use sinew_math::{Transform, max};

/// Whether they have a point in common.
pub(super) fn overlap(shape: &Shape, world_from_shape: &Transform, probe: &Probe) -> bool {
    penetration(shape, world_from_shape, probe).is_some()
}

/// The shortest way by which the probe gets out of the shape, if they overlap.
pub(super) fn penetration(shape: &Shape, world_from_shape: &Transform, probe: &Probe) -> Option<Penetration> {
    let mut manifold = Manifold::default();
    collide(shape, world_from_shape, &probe.shape, &probe.world_from_shape, 0.0, &mut manifold);
    let deepest = manifold.points().iter().map(|point| -point.separation).reduce(max)?;
    Some(Penetration { depth: max(deepest, 0.0), direction: manifold.normal })
}
