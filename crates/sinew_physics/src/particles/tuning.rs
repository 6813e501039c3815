//! Behaviour constants of particles: the numbers an engineer would tune.
//!
//! Each comment states the unit, the reason, the effect of a larger and a smaller value, and the scene (`sinew run
//! NAME`) or test (`crates/sinew_physics/tests/it`) that shows it. Effects without a figure are judgement, not
//! measurement. Any change may move the golden hashes. Rounding tolerances are in the formulas they belong to.

/// Number of iterations, at the current speed and acceleration, covered by the margins of the nearby lists.
///
/// Larger: longer lists. Smaller: they are rebuilt more often. Shown by `cargo xtask bench --trace box_rain`.
pub(super) const LIST_ITERATIONS: f32 = 8.0;

/// Least margin of each entry of those lists, metres.
///
/// As [`LIST_ITERATIONS`].
pub(super) const LIST_ROOM: f32 = 0.01;

/// Displacement speed in a step below which a particle may sleep, m/s.
///
/// It swings about its rest position, and must settle first. Larger: cloth stops in mid-swing, with springs short of
/// the stretch that their load requires. Smaller: trembling nets keep a world awake. Shown by the tests of `sleep`.
pub(super) const RESTING_SPEED: f32 = 0.001;

/// Margin around a sleeping group within which the user's changes to bodies wake it, metres.
///
/// Exceeds the distance to its support. Larger: it wakes for unrelated changes. Smaller: it keeps sleeping where its
/// support was. Shown by the tests of `sleep`.
pub(super) const BED_ROOM: f32 = 0.02;

/// Least vertical component of a surface normal at which the surface supports a particle, a ratio.
///
/// Larger: particles in a steep fold of cloth stay in the air when the cloth is removed. Smaller: a rope that swings
/// against a side of a box keeps the box awake. Shown by `rope_on_box` and the tests of `sleep`.
pub(super) const BEARING: f32 = 0.2;

/// Length by which a spring may exceed its predicted length at the end of a step, as a share of its rest length, a ratio.
///
/// Larger: ropes stretch visibly in jerks. Smaller: more iterations. Shown by `catenary`, `spring_chain`.
pub(super) const LENGTH_TOLERANCE: f32 = 1e-3;

/// Energy of the error of velocities at which springs that close loops are solved, as a share of that of the velocities, a ratio.
///
/// Larger: taut nets tremble. Smaller: more iterations of conjugate gradients. Shown by the tests of `loads`.
pub(super) const CONJUGATE_TOLERANCE: f64 = 1e-9;

/// Most rounds of conjugate gradients in one solve, a number.
///
/// A net needs as many as it is wide. Larger: nets of thousands of particles are solved at any cost. Smaller: they
/// yield. Shown by the tests of `loads`.
pub(super) const CONJUGATE_ROUNDS: u32 = 200;

/// Factor on the path length for all searches, a ratio.
///
/// Later impulses may change the path slightly. Larger: more candidates. Smaller: particles pass through obstacles they
/// are pushed into. Shown by `fast_particle` and the tests of `particles`.
pub(super) const DETOUR: f32 = 1.5;

/// Gap up to which a particle counts as touching at any speed, as a share of its radius, a ratio.
///
/// Larger: contacts that never close. Smaller: a particle trembling on a surface is solved without it. Shown by the
/// tests of `particles`.
pub(super) const REACH_SHARE: f32 = 0.05;

/// Largest number of obstacles near a net for which its particles are solved in lanes.
///
/// Larger: eight particles are tested against obstacles near only one of them. Smaller: cloth over a heap is solved
/// individually. Shown by the scene `cloth` of `bench/peers`.
pub(super) const MOST_SOLIDS: usize = 16;

/// Gap below which a path counts as having reached its obstacle, metres.
///
/// A falling particle gains no more within a step. Larger: hits obstacles that it passes closely. Smaller: more steps
/// along a path. Shown by the tests of `particles`.
pub(super) const STRIKE_GAP: f32 = 0.005;

/// Share of critical damping that ropes and strands are built with, a ratio.
///
/// Larger: they hang like dough. Smaller: they vibrate for seconds. Shown by `catenary` and the tests of `rope`.
pub(super) const ROPE_DAMPING: f32 = 0.1;

/// Speed of approach from which on particles bounce, m/s.
///
/// Larger: a particle dropped from 10 cm does not bounce. Smaller: resting particles tremble. Shown by `particle`.
pub(super) const IMPACT_SPEED: f32 = 1.0;

/// Margin of the list of a group's self-collision pairs, as a share of the thickness, a ratio.
///
/// Larger: more pairs to test. Smaller: more frequent searches. Shown by `folded`.
pub(super) const SELF_ROOM: f32 = 1.0;

/// Sweeps over the pairs of a group's own particles in an iteration, a number.
///
/// A particle rests in the hollow between up to four. Larger: slower. Smaller: with two, folds creep and never sleep.
/// Shown by the tests of `self_collision`.
pub(super) const SELF_SWEEPS: u32 = 4;

/// Speed at which overlapping particles of a group are pushed apart, m/s.
///
/// Larger: overlapping initial or pulled shapes spring open. Smaller: they stay. Shown by `folded`.
pub(super) const SELF_PUSH_SPEED: f32 = 0.1;

/// Ratio of the energy that a body passes on to that which it keeps, of the springs' impulse, above which it has an
/// added mass.
///
/// Larger: a body on ropes hangs lower by `g h²` times that for its load. Smaller: rounding counts as a mass. Shown by
/// the tests of `held`.
pub(super) const LEAST_ADDED: f32 = 1e-3;

/// Most mass that moves along with a body, over its own, a ratio.
///
/// Larger: a taut body that also stands on the ground is solved as if immovable, with errors when it lifts off.
/// Smaller: light planks hang lower under a load heavier by that ratio. Shown by the tests of `held`.
pub(super) const MOST_ADDED: f32 = 1e3;

/// Cosine between the normals of a fixed surface and of a body's below which a particle on the former cannot yield to
/// the latter, a ratio.
///
/// Larger: a particle leaning on a wall counts as under a body that slides along the wall. Smaller: a body that rolls
/// over a rope drags it through the floor. Shown by the tests of `pinched`.
pub(super) const PINCHING: f32 = -0.1;

/// Least tangent of the half angle between two surfaces at which a particle between them counts as nipped, whatever the
/// friction, a ratio.
///
/// Larger: smooth surfaces hold particles that should slip out. Smaller: rounding of normals releases them. Shown by
/// the tests of `pinched`.
pub(super) const LEAST_NIP: f32 = 0.1;

/// Speed at which a particle leaves an immovable shape, or moves midway between two surfaces without room, m/s.
///
/// A particle that a limb has pressed into the ground, or that is caught in a joint, must move some centimetres.
/// Larger: it jerks, and stretches its springs with energy from nothing. Smaller: it is visible inside for longer.
/// Shown by `skirt` and `cape`.
pub(super) const EXIT_SPEED: f32 = 0.5;

/// Gap within which a particle is on a surface that nothing moves, metres.
///
/// Larger: a particle that hovers over a floor carries load. Smaller: rounding lifts it off, and a body pushes it in.
/// Shown by the tests of `pinched`.
pub(super) const WALL_GAP: f32 = 1e-4;

/// Speed below which nothing moves, m/s.
///
/// Rounding of speeds of some metres per second. Larger: creeping counts as held. Smaller: noise decides grips.
/// No scene shows it.
pub(super) const NO_SPEED: f32 = 1e-6;

/// Depth below which a particle is on a surface and not in it, metres.
///
/// Rounding of positions of some metres. Larger: particles sink in by that depth. Smaller: resting particles are moved
/// out in each iteration. No scene shows it.
pub(super) const ROUNDING: f32 = 1e-6;
