//! Narrow phase: from two placed shapes to a manifold.

use sinew_math::Vec3;

/// At most this many points describe the contact of two shapes.
pub const MAX_POINTS: usize = 4;

/// One point of a manifold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ManifoldPoint {
    /// Half-way between the two surfaces, in the frame the shapes were given in (world), metres.
    pub position: Vec3,
    /// Gap along the normal, metres; negative when they overlap.
    pub separation: f32,
    /// Which features touch; the same from step to step while the same features do, and for both orders of the shapes.
    pub feature: u32,
}

/// Where and how two convex shapes touch or are about to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Manifold {
    /// Unit, from A to B.
    pub normal: Vec3,
    /// The points; only the first `count` count.
    pub points: [ManifoldPoint; MAX_POINTS],
    /// How many points, 0..=4.
    pub count: usize,
}

impl Manifold {
    /// The points that count.
    pub fn points(&self) -> &[ManifoldPoint] {
        &self.points[..self.count]
    }
}
