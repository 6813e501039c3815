//! `sensors`: who is inside whom, as events.

use crate::arena::Arena;
use crate::body::Body;
use crate::contact::{Contact, pairs_of};
use crate::touch::{Events, note_change};

/// Compares each sensor pair with the step before.
pub(crate) fn sensors(bodies: &Arena<Body>, contacts: &mut [Contact], events: &mut Events) {
    events.sensor_begin.clear();
    events.sensor_end.clear();
    for pair in pairs_of(contacts).filter(|pair| pair[0].sensor) {
        note_change(bodies, pair, &mut events.sensor_begin, &mut events.sensor_end);
    }
}
