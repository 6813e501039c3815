//! What a joint's name says about it. Names are a witness, not a judge: see [`super::humanoid`].

use super::role::Side;

/// Part of the body that a name speaks of.
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
    /// Never a body of its own: twist and IK joints, ends, sockets, fingers, face.
    Appendix,
}

/// A name taken apart.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Reading {
    /// The name without prefixes, numbers and side: equal for both joints of a mirrored pair.
    pub key: String,
    /// Side that the name states.
    pub side: Option<Side>,
    /// Part of the body, where the name is one of those in use.
    pub part: Option<Part>,
}

const PREFIXES: [&str; 18] = [
    "mixamorig",
    "def",
    "org",
    "mch",
    "bip",
    "biped",
    "valve",
    "valvebiped",
    "cc",
    "base",
    "skeleton",
    "joint",
    "jnt",
    "bone",
    "b",
    "j",
    "c",
    "armature",
];

/// Words that make a joint an appendix wherever they occur in its name.
const APPENDIX_WORDS: [&str; 36] = [
    "twist",
    "roll",
    "ik",
    "fk",
    "pole",
    "target",
    "ctrl",
    "control",
    "end",
    "tip",
    "nub",
    "slot",
    "handslot",
    "socket",
    "weapon",
    "prop",
    "attach",
    "helper",
    "thumb",
    "index",
    "middle",
    "ring",
    "pinky",
    "little",
    "finger",
    "fingers",
    "metacarpal",
    "eye",
    "eyes",
    "jaw",
    "tongue",
    "lip",
    "brow",
    "teeth",
    "ear",
    "hair",
];

/// Readings of all names of a rig, with the words resolved whose meaning hangs on the others.
pub(super) fn read_names<'a>(names: impl Iterator<Item = &'a str>) -> Vec<Reading> {
    let mut readings: Vec<Reading> = names.map(read_name).collect();
    let has = |words: &[&str]| readings.iter().any(|r| words.contains(&r.key.as_str()));
    let upper_arm = has(&["upperarm", "uparm", "arm", "humerus"]);
    let thigh = has(&["upperleg", "upleg", "thigh", "femur"]);
    let (wrist, ankle) = (has(&["wrist"]), has(&["ankle"]));
    for reading in &mut readings {
        reading.part = match (reading.key.as_str(), reading.side.is_some()) {
            // The clavicle to Mixamo, VRM and CMU, the humerus to SMPL, which has no other word for it.
            ("shoulder", _) if !upper_arm => Some(Part::UpperArm),
            // SMPL's hip joint is the thigh; CMU's only leads to it.
            ("hip" | "hips", true) => Some(if thigh { Part::Appendix } else { Part::UpperLeg }),
            ("leg", _) if !thigh => None,
            ("hand", _) if wrist => Some(Part::Appendix),
            ("foot", _) if ankle => Some(Part::Toes),
            _ => reading.part,
        };
    }
    readings
}

/// Settles parts that several joints of one side claim, of those that move skin: they have a `depth`, the number of
/// joints above them. Where the rig names all four long limb parts, one is meant and the others continue it (Rigify's
/// "upper_arm.L.001"); else the name tells nothing (CesiumMan calls all of its arm "arm").
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
        if many || matches!(claim.0, None | Some(Part::Spine | Part::Tail | Part::Appendix)) {
            continue;
        }
        // Each claim once, at the first joint that makes it.
        if claims[..i].contains(&claim) {
            continue;
        }
        let same: Vec<usize> = (i..claims.len()).filter(|&other| claims[other] == claim).collect();
        if same.len() == 1 {
            continue;
        }
        let meant = meant(same.clone(), names, &depth).filter(|_| names_all);
        for joint in same.into_iter().filter(|&joint| Some(joint) != meant) {
            readings[joint].part = names_all.then_some(Part::Appendix);
        }
    }
}

/// Which of several joints of one name is meant, whatever their order in the file: that nearest to the root; of siblings the
/// one in the middle by name (of three palms the second, of two the first).
fn meant(mut same: Vec<usize>, names: &[&str], depth: &impl Fn(usize) -> Option<usize>) -> Option<usize> {
    let least = same.iter().filter_map(|&joint| depth(joint)).min()?;
    same.retain(|&joint| depth(joint) == Some(least));
    same.sort_by_key(|&joint| names[joint]);
    same.get((same.len() - 1) / 2).copied()
}

fn read_name(name: &str) -> Reading {
    let bare = name.rsplit([':', '|']).next().unwrap_or(name);
    let mut words = split_words(bare);
    words
        .retain(|word| !PREFIXES.contains(&word.as_str()) && !word.starts_with(|c: char| c.is_ascii_digit()));
    let mut side = None;
    words.retain_mut(|word| {
        let (found, rest) = split_side(word);
        side = side.or(found);
        *word = rest;
        !word.is_empty()
    });
    let appendix = words.iter().any(|word| APPENDIX_WORDS.contains(&word.as_str()));
    let key = words.concat();
    let part = if appendix { Some(Part::Appendix) } else { part_of(&key) };
    Reading { key, side, part }
}

/// A side word alone ("l", "left") or glued to the front ("leftarm"), and what is left of the word.
fn split_side(word: &str) -> (Option<Side>, String) {
    match word {
        "l" | "left" => (Some(Side::Left), String::new()),
        "r" | "right" => (Some(Side::Right), String::new()),
        _ => {
            let glued = [("left", Side::Left), ("right", Side::Right)];
            let cut = glued
                .into_iter()
                .find_map(|(prefix, side)| word.strip_prefix(prefix).map(|rest| (side, rest)));
            cut.map_or((None, word.to_owned()), |(side, rest)| (Some(side), rest.to_owned()))
        }
    }
}

/// Words in lower case, split at punctuation, at digits and at camel humps ("LHipJoint": l, hip, joint).
fn split_words(name: &str) -> Vec<String> {
    let chars: Vec<char> = name.chars().collect();
    let mut words = vec![String::new()];
    for (i, &c) in chars.iter().enumerate() {
        let before = i.checked_sub(1).map(|b| chars[b]);
        let hump = c.is_uppercase()
            && (before.is_some_and(char::is_lowercase)
                || chars.get(i + 1).is_some_and(|next| next.is_lowercase()));
        let digits = before.is_some_and(|b| b.is_ascii_digit() != c.is_ascii_digit());
        if hump || digits || !c.is_alphanumeric() {
            words.push(String::new());
        }
        if c.is_alphanumeric() {
            words.last_mut().expect("starts with one word").extend(c.to_lowercase());
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

fn part_of(key: &str) -> Option<Part> {
    Some(match key {
        "hips" | "hip" | "pelvis" => Part::Hips,
        "spine" | "chest" | "upperchest" | "torso" | "abdomen" | "lowerback" | "waist" | "thorax" => {
            Part::Spine
        }
        "neck" => Part::Neck,
        "head" => Part::Head,
        "clavicle" | "collar" | "collarbone" | "shoulder" => Part::Clavicle,
        "upperarm" | "uparm" | "arm" | "humerus" => Part::UpperArm,
        "lowerarm" | "forearm" | "elbow" => Part::LowerArm,
        "hand" | "wrist" | "palm" => Part::Hand,
        "upperleg" | "upleg" | "thigh" | "femur" => Part::UpperLeg,
        "lowerleg" | "leg" | "calf" | "shin" | "shank" | "knee" => Part::LowerLeg,
        "foot" | "ankle" => Part::Foot,
        "toe" | "toes" | "toebase" | "ball" => Part::Toes,
        "tail" => Part::Tail,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(names: &[&str], expected: &[(Option<Part>, Option<Side>)]) {
        let got: Vec<_> = read_names(names.iter().copied()).into_iter().map(|r| (r.part, r.side)).collect();
        assert_eq!(got, expected, "{names:?}");
    }

    #[test]
    fn names_of_the_common_conventions() {
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

    #[test]
    fn words_whose_meaning_hangs_on_the_others() {
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
        check(&["leg_joint_L_1", "torso_joint_3", "Cube"], &[(None, l), (Some(Spine), None), (None, None)]);
    }
}
