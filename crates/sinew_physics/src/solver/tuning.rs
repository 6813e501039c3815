//! Constants of behaviour of the solver, by room: numbers that an engineer would turn.
//!
//! Each says its unit, why it is what it is, the range in which it keeps its purpose, what a larger and a smaller one does, and the
//! scene (`sinew run NAME`) or test (`crates/sinew_physics/tests/it`) where that is to be seen. Figures are measured; ranges, and
//! consequences without a figure, are judgement: no sweep over values stands behind them. Any change may move the golden hashes.
//!
//! The other home is `sweep/policy.rs`, for constants that are structures: `JOINTED`, `TURNS`, `PILE`, `HEAP` and `UNEQUAL` (how long
//! sweeps go on) and [`Firmness`](crate::solver::sweep::policy::Firmness) (how hard a pair's contact is). Constants of layout and of
//! code (widths, sizes of chunks and arrays, markers, ranges of series) stand where they are used.

// ---- Substeps and coupling ----

/// Contacts from which on an island of free bodies takes half of the substeps, a number.
///
/// They damp all motion, and no single one decides. Sensible from 16 to some hundreds. Fewer: with 16, 10,000 boxes take a quarter less
/// time, but `cards` sink by 2.009 mm (bar 2.0) and `wave_pile` sleeps 52 steps too late (ADR 0015). More: heaps below it take all
/// substeps. Shown by `cards`, `wave_pile`.
pub(super) const DAMPED_CONTACTS: usize = 32;

/// Contacts per body from which on an island with limp joints takes half of the substeps, a ratio.
///
/// Bodies that lie take half of them, those that swing or fly all. Sensible from 0.1 to 1. Larger: heaps of figures cost more. Smaller: what
/// hangs by its joints and hardly touches swings in the longer substep. Shown by `ragdoll_pile`; the tests of `bobs` swing beneath a
/// heap.
pub(super) const DAMPED_CONTACTS_PER_BODY: f32 = 0.25;

/// Contacts below which an island with joints takes all substeps, a number.
///
/// With fewer than four one contact decides: a foot of 1 kg under 69 kg sinks by 2.3 mm instead of 2 in half the substeps. Sensible
/// from 2 to 8. Larger: single figures that lie cost more. Smaller: that foot sinks. Shown by `heavy_foot`.
pub(super) const DAMPED_CONTACTS_JOINTED: usize = 4;

/// Turn of a body within a longer substep up to which its island may take those, radians.
///
/// Rows are linearised at the substep's beginning. Sensible from 0.05 to 0.5. Larger: what spins meets contacts and stops that its rows
/// do not know. Smaller: heaps in motion cost more. No scene shows it alone; `wave_pile` and `ragdoll_pile` go through it as they calm.
pub(super) const CALM_TURN: f32 = 0.25;

/// Ratio of masses beyond which an island takes all substeps and a pile the sweeps for unequal masses, a number.
///
/// Sensible from 10 to 1,000. Larger: light bodies between heavy ones are tossed about. Smaller: heaps of all sizes pay for what they
/// do not need. Shown by `stack_ratio`, `stack_mass_ratio`, and the tests of `stacks` with towers of any masses.
pub(super) const GRADED_RATIO: f32 = 100.0;

/// Trees of joints beyond which an island without loops is solved by turns, a number.
///
/// The response of all links grows with trees times contacts (ADR 0017). Sensible from 2 to 8. Larger: heaps of some figures take longer: with 8
/// instead of 2, a heap of ten takes half as much again, and its 99th percentile twice as much. Smaller: with 1 a heap of ten rests 2 to
/// 30 mm deep (`humanoid_pile_10` of `cargo xtask bench`). Shown by `ragdoll_pile` (beyond) and `ragdoll_poses` (below).
pub(super) const RESPONSE_TREES: usize = 2;

/// Trees of joints beyond which an island with loops is solved by turns, a number.
///
/// Loops are iterated between the turns, and what contacts do to them meanwhile may gain energy: with 2, nets of welds and springs do in 1 of 100
/// random worlds. Larger and smaller: as for [`RESPONSE_TREES`]. Shown by the test `random_worlds`.
pub(super) const RESPONSE_TREES_WITH_LOOPS: usize = 8;

/// Contacts, beside those of [`RESPONSE_CONTACTS_PER_LINK`], beyond which an island with joints is solved by turns, a number.
///
/// Sensible from 32 to 512. Larger and smaller: as for [`RESPONSE_TREES`]. Shown by a figure among many boxes (`ragdoll_on_boxes` of
/// `cargo xtask bench`).
pub(super) const RESPONSE_CONTACTS: usize = 128;

/// Contacts for each link that do not count towards [`RESPONSE_CONTACTS`], a number.
///
/// A tree of many links has many contacts that never push, with itself. Sensible from 0 to 8. Larger: a long chain in a heap is kept
/// with the response of all links at any price. Smaller: it is solved by turns on its own account. No scene shows it alone.
pub(super) const RESPONSE_CONTACTS_PER_LINK: usize = 4;

/// Most bodies that are solved as one tree, a number; joints beyond become rows of loops.
///
/// Sensible from 128 to some thousands. Larger: an island with a huge tree waits for one long factor. Smaller: long chains stretch
/// where they are cut, since rows of loops beyond [`MAX_EXACT_ROWS`] are iterated. No scene shows it alone.
pub(super) const MAX_TREE: usize = 1024;

/// Angle by which a joint may go farther beyond a hard limit within a long substep, radians.
///
/// Beyond it the island takes its step again in the world's substeps. Larger: limbs are over-extended in crashes. Smaller: crashes cost more.
/// Sensible from 0.02 to 0.1. Shown by `ragdoll_pile` of `cargo xtask bench`.
pub(super) const LIMIT_LEAP: f32 = 0.05;

/// Rounds a substep in which limits and contacts that it would pass by far are tightened, a number.
///
/// Each is a resumed pass of sweeps. Sensible from 1 to 8. More: violent crashes cost more. Fewer: a limb that whirls leaves its cone
/// on a side that no row faces. Shown by `ragdoll_wall_fast` and the test `humanoid::wall_hits`.
pub(super) const PREDICTIONS: usize = 8;

// ---- Sweeps ----

/// Sweeps of `relax` before which friction learns its loads anew, a number.
///
/// The impulses of `solve` first, then those that really press. From then on loads stay, or friction and normals may chase each other
/// for ever (ADR 0011). One: friction is that of what `solve` gave, bias and all. More than a few: `relax` need not converge. Shown by
/// `ragdoll_poses` (hands that tremble) and `slide_to_roll`.
pub(super) const FRICTION_BOUND_UPDATES: usize = 2;

/// Contacts from which on an island of free bodies is swept as a heap, a number.
///
/// Sensible from 8 to 64. Fewer: islands of few contacts get few sweeps; with 8 or 16 sweeps in such islands `block_overhang`, which
/// all but tips over, does (0.4 m in 10 s; ADR 0015). More: heaps take all the sweeps of a small pile. Shown by `block_overhang`,
/// `mesh_drop`.
pub(super) const HEAP_CONTACTS: usize = 16;

/// Support depth of a pile that the policy for unequal masses is for, a number.
///
/// One end of a pile feels the other after as many sweeps as it has levels, so taller ones get more in proportion. Larger: tall piles
/// of unequal masses are ended too soon. Smaller: they cost more. Sensible from 5 to 20. Shown by `stack_mass_ratio`.
pub(super) const POLICY_LEVELS: f32 = 10.0;

/// Most sweeps of `solve` for high and unequal piles, a number.
///
/// A bound on `96 n r^¼`, for `n` tens of levels and masses 1 : `r` (ADR 0015). Larger: such piles take longer. Smaller: they are ended
/// too soon, and sink. Sensible from 256 to 4,096. Shown by `stack_mass_ratio`.
pub(super) const MOST_SOLVE_SWEEPS: f32 = 1024.0;

/// Most sweeps of `relax` for high and unequal piles, a number.
///
/// A bound on `2 n r^½`, with the letters, the consequences and the scene of [`MOST_SOLVE_SWEEPS`]. Sensible from 128 to 2,048.
pub(super) const MOST_RELAX_SWEEPS: f32 = 512.0;

/// Least change of a velocity that ends the sweeps of unequal piles, m/s.
///
/// A bound on `0.002/(n r)` (ADR 0015): below it 32 bits have nothing more to say of velocities of a metre a second. Larger: light
/// bodies under heavy ones creep. Smaller: sweeps go on to their count. Sensible from 1e-8 to 1e-6. Shown by `stack_mass_ratio`.
pub(super) const LEAST_SWEEP_TOLERANCE: f32 = 1e-7;

/// Ratio of masses up to which every other sweep of a pile goes backward, a number.
///
/// All one way, each leaves a little motion to the side it comes from: a wall of 40 rows leaned by 2 mm in 200 steps, to and fro by 0.2
/// (ADR 0015). Larger: light bodies are squeezed out, since what cannot move does not have the last word. Smaller: more walls lean.
/// Sensible from 2 to 10. Shown by the test `stacks::a_wall_at_rest_stays_at_rest`, `stack_ratio`.
pub(super) const TO_AND_FRO_RATIO: f32 = 4.0;

/// Addition to the response of rows of contacts and limits, as a share of what the bodies would answer if nothing held them.
///
/// Rows that cannot move anything, since joints hold it already, answer with rounding errors alone (ADR 0010). Larger: rows yield under
/// load. Smaller: what is held answers by rounding; as a share of the row's own response a planar four-bar linkage exploded to 1e4 J.
/// Sensible from 1e-6 to 1e-4. Shown by the test `joints::a_four_bar_linkage_of_hinges_stays_closed`, `linkage`.
pub(super) const REDUNDANCY: f32 = 1e-5;

/// Proximal term of a manifold's normal block by response, as a share of its largest response, added to all.
///
/// Four points of a face leave the block singular. Larger: points yield under load. Smaller: the active set meets pivots of rounding,
/// cycles and falls back to trying all sets. Sensible from 1e-6 to 1e-4. No scene shows it alone; `ragdoll_drop` lands on such faces.
pub(super) const LCP_PROXIMAL: f32 = 1e-5;

/// Addition to the response of each point, and of friction, to itself in lanes, as a share of it.
///
/// Four points of a face leave their block singular. Larger: each visit gives too little, and sweeps add up. Smaller: nothing but
/// rounding stands between a redundant point and a quotient of zeros. Sensible from 1e-6 to 1e-3. No scene shows it alone.
pub(super) const POINT_PROXIMAL: f32 = 1e-5;

/// Rounds of Gauss-Seidel over the points of a manifold within a visit in lanes, a number.
///
/// Four points of a face share a load that one round would leave with the first. They stand in for the active set of `lcp.rs`: towers
/// stand with either (ADR 0017). More: visits cost more for little. Fewer: stacks rock. Sensible from 2 to 8. Shown by `jenga`,
/// `stack`.
pub(super) const MANIFOLD_ROUNDS: usize = 4;

/// Rounds over the rows of a block of limits in one visit at most, a number.
///
/// Limits of one tree answer to each other. More: crashes cost more. Fewer: the stops of a limb that folds come to agree only from
/// sweep to sweep. Sensible from 1 to 8. No scene shows it alone; `ragdoll_pile` counts limits that are passed.
pub(super) const LIMIT_ROUNDS: usize = 4;

// ---- Contacts ----

/// Stiffness of contacts between moving bodies as a frequency, Hz.
///
/// Never more than a quarter of the substep rate; [`Firmness`](crate::solver::sweep::policy::Firmness) takes a share of what it gives.
/// Larger: harder, and livelier at the edge of a foot. Smaller: piles sink before loads are known. Sensible from 10 to 60. Shown by
/// `heavy_foot`.
pub(super) const CONTACT_HERTZ: f32 = 30.0;

/// Stiffness of contacts with fixed bodies as a frequency, Hz.
///
/// Twice that of [`CONTACT_HERTZ`], with the same bounds, consequences and scene: what cannot move need not share.
pub(super) const FIXED_HERTZ: f32 = 60.0;

/// Damping ratio of contacts, a number.
///
/// Overlap goes without a bounce (Catto, "Soft Constraints", 2011). Larger: what overlaps comes out slowly. Below 1: it is thrown out.
/// Sensible from 2 to 20. No scene shows it alone; `stack` has it.
pub(super) const CONTACT_DAMPING: f32 = 10.0;

/// Time after which a load counts as lasting, seconds: contacts are soft to changes of their load alone.
///
/// A pile would sag by all the weight it bears (30 rows of cubes by a quarter of a cube). Larger: it sags while loads are found. At 0
/// tall piles of soft contacts never come to rest; tried in place of hardness, `jenga` stood and `stack_ratio` did not (ADR 0015).
/// Sensible from one step to some. Shown by `large_pyramid`, and by `box_pyramid` of `cargo xtask bench`: 15 layers sink by 3.1 mm
/// instead of 25.9 (docs/performance.md).
pub(super) const LASTING: f32 = 1.0 / 60.0;

/// Share of the slop that is left overlapping, a number below 1.
///
/// Larger: bodies rest deeper. At 0 what rests parts and meets again from substep to substep. Sensible from 0.05 to 0.5. Shown by
/// `stack` and the test `closed_forms::a_box_comes_to_rest_on_the_floor_and_sleeps`.
pub(super) const DEAD_ZONE: f32 = 0.2;

/// Overlap in slops beyond which a contact is deep, and its island may gain the height that brings it out, a number.
///
/// If there is one, 0.1 % of kinetic energy (or of 1 J/kg) is free in each substep: what is crushed must get out (ADR 0011). Larger: a
/// hand under a thigh stays in. Smaller: what stands on soft contacts may rock for ever. Sensible from 1 to 5. Shown by
/// `ragdoll_poses`, `heavy_foot`.
pub(super) const DEEP_SLOPS: f32 = 2.0;

/// Factor by which an impulse must grow within a substep to count as an impact, a number.
///
/// A load that lasts is kept, an impact is not repeated: repeating it gave 141° of limit overshoot and +214 J (docs/step.md). Contacts judge
/// it for the whole manifold. Larger: blows are given twice. Near 1: loads that grow are started from too little. Sensible from 1.5 to
/// 4. Shown by `ragdoll_wall`.
pub(super) const IMPACT_JUMP: f32 = 2.0;

/// Turn within a substep up to which `relax` may take back impulses of a body, radians.
///
/// An impulse taken back at another pose than it was given at adds energy: a hand went from 70 to 2,700 rad/s (ADR 0008). Larger: that.
/// Smaller: what `solve` gave too much stays, and bodies part that should rest. Sensible from 0.05 to 0.3. Shown by
/// `ragdoll_wall_fast`.
pub(super) const RELAX_TURN: f32 = 0.15;

/// Turn within a substep from which on contacts by response are looked for anew, radians.
///
/// Points of the step's beginning say nothing of the corner that swings in: a hand sank 33 mm into a thigh (docs/step.md). Larger:
/// that. Smaller: figures that roll over cost more. It also decides which contacts are foreseen, and by half of it which in lanes have
/// room for four points from the start. Sensible from 0.003 to 0.05. Shown by `ragdoll_drop`, `ragdoll_poses`.
pub(super) const REFRESH_TURN_RESPONSE: f32 = 0.01;

/// Turn since they were found from which on contacts in lanes are looked for anew, radians.
///
/// Points that are known stay exact, and corners that swing in by less have rows, since they were within reach. Larger: corners of what
/// tumbles come down unseen. With a fifth of it heaps that fall cost half as much again and are as deep. Sensible from 0.01 to 0.1.
/// Shown by `box_rain`.
pub(super) const REFRESH_TURN_LANES: f32 = 0.05;

/// Turn within a substep from which on contacts with what is kinematic are looked for anew, radians.
///
/// Spinning rods missed up to 33 of 80 balls that flew through their discs, and struck as many from where they had been. Larger: that, of rods that spin
/// slower. Smaller: limbs that clips lead cost more, and contacts with them have other bits. Sensible from 0.05 to 0.2. Shown by the test
/// `spinning::rods_strike_what_flies_through_their_discs`.
pub(super) const REFRESH_TURN_LED: f32 = 0.1;

/// Turn within a substep from which on the contacts of a rolling rim are looked for anew, radians.
///
/// However slowly it rolls, what pushes from where the rim was turns the body as much as it gyrates. Larger: discs roll in wrong
/// circles. Smaller: nothing but cost. Sensible from 1e-5 to 1e-3. Shown by the test
/// `rims::a_disc_rolls_in_a_circle_at_the_rate_of_its_closed_form`, `coin`.
pub(super) const REFRESH_TURN_RIM: f32 = 1e-4;

/// Distance up to which points found anew count, as a share of the smaller bounding radius.
///
/// A hand between thigh and floor that spins off one corner meets the other within the substep (ADR 0011). Larger: more rows that never
/// push. Smaller: it sinks in. Sensible from 0.1 to 1. Shown by `ragdoll_poses`.
pub(super) const FAR_CORNER: f32 = 0.4;

/// Depth to which a substep may press in points that its rows do not know, metres.
///
/// Beyond it the manifold of the predicted pose takes the place of the one at hand: a foot at 7 m/s met the other shin with a corner
/// that its rows did not know, and was 2 cm in (docs/step.md). Larger: limbs enter each other. Smaller: more passes are resumed.
/// Sensible from 0.2 to 5 mm. Shown by `ragdoll_drop`, the tests of `humanoid`.
pub(super) const PREDICTED_DEPTH: f32 = 1e-3;

/// Approach above which a contact in lanes has room for four points from the start, m/s.
///
/// Contacts that come in faster may have other points before the step is over. Larger: a fast body may come down on a point without a
/// place. Smaller: more blocks of four points that hold one. Sensible from 0.2 to 3. No scene shows it alone.
pub(super) const FAST_APPROACH: f32 = 1.0;

/// Sine up to which a cylinder's axis may lean against the plane across the normal and count as lying on its side.
///
/// Then its contact point goes along with its rounding. Larger: one that leans rolls on a line that it does not touch. Smaller: one
/// that rolls over bumps is pushed beside its lowest point. Sensible from 0.02 to 0.3. Shown by the test
/// `round_rest::a_lying_cylinder_rolls`.
pub(super) const LYING_SINE: f32 = 0.1;

/// Sine up to which the end of a cylinder or cone may lean and count as standing on it.
///
/// Larger: the wobble of a coin ends early. Smaller: one that stands is looked for anew for nothing. Sensible from 0.001 to 0.05. Shown by
/// the test `round_rest::a_standing_cylinder_stands_still`, `coin`.
pub(super) const FLAT_SINE: f32 = 0.01;

// ---- Friction ----

/// Slip of two surfaces, left over by static friction, above which they slide, m/s.
///
/// More than loads that have not converged make of it in a substep. The twist of a manifold is judged by the same speed at its lever.
/// Larger: what should slide sticks. Smaller: stacks at rest have only the friction of sliding. Sensible from 0.001 to 0.02. Shown by
/// `static_friction` and the tests of `surfaces`.
pub(super) const SLIP_SPEED: f32 = 0.005;

/// Weight of the load that a point has in the centre at which friction acts, a share; with [`WEIGHT_EVENLY`] it makes 1.
///
/// Larger: a point that is about to bear some has no say. Smaller: friction acts beside the centre of pressure, and turns what slides.
/// Sensible from 0.5 to 1. No scene shows it alone; `slide_to_roll` and `incline_slides` have it.
pub(super) const WEIGHT_OF_LOAD: f32 = 0.8;

/// Weight of all points alike in the centre at which friction acts, a share.
///
/// The rest to 1 of [`WEIGHT_OF_LOAD`]; larger does what that does where it is smaller, in the same scenes.
pub(super) const WEIGHT_EVENLY: f32 = 0.2;

/// Newton steps to the rim of the friction disk in lanes at most, a number.
///
/// They end within a ten-thousandth of the radius; what is left is scaled. More: nothing. Fewer: flat or slender bodies get friction
/// off its direction of least energy. Sensible from 3 to 10. No scene shows it alone; `incline_slides` has it.
pub(super) const FRICTION_RIM_STEPS: usize = 6;

// ---- Bounces ----

/// Approach below which nothing bounces, m/s.
///
/// Stacks do not feel restitution as noise (ADR 0013). An island in which something bounces faster takes all substeps. Larger: balls
/// stop early. Smaller: heaps tremble for long. Sensible from 0.1 to 2. Shown by `bouncing_balls` and the tests of `bounce`.
pub(super) const BOUNCE_SPEED: f32 = 1.0;

// ---- Limits ----

/// Fastest rate with which a violated stop of a rotation pushes back, rad/s.
///
/// Larger: what a crash bent beyond is thrown back, with energy that must be paid for. Smaller: it stays beyond for long; one that
/// whirls around outside of its cone leaves it as fast as this brings it back (ADR 0011, at 30 rad/s). Sensible from 1 to 10. Shown by
/// `ragdoll_wall_fast`.
pub(super) const LIMIT_PUSH_SPIN: f32 = 4.0;

/// Fastest rate with which a violated stop of a slide or distance pushes back, m/s.
///
/// For the reason, and with the range, of [`LIMIT_PUSH_SPIN`]. Shown by the test `joints::limits_hold_against_load_for_every_kind`.
pub(super) const LIMIT_PUSH_SPEED: f32 = 4.0;

/// Room below which a stop of a rotation gets a row even at rest, radians.
///
/// Two substeps at the joint's rate, or at the rate that a hit may give it, come on top. Larger: more rows that never push. Smaller: a
/// blow passes a stop that has none. Sensible from 0.05 to 0.5. Shown by `ragdoll_wall`; limits that are passed are counted by
/// `ragdoll_pile`.
pub(super) const LIMIT_MARGIN_ANGLE: f32 = 0.15;

/// Room below which a stop of a slide or distance gets a row even at rest, metres.
///
/// For the reason, and with the consequences, of [`LIMIT_MARGIN_ANGLE`]. Sensible from 0.02 to 0.5. No scene shows it alone; the test
/// `joints::a_slider_slides_along_its_axis_alone_and_stops_at_its_end` has such a stop.
pub(super) const LIMIT_MARGIN_LENGTH: f32 = 0.15;

/// Angle by which a stop may end a substep beyond where it should before its row is tightened, radians.
///
/// Rows foreseen cut overshoot at 15 m/s from 30–54° to < 1° (ADR 0008). Larger: stops are passed by as much. Smaller: more passes are
/// resumed. Sensible from 0.002 to 0.05. Shown by `ragdoll_wall_fast`, the test `humanoid::wall_hits`.
pub(super) const LIMIT_SLACK_ANGLE: f32 = 0.01;

/// Length by which a stop may end a substep beyond where it should before its row is tightened, metres.
///
/// For the reason, and with the consequences, of [`LIMIT_SLACK_ANGLE`]. Sensible from 0.001 to 0.05. No scene shows it alone; its stop
/// is that of [`LIMIT_MARGIN_LENGTH`].
pub(super) const LIMIT_SLACK_LENGTH: f32 = 0.01;

/// Most that the room of a stop may stray from its row's line, per square of the turn of its faster body, rad/rad².
///
/// Larger looks at more limits in vain; with less, a limb that turns fast passes a stop that curves away from its row. Sensible from 2
/// to 50. No scene shows it alone; `ragdoll_pile` counts limits that are passed.
pub(super) const LIMIT_BEND: f32 = 10.0;

/// Lever over which a hit turns linear speed into rotation at least, metres.
///
/// It sets how fast a joint may be turned by what touches, and so which stops get rows. Larger: stops of small limbs are missed in a
/// blow. Smaller: rows that never push. Sensible from 0.05 to 0.5, with the size of limbs. No scene shows it alone; `ragdoll_wall_fast`
/// has it.
pub(super) const HIT_LEVER: f32 = 0.2;

// ---- Joints and positions ----

/// Rounds of position corrections (SHAKE) in a pass at most, a number.
///
/// One or two nearly always, all six in violent hits: ending with the worse round left gaps of 0.01 to 0.3 mm in a crash, all six, of
/// which the best counts, 0.003 mm (ADR 0019). More: crashes cost more. Fewer: joints open there. Sensible from 3 to 10. Shown by
/// `ragdoll_pile`.
pub(super) const POSITION_CORRECTIONS: usize = 6;

/// Rounds of position corrections in a pass where loops are iterated at most, a number.
///
/// Each is a whole solution by conjugate gradients. More: nets cost as many times more. At 0 they drift apart. Shown by `net`,
/// `joint_grid`.
pub(super) const POSITION_CORRECTIONS_ITERATED: usize = 1;

/// Error of positions that needs no correction, metres of a gap and radians of a held rotation alike.
///
/// One number, since a tree is measured by its largest error, whichever row it is of, and all its rows are corrected together; in
/// strands, of ball joints, it is metres alone. With 3e-6 a triple pendulum drifts by 1.3 % of its energy (bar 1), though a scene of
/// rain takes 277 instead of 294 M instructions (docs/performance.md). Smaller: rounds about rounding. Sensible from 3e-7 to 1e-5.
/// Shown by `triple_pendulum`.
pub(super) const POSITION_TOLERANCE: f32 = 1e-6;

/// Error of a strand that needs no correction, as a share of its largest coordinate.
///
/// One and a half of its last digits, which is what rounding of two positions makes of a gap: at 40 m from the origin two of three
/// corrections were about rounding (ADR 0018). Larger: gaps. Smaller: those rounds. Sensible from 1 to 4 times `EPSILON`. Shown by
/// `chain_100_links`.
pub(super) const POSITION_ROUNDING: f32 = 1.5 * f32::EPSILON;

/// Share of a tree's error that a round may leave at most for another to follow.
///
/// A round that makes it larger is often followed by one that removes it, so that ends nothing (ADR 0019). Larger: rounds that gain
/// little. Smaller: errors that go slowly stay. Sensible from 0.5 to 0.99. No scene shows it alone.
pub(super) const WORTH_ANOTHER: f32 = 0.9;

/// Further solves of joint velocities in `relax` at most, a number.
///
/// One solve in 32 bits leaves too much between masses of 1 : 100,000 (ADR 0010). More: nothing. At 0 such joints keep rates. Sensible
/// from 1 to 4. Shown by `mass_ratio`.
pub(super) const REFINEMENTS: usize = 2;

/// Rate that joints may keep without a further solve, as a share of the fastest velocity.
///
/// One number of rates in m/s and rad/s together, as both are largest of all rows and of all velocities. Larger: `mass_ratio` keeps
/// velocities that open its joints. Smaller: every tree is solved again for its last digit. Sensible from 1e-5 to 1e-3. Shown by
/// `mass_ratio`.
pub(super) const RATE_SHARE: f32 = 1e-4;

/// Fastest that an open joint closes its gap, m/s.
///
/// One attached anew at a distance does not jump (ADR 0010). Larger: it is thrown together. Smaller: what a crash opened stays open for
/// long. Sensible from 1 to 20. Shown by the test `strands::a_joint_that_is_open_closes_as_in_an_island`.
pub(super) const CLOSING_SPEED: f32 = 4.0;

/// Fastest that a joint which is turned apart closes in a held rotation, rad/s.
///
/// For the reason, and with the range, of [`CLOSING_SPEED`]. No scene shows it alone; the test `random_worlds` breaks and joins joints
/// of all kinds anew.
pub(super) const CLOSING_SPIN: f32 = 4.0;

/// Length by which a weld that gives may be off beyond what its rows foresaw and still be corrected, metres.
///
/// More is a jump. Larger: jumps are corrected as if they were a drift. Smaller: a body on a soft weld that turns fast drifts outward
/// by `½ ω² r h²` a substep (ADR 0010). Sensible from 0.02 to 0.5. Shown by the test `joints::a_damped_weld_holds_a_body_that_turns`.
pub(super) const MOST_BENT_LENGTH: f32 = 0.1;

/// Angle by which a weld that gives may be off beyond what its rows foresaw and still be corrected, radians.
///
/// One that jumped by a full turn is no displacement. Sensible from 0.02 to 1, far below a turn; otherwise as [`MOST_BENT_LENGTH`], and
/// its test.
pub(super) const MOST_BENT_ANGLE: f32 = 0.1;

/// Pivot below which a direction is taken for held, as a share of what the pivot started as.
///
/// Less is rounding. Larger: directions that could move are held. Smaller: a direction that is all rounding answers by a huge number.
/// Sensible around the last digit of 32 bits, 1e-7 to 1e-5. No scene shows it alone; `gimbal` lines up its axes.
pub(super) const LEAST_PIVOT: f32 = 1e-7;

/// Square of the length below which an axis of a joint is none, a number (axes that are there have lengths of about 1).
///
/// Larger: a joint near its singularity loses a row early. Smaller: a row of rounding. Sensible from 1e-8 to 1e-4. Shown by `gimbal`.
pub(super) const LEAST_AXIS_SQUARE: f32 = 1e-6;

/// Share of an axis's square that must stand off the other axes of its joint, a number.
///
/// Larger: axes that lie nearly along each other are taken for one early. Smaller: their rows are rounding. Sensible from 1e-6 to 1e-3.
/// Shown by `gimbal`.
pub(super) const LEAST_AXIS_SHARE: f32 = 1e-5;

// ---- Drives ----

/// Rate below which dry friction of a rotation is no longer the full torque, rad/s.
///
/// Joint friction is a viscosity that gives the full torque at the present rate, but never more than this slow one would ask: a joint
/// that should stick creeps below it, and sleep ends the creep. Larger: limp figures sag. Smaller: gains so large that 32 bits lose the
/// limb beside them. Sensible from 0.001 to 0.02. Shown by the test `joints::friction_slows_a_hinge_by_its_torque`, `ragdoll_poses`.
pub(super) const STICK_SPIN: f32 = 0.004;

/// Rate below which dry friction of a slide is no longer the full force, m/s.
///
/// For the reason, and with the consequences, of [`STICK_SPIN`]. Sensible from 0.001 to 0.02. No scene shows it alone.
pub(super) const STICK_SPEED: f32 = 0.004;

/// Share of a substep within which a velocity motor would bring what it moves to its speed, a number.
///
/// A motor is a viscosity of that gain. Larger: it lags under load. Smaller: gains that 32 bits cannot hold beside a limb's mass.
/// Sensible from 1e-4 to 0.1. Shown by the tests of motors in `joints`.
pub(super) const MOTOR_SHARE: f32 = 1e-3;

/// Square of `ωh` up to which the oscillation of a spring is kept, a number.
///
/// Faster ones are more than a substep can show, and are left to implicit Euler (38 Hz by default; ADR 0010). Larger: springs that
/// shake. Smaller: damping ratio too large by `ωh/2` for slower ones. Sensible up to 1. Shown by the test
/// `joints::an_undamped_spring_keeps_its_period_and_energy`, `spring`.
pub(super) const FASTEST_SPRING: f32 = 1.0;

/// Factor on the least damping with which springs of too little mass are stable, a number.
///
/// Without it the spring is implicit Euler: what carries a figure by its hand must not shake when that is all that moves.
/// Larger: more springs lose their poles. Below 1: they shake. Sensible from 1 to 2. Shown by the test
/// `pins::an_underdamped_pin_on_a_light_end_does_not_shake`.
pub(super) const SPRING_MARGIN: f32 = 1.1;

/// Rounds a substep in which motors that ask for more than their caps are saturated, a number.
///
/// Each is a factor and a solve. More: nothing but cost where many saturate. Fewer: motors give more than their cap for a substep.
/// Sensible from 2 to 8. Shown by the test `joints::motors_in_a_chain_saturate_only_where_they_are_weak`, `powered`.
pub(super) const SATURATION_ROUNDS: usize = 4;

/// Mass that stands in where a row of translation moves none to speak of (both bodies held), kg.
///
/// A spring given by a frequency then asks for next to nothing. It must be positive and far below any body. No scene shows it alone.
pub(super) const LEAST_ROW_MASS: f32 = 1e-9;

/// Moment of inertia that stands in where a row of rotation moves none to speak of (both bodies held), kg·m².
///
/// For the reason of [`LEAST_ROW_MASS`], and far below any body's moments. No scene shows it alone.
pub(super) const LEAST_ROW_MOMENT: f32 = 1e-9;

// ---- Loops ----

/// Rows of loops in one tree up to which they are solved exactly, a number.
///
/// All loops by Schur complement took 66 ms a step for a `joint_grid` of side 12 (ADR 0010). More: such times. Fewer: closed chains are
/// iterated, with one position correction. Sensible from 6 to 48. Shown by `linkage` (exact), `net` and `joint_grid` (iterated).
pub(super) const MAX_EXACT_ROWS: usize = 24;

/// Rounds of conjugate gradients on loops at most, a number.
///
/// Each is a pass through the trees, and a pass that ends early has still taken energy out (ADR 0010). More: nets cost more, and open
/// less. Sensible from 8 to 64. Shown by `net`, `joint_grid`.
pub(super) const LOOP_ROUNDS: usize = 16;

/// Rate that loops may keep, m/s of translations and rad/s of rotations alike.
///
/// One number, since the gradients end by the sum of squares over all rows of the island's loops. Larger: nets creep. Smaller: rounds
/// about rounding. Sensible from 1e-6 to 1e-4. Shown by `joint_grid`.
pub(super) const LOOP_RATE_TOLERANCE: f32 = 1e-5;

/// Share of the residual's square that ends the rounds of conjugate gradients on loops, a number.
///
/// A thousandth of the residual. Larger: nets open. Smaller: all rounds are taken. Sensible from 1e-8 to 1e-4. Shown by `net`.
pub(super) const LOOP_RESIDUAL_SHARE: f32 = 1e-6;

/// Addition to the response of rows of loops, as a share of what the bodies would answer if nothing held them.
///
/// [`REDUNDANCY`] of loops: they meet the rounding of a whole way around. Larger: closed chains yield. Smaller: redundant rows make the
/// inverse mostly rounding, which grew a thousandfold per step (ADR 0010). Sensible from 1e-5 to 1e-3. Shown by the test
/// `joints::a_four_bar_linkage_of_hinges_stays_closed`.
pub(super) const LOOP_REDUNDANCY: f32 = 3e-5;

// ---- Piles ----

/// Cosine of the steepest slope on which a body is taken to stand when loads are guessed, a number.
///
/// About 45° (ADR 0015); a guess that is wrong costs sweeps, nothing else. Larger: what leans gets no guess. Smaller: what slides gets
/// one. Sensible from 0.5 to 0.9. Shown by `large_pyramid`, whose loads are guessed when it is made.
pub(super) const STANDING_COSINE: f32 = 0.7;

/// Fastest approach of a body that is taken to stand already when loads are guessed, m/s.
///
/// Larger: what falls is held up for a step as if it stood. Smaller: piles sink before their loads are found (a wall of 100 rows by 187
/// mm with many sweeps and no guesses, by 9 with guesses; ADR 0015). Sensible from 0.02 to 0.5. Shown by `large_pyramid`.
pub(super) const STANDING_SPEED: f32 = 0.1;

/// Mass of a body at least, per impulse that cancels itself on it in a substep, kg/(N·s).
///
/// A body that bears less than 4,000 times its weight has no mass scaling, and an ulp of that impulse is worth 1e-5 m/s. Larger: what is squeezed
/// is slow to move. Smaller: an ulp of the load of a tower tosses its lowest cube, by 4 m/s (ADR 0015). Sensible from 1e-3 to 0.05.
/// Shown by `stack_mass_ratio`, the test `stacks::towers_of_any_masses_stand_on_a_floor_that_bears_their_weight`.
pub(super) const MASS_SCALE: f32 = 6e-3;

/// Ratio of masses below which nobody has mass scaling, a number.
///
/// Sums of pushes are not made there. Larger: squeezed bodies are tossed. Smaller: heaps of all sizes pay for sums. Sensible from 100
/// to 4,000. Shown by the test `stacks::what_is_not_squeezed_weighs_what_it_weighs_beside_what_is_heavy`.
pub(super) const BALLASTED_RATIO: f32 = 1e3;

// ---- Safeguards ----

/// Angle that a link may turn within a substep beside the motion of its tree as a whole, radians.
///
/// Position corrections converge below it, and linearised rows mean something (ADR 0008). Larger: joints open in whips. Smaller: whips
/// are slowed that need not be. Sensible from 0.5 to 1.5. Shown by `ragdoll_wall_fast`; `mass_ratio` whips.
pub(super) const MAX_INNER_TURN: f32 = 1.0;

/// Share of the kinetic energy (of at least 1 J/kg) that a pass may give before it counts as an error.
///
/// Rounding and the give and take of resting contacts are far below. Larger: islands gain energy step by step. Smaller: warm starts are
/// dropped for rounding. Sensible from 1e-4 to 1e-2. Shown by the `random_worlds`, `ragdoll_wall_fast`.
pub(super) const ENERGY_SLACK: f32 = 1e-3;

/// Speed that no velocity has, as a multiple of the world's limit on speed.
///
/// Beyond it, the island moves as one piece for the pass. Speed is limited before the solve, so it must be well above 1. Sensible from
/// 1.5 to 10. Shown by the test `trouble::impulses_beyond_all_measure_are_limited_and_told_of`.
pub(super) const DIVERGED_SPEED: f32 = 2.5;

/// Spin that no body has, rad/s.
///
/// As [`DIVERGED_SPEED`], and well above what the world's limit on turns allows. Sensible from 1e3 to 1e5. Shown by the test
/// `trouble::spins_beyond_all_measure_are_limited_and_told_of`.
pub(super) const DIVERGED_SPIN: f32 = 1e4;

/// Error by which a substep may leave a joint more open than it was before it counts as not solved, metres of a gap and radians alike.
///
/// One number, since an island is judged by the largest error of all its rows (see [`POSITION_TOLERANCE`]). Larger: rows that
/// contradict each other fling bodies. Smaller: crashes are taken for contradictions, and figures move as one piece. Sensible from 0.03
/// to 0.5. Shown by the `random_worlds`.
pub(super) const TORN: f32 = 0.1;

// ---- Flight and strands ----

/// Turn of a body in flight within a substep at most, should the world's limit allow more, radians.
///
/// The series for sine and cosine reach so far. Never more than 3; smaller bounds spins that the world allows. Shown by the test
/// `flight::spin_and_speed_stay_within_the_worlds_limits`.
pub(super) const MOST_FLIGHT_TURN: f32 = 3.0;

/// Newton steps to the middle of a free body's spin at most, a number.
///
/// The implicit midpoint keeps energy and momentum to rounding (ADR 0018). More: nothing. Fewer: tops gain or lose energy. Sensible
/// from 2 to 6. Shown by `dzhanibekov`, `symmetric_top`.
pub(super) const MIDPOINT_STEPS: usize = 4;

/// Square of the relative change with which those Newton steps end, a number.
///
/// A change of 1e-6. Larger: boxes that flip over and over, which live by differences of 1e-6, leave their way. Smaller: a step more
/// for rounding. Sensible from 1e-14 to 1e-10. Shown by `dzhanibekov`.
pub(super) const MIDPOINT_TOLERANCE: f32 = 1e-12;

/// Turn of half a substep that those Newton steps take at most on their way, radians.
///
/// Within a quarter of a turn, should the world's limit allow more: beyond `π/2` the tangent of the Cayley map changes sign. Smaller:
/// fast spins are not on the midpoint. Sensible from 0.8 to 1.5. Shown by the tests of `solver/motion`.
pub(super) const MOST_HALF_TURN: f32 = 1.2;

/// Links from which on a strand is cut into eight pieces that go side by side.
///
/// A rope of 49 links takes a third of the instructions so; eight of a hundred links each take half as many again as they would whole.
/// More: single ropes of some thirty links take what one of fifty does. Fewer: many short ones of one length take longer. Sensible from 16
/// (two links in each piece) to 64. Shown by `hanging_rope`, `chain_100_links`.
pub(super) const CUT_STRANDS: usize = 24;

/// Multiple of `max_speed` and `max_turn` at which contacts clamp an approach, a ratio.
///
/// Forces slow a body that exceeds its bounds; contacts that had seen the full approach counted the slowing as a pull of
/// forces, and a bounce returned half of it. Larger: bounces use speeds at which no body moves. Smaller: speeds that solves leave slightly beyond the bounds change bits. Sensible from 2
/// to 100. Shown by the test `events::hits_beyond_all_measure_are_told_in_numbers`.
pub(super) const BEYOND_MEASURE: f32 = 4.0;
