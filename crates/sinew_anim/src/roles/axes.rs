//! Up, forward and the length of a metre, read off the body instead of the file.

use super::UnitGuess;
use super::bind::Bound;
use super::graph::Graph;
use super::humanoid::Stance;
use super::names::Reading;
use super::role::Side;
use super::symmetry::Symmetry;
use sinew_math::{Mat3, Rotation, Vec3, max, min};

/// The model's axis nearest to a direction.
pub(super) fn snap(direction: Vec3) -> Vec3 {
    let axes = [Vec3::Y, Vec3::Z, Vec3::X, -Vec3::Y, -Vec3::Z, -Vec3::X];
    axes.into_iter().reduce(|a, b| if b.dot(direction) > a.dot(direction) { b } else { a }).unwrap_or(Vec3::Y)
}

/// The four model axes at right angles to `lateral`: the file's own up first, then those of other programs.
pub(super) fn possible_ups(lateral: Vec3) -> impl Iterator<Item = Vec3> {
    [Vec3::Y, Vec3::Z, -Vec3::Y, -Vec3::Z, Vec3::X, -Vec3::X]
        .into_iter()
        .filter(move |up| up.dot(lateral).abs() < 0.5)
}

/// The rotation from model axes to the character's: left to +X, up to +Y, forward to +Z.
pub(super) fn character_from_model(left: Vec3, up: Vec3) -> Rotation {
    Rotation::from_mat3(&Mat3::from_cols(left, up, left.cross(up)).transpose())
}

/// How far the feet stick out along `forward` in front of their ankles, in heights of the body, all feet together.
pub(super) fn feet_lead(bound: &Bound, stance: &Stance, forward: Vec3, ankles: &[Vec3]) -> f32 {
    let flat = |v: Vec3| v - stance.up * v.dot(stance.up);
    let lead = |&ankle: &Vec3| {
        let (mut heel, mut toe) = (f32::INFINITY, f32::NEG_INFINITY);
        for &vertex in &bound.vertices {
            let away = flat(vertex - ankle);
            if stance.level(vertex) < 0.08 && away.length() < 0.2 * stance.height {
                let along = away.dot(forward);
                (heel, toe) = (min(heel, along), max(toe, along));
            }
        }
        if toe > heel { 0.5 * (toe + heel) / stance.height } else { 0.0 }
    };
    ankles.iter().map(lead).sum()
}

/// Which way the names put the left side: the sign along [`Symmetry::lateral`], 0 when they say nothing.
pub(super) fn left_by_name(graph: &Graph, symmetry: &Symmetry, readings: &[Reading]) -> f32 {
    let vote = |i: usize| match readings[i].side {
        Some(Side::Left) => symmetry.side(graph, i),
        Some(Side::Right) => -symmetry.side(graph, i),
        None => 0.0,
    };
    let sum: f32 = (0..graph.nodes.len()).map(vote).sum();
    if sum.abs() > 0.0 { sum.signum() } else { 0.0 }
}

/// Units that files are in, metres. The last two are what is left of metres and centimetres where a program converts a file
/// that was converted already.
const UNITS: [(f32, &str); 7] = [
    (1.0, "metres"),
    (0.01, "centimetres"),
    (0.0254, "inches"),
    (0.1, "decimetres"),
    (0.001, "millimetres"),
    (100.0, "metres divided by a hundred"),
    (0.0001, "centimetres times a hundred"),
];

/// Metres per file unit, why, and what else it may be.
///
/// A humanoid between 0.5 m and 3 m is taken at its word; else centimetres, inches, decimetres, millimetres and units that
/// were converted twice are tried, then 1.75 m is assumed. A creature's longest side may be 0.1 m to 10 m; else one metre is assumed after
/// the same units.
pub(super) fn unit_scale(height: f32, size: f32, humanoid: bool) -> (f32, UnitGuess) {
    let (measure, range, assumed) = if humanoid { (height, 0.5..3.0, 1.75) } else { (size, 0.1..10.0, 1.0) };
    let body = if humanoid { "a human is" } else { "a creature is" };
    let across = if humanoid { "tall" } else { "long" };
    let usual = format!("{body} {} to {} m", range.start, range.end);
    let fits = |&(scale, _): &(f32, &str)| range.contains(&(measure * scale));
    let mut fitting = UNITS.into_iter().filter(fits);
    let Some((scale, unit)) = fitting.next() else {
        let scale = assumed / max(measure, 1e-12);
        let note = format!(
            "{measure:.3} units {across} fits no unit, since {usual}: scaled to {assumed} m, a unit of {scale} m; as metres \
             it would be {measure:.2} m"
        );
        return (scale, UnitGuess { note, is_sure: false });
    };
    let others: Vec<String> =
        fitting.map(|(scale, unit)| format!("{unit} ({:.2} m)", measure * scale)).collect();
    let is_sure = others.is_empty() && humanoid && scale == 1.0;
    let others = match others.is_empty() {
        true => "no other unit makes it so".to_owned(),
        false => format!("it may also be {}", others.join(", ")),
    };
    let note = format!(
        "{measure:.2} units {across}, taken as {unit}: {:.2} m, since {usual}; {others}",
        measure * scale
    );
    (scale, UnitGuess { note, is_sure })
}
