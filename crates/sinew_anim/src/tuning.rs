//! Tunable constants of animation.
//!
//! Each has its unit, the effect of a larger and a smaller value, and the tests (`crates/sinew_anim/tests/it`) that
//! show it; effects without a number are estimates.

// animator/mod.rs

/// Sum of weights in layer 0 below which the rest pose is blended in (see [`crate::BlendOptions`]), 0 to 1.
///
/// Larger: a track that fades in starts at the rest pose. Smaller: the pose of a nearly faded track keeps full effect.
/// Shown by the tests of `animators`.
pub(crate) const FILL_BELOW: f32 = 0.1;

// animator/fed.rs

/// Longest extrapolation of a fed pose, seconds.
///
/// Larger: limbs of a character without new poses move on too far. Smaller: limbs stop in an animator that predicts
/// several steps. Shown by the tests of `feeding`.
pub(crate) const LONGEST_EXTRAPOLATION: f32 = 0.1;

// animator/track.rs

/// Largest track speed, forward or backward, clip seconds per second.
///
/// It bounds the number of laps and events in an update. Larger: an update may take very long. Smaller: clips cannot be
/// played as fast. Shown by the tests of `animators`.
pub const MAX_SPEED: f32 = 1_000.0;

// contact/mod.rs

/// Reciprocal of the least share of a clip's frames in which a foot must be low for a walk on the spot.
///
/// Larger: a sliding dance counts as a walk. Smaller: a walk with high steps counts as standing. Shown by the tests of
/// `retarget` and by `loaded` of `sinew`.
pub(crate) const WALK_STANDS: usize = 3;

/// Reciprocal of the least share of a clip's frames in which a foot must be low for a run. It exceeds [`WALK_STANDS`],
/// because each foot of a runner is mostly off the ground.
///
/// Larger: a kick counts as a run. Smaller: cartoon runs count as jumps. Shown by `loaded` of `sinew`.
pub(crate) const RUN_STANDS: usize = 8;

// contact/footsteps.rs

/// Time between the frames of a clip in the search for footfalls, seconds.
///
/// Larger: footfalls are found later and less exactly. Smaller: the search is slower. Shown by `sinew_cli` `convert`.
pub(crate) const STEP_FRAME_TIME: f64 = 1.0 / 60.0;

/// Largest speed of a standing foot over the ground, as a share of the body's speed, 0 to 1. It is above 0 because in
/// most drawn or captured runs the standing feet slide.
///
/// Larger: a low swinging foot counts as standing. Smaller: runs have no footsteps. Shown by `sinew_cli` `convert`.
pub(crate) const STEP_SLIDE: f32 = 0.2;

/// Least net displacement of the lower foot in a walk on the spot, as a share of the length of its path, 0 to 1.
///
/// Larger: drawn walks get no walking speed. Smaller: dances get a walking speed. Shown by the tests of `hints`.
pub(crate) const ONE_WAY: f32 = 0.6;

/// Largest rotation of a joint from the last pose of a loop to its first, radians, and largest displacement, as a share
/// of the leg.
///
/// Larger: a clip that ends near its start counts as a loop. Smaller: a loop that does not quite close lacks the
/// footfall at its seam. Shown by `sinew_cli` `convert`.
pub(crate) const LOOP_SEAM: f32 = 0.1;

/// Number of frames before the end of a loop whose motion is added to [`LOOP_SEAM`]: many loops end one frame before
/// their first pose.
///
/// Larger or smaller: like a larger or smaller [`LOOP_SEAM`], for fast clips. Shown by `sinew_cli` `convert`.
pub(crate) const LAST_FRAMES: usize = 4;

// cleanup/foot_slide.rs

/// Largest share of its length to which a leg is stretched, below 1.
///
/// Larger: knees snap straight. Smaller: the pelvis is lowered although the leg would reach. Shown by the tests of
/// `cleanup`.
pub(crate) const LEG_REACH: f32 = 0.996;

/// Time over which the pelvis moves down and up again for an unreachable foot, seconds.
///
/// Larger: the pelvis stays low for long. Smaller: the pelvis jerks. Shown by the tests of `cleanup`.
pub(crate) const PELVIS_TIME: f32 = 0.1;

// clip/reduce.rs

/// Share of the error bound, 0 to 1, at which the search for fewer keys stops.
///
/// Larger: the search takes more rounds and saves a few more keys. Smaller: more keys remain than the bound needs.
/// Shown by the tests of `reduce`.
pub(crate) const REDUCED_ENOUGH: f32 = 0.75;

/// Initial share of the error bound per channel, 0 to 1.
///
/// The share is high because the errors of different joints rarely add up. Larger or smaller: the search needs one more
/// round. Shown by the tests of `reduce`.
pub(crate) const CHANNEL_SHARE: f32 = 0.55;

/// Share of the error bound that the next round aims at, from [`REDUCED_ENOUGH`] to 1.
///
/// Larger: rounds that exceed the bound are wasted. Smaller: more keys remain. Shown by the tests of `reduce`.
pub(crate) const REDUCTION_AIM: f32 = 0.9;

// clip/root_motion.rs

/// Longest time between samples of root motion, seconds; the motion is linear between samples.
///
/// Larger: the path cuts the corners of turns. Smaller: motion tracks are longer. Shown by the tests of `root_motion`.
pub(crate) const ROOT_SAMPLING: f32 = 1.0 / 60.0;

// learned_limits.rs

/// Share of the frames whose rotations learned limits include, 0 to 1.
///
/// Larger: single frames widen the limits. Smaller: real motion is excluded. Shown by the tests of `learned_limits`.
pub const COVERAGE: f32 = 0.995;

/// Least range of rotation at which a joint counts as a hinge, radians.
///
/// Larger: hinges that hardly move count as ball joints. Smaller: noise counts as a hinge. Shown by the tests of
/// `learned_limits`.
pub(crate) const LEAST_HINGE: f32 = 0.2;

/// Largest rotation of a hinge about other axes, as a share of its range.
///
/// Larger: a ball joint that swings mostly about one axis counts as a hinge. Smaller: captured knees count as ball
/// joints. Shown by the tests of `learned_limits`.
pub(crate) const HINGE_PLAY: f32 = 0.1;

// legs.rs

/// Distance of the ball of a foot in front of the ankle if the foot has no toes, in leg lengths.
///
/// In humans it is 0.13 to 0.16. Larger: heels lift too early. Smaller: characters stand on their heels. Shown by the
/// tests of `retarget`.
pub(crate) const BALL_AHEAD: f32 = 0.14;

/// Height of an added ankle above the lowest skin of the shank, in body heights.
///
/// Larger: shanks are too short, and soles are above the ground. Smaller: knees bend where a foot should roll. Shown by
/// the tests of `retarget`.
pub(crate) const ANKLE_HEIGHT: f32 = 0.04;

/// Confidence of the role of an added joint.
///
/// It affects only a report. Shown by the tests of `retarget`.
pub(crate) const MADE_UP: f32 = 0.5;

// playback/inertial.rs

/// Shortest decay of an offset, as a share of the transition's duration, 0 to 1.
///
/// Larger: the offset overshoots. Smaller: an offset that already shrinks fast stops with a jerk. Shown by the tests of
/// `transitions`.
pub(crate) const SHORTEST_DECAY: f32 = 1.0 / 3.0;

// garments/columns.rs

/// Share of the last bone's length beyond which the skin of a chain's last joint gets its own hem, a ratio.
///
/// Larger: hems as long as a bone stay stiff. Smaller: narrow seams get a hem bone. Shown by the tests of `garments`.
pub(crate) const HEM_SHARE: f32 = 0.25;

/// Largest gap between the last column and the first in a closed garment, as a ratio to the widest gap between other
/// neighbours.
///
/// Larger: the open front of a coat is closed. Smaller: a skirt with uneven columns has a slit. Shown by the tests of
/// `garments`.
pub(crate) const RING_GAP: f32 = 1.5;

// garments/sheet

/// Default limit of the number of particles of a mesh sheet.
///
/// Each particle is a joint of the written file and of the GPU skin. Larger: the simulation is slower, and old viewers
/// lose joints. Smaller: a long coat has coarse folds. Shown by the tests of `sheets`.
pub const MOST_PARTICLES: usize = 400;

/// Default share of a sheet's height, from its top, in which bodies hold it, 0 to 1.
///
/// Larger: a skirt is stiff down to the hips. Smaller: part of an uneven waistband hangs loose. Shown by the tests of
/// `sheets`.
pub(crate) const HELD_SHARE: f32 = 0.1;

/// Factor by which the particle distance grows in each try, until the number of particles is within the limit.
///
/// Larger: sheets are coarser than necessary. Smaller: the search needs more tries. Shown by the tests of `sheets`.
pub(crate) const COARSER: f32 = 1.1;

/// Cosine of the least angle, 75°, at which a triangle's corner counts as the corner of a square cell, so that the
/// opposite side is a diagonal of the cell.
///
/// Larger: equilateral triangles count as halves of cells, and particles are farther apart. Smaller: diagonals of
/// slightly skewed cells are split. Shown by the tests of `sheets`.
pub(crate) const SQUARE_CORNER: f32 = 0.26;

/// Longest diagonal that is not split, as a ratio to the spacing: slightly above √2, that of a square cell.
///
/// Larger: limbs pass between particles. Smaller: diagonals of square cells are split, and edges run diagonally.
/// Shown by the tests of `sheets`.
pub(crate) const DIAGONAL: f32 = 1.45;

/// Smallest particle distance that is tried, as a share of a sheet's extent.
///
/// Larger: sheets of long, narrow meshes are coarser. Smaller: a tiny spacing needs more tries. Shown by the tests of
/// `sheets`.
pub(crate) const FINEST: f32 = 1e-4;

// retarget/align.rs

/// Cosine of the largest angle between two reference poses, 30°, that both count as upright.
///
/// A larger angle: a character with an A-pose stands bent. A smaller angle: traces of the actor's calibration pose
/// remain in standing poses. Shown by the tests of `mocap`.
pub(crate) const SAME_UPRIGHT: f32 = 0.866;

/// Cosine of the largest angle of a leg's bones to the vertical, 25°, at which the leg stands and its foot is flat on
/// the floor.
///
/// A larger angle: feet of crouching rest poses are turned flat. A smaller angle: feet of standing rest poses are not
/// turned flat. Shown by the tests of `retarget`.
pub(crate) const LEG_STANDS: f32 = 0.906;

// retarget/mod.rs

/// Time by which a foot's hold extends beyond each end of the actor's contact, seconds.
///
/// Shortly before a foot lands it hardly moves forward. Larger: feet stick at each step. Smaller: feet slide as they
/// land. Shown by the tests of `retarget`.
pub(crate) const FOOT_HOLD: f32 = 0.02;

/// Time over which the height of the body is matched to the floor, seconds.
///
/// Larger: feet sink at the start of a step. Smaller: the body bobs. Shown by the tests of `retarget`.
pub(crate) const FLOOR_TIME: f32 = 0.12;

// retarget/reference.rs

/// Cosine of the largest angle, 32°, of trunk and legs to the vertical in a clearly standing pose.
///
/// A larger angle: a crouch becomes the reference pose. A smaller angle: no frame of a capture qualifies. Shown by the
/// tests of `mocap`.
pub(crate) const CLEARLY_STANDING: f32 = 0.85;

/// Least cosine of trunk, thighs and shanks with the vertical for a standing frame of a clip.
///
/// Larger: the bent knees of a walk count as lying. Smaller: crawling counts as standing. Shown by the tests of `take`.
pub(crate) const STANDS_IN_CLIP: f32 = 0.5;

// springs/guess.rs

/// Radius of a spring's tip, as a ratio to the mean length of its chain's bones.
///
/// Larger: hair stands off the head. Smaller: hair sinks into surfaces. Shown by the tests of `springs`.
pub(crate) const SPRING_RADIUS: f32 = 0.15;

// springs/mod.rs

/// Default share of a link's error corrected per 1/60 s.
///
/// Larger: a skirt is one stiff sheet. Smaller: its strands separate where a leg pulls. Shown by
/// `spring_links_limit_the_distance_of_strands`.
pub(crate) const SPRING_LINK_SHARE: f32 = 0.5;

// weights.rs

/// Least number of joints of a skeleton whose skin weights may count as lost; a lid on a hinge has fewer.
///
/// Larger: a small skeleton that moves as one piece counts as rigid. Smaller: a hinge is rejected. Shown by the tests
/// of `weights`.
pub(crate) const FEWEST_OF_A_SKELETON: usize = 4;

/// Largest number of comparisons of unweighted vertices with weighted vertices per mesh part.
///
/// Larger: reading huge meshes takes longer. Smaller: in large meshes fewer vertices are compared, and the nearest is
/// found less exactly. Only shown by the reading time of huge meshes.
pub(crate) const MOST_COMPARED: usize = 50_000_000;

/// Least weight of a neighbouring bone, as a share of the nearest bone's, to be kept for a vertex.
///
/// Larger: the skin at joints bends in sharp folds. Smaller: vertices far from a bone get tiny weights for it. Shown by
/// the tests of `weights`.
pub(crate) const NEAREST_FALLOFF: f32 = 0.01;
