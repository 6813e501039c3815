//! Behaviour constants of movers: the numbers an engineer would tune.
//!
//! Each comment states the unit, the reason, the effect of a larger and a smaller value, and the scene (`sinew run
//! NAME`) or test (`crates/sinew_physics/tests/it`) that shows it. Effects without a figure are judgement, not
//! measurement. Any change may move the golden hashes. Rounding tolerances are in the formulas they belong to.

/// Distance at which a sweep stops in front of an obstacle, in skins.
///
/// Larger: movers stay farther from walls than necessary. Smaller: rounding puts them inside their obstacles. Shown by
/// the tests of `mover`.
pub(super) const STOP_SKIN: f32 = 0.75;

/// Gap beyond the skin that counts as touching, in skins.
///
/// Larger: closely passed obstacles stop a slide. Smaller: touches are lost between two sweeps. Shown by the tests of
/// `mover`.
pub(super) const TOUCH_SKIN: f32 = 0.05;

/// Gap beyond the skin within which ground supports, in skins.
///
/// Larger: a mover stands on nothing beside an edge. Smaller: on uneven ground it falls for moments. Shown by
/// `mover_course` and the tests of `mover`.
pub(super) const BEARING_SKIN: f32 = 0.5;

/// Distance from the end of a motion that counts as reached, in skins.
///
/// Larger: slow movers do not move. Smaller: sweeps continue for rounding. Shown by the tests of `mover`.
pub(super) const ARRIVED_SKIN: f32 = 0.02;

/// Largest distance between faces that count as coplanar, in skins.
///
/// Larger: small steps count as even ground. Smaller: movers stumble over the seams of meshes. Shown by the tests of
/// `mover`.
pub(super) const COPLANAR_SKIN: f32 = 0.04;

/// Length of one slide away from an obstacle that is too near, in skins.
///
/// Larger: movers jump away from approaching obstacles. Smaller: they stay wedged between two walls. Shown by the tests
/// of `mover`.
pub(super) const SLIDE_AWAY: f32 = 0.3;

/// Largest length of a slide along walls, as a multiple of the remaining motion.
///
/// Larger: a mover wedged between crates shoots up between them. Smaller: it stops where a steep slope leads it on.
/// Shown by the test `mover::an_upward_cleft_does_not_eject_a_mover`.
pub(super) const LONGEST_DETOUR: f32 = 4.0;

/// Largest length of a displacement out of walls, as a multiple of the largest penetration: that of a wedge of 4°.
///
/// Larger: a mover wedged between crates is pushed up between them. Smaller: it stays in sharp corners. Shown by the
/// test `mover::an_upward_cleft_does_not_eject_a_mover`.
pub(super) const LONGEST_WAY_OUT: f32 = 32.0;

/// Length of a motion that continues beside a face that it may reach, in radii.
///
/// Larger: slides past corners need more sweeps. Smaller: a mover hits a face without warning. Shown by the tests of
/// `mover`.
pub(super) const BESIDE_RADIUS: f32 = 0.1;

/// Speed above which a body counts as flying and may pass through a mover that allows it, m/s.
///
/// Larger: thrown objects bounce off the mover instead of hitting its limbs. Smaller: pushed objects pass through.
/// Shown by the tests of `mover`.
pub(super) const FLYING_SPEED: f32 = 2.0;

/// Share of an overlap resolved per second, 1/s.
///
/// Larger: obstacles that a mover walks into are thrown. Smaller: they stay inside the mover. Shown by `mover_course`.
pub(super) const LEAVE_RATE: f32 = 12.0;

/// Largest speed at which a body leaves an overlap, m/s.
///
/// Larger: bodies that spawn inside a mover shoot away. Smaller: crowds stay wedged. Shown by `mover_course`.
pub(super) const LEAVE_SPEED: f32 = 1.0;

/// Upward component of a contact normal above which one supports the other, a cosine: 45°.
///
/// Larger: a mover on a slope pushes it away. Smaller: it stands on objects it leans against. Shown by `mover_course`.
pub(super) const BEARING_COSINE: f32 = 0.7;

/// Distance around its path within which a mover tests for approaching bodies, metres.
///
/// Larger: more obstacles to test. Smaller: fast bodies are detected too late. Shown by the tests of `mover`.
pub(super) const LOOK_AHEAD: f32 = 0.5;

/// Distance behind an edge at which a tread is searched, metres.
///
/// Larger: narrow treads are missed. Smaller: rounding puts the look before the edge. Shown by `stairs` and the tests of `mover`.
pub(super) const BEHIND_EDGE: f32 = 0.01;

/// Distance above and below an edge at which a tread is searched, metres.
///
/// Larger: a mover steps onto walls. Smaller: rounded edges are not treads. Shown by the tests of `mover`.
pub(super) const OVER_EDGE: f32 = 0.03;

/// Missing share of a motion above which something other than the ground's slope has stopped it, a ratio.
///
/// Larger: low steps slow a mover instead of being climbed. Smaller: it tries to climb on every slope. Shown by `mover_course`.
pub(super) const STOPPED_SHARE: f32 = 0.02;

/// Share of its motion below which a fall counts as wedged, a ratio.
///
/// Larger: a slow fall along a wall counts as ground. Smaller: movers in a cleft fall forever. Shown by the tests of
/// `mover`.
pub(super) const WEDGED_SHARE: f32 = 0.02;

/// Acceleration with which a dynamic body carries a mover that stands on it, m/s²: friction of soles.
///
/// Larger: a mover on a hand that jerks away is flung with it. Smaller: riders slide on crates that start moving.
/// Shown by the tests of `mover`.
pub(super) const GRIP: f32 = 20.0;
