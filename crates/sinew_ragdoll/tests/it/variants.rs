//! Many variants of a rig, as exporters, riggers and stores make them, give the same ragdoll.

use crate::build::{built, check_sound};
use crate::built_rigs::{beetle, block_man, dog};
use crate::data::{document, is_there};
use crate::disguise::{
    CONVENTIONS, affixed, bound_in, made_roots, parented_to_root, renamed, shifted, shuffled, transformed,
    under_a_mirror, unweighted, with_controls, with_eyes, with_hair, with_halves, with_hat, with_twists,
    with_two_skins, z_up,
};
use crate::rig_variants::Falls;
use sinew_anim::{Clip, Hints, JointIdx, Rig, RigAnalysis, Role, Side, analyze, analyze_hinted};
use sinew_formats::Document;
use sinew_math::{Random, Rotation};
use sinew_ragdoll::{BuildOptions, RagdollDef, build};
use sinew_scenes::mannequin::mannequin;

/// Humans, stylised characters, animals and eight-legged creatures, in addition to the rigs built in code.
const RIGS: [&str; 10] = [
    "CesiumMan.glb",
    "RiggedFigure.glb",
    "../rigs_wild/modular_men_Adventurer.glb",
    "../rigs_wild/modular_women_Witch.glb",
    "mannequiny.glb",
    "mesh2motion_human_rigify.glb",
    "kaykit_Knight.glb",
    "../rigs_wild/modular_women_Adventurer.glb",
    "Fox.glb",
    "quaternius_Spider.glb",
];

/// Number of variants per rig in full runs; otherwise a few.
const ALL: u64 = 60;
const FEW: u64 = 2;

const PREFIXES: [&str; 6] = ["", "Armature|", "chr_", "rig:", "GLB_", "Char01."];
const SUFFIXES: [&str; 4] = ["", "_jnt", ".001", "_050"];

/// Returns the feet that may be reparented to the root.
fn feet(rig: &Rig, analysis: &RigAnalysis) -> Vec<JointIdx> {
    let of = |side| analysis.joint_with(Role::Foot(side));
    if analysis.humanoid {
        return [Side::Left, Side::Right].into_iter().filter_map(of).collect();
    }
    // Bodies of a creature at the end of a limb count, unless feet are children of the root already.
    let is_end = |bone: usize| analysis.kept.iter().all(|other| other.parent != Some(bone));
    let holds = |joint: JointIdx, below: JointIdx| {
        std::iter::successors(Some(below), |&at| rig.joints[at].parent).any(|at| at == joint)
    };
    let limbs = analysis.kept.iter().enumerate().filter(|(bone, kept)| {
        let is_foot = matches!(kept.role, Role::LimbSegment { segment, .. } if segment > 0);
        is_foot && is_end(*bone) && kept.merged.iter().all(|&joint| holds(kept.joint, joint))
    });
    limbs.map(|(_, kept)| kept.joint).collect()
}

/// Returns thighs and upper arms, or their parent clavicles.
fn limbs(analysis: &RigAnalysis) -> Vec<JointIdx> {
    let of = |side: Side| {
        let arm = [Role::Shoulder(side), Role::UpperArm(side)].map(|role| analysis.joint_with(role));
        [analysis.joint_with(Role::UpperLeg(side)), arm[0].or(arm[1])]
    };
    [Side::Left, Side::Right].into_iter().flat_map(of).flatten().collect()
}

/// Returns thighs or upper arms, each with its parent.
fn limb_roots(analysis: &RigAnalysis, random: &mut Random) -> Vec<(JointIdx, JointIdx)> {
    let [thigh, arm] = [|side| Role::UpperLeg(side), |side| Role::UpperArm(side)] as [fn(Side) -> Role; 2];
    let upper = [thigh, arm][random.index(2)];
    let carried = |side: Side| {
        let bone = analysis.kept_with(upper(side))?;
        let carrier = analysis.kept[bone].parent?;
        Some((analysis.kept[bone].joint, analysis.kept[carrier].joint))
    };
    [Side::Left, Side::Right].into_iter().filter_map(carried).collect()
}

/// A changed rig and its expected results.
struct Variant {
    rig: Rig,
    hints: Hints,
    /// New index of each joint of the plain rig.
    place: Vec<usize>,
    /// Description of the variant, for messages.
    changes_made: String,
}

/// A character to vary.
struct Subject {
    name: &'static str,
    rig: Rig,
    clips: Vec<Clip>,
}

impl Subject {
    /// Returns the rigs built in code, then those of the shared data if present.
    fn all() -> Vec<Self> {
        let mannequin = mannequin();
        let built = [
            ("the mannequin", mannequin.rig, mannequin.clips),
            ("a man of boxes", block_man(), Vec::new()),
            ("a dog of boxes", dog(), Vec::new()),
            ("a beetle of boxes", beetle(), Vec::new()),
        ];
        let mut all: Vec<Self> =
            built.into_iter().map(|(name, rig, clips)| Self { name, rig, clips }).collect();
        for name in RIGS.into_iter().filter(|_| is_there()) {
            let Document { rig, clips, .. } = document(name);
            all.push(Self { name, rig, clips });
        }
        all
    }

    fn variant(&self, analysis: &RigAnalysis, seed: u64) -> Variant {
        let mut random = Random::new(1000 + seed);
        let mut changes_made = Vec::new();
        let mut rig = self.rig.clone();
        let mut hints = Hints::default();
        let mut chance = |random: &mut Random, what: &str| {
            let does = random.unit() < 0.5;
            does.then(|| changes_made.push(what.to_owned()));
            does
        };
        if chance(&mut random, "twist bones") {
            rig = with_twists(&rig, analysis);
        }
        // Only a rig with a head gets attachments: those of a creature may be parts of its body.
        let head = analysis.joint_with(Role::Head);
        if let Some(head) = head.filter(|_| chance(&mut random, "hair")) {
            rig = with_hair(&rig, analysis, head, &mut random);
        }
        let hips = analysis.joint_with(Role::Hips);
        if let Some(hips) = hips.filter(|_| chance(&mut random, "a second bone of the pelvis")) {
            rig = with_halves(&rig, hips, "pelvis.L");
        }
        if chance(&mut random, "controls") {
            rig = with_controls(&rig, analysis, &mut random);
        }
        let convention = usize::try_from(seed).expect("the count fits") % CONVENTIONS.len();
        // A clip fits only one hierarchy, unit and choice of axes.
        if !self.clips.is_empty() && chance(&mut random, "shifted clips") {
            let size = analysis.height / analysis.unit_scale;
            let clips = shifted(&self.clips, &self.rig, random.in_cube() * (5.0 * size));
            hints = Hints::of_clips(&rig, &clips);
        } else {
            rig = self.reparented(rig, analysis, convention, &mut random, &mut chance);
        }
        if let Some(head) = head.filter(|_| chance(&mut random, "a hat")) {
            rig = with_hat(&rig, analysis, head);
        } else if let Some(head) = head.filter(|_| chance(&mut random, "eyes beside the skeleton")) {
            rig = with_eyes(&rig, analysis, head);
        }
        if chance(&mut random, "binds of another unit") {
            rig = bound_in(&rig, [100.0, 0.01, -1.0][random.index(3)]);
        }
        if chance(&mut random, "two skins") {
            rig = with_two_skins(&rig, [100.0, 0.01, -1.0][random.index(3)]);
        }
        let has_clips = hints != Hints::default();
        if !has_clips && chance(&mut random, "other unit and axes") {
            let turn = [Rotation::IDENTITY, z_up()][random.index(2)];
            rig = transformed(&rig, [0.01, 1.0, 100.0][random.index(3)], turn);
        }
        let is_mirrored = !has_clips && chance(&mut random, "a mirror above it");
        rig = renamed(&rig, analysis, &CONVENTIONS[convention]);
        if is_mirrored {
            rig = under_a_mirror(&rig);
        }
        let (prefix, suffix) =
            (PREFIXES[random.index(PREFIXES.len())], SUFFIXES[random.index(SUFFIXES.len())]);
        rig = affixed(&rig, prefix, suffix);
        changes_made.push(format!("convention {convention}, '{prefix}' and '{suffix}'"));
        let (rig, place) = if has_clips {
            let same = (0..rig.joints.len()).collect();
            (rig, same)
        } else {
            shuffled(&rig, seed)
        };
        let first = usize::from(is_mirrored);
        Variant { rig, hints, place: place[first..].to_vec(), changes_made: changes_made.join(", ") }
    }

    /// Makes feet children of the root, limbs roots, or leaves beginnings of limbs without skin.
    fn reparented(
        &self,
        mut rig: Rig,
        analysis: &RigAnalysis,
        convention: usize,
        random: &mut Random,
        chance: &mut impl FnMut(&mut Random, &str) -> bool,
    ) -> Rig {
        if chance(random, "feet on the root") {
            rig = parented_to_root(&rig, &feet(&rig, analysis));
        }
        if analysis.humanoid && chance(random, "limbs that are roots") {
            // Names are needed to connect these limbs again.
            rig = made_roots(&renamed(&rig, analysis, &CONVENTIONS[convention]), &limbs(analysis));
        } else if analysis.humanoid && chance(random, "beginnings of limbs without skin") {
            let named = renamed(&rig, analysis, &CONVENTIONS[convention]);
            rig = unweighted(&named, &limb_roots(analysis, random));
        }
        rig
    }
}

/// Returns the differences between two ragdolls; empty if the bodies match those of the plain rig, with equal masses.
fn differences(plain: &RagdollDef, other: &RagdollDef, place: &[usize]) -> Vec<String> {
    let mut found = Vec::new();
    for a in &plain.bodies {
        let Some(b) = other.bodies.iter().find(|body| body.joint == place[a.joint]) else {
            found.push(format!("no body of {}", a.role));
            continue;
        };
        if a.role != b.role {
            found.push(format!("{} became {}", a.role, b.role));
        }
        let (m, n) = (a.mass.mass, b.mass.mass);
        if (m - n).abs() > 0.02 * m {
            found.push(format!("{}: {m} and {n} kg", a.role));
        }
    }
    let is_known = |joint: usize| plain.bodies.iter().any(|body| place[body.joint] == joint);
    let added = other.bodies.iter().filter(|body| !is_known(body.joint));
    found.extend(added.map(|body| format!("a body of {} ({})", body.role, body.bone)));
    let parent = |def: &RagdollDef, body: usize| {
        def.joints.iter().find(|joint| joint.child == body).map(|joint| joint.parent)
    };
    if found.is_empty() {
        for (body, a) in plain.bodies.iter().enumerate() {
            let twin = other.bodies.iter().position(|b| b.joint == place[a.joint]).expect("seen above");
            let [on, twin_on] = [
                parent(plain, body).map(|on| plain.bodies[on].role.clone()),
                parent(other, twin).map(|on| other.bodies[on].role.clone()),
            ];
            if on != twin_on {
                found.push(format!("{} is attached to {twin_on:?}, not {on:?}", a.role));
            }
        }
    }
    found
}

/// Returns the flaws of the variants of a rig, one line each.
fn flaws(number: u64, subject: &Subject, count: u64) -> Vec<String> {
    let name = subject.name;
    let analysis = analyze(&subject.rig).expect("the rig has a skin");
    let (plain, _) = built(&subject.rig, &BuildOptions::default());
    let mut falls = Falls::of(&plain);
    let mut wrong = Vec::new();
    // Each rig has different seeds, so that the rigs together cover more.
    let first = number * count % ALL;
    for seed in (first..first + count).map(|seed| seed % ALL) {
        let Variant { rig, hints, place, changes_made } = subject.variant(&analysis, seed);
        let what = format!("{name}, variant {seed} ({changes_made})");
        let seen = analyze_hinted(&rig, &hints).expect("the rig has a skin");
        let (def, _) = build(&rig, &seen, &BuildOptions::default()).expect("the ragdoll can be built");
        check_sound(&what, &def);
        let differences = differences(&plain, &def, &place);
        let flaw =
            if differences.is_empty() { falls.worse(&plain, &def) } else { Some(differences.join(", ")) };
        println!("{what}: {}", flaw.as_deref().unwrap_or("the same"));
        wrong.extend(flaw.map(|flaw| format!("{what}: {flaw}")));
    }
    wrong
}

#[test]
fn variants_of_a_rig_give_the_same_ragdoll() {
    let count = if std::env::var_os("SINEW_FULL").is_some() { ALL } else { FEW };
    let subjects = Subject::all();
    let wrong: Vec<String> =
        subjects.iter().zip(0..).flat_map(|(subject, number)| flaws(number, subject, count)).collect();
    assert!(wrong.is_empty(), "{} variants differ:\n{}", wrong.len(), wrong.join("\n"));
}
