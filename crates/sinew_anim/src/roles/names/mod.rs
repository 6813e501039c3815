//! Meanings of joint names. Names are evidence only: see [`super::humanoid`].

mod lexicon;
mod tokens;

use super::role::Side;
use lexicon::Word;
use tokens::{Token, tokens};

pub(crate) use tokens::words;

/// Body part given by a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Hips,
    Spine,
    Neck,
    Head,
    Clavicle,
    UpperArm,
    LowerArm,
    Hand,
    UpperLeg,
    LowerLeg,
    Foot,
    Toes,
    Tail,
    /// A limb of a quadruped, which humans lack.
    Beast,
    /// A joint that never has a body: twist and IK joints, ends, sockets, fingers, face.
    Appendix,
}

/// A parsed name.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Reading {
    /// Name without prefixes, numbers and side; equal for both joints of a mirrored pair.
    pub key: String,
    /// Side in the name.
    pub side: Option<Side>,
    /// Body part, if the name gives a known one.
    pub part: Option<Part>,
    /// True if the name contains a word for wing.
    pub is_wing: bool,
    /// True if the name is only "root". If no joint of the rig is named hips, a root that moves skin is the hips.
    pub is_root: bool,
    /// True if the joint is an appendix only because its name contains a word for a control, such as "IK".
    pub is_control: bool,
}

/// Parses all names of a rig and resolves words that depend on other names. `parents` has the parent of every joint, or
/// is empty if only names are known.
pub(super) fn read_names(names: &[&str], parents: &[Option<usize>]) -> Vec<Reading> {
    let (mut readings, senses): (Vec<Reading>, Vec<Option<Sense>>) =
        tokens(names).iter().map(|t| read(t)).unzip();
    let has = |wanted: &[Sense]| senses.iter().flatten().any(|sense| wanted.contains(sense));
    let upper_arm = has(&[Sense::Arm, Sense::Part(Part::UpperArm)]);
    let thigh = has(&[Sense::Part(Part::UpperLeg)]);
    let shank = has(&[Sense::Part(Part::LowerLeg)]);
    // The parts must be of the same side: a mesh beside the skeleton may be called a wrist, too.
    let sides_with = |wanted: Sense| {
        [Side::Left, Side::Right].map(|side| {
            (0..senses.len()).any(|i| senses[i] == Some(wanted) && readings[i].side == Some(side))
        })
    };
    let (wrists, ankles) = (sides_with(Sense::Wrist), sides_with(Sense::Ankle));
    let on_side = |sides: [bool; 2], side: Option<Side>| side.is_some_and(|side| sides[side as usize]);
    let alone = |sense: Sense, side: Option<Side>| {
        (0..senses.len()).filter(|&i| senses[i] == Some(sense) && readings[i].side == side).count() == 1
    };
    let one_leg = [Side::Left, Side::Right].into_iter().all(|side| alone(Sense::Leg, Some(side)));
    for (reading, sense) in readings.iter_mut().zip(&senses) {
        let sided = reading.side.is_some();
        reading.part = match sense {
            None => None,
            // Clavicle in Mixamo, VRM and CMU, humerus in SMPL and Daz.
            Some(Sense::Shoulder) if upper_arm => Some(Part::Clavicle),
            Some(Sense::Shoulder | Sense::Arm) => Some(Part::UpperArm),
            // SMPL's hip joint is the thigh; CMU's hip joint is only above it. Rigify has a pelvis on each side.
            Some(Sense::Hip) if sided && !thigh => Some(Part::UpperLeg),
            Some(Sense::Hip | Sense::Pelvis) if sided => Some(Part::Appendix),
            Some(Sense::Hip | Sense::Pelvis) => Some(Part::Hips),
            // Shank in Mixamo; thigh in MMD and rigs with only one such name; the whole leg in some rigs.
            Some(Sense::LegOrFoot) if thigh && shank => Some(Part::Foot),
            Some(Sense::Leg | Sense::LegOrFoot) if thigh => Some(Part::LowerLeg),
            Some(Sense::Leg | Sense::LegOrFoot) if shank || one_leg => Some(Part::UpperLeg),
            Some(Sense::Leg | Sense::LegOrFoot) => None,
            Some(Sense::Hand) => {
                Some(if on_side(wrists, reading.side) { Part::Appendix } else { Part::Hand })
            }
            Some(Sense::Wrist) => Some(Part::Hand),
            Some(Sense::Foot) => Some(if on_side(ankles, reading.side) { Part::Toes } else { Part::Foot }),
            Some(Sense::Ankle) => Some(Part::Foot),
            Some(Sense::Hub) => None,
            Some(Sense::Part(Part::Spine | Part::Neck | Part::Head)) if sided => None,
            Some(Sense::Part(part)) => Some(*part),
        };
    }
    if parents.len() == readings.len() {
        name_ball(&mut readings, parents);
        name_lower_arms(&mut readings, &senses, parents);
        // Only CAT rigs have hubs.
        if senses.iter().filter(|&&sense| sense == Some(Sense::Hub)).count() > 1 {
            name_halves(&mut readings, &senses, parents);
            name_hubs(&mut readings, &senses, parents);
        }
    }
    readings
}

/// True if joint `above` is an ancestor of `joint`.
fn carries(parents: &[Option<usize>], above: usize, joint: usize) -> bool {
    core::iter::successors(parents[joint], |&at| parents[at]).any(|at| at == above)
}

/// Reads two joints in line that are only named leg, or arm, as the two halves of the limb ("LLeg1", "LLeg2"). A
/// quadruped's limbs may be named so, too.
fn name_halves(readings: &mut [Reading], senses: &[Option<Sense>], parents: &[Option<usize>]) {
    let limbs =
        [(Sense::Leg, [Part::UpperLeg, Part::LowerLeg]), (Sense::Arm, [Part::UpperArm, Part::LowerArm])];
    for (sense, halves) in limbs {
        if senses.iter().flatten().any(|other| halves.iter().any(|&half| *other == Sense::Part(half))) {
            continue;
        }
        for side in [Side::Left, Side::Right] {
            let is = |&joint: &usize| senses[joint] == Some(sense) && readings[joint].side == Some(side);
            let own: Vec<usize> = (0..senses.len()).filter(is).collect();
            let (upper, lower) = match *own.as_slice() {
                [a, b] if carries(parents, a, b) => (a, b),
                [a, b] if carries(parents, b, a) => (b, a),
                _ => continue,
            };
            (readings[upper].part, readings[lower].part) = (Some(halves[0]), Some(halves[1]));
        }
    }
}

/// Reads the lowest of several hubs in line as hips, the highest as head, those between as spine.
fn name_hubs(readings: &mut [Reading], senses: &[Option<Sense>], parents: &[Option<usize>]) {
    let hubs: Vec<usize> = (0..senses.len()).filter(|&joint| senses[joint] == Some(Sense::Hub)).collect();
    for &hub in &hubs {
        let is_carried = hubs.iter().any(|&other| carries(parents, other, hub));
        let is_last = !hubs.iter().any(|&other| carries(parents, hub, other));
        readings[hub].part = match (is_carried, is_last) {
            (false, false) => Some(Part::Hips),
            (true, true) => Some(Part::Head),
            (true, false) => Some(Part::Spine),
            (false, true) => None,
        };
    }
}

/// Reads a joint that is only named arm, below an upper arm of its side, as the lower arm if no joint has that name.
fn name_lower_arms(readings: &mut [Reading], senses: &[Option<Sense>], parents: &[Option<usize>]) {
    if senses.contains(&Some(Sense::Part(Part::LowerArm))) {
        return;
    }
    for joint in 0..readings.len() {
        let side = readings[joint].side;
        let is_upper = |&above: &usize| {
            senses[above] == Some(Sense::Part(Part::UpperArm)) && readings[above].side == side
        };
        let above = core::iter::successors(parents[joint], |&at| parents[at]).find(is_upper);
        if senses[joint] == Some(Sense::Arm) && side.is_some() && above.is_some() {
            readings[joint].part = Some(Part::LowerArm);
        }
    }
}

/// Reads a foot below a foot as its ball if no joint is named toes.
fn name_ball(readings: &mut [Reading], parents: &[Option<usize>]) {
    if readings.iter().any(|reading| reading.part == Some(Part::Toes)) {
        return;
    }
    let is_foot = |readings: &[Reading], joint: usize| readings[joint].part == Some(Part::Foot);
    let balls: Vec<usize> = (0..readings.len())
        .filter(|&joint| {
            let under = parents[joint].filter(|&parent| is_foot(readings, parent));
            is_foot(readings, joint)
                && under.is_some_and(|parent| readings[parent].side == readings[joint].side)
        })
        .collect();
    balls.into_iter().for_each(|joint| readings[joint].part = Some(Part::Toes));
}

/// Resolves parts that several skinned joints of one side claim; `depth` returns the number of joints above a skinned
/// joint. If the rig names all four long limb parts, one joint is the part and the others continue it (Rigify's
/// "upper_arm.L.001"); otherwise the name has no meaning (CesiumMan names all joints of its arm "arm").
pub(super) fn settle_duplicates(
    readings: &mut [Reading],
    names: &[&str],
    depth: impl Fn(usize) -> Option<usize>,
) {
    use Part::{LowerArm, LowerLeg, UpperArm, UpperLeg};
    let names_all = [UpperArm, LowerArm, UpperLeg, LowerLeg]
        .into_iter()
        .all(|part| readings.iter().any(|reading| reading.part == Some(part)));
    let claims: Vec<(Option<Part>, Option<Side>)> =
        readings.iter().enumerate().map(|(i, r)| (r.part.filter(|_| depth(i).is_some()), r.side)).collect();
    for i in 0..claims.len() {
        let claim = claims[i];
        let many =
            Some(Part::Neck) == claim.0 && readings.iter().any(|reading| reading.part == Some(Part::Head));
        if many || matches!(claim.0, None | Some(Part::Spine | Part::Tail | Part::Beast | Part::Appendix)) {
            continue;
        }
        // Counts each claim once, at the first joint that makes it.
        if claims[..i].contains(&claim) {
            continue;
        }
        let same: Vec<usize> = (i..claims.len()).filter(|&other| claims[other] == claim).collect();
        if same.len() == 1 {
            continue;
        }
        let chosen = chosen_index(same.clone(), names, &depth).filter(|_| names_all);
        for joint in same.into_iter().filter(|&joint| Some(joint) != chosen) {
            readings[joint].part = names_all.then_some(Part::Appendix);
        }
    }
}

/// Swaps the upper and the lower bone of limbs that are named in the wrong order ('Elbow' above 'Arm'), because a
/// limb's upper bone carries its lower one.
pub(super) fn settle_limbs(readings: &mut [Reading], parents: &[Option<usize>]) {
    for (upper, lower) in [(Part::UpperArm, Part::LowerArm), (Part::UpperLeg, Part::LowerLeg)] {
        for side in [Side::Left, Side::Right] {
            let with = |part: Part| {
                let mut of_part = (0..readings.len())
                    .filter(|&at| readings[at].part == Some(part) && readings[at].side == Some(side));
                of_part.next().filter(|_| of_part.next().is_none())
            };
            let (Some(above), Some(below)) = (with(upper), with(lower)) else { continue };
            if carries(parents, below, above) {
                (readings[above].part, readings[below].part) = (Some(lower), Some(upper));
            }
        }
    }
}

/// Finds the skinned joint at which the trunk begins and reads it as hips. Such a joint is not named hips but carries
/// the thighs and the rest of the trunk. No part of the spine is above the hips.
pub(super) fn settle_trunk(
    readings: &mut [Reading],
    parents: &[Option<usize>],
    moves_skin: impl Fn(usize) -> bool,
) {
    let up = |joint: usize| core::iter::successors(Some(joint), |&at| parents[at]);
    let with = |part: Part, side: Option<Side>| {
        let named = |reading: &Reading| reading.part == Some(part) && reading.side == side;
        readings.iter().position(named)
    };
    let is_hips = |i: &usize| readings[*i].part == Some(Part::Hips) && moves_skin(*i);
    let hips = (0..readings.len()).find(is_hips).or_else(|| {
        let thighs = [Side::Left, Side::Right].map(|side| with(Part::UpperLeg, Some(side)));
        let [Some(left), Some(right)] = thighs else { return None };
        // Auto-Rig Pro names the pelvis "root".
        if let Some(root) = (0..readings.len()).find(|&at| readings[at].is_root && moves_skin(at)) {
            return Some(root);
        }
        let top = with(Part::Head, None).or(with(Part::Neck, None))?;
        let fork = up(top).find(|&at| [left, right].into_iter().all(|thigh| up(thigh).any(|i| i == at)))?;
        // If the fork joint has no skin, its child toward the head is the pelvis.
        let mut trunk: Vec<usize> = up(top).take_while(|&at| at != fork).collect();
        trunk.push(fork);
        let lowest = trunk.into_iter().rev().find(|&at| moves_skin(at))?;
        let is_spine = |at: usize| readings[at].part == Some(Part::Spine);
        if readings[lowest].part.is_none() || is_spine(lowest) {
            return Some(lowest);
        }
        // No joint between the legs and the neck moves skin: the trunk's bones are a separate branch, moved by
        // constraints.
        let on_bare = |at: usize| up(at).skip(1).all(|above| !is_spine(above) || !moves_skin(above));
        (0..readings.len()).find(|&at| is_spine(at) && moves_skin(at) && on_bare(at))
    });
    let Some(hips) = hips else { return };
    for above in up(hips).skip(1) {
        if readings[above].part == Some(Part::Spine) {
            readings[above].part = Some(Part::Appendix);
        }
    }
    readings[hips].part = Some(Part::Hips);
}

/// Returns the joint to use among several of one name, independently of the file order: the nearest to the root; of
/// siblings, the middle one by name (of three palms the second, of two the first).
fn chosen_index(
    mut same: Vec<usize>,
    names: &[&str],
    depth: &impl Fn(usize) -> Option<usize>,
) -> Option<usize> {
    let least = same.iter().filter_map(|&joint| depth(joint)).min()?;
    same.retain(|&joint| depth(joint) == Some(least));
    same.sort_by_key(|&joint| names[joint]);
    same.get((same.len() - 1) / 2).copied()
}

/// Meaning of a single name; for some words it depends on the rest of the rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sense {
    Part(Part),
    Shoulder,
    Arm,
    Hip,
    Pelvis,
    Leg,
    LegOrFoot,
    Hand,
    Wrist,
    Foot,
    Ankle,
    Hub,
}

fn read(tokens: &[Token]) -> (Reading, Option<Sense>) {
    let mut reading = Reading::default();
    let (mut words, mut unknown) = (Vec::new(), false);
    for token in tokens {
        let Some(said) = &token.words else {
            unknown = true;
            reading.key.push_str(&token.text);
            continue;
        };
        for word in said {
            match word {
                Word::Noise => {}
                // If a name has two sides, the last one counts (Blender's ".L"), because the first is only a letter.
                Word::Side(side) => unknown |= reading.side.replace(*side).is_some(),
                _ => words.push(*word),
            }
        }
    }
    reading.is_root = words.is_empty() && reading.side.is_none() && reading.key == "root";
    reading.key.push_str(&key(&words));
    reading.is_wing = words.contains(&Word::Wing);
    let is_appendix = words.contains(&Word::Appendix);
    reading.is_control = !is_appendix && words.contains(&Word::Control);
    let sense =
        if is_appendix || reading.is_control { Some(Sense::Part(Part::Appendix)) } else { sense(&words) };
    let sense = sense.filter(|sense| !unknown || *sense == Sense::Part(Part::Appendix));
    reading.part = None;
    (reading, sense)
}

/// Joins words to a text that is equal for both joints of a mirrored pair.
fn key(words: &[Word]) -> String {
    words.iter().map(|word| format!("{word:?}")).collect()
}

/// Returns the meaning of a combination of known words. Their order matters only in a few cases.
fn sense(words: &[Word]) -> Option<Sense> {
    use Word::{Arm, Back, Body, Fore, Front, Leg, Lower, Mid, Paw, Twist, Upper};
    let has = |word: Word| words.contains(&word);
    let is_level = |word: &Word| matches!(word, Upper | Lower | Mid | Fore | Twist | Front | Back);
    let mut rest: Vec<Word> = words.iter().copied().filter(|word| !is_level(word)).collect();
    rest.dedup();
    let level = |upper: Part, lower: Part, plain: Option<Sense>| {
        if has(Upper) {
            Some(Sense::Part(upper))
        } else if has(Lower) {
            Some(Sense::Part(lower))
        } else {
            plain
        }
    };
    let of_limb = |word: &Word| {
        use Word::{Ankle, Foot, Hand, LegOrFoot, LowerArm, LowerLeg, Shoulder, UpperArm, UpperLeg, Wrist};
        let arm = matches!(word, Arm | UpperArm | LowerArm | Hand | Wrist | Shoulder);
        arm || matches!(word, Leg | LegOrFoot | UpperLeg | LowerLeg | Foot | Ankle | Word::Hip | Word::Toes)
    };
    let before_limb = |word: Word| {
        let limb = words.iter().position(of_limb);
        words.iter().position(|&w| w == word).is_some_and(|at| limb.is_some_and(|limb| at < limb))
    };
    if has(Paw)
        || has(Word::Wing)
        || before_limb(Front)
        || before_limb(Back)
        || has(Fore) && rest.contains(&Leg)
    {
        return Some(Sense::Part(Part::Beast));
    }
    if has(Front) {
        return None;
    }
    let found = match *rest.as_slice() {
        [] if has(Back) => level(Part::Spine, Part::Spine, None),
        [Arm] if has(Fore) => Some(Sense::Part(Part::LowerArm)),
        [Arm] => level(Part::UpperArm, Part::LowerArm, Some(Sense::Arm)),
        [Leg] => level(Part::UpperLeg, Part::LowerLeg, Some(Sense::Leg)),
        [Body] if has(Upper) => Some(Sense::Part(Part::Spine)),
        [Body] if has(Lower) => Some(Sense::Pelvis),
        [Body] | [] => None,
        [Word::Spine, ..] => Some(Sense::Part(Part::Spine)),
        [one] => plain(one),
        [Word::Shoulder, Word::Clavicle] | [Word::Clavicle, Word::Shoulder] => plain(Word::Clavicle),
        [Arm, last @ (Word::Hand | Word::Wrist | Word::Clavicle)]
        | [Leg, last @ (Word::Foot | Word::Ankle)] => plain(last),
        [Word::Hand, Word::Wrist] | [Word::Wrist, Word::Hand] => plain(Word::Wrist),
        [Word::Foot, Word::Ankle] | [Word::Ankle, Word::Foot] => plain(Word::Ankle),
        [Word::Foot, Word::Toes] | [Word::Toes, Word::Foot] => plain(Word::Toes),
        _ => None,
    }?;
    let trunk = matches!(found, Sense::Part(Part::Neck | Part::Spine | Part::Head));
    if has(Mid) && !trunk {
        return None;
    }
    if has(Twist) && !trunk { Some(Sense::Part(Part::Appendix)) } else { Some(found) }
}

/// Returns the meaning of a single word.
fn plain(word: Word) -> Option<Sense> {
    Some(match word {
        Word::Pelvis => Sense::Pelvis,
        Word::Hip => Sense::Hip,
        Word::Spine => Sense::Part(Part::Spine),
        Word::Neck => Sense::Part(Part::Neck),
        Word::Head => Sense::Part(Part::Head),
        Word::Shoulder => Sense::Shoulder,
        Word::Clavicle => Sense::Part(Part::Clavicle),
        Word::UpperArm => Sense::Part(Part::UpperArm),
        Word::LowerArm => Sense::Part(Part::LowerArm),
        Word::Hand => Sense::Hand,
        Word::Wrist => Sense::Wrist,
        Word::UpperLeg => Sense::Part(Part::UpperLeg),
        Word::LowerLeg => Sense::Part(Part::LowerLeg),
        Word::LegOrFoot => Sense::LegOrFoot,
        Word::Foot => Sense::Foot,
        Word::Ankle => Sense::Ankle,
        Word::Hub => Sense::Hub,
        Word::Toes => Sense::Part(Part::Toes),
        Word::Tail => Sense::Part(Part::Tail),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(names: &[&str], expected: &[(Option<Part>, Option<Side>)]) {
        let got: Vec<_> = read_names(names, &[]).into_iter().map(|r| (r.part, r.side)).collect();
        assert_eq!(got, expected, "{names:?}");
    }

    #[test]
    fn a_bone_named_elbow_above_one_named_arm_is_the_upper_arm() {
        let names = ["Shoulder.L", "Elbow.L", "Arm.L", "Hand.L", "UpperLeg.L", "LowerLeg.L"];
        let parents = [None, Some(0), Some(1), Some(2), None, Some(4)];
        let mut readings = read_names(&names, &parents);
        settle_limbs(&mut readings, &parents);
        use Part::*;
        let expected = [Clavicle, UpperArm, LowerArm, Hand, UpperLeg, LowerLeg].map(Some);
        let found: Vec<Option<Part>> = readings.into_iter().map(|reading| reading.part).collect();
        assert_eq!(found, expected);
    }

    /// A CAT rig: hubs, and limbs of two bones with one name.
    #[test]
    fn hubs_and_numbered_halves_of_limbs_are_read() {
        let names = [
            "CATRigHub004",
            "CATRigLLeg003",
            "CATRigLLeg004",
            "CATRigLLegAnkle001",
            "CATRigSpine011",
            "CATRigHub005",
            "CATRigRArmCollarbone001",
            "CATRigRArm004",
            "CATRigRArm003",
            "CATRigRArmPalm001",
            "CATRigHub006",
        ];
        let parents =
            [None, Some(0), Some(1), Some(2), Some(0), Some(4), Some(5), Some(6), Some(7), Some(8), Some(5)];
        use Part::*;
        let expected =
            [Hips, UpperLeg, LowerLeg, Foot, Spine, Spine, Clavicle, UpperArm, LowerArm, Hand, Head];
        let found: Vec<Option<Part>> =
            read_names(&names, &parents).into_iter().map(|reading| reading.part).collect();
        assert_eq!(found, expected.map(Some));
    }

    #[test]
    fn common_naming_conventions_are_read() {
        use Part::*;
        let (l, r) = (Some(Side::Left), Some(Side::Right));
        let names =
            ["mixamorig:LeftArm", "mixamorig5:RightUpLeg", "mixamorig:LeftLeg", "mixamorig:LeftShoulder"];
        check(&names, &[(Some(UpperArm), l), (Some(UpperLeg), r), (Some(LowerLeg), l), (Some(Clavicle), l)]);
        let names = ["DEF-upper_arm.L.001", "DEF-shin.R", "DEF-f_index.01.L", "DEF-spine.003"];
        check(&names, &[(Some(UpperArm), l), (Some(LowerLeg), r), (Some(Appendix), l), (Some(Spine), None)]);
        let names = ["Bip01 L UpperArm", "ValveBiped.Bip01_R_Calf", "CC_Base_L_Thigh", "J_Bip_C_Hips"];
        check(&names, &[(Some(UpperArm), l), (Some(LowerLeg), r), (Some(UpperLeg), l), (Some(Hips), None)]);
        let names = ["upperarm.l", "wrist.l", "hand.l", "control-toe-roll.l", "kneeIK.r"];
        check(
            &names,
            &[
                (Some(UpperArm), l),
                (Some(Hand), l),
                (Some(Appendix), l),
                (Some(Appendix), l),
                (Some(Appendix), r),
            ],
        );
    }

    /// Checks body parts in the languages of asset stores, on both sides, in any case.
    #[test]
    fn names_are_read_in_other_languages_and_any_case() {
        use Part::*;
        let (l, r) = (Some(Side::Left), Some(Side::Right));
        let wanted = [
            (Some(Hips), None),
            (Some(Neck), None),
            (Some(UpperLeg), l),
            (Some(LowerLeg), r),
            (Some(Foot), l),
        ];
        let languages = [
            ["Cadera", "Cuello", "Muslo_izq", "Pantorrilla_der", "Pie_izq"],
            ["Bassin", "Cou", "Cuisse_gauche", "Mollet_droit", "Pied_gauche"],
            ["Bacino", "Collo", "Coscia.sx", "Polpaccio.dx", "Piede.sx"],
            ["Quadril", "Pescoco", "CoxaEsq", "PanturrilhaDireita", "Pie_esq"],
            ["Becken", "Hals", "Oberschenkel_links", "Unterschenkel_rechts", "Fuss_links"],
            ["Таз", "Шея", "Бедро_Л", "Голень_П", "Стопа_Л"],
            ["골반", "목", "왼쪽허벅지", "오른쪽종아리", "왼쪽발"],
            ["kuabu", "bozi", "datui_zuo", "xiaotui_you", "jiao_zuo"],
            ["Bassin", "Cou", "Cuisse_G", "Mollet.D", "PiedGauche"],
            ["Miednica", "Szyja", "Udo_lewe", "Lydka_prawa", "Stopa_lewa"],
            ["kalca", "boyun", "uyluk_sol", "baldir_sag", "ayak_sol"],
            ["bekken", "nek", "bovenbeen_l", "scheenbeen_r", "voet_l"],
            ["panev", "krk", "stehno_levy", "lytko_pravy", "chodidlo_levy"],
            ["hIPs", "NecK", "uPPerLEG.l", "LOWERleg.R", "fOOt.L"],
        ];
        for names in languages {
            check(&names, &wanted);
        }
    }

    #[test]
    fn arms_in_other_languages() {
        use Part::*;
        let l = Some(Side::Left);
        let languages = [
            ["Epaule_G", "Bras_G", "Avant-Bras_G", "Main_G", "Bras_D"],
            ["Hombro_izq", "Brazo_izq", "Antebrazo_izq", "Mano_izq", "Brazo_der"],
            ["Schulter.L", "Oberarm.L", "Unterarm.L", "Hand.L", "Oberarm.R"],
            ["Spalla_sx", "Braccio_sx", "Avambraccio_sx", "Mano_sx", "Braccio_dx"],
            ["ombro_esq", "braco_esq", "antebraco_esq", "mao_esq", "braco_dir"],
        ];
        for names in languages {
            let parts = [Some(Clavicle), Some(UpperArm), Some(LowerArm), Some(Hand)];
            let got: Vec<_> = read_names(&names, &[]).into_iter().map(|r| (r.part, r.side)).collect();
            assert_eq!(got[..4], parts.map(|part| (part, l)), "{names:?}");
        }
    }

    #[test]
    fn word_meaning_depends_on_the_other_names() {
        use Part::*;
        let (l, r) = (Some(Side::Left), Some(Side::Right));
        let smpl = [
            "Pelvis",
            "L_Hip",
            "L_Knee",
            "L_Ankle",
            "L_Foot",
            "R_Collar",
            "R_Shoulder",
            "R_Elbow",
            "R_Wrist",
        ];
        let expected = [
            (Some(Hips), None),
            (Some(UpperLeg), l),
            (Some(LowerLeg), l),
            (Some(Foot), l),
            (Some(Toes), l),
            (Some(Clavicle), r),
            (Some(UpperArm), r),
            (Some(LowerArm), r),
            (Some(Hand), r),
        ];
        check(&smpl, &expected);
        let cmu = ["LHipJoint", "LeftUpLeg", "LeftLeg", "LowerBack", "RThumb"];
        check(
            &cmu,
            &[
                (Some(Appendix), l),
                (Some(UpperLeg), l),
                (Some(LowerLeg), l),
                (Some(Spine), None),
                (Some(Appendix), r),
            ],
        );
        // A mesh beside the skeleton named "wrist" does not turn hands into fingers.
        check(&["Wrist_2", "mixamorig:LeftHand"], &[(Some(Hand), None), (Some(Hand), l)]);
        check(&["leg_joint_L_1", "torso_joint_3", "Cube"], &[(None, l), (Some(Spine), None), (None, None)]);
    }
}
