//! Behaviour constants for building, judging and driving ragdolls: the numbers an engineer would tune.
//!
//! Each comment states the unit and space, the effect of a larger and a smaller value, and the tests
//! (`crates/sinew_ragdoll/tests/it`) that show it. Effects without a number are judgement, not measurement.

// build/report.rs

/// Least widening of limits that the report notes, radians (1°).
///
/// Larger: the report misses a bind pose beyond its limits. Smaller: it has notes on every rig. Shown by the tests of
/// `build_limits`.
pub(crate) const NOTED_WIDENING: f32 = 0.017;

// build/takes.rs

/// Least time between the clip frames that a build reads, seconds.
///
/// Larger: quick motions add nothing to the learned limits. Smaller: builds are slower. Shown by the tests of
/// `learned`.
pub(crate) const FRAME_TIME: f64 = 1.0 / 30.0;

// drive/level.rs

/// Frequency below which a drive counts as zero, Hz.
///
/// Larger: fading drives end abruptly. Smaller: springs without effect are solved. Shown by the tests of `drive`.
pub(crate) const LEAST_HERTZ: f32 = 0.02;

/// Number of half-lives after which a body becomes keyed.
///
/// Larger: the body lags longer. Smaller: it jumps to the animation. Shown by the tests of `drive`.
pub(crate) const KEYED_AFTER: f32 = 5.0;

// drive/apply.rs

/// Largest acceleration that the pin of a body that becomes keyed gives to this body, m/s²: a leg that is raised
/// against a bystander.
///
/// Larger: a returning foot throws whoever lies in its way. Smaller: the limb hangs until it is keyed. Shown by the
/// scene `brawl`.
pub(crate) const RETURN_ACCELERATION: f32 = 300.0;

/// Lever with which the largest force of such a pin gives its largest torque, metres.
///
/// Larger: a returning hand spins. Smaller: it arrives with another rotation. Shown by the scene `brawl`.
pub(crate) const RETURN_LEVER: f32 = 0.15;

/// Largest speed, m/s, and angular speed, rad/s, at which a body that becomes keyed approaches its animation.
///
/// Larger: a limb that a hit has raised snaps back. Smaller: it lags behind the animation. Shown by the scene `brawl`.
pub(crate) const RETURN_SPEED: f32 = 6.0;
/// See [`RETURN_SPEED`].
pub(crate) const RETURN_TURN: f32 = 15.0;

// drive/mod.rs

/// Speed of the whole ragdoll for which a hit's impulse removes all strength from the muscles at the struck body, m/s.
///
/// Larger: hits leave no trace. Smaller: a touch makes a limb limp. Shown by the tests of `blows`.
pub(crate) const NUMBING_SPEED: f32 = 0.2;

/// Ratio of the weakness after a hit at one joint to that at the joint before it, 0 to 1.
///
/// Larger: the whole body yields. Smaller: only the struck joint yields. Shown by the tests of `blows`.
pub(crate) const WEAKNESS_FALLOFF: f32 = 0.5;

/// Share of strength, or of a pin's force, below which it counts as zero.
///
/// Larger: fading drives end with a jerk. Smaller: fading drives are solved for longer. Shown by the tests of `drive`.
pub(crate) const NO_STRENGTH: f32 = 1e-3;

// drive/target.rs

/// Distance that a motor's target keeps from a stop, radians.
///
/// Larger: poses at a limit are not reached. Smaller: the motor and the stop push against each other. Shown by the
/// tests of `drive`.
pub(crate) const STOP_ROOM: f32 = 0.01;

// drive/torque.rs

/// Torque of a creature's joint over the gravity torque of its subtree, a ratio.
///
/// Larger: creatures are stiff. Smaller: creatures sag under their own weight. Shown by the tests of `drive`.
pub(crate) const CREATURE_STRENGTH: f32 = 3.0;

/// Acceleration of free fall that strengths are derived from, m/s²: standard gravity.
///
/// Larger: muscles and the friction of limp creatures are stronger. Smaller: they are weaker. Shown by the tests of
/// `drive`.
pub(crate) const GRAVITY: f32 = 9.81;

// filter/mod.rs

/// Overlap in the bind pose that is tolerated, metres: about the solver's slop.
///
/// Larger: pairs push each other apart when limp. Smaller: pairs that only touch do not collide. Shown by the tests of
/// `filter`.
pub const TOLERATED: f32 = 0.005;

/// Least factor on a shape's cross-section at which a pair still collides, below 1.
///
/// Larger: more pairs pass through each other. Smaller: limbs are much thinner than their skin. Shown by the tests of
/// `filter`.
pub(crate) const LEAST_SCALE: f32 = 0.86;

/// Factor on a shape's cross-section per shrinking step, below 1.
///
/// Larger: shrinking takes more steps. Smaller: shapes get thinner than necessary. Shown by the tests of `filter`.
pub(crate) const SCALE_STEP: f32 = 0.975;

/// Share of the poses within the limits, 0 to 1, from which a pair that overlaps in them counts as always overlapping.
///
/// Larger: pairs that always overlap collide and jitter. Smaller: hands pass through thighs. Shown by the tests of
/// `filter`.
pub(crate) const ALWAYS: f32 = 0.9;

/// Share of the poses within the limits, 0 to 1, below which a pair that overlaps in the bind pose counts as
/// overlapping only there.
///
/// Larger: pairs that mostly overlap collide. Smaller: arms bound at the hips pass through them. Shown by the tests of
/// `filter`.
pub(crate) const SELDOM: f32 = 0.1;

/// Share of the clips' poses, 0 to 1, above which limbs count as always overlapping.
///
/// Larger: limbs that overlap in most clips push each other apart. Smaller: limbs pass through each other. Shown by the
/// tests of `filter`.
pub(crate) const MOSTLY: f32 = 0.5;

/// Share of the clips' poses, 0 to 1, up to which other parts may overlap and still collide.
///
/// A fall does not need their contact to look right. Larger: parts that overlap in clips push each other. Smaller: one
/// bad frame excludes them. Shown by the tests of `filter`.
pub(crate) const A_FEW: f32 = 0.02;

// fit/frame.rs

/// Cosine of the angle, 35°, between a surface's long axis and its bone up to which the shape uses the bone's
/// direction.
///
/// A larger angle: shapes are tilted relative to their skin. A smaller one: shapes of limbs are not parallel to their
/// bones. Shown by the tests of `build`.
pub(crate) const ALONG_BONE: f32 = 0.819;

/// Least ratio of a surface's largest variance to the next for which it has a long axis.
///
/// Larger: shapes of feet point along their bones. Smaller: noise decides the axes of round parts. Shown by the tests
/// of `build`.
pub(crate) const ELONGATED: f32 = 1.5;

/// Largest ratio of the area of the smallest rectangle around a trunk's cross-section to that of the upright one at
/// which the smallest is used.
///
/// Larger: boxes of trunks are tilted needlessly. Smaller: boxes are far larger than bent backs. Shown by the tests of
/// `build`.
pub(crate) const WORTH_TILTING: f32 = 0.75;

/// Largest ratio of the box volume in another frame to that in the preferred one at which the other frame is used.
///
/// Larger: a moved vertex can change the frame. Smaller: boxes are loose. Shown by the tests of `build`.
pub(crate) const CLEARLY_SMALLER: f32 = 0.9;

// fit/mod.rs

/// Least half side or radius of a shape, metres.
///
/// Larger: fingers and ears of small characters become too thick. Smaller: thin shapes fall through edges. Shown by the
/// tests of `build`.
pub(crate) const LEAST_HALF: f32 = 0.0075;

/// Factor on the fitted cross-section that places contacts inside the skin instead of outside.
///
/// Larger: characters float. Smaller: they sink in. Shown by the tests of `skin`.
pub(crate) const SHRINK: f32 = 0.97;

/// Share of a bone's length by which its shape may extend past each of its joints. Two neighbours then overlap by at
/// most a quarter.
///
/// Larger: second neighbours touch. Smaller: knees and elbows have gaps. Shown by the tests of `build`.
pub(crate) const PAST_JOINT: f32 = 0.125;

/// Ratio of a shape's bounding radius to its twin's from which the shape contains more than the body part.
///
/// Larger: a sword in a hand becomes part of the hand. Smaller: uneven sculpting is smoothed away. Shown by the tests
/// of `rig_variants`.
pub(crate) const BURDENED: f32 = 1.6;

/// Distance of a tail's skin from the nearest shape from which this skin is a spike, as a share of the character's
/// size.
///
/// Larger: spikes sink into the floor. Smaller: thick tails get hulls. Shown by the tests of `skin`.
pub(crate) const SPIKED: f32 = 0.04;

/// Distance of skin from the nearest shape from which the part gets the hull of its skin, as a share of the character's
/// size.
///
/// Larger: hats and packs sink into the floor. Smaller: hair and clothes get hulls, which cost more. Shown by the tests
/// of `skin`.
pub(crate) const PROTRUDING: f32 = 0.06;

/// Distance of a box's corner from the nearest skin from which the part gets the hull of its skin, as a share of the
/// character's size.
///
/// Larger: characters float on the corners of their boxes. Smaller: round trunks get hulls, which cost more. Shown by
/// the tests of `skin`.
pub(crate) const HOLLOW: f32 = 0.2;

/// Ratio of the volumes of twins above which both get the better-fitting shape.
///
/// Larger: bodies are asymmetric. Smaller: parts that really differ become equal. Shown by the tests of `build`.
pub(crate) const UNLIKE: f32 = 1.3;

/// Factor on the error of a shape whose kind does not suit the part, so that it is chosen only if clearly nearer to the
/// skin.
///
/// Larger: the table of usual kinds decides. Smaller: a few vertices lead to odd shapes. Shown by the tests of `build`.
pub(crate) const UNUSUAL: f32 = 1.0 / 0.6;

/// Factor on the error of a tapered capsule for a limb; a tapered capsule costs about as much as a capsule.
///
/// Larger: limbs get only capsules. Smaller: untapered limbs get tapered capsules. Shown by the tests of `build`.
pub(crate) const TAPERED: f32 = 1.0 / 0.9;

/// Factor on the error of a hull, whose collisions cost several times those of a box.
///
/// Larger: no part gets a hull. Smaller: falls are slow to simulate. Shown by the tests of `build`.
pub(crate) const INTRICATE: f32 = 3.0;

// fit/patch.rs

/// Approximate number of samples of a patch of skin.
///
/// Larger: fits are slower. Smaller: shapes depend on the mesh's tessellation. Shown by the tests of `rig_variants`.
pub(crate) const SAMPLES: f32 = 400.0;

/// Share of the weighted area moved by a bone from which a selection counts as all of its flesh, 0 to 1.
///
/// Larger: wide selections contain the neighbours' skin. Smaller: shapes are too thin where bones share skin. Shown by
/// the tests of `build`.
pub(crate) const LEAST_AREA: f32 = 0.4;

// fit/round.rs

/// Ratio of a capsule's cylinder length to its radius below which the capsule becomes a ball.
///
/// Larger: heads become balls. Smaller: some capsules have almost no length. Shown by the tests of `build`.
pub(crate) const BALL: f32 = 0.1;

/// Largest ratio of the difference of a tapered capsule's radii to the distance of their centres: a cone of 20°.
///
/// Larger: some shapes are balls with a tip. Smaller: calves become capsules. Shown by the tests of `build`.
pub(crate) const STEEPEST: f32 = 0.35;

// fit/solid.rs

/// Weight of the distance from the centre relative to the distance along a direction, and the tilt of the directions,
/// in half sides of the box.
///
/// All points of a flat side are equally far along its direction. The weight selects the point nearest to a corner; the
/// tilt selects the same one of two mirror images. Otherwise rounding selected the point, and the same skin in another
/// unit had a hull of half the volume. Larger: hulls miss protruding parts. Smaller: rounding decides. Shown by the
/// tests of `rig_variants`.
pub(crate) const TOWARD_CORNERS: f32 = 1e-3;

// fit/surface.rs

/// Least weight of a bone on a triangle for the triangle to count, 0 to 1.
///
/// Larger: skin near joints belongs to no bone. Smaller: fits are slower. Shown by the tests of `build`.
pub(crate) const LEAST_PULL: f32 = 0.05;

/// Largest size of the parts into which a triangle moved by several bones is cut, as a share of the character's height.
///
/// Larger: coarse meshes get other shapes than fine ones. Smaller: fits are slower. Shown by the tests of
/// `rig_variants`.
pub(crate) const FINEST: f32 = 0.03;

/// Largest number of parts into which a side of a triangle is cut.
///
/// Larger: characters with few triangles are slow to fit. Smaller: same effect as a larger [`FINEST`]. Shown by the
/// tests of `rig_variants`.
pub(crate) const MOST_CUTS: f32 = 8.0;

// garments/sheet.rs

/// Number of times that a particle is moved out of the nearest body when a sheet is made; between two legs several are
/// needed.
///
/// Larger: more work without effect. Smaller: sheets start inside a body, which pushes them out violently. Shown by the
/// tests of `garments`.
pub(crate) const CLEARINGS: usize = 4;

/// Number of solver iterations of a sheet per substep, as in scene `cape`.
///
/// Larger: the sheet is slower to solve, and stiffer. Smaller: it stretches like rubber. Shown by the tests of
/// `garments`.
pub(crate) const SHEET_ITERATIONS: u32 = 4;

/// Least ratio of a thread's length to the spacing for its stiffness; a shorter thread gets the stiffness of this
/// length.
///
/// Larger: short threads are soft. Smaller: where columns meet in a point, springs are too stiff for the solver.
/// Shown by the tests of `garments`.
pub(crate) const SHORTEST_THREAD: f32 = 0.1;

// garments/mesh.rs

/// Cosine of the angle, 75°, above which the angles opposite an edge, in both of its triangles, make the edge the
/// diagonal of a cell.
///
/// Larger: equal triangles count as halves of cells and are soft along one side. Smaller: cells that are not quite
/// square are stiff across. Shown by the tests of `mesh_garments`.
pub(crate) const SQUARE: f32 = 0.26;

/// Cosine of the angle, 143°, from which two neighbours of a particle count as opposite.
///
/// Larger: sheets resist folds at wrong corners. Smaller: uneven meshes do not resist bending. Shown by the tests of
/// `mesh_garments`.
pub(crate) const STRAIGHT: f32 = -0.8;

// garments/wear.rs

/// Ratio of a thread's length to its rest length, or to half the spacing of its sheet if that is longer, from which the
/// body has caught the thread.
///
/// Larger: a skirt under a sitting body stays caught. Smaller: stretched cloth jumps. Shown by the tests of `garments`.
pub(crate) const CAUGHT: f32 = 1.5;

/// Number of iterations that restore lengths and leave bodies when a sheet is added.
///
/// Larger: more work without effect. Smaller: a sheet added in mid-stride starts with a jerk. Shown by the tests of
/// `garments`.
pub(crate) const DRAPINGS: usize = 8;

// limits/friction.rs

/// Least resisting torque of a limp joint of a creature, as a share of the gravity torque of the bodies below the
/// joint.
///
/// The table's torques are 3 % (spine) to 36 % (elbow) of the gravity torques of human joints. On a fish of four tonnes
/// the same torques are half a per cent, so that the fish stands on its nose and sways for ten seconds. With a tenth, a
/// column of nine metres still sways for five; with a fifth, all tested creatures are asleep 2.2 s after they are calm.
/// Larger: falls look stiff. Smaller: large creatures sway for longer. Shown by the tests of `falls`.
pub(crate) const SHARE_OF_LOAD: f32 = 0.2;

// limits/learned.rs

/// Angle by which twist and hinges may exceed the observed range, radians (10°).
///
/// Larger: learned limits lose their effect. Smaller: limits stop a fall where the clips by chance did not go. Shown by
/// the tests of `learned`.
pub(crate) const TWIST_MARGIN: f32 = 0.174_532_92;

/// Least motion of a joint from which limits are learned, and narrowest learned range, radians (5°).
///
/// Larger: anatomy decides more often. Smaller: joints lock where clips do not move. Shown by the tests of `learned`.
pub(crate) const LEAST_RANGE: f32 = 0.087_266_46;

/// Angle beyond the clips to which anatomical limits are widened, radians (1°): half of the allowed overshoot.
///
/// Larger: limits are wider than necessary. Smaller: a character starts beyond its limit. Shown by the tests of
/// `learned`.
pub(crate) const BEYOND_CLIPS: f32 = 0.017_453_292;

// limits/mod.rs

/// Share of the muscles' largest torque that a limp joint resists with.
///
/// Larger: limp bodies fall stiffly. Smaller: limbs flail. Shown by the tests of `falls`.
pub(crate) const FRICTION_SHARE: f32 = 0.02;

/// Margin of a bind pose to every limit, radians (2°).
///
/// Larger: limits are wider than the anatomical ones. Smaller: a joint bound at a limit overshoots it from the start.
/// Shown by the tests of `build_limits`.
pub(crate) const BIND_MARGIN: f32 = 0.034_906_585;

/// Cosine of the bend, 10°, of a bone in the bind pose from which the bend determines the axis of the hinge.
///
/// A larger bend: knees of A-poses bend about a wrong axis. A smaller one: noise determines the axis. Shown by the
/// tests of `build_limits`.
pub(crate) const BENT: f32 = 0.984_8;

/// Cosine of the angle, 50°, from the anatomical axis up to which the axis of a bend is used.
///
/// A larger angle: knees bend sideways. A smaller one: turned-out legs bend about a wrong axis. Shown by the tests of
/// `build_limits`.
pub(crate) const BELIEVED: f32 = 0.642_8;

/// Largest half-angle to which a swing is widened, radians (170°).
///
/// Larger: limits have no effect. Smaller: odd bind poses exceed their limits. Shown by the tests of `build_limits`.
pub(crate) const WIDEST_SWING: f32 = 2.967;

// limits/sample.rs

/// Half-axes of the square of random swings over those of the ellipse that contains them: √½, minus a margin.
///
/// Larger: random poses exceed their limits. Smaller: all random poses are near the centre. Shown by the tests of
/// `filter`.
pub(crate) const INSCRIBED: f32 = 0.7;

// masses/inertia.rs

/// Largest ratio of a body's principal moments.
///
/// Larger: thin bodies spin up about their long axis faster than a substep resolves. Smaller: limbs rotate as
/// sluggishly as boxes. Shown by the tests of `build`.
pub(crate) const LARGEST_MOMENTS: f32 = 8.0;

// masses/mod.rs

/// Share of a fitted box that flesh fills, 0 to 1.
///
/// Larger: creatures without a closed skin are heavier. Smaller: they are lighter. Shown by the tests of `volume`.
pub(crate) const BOX_FILL: f32 = 0.55;

/// Share of a fitted capsule that flesh fills, 0 to 1.
///
/// As [`BOX_FILL`].
pub(crate) const CAPSULE_FILL: f32 = 0.8;

/// Least mass of a body as a share of the total mass, 0 to 1.
///
/// The solver needs ratios below about 1000. Larger: fingers are as heavy as hands. Smaller: joints need more sweeps.
/// Shown by the tests of `build`.
pub(crate) const LEAST_MASS: f32 = 0.001;

/// Least length of a trunk's body as a share of the trunk's length, 0 to 1.
///
/// Larger: all bodies of a spine have about the same length. Smaller: vertebrae without mass lie between heavy ones.
/// Shown by the tests of `build`.
pub(crate) const LEAST_TRUNK: f32 = 0.1;

// masses/volume.rs

/// Least share of the sample lines that must cross a closed skin, 0 to 1.
///
/// Larger: the mass of characters with open necks is computed from their shapes. Smaller: volumes include the air under
/// cloaks. Shown by the tests of `volume`.
pub(crate) const CLOSED: f32 = 0.6;

/// Density of living tissue, kg/m³: about that of water.
///
/// Larger: creatures are heavier. Smaller: they are lighter. Shown by the tests of `volume`.
pub(crate) const FLESH: f32 = 1000.0;

/// Mean density of a machine and the air inside, kg/m³: cars have 200, tanks 1000.
///
/// Larger: machines are heavier. Smaller: they are lighter. Shown by the tests of `volume`.
pub(crate) const MACHINE: f32 = 500.0;

// quality/balance.rs

/// Height over the lowest skin point up to which skin bears a body that gets up, as a share of the character's height.
///
/// Larger: knees in the air bear a body. Smaller: a foot that has rolled onto its toes loses its heel. Shown by the
/// tests of `rising`.
pub(crate) const BEARS_NEAR: f32 = 0.06;

/// Horizontal distance of the centre of mass from the skin that bears it, as a share of the height, from which a body
/// that gets up is unbalanced.
///
/// A human that swings up from sitting reaches 6 to 11 % for a moment; a stiff figure that rises like a board, 17 to
/// 40 %. Larger: boards pass. Smaller: swings are reported. Shown by the tests of `rising`.
pub(crate) const LEANS: f32 = 0.08;

/// Longest time without balance while getting up, seconds.
///
/// Larger: boards pass. Smaller: swings are reported. Shown by the tests of `rising`.
pub(crate) const LEANS_FOR: f32 = 0.35;

// quality/faults.rs

/// Least depth in static geometry at which a character starts inside the world, as a share of its height.
///
/// Larger: the report misses characters that are thrown out of a wall. Smaller: feet in uneven ground count. Shown by
/// the tests of `faults`.
pub(crate) const STARTS_INSIDE: f32 = 0.15;

/// Least distance below all static geometry at which a body has fallen out of the world, metres; or the character's
/// height, if that is larger.
///
/// Larger: a fall out of the world is detected later. Smaller: an arm through a thin floor counts. Shown by the tests
/// of `faults`.
pub(crate) const FALLEN_OUT: f32 = 2.0;

/// Time limp without lying still after which a character counts as never still, seconds.
///
/// The contract has a drop asleep within 6 s. Larger: jitter is not detected. Smaller: long falls count as faults.
/// Shown by the tests of `faults`.
pub(crate) const NEVER_STILL: f32 = 6.0;

/// Height of the highest part over the floor at rest, as a share of its height at release, above which a tall body
/// counts as still upright.
///
/// Larger: kneeling or leaning counts as fallen. Smaller: sitting counts as standing. Shown by the tests of `faults`.
pub(crate) const STILL_UPRIGHT: f32 = 0.8;

/// Height of a limp human's hips over the floor, as a share of their height in the bind pose, above which it props them
/// up.
///
/// Larger: kneeling counts as lying. Smaller: lying on a side counts as propped. Shown by the tests of `faults`.
pub(crate) const PROPPED: f32 = 0.3;

/// Speed of a limp human's hips below which it does not fall any more, m/s.
///
/// Larger: falls count. Smaller: a body that sags slowly does not count. Shown by the tests of `faults`.
pub(crate) const PROPPED_SLOW: f32 = 0.15;

/// Longest time for which a limp human may prop its hips up, seconds.
///
/// Larger: bodies that rest on hands and feet count as good. Smaller: knees that give way slowly are reported. Shown by
/// the tests of `faults`.
pub(crate) const PROPPED_FOR: f32 = 1.5;

/// Height of a heavy part of a creature's trunk over the floor at rest, as a share of the trunk's mean height at
/// release, above which the creature counts as standing on its legs.
///
/// Larger: animals with their rump up count as lying. Smaller: animals that lie on a side count as standing. Shown by
/// the tests of `faults`.
pub(crate) const STILL_ON_LEGS: f32 = 0.25;

/// The same share above which a creature lies on folded legs: it is pushed over if that lays it flat.
///
/// Larger: dogs kneel. Smaller: animals that lie on a side are pushed. Shown by the tests of `faults`.
pub(crate) const LIES_FLAT: f32 = 0.12;

/// Least share of the trunk's mass of a heavy part, 0 to 1.
///
/// Larger: a rump of many bones counts as light. Smaller: a raised neck counts as standing. Shown by the tests of
/// `faults`.
pub(crate) const HEAVY_PART: f32 = 0.1;

/// Least mean height of a creature's trunk over the floor at release to count as standing on legs, as a share of its
/// height.
///
/// Larger: short-legged animals are never pushed over. Smaller: slugs are. Shown by the tests of `faults`.
pub(crate) const OFF_FLOOR: f32 = 0.15;

/// Velocities of the highest point used to push over a limp body that stays upright, weakest first, as shares of √(g
/// h), h its height.
///
/// A block half as deep as it is tall falls from 0.7 on. Larger: a slender character is thrown into the air. Smaller: a
/// broad one stays upright. Shown by the tests of `faults`.
pub(crate) const TOPPLES: [f32; 3] = [0.35, 0.7, 1.05];

/// Largest ratio of a creature's mass to the cube of its longest side, kg/m³: a human has 14, an elephant 20, a bear
/// 40, a cow 50, a pig 60.
///
/// Larger: a block of 625 kg at 1.75 m passes. Smaller: a pig is doubted. Shown by the tests of `faults`.
pub(crate) const CREATURE_BUILD: f32 = 80.0;

/// Mass below which a creature of any build passes, kg: a toad, a chick, a hedgehog.
///
/// Larger: a hog passes. Smaller: a hen is doubted. Shown by the tests of `faults`.
pub(crate) const ROUND: f32 = 20.0;

/// Largest factor by which a character grows or shrinks between its clip and a get-up.
///
/// Larger: a giant that becomes a child for a second passes. Smaller: clips that stretch a character slightly count as
/// faults. Shown by the tests of `faults`.
pub(crate) const OTHER_SIZE: f32 = 1.15;

/// Least distance of two limbs' roots from the plane of symmetry, as a share of the height, from which each limb counts
/// as left or right.
///
/// Larger: narrow bodies are not checked. Smaller: noise counts as a side. Shown by the tests of `faults`.
pub(crate) const ON_A_SIDE: f32 = 0.01;

// quality/plausible.rs

/// Least share of the height, from the joint of the head up, that is too large for an adult: a two-year-old has 0.2, an
/// adult 0.12.
///
/// Larger: toys and children are doubted. Smaller: adults in another unit pass. Shown by the tests of `faults`.
pub(crate) const BIG_HEAD: f32 = 0.17;

// ragdoll.rs

/// Largest half-angle to which a swing is widened for the pose in which a ragdoll is spawned, radians (175°).
///
/// Larger: limits have no effect. Smaller: a character starts beyond its limit. Shown by the tests of `hand_over`.
pub(crate) const WIDEST_SPAWNED: f32 = 3.054;

// skin/judge.rs

/// Largest distance of the lowest drawn point from the floor while standing and after getting up, as a share of the
/// size.
///
/// Larger: floating and sunk characters pass. Smaller: toes that dip in by a few centimetres count as flaws. Shown by
/// the tests of `skin`.
pub(crate) const STANDS_OFF: f32 = 0.04;

/// Largest depth of the lowest drawn point in the floor while getting up, as a share of the size.
///
/// Larger: hands and knees far below the floor pass. Smaller: fingertips that dip in briefly count as flaws. Shown by
/// the tests of `skin`.
pub(crate) const SUNK_RISING: f32 = 0.1;

/// Largest height of the lowest drawn point over the floor while getting up, as a share of the size. Humans that
/// float visibly reach 5 to 9 %, others 3 %.
///
/// Larger: floating get-ups pass. Smaller: rounding of a sitting body counts. Shown by the tests of `skin`.
pub(crate) const FLOATS_RISING: f32 = 0.04;

/// Largest height of the lowest drawn point over the floor in a human's clip, as a share of the size: runners and legs
/// without knees reach 11 %, jumps 50 % and more.
///
/// Larger: characters that jump where they should stand pass. Smaller: sprints count as jumps. Shown by the tests of
/// `skin`.
pub(crate) const LEAPS: f32 = 0.25;

/// Height of the lowest drawn point over the floor at rest, as a share of the size, above which the verdict is bad.
///
/// A bear on a box as broad as its arms floats by a fifth. Larger: such a bear is usable. Smaller: a big head on a
/// round shape is bad. Shown by the tests of `skin`.
pub(crate) const HANGS: f32 = 0.125;

/// Ratio of a skin metric to its threshold above which the verdict is bad.
///
/// Larger: torsos torn by half a height are usable. Smaller: a coat that drags is bad. Shown by the tests of `skin`.
pub(crate) const GROSS: f32 = 3.0;

// skin/mod.rs

/// Least share of a vertex's weight for a body to own the vertex, 0 to 1.
///
/// Larger: fewer vertices are judged. Smaller: skin between two bodies must be near both. Shown by the tests of `skin`.
pub(crate) const OWN_WEIGHT: f32 = 0.25;

// skin/sides.rs

/// Largest distance of a pivot from its counterpart's mirror image, as a share of the size.
///
/// Larger: unrelated bodies count as counterparts. Smaller: sculpted characters have no counterparts. Shown by the
/// tests of `skin`.
pub(crate) const MIRRORED: f32 = 0.05;

/// Largest distance from the plane of symmetry of a pivot without counterpart, as a share of the size.
///
/// Larger: narrow legs have no counterparts. Smaller: counterparts of spine bodies count as missing. Shown by the tests
/// of `skin`.
pub(crate) const MIDDLE: f32 = 0.02;

/// Largest distance from its parent of a body whose skin is not linked to another body's, as a share of the size.
///
/// Larger: floating parts are not detected. Smaller: characters of loose parts count as torn. Shown by the tests of
/// `skin`.
pub(crate) const LOOSE: f32 = 0.2;

// skin/stretch.rs

/// Percentile of the stretch of all edges in all poses, as a share: one in a thousand stretches more.
///
/// The contract's `edge_stretch_p999`. Larger: single seams decide. Smaller: torn parts are not detected. Shown by the
/// tests of `skin`.
pub(crate) const STRETCH_PERCENTILE: f32 = 0.999;

// skin/surface.rs

/// Difference of the weights at the two ends of an edge up to which the edge does not stretch.
///
/// Larger: stretched edges are missed. Smaller: the rounding of files is measured. Shown by the tests of `skin`.
pub(crate) const SAME_WEIGHTS: f32 = 1e-3;

// quality/rising.rs

/// Largest slide of a foot while a character gets up, as a share of its height; at least [`SLIDES_LEAST`].
///
/// Larger: skating counts as good. Smaller: rounding is reported. Shown by the tests of `rising`.
pub(crate) const SLIDES: f32 = 0.017;
/// Least allowed slide of a foot while a character gets up, metres. See [`SLIDES`].
pub(crate) const SLIDES_LEAST: f32 = 0.03;

/// Largest jump of a pose in a frame of 1/30 s, as a share of the height.
///
/// Larger: pops count as good. Smaller: quick motion is reported. Shown by the tests of `rising`.
pub(crate) const JUMPS: f32 = 0.03;

/// Speed of trunk and head in the blend into a get-up clip beyond their fastest in the clip, as a share of √(g h): 1.5
/// m/s for a man.
///
/// Larger: bodies that snap over count as good. Smaller: quick blends are reported. Shown by the tests of `rising`.
pub(crate) const SNAPS: f32 = 0.35;

/// Height over the floor up to which a sole point counts as on the floor, as a share of the character's height.
///
/// Larger: steps count as slides. Smaller: skating just over the floor is missed. Shown by the tests of `rising`.
pub(crate) const STANDS_NEAR: f32 = 0.008;

/// Height of the hips over the floor from which the feet carry the body, as a share of the hips' height in the bind
/// pose; 0.05 to 0.3 when lying or sitting.
///
/// Larger: skating of a squatting body is missed. Smaller: legs that a sitting body draws in count as slides. Shown by
/// the tests of `rising`.
pub(crate) const HIPS_BEAR: f32 = 0.35;

/// Cosine of the largest tilt of a foot that stands on its sole.
///
/// Larger: feet about to land are measured. Smaller: heels of lying legs are measured. Shown by the tests of `rising`.
pub(crate) const STANDS_UPRIGHT: f32 = 0.8;

/// Height over the ground from which a character counts as in the air, and drop of its ground that counts as an edge,
/// metres: the highest step that it climbs.
///
/// Larger: walks beyond an edge count as good. Smaller: steps of stairs are reported. Shown by the tests of `faults`.
pub(crate) const WALKS_ON_AIR: f32 = 0.45;

/// Time in the air beyond an edge that is allowed, seconds.
///
/// Larger: short walks in the air count as good. Smaller: a step over a gap is reported. Shown by the tests of `faults`.
pub(crate) const WALKS_ON_AIR_FOR: f32 = 0.2;

/// Depth to which the judge searches ground, metres.
///
/// Larger: searches over pits are slower. Smaller: deep ground counts as none. Shown by the tests of `faults`.
pub(crate) const GROUND_REACH: f32 = 1000.0;

/// Factor beyond the usual masses of an animal from which a given mass is in doubt.
///
/// Larger: implausible masses count as good. Smaller: stylised animals are reported. Shown by `sinew_cli` `units`.
pub(crate) const FAR_OFF: f32 = 2.0;

/// Time between the poses of a clip at which its speed is measured, seconds.
///
/// Larger: quick motion is averaged. Smaller: the measurement is slower. Shown by the tests of `rising`.
pub(crate) const CLIP_FRAME: f32 = 1.0 / 30.0;

/// Time from the start of a get-up within which the speed of the blend is measured, seconds; slightly longer than the
/// blend.
///
/// Larger: motion of the clip counts. Smaller: the end of the blend is missed. Shown by the tests of `rising`.
pub(crate) const BLENDS_FOR: f32 = 0.4;
