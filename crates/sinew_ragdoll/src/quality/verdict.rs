//! Derives a verdict from metrics, by the limits of the specification (section 4).

use super::FallQuality;
use super::drop_test::worse;

/// Verdict on a ragdoll's fitness for use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Some metric is beyond the value at which a ragdoll is bad.
    Bad,
    /// Nothing breaks, but some metric is outside its limit.
    Usable,
    /// Every measured metric is inside its limit.
    Good,
}

impl Verdict {
    /// Returns `good`, `usable` or `bad`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Usable => "usable",
            Self::Bad => "bad",
        }
    }
}

/// Limit of one metric.
struct Limit {
    what: &'static str,
    value: Option<f32>,
    good: f32,
    /// Value beyond which the ragdoll is bad; infinite if the metric alone never makes it bad.
    usable: f32,
}

impl Limit {
    fn of(what: &'static str, value: f32, good: f32, usable: f32) -> Self {
        Self { what, value: Some(value), good, usable }
    }
}

/// Judges drops and a 15 m/s wall hit together. The reasons name each metric beyond its limit, and each that was not
/// measured.
pub fn judge(drop: &FallQuality, wall: &FallQuality) -> (Verdict, Vec<String>) {
    let timed = |what, value, good, usable| Limit { what, value, good, usable };
    let [broken, ajar, open, p99, overshoot] = of_joints(&worse(*drop, *wall));
    let limits = [
        Limit { value: Some((drop.nan + wall.nan) as f32), ..broken },
        Limit::of("energy gain of a drop", drop.energy_gain_max, 0.01, f32::INFINITY),
        Limit::of("energy gain at the wall", wall.energy_gain_max, 0.01, f32::INFINITY),
        ajar,
        open,
        p99,
        overshoot,
        timed("time to sleep after a drop, s", drop.asleep_s, 6.0, 8.0),
        timed("time from calm to sleep, s", drop.calm_to_asleep_s, 3.0, f32::INFINITY),
        timed("spin once settled, rad/s", drop.settled_omega_max, 0.05, f32::INFINITY),
        Limit::of("overlap of bodies, m", drop.nonadjacent_overlap_max_m, 0.01, 0.03),
        Limit::of("sinking at rest, m", drop.penetration_rest_max_m, 5e-3, f32::INFINITY),
    ];
    let (verdict, mut reasons) = verdict_of(limits);
    reasons.push("hand-over momentum: not measured, no clip is played here".to_owned());
    (verdict, reasons)
}

/// Judges a character in any world, also with hits or a travelling clip. The limits are those of [`judge`], except the
/// times to sleep and the spin after settling, which depend on the world and on later events. The reasons name each
/// metric beyond its limit.
pub fn judge_bake(quality: &FallQuality) -> (Verdict, Vec<String>) {
    let [broken, ajar, open, p99, overshoot] = of_joints(quality);
    verdict_of([
        broken,
        Limit::of("energy gain", quality.energy_gain_max, 0.01, f32::INFINITY),
        ajar,
        open,
        p99,
        overshoot,
        Limit::of("overlap of bodies, m", quality.nonadjacent_overlap_max_m, 0.01, 0.03),
        Limit::of("sinking at rest, m", quality.penetration_rest_max_m, 5e-3, f32::INFINITY),
    ])
}

/// Returns the limits of a ragdoll's joints, which hold in any world.
fn of_joints(q: &FallQuality) -> [Limit; 5] {
    [
        Limit::of("bodies with a state that is not finite", q.nan as f32, 0.0, 0.0),
        Limit::of("joint gap p99, m", q.joint_gap_p99_m, 1e-3, 0.02),
        Limit::of("joint gap, m", q.joint_gap_max_m, 5e-3, 0.02),
        Limit::of("limit overshoot p99, degrees", q.limit_overshoot_p99_deg, 2.0, f32::INFINITY),
        Limit::of("limit overshoot, degrees", q.limit_overshoot_max_deg, 4.0, f32::INFINITY),
    ]
}

fn verdict_of(limits: impl IntoIterator<Item = Limit>) -> (Verdict, Vec<String>) {
    let mut verdict = Verdict::Good;
    let mut reasons = Vec::new();
    for Limit { what, value, good, usable } in limits {
        let Some(value) = value else {
            reasons.push(format!("{what}: it never came to that within the test"));
            verdict =
                Verdict::min(verdict, if usable < f32::INFINITY { Verdict::Bad } else { Verdict::Usable });
            continue;
        };
        // Comparisons with NaN are false, so a metric that is NaN is bad.
        if value <= good {
            continue;
        }
        reasons.push(format!("{what}: {value:.4}, limit {good}"));
        verdict = Verdict::min(verdict, if value <= usable { Verdict::Usable } else { Verdict::Bad });
    }
    (verdict, reasons)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bake_has_the_limits_of_a_drop() {
        assert_eq!(judge_bake(&FallQuality::default()), (Verdict::Good, vec![]));
        let beyond = FallQuality { limit_overshoot_max_deg: 22.0, ..FallQuality::default() };
        let said = vec!["limit overshoot, degrees: 22.0000, limit 4".to_owned()];
        assert_eq!(judge_bake(&beyond), (Verdict::Usable, said));
        let open = FallQuality { joint_gap_max_m: 0.03, energy_gain_max: 0.07, ..FallQuality::default() };
        let (verdict, reasons) = judge_bake(&open);
        assert_eq!((verdict, reasons.len()), (Verdict::Bad, 2));
        let poisoned = FallQuality { joint_gap_p99_m: f32::NAN, ..FallQuality::default() };
        assert_eq!(judge_bake(&poisoned).0, Verdict::Bad);
    }
}
