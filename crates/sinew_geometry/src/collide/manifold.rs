//! Contact manifolds of two shapes.

use crate::boxes::separation::{Axis, AxisOf};
use sinew_math::Vec3;

/// Maximum number of points in a manifold.
pub const MAX_POINTS: usize = 4;

/// One point of a manifold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ManifoldPoint {
    /// Midpoint between the two surfaces, in the common frame of the shapes (world), metres.
    pub position: Vec3,
    /// Gap along the normal, metres; negative if the surfaces overlap.
    pub separation: f32,
    /// Feature id: A's feature in the low 16 bits, B's in the high 16 bits. The id does not change across steps while
    /// the same features touch. Swapping the shapes exchanges the halves (`feature.rotate_left(16)`).
    pub feature: u32,
}

/// Contact of two convex shapes that touch or are near: a normal and up to four points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Manifold {
    /// Unit normal from A to B.
    pub normal: Vec3,
    /// Points; only the first `count` are valid.
    pub points: [ManifoldPoint; MAX_POINTS],
    /// Number of points, 0..=4.
    pub count: usize,
}

impl Manifold {
    /// Returns the valid points.
    #[inline]
    pub fn points(&self) -> &[ManifoldPoint] {
        &self.points[..self.count]
    }

    /// Mean of the valid points, metres; the origin if there are none.
    #[inline]
    pub fn center(&self) -> Vec3 {
        let sum = self.points().iter().fold(Vec3::ZERO, |sum, point| sum + point.position);
        if self.count > 0 { sum / self.count as f32 } else { sum }
    }

    /// Appends a point; `position` is midway between the surfaces.
    pub(super) fn push(&mut self, position: Vec3, separation: f32, feature: u32) {
        self.points[self.count] = ManifoldPoint { position, separation, feature };
        self.count += 1;
    }

    /// Appends a point, or replaces the shallowest one if the manifold is full.
    pub(super) fn push_or_replace_shallowest(&mut self, position: Vec3, separation: f32, feature: u32) {
        if self.count < MAX_POINTS {
            self.push(position, separation, feature);
        } else {
            let deeper =
                |a: &usize, b: &usize| self.points[*a].separation.total_cmp(&self.points[*b].separation);
            let shallowest = (0..MAX_POINTS).max_by(deeper).unwrap_or(0);
            self.points[shallowest] = ManifoldPoint { position, separation, feature };
        }
    }

    /// Converts the result for (B, A) to the result for (A, B).
    pub(super) fn flip(&mut self) {
        self.normal = -self.normal;
        for point in &mut self.points[..self.count] {
            point.feature = point.feature.rotate_left(16);
        }
    }

    /// Converts positions relative to `origin` to world positions; drops all points if a number is not finite.
    pub(super) fn finish(&mut self, origin: Vec3) {
        for point in &mut self.points[..self.count] {
            point.position += origin;
        }
        let sane = |p: &ManifoldPoint| p.position.is_finite() && p.separation.is_finite();
        if !self.normal.is_finite() || !self.points().iter().all(sane) {
            self.count = 0;
        }
    }
}

/// Cache that a caller keeps for a pair of shapes between calls. Its contents never change the resulting manifold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeparationCache {
    /// Axis that separated two polytopes in the last call. It is tested first, since separated pairs mostly stay
    /// separated along the same axis.
    pub axis: Option<AxisOf>,
    /// Lower bound of the gap between the shapes, metres. Valid after a call that found no points.
    pub gap: f32,
}

impl Default for SeparationCache {
    /// Returns an empty cache.
    fn default() -> Self {
        Self { axis: None, gap: f32::NEG_INFINITY }
    }
}

impl SeparationCache {
    /// Returns the cache for two shapes that this axis separates.
    pub(super) fn along(axis: &Axis) -> Self {
        Self { axis: Some(axis.of), gap: axis.separation }
    }
}
