//! Difference of a crowd's poses from their clips.

use super::worse;
use crate::engine::CharacterPose;
use serde_json::{Value, json};
use sinew::anim::{LocalTransform, WeightedPose, Wrap, blend, local_to_model, rest_pose, sample};
use sinew::math::{Affine, Rotation};
use sinew_scenes::crowd::CrowdScene;

/// Compares poses with those of the raw clips: spherical interpolation between keys, blending and hierarchy in plain `f32`.
pub struct CrowdMeter<'a> {
    scene: &'a CrowdScene,
    rest: Vec<LocalTransform>,
    sampled: [Vec<LocalTransform>; 2],
    blended: Vec<LocalTransform>,
    model: Vec<Affine>,
    quality: CrowdQuality,
}

/// Largest errors of all measured poses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CrowdQuality {
    /// Angle between the rotation of a sampled joint and its clip, radians.
    pub rotation_error_max: f32,
    /// Distance of a joint of the blended pose from its expected position, model space, metres.
    pub model_error_max: f32,
}

impl<'a> CrowdMeter<'a> {
    /// Creates the measurement of this scene.
    pub fn new(scene: &'a CrowdScene) -> Self {
        let rest = rest_pose(&scene.rig);
        Self {
            scene,
            sampled: [rest.clone(), rest.clone()],
            blended: rest.clone(),
            model: Vec::new(),
            rest,
            quality: CrowdQuality::default(),
        }
    }

    /// Measures a character's pose after `step`.
    ///
    /// # Panics
    /// If there is not one entry for each joint.
    pub fn observe(&mut self, character: usize, step: usize, pose: &CharacterPose) {
        let (scene, quality) = (self.scene, &mut self.quality);
        let times = scene.times(character, step);
        for (i, sampled) in self.sampled.iter_mut().enumerate() {
            sample(&scene.clips[i], &scene.rig, times[i], Wrap::Clamp, sampled);
            assert_eq!(pose.sampled[i].len(), sampled.len(), "a rotation per joint");
            for (&found, expected) in pose.sampled[i].iter().zip(sampled) {
                let error = angle(found, expected.rotation);
                quality.rotation_error_max = worse(quality.rotation_error_max, error);
            }
        }
        let weight = scene.characters[character].weight;
        let [first, second] = &self.sampled;
        let layers = [(first, 1.0 - weight), (second, weight)];
        let layers = layers.map(|(pose, weight)| WeightedPose { pose, weight });
        blend(&self.rest, &layers, &mut self.blended);
        local_to_model(&scene.rig, &self.blended, &Affine::IDENTITY, &mut self.model);
        assert_eq!(pose.places.len(), self.model.len(), "a place per joint");
        for (&found, expected) in pose.places.iter().zip(&self.model) {
            let error = (found - expected.translation).length();
            quality.model_error_max = worse(quality.model_error_max, error);
        }
    }

    /// Returns the result after the last pose.
    pub fn finish(self) -> CrowdQuality {
        self.quality
    }
}

impl CrowdQuality {
    /// Returns the quality as part of a report.
    pub fn to_json(&self) -> Value {
        json!({
            "rotation_error_max_rad": self.rotation_error_max,
            "model_error_max_m": self.model_error_max,
        })
    }
}

/// Returns an angle in radians, from the chord in `f64`: the cosine would be less exact than the errors.
fn angle(a: Rotation, b: Rotation) -> f32 {
    let pairs = [(a.x, b.x), (a.y, b.y), (a.z, b.z), (a.w, b.w)].map(|(a, b)| (f64::from(a), f64::from(b)));
    let sign = if pairs.iter().map(|(a, b)| a * b).sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
    let chord: f64 = pairs.iter().map(|(a, b)| (a - sign * b) * (a - sign * b)).sum();
    (2.0 * chord.sqrt()) as f32
}
