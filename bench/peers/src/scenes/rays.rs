//! Rays against static boxes.

use sinew::math::{Random, Transform, Vec3};
use sinew::physics::ray::Ray;
use sinew::physics::{BodyDef, BodyKind, Shape, ShapeDef};
use sinew_scenes::blueprint::{in_box, rotation};

/// Number of rays in one measured step: enough for the clock.
const RAYS_PER_STEP: usize = 1_000;

/// A box in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedBox {
    /// Half of each side, metres.
    pub half_extents: Vec3,
    /// Centre and orientation of the box.
    pub world_from_box: Transform,
}

impl PlacedBox {
    /// Returns the box as a static body.
    pub fn fixed(&self) -> BodyDef {
        BodyDef {
            kind: BodyKind::Static,
            position: self.world_from_box.translation,
            rotation: self.world_from_box.rotation,
            shapes: vec![ShapeDef::new(Shape::Box { half_extents: self.half_extents })],
            ..BodyDef::default()
        }
    }
}

/// Static boxes, and rays whose closest hit is searched.
pub struct RayScene {
    /// 10,000 boxes, half extents 0.2 to 1 m, in a cube of side 100 m.
    pub boxes: Vec<PlacedBox>,
    /// 100,000 rays of 100 m; 75.8 % hit.
    pub rays: Vec<Ray>,
}

impl RayScene {
    /// Builds the scene, always the same one.
    pub fn new() -> Self {
        let mut random = Random::new(7);
        let boxes = (0..10_000)
            .map(|_| {
                let half_extents = in_box(&mut random, 0.2, 1.0);
                let center = in_box(&mut random, -50.0, 50.0);
                let world_from_box = Transform::new(center, rotation(&mut random));
                PlacedBox { half_extents, world_from_box }
            })
            .collect();
        let mut random = Random::new(8);
        let rays = (0..100_000)
            .map(|_| {
                let origin = in_box(&mut random, -60.0, 60.0);
                let target = in_box(&mut random, -60.0, 60.0);
                Ray { origin, direction: (target - origin).normalize() * 100.0 }
            })
            .collect();
        Self { boxes, rays }
    }

    /// Returns the rays of measured step number `step`, cyclically.
    pub fn rays_of_step(&self, step: usize) -> core::ops::Range<usize> {
        let start = step * RAYS_PER_STEP % self.rays.len();
        start..start + RAYS_PER_STEP
    }
}

impl Default for RayScene {
    fn default() -> Self {
        Self::new()
    }
}
