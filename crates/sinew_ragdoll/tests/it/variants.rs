//! A rig in many variants, as exporters, riggers and stores make them: one ragdoll.

use crate::build::{built, check_sound};
use crate::data::rig;
use crate::disguise::{
    CONVENTIONS, affixed, bound_in, cut_loose, hung_on_root, renamed, shuffled, transformed, with_controls,
    with_hair, with_hat, with_twists, with_two_skins, z_up,
};
use crate::rig_variants::Falls;
use sinew_anim::{JointIdx, Rig, RigAnalysis, Role, Side, analyze};
use sinew_math::{Random, Rotation};
use sinew_ragdoll::{BuildOptions, RagdollDef};

/// People, stylised ones, animals, eight legs.
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

/// Variants of each rig when all is asked for; else a few.
const ALL: u64 = 60;
const FEW: u64 = 1;

const PREFIXES: [&str; 6] = ["", "Armature|", "hero_", "rig:", "GLB_", "Char01."];
const SUFFIXES: [&str; 4] = ["", "_jnt", ".001", "_050"];

/// Feet that may be hung on the root.
fn feet(rig: &Rig, analysis: &RigAnalysis) -> Vec<JointIdx> {
    let of = |side| analysis.joint_with(Role::Foot(side));
    if analysis.humanoid {
        return [Side::Left, Side::Right].into_iter().filter_map(of).collect();
    }
    // A creature's: where a body ends a limb, unless its feet are on the root already.
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

/// Thighs and upper arms, or the clavicles that carry these.
fn limbs(analysis: &RigAnalysis) -> Vec<JointIdx> {
    let of = |side: Side| {
        let arm = [Role::Shoulder(side), Role::UpperArm(side)].map(|role| analysis.joint_with(role));
        [analysis.joint_with(Role::UpperLeg(side)), arm[0].or(arm[1])]
    };
    [Side::Left, Side::Right].into_iter().flat_map(of).flatten().collect()
}

/// A variant, where each joint went, and what was done in words.
fn variant(rig: &Rig, analysis: &RigAnalysis, seed: u64) -> (Rig, Vec<usize>, String) {
    let mut random = Random::new(1000 + seed);
    let mut said = Vec::new();
    let mut rig = rig.clone();
    let mut chance = |random: &mut Random, what: &str| {
        let does = random.unit() < 0.5;
        does.then(|| said.push(what.to_owned()));
        does
    };
    if chance(&mut random, "twist bones") {
        rig = with_twists(&rig, analysis);
    }
    // Only on who has a head: what grows on a creature may well be a part of it.
    let head = analysis.joint_with(Role::Head);
    if let Some(head) = head.filter(|_| chance(&mut random, "hair")) {
        rig = with_hair(&rig, analysis, head, &mut random);
    }
    if chance(&mut random, "controls") {
        rig = with_controls(&rig, analysis, &mut random);
    }
    if chance(&mut random, "feet on the root") {
        rig = hung_on_root(&rig, &feet(&rig, analysis));
    }
    let convention = usize::try_from(seed).expect("few") % CONVENTIONS.len();
    if analysis.humanoid && chance(&mut random, "limbs that are roots") {
        // Names put them together again.
        rig = cut_loose(&renamed(&rig, analysis, &CONVENTIONS[convention]), &limbs(analysis));
    }
    if let Some(head) = head.filter(|_| chance(&mut random, "a hat")) {
        rig = with_hat(&rig, analysis, head);
    }
    if chance(&mut random, "binds of another unit") {
        rig = bound_in(&rig, [100.0, 0.01, -1.0][random.index(3)]);
    }
    if chance(&mut random, "two skins") {
        rig = with_two_skins(&rig, [100.0, 0.01, -1.0][random.index(3)]);
    }
    if chance(&mut random, "other unit and axes") {
        let turn = [Rotation::IDENTITY, z_up()][random.index(2)];
        rig = transformed(&rig, [0.01, 1.0, 100.0][random.index(3)], turn);
    }
    rig = renamed(&rig, analysis, &CONVENTIONS[convention]);
    let (prefix, suffix) = (PREFIXES[random.index(PREFIXES.len())], SUFFIXES[random.index(SUFFIXES.len())]);
    rig = affixed(&rig, prefix, suffix);
    said.push(format!("convention {convention}, '{prefix}' and '{suffix}'"));
    let (rig, place) = shuffled(&rig, seed);
    (rig, place, said.join(", "))
}

/// Differences between two ragdolls; empty if the bodies are those of the plain rig and as heavy.
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
                found.push(format!("{} hangs on {twin_on:?}, not {on:?}", a.role));
            }
        }
    }
    found
}

#[test]
fn a_rig_in_many_variants_is_one_ragdoll() {
    let count = if std::env::var_os("SINEW_FULL").is_some() { ALL } else { FEW };
    let mut wrong = Vec::new();
    for (number, name) in RIGS.into_iter().enumerate() {
        let Some(rig) = rig(name) else { return };
        let analysis = analyze(&rig).expect("a skin");
        let (plain, _) = built(&rig, &BuildOptions::default());
        let mut falls = Falls::of(&plain);
        // Not the same seeds of all rigs, so that a few of each are many.
        let first = number as u64 * FEW;
        for seed in (first..first + count).map(|seed| seed % ALL) {
            let (other, place, said) = variant(&rig, &analysis, seed);
            let what = format!("{name}, variant {seed} ({said})");
            let (def, _) = built(&other, &BuildOptions::default());
            check_sound(&what, &def);
            let differences = differences(&plain, &def, &place);
            let flaw =
                if differences.is_empty() { falls.worse(&plain, &def) } else { Some(differences.join(", ")) };
            println!("{what}: {}", flaw.as_deref().unwrap_or("the same"));
            wrong.extend(flaw.map(|flaw| format!("{what}: {flaw}")));
        }
    }
    assert!(wrong.is_empty(), "{} variants are others:\n{}", wrong.len(), wrong.join("\n"));
}
