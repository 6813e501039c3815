//! Measures a ragdoll step by step.

use super::FallQuality;
use crate::character::{STILL_TIME, is_still, is_sunk, touches_world};
use crate::def::RagdollDef;
use crate::ragdoll::Ragdoll;
use sinew_math::max;
use sinew_physics::{BodyId, Energy, World};

/// Speed below which a body is calm, m/s.
pub(super) const CALM: f32 = 0.3;

/// Collects the metrics of [`FallQuality`] over the steps in which a character is limp.
#[derive(Clone, Debug)]
pub struct QualityMeter {
    quality: FallQuality,
    total_mass: f32,
    before: Energy,
    /// Gap of each joint in each step.
    gaps: Vec<f32>,
    overshoots: Vec<f32>,
    calm_steps: u32,
    calm_since: Option<f32>,
    /// True once the bodies settled after the last fall began.
    has_settled: bool,
    /// Deepest penetration of the bodies in the world in the last step, metres.
    penetration: f32,
    /// True if all bodies slept at some time and none has moved since.
    asleep: bool,
}

impl QualityMeter {
    /// Reserves memory for falls of about `seconds` of one ragdoll.
    pub fn new(def: &RagdollDef, seconds: f32) -> Self {
        let samples = (max(seconds, 0.0) * 60.0) as usize * def.joints.len();
        // Limit the reserved memory: if the caller's estimate is wrong, the vectors grow later.
        let samples = samples.min(1 << 20);
        Self {
            quality: FallQuality::default(),
            total_mass: def.bodies.iter().map(|body| body.mass.mass).sum(),
            before: Energy::default(),
            gaps: Vec::with_capacity(samples),
            overshoots: Vec::with_capacity(samples),
            calm_steps: 0,
            calm_since: None,
            has_settled: false,
            penetration: 0.0,
            asleep: false,
        }
    }

    /// Begins the measurement of a fall. Call this after a ragdoll was spawned, before the next step.
    pub fn went_limp(&mut self) {
        self.calm_steps = 0;
        self.calm_since = None;
        self.has_settled = false;
        self.asleep = false;
    }

    /// Adds the work of a push, J.
    pub fn pushed(&mut self, work: f32) {
        self.quality.work_in_j += work;
    }

    /// Records that the character is animated again.
    pub fn got_up(&mut self, world: &World) {
        self.quality.up_s.get_or_insert(world.time() as f32);
    }

    /// Records the energy before a step. Call this after all pushes.
    pub fn before_step(&mut self, world: &World) {
        self.before = world.energy();
    }

    /// Measures a step. Call this after the step, with the bodies still in the world.
    pub fn after_step(&mut self, world: &World, ragdoll: &Ragdoll) {
        self.measure_motion(world, ragdoll);
        self.measure_rest(world, ragdoll, world.time() as f32);
    }

    /// Measures a step of driven bodies, except the metrics of rest, because driven bodies are not at rest.
    pub fn after_driven_step(&mut self, world: &World, ragdoll: &Ragdoll) {
        self.measure_motion(world, ragdoll);
    }

    /// Measures joints, overlaps and energy. Sleeping bodies keep the values from when they fell asleep.
    fn measure_motion(&mut self, world: &World, ragdoll: &Ragdoll) {
        let slept = core::mem::replace(&mut self.asleep, all_sleep(world, ragdoll));
        if slept && self.asleep {
            return;
        }
        self.measure_energy(world);
        let q = &mut self.quality;
        for &joint in &ragdoll.joints {
            self.gaps.push(world.joint_gap(joint));
            self.overshoots.push(world.joint_overshoot(joint).to_degrees());
        }
        let penetration = ragdoll.bodies.iter().fold(0.0, |deepest, &b| max(deepest, world.penetration(b)));
        q.penetration_max_m = max(q.penetration_max_m, penetration);
        for &(a, b) in &ragdoll.colliding {
            q.nonadjacent_overlap_max_m = max(q.nonadjacent_overlap_max_m, world.overlap(a, b));
        }
        q.nan += world.events().quarantined.len() as u32;
        if q.first_contact_s.is_none() && touches_world(world, &ragdoll.bodies) {
            q.first_contact_s = Some(world.time() as f32);
        }
        self.penetration = penetration;
    }

    fn measure_energy(&mut self, world: &World) {
        let after = world.energy();
        // Compute the difference for each kind of energy: the sums are large and would lose digits.
        let work = world.work().total();
        self.quality.work_in_j += work;
        let rise = (after.kinetic - self.before.kinetic) + (after.potential - self.before.potential) - work;
        let gain = rise / max(self.before.kinetic, self.total_mass);
        self.quality.energy_gain_max = max(self.quality.energy_gain_max, gain);
    }

    fn measure_rest(&mut self, world: &World, ragdoll: &Ragdoll, now: f32) {
        let q = &mut self.quality;
        self.calm_steps = if is_still(world, &ragdoll.bodies) { self.calm_steps + 1 } else { 0 };
        let mut still = self.calm_steps as f32 * world.def().dt();
        if !self.has_settled && still >= STILL_TIME && is_sunk(world, &ragdoll.bodies) {
            (self.calm_steps, still) = (0, 0.0);
        }
        if still >= STILL_TIME {
            self.has_settled = true;
            q.settled_s.get_or_insert(now - still);
        }
        if self.has_settled {
            let spin = |&body: &BodyId| world.velocity(body).angular.length();
            let fastest = ragdoll.bodies.iter().map(spin).fold(q.settled_omega_max.unwrap_or(0.0), max);
            q.settled_omega_max = Some(fastest);
            q.penetration_rest_max_m = max(q.penetration_rest_max_m, self.penetration);
        }
        let calm = |&body: &BodyId| world.velocity(body).linear.length() < CALM;
        if q.first_contact_s.is_some() && self.calm_since.is_none() && ragdoll.bodies.iter().all(calm) {
            self.calm_since = Some(now);
        }
        if q.asleep_s.is_none() && self.asleep {
            q.asleep_s = Some(now);
            q.calm_to_asleep_s = self.calm_since.map(|since| now - since);
        }
    }

    /// Returns the metrics so far.
    pub fn quality(&self) -> FallQuality {
        let mut quality = self.quality;
        let mut sorted = self.gaps.clone();
        (quality.joint_gap_p99_m, quality.joint_gap_max_m) = p99_and_max(&mut sorted);
        sorted.clone_from(&self.overshoots);
        (quality.limit_overshoot_p99_deg, quality.limit_overshoot_max_deg) = p99_and_max(&mut sorted);
        quality
    }
}

fn all_sleep(world: &World, ragdoll: &Ragdoll) -> bool {
    ragdoll.bodies.iter().all(|&body| !world.is_awake(body))
}

/// Returns the 99th percentile (nearest rank) and the largest value; 0 without samples.
fn p99_and_max(samples: &mut [f32]) -> (f32, f32) {
    samples.sort_unstable_by(f32::total_cmp);
    let Some(&largest) = samples.last() else { return (0.0, 0.0) };
    let rank = (samples.len() * 99).div_ceil(100);
    (samples[rank - 1], largest)
}
