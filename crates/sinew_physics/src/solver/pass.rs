//! Passes over the rows of an island, and the coupling of its contacts and joints.

/// Purpose of a pass over the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pass {
    /// Solves with bias and without friction.
    Solve,
    /// Solves without bias and with friction. Friction that reacts to bias velocities adds energy to tall stacks.
    Relax,
    /// Like `Relax`, with the rebound speed of contacts that were hit. The contacts below them bear the rebound too.
    Restitution,
}

/// Coupling of contacts and joints in an island. It affects only how accurately and how fast the solution converges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Coupling {
    /// The island has no joints.
    #[default]
    Free,
    /// Each impulse of a contact or limit changes the velocities of all links. For one or two trees.
    Response,
    /// Limits, contacts in lanes and exact trees alternate. For heaps.
    Turns,
}

/// Trees whose positions are corrected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Corrected {
    All,
    /// Trees whose velocities changed after the last corrections of this substep.
    Changed,
}
