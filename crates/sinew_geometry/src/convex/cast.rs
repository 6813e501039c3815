//! Shape casts by conservative advancement (Mirtich, "Impulse-based dynamic simulation of rigid body systems", PhD
//! thesis 1996, §3.2).

use super::pair::{Gap, gap};
use crate::shape::Shape;
use sinew_math::{Transform, Vec3, min};

/// First touch of a moving shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeHit {
    /// Fraction of the motion before the hit, 0..=1.
    pub fraction: f32,
    /// Contact point of the two shapes, world, metres.
    pub point: Vec3,
    /// Unit normal, out of the other shape and against the moving one, world.
    pub normal: Vec3,
}

/// Gap that counts as touching, as a share of the smaller shape's size; [`CLOSE_STEP`] of the motion is added to it.
const CLOSE: f32 = 1e-5;
const CLOSE_STEP: f32 = 1e-7;
/// Largest number of steps of a cast. They are Newton steps: only motions that graze a round shape need more than a
/// few.
const MOST_STEPS: usize = 64;

/// Moves `a` by `motion` (metres) and returns its first touch of `b`. Returns `None` if they do not touch, or if a
/// number is not finite. `a` must not be a half-space, mesh or height field.
///
/// Shapes that overlap or touch at the start hit at fraction 0: the normal is the shortest way of A out of B, and the
/// point is in the middle of the overlap. A later hit is reported where the gap falls below 1e-5 of the smaller shape.
/// If the gap stops closing before that, the result is `None`.
pub fn cast_shape(
    a: &Shape,
    world_from_a: &Transform,
    motion: Vec3,
    b: &Shape,
    world_from_b: &Transform,
) -> Option<ShapeHit> {
    if !motion.is_finite() {
        return None;
    }
    let close = closeness(min(a.bounding_radius(), b.bounding_radius()), motion);
    advance(motion, close, |way| {
        let moved = Transform::new(world_from_a.translation + way, world_from_a.rotation);
        gap(a, &moved, b, world_from_b)
    })
}

/// Like [`cast_shape`], with touch distance `close`; `gap_after` returns the gap after a part of the motion.
pub fn advance(motion: Vec3, close: f32, mut gap_after: impl FnMut(Vec3) -> Option<Gap>) -> Option<ShapeHit> {
    let hit_of = |gap: Gap, fraction: f32| ShapeHit {
        fraction,
        point: (gap.on_a + gap.on_b) * 0.5,
        normal: -gap.normal,
    };
    let (mut now, mut fraction) = (gap_after(Vec3::ZERO)?, 0.0);
    if now.distance <= 0.0 {
        return Some(hit_of(now, 0.0));
    }
    for _ in 0..MOST_STEPS {
        // No part of B is in front of the plane across the gap.
        let approach = motion.dot(now.normal);
        if approach <= 0.0 {
            return None;
        }
        if now.distance <= close {
            return Some(hit_of(now, fraction));
        }
        fraction += now.distance / approach;
        if fraction > 1.0 {
            return None;
        }
        now = gap_after(motion * fraction)?;
    }
    Some(hit_of(now, fraction))
}

/// Gap at which two shapes count as touching, metres, if the smaller one has this radius and the motion is `motion`.
pub fn closeness(radius: f32, motion: Vec3) -> f32 {
    CLOSE * radius + CLOSE_STEP * motion.length()
}
