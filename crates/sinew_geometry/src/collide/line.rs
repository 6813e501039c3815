//! A capsule that lies on a face or along an edge: contact along a line.

use super::feature::{end, pair};
use super::manifold::Manifold;
use super::placed::Segment;
use sinew_math::Vec3;

/// The stretch of a capsule's core over a face or along an edge.
pub(super) struct Line<'a> {
    pub core: &'a Segment,
    pub radius: f32,
    /// From one parameter of the core to another.
    pub stretch: (f32, f32),
    /// Unit, from the face or edge to the core.
    pub normal: Vec3,
    /// Name of the face or edge.
    pub name: u16,
}

impl Line<'_> {
    /// Pushes the two ends of the stretch, A being what the capsule lies on; `height` is that of a point over it. False, and
    /// nothing pushed, if the stretch is too short to tell two points apart, or neither end is within the margin.
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
