//! Measures of cloth that a figure wears.

use sinew::math::max;
use sinew::physics::World;
use sinew::physics::particles::{AttachmentTarget, ParticleGroup};

/// Mean over the first so many springs, the threads, of how far their lengths are from those at rest, as a share.
pub(super) fn stretch(group: &ParticleGroup, threads: usize) -> f32 {
    let positions = group.positions();
    let off = group.springs()[..threads].iter().map(|thread| {
        let length = (positions[thread.b as usize] - positions[thread.a as usize]).length();
        (length / thread.rest_length - 1.0).abs()
    });
    off.sum::<f32>() / threads as f32
}

/// Distance of the particle that is farthest from where a body holds it, metres.
pub(super) fn torn(world: &World, group: &ParticleGroup) -> f32 {
    let off = group.attachments().iter().map(|held| match held.target {
        AttachmentTarget::Body { body, point } => {
            (world.transform(body).point(point) - group.positions()[held.particle as usize]).length()
        }
        AttachmentTarget::World(_) => f32::INFINITY,
    });
    off.fold(0.0, max)
}
