//! Moves a limp character out of walls and floors. Contacts alone would push each body out separately and slowly, and
//! could push the bodies out of a thin wall on both sides.

use super::ground;
use super::limp::Clearing;
use super::tuning::{CLEARING_REACH, CLEARING_SPEED, DEEP, MOST_OBSTACLES, SAME_WAY, SUNK};
use sinew_math::{Transform, Vec3, max, min, normalize_or};
use sinew_physics::{
    BodyId, BodyKind, BodyKinds, BodyPenetration, PenetrationOf, Probe, QueryFilter, Shape, ShapeCast,
    ShapeId, Velocity, World,
};

/// Starts to move all bodies together out of static shapes that they penetrate deeply; `None` if no body is deep, or no
/// displacement leads out.
pub(super) fn begin(own: &[BodyId], world: &mut World) -> Option<Clearing> {
    let momentum: Vec3 = own.iter().map(|&body| world.velocity(body).linear * world.mass(body).mass).sum();
    let back = normalize_or(-momentum, Vec3::ZERO);
    let way = way_out(world, own, back)?;
    let direction = normalize_or(way, Vec3::Y);
    let mut velocities: Vec<Velocity> = own.iter().map(|&body| world.velocity(body)).collect();
    for velocity in &mut velocities {
        // Remove the velocity into the wall.
        velocity.linear -= direction * min(velocity.linear.dot(direction), 0.0);
    }
    own.iter().for_each(|&body| world.set_kind(body, BodyKind::Kinematic));
    Some(Clearing { way, velocities })
}

impl Clearing {
    /// Sets the bodies' velocities for the next step; returns false at the end of the displacement.
    pub fn go_on(&mut self, own: &[BodyId], world: &mut World) -> bool {
        let way = &mut self.way;
        let dt = world.def().dt();
        let left = way.length();
        if left <= 0.0 {
            return false;
        }
        let step = min(left, CLEARING_SPEED * dt);
        let linear = *way * (step / (left * dt));
        *way = if left > step { *way * (1.0 - step / left) } else { Vec3::ZERO };
        for &body in own {
            world.set_velocity(body, Velocity { linear, ..Velocity::default() });
        }
        true
    }

    /// Makes the bodies dynamic at their current positions, with the stored velocities.
    pub fn end(self, own: &[BodyId], world: &mut World) {
        for (&body, &velocity) in own.iter().zip(&self.velocities) {
            world.set_kind(body, BodyKind::Dynamic);
            world.set_velocity(body, velocity);
        }
    }
}

/// Returns the displacement by which the bodies together leave all shapes that they penetrate deeply, world axes,
/// metres; `None` if no body is deep, or no displacement leads out. `back` is the direction from which the bodies came,
/// of length 1, or 0 if they rest.
fn way_out(world: &World, bodies: &[BodyId], back: Vec3) -> Option<Vec3> {
    let placed: Vec<(Shape, Transform)> = bodies.iter().flat_map(|&body| world.shapes(body)).collect();
    let moved = |way: Vec3| {
        placed.iter().map(move |(shape, pose)| {
            let pose = Transform { translation: pose.translation + way, ..*pose };
            Probe::new(shape.clone(), pose)
        })
    };
    let meets = world.shape_def(ShapeId { body: *bodies.first()?, shape: 0 }).filter;
    let filter = QueryFilter { meets, ..QueryFilter::of(BodyKinds::STATIC) };
    let (mut way, mut limit) = (Vec3::ZERO, DEEP);
    for _ in 0..MOST_OBSTACLES {
        let Some(deepest) = deepest((world, filter), moved(way), limit) else { break };
        let obstacle = ShapeId { body: deepest.body, shape: deepest.shape };
        let out: Vec<(Vec3, f32)> = directions(world, moved(way), obstacle)
            .into_iter()
            .filter_map(|direction| {
                let mut exits = moved(way).map(|probe| exit(world, probe, obstacle, direction));
                let length = exits.try_fold(0.0, |most, exit| Some(max(most, exit?)))?;
                Some((direction, length))
            })
            .collect();
        let comes = |&(direction, _): &(Vec3, f32)| direction.dot(back) > 0.5;
        let by_motion = out.iter().copied().find(comes);
        let nearer = |a: (Vec3, f32), b: (Vec3, f32)| if b.1 < a.1 { b } else { a };
        let (direction, length) = by_motion.or(out.into_iter().reduce(nearer))?;
        way += direction * length;
        limit = SUNK;
    }
    (way.length() > 0.0 && way.length() <= CLEARING_REACH).then_some(way)
}

/// Returns the deepest overlap of the probes with a static shape that pushes; `None` if no overlap is deeper than
/// `limit` metres.
fn deepest(
    (world, filter): (&World, QueryFilter<'_>),
    probes: impl Iterator<Item = Probe>,
    limit: f32,
) -> Option<BodyPenetration> {
    let query = world.query().filter(filter).accept(ground::pushes(world));
    let deeper = |a: BodyPenetration, b: BodyPenetration| if b.depth > a.depth { b } else { a };
    let found =
        probes.filter_map(|probe| query.first(&PenetrationOf(probe))).filter(|found| found.depth > limit);
    found.reduce(deeper)
}

/// Returns the directions in which the probes leave a shape by the shortest displacement, and the opposite directions,
/// without duplicates.
fn directions(world: &World, probes: impl Iterator<Item = Probe>, obstacle: ShapeId) -> Vec<Vec3> {
    let only = |body, shape| obstacle == ShapeId { body, shape };
    let mut directions: Vec<Vec3> = Vec::new();
    for found in probes.filter_map(|probe| world.query().accept(only).first(&PenetrationOf(probe))) {
        for direction in [found.direction, -found.direction] {
            if !directions.iter().any(|known| known.dot(direction) > SAME_WAY) {
                directions.push(direction);
            }
        }
    }
    directions
}

/// Returns the distance along `direction` at which a probe leaves a shape, metres; `None` if the probe is still inside
/// at [`CLEARING_REACH`].
fn exit(world: &World, mut probe: Probe, obstacle: ShapeId, direction: Vec3) -> Option<f32> {
    let reach = direction * CLEARING_REACH;
    probe.world_from_shape.translation += reach;
    let only = |body, shape| obstacle == ShapeId { body, shape };
    match world.query().accept(only).first(&ShapeCast { probe, translation: -reach }) {
        None => Some(0.0),
        Some(hit) if hit.start.is_some() => None,
        Some(hit) => Some(CLEARING_REACH * (1.0 - hit.fraction)),
    }
}
