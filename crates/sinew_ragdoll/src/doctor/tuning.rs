//! Constants of behaviour of the doctor's findings and cures: numbers that an engineer would turn.
//!
//! Each says its unit and space, what a larger and a smaller one does, and the tests
//! (`crates/sinew_ragdoll/tests/it`) where that is to be seen; consequences without a figure are judgement, not measured.

use crate::tuning::TOLERATED;

// doctor/anatomy.rs

/// Usual height of a person, metres.
///
/// Only told. Shown by the tests of `doctor`.
pub(crate) const USUAL_HEIGHT: f32 = 1.7;

/// Confidence of a role below which it is told of, 0 to 1.
///
/// Larger: findings on every rig. Smaller: wrong roles are passed over. Shown by the tests of `doctor`.
pub(crate) const UNCERTAIN: f32 = 0.4;

// doctor/limits.rs

/// Angle by which a joint may be beyond a limit in the bind pose, radians (1°).
///
/// Larger: what snaps at the start is passed over. Smaller: rounding is told of. Shown by the tests of `doctor`.
pub(crate) const BEYOND_AT_BIND: f32 = 0.017_453;

/// Difference of two frames in the bind pose from which on they have another zero, radians (5°).
///
/// Larger: limits that are shifted are passed over. Smaller: findings on rigs that were bent by hand. Shown by the tests of `doctor`.
pub(crate) const OTHER_ZERO: f32 = 0.087;

/// Width from which on a range is no limit, radians (350°).
///
/// Larger: limits that never stop are passed over. Smaller: wide shoulders are told of. Shown by the tests of `doctor`.
pub(crate) const NO_LIMIT: f32 = 6.1;

/// Width below which a range jitters, unless it is locked, radians (5°).
///
/// Larger: findings on stiff spines. Smaller: jitter is passed over. Shown by the tests of `doctor`.
pub(crate) const NARROW: f32 = 0.087;

/// Width below which a range is locked, radians (0.5°).
///
/// Larger: jitter counts as locked. Smaller: locks of other programs are told of. Shown by the tests of `doctor`.
pub(crate) const LOCKED: f32 = 0.008_8;

/// Angle beyond straight that a knee or elbow may go, radians (20°).
///
/// Larger: knees that bend backwards are passed over. Smaller: supple ones are told of. Shown by the tests of `doctor`.
pub(crate) const BACKWARDS: f32 = 0.349;

// doctor/masses.rs

/// Largest ratio of masses across a joint.
///
/// Larger: chains that take more sweeps are passed over. Smaller: findings on hands and heads. Shown by the tests of `doctor`.
pub(crate) const NEIGHBOUR_RATIO: f32 = 30.0;

/// Largest ratio of masses along a chain from the root.
///
/// As [`NEIGHBOUR_RATIO`].
pub(crate) const CHAIN_RATIO: f32 = 100.0;

/// Largest ratio of the moments of one body.
///
/// Larger: bodies that spin up about their long axis are passed over. Smaller: findings on forearms. Shown by the tests of `doctor`.
pub(crate) const MOMENT_RATIO: f32 = 60.0;

// doctor/mend.rs

/// Room that the bind pose gets to a limit that it had passed, radians (2°).
///
/// Larger: wider limits than were asked for. Smaller: it overshoots at once. Shown by the tests of `doctor`.
pub(crate) const MENDED_ROOM: f32 = 0.034_907;

/// Angle by which a joint may be beyond its limits without moving anything, radians (0.1°).
///
/// Larger: cures that still snap. Smaller: rounding is cured. Shown by the tests of `doctor`.
pub(crate) const STRAIN: f32 = 0.001_745;

// doctor/mirror.rs

/// Difference of the whole ranges of two sides from which on it is told of, radians (8°).
///
/// Larger: lopsided limits are passed over. Smaller: findings on learned ones. Shown by the tests of `doctor`.
pub(crate) const WIDTH_APART: f32 = 0.14;

/// Difference of the ends of the ranges of two sides from which on it is told of, radians (15°): rigs are not bound quite
/// symmetrically.
///
/// As [`WIDTH_APART`].
pub(crate) const ENDS_APART: f32 = 0.262;

/// Largest ratio of the volumes of two sides.
///
/// Larger: lopsided shapes are passed over. Smaller: findings on figures with one glove. Shown by the tests of `doctor`.
pub(crate) const VOLUMES_APART: f32 = 1.6;

/// Largest ratio of the lengths of two sides.
///
/// As [`VOLUMES_APART`].
pub(crate) const LENGTHS_APART: f32 = 1.3;

// doctor/motion.rs

/// Least motion that is worth telling, as a share of the height.
///
/// Larger: what explodes slowly is passed over. Smaller: findings on what only settles. Shown by the tests of `doctor`.
pub(crate) const MOVED_SHARE: f32 = 0.015;

/// Least motion that is worth telling besides [`MOVED_SHARE`], metres: two tolerated overlaps.
///
/// As [`MOVED_SHARE`].
pub(crate) const MOVED_LENGTH: f32 = 2.0 * TOLERATED;

/// Least turn that is worth telling, radians (6°).
///
/// As [`MOVED_SHARE`].
pub(crate) const TURNED: f32 = 0.105;

// doctor/shapes.rs

/// Least thickness of a shape, as a share of the height.
///
/// Larger: findings on fingers. Smaller: shapes that fall through edges are passed over. Shown by the tests of `doctor`.
pub(crate) const THIN: f32 = 0.002;

/// Longest part of a human, as a share of the height.
///
/// Larger: a shape over several parts is passed over. Smaller: findings on capes. Shown by the tests of `doctor`.
pub(crate) const LONG: f32 = 0.62;

/// Longest body of a creature, in lengths of the box around all pivots and middles.
///
/// As [`LONG`].
pub(crate) const LONG_CREATURE: f32 = 1.5;

/// Share of a joint's range, 0 to 1, from which on a pair that overlaps in it fights the limit.
///
/// Larger: jitter is passed over. Smaller: findings on thighs that touch. Shown by the tests of `doctor`.
pub(crate) const FIGHT: f32 = 0.6;
