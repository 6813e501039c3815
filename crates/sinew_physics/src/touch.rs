//! `collide` and `touch`: manifolds of all near pairs, then who began and stopped touching, and who wakes.

use crate::arena::Arena;
use crate::body::{Body, Rest};
use crate::collide::parts::Parts;
use crate::collide::{Manifold, Motion, collide as narrow_phase};
use crate::contact::{Contact, ContactKey, pairs_of, slop};
use crate::def::BodyKind;
use crate::field::Fields;
use crate::id::{BodyId, GroupId, JointId};
use crate::joint::Joint;
use crate::shape::Sensing;
use crate::slices::for_each_mut;
use crate::step::StepContext;
use sinew_math::{max, min};

/// What happened in the last step, in the order of body indices.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// Pairs of bodies that began to touch.
    pub begin: Vec<(BodyId, BodyId)>,
    /// Pairs of bodies that stopped.
    pub end: Vec<(BodyId, BodyId)>,
    /// Pairs of bodies of which one began to be inside a sensor of the other.
    pub sensor_begin: Vec<(BodyId, BodyId)>,
    /// Likewise, ended.
    pub sensor_end: Vec<(BodyId, BodyId)>,
    /// Bodies whose state became non-finite: rolled back to the step before, stopped and taken out of the simulation.
    pub quarantined: Vec<BodyId>,
    /// Groups with particles whose state became non-finite: those stopped where they were before the step.
    pub rolled_back: Vec<GroupId>,
    /// Joints that broke, in the order of joint indices. They are there, but disabled.
    pub broken: Vec<JointId>,
}

/// `collide`: manifolds at the poses of the step's beginning, with points as far away as the step may close.
pub(crate) fn collide(
    bodies: &Arena<Body>,
    contacts: &mut Vec<Contact>,
    parts: &mut Parts,
    context: &StepContext<'_>,
) {
    for_each_mut(context.runner, contacts, |contact| {
        let (a, b) = (bodies.at(contact.key.a), bodies.at(contact.key.b));
        if !a.can_touch() && !b.can_touch() {
            return;
        }
        let (sa, sb) = (contact.key.shape_a as usize, contact.key.shape_b as usize);
        let (shape_a, shape_b) = (&a.shapes[sa].shape, &b.shapes[sb].shape);
        contact.sensor = a.shapes[sa].sensing == Sensing::Sensor || b.shapes[sb].sensing == Sensing::Sensor;
        if shape_a.surface().is_some() || shape_b.surface().is_some() {
            return;
        }
        let margin = margin(a, b, contact.key, context.dt);
        let mut manifold = Manifold::default();
        narrow_phase(
            shape_a,
            &a.world_from_shape(sa),
            shape_b,
            &b.world_from_shape(sb),
            margin,
            &mut manifold,
        );
        contact.memory = contact.memory.matched(&contact.manifold, &manifold);
        contact.manifold = manifold;
    });
    parts.update(bodies, contacts, context, |contact| surface_motion(bodies, contact, context.dt));
}

/// How far apart points of two shapes are looked for, metres.
fn margin(a: &Body, b: &Body, key: ContactKey, dt: f32) -> f32 {
    let (shape_a, shape_b) = (&a.shapes[key.shape_a as usize].shape, &b.shapes[key.shape_b as usize].shape);
    let extent = min(shape_a.smallest_extent(), shape_b.smallest_extent());
    // Beside their approach: two that move together may not do so any more once one of them is hit.
    let (va, vb) = (a.velocity.linear, b.velocity.linear);
    let approach = max((va - vb).length(), max(va.length(), vb.length()))
        + a.velocity.angular.length() * a.reach()
        + b.velocity.angular.length() * b.reach();
    max(4.0 * slop(extent), approach * dt)
}

/// How a pair moves of which one is a surface, the other toward the surface; `None` of other pairs, and of those at rest.
fn surface_motion(bodies: &Arena<Body>, contact: &Contact, dt: f32) -> Option<Motion> {
    let key = contact.key;
    let (a, b) = (bodies.at(key.a), bodies.at(key.b));
    if !a.can_touch() && !b.can_touch() {
        return None;
    }
    let is_surface = |body: &Body, shape: u32| body.shapes[shape as usize].shape.surface().is_some();
    let center = |body: &Body, shape: u32| body.world_from_shape(shape as usize).translation;
    let (mover, ground, at) = match (is_surface(a, key.shape_a), is_surface(b, key.shape_b)) {
        (true, _) => (b, a, center(b, key.shape_b)),
        (_, true) => (a, b, center(a, key.shape_a)),
        _ => return None,
    };
    let speed = |body: &Body| body.velocity.linear + body.velocity.angular.cross(at - body.center());
    Some(Motion { velocity: speed(mover) - speed(ground), dt, margin: margin(a, b, key, dt) })
}

/// `touch`: events, and waking of what an awake body touches or attracts, or a moving kinematic one holds.
pub(crate) fn touch(
    bodies: &mut Arena<Body>,
    joints: &Arena<Joint>,
    contacts: &mut [Contact],
    fields: &Fields<'_>,
    events: &mut Events,
) {
    for list in [&mut events.begin, &mut events.end] {
        list.clear();
        // All of them: how many come at once differs from hit to hit.
        list.reserve(contacts.len());
    }
    for pair in pairs_of(contacts) {
        let (a, b) = (pair[0].key.a, pair[0].key.b);
        if !pair[0].sensor {
            note_change(bodies, pair, &mut events.begin, &mut events.end);
        }
        if pair.iter().any(Contact::pushes) {
            wake_touched(bodies, a, b);
            wake_touched(bodies, b, a);
        }
    }
    for (_, joint) in joints.iter().filter(|(_, joint)| joint.is_enabled()) {
        for (mover, held) in [(joint.a, joint.b), (joint.b, joint.a)] {
            let body = bodies.at(mover);
            if body.kind == BodyKind::Kinematic && !body.velocity.is_zero() {
                wake(bodies, held);
            }
        }
    }
    while let Some(attracted) = fields.next_to_wake(bodies) {
        wake(bodies, attracted);
    }
}

/// Puts a pair, given by its parts, that began or ceased to touch since it was last looked at into one of the lists.
pub(crate) fn note_change(
    bodies: &Arena<Body>,
    pair: &mut [Contact],
    begin: &mut Vec<(BodyId, BodyId)>,
    end: &mut Vec<(BodyId, BodyId)>,
) {
    let mut points = pair.iter().flat_map(|part| part.manifold.points());
    let touching = points.any(|point| point.separation <= 0.0);
    if touching != pair[0].touching {
        let list = if touching { begin } else { end };
        list.push((id(bodies, pair[0].key.a), id(bodies, pair[0].key.b)));
    }
    for part in pair {
        part.touching = touching;
    }
}

pub(crate) fn id(bodies: &Arena<Body>, index: u32) -> BodyId {
    BodyId { index, generation: bodies.generation(index) }
}

fn wake_touched(bodies: &mut Arena<Body>, mover: u32, sleeper: u32) {
    let body = bodies.at(mover);
    let wakes = body.is_active() || (body.kind == BodyKind::Kinematic && body.can_touch());
    if wakes {
        wake(bodies, sleeper);
    }
}

/// Wakes a body and everything it fell asleep with.
pub(crate) fn wake(bodies: &mut Arena<Body>, index: u32) {
    let body = bodies.at_mut(index);
    match body.rest {
        Rest::Awake { .. } => {}
        Rest::Asleep { island } => {
            for (_, other) in bodies.iter_mut() {
                if other.rest == (Rest::Asleep { island }) {
                    other.rest = Rest::Awake { calm: 0.0 };
                }
            }
        }
    }
}
