//! Passes over the rows of an island, and how its contacts and joints come to agree in them.

/// Purpose of a pass over the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pass {
    /// With bias, no friction.
    Solve,
    /// Without bias, with friction: friction that reacts to bias velocities pumps tall stacks.
    Relax,
    /// As `relax` leaves it, and what was hit bounces: what it stands on must bear that, too.
    Restitution,
}

/// Way in which contacts and joints of an island come to agree. It decides how nearly and how soon they do, nothing else.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Coupling {
    /// There are no joints.
    #[default]
    Free,
    /// Contacts and limits see all links move with each impulse: for single figures.
    Response,
    /// Contacts in lanes and trees by turns: for heaps.
    Turns,
}

/// Trees whose positions are corrected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Corrected {
    All,
    /// Trees whose velocities have changed since the last corrections of this substep.
    Changed,
}
