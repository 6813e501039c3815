//! What the build has to say about its work.

use crate::filter::Overlap;
use crate::fit::patch::Selection;

/// How a ragdoll came about.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BuildReport {
    /// One per body, in the definition's order.
    pub bodies: Vec<BodyReport>,
    /// Bodies that overlap in the bind pose although no joint connects them, and what was done about each.
    pub overlaps: Vec<Overlap>,
    /// Area-weighted mean distance between skin and shapes over all bodies, metres.
    pub mean_error: f32,
    /// Sum of the shapes' volumes, m³; more than the flesh has, for shapes overlap.
    pub shape_volume: f32,
    /// What a person should know, a sentence each.
    pub notes: Vec<String>,
}

/// How one body came about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyReport {
    /// Area-weighted mean distance between the bone's skin and the shape's surface, metres.
    pub error: f32,
    /// Which skin the shape was fitted to.
    pub selection: Selection,
    /// Factor on the cross-section to get clear of other bodies; 1 if it was not needed.
    pub scale: f32,
    /// How far the bind pose was beyond the table's limits of the joint to the parent, radians; they were widened.
    pub widened: f32,
}
