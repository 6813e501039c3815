//! Judges the metrics of the skin.
//!
//! The thresholds were tuned on 43 open rigs (values in `docs/ragdoll.md`): each lies in the gap between rigs that look
//! right at rest and rigs that do not.

use super::{Phase, SkinQuality, Stage};
use crate::def::RagdollDef;
use crate::quality::Verdict;
use crate::tuning::{FLOATS_RISING, GROSS, HANGS, LEAPS, STANDS_OFF, SUNK_RISING};
use sinew_math::max;

/// Least share of vertices that are near their body.
const COVERED: f32 = 0.95;
/// Largest stretch, as a share of the size: 99.9th percentile and maximum. Sound rigs reach 8 % and 16 %; torn ones
/// start at 15 % and 24 %.
const STRETCH: [f32; 2] = [0.10, 0.20];
/// Stretch tolerated because the file's own clips stretch the skin too, as a multiple of their stretch: 99.9th
/// percentile and maximum.
const STRETCH_OF_CLIPS: [f32; 2] = [1.5, 3.0];
/// Largest difference between left and right, as a share of the size. Of 136 characters that were inspected, 20 differ
/// by 2 to 4 % (a holster, a scar, an odd weight) and look symmetric; visible defects start at 5.6 %.
const ASYMMETRY: f32 = 0.045;
/// Largest difference of the drawn and the bound height, as a share of the size.
const HEIGHT: f32 = 0.02;
/// Largest depth of the lowest drawn point in the floor, as a share of the size. Shapes are inside the skin, so noses,
/// hair and fingers sink in.
const SUNK: f32 = 0.06;
/// Largest height of the lowest drawn point above the floor, as a share of the size; only a shape outside the skin
/// causes it.
const RAISED: f32 = 0.02;
/// Depth or height of the lowest drawn point up to which it does not count, metres.
const LEAST_OFF: f32 = 0.01;
/// Longest time in the air after calm, seconds: six steps, in which a body that fell asleep tilted may tip over.
const AIRBORNE: f32 = 0.1;

/// Kind of a flaw of the skin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlawKind {
    /// Skin is far from every body that moves it.
    Uncovered,
    /// A fall stretches the skin.
    Torn,
    /// Left and right differ.
    Lopsided,
    /// A part is attached to a body to which it is not connected.
    Apart,
    /// The character is drawn at another size than in the bind pose.
    Resized,
    /// The skin is in the floor, or above it.
    OffFloor,
    /// The character lies still without contact.
    Airborne,
}

/// A flaw of the skin of a ragdoll.
#[derive(Clone, Debug, PartialEq)]
pub struct Flaw {
    /// Kind of the flaw.
    pub kind: FlawKind,
    /// Measured value and the threshold that it misses, one sentence.
    pub evidence: String,
    /// Option or setting that helps, with the bones concerned.
    pub remedy: String,
    /// Bodies concerned, by index in the definition.
    pub bodies: Vec<usize>,
    /// Bones of these bodies.
    pub bones: Vec<String>,
    /// Best verdict on a ragdoll that has the flaw.
    pub at_most: Verdict,
}

impl core::fmt::Display for Flaw {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{}; {}", self.evidence, self.remedy)
    }
}

impl SkinQuality {
    /// Returns all flaws that keep the verdict on the skin below good; `def` is the definition with which the skin was
    /// measured.
    ///
    /// # Panics
    /// If the metrics belong to a definition with more bodies.
    pub fn flaws(&self, def: &RagdollDef) -> Vec<Flaw> {
        let names = BodyNames(def);
        [
            self.uncovered(&names),
            self.torn(&names),
            self.lopsided(&names),
            self.apart(&names),
            self.resized(&names),
            self.off_floor(&names),
            self.stands_off(&names, Stage::Standing),
            self.stands_off(&names, Stage::Rising),
            self.stands_off(&names, Stage::Up),
            self.above_floor(&names),
            self.airborne(&names),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// Returns the combined verdict of bodies and skin: the verdict on the bodies, limited by the worst skin flaw.
    pub fn verdict(flaws: &[Flaw], of_bodies: Verdict) -> Verdict {
        flaws.iter().map(|flaw| flaw.at_most).fold(of_bodies, Verdict::min)
    }

    fn uncovered(&self, names: &BodyNames<'_>) -> Option<Flaw> {
        // Comparisons with NaN are false: a metric that is NaN is a flaw.
        if self.covered_share >= COVERED {
            return None;
        }
        let [share, asked] = [self.covered_share, COVERED].map(|share| 100.0 * share);
        let near = 100.0 * self.tolerance();
        let mut flaw_text = format!(
            "{share:.1} % of the skin's vertices are within {near:.0} cm of their body, {asked:.0} % are asked"
        );
        if let Some(body) = self.worst.uncovered {
            flaw_text += &format!("; most of the others hang on {}", names.name(body));
        }
        if self.worst.adrift > 0 {
            flaw_text += &format!("; {:.1} % hang on no body", self.worst.adrift as f32 / 10.0);
        }
        let remedy = names.body_or_shape(self.worst.uncovered, self.worst.uncovered_joint.as_deref());
        Some(names.flaw(FlawKind::Uncovered, flaw_text, remedy, self.worst.uncovered.as_slice()))
    }

    fn torn(&self, names: &BodyNames<'_>) -> Option<Flaw> {
        let clips = [self.clips_stretch_p999, self.clips_stretch_max];
        let bar = |k: usize| max(STRETCH[k], clips[k].map_or(0.0, |clip| STRETCH_OF_CLIPS[k] * clip));
        if self.edge_stretch_p999 <= bar(0) && self.edge_stretch_max <= bar(1) {
            return None;
        }
        let cm = |share: f32| 100.0 * share * self.size;
        let is_gross = self.edge_stretch_p999 > GROSS * bar(0) || self.edge_stretch_max > GROSS * bar(1);
        let at_most = if is_gross { Verdict::Bad } else { Verdict::Usable };
        let what = match self.worst.torn_in {
            Phase::Drop | Phase::Fall => "falling",
            Phase::Clip => "getting up",
        };
        let mut flaw_text = format!(
            "{what} stretches one side of its triangles in a thousand by more than {:.1} cm, {:.1} cm at worst; up to {:.1} and {:.1} cm are let pass",
            cm(self.edge_stretch_p999),
            cm(self.edge_stretch_max),
            cm(bar(0)),
            cm(bar(1)),
        );
        let remedy =
            "--body BONE gives what stays behind a body, --role ROLE=BONE says what it is".to_owned();
        let Some((a, b)) = self.worst.torn else {
            return Some(Flaw { at_most, ..names.flaw(FlawKind::Torn, flaw_text, remedy, &[]) });
        };
        let (a_name, b_name) = (names.name(a), names.name(b));
        flaw_text += &if a == b {
            format!("; worst on {a_name}")
        } else {
            format!("; worst between {a_name} and {b_name}")
        };
        let bodies = [a, b];
        let flaw = names.flaw(FlawKind::Torn, flaw_text, remedy, if a == b { &bodies[..1] } else { &bodies });
        Some(Flaw { at_most, ..flaw })
    }

    fn lopsided(&self, names: &BodyNames<'_>) -> Option<Flaw> {
        let bar = ASYMMETRY * self.size;
        if self.symmetry_error_m <= bar {
            return None;
        }
        let cm = 100.0 * self.symmetry_error_m;
        let of = self.worst.unlike.map_or(String::new(), |body| format!("{} and ", names.name(body)));
        let flaw_text = format!("{of}its mirror image differ by {cm:.1} cm, more than {:.1} cm", 100.0 * bar);
        let remedy =
            "a role without its side in the settings (`bones`) sets shape, scale or mass of both".to_owned();
        Some(names.flaw(FlawKind::Lopsided, flaw_text, remedy, self.worst.unlike.as_slice()))
    }

    fn apart(&self, names: &BodyNames<'_>) -> Option<Flaw> {
        if self.contiguous {
            return None;
        }
        let body = self.worst.apart;
        let parent = body.and_then(|body| names.0.joints.iter().find(|joint| joint.child == body));
        let flaw_text = match (body, parent) {
            (Some(body), Some(joint)) => {
                format!(
                    "{} hangs on {}, which it does not grow from",
                    names.name(body),
                    names.name(joint.parent)
                )
            }
            _ => "a body hangs on one that it does not grow from".to_owned(),
        };
        let bone = body.map_or("BONE", |body| names.0.bodies[body].bone.as_str());
        let remedy = format!("--role ROLE={bone} says what it is, --no-body {bone} leaves it without a body");
        Some(names.flaw(FlawKind::Apart, flaw_text, remedy, body.as_slice()))
    }

    fn resized(&self, names: &BodyNames<'_>) -> Option<Flaw> {
        if (self.drawn_height_m - self.bind_height_m).abs() <= HEIGHT * self.size {
            return None;
        }
        let flaw_text = format!(
            "drawn by its nodes it is {:.3} m high, bound {:.3} m",
            self.drawn_height_m, self.bind_height_m
        );
        let remedy = "apply the nodes' scales in the modelling tool and export anew".to_owned();
        Some(names.flaw(FlawKind::Resized, flaw_text, remedy, &[]))
    }

    fn off_floor(&self, names: &BodyNames<'_>) -> Option<Flaw> {
        let (sunk, raised) = (max(SUNK * self.size, LEAST_OFF), max(RAISED * self.size, LEAST_OFF));
        let height = self.rest_height_m?;
        if height >= -sunk && height <= raised {
            return None;
        }
        let cm = 100.0 * height;
        let what = match self.worst.lowest {
            Some(body) => format!("the lowest point of its skin, on {},", names.name(body)),
            None => "the lowest point of its skin".to_owned(),
        };
        let flaw_text = if cm < 0.0 {
            format!("at rest {what} is {:.1} cm in the floor, more than {:.1} cm", -cm, 100.0 * sunk)
        } else {
            format!("at rest {what} is {cm:.1} cm above the floor, more than {:.1} cm", 100.0 * raised)
        };
        let remedy = match self.worst.lowest {
            Some(body) if cm > 0.0 => {
                format!(
                    "a `scale` below 1 of {} in the settings makes its shape smaller",
                    names.0.bodies[body].bone
                )
            }
            lowest => names.body_or_shape(lowest, self.worst.lowest_joint.as_deref()),
        };
        let at_most = if height > HANGS * self.size { Verdict::Bad } else { Verdict::Usable };
        Some(Flaw {
            at_most,
            ..names.flaw(FlawKind::OffFloor, flaw_text, remedy, self.worst.lowest.as_slice())
        })
    }

    /// Returns a flaw if the lowest point of the skin is far from the floor while clips move the character: in the
    /// floor, or, while standing, above it.
    fn stands_off(&self, names: &BodyNames<'_>, stage: Stage) -> Option<Flaw> {
        let (height, what) = match stage {
            Stage::Standing => (self.standing_height_m, "standing before the fall"),
            Stage::Rising => (self.rising_height_m, "getting up"),
            Stage::Up => (self.up_height_m, "standing up again"),
        };
        let height = height?;
        let is_rising = stage == Stage::Rising;
        let bar = max(if is_rising { SUNK_RISING } else { STANDS_OFF } * self.size, LEAST_OFF);
        // A creature that flies, swims or crawls may be above the floor.
        let may_be_above = is_rising || names.0.bodies[0].role != "hips";
        if height >= -bar && (height <= bar || may_be_above) {
            return None;
        }
        let lowest = self.worst.lowest_in[stage as usize];
        let point = lowest.map_or(String::new(), |body| format!(", on {},", names.name(body)));
        let side = if height > 0.0 { "above" } else { "in" };
        let flaw_text = format!(
            "{what} the lowest point of its skin{point} is {:.1} cm {side} the floor, more than {:.1} cm",
            100.0 * height.abs(),
            100.0 * bar
        );
        let remedy = match stage {
            Stage::Standing => "--clip NAME plays a clip that stands on its floor, --at X,Y,Z moves it there",
            _ => {
                "--clips FILE brings a clip to get up by that is made for this body, `bake --get-up none` leaves it lying"
            }
        };
        let flaw = names.flaw(FlawKind::OffFloor, flaw_text, remedy.to_owned(), lowest.as_slice());
        let is_gross = height.is_nan() || height.abs() > GROSS * bar;
        Some(Flaw { at_most: if is_gross { Verdict::Bad } else { Verdict::Usable }, ..flaw })
    }

    /// Returns a flaw if a human floats while getting up, or its clips leave the floor by more than a leap of a runner.
    fn above_floor(&self, names: &BodyNames<'_>) -> Option<Flaw> {
        if names.0.bodies[0].role != "hips" {
            return None;
        }
        let rising = (
            self.rising_above_m,
            FLOATS_RISING,
            "getting up it floats",
            "--clips FILE brings a clip to get up by that is made for this body",
        );
        let clips = (
            self.clips_above_m,
            LEAPS,
            "its clip carries it",
            "--clip NAME plays a clip that stays on the floor",
        );
        [rising, clips].into_iter().find_map(|(height, bar, what, remedy)| {
            let (height, bar) = (height?, max(bar * self.size, LEAST_OFF));
            // A comparison with NaN is false, and NaN is a flaw.
            if height <= bar {
                return None;
            }
            let [cm, most] = [height, bar].map(|metres| 100.0 * metres);
            let flaw_text =
                format!("{what}: its lowest point is {cm:.1} cm above the floor, more than {most:.1} cm");
            Some(names.flaw(FlawKind::OffFloor, flaw_text, remedy.to_owned(), &[]))
        })
    }

    fn airborne(&self, names: &BodyNames<'_>) -> Option<Flaw> {
        let seconds = self.airborne_s?;
        if seconds <= AIRBORNE {
            return None;
        }
        let flaw_text = format!("it is calm and touches nothing for {seconds:.2} s, more than {AIRBORNE} s");
        let remedy = "please report it with the file: what nothing holds must fall".to_owned();
        Some(names.flaw(FlawKind::Airborne, flaw_text, remedy, &[]))
    }
}

/// Names of bodies.
struct BodyNames<'a>(&'a RagdollDef);

impl BodyNames<'_> {
    /// Returns role and bone, the bone only where it differs.
    fn name(&self, body: usize) -> String {
        let body = &self.0.bodies[body];
        if body.role == body.bone { body.role.clone() } else { format!("{} ({})", body.role, body.bone) }
    }

    /// Returns the advice for skin far from a body: give its joint a body, or enlarge the shape if it has one.
    fn body_or_shape(&self, body: Option<usize>, joint: Option<&str>) -> String {
        match (body, joint.filter(|joint| !joint.is_empty())) {
            (_, Some(joint)) => {
                format!("--body {joint} gives that part a body of its own, --ignore {joint} leaves it out")
            }
            (Some(body), None) => {
                format!(
                    "a `scale` above 1 of {} in the settings makes its shape larger",
                    self.0.bodies[body].bone
                )
            }
            (None, None) => "--body BONE gives a part a body, --ignore BONE leaves it out".to_owned(),
        }
    }

    fn flaw(&self, kind: FlawKind, evidence: String, remedy: String, bodies: &[usize]) -> Flaw {
        let bones = bodies.iter().map(|&body| self.0.bodies[body].bone.clone()).collect();
        Flaw { kind, evidence, remedy, bodies: bodies.to_vec(), bones, at_most: Verdict::Usable }
    }
}
