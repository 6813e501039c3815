//! Ray casts against shapes, exact for every shape.

use crate::revolved::{TaperedCapsule, TruncatedCone};
use crate::shape::Shape;
use crate::slabs::Slabs;
use sinew_math::{Transform, Vec3, abs3, max, normalize_or};

/// A ray: the segment from `origin` to `origin + direction`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(alias = "raycast")]
pub struct Ray {
    /// Start, metres.
    pub origin: Vec3,
    /// Displacement from start to end, metres; its length is the length of the ray.
    pub direction: Vec3,
}

impl Ray {
    /// Creates a ray from one point to another.
    #[inline]
    pub fn between(from: Vec3, to: Vec3) -> Self {
        Self { origin: from, direction: to - from }
    }

    /// Point at `fraction`, 0..=1, metres.
    #[inline]
    pub fn at(&self, fraction: f32) -> Vec3 {
        self.origin + self.direction * fraction
    }

    /// True if the square of the ray's length may overflow.
    #[inline]
    pub fn is_long(&self) -> bool {
        let way = abs3(self.direction);
        max(max(way.x, way.y), way.z) > LONG
    }
}

/// Largest component of a direction whose square is safe from overflow.
const LONG: f32 = 1e15;
/// Factor by which directions with a component above [`LONG`] are scaled: 2⁻⁹⁶, so that scaling is exact.
const SHORTENED: f32 = f32::from_bits((127 - 96) << 23);

/// First point of a ray in a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Fraction of the ray before the hit, 0..=1. For a half-line the unit is the length of its direction, and the
    /// fraction may exceed 1.
    pub fraction: f32,
    /// Hit point, world, metres.
    pub point: Vec3,
    /// Unit normal, out of the shape, world.
    pub normal: Vec3,
}

impl Shape {
    /// Returns the first point of the ray inside the shape; `None` if the ray misses, or a number is not finite.
    ///
    /// A ray that starts inside a solid or on its surface hits at fraction 0. The normal is opposite to the ray's
    /// direction, or the outward normal at the closest surface point if the direction is zero. A ray that starts
    /// outside and points away never hits.
    ///
    /// Meshes and height fields are surfaces that may be open and have no inside. Rays hit their triangles from the
    /// front only, with the triangle's normal.
    pub fn cast_ray(&self, world_from_shape: &Transform, ray: &Ray) -> Option<RayHit> {
        self.cast_half_line(world_from_shape, ray).filter(|hit| hit.fraction <= 1.0)
    }

    /// Like [`cast_ray`](Self::cast_ray), for a ray without an end: the fraction counts lengths of the direction, and
    /// may exceed 1.
    pub fn cast_half_line(&self, world_from_shape: &Transform, ray: &Ray) -> Option<RayHit> {
        if !(ray.origin.is_finite() && ray.direction.is_finite() && world_from_shape.is_finite()) {
            return None;
        }
        let scale = if ray.is_long() { SHORTENED } else { 1.0 };
        let origin = world_from_shape.inverse_point(ray.origin);
        let direction = world_from_shape.rotation.inverse() * (ray.direction * scale);
        let (fraction, normal) = self.cast_local(origin, direction)?;
        let fraction = fraction * scale;
        Some(RayHit { fraction, point: ray.at(fraction), normal: world_from_shape.rotation * normal })
    }

    /// Returns the fraction (≥ 0, may exceed 1) and the normal at which a ray enters, in the shape's frame.
    pub(crate) fn cast_local(&self, origin: Vec3, direction: Vec3) -> Option<(f32, Vec3)> {
        if let Some(surface) = self.surface() {
            return surface.enter(origin, direction);
        }
        if let Self::Box { half_extents } = *self
            && (abs3(origin) - half_extents).cmpgt(Vec3::splat(CLEARLY_OUTSIDE)).any()
        {
            return enter_box(half_extents, origin, direction)
                .filter(|(fraction, _)| *fraction < f32::INFINITY);
        }
        let (distance, outward) = self.local_distance(origin);
        if distance <= 0.0 {
            return Some((0.0, normalize_or(-direction, outward)));
        }
        self.enter(origin, direction).filter(|(fraction, _)| *fraction < f32::INFINITY)
    }

    /// Like [`cast_local`](Self::cast_local), for a ray that starts outside the shape; in the shape's frame.
    fn enter(&self, origin: Vec3, direction: Vec3) -> Option<(f32, Vec3)> {
        match *self {
            Self::Box { half_extents } => enter_box(half_extents, origin, direction),
            Self::Sphere { radius } => enter_ball(Vec3::ZERO, radius, origin, direction),
            Self::Capsule { half_height, radius } => {
                let cap = Vec3::new(0.0, half_height, 0.0);
                let side = enter_tube(half_height, radius, origin, direction);
                let caps = [-cap, cap].map(|center| enter_ball(center, radius, origin, direction));
                first_of(caps, side)
            }
            Self::Hull(ref hull) => hull.enter(origin, direction),
            Self::TaperedCapsule { half_height, radius_bottom, radius_top } => {
                let tapered = TaperedCapsule::new(half_height, radius_bottom, radius_top);
                let (side, middle) = tapered.side();
                let side = side.enter(origin - Vec3::new(0.0, middle, 0.0), direction);
                let ends = tapered.balls().map(|(center, r)| enter_ball(center, r, origin, direction));
                first_of(ends, side)
            }
            Self::Cylinder { half_height, radius } => {
                TruncatedCone::cylinder(half_height, radius).enter(origin, direction)
            }
            Self::Cone { half_height, radius } => {
                TruncatedCone::cone(half_height, radius).enter(origin, direction)
            }
            Self::HalfSpace => (direction.y < 0.0).then(|| (origin.y / -direction.y, Vec3::Y)),
            Self::Mesh(_) | Self::HeightField(_) => None,
        }
    }
}

/// Distance beyond a face of a box, metres, above which a ray counts as starting outside, without the exact distance.
pub const CLEARLY_OUTSIDE: f32 = 1e-6;

/// Returns the earliest of the entries into the parts of a capsule.
fn first_of(ends: [Option<(f32, Vec3)>; 2], side: Option<(f32, Vec3)>) -> Option<(f32, Vec3)> {
    ends.into_iter().chain([side]).flatten().reduce(|a, b| if b.0 < a.0 { b } else { a })
}

fn enter_box(half: Vec3, origin: Vec3, direction: Vec3) -> Option<(f32, Vec3)> {
    let slabs = Slabs::<f32>::new(half.into(), origin.into(), direction.into());
    slabs.is_entered().then(|| (slabs.enter, Vec3::from_array(slabs.normal().to_array())))
}

/// Returns the fraction and the normal at which a ray enters a ball. Computed from the ray's point closest to the
/// centre, because the discriminant of the usual quadratic loses small radii at long distances (Haines et al.,
/// "Precision improvements for ray/sphere intersection", Ray Tracing Gems 2019).
fn enter_ball(center: Vec3, radius: f32, origin: Vec3, direction: Vec3) -> Option<(f32, Vec3)> {
    let length_squared = direction.dot(direction);
    if length_squared <= f32::MIN_POSITIVE {
        return None;
    }
    let offset = origin - center;
    let middle = -offset.dot(direction) / length_squared;
    let closest = offset + direction * middle;
    let depth = radius * radius - closest.dot(closest);
    // The comparison is false for NaN, which overflowing squares produce.
    if !(depth >= 0.0 && middle >= 0.0) {
        return None;
    }
    let fraction = max(middle - (depth / length_squared).sqrt(), 0.0);
    Some((fraction, normalize_or(offset + direction * fraction, normalize_or(-direction, Vec3::Y))))
}

/// Returns the entry through the side of a cylinder along y, without its ends.
fn enter_tube(half_height: f32, radius: f32, origin: Vec3, direction: Vec3) -> Option<(f32, Vec3)> {
    let flat = |v: Vec3| Vec3::new(v.x, 0.0, v.z);
    let (fraction, normal) = enter_ball(Vec3::ZERO, radius, flat(origin), flat(direction))?;
    ((origin.y + direction.y * fraction).abs() <= half_height).then_some((fraction, normal))
}
