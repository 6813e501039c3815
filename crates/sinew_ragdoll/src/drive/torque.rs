//! Largest torques of the muscles about a body's joints.

use super::{hangs_on, parent};
use crate::def::RagdollDef;
use crate::tuning::{CREATURE_STRENGTH, GRAVITY};
use sinew_math::{Vec3, max};

/// Largest torques of the muscles about a joint of a body of 75 kg and 1.75 m, N·m, by the role of the body below the
/// joint. The values are those of the humanoid of Peng et al. 2018 ("DeepMimic"); they are between the clinical values
/// and those of dm_control's CMU humanoid.
const HUMAN: [(&str, f32); 12] = [
    ("Shoulder", 100.0),
    ("UpperArm", 100.0),
    ("LowerArm", 60.0),
    ("Hand", 20.0),
    ("UpperLeg", 200.0),
    ("LowerLeg", 150.0),
    ("Foot", 90.0),
    ("Toes", 20.0),
    ("spine", 200.0),
    ("chest", 200.0),
    ("upperChest", 200.0),
    ("neck", 50.0),
];
const HEAD: f32 = 50.0;
/// Mass times height of the reference body, kg m.
const REFERENCE: f32 = 75.0 * 1.75;

/// Returns the largest muscle torque of each body's joint to its parent, N·m; 0 for the first body. Human roles use a
/// table, in proportion to mass and height. Other roles get three times the torque that holds the joint's subtree
/// horizontal; limbs get at least the torque that carries the whole weight at half the length of their bone.
pub fn torque_caps(def: &RagdollDef) -> Vec<f32> {
    let total: f32 = def.bodies.iter().map(|body| body.mass.mass).sum();
    let strength = total * def.height / REFERENCE;
    (0..def.bodies.len())
        .map(|body| match parent(def, body) {
            None => 0.0,
            Some(_) => match of_human(&def.bodies[body].role) {
                Some(torque) if strength > 0.0 => torque * strength,
                _ => of_creature(def, body, total),
            },
        })
        .collect()
}

fn of_human(role: &str) -> Option<f32> {
    if role == "head" {
        return Some(HEAD);
    }
    let part = role.strip_prefix("left").or_else(|| role.strip_prefix("right")).unwrap_or(role);
    HUMAN.iter().find(|(name, _)| *name == part).map(|(_, torque)| *torque)
}

fn of_creature(def: &RagdollDef, body: usize, total: f32) -> f32 {
    let joint = &def.joints[body - 1];
    let pivot = (def.bodies[body].character_from_body * joint.frame_child).translation;
    let center = |body: usize| def.bodies[body].character_from_body.point(def.bodies[body].mass.center);
    let mut moment = Vec3::ZERO;
    for below in (body..def.bodies.len()).filter(|&below| hangs_on(def, below, body)) {
        moment += (center(below) - pivot) * def.bodies[below].mass.mass;
    }
    let holds = CREATURE_STRENGTH * GRAVITY * moment.length();
    let bears = if def.bodies[body].role.starts_with("limb") {
        GRAVITY * total * (center(body) - pivot).length()
    } else {
        0.0
    };
    max(holds, bears)
}
