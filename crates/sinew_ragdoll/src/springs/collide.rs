//! Colliders of the tips of springs.

use super::tuning::{CLOSE, MOST_LEAPS, THIN};
use sinew_anim::springs::{ColliderShape, Side};
use sinew_math::{Affine, Mat3, Vec3, clamp, max, normalize_or};
use sinew_physics::{BodyId, NearestTo, Probe, Shape, ShapeCast, World};

/// Unit direction out of a collider, and signed distance from the collider to the surface of a ball, metres; negative
/// if they overlap.
#[derive(Clone, Copy)]
pub(super) struct Gap {
    pub direction: Vec3,
    pub distance: f32,
}

/// A collider at the current position of its joint (VRMC_springBone, and the appendix of its extended colliders). A
/// joint's scale enters by its largest axis.
#[derive(Clone, Copy, Debug)]
pub(super) enum Placed {
    /// A ball, or a capsule whose other end is at offset `along`.
    Round {
        head: Vec3,
        along: Vec3,
        radius: f32,
        keeps: Side,
    },
    Plane {
        point: Vec3,
        normal: Vec3,
    },
}

impl Placed {
    /// Places a collider whose joint is at `world_from_joint`.
    pub fn new(shape: &ColliderShape, world_from_joint: &Affine) -> Self {
        match *shape {
            ColliderShape::Sphere { offset, radius, keeps } => Self::Round {
                head: world_from_joint.point(offset),
                along: Vec3::ZERO,
                radius: radius * scale(world_from_joint),
                keeps,
            },
            ColliderShape::Capsule { offset, tail, radius, keeps } => {
                let head = world_from_joint.point(offset);
                let along = world_from_joint.point(tail) - head;
                Self::Round { head, along, radius: radius * scale(world_from_joint), keeps }
            }
            ColliderShape::Plane { offset, normal } => {
                let normal = turned_normal(&world_from_joint.linear, normal);
                Self::Plane { point: world_from_joint.point(offset), normal }
            }
        }
    }

    /// Returns the gap between the collider and a ball that overlaps it; `None` if they are separate.
    #[inline]
    pub fn touch(&self, center: Vec3, radius: f32) -> Option<Gap> {
        match *self {
            Self::Round { head, along, radius: own, keeps } => {
                let mut from = center - head;
                let square = along.length_squared();
                if square > 0.0 {
                    from -= along * clamp(from.dot(along) / square, 0.0, 1.0);
                }
                // Nearly all tips are separate from nearly all colliders, so this test avoids the square root.
                let square = from.length_squared();
                let is_clear = match keeps {
                    Side::Outside => square >= (own + radius) * (own + radius),
                    Side::Inside => own >= radius && square <= (own - radius) * (own - radius),
                };
                if is_clear {
                    return None;
                }
                let (length, out) = (square.sqrt(), normalize_or(from, Vec3::Y));
                Some(match keeps {
                    Side::Outside => Gap { direction: out, distance: length - own - radius },
                    Side::Inside => Gap { direction: -out, distance: own - radius - length },
                })
            }
            Self::Plane { point, normal } => {
                let distance = (center - point).dot(normal) - radius;
                (distance < 0.0).then_some(Gap { direction: normal, distance })
            }
        }
    }
}

impl Placed {
    /// Returns the end position of a fast ball that would pass through the collider: it slides along the first surface
    /// that it hits. Positions are relative to the collider's own motion. `None` if the ball hits nothing.
    #[inline]
    pub fn stop(&self, from: Vec3, to: Vec3, radius: f32) -> Option<Vec3> {
        let Self::Round { head, along, radius: own, keeps: Side::Outside } = *self else { return None };
        let way = to - from;
        let reach = own + radius;
        // A shorter motion ends inside the collider, on the same side.
        if way.length_squared() <= reach * reach {
            return None;
        }
        let (length, square) = (way.length(), along.length_squared());
        let mut gone = 0.0;
        for _ in 0..MOST_LEAPS {
            let mut out = from + way * (gone / length) - head;
            if square > 0.0 {
                out -= along * clamp(out.dot(along) / square, 0.0, 1.0);
            }
            let distance = out.length() - reach;
            if distance < CLOSE {
                return along_surface(from + way * (gone / length), to, normalize_or(out, Vec3::Y));
            }
            gone += distance;
            if gone >= length {
                return None;
            }
        }
        None
    }
}

/// Returns the end of a motion that hit a surface at `met`, without the component into the surface.
fn along_surface(met: Vec3, to: Vec3, normal: Vec3) -> Option<Vec3> {
    let into = (to - met).dot(normal);
    (into < 0.0).then(|| to - normal * into)
}

/// Transforms a normal. Normals transform by the inverse transpose; the cofactors of the matrix give the same direction
/// without a division.
fn turned_normal(m: &Mat3, normal: Vec3) -> Vec3 {
    let (x, y, z) = (m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    let mirrored = m.x_axis.dot(x) < 0.0;
    let turned = x * normal.x + y * normal.y + z * normal.z;
    normalize_or(if mirrored { -turned } else { turned }, Vec3::Y)
}

fn scale(m: &Affine) -> f32 {
    let m = &m.linear;
    max(m.x_axis.length(), max(m.y_axis.length(), m.z_axis.length()))
}

/// The world with the character's own bodies, which the character's springs ignore.
#[derive(Clone, Copy)]
pub(super) struct Surroundings<'a> {
    pub world: &'a World,
    pub own: &'a [BodyId],
}

impl Surroundings<'_> {
    /// Returns true if any shape is within `reach` of a position, metres.
    pub fn are_near(&self, center: Vec3, reach: f32) -> bool {
        let question = NearestTo { point: center, within: reach };
        self.world.query().accept(|body, _| !self.own.contains(&body)).any(&question)
    }

    /// Returns the end position of a fast ball that would pass through a thin obstacle.
    pub fn stop(&self, from: Vec3, to: Vec3, radius: f32) -> Option<Vec3> {
        let translation = to - from;
        if translation.length() <= max(radius, THIN) {
            return None;
        }
        // Use half of the radius, so that a ball that slides on a surface does not hit it.
        let ball = Shape::Sphere { radius: 0.5 * radius };
        let question = ShapeCast { probe: Probe::at(ball, from), translation };
        let hit = self.world.query().accept(|body, _| !self.own.contains(&body)).first(&question)?;
        if hit.start.is_some() {
            return None;
        }
        along_surface(from + translation * hit.fraction, to, hit.normal)
    }

    /// Returns the deepest gap between a ball and the world.
    pub fn touch(&self, center: Vec3, radius: f32) -> Option<Gap> {
        let question = NearestTo { point: center, within: radius };
        let near = self.world.query().accept(|body, _| !self.own.contains(&body)).first(&question)?;
        let distance = near.distance - radius;
        (distance < 0.0).then_some(Gap { direction: near.normal, distance })
    }
}
