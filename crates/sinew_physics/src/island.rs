//! An island: bodies connected by contacts, joints, particles and attraction.

/// Members of one island, by index, each list ascending.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Island<'a> {
    pub bodies: &'a [u32],
    pub joints: &'a [u32],
    /// Positions in the contact array. `color` orders contacts with static bodies last, so that they are solved last.
    pub contacts: &'a [u32],
    /// Particle groups that are attached to the island's bodies or may touch them.
    pub groups: &'a [u32],
    /// True if the island is a free-flying body or a strand that this step has already solved.
    pub is_flown: bool,
}

/// Number of contacts above which all threads work on one joint-free island together instead of on separate islands.
const LARGE: usize = 1_024;

impl Island<'_> {
    /// True if all threads work on the island together.
    pub fn is_large(&self) -> bool {
        self.joints.is_empty() && self.contacts.len() >= LARGE
    }
}
