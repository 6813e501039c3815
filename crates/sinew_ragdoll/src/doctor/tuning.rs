//! Behaviour constants of the doctor's findings and cures: the numbers an engineer would tune.
//!
//! Each comment states the unit and space, the effect of a larger and a smaller value, and the tests
//! (`crates/sinew_ragdoll/tests/it`) that show it. Effects without a number are judgement, not measurement.

use crate::tuning::TOLERATED;

// doctor/anatomy.rs

/// Usual height of a person, metres.
///
/// The height affects only reports. Shown by the tests of `doctor`.
pub(crate) const USUAL_HEIGHT: f32 = 1.7;

/// Confidence of a role below which the doctor reports it, 0 to 1.
///
/// Larger: every rig gets findings. Smaller: wrong roles are missed. Shown by the tests of `doctor`.
pub(crate) const UNCERTAIN: f32 = 0.4;

// doctor/limits.rs

/// Angle by which a joint may exceed a limit in the bind pose, radians (1°).
///
/// Larger: joints that snap at the start are missed. Smaller: rounding is reported. Shown by the tests of `doctor`.
pub(crate) const BEYOND_AT_BIND: f32 = 0.017_453;

/// Rotation between two joint frames in the bind pose above which their zero counts as shifted, radians (5°).
///
/// Larger: shifted limits are missed. Smaller: rigs bent by hand get findings. Shown by the tests of `doctor`.
pub(crate) const OTHER_ZERO: f32 = 0.087;

/// Width from which a range counts as no limit, radians (350°).
///
/// Larger: limits that never stop a joint are missed. Smaller: wide shoulders are reported. Shown by the tests of
/// `doctor`.
pub(crate) const NO_LIMIT: f32 = 6.1;

/// Width below which a range jitters, unless it is locked, radians (5°).
///
/// Larger: stiff spines get findings. Smaller: jitter is missed. Shown by the tests of `doctor`.
pub(crate) const NARROW: f32 = 0.087;

/// Width below which a range counts as locked, radians (0.5°).
///
/// Larger: jitter counts as locked. Smaller: locks from other programs are reported. Shown by the tests of `doctor`.
pub(crate) const LOCKED: f32 = 0.008_8;

/// Largest angle beyond straight of a knee or elbow, radians (20°).
///
/// Larger: knees that bend backwards are missed. Smaller: supple knees are reported. Shown by the tests of `doctor`.
pub(crate) const BACKWARDS: f32 = 0.349;

// doctor/masses.rs

/// Largest ratio of masses across a joint.
///
/// Larger: chains that need more sweeps are missed. Smaller: hands and heads get findings. Shown by the tests of
/// `doctor`.
pub(crate) const NEIGHBOUR_RATIO: f32 = 30.0;

/// Largest ratio of masses along a chain from the root.
///
/// As [`NEIGHBOUR_RATIO`].
pub(crate) const CHAIN_RATIO: f32 = 100.0;

/// Largest ratio of the principal moments of one body.
///
/// Larger: bodies that spin up about their long axis are missed. Smaller: forearms get findings. Shown by the tests of
/// `doctor`.
pub(crate) const MOMENT_RATIO: f32 = 60.0;

// doctor/mend.rs

/// Margin between the bind pose and a limit that a cure widens, radians (2°).
///
/// Larger: limits are wider than necessary. Smaller: the joint overshoots from the start. Shown by the tests of
/// `doctor`.
pub(crate) const WIDENED_MARGIN: f32 = 0.034_907;

/// Angle up to which a joint may exceed its limits without moving a body, radians (0.1°).
///
/// Larger: cured joints still snap. Smaller: rounding is cured. Shown by the tests of `doctor`.
pub(crate) const STRAIN: f32 = 0.001_745;

// doctor/mirror.rs

/// Difference between the total ranges of left and right above which the doctor reports it, radians (8°).
///
/// Larger: asymmetric limits are missed. Smaller: learned limits get findings. Shown by the tests of `doctor`.
pub(crate) const WIDTH_APART: f32 = 0.14;

/// Difference between the range ends of left and right above which the doctor reports it, radians (15°). Rigs are not
/// bound quite symmetrically.
///
/// As [`WIDTH_APART`].
pub(crate) const ENDS_APART: f32 = 0.262;

/// Largest ratio of the volumes of two sides.
///
/// Larger: asymmetric shapes are missed. Smaller: ragdolls with one glove get findings. Shown by the tests of `doctor`.
pub(crate) const VOLUMES_APART: f32 = 1.6;

/// Largest ratio of the lengths of two sides.
///
/// As [`VOLUMES_APART`].
pub(crate) const LENGTHS_APART: f32 = 1.3;

// doctor/motion.rs

/// Smallest motion worth reporting, as a share of the height.
///
/// Larger: slow explosions are missed. Smaller: ragdolls that only settle get findings. Shown by the tests of `doctor`.
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
/// Larger: fingers get findings. Smaller: shapes that fall through edges are missed. Shown by the tests of `doctor`.
pub(crate) const THIN: f32 = 0.002;

/// Longest part of a human, as a share of the height.
///
/// Larger: a shape that spans several parts is missed. Smaller: capes get findings. Shown by the tests of `doctor`.
pub(crate) const LONG: f32 = 0.62;

/// Longest body of a creature, over the length of the box around all pivots and centres.
///
/// As [`LONG`].
pub(crate) const LONG_CREATURE: f32 = 1.5;

/// Share of a joint's range, 0 to 1, from which a pair that overlaps in it works against the limit.
///
/// Larger: jitter is missed. Smaller: thighs that touch get findings. Shown by the tests of `doctor`.
pub(crate) const FIGHT: f32 = 0.6;
