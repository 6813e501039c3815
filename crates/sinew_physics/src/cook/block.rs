//! Oriented boxes while they are being found: distance, corners, samples of their surface.

use crate::boxes::Aabb;
use crate::def::{BodyDef, BodyKind};
use crate::distance::box_distance;
use crate::shape::{Shape, ShapeDef};
use sinew_math::{Random, Rotation, Transform, Vec3};

/// A solid box with any orientation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Its middle and its axes, metres.
    pub world_from_block: Transform,
    /// Half of each side along its own axes, metres, above 0.
    pub half_extents: Vec3,
}

impl Block {
    /// A static body of one box: the broad phase takes shapes one by one, so a body each costs it nothing, and every
    /// question about a body (overlap, neighbours, events) then concerns this box alone.
    pub fn to_body(&self) -> BodyDef {
        BodyDef {
            kind: BodyKind::Static,
            position: self.world_from_block.translation,
            rotation: self.world_from_block.rotation,
            shapes: vec![ShapeDef::new(self.shape())],
            ..BodyDef::default()
        }
    }

    /// The box as a shape.
    pub fn shape(&self) -> Shape {
        Shape::Box { half_extents: self.half_extents }
    }

    /// From `p` to its surface, metres, negative inside.
    pub fn signed_distance(&self, p: Vec3) -> f32 {
        box_distance(self.half_extents, self.world_from_block.inverse_point(p)).0
    }

    pub(super) fn bounds(&self) -> Aabb {
        self.shape().aabb(&self.world_from_block)
    }

    /// Cubic metres.
    pub fn volume(&self) -> f32 {
        8.0 * self.half_extents.x * self.half_extents.y * self.half_extents.z
    }

    /// Of its surface, square metres.
    pub fn area(&self) -> f32 {
        let h = self.half_extents;
        8.0 * (h.x * h.y + h.y * h.z + h.z * h.x)
    }

    pub(super) fn corners(&self) -> [Vec3; 8] {
        let h = self.half_extents;
        core::array::from_fn(|i| {
            let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
            self.world_from_block.point(Vec3::new(h.x * sign(0), h.y * sign(1), h.z * sign(2)))
        })
    }

    /// The box along the axes of `rotation` around points; sides of less than twice `least` are widened to that.
    pub(super) fn around(points: impl Iterator<Item = Vec3> + Clone, rotation: Rotation, least: f32) -> Self {
        let (mut low, mut high) = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
        for p in points {
            let local = rotation.inverse() * p;
            low = sinew_math::min3(low, local);
            high = sinew_math::max3(high, local);
        }
        Self::from_corners(low, high, rotation, least)
    }

    /// The box from corner to corner in the axes of `rotation`.
    pub(super) fn from_corners(low: Vec3, high: Vec3, rotation: Rotation, least: f32) -> Self {
        let half_extents = sinew_math::max3((high - low) * 0.5, Vec3::splat(least));
        let center = rotation * ((low + high) * 0.5);
        Self { world_from_block: Transform::new(center, rotation), half_extents }
    }

    /// `count` points of its surface, uniform by area, in strata.
    pub(super) fn sample(&self, count: usize, random: &mut Random, out: &mut Vec<Vec3>) {
        let h = self.half_extents;
        let faces = [h.y * h.z, h.z * h.x, h.x * h.y];
        let total = 2.0 * (faces[0] + faces[1] + faces[2]);
        for k in 0..count {
            let mut along = (k as f32 + random.unit()) / count as f32 * total;
            let mut face = 0;
            while face < 5 && along >= faces[face / 2] {
                along -= faces[face / 2];
                face += 1;
            }
            let mut p = Vec3::new(random.range(-h.x, h.x), random.range(-h.y, h.y), random.range(-h.z, h.z));
            let axis = face / 2;
            p[axis] = if face % 2 == 0 { -h[axis] } else { h[axis] };
            out.push(self.world_from_block.point(p));
        }
    }
}
