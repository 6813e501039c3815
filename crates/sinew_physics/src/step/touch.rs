//! `collide` and `touch`: manifolds of all near pairs, then what they do, who began and stopped touching, and who wakes.

use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::Body;
use crate::body::contact_rule::ContactRule;
use crate::body::def::BodyKind;
use crate::body::shape::Sensing;
use crate::body::surface::Surface;
use crate::collide::{Manifold, ManifoldPoint, Motion, Parting, collide_again};
use crate::contact::SPECULATIVE_SLOPS;
use crate::contact::events::Events;
use crate::contact::kept::Kept;
use crate::contact::meetings::{Meetings, Told};
use crate::contact::parts::Parts;
use crate::contact::{Contact, ContactKey, ContactMemory, Effect, pairs_of, slop};
use crate::context::StepContext;
use crate::field::Fields;
use crate::joint::Joint;
use crate::slices::for_each_mut;
use crate::step::pairs::{Asked, BroadPhase};
use sinew_math::{max, min};

/// Gap within which two shapes that touched go on touching, as a share of their slop.
const LINGER: f32 = 0.1;

/// `collide`: manifolds at the poses of the step's beginning, with points as far away as the step may close.
pub(crate) fn collide(
    bodies: &Arena<Body>,
    broad: &mut BroadPhase,
    contacts: &mut Vec<Contact>,
    parts: &mut Parts,
    context: &StepContext<'_>,
) {
    let BroadPhase { proxies, asked, .. } = broad;
    for_each_mut(context.runner, contacts, |contact| {
        let (a, b) = (bodies.at(contact.key.a), bodies.at(contact.key.b));
        contact.approach = 0.0;
        if !a.can_touch() && !b.can_touch() {
            return;
        }
        contact.pushed = contact.has_pushed();
        if contact.has_surface {
            return;
        }
        renew(contact, a, b, proxies.ahead(contact.key), context.dt);
        weigh(contact, a, b);
    });
    for_each_mut(context.runner, asked, |asked| {
        let (a, b) = (bodies.at(asked.key.a), bodies.at(asked.key.b));
        ask(a, b, asked, proxies.ahead(asked.key), context.dt);
    });
    broad.answer(contacts, |contact| weigh(contact, bodies.at(contact.key.a), bodies.at(contact.key.b)));
    if !contacts.iter().any(|contact| contact.has_surface) {
        return;
    }
    parts.update(bodies, contacts, context, |contact| surface_motion(bodies, contact, context.dt));
    for_each_mut(context.runner, contacts, |contact| {
        let (a, b) = (bodies.at(contact.key.a), bodies.at(contact.key.b));
        if contact.has_surface && (a.can_touch() || b.can_touch()) {
            weigh(contact, a, b);
        }
    });
}

/// Brings the manifold of two convex shapes to where they are. Points are looked for within `ahead` (m)
/// at most because of how fast they are.
fn renew(contact: &mut Contact, a: &Body, b: &Body, ahead: f32, dt: f32) {
    let is_slow = ahead < contact.kept.least_margin();
    if is_slow && contact.kept.renew([a, b], contact.kept.least_margin(), &mut contact.manifold) {
        return;
    }
    let (margin, slop) = margin(a, b, contact.key, ahead, dt);
    if !is_slow && contact.kept.renew([a, b], margin, &mut contact.manifold) {
        return;
    }
    let (mut manifold, mut parting) = (Manifold::default(), contact.parting());
    meet(a, b, contact.key, margin, &mut parting, &mut manifold);
    contact.memory = contact.memory.matched(&contact.manifold, &manifold);
    contact.manifold = manifold;
    contact.kept = Kept::new([a, b], contact.key, (margin, slop), &manifold);
    (contact.apart, contact.gap) = (parting.axis, parting.gap);
}

/// The manifold of two convex shapes.
fn meet(a: &Body, b: &Body, key: ContactKey, margin: f32, parting: &mut Parting, manifold: &mut Manifold) {
    let (sa, sb) = (key.shape_a as usize, key.shape_b as usize);
    let (shape_a, shape_b) = (&a.shapes[sa].shape, &b.shapes[sb].shape);
    let (from_a, from_b) = (a.world_from_shape(sa), b.world_from_shape(sb));
    collide_again((shape_a, &from_a), (shape_b, &from_b), margin, parting, manifold);
}

/// A contact of a pair that had none, if it has points now; `ahead` as in [`margin`].
pub(crate) fn ask(a: &Body, b: &Body, asked: &mut Asked, ahead: f32, dt: f32) {
    let (margin, slop) = margin(a, b, asked.key, ahead, dt);
    meet(a, b, asked.key, margin, &mut asked.parting, &mut asked.manifold);
    asked.kept = Kept::new([a, b], asked.key, (margin, slop), &asked.manifold);
}

/// How fast a contact comes in, and what it does.
fn weigh(contact: &mut Contact, a: &Body, b: &Body) {
    contact.approach = approach_of(a, b, &contact.manifold);
    if contact.is_plain && !a.stirred && !b.stirred {
        (contact.effect, contact.one_way) = (Effect::Push, false);
    } else {
        rule(contact, a, b);
    }
}

/// How far apart points of two shapes are looked for, and their slop, metres. Because of how fast the two are it is no more than
/// `ahead`, which may be far too much.
fn margin(a: &Body, b: &Body, key: ContactKey, ahead: f32, dt: f32) -> (f32, f32) {
    let slop = slop(smallest_extent(a, b, key));
    let least = SPECULATIVE_SLOPS * slop;
    if ahead < least {
        return (least, slop);
    }
    // Beside their approach: two that move together may not do so any more once one of them is hit.
    let (va, vb) = (a.velocity.linear, b.velocity.linear);
    let approach = max((va - vb).length(), max(va.length(), vb.length()))
        + a.velocity.angular.length() * a.reach()
        + b.velocity.angular.length() * b.reach();
    (max(least, approach * dt), slop)
}

/// Of the two shapes, metres.
fn smallest_extent(a: &Body, b: &Body, key: ContactKey) -> f32 {
    let (shape_a, shape_b) = (&a.shapes[key.shape_a as usize].shape, &b.shapes[key.shape_b as usize].shape);
    min(shape_a.smallest_extent(), shape_b.smallest_extent())
}

/// How a pair moves of which one is a surface, the other toward the surface; `None` of other pairs, and of those at rest.
fn surface_motion(bodies: &Arena<Body>, contact: &Contact, dt: f32) -> Option<Motion> {
    let key = contact.key;
    let (a, b) = (bodies.at(key.a), bodies.at(key.b));
    if !a.can_touch() && !b.can_touch() {
        return None;
    }
    if !contact.has_surface {
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
    Some(Motion {
        velocity: speed(mover) - speed(ground),
        dt,
        margin: margin(a, b, key, f32::INFINITY, dt).0,
    })
}

/// How fast the points come in, m/s; the fastest counts.
fn approach_of(a: &Body, b: &Body, manifold: &Manifold) -> f32 {
    manifold.points().iter().fold(0.0, |fastest, point| {
        let p = point.position;
        let relative = b.velocity.at(p - b.center()) - a.velocity.at(p - a.center());
        max(fastest, -relative.dot(manifold.normal))
    })
}

/// Whether a surface pushes, wherever it is met.
fn is_plain(surface: &Surface) -> bool {
    let pushes = matches!(surface.rule, ContactRule::Push | ContactRule::Modified { .. });
    pushes && surface.sensing == Sensing::Solid
}

/// What the contact does, as far as its shapes say.
fn rule(contact: &mut Contact, a: &Body, b: &Body) {
    let (sa, sb) = (contact.key.shape_a as usize, contact.key.shape_b as usize);
    contact.effect = Effect::Push;
    contact.one_way = false;
    contact.is_plain = [a.surface(sa), b.surface(sb)].into_iter().all(is_plain);
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
        let was = pair[0].touching;
        let is = pair[0].effect != Effect::Sense && touches(bodies, pair);
        touching.note(pair[0].key, was, is);
        pair.iter_mut().for_each(|contact| contact.touching = is);
        if pair.iter().any(Contact::pushes) {
            wake_touched(bodies, activity, pair);
        } else {
            pair.iter_mut().for_each(|contact| contact.memory = ContactMemory::default());
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

fn wake_touched(bodies: &mut Arena<Body>, activity: &mut Activity, pair: &[Contact]) {
    let key = pair[0].key;
    let is_settled = |index: u32| {
        let body = bodies.at(index);
        body.kind != BodyKind::Kinematic && body.is_awake()
    };
    if is_settled(key.a) && is_settled(key.b) {
        return;
    }
    for (mover, touched) in [(key.a, key.b), (key.b, key.a)] {
        let body = bodies.at(mover);
        match body.kind {
            BodyKind::Dynamic if body.is_active() => activity.wake(bodies, touched),
            BodyKind::Kinematic if !body.velocity.is_zero() => activity.disturb(bodies, touched),
            BodyKind::Static | BodyKind::Kinematic if body.stirred && is_deep(bodies, pair) => {
                activity.wake(bodies, touched);
            }
            _ => {}
        }
    }
}

/// Whether two shapes lie deeper in each other than what rests does.
fn is_deep(bodies: &Arena<Body>, pair: &[Contact]) -> bool {
    let key = pair[0].key;
    let deep = -slop(smallest_extent(bodies.at(key.a), bodies.at(key.b), key));
    points_of(pair).any(|point| point.separation < deep)
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

/// Whether two shapes overlap, or pushed each other in the last step and are still near: what bears a load may do so from a
/// thousandth of a millimetre away, and what bounced has met although it is gone by now. What touched goes on touching until
/// there is a gap that is none by rounding.
fn touches(bodies: &Arena<Body>, pair: &[Contact]) -> bool {
    let Contact { key, touching, .. } = pair[0];
    let nearest = points_of(pair).fold(f32::INFINITY, |least, point| min(point.separation, least));
    if nearest <= 0.0 || nearest < f32::INFINITY && pair.iter().any(|contact| contact.pushed) {
        return true;
    }
    touching && nearest <= LINGER * slop(smallest_extent(bodies.at(key.a), bodies.at(key.b), key))
}

fn points_of(pair: &[Contact]) -> impl Iterator<Item = &ManifoldPoint> {
    pair.iter().flat_map(|contact| contact.manifold.points())
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
