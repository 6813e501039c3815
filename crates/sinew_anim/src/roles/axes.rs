//! Up and forward, derived from the body instead of the file.

use super::bind::Bound;
use super::graph::Graph;
use super::humanoid::Stance;
use super::names::Reading;
use super::role::Side;
use super::symmetry::Symmetry;
use sinew_math::{Mat3, Rotation, Vec3, max, min};

/// Returns the model axis nearest to a direction.
pub(super) fn snap(direction: Vec3) -> Vec3 {
    nearest(direction).0
}

/// Returns the name of the axis nearest to a direction, such as `y` or `-z`.
pub(super) fn name(direction: Vec3) -> &'static str {
    nearest(direction).1
}

fn nearest(direction: Vec3) -> (Vec3, &'static str) {
    let axes = [
        (Vec3::Y, "y"),
        (Vec3::Z, "z"),
        (Vec3::X, "x"),
        (-Vec3::Y, "-y"),
        (-Vec3::Z, "-z"),
        (-Vec3::X, "-x"),
    ];
    let nearer = |a: (Vec3, _), b: (Vec3, _)| if b.0.dot(direction) > a.0.dot(direction) { b } else { a };
    axes.into_iter().reduce(nearer).unwrap_or((Vec3::Y, "y"))
}

/// Returns the four model axes perpendicular to `lateral`: +Y first, then those of other programs.
pub(super) fn possible_ups(lateral: Vec3) -> impl Iterator<Item = Vec3> {
    [Vec3::Y, Vec3::Z, -Vec3::Y, -Vec3::Z, Vec3::X, -Vec3::X]
        .into_iter()
        .filter(move |up| up.dot(lateral).abs() < 0.5)
}

/// Returns the rotation from model axes to the character's: left to +X, up to +Y, forward to +Z.
pub(super) fn character_from_model(left: Vec3, up: Vec3) -> Rotation {
    Rotation::from_mat3(&Mat3::from_cols(left, up, left.cross(up)).transpose())
}

/// Distance by which the feet extend along `forward` beyond their ankles, in body heights, summed over all feet.
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

/// Sign of the left side along [`Symmetry::lateral`] by name; 0 if unknown.
pub(super) fn left_by_name(graph: &Graph, symmetry: &Symmetry, readings: &[Reading]) -> f32 {
    let vote = |i: usize| match readings[i].side {
        Some(Side::Left) => symmetry.side(graph, i),
        Some(Side::Right) => -symmetry.side(graph, i),
        None => 0.0,
    };
    let sum: f32 = (0..graph.nodes.len()).map(vote).sum();
    if sum.abs() > 0.0 { sum.signum() } else { 0.0 }
}
