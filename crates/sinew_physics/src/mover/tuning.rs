//! Behaviour constants of movers: the numbers an engineer would tune.
//!
//! Each comment states the unit, the reason, the effect of a larger and a smaller value, and the scene (`sinew run
//! NAME`) or test (`crates/sinew_physics/tests/it`) that shows it. Effects without a number are judgement, not
//! measurement. Any change may move the golden hashes. Rounding tolerances are in the formulas they belong to.

/// Distance at which a sweep stops in front of an obstacle, in skins.
///
/// Larger: movers stay farther from walls than necessary. Smaller: rounding moves them into their obstacles. Shown by
/// the tests of `mover`.
pub(super) const STOP_SKIN: f32 = 0.75;

/// Gap beyond the skin that counts as touching, in skins.
///
/// Larger: obstacles that a mover passes closely stop its slide. Smaller: the mover loses touches between two sweeps.
/// Shown by the tests of `mover`.
pub(super) const TOUCH_SKIN: f32 = 0.05;

/// Gap beyond the skin within which ground supports, in skins.
///
/// Larger: a mover stands on nothing beside an edge. Smaller: the mover falls for moments on uneven ground. Shown by
/// `mover_course` and the tests of `mover`.
pub(super) const BEARING_SKIN: f32 = 0.5;

/// Distance from the end of a motion that counts as reached, in skins.
///
/// Larger: slow movers do not move. Smaller: sweeps run more iterations to remove rounding errors. Shown by the tests
/// of `mover`.
pub(super) const ARRIVED_SKIN: f32 = 0.02;

/// Largest distance between faces that count as coplanar, in skins.
///
/// Larger: movers treat small steps as even ground. Smaller: movers stumble over the seams of meshes. Shown by the
/// tests of `mover`.
pub(super) const COPLANAR_SKIN: f32 = 0.04;

/// Length of one slide away from an obstacle that is too near, in skins.
///
/// Larger: movers jump away from approaching obstacles. Smaller: movers stay wedged between two walls. Shown by the
/// tests of `mover`.
pub(super) const SLIDE_AWAY: f32 = 0.3;

/// Largest length of a slide along walls, as a multiple of the remaining motion.
///
/// Larger: a mover wedged between crates shoots up between them. Smaller: the mover stops where a steep slope would
/// guide its slide. Shown by the test `mover::an_upward_cleft_does_not_eject_a_mover`.
pub(super) const LONGEST_DETOUR: f32 = 4.0;

/// Largest length of a displacement out of walls, as a multiple of the largest penetration; a wedge of 4° needs this
/// multiple.
///
/// Larger: the recovery pushes a mover wedged between crates up between them. Smaller: the mover stays in sharp
/// corners. Shown by the test `mover::an_upward_cleft_does_not_eject_a_mover`.
pub(super) const LONGEST_WAY_OUT: f32 = 32.0;

/// Length of one sweep step past a face that the motion may still reach, in radii of the capsule.
///
/// Larger: a sweep past a corner may pass a face that it should hit. Smaller: slides past corners need more iterations.
/// Shown by the tests of `mover`.
pub(super) const BESIDE_RADIUS: f32 = 0.1;

/// Speed above which a body counts as flying and may pass through a mover that allows it, m/s.
///
/// Larger: thrown objects bounce off the mover instead of hitting its limbs. Smaller: objects that the mover pushes
/// pass through it. Shown by the tests of `mover`.
pub(super) const FLYING_SPEED: f32 = 2.0;

/// Rate at which an overlap is resolved, 1/s.
///
/// Larger: a mover throws the obstacles that it walks into. Smaller: obstacles stay inside the mover. Shown by
/// `mover_course`.
pub(super) const LEAVE_RATE: f32 = 12.0;

/// Largest speed at which a body leaves an overlap, m/s.
///
/// Larger: bodies that spawn inside a mover shoot away. Smaller: crowds of bodies stay wedged. Shown by `mover_course`.
pub(super) const LEAVE_SPEED: f32 = 1.0;

/// Upward component of a contact normal above which the body counts as supporting the mover, a cosine: 45°.
///
/// Larger: a mover on a sloping body pushes the body away. Smaller: a mover stands on objects that it leans against.
/// Shown by `mover_course`.
pub(super) const BEARING_COSINE: f32 = 0.7;

/// Distance around its path within which a mover tests for obstacles, metres.
///
/// Larger: the mover tests more obstacles. Smaller: the mover detects fast bodies too late. Shown by the tests of
/// `mover`.
pub(super) const LOOK_AHEAD: f32 = 0.5;

/// Distance behind an edge at which a ray tests for a tread, metres.
///
/// Larger: movers miss narrow treads. Smaller: rounding starts the ray before the edge. Shown by `stairs` and the tests
/// of `mover`.
pub(super) const BEHIND_EDGE: f32 = 0.01;

/// Distance above and below an edge within which a ray tests for a tread, metres.
///
/// Larger: a mover steps onto walls. Smaller: the mover does not accept treads with rounded edges. Shown by the tests
/// of `mover`.
pub(super) const OVER_EDGE: f32 = 0.03;

/// Missing share of a motion above which an obstacle, not the ground's slope, must have stopped it, a ratio.
///
/// Larger: low steps slow a mover instead of being climbed. Smaller: the mover tries to climb on every slope. Shown by
/// `mover_course`.
pub(super) const STOPPED_SHARE: f32 = 0.02;

/// Share of the intended fall below which a falling mover counts as wedged, a ratio.
///
/// Larger: a mover that falls slowly along a wall counts as grounded. Smaller: movers in a cleft fall forever. Shown by
/// the tests of `mover`.
pub(super) const WEDGED_SHARE: f32 = 0.02;

/// Largest acceleration with which a dynamic body carries a mover that stands on it, m/s²: friction of soles.
///
/// Larger: a mover on a suddenly moving hand is thrown with the hand. Smaller: movers slide on crates that start to
/// move. Shown by the tests of `mover`.
pub(super) const GRIP: f32 = 20.0;
