//! Constants of behaviour of characters: animated, limp, getting up, stumbling: numbers that an engineer would turn.
//!
//! Each says its unit and space, what a larger and a smaller one does, and the tests
//! (`crates/sinew_ragdoll/tests/it`) where that is to be seen; consequences without a figure are judgement, not measured.

// character/animate.rs

/// Largest speed at which the height of a character's origin follows the ground, m/s: a step of a stair takes a few frames.
///
/// Larger: it jerks up a stair. Smaller: it wades in the steps. Shown by the tests of `slopes`.
pub(crate) const CLIMB_SPEED: f32 = 1.2;

// character/blows.rs

/// Time for which a limb that was struck gives way, seconds.
///
/// Larger: it hangs. Smaller: a blow is not seen. Shown by the tests of `blows`.
pub(crate) const FLINCH_TIME: f32 = 0.12;

/// Half-life of a struck limb's coming back, seconds.
///
/// Larger: it floats home. Smaller: it snaps. Shown by the tests of `blows`.
pub(crate) const FLINCH_HALF_LIFE: f32 = 0.08;

/// Largest share of their strength, 0 to 1, that a blow takes from the legs of a character that steps.
///
/// Larger: it kneels before its foot is down. Smaller: legs like poles. Shown by the tests of `stumble`.
pub(crate) const LEGS_WEAKEN: f32 = 0.2;

/// Speed at which a led body gives way to what presses it slowly and hard, m/s; faster only to what comes faster.
///
/// Larger: who treads on somebody kicks. Smaller: a foot stays pressed on what it treads on. Shown by the tests of `grab`.
pub(crate) const GIVES_WAY: f32 = 3.0;

/// Blow that fells who is still near the ground as it gets up, over the one that fells who stands.
///
/// Larger: nothing stops who gets up. Smaller: in a crowd few come to stand. Shown by the tests of `blows`.
pub(crate) const LOW_STANDS: f32 = 2.5;

/// Largest share of its strength, 0 to 1, that a blow takes from the trunk of a character that steps.
///
/// Larger: it folds. Smaller: it steps like a board. Shown by the tests of `stumble`.
pub(crate) const TRUNK_WEAKENS: f32 = 0.5;

/// Number of half-lives after which a limb is as the clips have it again.
///
/// Larger: it counts as flinching for longer. Smaller: it jumps at the end. Shown by the tests of `blows`.
pub(crate) const RETURNED_AFTER: f32 = 6.0;

// character/detach.rs

/// Height of what was cut off for springs that come up against the body, metres, world: where nothing is.
///
/// Larger: springs may meet it. Smaller: nothing but rounding. Shown by the tests of `detach`.
pub(crate) const FAR_BELOW: f32 = -1e6;

// character/grasp.rs

/// Gap of a grip below which it has no direction, metres.
///
/// Larger: the axes of the grip lie as they did while it already slips. Smaller: they follow noise. Shown by the tests of `grab`.
pub(crate) const LEAST_GAP: f32 = 1e-4;

/// Cosine of the angle between a grip's pull and the diagonal of its axes from which on these are laid anew.
///
/// Larger: they are laid anew all the time. Smaller: it pulls with less than its force. Shown by the tests of `grab`.
pub(crate) const LEAST_ALONG: f32 = 0.98;

/// Stretch of a grip at its full force, metres.
///
/// Larger: what is held hangs away from the hand. Smaller: it jerks. Shown by the tests of `grab`.
pub(crate) const GRIP_STRETCH: f32 = 0.01;

/// Share of a grip's force that its motor uses, 0 to 1: contacts and stops of joints add to it within a substep.
///
/// Larger: a grip is seen to pull harder than it may. Smaller: it lets go too early. Shown by the tests of `grab`.
pub(crate) const GRIP_SHARE: f32 = 0.9;

// character/grab.rs

/// Distance between the bounds of two characters from which on they collide again after one has let go of the other, metres, twice.
///
/// Larger: they pass through each other for longer. Smaller: feet kick who is let go. Shown by the tests of `grab`.
pub(crate) const PARTED: f32 = 0.05;

// character/feet.rs

/// Natural frequency with which feet follow the ground, critically damped, rad/s: a step of a stair asks for as much of a leg as a
/// transition within 0.2 s.
///
/// Larger: legs jerk. Smaller: feet sink in and float. Shown by the tests of `slopes`.
pub(crate) const FEET_QUICKNESS: f32 = 12.0;

/// Farthest that ground may be up or down for a foot to stand on it, metres.
///
/// Larger: legs reach into holes. Smaller: feet hang over steps. Shown by the tests of `slopes`.
pub(crate) const FOOT_RANGE: f32 = 0.32;

/// Distance up or down below which ground is the floor of the clip, metres.
///
/// Larger: feet off the ground. Smaller: noise of meshes moves legs. Shown by the tests of `slopes`.
pub(crate) const FOOT_FLOOR: f32 = 2e-3;

/// Height and speed below which a foot has nothing left to come back from, metres and m/s.
///
/// Larger: it jumps at the end. Smaller: work for nothing. Shown by the tests of `pops`.
pub(crate) const FOOT_HOME: f32 = 1e-5;

/// Ratio of the times in which a body stands upright and its feet are planted.
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

/// Fastest turn about the vertical of a powered character, rad/s: what its muscles and pins follow. A person turns round on the spot within a second.
///
/// Larger: it twists and falls over its own legs. Smaller: it turns like a ship. Shown by the scene `brawl`.
pub(crate) const POWERED_TURNS: f32 = 3.5;

/// Natural frequency with which a foot of one who goes follows edges, critically damped, rad/s: within the half of a swing in which it sees them.
///
/// Larger: feet jerk over edges. Smaller: they float when they come down. Shown by the tests of `feet`.
pub(crate) const TREAD_QUICKNESS: f32 = 25.0;

/// Time by which a foot in the air looks ahead at its speed, seconds: it comes down there, for it slows down evenly in the second half of its
/// swing.
///
/// Larger: it is raised for the step after. Smaller: it sees edges late. Shown by the tests of `feet`.
pub(crate) const LOOKS_AHEAD: f32 = 0.12;

/// Height of its lower end over the floor of the clip from which on a foot looks ahead, and on which more it does so fully, over the height of
/// the body: one that is about to come down does not get far any more.
///
/// Larger: edges are seen late. Smaller: it comes down on the step after. Shown by the tests of `feet`.
pub(crate) const LANDS: [f32; 2] = [0.006, 0.017];

/// Part along up of the normal of a surface below which it is a wall for toes.
///
/// Larger: they draw back from slopes. Smaller: they go into steep ones. Shown by the tests of `feet`.
pub(crate) const STEEPEST_TREAD: f32 = 0.5;

/// Height over the ground at which what is before a foot counts as a wall, metres.
///
/// Larger: toes in low kerbs. Smaller: they draw back from slopes. Shown by the tests of `feet`.
pub(crate) const TOES_OVER: f32 = 0.06;

/// Distance that toes and heel keep from a wall where a foot comes down, metres: shapes of feet are a little smaller than what is drawn.
///
/// Larger: feet come down beside their clips. Smaller: toes in walls. Shown by the tests of `feet`.
pub(crate) const TOES_CLEAR: f32 = 0.02;

/// Farthest that ground may be down for a foot of one who goes, over the height of the body: a mover is up a stair by its radius before the foot.
///
/// Larger: legs reach into holes. Smaller: feet hang over steps. Shown by the tests of `feet`.
pub(crate) const TREAD_RANGE: f32 = 0.34;

/// Height of its lower end over the floor of the clip below which a foot stands, over the height of the body.
///
/// Larger: feet stick in a swing. Smaller: they slide. Shown by the tests of `feet`.
pub(crate) const STANCE_HEIGHT: f32 = 0.015;

/// Speed over the ground of a clip's foot below which it stands, m/s.
///
/// Larger: feet stick in a swing. Smaller: they slide where a clip does. Shown by the tests of `feet`.
pub(crate) const STANCE_SPEED: f32 = 0.8;

/// Rate at which a foot in the air comes back to where its clip has it, 1/s.
///
/// Larger: it flicks. Smaller: it comes down beside. Shown by the tests of `feet`.
pub(crate) const RELEASES: f32 = 12.0;

/// Way of a foot beside where its clip has it that is not made up for, metres: the speed of a mover follows that of clips by a step.
///
/// Larger: feet slide. Smaller: legs tremble. Shown by the tests of `feet`.
pub(crate) const SMALL_WAY: f32 = 4e-3;

/// Least mass of a dynamic body that is ground, over that of the character.
///
/// Larger: feet go through crates. Smaller: they step onto what they would kick. Shown by the tests of `in_world`.
pub(crate) const LEAST_TREAD: f32 = 0.05;

/// Farthest that a foot stands from where its clip has it, over the height of the body.
///
/// Larger: twisted legs. Smaller: feet slide. Shown by the tests of `feet`.
pub(crate) const MOST_ASTRAY: f32 = 0.07;

/// Depth of a sole in the ground from which on it is raised at once, metres.
///
/// Larger: it sinks in. Smaller: it jerks over noise. Shown by the tests of `feet`.
pub(crate) const SOLE_SINKS: f32 = 0.01;

/// Speed at which a sole comes out of the ground, m/s.
///
/// Larger: it jerks over edges that it saw late. Smaller: it goes through them. Shown by the tests of `feet`.
pub(crate) const RISES: f32 = 5.0;

/// Time without ground after which feet stand no longer, seconds.
///
/// Larger: feet hang on to the ground in a jump. Smaller: they let go at each kerb. Shown by the tests of `feet`.
pub(crate) const OFF_GROUND: f32 = 0.1;

/// Height above a foot from which the ground is sought, metres.
///
/// Larger: a table over it is its ground. Smaller: steps are seen late. Shown by the tests of `slopes`.
pub(crate) const FOOT_SEARCH: f32 = 0.5;

/// Speed from which on a character has its feet where its clips have them, m/s.
///
/// Larger: feet stick as it goes. Smaller: they slide as it stands. Shown by the tests of `slopes`.
pub(crate) const WALKS_FROM: f32 = 0.3;

/// Place of the ball in front of an ankle without toes, in lengths of the leg.
///
/// As that of the animations. Shown by the tests of `slopes`.
pub(crate) const BALL_AHEAD: f32 = 0.14;

// character/clearance.rs

/// Height by which a part of the body is raised out of the floor at most, as a share of the character's height.
///
/// Larger: it hovers where the skin of a limb is far from it. Smaller: limbs in the floor. Shown by the tests of `rising`.
pub(crate) const MOST_LIFT: f32 = 0.25;

/// Depth in the floor of the skin of feet, hands and elbows for which a clip to get up by is not bent, as a share of the character's height.
///
/// Larger: fingers in the floor. Smaller: soles over it. Shown by the tests of `motions`.
pub(crate) const LIMBS_SINK: f32 = 0.003;

/// Height of a step with which a foot goes to where a clip has it, over its way, and the largest as a share of the character's height.
///
/// Larger: it stamps. Smaller: feet slide. Shown by the tests of `rising`.
pub(crate) const STEP_OVER: f32 = 0.6;
/// See [`STEP_OVER`].
pub(crate) const STEP_HEIGHT: f32 = 0.05;

/// Cosine of the largest tilt of a foot from which it steps to where a clip has it.
///
/// Larger: feet slide. Smaller: legs that lie kick. Shown by the tests of `rising`.
pub(crate) const STEPS_FROM: f32 = 0.0;

/// Share of a step, at each end, in which the foot only goes up or down.
///
/// Larger: it jerks in between. Smaller: it slides. Shown by the tests of `rising`.
pub(crate) const STRAIGHT_UP: f32 = 0.22;

/// Length of a foot, as a share of the character's height, over which the ground under it may fall.
///
/// Larger: toes in the floor of a slope. Smaller: feet over it. Shown by the tests of `slopes`.
pub(crate) const FOOT_SHARE: f32 = 0.15;

// character/get_up.rs

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

/// Share of a get-up clip, to its end, in which a body that lay on a slope stands upright, 0 to 1.
///
/// Larger: hands leave the ground. Smaller: it swings upright. Shown by the tests of `slopes`.
pub(crate) const STRAIGHTENS: f32 = 0.6;

/// Load of others, less what it loads others with, under which a body that lies does not get up, as a share of its own weight: half of an arm.
///
/// Larger: it gets up under a limb of another, which is thrown off. Smaller: it waits for who but leans on it. Shown by
/// `in_world::who_lies_on_top_gets_up_first`.
pub(crate) const BEARS: f32 = 0.02;

/// Upward component of the normal toward a kinematic body above which that stands on who lies, a cosine: 17° from level.
///
/// Larger: who kneels beside it and on it is lifted. Smaller: it waits for a lift beside it. Shown as [`BEARS`].
pub(crate) const ON_TOP: f32 = 0.3;

/// Time after its fall for which a body waits for such a load to go, seconds.
///
/// Larger: it lies long under a crate, which nobody takes away. Smaller: it throws off who takes long to get up. Shown as [`BEARS`].
pub(crate) const BEARS_FOR: f32 = 5.0;

/// Height of a mover over a body that lies, as a share of its own.
///
/// Larger: it does not fit under what the body lies under. Shown by the tests of `in_world`.
pub(crate) const LYING_MOVER: f32 = 0.0;

/// Height above the pelvis from which the ground is sought, metres.
///
/// Larger: what it lies under is its ground. Smaller: a pelvis sunk in a slope finds none. Shown by the tests of `slopes`.
pub(crate) const ABOVE_PELVIS: f32 = 0.3;

// character/ground.rs

/// Highest step that a walking character climbs, metres.
///
/// Larger: it climbs tables. Smaller: it stops at stairs. Shown by the tests of `travel`.
pub(crate) const HIGHEST_STEP: f32 = 0.45;

/// Depth down to which the ground is sought, metres.
///
/// Larger: slower over holes. Smaller: what stands high has none. Shown by the tests of `character`.
pub(crate) const GROUND_DEPTH: f32 = 100.0;

/// Depth under a pelvis down to which the ground that bears it is sought, metres.
///
/// Larger: what lies over an edge gets up on the floor below. Smaller: large figures bear themselves on nothing. Shown by the tests
/// of `slopes`.
pub(crate) const LIES_ON: f32 = 1.0;

/// Height above a point of a body that lies from which the ground is sought, metres.
///
/// As [`ABOVE_PELVIS`].
pub(crate) const LYING_SEARCH: f32 = 0.3;

/// Slope from which on steeper ground counts as if it were not, radians.
///
/// Larger: a character gets up leaning. Smaller: it gets up through the ground. Shown by the tests of `slopes`.
pub(crate) const STEEPEST_GROUND: f32 = 0.6;

/// Slope below which ground counts as level, radians.
///
/// Larger: feet off gentle slopes. Smaller: work for nothing. Shown by the tests of `slopes`.
pub(crate) const LEVEL_GROUND: f32 = 0.02;

// character/hit_bodies.rs

/// Way of a body within a step beyond which it was put elsewhere, metres.
///
/// Larger: what was put strikes all on its way. Smaller: what is fast strikes nothing. Shown by the tests of `in_world`.
pub(crate) const TELEPORTED: f32 = 1.0;

// character/in_world.rs

/// Speed that a blow gives to the whole of a character that it fells, m/s.
///
/// Larger: it stands through more. Smaller: a touch fells it. Shown by the tests of `in_world`.
pub(crate) const FELLING_SPEED: f32 = 0.6;

/// Radius of a mover over its height.
///
/// Larger: it does not fit through doors. Smaller: arms in walls. Shown by the tests of `in_world`.
pub(crate) const MOVER_RADIUS: f32 = 0.17;

// character/limp.rs

/// Time between the poses ahead of now that the hand-over takes velocities from, seconds: short against any motion, long against
/// rounding.
///
/// Larger: speeds of the step to come. Smaller: noise. Shown by the tests of `hand_over`.
pub(crate) const HAND_OVER_TIME: f32 = 1.0 / 1000.0;

/// Time in which what no body moves comes to rest, seconds.
///
/// Larger: fingers go on moving on what lies. Smaller: they freeze. Shown by the tests of `pops`.
pub(crate) const LINGERS: f32 = 0.25;

/// Time in which joints take on the friction of a limp body, seconds.
///
/// Larger: it falls like water. Smaller: joints jerk at the hand-over. Shown by the tests of `hand_over`.
pub(crate) const SLACKENS: f32 = 0.2;

/// Speed below which a body lies still, m/s: the contract's 2 cm/s.
///
/// Larger: it gets up while it slides. Smaller: it waits. Shown by the tests of `character`.
pub(crate) const STILL_LINEAR: f32 = 0.02;

/// Angular speed below which a body lies still, rad/s: the contract's.
///
/// As [`STILL_LINEAR`].
pub(crate) const STILL_ANGULAR: f32 = 0.05;

/// Time that all bodies must be still, seconds: the contract's.
///
/// Larger: it waits. Smaller: it gets up at a turning point. Shown by the tests of `character`.
pub(crate) const STILL_TIME: f32 = 0.5;

/// Depth in what stands from which on a body does not lie yet, metres: it is pushed out, for which it has no speed of its own.
///
/// Larger: what is stuck counts as at rest. Smaller: what rests within the slop does not. Shown by the tests of `falls`.
pub(crate) const SUNK: f32 = 5e-3;

// character/mirror.rs

/// Largest distance of a joint from the mirror image of its counterpart in the bind pose, as a share of the body's height.
///
/// Larger: mirrored clips look askew. Smaller: there are none. Shown by the tests of `character`.
pub(crate) const MIRROR_TOLERANCE: f32 = 0.03;

/// Distance from its rest beyond which a joint counts as moved along, as a share of its distance from its parent.
///
/// Larger: sliding joints stay behind in mirrored clips. Smaller: rounding counts. Shown by the tests of `character`.
pub(crate) const MOVED: f32 = 1e-3;

// character/moves.rs

/// Share of a get-up clip in which it may begin, 0 to 1.
///
/// Larger: it may begin nearly upright. Smaller: what sits lies down first. Shown by the tests of `character`.
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
/// Larger: feet push what they meet. Smaller: they drag. Shown by the tests of `lives`.
pub(crate) const PIN_STEPS: f32 = 4.0;

/// Largest force of the pin of a powered pelvis, over the weight of the whole.
///
/// Larger: nothing fells it. Smaller: it sags. Shown by the tests of `lives`.
pub(crate) const PIN_BEARS: f32 = 1.0;

/// Largest torque of the pin of a powered pelvis over the weight of the whole, metres.
///
/// Larger: nothing tips it. Smaller: it leans. Shown by the tests of `lives`.
pub(crate) const PIN_TURNS: f32 = 0.3;

/// Half-life of a powered body's coming back to the clips, seconds.
///
/// Larger: it floats home. Smaller: it snaps. Shown by the tests of `lives`.
pub(crate) const POWERED_HALF_LIFE: f32 = 0.1;

/// Distance of the pelvis of a powered character from its clips', over its height, beyond which it falls.
///
/// Larger: it is dragged along. Smaller: a push fells it. Shown by the tests of `lives`.
pub(crate) const FALLS_BEYOND: f32 = 0.3;

/// Turn of the pelvis of a powered character from its clips' beyond which it falls, radians.
///
/// As [`FALLS_BEYOND`].
pub(crate) const FALLS_TURNED: f32 = 1.0;

// character/prepare.rs

/// Time in which a body is brought to where a get-up clip begins where its trunk has to be turned, seconds.
///
/// Larger: it lies for long. Smaller: it is thrown over. Shown by the tests of `character`.
pub(crate) const TIME_TO_ROLL: f32 = 1.5;

/// Time in which a body is brought to where a get-up clip begins where its trunk lies right, seconds.
///
/// As [`TIME_TO_ROLL`].
pub(crate) const TIME_TO_PULL: f32 = 0.5;

/// Time in which half of the strength to roll over is there, seconds.
///
/// Larger: slow rolls. Smaller: a jerk. Shown by the tests of `character`.
pub(crate) const PREPARES_HALF_LIFE: f32 = 0.1;

/// Frequency of the pin that turns a trunk over, Hz.
///
/// Larger: it flips. Smaller: it does not come round in time. Shown by the tests of `character`.
pub(crate) const ROLL_HERTZ: f32 = 2.0;

/// Largest torque of what rolls a body over, on each part of the trunk, over its weight times its height: 90 N·m of a man.
///
/// Larger: it throws off what lies on it. Smaller: it stays as it lies. Shown by the tests of `character`.
pub(crate) const ROLL_STRENGTH: f32 = 0.07;

// character/stumble/mod.rs

/// Time of a step that only brings a foot home, seconds.
///
/// Larger: slow. Smaller: feet snap. Shown by the tests of `stumble`.
pub(crate) const HOME_TIME: f32 = 0.25;

/// Share of a step until which its goal may change, 0 to 1.
///
/// Larger: feet dart aside at the end. Smaller: they land where the fall was foreseen at first. Shown by the tests of `stumble`.
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

/// Distance of a capture point from the feet that asks for a step, metres.
///
/// Larger: it falls before it steps. Smaller: it steps for nothing. Shown by the tests of `stumble`.
pub(crate) const CAPTURE_MARGIN: f32 = 0.01;

/// Distance of a capture point from the feet that asks for a first step where nothing was told of a push, metres.
///
/// As [`CAPTURE_MARGIN`].
pub(crate) const UNTOLD_MARGIN: f32 = 0.08;

/// Velocity beside the one that it is to have at which a character is caught, m/s.
///
/// Larger: it stands still while it sways. Smaller: it steps on. Shown by the tests of `stumble`.
pub(crate) const CAUGHT_SPEED: f32 = 0.15;

/// Share of the velocity that it is to have by which a character that is caught may be off besides, 0 to 1.
///
/// As [`CAUGHT_SPEED`].
pub(crate) const CAUGHT_SHARE: f32 = 0.35;

/// Distance by which a step may miss its place for a second less of its time, metres per second.
///
/// Larger: hasty steps. Smaller: late ones. Shown by the tests of `stumble`.
pub(crate) const HURRY: f32 = 0.2;

/// Distance by which a step may miss its place for a metre less by which the foot that stands is left behind too far, a ratio.
///
/// Larger: short steps. Smaller: splits. Shown by the tests of `stumble`.
pub(crate) const STRAIN_COST: f32 = 3.0;

/// Distance from where it should be at which a foot in the air is put down for the other to step, over the height of the body.
///
/// Larger: steps that do not catch. Smaller: feet patter. Shown by the tests of `stumble`.
pub(crate) const HOPELESS: f32 = 0.04;

/// Way of a foot over which it is lifted all of [`LIFT`], metres.
///
/// Larger: feet drag. Smaller: short steps march. Shown by the tests of `stumble`.
pub(crate) const WIDE_STEP: f32 = 0.2;

/// Rate at which what was caught takes on the velocity that it is to have, 1/s.
///
/// Larger: a jerk. Smaller: it drifts. Shown by the tests of `stumble`.
pub(crate) const RESUMES: f32 = 10.0;

/// Height of an ankle above its height on the floor at which a foot is in the air, metres.
///
/// Larger: what hops stands. Smaller: rough ground throws it. Shown by the tests of `stumble`.
pub(crate) const AIRBORNE: f32 = 0.04;

/// Time without ground after which there is nothing to step on, seconds.
///
/// Larger: it steps in the air. Smaller: a kerb fells it. Shown by the tests of `stumble`.
pub(crate) const FLIES_AFTER: f32 = 0.15;

/// Farthest that ground may be up or down to be stepped on, metres.
///
/// Larger: it steps onto tables. Smaller: stairs fell it. Shown by the tests of `stumble`.
pub(crate) const STEP_RANGE: f32 = 0.4;

// character/stumble/step.rs

/// Time in which a foot that is in the air is put down at once, seconds.
///
/// Larger: it falls meanwhile. Smaller: a stamp. Shown by the tests of `stumble`.
pub(crate) const DROP_TIME: f32 = 0.1;

/// Time of a step of a steady walk, seconds.
///
/// Larger: long steps. Smaller: feet patter. Shown by the tests of `stumble`.
pub(crate) const STRIDE_TIME: f32 = 0.28;

/// Least way between the feet across, over the height of the body.
///
/// Larger: a straddle. Smaller: feet cross. Shown by the tests of `stumble`.
pub(crate) const FEET_APART: f32 = 0.08;

/// Farthest of a foot from the body, over its height.
///
/// Larger: splits. Smaller: it falls where a step would catch it. Shown by the tests of `stumble`.
pub(crate) const STEP_REACH: f32 = 0.3;

/// Largest mean speed of a foot over the height of the body, 1/s: a quick step of a person takes 0.2 s for 0.6 m.
///
/// Larger: feet flash. Smaller: it falls where a step would catch it. Shown by the tests of `stumble`.
pub(crate) const FOOT_SPEED: f32 = 1.7;

/// Way of a foot to its own side of the capture point, over the height of the body.
///
/// Larger: it sways from side to side. Smaller: it tips over its own foot. Shown by the tests of `stumble`.
pub(crate) const STEP_OUT: f32 = 0.015;

/// Way by which the foot leads the capture point to brake, in ways of the velocity that is too much over the pendulum's frequency.
///
/// Larger: it swings back. At 1 or below: it never stops. Shown by the tests of `stumble`.
pub(crate) const BRAKES: f32 = 1.5;

// character/travel.rs

/// Distance from where it began nearer than which a clip that ends there stays in its place, metres.
///
/// Larger: slow walks stay. Smaller: idle clips creep. Shown by the tests of `travel`.
pub(crate) const STAYS_WITHIN: f32 = 0.02;

/// Turn from where it began below which a clip that ends there stays in its place, radians.
///
/// As [`STAYS_WITHIN`].
pub(crate) const STAYS_TURNED: f32 = 0.02;

/// Turn of a lap below which it goes straight on, radians.
///
/// Larger: wide circles are lines. Smaller: the middle of a circle is rounded away. Shown by the tests of `travel`.
pub(crate) const STRAIGHT: f32 = 1e-4;

// character/walk.rs

/// Rate at which what a step of a stair lifts a character dies away, 1/s: the eye follows within a few frames.
///
/// Larger: it jerks. Smaller: it wades in the steps. Shown by the tests of `in_world`.
pub(crate) const STEP_SETTLES: f32 = 14.0;

/// Farthest that a character is shown from its mover, metres.
///
/// Larger: it floats after a drop. Smaller: high steps jerk. Shown by the tests of `in_world`.
pub(crate) const MOST_BESIDE: f32 = 0.4;

/// Speed beside its own at which a mover that is pushed aside takes its character along at once, m/s; beyond it the character follows.
///
/// Larger: it jumps aside. Smaller: what pushes it is seen in it. Shown by the tests of `in_world`.
pub(crate) const PUSHED_ASIDE: f32 = 1.5;

/// Rise of the ground over the way, a slope, from which on it is a step.
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

/// Time in which the looped clip and that of standing change places at most, seconds.
///
/// Larger: who sets off slides. Smaller: arms and legs are flung to where the other clip has them, and kick what is near. Shown by the
/// tests of `in_world`.
pub(crate) const STANDS_IN: f32 = 0.2;

/// Acceleration of what stands on its own feet, m/s²: shoes give way beyond it.
///
/// Larger: starts without weight. Smaller: it answers late. Shown by the tests of `in_world`.
pub(crate) const PICKS_UP: f32 = 5.0;

/// Most clips that a character goes by, walk and run among them.
///
/// Larger: more weights on the stack. Smaller: faster clips are left out. Shown by the tests of `paces`.
pub(crate) const MOST_PACES: usize = 8;

/// Largest speed of a clip over its own.
///
/// Larger: legs whirl. Smaller: feet slide. Shown by the tests of `in_world`.
pub(crate) const FASTEST_PACE: f32 = 2.0;

// floor.rs

/// Distance of the lowest drawn point of a clip from the floor of the rest pose from which on the clip has a floor of its own, as a
/// share of the character's height.
///
/// Larger: characters float or sink by so much. Smaller: a toe that dips in lifts the whole. Shown by the tests of `floors`.
pub(crate) const OWN_FLOOR: f32 = 0.03;

/// Depth in what stands from which on a character that goes limp is taken out of it, metres.
///
/// Contacts push out half of it in 0.5 s. Larger: limbs stay in walls for seconds. Smaller: a foot that a clip puts into a stair lifts all of the
/// figure. Shown by the tests of `clear`.
pub(super) const DEEP: f32 = 0.1;

/// Speed at which it is taken out, m/s.
///
/// Larger: it jumps. Smaller: it floats for longer. Shown by the tests of `clear`.
pub(super) const CLEARING_SPEED: f32 = 1.9;

/// Longest way out, metres.
///
/// Larger: what stands in a hill rises out of it. Smaller: what is in a thick wall stays there. Shown by the tests of `clear`.
pub(super) const CLEARING_REACH: f32 = 1.2;

/// Static shapes that it is taken out of one after the other, a number.
///
/// Floor, two walls of a corner, and one more. Larger: more queries where no way leads out. Smaller: corners are not left. Shown by the tests of `clear`.
pub(super) const MOST_OBSTACLES: usize = 4;

/// Cosine from which on two directions out of a shape are one.
///
/// 11°. Larger: more queries. Smaller: a slanting side of a hull is left by the way of the next. Shown by the tests of `clear`.
pub(super) const SAME_WAY: f32 = 0.98;
