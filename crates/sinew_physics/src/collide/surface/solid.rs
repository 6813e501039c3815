//! What meets a surface: a shape around the origin, in the directions of the surface's frame.

use super::outline::{Corner, Outline, Side};
use crate::collide::feature::{self, WHOLE};
use crate::collide::placed::{Pill, PlacedBox};
use crate::shape::Shape;
use sinew_math::{Rotation, Transform, Vec3, min};

pub(super) enum Solid {
    /// Ball of this radius.
    Ball(f32),
    Pill(Pill),
    Box(PlacedBox),
}

impl Solid {
    /// `None` of what cannot meet a surface: another one, or a half-space.
    pub fn new(shape: &Shape, rotation: Rotation) -> Option<Self> {
        let frame = Transform { translation: Vec3::ZERO, rotation };
        match *shape {
            Shape::Box { half_extents } => Some(Self::Box(PlacedBox::new(half_extents, &frame))),
            Shape::Sphere { radius } => Some(Self::Ball(radius)),
            Shape::Capsule { half_height, radius } => {
                Some(Self::Pill(Pill::new(half_height, radius, &frame)))
            }
            Shape::HalfSpace | Shape::Mesh(_) | Shape::HeightField(_) => None,
        }
    }

    /// Radius of its rounding.
    pub fn radius(&self) -> f32 {
        match self {
            Self::Ball(radius) => *radius,
            Self::Pill(pill) => pill.radius,
            Self::Box(_) => 0.0,
        }
    }

    /// How far it reaches along the unit vector `n`, metres.
    pub fn half_width(&self, n: Vec3) -> f32 {
        match self {
            Self::Ball(radius) => *radius,
            Self::Pill(pill) => pill.core.ends[1].dot(n).abs() + pill.radius,
            Self::Box(placed) => placed.half_width(n),
        }
    }

    /// Lengths below this don't matter for the choice of features, metres.
    pub fn tolerance(&self) -> f32 {
        let thin = match self {
            Self::Ball(radius) => *radius,
            Self::Pill(pill) => pill.radius,
            Self::Box(placed) => placed.thinnest(),
        };
        min(0.0005, 0.01 * thin)
    }

    /// The side of its core that faces a plane with this normal.
    pub fn outline(&self, normal: Vec3) -> Outline {
        let mut outline = Outline::default();
        let mut push = |at: Vec3, of_shape: u16, side: Side| {
            outline.push(Corner { at, of_shape, of_surface: super::name::FACE, side });
        };
        match self {
            Self::Ball(_) => push(Vec3::ZERO, WHOLE, Side::None),
            Self::Pill(pill) => {
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
        }
        outline
    }
}
