//! Oracle for queries: shapes in `f64`, given by their distance functions, in which hits are found by search.

use crate::wide::{Wide, add, axes, dot, length, wide};
use sinew_math::Transform;
use sinew_physics::Shape;

/// A shape and its pose.
pub struct WideShape<'a> {
    shape: &'a Shape,
    center: Wide,
    axes: [Wide; 3],
}

impl<'a> WideShape<'a> {
    pub fn new(shape: &'a Shape, frame: &Transform) -> Self {
        Self { shape, center: wide(frame.translation), axes: axes(frame.rotation) }
    }

    fn local(&self, p: Wide) -> Wide {
        let d = add(p, self.center, -1.0);
        self.axes.map(|axis| dot(d, axis))
    }

    /// Returns the distance from the surface to a point, negative inside.
    pub fn signed_distance(&self, p: Wide) -> f64 {
        let q = self.local(p);
        let flat = q[0].hypot(q[2]);
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
            Shape::Cylinder { half_height, radius } => {
                let beyond = [flat - f64::from(radius), q[1].abs() - f64::from(half_height)];
                length([beyond[0].max(0.0), beyond[1].max(0.0), 0.0]) + beyond[0].max(beyond[1]).min(0.0)
            }
            Shape::Cone { half_height, radius } => {
                let (h, r) = (f64::from(half_height), f64::from(radius));
                let to_base = to_segment([flat, q[1]], [0.0, -h], [r, -h]);
                let to_side = to_segment([flat, q[1]], [r, -h], [0.0, h]);
                let inside = q[1] >= -h && flat * 2.0 * h + (q[1] - h) * r <= 0.0;
                to_base.min(to_side) * if inside { -1.0 } else { 1.0 }
            }
            Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
                let (h, bottom, top) =
                    (f64::from(half_height), f64::from(radius_bottom), f64::from(radius_top));
                // Sine and cosine of the slope of the side.
                let b = (bottom - top) / (2.0 * h);
                let a = (1.0 - b * b).sqrt();
                let along = -b * flat + a * (q[1] + h);
                if along < 0.0 {
                    flat.hypot(q[1] + h) - bottom
                } else if along > a * 2.0 * h {
                    flat.hypot(q[1] - h) - top
                } else {
                    a * flat + b * (q[1] + h) - bottom
                }
            }
            Shape::HalfSpace => q[1],
            Shape::Hull(_) | Shape::Mesh(_) | Shape::HeightField(_) => {
                panic!("the oracle has no distance function for hulls and surfaces")
            }
        }
    }

    /// Returns the smallest signed distance along a segment, by a search: along it the distance is a convex function.
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

/// Returns the distance from a point to a segment in a plane.
fn to_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (way, from) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let along = (from[0] * way[0] + from[1] * way[1]) / (way[0] * way[0] + way[1] * way[1]);
    let t = along.clamp(0.0, 1.0);
    (from[0] - way[0] * t).hypot(from[1] - way[1] * t)
}
