//! `store`, `finalize` and `continuous`: the world takes what the islands computed.

use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::Body;
use crate::body::contact_rule::ContactRule;
use crate::body::def::BodyKind;
use crate::body::shape::Sensing;
use crate::body::surface::Surface;
use crate::contact::events::Events;
use crate::contact::filter::PairFilter;
use crate::contact::parted::PartedPairs;
use crate::contact::proxies::{Owner, Proxies};
use crate::contact::{Contact, ContactKey};
use crate::context::StepContext;
use crate::joint::Joint;
use crate::joint::def::JointState;
use crate::particles::ParticleGroup;
use crate::ray::Ray;
use crate::solver::{SolvedBody, SolvedJoint};
use crate::step::islands::Islands;
use crate::step::pairs::BroadPhase;
use crate::tree::Sweep;
use sinew_math::{Transform, Vec3, normalize_or};

/// `store`: impulses and joint forces that the next step starts from; particle groups return to the world, where what is not
/// finite is rolled back; joints that were loaded too much break.
pub(crate) fn store(
    islands: &mut Islands,
    joints: &mut Arena<Joint>,
    parted: &mut PartedPairs,
    contacts: &mut [Contact],
    groups: &mut Arena<ParticleGroup>,
    events: &mut Events,
    context: &StepContext<'_>,
) {
    islands.release(groups);
    events.rolled_back.clear();
    for (id, group) in groups.entries_mut() {
        if group.roll_back() {
            events.rolled_back.push(id);
        }
    }
    let solution = islands.solution();
    for solved in &solution.contacts {
        let contact = &mut contacts[solved.index as usize];
        if let Some(manifold) = solved.found {
            let of_solved = manifold.points().iter().map(|point| point.feature);
            if contact.manifold.points().iter().map(|point| point.feature).ne(of_solved) {
                contact.kept.drop();
            }
            contact.manifold = manifold;
        }
        contact.memory = solved.memory;
    }
    events.broken.clear();
    for &SolvedJoint { index, limits, force, warm_impulse, saturated, mass, reaction } in &solution.joints {
        let id = joints.id(index);
        let joint = joints.at_mut(index);
        joint.limits = limits;
        joint.force = force;
        joint.warm_impulse = warm_impulse;
        joint.saturated = saturated;
        joint.mass = mass;
        joint.reaction = reaction.map(|impulse| impulse / context.dt);
        if joint.is_overloaded() {
            joint.state = JointState::Disabled;
            events.broken.push(id);
        }
    }
    if !events.broken.is_empty() {
        events.broken.sort_unstable();
        parted.invalidate();
    }
}

/// `finalize`: poses and velocities; a body whose state is not finite keeps its old pose, stops and is quarantined.
/// Kinematic bodies move as their velocity says; forces of the step are used up.
pub(crate) fn finalize(
    islands: &Islands,
    bodies: &mut Arena<Body>,
    activity: &mut Activity,
    events: &mut Events,
    context: &StepContext<'_>,
) {
    events.quarantined.clear();
    events.limited.clear();
    for SolvedBody { index, pose, velocity, is_limited } in &islands.solution().bodies {
        let body = bodies.at_mut(*index);
        body.previous = body.world_from_principal;
        body.force = Vec3::ZERO;
        body.torque = Vec3::ZERO;
        if pose.is_finite() && velocity.linear.is_finite() && velocity.angular.is_finite() {
            body.world_from_principal = *pose;
            body.velocity = *velocity;
            if *is_limited {
                let id = bodies.id(*index);
                events.limited.push(id);
            }
        } else {
            body.velocity = Default::default();
            body.quarantined = true;
            activity.note(*index, body);
            let id = bodies.id(*index);
            events.quarantined.push(id);
        }
    }
    for &index in activity.kinematic() {
        let body = bodies.at_mut(index);
        body.previous = body.world_from_principal;
        body.world_from_principal = body.carried(context.h, context.substeps);
    }
    events.limited.sort_unstable();
}

/// `continuous`: a body without joints whose centre passed through a static shape within the step is put back to where
/// its core touches. Speculative contacts stop nearly everything before; this is for what they miss. Jointed bodies are
/// left to the speculative contacts: moving one link would tear its joints. With that all poses are
/// final, and the trees of bounds follow.
pub(crate) fn continuous(
    islands: &Islands,
    bodies: &mut Arena<Body>,
    activity: &Activity,
    broad: &mut BroadPhase,
    filter: PairFilter<'_>,
    context: &StepContext<'_>,
) {
    for island in islands.iter().filter(|island| island.joints.is_empty()) {
        for &index in island.bodies {
            let body = bodies.at(index);
            let core = core_radius(body);
            let motion = body.center() - body.previous.translation;
            if core == 0.0 || motion.length() <= core {
                continue;
            }
            let ray = Ray { origin: body.previous.translation, direction: motion };
            if let Some(fraction) = first_static_hit(bodies, &broad.proxies, filter, index, &ray) {
                let back = sinew_math::max(fraction - core / motion.length(), 0.0);
                let center = ray.at(back);
                bodies.at_mut(index).world_from_principal.translation = center;
            }
        }
    }
    broad.proxies.follow(bodies, activity.movers(), context.dt);
}

/// Radius of the largest ball about the centre of mass that surely lies inside a body of one shape; 0 if none.
fn core_radius(body: &Body) -> f32 {
    match body.shapes.as_slice() {
        [only] if only.principal_from_shape.translation.length() < 1e-4 => only.shape.inner_radius(),
        _ => 0.0,
    }
}

fn first_static_hit(
    bodies: &Arena<Body>,
    proxies: &Proxies,
    filter: PairFilter<'_>,
    mover: u32,
    ray: &Ray,
) -> Option<f32> {
    let mut first: Option<f32> = None;
    let own = bodies.at(mover).shapes.len() as u32;
    let sweep = Sweep { origin: ray.origin, direction: ray.direction, half_extents: Vec3::ZERO, limit: 1.0 };
    proxies.along(&sweep, |Owner { body: index, shape }| {
        let body = bodies.at(index);
        let frame = body.world_from_shape(shape as usize);
        let meets = |i| filter.lets_meet(bodies, ContactKey::new((mover, i), (index, shape)));
        if body.kind == BodyKind::Static
            && stops(body.surface(shape as usize), &frame, ray)
            && (0..own).any(meets)
            && let Some(hit) = body.shapes[shape as usize].shape.cast_ray(&frame, ray)
            // A start inside is an overlap that the contacts are working on.
            && hit.fraction > 0.0
            && first.is_none_or(|first| hit.fraction < first)
        {
            first = Some(hit.fraction);
        }
        first.unwrap_or(1.0)
    });
    first
}

/// Whether a shape surely stops what comes along a ray. One that a modifier may open is left to the speculative contacts.
fn stops(s: &Surface, frame: &Transform, ray: &Ray) -> bool {
    let solid = s.sensing == Sensing::Solid;
    solid
        && match s.rule {
            ContactRule::Push => true,
            ContactRule::Ghost | ContactRule::Modified { .. } => false,
            ContactRule::OneWay(one_way) => {
                one_way.holds(normalize_or(frame.rotation.inverse() * -ray.direction, Vec3::Y))
            }
        }
}
