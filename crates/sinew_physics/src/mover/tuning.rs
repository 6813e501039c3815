//! Constants of behaviour of movers: numbers that an engineer would turn.
//!
//! Each says its unit, why it is what it is, what a larger and a smaller one does, and the scene (`sinew run NAME`) or test
//! (`crates/sinew_physics/tests/it`) where that is to be seen; consequences without a figure are judgement, not measured. Any change may
//! move the golden hashes. Tolerances of rounding stand in the formulas that they belong to.

/// Distance at which a sweep stops before what it meets, in skins.
///
/// Larger: movers stay further from walls than they need. Smaller: rounding puts them within what they touch. Shown by the tests of `mover`.
pub(super) const STOP_SKIN: f32 = 0.75;

/// Gap beyond the skin that counts as touching, in skins.
///
/// Larger: what is passed closely stops a slide. Smaller: what is touched is lost between two sweeps. Shown by the tests of `mover`.
pub(super) const TOUCH_SKIN: f32 = 0.05;

/// Gap beyond the skin within which ground bears, in skins.
///
/// Larger: a mover stands beside an edge on nothing. Smaller: on uneven ground it falls by moments. Shown by `mover_course` and the tests of `mover`.
pub(super) const BEARING_SKIN: f32 = 0.5;

/// Distance from the end of a way that is as good as there, in skins.
///
/// Larger: slow movers stand. Smaller: sweeps go on for rounding. Shown by the tests of `mover`.
pub(super) const ARRIVED_SKIN: f32 = 0.02;

/// Distance between faces that lie in one plane, in skins.
///
/// Larger: small steps are taken for even ground. Smaller: movers stumble over the seams of meshes. Shown by the tests of `mover`.
pub(super) const COPLANAR_SKIN: f32 = 0.04;

/// Length by which one slide leads away from what is too near, in skins.
///
/// Larger: movers jump away from what comes near. Smaller: they stay wedged between two walls. Shown by the tests of `mover`.
pub(super) const SLIDE_AWAY: f32 = 0.3;

/// Length of a slide along walls as a multiple of the way that is left, from which it is no way.
///
/// Larger: a mover wedged between crates is shot up between them. Smaller: it stops where a steep slope leads it on. Shown by the test
/// `mover::a_cleft_that_opens_upward_shoots_nobody_up`.
pub(super) const LONGEST_DETOUR: f32 = 4.0;

/// Length of a way out of walls as a multiple of the distance that the deepest one lacks, from which it is no way out: that of a wedge of 4°.
///
/// Larger: a mover wedged between crates is pushed up between them. Smaller: it stays in sharp corners. Shown by the test
/// `mover::a_cleft_that_opens_upward_shoots_nobody_up`.
pub(super) const LONGEST_WAY_OUT: f32 = 32.0;

/// Length of way that goes on beside a face that it may come to, in radii.
///
/// Larger: slides past corners take more sweeps. Smaller: a mover comes upon a face that it has not seen. Shown by the tests of `mover`.
pub(super) const BESIDE_RADIUS: f32 = 0.1;

/// Speed from which on a body flies and may pass a mover that lets it, m/s.
///
/// Larger: thrown things bounce off what they should strike. Smaller: what is pushed along passes through. Shown by the tests of `mover`.
pub(super) const FLYING_SPEED: f32 = 2.0;

/// Share of an overlap that a body is told to leave within a second, 1/s.
///
/// Larger: what a mover walks into is thrown. Smaller: it stays within the mover. Shown by `mover_course`.
pub(super) const LEAVE_RATE: f32 = 12.0;

/// Fastest speed with which a body is told to leave an overlap, m/s.
///
/// Larger: what spawns in a mover is shot away. Smaller: crowds stay wedged. Shown by `mover_course`.
pub(super) const LEAVE_SPEED: f32 = 1.0;

/// Upward component of a normal above which what meets there bears or is borne, a cosine: 45°.
///
/// Larger: a mover on a slope pushes it away. Smaller: it stands on what it leans against. Shown by `mover_course`.
pub(super) const BEARING_COSINE: f32 = 0.7;

/// Distance around its way within which a mover looks for bodies that come toward it, metres.
///
/// Larger: more obstacles to go through. Smaller: what is fast is not seen in time. Shown by the tests of `mover`.
pub(super) const LOOK_AHEAD: f32 = 0.5;

/// Distance behind an edge at which a tread is looked for, metres.
///
/// Larger: narrow treads are missed. Smaller: rounding puts the look before the edge. Shown by `stairs` and the tests of `mover`.
pub(super) const BEHIND_EDGE: f32 = 0.01;

/// Distance over and under an edge at which a tread is looked for, metres.
///
/// Larger: a mover steps onto what is a wall. Smaller: rounded edges are none. Shown by the tests of `mover`.
pub(super) const OVER_EDGE: f32 = 0.03;

/// Missing share of a way from which on something other than the ground's slope has stopped it, a ratio.
///
/// Larger: low steps slow a mover instead of being climbed. Smaller: it tries to climb on every slope. Shown by `mover_course`.
pub(super) const STOPPED_SHARE: f32 = 0.02;

/// Share of its way by which a fall that comes less far lies wedged, a ratio.
///
/// Larger: a slow fall along a wall counts as ground. Smaller: movers in a cleft fall for ever. Shown by the tests of `mover`.
pub(super) const WEDGED_SHARE: f32 = 0.02;

/// Acceleration by which a dynamic body takes along the mover that it bears, m/s²: friction of soles.
///
/// Larger: who steps on a hand that is jerked away is flung with it. Smaller: riders slide on crates that start. Shown by the tests of `mover`.
pub(super) const GRIP: f32 = 20.0;
