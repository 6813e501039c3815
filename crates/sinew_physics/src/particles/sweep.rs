//! A ball on a straight way against a shape.

use crate::shape::Shape;
use sinew_math::{Vec3, max};

/// Where a ball on its way meets a shape, in the shape's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    /// Share of the way before, 0..=1.
    pub fraction: f32,
    /// Centre of the ball.
    pub at: Vec3,
    /// Unit, out of the shape.
    pub normal: Vec3,
    /// What is still between them, metres; negative where the way begins inside.
    pub gap: f32,
}

impl Meeting {
    /// Distance of a point from the plane in which the ball's centre lies when it touches.
    pub fn height(&self, point: Vec3) -> f32 {
        self.gap + (point - self.at).dot(self.normal)
    }
}

/// Each round gains at least as many digits as there are already, but for ways that graze.
const ROUNDS: u32 = 32;

/// The first place on the way from `from` to `to` (the shape's frame) where a ball of this radius touches the shape on
/// approach, `None` if it passes. Works for every convex shape by its signed distance: all of the shape lies behind the
/// plane at the closest point, so the ball can go on to that plane at least (Newton's method on the distance, from the
/// side on which it never goes too far).
pub(super) fn sweep_ball(shape: &Shape, radius: f32, from: Vec3, to: Vec3) -> Option<Meeting> {
    let length = (to - from).length();
    if length < 1e-12 {
        return None;
    }
    let along = (to - from) / length;
    let touching = 1e-5 + 1e-6 * max(from.length(), to.length());
    let mut travelled = 0.0;
    let mut meeting = None;
    for _ in 0..ROUNDS {
        let at = from + along * travelled;
        let (distance, normal) = shape.local_distance(at);
        let (gap, closing) = (distance - radius, -along.dot(normal));
        if closing <= 0.0 {
            return None;
        }
        meeting = Some(Meeting { fraction: travelled / length, at, normal, gap });
        if gap <= touching {
            break;
        }
        travelled += gap / closing;
        if travelled > length {
            return None;
        }
    }
    meeting
}
