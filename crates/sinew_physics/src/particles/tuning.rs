//! Constants of behaviour of particles: numbers that an engineer would turn.
//!
//! Each says its unit, why it is what it is, what a larger and a smaller one does, and the scene (`sinew run NAME`) or test
//! (`crates/sinew_physics/tests/it`) where that is to be seen; consequences without a figure are judgement, not measured. Any change may
//! move the golden hashes. Tolerances of rounding stand in the formulas that they belong to.

/// Iterations for which the lists of what is near have room, at the present speed and acceleration, a number.
///
/// Larger: longer lists. Smaller: they are made more often. Shown by `cargo xtask bench --trace box_rain`.
pub(super) const LIST_ITERATIONS: f32 = 8.0;

/// Room of each entry of those lists at least, metres.
///
/// As [`LIST_ITERATIONS`].
pub(super) const LIST_ROOM: f32 = 0.01;

/// Speed of the way in a step below which a particle may sleep, m/s.
///
/// It swings about its place, and must come to rest before that. Larger: cloth stops in mid-swing, and springs short of the stretch that their load
/// asks for. Smaller: nets that tremble keep a world awake.
/// Shown by the tests of `sleep`.
pub(super) const RESTING_SPEED: f32 = 0.001;

/// Room around a sleeping group within which the user's changes to bodies wake it, metres.
///
/// More than what bears it is away. Larger: it wakes for what does not concern it. Smaller: it goes on sleeping where its support was. Shown by the
/// tests of `sleep`.
pub(super) const BED_ROOM: f32 = 0.02;

/// Least share of the vertical in the normal of a surface at which a particle bears it, a ratio.
///
/// Larger: what lies in a steep fold of cloth stays in the air when the cloth goes. Smaller: a rope that swings against a wall of a box keeps the
/// box awake. Shown by `rope_on_box` and the tests of `sleep`.
pub(super) const BEARING: f32 = 0.2;

/// Length by which a spring may exceed its predicted length at the end of a step, as a share of its rest length, a ratio.
///
/// Larger: ropes stretch visibly in jerks. Smaller: more iterations. Shown by `catenary`, `spring_chain`.
pub(super) const LENGTH_TOLERANCE: f32 = 1e-3;

/// Energy of the error of velocities at which springs that close loops are solved, as a share of that of the velocities, a ratio.
///
/// Larger: nets that hang taut tremble. Smaller: more rounds of conjugate gradients. Shown by the tests of `loads`.
pub(super) const CONJUGATE_TOLERANCE: f64 = 1e-9;

/// Most rounds of conjugate gradients in one solve, a number.
///
/// A net takes as many as it is wide. Larger: nets of thousands of particles are solved for as long as they take. Smaller: they give way.
/// Shown by the tests of `loads`.
pub(super) const CONJUGATE_ROUNDS: u32 = 200;

/// Factor on the length of a way within which everything is looked for, a ratio.
///
/// What is still to push may turn the way a little. Larger: more to look at. Smaller: particles pass what they are pushed into. Shown by
/// `fast_particle` and the tests of `particles`.
pub(super) const DETOUR: f32 = 1.5;

/// Gap that a particle counts as touching whatever its speed, as a share of its radius, a ratio.
///
/// Larger: contacts that never close. Smaller: what trembles on a surface is solved as if it were not there. Shown by the tests of `particles`.
pub(super) const REACH_SHARE: f32 = 0.05;

/// Most obstacles near a net with which its particles are solved eight side by side, a number.
///
/// Larger: eight particles are tried against what only one of them is near to. Smaller: cloth over a heap is solved one by one. Shown by
/// the scene `cloth` of `bench/peers`.
pub(super) const MOST_SOLIDS: usize = 16;

/// Gap from which on a way has come to what it strikes, metres.
///
/// What falls gains no more within a step. Larger: what passes closely is struck. Smaller: more strides along a way. Shown by the tests of
/// `particles`.
pub(super) const STRIKE_GAP: f32 = 0.005;

/// Share of critical damping that ropes and strands are built with, a ratio.
///
/// Larger: they hang like dough. Smaller: they hum for seconds. Shown by `catenary` and the tests of `rope`.
pub(super) const ROPE_DAMPING: f32 = 0.1;

/// Speed of approach from which on particles bounce, m/s.
///
/// Larger: what drops from a hand's breadth stays down. Smaller: what lies trembles. Shown by `particle`.
pub(super) const IMPACT_SPEED: f32 = 1.0;

/// Room of the list of pairs of a group's own particles, as a share of the thickness, a ratio.
///
/// Larger: more pairs to look at. Smaller: they are found anew more often. Shown by `folded`.
pub(super) const SELF_ROOM: f32 = 1.0;

/// Sweeps over the pairs of a group's own particles in an iteration, a number.
///
/// A particle lies in the hollow between up to four. Larger: slower. Smaller: with two, folds creep and never sleep. Shown by the tests of
/// `self_collision`.
pub(super) const SELF_SWEEPS: u32 = 4;

/// Speed with which particles of a group that lie in each other are pushed apart, m/s.
///
/// Larger: what is made or pulled into itself springs open. Smaller: it stays so. Shown by `folded`.
pub(super) const SELF_PUSH_SPEED: f32 = 0.1;

/// Energy that a body passes on of what springs give it, over what it keeps, from which on what it passes it to counts as moving along, a ratio.
///
/// Larger: what hangs on ropes hangs lower by `g h²` times that for what lies on it. Smaller: rounding counts as a mass. Shown by the tests of `held`.
pub(super) const LEAST_ADDED: f32 = 1e-3;

/// Most mass that moves along with a body, over its own, a ratio.
///
/// Larger: what hangs taut and stands on the ground as well is solved as if it could not move, with what comes of that when it lifts off. Smaller: light
/// planks hang lower under what is heavier than so many of them. Shown by the tests of `held`.
pub(super) const MOST_ADDED: f32 = 1e3;

/// Cosine between the normals of a fixed surface and of a body's below which a particle on the one cannot give way to the other, a ratio.
///
/// Larger: what leans on a wall at its side counts as under a body that slides along the wall. Smaller: what rolls over a rope takes it along through the
/// floor. Shown by the tests of `pinched`.
pub(super) const PINCHING: f32 = -0.1;

/// Least tangent of the half angle between two surfaces at which a particle between them is nipped, whatever the friction, a ratio.
///
/// Larger: what is smooth is borne where it would slip out. Smaller: rounding of normals lets go. Shown by the tests of `pinched`.
pub(super) const LEAST_NIP: f32 = 0.1;

/// Speed with which a particle comes out of what no force moves, or midway between two surfaces that leave it no room, m/s.
///
/// A particle that a limb has pressed into the ground, or caught in a joint, has some centimetres to go. Larger: it jerks, and stretches its springs by energy that no
/// force gave. Smaller: it is seen in there for longer. Shown by `skirt` and `cape`.
pub(super) const EXIT_SPEED: f32 = 0.5;

/// Gap within which a particle is on a surface that nothing moves, metres.
///
/// Larger: what hovers over a floor bears as if it lay there. Smaller: rounding lifts it off, and a body pushes it in. Shown by the tests of `pinched`.
pub(super) const WALL_GAP: f32 = 1e-4;

/// Speed below which nothing moves, m/s.
///
/// Rounding of speeds of some metres a second. Larger: what creeps counts as held. Smaller: noise decides who touches and who lets go. No scene shows it.
pub(super) const NO_SPEED: f32 = 1e-6;

/// Depth below which a particle is on a surface and not in it, metres.
///
/// Rounding of places of some metres. Larger: particles sink in by so much. Smaller: what lies is moved out in each iteration. No scene shows it.
pub(super) const ROUNDING: f32 = 1e-6;
