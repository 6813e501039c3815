//! Tunable constants of characters: animated, limp, getting up, stumbling.
//!
//! Each constant has its unit, the effect of a larger and a smaller value, and the tests
//! (`crates/sinew_ragdoll/tests/it`) that show it. Effects without a number are estimates.

// character/gait.rs

/// Largest speed at which the height of a character's origin follows the ground, m/s: a stair step takes a few frames.
///
/// Larger: the character jerks up a stair. Smaller: its feet sink into the steps. Shown by the tests of `slopes`.
pub(crate) const CLIMB_SPEED: f32 = 1.2;

// character/blows.rs

/// Time for which a struck limb is weak, seconds.
///
/// Larger: the limb hangs down. Smaller: the hit is not visible. Shown by the tests of `blows`.
pub(crate) const FLINCH_TIME: f32 = 0.12;

/// Distance of a struck body from its pose in the clip below which it counts as returned, metres.
///
/// Larger: the limb jumps at the end of a flinch. Smaller: characters in a crowd flinch for longer. Shown by the scene
/// `brawl`.
pub(crate) const BACK_WITHIN: f32 = 0.04;

/// Half-life of the change to keyed drives for the bodies of a flinching character that were not struck, seconds. It is
/// shorter than any step, but not 0, so that the bodies' speeds stay bounded where the pose with planted feet ends.
///
/// Larger: the bodies hang from springs for a step. Smaller: no visible difference. Shown by the scene `brawl`.
pub(crate) const FLINCH_KEYS: f32 = 1e-4;

/// Half-life of a struck limb's return, seconds.
///
/// Larger: the limb drifts back slowly. Smaller: it snaps back. Shown by the tests of `blows`.
pub(crate) const FLINCH_HALF_LIFE: f32 = 0.08;

/// Largest share of the legs' strength, 0 to 1, that a hit takes from a stepping character.
///
/// Larger: the character kneels before its foot is down. Smaller: the legs stay stiff. Shown by the tests of `stumble`.
pub(crate) const LEGS_WEAKEN: f32 = 0.2;

/// Speed up to which each struck body takes up the impulse that it stopped as a kinematic body, m/s. If the striker is
/// faster, its speed applies instead.
///
/// Larger: a foot that treads on a body kicks it away. Smaller: the foot stays pressed against the body. Shown by the
/// tests of `grab`.
pub(crate) const GIVES_WAY: f32 = 3.0;

/// Largest speed that [`hit`](super::Character::hit) gives to the struck body alone, m/s; the rest of the impulse goes
/// up its chain.
///
/// A fist or foot strikes at 8 to 12 m/s. Larger: a strong hit flings a hand away. Smaller: weak hits move the trunk.
/// Shown by `brawl`.
pub(crate) const HIT_SPEED: f32 = 12.0;

/// Ratio of the impulse that makes a character near the ground fall to the one that makes a standing character fall.
///
/// Larger: no hit stops a get-up. Smaller: few characters of a crowd get up. Shown by the tests of `blows`.
pub(crate) const LOW_STANDS: f32 = 2.5;

/// Largest share of the trunk's strength, 0 to 1, that a hit takes from a stepping character.
///
/// Larger: the trunk folds. Smaller: the trunk stays stiff. Shown by the tests of `stumble`.
pub(crate) const TRUNK_WEAKENS: f32 = 0.5;

/// Number of half-lives after which a limb follows the clips again.
///
/// Larger: the limb counts as flinching for longer. Smaller: it jumps at the end. Shown by the tests of `blows`.
pub(crate) const RETURNED_AFTER: f32 = 6.0;

// character/detach.rs

/// Height at which detached bodies are placed for springs that collide with bodies, metres, world; the world is empty
/// there.
///
/// Larger: springs may touch these bodies. Smaller: only rounding grows. Shown by the tests of `detach`.
pub(crate) const FAR_BELOW: f32 = -1e6;

// character/grasp.rs

/// Gap of a grip below which the gap has no direction, metres.
///
/// Larger: the axes of the grip stay although it already slips. Smaller: the axes follow noise. Shown by the tests of
/// `grab`.
pub(crate) const LEAST_GAP: f32 = 1e-4;

/// Cosine between a grip's pull and the diagonal of its axes below which the axes are aligned again.
///
/// Larger: the axes are aligned all the time. Smaller: the grip pulls with less than its force. Shown by the tests of
/// `grab`.
pub(crate) const LEAST_ALONG: f32 = 0.98;

/// Stretch of a grip at its full force, metres.
///
/// Larger: held bodies hang away from the hand. Smaller: the grip jerks. Shown by the tests of `grab`.
pub(crate) const GRIP_STRETCH: f32 = 0.01;

/// Share of a grip's force that its motor uses, 0 to 1: contacts and stops of joints add to it within a substep.
///
/// Larger: a grip pulls visibly harder than allowed. Smaller: it lets go too early. Shown by the tests of `grab`.
pub(crate) const GRIP_SHARE: f32 = 0.9;

// character/rises.rs

/// Distance between the points of a part at which the ground is searched, as a share of the character's height.
///
/// Larger: a hand over the edge of a step sinks into it. Smaller: more rays are cast. Shown by `brawl`.
pub(crate) const PROBES_APART: f32 = 0.08;

/// Height above a part of a rising character from which the ground is searched, as a share of the character's height.
///
/// Larger: a body that leans against a crate is lifted onto it. Smaller: hands pass through stairs. Shown by `brawl` and
/// `rising::arms_rise_over_a_step_beside_the_body`.
pub(crate) const PART_SEARCH: f32 = 0.14;

/// Largest speed at which the end of a limb moves out of a wall, relative to its clip, m/s.
///
/// Larger: hands snap back at corners. Smaller: hands enter walls. Shown by `brawl`.
pub(crate) const PULLED_BACK: f32 = 2.5;

/// Speed at which the end of a limb returns to its clip beside a wall, m/s.
///
/// Larger: hands snap over edges. Smaller: hands lag behind the clip. Shown by `brawl`.
pub(crate) const RETURNS: f32 = 1.0;

/// Natural frequency at which the parts of a rising character follow the ground, rad/s; critically damped.
///
/// Larger: hands jerk over edges. Smaller: hands pass through them. Shown by `brawl`.
pub(crate) const PART_QUICKNESS: f32 = 12.0;

/// Largest softness of a limb whose end is moved out of a floor or a wall, or steps, as a share of the limb's length: see
/// [`TwoBoneGoal`](sinew_anim::ik::TwoBoneGoal::softness).
///
/// Larger: the end stops short of its target. Smaller: the knee snaps when the leg becomes straight. Shown by the scene
/// `brawl`.
pub(crate) const LIMB_SOFTNESS: f32 = 0.08;

// character/foot_bodies.rs

/// Distance by which the body of a foot may be lower than its drawn skin, as a share of the character's height.
///
/// Larger: the box of a walking foot enters the ground. Smaller: boxes that are a little larger than the skin turn while
/// the foot is flat. Shown by `feet::bodies_of_feet_stay_out_of_the_floor`.
pub(crate) const BODY_BELOW_SKIN: f32 = 0.003;

/// Downward component of a foot's up direction from which the foot's body is not rotated.
///
/// Larger: feet of prone characters press their toes into the floor. Smaller: the box of a foot that points down enters
/// the ground. Shown by the scene `brawl`.
pub(crate) const UPSIDE_DOWN: f32 = 0.5;

// character/grab.rs

/// Half of the distance between the bounds of two characters from which they collide again after a release, metres.
///
/// Larger: the characters pass through each other for longer. Smaller: feet kick the released character. Shown by the
/// tests of `grab`.
pub(crate) const PARTED: f32 = 0.05;

// character/feet.rs

/// Natural frequency at which feet follow the ground, rad/s; critically damped.
///
/// Larger: legs jerk. Smaller: feet sink in and float. Shown by the tests of `slopes`.
pub(crate) const FEET_QUICKNESS: f32 = 12.0;

/// Largest height of the ground above or below the clip's floor at which a foot is still placed on it, metres.
///
/// Larger: legs reach into holes. Smaller: feet hang over steps. Shown by the tests of `slopes`.
pub(crate) const FOOT_RANGE: f32 = 0.32;

/// Height difference below which ground counts as level with the clip's floor, metres.
///
/// Larger: feet float above the ground. Smaller: noise of meshes moves legs. Shown by the tests of `slopes`.
pub(crate) const FOOT_FLOOR: f32 = 2e-3;

/// Offset (metres) and speed (m/s) below which a foot counts as returned to its clip.
///
/// Larger: the foot jumps at the end. Smaller: the correction is computed for longer without visible effect. Shown by
/// the tests of `pops`.
pub(crate) const FOOT_HOME: f32 = 1e-5;

/// Ratio of the time for standing up to the time for planting the feet.
///
/// Larger: feet jerk. Smaller: feet slide while the character rises. Shown by the tests of `slopes`.
pub(crate) const PLANTED_SOONER: f32 = 2.0;

/// Slope of the ground along a foot, rise over run, from which it counts as an edge.
///
/// Larger: feet tilt on edges. Smaller: feet stay level on slopes. Shown by the tests of `slopes`.
pub(crate) const FOOT_EDGE: f32 = 0.6;

/// Largest tilt of a foot, radians.
///
/// Larger: ankles bend too far. Smaller: feet sink into steep ground. Shown by the tests of `slopes`.
pub(crate) const MOST_TILT: f32 = 0.6;

/// Largest turning speed of a powered character, rad/s, which its muscles and pins can follow. A person turns round on
/// the spot within a second.
///
/// Larger: the character twists and falls over its own legs. Smaller: it turns slowly. Shown by the scene `brawl`.
pub(crate) const POWERED_TURNS: f32 = 3.5;

/// Natural frequency at which a walking foot follows edges, rad/s; critically damped. The foot reaches the new height
/// within half a swing; edges are detected that long in advance.
///
/// Larger: feet jerk over edges. Smaller: feet are still too high when they land. Shown by the tests of `feet`.
pub(crate) const TREAD_QUICKNESS: f32 = 25.0;

/// Time over which the landing point of a foot in the air is predicted from its speed, seconds. The foot slows down
/// evenly in the second half of its swing.
///
/// Larger: the foot is raised for the step after. Smaller: edges are detected late. Shown by the tests of `feet`.
pub(crate) const LOOKS_AHEAD: f32 = 0.12;

/// Heights of a foot's lowest point above the clip's floor, as shares of body height: the height above which the
/// landing point is predicted, and the further height over which the prediction time grows to [`LOOKS_AHEAD`]. A foot
/// that is about to land moves only a little further.
///
/// Larger: edges are detected late. Smaller: the foot is raised for the step after. Shown by the tests of `feet`.
pub(crate) const LANDS: [f32; 2] = [0.006, 0.017];

/// Upward component of a surface normal below which the surface is a wall for toes, a cosine.
///
/// Larger: toes draw back from slopes. Smaller: toes enter steep slopes. Shown by the tests of `feet`.
pub(crate) const STEEPEST_TREAD: f32 = 0.5;

/// Height over the ground from which an obstacle in front of a foot counts as a wall, metres.
///
/// Larger: toes enter low kerbs. Smaller: toes draw back from slopes. Shown by the tests of `feet`.
pub(crate) const TOES_OVER: f32 = 0.06;

/// Distance that toes and heel keep from a wall where a foot lands, metres. Foot shapes are slightly smaller than the
/// drawn feet.
///
/// Larger: feet land beside their clips. Smaller: toes enter walls. Shown by the tests of `feet`.
pub(crate) const TOES_CLEAR: f32 = 0.02;

/// Largest depth of the ground below the clip's floor at which a walking foot is still placed on it, as a share of body
/// height. It includes more than one stair, because the mover arrives there a radius ahead of the foot.
///
/// Larger: legs reach into holes. Smaller: feet hang over steps. Shown by the tests of `feet`.
pub(crate) const TREAD_RANGE: f32 = 0.34;

/// Height of a foot's lowest point above the clip's floor below which the foot may stand, as a share of body height.
///
/// Larger: feet stick during a swing. Smaller: feet slide. Shown by the tests of `feet`.
pub(crate) const STANCE_HEIGHT: f32 = 0.015;

/// Speed of a clip's foot over the ground below which the foot may stand, m/s.
///
/// Larger: feet stick during a swing. Smaller: feet slide with the clip. Shown by the tests of `feet`.
pub(crate) const STANCE_SPEED: f32 = 0.8;

/// Rate at which a foot in the air returns to its clip, 1/s.
///
/// Larger: the foot jerks when it leaves the ground. Smaller: the foot lands beside its target. Shown by the tests of
/// `feet`.
pub(crate) const RELEASES: f32 = 12.0;

/// Rate at which the pelvis returns after it was lowered so that a leg reaches its planted foot, 1/s.
///
/// Larger: the knee jumps when the foot leaves the ground. Smaller: the walker crouches. Shown by
/// `feet::joints_of_a_walker_do_not_shake`.
pub(crate) const PELVIS_RISES: f32 = 8.0;

/// Part of a foot's offset that is not corrected, metres. A mover's speed lags the clips' speed by a step.
///
/// Larger: feet slide. Smaller: legs vibrate. Shown by the tests of `feet`.
pub(crate) const SMALL_WAY: f32 = 4e-3;

/// Least mass of a dynamic body that counts as ground, as a share of the character's mass.
///
/// Larger: feet pass through crates. Smaller: feet step onto crates that they should kick. Shown by the tests of
/// `in_world`.
pub(crate) const LEAST_TREAD: f32 = 0.05;

/// Largest distance of a planted foot from its position in the clip, as a share of body height.
///
/// Larger: legs twist. Smaller: feet slide. Shown by the tests of `feet`.
pub(crate) const MOST_ASTRAY: f32 = 0.07;

/// Depth of a sole in the ground from which it is raised immediately, metres.
///
/// Larger: the sole sinks in. Smaller: the foot jerks over noise. Shown by the tests of `feet`.
pub(crate) const SOLE_SINKS: f32 = 0.01;

/// Speed at which a sole rises out of the ground, m/s.
///
/// Larger: the foot jerks over edges that are detected late. Smaller: the foot passes through them. Shown by the tests
/// of `feet`.
pub(crate) const RISES: f32 = 5.0;

/// Time without ground after which feet are no longer planted, seconds.
///
/// Larger: feet stick to the ground in a jump. Smaller: feet are released at each kerb. Shown by the tests of `feet`.
pub(crate) const OFF_GROUND: f32 = 0.1;

/// Height above a foot from which the ground is searched, metres.
///
/// Larger: a table above the foot counts as ground. Smaller: steps are detected late. Shown by the tests of `slopes`.
pub(crate) const FOOT_SEARCH: f32 = 0.5;

/// Speed from which the feet of a character follow its clips, m/s.
///
/// Larger: feet stick while walking. Smaller: feet slide while standing. Shown by the tests of `slopes`.
pub(crate) const WALKS_FROM: f32 = 0.3;

/// Position of the ball of the foot in front of an ankle without toes, in leg lengths.
///
/// The animations use the same value. Shown by the tests of `slopes`.
pub(crate) const BALL_AHEAD: f32 = 0.14;

// character/clearance.rs

/// Least horizontal distance of the pelvis from its position in the rest pose at which a clip begins away from its
/// origin, as a share of the character's height.
///
/// Larger: a character with a captured clip walks beside its ground. Smaller: a lunge is pulled back. Shown by the
/// tests of `travel`.
pub(crate) const OFF_ORIGIN: f32 = 0.3;

/// Largest lift of a body part out of the floor, as a share of the character's height.
///
/// Larger: the character hovers where a limb's shape is far from its skin. Smaller: limbs sink into the floor. Shown by
/// the tests of `rising`.
pub(crate) const MOST_LIFT: f32 = 0.25;

/// Weight of the direction away from the pelvis in the direction in which an arm of one bone is raised out of the floor;
/// the arm's own horizontal direction has the sine of its angle to the vertical.
///
/// Larger: arms that push in front of the body spread to the sides. Smaller: arms that hang straight down turn in any
/// direction. Shown by the tests of `motions`.
pub(crate) const ARMS_ASIDE: f32 = 0.2;

/// Depth of the skin of feet, hands and elbows in the floor up to which a get-up clip is not corrected, as a share of
/// the character's height.
///
/// Larger: fingers sink into the floor. Smaller: soles float above it. Shown by the tests of `motions`.
pub(crate) const LIMBS_SINK: f32 = 0.003;

/// Ratio of the height to the length of a foot's step to its position in a clip; [`STEP_HEIGHT`] limits the height.
///
/// Larger: the character stamps. Smaller: feet slide. Shown by the tests of `rising`.
pub(crate) const STEP_OVER: f32 = 0.6;
/// Largest height of a foot's step to its position in a clip, as a share of the character's height: see [`STEP_OVER`].
pub(crate) const STEP_HEIGHT: f32 = 0.05;

/// Cosine of the largest tilt of a foot that steps to its position in a clip.
///
/// Larger: feet slide. Smaller: lying legs kick. Shown by the tests of `rising`.
pub(crate) const STEPS_FROM: f32 = 0.0;

/// Share of a step, at each end, in which the foot only moves up or down.
///
/// Larger: the foot jerks between the ends. Smaller: the foot slides. Shown by the tests of `rising`.
pub(crate) const STRAIGHT_UP: f32 = 0.22;

// character/grab.rs

/// Distance of a held limb from its position in the clip beyond which its character follows, as a share of body height.
///
/// Larger: the character leans before it steps. Smaller: it follows a hand that only touches it. Shown by the tests of
/// `held`.
pub(crate) const PULL_SLACK: f32 = 0.03;

/// Upward speed at which a standing character leaves the ground, m/s.
///
/// Larger: an updraft lifts the character late, and feet stick in a jump. Smaller: the mover snaps back to the ground.
/// Shown by the tests of `blown`.
pub(crate) const LIFTS_OFF: f32 = 0.5;

/// Rate at which a character follows a held limb beyond [`PULL_SLACK`], 1/s.
///
/// Larger: the character jerks. Smaller: a slow pull makes it fall. Shown by the tests of `held`.
pub(crate) const PULL_RATE: f32 = 6.0;

/// Largest speed at which a character follows a held limb, m/s.
///
/// Larger: the character is dragged on its feet faster than it can walk. Smaller: a walker who holds it makes it fall.
/// Shown by the tests of `held`.
pub(crate) const PULL_SPEED: f32 = 2.0;

/// Distance of a held limb from its position in the clip at which its character falls, as a share of body height: about
/// an arm's reach.
///
/// Larger: joints are torn apart. Smaller: every pull makes the character fall. Shown by the tests of `held`.
pub(crate) const PULL_FELLS: f32 = 0.3;

// character/get_up.rs

/// Height of a pelvis above the ground up to which the body counts as lying on this ground, as a share of body height.
///
/// Larger: bodies that are carried get up in the air. Smaller: a body that lies on others does not get up. Shown by the
/// tests of `held`.
pub(crate) const LIES_LOW: f32 = 0.3;

/// Share of a body's weight that firm ground must carry so that the body gets up from an edge or a rail.
///
/// Larger: the body stays on rails. Smaller: a carried body gets up while its foot drags on the ground. Shown by the
/// tests of `held`.
pub(crate) const BORNE: f32 = 0.5;

/// Time of the blend from the bodies' pose into a get-up clip, seconds.
///
/// Larger: limbs pass through the floor. Smaller: limbs jerk. Shown by the tests of `pops`.
pub(crate) const INTO_GET_UP: f32 = 0.35;

/// Largest rotation of the pelvis, radians, and largest mean distance of the joints, as a share of the height, of a body
/// at rest from the looped clip's pose for which it counts as standing and plays no get-up clip.
///
/// Larger: a kneeling body rises without a get-up clip. Smaller: a standing body lies down to get up. Shown by the
/// tests of `character`.
pub(crate) const STANDS: [f32; 2] = [0.7, 0.14];

/// Time of the blend from the bodies' pose into the looped clip, if no get-up clip exists, seconds.
///
/// Larger: the character floats up. Smaller: it jumps up. Shown by the tests of `pops`.
pub(crate) const INTO_STANDING: f32 = 0.8;

/// Time of the blend from the end of a get-up clip into the looped clip, seconds.
///
/// Larger: feet slide. Smaller: limbs jerk. Shown by the tests of `pops`.
pub(crate) const INTO_LOOP: f32 = 0.3;

/// Share of a get-up clip, ending with the clip, in which a body that lay on a slope becomes upright, 0 to 1.
///
/// Larger: hands leave the ground. Smaller: the body swings upright. Shown by the tests of `slopes`.
pub(crate) const STRAIGHTENS: f32 = 0.6;

/// Net load from other bodies above which a lying body does not get up, as a share of its own weight: about half the
/// weight of an arm.
///
/// Larger: the body gets up under another's limb and throws it off. Smaller: it waits for someone who only leans on it.
/// Shown by `in_world::upper_of_two_fallen_characters_gets_up_first`.
pub(crate) const BEARS: f32 = 0.02;

/// Upward component of the contact normal toward a kinematic body above which this body stands on the lying one, a
/// cosine: 17° from level.
///
/// Larger: a body that kneels on the lying one is lifted. Smaller: the lying body waits for a lift beside it. Shown as
/// [`BEARS`].
pub(crate) const ON_TOP: f32 = 0.3;

/// Time after its fall for which a body waits until a load above [`BEARS`] is gone, seconds.
///
/// Larger: the body lies long under a crate that nobody removes. Smaller: it throws off slow loads. Shown as [`BEARS`].
pub(crate) const BEARS_FOR: f32 = 5.0;

/// Initial height of the mover of a character that gets up, as a share of the mover's full height.
///
/// Larger: the mover does not fit under obstacles. Shown by the tests of `in_world`.
pub(crate) const LYING_MOVER: f32 = 0.0;

/// Height above the pelvis from which the ground is searched, metres.
///
/// Larger: objects above the pelvis count as ground. Smaller: no ground is found for a pelvis sunk in a slope. Shown by
/// the tests of `slopes`.
pub(crate) const ABOVE_PELVIS: f32 = 0.3;

// character/ground.rs

/// Highest step that a walking character climbs, metres.
///
/// Larger: the character climbs tables. Smaller: it stops at stairs. Shown by the tests of `travel`.
pub(crate) const HIGHEST_STEP: f32 = 0.45;

/// Distance around the origin of a character without a mover within which ground keeps it from falling over an edge, as
/// a share of its height.
///
/// Larger: it walks on air beyond an edge. Smaller: gaps in a floor fell it. Shown by the tests of `slopes`.
pub(crate) const FOOTHOLD: f32 = 0.05;

/// Depth below a point to which the ground is searched, metres.
///
/// Larger: searches over holes are slower. Smaller: no ground is found for bodies high in the air. Shown by the tests
/// of `character`.
pub(crate) const GROUND_DEPTH: f32 = 100.0;

/// Depth under a pelvis to which the supporting ground is searched, metres.
///
/// Larger: a body on an edge gets up on the floor below. Smaller: large characters find no support. Shown by the tests
/// of `slopes`.
pub(crate) const LIES_ON: f32 = 1.0;

/// Height above a point of a lying body from which the ground is searched, metres.
///
/// As [`ABOVE_PELVIS`].
pub(crate) const LYING_SEARCH: f32 = 0.3;

/// Largest slope to which a character aligns, radians; steeper ground counts as this steep.
///
/// Larger: a character gets up leaning. Smaller: it gets up through the ground. Shown by the tests of `slopes`.
pub(crate) const STEEPEST_GROUND: f32 = 0.6;

/// Slope below which ground counts as level, radians.
///
/// Larger: feet float above gentle slopes. Smaller: feet are corrected needlessly. Shown by the tests of `slopes`.
pub(crate) const LEVEL_GROUND: f32 = 0.02;

// character/hit_bodies.rs

/// Displacement of a body within a step from which it counts as teleported, metres.
///
/// Larger: teleported bodies strike everything on their way. Smaller: fast bodies strike nothing. Shown by the tests of
/// `in_world`.
pub(crate) const TELEPORTED: f32 = 1.0;

/// Largest speed at which a body of a clip that is away from its pose approaches the pose, m/s, in addition to its
/// clip's own.
///
/// Larger: a character whose pose jumps throws whoever lies there. Smaller: its bodies lag behind its pose. Shown by the
/// scene `brawl`.
pub(crate) const CATCHES_UP: f32 = 10.0;

/// Largest difference between the velocity at which a body becomes dynamic and that of the hit body, m/s and rad/s.
///
/// Larger: a limb that has just been lifted out of a crate flies away in a fall. Smaller: bodies fall at the speed of the
/// step before. Shown by the scene `brawl`.
pub(crate) const HAND_OVER_CHANGE: [f32; 2] = [4.0, 12.0];

/// Largest acceleration of a clip's body whose motion is extrapolated in full, m/s²; a punch stays below it.
///
/// Larger: a body overshoots each jump of its clip by the length of the jump. Smaller: bodies lag behind fast clips.
/// Shown by `feet::bodies_do_not_overshoot_a_jump`.
pub(crate) const SUDDEN: f32 = 70.0;

// character/in_world.rs

/// Least speed of the whole character after a hit that makes it fall, m/s.
///
/// Larger: stronger hits are needed. Smaller: a touch makes the character fall. Shown by the tests of `in_world`.
pub(crate) const FELLING_SPEED: f32 = 0.6;

/// Radius of a mover, as a share of its height.
///
/// Larger: the mover does not fit through doors. Smaller: arms enter walls. Shown by the tests of `in_world`.
pub(crate) const MOVER_RADIUS: f32 = 0.17;

// character/limp.rs

/// Time between the predicted poses for hand-over velocities, seconds: short against any motion, long against rounding.
///
/// Larger: bodies get the speeds of the next step. Smaller: rounding makes the speeds noisy. Shown by the tests of
/// `hand_over`.
pub(crate) const HAND_OVER_TIME: f32 = 1.0 / 1000.0;

/// Rate at which the position of a limp character approaches the point under its pelvis, in addition to moving with
/// this point, 1/s.
///
/// Larger: the position jumps when a fall begins. Smaller: a camera looks beside the body. Shown by the tests of
/// `held`.
pub(crate) const PLACE_FOLLOWS: f32 = 8.0;

/// Distance of a limp character's position from the point under its pelvis below which the position stays unchanged,
/// metres, so that a resting body keeps its pose.
///
/// Larger: the position stays beside the body. Smaller: the pose of a resting body is computed in every step. Shown by
/// the tests of `held`.
pub(crate) const PLACE_RESTS: f32 = 1e-4;

/// Time in which joints without bodies come to rest, seconds.
///
/// Larger: fingers keep moving on a lying body. Smaller: fingers freeze. Shown by the tests of `pops`.
pub(crate) const LINGERS: f32 = 0.25;

/// Time in which joints reach the friction of a limp body, seconds.
///
/// Larger: the body falls without resistance. Smaller: joints jerk at the hand-over. Shown by the tests of `hand_over`.
pub(crate) const SLACKENS: f32 = 0.2;

/// Speed below which a body counts as still, m/s: 2 cm/s by the contract.
///
/// Larger: the character gets up while its body slides. Smaller: it lies longer before it gets up. Shown by the tests
/// of `character`.
pub(crate) const STILL_LINEAR: f32 = 0.02;

/// Angular speed below which a body counts as still, rad/s, by the contract.
///
/// As [`STILL_LINEAR`].
pub(crate) const STILL_ANGULAR: f32 = 0.05;

/// Time for which all bodies must be still before the character counts as at rest, seconds, by the contract.
///
/// Larger: the character lies longer before it gets up. Smaller: it gets up at the turning point of a swing, while
/// bodies still move. Shown by the tests of `character`.
pub(crate) const STILL_TIME: f32 = 0.5;

/// Penetration above which a body does not count as lying yet, metres: contacts still push it out, without a velocity
/// of its own.
///
/// Larger: stuck bodies count as at rest. Smaller: bodies resting within the slop do not. Shown by the tests of
/// `falls`.
pub(crate) const SUNK: f32 = 5e-3;

// character/mirror.rs

/// Largest distance of a joint from the mirror image of its counterpart in the bind pose, as a share of the body's
/// height.
///
/// Larger: mirrored clips look crooked. Smaller: no clip is mirrored. Shown by the tests of `character`.
pub(crate) const MIRROR_TOLERANCE: f32 = 0.03;

/// Distance of a joint from its rest position beyond which it counts as translated, as a share of its distance from its
/// parent.
///
/// Larger: translated joints keep their rest position in mirrored clips. Smaller: rounding counts as a translation.
/// Shown by the tests of `character`.
pub(crate) const MOVED: f32 = 1e-3;

// character/moves.rs

/// Share of a get-up clip, from its start, within which a get-up may begin, 0 to 1.
///
/// Larger: the get-up may begin nearly upright. Smaller: a sitting body lies down first. Shown by the tests of
/// `character`.
pub(crate) const MAY_BEGIN: f32 = 0.4;

/// Uprightness of the pelvis (1: upright) below which a get-up clip counts as one that begins lying.
///
/// Larger: clips that begin sitting count as lying. Smaller: clips that begin lying on a side count as sitting.
/// Shown by the tests of `rising`.
pub(crate) const BEGINS_LYING: f32 = 0.6;

/// Largest height of the pelvis above its lowest position at which a get-up may begin in a clip that begins sitting, as
/// a share of the character's height.
///
/// Larger: a lying body snaps to a crouch. Smaller: fewer start poses are available. Shown by the tests of `rising`.
pub(crate) const LOW_START: f32 = 0.05;

/// Interval between the clip times at which a get-up may begin, seconds.
///
/// Larger: the start matches the lying pose less well. Smaller: the search is slower. Shown by the tests of
/// `character`.
pub(crate) const STARTS_APART: f32 = 1.0 / 15.0;

/// Time between the poses of a clip whose root motion is moved to the pelvis, seconds.
///
/// Larger: steps are cut short. Smaller: clips take more memory. Shown by the tests of `travel`.
pub(crate) const ROOT_FRAME: f64 = 1.0 / 60.0;

/// Time between the poses of a mirrored clip, seconds: getting up is slow.
///
/// As [`ROOT_FRAME`].
pub(crate) const MIRRORED_FRAME: f64 = 1.0 / 30.0;

// character/pose_similarity.rs

/// Weight of each point at the end of a stick that represents the rotation of the trunk, relative to the mean weight of
/// a body.
///
/// Larger: limbs have no influence. Smaller: a body on its back gets up by the clip for its belly. Shown by the tests
/// of `character`.
pub(crate) const STICK_WEIGHT: f32 = 1.5;

/// Length of a stick that represents the rotation of the trunk, as a share of body height.
///
/// As [`STICK_WEIGHT`].
pub(crate) const STICK: f32 = 0.2;

// character/powered.rs

/// Largest force of the pin of a powered body that is neither pelvis nor leg, as a multiple of that body's weight.
///
/// Larger: the body moves like a puppet on strings. Smaller: arms lag. Shown by the tests of `lives`.
pub(crate) const PIN_HELPS: f32 = 1.0;

/// Largest force of the pin of a body of a powered leg, as a multiple of that body's weight.
///
/// Larger: feet push obstacles. Smaller: they drag. Shown by the tests of `lives`.
pub(crate) const PIN_STEPS: f32 = 4.0;

/// Largest force of the pin of a powered pelvis, as a multiple of the total weight.
///
/// Larger: no push makes the character fall. Smaller: it sags. Shown by the tests of `lives`.
pub(crate) const PIN_BEARS: f32 = 1.0;

/// Largest torque of the pin of a powered pelvis, divided by the total weight, metres.
///
/// Larger: no push tips the character over. Smaller: it leans. Shown by the tests of `lives`.
pub(crate) const PIN_TURNS: f32 = 0.3;

/// Half-life of a powered body's return to the clips, seconds.
///
/// Larger: the body drifts back slowly. Smaller: it snaps back. Shown by the tests of `lives`.
pub(crate) const POWERED_HALF_LIFE: f32 = 0.1;

/// Distance of a powered pelvis from the pelvis of its clips beyond which the character falls, as a share of body
/// height.
///
/// Larger: the character is dragged along. Smaller: a push makes it fall. Shown by the tests of `lives`.
pub(crate) const FALLS_BEYOND: f32 = 0.3;

/// Rotation of a powered pelvis from the pelvis of its clips beyond which the character falls, radians.
///
/// As [`FALLS_BEYOND`].
pub(crate) const FALLS_TURNED: f32 = 1.0;

// character/prepare.rs

/// Time to drive a body to the start of a get-up clip if its trunk must be rolled over, seconds.
///
/// Larger: the character lies long. Smaller: it is thrown over. Shown by the tests of `character`.
pub(crate) const TIME_TO_ROLL: f32 = 1.5;

/// Time to drive a body to the start of a get-up clip if its trunk needs no roll, seconds.
///
/// As [`TIME_TO_ROLL`].
pub(crate) const TIME_TO_PULL: f32 = 0.5;

/// Half-life with which the drives that prepare a get-up grow to their full strength, seconds.
///
/// Larger: the trunk rolls late. Smaller: the trunk jerks. Shown by the tests of `character`.
pub(crate) const PREPARES_HALF_LIFE: f32 = 0.1;

/// Frequency of the pin that rolls a trunk over, Hz.
///
/// Larger: the trunk flips. Smaller: the roll does not finish in time. Shown by the tests of `character`.
pub(crate) const ROLL_HERTZ: f32 = 2.0;

/// Largest rolling torque on each part of the trunk, divided by the product of weight and height: 90 N·m for a man.
///
/// Larger: the body throws off its load. Smaller: it stays lying. Shown by the tests of `character`.
pub(crate) const ROLL_STRENGTH: f32 = 0.07;

// character/stumble/mod.rs

/// Duration of a step that only returns a foot to its position in the clips, seconds.
///
/// Larger: the foot returns slowly. Smaller: it snaps back. Shown by the tests of `stumble`.
pub(crate) const HOME_TIME: f32 = 0.25;

/// Share of a step's duration, from its start, within which its goal may change, 0 to 1.
///
/// Larger: feet change direction late. Smaller: they land at the point that was predicted first. Shown by the tests of
/// `stumble`.
pub(crate) const AIMS_UNTIL: f32 = 0.7;

/// Height to which a step raises the foot, as a share of body height.
///
/// Larger: the character marches. Smaller: feet drag. Shown by the tests of `stumble`.
pub(crate) const LIFT: f32 = 0.05;

/// Half the width of a sole, as a share of body height.
///
/// Larger: the character balances on edges. Smaller: it steps needlessly. Shown by the tests of `stumble`.
pub(crate) const SOLE_RIM: f32 = 0.023;

/// Largest distance by which the pelvis is lowered, as a share of body height.
///
/// Larger: the character squats. Smaller: feet do not reach their goals. Shown by the tests of `stumble`.
pub(crate) const PELVIS_SINKS: f32 = 0.12;

/// Distance of a capture point from the feet that triggers a step, metres.
///
/// Larger: the character falls before it steps. Smaller: it steps needlessly. Shown by the tests of `stumble`.
pub(crate) const CAPTURE_MARGIN: f32 = 0.01;

/// Distance of a capture point from the feet that triggers the first step without a reported push, metres.
///
/// As [`CAPTURE_MARGIN`].
pub(crate) const UNTOLD_MARGIN: f32 = 0.08;

/// Velocity error below which a character counts as caught, m/s.
///
/// Larger: the character stands still while it sways. Smaller: it keeps stepping. Shown by the tests of `stumble`.
pub(crate) const CAUGHT_SPEED: f32 = 0.15;

/// Additional velocity error of a caught character, as a share of its requested velocity, 0 to 1.
///
/// As [`CAUGHT_SPEED`].
pub(crate) const CAUGHT_SHARE: f32 = 0.35;

/// Reduction of the landing error that justifies a step that is one second shorter, m/s.
///
/// Larger: steps come late. Smaller: steps are hasty. Shown by the tests of `stumble`.
pub(crate) const HURRY: f32 = 0.2;

/// Landing error that is accepted to avoid each metre by which the body exceeds the other foot's reach, dimensionless.
///
/// Larger: steps are short. Smaller: the character does the splits. Shown by the tests of `stumble`.
pub(crate) const STRAIN_COST: f32 = 3.0;

/// Landing error above which a swinging foot is put down and the other foot steps, as a share of body height.
///
/// Larger: steps do not catch the character. Smaller: the character takes many tiny steps. Shown by the tests of
/// `stumble`.
pub(crate) const HOPELESS: f32 = 0.04;

/// Step length at which a foot reaches the full [`LIFT`], metres.
///
/// Larger: feet drag. Smaller: short steps look like marching. Shown by the tests of `stumble`.
pub(crate) const WIDE_STEP: f32 = 0.2;

/// Rate at which a caught character approaches its requested velocity, 1/s.
///
/// Larger: the character jerks. Smaller: it drifts. Shown by the tests of `stumble`.
pub(crate) const RESUMES: f32 = 10.0;

/// Rise of an ankle over its standing height above which the foot is in the air, metres.
///
/// Larger: hopping counts as standing. Smaller: rough ground counts as air. Shown by the tests of `stumble`.
pub(crate) const AIRBORNE: f32 = 0.04;

/// Time without ground after which the character has no ground to step on, seconds.
///
/// Larger: the character steps in the air. Smaller: a kerb makes it fall. Shown by the tests of `stumble`.
pub(crate) const FLIES_AFTER: f32 = 0.15;

/// Largest height difference of the ground that a step may cover, metres.
///
/// Larger: the character steps onto tables. Smaller: stairs make it fall. Shown by the tests of `stumble`.
pub(crate) const STEP_RANGE: f32 = 0.4;

// character/stumble/step.rs

/// Time in which a swinging foot that must stop is put down, seconds.
///
/// Larger: the character falls meanwhile. Smaller: the foot stamps. Shown by the tests of `stumble`.
pub(crate) const DROP_TIME: f32 = 0.1;

/// Time of a step of a steady walk, seconds.
///
/// Larger: steps are long. Smaller: the character takes many tiny steps. Shown by the tests of `stumble`.
pub(crate) const STRIDE_TIME: f32 = 0.28;

/// Least lateral distance of the feet, as a share of body height.
///
/// Larger: the character straddles. Smaller: feet cross. Shown by the tests of `stumble`.
pub(crate) const FEET_APART: f32 = 0.08;

/// Largest horizontal distance of a foot from the body, as a share of body height.
///
/// Larger: the character does the splits. Smaller: it falls where a step would catch it. Shown by the tests of
/// `stumble`.
pub(crate) const STEP_REACH: f32 = 0.3;

/// Largest mean speed of a foot, divided by body height, 1/s: a quick step of a person takes 0.2 s for 0.6 m.
///
/// Larger: feet move too fast to see. Smaller: the character falls where a step would catch it. Shown by the tests of
/// `stumble`.
pub(crate) const FOOT_SPEED: f32 = 1.7;

/// Lateral distance of a foot from the capture point, as a share of body height.
///
/// Larger: the character sways from side to side. Smaller: it tips over its own foot. Shown by the tests of `stumble`.
pub(crate) const STEP_OUT: f32 = 0.015;

/// Distance of the foot's goal ahead of the body that brakes it, as a multiple of the excess velocity divided by the
/// pendulum's frequency; 1 places the foot on the capture point.
///
/// Larger: the character swings back. Smaller: it takes longer to stop, and at 1 or below it never stops. Shown by the
/// tests of `stumble`.
pub(crate) const BRAKES: f32 = 1.5;

// character/travel.rs

/// Distance between the start and the end of a clip below which the clip counts as in place, metres.
///
/// Larger: slow walks stay in place. Smaller: idle clips creep. Shown by the tests of `travel`.
pub(crate) const STAYS_WITHIN: f32 = 0.02;

/// Rotation between the start and the end of a clip below which the clip counts as in place, radians.
///
/// As [`STAYS_WITHIN`].
pub(crate) const STAYS_TURNED: f32 = 0.02;

/// Rotation of a clip from its start to its end below which its path counts as straight, radians.
///
/// Larger: wide circles become lines. Smaller: rounding moves the centre of a circle. Shown by the tests of `travel`.
pub(crate) const STRAIGHT: f32 = 1e-4;

// character/gait.rs

/// Rate at which the height difference from the mover decays after a stair step, 1/s; it disappears in a few frames.
///
/// Larger: the character jerks. Smaller: its feet sink into the steps. Shown by the tests of `in_world`.
pub(crate) const STEP_SETTLES: f32 = 14.0;

/// Largest height difference of a shown character from its mover, metres.
///
/// Larger: the character floats after a drop. Smaller: the character jerks at high steps. Shown by the tests of
/// `in_world`.
pub(crate) const MOST_BESIDE: f32 = 0.4;

/// Largest horizontal distance of a shown character from its mover, metres. A mover that begins inside a crate leaves
/// the crate within one step of the world.
///
/// Larger: the character stays inside an obstacle that its mover has left. Smaller: it jumps with its mover. Shown by
/// the scene `brawl`.
pub(crate) const MOST_ASIDE: f32 = 0.8;

/// Extra speed up to which a mover that is pushed aside takes its character along immediately, m/s; the character
/// follows the rest later.
///
/// Larger: the character jumps aside. Smaller: it overlaps the pushing body. Shown by the tests of `in_world`.
pub(crate) const PUSHED_ASIDE: f32 = 1.5;

/// Slope of the ground, rise over run, from which the ground counts as a step.
///
/// Larger: the character jerks at steps. Smaller: slopes are smoothed, and feet sink in. Shown by the tests of
/// `in_world`.
pub(crate) const STEP_SLOPE: f32 = 1.2;

/// Rate at which the pace of the looped clip follows the character's speed, 1/s.
///
/// Larger: legs jerk. Smaller: feet slide. Shown by the tests of `in_world`.
pub(crate) const PACE_RATE: f32 = 10.0;

/// Speed below which a character starts to blend from the looped clip to idling, m/s.
///
/// Larger: slow walks slide. Smaller: it walks on the spot. Shown by the tests of `in_world`.
pub(crate) const STANDS_BELOW: f32 = 0.35;

/// Longest crossfade between the looped clip and idling, seconds.
///
/// Larger: a starting character slides. Smaller: limbs are flung to the other clip and kick nearby bodies. Shown by the
/// tests of `in_world`.
pub(crate) const STANDS_IN: f32 = 0.2;

/// Largest acceleration of a character on its own feet, m/s²; beyond it, shoes would slip.
///
/// Larger: starts look weightless. Smaller: the character reacts late. Shown by the tests of `in_world`.
pub(crate) const PICKS_UP: f32 = 5.0;

/// Largest number of locomotion clips of a character, with walk and run.
///
/// Larger: more weights are kept on the stack. Smaller: faster clips are left out. Shown by the tests of `paces`.
pub(crate) const MOST_PACES: usize = 8;

/// Largest playing speed of a clip, as a multiple of the clip's own speed.
///
/// Larger: legs move too fast to be plausible. Smaller: feet slide. Shown by the tests of `in_world`.
pub(crate) const FASTEST_PACE: f32 = 2.0;

// character/floor.rs

/// Distance of a clip's lowest drawn point from the floor of the rest pose above which the clip has its own floor, as a
/// share of the character's height.
///
/// Larger: characters float or sink by up to this share. Smaller: a toe that dips in raises the whole character.
/// Shown by the tests of `floors`.
pub(crate) const OWN_FLOOR: f32 = 0.03;

/// Penetration of a static shape from which a character that goes limp is moved out, metres.
///
/// Contacts push out half of it in 0.5 s. Larger: limbs stay in walls for seconds. Smaller: a foot that a clip puts
/// into a stair lifts the whole character. Shown by the tests of `clear`.
pub(super) const DEEP: f32 = 0.1;

/// Speed at which the character is moved out, m/s.
///
/// Larger: the character jumps. Smaller: it floats for longer. Shown by the tests of `clear`.
pub(super) const CLEARING_SPEED: f32 = 1.9;

/// Largest distance by which the character is moved out, metres.
///
/// Larger: a character inside a hill is lifted out of it. Smaller: it stays in a thick wall. Shown by the tests of
/// `clear`.
pub(super) const CLEARING_REACH: f32 = 1.2;

/// Largest number of static shapes that the character is moved out of in sequence.
///
/// Floor, two walls of a corner, and one more. Larger: more queries if no direction leads out. Smaller: corners are not
/// left. Shown by the tests of `clear`.
pub(super) const MOST_OBSTACLES: usize = 4;

/// Cosine of the angle, 11°, below which two directions out of a shape count as one.
///
/// Larger: more queries are made. Smaller: a slanted side of a hull gets its neighbour's direction. Shown by the tests
/// of `clear`.
pub(super) const SAME_WAY: f32 = 0.98;
