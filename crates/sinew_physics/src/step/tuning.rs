//! Behaviour constants of the world's stages: the numbers an engineer would tune.
//!
//! Each comment states the unit, the reason, the effect of a larger and a smaller value, and the scene (`sinew run
//! NAME`) or test (`crates/sinew_physics/tests/it`) that shows it. Effects without a number are judgement, not
//! measurement. Any change may move the golden hashes. Rounding tolerances are in the formulas they belong to.

/// Factor on `distance / time` of the sleep thresholds: below that speed a body counts as at rest wherever it is, a
/// ratio.
///
/// Limp limbs sag for seconds. Larger: a body that creeps down a slope falls asleep there. Smaller: heaps of ragdolls
/// stay awake for seconds longer. Shown by `ragdoll_pile`, `ragdoll_poses`.
pub(super) const CREEP: f32 = 2.0;

/// Velocity gain during about the rest time, above which a body is not at rest, as a multiple of the distance and angle
/// thresholds divided by that time, a ratio.
///
/// 4 mm/s in 0.5 s: the gain of a ball at its turning point on a slope of 0.07°, where it is slower than the creep
/// limit for a second. Larger: the ball falls asleep there. Smaller: slowly settling limbs and bodies swinging on ropes
/// stay awake longer. Shown by the tests of `sleep` and of `loads`.
pub(super) const GAINED: f32 = 2.0 / 3.0;

/// Displacement speed in a step above which a body without velocity counts as being pushed out of another, m/s.
///
/// Half of the push-out speed of bodies with joints. Larger: bodies fall asleep inside each other. Smaller: bodies on a
/// soft contact never sleep. Shown by `ragdoll_drop`.
pub(super) const PUSHED_SPEED: f32 = 0.0275;

/// Displacement speed in a step below which a body on particles may sleep, m/s.
///
/// Such a body swings about its rest position, and must settle first. Larger: the body stops in mid-swing. Smaller:
/// ropes keep a world awake. Shown by the tests of `rope`.
pub(super) const HANGING_SPEED: f32 = 0.02;

/// Rotation rate from step to step below which a body on particles may sleep, rad/s.
///
/// Reason, effects and tests as for [`HANGING_SPEED`].
pub(super) const HANGING_SPIN: f32 = 0.05;

/// Overlap above which a yielding shape lets a body pass, metres.
///
/// Larger: a body between a walking character and a wall is squeezed for longer. Smaller: a body that leans on a
/// yielding shape passes through. Shown by the tests of `yields`.
pub(super) const YIELDING_DEPTH: f32 = 0.01;

/// Gap up to which two shapes that touched continue to touch, in slops.
///
/// Larger: the end of a touch is reported late. Smaller: vibrating bodies cause repeated begin and end events. Shown by
/// the tests of `events`.
pub(super) const LINGER: f32 = 0.1;

/// Separation speed of joint anchors above which an impulse counts as an impact, m/s.
///
/// Solved joints leave a smaller speed to the next step. Larger: a limb penetrates another for a step at this speed.
/// Smaller: the step searches pairs that do not touch. Shown by the tests of `stumble`.
pub(super) const BLOW_SPEED: f32 = 0.3;

/// Number of consecutive joints through which an impact is followed.
///
/// There are five joints from the pelvis to a hand. Larger: more pairs are tested in steps after an impact. Smaller: the
/// hand of a ragdoll hit at its trunk is inside the thigh at the end of the step. Shown by the same tests as
/// [`BLOW_SPEED`].
pub(super) const BLOW_PASSES: usize = 6;

/// Ratio of the added mass of a body on ropes to its own mass, above which its island's contacts are swept until they
/// transmit all of the added mass.
///
/// Larger: a plank rotates under a body heavier by that ratio, and gains energy. Smaller: more islands on ropes need
/// these sweeps, and light loads on undamped ropes vibrate. Sensible from 2 to 10. Shown by the tests of `held`.
pub(super) const HEAVY_LOAD: f32 = 4.0;

/// Largest number of rounds over groups attached to one body and solved as one system.
///
/// Larger: the step is slower. Smaller: groups that share several bodies pull against each other. Shown by the tests of
/// `held`.
pub(super) const JOINT_ROUNDS: u32 = 8;

/// Change of such a body's velocity per round below which the rounds end: relative to the change by its springs in the
/// substep, a ratio.
///
/// Larger: ropes of a plank pull against each other. Smaller: the step takes more rounds. Shown by the tests of `held`.
pub(super) const JOINT_CHANGE: f32 = 1e-4;

/// Largest number of contacts of two shapes through the particles of a group.
///
/// A limb in the corner of two walls of one mesh has two contacts. Larger: the step is slower. Smaller: a body touched
/// on several sides is not fully supported. No scene shows it.
pub(super) const MOST_PINCHED: u32 = 4;

/// Largest height of a particle above the deepest one of its contact at which it still carries a share of the load,
/// metres.
///
/// Larger: the load is spread over more particles than carry it. Smaller: a single particle carries all of it. Shown by
/// `cape`.
pub(super) const BEARING_GAP: f32 = 0.005;

/// Factor on the height of a contact point above the deepest one, which its distance from the others must exceed,
/// metres per metre.
///
/// Larger: points are close together. Smaller: points are beside the loaded area. Shown by the tests of `pinched`.
pub(super) const POINT_SLOPE: f32 = 5.0;

/// Distance by which a new point must be farther away to replace a point of the previous step, metres.
///
/// Larger: contact points stay where there is no load. Smaller: contact points and their impulses jump between
/// particles. Shown by `cape`.
pub(super) const KEPT_POINT: f32 = 0.005;

/// Largest approach speed of a contact for bounces and hits, m/s.
///
/// A faster body is slowed when forces act, after contacts were computed: a bounce at its requested speed would need an
/// infinite impulse. Sensible from 1e5, well above [`WorldDef::max_speed`](crate::WorldDef::max_speed), to 1e12.
/// Larger: impulses of heavy bodies are infinite. Smaller: allowed speeds bounce too slowly. Shown by the test
/// `events::extreme_hits_are_reported_finite`.
pub(super) const MOST_APPROACH: f32 = 1e6;

/// Largest component of a kinematic body's velocity, m/s or rad/s.
///
/// Larger: surface speeds and their squares overflow, and cloth nearby becomes non-finite. Smaller: very fast bodies lag behind their
/// requested velocity. Sensible from 1e5 to 1e9. Shown by lives 2048 and 4900 of `lives`.
pub(super) const FASTEST_KINEMATIC: f32 = 1e6;
