//! `collide` and `touch`: manifolds of all near pairs, then who began and stopped touching, and who wakes.

use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::Body;
use crate::collide::{Manifold, collide as narrow_phase};
use crate::contact::{Contact, slop};
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
pub(crate) fn collide(bodies: &Arena<Body>, contacts: &mut [Contact], context: &StepContext<'_>) {
    for_each_mut(context.runner, contacts, |contact| {
        let (a, b) = (bodies.at(contact.key.a), bodies.at(contact.key.b));
        if !a.can_touch() && !b.can_touch() {
            return;
        }
        let (sa, sb) = (contact.key.shape_a as usize, contact.key.shape_b as usize);
        let (shape_a, shape_b) = (&a.shapes[sa].shape, &b.shapes[sb].shape);
        let extent = min(shape_a.smallest_extent(), shape_b.smallest_extent());
        // Beside their approach: two that move together may not do so any more once one of them is hit.
        let (va, vb) = (a.velocity.linear, b.velocity.linear);
        let approach = max((va - vb).length(), max(va.length(), vb.length()))
            + a.velocity.angular.length() * a.reach()
            + b.velocity.angular.length() * b.reach();
        let margin = max(4.0 * slop(extent), approach * context.dt);
        let mut manifold = Manifold::default();
        narrow_phase(
            shape_a,
            &a.world_from_shape(sa),
            shape_b,
            &b.world_from_shape(sb),
            margin,
            &mut manifold,
        );
        contact.sensor = a.surface(sa).sensing == Sensing::Sensor || b.surface(sb).sensing == Sensing::Sensor;
        contact.memory = contact.memory.matched(&contact.manifold, &manifold);
        contact.manifold = manifold;
    });
}

/// `touch`: events, and waking of what an awake body touches or attracts, or a moving kinematic one holds. What wakes
/// comes with its contacts.
pub(crate) fn touch(
    bodies: &mut Arena<Body>,
    joints: &Arena<Joint>,
    contacts: &mut Vec<Contact>,
    activity: &mut Activity,
    fields: &Fields<'_>,
    events: &mut Events,
) {
    for list in [&mut events.begin, &mut events.end] {
        list.clear();
        // All of them: how many come at once differs from hit to hit.
        list.reserve(contacts.len());
    }
    for contact in contacts.iter_mut() {
        let (a, b) = (contact.key.a, contact.key.b);
        if !contact.sensor {
            note_change(bodies, contact, &mut events.begin, &mut events.end);
        }
        if contact.pushes() {
            wake_touched(bodies, activity, a, b);
            wake_touched(bodies, activity, b, a);
        }
    }
    wake_held(bodies, joints, activity);
    while let Some(attracted) = fields.next_to_wake(bodies, activity) {
        activity.wake(bodies, attracted);
    }
    activity.return_contacts(contacts);
}

fn wake_touched(bodies: &mut Arena<Body>, activity: &mut Activity, mover: u32, touched: u32) {
    let body = bodies.at(mover);
    match body.kind {
        BodyKind::Dynamic if body.is_active() => activity.wake(bodies, touched),
        BodyKind::Kinematic if body.can_touch() => activity.disturb(bodies, touched),
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

/// Puts the pair of a contact that began or ceased to touch since it was last looked at into one of the lists.
pub(crate) fn note_change(
    bodies: &Arena<Body>,
    contact: &mut Contact,
    begin: &mut Vec<(BodyId, BodyId)>,
    end: &mut Vec<(BodyId, BodyId)>,
) {
    let touching = contact.manifold.points().iter().any(|point| point.separation <= 0.0);
    if touching != contact.touching {
        let list = if touching { begin } else { end };
        list.push((id(bodies, contact.key.a), id(bodies, contact.key.b)));
        contact.touching = touching;
    }
}

pub(crate) fn id(bodies: &Arena<Body>, index: u32) -> BodyId {
    BodyId { index, generation: bodies.generation(index) }
}
