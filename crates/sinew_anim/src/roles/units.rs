//! The length of a file's unit, from the body and its surroundings.

use super::species::Species;
use super::{Hints, UnitGuess};
use crate::roles::tuning::{
    GROWN_BY_HEAD, SHORTEST, STEPS_ALIKE, STRIDE_SPEED, UNDER_DOOR, UNIT_BY_EXPORTER, UNIT_BY_KIN,
};
use core::fmt::Write as _;
use sinew_math::{clamp, max, trig};

/// Sizes of a body, from which the unit of its file is derived.
pub(super) struct Measured {
    pub humanoid: bool,
    /// Height from floor to crown, file units.
    pub height: f32,
    /// Longest side of the skin's box, file units.
    pub size: f32,
    /// Distance from the head joint to the crown, as a share of the height; `None` without a head.
    pub head: Option<f32>,
    /// Stride time, seconds, and the height of the legs' start over the floor, file units.
    pub stride: Option<(f32, f32)>,
    /// Kind of body according to the names in the file.
    pub species: Option<Species>,
}

impl Measured {
    /// True for a body of human size: a human, or a character named like one.
    fn is_human(&self) -> bool {
        self.humanoid || self.species == Some(Species::Human)
    }
}

/// A possible unit of a file.
struct Unit {
    metres: f32,
    name: &'static str,
    /// Rarity of the unit compared with centimetres, on a logarithmic scale: a rarity of 1 counts as much as a size
    /// that is `e` times farther from the usual one.
    rarity: f32,
}

/// Possible units of files. The last two result from converting metres or centimetres twice.
const UNITS: [Unit; 7] = [
    Unit { metres: 1.0, name: "metres", rarity: 0.0 },
    Unit { metres: 0.01, name: "centimetres", rarity: 0.0 },
    Unit { metres: 0.0254, name: "inches", rarity: 1.0 },
    Unit { metres: 0.1, name: "decimetres", rarity: 1.0 },
    Unit { metres: 0.001, name: "millimetres", rarity: 0.5 },
    Unit { metres: 100.0, name: "metres divided by a hundred", rarity: 0.5 },
    Unit { metres: 0.0001, name: "centimetres times a hundred", rarity: 0.5 },
];

/// Programs, by a word of their signature in files, and the unit in which they write, metres.
const EXPORTERS: [(&str, f32); 16] = [
    ("blender", 1.0),
    ("unity", 1.0),
    ("univrm", 1.0),
    ("unigltf", 1.0),
    ("vroid", 1.0),
    ("godot", 1.0),
    ("unreal", 1.0),
    ("maya", 0.01),
    ("mixamo", 0.01),
    ("character creator", 0.01),
    ("iclone", 0.01),
    ("daz", 0.01),
    ("assimp", 0.01),
    ("open asset import", 0.01),
    ("makehuman", 0.1),
    ("source engine", 0.0254),
];

/// Distance from a human's head joint to the crown, metres, nearly independent of height.
const HEAD: f32 = 0.23;
/// Range of heights that a head may imply, metres.
const BY_HEAD: [f32; 2] = [0.7, 1.8];

/// Acceleration of free fall, m/s².
const GRAVITY: f32 = 9.81;

/// Sizes of a kind of body, metres.
#[derive(Clone)]
struct Sizes {
    /// Names of the body and of its measure, for a sentence.
    words: [&'static str; 2],
    fits: core::ops::Range<f32>,
    /// Range of sizes, metres. If a centimetre as the file's unit gives a size in this range, it is accepted.
    surely: core::ops::Range<f32>,
    /// Usual size, metres.
    usual: f32,
    /// Factor by which deviations from the usual size count more than for creatures.
    focus: f32,
    /// Size if no unit fits, metres.
    assumed: f32,
}

const HUMAN: Sizes = Sizes {
    words: ["a human", "tall"],
    fits: 0.9..3.0,
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

impl Sizes {
    /// Returns the sizes of the kind of body that was measured.
    fn of(body: &Measured) -> Self {
        match body.species {
            Some(Species::Animal(_, length)) if !body.humanoid => Self {
                fits: GROWN.start * length..GROWN.end * length,
                surely: GROWN.start * length..GROWN.end * length,
                usual: length,
                assumed: length,
                ..CREATURE
            },
            _ if body.is_human() => HUMAN,
            _ => CREATURE,
        }
    }

    /// Accepts a small human if neighbouring files use its unit, doors are low, or the head is large and the steps are
    /// fast.
    ///
    /// A large head or the exporter's usual unit is not enough: characters with large heads are drawn at adult size,
    /// and scaled rigs are common. A short stride time alone is not enough either, because an adult may be in a hurry.
    fn with_small(mut self, witnesses: &Witnesses, metres: f32) -> Self {
        let steps = |(leg, by_stride): (f32, f32)| {
            let leg = leg * metres;
            leg < STEPS_ALIKE * by_stride && by_stride < STEPS_ALIKE * leg
        };
        // Files in metres occur everywhere, so they do not confirm a scaled one.
        let is_kin = metres != 1.0 && witnesses.kin.is_some_and(|kin| (metres / kin - 1.0).abs() < 0.05);
        if witnesses.has_low_door || is_kin || witnesses.has_large_head && witnesses.legs.is_some_and(steps) {
            self.fits.start = SHORTEST;
        }
        self
    }
}

/// Range of sizes of an animal, as shares of an adult's.
const GROWN: core::ops::Range<f32> = 0.6..1.5;

/// Evidence for a unit in addition to the body's size, and its wording.
struct Witnesses {
    /// Length of the legs in file units, and in metres as implied by the stride time.
    legs: Option<(f32, f32)>,
    /// Usual unit of the exporter, and unit of neighbouring files, metres.
    exporter: Option<f32>,
    kin: Option<f32>,
    /// Usual size of such a body, metres.
    usual: f32,
    /// True if doors of the target world are for small humans.
    has_low_door: bool,
    /// True if the head implies a small human.
    has_large_head: bool,
    words: String,
}

impl Witnesses {
    fn of(body: &Measured, hints: &Hints, sizes: &Sizes) -> Self {
        let mut words = String::new();
        let legs = body.stride.filter(|&(stride, leg)| stride > 0.0 && leg > 0.0).map(|(stride, leg)| {
            let metres = GRAVITY * (stride / STRIDE_SPEED) * (stride / STRIDE_SPEED);
            let _ = write!(words, ", a stride of {stride:.2} s is that of legs of {metres:.2} m");
            (leg, metres)
        });
        let signed = hints.exporter.to_lowercase();
        let exporter = EXPORTERS.iter().find(|(word, _)| signed.contains(word));
        let exporter = exporter.map(|&(_, metres)| metres);
        if let Some(unit) = exporter.and_then(unit_of) {
            let _ = write!(words, ", {} writes {}", hints.exporter, unit.name);
        }
        let kin = common(&hints.kin);
        if let Some(unit) = kin.and_then(unit_of) {
            let _ = write!(words, ", files beside it are in {}", unit.name);
        }
        let (mut usual, mut has_low_door) = (sizes.usual, false);
        if let Some(door) = hints.door.filter(|_| body.humanoid) {
            usual = UNDER_DOOR * door;
            has_low_door = usual < sizes.fits.start;
            let _ = write!(words, ", doors of its world are {door:.2} m high");
        } else if let Some(head) = body.head.filter(|head| body.humanoid && *head > 0.0) {
            usual = clamp(HEAD / head, BY_HEAD[0], BY_HEAD[1]);
            let _ = write!(words, ", its head is {:.0} % of it", 100.0 * head);
        }
        let has_large_head = body.head.is_some_and(|head| HEAD < GROWN_BY_HEAD * head);
        Self { legs, exporter, kin, usual, has_low_door, has_large_head, words }
    }

    /// Returns the evidence against a unit, on the scale of [`Unit::rarity`].
    fn against(&self, unit: &Unit) -> f32 {
        let off = |(leg, metres): (f32, f32)| trig::ln(leg * unit.metres / metres).abs();
        let same = |metres: f32| (metres / unit.metres - 1.0).abs() < 0.05;
        let by_exporter = if self.exporter.is_some_and(same) { UNIT_BY_EXPORTER } else { 0.0 };
        let by_kin = if self.kin.is_some_and(same) { UNIT_BY_KIN } else { 0.0 };
        self.legs.map_or(0.0, off) - by_exporter - by_kin
    }
}

fn unit_of(metres: f32) -> Option<&'static Unit> {
    UNITS.iter().find(|unit| (metres / unit.metres - 1.0).abs() < 0.05)
}

/// Returns the unit that most of several files have; `None` if there is none.
fn common(kin: &[f32]) -> Option<f32> {
    let alike = |metres: f32| kin.iter().filter(|other| (*other / metres - 1.0).abs() < 0.05).count();
    kin.iter().copied().find(|&metres| alike(metres) > 1 && 2 * alike(metres) > kin.len())
}

/// Returns the metres per file unit, with the reason and alternatives.
///
/// In metres, a humanoid between 0.9 m and 3 m is accepted (from 0.5 m if its leg length fits its steps), a creature
/// whose longest side is 0.1 m to 10 m, and an animal named by the file at 0.6 to 1.5 times its adult size; in
/// centimetres, humanoids from 0.9 m and creatures from 0.3 m. Otherwise the most likely unit is chosen among
/// centimetres, inches, decimetres, millimetres and twice converted units: near the usual size (by head and doors), not
/// rare, with matching strides, and used by the exporter and neighbouring files. Strong evidence of these kinds
/// overrides an accepted size. If no unit fits, a humanoid is 1.75 m, a creature has the length that its stride
/// implies, else 1 m.
pub(super) fn unit_scale(body: &Measured, hints: &Hints) -> (f32, UnitGuess) {
    let (measure, sizes) = (if body.is_human() { body.height } else { body.size }, Sizes::of(body));
    let across = sizes.words[1];
    let kind = match body.species {
        Some(Species::Animal(name, _)) if !body.humanoid => {
            format!("a grown {name} (by the names of the file and in it)")
        }
        _ => sizes.words[0].to_owned(),
    };
    let witnesses = Witnesses::of(body, hints, &sizes);
    let hundredths = |metres: f32| (100.0 * metres).round() / 100.0;
    let [least, most] = [sizes.fits.start, sizes.fits.end].map(hundredths);
    let usual = format!("{kind} is {least} to {most} m");
    let fits = |unit: &&Unit| {
        let sizes =
            if body.humanoid { sizes.clone().with_small(&witnesses, unit.metres) } else { sizes.clone() };
        sizes.fits.contains(&(measure * unit.metres))
    };
    let mut fitting: Vec<&Unit> = UNITS.iter().filter(fits).collect();
    if fitting.is_empty() {
        let (assumed, by) = assumed(body, &sizes, &witnesses);
        let scale = assumed / max(measure, 1e-12);
        let note = format!(
            "{measure:.3} units {across} fits no unit, since {usual}: scaled to {assumed} m{by}, a unit of {scale} m; as \
             metres it would be {measure:.2} m"
        );
        return (scale, UnitGuess { note, is_sure: false, is_only: false, is_scaled: true });
    }
    // The sort is stable: of equally likely units the first is chosen.
    let by_size = |unit: &Unit| match unit.metres {
        1.0 => 0.0,
        0.01 if sizes.surely.contains(&(measure * 0.01)) => 0.0,
        metres => 1e-3 + unit.rarity + sizes.focus * trig::ln(measure * metres / witnesses.usual).abs(),
    };
    let unlikely = |unit: &Unit| by_size(unit) + witnesses.against(unit);
    fitting.sort_by(|a, b| unlikely(a).total_cmp(&unlikely(b)));
    let unit = fitting.remove(0);
    let others: Vec<String> =
        fitting.iter().map(|unit| format!("{} ({:.2} m)", unit.name, measure * unit.metres)).collect();
    // Units in which the body would be a small human, which its surroundings could confirm, leave a doubt.
    let small = SHORTEST..sizes.fits.start;
    let may_be_small = |unit: &&Unit| body.humanoid && small.contains(&(measure * unit.metres));
    let small =
        UNITS.iter().filter(may_be_small).filter(|other| other.metres != unit.metres && other.metres != 1.0);
    let known: Vec<f32> = fitting.iter().map(|unit| unit.metres).collect();
    let small = small.filter(|other| !known.contains(&other.metres));
    let others: Vec<String> = others
        .into_iter()
        .chain(small.map(|unit| format!("{} ({:.2} m)", unit.name, measure * unit.metres)))
        .collect();
    let is_only = others.is_empty();
    let is_sure = is_only && body.humanoid && unit.metres == 1.0;
    // A single candidate needs no comparison.
    let (others, words) = if is_only {
        ("no other unit fits".to_owned(), "")
    } else {
        (format!("it may also be {}", others.join(", ")), witnesses.words.as_str())
    };
    let (name, metres) = (unit.name, measure * unit.metres);
    let note = format!(
        "{measure:.2} units {across}, taken as {name}: {metres:.2} m, since {usual}{words}; {others}"
    );
    (unit.metres, UnitGuess { note, is_sure, is_only, is_scaled: false })
}

/// Returns the assumed size of a body that fits no unit, metres, and its reason.
fn assumed(body: &Measured, sizes: &Sizes, witnesses: &Witnesses) -> (f32, &'static str) {
    match witnesses.legs {
        Some((leg, metres)) if !body.humanoid && body.species.is_none() => {
            (clamp(body.size * metres / leg, sizes.fits.start, sizes.fits.end), ", by its stride")
        }
        _ => (sizes.assumed, ""),
    }
}
