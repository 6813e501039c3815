//! Constants of behaviour of contacts and of what looks for them: numbers that an engineer would turn.
//!
//! Each says its unit, why it is what it is, what a larger and a smaller one does, and the scene (`sinew run NAME`) or test
//! (`crates/sinew_physics/tests/it`) where that is to be seen; consequences without a figure are judgement, not measured. Any change may
//! move the golden hashes. Tolerances of rounding stand in the formulas that they belong to.

/// Separation up to which contacts are looked for, beside the motion of the step, metres.
///
/// Sums of rounding and of what a step may add to a motion must stay below it. Larger: more pairs near each other that never touch. Smaller:
/// what is pushed within a step arrives without a contact. Shown by the tests of `touches`.
pub(crate) const MARGIN: f32 = 0.02;

/// Slops within which shapes of the ground count as abutting, a number.
///
/// Below 1: a step of 5 mm is one. Larger: steps and gaps that are meant do not stop what is small. Smaller: levels put together by hand have
/// edges between their boxes. Shown by the tests of `seams`.
pub(crate) const SEAM_SLOPS: f32 = 0.9;

/// Slops by which what comes to the next shape of the ground may be in its plane before it is over it, a number.
///
/// Larger: what comes up to the crest of a hill is lifted before. Smaller: what rests lower than its surface falls in before it is over the
/// next. Shown by the tests of `seams`.
pub(crate) const SEAM_REACH: f32 = 1.0;

/// Room that the fat bounds of what moves have beyond what they need, metres.
///
/// What trembles or settles keeps its place in the tree. Larger: more candidate pairs. Smaller: more leaves move. Changes no result but the
/// order of work; shown by `cargo xtask bench --trace wave_pile`.
pub(crate) const BOUNDS_ROOM: f32 = 0.04;

/// Room that the fat bounds of small kinematic bodies have beyond what they need, metres: of those of one shape that reach no farther than
/// twice that.
///
/// Most of them are parts of characters, which swing to and fro and meet nobody: as long as they stay within this room nothing but their
/// place is looked at. Larger: more candidate pairs, rays go through more boxes. Smaller: more leaves move. Changes no result but the order of
/// work; shown by `walkers_step` of `cargo xtask bench --counts`.
pub(crate) const BOUNDS_ROOM_LED: f32 = 0.3;

/// Steps of motion at the present velocity that the fat bounds of small kinematic bodies have room for ahead, a number.
///
/// Larger: longer bounds, more candidate pairs. Smaller: more leaves move. Shown as [`BOUNDS_ROOM_LED`].
pub(crate) const BOUNDS_STEPS_LED: f32 = 12.0;

/// Steps of motion at the present velocity that fat bounds have room for ahead, a number.
///
/// Larger: longer bounds, more candidate pairs. Smaller: what moves asks the tree anew more often. Shown by `cargo xtask bench --trace
/// box_rain`.
pub(crate) const BOUNDS_STEPS: f32 = 3.0;

/// Steps of motion that the fat bounds of what meets nobody have room for, a number.
///
/// Nothing but rays and the like asks for them. Larger: rays go through more boxes. Smaller: the leaves of what flies move more often. Shown
/// as [`BOUNDS_STEPS`].
pub(crate) const BOUNDS_STEPS_ALONE: f32 = 12.0;

/// Multiple of their room by which fat bounds may exceed those that are needed before they are made smaller, a ratio.
///
/// Larger: what has come to rest keeps the long bounds of its flight, and pairs with them. Smaller: bounds of what slows down are made again
/// and again. Shown as [`BOUNDS_STEPS`].
pub(crate) const BOUNDS_EXCESS: f32 = 3.0;

/// Length by which a gap that was found may be less than it seems, metres.
///
/// Points of manifolds may lie outside of the faces that they are cut to by up to half a millimetre. Larger: pairs that motion cannot close
/// are looked at sooner. Smaller than that half: a contact may come late. Shown by the tests of `touches`.
pub(crate) const GAP_ERROR: f32 = 0.001;

/// Separation up to which points of a manifold are made for what hardly moves, in slops.
///
/// A box that rocks must find the points of its other edge. Larger: more points that never push. Smaller: what rocks falls onto its edge
/// before it has a row. Shown by `jenga` and the tests of `stacks`.
pub(crate) const SPECULATIVE_SLOPS: f32 = 4.0;

/// Slip of two bodies past each other until their manifold is found anew, in slops: 2 mm of crates.
///
/// Larger: points stand where the faces no longer meet, and piles creep. Smaller: fewer manifolds are recycled. Shown by `large_pyramid`,
/// `jenga`.
pub(crate) const RECYCLED_SLIP: f32 = 0.4;

/// Cosine of half the turn of one body against the other, 1°, from which on their manifold is found anew.
///
/// A larger turn: what tips over stands on the points of its face. A smaller one: fewer manifolds are recycled. Shown by `dominoes`, `cards`.
pub(crate) const RECYCLED_HALF_TURN: f32 = 0.999_962;

/// Cosine of the turn of a normal, 25°, after which a part of a pair is another one.
///
/// A larger turn: impulses of one slope go on to another. A smaller one: what rolls over a mesh loses its warm start. Shown by `mesh_drop`.
pub(crate) const SAME_PART_COSINE: f32 = 0.9;

/// Share of the speed that a pair came in with above which it has not been stopped yet, a ratio.
///
/// Larger: a hit that takes several steps is told of in parts. Smaller: it is told of late. Shown by the tests of `events`.
pub(crate) const STILL_COMING: f32 = 0.1;

/// Sine of the angle between two edges up to which their manifold is found anew.
///
/// Larger: fewer manifolds are recycled. Smaller: the direction across two edges that are nearly parallel is rounding. Shown by `rocks`.
pub(crate) const RECYCLED_SINE: f32 = 0.005;
