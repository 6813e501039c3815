//! Backstops of a sheet: balls behind the rest positions of its particles, each fixed to the nearest body.

use crate::def::RagdollDef;
use sinew_anim::Garment;
use sinew_math::{Vec3, direction};
use sinew_physics::particles::GroupDef;

/// Backstop of a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Backing {
    pub particle: usize,
    /// Body of the ragdoll to which the ball is fixed.
    pub body: usize,
    /// Centre of the ball in the frame of that body, metres.
    pub center: Vec3,
    pub radius: f32,
}

/// Returns the backstops of a sheet's particles at rest (character space). Held particles and particles where the sheet
/// has no area get none. The list is empty for a garment without backstops. Bodies that pass through the sheet get
/// none, because the sheet does not move with them.
pub(super) fn backings(
    garment: &Garment,
    group: &GroupDef,
    is_held: &[bool],
    ragdoll: &RagdollDef,
    passed: &[usize],
) -> Vec<Backing> {
    let Some(backstop) = garment.backstop else { return Vec::new() };
    let mut normals = vec![Vec3::ZERO; group.particles.len()];
    for &face in &group.faces {
        let [a, b, c] = face.map(|at| group.particles[at as usize].position);
        face.iter().for_each(|&corner| normals[corner as usize] += (b - a).cross(c - a));
    }
    let back = |(particle, &normal): (usize, &Vec3)| {
        let place = group.particles[particle].position;
        let (body, outward) = nearest(ragdoll, passed, place)?;
        let normal = direction(normal)?;
        // Take the direction from the body, because the winding of a sheet is arbitrary and a lining faces the other
        // way.
        let outward = if normal.dot(outward) < 0.0 { -normal } else { normal };
        let center = place - outward * (backstop.distance + backstop.radius + garment.radius);
        let center = ragdoll.bodies[body].character_from_body.inverse_point(center);
        Some(Backing { particle, body, center, radius: backstop.radius })
    };
    normals.iter().enumerate().filter(|(particle, _)| !is_held[*particle]).filter_map(back).collect()
}

/// Returns the body nearest to a position, among those that do not pass through the sheet, and the direction away from
/// this body.
fn nearest(ragdoll: &RagdollDef, passed: &[usize], place: Vec3) -> Option<(usize, Vec3)> {
    let mut nearest: Option<(f32, usize, Vec3)> = None;
    for (index, body) in ragdoll.bodies.iter().enumerate().filter(|(body, _)| !passed.contains(body)) {
        let (distance, outward) = body.shape.signed_distance(&body.character_from_body, place);
        if nearest.is_none_or(|(least, ..)| distance < least) {
            nearest = Some((distance, index, outward));
        }
    }
    nearest.map(|(_, body, outward)| (body, outward))
}
