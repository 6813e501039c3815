//! The stage `touch` determines which touches begin and end, and wakes bodies.

use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::Body;
use crate::body::def::BodyKind;
use crate::collide::ManifoldPoint;
use crate::contact::events::Events;
use crate::contact::tracking::{ContactTracking, TouchEvents};
use crate::contact::{Contact, ContactMemory, Effect, pairs_of, slop};
use crate::field::Fields;
use crate::joint::Joint;
use crate::particles::ParticleGroup;
use crate::step::collide::smallest_extent;
use crate::step::tuning::LINGER;
use sinew_math::min;

/// `touch`: computes contact effects and events, and wakes bodies that an awake body touches, presses through particles
/// or attracts, and bodies jointed to a moving kinematic body. Contacts of woken bodies return.
pub(crate) fn touch(
    bodies: &mut Arena<Body>,
    joints: &Arena<Joint>,
    groups: &Arena<ParticleGroup>,
    contacts: &mut Vec<Contact>,
    activity: &mut Activity,
    fields: &Fields<'_>,
    meetings: &mut ContactTracking,
    events: &mut Events,
) {
    let ContactTracking { touching, hits, .. } = meetings;
    touching.start(contacts.len());
    for pair in pairs_of(contacts) {
        agree(pair);
        hits.note(pair);
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
    touching.report(
        bodies,
        TouchEvents { bodies: &mut events.begin, shapes: &mut events.shapes_begin },
        TouchEvents { bodies: &mut events.end, shapes: &mut events.shapes_end },
    );
    // Pressure through particles counts as a touch.
    let groups = groups.iter().map(|(_, group)| group).filter(|group| group.is_awake());
    let pinched = groups.flat_map(|group| &group.pinched.contacts);
    for contact in pinched.filter(|contact| contact.has_pushed()) {
        wake_touched(bodies, activity, core::slice::from_ref(contact));
    }
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
            BodyKind::Static | BodyKind::Kinematic if body.changed && is_deep(bodies, pair) => {
                activity.wake(bodies, touched);
            }
            _ => {}
        }
    }
}

/// True if two shapes overlap by more than resting shapes do.
fn is_deep(bodies: &Arena<Body>, pair: &[Contact]) -> bool {
    let key = pair[0].key;
    let deep = -slop(smallest_extent(bodies.at(key.a), bodies.at(key.b), key));
    points_of(pair).any(|point| point.separation < deep)
}

/// Wakes the bodies that joints connect to a moving kinematic body.
fn wake_held(bodies: &mut Arena<Body>, joints: &Arena<Joint>, activity: &mut Activity) {
    for at in 0..activity.kinematic().len() {
        let mover = activity.kinematic()[at];
        if activity.joints_of.body(mover).is_empty() || bodies.at(mover).velocity.is_zero() {
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

/// True if two shapes overlap, or pushed each other in the last step and are still near. A contact may carry a load at
/// a gap of a thousandth of a millimetre, and a body that bounced has touched although it already separated. A touch
/// continues until the gap exceeds rounding.
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

/// Sets the same effect for all parts of a pair of shapes. A shape that already touched a one-way shape keeps its
/// effect. Otherwise the pair passes if any part approaches from another side.
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
