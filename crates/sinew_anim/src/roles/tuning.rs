//! Tunable constants for the recognition of joints.
//!
//! Each has its unit, the effect of a larger and a smaller value, and the tests (`crates/sinew_anim/tests/it`) that
//! show it; effects without a number are estimates.

// roles/anatomy.rs

/// Share of all skin above which a joint named as a control counts as a bone, 0 to 1.
///
/// It is below [`LEAST_BODY_SKIN`], because a hoof too small for its own body must still follow its leg. Larger: hoofs
/// do not follow their legs. Smaller: stray weights turn controls into bones. Shown by the tests of `wild`.
pub(crate) const CONTROL_SKIN: f32 = 5e-4;

/// Least distance by which the feet extend in front of their ankles, summed over both feet, in body heights, at which
/// they decide the forward direction against the names of left and right.
///
/// It is half of a human's distance. Larger: swapped names reverse characters. Smaller: feet that extend slightly
/// backward reverse characters. Shown by the tests of `hints`.
pub(crate) const FEET_AGAINST_NAMES: f32 = 0.04;

/// Least such distance, in body heights, at which the feet decide the forward direction if there is no other evidence.
///
/// Larger: small feet are ignored. Smaller: noise decides the forward direction. Shown by the tests of `hints`.
pub(crate) const LEAST_FOOT: f32 = 0.005;

/// Drop of a limb from its first joint to its last, as a share of their distance, above which the limb counts as
/// hanging. A trunk that rises by a smaller share counts as horizontal.
///
/// Larger: quadrupeds with human names count as humans. Smaller: a bent human counts as a quadruped. Shown by the tests
/// of `assembly`.
pub(crate) const HANGING: f32 = 0.6;

/// Least sum of the distances of both elbows behind the straight lines of the arms, in body heights, at which the
/// elbows decide against unclear feet.
///
/// Larger: T-poses without feet have no front. Smaller: noise of straight arms decides the forward direction. Shown by
/// the tests of `hints`.
pub(crate) const ELBOWS_BEHIND: f32 = 0.03;

/// Least correlation of the feet's height with their speed, 0 to 1, that decides the walking direction.
///
/// Larger: shuffling walks give no direction. Smaller: dances give a direction. Shown by the tests of `hints`.
pub(crate) const STEP_CORRELATION: f32 = 0.25;

// roles/assembly.rs

/// Least number of limb pairs with consistent left and right names at which the names are trusted without a mirror
/// plane.
///
/// Larger: low-poly characters with few bones are rejected. Smaller: two names may agree by chance. Shown by the tests
/// of `assembly`.
pub(crate) const LEAST_NAMED_PAIRS: usize = 3;

/// Least cosine between a pair's right-to-left direction and the mean of all pairs at which the names are consistent.
///
/// Larger: legs in a stride are rejected. Smaller: shuffled names are accepted. Shown by the tests of `assembly`.
pub(crate) const NAMED_ALIKE: f32 = 0.3;

// roles/bind.rs

/// Distance of two joints that counts as one position, as a share of the body's size.
///
/// Larger: fingertips coincide. Smaller: an exporter's helpers count as bones. Shown by the tests of `rigs`.
pub(crate) const COINCIDENT: f32 = 1e-3;

/// Ratio of the joints of the largest tree of a capture to those of another tree, above which the other is not part of
/// the skeleton.
///
/// Larger: cameras with targets count as body parts. Smaller: limbs that are roots are left out. Shown by the tests of
/// `roles`.
pub(crate) const LARGEST_BESIDE: usize = 8;

/// Largest difference of a joint's bind scale from that of most joints, as a share.
///
/// Larger: exporter handles decide the scale of the bind pose. Smaller: stretched bones are ignored. Shown by the tests
/// of `assembly`.
pub(crate) const BOUND_ALIKE: f32 = 0.1;

// roles/beside.rs

/// Largest distance of a side skeleton's root from a bone of the main skeleton in the rest pose, to move with it in the
/// bind pose, as a share of the main skeleton's size.
///
/// Larger: a pet is moved with its owner. Smaller: hair stays at the rest pose of the body. Shown by the tests of
/// `assembly`.
pub(crate) const AT_MAIN: f32 = 0.15;

/// Least ratio of the bones of the main skeleton to those of a skeleton beside it that moves with it.
///
/// Larger: hair of many strands stays at the rest pose of the body. Smaller: a second character is moved. Shown by the
/// tests of `assembly`.
pub(crate) const SIDE_BONES: usize = 2;

// roles/characters.rs

/// Least share of a skeleton's bounds inside another's, along each axis, at which it belongs to the other skeleton.
///
/// Larger: protruding clothes count as characters. Smaller: characters that stand close together are merged. Shown by
/// the tests of `assembly`.
pub(crate) const LIES_WITHIN: f32 = 0.5;

/// Largest side of a skeleton that belongs to one beside it, as a share of the other's largest side.
///
/// Larger: a dog belongs to its owner. Smaller: a hat counts as a character. Shown by the tests of `assembly`.
pub(crate) const SMALL_BESIDE: f32 = 0.25;

/// Least size of a skeleton within another's bounds that may be a separate character, as a share of the other's size.
///
/// Larger: surrounded characters are merged. Smaller: a wig counts as a character. Shown by the tests of `assembly`.
pub(crate) const LARGE_WITHIN: f32 = 0.4;

/// Least number of bones of a separate character within another's bounds.
///
/// Larger: a bird on a shoulder is merged. Smaller: a coat with its own bones counts as a character. Shown by the tests
/// of `assembly`.
pub(crate) const BONES_OF_A_CHARACTER: usize = 8;

/// Largest distance of bones of clothes from those of the body, as a share of the body's size.
///
/// Larger: a character inside another counts as its clothes. Smaller: fitted clothes count as characters. Shown by the
/// tests of `assembly`.
pub(crate) const SAME_BONE: f32 = 0.02;

// roles/gait.rs

/// Number of poses per second sampled from a clip for its gait, 1/s.
///
/// Larger: the analysis is slower. Smaller: the swing of a run falls between the samples. Shown by the tests of
/// `hints`.
pub(crate) const GAIT_RATE: f32 = 24.0;

/// Least duration of a clip of walking, seconds.
///
/// Larger: short cycles are missed. Smaller: single poses count as clips. Shown by the tests of `hints`.
pub(crate) const SHORTEST_WALK: f32 = 0.2;

/// Least ratio of the variance of alternating swing to that of common swing.
///
/// Larger: the legs of a swaying walk are not recognised. Smaller: limbs of a hop count as legs. Shown by the tests of
/// `hints`.
pub(crate) const IN_TURNS: f32 = 4.0;

/// Largest ratio of the variances of two limbs that swing as a pair.
///
/// Larger: one striking arm counts as a pair of legs. Smaller: limping legs do not count. Shown by the tests of
/// `hints`.
pub(crate) const SWINGS_ALIKE: f32 = 3.0;

/// Least swing of legs, root mean square, as a share of the body's height.
///
/// Larger: short steps are ignored. Smaller: breathing counts as swing. Shown by the tests of `hints`.
pub(crate) const LEAST_SWING: f32 = 0.03;

// roles/graph.rs

/// Largest distance of a foot beside the body from the skin of its leaf, as a share of the skin's size.
///
/// Larger: a foot is attached to the wrong leg. Smaller: a foot stays detached. Shown by the tests of `wild`.
pub(crate) const FOOT_AT_SKIN: f32 = 0.06;

/// Largest distance of a foot parented to the root from the end of its leg, as a share of the skin's size.
///
/// Larger: IK targets count as feet. Smaller: feet with a gap are not attached. Shown by the tests of `wild`.
pub(crate) const FOOT_AT_END: f32 = 0.01;

/// Largest ratio of the skin of a foot beside the body to that of the shank before it.
///
/// Larger: legs are attached to hands as feet. Smaller: large boots are not attached to a leg. Shown by the tests of
/// `assembly`.
pub(crate) const LARGEST_FOOT: f32 = 2.0;

/// Largest difference of the distances of twins from the root, as a share of the skin's size.
///
/// Larger: any two subtrees count as twins. Smaller: slightly asymmetric rigs have no twins. Shown by the tests of
/// `creatures`.
pub(crate) const TWIN_PLACE: f32 = 0.025;

/// Least area of skin that a twin moves, as a share of the other's.
///
/// Larger: legs of uneven meshes do not count as twins. Smaller: a leg and a finger count as twins. Shown by the tests
/// of `creatures`.
pub(crate) const TWIN_AREA: f32 = 0.6;

// roles/humanoid.rs

/// Distance of another joint from the start of a forearm, as a share of the hand joint's distance, above which both
/// joints count as fingers.
///
/// Larger: a thumb that begins early is missed. Smaller: a twist bone counts as a finger. Shown by the tests of
/// `roles`.
pub(crate) const FORKED: f32 = 0.8;

/// Largest spread of the fingers' starts, as a share of their distance from the parent, at which their position is the
/// wrist.
///
/// Larger: palms are lost. Smaller: fingers are attached to the forearm. Shown by the tests of `roles`.
pub(crate) const AT_WRIST: f32 = 0.15;

/// Longest palm, as a share of the forearm's length; also fits characters with large hands.
///
/// Larger: forearms count as palms. Smaller: large hands count as forearms. Shown by the tests of `roles`.
pub(crate) const LONGEST_PALM: f32 = 0.7;

/// Largest distance of a joint of the neck below the shoulders, as a share of the body's height.
///
/// Larger: the chest counts as neck. Smaller: raised shoulders hide the neck. Shown by the tests of `assembly`.
pub(crate) const AT_SHOULDER: f32 = 0.03;

/// Largest difference of the heights of two joints that count as equally high, as a share of the body's height.
///
/// Larger: knees and ankles count as equally high. Smaller: rounding decides which joint is higher. Shown by the tests
/// of `roles`.
pub(crate) const AS_HIGH: f32 = 0.02;

/// Least height of the hips of a character with a large head, as a share of the character's height.
///
/// Larger: the legs of dolls are not recognised. Smaller: feet count as legs. Shown by the tests of `roles`.
pub(crate) const LOWEST_HIP: f32 = 0.1;

/// Largest distance of the inner end of a limb from the midline, as a share of the next joint's distance.
///
/// Larger: thighs and upper arms close to the midline count as hips and clavicles. Smaller: inner ends slightly off the
/// midline count as thighs. Shown by the tests of `assembly`.
pub(crate) const INNER_END: f32 = 0.1;

/// Largest length of the bone of a clavicle or a hip, as a share of the next bone's length.
///
/// Larger: short upper arms count as clavicles. Smaller: clavicles count as upper arms. Shown by the tests of `lost`.
pub(crate) const SHORT_BONE: f32 = 0.35;

/// Least share of a hip bone's length that points away from the midline.
///
/// Larger: slanted hip bones count as thighs. Smaller: short, spread thighs count as hips. Shown by the tests of
/// `lost`.
pub(crate) const SIDEWAYS: f32 = 0.8;

// roles/keep.rs

/// Least share of all skin that a joint of a creature must move to get a body, 0 to 1.
///
/// Larger: ends of tails and legs become stiff. Smaller: ears and claws get bodies. Shown by the tests of `creatures`.
pub(crate) const LEAST_BODY_SKIN: f32 = 0.004;

/// Least share of all skin that a part of the spine must move to get a separate body, 0 to 1.
///
/// Larger: snakes become stiff. Smaller: short vertebrae make weak joints. Shown by the tests of `creatures`.
pub(crate) const LEAST_SPINE_SKIN: f32 = 0.02;

/// Ratio of a vertex's distance from the bone of an upper arm without skin to its distance from the trunk's line, below
/// which the spine's skin belongs to the arm.
///
/// Larger: hanging arms take the skin of the waist. Smaller: arms thicken the chest. Shown by the variants of
/// `RiggedFigure` (1) and of `Witch` (0.5).
pub(crate) const ON_BARE_ARM: f32 = 0.7;

/// Length of the shortest clavicle that gets a body, as a share of the body's height.
///
/// Larger: shoulders are rigid. Smaller: clavicles get bodies so small that nothing collides with them. Shown by the
/// tests of `roles`.
pub(crate) const LEAST_CLAVICLE: f32 = 0.05;

/// Distance around the skin's box within which a mesh without a bone counts as worn, as a share of the skin's size.
///
/// Larger: a table beside a character follows it. Smaller: a backpack stays behind. Shown by the tests of `assembly`.
pub(crate) const WORN_WITHIN: f32 = 0.08;

/// Longest side of a worn mesh, as a share of the skin's size.
///
/// Larger: the ground under a character follows it. Smaller: a rifle stays behind. Shown by the tests of `assembly`.
pub(crate) const LARGEST_WORN: f32 = 0.9;

/// Longest side of a mesh on the skeleton's node that touches the body, as a share of the skin's size.
///
/// Larger: a stage under a character follows it. Smaller: a goblin's head stays in the air. Shown by the tests of
/// `assembly`.
pub(crate) const LARGEST_ON_ARMATURE: f32 = 1.2;

/// Most vertices that vote on the body of a part without a bone.
///
/// Larger: scenes with many parts take longer. Smaller: single vertices decide. Shown by the tests of `assembly`.
pub(crate) const VOTERS: usize = 48;

// roles/props.rs

/// Least length of the longest side of a prop that gets its own body, as a share of the skin's longest side.
///
/// Larger: swords sink into the floor. Smaller: buttons get bodies. Shown by the tests of `rig_variants` of the
/// ragdolls.
pub(crate) const LEAST_PROP: f32 = 0.1;

/// Least distance of a protruding vertex from the box of its carrier's skin, as a share of the skin's size.
///
/// Larger: hats are part of the head. Smaller: collars count as props. Shown by the tests of `rig_variants` of the
/// ragdolls.
pub(crate) const PROP_BEYOND: f32 = 0.05;

/// Least share of a prop's vertices that protrude, 0 to 1.
///
/// Larger: a shield held close is missed. Smaller: a belt counts as a prop. Shown by the tests of `rig_variants` of the
/// ragdolls.
pub(crate) const PROP_SHARE: f32 = 0.1;

/// Confidence of a prop, 0 to 1.
///
/// It affects only a report. No scene shows it.
pub(crate) const PROP_CONFIDENCE: f32 = 0.5;

// roles/symmetry.rs

/// Largest distance of a joint from its mirror image, as a share of the size of the skin.
///
/// Larger: false planes are found. Smaller: sculpted characters have no plane. Shown by the tests of `creatures`.
pub(crate) const MIRROR_TOLERANCE: f32 = 0.025;

// roles/units.rs

/// Weight of the unit in which the exporting program usually writes, on the same scale as the rarity of a unit.
///
/// Larger: a giant is accepted if its exporting program writes metres. Smaller: the exporting program is ignored.
/// Shown by the tests of `hints`.
pub(crate) const UNIT_BY_EXPORTER: f32 = 1.0;

/// Weight of a unit that all neighbouring files have, on the scale of [`UNIT_BY_EXPORTER`].
///
/// Larger: a file with another unit gets the unit of its neighbours. Smaller: files of one kit get different sizes.
/// Shown by the tests of `hints`.
pub(crate) const UNIT_BY_KIN: f32 = 2.0;

/// Height of a human as a share of the free height under a door, 0 to 1.
///
/// Doors of 2.05 m suit 1.75 m. Larger or smaller: characters sized by a door grow or shrink with it. Shown by the
/// tests of `hints`.
pub(crate) const UNDER_DOOR: f32 = 0.85;

/// Speed of strides in square roots of gravity times leg length, between that of a walk (3.6 strides) and a run (2.3
/// strides).
///
/// Larger or smaller: characters without other hints shrink or grow by its square. Shown by the tests of `hints`.
pub(crate) const STRIDE_SPEED: f32 = 3.0;

/// Least height that an adult's head implies, metres.
///
/// Larger: short adults count as children. Smaller: dolls count as adults. Shown by the tests of `hints`.
pub(crate) const GROWN_BY_HEAD: f32 = 1.3;

/// Least height of a human that is small according to files, doors or steps, metres.
///
/// Larger: dolls are scaled to adults. Smaller: unusual units are accepted. Shown by the tests of `hints`.
pub(crate) const SHORTEST: f32 = 0.5;

/// Largest ratio, either way, of leg length to the length implied by the stride, at which the stride confirms a height.
///
/// Larger: any walk confirms any height. Smaller: hurried walks confirm no height. Shown by the tests of `hints`.
pub(crate) const STEPS_ALIKE: f32 = 1.5;
