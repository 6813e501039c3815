//! `sensors`: who is inside whom, as events.

use crate::arena::Arena;
use crate::body::Body;
use crate::contact::{Contact, Effect};
use crate::events::Events;
use crate::meetings::{Meetings, Told};

/// Compares the sensor pairs with those of the step before. All that the user changed since has been looked at now.
pub(crate) fn sensors(
    bodies: &mut Arena<Body>,
    contacts: &[Contact],
    meetings: &mut Meetings,
    events: &mut Events,
) {
    let sensed = &mut meetings.sensed;
    sensed.start(contacts.len());
    for pair in contacts.chunk_by(|p, q| p.key.is_same_pair(&q.key)) {
        if pair[0].effect == Effect::Sense {
            sensed.note(bodies, pair);
        }
    }
    sensed.tell(
        Told { bodies: &mut events.sensor_begin, shapes: &mut events.sensor_shapes_begin },
        Told { bodies: &mut events.sensor_end, shapes: &mut events.sensor_shapes_end },
    );
    meetings.settle(bodies);
}
