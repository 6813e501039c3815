//! `collide` and `touch`: manifolds of all near pairs, then what they do, who began and stopped touching, and who wakes.

use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::Body;
use crate::collide::parts::Parts;
use crate::collide::{Manifold, Motion, collide as narrow_phase};
use crate::contact::{Contact, ContactKey, Effect, pairs_of, slop};
use crate::contact_rule::ContactRule;
use crate::def::BodyKind;
use crate::events::Events;
use crate::field::Fields;
use crate::id::BodyId;
use crate::joint::Joint;
use crate::meetings::{Meetings, Told, Touches, lie_still, touch_of};
use crate::shape::Sensing;
use crate::slices::for_each_mut;
use crate::step::StepContext;
use sinew_math::{max, min};

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
    for_each_mut(context.runner, contacts, |contact| {
        let (a, b) = (bodies.at(contact.key.a), bodies.at(contact.key.b));
        contact.approach = 0.0;
        if a.can_touch() || b.can_touch() {
            contact.approach = approach_of(a, b, &contact.manifold);
            rule(contact, a, b);
        }
    });
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

/// How fast the points come in, m/s; the fastest counts.
fn approach_of(a: &Body, b: &Body, manifold: &Manifold) -> f32 {
    manifold.points().iter().fold(0.0, |fastest, point| {
        let p = point.position;
        let relative = b.velocity.at(p - b.center()) - a.velocity.at(p - a.center());
        max(fastest, -relative.dot(manifold.normal))
    })
}

/// What the contact does, as far as its shapes say.
fn rule(contact: &mut Contact, a: &Body, b: &Body) {
    let (sa, sb) = (contact.key.shape_a as usize, contact.key.shape_b as usize);
    contact.effect = Effect::Push;
    contact.one_way = false;
    let normal = contact.manifold.normal;
    for (body, shape, away) in [(a, sa, normal), (b, sb, -normal)] {
        match body.surface(shape).rule {
            ContactRule::Push | ContactRule::Modified { .. } => {}
            ContactRule::Ghost => contact.effect = Effect::Pass,
            ContactRule::OneWay(one_way) => {
                contact.one_way = true;
                let away = body.world_from_shape(shape).rotation.inverse() * away;
                if contact.manifold.count > 0 && !one_way.holds(away) {
                    contact.effect = Effect::Pass;
                }
            }
        }
    }
    if [a.surface(sa), b.surface(sb)].into_iter().any(|s| s.sensing == Sensing::Sensor) {
        contact.effect = Effect::Sense;
    }
}

/// `touch`: what contacts do, events, and waking of what an awake body touches or attracts, or a moving kinematic one holds.
/// What wakes comes with its contacts.
pub(crate) fn touch(
    bodies: &mut Arena<Body>,
    joints: &Arena<Joint>,
    contacts: &mut Vec<Contact>,
    activity: &mut Activity,
    fields: &Fields<'_>,
    meetings: &mut Meetings,
    events: &mut Events,
) {
    let touching = &mut meetings.touching;
    touching.start(contacts.len());
    for pair in pairs_of(contacts) {
        agree(pair);
        note(bodies, pair, touching);
        if pair.iter().any(Contact::pushes) {
            let key = pair[0].key;
            wake_touched(bodies, activity, key.a, key.b);
            wake_touched(bodies, activity, key.b, key.a);
        }
    }
    touching.tell(
        bodies,
        Told { bodies: &mut events.begin, shapes: &mut events.shapes_begin },
        Told { bodies: &mut events.end, shapes: &mut events.shapes_end },
    );
    wake_held(bodies, joints, activity);
    while let Some(attracted) = fields.next_to_wake(bodies, activity) {
        activity.wake(bodies, attracted);
    }
    activity.return_contacts(contacts);
    meetings.modifiers.change(bodies, contacts, fields.step);
}

fn wake_touched(bodies: &mut Arena<Body>, activity: &mut Activity, mover: u32, touched: u32) {
    let body = bodies.at(mover);
    match body.kind {
        BodyKind::Dynamic if body.is_active() => activity.wake(bodies, touched),
        BodyKind::Static | BodyKind::Kinematic if body.can_touch() => activity.disturb(bodies, touched),
        _ => {}
    }
}

/// What joints hold to a kinematic body that moves.
fn wake_held(bodies: &mut Arena<Body>, joints: &Arena<Joint>, activity: &mut Activity) {
    for at in 0..activity.kinematic().len() {
        let mover = activity.kinematic()[at];
        if bodies.at(mover).velocity.is_zero() {
            continue;
        }
        for at in 0..activity.joints_of.body(mover).len() {
            let joint = joints.at(activity.joints_of.body(mover)[at]);
            if joint.is_enabled() {
                activity.disturb(bodies, if joint.a == mover { joint.b } else { joint.a });
            }
        }
    }
}

/// Has a pair of shapes told of if it begins or ceases to touch.
fn note(bodies: &Arena<Body>, pair: &mut [Contact], touching: &mut Touches) {
    let was = pair.iter().any(|contact| contact.touching);
    let solid = pair[0].effect != Effect::Sense;
    let is = if solid && lie_still(bodies, pair) { was } else { solid && pair.iter().any(Contact::touches) };
    if is || was {
        touching.note(touch_of(bodies, &pair[0]), was, is);
    }
    pair.iter_mut().for_each(|contact| contact.touching = is);
}

/// All parts of a pair of shapes do the same: what touched a one-way shape goes on as it did, anything else passes if any
/// part of it comes from another side.
fn agree(pair: &mut [Contact]) {
    if !pair[0].one_way || pair[0].effect == Effect::Sense {
        return;
    }
    let passes = if pair.iter().any(|contact| contact.touching) {
        pair.iter().any(|contact| contact.touching && contact.passes)
    } else {
        pair.iter().any(|contact| contact.effect == Effect::Pass)
    };
    for contact in pair {
        contact.passes = passes;
        contact.effect = if passes { Effect::Pass } else { Effect::Push };
    }
}

pub(crate) fn id(bodies: &Arena<Body>, index: u32) -> BodyId {
    BodyId { index, generation: bodies.generation(index) }
}
