//! Behaviour constants of particles: the numbers an engineer would tune.
//!
//! Each comment states the unit, the reason, the effect of a larger and a smaller value, and the scene (`sinew run
//! NAME`) or test (`crates/sinew_physics/tests/it`) that shows it. Effects without a number are judgement, not
//! measurement. Any change may move the golden hashes. Rounding tolerances are in the formulas they belong to.

/// Number of iterations, at the current speed and acceleration, covered by the margins of the lists of nearby
/// obstacles.
///
/// Larger: lists are longer. Smaller: lists are rebuilt more often. Shown by `cargo xtask bench --trace box_rain`.
pub(super) const LIST_ITERATIONS: f32 = 8.0;

/// Least margin of each entry of the lists of nearby obstacles, metres.
///
/// Effects and bench as for [`LIST_ITERATIONS`].
pub(super) const LIST_ROOM: f32 = 0.01;

/// Displacement speed in a step below which a particle may sleep, m/s.
///
/// A particle swings about its rest position, and must settle first. Larger: cloth stops in mid-swing, with springs
/// short of the stretch that their load requires. Smaller: vibrating nets keep a world awake. Shown by the tests of
/// `sleep`.
pub(super) const RESTING_SPEED: f32 = 0.001;

/// Margin around a sleeping group within which the user's changes to bodies wake it, metres.
///
/// Exceeds the distance of a group to its support. Larger: the group wakes for unrelated changes. Smaller: the group
/// continues to sleep without its support. Shown by the tests of `sleep`.
pub(super) const SUPPORT_MARGIN: f32 = 0.02;

/// Least vertical component of a surface normal at which the surface supports a particle, a ratio.
///
/// Larger: particles in a steep fold of cloth stay in the air when the cloth is removed. Smaller: a rope that swings
/// against a side of a box keeps the box awake. Shown by `rope_on_box` and the tests of `sleep`.
pub(super) const BEARING: f32 = 0.2;

/// Length by which a spring may exceed its predicted length at the end of a step, as a share of its rest length, a ratio.
///
/// Larger: ropes stretch visibly in jerks. Smaller: the solve takes more iterations. Shown by `catenary`,
/// `spring_chain`.
pub(super) const LENGTH_TOLERANCE: f32 = 1e-3;

/// Energy of the velocity error at which the solve of springs that close loops ends, as a share of the energy of the
/// velocities, a ratio.
///
/// Larger: taut nets vibrate. Smaller: conjugate gradients take more iterations. Shown by the tests of `loads`.
pub(super) const CONJUGATE_TOLERANCE: f64 = 1e-9;

/// Largest number of iterations of conjugate gradients in one solve.
///
/// A net needs as many as it is wide in particles. Larger: nets of thousands of particles are solved at any cost.
/// Smaller: such nets yield. Shown by the tests of `loads`.
pub(super) const CONJUGATE_ROUNDS: u32 = 200;

/// Factor on the path length for all searches, a ratio.
///
/// Impulses after the search may change the path slightly. Larger: searches find more candidates. Smaller: particles
/// pass through obstacles that they are pushed into. Shown by `fast_particle` and the tests of `particles`.
pub(super) const DETOUR: f32 = 1.5;

/// Gap up to which a particle counts as touching at any speed, as a share of its radius, a ratio.
///
/// Larger: the solve includes contacts that never close. Smaller: the solve ignores the surface under a vibrating
/// particle. Shown by the tests of `particles`.
pub(super) const REACH_SHARE: f32 = 0.05;

/// Largest number of obstacles near a net for which its particles are solved in lanes.
///
/// Larger: eight particles are tested against obstacles near only one of them. Smaller: cloth over a heap is solved
/// individually. Shown by the scene `cloth` of `bench/peers`.
pub(super) const MOST_SOLIDS: usize = 16;

/// Gap below which a path counts as having reached its obstacle, metres.
///
/// A falling particle gains no more within a step. Larger: a particle hits obstacles that it only passes closely.
/// Smaller: the search takes more steps along a path. Shown by the tests of `particles`.
pub(super) const STRIKE_GAP: f32 = 0.005;

/// Damping of the springs of ropes and strands, as a share of critical damping, a ratio.
///
/// Larger: ropes swing sluggishly. Smaller: ropes vibrate for seconds. Shown by `catenary` and the tests of `rope`.
pub(super) const ROPE_DAMPING: f32 = 0.1;

/// Speed of approach above which particles bounce, m/s.
///
/// Larger: a particle dropped from 10 cm does not bounce. Smaller: resting particles tremble. Shown by `particle`.
pub(super) const IMPACT_SPEED: f32 = 1.0;

/// Margin of the list of a group's self-collision pairs, as a share of the thickness, a ratio.
///
/// Larger: more pairs are tested. Smaller: pairs are searched more often. Shown by `folded`.
pub(super) const SELF_ROOM: f32 = 1.0;

/// Sweeps over the pairs of a group's own particles in an iteration, a number.
///
/// A particle rests in the hollow between up to four. Larger: the step is slower. Smaller: with two sweeps, folds creep
/// and never sleep. Shown by the tests of `self_collision`.
pub(super) const SELF_SWEEPS: u32 = 4;

/// Speed at which overlapping particles of a group are pushed apart, m/s.
///
/// Larger: shapes that overlap initially or are pulled spring open. Smaller: they remain overlapping. Shown by
/// `folded`.
pub(super) const SELF_PUSH_SPEED: f32 = 0.1;

/// Ratio of the energy that a body passes on to the energy that it keeps, above which the body gets an added mass. The
/// energy is that of a spring impulse on the body.
///
/// Larger: a body on ropes hangs lower by up to `g h²` times that ratio under its load. Smaller: rounding errors count
/// as a mass. Shown by the tests of `held`.
pub(super) const LEAST_ADDED: f32 = 1e-3;

/// Largest ratio of the mass added to a body to its own mass.
///
/// Larger: a body on taut ropes that also stands on the ground is solved as if immovable, with errors when it lifts
/// off. Smaller: light planks hang lower under a load heavier by that ratio. Shown by the tests of `held`.
pub(super) const MOST_ADDED: f32 = 1e3;

/// Cosine between the normals of a firmer and a less firm surface below which a particle on the firmer one cannot yield
/// to the other, a ratio.
///
/// Larger: a particle leaning on a wall counts as pinched by a body that slides along the wall. Smaller: a body that
/// rolls over a rope drags the rope through the floor. Shown by the tests of `pinched`.
pub(super) const PINCHING: f32 = -0.1;

/// Least tangent of the half angle between two surfaces at which a particle between them counts as nipped, regardless
/// of the friction, a ratio.
///
/// Larger: smooth surfaces hold particles that should slip out. Smaller: rounding of normals releases such particles.
/// Shown by the tests of `pinched`.
pub(super) const LEAST_NIP: f32 = 0.1;

/// Speed at which a particle leaves an immovable shape, or moves midway between two surfaces without room, m/s.
///
/// A particle that a limb has pressed into the ground, or that is caught in a joint, must move some centimetres.
/// Larger: the particle jerks, and stretches its springs with energy from nothing. Smaller: the particle is visible
/// inside for longer. Shown by `skirt` and `cape`.
pub(super) const EXIT_SPEED: f32 = 0.5;

/// Gap within which a particle counts as on a wall, metres.
///
/// Larger: a particle that hovers over a floor carries load. Smaller: rounding lifts the particle off, and a body
/// pushes it into the floor. Shown by the tests of `pinched`.
pub(super) const WALL_GAP: f32 = 1e-4;

/// Speed below which a particle counts as at rest, m/s.
///
/// The rounding error of speeds of a few metres per second. Larger: creeping particles count as held. Smaller: rounding
/// noise decides whether particles stick. No scene shows the effect.
pub(super) const NO_SPEED: f32 = 1e-6;

/// Depth below which a particle counts as on a surface and not inside it, metres.
///
/// Rounding error of positions of some metres. Larger: particles sink in by that depth. Smaller: resting particles are
/// moved out in each iteration. No scene shows it.
pub(super) const ROUNDING: f32 = 1e-6;
