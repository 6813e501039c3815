//! Writes `docs/benchmarks.md`: what each engine achieves in its time.

use super::figures::{Figure, came_apart, headline, rounded, telling};
use super::machine::Machine;
use super::requirements::{HOLDS, Hold, SPEEDS, STANDS, Verdict};
use super::results::{EngineResult, Results, SceneResult};
use super::table::Table;
use std::fmt::Write as _;

/// No figure.
const NONE: &str = "–";

/// The page for readers; `missing` are the scenes without figures.
pub fn page(results: &Results, missing: &[&str]) -> String {
    let mut page =
        format!("{INTRODUCTION}\n{COUNTED}{} scenes: all of each in {DETAILS}.\n", results.scenes.len());
    let mut add = |heading: &str, text: &str| {
        write!(page, "\n## {heading}\n\n{text}").expect("a string takes everything");
    };
    add("At a glance", &format!("{GLANCE}\n{}\n{LEGEND}{}", glance(results), gaps(missing)));
    add("Joints that hold", &format!("{HOLD}\n{}", holds(results, HOLDS)));
    add("Stacks that stand, heaps that sleep", &format!("{STAND}\n{}", holds(results, STANDS)));
    add("Characters that blend clips", &format!("{ANIMATION}\n{}", animation(results)));
    add("Figures awake, beside MuJoCo", &format!("{FIGURES_ALONE}\n{}", figures_alone(results)));
    add("Against the specification", &format!("{SPECIFICATION}\n{}", speeds(results)));
    let machine = results.machine.clone().unwrap_or_else(|| Machine::this().to_string());
    write!(page, "\n## Engines and machine\n\n{}\n{machine}", engines(results))
        .expect("a string takes everything");
    page
}

/// Everything about each scene.
pub fn scenes(results: &Results) -> String {
    let mut page = format!("# Benchmarks, scene by scene\n\n{SCENES}");
    for scene in &results.scenes {
        write!(page, "\n## {}\n\n{}", scene.name, details(scene)).expect("a string takes everything");
    }
    page
}

/// Number of scenes of a page; 0 if it names none.
pub fn scene_count(page: &str) -> usize {
    let count = page.lines().find_map(|line| line.strip_prefix(COUNTED)?.split(' ').next()?.parse().ok());
    count.unwrap_or(0)
}

/// Start of the line with the number of scenes.
const COUNTED: &str = "Figures of ";

/// Places of the figures that the page leaves out.
const DETAILS: &str =
    "`bench/benchmarks.json`, as tables in `target/benchmarks.md` after `cargo xtask bench --page`";

fn gaps(missing: &[&str]) -> String {
    if missing.is_empty() { String::new() } else { format!("\nNot measured yet: {}.\n", missing.join(", ")) }
}

const INTRODUCTION: &str = "# Benchmarks

The same scenes on Sinew and on Rapier, Box3D and Jolt, each with its default settings, on one thread. **Time never stands
alone**: an engine that lets joints stretch and bodies sink has less to do. So beside each time stands what it bought,
measured by one tool for all engines from the poses after each step.

Written by `cargo xtask bench`; do not edit.
";

const GLANCE: &str =
    "Processor time of the mean step in milliseconds (the whole run over its steps: the crash counts, and so does sleep), then the
figure that tells whether it is the time of the same work.
";

const LEGEND: &str = "*gap*: largest distance between the two anchors of a joint after any step · *stretch*: all gaps of a chain over its length ·
*depth*: deepest overlap of two bodies · *shift*: how far a body of a stack at rest has moved ·
*asleep at step*: the one after which nothing moves any more, – if something always does · *speed*: the fastest peer's
mean step over Sinew's, above 1 is faster · *p99*: the same of the 99th percentile · † the joints came apart: the time is that of another scene.
";

const HOLD: &str = "What must hold with default settings, and what others do with theirs: the worst after any step of the run.
**Bold** where Sinew holds it.
";

const STAND: &str = "The farthest that a body of a stack has moved at the end, the deepest overlap in a heap after any step that was looked at,
the step after which a heap sleeps. **Bold** where Sinew is no worse than the best peer.
";

const ANIMATION: &str = "Sampling two clips, blending them and bringing the pose to model space, of 1,000 characters, each at its own times, a step of
1/60 s: milliseconds for all of them, then how far a joint was from its place at most, by the raw clips sampled and blended
in plain numbers. Keys stand each 1/30 s for every joint's rotation and the root's place, the same keys on both sides.
ozz-animation-rs reads the bytes of its own format.
";

const FIGURES_ALONE: &str = "Our own ragdoll of 19 bodies with the limits and the friction of its joints, lying, and in heaps of 10 and of 100, awake, on Sinew
and on MuJoCo, which gets it as MJCF: the same masses, capsules, boxes, hinges, friction and pairs that do not collide; its
ball joints are three hinges each, whose ranges are a box and not an ellipse. Processor time for 1/60 s of the scene: MuJoCo
takes 8⅓ of its default steps for it. Depths of MuJoCo are those that it finds itself, Sinew's are found as everywhere here.
";

const SPECIFICATION: &str = "Factors against the fastest peer of this run.\n";

const SCENES: &str = "Times in milliseconds per step: the mean step (in brackets: of the best round), the 99th percentile, the slowest step, the median
step, the median of the last third of the run, when piles have settled. *Sinew's speed* is the engine's mean over Sinew's. Memory in MiB is the
peak above what the process had before the scene. *depth* is looked at after every tenth step, everything else after every
step. *energy gained* is the most the world ever had above its start, *energy lost* what is missing at the end. Figures that
are 0 for all are left out.
";

/// Whether a scene is one of clips, whose engines have no part in the others.
fn is_animation(scene: &SceneResult) -> bool {
    scene.name == "crowd"
}

/// Whether a scene is one of figures as characters are, beside MuJoCo alone.
fn is_of_figures(scene: &SceneResult) -> bool {
    scene.name.starts_with("humanoid_")
}

/// Scenes with bodies, cloth and shapes.
fn physics(results: &Results) -> Vec<&SceneResult> {
    results.scenes.iter().filter(|scene| !is_animation(scene) && !is_of_figures(scene)).collect()
}

/// Engines in the order of the columns.
fn columns(scenes: &[&SceneResult]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for engine in scenes.iter().flat_map(|scene| &scene.engines) {
        if !names.contains(&engine.name) {
            names.push(engine.name.clone());
        }
    }
    names
}

/// Display name of an engine.
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

/// A table with two columns of words and one for each engine.
fn heading<'a>(before: &[&'a str], engines: &'a [String], after: &[&'a str]) -> Table {
    Table::new(2, [before, &engines.iter().map(|name| title(name)).collect::<Vec<_>>(), after].concat())
}

/// An engine's result.
pub fn of<'a>(scene: &'a SceneResult, engine: &str) -> Option<&'a EngineResult> {
    scene.engines.iter().find(|result| result.name == engine)
}

/// One line per scene: time and main figure of each engine.
pub fn glance(results: &Results) -> Table {
    times_and_figures(&physics(results))
}

/// The same for animation scenes.
pub fn animation(results: &Results) -> Table {
    times_and_figures(&results.scenes.iter().filter(|scene| is_animation(scene)).collect::<Vec<_>>())
}

/// The same for lying figures and heaps of them, beside MuJoCo.
pub fn figures_alone(results: &Results) -> Table {
    times_and_figures(&results.scenes.iter().filter(|scene| is_of_figures(scene)).collect::<Vec<_>>())
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

/// Reason why there is no figure.
fn absence(engine: &EngineResult) -> String {
    if engine.is_failed() { engine.why_not().unwrap_or(NONE).to_owned() } else { NONE.to_owned() }
}

/// Requirements and whether they hold.
pub fn holds(results: &Results, rows: &[Hold]) -> Table {
    let engines = columns(&physics(results));
    let mut table = heading(&["scene", "figure", "must"], &engines, &[]);
    for hold in rows {
        let verdict = hold.judge(results);
        if verdict == Verdict::NotRun {
            continue;
        }
        let is_held = verdict == Verdict::Met;
        let figure = |name: &String| {
            let engine = results.scene(hold.scene).and_then(|scene| of(scene, name));
            let Some(engine) = engine else { return NONE.to_owned() };
            if engine.why_not().is_some() {
                return absence(engine);
            }
            let value = cell(hold.figure, engine);
            if is_held && engine.is_sinew() { format!("**{value}**") } else { value }
        };
        let before = [hold.scene.to_owned(), hold.figure.heading.to_owned(), hold.must()];
        table.row(before.into_iter().chain(engines.iter().map(figure)));
    }
    table
}

/// The specification's table with verdicts.
pub fn speeds(results: &Results) -> Table {
    let mut table = Table::new(2, ["work", "verdict", "must", "goal", "measured"]);
    for speed in SPEEDS {
        let (value, verdict) = speed.judge(results);
        let measured = value.map_or(NONE.to_owned(), |value| format!("{}×", rounded(value)));
        let verdict = match verdict {
            Verdict::Goal => "reaches the goal".to_owned(),
            Verdict::Met => "met".to_owned(),
            Verdict::Missed => "**falls short**".to_owned(),
            Verdict::Open(why) => why,
            Verdict::NotRun => continue,
        };
        table.row([speed.work.to_owned(), verdict, speed.bar.must(), speed.bar.goal(), measured]);
    }
    table
}

/// Everything about one scene.
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
    let absent = scene.engines.iter().filter_map(|engine| Some((title(&engine.name), engine.why_not()?)));
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

/// A figure with its unit.
fn cell(figure: &Figure, engine: &EngineResult) -> String {
    (figure.of)(engine).map_or(NONE.to_owned(), |value| figure.unit.show(value))
}

/// Warning mark for a time that does not represent the scene.
fn mark(engine: &EngineResult) -> &'static str {
    if came_apart(engine) { " †" } else { "" }
}

/// Engines, their versions and compiler flags.
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
    fn time_stands_beside_what_it_bought() {
        let glance = glance(&results()).to_string();
        let row: Vec<&str> = glance.lines().nth(2).expect("a row").split('|').map(str::trim).collect();
        assert_eq!(
            row[1..8],
            ["chain_swing_1000", "gap", "100", "2.00 · 0.100 mm", "1.00 · 11.0 m †", "–", "0.500×"]
        );
    }

    #[test]
    fn what_holds_is_bold() {
        let holds = holds(&results(), HOLDS).to_string();
        let row = holds.lines().nth(2).expect("a row");
        assert!(row.contains("≤ 1 mm") && row.contains("**0.100 mm**"), "{row}");
    }

    #[test]
    fn clips_have_a_table_of_their_own() {
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
    fn the_page_has_all_parts() {
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
}
