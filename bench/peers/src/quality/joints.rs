//! Gaps of joints.

use super::chains::Chain;
use super::worse;
use crate::engine::{BodyState, joint_frames};
use sinew::math::Vec3;
use sinew_scenes::blueprint::Blueprint;

/// Distances between the two anchors of a joint.
#[derive(Clone, Debug, PartialEq)]
pub struct JointQuality {
    /// Largest distance over all joints and steps, metres.
    pub gap_peak: f32,
    /// Largest distance at the end, metres.
    pub gap_end_max: f32,
    /// Mean distance of the joints at the end, metres.
    pub gap_end_mean: f32,
    /// Largest gap of a chain over all steps, as a share of the mean length of its links. `None` without chains.
    pub gap_per_link: Option<f32>,
    /// Largest sum of a chain's gaps over all steps, as a share of the chain's length. `None` without chains.
    pub stretch_peak: Option<f32>,
    /// Sum of a chain's gaps at the end, as a share of the chain's length.
    pub stretch_end: Option<f32>,
}

pub(super) struct JointMeter {
    anchors: Vec<Anchors>,
    chains: Vec<Chain>,
    gaps: Vec<f32>,
    gap_peak: f32,
    gap_per_link: f32,
    stretch_peak: f32,
}

/// Bodies of a joint, and the joint's position in each.
struct Anchors {
    bodies: [usize; 2],
    local: [Vec3; 2],
}

impl JointMeter {
    pub fn new(scene: &Blueprint) -> Self {
        let anchors = scene.joints.iter().map(|joint| Anchors {
            bodies: [joint.a, joint.b],
            local: joint_frames(scene, joint).map(|frame| frame.translation),
        });
        Self {
            anchors: anchors.collect(),
            chains: Chain::find(scene),
            gaps: Vec::new(),
            gap_peak: 0.0,
            gap_per_link: 0.0,
            stretch_peak: 0.0,
        }
    }

    pub fn observe(&mut self, states: &[BodyState]) {
        self.measure(states);
        self.gap_peak = self.gaps.iter().copied().fold(self.gap_peak, worse);
        for chain in &self.chains {
            self.gap_per_link = worse(self.gap_per_link, chain.gap_per_link(&self.gaps));
            self.stretch_peak = worse(self.stretch_peak, chain.stretch(&self.gaps));
        }
    }

    pub fn finish(&mut self, states: &[BodyState]) -> Option<JointQuality> {
        self.measure(states);
        let has_chains = !self.chains.is_empty();
        let stretch_end = self.chains.iter().map(|chain| chain.stretch(&self.gaps)).fold(0.0, worse);
        (!self.gaps.is_empty()).then(|| JointQuality {
            gap_peak: self.gap_peak,
            gap_end_max: self.gaps.iter().copied().fold(0.0, worse),
            gap_end_mean: self.gaps.iter().sum::<f32>() / self.gaps.len() as f32,
            gap_per_link: has_chains.then_some(self.gap_per_link),
            stretch_peak: has_chains.then_some(self.stretch_peak),
            stretch_end: has_chains.then_some(stretch_end),
        })
    }

    fn measure(&mut self, states: &[BodyState]) {
        self.gaps.clear();
        self.gaps.extend(self.anchors.iter().map(|joint| {
            let [a, b] = [0, 1].map(|side| {
                let body = &states[joint.bodies[side]];
                body.world_from_body.point(joint.local[side])
            });
            (b - a).length()
        }));
    }
}
