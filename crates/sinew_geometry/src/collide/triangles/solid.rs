//! Convex shapes around the origin, in the axes of the surface's frame.

use super::name;
use super::outline::{Corner, Outline, Side};
use crate::collide::feature::{self, WHOLE};
use crate::collide::placed::{PlacedBox, PlacedCapsule};
use crate::convex::support::{Core, Posed, Support, narrow, wide};
use crate::shape::Shape;
use sinew_math::{Transform, Vec3, min};

/// A convex shape. Balls, capsules and boxes have their own tests; all others use GJK and EPA.
pub(super) enum Solid<'a> {
    /// A ball with this radius.
    PlacedSphere(f32),
    PlacedCapsule(PlacedCapsule),
    Box(PlacedBox),
    Other(Posed<'a, Core<'a>>),
}

impl<'a> Solid<'a> {
    pub fn new(shape: &Shape, core: &'a Core<'a>, frame: &Transform) -> Self {
        match *shape {
            Shape::Box { half_extents } => Self::Box(PlacedBox::new(half_extents, frame)),
            Shape::Sphere { radius } => Self::PlacedSphere(radius),
            Shape::Capsule { half_height, radius } => {
                Self::PlacedCapsule(PlacedCapsule::new(half_height, radius, frame))
            }
            _ => Self::Other(Posed::new(core, frame, Vec3::ZERO)),
        }
    }

    /// Rounding radius, metres.
    pub fn radius(&self) -> f32 {
        match self {
            Self::PlacedSphere(radius) => *radius,
            Self::PlacedCapsule(pill) => pill.radius,
            Self::Box(_) => 0.0,
            Self::Other(posed) => posed.solid.rounding(),
        }
    }

    /// Extent from the origin along `-n`, metres; `n` is a unit vector.
    pub fn depth(&self, n: Vec3) -> f32 {
        match self {
            Self::PlacedSphere(radius) => *radius,
            Self::PlacedCapsule(pill) => pill.core.ends[1].dot(n).abs() + pill.radius,
            Self::Box(placed) => placed.half_width(n),
            Self::Other(posed) => posed.extent(-wide(n)) as f32,
        }
    }

    /// Length differences that the choice of features ignores, metres.
    pub fn tolerance(&self) -> f32 {
        let thin = match self {
            Self::PlacedSphere(radius) => *radius,
            Self::PlacedCapsule(pill) => pill.radius,
            Self::Box(placed) => placed.thinnest(),
            Self::Other(posed) => posed.solid.thinnest(),
        };
        min(0.0005, 0.01 * thin)
    }

    /// Returns the side of the core that faces a plane with this normal.
    pub fn outline(&self, normal: Vec3) -> Outline {
        let mut outline = Outline::default();
        let mut push = |at: Vec3, of_shape: u16, side: Side| {
            outline.push(Corner { at, of_shape, of_surface: name::FACE, side });
        };
        match self {
            Self::PlacedSphere(_) => push(Vec3::ZERO, WHOLE, Side::None),
            Self::PlacedCapsule(pill) => {
                for (index, at) in pill.core.ends.into_iter().enumerate() {
                    push(at, feature::end(index), Side::Shape(WHOLE));
                }
            }
            Self::Box(placed) => {
                let (axis, sign) = placed.facing(-normal);
                let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
                let base = usize::from(sign > 0.0) << axis;
                for (k, [on_u, on_v]) in [[0, 0], [1, 0], [1, 1], [0, 1]].into_iter().enumerate() {
                    let index = base | on_u << u | on_v << v;
                    let along = if k % 2 == 0 { u } else { v };
                    let edge = feature::edge(along, index);
                    push(placed.vertex(index), feature::vertex(index), Side::Shape(edge));
                }
                outline.face = feature::face(axis, sign);
            }
            Self::Other(posed) => {
                let feature = posed.feature(-normal);
                for corner in feature.corners() {
                    push(corner.point, corner.name, Side::Shape(corner.side));
                }
                if !feature.is_face() {
                    // A round side extends further than the edge or corner that represents it.
                    outline = lowest(posed, normal, outline);
                }
                outline.face = feature.name;
            }
        }
        outline
    }
}

/// Moves an edge or corner that represents a round side to where the side extends furthest.
fn lowest(posed: &Posed<'_, Core<'_>>, normal: Vec3, outline: Outline) -> Outline {
    let support = narrow(posed.support(-wide(normal)));
    let named = outline.corners().iter().fold(f32::INFINITY, |y, c| min(c.at.dot(normal), y));
    if named <= support.dot(normal) + 1e-6 {
        outline
    } else {
        outline.moved(normal * (support.dot(normal) - named))
    }
}
