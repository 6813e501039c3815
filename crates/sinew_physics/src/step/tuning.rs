//! Constants of behaviour of the stages of the world: numbers that an engineer would turn.
//!
//! Each says its unit, why it is what it is, what a larger and a smaller one does, and the scene (`sinew run NAME`) or test
//! (`crates/sinew_physics/tests/it`) where that is to be seen; consequences without a figure are judgement, not measured. Any change may
//! move the golden hashes. Tolerances of rounding stand in the formulas that they belong to.

/// Factor on the threshold of distance over that of time below which a body is at rest wherever it gets to, a ratio.
///
/// Limp limbs sag for seconds. Larger: what creeps down a slope falls asleep on its way. Smaller: heaps of figures stay awake for seconds more.
/// Shown by `ragdoll_pile`, `ragdoll_poses`.
pub(super) const CREEP: f32 = 2.0;

/// Gain of velocity over about the time that rest takes from which on a body is not at rest, in thresholds of distance and of angle
/// over that time, a ratio.
///
/// 4 mm/s in 0.5 s: a ball at the top of its way up a slope of 0.07 degrees, where it is slower than what creeps for a second. Larger: it
/// falls asleep there. Smaller: limbs that come to rest slowly and what swings on ropes stay awake for longer. Shown by the tests of
/// `sleep` and of `loads`.
pub(super) const GAINED: f32 = 2.0 / 3.0;

/// Speed of the way in a step from which on a body without velocity is being pushed out of another, m/s.
///
/// Half of what bodies with joints are pushed out with. Larger: they fall asleep in each other. Smaller: what rests on a soft contact never
/// sleeps. Shown by `ragdoll_drop`.
pub(super) const PUSHED_SPEED: f32 = 0.0275;

/// Speed of the way in a step below which what hangs on particles may sleep, m/s.
///
/// It swings about its place, and must come to rest before that. Larger: it stops in mid-swing. Smaller: ropes keep a world awake. Shown by
/// the tests of `rope`.
pub(super) const HANGING_SPEED: f32 = 0.02;

/// Spin from step to step below which what hangs on particles may sleep, rad/s.
///
/// As [`HANGING_SPEED`].
pub(super) const HANGING_SPIN: f32 = 0.05;

/// Overlap from which on a shape that yields lets pass what it cannot press out of itself, metres.
///
/// Larger: what a walking figure pins to a wall is squeezed for longer. Smaller: what leans on it falls through. Shown by the tests of
/// `yields`.
pub(super) const YIELDING_DEPTH: f32 = 0.01;

/// Gap within which two shapes that touched go on touching, in slops.
///
/// Larger: the end of a touch is told of late. Smaller: what trembles tells of begin and end again and again. Shown by the tests of `events`.
pub(super) const LINGER: f32 = 0.1;

/// Speed from which anchors of a joint that part tell of a blow, m/s.
///
/// Joints leave less to the next step. Larger: a limb goes into another by a step of that. Smaller: pairs are looked for that do not meet.
/// Shown by the tests of `stumble`.
pub(super) const BLOW_SPEED: f32 = 0.3;

/// Joints in a row through which a blow is followed to what it may drive into something, a number.
///
/// From the pelvis to a hand there are five. Larger: more pairs are looked at in steps after a blow. Smaller: the hand of a figure that is struck at its trunk
/// is in the thigh by the end of the step. Shown as [`BLOW_SPEED`].
pub(super) const BLOW_PASSES: usize = 6;

/// Mass that moves along with a body on ropes over its own, from which on its island's contacts are swept until they pass all of it on, a ratio.
///
/// Larger: a plank turns under what is heavier by so much, and gains energy. Smaller: more islands on ropes pay for sweeps, and light loads on ropes without
/// damping tremble. Sensible from 2 to 10. Shown by the tests of `held`.
pub(super) const HEAVY_LOAD: f32 = 4.0;

/// Rounds over groups that hang on one body and are solved as one system, a number.
///
/// Larger: slower. Smaller: groups that hold several bodies in common pull against each other. Shown by the tests of `held`.
pub(super) const JOINT_ROUNDS: u32 = 8;

/// Change of such a body's velocity in a round, over what springs change it by in the substep, below which it is solved, a ratio.
///
/// Larger: ropes of a plank pull against each other. Smaller: more rounds. Shown by the tests of `held`.
pub(super) const JOINT_CHANGE: f32 = 1e-4;

/// Contacts of two shapes through the particles of a group at most, a number.
///
/// A limb in the corner of two walls of one mesh has two. Larger: slower. Smaller: of what touches on several sides some is not borne. No scene shows it.
pub(super) const MOST_PINCHED: u32 = 4;

/// Gap by which a particle may be farther from being pinched than the one that is pinched most and share the load, metres.
///
/// Larger: the load is spread over more particles than bear it, and each holds less. Smaller: all of it is on one. Shown by `cape`.
pub(super) const BEARING_GAP: f32 = 0.005;

/// Distance along a surface that outweighs a gap more when points of a contact are chosen, metres for each metre.
///
/// Larger: points close together. Smaller: points beside what bears. Shown by the tests of `pinched`.
pub(super) const POINT_SLOPE: f32 = 5.0;

/// Distance by which others must be farther away to take the place of a point of the step before, metres.
///
/// Larger: points stay where they no longer bear. Smaller: points jump from particle to particle, and their impulses with them. Shown by `cape`.
pub(super) const KEPT_POINT: f32 = 0.005;

/// Most approach speed of a contact, m/s: bounces and hits are taken from no more.
///
/// A body that was given more is slowed when forces act, after contacts were looked at: what bounced as fast as it was told to had no finite
/// impulse. Sensible from 1e5, well above [`WorldDef::max_speed`](crate::WorldDef::max_speed), to 1e12. Larger: impulses of heavy bodies are infinite. Smaller: what is allowed
/// to be so fast bounces too slowly. Shown by the test `events::hits_beyond_all_measure_are_told_in_numbers`.
pub(super) const MOST_APPROACH: f32 = 1e6;
