//! Final positions of the dynamic bodies.

use super::{collides, worse};
use crate::engine::BodyState;
use crate::parry;
use sinew::math::{Transform, Vec3};
use sinew::physics::{BodyKind, Shape};
use sinew_scenes::blueprint::Blueprint;

/// Depth below all static shapes at which a body counts as lost, metres.
const LOST_BELOW: f32 = 1.0;

/// Final positions of dynamic bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaceQuality {
    /// Number of bodies that fell below all static shapes, or whose numbers are not finite.
    pub lost: usize,
    /// Mean height of the bodies' origins, metres.
    pub mean_height: f64,
    /// Largest distance of a body from its start, metres.
    pub displacement_max: f32,
}

pub(super) struct PlaceMeter {
    bodies: Vec<Start>,
    /// Height below which colliding bodies are lost, metres.
    bottom: f32,
}

/// A dynamic body before the first step.
struct Start {
    place: usize,
    position: Vec3,
    collides: bool,
}

impl PlaceMeter {
    pub fn new(scene: &Blueprint) -> Self {
        let bodies = scene.dynamic().map(|place| {
            let def = &scene.bodies[place];
            Start { place, position: def.position, collides: def.shapes.iter().any(collides) }
        });
        let bottoms = scene.bodies.iter().filter(|def| def.kind == BodyKind::Static).flat_map(|def| {
            let world_from_body = Transform::new(def.position, def.rotation);
            let shapes = def.shapes.iter().filter(|shape| collides(shape));
            shapes.map(move |shape| bottom(&shape.shape, world_from_body * shape.body_from_shape))
        });
        // Without a static shape below, no body can be lost.
        let bottom = bottoms.reduce(f32::min).map_or(f32::NEG_INFINITY, |bottom| bottom - LOST_BELOW);
        Self { bodies: bodies.collect(), bottom }
    }

    pub fn finish(&mut self, states: &[BodyState]) -> PlaceQuality {
        let (mut lost, mut height, mut displacement_max) = (0, 0.0, 0.0);
        for body in &self.bodies {
            let now = states[body.place].world_from_body.translation;
            if !now.is_finite() || (body.collides && now.y < self.bottom) {
                lost += 1;
            }
            height += f64::from(now.y);
            displacement_max = worse(displacement_max, (now - body.position).length());
        }
        PlaceQuality { lost, mean_height: height / self.bodies.len() as f64, displacement_max }
    }
}

/// Returns the lowest height of a static shape, metres; a half-space ends at its plane.
fn bottom(shape: &Shape, world_from_shape: Transform) -> f32 {
    if *shape == Shape::HalfSpace {
        return world_from_shape.translation.y;
    }
    match parry::shape(shape) {
        Ok(shape) => shape.compute_aabb(&parry::pose(world_from_shape)).mins.y,
        // A lower bound of the lowest point.
        Err(_) => world_from_shape.translation.y - shape.bounding_radius(),
    }
}
