//! Behaviour constants of the world's stages: the numbers an engineer would tune.
//!
//! Each comment states the unit, the reason, the effect of a larger and a smaller value, and the scene (`sinew run
//! NAME`) or test (`crates/sinew_physics/tests/it`) that shows it. Effects without a figure are judgement, not
//! measurement. Any change may move the golden hashes. Rounding tolerances are in the formulas they belong to.

/// Factor on the threshold of distance over that of time below which a body is at rest wherever it gets to, a ratio.
///
/// Limp limbs sag for seconds. Larger: a body that creeps down a slope falls asleep there. Smaller: heaps of figures
/// stay awake for seconds longer. Shown by `ragdoll_pile`, `ragdoll_poses`.
pub(super) const CREEP: f32 = 2.0;

/// Velocity gain over about the rest time above which a body is not at rest, as a multiple of the distance and angle
/// thresholds over that time, a ratio.
///
/// 4 mm/s in 0.5 s: a ball at the turning point on a slope of 0.07 degrees, where it is slower than creep for a second.
/// Larger: it falls asleep there. Smaller: slowly settling limbs and bodies swinging on ropes stay awake longer.
/// Shown by the tests of `sleep` and of `loads`.
pub(super) const GAINED: f32 = 2.0 / 3.0;

/// Displacement speed in a step above which a body without velocity counts as being pushed out of another, m/s.
///
/// Half of the push-out speed of bodies with joints. Larger: they fall asleep inside each other. Smaller: bodies on a
/// soft contact never sleep. Shown by `ragdoll_drop`.
pub(super) const PUSHED_SPEED: f32 = 0.0275;

/// Displacement speed in a step below which a body on particles may sleep, m/s.
///
/// It swings about its rest position, and must settle first. Larger: it stops in mid-swing. Smaller: ropes keep a world
/// awake. Shown by the tests of `rope`.
pub(super) const HANGING_SPEED: f32 = 0.02;

/// Rotation rate from step to step below which a body on particles may sleep, rad/s.
///
/// As [`HANGING_SPEED`].
pub(super) const HANGING_SPIN: f32 = 0.05;

/// Overlap above which a yielding shape lets a body pass that it cannot push out, metres.
///
/// Larger: a body that a walking figure pins to a wall is squeezed for longer. Smaller: a body that leans on it falls
/// through. Shown by the tests of `yields`.
pub(super) const YIELDING_DEPTH: f32 = 0.01;

/// Gap within which two shapes that touched go on touching, in slops.
///
/// Larger: the end of a touch is reported late. Smaller: trembling bodies report begin and end repeatedly. Shown by the
/// tests of `events`.
pub(super) const LINGER: f32 = 0.1;

/// Separation speed of joint anchors above which it counts as a blow, m/s.
///
/// Solved joints leave less to the next step. Larger: a limb penetrates another by a step at this speed. Smaller:
/// searches pairs that do not touch. Shown by the tests of `stumble`.
pub(super) const BLOW_SPEED: f32 = 0.3;

/// Number of consecutive joints through which a blow is followed.
///
/// From the pelvis to a hand there are five. Larger: more pairs are tested in steps after a blow. Smaller: the hand of
/// a figure hit at its trunk is inside the thigh at the end of the step. Shown as [`BLOW_SPEED`].
pub(super) const BLOW_PASSES: usize = 6;

/// Ratio of the added mass of a body on ropes to its own above which its island's contacts are swept until they
/// transmit all of it.
///
/// Larger: a plank rotates under a body heavier by that ratio, and gains energy. Smaller: more islands on ropes pay for
/// sweeps, and light loads on undamped ropes tremble. Sensible from 2 to 10. Shown by the tests of `held`.
pub(super) const HEAVY_LOAD: f32 = 4.0;

/// Rounds over groups attached to one body and solved as one system, a number.
///
/// Larger: slower. Smaller: groups that share several bodies pull against each other. Shown by the tests of `held`.
pub(super) const JOINT_ROUNDS: u32 = 8;

/// Change of such a body's velocity per round, relative to the springs' change in the substep, below which it has
/// converged, a ratio.
///
/// Larger: ropes of a plank pull against each other. Smaller: more rounds. Shown by the tests of `held`.
pub(super) const JOINT_CHANGE: f32 = 1e-4;

/// Largest number of contacts of two shapes through the particles of a group.
///
/// A limb in the corner of two walls of one mesh has two. Larger: slower. Smaller: a body touched on several sides is
/// not fully supported. No scene shows it.
pub(super) const MOST_PINCHED: u32 = 4;

/// Gap by which a particle may be less pinched than the most pinched one and still share the load, metres.
///
/// Larger: the load is spread over particles that do not carry it, and each holds less. Smaller: a single particle
/// carries it. Shown by `cape`.
pub(super) const BEARING_GAP: f32 = 0.005;

/// Distance along a surface that outweighs a larger gap in the choice of contact points, metres per metre.
///
/// Larger: points close together. Smaller: points beside the loaded area. Shown by the tests of `pinched`.
pub(super) const POINT_SLOPE: f32 = 5.0;

/// Distance by which another point must be farther away to replace a point of the previous step, metres.
///
/// Larger: points stay where they carry nothing. Smaller: points jump from particle to particle, and their impulses
/// with them. Shown by `cape`.
pub(super) const KEPT_POINT: f32 = 0.005;

/// Largest approach speed of a contact, m/s, used for bounces and hits.
///
/// A faster body is slowed when forces act, after contacts were computed: a bounce at its requested speed would need an
/// infinite impulse. Sensible from 1e5, well above [`WorldDef::max_speed`](crate::WorldDef::max_speed), to 1e12.
/// Larger: impulses of heavy bodies are infinite. Smaller: allowed speeds bounce too slowly. Shown by the test
/// `events::extreme_hits_are_reported_finite`.
pub(super) const MOST_APPROACH: f32 = 1e6;
