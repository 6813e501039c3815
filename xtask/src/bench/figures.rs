//! Quality metrics listed beside the times, and their formatting.

use super::results::{EngineResult, SceneResult};
use serde_json::Value;

/// Unit of a metric.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A length in metres, written in millimetres up to a metre.
    Length,
    /// A share of a whole, written in per cent.
    Share,
    /// An energy in joules.
    Energy,
    /// An angle in radians, written in degrees.
    Angle,
    /// A count.
    Count,
}

/// A metric of quality.
pub struct Figure {
    /// Heading in tables.
    pub heading: &'static str,
    /// Unit of the metric.
    pub unit: Unit,
    /// Returns the metric; `None` if it was not measured.
    pub of: fn(&EngineResult) -> Option<f64>,
}

/// Largest distance between the two anchors of a joint after any step.
pub const GAP: Figure = Figure { heading: "gap", unit: Unit::Length, of: |e| number(e, "joint_gap_peak_m") };
/// Sum of a chain's gaps divided by its length, after any step.
pub const STRETCH: Figure =
    Figure { heading: "stretch", unit: Unit::Share, of: |e| number(e, "stretch_peak") };
/// Sum of a chain's gaps divided by its length, after the last step.
pub const STRETCH_END: Figure =
    Figure { heading: "stretch at the end", unit: Unit::Share, of: |e| number(e, "stretch_end") };
/// Mean gap of the joints of a rope at its largest.
pub const GAP_PER_LINK: Figure =
    Figure { heading: "gap per link", unit: Unit::Length, of: |e| number(e, "gap_per_link") };
/// Number of limits exceeded by more than 0.1 rad after any step.
pub const LIMITS: Figure = Figure {
    heading: "limits > 0.1 rad",
    unit: Unit::Count,
    of: |e| over_limits(e, "exceeded_run", |a, b| a + b),
};
/// Deepest overlap of two bodies after any checked step.
pub const DEPTH: Figure =
    Figure { heading: "depth", unit: Unit::Length, of: |e| number(e, "penetration_run_max_m") };
/// Deepest overlap of two bodies after the last step.
pub const DEPTH_END: Figure =
    Figure { heading: "depth at the end", unit: Unit::Length, of: |e| number(e, "penetration_end_max_m") };
/// 99th percentile of the overlaps after the last step.
pub const DEPTH_P99: Figure =
    Figure { heading: "its p99", unit: Unit::Length, of: |e| number(e, "penetration_end_p99_m") };
/// Displacement of a body that should stay.
pub const SHIFT: Figure =
    Figure { heading: "shift", unit: Unit::Length, of: |e| number(e, "displacement_max_m") };
/// Step after which all bodies sleep; `None` if one never sleeps.
pub const ASLEEP: Figure =
    Figure { heading: "asleep at step", unit: Unit::Count, of: |e| number(e, "asleep_step") };
/// Mean stretch of a cloth's edges.
pub const CLOTH: Figure =
    Figure { heading: "mean stretch", unit: Unit::Share, of: |e| number(e, "stretch_mean") };
/// Largest distance of a joint from its position in the clips, in model space.
pub const POSE: Figure =
    Figure { heading: "pose error", unit: Unit::Length, of: |e| number(e, "model_error_max_m") };
/// Share of rays or pairs that hit.
pub const HITS: Figure = Figure { heading: "hits", unit: Unit::Share, of: |e| e.number("hit_share") };

/// All metrics, in the order of the columns.
pub const FIGURES: &[Figure] = &[
    GAP,
    Figure { heading: "gap at the end", unit: Unit::Length, of: |e| number(e, "joint_gap_end_max_m") },
    GAP_PER_LINK,
    STRETCH,
    STRETCH_END,
    LIMITS,
    Figure { heading: "worst limit", unit: Unit::Angle, of: |e| over_limits(e, "worst_run_rad", f64::max) },
    DEPTH,
    DEPTH_END,
    DEPTH_P99,
    SHIFT,
    ASLEEP,
    CLOTH,
    Figure { heading: "largest stretch", unit: Unit::Share, of: |e| number(e, "stretch_max") },
    Figure { heading: "motion at the end", unit: Unit::Energy, of: |e| number(e, "kinetic_energy_end_j") },
    Figure { heading: "energy gained", unit: Unit::Energy, of: energy_gained },
    Figure { heading: "energy lost", unit: Unit::Energy, of: energy_lost },
    Figure { heading: "lost bodies", unit: Unit::Count, of: |e| number(e, "lost_bodies") },
    POSE,
    Figure { heading: "rotation error", unit: Unit::Angle, of: |e| number(e, "rotation_error_max_rad") },
    HITS,
];

/// Returns the metric that shows whether engines did the same work in a scene.
pub fn headline(scene: &str) -> &'static Figure {
    match scene {
        "box_pyramid" | "large_pyramid" => &SHIFT,
        "stack_mass_ratio" | "stack_ratio" | "jenga" | "cards" | "arch" => &SHIFT,
        "ragdolls" | "wave_pile" | "mesh_drop" => &ASLEEP,
        "box_rain" | "boxes_10000" => &DEPTH,
        "humanoid_lying" | "humanoid_pile_10" | "humanoid_pile_100" => &DEPTH,
        "chain_100_links" => &STRETCH,
        "heavy_rope" | "hanging_rope" => &GAP_PER_LINK,
        "cloth" => &CLOTH,
        "crowd" => &POSE,
        "rays" | "obb_tests" | "obb_tests_streamed" => &HITS,
        _ => &GAP,
    }
}

/// Returns true if the joints came apart, so that the time is for different work.
pub fn came_apart(engine: &EngineResult) -> bool {
    const GAP_MAX: f64 = 0.5;
    const STRETCH_MAX: f64 = 1.0;
    (GAP.of)(engine).is_some_and(|gap| gap > GAP_MAX) || (STRETCH.of)(engine).is_some_and(|s| s > STRETCH_MAX)
}

fn number(engine: &EngineResult, key: &str) -> Option<f64> {
    engine.judged(|quality| quality.get(key)?.as_f64())
}

fn over_limits(engine: &EngineResult, key: &str, fold: fn(f64, f64) -> f64) -> Option<f64> {
    engine.judged(|quality| {
        let kinds = quality.get("limits")?.as_object()?;
        kinds
            .values()
            .map(|kind: &Value| kind[key].as_f64())
            .try_fold(0.0, |sum, value| Some(fold(sum, value?)))
    })
}

/// Returns the largest energy above the initial one; nothing adds energy.
fn energy_gained(engine: &EngineResult) -> Option<f64> {
    Some((number(engine, "energy_peak_j")? - number(engine, "energy_start_j")?).max(0.0))
}

/// Returns the energy lost at the end, by dissipation or error.
fn energy_lost(engine: &EngineResult) -> Option<f64> {
    Some(number(engine, "energy_start_j")? - number(engine, "energy_end_j")?)
}

/// Returns the relevant metrics of a scene: those measured and not all 0, and the shift of bodies only where they
/// should stay.
pub fn telling(scene: &SceneResult) -> Vec<&'static Figure> {
    let is_telling = |figure: &Figure| {
        let mut values = scene.engines.iter().filter_map(figure.of);
        let belongs = figure.heading != SHIFT.heading || headline(&scene.name).heading == SHIFT.heading;
        belongs && (figure.heading == headline(&scene.name).heading || values.any(|value| value != 0.0))
    };
    FIGURES.iter().filter(|figure| is_telling(figure)).collect()
}

impl Unit {
    /// Formats a value with its unit, rounded.
    pub fn show(self, value: f64) -> String {
        let (value, unit) = self.scaled(value);
        if self == Self::Count { format!("{value:.0}") } else { format!("{}{unit}", rounded(value)) }
    }

    /// Formats a value with its unit, unrounded.
    pub fn show_bound(self, value: f64) -> String {
        let (value, unit) = self.scaled(value);
        format!("{}{unit}", value as f32)
    }

    /// Converts to a readable unit.
    fn scaled(self, value: f64) -> (f64, &'static str) {
        match self {
            Self::Length if value.abs() >= 1.0 => (value, " m"),
            Self::Length => (value * 1e3, " mm"),
            Self::Share => (value * 1e2, " %"),
            Self::Energy if value.abs() >= 1e3 => (value * 1e-3, " kJ"),
            Self::Energy => (value, " J"),
            Self::Angle => (value.to_degrees(), "°"),
            Self::Count => (value, ""),
        }
    }
}

/// Formats a number with three significant digits, at most three after the decimal point.
pub fn rounded(value: f64) -> String {
    let decimals = match value.abs() {
        0.0 => 0,
        x if x >= 99.95 => 0,
        x if x >= 9.995 => 1,
        x if x >= 0.9995 => 2,
        _ => 3,
    };
    let text = format!("{value:.decimals$}");
    if value != 0.0 && text.trim_start_matches('-').chars().all(|digit| "0.".contains(digit)) {
        return "< 0.001".to_owned();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::results::tests::engine;
    use super::*;
    use serde_json::json;

    #[test]
    fn numbers_are_short_and_have_units() {
        assert_eq!(
            [0.0, 0.0004, 0.12, 1.0, 23.456, 1234.5].map(rounded),
            ["0", "< 0.001", "0.120", "1.00", "23.5", "1234"]
        );
        assert_eq!(Unit::Length.show(0.1734), "173 mm");
        assert_eq!(Unit::Length.show(15.2), "15.2 m");
        assert_eq!(Unit::Share.show(0.063), "6.30 %");
        assert_eq!(Unit::Energy.show(27.5), "27.5 J");
        assert_eq!(Unit::Count.show(12.0), "12");
        assert_eq!(Unit::Length.show_bound(2e-4), "0.2 mm");
    }

    #[test]
    fn limits_of_all_kinds_count_together() {
        let limits = json!({ "cone": { "exceeded_run": 2, "worst_run_rad": 0.1 },
                             "hinge": { "exceeded_run": 3, "worst_run_rad": 0.4 } });
        let quality = json!({ "limits": limits, "energy_start_j": 10.0, "energy_peak_j": 12.5 });
        let engine = engine("rapier", &[1.0], &quality);
        assert_eq!((LIMITS.of)(&engine), Some(5.0));
        let worst = FIGURES.iter().find(|figure| figure.heading == "worst limit").expect("the column exists");
        assert_eq!((worst.of)(&engine), Some(0.4));
        assert_eq!(energy_gained(&engine), Some(2.5));
        assert_eq!((GAP.of)(&engine), None);
    }

    #[test]
    fn open_joints_are_detected() {
        let of = |quality| engine("jolt", &[1.0], &quality);
        assert!(came_apart(&of(json!({ "joint_gap_peak_m": 11.0 }))));
        assert!(came_apart(&of(json!({ "joint_gap_peak_m": 0.2, "stretch_peak": 16.6 }))));
        assert!(!came_apart(&of(json!({ "joint_gap_peak_m": 0.2, "stretch_peak": 0.3 }))));
    }
}
