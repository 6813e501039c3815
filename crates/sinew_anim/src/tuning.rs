//! Constants of behaviour of animations: numbers that an engineer would turn.
//!
//! Each says its unit and space, what a larger and a smaller one does, and the tests
//! (`crates/sinew_anim/tests/it`) where that is to be seen; consequences without a figure are judgement, not measured.

// animator/mod.rs

/// Sum of weights in layer 0 below which the rest pose makes up for what is missing (see [`crate::BlendOptions`]), 0 to 1.
///
/// Larger: a track that fades in begins at the rest pose. Smaller: what is left of a faded track is blown up to a whole pose. Shown
/// by the tests of `animators`.
pub(crate) const FILL_BELOW: f32 = 0.1;

// animator/fed.rs

/// Longest time for which a pose from outside goes on as it went when no other comes, seconds.
///
/// Larger: who is fed no more swings out. Smaller: who is sent ahead by several steps, to see how fast limbs are, sees them stop. Shown by
/// the tests of `feeding`.
pub(crate) const GOES_ON: f32 = 0.1;

// animator/track.rs

/// Fastest that a track goes, forward or backward, clip seconds per second.
///
/// An update passes as many laps, and fires as many events, as that makes: larger, it may take as long as it likes; smaller, a clip
/// cannot be rushed through. Shown by the tests of `animators`.
pub const MAX_SPEED: f32 = 1_000.0;

// contact/mod.rs

/// Least part of a clip in which a foot is low for a walk on the spot: one in so many frames.
///
/// Larger: a dance whose feet slide is taken for a walk. Smaller: a walk with high steps is taken for one that gets nowhere. Shown by the
/// tests of `retarget` and by `loaded` of `sinew`.
pub(crate) const WALK_STANDS: usize = 3;

/// The same for a run, which is in the air for most of the time.
///
/// Larger: a kick is taken for a run. Smaller: runs of cartoons are taken for jumps. Shown by `loaded` of `sinew`.
pub(crate) const RUN_STANDS: usize = 8;

// contact/footsteps.rs

/// Time between the frames of a clip that are searched for footfalls, seconds.
///
/// Larger: footfalls are told later and less exactly. Smaller: it takes longer. Shown by `sinew_cli` `convert`.
pub(crate) const STEP_FRAME_TIME: f64 = 1.0 / 60.0;

/// Share of the body's speed by which a foot may slide while it stands, 0 to 1: a run is seldom drawn, or captured, to the speed of one
/// foot.
///
/// Larger: a foot that swings low is taken for one that stands. Smaller: runs have no footsteps. Shown by `sinew_cli` `convert`.
pub(crate) const STEP_SLIDE: f32 = 0.2;

/// Largest turn of a joint from the last pose of a loop to its first, radians, and largest way, as a share of the leg.
///
/// Larger: a clip that ends near its beginning counts as a loop. Smaller: a loop that does not quite close loses the footfall at its seam.
/// Shown by `sinew_cli` `convert`.
pub(crate) const LOOP_SEAM: f32 = 0.1;

/// Frames before the end of a loop whose motion comes on top of [`LOOP_SEAM`]: many loops end one frame before their first pose.
///
/// Larger: as with a larger [`LOOP_SEAM`], for fast clips. Smaller: likewise. Shown by `sinew_cli` `convert`.
pub(crate) const LAST_FRAMES: usize = 4;

// cleanup/foot_slide.rs

/// Largest share of its length that a leg is stretched to, below 1.
///
/// Larger: a knee snaps straight. Smaller: the pelvis goes down where the leg would have reached. Shown by the tests of `cleanup`.
pub(crate) const LEG_REACH: f32 = 0.996;

/// Time over which the pelvis goes down and up again for a foot out of reach, seconds.
///
/// Larger: it is low for long. Smaller: it jerks. Shown by the tests of `cleanup`.
pub(crate) const PELVIS_TIME: f32 = 0.1;

// clip/reduce.rs

/// Share of the bound on the error, 0 to 1, that is good enough to stop looking for fewer keys.
///
/// Larger: more rounds for a few keys less. Smaller: clips with more keys than the bound asks for. Shown by the tests of `reduce`.
pub(crate) const REDUCED_ENOUGH: f32 = 0.75;

/// Share of the bound on the error that each channel may use to begin with, 0 to 1.
///
/// Errors of different joints hardly ever add up. Larger or smaller: one more round until the share is found. Shown by the tests of
/// `reduce`.
pub(crate) const CHANNEL_SHARE: f32 = 0.55;

/// Share of the bound on the error that the next round aims at, from [`REDUCED_ENOUGH`] to 1.
///
/// Larger: rounds that overshoot are lost. Smaller: more keys. Shown by the tests of `reduce`.
pub(crate) const REDUCTION_AIM: f32 = 0.9;

// clip/root_motion.rs

/// Longest time between samples of root motion, seconds; in between it goes in a straight line.
///
/// Larger: turns are cut short. Smaller: longer tracks. Shown by the tests of `root_motion`.
pub(crate) const ROOT_SAMPLING: f32 = 1.0 / 60.0;

// learned_limits.rs

/// Share of the frames that learned limits take in, 0 to 1.
///
/// Larger: single frames of a capture widen them. Smaller: what a clip does is cut off. Shown by the tests of `learned_limits`.
pub const COVERAGE: f32 = 0.995;

/// Least turn that shows a hinge, radians.
///
/// Larger: hinges that hardly move are balls. Smaller: noise is a hinge. Shown by the tests of `learned_limits`.
pub(crate) const LEAST_HINGE: f32 = 0.2;

/// Turn about other axes than its own that a hinge may have, as a share of its range.
///
/// Larger: a ball that swings one way is taken for a hinge. Smaller: captured knees are balls. Shown by the tests of
/// `learned_limits`.
pub(crate) const HINGE_PLAY: f32 = 0.1;

// legs.rs

/// Place of the ball of a foot in front of an ankle whose rig has no toes, in lengths of the leg.
///
/// That of a human is 0.13 to 0.16. Larger: heels are lifted too early. Smaller: feet stand on their heels. Shown by the tests of
/// `retarget`.
pub(crate) const BALL_AHEAD: f32 = 0.14;

/// Height of an ankle that a rig does not have over the lowest skin of the shank, heights of the body.
///
/// Larger: shanks are short, and soles hang in the air. Smaller: knees bend where a foot would roll. Shown by the tests of `retarget`.
pub(crate) const ANKLE_HEIGHT: f32 = 0.04;

/// Confidence of a role of a joint that a rig does not have.
///
/// It says how sure the place of an ankle is; nothing is decided by it. Shown by the tests of `retarget`.
pub(crate) const MADE_UP: f32 = 0.5;

// playback/inertial.rs

/// Least share of its time that an offset may die away in, 0 to 1.
///
/// Smaller: an offset that already runs home stops with a jerk. Larger: it swings past. Shown by the tests of `transitions`.
pub(crate) const SHORTEST_DECAY: f32 = 1.0 / 3.0;

// garments/columns.rs

/// Share of the last bone's length beyond which the skin of a chain's last joint makes a hem of its own, a ratio.
///
/// Larger: hems stay stiff, as long as a bone. Smaller: a bone of its own for a seam. Shown by the tests of `garments`.
pub(crate) const HEM_SHARE: f32 = 0.25;

/// Gap between the last column and the first, over the widest between neighbours, up to which a garment goes round, a ratio.
///
/// Larger: an open coat is sewn up. Smaller: a skirt with uneven columns has a slit. Shown by the tests of `garments`.
pub(crate) const RING_GAP: f32 = 1.5;

// garments/sheet

/// Most particles that a mesh becomes as a sheet of cloth if nothing else is said, a number.
///
/// Each is a joint of the file that is written, and of the skin on the graphics card. Larger: slower, and old viewers lose joints. Smaller: a long coat has
/// coarse folds. Shown by the tests of `sheets`.
pub const MOST_PARTICLES: usize = 400;

/// Share of a sheet's height, from its highest point down, in which bodies hold it if nothing else is said, 0 to 1.
///
/// Larger: a skirt is stiff to the hips. Smaller: of a waistband that is not level a part hangs down. Shown by the tests of `sheets`.
pub(crate) const HELD_SHARE: f32 = 0.1;

/// Factor by which the distance between particles grows until there are few enough, a ratio.
///
/// Larger: coarser sheets than need be. Smaller: more tries. Shown by the tests of `sheets`.
pub(crate) const COARSER: f32 = 1.1;

/// Cosine of the angle, 75°, from which on a corner is that of a cell, so that the side opposite to it is a diagonal, a ratio.
///
/// Larger: equal triangles are split as if they were halves of cells, and lie wider apart. Smaller: cells that are not quite square are split across. Shown by
/// the tests of `sheets`.
pub(crate) const SQUARE_CORNER: f32 = 0.26;

/// Length of a diagonal over the spacing up to which it is not split, a ratio: that of a square cell, and a little.
///
/// Larger: limbs come between particles. Smaller: cells are split across, and threads run aslant. Shown by the tests of `sheets`.
pub(crate) const DIAGONAL: f32 = 1.45;

/// Share of a sheet's extent below which no distance between particles is tried, a ratio.
///
/// Larger: less fine sheets of what is long and narrow. Smaller: more tries where the spacing is tiny. Shown by the tests of `sheets`.
pub(crate) const FINEST: f32 = 1e-4;

// retarget/align.rs

/// Cosine of the angle between two reference poses, 30°, up to which both are taken to stand upright.
///
/// A larger angle: an A-pose is bent to a slouch. A smaller one: stances keep what is only the actor's pose of calibration. Shown by
/// the tests of `mocap`.
pub(crate) const SAME_UPRIGHT: f32 = 0.866;

/// Cosine of the angle of a leg's bones to the vertical, 25°, up to which it stands and its foot is flat on the floor.
///
/// A larger angle: feet of crouching rest poses are turned flat. A smaller one: those of standing ones are not. Shown by the tests of
/// `retarget`.
pub(crate) const LEG_STANDS: f32 = 0.906;

// retarget/mod.rs

/// Time by which a foot is held longer than the actor's at either end, seconds.
///
/// A foot on its way down hardly moves on. Larger: steps stick. Smaller: feet slide as they land. Shown by the tests of `retarget`.
pub(crate) const FOOT_HOLD: f32 = 0.02;

/// Time over which the height of the body is matched to the floor, seconds.
///
/// Larger: feet sink as a step begins. Smaller: the body bobs. Shown by the tests of `retarget`.
pub(crate) const FLOOR_TIME: f32 = 0.12;

// retarget/reference.rs

/// Cosine of the angles, 32°, that trunk and legs may be off the vertical in a pose that is clearly standing.
///
/// A larger angle: a crouch is the reference. A smaller one: no frame of a capture is. Shown by the tests of `mocap`.
pub(crate) const CLEARLY_STANDING: f32 = 0.85;

/// Least cosine of trunk, thighs and shanks with the vertical from which a body stands in a frame of a clip.
///
/// Larger: the bent knees of a walk count as lying. Smaller: who crawls stands. Shown by the tests of `take`.
pub(crate) const STANDS_IN_CLIP: f32 = 0.5;

// springs/guess.rs

/// Radius of a spring's tip over the mean length of its chain's bones, a ratio.
///
/// Larger: hair stands off the head. Smaller: it sinks into what it lies on. Shown by the tests of `springs`.
pub(crate) const SPRING_RADIUS: f32 = 0.15;

// springs/mod.rs

/// Share of what a link between strands is off by that a sixtieth of a second takes back at a time, if nothing else is said.
///
/// Larger: a skirt is one stiff sheet. Smaller: its strands part where a leg pulls. Shown by `links_hold_strands_together`.
pub(crate) const SPRING_LINK_SHARE: f32 = 0.5;

// weights.rs

/// Fewest joints of a skeleton whose weights can have been lost: a lid on a hinge has less.
///
/// Larger: a small skeleton that moves as one piece counts as rigid. Smaller: a hinge is refused. Shown by the tests of `weights`.
pub(crate) const FEWEST_OF_A_SKELETON: usize = 4;

/// Comparisons of loose vertices with others, at most, for a part of a mesh.
///
/// Larger: reading takes longer. Smaller: of large meshes fewer vertices are compared, and the nearest is found less exactly. Shown by nothing but the time that huge meshes take.
pub(crate) const MOST_COMPARED: usize = 50_000_000;

/// Least weight of a neighbouring bone, as a share of the nearest bone's, by which a vertex hangs on it too.
///
/// Larger: joints bend as sharp folds. Smaller: far vertices hang on it by a hair. Shown by the tests of `weights`.
pub(crate) const NEAREST_FALLOFF: f32 = 0.01;
