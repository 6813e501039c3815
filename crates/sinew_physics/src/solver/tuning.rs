//! Tuning constants of the solver, by subject.
//!
//! The documentation of each constant states its unit, the reason for its value, the sensible range, the effects of larger and smaller
//! values, and the scene (`sinew run NAME`) or test (`crates/sinew_physics/tests/it`) that shows them. Numbers are measured. Ranges, and
//! effects without a number, are estimates: no sweep over values was made. Any change may change the golden hashes.
//!
//! Constants that are structures are in `sweep/policy.rs`: `JOINTED`, `TURNS`, `PILE`, `HEAP` and `UNEQUAL` (number of sweeps) and
//! [`Firmness`](crate::solver::sweep::policy::Firmness) (hardness of a pair's contact). Constants of layout and code (widths, sizes of
//! chunks and arrays, markers, ranges of series) are defined where they are used.

// ---- Substeps and coupling ----

/// Number of contacts at or above which an island of free bodies takes half of the substeps.
///
/// Many contacts damp all motion, and no single one dominates. Sensible from 16 to some hundreds. Smaller: with 16,
/// 10,000 boxes take a quarter less time, but `cards` sink by 2.009 mm (allowed: 2.0) and `wave_pile` sleeps 52 steps
/// too late (ADR 0015). Larger: small heaps take all substeps. Shown by `cards`, `wave_pile`.
pub(super) const DAMPED_CONTACTS: usize = 32;

/// Number of contacts per body at or above which an island with limp joints takes half of the substeps, a ratio.
///
/// Ragdolls that lie on the ground or on each other take half of the substeps, ragdolls that swing or fly take all. Sensible from 0.1 to 1.
/// Larger: heaps of ragdolls cost more. Smaller: ragdolls that hang by joints and hardly touch anything swing in the longer substep. Shown by
/// `ragdoll_pile`; the tests of `bobs` swing beneath a heap.
pub(super) const DAMPED_CONTACTS_PER_BODY: f32 = 0.25;

/// Number of contacts below which an island with joints takes all substeps.
///
/// With fewer than four contacts, a single one dominates: in half the substeps, a foot of 1 kg under 69 kg sinks by 2.3 mm instead of 2.
/// Sensible from 2 to 8. Larger: single lying ragdolls cost more. Smaller: the foot sinks. Shown by `heavy_foot`.
pub(super) const DAMPED_CONTACTS_JOINTED: usize = 4;

/// Largest turn of a body within a longer substep for its island to take longer substeps, radians.
///
/// Rows are linearised at the substep's beginning. Sensible from 0.05 to 0.5. Larger: spinning bodies hit contacts and stops without rows.
/// Smaller: heaps in motion cost more. No scene shows it alone; `wave_pile` and `ragdoll_pile` fall below it as they calm down.
pub(super) const CALM_TURN: f32 = 0.25;

/// Ratio of masses above which an island takes all substeps and a pile the sweeps for unequal masses, a number.
///
/// Sensible from 10 to 1,000. Larger: light bodies between heavy ones are tossed about. Smaller: heaps of mixed sizes take substeps and
/// sweeps that they do not need. Shown by `stack_ratio`, `stack_mass_ratio`, and the tests of `stacks` with towers of any masses.
pub(super) const GRADED_RATIO: f32 = 100.0;

/// Number of trees of joints above which an island is solved by turns.
///
/// The cost of the response of all links grows with trees times contacts (ADR 0017). Sensible from 1 to 16. Larger: heaps of a few ragdolls
/// take 1.5 times as long. Smaller: two colliding ragdolls penetrate each other by 6 mm. Shown by `brawl` (above) and `ragdoll_poses`
/// (below).
pub(super) const RESPONSE_TREES: usize = 2;

/// Number of contacts, without those of [`RESPONSE_CONTACTS_PER_LINK`], above which an island with joints is solved by turns.
///
/// Sensible from 32 to 512. Larger and smaller: as for [`RESPONSE_TREES`]. Shown by a ragdoll among many boxes (`ragdoll_on_boxes` of
/// `cargo xtask bench`).
pub(super) const RESPONSE_CONTACTS: usize = 128;

/// Number of contacts for each link that do not count towards [`RESPONSE_CONTACTS`].
///
/// A tree of many links has many contacts with itself that never push. Sensible from 0 to 8. Larger: a long chain in a heap uses the
/// response of all links at any cost. Smaller: a long chain alone is solved by turns. No scene shows it alone.
pub(super) const RESPONSE_CONTACTS_PER_LINK: usize = 4;

/// Largest number of bodies in a tree; further joints become loop joints.
///
/// Sensible from 128 to some thousands. Larger: an island with a huge tree waits for one long factor. Smaller: long chains stretch where
/// they are cut, since loop rows beyond [`MAX_EXACT_ROWS`] are iterated. No scene shows it alone.
pub(super) const MAX_TREE: usize = 1024;

/// Largest additional violation of a hard joint limit within a longer substep, radians.
///
/// If a joint exceeds this violation, the island repeats the step in the world's substeps. Larger: limbs are over-extended in crashes. Smaller: crashes
/// cost more. Sensible from 0.02 to 0.1. Shown by `ragdoll_pile` of `cargo xtask bench`.
pub(super) const LIMIT_LEAP: f32 = 0.05;

/// Largest number of rounds in a substep that tighten the rows of badly violated limits and contacts.
///
/// Each round resumes the pass of sweeps. Sensible from 1 to 8. Larger: violent crashes cost more. Smaller: a whirling limb leaves its cone
/// on a side without a row. Shown by `ragdoll_wall_fast` and the test `humanoid::wall_hits`.
pub(super) const PREDICTIONS: usize = 8;

// ---- Sweeps ----

/// Number of first sweeps of `relax` that update the loads of friction.
///
/// The first update uses the impulses of `solve`, the second those of the first sweep. Then the loads stay fixed; otherwise friction and
/// normal impulses may alternate for ever (ADR 0011). With one update, friction uses the impulses of `solve`, bias included. With more than
/// a few, `relax` may not converge. Shown by `ragdoll_poses` (hands that vibrate) and `slide_to_roll`.
pub(super) const FRICTION_BOUND_UPDATES: usize = 2;

/// Number of contacts at or above which an island of free bodies uses the sweep policy of heaps.
///
/// Sensible from 8 to 64. Smaller: islands of few contacts get few sweeps; with 8 or 16 sweeps in such islands `block_overhang`, which is
/// close to tipping, tips over (0.4 m in 10 s; ADR 0015). Larger: heaps take all the sweeps of a small pile. Shown by `block_overhang`,
/// `mesh_drop`.
pub(super) const HEAP_CONTACTS: usize = 16;

/// Support depth of the pile that the sweep policy for unequal masses is tuned to, a number.
///
/// Impulses propagate one level a sweep, so taller piles get proportionally more sweeps. Larger: the sweeps of tall piles of unequal masses
/// end too soon. Smaller: such piles cost more. Sensible from 5 to 20. Shown by `stack_mass_ratio`.
pub(super) const POLICY_LEVELS: f32 = 10.0;

/// Largest number of `solve` sweeps for tall piles of unequal masses.
///
/// A bound on `96 n r^¼`, for `n` tens of levels and masses 1 : `r` (ADR 0015). Larger: such piles take longer. Smaller: sweeps end too
/// soon, and the piles sink. Sensible from 256 to 4,096. Shown by `stack_mass_ratio`.
pub(super) const MOST_SOLVE_SWEEPS: f32 = 1024.0;

/// Largest number of `relax` sweeps for tall piles of unequal masses.
///
/// A bound on `2 n r^½`; variables, effects and scene are those of [`MOST_SOLVE_SWEEPS`]. Sensible from 128 to 2,048.
pub(super) const MOST_RELAX_SWEEPS: f32 = 512.0;

/// Least change of a velocity that ends the sweeps of unequal piles, m/s.
///
/// A bound on `0.002/(n r)` (ADR 0015): smaller changes are within the rounding error of velocities around 1 m/s in 32 bits. Larger: light
/// bodies under heavy ones creep. Smaller: the solver makes all sweeps up to the largest number. Sensible from 1e-8 to 1e-6. Shown by
/// `stack_mass_ratio`.
pub(super) const LEAST_SWEEP_TOLERANCE: f32 = 1e-7;

/// Ratio of masses up to which every other sweep of a pile goes backward, a number.
///
/// Sweeps that all go one way leave a small motion to one side: a wall of 40 rows leaned by 2 mm in 200 steps, with alternating sweeps by
/// 0.2 (ADR 0015). Larger: light bodies are squeezed out, since the contacts with fixed bodies are not solved last. Smaller: more walls
/// lean. Sensible from 2 to 10. Shown by the test `stacks::a_wall_at_rest_stays_at_rest`, `stack_ratio`.
pub(super) const TO_AND_FRO_RATIO: f32 = 4.0;

/// Regularisation of contact and limit rows, as a share of the bodies' response without joints.
///
/// Rows that joints prevent from moving anything respond with rounding errors only (ADR 0010). Larger: rows yield under load. Smaller:
/// rounding determines the response of such rows. As a share of the row's own response, it made a planar four-bar linkage explode to 1e4 J.
/// Sensible from 1e-6 to 1e-4. Shown by the test `joints::a_four_bar_linkage_of_hinges_stays_closed`, `linkage`.
pub(super) const REDUNDANCY: f32 = 1e-5;

/// Proximal term of a manifold's normal block (by response), as a share of its largest response, added to each diagonal entry.
///
/// Four points of a face leave the block singular. Larger: points yield under load. Smaller: the active set method meets pivots of pure
/// rounding error, cycles and falls back to trying all sets. Sensible from 1e-6 to 1e-4. No scene shows it alone; `ragdoll_drop` lands on
/// such faces.
pub(super) const LCP_PROXIMAL: f32 = 1e-5;

/// Regularisation of each point's and friction's own response in lanes, as a share of that response.
///
/// Four points of a face leave their block singular. Larger: each visit applies too small an impulse, and more sweeps are needed. Smaller:
/// only rounding keeps a redundant point from a division of zero by zero. Sensible from 1e-6 to 1e-3. No scene shows it alone.
pub(super) const POINT_PROXIMAL: f32 = 1e-5;

/// Number of Gauss-Seidel rounds over the points of a manifold within a visit in lanes.
///
/// One round would leave the load of a face's four points mostly on the first one. The rounds replace the active set of `lcp.rs`: towers
/// stand with either (ADR 0017). Larger: visits cost more for little gain. Smaller: stacks rock. Sensible from 2 to 8. Shown by `jenga`,
/// `stack`.
pub(super) const MANIFOLD_ROUNDS: usize = 4;

/// Largest number of rounds over the rows of a limit block in one visit.
///
/// Limits of one tree influence each other. Larger: crashes cost more. Smaller: the stops of a folding limb converge only from sweep to
/// sweep. Sensible from 1 to 8. No scene shows it alone; `ragdoll_pile` counts violated limits.
pub(super) const LIMIT_ROUNDS: usize = 4;

// ---- Contacts ----

/// Stiffness of contacts between moving bodies as a frequency, Hz.
///
/// The frequency is limited to a quarter of the substep rate; [`Firmness`](crate::solver::sweep::policy::Firmness) scales the resulting
/// softness. Larger: contacts are harder, and the edge of a foot jitters. Smaller: piles sink before loads are known. Sensible from 10 to
/// 60. Shown by `heavy_foot`.
pub(super) const CONTACT_HERTZ: f32 = 30.0;

/// Stiffness of contacts with fixed bodies as a frequency, Hz.
///
/// Twice [`CONTACT_HERTZ`], since only one of the bodies moves; bounds, effects and scene are the same.
pub(super) const FIXED_HERTZ: f32 = 60.0;

/// Damping ratio of contacts, a number.
///
/// Overlap is removed without a bounce (Catto, "Soft Constraints", 2011). Larger: overlap is removed slowly. Below 1: overlapping bodies
/// are thrown out. Sensible from 2 to 20. No scene shows it alone; `stack` uses it.
pub(super) const CONTACT_DAMPING: f32 = 10.0;

/// Time after which a load counts as lasting, seconds; contacts are soft only to changes of their load.
///
/// If contacts were soft to their whole load, a pile would sag by its weight (30 rows of cubes by a quarter of a cube). Larger: piles sag
/// while loads are found. At 0, tall piles of soft contacts never come to rest; tried instead of hard contacts, `jenga` stood and
/// `stack_ratio` did not (ADR 0015). Sensible from one step to a few. Shown by `large_pyramid`, and by `box_pyramid` of `cargo xtask
/// bench`: 15 layers sink by 3.1 mm instead of 25.9 (docs/performance.md).
pub(super) const LASTING: f32 = 1.0 / 60.0;

/// Share of the slop that is left as overlap, a number below 1.
///
/// Larger: bodies rest deeper. At 0, resting bodies separate and touch again from substep to substep. Sensible from 0.05 to 0.5. Shown by
/// `stack` and the test `closed_forms::a_box_comes_to_rest_on_the_floor_and_sleeps`.
pub(super) const DEAD_ZONE: f32 = 0.2;

/// Overlap above which a contact counts as deep, in multiples of the slop.
///
/// An island with a deep contact may gain the height that removes the overlap, and 0.1 % of its kinetic energy (or of 1 J/kg) in each
/// substep, so that crushed bodies get out (ADR 0011). Larger: a hand under a thigh stays in. Smaller: bodies on soft contacts may rock for
/// ever. Sensible from 1 to 5. Shown by `ragdoll_poses`, `heavy_foot`.
pub(super) const DEEP_SLOPS: f32 = 2.0;

/// Factor by which an impulse must grow within a substep to count as an impact, a number.
///
/// Lasting loads are warm-started, impacts are not: repeating an impact gave 141° of limit overshoot and +214 J (docs/step.md). The whole
/// manifold is compared. Larger: impacts are applied twice. Near 1: the warm start of growing loads is too small. Sensible from 1.5 to 4.
/// Shown by `ragdoll_wall`.
pub(super) const IMPACT_JUMP: f32 = 2.0;

/// Largest turn of a body within a substep for `relax` to take back its impulses, radians.
///
/// An impulse taken back at another pose adds energy: a hand went from 70 to 2,700 rad/s (ADR 0008). Larger: violent hits add energy.
/// Smaller: excess impulses of `solve` stay, and bodies separate that should rest. Sensible from 0.05 to 0.3. Shown by
/// `ragdoll_wall_fast`.
pub(super) const RELAX_TURN: f32 = 0.15;

/// Turn within a substep at or above which contacts by response are recomputed, radians.
///
/// The points of the step's beginning do not include a corner that swings in: a hand sank 33 mm into a thigh (docs/step.md). Larger: such
/// corners sink in. Smaller: rolling ragdolls cost more. The value also decides which contacts are predicted, and half of it which contacts
/// in lanes have room for four points from the start. Sensible from 0.003 to 0.05. Shown by `ragdoll_drop`, `ragdoll_poses`.
pub(super) const REFRESH_TURN_RESPONSE: f32 = 0.01;

/// Turn since the last computation at or above which contacts in lanes are recomputed, radians.
///
/// Known points stay exact, and corners that swing in by a smaller turn have rows, since they were within the margin. Larger: corners of
/// tumbling bodies hit the ground without rows. With a fifth of the value, falling heaps cost 1.5 times as much and penetrate as deeply.
/// Sensible from 0.01 to 0.1. Shown by `box_rain`.
pub(super) const REFRESH_TURN_LANES: f32 = 0.05;

/// Turn within a substep at or above which contacts with kinematic bodies are recomputed, radians.
///
/// Without recomputing, spinning rods missed up to 33 of 80 balls that flew through their discs, and hit as many at positions that the rods had
/// left. Larger: slower rods miss balls too. Smaller: limbs moved by clips cost more, and the bits of their contacts change. Sensible from
/// 0.05 to 0.2. Shown by the test `spinning::rods_hit_balls_that_fly_through_their_discs`.
pub(super) const REFRESH_TURN_LED: f32 = 0.1;

/// Turn within a substep at or above which the contacts of a rolling rim are recomputed, radians.
///
/// However slowly the rim rolls, a push at its old position turns the body as much as gyration does. Larger: discs roll in wrong circles.
/// Smaller: only the cost rises. Sensible from 1e-5 to 1e-3. Shown by the test
/// `rims::a_disc_rolls_in_a_circle_at_the_rate_of_its_closed_form`, `coin`.
pub(super) const REFRESH_TURN_RIM: f32 = 1e-4;

/// Distance up to which recomputed contacts get points, as a share of the smaller bounding radius.
///
/// A hand between thigh and floor that spins off one corner hits the other within the substep (ADR 0011). Larger: there are more rows that
/// never push. Smaller: the hand sinks in. Sensible from 0.1 to 1. Shown by `ragdoll_poses`.
pub(super) const FAR_CORNER: f32 = 0.4;

/// Largest predicted penetration of points without rows in a substep, metres.
///
/// Above it, the manifold of the predicted pose replaces the present one: a foot at 7 m/s hit the other shin with a corner without rows,
/// and penetrated by 2 cm (docs/step.md). Larger: limbs penetrate each other. Smaller: more passes are resumed. Sensible from 0.2 to 5 mm.
/// Shown by `ragdoll_drop`, the tests of `humanoid`.
pub(super) const PREDICTED_DEPTH: f32 = 1e-3;

/// Approach speed above which a contact in lanes has room for four points from the start, m/s.
///
/// Faster contacts may get other points within the step. Larger: there may be no room for a new point of a fast body. Smaller: more blocks
/// of four points hold only one. Sensible from 0.2 to 3. No scene shows it alone.
pub(super) const FAST_APPROACH: f32 = 1.0;

/// Sine of the largest tilt of a cylinder's axis at which it counts as lying on its side.
///
/// The tilt is measured against the contact plane. The contact point of a lying cylinder follows its rounding. Larger: a tilted cylinder
/// rolls on a line that it does not touch. Smaller: a cylinder that rolls over bumps is pushed beside its lowest point. Sensible from 0.02
/// to 0.3. Shown by the test `round_rest::a_lying_cylinder_rolls`.
pub(super) const LYING_SINE: f32 = 0.1;

/// Sine of the largest tilt of a cylinder's or cone's end at which the shape counts as standing on it.
///
/// Larger: the wobble of a coin ends early. Smaller: contacts of standing shapes are recomputed for nothing. Sensible from 0.001 to 0.05.
/// Shown by the test `round_rest::a_standing_cylinder_stands_still`, `coin`.
pub(super) const FLAT_SINE: f32 = 0.01;

// ---- Friction ----

/// Slip speed above which static friction changes to sliding friction, m/s.
///
/// The value is larger than the slip that unconverged loads cause in a substep. The twist of a manifold is compared to the same speed at its lever
/// arm. Larger: bodies that should slide stick. Smaller: stacks at rest have only sliding friction. Sensible from 0.001 to 0.02. Shown by
/// `static_friction` and the tests of `surfaces`.
pub(super) const SLIP_SPEED: f32 = 0.005;

/// Weight of a point's load in the friction centre, a share; this and [`WEIGHT_EVENLY`] sum to 1.
///
/// Larger: a point that is about to bear load has no weight. Smaller: friction acts beside the centre of pressure, and turns sliding
/// bodies. Sensible from 0.5 to 1. No scene shows it alone; `slide_to_roll` and `incline_slides` use it.
pub(super) const WEIGHT_OF_LOAD: f32 = 0.8;

/// Weight distributed evenly over the points in the friction centre, a share.
///
/// The value is 1 minus [`WEIGHT_OF_LOAD`]; a larger value has the effects of a smaller one there, in the same scenes.
pub(super) const WEIGHT_EVENLY: f32 = 0.2;

/// Largest number of Newton steps to the rim of the friction disk in lanes.
///
/// The steps end within 1e-4 of the radius; scaling removes the remaining error. Larger: no effect. Smaller: the friction of flat or
/// slender bodies deviates from the direction of least energy. Sensible from 3 to 10. No scene shows it alone; `incline_slides` uses it.
pub(super) const FRICTION_RIM_STEPS: usize = 6;

// ---- Bounces ----

/// Approach speed below which contacts do not bounce, m/s.
///
/// Without a lower bound, restitution makes stacks jitter (ADR 0013). An island with a faster bounce takes all substeps. Larger: balls stop bouncing
/// early. Smaller: heaps jitter for long. Sensible from 0.1 to 2. Shown by `bouncing_balls` and the tests of `bounce`.
pub(super) const BOUNCE_SPEED: f32 = 1.0;

// ---- Limits ----

/// Largest rate at which a violated rotational stop is corrected, rad/s.
///
/// Larger: a joint that a crash bent beyond its limit is thrown back, with energy that has to be removed elsewhere. Smaller: the limit
/// stays violated for long; a limb that circles outside its cone drifts out as fast as the correction brings it back (ADR 0011, at
/// 30 rad/s). Sensible from 1 to 10. Shown by `ragdoll_wall_fast`.
pub(super) const LIMIT_PUSH_SPIN: f32 = 4.0;

/// Largest rate at which a violated stop of a slide or distance is corrected, m/s.
///
/// Reason and range are those of [`LIMIT_PUSH_SPIN`]. Shown by the test `joints::limits_hold_against_load_for_every_kind`.
pub(super) const LIMIT_PUSH_SPEED: f32 = 4.0;

/// Slack below which a rotational stop gets a row even at rest, radians.
///
/// The motion in two substeps at the joint's rate, or at the rate after a possible hit, is added. Larger: there are more rows that never
/// push. Smaller: a hit violates a stop that has no row. Sensible from 0.05 to 0.5. Shown by `ragdoll_wall`; `ragdoll_pile` counts violated
/// limits.
pub(super) const LIMIT_MARGIN_ANGLE: f32 = 0.15;

/// Slack below which a stop of a slide or distance gets a row even at rest, metres.
///
/// Reason and effects are those of [`LIMIT_MARGIN_ANGLE`]. Sensible from 0.02 to 0.5. No scene shows it alone; the test
/// `joints::a_slider_slides_along_its_axis_alone_and_stops_at_its_end` has such a stop.
pub(super) const LIMIT_MARGIN_LENGTH: f32 = 0.15;

/// Error of a rotational stop at a substep's end above which its row is tightened, radians.
///
/// Predicted rows cut the overshoot at 15 m/s from 30–54° to < 1° (ADR 0008). Larger: stops are violated by as much. Smaller: more passes
/// are resumed. Sensible from 0.002 to 0.05. Shown by `ragdoll_wall_fast`, the test `humanoid::wall_hits`.
pub(super) const LIMIT_SLACK_ANGLE: f32 = 0.01;

/// Error of a linear stop at a substep's end above which its row is tightened, metres.
///
/// Reason and effects are those of [`LIMIT_SLACK_ANGLE`]. Sensible from 0.001 to 0.05. No scene shows it alone; the test of
/// [`LIMIT_MARGIN_LENGTH`] has such a stop.
pub(super) const LIMIT_SLACK_LENGTH: f32 = 0.01;

/// Bound on the nonlinearity of a stop's slack, per square of the turn of its faster body, rad/rad².
///
/// Larger: more limits are checked in vain. Smaller: a fast limb violates a stop that curves away from its row. Sensible from 2 to 50.
/// No scene shows it alone; `ragdoll_pile` counts violated limits.
pub(super) const LIMIT_BEND: f32 = 10.0;

/// Least lever arm over which a hit converts linear speed to rotation, metres.
///
/// The lever arm sets the assumed rate of a joint after a hit, which decides the stops that get rows. Larger: stops of small limbs are
/// missed in a hit. Smaller: there are more rows that never push. Sensible from 0.05 to 0.5, with the size of limbs. No scene shows it
/// alone; `ragdoll_wall_fast` uses it.
pub(super) const HIT_LEVER: f32 = 0.2;

// ---- Joints and positions ----

/// Largest number of position corrections (SHAKE) in a pass.
///
/// Nearly always one or two are made, in violent hits all six. Ending with the first round that is worse than the one before left gaps of
/// 0.01 to 0.3 mm in a crash; using the best of all six leaves 0.003 mm (ADR 0019). Larger: crashes cost more. Smaller: joints open in
/// crashes. Sensible from 3 to 10. Shown by `ragdoll_pile`.
pub(super) const POSITION_CORRECTIONS: usize = 6;

/// Largest number of position corrections in a pass with iterated loops.
///
/// Each correction is a full solve by conjugate gradients. Larger: nets cost proportionally more. At 0, nets drift apart. Shown by `net`,
/// `joint_grid`.
pub(super) const POSITION_CORRECTIONS_ITERATED: usize = 1;

/// Position error that needs no correction, for gaps in metres and locked rotations in radians.
///
/// There is one value for both units, since a tree is judged by its largest error over all rows, and all its rows are corrected together.
/// Strands have ball joints only, so the unit there is metres. With 3e-6 a triple pendulum drifts by 1.3 % of its energy (allowed: 1), though a
/// scene of rain takes 277 instead of 294 M instructions (docs/performance.md). Smaller: corrections act on rounding errors. Sensible from
/// 3e-7 to 1e-5. Shown by `triple_pendulum`.
pub(super) const POSITION_TOLERANCE: f32 = 1e-6;

/// Position error that needs no correction, as a share of the largest coordinate of a tree or strand.
///
/// The value is 1.5 ulp, the rounding error of the difference of two positions; below 5.6 m [`POSITION_TOLERANCE`] is larger. With that
/// alone, figures up to 75 m from the origin took five corrections a substep instead of 0.8, and chains at 40 m made two of three for
/// rounding errors (ADR 0018, ADR 0019). Larger: gaps stay open. Smaller: corrections act on rounding errors. Sensible from 1 to 4 times
/// `EPSILON`. Shown by `rain` of `cargo xtask bench`, `chain_100_links`.
pub(super) const POSITION_ROUNDING: f32 = 1.5 * f32::EPSILON;

/// Largest share of a tree's error that a correction may leave for another one to follow.
///
/// A correction that increases the error does not end the rounds, since the next one often removes it (ADR 0019). Larger: trees make
/// corrections with little gain. Smaller: slowly converging errors stay. Sensible from 0.5 to 0.99. No scene shows it alone.
pub(super) const WORTH_ANOTHER: f32 = 0.9;

/// Largest number of additional solves of joint velocities in `relax`.
///
/// With mass ratios of 1 : 100,000, one solve in 32 bits leaves too large an error (ADR 0010). Larger: no effect. At 0, such joints keep a
/// rate. Sensible from 1 to 4. Shown by `mass_ratio`.
pub(super) const REFINEMENTS: usize = 2;

/// Largest remaining joint rate without another solve, as a share of the largest velocity.
///
/// There is one value for m/s and rad/s, since both rates and velocities are maxima over all components. Larger: `mass_ratio` keeps
/// velocities that open its joints. Smaller: every tree is solved again to correct rounding errors. Sensible from 1e-5 to 1e-3. Shown by
/// `mass_ratio`.
pub(super) const RATE_SHARE: f32 = 1e-4;

/// Largest speed at which an open joint closes its gap, m/s.
///
/// A joint newly attached at a distance does not jump (ADR 0010). Larger: its bodies are thrown together. Smaller: joints opened by a crash
/// stay open for long. Sensible from 1 to 20. Shown by the test `strands::a_joint_that_is_open_closes_as_in_an_island`.
pub(super) const CLOSING_SPEED: f32 = 4.0;

/// Largest rate at which the error of a locked rotation is corrected, rad/s.
///
/// Reason and range are those of [`CLOSING_SPEED`]. No scene shows it alone; the test `random_worlds` breaks and reattaches joints of all
/// kinds.
pub(super) const CLOSING_SPIN: f32 = 4.0;

/// Largest length error of a soft weld beyond the prediction of its rows that is corrected, metres.
///
/// A larger error is a jump. Larger: jumps are corrected as if they were drift. Smaller: a body on a soft weld that turns fast drifts
/// outward by `½ ω² r h²` a substep (ADR 0010). Sensible from 0.02 to 0.5. Shown by the test
/// `joints::a_damped_weld_holds_a_body_that_turns`.
pub(super) const MOST_BENT_LENGTH: f32 = 0.1;

/// Largest angular error of a soft weld beyond the prediction of its rows that is corrected, radians.
///
/// An angle that jumped by a full turn is no displacement. Sensible from 0.02 to 1, far below a turn; effects and test are those of
/// [`MOST_BENT_LENGTH`].
pub(super) const MOST_BENT_ANGLE: f32 = 0.1;

/// Pivot below which a direction counts as locked, as a share of the initial pivot.
///
/// A smaller pivot is rounding error. Larger: directions that could move are locked. Smaller: a direction that is pure rounding error gets
/// a huge response. Sensible around an ulp of 32 bits, 1e-7 to 1e-5. No scene shows it alone; `gimbal` aligns its axes.
pub(super) const LEAST_PIVOT: f32 = 1e-7;

/// Squared length below which a joint axis counts as degenerate, a number (valid axes have lengths of about 1).
///
/// Larger: a joint near its singularity loses a row early. Smaller: the row is pure rounding error. Sensible from 1e-8 to 1e-4. Shown by
/// `gimbal`.
pub(super) const LEAST_AXIS_SQUARE: f32 = 1e-6;

/// Least share of an axis's square perpendicular to the joint's other axes, a number.
///
/// Larger: nearly parallel axes count as one early. Smaller: their rows are rounding errors. Sensible from 1e-6 to 1e-3. Shown by `gimbal`.
pub(super) const LEAST_AXIS_SHARE: f32 = 1e-5;

// ---- Drives ----

/// Rate below which rotational dry friction is less than the full torque, rad/s.
///
/// Joint friction is a viscosity that gives the full torque at the present rate, but at most the viscosity at this rate. A joint that
/// should stick creeps below this rate, until it sleeps. Larger: limp ragdolls sag. Smaller: gains are so large that the limb's inertia is
/// lost in 32 bits. Sensible from 0.001 to 0.02. Shown by the test `joints::friction_slows_a_hinge_by_its_torque`, `ragdoll_poses`.
pub(super) const STICK_SPIN: f32 = 0.004;

/// Rate below which dry friction of a slide is less than the full force, m/s.
///
/// Reason and effects are those of [`STICK_SPIN`]. Sensible from 0.001 to 0.02. No scene shows it alone.
pub(super) const STICK_SPEED: f32 = 0.004;

/// Time in which a velocity motor accelerates its load to the target rate, as a share of a substep.
///
/// A motor is a viscosity of that gain. Larger: the motor lags under load. Smaller: gains are so large that the limb's mass is lost in 32
/// bits. Sensible from 1e-4 to 0.1. Shown by the tests of motors in `joints`.
pub(super) const MOTOR_SHARE: f32 = 1e-3;

/// Largest `(ωh)²` for which the oscillation of a spring is reproduced, a number.
///
/// Faster oscillations cannot be resolved by the substep and use implicit Euler (38 Hz by default; ADR 0010). Larger: springs shake.
/// Smaller: the damping ratio of slower springs is too large by `ωh/2`. Sensible up to 1. Shown by the test
/// `joints::an_undamped_spring_keeps_its_period_and_energy`, `spring`.
pub(super) const FASTEST_SPRING: f32 = 1.0;

/// Safety factor for the least damping at which a spring on a small mass is stable, dimensionless.
///
/// A spring with less damping uses implicit Euler: a pin that carries a ragdoll by its hand must not shake if only the hand moves. Larger:
/// more springs lose their exact poles. Below 1: such pins shake. Sensible from 1 to 2. Shown by the test
/// `pins::an_underdamped_pin_on_a_light_end_does_not_shake`.
pub(super) const SPRING_MARGIN: f32 = 1.1;

/// Largest number of rounds in a substep that saturate motors beyond their caps.
///
/// Each round is a factor and a solve. Larger: only the cost rises where many motors saturate. Smaller: motors exceed their caps for a
/// substep. Sensible from 2 to 8. Shown by the test `joints::motors_in_a_chain_saturate_only_where_they_are_weak`, `powered`.
pub(super) const SATURATION_ROUNDS: usize = 4;

/// Substitute for the mass of a translation row whose bodies are both held, kg.
///
/// A spring given by a frequency then has almost no force. The value must be positive and far below any body's mass. No scene shows it alone.
pub(super) const LEAST_ROW_MASS: f32 = 1e-9;

/// Substitute for the inertia of a rotation row whose bodies are both held, kg·m².
///
/// The reason is that of [`LEAST_ROW_MASS`]; the value must be far below any body's moments. No scene shows it alone.
pub(super) const LEAST_ROW_MOMENT: f32 = 1e-9;

// ---- Loops ----

/// Largest number of loop rows in a tree that are solved exactly.
///
/// Solving all loops by Schur complement took 66 ms a step for a `joint_grid` of side 12 (ADR 0010). Larger: large grids take as long.
/// Smaller: closed chains are iterated, with one position correction. Sensible from 6 to 48. Shown by `linkage` (exact), `net` and
/// `joint_grid` (iterated).
pub(super) const MAX_EXACT_ROWS: usize = 24;

/// Largest number of conjugate gradient rounds on loops.
///
/// Each round is a pass through the trees and removes energy, so the rounds may end early (ADR 0010). Larger: nets cost more, and open
/// less. Sensible from 8 to 64. Shown by `net`, `joint_grid`.
pub(super) const LOOP_ROUNDS: usize = 16;

/// Largest remaining rate of loops, for translations in m/s and rotations in rad/s.
///
/// There is one value for both units, since the rounds end by the sum of squares over all loop rows of the island. Larger: nets creep.
/// Smaller: rounds act on rounding errors. Sensible from 1e-6 to 1e-4. Shown by `joint_grid`.
pub(super) const LOOP_RATE_TOLERANCE: f32 = 1e-5;

/// Share of the residual's square that ends the rounds of conjugate gradients on loops, a number.
///
/// The value is 1e-3 of the residual, squared. Larger: nets open. Smaller: all rounds are made. Sensible from 1e-8 to 1e-4. Shown by `net`.
pub(super) const LOOP_RESIDUAL_SHARE: f32 = 1e-6;

/// Regularisation of loop rows, as a share of the bodies' response without joints.
///
/// The counterpart of [`REDUNDANCY`]; it is larger since rounding accumulates around the whole loop. Larger: closed chains yield. Smaller:
/// redundant rows make the inverse mostly rounding, which grew a thousandfold per step (ADR 0010). Sensible from 1e-5 to 1e-3. Shown by the
/// test `joints::a_four_bar_linkage_of_hinges_stays_closed`.
pub(super) const LOOP_REDUNDANCY: f32 = 3e-5;

// ---- Piles ----

/// Cosine of the steepest slope on which a body counts as standing when loads are guessed.
///
/// About 45° (ADR 0015); a wrong guess only costs sweeps. Larger: leaning bodies get no guess. Smaller: sliding bodies get a guess.
/// Sensible from 0.5 to 0.9. Shown by `large_pyramid`, whose loads are guessed when it is created.
pub(super) const STANDING_COSINE: f32 = 0.7;

/// Largest approach speed of a body that counts as standing when loads are guessed, m/s.
///
/// Larger: falling bodies are supported for a step as if they stood. Smaller: piles sink before their loads are found (a wall of 100 rows
/// by 187 mm with many sweeps and no guesses, by 9 with guesses; ADR 0015). Sensible from 0.02 to 0.5. Shown by `large_pyramid`.
pub(super) const STANDING_SPEED: f32 = 0.1;

/// Least scaled mass of a body per impulse that cancels itself on it in a substep, kg/(N·s).
///
/// A body that bears less than 4,000 times its weight has no mass scaling, and an ulp of that impulse changes its velocity by 1e-5 m/s.
/// Larger: squeezed bodies react slowly. Smaller: an ulp of a tower's load tosses its lowest cube by 4 m/s (ADR 0015). Sensible from 1e-3
/// to 0.05. Shown by `stack_mass_ratio`, the test `stacks::towers_of_any_masses_stand_and_load_the_floor_by_their_weight`.
pub(super) const MASS_SCALE: f32 = 6e-3;

/// Ratio of masses below which no body has mass scaling, a number.
///
/// Below it, the sums of loads are not computed. Larger: squeezed bodies are tossed. Smaller: heaps of mixed sizes pay for these sums.
/// Sensible from 100 to 4,000. Shown by the test `stacks::unsqueezed_bodies_keep_their_mass_beside_heavy_ones`.
pub(super) const BALLASTED_RATIO: f32 = 1e3;

// ---- Safeguards ----

/// Largest turn of a link within a substep relative to the rigid motion of its tree, radians.
///
/// Below it, position corrections converge and linearised rows are valid (ADR 0008). Larger: joints open in whipping motions. Smaller:
/// harmless whipping motions are slowed. Sensible from 0.5 to 1.5. Shown by `ragdoll_wall_fast` and the whipping chain of `mass_ratio`.
pub(super) const MAX_INNER_TURN: f32 = 1.0;

/// Largest share of the kinetic energy (of at least 1 J/kg) that a pass may add before it counts as an error.
///
/// Rounding and the energy exchange of resting contacts are far below this share. Larger: islands gain energy step by step. Smaller: warm
/// starts are dropped because of rounding errors. Sensible from 1e-4 to 1e-2. Shown by `random_worlds`, `ragdoll_wall_fast`.
pub(super) const ENERGY_SLACK: f32 = 1e-3;

/// Speed above which a solution counts as diverged, as a multiple of the world's speed limit.
///
/// If a solution exceeds this speed, the island moves as one rigid piece for the pass. Speeds are limited before the
/// solve, so the factor must be well above 1. Sensible from 1.5 to 10. Shown by the test
/// `trouble::extreme_impulses_are_limited_and_reported`.
pub(super) const DIVERGED_SPEED: f32 = 2.5;

/// Spin above which a solution counts as diverged, rad/s.
///
/// The effect is that of [`DIVERGED_SPEED`]. The value must be well above the spin that the world's limit on turns allows. Sensible from
/// 1e3 to 1e5. Shown by the test `trouble::extreme_spins_are_limited_and_reported`.
pub(super) const DIVERGED_SPIN: f32 = 1e4;

/// Largest increase of a joint's error in a substep before the substep counts as unsolved, for gaps in metres and angles in radians.
///
/// There is one value for both units, since an island is judged by the largest error of all its rows (see [`POSITION_TOLERANCE`]). Larger:
/// contradictory rows fling bodies. Smaller: crashes count as contradictions, and ragdolls move as one rigid piece. Sensible from 0.03 to
/// 0.5. Shown by the test `random_worlds`.
pub(super) const TORN: f32 = 0.1;

// ---- Flight and strands ----

/// Largest turn of a body in flight within a substep, if the world's limit allows more, radians.
///
/// The series for sine and cosine are accurate up to this turn. The value must be at most 3. Smaller: spins are limited that the world
/// allows. Shown by the test `flight::spin_and_speed_stay_within_the_worlds_limits`.
pub(super) const MOST_FLIGHT_TURN: f32 = 3.0;

/// Largest number of Newton steps for the midpoint spin of a free body.
///
/// The implicit midpoint keeps energy and momentum to rounding (ADR 0018). Larger: no effect. Smaller: tops gain or lose energy. Sensible
/// from 2 to 6. Shown by `dzhanibekov`, `symmetric_top`.
pub(super) const MIDPOINT_STEPS: usize = 4;

/// Square of the relative change at which the Newton steps for the midpoint spin end, a number.
///
/// The value is a change of 1e-6. Larger: the motion of boxes that flip over and over, which depends on differences of 1e-6, is wrong.
/// Smaller: one more step acts on rounding errors. Sensible from 1e-14 to 1e-10. Shown by `dzhanibekov`.
pub(super) const MIDPOINT_TOLERANCE: f32 = 1e-12;

/// Largest half turn in a substep in the Newton steps for the midpoint spin, radians.
///
/// The value must be below a quarter of a turn, even if the world's limit allows more: beyond `π/2` the tangent of the Cayley map changes
/// sign. Smaller: fast spins miss the midpoint. Sensible from 0.8 to 1.5. Shown by the tests of `solver/motion`.
pub(super) const MOST_HALF_TURN: f32 = 1.2;

/// Number of links at or above which a strand is cut into eight pieces that are solved side by side.
///
/// A rope of 49 links then takes a third of the instructions; eight ropes of a hundred links each take 1.5 times the instructions of uncut
/// ones. Larger: a single rope of some thirty links takes as long as one of fifty. Smaller: many short ropes of one length take longer.
/// Sensible from 16 (two links in each piece) to 64. Shown by `hanging_rope`, `chain_100_links`.
pub(super) const CUT_STRANDS: usize = 24;

/// Multiple of `max_speed` and `max_turn` to which contacts clamp an approach, a ratio.
///
/// Force integration slows a body that exceeds its limits. If contacts used the full approach speed, they would count this slowing as a
/// pull of forces, and a bounce would return half of it. Larger: bounces use speeds at which no body moves. Smaller: the bits of speeds
/// slightly above the limits change. Sensible from 2 to 100. Shown by the test `events::extreme_hits_are_reported_finite`.
pub(super) const BEYOND_MEASURE: f32 = 4.0;
