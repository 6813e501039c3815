//! Quality of cloth.

use super::worse;
use crate::engine::ParticleState;
use crate::scenes::ClothScene;
use serde_json::{Value, json};
use sinew::math::{Transform, Vec3};
use sinew::physics::Shape;

/// Measures a cloth.
pub struct ClothMeter<'a> {
    scene: &'a ClothScene,
}

/// Quality of cloth at the end of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct ClothQuality {
    /// Mean relative deviation of the structural links from their rest length.
    pub stretch_mean: f32,
    /// Largest relative deviation of a structural link from its rest length.
    pub stretch_max: f32,
    /// Kinetic energy of all particles, J.
    pub kinetic_energy: f64,
    /// Deepest centre of a particle in an obstacle, metres; 0 if none is inside.
    pub depth_max: f32,
}

impl<'a> ClothMeter<'a> {
    /// Creates the measurement of this scene.
    pub fn new(scene: &'a ClothScene) -> Self {
        Self { scene }
    }

    /// Returns the quality after the last step.
    ///
    /// # Panics
    /// If there is not one state for each particle.
    pub fn finish(&self, particles: &[ParticleState]) -> ClothQuality {
        let links = self.scene.structural_links();
        let (mut sum, mut stretch_max) = (0.0, 0.0);
        for &[a, b] in &links {
            let length = (particles[b].position - particles[a].position).length();
            let stretch = (length / self.scene.spacing - 1.0).abs();
            sum += stretch;
            stretch_max = worse(stretch_max, stretch);
        }
        let squares = particles.iter().map(|p| f64::from(p.velocity.length_squared()));
        let depths = particles.iter().map(|p| -self.distance(p.position));
        ClothQuality {
            stretch_mean: sum / links.len() as f32,
            stretch_max,
            kinetic_energy: 0.5 * f64::from(self.scene.particle_mass) * squares.sum::<f64>(),
            depth_max: depths.fold(0.0, worse),
        }
    }

    /// Returns the distance from a point to the nearest obstacle, metres; negative inside.
    fn distance(&self, point: Vec3) -> f32 {
        let boxes = self.scene.boxes.iter().map(|place| {
            Shape::Box { half_extents: place.half_extents }.signed_distance(&place.world_from_box, point).0
        });
        let spheres = self.scene.spheres.iter().map(|&(center, radius)| {
            Shape::Sphere { radius }.signed_distance(&Transform::from_translation(center), point).0
        });
        boxes.chain(spheres).fold(f32::INFINITY, f32::min)
    }
}

impl ClothQuality {
    /// Returns the quality as part of a report.
    pub fn to_json(&self) -> Value {
        json!({
            "stretch_mean": self.stretch_mean,
            "stretch_max": self.stretch_max,
            "kinetic_energy_end_j": self.kinetic_energy,
            "penetration_end_max_m": self.depth_max,
        })
    }
}
