//! What a character stands on.

use sinew_math::Vec3;
use sinew_physics::ray::Ray;
use sinew_physics::{BodyKinds, QueryFilter, World};

/// The highest step that a walking character climbs, metres.
pub(super) const HIGHEST_STEP: f32 = 0.45;
/// How far down the ground is sought, metres.
const DEPTH: f32 = 100.0;

/// Height of the static world under a point, sought from `above` metres over it.
pub(super) fn below(world: &World, point: Vec3, above: f32) -> Option<f32> {
    let ray = Ray { origin: point + Vec3::Y * above, direction: Vec3::Y * -(above + DEPTH) };
    let hit = world.query().filter(QueryFilter::of(BodyKinds::STATIC)).first(&ray)?;
    // A ray that starts inside says nothing about the height.
    hit.start.is_none().then_some(hit.point.y)
}
