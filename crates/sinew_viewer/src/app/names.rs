//! Names and values of metrics in plain words, with units.

/// Endings of names, the longest first, and their units.
const UNITS: [(&str, &str); 18] = [
    ("_cm_s_per_m", "cm/s per m"),
    ("_m2_s2", "m²/s²"),
    ("_rad_s2", "rad/s²"),
    ("_n_m_s", "N·m·s"),
    ("_rad_s", "rad/s"),
    ("_cm_s", "cm/s"),
    ("_m_s2", "m/s²"),
    ("_m_s", "m/s"),
    ("_n_s", "N·s"),
    ("_mps", "m/s"),
    ("_deg", "°"),
    ("_rad", "rad"),
    ("_j2", "J²"),
    ("_ms", "ms"),
    ("_m", "m"),
    ("_s", "s"),
    ("_j", "J"),
    ("_n", "N"),
];

/// Endings of names before their units, and the words in front that replace them.
const KINDS: [(&str, &str); 6] = [
    ("_p99", "99 % of"),
    ("_p95", "95 % of"),
    ("_max", "largest"),
    ("_most", "largest"),
    ("_mean", "mean"),
    ("_peak", "peak"),
];

/// Names that every scene has.
const SPECIAL: [(&str, &str); 2] =
    [("nan", "bodies with invalid numbers"), ("energy_gain_max", "largest energy gain in a step")];

/// Length below which lengths are shown in millimetres, metres.
const SMALL: f64 = 0.1;

/// Returns the plain name and the unit of a metric.
pub(super) fn plain(name: &str) -> (String, &'static str) {
    if let Some((_, words)) = SPECIAL.iter().find(|(it, _)| *it == name) {
        return ((*words).to_owned(), "");
    }
    let found = UNITS.iter().find_map(|&(ending, unit)| Some((name.strip_suffix(ending)?, unit)));
    let (stem, unit) = found.unwrap_or((name, ""));
    let kind = KINDS.iter().find_map(|&(ending, words)| Some((stem.strip_suffix(ending)?, words)));
    let (stem, words) = kind.unwrap_or((stem, ""));
    let stem = stem.replace('_', " ");
    (if words.is_empty() { stem } else { format!("{words} {stem}") }, unit)
}

/// Returns a value with its unit.
pub(super) fn value(value: f64, unit: &str) -> String {
    match unit {
        "m" if value != 0.0 && value.abs() < SMALL => format!("{} mm", digits(1e3 * value)),
        "" => digits(value),
        "°" => format!("{}°", digits(value)),
        _ => format!("{} {unit}", digits(value)),
    }
}

/// Formats a number with five digits; a whole number without decimals.
pub(super) fn digits(x: f64) -> String {
    let size = x.abs();
    if x.fract() == 0.0 && size < 1e6 {
        return format!("{x:.0}");
    }
    if !(1e-3..1e5).contains(&size) {
        return format!("{x:.3e}");
    }
    let decimals = [1.0, 10.0, 100.0, 1000.0].iter().filter(|&&bound| size < bound).count();
    format!("{x:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::{plain, value};

    #[test]
    fn metric_names_are_words_and_values_have_units() {
        for (name, words, unit) in [
            ("limit_overshoot_p99_deg", "99 % of limit overshoot", "°"),
            ("joint_gap_max_m", "largest joint gap", "m"),
            ("slide_cm_s_per_m", "slide", "cm/s per m"),
            ("nan", "bodies with invalid numbers", ""),
            ("falls", "falls", ""),
            ("momentum_n_s", "momentum", "N·s"),
        ] {
            assert_eq!(plain(name), (words.to_owned(), unit));
        }
        assert_eq!(value(3.0, ""), "3");
        assert_eq!(value(0.001_25, "m"), "1.250 mm");
        assert_eq!(value(0.0, "m"), "0 m");
        assert_eq!(value(1.5, "°"), "1.500°");
        assert_eq!(value(2e-9, "J"), "2.000e-9 J");
    }
}
