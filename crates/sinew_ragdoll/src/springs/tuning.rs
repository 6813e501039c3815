//! Behaviour constants of springs: unit, reason, and the effect of a larger and a smaller value.

/// Time between two ticks, seconds: one frame at 60 frames a second, for which springs are authored.
///
/// The time belongs to the format: stiffness, drag and gravity of a file are per frame at 60 frames a second. Shown by
/// the tests of `springs`.
pub const TICK: f32 = 1.0 / 60.0;

/// Distance from a tick, in ticks, within which a step ends at the tick: the error of summed rounded steps, at most 17
/// µs.
///
/// Larger: a frame is shown early by this share of a tick. Smaller: rounding decides whether a tick happens in this
/// step or in the next. Shown by the tests of `springs` at 30 to 240 frames a second.
pub(super) const SNAP: f32 = 1e-3;

/// Drag below which a part of a tick uses the drag-free form, a share of the speed; the exact form would lose digits to
/// cancellation.
///
/// Larger: the state shown between ticks is wrong by this share of its motion. Smaller: the state is wrong by rounding.
/// Shown by `hair`.
pub(super) const SLIGHT_DRAG: f32 = 1e-3;

/// Largest ratio between the lengths of two consecutive steps for which the path between poses is curved.
///
/// Larger: a hitch of the host's clock bends the path after it. Smaller: a varying frame rate puts corners into paths.
/// Shown by the tests of `springs` with uneven steps.
pub(super) const ALIKE: f32 = 4.0;

/// Distance at which a moving tip touches a collider, metres.
///
/// Larger: fast tips stop short. Smaller: a tip needs more iterations to reach a collider. Shown by
/// `fast_tip_is_stopped_by_a_thin_collider`.
pub(super) const CLOSE: f32 = 1e-4;

/// Largest number of iterations toward a collider within a tick, each by the remaining distance; a tip that is not
/// close by then passes.
///
/// Larger: iterations cost time without effect. Smaller: a tip that grazes a collider passes through. Shown by
/// `fast_tip_is_stopped_by_a_thin_collider`.
pub(super) const MOST_LEAPS: usize = 24;

/// Displacement per tick above which a tip with a smaller radius is swept through the world, metres.
///
/// Larger: tips without a radius pass through thin obstacles. Smaller: every tip near the world is swept. Shown by
/// `fast_tip_is_stopped_by_a_thin_wall`.
pub(super) const THIN: f32 = 0.002;

/// Iterations over the links between strands within a tick.
///
/// Larger: a pull on one strand of a skirt reaches more strands at once. Smaller: a leg tears the skirt apart. Shown by
/// `spring_links_limit_the_distance_of_strands`.
pub(super) const LINK_SWEEPS: usize = 4;

/// Time in which the rotation of distant springs from the pose falls to 1/e, seconds.
///
/// Larger: distant springs cost time for longer. Smaller: a strand far from its pose visibly snaps. Shown by the tests
/// of `springs::changes`.
pub(super) const EASE: f32 = 0.3;

/// Rotation from the pose below which distant springs are set to the pose, radians. The tip of a strand of half a metre
/// then moves by 0.01 mm, which is 2 mm/s at 240 frames a second.
///
/// Larger: the motion ends with a jerk. Smaller: distant springs cost time for longer, 0.3 s for each factor of e.
/// Shown by the tests of `springs::changes`.
pub(super) const GONE: f32 = 2e-5;
