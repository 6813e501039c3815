//! Where the dynamic bodies are at the end.

use crate::engine::BodyState;
use crate::parry;
use parry3d::bounding_volume::Aabb;
use sinew::math::{Transform, Vec3};
use sinew::physics::{BodyKind, Shape};
use sinew_scenes::blueprint::Blueprint;

/// Further below all static shapes than this, a body is lost, metres.
const LOST_BELOW: f32 = 1.0;

/// Of dynamic bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaceQuality {
    /// Bodies that fell through everything static, or whose numbers are not finite.
    pub lost: usize,
    /// Mean height of the bodies' origins, metres.
    pub mean_height: f64,
    /// Largest distance of a body from where it started, metres.
    pub displacement_max: f32,
}

pub(super) struct PlaceMeter {
    /// Places of dynamic bodies, and where they start.
    start: Vec<(usize, Vec3)>,
    /// Bodies below are lost.
    bottom: f32,
}

impl PlaceMeter {
    pub fn new(scene: &Blueprint) -> Self {
        let start = scene.dynamic().map(|place| (place, scene.bodies[place].position)).collect();
        let bottoms = scene.bodies.iter().filter(|def| def.kind == BodyKind::Static).flat_map(|def| {
            let world_from_body = Transform::new(def.position, def.rotation);
            def.shapes.iter().map(move |shape| bottom(&shape.shape, world_from_body * shape.body_from_shape))
        });
        // Without static shapes nothing can be fallen through.
        let bottom = bottoms.reduce(f32::min).map_or(f32::NEG_INFINITY, |bottom| bottom - LOST_BELOW);
        Self { start, bottom }
    }

    pub fn finish(&mut self, states: &[BodyState]) -> PlaceQuality {
        let (mut lost, mut height, mut displacement_max) = (0, 0.0, 0.0);
        for &(place, start) in &self.start {
            let now = states[place].world_from_body.translation;
            if !now.is_finite() || now.y < self.bottom {
                lost += 1;
            }
            height += f64::from(now.y);
            displacement_max = super::worse(displacement_max, (now - start).length());
        }
        PlaceQuality { lost, mean_height: height / self.start.len() as f64, displacement_max }
    }
}

/// Lowest height that a static shape reaches, metres; a half-space ends at its plane.
fn bottom(shape: &Shape, world_from_shape: Transform) -> f32 {
    if *shape == Shape::HalfSpace {
        return world_from_shape.translation.y;
    }
    let Aabb { mins, .. } = parry::shape(shape).compute_aabb(&parry::pose(world_from_shape));
    mins.y
}
