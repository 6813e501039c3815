//! Overshoot of joint limits.

use super::worse;
use crate::engine::{BodyState, joint_frames};
use serde_json::{Value, json};
use sinew::math::limits::{hinge_angle, wrap};
use sinew::math::{Range, Rotation, SwingTwistLimit, Vec3, trig};
use sinew::physics::JointKind;
use sinew_scenes::blueprint::Blueprint;

/// Overshoot from which a joint is counted, radians.
const TOLERANCE: f32 = 0.1;

/// Overshoots of limits by kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LimitQuality {
    /// Swing cones of balls.
    pub cone: LimitTally,
    /// Twist ranges of balls.
    pub twist: LimitTally,
    /// Ranges of hinges.
    pub hinge: LimitTally,
    /// Angles between the two axes of hinges, which should be 0.
    pub axis: LimitTally,
}

/// Overshoots of one kind of limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LimitTally {
    /// Number of joints with such a limit.
    pub joints: usize,
    /// Number of joints more than 0.1 rad beyond the limit at the end.
    pub exceeded_end: usize,
    /// Number of joints more than 0.1 rad beyond the limit after any step.
    pub exceeded_run: usize,
    /// Largest overshoot at the end, radians.
    pub worst_end: f32,
    /// Largest overshoot after any step, radians.
    pub worst_run: f32,
}

impl LimitQuality {
    /// Returns the tally as part of a report.
    pub fn to_json(&self) -> Value {
        let tally = |tally: &LimitTally| {
            json!({
                "joints": tally.joints,
                "exceeded_end": tally.exceeded_end,
                "exceeded_run": tally.exceeded_run,
                "worst_end_rad": tally.worst_end,
                "worst_run_rad": tally.worst_run,
            })
        };
        json!({
            "cone": tally(&self.cone),
            "twist": tally(&self.twist),
            "hinge": tally(&self.hinge),
            "axis": tally(&self.axis),
        })
    }
}

impl LimitTally {
    fn count(&mut self, now: f32, run: f32) {
        self.joints += 1;
        self.exceeded_end += usize::from(is_exceeded(now));
        self.exceeded_run += usize::from(is_exceeded(run));
        self.worst_end = worse(self.worst_end, now);
        self.worst_run = worse(self.worst_run, run);
    }
}

/// Returns true if an excess is beyond the tolerance, or NaN.
fn is_exceeded(excess: f32) -> bool {
    excess.is_nan() || excess > TOLERANCE
}

pub(super) struct LimitMeter {
    joints: Vec<LimitedJoint>,
}

struct LimitedJoint {
    bodies: [usize; 2],
    frames: [Rotation; 2],
    limit: Limit,
    /// Largest excess so far.
    run: Excess,
}

#[derive(Clone, Copy)]
enum Limit {
    Ball(SwingTwistLimit),
    Hinge(Option<Range>),
}

/// Angles beyond the limits of a joint, radians: swing and twist of a ball, or angle and axis of a hinge; 0 inside.
type Excess = [f32; 2];

impl LimitMeter {
    pub fn new(scene: &Blueprint) -> Self {
        let limited = scene.joints.iter().filter_map(|joint| {
            let limit = match joint.kind {
                JointKind::Ball { limit } => Limit::Ball(limit?),
                JointKind::Hinge { limit } => Limit::Hinge(limit),
                _ => return None,
            };
            let frames = joint_frames(scene, joint).map(|frame| frame.rotation);
            Some(LimitedJoint { bodies: [joint.a, joint.b], frames, limit, run: [0.0; 2] })
        });
        Self { joints: limited.collect() }
    }

    pub fn observe(&mut self, states: &[BodyState]) {
        for joint in &mut self.joints {
            let now = joint.excess(states);
            joint.run = [0, 1].map(|k| worse(joint.run[k], now[k]));
        }
    }

    pub fn finish(&mut self, states: &[BodyState]) -> Option<LimitQuality> {
        let mut quality = LimitQuality::default();
        for joint in &self.joints {
            let now = joint.excess(states);
            let tallies = match joint.limit {
                Limit::Ball(_) => [Some(&mut quality.cone), Some(&mut quality.twist)],
                Limit::Hinge(Some(_)) => [Some(&mut quality.hinge), Some(&mut quality.axis)],
                Limit::Hinge(None) => [None, Some(&mut quality.axis)],
            };
            for (k, tally) in tallies.into_iter().enumerate() {
                if let Some(tally) = tally {
                    tally.count(now[k], joint.run[k]);
                }
            }
        }
        (!self.joints.is_empty()).then_some(quality)
    }
}

impl LimitedJoint {
    fn excess(&self, states: &[BodyState]) -> Excess {
        let [a, b] =
            [0, 1].map(|side| states[self.bodies[side]].world_from_body.rotation * self.frames[side]);
        let joint = a.inverse() * b;
        match self.limit {
            Limit::Ball(limit) => {
                let [below, above] = limit.twist_states(joint);
                [worse(0.0, -limit.swing_state(joint).slack), worse(worse(0.0, -below.slack), -above.slack)]
            }
            Limit::Hinge(range) => {
                let excess = range.map_or(0.0, |range| {
                    let half = 0.5 * (range.hi - range.lo);
                    worse(0.0, wrap(hinge_angle(joint) - range.center()).abs() - half)
                });
                let axis = joint * Vec3::X;
                [excess, trig::atan2(axis.cross(Vec3::X).length(), axis.x)]
            }
        }
    }
}
