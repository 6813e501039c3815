//! Behaviour constants of the doctor's findings and cures: the numbers an engineer would tune.
//!
//! Each comment states the unit and space, the effect of a larger and a smaller value, and the tests
//! (`crates/sinew_ragdoll/tests/it`) that show it. Effects without a figure are judgement, not measurement.

use crate::tuning::TOLERATED;

// doctor/anatomy.rs

/// Usual height of a person, metres.
///
/// Affects only reports. Shown by the tests of `doctor`.
pub(crate) const USUAL_HEIGHT: f32 = 1.7;

/// Confidence of a role below which the doctor reports it, 0 to 1.
///
/// Larger: findings on every rig. Smaller: misses wrong roles. Shown by the tests of `doctor`.
pub(crate) const UNCERTAIN: f32 = 0.4;

// doctor/limits.rs

/// Angle by which a joint may exceed a limit in the bind pose, radians (1°).
///
/// Larger: misses joints that snap at the start. Smaller: reports rounding. Shown by the tests of `doctor`.
pub(crate) const BEYOND_AT_BIND: f32 = 0.017_453;

/// Difference of two frames in the bind pose above which their zero counts as shifted, radians (5°).
///
/// Larger: misses shifted limits. Smaller: findings on rigs bent by hand. Shown by the tests of `doctor`.
pub(crate) const OTHER_ZERO: f32 = 0.087;

/// Width from which on a range is no limit, radians (350°).
///
/// Larger: misses limits that never stop a joint. Smaller: reports wide shoulders. Shown by the tests of `doctor`.
pub(crate) const NO_LIMIT: f32 = 6.1;

/// Width below which a range jitters, unless it is locked, radians (5°).
///
/// Larger: findings on stiff spines. Smaller: misses jitter. Shown by the tests of `doctor`.
pub(crate) const NARROW: f32 = 0.087;

/// Width below which a range is locked, radians (0.5°).
///
/// Larger: counts jitter as locked. Smaller: reports locks from other programs. Shown by the tests of `doctor`.
pub(crate) const LOCKED: f32 = 0.008_8;

/// Angle beyond straight that a knee or elbow may go, radians (20°).
///
/// Larger: misses knees that bend backwards. Smaller: reports supple ones. Shown by the tests of `doctor`.
pub(crate) const BACKWARDS: f32 = 0.349;

// doctor/masses.rs

/// Largest ratio of masses across a joint.
///
/// Larger: misses chains that need more sweeps. Smaller: findings on hands and heads. Shown by the tests of `doctor`.
pub(crate) const NEIGHBOUR_RATIO: f32 = 30.0;

/// Largest ratio of masses along a chain from the root.
///
/// As [`NEIGHBOUR_RATIO`].
pub(crate) const CHAIN_RATIO: f32 = 100.0;

/// Largest ratio of the moments of one body.
///
/// Larger: misses bodies that spin up about their long axis. Smaller: findings on forearms. Shown by the tests of
/// `doctor`.
pub(crate) const MOMENT_RATIO: f32 = 60.0;

// doctor/mend.rs

/// Margin between the bind pose and a limit that a cure widens, radians (2°).
///
/// Larger: limits wider than needed. Smaller: the joint overshoots at once. Shown by the tests of `doctor`.
pub(crate) const WIDENED_MARGIN: f32 = 0.034_907;

/// Angle by which a joint may exceed its limits without moving anything, radians (0.1°).
///
/// Larger: cures that still snap. Smaller: cures rounding. Shown by the tests of `doctor`.
pub(crate) const STRAIN: f32 = 0.001_745;

// doctor/mirror.rs

/// Difference between the total ranges of left and right above which the doctor reports it, radians (8°).
///
/// Larger: misses lopsided limits. Smaller: findings on learned limits. Shown by the tests of `doctor`.
pub(crate) const WIDTH_APART: f32 = 0.14;

/// Difference between the range ends of left and right above which the doctor reports it, radians (15°): rigs are not
/// bound quite symmetrically.
///
/// As [`WIDTH_APART`].
pub(crate) const ENDS_APART: f32 = 0.262;

/// Largest ratio of the volumes of two sides.
///
/// Larger: misses lopsided shapes. Smaller: findings on figures with one glove. Shown by the tests of `doctor`.
pub(crate) const VOLUMES_APART: f32 = 1.6;

/// Largest ratio of the lengths of two sides.
///
/// As [`VOLUMES_APART`].
pub(crate) const LENGTHS_APART: f32 = 1.3;

// doctor/motion.rs

/// Smallest motion worth reporting, as a share of the height.
///
/// Larger: misses slow explosions. Smaller: findings on figures that only settle. Shown by the tests of `doctor`.
pub(crate) const MOVED_SHARE: f32 = 0.015;

/// Smallest motion worth reporting in addition to [`MOVED_SHARE`], metres: two tolerated overlaps.
///
/// As [`MOVED_SHARE`].
pub(crate) const MOVED_LENGTH: f32 = 2.0 * TOLERATED;

/// Smallest rotation worth reporting, radians (6°).
///
/// As [`MOVED_SHARE`].
pub(crate) const TURNED: f32 = 0.105;

// doctor/shapes.rs

/// Least thickness of a shape, as a share of the height.
///
/// Larger: findings on fingers. Smaller: misses shapes that fall through edges. Shown by the tests of `doctor`.
pub(crate) const THIN: f32 = 0.002;

/// Longest part of a human, as a share of the height.
///
/// Larger: misses a shape that spans several parts. Smaller: findings on capes. Shown by the tests of `doctor`.
pub(crate) const LONG: f32 = 0.62;

/// Longest body of a creature, in lengths of the box around all pivots and middles.
///
/// As [`LONG`].
pub(crate) const LONG_CREATURE: f32 = 1.5;

/// Share of a joint's range, 0 to 1, from which on a pair that overlaps in it fights the limit.
///
/// Larger: misses jitter. Smaller: findings on thighs that touch. Shown by the tests of `doctor`.
pub(crate) const FIGHT: f32 = 0.6;
