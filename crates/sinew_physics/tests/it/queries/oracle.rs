//! Shapes in `f64`, by their distance functions alone: what a ray meets and what a point is in follows by search.

use crate::boxes::oracle::{Wide, add, dot, length, wide};
use sinew_math::{Rotation, Transform, Vec3};
use sinew_physics::Shape;

/// A placed shape.
pub struct WideShape<'a> {
    shape: &'a Shape,
    center: Wide,
    axes: [Wide; 3],
}

impl<'a> WideShape<'a> {
    pub fn new(shape: &'a Shape, frame: &Transform) -> Self {
        let axes = crate::boxes::oracle::axes(frame.rotation);
        Self { shape, center: wide(frame.translation), axes }
    }

    fn local(&self, p: Wide) -> Wide {
        let d = add(p, self.center, -1.0);
        self.axes.map(|axis| dot(d, axis))
    }

    /// Distance from a point to the surface, negative inside.
    pub fn signed_distance(&self, p: Wide) -> f64 {
        let q = self.local(p);
        match *self.shape {
            Shape::Box { half_extents } => {
                let beyond = [0, 1, 2].map(|k| q[k].abs() - wide(half_extents)[k]);
                let deepest = beyond.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
                length(beyond.map(|x| x.max(0.0))) + deepest.min(0.0)
            }
            Shape::Sphere { radius } => length(q) - f64::from(radius),
            Shape::Capsule { half_height, radius } => {
                let h = f64::from(half_height);
                length([q[0], q[1] - q[1].clamp(-h, h), q[2]]) - f64::from(radius)
            }
            Shape::HalfSpace => q[1],
        }
    }

    /// The fraction of a segment at which it enters the shape: the distance along a line is a convex function, searched for
    /// its least and, before it, for 0.
    pub fn enter(&self, origin: Wide, direction: Wide) -> Option<f64> {
        let at = |t: f64| self.signed_distance(add(origin, direction, t));
        if at(0.0) <= 0.0 {
            return Some(0.0);
        }
        let (mut lo, mut hi) = (0.0, 1.0);
        for _ in 0..100 {
            let (a, b) = (lo + (hi - lo) / 3.0, hi - (hi - lo) / 3.0);
            if at(a) <= at(b) { hi = b } else { lo = a }
        }
        let least = if at(1.0) <= at(lo) { 1.0 } else { lo };
        if at(least) > 0.0 {
            return None;
        }
        let (mut outside, mut inside) = (0.0, least);
        for _ in 0..80 {
            let middle = 0.5 * (outside + inside);
            if at(middle) > 0.0 { outside = middle } else { inside = middle }
        }
        Some(inside)
    }

    /// Least distance along a segment.
    pub fn least_distance(&self, origin: Wide, direction: Wide) -> f64 {
        let at = |t: f64| self.signed_distance(add(origin, direction, t));
        let (mut lo, mut hi) = (0.0, 1.0);
        for _ in 0..100 {
            let (a, b) = (lo + (hi - lo) / 3.0, hi - (hi - lo) / 3.0);
            if at(a) <= at(b) { hi = b } else { lo = a }
        }
        at(lo).min(at(0.0)).min(at(1.0))
    }
}
