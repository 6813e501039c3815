//! Quality of a run, from the bodies' states alone: the same tool for every engine.

mod chains;
mod cloth;
mod crowd;
mod energy;
mod joints;
mod limits;
mod penetration;
mod place;

pub use cloth::{ClothMeter, ClothQuality};
pub use crowd::{CrowdMeter, CrowdQuality};
pub use energy::EnergyQuality;
pub use joints::JointQuality;
pub use limits::{LimitQuality, LimitTally};
pub use penetration::PenetrationQuality;
pub use place::PlaceQuality;

use crate::engine::BodyState;
use energy::EnergyMeter;
use joints::JointMeter;
use limits::LimitMeter;
use penetration::PenetrationMeter;
use place::PlaceMeter;
use serde_json::{Map, Value, json};
use sinew::physics::{Sensing, ShapeDef};
use sinew_scenes::blueprint::Blueprint;

/// Measures a run.
pub struct QualityMeter {
    steps: usize,
    joints: JointMeter,
    limits: LimitMeter,
    penetration: PenetrationMeter,
    energy: EnergyMeter,
    place: PlaceMeter,
}

/// Result of a run.
#[derive(Clone, Debug)]
pub struct Quality {
    /// Quality of joints; `None` without joints.
    pub joints: Option<JointQuality>,
    /// Quality of limits; `None` without limits.
    pub limits: Option<LimitQuality>,
    /// Penetration of shapes; `None` if none can collide.
    pub penetration: Option<PenetrationQuality>,
    /// Energy of the dynamic bodies.
    pub energy: EnergyQuality,
    /// Final positions of the dynamic bodies.
    pub place: PlaceQuality,
}

impl QualityMeter {
    /// Starts the measurement before the first step. Penetration, the most expensive metric, is measured every
    /// `penetration_every` steps.
    pub fn new(scene: &Blueprint, penetration_every: usize) -> Self {
        Self {
            steps: 0,
            joints: JointMeter::new(scene),
            limits: LimitMeter::new(scene),
            penetration: PenetrationMeter::new(scene, penetration_every),
            energy: EnergyMeter::new(scene),
            place: PlaceMeter::new(scene),
        }
    }

    /// Observes the states after a step.
    ///
    /// # Panics
    /// If there is not one state for each body.
    pub fn observe(&mut self, states: &[BodyState]) {
        self.steps += 1;
        self.joints.observe(states);
        self.limits.observe(states);
        self.penetration.observe(self.steps, states);
        self.energy.observe(states);
    }

    /// Returns the quality after the last step.
    pub fn finish(mut self, states: &[BodyState]) -> Quality {
        Quality {
            joints: self.joints.finish(states),
            limits: self.limits.finish(states),
            penetration: self.penetration.finish(states),
            energy: self.energy.finish(states),
            place: self.place.finish(states),
        }
    }
}

impl Quality {
    /// Returns the result as part of a report; `null` if the scene lacks the object or a number is not finite.
    pub fn to_json(&self) -> Value {
        let mut report = Map::new();
        let mut add = |key: &str, value: Value| report.insert(key.into(), value);
        let joints = self.joints.as_ref();
        add("joint_gap_peak_m", json!(joints.map(|q| q.gap_peak)));
        add("joint_gap_end_max_m", json!(joints.map(|q| q.gap_end_max)));
        add("joint_gap_end_mean_m", json!(joints.map(|q| q.gap_end_mean)));
        add("gap_per_link", json!(joints.and_then(|q| q.gap_per_link)));
        add("stretch_peak", json!(joints.and_then(|q| q.stretch_peak)));
        add("stretch_end", json!(joints.and_then(|q| q.stretch_end)));
        add("limits", self.limits.as_ref().map_or(Value::Null, LimitQuality::to_json));
        let penetration = self.penetration.as_ref();
        add("penetration_end_max_m", json!(penetration.map(|q| q.end_max)));
        add("penetration_end_p99_m", json!(penetration.map(|q| q.end_p99)));
        add("penetration_run_max_m", json!(penetration.map(|q| q.run_max)));
        add("penetration_every_steps", json!(penetration.map(|q| q.every)));
        add("kinetic_energy_end_j", json!(self.energy.kinetic_end));
        add("energy_start_j", json!(self.energy.total_start));
        add("energy_end_j", json!(self.energy.total_end));
        add("energy_peak_j", json!(self.energy.total_peak));
        add("lost_bodies", json!(self.place.lost));
        add("mean_height_m", json!(self.place.mean_height));
        add("displacement_max_m", json!(self.place.displacement_max));
        Value::Object(report)
    }
}

/// Returns true if a body can touch the shape and be pushed.
fn collides(shape: &ShapeDef) -> bool {
    shape.sensing == Sensing::Solid && shape.filter.mask != 0 && shape.filter.layers != 0
}

/// Returns the larger of two numbers; NaN has priority, so that it shows.
fn worse(a: f32, b: f32) -> f32 {
    if b.is_nan() || b > a { b } else { a }
}
