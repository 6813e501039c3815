//! Gap between two solids, or their penetration depth.

use super::epa;
use super::gjk::{self, Bridge, Cores};
use super::support::{Core, Posed, Support, narrow, wide};
use crate::shape::Shape;
use sinew_math::{DVec3, Transform, Vec3};

/// Closest points of two separated solids; for overlapping ones, the ends of the shortest way out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Distance, metres; 0 if the solids touch, minus the depth if they overlap.
    pub distance: f32,
    /// Unit normal from A to B, world. A displacement of B along it by the depth separates overlapping solids.
    pub normal: Vec3,
    /// Point on A's surface, world, metres.
    pub on_a: Vec3,
    /// Point on B's surface, world, metres: `on_a + normal × distance`.
    pub on_b: Vec3,
}

/// Returns the gap between two placed shapes, or their penetration. Returns `None` if both are half-spaces, one is a
/// mesh or height field, or a number is not finite.
///
/// The result is accurate to a few roundings (6e-8) of the sizes and the distance. If several ways out are shortest,
/// the choice is deterministic. For round, nearly concentric shapes the depth may exceed that of the shortest way out
/// by 5e-5 of the sizes.
pub fn gap(a: &Shape, world_from_a: &Transform, b: &Shape, world_from_b: &Transform) -> Option<Gap> {
    if !(world_from_a.is_finite() && world_from_b.is_finite()) {
        return None;
    }
    match (Core::of(a), Core::of(b)) {
        (Some(core_a), Some(core_b)) => {
            let origin = world_from_b.translation;
            let (a, b) =
                (Posed::new(&core_a, world_from_a, origin), Posed::new(&core_b, world_from_b, origin));
            Some(meet(&a, &b).placed(origin))
        }
        (None, Some(core)) if *a == Shape::HalfSpace => over_plane(world_from_a, &core, world_from_b),
        (Some(core), None) if *b == Shape::HalfSpace => {
            over_plane(world_from_b, &core, world_from_a).map(Gap::flipped)
        }
        _ => None,
    }
    .filter(Gap::is_finite)
}

/// True if two placed shapes have a common point; touching counts. Two half-spaces always overlap.
pub fn overlaps(a: &Shape, world_from_a: &Transform, b: &Shape, world_from_b: &Transform) -> bool {
    (*a == Shape::HalfSpace && *b == Shape::HalfSpace)
        || gap(a, world_from_a, b, world_from_b).is_some_and(|gap| gap.distance <= 0.0)
}

/// Returns the gap between a half-space and a solid, along the plane's normal.
fn over_plane(world_from_plane: &Transform, core: &Core<'_>, world_from_core: &Transform) -> Option<Gap> {
    let origin = world_from_core.translation;
    let posed = Posed::new(core, world_from_core, origin);
    let normal = world_from_plane.rotation * Vec3::Y;
    let up = wide(normal).normalize();
    let lowest = posed.support(-up) - up * f64::from(core.rounding());
    let height = (lowest - (wide(world_from_plane.translation) - wide(origin))).dot(up);
    let bridge = Bridge { on_a: lowest - up * height, on_b: lowest, distance: height, normal: up };
    Some(Gap::from(bridge).placed(origin))
}

/// Returns the gap between two posed solids, in the frame of the pair.
pub fn meet<A: Support, B: Support>(a: &Posed<'_, A>, b: &Posed<'_, B>) -> Gap {
    let bridge = match gjk::closest(a, b) {
        Cores::Apart(bridge) => bridge,
        Cores::Overlapping(simplex) => epa::deepest(a, b, &simplex),
    };
    Gap::from(bridge.rounded(f64::from(a.solid.rounding()), f64::from(b.solid.rounding())))
}

impl Bridge {
    /// Returns the gap between the surfaces of the rounded cores with radii `a` and `b`, metres.
    pub(super) fn rounded(self, a: f64, b: f64) -> Self {
        Self {
            on_a: self.on_a + self.normal * a,
            on_b: self.on_b - self.normal * b,
            distance: self.distance - a - b,
            normal: self.normal,
        }
    }
}

impl From<Bridge> for Gap {
    fn from(bridge: Bridge) -> Self {
        // The points of overlapping cores are not exactly opposite each other, so the contact is placed at their mean.
        let middle = (bridge.on_a + bridge.on_b) * 0.5;
        let half = bridge.normal * (0.5 * bridge.distance);
        Self {
            distance: bridge.distance as f32,
            normal: narrow(bridge.normal),
            on_a: narrow(middle - half),
            on_b: narrow(middle + half),
        }
    }
}

impl Gap {
    /// Returns the same gap from B to A.
    #[must_use]
    pub fn flipped(self) -> Self {
        Self { normal: -self.normal, on_a: self.on_b, on_b: self.on_a, ..self }
    }

    /// Converts points relative to `origin` to world points.
    pub fn placed(self, origin: Vec3) -> Self {
        Self { on_a: self.on_a + origin, on_b: self.on_b + origin, ..self }
    }

    fn is_finite(&self) -> bool {
        self.distance.is_finite() && self.normal.is_finite() && self.on_a.is_finite() && self.on_b.is_finite()
    }
}

/// Gap between two solids along a unit direction from A to B, metres; negative if they overlap along it.
pub fn apart_along<A: Support, B: Support>(a: &Posed<'_, A>, b: &Posed<'_, B>, direction: DVec3) -> f64 {
    -b.extent(-direction) - a.extent(direction)
}
