//! Prints the times of the stages of a scene's step, and counts of their work.

use super::figures::rounded;
use super::peers;
use super::table::Table;
use crate::command;
use anyhow::Result;
use serde_json::Value;
use std::fmt::Write as _;
use std::process::Command;

/// Number of bytes in a MiB.
const MIB: f64 = (1 << 20) as f64;

/// Traces a scene with its own binary and prints the result.
///
/// # Errors
/// If the binary cannot be built, or there is no such scene.
pub fn print(scene: &str, steps: Option<u32>, warm_up: Option<u32>) -> Result<()> {
    let mut run = Command::new(peers::build_ours()?);
    run.args(["trace", "--scene", scene]);
    for (option, value) in [("--steps", steps), ("--warm-up", warm_up)] {
        if let Some(value) = value {
            run.args([option, &value.to_string()]);
        }
    }
    print!("{}", shown(&command::output_json(&mut run)?));
    Ok(())
}

fn shown(trace: &Value) -> String {
    let us = |value: &Value| value.as_f64().map_or("–".to_owned(), rounded);
    let mut text = format!(
        "{}: medians of {} steps after {}; a step takes {} µs of processor time, {} µs on the wall\n",
        trace["scene"].as_str().unwrap_or_default(),
        trace["steps"],
        trace["warm_up"],
        us(&trace["step"]["cpu_us"]),
        us(&trace["step"]["wall_us"]),
    );
    if let Some(stages) = trace["stages_us"].as_object() {
        let sum: f64 = stages.values().filter_map(Value::as_f64).sum();
        let mut table = Table::new(1, ["stage", "µs", "%"]);
        let mut row = |name: &str, us: f64| {
            table.row([name.to_owned(), rounded(us), format!("{:.1}", 100.0 * us / sum)]);
        };
        for (name, value) in stages {
            row(name, value.as_f64().unwrap_or(0.0));
        }
        row("sum", sum);
        let clock = trace["clock"].as_str().unwrap_or_default();
        let cost = us(&trace["clock_us"]);
        write!(text, "\n{table}\nBy the clock of the {clock}, whose reads are about {cost} µs of it.\n")
            .expect("writing to a string cannot fail");
    }
    if trace["counts"].is_object() {
        write!(text, "\n{}", counts(&trace["counts"])).expect("writing to a string cannot fail");
    }
    text
}

/// Returns the medians per step; ratios are those of the medians.
fn counts(counts: &Value) -> Table {
    let of = |key: &str| counts[key].as_f64();
    let ratio = |a: &str, b: &str| Some(of(a)? / of(b).filter(|&b| b > 0.0)?);
    let whole = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.0}"));
    let part = |value: Option<f64>| value.map_or("–".to_owned(), rounded);
    let mib = |key: &str| part(of(key).map(|bytes| bytes / MIB));
    let mut table = Table::new(1, ["count per step", "median"]);
    for (name, value) in [
        ("shapes", whole(of("shapes"))),
        ("pairs", whole(of("pairs"))),
        ("pairs with points", whole(of("pairs_with_points"))),
        ("islands", whole(of("islands"))),
        ("moving bodies", whole(of("bodies"))),
        ("bodies of the largest island", whole(of("largest_island"))),
        ("joints", whole(of("joints"))),
        ("manifolds", whole(of("manifolds"))),
        ("points", whole(of("points"))),
        ("limit rows", whole(of("limit_rows"))),
        ("substeps", part(ratio("body_substeps", "bodies"))),
        ("sweeps of a `solve`", part(ratio("solve_rows", "pass_rows"))),
        ("sweeps of a `relax`", part(ratio("relax_rows", "pass_rows"))),
        ("row visits", whole(of("visits"))),
        ("solver data, MiB", mib("resident_bytes")),
        ("touched of it, MiB", mib("touched_bytes")),
    ] {
        table.row([name.to_owned(), value]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn shares_and_ratios_are_of_the_medians() {
        let shown = shown(&json!({
            "scene": "pile", "warm_up": 10, "steps": 20, "step": { "cpu_us": 400.0, "wall_us": 410.0 },
            "clock": "processor", "clock_us": 1.5, "stages_us": { "pairs": 100.0, "solve": 300.0 },
            "counts": { "bodies": 8.0, "body_substeps": 16.0, "pass_rows": 10.0, "solve_rows": 35.0,
                        "relax_rows": 40.0, "resident_bytes": 3.0 * MIB, "visits": 7.0 },
        }));
        let has = |cells: &[&str]| {
            let row = |line: &str| line.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
            assert!(
                shown.lines().any(|line| row(line)[..].windows(cells.len()).any(|w| w == cells)),
                "{shown}"
            );
        };
        has(&["solve", "300", "75.0"]);
        has(&["sum", "400", "100.0"]);
        has(&["substeps", "2.00"]);
        has(&["sweeps of a `solve`", "3.50"]);
        has(&["solver data, MiB", "3.00"]);
        has(&["joints", "–"]);
    }

    #[test]
    fn work_without_a_world_has_its_time() {
        let text = shown(&json!({ "scene": "rays", "warm_up": 0, "steps": 5,
                                  "step": { "cpu_us": 12.0, "wall_us": null } }));
        assert_eq!(
            text,
            "rays: medians of 5 steps after 0; a step takes 12.0 µs of processor time, – µs on the wall\n"
        );
    }
}
