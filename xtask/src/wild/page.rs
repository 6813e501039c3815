//! Metrics of all files as tables.

use super::Row;
use crate::bench::table::Table;
use serde_json::Value;
use std::fmt::Write as _;

const HEAD: &str = "# Characters from the wild

Made by `cargo xtask wild`. No file has settings or code of its own. Files are those beside the repository, in
`../shared/data`.

Roles are right where they stand in `crates/sinew_anim/tests/data/truth.txt`, which was written by reading the files' names and looking;
of all: those of the table and those that were given. *By names* is with every joint moved aside at random, so that nothing but its
name tells what it is; *by shape*, of files with meshes, with a number for every name. Skeletons have no mesh: theirs is made up, a pyramid around each bone. Creatures that are no humanoids have no truth in that table: tests hold that
none of them is taken for one.
";

const ROLES: [&str; 4] = ["file", "roles", "by names", "by shape"];

const RIGS: [&str; 13] = [
    "file",
    "verdict",
    "bodies",
    "m",
    "kg",
    "covered, %",
    "stretch 1 ‰ and worst, %",
    "asymmetry, %",
    "drawn/bound",
    "lowest at rest, %",
    "in the air, s",
    "build, s",
    "bake, s",
];

const BAKES: [&str; 8] = [
    "file",
    "energy gain",
    "gap p99, mm",
    "gap, mm",
    "beyond limit p99, °",
    "beyond limit, °",
    "in the ground at rest, mm",
    "still after, s",
];

/// Returns the whole page.
pub fn page(rows: &[Row], roles: &Value) -> String {
    let mut page = format!("{HEAD}\n{}\n", summary(rows, roles));
    let _ = write!(
        page,
        "## How they fall: eight drops, and the skin over them\n\nSeconds are of the whole command, on one processor among others at work. Shares are of the size: a human's height, a creature's longest side.\n\n{}\n",
        drops(rows)
    );
    let _ = write!(
        page,
        "## How they bake: limp at 0.5 s out of the file's own clip, on a floor\n\n{}\n",
        bakes(rows)
    );
    let _ = write!(page, "## Roles, right of all\n\n{}\n", recognised(roles));
    let _ = write!(page, "## Reasons\n\n{}", reasons(rows));
    page
}

/// Returns the sums over all files of one column of roles: correct, and total.
fn sum(roles: &Value, column: &str) -> (u64, u64) {
    let pairs = roles.as_object().into_iter().flatten().filter_map(|(_, row)| pair(&row[column]));
    pairs.fold((0, 0), |sum, pair| (sum.0 + pair.0, sum.1 + pair.1))
}

fn pair(value: &Value) -> Option<(u64, u64)> {
    Some((value[0].as_u64()?, value[1].as_u64()?))
}

fn summary(rows: &[Row], roles: &Value) -> String {
    let mut text = String::new();
    for (column, what, bar) in [
        ("plain", "with names and shape", 98),
        ("by_names", "by names alone", 98),
        ("by_shape", "with numbers for names", 90),
    ] {
        let (right, all) = sum(roles, column);
        let share = 100.0 * right as f64 / all.max(1) as f64;
        let _ = writeln!(
            text,
            "- Roles of humanoids {what}: {right} of {all} right, {share:.1} % (bar: {bar} %)"
        );
    }
    let count = |verdict: &str| {
        rows.iter().filter(|row| row.report["build"]["quality"]["verdict"] == verdict).count()
    };
    let refused = rows.iter().filter(|row| !row.report["refused"].is_null()).count();
    let [good, usable, bad] = ["good", "usable", "bad"].map(count);
    let _ = writeln!(
        text,
        "- {} files with meshes: {good} good, {usable} usable, {bad} bad, {refused} refused",
        rows.len()
    );
    text
}

fn built(rows: &[Row]) -> impl Iterator<Item = &Row> {
    rows.iter().filter(|row| row.report["refused"].is_null())
}

fn drops(rows: &[Row]) -> Table {
    let mut table = Table::new(2, RIGS);
    for row in built(rows) {
        let (build, skin) = (&row.report["build"], &row.report["build"]["quality"]["skin"]);
        let size = skin["size_m"].as_f64().unwrap_or(f64::NAN);
        let percent = |key: &str| figure(&skin[key], 100.0, 1);
        let of_size = |key: &str| figure(&skin[key], 100.0 / size, 1);
        let drawn = skin["drawn_height_m"].as_f64().zip(skin["bind_height_m"].as_f64());
        table.row([
            row.file.clone(),
            build["quality"]["verdict"].as_str().unwrap_or("–").to_owned(),
            build["bodies"].as_array().map_or(0, Vec::len).to_string(),
            figure(&build["height_m"], 1.0, 2),
            figure(&build["total_mass_kg"], 1.0, 1),
            percent("covered_share"),
            format!("{} · {}", percent("edge_stretch_p999"), percent("edge_stretch_max")),
            of_size("symmetry_error_m"),
            drawn.map_or("–".to_owned(), |(drawn, bound)| format!("{:.3}", drawn / bound)),
            of_size("rest_height_m"),
            figure(&skin["airborne_s"], 1.0, 2),
            figure(&row.report["build_s"], 1.0, 1),
            figure(&row.report["bake_s"], 1.0, 1),
        ]);
    }
    table
}

fn bakes(rows: &[Row]) -> Table {
    let mut table = Table::new(1, BAKES);
    for row in built(rows) {
        let bake = &row.report["bake"];
        table.row([
            row.file.clone(),
            figure(&bake["energy_gain_max"], 1.0, 4),
            figure(&bake["joint_gap_p99_m"], 1e3, 3),
            figure(&bake["joint_gap_max_m"], 1e3, 2),
            figure(&bake["limit_overshoot_p99_deg"], 1.0, 2),
            figure(&bake["limit_overshoot_max_deg"], 1.0, 2),
            figure(&bake["penetration_rest_max_m"], 1e3, 2),
            figure(&bake["settled_s"], 1.0, 1),
        ]);
    }
    table
}

fn recognised(roles: &Value) -> Table {
    let mut table = Table::new(1, ROLES);
    for (file, row) in roles.as_object().into_iter().flatten() {
        let cell = |column: &str| {
            pair(&row[column]).map_or("–".to_owned(), |(right, all)| format!("{right} of {all}"))
        };
        table.row([file.clone(), cell("plain"), cell("by_names"), cell("by_shape")]);
    }
    table
}

fn reasons(rows: &[Row]) -> String {
    let mut text = String::new();
    for row in rows {
        if let Some(what) = row.report["refused"].as_str() {
            let _ = writeln!(text, "- {}: refused, {what}", row.file);
            continue;
        }
        let of_drops = &row.report["build"]["quality"]["reasons"];
        let of_bake = &row.report["bake"]["notes"];
        // Leaves out the reason that no clip is played, because it applies to the drops of every file.
        let reason_texts = of_drops.as_array().into_iter().flatten().filter_map(Value::as_str);
        for reason in reason_texts.filter(|reason| !reason.starts_with("hand-over")) {
            let _ = writeln!(text, "- {}: {reason}", row.file);
        }
        // Leaves out the note on the missing get-up, because the command requested none.
        let noted = of_bake.as_array().into_iter().flatten().filter_map(Value::as_str);
        for note in noted.filter(|note| !note.starts_with("it does not get up")) {
            let _ = writeln!(text, "- {}, baked: {note}", row.file);
        }
    }
    text
}

/// Returns a number times a factor, or a dash.
fn figure(value: &Value, factor: f64, digits: usize) -> String {
    value.as_f64().map_or("–".to_owned(), |x| {
        // Adding zero turns −0 into 0.
        let rounded = (x * factor * 10f64.powi(digits as i32)).round() / 10f64.powi(digits as i32) + 0.0;
        format!("{rounded:.digits$}")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::path::PathBuf;

    #[test]
    fn rejected_file_is_counted_and_listed() {
        let row = Row {
            file: "rigs/odd.glb".into(),
            report: json!({ "refused": "no skin" }),
            picture: PathBuf::new(),
        };
        let roles = json!({ "rigs/a.glb": { "plain": [9, 10], "by_names": null, "by_shape": [5, 10] } });
        let page = page(&[row], &roles);
        assert!(page.contains("1 files with meshes: 0 good, 0 usable, 0 bad, 1 refused"), "{page}");
        assert!(page.contains("9 of 10 right, 90.0 %"), "{page}");
        assert!(page.contains("- rigs/odd.glb: refused, no skin"), "{page}");
    }

    #[test]
    fn figures_have_no_minus_zero() {
        assert_eq!(figure(&json!(-0.00001), 1.0, 2), "0.00");
        assert_eq!(figure(&Value::Null, 1.0, 2), "–");
    }
}
