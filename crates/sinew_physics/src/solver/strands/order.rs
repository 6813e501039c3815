//! Finds the islands that are strands, and the order of their links.

use super::is_plain;
use crate::island::Island;
use crate::solver::view::View;

/// Marks the absence of a body or joint.
pub(super) const NONE: u32 = u32::MAX;
/// Marks a body that is not in the island.
const ABSENT: [u32; 2] = [NONE - 1; 2];

/// A link at its position in the strand; the indices are those of the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    pub body: u32,
    /// Joint to the previous link, or to the body that holds the strand.
    pub joint: u32,
    pub parent: u32,
    /// True if the body is the joint's second one.
    pub is_b: bool,
}

/// The links of the strand found last, from the held end on. A free strand starts at the end with the smaller body index.
#[derive(Clone, Debug, Default)]
pub(super) struct Order {
    pub links: Vec<Placed>,
    /// Joints of each body of the island, by slot of the world's bodies.
    joints_of: Vec<[u32; 2]>,
}

impl Order {
    /// True if a fixed body holds the first link.
    pub fn is_held(&self) -> bool {
        self.links.first().is_some_and(|first| first.joint != NONE)
    }

    /// Lists the links of an island if it is a strand. The result depends on the island alone.
    pub fn find(&mut self, island: &Island<'_>, view: &View<'_>) -> bool {
        self.links.clear();
        let (bodies, joints) = (island.bodies.len(), island.joints.len());
        let is_tree = joints == bodies || joints + 1 == bodies;
        let is_apart = island.contacts.is_empty() && island.groups.is_empty() && view.fields.is_empty();
        // Only gravity and the forces and torques of this step act on the body.
        let is_left_alone = |&body: &u32| view.bodies.at(body).forces.list.is_empty();
        if joints == 0 || !is_tree || !is_apart || !island.bodies.iter().all(is_left_alone) {
            return false;
        }
        self.joints_of.resize(view.bodies.slot_count(), ABSENT);
        for &body in island.bodies {
            self.joints_of[body as usize] = [NONE; 2];
        }
        let start = self.join(island, view);
        if let Some(start) = start {
            self.walk(start, joints == bodies, view);
        }
        for &body in island.bodies {
            self.joints_of[body as usize] = ABSENT;
        }
        self.links.len() == bodies
    }

    /// Records the joints of each body. Returns the joint and the body at the start of the strand, or `None` if links
    /// branch, a joint is not plain, or the holding body moves.
    fn join(&mut self, island: &Island<'_>, view: &View<'_>) -> Option<(u32, u32)> {
        let mut held = None;
        for &index in island.joints {
            let joint = view.joints.at(index);
            if !is_plain(joint) {
                return None;
            }
            for (body, other) in [(joint.a, joint.b), (joint.b, joint.a)] {
                let of_body = &mut self.joints_of[body as usize];
                if *of_body == ABSENT {
                    if !view.bodies.at(body).velocity.is_zero() {
                        return None;
                    }
                    held = Some((index, other));
                    continue;
                }
                *of_body.iter_mut().find(|place| **place == NONE)? = index;
            }
        }
        let is_end = |&&body: &&u32| self.joints_of[body as usize][1] == NONE;
        held.or_else(|| island.bodies.iter().find(is_end).map(|&body| (NONE, body)))
    }

    /// Walks from the first link along the joints.
    fn walk(&mut self, (mut through, mut body): (u32, u32), is_held: bool, view: &View<'_>) {
        if is_held != (through != NONE) {
            return;
        }
        loop {
            let joint = (through != NONE).then(|| view.joints.at(through));
            let is_b = joint.is_some_and(|joint| joint.b == body);
            let parent = joint.map_or(NONE, |joint| if is_b { joint.a } else { joint.b });
            self.links.push(Placed { body, joint: through, parent, is_b });
            let next =
                self.joints_of[body as usize].into_iter().find(|&next| next != through && next != NONE);
            let Some(next) = next else { return };
            let joint = view.joints.at(next);
            body = if joint.a == body { joint.b } else { joint.a };
            through = next;
        }
    }
}
