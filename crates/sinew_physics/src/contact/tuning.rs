//! Behaviour constants of contacts and their search: the numbers an engineer would tune.
//!
//! Each comment states the unit, the reason, the effect of a larger and a smaller value, and the scene (`sinew run
//! NAME`) or test (`crates/sinew_physics/tests/it`) that shows it. Effects without a number are judgement, not
//! measurement. Any change may move the golden hashes. Rounding tolerances are in the formulas they belong to.

/// Separation up to which contacts are searched, in addition to the motion of the step, metres.
///
/// Must exceed the sum of rounding errors and motion added within a step. Larger: the step tests more near pairs that
/// never touch. Smaller: bodies pushed within a step meet without a contact. Shown by the tests of `touches`.
pub(crate) const MARGIN: f32 = 0.02;

/// Slops within which shapes of the ground count as abutting, a number.
///
/// Below 1, so that a step of 5 mm counts as a step. Larger: intended steps and gaps do not stop small bodies. Smaller:
/// bodies catch on edges between the boxes of levels assembled by hand. Shown by the tests of `seams`.
pub(crate) const SEAM_SLOPS: f32 = 0.9;

/// Depth below the plane of the next ground shape up to which a point gets a contact before it is over that shape, in
/// slops.
///
/// Larger: bodies are lifted before a hill's crest. Smaller: bodies that rest slightly below the surface sink at the
/// border to the next shape. Shown by the tests of `seams`.
pub(crate) const SEAM_REACH: f32 = 1.0;

/// Margin of the fat bounds of moving shapes, metres.
///
/// Within the margin, bodies that vibrate or settle keep their leaf. Larger: the step tests more candidate pairs.
/// Smaller: more leaves move. Changes only the order of work; shown by `cargo xtask bench --trace wave_pile`.
pub(crate) const BOUNDS_ROOM: f32 = 0.04;

/// Margin of the fat bounds of small kinematic bodies, metres: of bodies with one shape and a radius of at most twice
/// the margin.
///
/// Most of them are parts of characters, which swing back and forth without contacts: while they stay within this
/// margin the step tests only their position. Larger: the step tests more candidate pairs, and rays test more boxes.
/// Smaller: more leaves move. Changes only the order of work; shown by `walkers_step` of `cargo xtask bench --counts`.
pub(crate) const BOUNDS_ROOM_LED: f32 = 0.3;

/// Number of steps of motion at the current velocity that the fat bounds of small kinematic bodies include.
///
/// Larger: bounds are longer and make more candidate pairs. Smaller: more leaves move. Shown by the same count as
/// [`BOUNDS_ROOM_LED`].
pub(crate) const BOUNDS_STEPS_LED: f32 = 12.0;

/// Number of steps of motion at the current velocity that fat bounds include.
///
/// Larger: bounds are longer and make more candidate pairs. Smaller: moving bodies search the tree more often. Shown by
/// `cargo xtask bench --trace box_rain`.
pub(crate) const BOUNDS_STEPS: f32 = 3.0;

/// Steps of motion included in the fat bounds of shapes that collide with nothing, a number.
///
/// Only rays and other queries use these bounds. Larger: rays test more boxes. Smaller: leaves of flying bodies move more
/// often. Shown by the same bench as [`BOUNDS_STEPS`].
pub(crate) const BOUNDS_STEPS_ALONE: f32 = 12.0;

/// Factor on the margin above which oversized fat bounds are shrunk, a ratio.
///
/// Larger: bodies at rest keep the long bounds of their flight, with many candidate pairs. Smaller: the bounds of
/// slowing bodies are rebuilt repeatedly. Shown by the same bench as [`BOUNDS_STEPS`].
pub(crate) const BOUNDS_EXCESS: f32 = 3.0;

/// Error by which a computed gap may be too large, metres.
///
/// Manifold points may be outside their clipping faces by up to half a millimetre. Larger: pairs are tested earlier
/// than their motion requires. Smaller than half a millimetre: a contact may come late. Shown by the tests of
/// `touches`.
pub(crate) const GAP_ERROR: f32 = 0.001;

/// Separation up to which a nearly static pair gets manifold points, in slops.
///
/// A rocking box needs the points of its other edge. Larger: manifolds have more points that never push. Smaller: a
/// rocking box falls onto an edge that has no contact point yet. Shown by `jenga` and the tests of `stacks`.
pub(crate) const SPECULATIVE_SLOPS: f32 = 4.0;

/// Slip between two bodies up to which their manifold is recycled, in slops: 2 mm for crates.
///
/// Larger: points remain where the faces no longer touch, and piles creep. Smaller: the step recomputes more manifolds.
/// Shown by `large_pyramid`, `jenga`.
pub(crate) const RECYCLED_SLIP: f32 = 0.4;

/// Cosine of half the relative rotation, 1°, up to which a manifold is recycled.
///
/// Larger angle: a tipping body keeps the contact points of a whole face. Smaller angle: the step recomputes more
/// manifolds. Shown by `dominoes`, `cards`.
pub(crate) const RECYCLED_HALF_TURN: f32 = 0.999_962;

/// Cosine of the normal's rotation, 25°, beyond which a part of a pair counts as a new one.
///
/// A larger angle: impulses move from one slope to another. A smaller angle: bodies rolling over a mesh lose their warm
/// start. Shown by `mesh_drop`.
pub(crate) const SAME_PART_COSINE: f32 = 0.9;

/// Remaining share of a pair's approach speed above which a hit is still in progress, a ratio.
///
/// Larger: a hit over several steps is reported in parts. Smaller: a hit is reported late. Shown by the tests of
/// `events`.
pub(crate) const STILL_COMING: f32 = 0.1;

/// Sine of the angle between two edges up to which their manifold is always recomputed.
///
/// Larger: the step recomputes more manifolds. Smaller: the cross product of nearly parallel edges is only rounding
/// error. Shown by `rocks`.
pub(crate) const RECYCLED_SINE: f32 = 0.005;
