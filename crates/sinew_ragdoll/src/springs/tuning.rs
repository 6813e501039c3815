//! Constants of behaviour of springs: each with its unit, its reason, and what a larger and a smaller one does.

/// Time between two ticks, seconds: that of the frames for which springs are authored.
///
/// It belongs to the format: stiffness, drag and gravity of a file are those of 60 frames a second. Shown by the tests of `springs`.
pub const TICK: f32 = 1.0 / 60.0;

/// Distance from a tick, in ticks, within which a step ends at it: what sums of rounded steps are off by, and no more than 17 µs.
///
/// Larger: a frame is shown early by as much. Smaller: rounding decides whether a tick is taken in this step or in the next. Shown by the
/// tests of `springs` at 30 to 240 frames a second.
pub(super) const SNAP: f32 = 1e-3;

/// Drag below which a part of a tick is taken for free of it, a share of the speed: the exact form would lose its digits.
///
/// Larger: what is shown between ticks is off by as much of its way. Smaller: it is off by rounding. Shown by `hair`.
pub(super) const SLIGHT_DRAG: f32 = 1e-3;

/// Most that the lengths of two steps in a row may differ by for the way between poses to be bent, a factor.
///
/// Larger: a hitch of the host's clock bends the way after it. Smaller: a frame rate that wavers has corners in its ways. Shown by the tests of
/// `springs` with uneven steps.
pub(super) const ALIKE: f32 = 4.0;

/// Distance at which a tip on its way touches a collider, metres.
///
/// Larger: fast tips stop short. Smaller: more leaps to come that near. Shown by `a_fast_tip_does_not_pass_through_a_thin_collider`.
pub(super) const CLOSE: f32 = 1e-4;

/// Leaps toward a collider within a tick, each by the distance that is left: what has not come close by then passes by.
///
/// Larger: nothing but work. Smaller: a tip that grazes a collider is let through. Shown by `a_fast_tip_does_not_pass_through_a_thin_collider`.
pub(super) const MOST_LEAPS: usize = 24;

/// Way in a tick from which on a tip is looked for on its way through the world, metres, if its radius is less.
///
/// Larger: tips without a radius pass through what is thin. Smaller: every tip near the world asks for its way. Shown by
/// `a_fast_tip_does_not_pass_through_a_thin_wall`.
pub(super) const THIN: f32 = 0.002;

/// Times within a tick that links between strands are gone through, one after the other.
///
/// Larger: a pull on one strand of a skirt comes to more of the others at once. Smaller: the skirt is torn apart where a leg pulls. Shown by
/// `links_hold_strands_together`.
pub(super) const LINK_SWEEPS: usize = 4;

/// Time in which what springs seen from afar are off from the pose falls to 1/e, seconds.
///
/// Larger: they cost something for longer. Smaller: a strand that hangs far from its pose is seen to fly there. Shown by the tests of `springs::changes`.
pub(super) const EASE: f32 = 0.3;

/// Turn from the pose below which springs seen from afar are the pose, radians: the tip of a strand of half a metre then goes on by 0.01 mm,
/// which is 2 mm/s at 240 frames a second.
///
/// Larger: the end of the way is a jerk. Smaller: they cost something for longer, 0.3 s for each factor of e. Shown by the tests of `springs::changes`.
pub(super) const GONE: f32 = 2e-5;
