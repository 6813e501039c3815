//! From figures to a verdict, by the limits of the specification (section 4).

use super::Quality;

/// Whether a ragdoll is fit for use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Some figure is beyond use.
    Bad,
    /// Nothing breaks, but some figure is outside its limit.
    Usable,
    /// Every measured figure is inside its limit.
    Good,
}

impl Verdict {
    /// `good`, `usable` or `bad`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Usable => "usable",
            Self::Bad => "bad",
        }
    }
}

/// A limit on one figure.
struct Limit {
    what: &'static str,
    value: Option<f32>,
    good: f32,
    /// Beyond it the ragdoll is bad; infinite if the figure alone never makes it so.
    usable: f32,
}

/// Judges drops and a 15 m/s wall hit together. The reasons name each figure outside its limit, and each that was not
/// measured.
pub fn judge(drop: &Quality, wall: &Quality) -> (Verdict, Vec<String>) {
    let limit = |what, value, good, usable| Limit { what, value: Some(value), good, usable };
    let timed = |what, value, good, usable| Limit { what, value, good, usable };
    let limits = [
        limit("bodies with a state that is not finite", (drop.nan + wall.nan) as f32, 0.0, 0.0),
        limit("energy gain of a drop", drop.energy_gain_max, 0.01, f32::INFINITY),
        limit("energy gain at the wall", wall.energy_gain_max, 0.01, f32::INFINITY),
        limit("joint gap p99, m", sinew_math::max(drop.joint_gap_p99_m, wall.joint_gap_p99_m), 1e-3, 0.02),
        limit("joint gap, m", sinew_math::max(drop.joint_gap_max_m, wall.joint_gap_max_m), 5e-3, 0.02),
        limit(
            "limit overshoot p99, degrees",
            sinew_math::max(drop.limit_overshoot_p99_deg, wall.limit_overshoot_p99_deg),
            2.0,
            f32::INFINITY,
        ),
        limit(
            "limit overshoot, degrees",
            sinew_math::max(drop.limit_overshoot_max_deg, wall.limit_overshoot_max_deg),
            4.0,
            f32::INFINITY,
        ),
        timed("time to sleep after a drop, s", drop.asleep_s, 6.0, 8.0),
        timed("time from calm to sleep, s", drop.calm_to_asleep_s, 3.0, f32::INFINITY),
        timed("spin once settled, rad/s", drop.settled_omega_max, 0.05, f32::INFINITY),
        limit("overlap of bodies, m", drop.nonadjacent_overlap_max_m, 0.01, 0.03),
        limit("sinking at rest, m", drop.penetration_rest_max_m, 5e-3, f32::INFINITY),
    ];
    let mut verdict = Verdict::Good;
    let mut reasons = Vec::new();
    for Limit { what, value, good, usable } in limits {
        let Some(value) = value else {
            reasons.push(format!("{what}: it never came to that within the test"));
            verdict =
                Verdict::min(verdict, if usable < f32::INFINITY { Verdict::Bad } else { Verdict::Usable });
            continue;
        };
        // Comparisons with NaN are false, so a poisoned figure is bad.
        if value <= good {
            continue;
        }
        reasons.push(format!("{what}: {value:.4}, limit {good}"));
        verdict = Verdict::min(verdict, if value <= usable { Verdict::Usable } else { Verdict::Bad });
    }
    reasons.push("hand-over momentum: not measured, no clip is played here".to_owned());
    (verdict, reasons)
}
