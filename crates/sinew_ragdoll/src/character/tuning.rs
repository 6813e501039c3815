//! Tunable constants of characters: animated, limp, getting up, stumbling.
//!
//! Each has its unit, the effect of a larger and a smaller value, and the tests (`crates/sinew_ragdoll/tests/it`) that
//! show it; effects without a figure are estimates.

// character/animate.rs

/// Largest speed at which the height of a character's origin follows the ground, m/s: a stair step takes a few frames.
///
/// Larger: it jerks up a stair. Smaller: it wades in the steps. Shown by the tests of `slopes`.
pub(crate) const CLIMB_SPEED: f32 = 1.2;

// character/blows.rs

/// Time for which a struck limb is weak, seconds.
///
/// Larger: it hangs. Smaller: a blow is not visible. Shown by the tests of `blows`.
pub(crate) const FLINCH_TIME: f32 = 0.12;

/// Half-life of a struck limb's return, seconds.
///
/// Larger: it floats home. Smaller: it snaps. Shown by the tests of `blows`.
pub(crate) const FLINCH_HALF_LIFE: f32 = 0.08;

/// Largest share of their strength, 0 to 1, that a blow takes from the legs of a stepping character.
///
/// Larger: it kneels before its foot is down. Smaller: legs like poles. Shown by the tests of `stumble`.
pub(crate) const LEGS_WEAKEN: f32 = 0.2;

/// Speed at which a led body yields to slow, hard pressure, m/s; faster only to faster bodies.
///
/// Larger: treading on a body kicks it. Smaller: a foot stays pressed on a trodden body. Shown by the tests of `grab`.
pub(crate) const GIVES_WAY: f32 = 3.0;

/// Fastest speed that [`hit`](super::Character::hit) gives the struck body alone, m/s; the rest of the blow goes up its chain.
///
/// A fist or foot strikes at 8 to 12 m/s. Larger: a strong blow flings a hand away. Smaller: weak blows move trunks. Shown by `brawl`.
pub(crate) const HIT_SPEED: f32 = 12.0;

/// Ratio of the blow that fells a character still near the ground to the one that fells a standing one.
///
/// Larger: nothing stops a get-up. Smaller: in a crowd few come to stand. Shown by the tests of `blows`.
pub(crate) const LOW_STANDS: f32 = 2.5;

/// Largest share of its strength, 0 to 1, that a blow takes from the trunk of a stepping character.
///
/// Larger: it folds. Smaller: it steps like a board. Shown by the tests of `stumble`.
pub(crate) const TRUNK_WEAKENS: f32 = 0.5;

/// Number of half-lives after which a limb follows the clips again.
///
/// Larger: it counts as flinching for longer. Smaller: it jumps at the end. Shown by the tests of `blows`.
pub(crate) const RETURNED_AFTER: f32 = 6.0;

// character/detach.rs

/// Height of detached bodies for springs that collide with the body, metres, world: where nothing is.
///
/// Larger: springs may meet it. Smaller: only rounding. Shown by the tests of `detach`.
pub(crate) const FAR_BELOW: f32 = -1e6;

// character/grasp.rs

/// Gap of a grip below which it has no direction, metres.
///
/// Larger: the axes of the grip stay while it already slips. Smaller: they follow noise. Shown by the tests of `grab`.
pub(crate) const LEAST_GAP: f32 = 1e-4;

/// Cosine between a grip's pull and the diagonal of its axes below which the axes are aligned again.
///
/// Larger: they are aligned all the time. Smaller: it pulls with less than its force. Shown by the tests of `grab`.
pub(crate) const LEAST_ALONG: f32 = 0.98;

/// Stretch of a grip at its full force, metres.
///
/// Larger: held bodies hang away from the hand. Smaller: it jerks. Shown by the tests of `grab`.
pub(crate) const GRIP_STRETCH: f32 = 0.01;

/// Share of a grip's force that its motor uses, 0 to 1: contacts and stops of joints add to it within a substep.
///
/// Larger: a grip pulls visibly harder than allowed. Smaller: it lets go too early. Shown by the tests of `grab`.
pub(crate) const GRIP_SHARE: f32 = 0.9;

// character/rises.rs

/// Distance between the points of a part below which the ground is sought, as a share of the height.
///
/// Larger: a hand over the edge of a step sinks into it. Smaller: more rays. Shown by `brawl`.
pub(crate) const PROBES_APART: f32 = 0.08;

/// Largest speed at which the end of a limb moves out of a wall, relative to its clip, m/s.
///
/// Larger: hands snap back at corners. Smaller: they enter walls. Shown by `brawl`.
pub(crate) const PULLED_BACK: f32 = 2.5;

/// Speed at which the end of a limb returns to its clip beside a wall, m/s.
///
/// Larger: hands snap over edges. Smaller: they lag behind the clip. Shown by `brawl`.
pub(crate) const RETURNS: f32 = 1.0;

/// Natural frequency with which the parts of a rising character follow the ground, critically damped, rad/s.
///
/// Larger: hands jerk over edges. Smaller: they pass through them. Shown by `brawl`.
pub(crate) const PART_QUICKNESS: f32 = 12.0;

// character/grab.rs

/// Distance between the bounds of two characters from which they collide again after a release, metres, twice.
///
/// Larger: they pass through each other for longer. Smaller: feet kick the released one. Shown by the tests of `grab`.
pub(crate) const PARTED: f32 = 0.05;

// character/feet.rs

/// Natural frequency with which feet follow the ground, critically damped, rad/s: a stair step asks as much of a leg as
/// a transition within 0.2 s.
///
/// Larger: legs jerk. Smaller: feet sink in and float. Shown by the tests of `slopes`.
pub(crate) const FEET_QUICKNESS: f32 = 12.0;

/// Largest height difference of the ground for a foot to stand on it, metres.
///
/// Larger: legs reach into holes. Smaller: feet hang over steps. Shown by the tests of `slopes`.
pub(crate) const FOOT_RANGE: f32 = 0.32;

/// Distance up or down below which ground is the floor of the clip, metres.
///
/// Larger: feet off the ground. Smaller: noise of meshes moves legs. Shown by the tests of `slopes`.
pub(crate) const FOOT_FLOOR: f32 = 2e-3;

/// Height and speed below which a foot counts as back, metres and m/s.
///
/// Larger: it jumps at the end. Smaller: work for nothing. Shown by the tests of `pops`.
pub(crate) const FOOT_HOME: f32 = 1e-5;

/// Ratio of the times for standing up and for planting the feet.
///
/// Larger: feet jerk. Smaller: they slide while it rises. Shown by the tests of `slopes`.
pub(crate) const PLANTED_SOONER: f32 = 2.0;

/// Rise or fall of ground along a foot, a slope, from which on it is an edge.
///
/// Larger: feet tilt on edges. Smaller: they are level on slopes. Shown by the tests of `slopes`.
pub(crate) const FOOT_EDGE: f32 = 0.6;

/// Largest tilt of a foot, radians.
///
/// Larger: broken ankles. Smaller: feet in steep ground. Shown by the tests of `slopes`.
pub(crate) const MOST_TILT: f32 = 0.6;

/// Largest turning speed of a powered character, rad/s: its muscles and pins can follow it. A person turns round on the
/// spot within a second.
///
/// Larger: it twists and falls over its own legs. Smaller: it turns slowly. Shown by the scene `brawl`.
pub(crate) const POWERED_TURNS: f32 = 3.5;

/// Natural frequency with which a walking foot follows edges, critically damped, rad/s: within the half swing in which
/// it sees them.
///
/// Larger: feet jerk over edges. Smaller: they float when they come down. Shown by the tests of `feet`.
pub(crate) const TREAD_QUICKNESS: f32 = 25.0;

/// Time by which a foot in the air looks ahead at its speed, seconds: it comes down there, since it slows down evenly
/// in the second half of its swing.
///
/// Larger: it is raised for the step after. Smaller: it sees edges late. Shown by the tests of `feet`.
pub(crate) const LOOKS_AHEAD: f32 = 0.12;

/// Heights of its lower end over the clip's floor, over body height, from which a foot looks ahead at all, and fully: a
/// foot about to come down does not get far.
///
/// Larger: edges are seen late. Smaller: it comes down on the step after. Shown by the tests of `feet`.
pub(crate) const LANDS: [f32; 2] = [0.006, 0.017];

/// Component along up of a surface normal below which it is a wall for toes.
///
/// Larger: they draw back from slopes. Smaller: they go into steep ones. Shown by the tests of `feet`.
pub(crate) const STEEPEST_TREAD: f32 = 0.5;

/// Height over the ground from which an obstacle in front of a foot counts as a wall, metres.
///
/// Larger: toes in low kerbs. Smaller: they draw back from slopes. Shown by the tests of `feet`.
pub(crate) const TOES_OVER: f32 = 0.06;

/// Distance that toes and heel keep from a wall where a foot comes down, metres: foot shapes are slightly smaller than
/// the drawn feet.
///
/// Larger: feet come down beside their clips. Smaller: toes in walls. Shown by the tests of `feet`.
pub(crate) const TOES_CLEAR: f32 = 0.02;

/// Largest drop of the ground for a walking foot, over body height: a mover is up a stair by its radius before the
/// foot.
///
/// Larger: legs reach into holes. Smaller: feet hang over steps. Shown by the tests of `feet`.
pub(crate) const TREAD_RANGE: f32 = 0.34;

/// Height of its lower end over the clip's floor below which a foot stands, over body height.
///
/// Larger: feet stick in a swing. Smaller: they slide. Shown by the tests of `feet`.
pub(crate) const STANCE_HEIGHT: f32 = 0.015;

/// Speed over the ground of a clip's foot below which it stands, m/s.
///
/// Larger: feet stick in a swing. Smaller: they slide with the clip. Shown by the tests of `feet`.
pub(crate) const STANCE_SPEED: f32 = 0.8;

/// Rate at which a foot in the air returns to its clip, 1/s.
///
/// Larger: it flicks. Smaller: it lands beside its target. Shown by the tests of `feet`.
pub(crate) const RELEASES: f32 = 12.0;

/// Offset of a foot that is not corrected, metres: a mover's speed lags the clips' by a step.
///
/// Larger: feet slide. Smaller: legs tremble. Shown by the tests of `feet`.
pub(crate) const SMALL_WAY: f32 = 4e-3;

/// Least mass of a dynamic body that is ground, over that of the character.
///
/// Larger: feet pass through crates. Smaller: they step onto crates they should kick. Shown by the tests of `in_world`.
pub(crate) const LEAST_TREAD: f32 = 0.05;

/// Largest distance of a planted foot from its clip, over body height.
///
/// Larger: twisted legs. Smaller: feet slide. Shown by the tests of `feet`.
pub(crate) const MOST_ASTRAY: f32 = 0.07;

/// Depth of a sole in the ground from which on it is raised at once, metres.
///
/// Larger: it sinks in. Smaller: it jerks over noise. Shown by the tests of `feet`.
pub(crate) const SOLE_SINKS: f32 = 0.01;

/// Speed at which a sole rises out of the ground, m/s.
///
/// Larger: it jerks over late edges. Smaller: it passes through them. Shown by the tests of `feet`.
pub(crate) const RISES: f32 = 5.0;

/// Time without ground after which feet are no longer planted, seconds.
///
/// Larger: feet stick to the ground in a jump. Smaller: they let go at each kerb. Shown by the tests of `feet`.
pub(crate) const OFF_GROUND: f32 = 0.1;

/// Height above a foot from which the ground is sought, metres.
///
/// Larger: a table over it counts as ground. Smaller: steps are seen late. Shown by the tests of `slopes`.
pub(crate) const FOOT_SEARCH: f32 = 0.5;

/// Speed from which on a character has its feet where its clips have them, m/s.
///
/// Larger: feet stick while walking. Smaller: they slide while standing. Shown by the tests of `slopes`.
pub(crate) const WALKS_FROM: f32 = 0.3;

/// Position of the ball in front of an ankle without toes, in leg lengths.
///
/// As that of the animations. Shown by the tests of `slopes`.
pub(crate) const BALL_AHEAD: f32 = 0.14;

// character/clearance.rs

/// Least level distance of the pelvis from its place in the rest pose at which a clip begins away from its origin, as a
/// share of the character's height.
///
/// Larger: a capture walks beside the ground that bears it. Smaller: a lunge is pulled back. Shown by the tests of
/// `travel`.
pub(crate) const OFF_ORIGIN: f32 = 0.3;

/// Largest lift of a body part out of the floor, as a share of the character's height.
///
/// Larger: it hovers where the skin of a limb is far from it. Smaller: limbs in the floor. Shown by the tests of `rising`.
pub(crate) const MOST_LIFT: f32 = 0.25;

/// Depth in the floor of the skin of feet, hands and elbows for which a clip to get up by is not bent, as a share of the character's height.
///
/// Larger: fingers in the floor. Smaller: soles over it. Shown by the tests of `motions`.
pub(crate) const LIMBS_SINK: f32 = 0.003;

/// Height of a foot's step toward a clip, over its length, and the largest as a share of the character's height.
///
/// Larger: it stamps. Smaller: feet slide. Shown by the tests of `rising`.
pub(crate) const STEP_OVER: f32 = 0.6;
/// See [`STEP_OVER`].
pub(crate) const STEP_HEIGHT: f32 = 0.05;

/// Cosine of the largest tilt of a foot from which it steps to where a clip has it.
///
/// Larger: feet slide. Smaller: lying legs kick. Shown by the tests of `rising`.
pub(crate) const STEPS_FROM: f32 = 0.0;

/// Share of a step, at each end, in which the foot only moves up or down.
///
/// Larger: it jerks in between. Smaller: it slides. Shown by the tests of `rising`.
pub(crate) const STRAIGHT_UP: f32 = 0.22;

// character/grab.rs

/// Distance by which a held limb is drawn from its clip before its character follows, over body height.
///
/// Larger: it leans out before it steps. Smaller: it creeps after a hand that only touches. Shown by the tests of `held`.
pub(crate) const PULL_SLACK: f32 = 0.03;

/// Upward speed at which a standing character leaves the ground, m/s.
///
/// Larger: an updraft lifts it late, and feet stick in a jump. Smaller: its mover finds the ground again. Shown by the tests of `blown`.
pub(crate) const LIFTS_OFF: f32 = 0.5;

/// Rate at which a character follows a held limb beyond [`PULL_SLACK`], 1/s.
///
/// Larger: it jerks. Smaller: a slow pull fells it. Shown by the tests of `held`.
pub(crate) const PULL_RATE: f32 = 6.0;

/// Largest speed at which it follows a held limb, m/s.
///
/// Larger: it is dragged on its feet faster than it can walk. Smaller: a walker who holds it fells it. Shown by the tests
/// of `held`.
pub(crate) const PULL_SPEED: f32 = 2.0;

/// Distance of a held limb from its clip at which its character falls, over body height: an arm is out of reach.
///
/// Larger: joints are torn. Smaller: a pull fells it at once. Shown by the tests of `held`.
pub(crate) const PULL_FELLS: f32 = 0.3;

// character/get_up.rs

/// Height of a pelvis over the ground up to which a body lies on it, over body height.
///
/// Larger: carried bodies get up in the air. Smaller: who lies on others waits. Shown by the tests of `held`.
pub(crate) const LIES_LOW: f32 = 0.3;

/// Share of its weight that the static world bears of a body that lies over an edge or a rail, from which it gets up.
///
/// Larger: it stays on rails. Smaller: a carried body whose foot drags gets up. Shown by the tests of `held`.
pub(crate) const BORNE: f32 = 0.5;

/// Time in which the bodies' pose dies away in a get-up clip, seconds.
///
/// Larger: limbs through the floor. Smaller: a jerk. Shown by the tests of `pops`.
pub(crate) const INTO_GET_UP: f32 = 0.35;

/// Time in which the bodies' pose dies away in the looped clip, without one to get up by, seconds.
///
/// Larger: it floats up. Smaller: it jumps up. Shown by the tests of `pops`.
pub(crate) const INTO_STANDING: f32 = 0.8;

/// Time in which the end of a get-up clip dies away in the looped one, seconds.
///
/// Larger: feet slide. Smaller: a jerk. Shown by the tests of `pops`.
pub(crate) const INTO_LOOP: f32 = 0.3;

/// Share of a get-up clip, to its end, in which a body that lay on a slope comes upright, 0 to 1.
///
/// Larger: hands leave the ground. Smaller: it swings upright. Shown by the tests of `slopes`.
pub(crate) const STRAIGHTENS: f32 = 0.6;

/// Net load from others under which a lying body does not get up, as a share of its own weight: half of an arm.
///
/// Larger: it gets up under another's limb and throws it off. Smaller: it waits for someone who only leans on it.
/// Shown by `in_world::upper_of_two_fallen_characters_gets_up_first`.
pub(crate) const BEARS: f32 = 0.02;

/// Upward component of the normal toward a kinematic body above which that stands on the lying one, a cosine: 17° from
/// level.
///
/// Larger: a body kneeling on it is lifted. Smaller: it waits for a lift beside it. Shown as [`BEARS`].
pub(crate) const ON_TOP: f32 = 0.3;

/// Time after its fall for which a body waits for such a load to go, seconds.
///
/// Larger: it lies long under a crate that nobody removes. Smaller: it throws off slow ones. Shown as [`BEARS`].
pub(crate) const BEARS_FOR: f32 = 5.0;

/// Height of a mover over a lying body, as a share of its own.
///
/// Larger: it does not fit under obstacles above. Shown by the tests of `in_world`.
pub(crate) const LYING_MOVER: f32 = 0.0;

/// Height above the pelvis from which the ground is sought, metres.
///
/// Larger: objects above it count as ground. Smaller: a pelvis sunk in a slope finds none. Shown by the tests of
/// `slopes`.
pub(crate) const ABOVE_PELVIS: f32 = 0.3;

// character/ground.rs

/// Highest step that a walking character climbs, metres.
///
/// Larger: it climbs tables. Smaller: it stops at stairs. Shown by the tests of `travel`.
pub(crate) const HIGHEST_STEP: f32 = 0.45;

/// Depth down to which the ground is sought, metres.
///
/// Larger: slower over holes. Smaller: high bodies have no ground. Shown by the tests of `character`.
pub(crate) const GROUND_DEPTH: f32 = 100.0;

/// Depth under a pelvis to which the supporting ground is searched, metres.
///
/// Larger: a body over an edge gets up on the floor below. Smaller: large figures find no support. Shown by the tests
/// of `slopes`.
pub(crate) const LIES_ON: f32 = 1.0;

/// Height above a point of a lying body from which the ground is searched, metres.
///
/// As [`ABOVE_PELVIS`].
pub(crate) const LYING_SEARCH: f32 = 0.3;

/// Slope from which on steeper ground counts as if it were not, radians.
///
/// Larger: a character gets up leaning. Smaller: it gets up through the ground. Shown by the tests of `slopes`.
pub(crate) const STEEPEST_GROUND: f32 = 0.6;

/// Slope below which ground counts as level, radians.
///
/// Larger: feet off gentle slopes. Smaller: needless work. Shown by the tests of `slopes`.
pub(crate) const LEVEL_GROUND: f32 = 0.02;

// character/hit_bodies.rs

/// Displacement of a body within a step from which it counts as teleported, metres.
///
/// Larger: teleported bodies strike everything on their way. Smaller: fast bodies strike nothing. Shown by the tests of
/// `in_world`.
pub(crate) const TELEPORTED: f32 = 1.0;

// character/in_world.rs

/// Speed that a felling blow gives to the whole character, m/s.
///
/// Larger: it withstands more. Smaller: a touch fells it. Shown by the tests of `in_world`.
pub(crate) const FELLING_SPEED: f32 = 0.6;

/// Radius of a mover over its height.
///
/// Larger: it does not fit through doors. Smaller: arms in walls. Shown by the tests of `in_world`.
pub(crate) const MOVER_RADIUS: f32 = 0.17;

// character/limp.rs

/// Time between the predicted poses for hand-over velocities, seconds: short against any motion, long against rounding.
///
/// Larger: speeds of the next step. Smaller: noise. Shown by the tests of `hand_over`.
pub(crate) const HAND_OVER_TIME: f32 = 1.0 / 1000.0;

/// Rate at which the place of a limp character approaches the point under its pelvis, beside moving with it, 1/s.
///
/// Larger: it jumps where a fall begins. Smaller: a camera looks beside the body. Shown by the tests of `held`.
pub(crate) const PLACE_FOLLOWS: f32 = 8.0;

/// Distance below which that place stays, metres: a body at rest keeps its pose.
///
/// Larger: it stays beside the body. Smaller: the pose of a resting body is computed in every step. Shown by the tests of
/// `held`.
pub(crate) const PLACE_RESTS: f32 = 1e-4;

/// Time in which joints without bodies come to rest, seconds.
///
/// Larger: fingers keep moving on a lying body. Smaller: they freeze. Shown by the tests of `pops`.
pub(crate) const LINGERS: f32 = 0.25;

/// Time in which joints take on the friction of a limp body, seconds.
///
/// Larger: it falls like water. Smaller: joints jerk at the hand-over. Shown by the tests of `hand_over`.
pub(crate) const SLACKENS: f32 = 0.2;

/// Speed below which a body lies still, m/s: 2 cm/s by the contract.
///
/// Larger: it gets up while it slides. Smaller: it waits. Shown by the tests of `character`.
pub(crate) const STILL_LINEAR: f32 = 0.02;

/// Angular speed below which a body lies still, rad/s: by the contract.
///
/// As [`STILL_LINEAR`].
pub(crate) const STILL_ANGULAR: f32 = 0.05;

/// Time that all bodies must be still, seconds: by the contract.
///
/// Larger: it waits. Smaller: it gets up at a turning point. Shown by the tests of `character`.
pub(crate) const STILL_TIME: f32 = 0.5;

/// Penetration above which a body does not lie yet, metres: it is still pushed out, without a velocity of its own.
///
/// Larger: stuck bodies count as at rest. Smaller: bodies resting within the slop do not. Shown by the tests of
/// `falls`.
pub(crate) const SUNK: f32 = 5e-3;

// character/mirror.rs

/// Largest distance of a joint from the mirror image of its counterpart in the bind pose, as a share of the body's height.
///
/// Larger: mirrored clips look askew. Smaller: no clip is mirrored. Shown by the tests of `character`.
pub(crate) const MIRROR_TOLERANCE: f32 = 0.03;

/// Distance from its rest place beyond which a joint counts as translated, as a share of its distance from its parent.
///
/// Larger: sliding joints stay behind in mirrored clips. Smaller: rounding counts. Shown by the tests of `character`.
pub(crate) const MOVED: f32 = 1e-3;

// character/moves.rs

/// Share of a get-up clip in which it may begin, 0 to 1.
///
/// Larger: it may begin nearly upright. Smaller: a sitting body lies down first. Shown by the tests of `character`.
pub(crate) const MAY_BEGIN: f32 = 0.4;

/// Time between the moments at which a get-up clip may begin, seconds.
///
/// Larger: worse matches. Smaller: slower. Shown by the tests of `character`.
pub(crate) const STARTS_APART: f32 = 1.0 / 15.0;

/// Time between the poses of a clip whose root motion is moved to the pelvis, seconds.
///
/// Larger: steps are cut short. Smaller: larger clips. Shown by the tests of `travel`.
pub(crate) const ROOT_FRAME: f64 = 1.0 / 60.0;

/// Time between the poses of a mirrored clip, seconds: getting up is slow.
///
/// As [`ROOT_FRAME`].
pub(crate) const MIRRORED_FRAME: f64 = 1.0 / 30.0;

// character/pose_similarity.rs

/// Weight of a stick's end that shows how the trunk is turned, over the mean body's share of the mass.
///
/// Larger: limbs count for nothing. Smaller: it gets up from its back by the clip for its belly. Shown by the tests of `character`.
pub(crate) const STICK_WEIGHT: f32 = 1.5;

/// Length of a stick that shows how the trunk is turned, over the height of the body.
///
/// As [`STICK_WEIGHT`].
pub(crate) const STICK: f32 = 0.2;

// character/powered.rs

/// Largest force of the pin of a powered body, over its weight.
///
/// Larger: puppets on strings. Smaller: arms lag. Shown by the tests of `lives`.
pub(crate) const PIN_HELPS: f32 = 1.0;

/// Largest force of the pin of a powered leg, over its weight: feet would drag.
///
/// Larger: feet push obstacles. Smaller: they drag. Shown by the tests of `lives`.
pub(crate) const PIN_STEPS: f32 = 4.0;

/// Largest force of a powered pelvis' pin, over the total weight.
///
/// Larger: nothing fells it. Smaller: it sags. Shown by the tests of `lives`.
pub(crate) const PIN_BEARS: f32 = 1.0;

/// Largest torque of a powered pelvis' pin over the total weight, metres.
///
/// Larger: nothing tips it. Smaller: it leans. Shown by the tests of `lives`.
pub(crate) const PIN_TURNS: f32 = 0.3;

/// Half-life of a powered body's return to the clips, seconds.
///
/// Larger: it floats home. Smaller: it snaps. Shown by the tests of `lives`.
pub(crate) const POWERED_HALF_LIFE: f32 = 0.1;

/// Distance of a powered pelvis from its clips', over its height, beyond which the character falls.
///
/// Larger: it is dragged along. Smaller: a push fells it. Shown by the tests of `lives`.
pub(crate) const FALLS_BEYOND: f32 = 0.3;

/// Rotation of a powered pelvis from its clips' beyond which the character falls, radians.
///
/// As [`FALLS_BEYOND`].
pub(crate) const FALLS_TURNED: f32 = 1.0;

// character/prepare.rs

/// Time to drive a body to the start of a get-up clip if its trunk must be rolled over, seconds.
///
/// Larger: it lies for long. Smaller: it is thrown over. Shown by the tests of `character`.
pub(crate) const TIME_TO_ROLL: f32 = 1.5;

/// Time to drive a body to the start of a get-up clip if its trunk lies right, seconds.
///
/// As [`TIME_TO_ROLL`].
pub(crate) const TIME_TO_PULL: f32 = 0.5;

/// Time until half of the rolling strength is reached, seconds.
///
/// Larger: slow rolls. Smaller: a jerk. Shown by the tests of `character`.
pub(crate) const PREPARES_HALF_LIFE: f32 = 0.1;

/// Frequency of the pin that rolls a trunk over, Hz.
///
/// Larger: it flips. Smaller: it does not finish in time. Shown by the tests of `character`.
pub(crate) const ROLL_HERTZ: f32 = 2.0;

/// Largest rolling torque on each part of the trunk, over weight times height: 90 N·m for a man.
///
/// Larger: it throws off its load. Smaller: it stays lying. Shown by the tests of `character`.
pub(crate) const ROLL_STRENGTH: f32 = 0.07;

// character/stumble/mod.rs

/// Time of a step that only returns a foot, seconds.
///
/// Larger: slow. Smaller: feet snap. Shown by the tests of `stumble`.
pub(crate) const HOME_TIME: f32 = 0.25;

/// Share of a step until which its goal may change, 0 to 1.
///
/// Larger: feet dart aside at the end. Smaller: they land at the first prediction. Shown by the tests of `stumble`.
pub(crate) const AIMS_UNTIL: f32 = 0.7;

/// Height of a step over that of the body.
///
/// Larger: marches. Smaller: feet drag. Shown by the tests of `stumble`.
pub(crate) const LIFT: f32 = 0.05;

/// Half the width of a sole over the height of the body.
///
/// Larger: it balances on edges. Smaller: steps for nothing. Shown by the tests of `stumble`.
pub(crate) const SOLE_RIM: f32 = 0.023;

/// Farthest that the pelvis is lowered over the height of the body.
///
/// Larger: squats. Smaller: feet do not reach. Shown by the tests of `stumble`.
pub(crate) const PELVIS_SINKS: f32 = 0.12;

/// Distance of a capture point from the feet that triggers a step, metres.
///
/// Larger: it falls before it steps. Smaller: it steps for nothing. Shown by the tests of `stumble`.
pub(crate) const CAPTURE_MARGIN: f32 = 0.01;

/// Distance of a capture point from the feet that triggers the first step without a reported push, metres.
///
/// As [`CAPTURE_MARGIN`].
pub(crate) const UNTOLD_MARGIN: f32 = 0.08;

/// Velocity error at which a character counts as caught, m/s.
///
/// Larger: it stands still while it sways. Smaller: it steps on. Shown by the tests of `stumble`.
pub(crate) const CAUGHT_SPEED: f32 = 0.15;

/// Additional velocity error of a caught character, as a share of its requested velocity, 0 to 1.
///
/// As [`CAUGHT_SPEED`].
pub(crate) const CAUGHT_SHARE: f32 = 0.35;

/// Landing error traded for a second less of step time, metres per second.
///
/// Larger: hasty steps. Smaller: late ones. Shown by the tests of `stumble`.
pub(crate) const HURRY: f32 = 0.2;

/// Landing error traded for a metre less of reach beyond the standing foot, a ratio.
///
/// Larger: short steps. Smaller: splits. Shown by the tests of `stumble`.
pub(crate) const STRAIN_COST: f32 = 3.0;

/// Landing error at which a swinging foot is put down for the other to step, over body height.
///
/// Larger: steps that do not catch. Smaller: feet patter. Shown by the tests of `stumble`.
pub(crate) const HOPELESS: f32 = 0.04;

/// Step length at which a foot reaches the full [`LIFT`], metres.
///
/// Larger: feet drag. Smaller: short steps march. Shown by the tests of `stumble`.
pub(crate) const WIDE_STEP: f32 = 0.2;

/// Rate at which a caught character approaches its requested velocity, 1/s.
///
/// Larger: a jerk. Smaller: it drifts. Shown by the tests of `stumble`.
pub(crate) const RESUMES: f32 = 10.0;

/// Height of an ankle above its height on the floor at which a foot is in the air, metres.
///
/// Larger: hopping counts as standing. Smaller: rough ground throws it. Shown by the tests of `stumble`.
pub(crate) const AIRBORNE: f32 = 0.04;

/// Time without ground after which there is nothing to step on, seconds.
///
/// Larger: it steps in the air. Smaller: a kerb fells it. Shown by the tests of `stumble`.
pub(crate) const FLIES_AFTER: f32 = 0.15;

/// Largest height difference of the ground to step on, metres.
///
/// Larger: it steps onto tables. Smaller: stairs fell it. Shown by the tests of `stumble`.
pub(crate) const STEP_RANGE: f32 = 0.4;

// character/stumble/step.rs

/// Time in which a swinging foot is put down at once, seconds.
///
/// Larger: it falls meanwhile. Smaller: a stamp. Shown by the tests of `stumble`.
pub(crate) const DROP_TIME: f32 = 0.1;

/// Time of a step of a steady walk, seconds.
///
/// Larger: long steps. Smaller: feet patter. Shown by the tests of `stumble`.
pub(crate) const STRIDE_TIME: f32 = 0.28;

/// Least lateral distance of the feet, over body height.
///
/// Larger: a straddle. Smaller: feet cross. Shown by the tests of `stumble`.
pub(crate) const FEET_APART: f32 = 0.08;

/// Farthest of a foot from the body, over its height.
///
/// Larger: splits. Smaller: it falls where a step would catch it. Shown by the tests of `stumble`.
pub(crate) const STEP_REACH: f32 = 0.3;

/// Largest mean speed of a foot over body height, 1/s: a quick step of a person takes 0.2 s for 0.6 m.
///
/// Larger: feet flash. Smaller: it falls where a step would catch it. Shown by the tests of `stumble`.
pub(crate) const FOOT_SPEED: f32 = 1.7;

/// Lateral distance of a foot from the capture point, over body height.
///
/// Larger: it sways from side to side. Smaller: it tips over its own foot. Shown by the tests of `stumble`.
pub(crate) const STEP_OUT: f32 = 0.015;

/// Lead of the foot over the capture point for braking, as a factor on the excess velocity over the pendulum's
/// frequency.
///
/// Larger: it swings back. At 1 or below: it never stops. Shown by the tests of `stumble`.
pub(crate) const BRAKES: f32 = 1.5;

// character/travel.rs

/// Distance from its start below which a clip's end counts as in place, metres.
///
/// Larger: slow walks stay. Smaller: idle clips creep. Shown by the tests of `travel`.
pub(crate) const STAYS_WITHIN: f32 = 0.02;

/// Rotation from its start below which a clip's end counts as in place, radians.
///
/// As [`STAYS_WITHIN`].
pub(crate) const STAYS_TURNED: f32 = 0.02;

/// Rotation of a lap below which it goes straight, radians.
///
/// Larger: wide circles are lines. Smaller: the middle of a circle is rounded away. Shown by the tests of `travel`.
pub(crate) const STRAIGHT: f32 = 1e-4;

// character/walk.rs

/// Rate at which the lift of a stair step decays, 1/s: the eye follows within a few frames.
///
/// Larger: it jerks. Smaller: it wades in the steps. Shown by the tests of `in_world`.
pub(crate) const STEP_SETTLES: f32 = 14.0;

/// Farthest that a character is shown from its mover, metres.
///
/// Larger: it floats after a drop. Smaller: high steps jerk. Shown by the tests of `in_world`.
pub(crate) const MOST_BESIDE: f32 = 0.4;

/// Extra speed at which a mover that is pushed aside takes its character along at once, m/s; beyond it the character
/// follows.
///
/// Larger: it jumps aside. Smaller: it overlaps what pushes it. Shown by the tests of `in_world`.
pub(crate) const PUSHED_ASIDE: f32 = 1.5;

/// Slope of the ground, rise over run, from which it is a step.
///
/// Larger: steps jerk. Smaller: slopes are smoothed, and feet sink in. Shown by the tests of `in_world`.
pub(crate) const STEP_SLOPE: f32 = 1.2;

/// Rate at which the pace of the looped clip follows the speed, 1/s.
///
/// Larger: legs jerk. Smaller: feet slide. Shown by the tests of `in_world`.
pub(crate) const PACE_RATE: f32 = 10.0;

/// Speed below which a character begins to stand, m/s.
///
/// Larger: slow walks slide. Smaller: it walks on the spot. Shown by the tests of `in_world`.
pub(crate) const STANDS_BELOW: f32 = 0.35;

/// Longest crossfade between the looped clip and idling, seconds.
///
/// Larger: a starting character slides. Smaller: limbs are flung to the other clip and kick what is near. Shown by the
/// tests of `in_world`.
pub(crate) const STANDS_IN: f32 = 0.2;

/// Acceleration of a character on its own feet, m/s²: shoes slip beyond it.
///
/// Larger: starts without weight. Smaller: it answers late. Shown by the tests of `in_world`.
pub(crate) const PICKS_UP: f32 = 5.0;

/// Most locomotion clips of a character, walk and run among them.
///
/// Larger: more weights on the stack. Smaller: faster clips are left out. Shown by the tests of `paces`.
pub(crate) const MOST_PACES: usize = 8;

/// Largest speed of a clip over its own.
///
/// Larger: legs whirl. Smaller: feet slide. Shown by the tests of `in_world`.
pub(crate) const FASTEST_PACE: f32 = 2.0;

// floor.rs

/// Distance of the lowest drawn point of a clip from the floor of the rest pose from which the clip has its own floor,
/// as a share of the character's height.
///
/// Larger: characters float or sink by as much. Smaller: a toe that dips in raises everything. Shown by the tests of
/// `floors`.
pub(crate) const OWN_FLOOR: f32 = 0.03;

/// Penetration from which a character that goes limp is moved out, metres.
///
/// Contacts push out half of it in 0.5 s. Larger: limbs stay in walls for seconds. Smaller: a foot that a clip puts
/// into a stair lifts the whole figure. Shown by the tests of `clear`.
pub(super) const DEEP: f32 = 0.1;

/// Speed at which it is moved out, m/s.
///
/// Larger: it jumps. Smaller: it floats for longer. Shown by the tests of `clear`.
pub(super) const CLEARING_SPEED: f32 = 1.9;

/// Longest way out, metres.
///
/// Larger: a character in a hill rises out of it. Smaller: it stays in a thick wall. Shown by the tests of `clear`.
pub(super) const CLEARING_REACH: f32 = 1.2;

/// Most static shapes that it is moved out of one after the other, a number.
///
/// Floor, two walls of a corner, and one more. Larger: more queries if no way leads out. Smaller: corners are not left.
/// Shown by the tests of `clear`.
pub(super) const MOST_OBSTACLES: usize = 4;

/// Cosine from which two directions out of a shape count as one.
///
/// 11°. Larger: more queries. Smaller: a slanted side of a hull shares its neighbour's direction. Shown by the tests of
/// `clear`.
pub(super) const SAME_WAY: f32 = 0.98;
