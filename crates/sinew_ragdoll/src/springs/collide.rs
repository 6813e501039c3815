//! Colliders of tips.

use sinew_anim::springs::{ColliderShape, Side};
use sinew_math::{Affine, Vec3, clamp, max, normalize_or};
use sinew_physics::{BodyId, NearestTo, World};

/// Way out of a collider: unit direction, and how far the surface of a ball is from it, metres; negative: so deep in it.
#[derive(Clone, Copy)]
pub(super) struct Gap {
    pub direction: Vec3,
    pub distance: f32,
}

/// Gap between a ball and a collider that its joint carries to `world_from_joint` (VRMC_springBone, and the appendix of its
/// extended colliders). A joint's scale enters by its largest axis.
pub(super) fn gap(shape: &ColliderShape, world_from_joint: &Affine, center: Vec3, radius: f32) -> Gap {
    match *shape {
        ColliderShape::Sphere { offset, radius: own, keeps } => {
            let from = center - world_from_joint.point(offset);
            round(from, own * scale(world_from_joint), radius, keeps)
        }
        ColliderShape::Capsule { offset, tail, radius: own, keeps } => {
            let head = world_from_joint.point(offset);
            let along = world_from_joint.point(tail) - head;
            let from = center - head;
            let square = along.length_squared();
            let share = if square > 0.0 { clamp(from.dot(along) / square, 0.0, 1.0) } else { 0.0 };
            round(from - along * share, own * scale(world_from_joint), radius, keeps)
        }
        ColliderShape::Plane { offset, normal } => {
            // Normals go by the inverse transpose; the cofactors of the matrix have its direction without a division.
            let m = &world_from_joint.linear;
            let (x, y, z) = (m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
            let mirrored = m.x_axis.dot(x) < 0.0;
            let turned = x * normal.x + y * normal.y + z * normal.z;
            let direction = normalize_or(if mirrored { -turned } else { turned }, Vec3::Y);
            Gap { direction, distance: (center - world_from_joint.point(offset)).dot(direction) - radius }
        }
    }
}

fn round(from: Vec3, own: f32, radius: f32, keeps: Side) -> Gap {
    let length = from.length();
    let out = normalize_or(from, Vec3::Y);
    match keeps {
        Side::Outside => Gap { direction: out, distance: length - own - radius },
        Side::Inside => Gap { direction: -out, distance: own - radius - length },
    }
}

fn scale(m: &Affine) -> f32 {
    let m = &m.linear;
    max(m.x_axis.length(), max(m.y_axis.length(), m.z_axis.length()))
}

/// The world with the character's own bodies in it, which are no part of it to the character's springs.
#[derive(Clone, Copy)]
pub(super) struct Surroundings<'a> {
    pub world: &'a World,
    pub own: &'a [BodyId],
}

impl Surroundings<'_> {
    /// True if anything is within `reach` of a place, metres.
    pub fn are_near(&self, center: Vec3, reach: f32) -> bool {
        let question = NearestTo { point: center, within: reach };
        self.world.query().accept(|body, _| !self.own.contains(&body)).any(&question)
    }

    /// Gap between a ball and what is deepest in it.
    pub fn gap(&self, center: Vec3, radius: f32) -> Option<Gap> {
        let question = NearestTo { point: center, within: radius };
        let near = self.world.query().accept(|body, _| !self.own.contains(&body)).first(&question)?;
        Some(Gap { direction: near.normal, distance: near.distance - radius })
    }
}
