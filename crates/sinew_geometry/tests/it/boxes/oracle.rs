//! Oracle for boxes, by enumeration and by search in `f64`.

use crate::wide::{Wide, add, axes, dot, length, wide};
use sinew_geometry::boxes::PlacedBox;
use sinew_geometry::{Aabb, Obb};
use sinew_math::Rotation;

pub fn cross(a: Wide, b: Wide) -> Wide {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A box in `f64`, with axes from the quaternion.
#[derive(Clone, Copy, Debug)]
pub struct WideBox {
    pub center: Wide,
    pub axes: [Wide; 3],
    pub half: Wide,
}

impl From<&Obb> for WideBox {
    fn from(obb: &Obb) -> Self {
        Self { center: wide(obb.center), axes: axes(obb.rotation), half: wide(obb.half_extents) }
    }
}

impl From<&Aabb> for WideBox {
    fn from(aabb: &Aabb) -> Self {
        let (min, max) = (wide(aabb.min), wide(aabb.max));
        Self {
            center: [0, 1, 2].map(|k| 0.5 * (min[k] + max[k])),
            axes: axes(Rotation::IDENTITY),
            half: [0, 1, 2].map(|k| 0.5 * (max[k] - min[k])),
        }
    }
}

impl From<&PlacedBox> for WideBox {
    fn from(placed: &PlacedBox) -> Self {
        Self { center: wide(placed.center), axes: placed.axes.map(wide), half: wide(placed.half) }
    }
}

impl WideBox {
    pub fn local(&self, p: Wide) -> Wide {
        let d = add(p, self.center, -1.0);
        self.axes.map(|axis| dot(d, axis))
    }

    pub fn point(&self, q: Wide) -> Wide {
        (0..3).fold(self.center, |p, k| add(p, self.axes[k], q[k]))
    }

    pub fn moved(&self, by: Wide) -> Self {
        Self { center: add(self.center, by, 1.0), ..*self }
    }

    /// Sum of the half extents.
    pub fn size(&self) -> f64 {
        self.half.iter().sum()
    }

    /// Returns the farthest extent of the box along a direction, from the origin.
    pub fn support(&self, n: Wide) -> f64 {
        dot(self.center, n) + (0..3).map(|k| self.half[k] * dot(self.axes[k], n).abs()).sum::<f64>()
    }

    pub fn edges(&self) -> impl Iterator<Item = [Wide; 2]> {
        let corner = |bits: usize| {
            self.point([0, 1, 2].map(|k| if bits >> k & 1 == 1 { self.half[k] } else { -self.half[k] }))
        };
        (0..3).flat_map(move |axis| {
            (0..8)
                .filter(move |bits| bits >> axis & 1 == 0)
                .map(move |bits| [corner(bits), corner(bits | 1 << axis)])
        })
    }

    /// True if a part of a segment is in the box, enlarged by `grow` on every side.
    fn meets_segment(&self, ends: [Wide; 2], grow: f64) -> bool {
        let [p, q] = ends.map(|p| self.local(p));
        let (mut first, mut last) = (0.0f64, 1.0f64);
        for k in 0..3 {
            let half = self.half[k] + grow;
            let step = q[k] - p[k];
            if step.abs() < 1e-300 {
                if p[k].abs() > half {
                    return false;
                }
                continue;
            }
            let (t0, t1) = ((-half - p[k]) / step, (half - p[k]) / step);
            first = first.max(t0.min(t1));
            last = last.min(t0.max(t1));
        }
        first <= last
    }

    /// True if two boxes, the first enlarged by `grow`, have a point in common: then an edge of one enters the other.
    pub fn meets(&self, other: &Self, grow: f64) -> bool {
        if self.half.iter().any(|h| h + grow < 0.0) {
            return false;
        }
        let grown = Self { half: self.half.map(|h| h + grow), ..*self };
        other.edges().any(|edge| self.meets_segment(edge, grow))
            || grown.edges().any(|edge| other.meets_segment(edge, 0.0))
    }

    /// Returns the distance from a point to the nearest of the six faces, negative inside.
    pub fn signed_distance(&self, p: Wide) -> f64 {
        let q = self.local(p);
        let mut nearest = f64::INFINITY;
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let foot = [0, 1, 2].map(|k| {
                    if k == axis { side * self.half[k] } else { q[k].max(-self.half[k]).min(self.half[k]) }
                });
                nearest = nearest.min(length(add(q, foot, -1.0)));
            }
        }
        let inside = (0..3).all(|k| q[k].abs() <= self.half[k]);
        if inside { -nearest } else { nearest }
    }

    /// Returns the distance from the solid box to a segment, by minimising a convex function of the position on the
    /// segment.
    pub fn distance_to_segment(&self, ends: [Wide; 2]) -> f64 {
        let along = add(ends[1], ends[0], -1.0);
        let at = |t: f64| self.signed_distance(add(ends[0], along, t)).max(0.0);
        let (mut lo, mut hi) = (0.0, 1.0);
        for _ in 0..80 {
            let (a, b) = (lo + (hi - lo) / 3.0, hi - (hi - lo) / 3.0);
            let (fa, fb) = (at(a), at(b));
            if fa == 0.0 || fb == 0.0 {
                return 0.0;
            }
            if fa < fb { hi = b } else { lo = a }
        }
        at(0.5 * (lo + hi)).min(at(0.0)).min(at(1.0))
    }

    /// Returns the smallest sine between an edge of each box, excluding edges that are parallel within `f32`.
    pub fn least_sine(&self, other: &Self) -> f64 {
        let sines = self.axes.iter().flat_map(|u| other.axes.iter().map(|v| length(cross(*u, *v))));
        sines.filter(|sine| *sine > 1e-6).fold(1.0, f64::min)
    }
}
