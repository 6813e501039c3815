//! Up, forward and the length of a metre, read off the body instead of the file.

use super::UnitGuess;
use super::bind::Bound;
use super::graph::Graph;
use super::humanoid::Stance;
use super::names::Reading;
use super::role::Side;
use super::symmetry::Symmetry;
use sinew_math::{Mat3, Rotation, Vec3, max, min, trig};

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

/// A unit that files may be in.
struct Unit {
    metres: f32,
    name: &'static str,
    /// Rarity of the unit against centimetres, as a natural logarithm of sizes: of two units, one that makes the body `e` times
    /// farther from its usual size is as likely as one that is rarer by 1.
    rarity: f32,
}

/// Units that files are in. The last two are what is left of metres and centimetres where a program converts a file that was
/// converted already.
const UNITS: [Unit; 7] = [
    Unit { metres: 1.0, name: "metres", rarity: 0.0 },
    Unit { metres: 0.01, name: "centimetres", rarity: 0.0 },
    Unit { metres: 0.0254, name: "inches", rarity: 1.0 },
    Unit { metres: 0.1, name: "decimetres", rarity: 1.0 },
    Unit { metres: 0.001, name: "millimetres", rarity: 0.5 },
    Unit { metres: 100.0, name: "metres divided by a hundred", rarity: 0.5 },
    Unit { metres: 0.0001, name: "centimetres times a hundred", rarity: 0.5 },
];

/// Sizes of a kind of body, metres.
struct Sizes {
    /// The body, and what is measured of it, for a sentence.
    words: [&'static str; 2],
    fits: core::ops::Range<f32>,
    /// In centimetres, those that leave no doubt.
    surely: core::ops::Range<f32>,
    /// Size of most, metres.
    usual: f32,
    /// Narrowness of the spread of sizes against those of creatures.
    focus: f32,
    /// Size that is taken where no unit fits, metres.
    assumed: f32,
}

const HUMAN: Sizes = Sizes {
    words: ["a human", "tall"],
    fits: 0.5..3.0,
    surely: 0.9..3.0,
    usual: 1.7,
    focus: 2.0,
    assumed: 1.75,
};
const CREATURE: Sizes = Sizes {
    words: ["a creature", "long"],
    fits: 0.1..10.0,
    surely: 0.3..10.0,
    usual: 1.5,
    focus: 1.0,
    assumed: 1.0,
};

/// Metres per file unit, why, and what else it may be.
///
/// A humanoid between 0.5 m and 3 m is taken at its word, as is a creature whose longest side is 0.1 m to 10 m; in centimetres from
/// 0.9 m and 0.3 m on. Else, of centimetres, inches, decimetres, millimetres and units that were converted twice, the likeliest that
/// makes it so is taken: near the usual size, and not rare. If none does, a humanoid is assumed to be 1.75 m, a creature 1 m.
pub(super) fn unit_scale(height: f32, size: f32, humanoid: bool) -> (f32, UnitGuess) {
    let (measure, sizes) = if humanoid { (height, HUMAN) } else { (size, CREATURE) };
    let [body, across] = sizes.words;
    let usual = format!("{body} is {} to {} m", sizes.fits.start, sizes.fits.end);
    let mut fitting: Vec<&Unit> =
        UNITS.iter().filter(|unit| sizes.fits.contains(&(measure * unit.metres))).collect();
    if fitting.is_empty() {
        let assumed = sizes.assumed;
        let scale = assumed / max(measure, 1e-12);
        let note = format!(
            "{measure:.3} units {across} fits no unit, since {usual}: scaled to {assumed} m, a unit of {scale} m; as metres \
             it would be {measure:.2} m"
        );
        return (scale, UnitGuess { note, is_sure: false });
    }
    // Stable: of units as likely the one that stands first.
    let unlikely = |unit: &Unit| match unit.metres {
        1.0 => 0.0,
        0.01 if sizes.surely.contains(&(measure * 0.01)) => 0.0,
        metres => 1e-3 + unit.rarity + sizes.focus * trig::ln(measure * metres / sizes.usual).abs(),
    };
    fitting.sort_by(|a, b| unlikely(a).total_cmp(&unlikely(b)));
    let unit = fitting.remove(0);
    let others: Vec<String> =
        fitting.iter().map(|unit| format!("{} ({:.2} m)", unit.name, measure * unit.metres)).collect();
    let is_sure = others.is_empty() && humanoid && unit.metres == 1.0;
    let others = match others.is_empty() {
        true => "no other unit makes it so".to_owned(),
        false => format!("it may also be {}", others.join(", ")),
    };
    let (name, metres) = (unit.name, measure * unit.metres);
    let note =
        format!("{measure:.2} units {across}, taken as {name}: {metres:.2} m, since {usual}; {others}");
    (unit.metres, UnitGuess { note, is_sure })
}
