//! Metrics of falls, as JSON by the contract and as text.

use crate::report::number;
use serde_json::{Map, Value};
use sinew::ragdoll::FallQuality;

/// Returns the metrics under the keys that `bake` and `ragdoll build` share.
pub fn quality_json(q: &FallQuality) -> Map<String, Value> {
    let time = |seconds: Option<f32>| seconds.map_or(Value::Null, number);
    let figures = [
        ("first_contact_s", time(q.first_contact_s)),
        ("settled_s", time(q.settled_s)),
        ("energy_gain_max", number(q.energy_gain_max)),
        ("joint_gap_max_m", number(q.joint_gap_max_m)),
        ("joint_gap_p99_m", number(q.joint_gap_p99_m)),
        ("limit_overshoot_max_deg", number(q.limit_overshoot_max_deg)),
        ("limit_overshoot_p99_deg", number(q.limit_overshoot_p99_deg)),
        ("penetration_max_m", number(q.penetration_max_m)),
        ("penetration_rest_max_m", number(q.penetration_rest_max_m)),
        ("up_s", time(q.up_s)),
        ("work_in_j", number(q.work_in_j)),
        ("nan", q.nan.into()),
    ];
    figures.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}

/// Returns the metrics in a few lines.
pub fn quality_text(q: &FallQuality) -> String {
    let mm = |meters: f32| 1000.0 * meters;
    format!(
        "  joints open by {:.2} mm at most, bend {:.1}° beyond their limits at most (99 %: {:.1}°)\n\
         \x20 sinks {:.1} mm into the world at most, {:.1} mm at rest; energy gain {:.4}; {} numbers not finite\n",
        mm(q.joint_gap_max_m),
        q.limit_overshoot_max_deg,
        q.limit_overshoot_p99_deg,
        mm(q.penetration_max_m),
        mm(q.penetration_rest_max_m),
        q.energy_gain_max,
        q.nan,
    )
}
