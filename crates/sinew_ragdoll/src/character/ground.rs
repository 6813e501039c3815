//! Ground under a character.

use crate::character::tuning::{
    BORNE, GROUND_DEPTH, HIGHEST_STEP, LEAST_TREAD, LEVEL_GROUND, LIES_LOW, LIES_ON, LYING_SEARCH,
    STEEPEST_GROUND,
};
use crate::def::RagdollDef;
use sinew_math::{Rotation, Vec3, max, min, trig};
use sinew_physics::ray::Ray;
use sinew_physics::{
    BodyContact, BodyHit, BodyId, BodyKind, BodyKinds, ContactRule, Effect, QueryFilter, ShapeId, Velocity,
    World,
};

/// Returns the height of the supporting surface under a point, searched from `above` metres over the point. A character
/// outside of a world (`own` is `None`) finds only the static world; otherwise all bodies count except the character's
/// own, kinematic bodies of other characters, and detached limbs.
pub(super) fn below(world: &World, point: Vec3, above: f32, own: Option<&[BodyId]>) -> Option<f32> {
    found_below(world, point, above, own).map(|hit| hit.point.y)
}

/// Returns the hit of [`below`], with the supporting body.
pub(super) fn found_below(world: &World, point: Vec3, above: f32, own: Option<&[BodyId]>) -> Option<BodyHit> {
    // A ray that starts inside a shape does not find the height of the surface.
    first_below(world, point, above, own).filter(|hit| hit.start.is_none())
}

fn first_below(world: &World, point: Vec3, above: f32, own: Option<&[BodyId]>) -> Option<BodyHit> {
    let ray = Ray { origin: point + Vec3::Y * above, direction: Vec3::Y * -(above + GROUND_DEPTH) };
    match own {
        None => world.query().filter(QueryFilter::of(BodyKinds::STATIC)).first(&ray),
        Some(own) => bearer(world, &ray, own),
    }
}

/// Returns the height of the ground under a point like [`below`], but ignores detached limbs, other characters, and
/// dynamic bodies lighter than `least` kg.
pub(super) fn firm_below(
    world: &World,
    point: Vec3,
    above: f32,
    own: Option<&[BodyId]>,
    least: f32,
) -> Option<f32> {
    let hit = found_below(world, point, above, own)?;
    is_firm(world, hit.body, least).then_some(hit.point.y)
}

/// Returns true if a body can support a character: it is neither another character's body nor a dynamic body lighter
/// than `least` kg.
pub(super) fn is_firm(world: &World, body: BodyId, least: f32) -> bool {
    let is_heavy = world.kind(body) != BodyKind::Dynamic || world.mass(body).mass >= least;
    is_heavy && world.body_owner(body).is_none()
}

pub(super) fn bearer(world: &World, ray: &Ray, own: &[BodyId]) -> Option<BodyHit> {
    let bears = |body: BodyId, shape: u32| {
        !matches!(world.contact_rule(ShapeId { body, shape }), ContactRule::Ghost | ContactRule::Yields(_))
    };
    world.query().filter(QueryFilter::without(own)).accept(bears).first(ray)
}

/// Returns true if a character without a mover has walked over an edge: there is ground near the first place, within
/// `radius` of it, and the ground within `radius` of the second place is absent, or lower by more than the highest
/// step.
pub(super) fn ends_between(
    world: &World,
    [from, to]: [Vec3; 2],
    radius: f32,
    own: Option<&[BodyId]>,
) -> bool {
    let height = |point: Vec3| {
        let hit = first_below(world, point, HIGHEST_STEP, own)?;
        // A point inside a wall counts as ground, because there is no edge.
        Some(if hit.start.is_some() { point.y } else { hit.point.y })
    };
    let highest = |at: Vec3| {
        let aside = [Vec3::ZERO, Vec3::X, -Vec3::X, Vec3::Z, -Vec3::Z].map(|aside| at + aside * radius);
        aside.into_iter().filter_map(height).reduce(max)
    };
    let Some(stood) = highest(from).filter(|&height| from.y - height <= HIGHEST_STEP) else { return false };
    highest(to).is_none_or(|height| height < stood - HIGHEST_STEP)
}

/// Returns a query condition that accepts only shapes whose contacts push: no sensors, and no bodies that others pass
/// through or that yield.
pub(super) fn pushes(world: &World) -> impl Fn(BodyId, u32) -> bool + '_ {
    |body, shape| {
        let rule = world.contact_rule(ShapeId { body, shape });
        matches!(rule, ContactRule::Push | ContactRule::Modified { .. })
    }
}

/// Motion of the ground under a body; by default the ground is at rest.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct GroundMotion {
    velocity: Velocity,
    center: Vec3,
}

impl GroundMotion {
    /// Returns the velocity of the ground's surface at a point, m/s.
    pub fn at(&self, point: Vec3) -> Vec3 {
        self.velocity.at(point - self.center)
    }

    /// Returns the angular velocity of the ground, rad/s.
    pub fn angular(&self) -> Vec3 {
        self.velocity.angular
    }
}

/// Returns the motion of the body under the pelvis, which is the first of `bodies`.
pub(super) fn motion_below(world: &World, bodies: &[BodyId]) -> GroundMotion {
    let Some(&pelvis) = bodies.first() else { return GroundMotion::default() };
    let ray = Ray { origin: world.center_of_mass(pelvis), direction: Vec3::Y * -LIES_ON };
    let Some(hit) = bearer(world, &ray, bodies) else { return GroundMotion::default() };
    GroundMotion { velocity: world.velocity(hit.body), center: world.center_of_mass(hit.body) }
}

/// Returns true if the ground supports a lying character: its pelvis, the first of `own`, is close above the ground, or
/// firm ground carries enough of its weight.
pub(super) fn bears(def: &RagdollDef, own: &[BodyId], world: &World) -> bool {
    let Some(&pelvis) = own.first() else { return true };
    let (at, low) = (world.center_of_mass(pelvis), LIES_LOW * def.height);
    if found_below(world, at, LYING_SEARCH, Some(own)).is_some_and(|hit| at.y - hit.point.y < low) {
        return true;
    }
    // Kinematic bodies do not count, because they may be the arms of a character that carries this one.
    let least = LEAST_TREAD * def.total_mass;
    let bears = |body| world.kind(body) != BodyKind::Kinematic && is_firm(world, body, least);
    let lift = |contact: &BodyContact| {
        let [a, b] = [contact.a.body, contact.b.body];
        let sign = match (own.contains(&a), own.contains(&b)) {
            (true, false) if bears(b) => -1.0,
            (false, true) if bears(a) => 1.0,
            _ => return 0.0,
        };
        sign * (contact.normal.y * contact.impulse() + contact.friction.y)
    };
    let pushing = world.contacts().filter(|contact| contact.effect == Effect::Push);
    let borne: f32 = pushing.map(|contact| lift(&contact)).sum();
    borne > BORNE * def.total_mass * world.def().gravity.length() * world.def().dt()
}

/// Fits a plane to the heights of the ground under these points and returns the rotation from the vertical to its
/// normal, scaled axis. Stairs act as the slope through their treads. `least`: as for [`firm_below`].
pub(super) fn slope(world: &World, points: &[Vec3], own: Option<&[BodyId]>, least: f32) -> Vec3 {
    let under = |&point: &Vec3| {
        firm_below(world, point, LYING_SEARCH, own, least).map(|y| Vec3::new(point.x, y, point.z))
    };
    let places: Vec<Vec3> = points.iter().filter_map(under).collect();
    if places.len() < 3 {
        return Vec3::ZERO;
    }
    let middle = places.iter().fold(Vec3::ZERO, |sum, &place| sum + place) / places.len() as f32;
    // Least squares: y = a x + b z.
    let (mut xx, mut xz, mut zz, mut xy, mut zy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for d in places.iter().map(|&place| place - middle) {
        (xx, xz, zz) = (xx + d.x * d.x, xz + d.x * d.z, zz + d.z * d.z);
        (xy, zy) = (xy + d.x * d.y, zy + d.z * d.y);
    }
    // Collinear points do not determine the slope across them; that slope is zero.
    let ridge = 0.01 * (xx + zz) + 1e-6;
    let (xx, zz) = (xx + ridge, zz + ridge);
    let det = xx * zz - xz * xz;
    let (a, b) = ((xy * zz - zy * xz) / det, (zy * xx - xy * xz) / det);
    let steep = trig::atan2((a * a + b * b).sqrt(), 1.0);
    if steep < LEVEL_GROUND {
        return Vec3::ZERO;
    }
    let normal = Vec3::new(-a, 1.0, -b).normalize();
    let turn = Rotation::from_arc(Vec3::Y, normal).to_scaled_axis();
    turn * (max(min(steep, STEEPEST_GROUND), 0.0) / steep)
}
