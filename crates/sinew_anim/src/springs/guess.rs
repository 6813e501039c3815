//! Guesses springs from joint names.

use super::{LimitKind, SpringBone, SpringChain, SpringLimit, SpringLink, Springs};
use crate::garments::guess_garments;
use crate::rig::{JointIdx, Rig};
use crate::roles::words;
use crate::tuning::SPRING_RADIUS;
use sinew_math::{Rotation, Vec3};

/// Kind of swinging part, with its settings.
struct Material {
    /// Words of names, lower case.
    words: &'static [&'static str],
    /// Stiffness over the mean length of the chain's bones, 1/s: the rate at which a light spring approaches its rest
    /// pose.
    rate: f32,
    /// Ratio of gravity to stiffness.
    sag: f32,
    drag: f32,
    /// Largest rotation of a bone from its rest pose, radians.
    cone: f32,
}

/// Kinds of parts; the first kind whose word is in a name applies. Rates are those of avatars drawn for VRM (stiffness
/// about 1 m/s on bones of 6 to 10 cm). Parts drawn as if free of gravity, such as ears, do not sag.
const MATERIALS: [Material; 6] = [
    Material {
        words: &[
            "hair", "hairs", "bang", "bangs", "braid", "ponytail", "pigtail", "twintail", "ahoge", "beard",
            "kami", "髪",
        ],
        rate: 12.0,
        sag: 0.2,
        drag: 0.4,
        cone: 1.2,
    },
    Material { words: &["ear", "ears", "耳"], rate: 25.0, sag: 0.0, drag: 0.4, cone: 0.5 },
    Material { words: &["tail", "尾", "尻尾"], rate: 12.0, sag: 0.1, drag: 0.4, cone: 0.8 },
    Material {
        words: &["skirt", "dress", "coat", "cape", "cloak", "スカート"],
        rate: 10.0,
        sag: 0.4,
        drag: 0.5,
        cone: 1.0,
    },
    Material {
        words: &[
            "ribbon",
            "strap",
            "scarf",
            "string",
            "tassel",
            "lace",
            "antenna",
            "feather",
            "whisker",
            "リボン",
        ],
        rate: 10.0,
        sag: 0.3,
        drag: 0.4,
        cone: 1.2,
    },
    Material {
        words: &["breast", "breasts", "bust", "boob", "chichi", "胸"],
        rate: 30.0,
        sag: 0.0,
        drag: 0.5,
        cone: 0.25,
    },
];

/// Returns springs by joint names for files that state none: hair, ears, tails, skirts, coats and capes, ribbons and
/// straps, breasts. `up` is the file's up axis, a unit vector. Chains follow children of one kind. A childless joint
/// ends a chain and does not swing, because its length is unknown (joints of [sheets](Rig::sheets) do not count as
/// children). The chains collide with the character's body. Neighbouring strands of skirts, coats and capes are linked.
pub fn guess_springs(rig: &Rig, up: Vec3) -> Springs {
    let material: Vec<Option<usize>> = rig.joints.iter().map(|joint| material_of(&joint.name)).collect();
    let is_cloth = rig.is_of_sheet();
    let mut children: Vec<Vec<JointIdx>> = vec![Vec::new(); rig.joints.len()];
    for (joint, node) in rig.joints.iter().enumerate() {
        if let Some(parent) = node.parent.filter(|_| !is_cloth[joint]) {
            children[parent].push(joint);
        }
    }
    let mut taken = vec![false; rig.joints.len()];
    let mut chains = Vec::new();
    for root in 0..rig.joints.len() {
        let Some(kind) = material[root].filter(|_| !taken[root]) else { continue };
        let mut bones: Vec<(JointIdx, Vec3)> = Vec::new();
        let mut at = root;
        loop {
            taken[at] = true;
            let same = children[at].iter().copied().find(|&child| material[child] == Some(kind));
            let Some(next) = same.or_else(|| children[at].first().copied()) else { break };
            let tail = rig.joints[next].rest.translation;
            if tail.length() > 0.0 {
                bones.push((at, tail));
            }
            if same.is_none() {
                break;
            }
            at = next;
        }
        if !bones.is_empty() {
            chains.push(chain(&rig.joints[root].name, &bones, &MATERIALS[kind], up));
        }
    }
    let mut springs = Springs { chains, ..Springs::default() };
    let across = |garment: &crate::Garment| SpringLink::default().across(&garment.columns, garment.closed);
    let mut links: Vec<SpringLink> = guess_garments(rig).iter().flat_map(across).collect();
    links.retain(|link| link.joints.iter().all(|&joint| springs.swings(joint)));
    springs.links = links;
    springs
}

fn chain(name: &str, bones: &[(JointIdx, Vec3)], material: &Material, up: Vec3) -> SpringChain {
    let length = bones.iter().map(|(_, tail)| tail.length()).sum::<f32>() / bones.len() as f32;
    let stiffness = material.rate * length;
    let bone = |&(joint, tail): &(JointIdx, Vec3)| SpringBone {
        joint,
        tail,
        stiffness,
        gravity: up * (-material.sag * stiffness),
        drag: material.drag,
        radius: SPRING_RADIUS * length,
        limit: Some(SpringLimit {
            kind: LimitKind::Cone { angle: material.cone },
            rotation: Rotation::IDENTITY,
        }),
    };
    SpringChain {
        name: name.to_owned(),
        bones: bones.iter().map(bone).collect(),
        center: None,
        colliders: Vec::new(),
        hits_body: true,
    }
}

/// Index of the first kind whose word is in the name; `None` for end markers and controls.
fn material_of(name: &str) -> Option<usize> {
    let words = words(name);
    if words.iter().any(|word| matches!(word.as_str(), "end" | "ik" | "ctrl" | "control" | "target" | "nub"))
    {
        return None;
    }
    MATERIALS.iter().position(|material| words.iter().any(|word| material.words.contains(&word.as_str())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_identify_springs() {
        let of = |name: &str| material_of(name).map(|kind| MATERIALS[kind].words[0]);
        assert_eq!(of("J_Sec_Hair1_01"), Some("hair"));
        assert_eq!(of("Ear2.L"), Some("ear"));
        assert_eq!(of("b_Tail01_012"), Some("tail"));
        assert_eq!(of("skirt_front_1"), Some("skirt"));
        assert_eq!(of("breast.R"), Some("breast"));
        assert_eq!(of("リボン_左"), Some("ribbon"));
        // Names that contain the letters by chance, and names of markers.
        for name in ["LeftForeArm", "Rear_Leg", "Ear4.L_end", "mixamorig:Head", "tailor", "IK_hair"] {
            assert_eq!(of(name), None, "{name}");
        }
    }
}
