//! Random placed shapes of all kinds, and their support functions in `f64`.

use crate::solids::pebble;
use sinew_geometry::Shape;
use sinew_geometry::collide::{Manifold, collide};
use sinew_math::{Random, Rotation, Transform, Vec3};

/// A shape and its pose.
#[derive(Clone, Debug)]
pub struct Placed {
    pub shape: Shape,
    pub frame: Transform,
}

impl Placed {
    /// Returns the furthest extent along the unit vector `n`; for a half-space that of its plane, if `n` is its normal.
    fn support(&self, n: [f64; 3]) -> f64 {
        let m = self.frame.rotation.to_mat3();
        let along = |v: Vec3| f64::from(v.x) * n[0] + f64::from(v.y) * n[1] + f64::from(v.z) * n[2];
        let center = along(self.frame.translation);
        match self.shape {
            Shape::Box { half_extents: h } => {
                center
                    + f64::from(h.x) * along(m.x_axis).abs()
                    + f64::from(h.y) * along(m.y_axis).abs()
                    + f64::from(h.z) * along(m.z_axis).abs()
            }
            Shape::Sphere { radius } => center + f64::from(radius),
            Shape::Capsule { half_height, radius } => {
                center + f64::from(half_height) * along(m.y_axis).abs() + f64::from(radius)
            }
            Shape::Mesh(_) | Shape::HeightField(_) => unreachable!("surfaces have no core"),
            Shape::Hull(ref hull) => {
                let reach = hull.vertices().iter().map(|&v| along(m * v));
                center + reach.fold(f64::NEG_INFINITY, f64::max)
            }
            Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
                let reach = f64::from(half_height) * along(m.y_axis);
                center + (reach + f64::from(radius_top)).max(f64::from(radius_bottom) - reach)
            }
            Shape::Cylinder { half_height, radius } => {
                let across = along(m.x_axis).hypot(along(m.z_axis));
                center + f64::from(half_height) * along(m.y_axis).abs() + f64::from(radius) * across
            }
            Shape::Cone { half_height, radius } => {
                let across = along(m.x_axis).hypot(along(m.z_axis));
                let reach = f64::from(half_height) * along(m.y_axis);
                center + reach.max(f64::from(radius) * across - reach)
            }
            Shape::HalfSpace => {
                if along(m.y_axis) > 0.999_9 {
                    center
                } else {
                    f64::INFINITY
                }
            }
        }
    }

    pub fn size(&self) -> f32 {
        if self.shape == Shape::HalfSpace { 0.0 } else { self.shape.bounding_radius() }
    }

    pub fn collide(&self, other: &Self, margin: f32) -> Manifold {
        let mut out = Manifold::default();
        collide(&self.shape, &self.frame, &other.shape, &other.frame, margin, &mut out);
        out
    }
}

pub fn wide(v: Vec3) -> [f64; 3] {
    [f64::from(v.x), f64::from(v.y), f64::from(v.z)]
}

pub fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let l = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    (l > 1e-9).then(|| v.map(|x| x / l))
}

/// Gap between two shapes along `n`, from `a` to `b`.
pub fn gap(a: &Placed, b: &Placed, n: [f64; 3]) -> f64 {
    -b.support(n.map(|x| -x)) - a.support(n)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    Box,
    Sphere,
    Capsule,
    TaperedCapsule,
    Cylinder,
    Cone,
    Hull,
    HalfSpace,
}

/// All bounded kinds.
pub const FINITE: [Kind; 7] =
    [Kind::Box, Kind::Sphere, Kind::Capsule, Kind::TaperedCapsule, Kind::Cylinder, Kind::Cone, Kind::Hull];

/// Returns every pair of kinds once. A half-space comes first.
pub fn all_pairs() -> impl Iterator<Item = (Kind, Kind)> {
    let with_itself_and_later = |(k, a): (usize, Kind)| FINITE[k..].iter().map(move |&b| (a, b));
    let planes = FINITE.into_iter().map(|kind| (Kind::HalfSpace, kind));
    FINITE.into_iter().enumerate().flat_map(with_itself_and_later).chain(planes)
}

pub fn random_shape(kind: Kind, scale: f32, random: &mut Random) -> Shape {
    if kind == Kind::Hull {
        return pebble(scale, random);
    }
    // Some capsules are balls, because heads are fitted by capsules of length zero.
    let is_ball = kind == Kind::Capsule && random.index(10) == 0;
    let mut side = || scale * random.range(0.2, 1.0);
    match kind {
        Kind::Box => Shape::Box { half_extents: Vec3::new(side(), side(), side()) },
        Kind::Sphere => Shape::Sphere { radius: side() },
        Kind::Capsule if is_ball => Shape::Capsule { half_height: 0.0, radius: 0.6 * side() },
        Kind::Capsule => Shape::Capsule { half_height: side(), radius: 0.4 * side() },
        Kind::TaperedCapsule => {
            let radius_bottom = 0.4 * side();
            // Neither ball contains the other.
            Shape::TaperedCapsule { half_height: side(), radius_bottom, radius_top: 0.4 * side() }
        }
        Kind::Cylinder => Shape::Cylinder { half_height: side(), radius: 0.6 * side() },
        Kind::Cone => Shape::Cone { half_height: side(), radius: side() },
        Kind::HalfSpace | Kind::Hull => Shape::HalfSpace,
    }
}

pub fn random_rotation(random: &mut Random) -> Rotation {
    // A third of the rotations are the identity and a third nearly, as contacts often are.
    match random.index(3) {
        0 => Rotation::IDENTITY,
        1 => Rotation::from_scaled_axis(random.in_cube() * 0.02),
        _ => random.rotation(),
    }
}
