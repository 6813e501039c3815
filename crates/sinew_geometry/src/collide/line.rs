//! Contact along a line: a capsule on a face or along an edge.

use super::feature::{end, pair};
use super::manifold::Manifold;
use super::placed::Segment;
use sinew_math::Vec3;

/// Part of a capsule's core over a face or along an edge.
pub(super) struct Line<'a> {
    pub core: &'a Segment,
    pub radius: f32,
    /// Range of the core's parameter, 0..=1.
    pub stretch: (f32, f32),
    /// Unit normal from the face or edge to the core.
    pub normal: Vec3,
    /// Name of the face or edge.
    pub name: u16,
}

impl Line<'_> {
    /// Pushes the two ends of the part. A is the solid that the capsule touches; `height` returns the height of a point
    /// over A's face or edge. Returns false if the part is too short for two points, or neither end is within the
    /// margin; no points are pushed then.
    pub fn push_ends(&self, height: impl Fn(Vec3) -> f32, margin: f32, out: &mut Manifold) -> bool {
        let &Self { core, radius, stretch: (from, to), normal, name } = self;
        let length = (core.ends[1] - core.ends[0]).length();
        if (to - from) * length < 0.1 * radius {
            return false;
        }
        out.normal = normal;
        for (index, t) in [from, to].into_iter().enumerate() {
            let p = core.at(t);
            let separation = height(p) - radius;
            if separation <= margin {
                out.push(p - normal * (radius + 0.5 * separation), separation, pair(name, end(index)));
            }
        }
        out.count > 0
    }
}
