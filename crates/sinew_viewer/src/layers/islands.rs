//! Outlines of bodies in the colour of their island.

use sinew::physics::{BodyId, BodyKind, World};
use sinew_picture::{Line, LineDepth, draw, world::body_color};
use std::collections::HashMap;

/// Linear colour of sleeping bodies.
const ASLEEP: [f32; 3] = [0.32, 0.36, 0.42];

/// Adds the outlines of all dynamic bodies. An island is a set of dynamic bodies connected by contacts or joints.
pub(super) fn add(world: &World, lines: &mut Vec<Line>) {
    let dynamic: Vec<BodyId> = world.body_ids().filter(|&id| world.kind(id) == BodyKind::Dynamic).collect();
    let places: HashMap<BodyId, usize> = dynamic.iter().enumerate().map(|(place, &id)| (id, place)).collect();
    let mut first: Vec<usize> = (0..dynamic.len()).collect();
    let touching = world.contacts().filter(|contact| contact.impulse() > 0.0);
    let pairs = touching.map(|contact| (contact.a.body, contact.b.body));
    let joined = world.joint_ids().map(|id| world.joint_bodies(id));
    for (a, b) in pairs.chain(joined) {
        if let (Some(&a), Some(&b)) = (places.get(&a), places.get(&b)) {
            let (a, b) = (root(&mut first, a), root(&mut first, b));
            first[a.max(b)] = a.min(b);
        }
    }
    for (place, &id) in dynamic.iter().enumerate() {
        let color = if world.is_awake(id) { body_color(root(&mut first, place)) } else { ASLEEP };
        for (shape, place) in world.shapes(id) {
            lines.extend(draw::wire(&shape, place, color, LineDepth::OnTop));
        }
    }
}

/// Returns the first body of an island, as an index.
fn root(first: &mut [usize], mut at: usize) -> usize {
    while first[at] != at {
        first[at] = first[first[at]];
        at = first[at];
    }
    at
}
