//! Tunable constants for the recognition of joints.
//!
//! Each has its unit, the effect of a larger and a smaller value, and the tests (`crates/sinew_anim/tests/it`) that
//! show it; effects without a figure are estimates.

// roles/anatomy.rs

/// Share of all skin from which a joint named as a control counts as a bone, 0 to 1.
///
/// Less than a body needs: a hoof too small for one must still follow its leg. Larger: hoofs stay behind. Smaller:
/// stray weights make bones of controls. Shown by the tests of `wild`.
pub(crate) const CONTROL_SKIN: f32 = 5e-4;

/// Least lead of both feet together, in body heights, that decides forward against the names of left and right.
///
/// Half of a human's lead. Larger: swapped names turn figures round. Smaller: slightly leading toes do. Shown by the
/// tests of `hints`.
pub(crate) const FEET_AGAINST_NAMES: f32 = 0.04;

/// Least lead of both feet together, in body heights, that decides forward if nothing else does.
///
/// Larger: small feet have no front. Smaller: noise has one. Shown by the tests of `hints`.
pub(crate) const LEAST_FOOT: f32 = 0.005;

/// Fall of a limb from its first joint to its last, as a share of the distance, from which it counts as hanging; a
/// trunk that rises by less is horizontal.
///
/// Larger: quadrupeds with human names count as humans. Smaller: a bent human does not. Shown by the tests of
/// `assembly`.
pub(crate) const HANGING: f32 = 0.6;

/// Least distance of both elbows together behind the arms, in body heights, to outweigh unclear feet.
///
/// Larger: T-poses without feet have no front. Smaller: straight arms decide by noise. Shown by the tests of `hints`.
pub(crate) const ELBOWS_BEHIND: f32 = 0.03;

/// Least correlation of the feet's height with their speed, 0 to 1, that decides the walking direction.
///
/// Larger: shuffling walks decide nothing. Smaller: dances decide. Shown by the tests of `hints`.
pub(crate) const STEP_CORRELATION: f32 = 0.25;

// roles/assembly.rs

/// Least number of limb pairs with consistent left and right names to trust them without a mirror.
///
/// Larger: rejects low-poly figures with few bones. Smaller: accepts two names by chance. Shown by the tests of `assembly`.
pub(crate) const LEAST_NAMED_PAIRS: usize = 3;

/// Least cosine between a pair's right-to-left direction and the mean of all pairs.
///
/// Larger: rejects legs in a stride. Smaller: accepts shuffled names. Shown by the tests of `assembly`.
pub(crate) const NAMED_ALIKE: f32 = 0.3;

// roles/bind.rs

/// Distance of two joints that counts as one place, as a share of the body's size.
///
/// Larger: fingertips coincide. Smaller: helpers of an exporter count as bones. Shown by the tests of `rigs`.
pub(crate) const COINCIDENT: f32 = 1e-3;

/// Ratio of joints between the largest tree of a capture and another above which the other is no part of the skeleton.
///
/// Larger: cameras with targets count as body parts. Smaller: limbs that are roots are left out. Shown by the tests of
/// `roles`.
pub(crate) const LARGEST_BESIDE: usize = 8;

/// Largest difference of the scale in which a joint is bound from that of most joints, as a share.
///
/// Larger: exporter handles decide the scale of the bind pose. Smaller: stretched bones are ignored. Shown by the tests
/// of `assembly`.
pub(crate) const BOUND_ALIKE: f32 = 0.1;

// roles/beside.rs

/// Farthest that the root of a side skeleton rests from a bone of the main one to move with it in the bind pose, as a share of
/// the main one's size.
///
/// Larger: a pet is moved with its owner. Smaller: hair stays where the body rests. Shown by the tests of `assembly`.
pub(crate) const AT_MAIN: f32 = 0.15;

/// Least ratio of the bones of the main skeleton to those of one beside it that goes with it.
///
/// Larger: hair of many strands stays where the body rests. Smaller: a second character is moved. Shown by the tests of
/// `assembly`.
pub(crate) const SIDE_BONES: usize = 2;

// roles/characters.rs

/// Least share of a skeleton's box, along each axis, inside another's, to belong to it.
///
/// Larger: protruding clothes are characters. Smaller: characters that stand close together are merged. Shown by the
/// tests of `assembly`.
pub(crate) const LIES_WITHIN: f32 = 0.5;

/// Largest side of a skeleton that belongs to one beside it, as a share of that one's.
///
/// Larger: a dog belongs to its owner. Smaller: a hat is a character. Shown by the tests of `assembly`.
pub(crate) const SMALL_BESIDE: f32 = 0.25;

/// Least size of a skeleton within another's box that may be its own character, as a share of that one's.
///
/// Larger: surrounded characters are merged. Smaller: a wig is a character. Shown by the tests of `assembly`.
pub(crate) const LARGE_WITHIN: f32 = 0.4;

/// Fewest bones of a character within another's box.
///
/// Larger: a bird on a shoulder is merged. Smaller: a coat with its own bones is a character. Shown by the tests of
/// `assembly`.
pub(crate) const BONES_OF_A_CHARACTER: usize = 8;

/// Farthest that bones of clothes are from those of the body, as a share of its size.
///
/// Larger: a character inside another counts as its clothes. Smaller: fitted clothes are characters. Shown by the tests
/// of `assembly`.
pub(crate) const SAME_BONE: f32 = 0.02;

// roles/gait.rs

/// Poses a second sampled from a clip for its gait, 1/s.
///
/// Larger: slower. Smaller: a run's swing falls between them. Shown by the tests of `hints`.
pub(crate) const GAIT_RATE: f32 = 24.0;

/// Least length of a clip of walking, seconds.
///
/// Larger: short cycles are missed. Smaller: poses count as clips. Shown by the tests of `hints`.
pub(crate) const SHORTEST_WALK: f32 = 0.2;

/// Least ratio of the variance of alternating swing to that of common swing.
///
/// Larger: a walk with a sway has no legs. Smaller: hops have. Shown by the tests of `hints`.
pub(crate) const IN_TURNS: f32 = 4.0;

/// Largest ratio of the variances of two limbs that swing as a pair.
///
/// Larger: one striking arm counts as a pair of legs. Smaller: a limp does not. Shown by the tests of `hints`.
pub(crate) const SWINGS_ALIKE: f32 = 3.0;

/// Least swing of legs, root mean square, as a share of the body's height.
///
/// Larger: short steps are ignored. Smaller: breathing counts. Shown by the tests of `hints`.
pub(crate) const LEAST_SWING: f32 = 0.03;

// roles/graph.rs

/// Largest distance of a foot beside the body from the skin of its leaf, as a share of the skin's size.
///
/// Larger: a foot is attached to the wrong leg. Smaller: it stays alone. Shown by the tests of `wild`.
pub(crate) const FOOT_AT_SKIN: f32 = 0.06;

/// Largest distance of a foot parented to the root from the end of its leg, as a share of the skin's size.
///
/// Larger: IK targets count as feet. Smaller: feet with a gap stay behind. Shown by the tests of `wild`.
pub(crate) const FOOT_AT_END: f32 = 0.01;

/// Largest difference of the distances of twins from the root, as a share of the skin's size.
///
/// Larger: any two are twins. Smaller: slightly asymmetric rigs have none. Shown by the tests of `creatures`.
pub(crate) const TWIN_PLACE: f32 = 0.025;

/// Least area of skin that a twin moves, as a share of the other's.
///
/// Larger: legs of uneven meshes are no twins. Smaller: a leg and a finger are. Shown by the tests of `creatures`.
pub(crate) const TWIN_AREA: f32 = 0.6;

// roles/humanoid.rs

/// Least distance along a forearm of the nearer of two joints, as a share of the other's, for fingers.
///
/// Larger: misses a thumb that begins early. Smaller: a twist bone counts as a finger. Shown by the tests of `roles`.
pub(crate) const FORKED: f32 = 0.8;

/// Largest spread of the fingers' starts, as a share of their distance from the parent, for which that place is the
/// wrist.
///
/// Larger: palms are lost. Smaller: fingers hang on the forearm. Shown by the tests of `roles`.
pub(crate) const AT_WRIST: f32 = 0.15;

/// Longest palm, as a share of the forearm's length, also of a figure with large hands.
///
/// Larger: forearms are palms. Smaller: large hands are forearms. Shown by the tests of `roles`.
pub(crate) const LONGEST_PALM: f32 = 0.7;

/// Largest difference of the heights of two joints that are as high, as a share of the body's height.
///
/// Larger: knees are as high as ankles. Smaller: rounding decides. Shown by the tests of `roles`.
pub(crate) const AS_HIGH: f32 = 0.02;

/// Lowest hips of a figure with a large head, as a share of its height.
///
/// Larger: the legs of dolls are not recognised. Smaller: feet count as legs. Shown by the tests of `roles`.
pub(crate) const LOWEST_HIP: f32 = 0.1;

/// Largest distance of the inner end of a limb from the midline, as a share of that of its next joint.
///
/// Larger: thighs and upper arms close to the midline count as hips and clavicles. Smaller: inner ends slightly aside
/// count as thighs. Shown by the tests of `assembly`.
pub(crate) const INNER_END: f32 = 0.1;

// roles/keep.rs

/// Least share of all skin for a body of a creature, 0 to 1.
///
/// Larger: ends of tails and legs go stiff. Smaller: ears and claws are bodies. Shown by the tests of `creatures`.
pub(crate) const LEAST_BODY_SKIN: f32 = 0.004;

/// Least share of all skin for a separate part of the spine, 0 to 1.
///
/// Larger: snakes become stiff. Smaller: short vertebrae make weak joints. Shown by the tests of `creatures`.
pub(crate) const LEAST_SPINE_SKIN: f32 = 0.02;

/// Distance from the bone of an upper arm without skin, over that from the trunk's line, below which the spine's skin is
/// the arm's.
///
/// Larger: hanging arms take the skin of the waist. Smaller: arms thicken the chest. Shown by the variants of
/// `RiggedFigure` (1) and of `Witch` (0.5).
pub(crate) const ON_BARE_ARM: f32 = 0.7;

/// Shortest clavicle that is a body, as a share of the height.
///
/// Larger: shoulders are rigid. Smaller: bodies that nothing collides with. Shown by the tests of `roles`.
pub(crate) const LEAST_CLAVICLE: f32 = 0.05;

/// Distance around the skin's box within which a mesh without a bone counts as worn, as a share of the skin's size.
///
/// Larger: a table beside a figure follows it. Smaller: a backpack stays behind. Shown by the tests of `assembly`.
pub(crate) const WORN_WITHIN: f32 = 0.08;

/// Longest side of such a mesh, as a share of the skin's size.
///
/// Larger: the ground under a figure follows it. Smaller: a rifle stays behind. Shown by the tests of `assembly`.
pub(crate) const LARGEST_WORN: f32 = 0.9;

/// Longest side of a mesh on the skeleton's node that touches the body, as a share of the skin's size.
///
/// Larger: a stage under a figure follows it. Smaller: a goblin's head stays in the air. Shown by the tests of
/// `assembly`.
pub(crate) const LARGEST_ON_ARMATURE: f32 = 1.2;

/// Most vertices that vote on the body of a part without a bone.
///
/// Larger: slower for scenes with many parts. Smaller: single vertices decide. Shown by the tests of `assembly`.
pub(crate) const VOTERS: usize = 48;

// roles/props.rs

/// Least longest side of a prop with its own body, as a share of the skin's.
///
/// Larger: swords stick in the floor. Smaller: buttons have bodies. Shown by the tests of `rig_variants` of the ragdolls.
pub(crate) const LEAST_PROP: f32 = 0.1;

/// Least distance outside the box of its carrier's skin at which a vertex protrudes, as a share of the skin's size.
///
/// Larger: hats are part of the head. Smaller: collars are props. Shown by the tests of `rig_variants` of the ragdolls.
pub(crate) const PROP_BEYOND: f32 = 0.05;

/// Least share of a prop's vertices that protrude, 0 to 1.
///
/// Larger: misses a shield held close. Smaller: a belt counts as a prop. Shown by the tests of `rig_variants` of the
/// ragdolls.
pub(crate) const PROP_SHARE: f32 = 0.1;

/// Confidence of a prop, 0 to 1.
///
/// It affects only a report. No scene shows it.
pub(crate) const PROP_CONFIDENCE: f32 = 0.5;

// roles/symmetry.rs

/// Farthest that a joint may be from its mirror image, as a share of the size of the skin.
///
/// Larger: finds false planes. Smaller: sculpted figures have none. Shown by the tests of
/// `creatures`.
pub(crate) const MIRROR_TOLERANCE: f32 = 0.025;

// roles/units.rs

/// Weight of the unit in which the program that wrote the file writes, in the measure of a unit's rarity.
///
/// Larger: accepts giants of a program that writes metres. Smaller: ignores the program. Shown by the tests of `hints`.
pub(crate) const UNIT_BY_EXPORTER: f32 = 1.0;

/// Weight of a unit that all neighbouring files have, in the measure of [`UNIT_BY_EXPORTER`].
///
/// Larger: one bad file of a kit follows the others. Smaller: files of one kit get different sizes. Shown by the tests
/// of `hints`.
pub(crate) const UNIT_BY_KIN: f32 = 2.0;

/// Height of a human as a share of the free height under a door, 0 to 1.
///
/// Doors of 2.05 m suit 1.75 m. Larger or smaller: figures sized by a door grow or shrink with it. Shown by the tests
/// of `hints`.
pub(crate) const UNDER_DOOR: f32 = 0.85;

/// Speed of strides in square roots of gravity and the length of the legs, between a walk's 3.6 and a run's 2.3 strides.
///
/// Larger or smaller: figures without other hints shrink or grow by its square. Shown by the tests of `hints`.
pub(crate) const STRIDE_SPEED: f32 = 3.0;

/// Least height that the head of an adult implies, metres.
///
/// Larger: short adults are children. Smaller: dolls are adults. Shown by the tests of `hints`.
pub(crate) const GROWN_BY_HEAD: f32 = 1.3;

/// Least height of a human that files, doors or steps show to be small, metres.
///
/// Larger: dolls are scaled to adults. Smaller: unusual units are accepted. Shown by the tests of `hints`.
pub(crate) const SHORTEST: f32 = 0.5;

/// Largest ratio, either way, of leg length to that implied by the stride, for the stride to confirm a height.
///
/// Larger: any walk confirms any height. Smaller: hurried walks confirm none. Shown by the tests of `hints`.
pub(crate) const STEPS_ALIKE: f32 = 1.5;
