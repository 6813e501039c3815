//! `sensors`: who is inside whom, as events.

use crate::arena::Arena;
use crate::body::Body;
use crate::contact::Contact;
use crate::touch::{Events, id};

/// Compares each sensor pair with the step before.
pub(crate) fn sensors(bodies: &Arena<Body>, contacts: &mut [Contact], events: &mut Events) {
    events.sensor_begin.clear();
    events.sensor_end.clear();
    for contact in contacts.iter_mut().filter(|contact| contact.sensor) {
        let inside = contact.manifold.points().iter().any(|point| point.separation <= 0.0);
        if inside != contact.touching {
            let list = if inside { &mut events.sensor_begin } else { &mut events.sensor_end };
            list.push((id(bodies, contact.key.a), id(bodies, contact.key.b)));
            contact.touching = inside;
        }
    }
}
