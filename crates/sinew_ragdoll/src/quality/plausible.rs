//! Doubts about an inferred size or mass.

use super::{FallQuality, Verdict};
use crate::def::RagdollDef;
use crate::tuning::{BIG_HEAD, CREATURE_BUILD, FAR_OFF, ROUND};
use sinew_anim::Animal;
use sinew_math::{max, max3, min, min3, trig};

/// Mass that a human may have, kg.
const HUMAN: core::ops::RangeInclusive<f32> = 3.0..=300.0;
/// Mass of a human over the square of its height, kg/m²: from a starved adult to the heaviest known.
const HUMAN_BUILD: core::ops::RangeInclusive<f32> = 10.0..=80.0;
/// Height range of a human with adult proportions, metres.
const ADULT: core::ops::RangeInclusive<f32> = 0.9..=2.6;
/// Mass range of a creature, kg: from a small bird to a bull or the largest bears. Heavier creatures are elephants,
/// whales and, far more often, files in another unit: a wolf of 2.5 t, a wasp of 1.6 t.
const CREATURE: core::ops::RangeInclusive<f32> = 0.1..=1000.0;

/// Doubt about an estimated mass that hardly any body has. If the file's unit was guessed, the guess is usually wrong,
/// and a verdict on the ragdoll is unreliable.
#[derive(Clone, Debug, PartialEq)]
pub struct Doubt {
    /// Reason, a sentence.
    pub reason: String,
    /// Factor on the size of the character that reduces its mass to the heaviest plausible one of its kind, at most 1.
    size: f32,
    /// True if hardly any body of this kind, of any size, has this mass.
    pub is_gross: bool,
}

impl Doubt {
    /// Returns a doubt about a ragdoll's mass or size; `None` if such bodies exist.
    pub fn of(def: &RagdollDef) -> Option<Self> {
        let (kind, range) = kin(def);
        if range.contains(&def.total_mass) {
            return if kind == "human" { Self::of_human(def) } else { Self::of_build(def) };
        }
        let (mass, height) = (in_words(def.total_mass), def.height);
        let (least, most) = (in_words(*range.start()), in_words(*range.end()));
        Some(Self {
            reason: format!(
                "mass of {mass} at a height of {height:.3} m: hardly any {kind} weighs less than {least} or more than {most}"
            ),
            size: min(1.0, trig::pow(range.end() / def.total_mass, 1.0 / 3.0)),
            is_gross: true,
        })
    }

    /// Returns a doubt about a mass far outside of those of the animal that the file names, for a character whose unit
    /// has this length, metres.
    pub fn of_kind(def: &RagdollDef, animal: &Animal, unit_scale: f32) -> Option<Self> {
        let [least, most] = animal.mass_at(unit_scale);
        let is_usual = def.total_mass > least / FAR_OFF && def.total_mass < FAR_OFF * most;
        (!is_usual).then(|| {
            let [mass, least, most] = [def.total_mass, least, most].map(in_words);
            let name = animal.name;
            let reason = format!("mass of {mass}: a {name} of that size weighs {least} to {most}");
            Self { reason, size: 1.0, is_gross: true }
        })
    }

    /// Returns a doubt about a human of plausible mass: about this mass for the height, or about the height for the
    /// proportions.
    fn of_human(def: &RagdollDef) -> Option<Self> {
        let (mass, height) = (def.total_mass, def.height);
        let doubt = |why: String| {
            let reason = format!("mass of {} at a height of {height:.3} m: {why}", in_words(mass));
            Some(Self { reason, size: 1.0, is_gross: false })
        };
        if !HUMAN_BUILD.contains(&(mass / (height * height))) {
            return doubt("hardly any human of that height weighs as much".to_owned());
        }
        let head = def.bodies.iter().position(|body| body.role == "head");
        let head = head.and_then(|head| def.joints.iter().find(|joint| joint.child == head));
        let share = head.map_or(0.0, |joint| {
            let neck = def.bodies[joint.child].character_from_body * joint.frame_child;
            1.0 - neck.translation.y / height
        });
        let is_adult = share < BIG_HEAD;
        let (least, most) = (ADULT.start(), ADULT.end());
        if height > *most || (height < *least && is_adult) {
            return doubt(format!("a human with this head is between {least} m and {most} m tall"));
        }
        None
    }

    /// Returns a doubt about a creature of plausible mass: the mass is too large for its longest side.
    fn of_build(def: &RagdollDef) -> Option<Self> {
        let boxes = def.bodies.iter().map(|body| body.shape.aabb(&body.character_from_body));
        let corners = boxes.map(|own| (own.min, own.max));
        let (low, high) = corners.reduce(|a, b| (min3(a.0, b.0), max3(a.1, b.1)))?;
        let sides = high - low;
        let longest = max(sides.x, max(sides.y, sides.z));
        let mass = def.total_mass;
        // Comparisons with NaN are false.
        if !(mass > ROUND && mass > CREATURE_BUILD * longest * longest * longest) {
            return None;
        }
        let mass = in_words(mass);
        let reason = format!(
            "mass of {mass} at a length of {longest:.3} m: hardly any creature of that size weighs as much"
        );
        Some(Self { reason, size: 1.0, is_gross: false })
    }

    /// Judges a ragdoll in doubt, from drops or bakes, and returns verdict and reasons; `judge` judges the metrics of a
    /// ragdoll without doubt. The verdict is at most `usable`, and the doubt is the first reason. The thresholds are in
    /// metres and seconds for real bodies, so a heavier ragdoll is judged at the scale where the heaviest real body
    /// would have its mass: lengths scale with the size and times with its square root. Metrics that miss their
    /// threshold unscaled are still listed among the reasons.
    pub fn judge<const N: usize>(
        &self,
        figures: [FallQuality; N],
        judge: impl Fn(&[FallQuality; N]) -> (Verdict, Vec<String>),
    ) -> (Verdict, Vec<String>) {
        let (_, mut reasons) = judge(&figures);
        let (verdict, _) = judge(&figures.map(|quality| at_size(quality, self.size)));
        reasons.insert(0, self.reason.clone());
        (Verdict::min(verdict, Verdict::Usable), reasons)
    }
}

/// Returns the metrics of the same fall scaled to a body `size` times as large.
fn at_size(quality: FallQuality, size: f32) -> FallQuality {
    let time = |seconds: Option<f32>| seconds.map(|seconds| seconds * size.sqrt());
    FallQuality {
        joint_gap_max_m: quality.joint_gap_max_m * size,
        joint_gap_p99_m: quality.joint_gap_p99_m * size,
        penetration_max_m: quality.penetration_max_m * size,
        penetration_rest_max_m: quality.penetration_rest_max_m * size,
        nonadjacent_overlap_max_m: quality.nonadjacent_overlap_max_m * size,
        asleep_s: time(quality.asleep_s),
        calm_to_asleep_s: time(quality.calm_to_asleep_s),
        ..quality
    }
}

/// Returns the name of the ragdoll's presumed kind, and the mass range of such bodies.
fn kin(def: &RagdollDef) -> (&'static str, core::ops::RangeInclusive<f32>) {
    let human = def.bodies.iter().any(|body| body.role == "hips");
    if human { ("human", HUMAN) } else { ("creature", CREATURE) }
}

/// Returns a mass with its unit, to three digits.
fn in_words(kg: f32) -> String {
    let (value, unit) = match kg {
        kg if kg >= 1000.0 => (kg / 1000.0, "t"),
        kg if kg >= 1.0 => (kg, "kg"),
        kg => (1000.0 * kg, "g"),
    };
    let tenths = (10.0 * value).round() / 10.0;
    format!("{tenths} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::{judge, judge_bake};

    fn of(total_mass: f32) -> RagdollDef {
        RagdollDef { total_mass, height: 4.6, ..RagdollDef::default() }
    }

    #[test]
    fn drops_and_bakes_of_a_mass_in_doubt_are_usable_at_most() {
        let calm = FallQuality {
            asleep_s: Some(3.0),
            calm_to_asleep_s: Some(0.7),
            settled_omega_max: Some(0.0),
            ..FallQuality::default()
        };
        for mass in [0.013, 3600.0, 24_000.0, 30_000.0] {
            let doubt = Doubt::of(&of(mass)).expect("the mass is doubtful");
            assert_eq!((judge(&calm, &calm).0, judge_bake(&calm).0), (Verdict::Good, Verdict::Good));
            let drops = doubt.judge([calm, calm], |[drop, wall]| judge(drop, wall));
            let bake = doubt.judge([calm], |[fall]| judge_bake(fall));
            for (verdict, reasons) in [drops, bake] {
                assert_eq!(verdict, Verdict::Usable, "{mass} kg");
                assert_eq!(reasons[0], doubt.reason, "{mass} kg");
            }
        }
        assert_eq!(Doubt::of(&of(900.0)), None);
    }

    #[test]
    fn heavy_ragdoll_is_judged_at_a_plausible_size() {
        let calm = FallQuality {
            asleep_s: Some(6.2),
            calm_to_asleep_s: Some(0.7),
            settled_omega_max: Some(0.0),
            ..FallQuality::default()
        };
        let deep = |overlap: f32| FallQuality { nonadjacent_overlap_max_m: overlap, ..calm };
        let verdict = |mass: f32, drop: FallQuality| {
            let doubt = Doubt::of(&of(mass)).expect("the mass is doubtful");
            doubt.judge([drop, calm], |[drop, wall]| judge(drop, wall)).0
        };
        assert_eq!(judge(&deep(0.042), &calm).0, Verdict::Bad);
        assert_eq!(verdict(24_000.0, deep(0.042)), Verdict::Usable);
        // Slightly above 1 t the size is plausible; a depth of 50 cm is deep at any size.
        assert_eq!(verdict(1050.0, deep(0.042)), Verdict::Bad);
        assert_eq!(verdict(24_000.0, deep(0.5)), Verdict::Bad);
        assert_eq!(verdict(24_000.0, deep(f32::NAN)), Verdict::Bad);
        assert_eq!(verdict(24_000.0, FallQuality { nan: 1, ..calm }), Verdict::Bad);
        assert_eq!(verdict(24_000.0, FallQuality { asleep_s: None, ..calm }), Verdict::Bad);
        // A ragdoll with a doubtful mass is never good, and small ones are judged unscaled.
        assert_eq!(verdict(24_000.0, FallQuality { asleep_s: Some(3.0), ..calm }), Verdict::Usable);
        assert_eq!(verdict(0.013, deep(0.0)), Verdict::Usable);
        assert_eq!(verdict(0.013, deep(0.042)), Verdict::Bad);
    }
}
