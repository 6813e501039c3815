//! The stage `sensors` reports sensor events and hits.

use crate::arena::Arena;
use crate::body::Body;
use crate::contact::events::Events;
use crate::contact::tracking::{ContactTracking, TouchEvents};
use crate::contact::{Contact, Effect, pairs_of};

/// Compares the sensor pairs with those of the previous step, and reports hits. Clears the marks of changed bodies.
pub(crate) fn sensors(
    bodies: &mut Arena<Body>,
    contacts: &mut [Contact],
    meetings: &mut ContactTracking,
    events: &mut Events,
) {
    let sensed = &mut meetings.sensed;
    sensed.start(contacts.len());
    for pair in pairs_of(contacts) {
        let was = pair.iter().any(|contact| contact.sensed);
        let is = pair[0].effect == Effect::Sense && pair.iter().any(Contact::overlaps);
        if !was && !is {
            continue;
        }
        sensed.note(pair[0].key, was, is);
        pair.iter_mut().for_each(|contact| contact.sensed = is);
    }
    sensed.report(
        bodies,
        TouchEvents { bodies: &mut events.sensor_begin, shapes: &mut events.sensor_shapes_begin },
        TouchEvents { bodies: &mut events.sensor_end, shapes: &mut events.sensor_shapes_end },
    );
    meetings.hits.report(bodies, contacts, &mut events.hits);
    meetings.settle(bodies);
}
