//! Convex cores, defined by their support functions.

use super::feature::Feature;
use crate::collide::placed::sign;
use crate::hull::Hull;
use crate::revolved::{TaperedCapsule, TruncatedCone};
use crate::shape::Shape;
use sinew_math::{DVec3, Transform, Vec3, max, min};

/// A convex solid: all points within the rounding radius of a core. Any two types with this trait can collide.
/// Coordinates are in the solid's own frame.
pub trait Support {
    /// Returns the point of the core that is furthest along `direction`, which has any length but 0.
    fn support(&self, direction: DVec3) -> DVec3;

    /// Radius of the rounding, metres, ≥ 0.
    fn rounding(&self) -> f32;

    /// Radius of a ball around the origin that contains the solid, metres.
    fn reach(&self) -> f32;

    /// Half the least width of the solid, metres. It sets the tolerances in the choice of contact points.
    fn thinnest(&self) -> f32;

    /// Returns the feature of the core's surface that touches another solid along the unit vector `direction`: the face
    /// that faces this direction, otherwise the edge or corner.
    fn feature(&self, direction: Vec3) -> Feature;
}

/// Core of a shape that is convex and bounded. Sizes are metres; frames are those of the [`Shape`].
#[derive(Clone, Copy, Debug)]
pub enum Core<'a> {
    /// Core of a ball.
    Point {
        /// Rounding radius.
        radius: f32,
    },
    /// Core of a capsule, along y.
    Segment {
        /// Half the length of the segment.
        half_height: f32,
        /// Rounding radius.
        radius: f32,
    },
    /// A box.
    Box {
        /// Half extents.
        half: Vec3,
    },
    /// A cylinder or cone.
    TruncatedCone(TruncatedCone),
    /// A tapered capsule, rounded by the smaller radius: the core is the hull of a ball and a point.
    Tapered(TaperedCapsule),
    /// A convex hull.
    Hull(&'a Hull),
}

impl<'a> Core<'a> {
    /// Core of a shape; `None` if the shape is not convex or not bounded.
    pub fn of(shape: &'a Shape) -> Option<Self> {
        Some(match *shape {
            Shape::Box { half_extents: half } => Self::Box { half },
            Shape::Sphere { radius } => Self::Point { radius },
            Shape::Capsule { half_height, radius } => Self::Segment { half_height, radius },
            Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
                Self::Tapered(TaperedCapsule::new(half_height, radius_bottom, radius_top))
            }
            Shape::Cylinder { half_height, radius } => {
                Self::TruncatedCone(TruncatedCone::cylinder(half_height, radius))
            }
            Shape::Cone { half_height, radius } => {
                Self::TruncatedCone(TruncatedCone::cone(half_height, radius))
            }
            Shape::HalfSpace | Shape::Mesh(_) | Shape::HeightField(_) => return None,
            Shape::Hull(ref hull) => Self::Hull(hull),
        })
    }
}

impl Support for Core<'_> {
    fn support(&self, d: DVec3) -> DVec3 {
        let toward =
            |length: f32, along: f64| if along < 0.0 { -f64::from(length) } else { f64::from(length) };
        match self {
            Self::Point { .. } => DVec3::ZERO,
            Self::Segment { half_height, .. } => DVec3::new(0.0, toward(*half_height, d.y), 0.0),
            Self::Box { half } => DVec3::new(toward(half.x, d.x), toward(half.y, d.y), toward(half.z, d.z)),
            Self::TruncatedCone(cone) => truncated_cone_support(cone, d),
            Self::Tapered(tapered) => tapered_support(tapered, d),
            Self::Hull(hull) => hull_support(hull, d),
        }
    }

    fn rounding(&self) -> f32 {
        match self {
            Self::Point { radius } | Self::Segment { radius, .. } => *radius,
            Self::Box { .. } | Self::TruncatedCone(_) | Self::Hull(_) => 0.0,
            Self::Tapered(tapered) => min(tapered.bottom, tapered.top),
        }
    }

    fn reach(&self) -> f32 {
        match self {
            Self::Point { radius } => *radius,
            Self::Segment { half_height, radius } => half_height + radius,
            Self::Box { half } => half.length(),
            Self::TruncatedCone(f) => {
                let radius = max(f.bottom, f.top);
                (f.half_height * f.half_height + radius * radius).sqrt()
            }
            Self::Tapered(t) => t.half_height + max(t.bottom, t.top),
            Self::Hull(hull) => hull.bounding_radius(),
        }
    }

    fn thinnest(&self) -> f32 {
        match self {
            Self::Point { radius } | Self::Segment { radius, .. } => *radius,
            Self::Box { half } => min(min(half.x, half.y), half.z),
            Self::TruncatedCone(f) => min(f.half_height, 0.5 * (f.bottom + f.top)),
            Self::Tapered(t) => max(t.bottom, t.top),
            Self::Hull(hull) => hull.inner_radius(),
        }
    }

    fn feature(&self, direction: Vec3) -> Feature {
        match self {
            Self::Point { .. } => Feature::of_point(Vec3::ZERO),
            Self::Segment { half_height, .. } => {
                let up = Vec3::new(0.0, *half_height, 0.0);
                Feature::of_edge([-up, up])
            }
            Self::Box { half } => Feature::of_box(*half, direction),
            Self::TruncatedCone(cone) => Feature::of_truncated_cone(cone, direction),
            Self::Hull(hull) => Feature::of_hull(hull, direction),
            Self::Tapered(tapered) => {
                let rounding = self.rounding();
                let ends = tapered.balls().map(|(center, radius)| center + direction * (radius - rounding));
                let off_side = direction.y - tapered.side_normal().y;
                if off_side.abs() < TAPERED_SIDE {
                    Feature::of_edge(ends)
                } else {
                    Feature::of_point(ends[usize::from(sign(off_side) > 0.0)])
                }
            }
        }
    }
}

/// Largest difference between the y components of a direction and a tapered capsule's side normal at which the
/// direction touches the side, not an end.
const TAPERED_SIDE: f32 = 0.1;

/// Returns the point of the rim that extends further, at the azimuth of the direction.
fn truncated_cone_support(cone: &TruncatedCone, d: DVec3) -> DVec3 {
    let across = (d.x * d.x + d.z * d.z).sqrt();
    let [h, bottom, top] = [cone.half_height, cone.bottom, cone.top].map(f64::from);
    let (y, radius) =
        if top * across + h * d.y > bottom * across - h * d.y { (h, top) } else { (-h, bottom) };
    if across > 0.0 {
        DVec3::new(radius * (d.x / across), y, radius * (d.z / across))
    } else {
        // Flat on an end: the centre extends as far as the rim.
        DVec3::new(0.0, y, 0.0)
    }
}

/// Returns the corner that extends furthest; the first among equals.
fn hull_support(hull: &Hull, d: DVec3) -> DVec3 {
    let (mut best, mut reach) = (DVec3::ZERO, f64::NEG_INFINITY);
    for vertex in hull.vertices().iter().copied().map(wide) {
        let along = vertex.dot(d);
        if along > reach {
            (best, reach) = (vertex, along);
        }
    }
    best
}

fn tapered_support(tapered: &TaperedCapsule, d: DVec3) -> DVec3 {
    let [h, bottom, top] = [tapered.half_height, tapered.bottom, tapered.top].map(f64::from);
    let least = if bottom < top { bottom } else { top };
    let length = d.length();
    let (y, radius) =
        if (top - bottom) * length + 2.0 * h * d.y > 0.0 { (h, top - least) } else { (-h, bottom - least) };
    DVec3::new(0.0, y, 0.0) + d * (radius / length)
}

/// A convex solid in the common frame of a pair. Uses `f64` to resolve small differences at all sizes, since `f32`
/// positions and sizes have few digits.
pub struct Posed<'a, S> {
    /// Solid in its own frame.
    pub solid: &'a S,
    /// Unit directions of the solid's axes in the frame of the pair.
    pub axes: [DVec3; 3],
    /// Origin of the solid's frame in the frame of the pair, metres.
    pub center: DVec3,
}

impl<'a, S: Support> Posed<'a, S> {
    /// Places a solid by `frame`, in coordinates relative to `origin`.
    #[inline]
    pub fn new(solid: &'a S, frame: &Transform, origin: Vec3) -> Self {
        let r = frame.rotation;
        let [x, y, z, w] = [r.x, r.y, r.z, r.w].map(f64::from);
        // Normalised in `f64`, because the rotation has length 1 only to `f32` precision.
        let s = 2.0 / (x * x + y * y + z * z + w * w);
        let axes = [
            DVec3::new(1.0 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)),
            DVec3::new(s * (x * y - w * z), 1.0 - s * (x * x + z * z), s * (y * z + w * x)),
            DVec3::new(s * (x * z + w * y), s * (y * z - w * x), 1.0 - s * (x * x + y * y)),
        ];
        Self { solid, axes, center: wide(frame.translation) - wide(origin) }
    }

    /// Returns the point of the core that is furthest along `direction`.
    pub fn support(&self, direction: DVec3) -> DVec3 {
        let [x, y, z] = self.axes;
        let local = DVec3::new(direction.dot(x), direction.dot(y), direction.dot(z));
        let p = self.solid.support(local);
        self.center + x * p.x + y * p.y + z * p.z
    }

    /// Extent of the solid along the unit vector `direction`, from the origin of the pair's frame, metres.
    pub fn extent(&self, direction: DVec3) -> f64 {
        self.support(direction).dot(direction) + f64::from(self.solid.rounding())
    }

    /// Returns the feature that touches another solid along the unit vector `direction`, in the frame of the pair.
    pub fn feature(&self, direction: Vec3) -> Feature {
        let [x, y, z] = self.axes.map(narrow);
        let local = Vec3::new(direction.dot(x), direction.dot(y), direction.dot(z));
        let turned = |v: Vec3| x * v.x + y * v.y + z * v.z;
        let center = narrow(self.center);
        self.solid.feature(local).mapped(|p| center + turned(p), turned)
    }
}

/// Converts a vector to `f64`.
#[inline]
pub fn wide(v: Vec3) -> DVec3 {
    DVec3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z))
}

/// Converts a vector to `f32`, rounded.
#[inline]
pub fn narrow(v: DVec3) -> Vec3 {
    Vec3::new(v.x as f32, v.y as f32, v.z as f32)
}
