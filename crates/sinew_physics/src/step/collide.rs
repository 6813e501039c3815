//! `collide`: computes the manifolds of all near pairs, and their effect.

use crate::arena::Arena;
use crate::body::Body;
use crate::body::contact_rule::{ContactRule, Yields};
use crate::body::def::BodyKind;
use crate::body::shape::Sensing;
use crate::body::surface::Surface;
use crate::collide::{Manifold, Motion, SeparationCache, collide_again, is_hidden};
use crate::contact::filter::PairFilter;
use crate::contact::parts::Parts;
use crate::contact::proxies::Ahead;
use crate::contact::recycled::Recycled;
use crate::contact::seams::{Seams, Search};
use crate::contact::tuning::SPECULATIVE_SLOPS;
use crate::contact::{Contact, ContactKey, ContactMemory, Effect, slop};
use crate::context::StepContext;
use crate::slices::for_each_mut;
use crate::step::pairs::{Asked, BroadPhase};
use crate::step::tuning::{MOST_APPROACH, YIELDING_DEPTH};
use sinew_math::{Vec3, max, min};

/// `collide`: manifolds at the start poses of the step, with points up to the distance that the step may close.
pub(crate) fn collide(
    (bodies, filter): (&Arena<Body>, PairFilter<'_>),
    broad: &mut BroadPhase,
    contacts: &mut Vec<Contact>,
    parts: &mut Parts,
    context: &StepContext<'_>,
) {
    let BroadPhase { proxies, asked, .. } = broad;
    let seams = Seams { bodies, proxies, filter };
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
        renew(contact, (a, b, &seams), proxies.ahead(contact.key), context.dt);
        weigh(contact, a, b, context.dt);
    });
    for_each_mut(context.runner, asked, |asked| {
        let (a, b) = (bodies.at(asked.key.a), bodies.at(asked.key.b));
        ask((a, b, &seams), asked, proxies.ahead(asked.key), context.dt);
    });
    broad.answer(contacts, |contact| {
        weigh(contact, bodies.at(contact.key.a), bodies.at(contact.key.b), context.dt);
    });
    if !contacts.iter().any(|contact| contact.has_surface) {
        return;
    }
    let proxies = &broad.proxies;
    parts.update(&Seams { bodies, proxies, filter }, contacts, context, |contact| {
        surface_motion(bodies, contact, proxies.ahead(contact.key), context.dt)
    });
    for_each_mut(context.runner, contacts, |contact| {
        let (a, b) = (bodies.at(contact.key.a), bodies.at(contact.key.b));
        if contact.has_surface && (a.can_touch() || b.can_touch()) {
            weigh(contact, a, b, context.dt);
        }
    });
}

/// Updates the manifold of a contact of two convex shapes. `ahead` limits the search distance for speed.
fn renew(contact: &mut Contact, (a, b, seams): (&Body, &Body, &Seams<'_>), ahead: Ahead, dt: f32) {
    let is_slow = ahead.most < contact.kept.least_margin();
    if is_slow && contact.kept.renew([a, b], contact.kept.least_margin(), &mut contact.manifold) {
        return;
    }
    let (margin, slop) = margin(a, b, contact.key, ahead, dt);
    if !is_slow && contact.kept.renew([a, b], margin, &mut contact.manifold) {
        return;
    }
    let (mut manifold, mut parting) = (Manifold::default(), contact.parting());
    meet(a, b, contact.key, margin, &mut parting, &mut manifold);
    seams.mend(contact.key, Search { margin, slop, dt }, &mut manifold);
    contact.memory = contact.memory.matched(&contact.manifold, &manifold);
    contact.manifold = manifold;
    contact.kept = Recycled::new([a, b], contact.key, (margin, slop), &manifold);
    (contact.apart, contact.gap) = (parting.axis, parting.gap);
}

/// Computes the manifold of two convex shapes.
fn meet(
    a: &Body,
    b: &Body,
    key: ContactKey,
    margin: f32,
    parting: &mut SeparationCache,
    manifold: &mut Manifold,
) {
    let (sa, sb) = (key.shape_a as usize, key.shape_b as usize);
    let (shape_a, shape_b) = (&a.shapes[sa].shape, &b.shapes[sb].shape);
    let (from_a, from_b) = (a.world_from_shape(sa), b.world_from_shape(sb));
    collide_again((shape_a, &from_a), (shape_b, &from_b), margin, parting, manifold);
}

/// Computes the points of a pair without a contact; `ahead` is used as in [`margin`].
pub(crate) fn ask((a, b, seams): (&Body, &Body, &Seams<'_>), asked: &mut Asked, ahead: Ahead, dt: f32) {
    let (margin, slop) = margin(a, b, asked.key, ahead, dt);
    meet(a, b, asked.key, margin, &mut asked.parting, &mut asked.manifold);
    seams.mend(asked.key, Search { margin, slop, dt }, &mut asked.manifold);
    asked.kept = Recycled::new([a, b], asked.key, (margin, slop), &asked.manifold);
}

/// Computes a contact's approach speed and effect.
fn weigh(contact: &mut Contact, a: &Body, b: &Body, dt: f32) {
    contact.approach = approach_of(a, b, &contact.manifold);
    if contact.is_plain && !a.changed && !b.changed {
        (contact.effect, contact.one_way) = (Effect::Push, false);
    } else {
        rule(contact, a, b, dt);
    }
    if is_hidden(&contact.manifold) {
        contact.effect = Effect::Pass;
        contact.memory = ContactMemory::default();
    }
}

/// Search distance for points of two shapes, and their slop, metres. The part for speed is computed only if
/// `ahead.most`, its upper bound, exceeds the distance for slow pairs.
fn margin(a: &Body, b: &Body, key: ContactKey, ahead: Ahead, dt: f32) -> (f32, f32) {
    let slop = slop(smallest_extent(a, b, key));
    let least = SPECULATIVE_SLOPS * slop;
    if ahead.most < least {
        return (least, slop);
    }
    // The larger of relative and individual speeds: two bodies that move together separate when one is hit.
    let (va, vb) = (a.velocity.linear, b.velocity.linear);
    let approach = max((va - vb).length(), max(va.length(), vb.length()))
        + a.velocity.angular.length() * a.reach()
        + b.velocity.angular.length() * b.reach();
    (max(least, approach * dt + ahead.blow), slop)
}

/// Smallest extent of the two shapes, metres.
pub(crate) fn smallest_extent(a: &Body, b: &Body, key: ContactKey) -> f32 {
    let (shape_a, shape_b) = (&a.shapes[key.shape_a as usize].shape, &b.shapes[key.shape_b as usize].shape);
    min(shape_a.smallest_extent(), shape_b.smallest_extent())
}

/// Motion of the other shape relative to the mesh or height field of a pair; `None` for other pairs, and at rest.
fn surface_motion(bodies: &Arena<Body>, contact: &Contact, ahead: Ahead, dt: f32) -> Option<Motion> {
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
        margin: margin(a, b, key, Ahead { most: f32::INFINITY, ..ahead }, dt).0,
    })
}

/// Largest approach speed of the manifold's points, m/s, from 0 to [`MOST_APPROACH`].
///
/// Bodies are rigid: rates at two points differ by the relative spin times their offset.
pub(super) fn approach_of(a: &Body, b: &Body, manifold: &Manifold) -> f32 {
    let [first, others @ ..] = manifold.points() else { return 0.0 };
    let (p, n) = (first.position, manifold.normal);
    let rate = (b.velocity.at(p - b.center()) - a.velocity.at(p - a.center())).dot(n);
    let per_way = n.cross(b.velocity.angular - a.velocity.angular);
    let least = others.iter().fold(rate, |least, other| min(least, rate + per_way.dot(other.position - p)));
    if least.is_finite() { min(max(0.0, -least), MOST_APPROACH) } else { MOST_APPROACH }
}

/// True if a surface pushes at every point.
pub(super) fn is_plain(surface: &Surface) -> bool {
    let pushes = matches!(surface.rule, ContactRule::Push | ContactRule::Modified { .. });
    pushes && surface.sensing == Sensing::Solid
}

/// Sets the contact's effect according to its shapes.
fn rule(contact: &mut Contact, a: &Body, b: &Body, dt: f32) {
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
            ContactRule::Yields(yields) => {
                contact.passes = gives_way(yields, contact, [a, b], dt);
                if contact.passes {
                    contact.effect = Effect::Pass;
                }
            }
        }
    }
    if [a.surface(sa), b.surface(sb)].into_iter().any(|s| s.sensing == Sensing::Sensor) {
        contact.effect = Effect::Sense;
    }
}

/// True if a kinematic body lets a dynamic body pass: pushing the body would exceed a limit, or did so earlier in this
/// touch.
fn gives_way(yields: Yields, contact: &Contact, [a, b]: [&Body; 2], dt: f32) -> bool {
    let (other, led, out) = match (a.kind, b.kind) {
        (BodyKind::Kinematic, BodyKind::Dynamic) => (b, a, contact.manifold.normal),
        (BodyKind::Dynamic, BodyKind::Kinematic) => (a, b, -contact.manifold.normal),
        _ => return false,
    };
    if contact.touching && contact.passes {
        return true;
    }
    let points = contact.manifold.points();
    if points.is_empty() {
        return false;
    }
    let middle = points.iter().fold(Vec3::ZERO, |sum, point| sum + point.position) / points.len() as f32;
    let (at, on) = (middle - other.center(), middle - led.center());
    let (comes, shoves) = (-other.velocity.at(at).dot(out), led.velocity.at(on).dot(out));
    let closing = max(comes + shoves, 0.0);
    let turn = other.inverse_inertia_mul(at.cross(out)).cross(at).dot(out);
    let mass = 1.0 / (other.inverse_mass() + turn);
    let push = yields.max_force * dt;
    // A large impulse shows that an object behind the other body blocks it. A free body takes none above both limits.
    let took = contact.impulses().fold(0.0, |sum, (_, impulse)| sum + impulse);
    let squeezes = took > max(push, yields.max_impulse);
    let jammed = squeezes || shoves > 0.0 && contact.touching && closing > 0.0 && took > push;
    jammed
        || points.iter().any(|point| point.separation < -YIELDING_DEPTH)
        || mass * min(shoves, closing) > push
        || mass * min(comes, closing) > yields.max_impulse
}
