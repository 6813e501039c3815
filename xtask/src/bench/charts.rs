//! Charts of the landing page: time of the mean step against the largest gap of a joint, an SVG for each scene. Scenes
//! that were measured at several efforts show each as a dot, joined by a line for each engine.

use super::figures::{self, GAP, came_apart, rounded};
use super::page::title;
use super::results::{EngineResult, Results, SceneResult};
use anyhow::{Context, Result, ensure};
use std::fmt::Write;

/// Scenes with a chart: characters in heaps, heavy chains, nets.
pub const SCENES: [&str; 4] = ["ragdoll_pile", "crowd_pile", "chain_100_links", "net"];
/// Engines with the colours of their dots; Sinew has the page's own colour.
const ENGINES: [(&str, &str); 5] = [
    ("sinew", "#ff8a50"),
    ("rapier", "#7db8ff"),
    ("rapier_simd8", "#5fd0c5"),
    ("box3d", "#d7a6ff"),
    ("jolt", "#f2d060"),
];
/// Size of a chart, and the margins left, right, above and below its axes, in units of the SVG.
const SIZE: [f64; 2] = [420.0, 290.0];
const MARGINS: [f64; 4] = [58.0, 16.0, 14.0, 46.0];
/// Height of a line of text.
const LINE: f64 = 17.0;
/// Smallest gap on the axis, millimetres: smaller ones are drawn at the left edge.
const LEAST_GAP: f64 = 1e-3;

/// A dot of a chart: an engine's gap and time.
#[derive(Clone, Debug, PartialEq)]
pub struct Dot {
    engine: &'static str,
    /// Sinew's quality or a peer's number of substeps; empty for an engine measured at its default alone.
    effort: String,
    color: &'static str,
    /// Largest gap of a joint after any step, millimetres.
    gap: f64,
    /// Mean step, milliseconds.
    time: f64,
    came_apart: bool,
}

impl Dot {
    /// Returns the engine, and the effort if there are several.
    fn name(&self) -> String {
        let Self { engine, effort, .. } = self;
        if effort.is_empty() { (*engine).to_owned() } else { format!("{engine}, {effort}") }
    }
}

/// Returns the results of a scene at several efforts, or at the defaults if those were not measured.
fn scene<'a>(results: &'a Results, name: &str) -> Option<&'a SceneResult> {
    results.efforts.iter().find(|scene| scene.name == name).or_else(|| results.scene(name))
}

/// Returns the dots of a scene, each engine's in the order of its efforts.
fn dots(scene: &SceneResult) -> Vec<Dot> {
    let of_engine = |&(engine, color): &(&'static str, &'static str)| {
        let dot = move |result: &EngineResult| {
            let (name, effort) = result.name.split_once(' ').unwrap_or((&result.name, ""));
            let (time, gap) = (result.times()?.mean, 1e3 * (GAP.of)(result)?);
            let came_apart = came_apart(result);
            (name == engine).then(|| Dot {
                engine: title(engine),
                effort: effort.to_owned(),
                color,
                gap,
                time,
                came_apart,
            })
        };
        scene.engines.iter().filter_map(dot)
    };
    ENGINES.iter().flat_map(of_engine).collect()
}

/// Returns the range in whole powers of ten that contains values.
fn decades(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let least = values.clone().fold(f64::INFINITY, f64::min).log10();
    let most = values.fold(f64::NEG_INFINITY, f64::max).log10();
    [(least - 0.05).floor(), (most + 0.05).ceil()]
}

/// Returns the position of a value on a logarithmic axis.
fn place(value: f64, [low, high]: [f64; 2], [from, to]: [f64; 2]) -> f64 {
    from + (value.log10() - low) / (high - low) * (to - from)
}

/// Returns the charts of [`SCENES`] as HTML figures.
///
/// # Errors
/// If one of the scenes was not measured, or has fewer than two engines.
pub fn charts(results: &Results) -> Result<String> {
    let mut html = String::new();
    for name in SCENES {
        let scene = scene(results, name).with_context(|| format!("{name} was not measured"))?;
        let dots = dots(scene);
        ensure!(dots.len() > 1 && dots[0].engine == "Sinew", "{name} has no peers to compare with");
        html += &figure(scene, &dots);
    }
    Ok(html)
}

fn figure(scene: &SceneResult, dots: &[Dot]) -> String {
    let cells = |dot: &Dot| {
        let mark = if dot.came_apart { " †" } else { "" };
        let (time, gap) = (rounded(dot.time), figures::Unit::Length.show(1e-3 * dot.gap));
        format!("<tr><th scope=\"row\">{}</th><td>{time} ms</td><td>{gap}{mark}</td></tr>", dot.name())
    };
    let rows: String = dots.iter().map(cells).collect();
    let note = if dots.iter().any(|dot| dot.came_apart) { "<p>† the joints came apart.</p>" } else { "" };
    format!(
        "<figure><figcaption>{name}: {about}</figcaption>\n{svg}\n<details><summary>As a table</summary><table><tr><th>engine</th>\
         <th>mean step</th><th>largest gap</th></tr>{rows}</table>{note}</details></figure>\n",
        name = scene.name,
        about = scene.about,
        svg = svg(scene, dots),
    )
}

fn svg(scene: &SceneResult, dots: &[Dot]) -> String {
    let [width, height] = SIZE;
    let [left, right, above, below] = MARGINS;
    let gaps = dots.iter().map(|dot| dot.gap.max(LEAST_GAP));
    let (mut across, up) = (decades(gaps), decades(dots.iter().map(|dot| dot.time)));
    across[0] = across[0].max(LEAST_GAP.log10());
    let (xs, ys) = ([left, width - right], [height - below, above]);
    let legend: Vec<String> = dots
        .iter()
        .map(|dot| format!("{} {} ms and {} mm", dot.name(), rounded(dot.time), rounded(dot.gap)))
        .collect();
    let mut out = format!(
        "<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{}: {}\">\n",
        scene.name,
        legend.join("; ")
    );
    axes(&mut out, (across, xs), (up, ys));
    let at = |dot: &Dot| [place(dot.gap.max(LEAST_GAP), across, xs), place(dot.time, up, ys)];
    for pair in dots.windows(2).filter(|pair| pair[0].engine == pair[1].engine) {
        let ([x, y], [x2, y2]) = (at(&pair[0]), at(&pair[1]));
        _ = writeln!(
            out,
            "<path d=\"M{x:.1} {y:.1}L{x2:.1} {y2:.1}\" stroke=\"{}\" stroke-width=\"2\"/>",
            pair[0].color
        );
    }
    let mut labels: Vec<[f64; 2]> = Vec::new();
    for (i, dot) in dots.iter().enumerate() {
        let [x, y] = at(dot);
        let radius = if dot.engine == "Sinew" { 8.0 } else { 6.0 };
        _ = writeln!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{}\"/>", dot.color);
        let is_right = x > 0.5 * width;
        let (anchor, shift) = if is_right { ("end", -12.0) } else { ("start", 13.0) };
        let at = free_line(&labels, [x, y + 4.0]);
        labels.push([x, at]);
        if (at - y - 4.0).abs() > 0.5 * LINE {
            _ = writeln!(
                out,
                "<path d=\"M{x:.1} {y:.1}L{:.1} {:.1}\" stroke=\"{}\" opacity=\"0.6\"/>",
                x + 0.8 * shift,
                at - 4.0,
                dot.color
            );
        }
        _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{at:.1}\" fill=\"{}\" text-anchor=\"{anchor}\">{}</text>",
            x + shift,
            dot.color,
            if i > 0 && dots[i - 1].engine == dot.engine { dot.effort.clone() } else { dot.name() }
        );
    }
    out + "</svg>"
}

/// Returns the line of a name beside a dot: the nearest one, above or below, that overlaps no other name.
fn free_line(labels: &[[f64; 2]], [x, y]: [f64; 2]) -> f64 {
    let is_free =
        |at: &f64| labels.iter().all(|[side, other]| (side - x).abs() >= 130.0 || (other - at).abs() >= LINE);
    let lines = (0..).flat_map(|k| [y + 2.0 * f64::from(k), y - 2.0 * f64::from(k)]);
    lines.take(200).find(is_free).unwrap_or(y)
}

/// Adds lines at powers of ten with their names, and the titles of the axes.
fn axes(out: &mut String, (across, xs): ([f64; 2], [f64; 2]), (up, ys): ([f64; 2], [f64; 2])) {
    let ticks = |[low, high]: [f64; 2]| (low as i32..=high as i32).map(|power| 10f64.powi(power));
    let named = |value: f64| match value {
        _ if value < 1.0 => format!("{value}"),
        _ if value < 1e3 => format!("{value:.0}"),
        _ => format!("{:.0}k", 1e-3 * value),
    };
    for value in ticks(across) {
        let x = place(value, across, xs);
        let name = if value <= LEAST_GAP { format!("≤ {}", named(value)) } else { named(value) };
        _ = writeln!(
            out,
            "<path d=\"M{x:.1} {:.1}V{:.1}\" stroke=\"#39414e\"/><text x=\"{x:.1}\" y=\"{:.1}\" fill=\"#b3bcc9\" text-anchor=\"middle\">{name}</text>",
            ys[0],
            ys[1],
            ys[0] + LINE
        );
    }
    for value in ticks(up) {
        let y = place(value, up, ys);
        _ = writeln!(
            out,
            "<path d=\"M{:.1} {y:.1}H{:.1}\" stroke=\"#39414e\"/><text x=\"{:.1}\" y=\"{:.1}\" fill=\"#b3bcc9\" text-anchor=\"end\">{}</text>",
            xs[0],
            xs[1],
            xs[0] - 6.0,
            y + 4.0,
            named(value)
        );
    }
    let (middle, bottom) = (0.5 * (xs[0] + xs[1]), SIZE[1] - 8.0);
    _ = writeln!(
        out,
        "<text x=\"{middle:.1}\" y=\"{bottom:.1}\" fill=\"#e6eaf0\" text-anchor=\"middle\">largest gap of a joint, mm</text>"
    );
    let center = 0.5 * (ys[0] + ys[1]);
    _ = writeln!(
        out,
        "<text transform=\"translate(14 {center:.1}) rotate(-90)\" fill=\"#e6eaf0\" text-anchor=\"middle\">mean step, ms</text>"
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command;
    use std::fs;

    /// The charts agree with the committed page of results.
    #[test]
    fn charts_agree_with_the_page() {
        let page =
            fs::read_to_string(command::root().join("docs/benchmarks.md")).expect("the page can be read");
        let results = super::super::kept();
        charts(&results).expect("all scenes were measured");
        for name in SCENES {
            let dots = dots(scene(&results, name).expect("the scene was measured"));
            let rows: Vec<&str> =
                page.lines().filter(|line| line.starts_with(&format!("| {name} "))).collect();
            for dot in &dots {
                let time = rounded(dot.time);
                let is_row = |row: &&&str| match dot.effort.as_str() {
                    "" => row.contains(&format!(" {time} · ")),
                    effort => [dot.engine, effort, &time]
                        .iter()
                        .all(|cell| row.split('|').any(|c| c.trim() == *cell)),
                };
                assert!(rows.iter().any(|row| is_row(&row)), "{dot:?}: {rows:?}");
            }
            assert!(dots.len() >= ENGINES.len(), "{name}");
        }
    }

    /// Every dot is within its axes, and a larger gap is further right.
    #[test]
    fn dots_are_placed_by_their_figures() {
        let [low, high] = decades([0.003, 193.0].into_iter());
        assert_eq!([low, high], [-3.0, 3.0]);
        assert_eq!(place(1.0, [-3.0, 3.0], [0.0, 600.0]), 300.0);
        assert!(place(193.0, [low, high], [0.0, 1.0]) > place(0.003, [low, high], [0.0, 1.0]));
        // A value at a power of ten has space on both sides.
        assert_eq!(decades([1.0, 10.0].into_iter()), [-1.0, 2.0]);
    }
}
