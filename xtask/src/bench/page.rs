//! Writes `docs/benchmarks.md`: what each engine achieves in its time.

use super::figures::{DEPTH, DEPTH_P99, Figure, GAP, LIMITS, came_apart, headline, rounded, telling};
use super::machine::Machine;
use super::requirements::{Bar, HOLDS, Hold, SPEEDS, STANDS, Verdict};
use super::results::{EngineResult, Results, SceneResult};
use super::table::Table;
use std::fmt::Write as _;

/// Text of a missing result.
const NONE: &str = "–";

/// Returns the page for readers; `missing` are the scenes without results.
pub fn page(results: &Results, missing: &[&str]) -> String {
    let mut page =
        format!("{INTRODUCTION}\n{COUNTED}{} scenes: all of each in {DETAILS}.\n", results.scenes.len());
    let mut add = |heading: &str, text: &str| {
        write!(page, "\n## {heading}\n\n{text}").expect("writing to a string cannot fail");
    };
    add("At a glance", &format!("{GLANCE}\n{}\n{LEGEND}{}", glance(results), gaps(missing)));
    add("Joints and stacks", &format!("{HOLD}\n{}", holds(results, HOLDS.iter().chain(STANDS))));
    if !results.efforts.is_empty() {
        add("Time against quality", &format!("{EFFORTS}\n{}", efforts(results)));
    }
    add("Characters that blend clips", &format!("{ANIMATION}\n{}", animation(results)));
    add("Ragdolls beside MuJoCo", &format!("{RAGDOLLS}\n{}", ragdolls(results)));
    add("Against the specification", &format!("{SPECIFICATION}\n{}", speeds(results)));
    let machine = results.machine.clone().unwrap_or_else(|| Machine::this().to_string());
    write!(page, "\n## Engines and machine\n\n{}\n{machine}", engines(results))
        .expect("writing to a string cannot fail");
    page
}

/// Returns a page with all results of each scene.
pub fn scenes(results: &Results) -> String {
    let mut page = format!("# Benchmarks, scene by scene\n\n{SCENES}");
    for scene in &results.scenes {
        write!(page, "\n## {}\n\n{}", scene.name, details(scene)).expect("writing to a string cannot fail");
    }
    page
}

/// Returns the number of scenes of a page; 0 if the page does not state it.
pub fn scene_count(page: &str) -> usize {
    let count = page.lines().find_map(|line| line.strip_prefix(COUNTED)?.split(' ').next()?.parse().ok());
    count.unwrap_or(0)
}

/// Start of the line with the number of scenes.
const COUNTED: &str = "Figures of ";

/// Places of the results that the page leaves out.
const DETAILS: &str =
    "`bench/benchmarks.json`, as tables in `target/benchmarks.md` after `cargo xtask bench --page`";

fn gaps(missing: &[&str]) -> String {
    if missing.is_empty() { String::new() } else { format!("\nNot measured yet: {}.\n", missing.join(", ")) }
}

const INTRODUCTION: &str = "# Benchmarks

The same scenes on Sinew and on Rapier, Box3D and Jolt, each with its default settings, on one thread. An engine that lets joints
stretch and bodies sink has less to do, so a figure of quality stands beside each time. One tool measures it for all engines from the
poses after each step.

Written by `cargo xtask bench`.
";

const GLANCE: &str = "Processor time of the mean step in milliseconds, then the figure of quality.
The mean is over the whole run, impacts and sleep included.
";

const LEGEND: &str = "*gap*: largest distance between the two anchors of a joint after any step · *stretch*: sum of the gaps of a chain over its length ·
*depth*: deepest overlap of two bodies · *shift*: largest displacement of a body in a stack at rest ·
*asleep at step*: step after which nothing moves, – if something always does · *speed*: the fastest peer's
mean step over Sinew's, above 1 is faster · *p99*: the same for the 99th percentile · † the joints came apart, so the time is for different work.
";

const HOLD: &str =
    "Requirements with default settings, Sinew's figure, and the best peer's. Peaks are over all steps.
**Bold** where Sinew meets the requirement.
";

const EFFORTS: &str =
    "Heaps of ragdolls at several efforts of each engine: Sinew's `Quality`, Rapier's solver iterations, Box3D's substeps, Jolt's collision
steps. Milliseconds, then quality over the whole run; *limits* counts those exceeded by more than 0.1 rad.
";

const ANIMATION: &str = "1,000 characters sample two clips, blend them and compute the pose in model space, each at its own times, in a step of
1/60 s. Milliseconds for all, then the largest distance of a joint from the pose of the raw clips. Both sides have the same keys, one
each 1/30 s.
";

const RAGDOLLS: &str = "Sinew's ragdoll of 19 bodies with limits and joint friction, awake: lying, and in heaps of 10 and 100. MuJoCo gets it as MJCF:
the same masses, shapes, friction and pairs that do not collide; its ball joints are three hinges each, whose ranges are a box instead of an
ellipse. Processor time for 1/60 s, 8⅓ default steps of MuJoCo. MuJoCo reports its depths itself.
";

const SPECIFICATION: &str = "Factors against the fastest peer of this run. Goals are in brackets.\n";

const SCENES: &str = "Times in milliseconds per step: the mean step (in brackets: of the best round), the 99th percentile, the slowest step, the median
step, the median of the last third of the run, when piles have settled. *Sinew's speed* is the engine's mean over Sinew's. Memory in MiB is the
peak above what the process had before the scene. *depth* is measured after every tenth step, everything else after every
step. *energy gained* is the largest energy of the world above its start, *energy lost* the difference at the end. Figures that
are 0 for all engines are left out.
";

/// Returns true if a scene compares animation engines.
fn is_animation(scene: &SceneResult) -> bool {
    scene.name == "crowd"
}

/// Returns true if a scene compares ragdolls with MuJoCo alone.
fn is_of_ragdolls(scene: &SceneResult) -> bool {
    scene.name.starts_with("humanoid_")
}

/// Returns the scenes with bodies, cloth and shapes.
fn physics(results: &Results) -> Vec<&SceneResult> {
    results.scenes.iter().filter(|scene| !is_animation(scene) && !is_of_ragdolls(scene)).collect()
}

/// Returns the engines in the order of the columns.
fn columns(scenes: &[&SceneResult]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for engine in scenes.iter().flat_map(|scene| &scene.engines) {
        if !names.contains(&engine.name) {
            names.push(engine.name.clone());
        }
    }
    names
}

/// Returns the display name of an engine.
pub fn title(engine: &str) -> &str {
    match engine {
        "sinew" => "Sinew",
        "rapier" => "Rapier",
        "rapier_simd8" => "Rapier, 8 lanes",
        "box3d" => "Box3D",
        "jolt" => "Jolt",
        "ozz" => "ozz-animation-rs",
        "mujoco" => "MuJoCo",
        other => other,
    }
}

/// Returns a table with two columns of words and one for each engine.
fn heading<'a>(before: &[&'a str], engines: &'a [String], after: &[&'a str]) -> Table {
    Table::new(2, [before, &engines.iter().map(|name| title(name)).collect::<Vec<_>>(), after].concat())
}

/// Returns an engine's result.
pub fn of<'a>(scene: &'a SceneResult, engine: &str) -> Option<&'a EngineResult> {
    scene.engines.iter().find(|result| result.name == engine)
}

/// Returns one line per scene: time and main metric of each engine.
pub fn glance(results: &Results) -> Table {
    times_and_figures(&physics(results))
}

/// Returns one line per animation scene: time and main metric of each engine.
pub fn animation(results: &Results) -> Table {
    times_and_figures(&results.scenes.iter().filter(|scene| is_animation(scene)).collect::<Vec<_>>())
}

/// Returns one line per scene of ragdolls beside MuJoCo: time and main metric of each engine.
pub fn ragdolls(results: &Results) -> Table {
    times_and_figures(&results.scenes.iter().filter(|scene| is_of_ragdolls(scene)).collect::<Vec<_>>())
}

fn times_and_figures(scenes: &[&SceneResult]) -> Table {
    let engines = columns(scenes);
    let mut table = heading(&["scene", "figure", "steps"], &engines, &["speed", "p99"]);
    for scene in scenes {
        let figure = headline(&scene.name);
        let time = |name: &String| {
            let Some(engine) = of(scene, name) else { return NONE.to_owned() };
            let Some(times) = engine.times() else { return absence(engine) };
            format!("{} · {}{}", rounded(times.mean), cell(figure, engine), mark(engine))
        };
        let speeds = [scene.speed(), scene.p99_speed()].map(factor);
        let steps = scene.size("steps").map_or(NONE.to_owned(), |steps| steps.to_string());
        let before = [scene.name.clone(), figure.heading.to_owned(), steps];
        table.row(before.into_iter().chain(engines.iter().map(time)).chain(speeds));
    }
    table
}

fn factor(speed: Option<f64>) -> String {
    speed.map_or(NONE.to_owned(), |speed| format!("{}×", rounded(speed)))
}

/// Returns the reason why there is no result.
fn absence(engine: &EngineResult) -> String {
    if engine.is_failed() { engine.missing_reason().unwrap_or(NONE).to_owned() } else { NONE.to_owned() }
}

/// Returns one line per scene, engine and effort: times and metrics of quality.
pub fn efforts(results: &Results) -> Table {
    let figures = [&GAP, &LIMITS, &DEPTH, &DEPTH_P99];
    let headings = ["scene", "engine", "effort", "mean", "p99"].into_iter();
    let mut table = Table::new(3, headings.chain(["gap", "limits", "depth", "depth p99 at the end"]));
    for (scene, engine) in
        results.efforts.iter().flat_map(|scene| scene.engines.iter().map(move |e| (scene, e)))
    {
        let (name, effort) = engine.name.split_once(' ').unwrap_or((&engine.name, NONE));
        let Some(times) = engine.times() else { continue };
        let cells = [scene.name.clone(), title(name).to_owned(), effort.to_owned()];
        let times = [times.mean, times.p99].map(rounded);
        table.row(cells.into_iter().chain(times).chain(figures.map(|figure| cell(figure, engine))));
    }
    table
}

/// Returns the table of requirements, with Sinew's metric and the best peer's.
pub fn holds<'a>(results: &Results, rows: impl IntoIterator<Item = &'a Hold>) -> Table {
    let mut table = Table::new(2, ["scene", "figure", "must", "Sinew", "best peer"]);
    for hold in rows {
        let verdict = hold.judge(results);
        let Some(scene) = results.scene(hold.scene).filter(|_| verdict != Verdict::NotRun) else { continue };
        let ours = scene.sinew().map_or(NONE.to_owned(), |ours| match ours.missing_reason() {
            Some(_) => absence(ours),
            None => cell(hold.figure, ours),
        });
        let ours = if verdict == Verdict::Met { format!("**{ours}**") } else { ours };
        let best = scene.peers().filter_map(hold.figure.of).min_by(f64::total_cmp);
        let best = best.map_or(NONE.to_owned(), |value| hold.figure.unit.show(value));
        table.row([hold.scene.to_owned(), hold.figure.heading.to_owned(), hold.must(), ours, best]);
    }
    table
}

/// Returns the specification's table with verdicts.
pub fn speeds(results: &Results) -> Table {
    let mut table = Table::new(2, ["work", "verdict", "must (goal)", "measured"]);
    for speed in SPEEDS {
        let (value, verdict) = speed.judge(results);
        let measured = value.map_or(NONE.to_owned(), |value| format!("{}×", rounded(value)));
        let verdict = match verdict {
            Verdict::Goal => "reaches the goal".to_owned(),
            Verdict::Met => "met".to_owned(),
            Verdict::Missed => "**falls short**".to_owned(),
            // If no peer's joints hold, there is no requirement.
            Verdict::Open(_) if matches!(speed.bar, Bar::Factor { .. }) => continue,
            Verdict::Open(why) => why,
            Verdict::NotRun => continue,
        };
        let must = format!("{} ({})", speed.bar.must(), speed.bar.goal());
        table.row([speed.work.to_owned(), verdict, must, measured]);
    }
    table
}

/// Returns the results of one scene.
fn details(scene: &SceneResult) -> String {
    let sizes = ["bodies", "particles", "characters", "joints", "steps"].into_iter();
    let sizes = sizes.filter_map(|key| Some((scene.size(key).filter(|&size| size > 0)?, key)));
    let sizes: Vec<String> = sizes.map(|(size, key)| format!("{size} {key}")).collect();
    let figures = telling(scene);
    let times = ["engine", "mean (best)", "Sinew's speed", "p99", "worst", "median", "last third", "MiB"];
    let mut table = Table::new(1, times.into_iter().chain(figures.iter().map(|figure| figure.heading)));
    for engine in &scene.engines {
        let Some(times) = time_cells(scene, engine) else { continue };
        let figures = figures.iter().map(|figure| cell(figure, engine));
        table.row(times.into_iter().chain(figures));
    }
    let absent =
        scene.engines.iter().filter_map(|engine| Some((title(&engine.name), engine.missing_reason()?)));
    let absent: String = absent.map(|(name, why)| format!("\n{name}: {why}.\n")).collect();
    format!("{}: {}. Measured at {}.\n\n{table}{absent}", scene.about, sizes.join(", "), scene.revision)
}

fn time_cells(scene: &SceneResult, engine: &EngineResult) -> Option<[String; 8]> {
    let times = engine.times()?;
    Some([
        format!("{}{}", title(&engine.name), mark(engine)),
        format!("{} ({})", rounded(times.mean), rounded(times.best)),
        factor(scene.speed_against(engine)),
        rounded(times.p99),
        times.worst.map_or(NONE.to_owned(), rounded),
        rounded(times.median),
        rounded(times.last_third),
        engine.memory().map_or(NONE.to_owned(), rounded),
    ])
}

/// Formats a metric with its unit.
fn cell(figure: &Figure, engine: &EngineResult) -> String {
    (figure.of)(engine).map_or(NONE.to_owned(), |value| figure.unit.show(value))
}

/// Returns the warning mark for a time that does not represent the scene.
fn mark(engine: &EngineResult) -> &'static str {
    if came_apart(engine) { " †" } else { "" }
}

/// Returns the engines, their versions and compiler flags.
fn engines(results: &Results) -> Table {
    let mut table = Table::new(4, ["engine", "version", "compiled", "settings"]);
    for name in columns(&results.scenes.iter().collect::<Vec<_>>()) {
        let found = results.scenes.iter().filter_map(|scene| of(scene, &name));
        let Some(engine) = found.into_iter().find(|engine| engine.text("version").is_some()) else {
            continue;
        };
        let text = |key: &str| engine.text(key).unwrap_or(NONE).to_owned();
        table.row([title(&name).to_owned(), text("version"), text("flags"), text("settings")]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::super::results::tests::{engine, scene};
    use super::*;
    use serde_json::json;

    fn results() -> Results {
        let gap = |gap: f64| json!({ "joint_gap_peak_m": gap });
        let lacks =
            EngineResult { name: "box3d".into(), reports: vec![json!({ "unsupported": "no balls" })] };
        let engines = vec![engine("sinew", &[2.0], &gap(0.0001)), engine("jolt", &[1.0], &gap(11.0)), lacks];
        Results { scenes: vec![scene("chain_swing_1000", engines)], ..Results::default() }
    }

    #[test]
    fn glance_lists_time_and_quality() {
        let glance = glance(&results()).to_string();
        let row: Vec<&str> = glance.lines().nth(2).expect("a row").split('|').map(str::trim).collect();
        assert_eq!(
            row[1..8],
            ["chain_swing_1000", "gap", "100", "2.00 · 0.100 mm", "1.00 · 11.0 m †", "–", "0.500×"]
        );
    }

    #[test]
    fn efforts_are_rows_by_engine() {
        let quality = json!({ "joint_gap_peak_m": 0.001, "penetration_run_max_m": 0.05 });
        let engines = vec![engine("sinew fast", &[2.0], &quality), engine("box3d 16", &[4.0], &quality)];
        let results = Results { efforts: vec![scene("ragdoll_pile", engines)], ..Results::default() };
        let table = efforts(&results).to_string();
        let rows: Vec<Vec<&str>> =
            table.lines().skip(2).map(|line| line.split('|').map(str::trim).collect()).collect();
        assert_eq!(rows[0][1..7], ["ragdoll_pile", "Sinew", "fast", "2.00", "4.00", "1.00 mm"]);
        assert_eq!(rows[1][2..5], ["Box3D", "16", "4.00"]);
    }

    #[test]
    fn met_requirement_is_bold() {
        let holds = holds(&results(), HOLDS).to_string();
        let row: Vec<&str> = holds.lines().nth(2).expect("a row").split('|').map(str::trim).collect();
        assert_eq!(row[3..6], ["≤ 1 mm", "**0.100 mm**", "11.0 m"]);
    }

    #[test]
    fn animation_scenes_are_in_their_own_table() {
        let error = |metres: f64| json!({ "model_error_max_m": metres });
        let engines = vec![engine("sinew", &[2.0], &error(2e-4)), engine("ozz", &[6.0], &error(5e-4))];
        let mut results = results();
        results.scenes.push(scene("crowd", engines));
        let row = animation(&results).to_string().lines().nth(2).expect("a row").to_owned();
        assert!(row.contains("2.00 · 0.200 mm") && row.contains("3.00×"), "{row}");
        let heading = glance(&results).to_string().lines().next().expect("a heading").to_owned();
        assert!(heading.contains("Jolt") && !heading.contains("ozz"), "{heading}");
    }

    #[test]
    fn page_has_all_parts() {
        let page = page(&results(), &["net", "bake"]);
        for part in ["At a glance", "yet: net, bake.", "-O3"] {
            assert!(page.contains(part), "{part} is missing:\n{page}");
        }
        assert_eq!(scene_count(&page), 1);
        let scenes = scenes(&results());
        for part in ["## chain_swing_1000", "Box3D: no balls."] {
            assert!(scenes.contains(part), "{part} is missing:\n{scenes}");
        }
        assert!(!page.contains("\n\n\n"), "one empty line is enough:\n{page}");
    }

    /// Claims of the README: the scene, and the words around its speed.
    const CLAIMS: &[(&str, [&str; 2])] = &[
        ("box_pyramid", ["`box_pyramid` ", " times as fast"]),
        ("box_rain", ["`box_rain` ", ","]),
        ("boxes_10000", ["`boxes_10000` ", " |"]),
        ("humanoid_pile_10", ["`humanoid_pile_10` ", " times as fast as MuJoCo"]),
        ("humanoid_lying", ["`humanoid_lying` ", ","]),
        ("ragdoll_pile", ["Sinew has ", " of the fastest one's speed in `ragdoll_pile`"]),
        ("crowd_pile", [", ", " in `crowd_pile`"]),
        ("rain", [", ", " in `rain`"]),
    ];

    /// The README gives the speeds of `docs/benchmarks.md`, which are by the mean step.
    #[test]
    fn readme_has_the_speeds_of_the_page() {
        let read = |name: &str| {
            std::fs::read_to_string(crate::command::root().join(name)).expect("the file can be read")
        };
        let (readme, page) = (read("README.md"), read("docs/benchmarks.md"));
        for &(scene, [before, after]) in CLAIMS {
            let row = page.lines().find(|line| line.starts_with(&format!("| {scene} "))).expect(scene);
            let speed = row.rsplit('|').nth(2).and_then(|cell| cell.trim().strip_suffix('×'));
            let speed: f64 = speed.and_then(|speed| speed.parse().ok()).expect(row);
            let speed = if speed < 1.0 { format!("{speed:.2}") } else { format!("{speed:.1}") };
            let claim = format!("{before}{speed}{after}");
            assert!(readme.contains(&claim), "{scene}: the README does not say `{claim}`");
        }
    }
}
