//! Masses, centres and inertias of the bodies.
//!
//! Humans get shares of the total by de Leva's table, never from shape volumes, whose sum is 1.3 to 2.2 times the
//! body's (measured). Creatures have no table: the total comes from the volume that the skin encloses, and the parts
//! share it by shape volume.
//!
//! ```
//! use sinew_ragdoll::Sex;
//! use sinew_ragdoll::masses::default_mass;
//!
//! assert!((default_mass(1.741, Sex::Male) - 73.0).abs() < 0.1); // kg
//! assert!(default_mass(1.2, Sex::Female) < 40.0);
//! ```

pub mod de_leva;
mod inertia;
pub mod volume;

use crate::build::bones::{Anatomy, Bones};
use crate::build::part::{Part, Side};
use crate::fit::Fit;
use crate::tuning::{BOX_FILL, CAPSULE_FILL, FLESH, LEAST_MASS, LEAST_TRUNK};
use de_leva::{GIRDLE_OF_UPPER_TRUNK, NECK_OF_HEAD, Segment, Sex, TOES_OF_FOOT, Table, table};
use inertia::{conditioned, inside, of_shape};
use sinew_math::{Rotation, Sym3, Vec3, clamp, max, min};
use sinew_physics::{MassProperties, Shape};

/// Options for the masses of a character.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MassOptions {
    /// Total mass, kg; `None`: [`default_mass`].
    pub total: Option<f32>,
    /// Sex that selects the table.
    pub sex: Sex,
    /// Mass of the skin's enclosed volume, kg, for creatures. If the mass is unknown or does not match the shapes, the
    /// shapes determine the mass.
    pub enclosed: Option<f32>,
    /// Least and largest mass of a creature, kg, to which its mass is limited if `total` is `None`.
    pub usual: Option<[f32; 2]>,
}

/// Ratios of the enclosed mass to the shapes' mass for which the enclosed mass is accepted.
const BELIEVED: core::ops::Range<f32> = 0.1..2.0;

/// Returns the mass of a person of this height, kg, at the body mass index of the table's reference body (male 24.1,
/// female 20.6 kg/m²); for a male 73.0 kg × (height / 1.741 m)².
pub fn default_mass(height: f32, sex: Sex) -> f32 {
    let table = table(sex);
    let ratio = height / table.reference_height;
    table.reference_mass * ratio * ratio
}

/// Returns mass, centre and inertia of every body, in the body's frame. The masses add up to the requested total.
pub fn distribute(bones: &Bones, fits: &[Fit], options: MassOptions) -> Vec<MassProperties> {
    let shares = match bones.anatomy {
        Anatomy::Human => human_shares(bones, table(options.sex)),
        Anatomy::Creature => fits.iter().map(|fit| flesh(&fit.shape)).collect(),
    };
    let sum: f32 = shares.iter().sum();
    let total = options.total.unwrap_or_else(|| match bones.anatomy {
        Anatomy::Human => default_mass(bones.height, options.sex),
        Anatomy::Creature => {
            let own = options.enclosed.filter(|mass| BELIEVED.contains(&(mass / sum))).unwrap_or(sum);
            options.usual.map_or(own, |[least, most]| max(min(own, most), least))
        }
    });
    let shares: Vec<_> = shares.iter().map(|share| max(share / sum, LEAST_MASS)).collect();
    let sum: f32 = shares.iter().sum();
    let mut masses: Vec<_> = shares.iter().map(|share| total * share / sum).collect();
    // The rounding remainder goes to the pelvis, where it matters least.
    let rest = total - masses.iter().sum::<f32>();
    masses[0] += rest;
    (0..fits.len()).map(|body| properties(bones, &fits[body], body, masses[body], options.sex)).collect()
}

/// Returns the mass of flesh in a shape, kg.
fn flesh(shape: &Shape) -> f32 {
    let fill = if matches!(shape, Shape::Box { .. }) { BOX_FILL } else { CAPSULE_FILL };
    FLESH * fill * shape.volume()
}

/// Returns the share of the total mass per bone. The mass of a bone that the rig lacks goes to the bone that would
/// carry it.
fn human_shares(bones: &Bones, table: &Table) -> Vec<f32> {
    let mut shares = vec![0.0; bones.list.len()];
    let carrier = |chain: &[Part], side: Side| {
        chain.iter().find_map(|&part| {
            // Parts of the trunk have no side. The uppermost bone of the trunk carries arms and head.
            let side = if part.is_trunk() && part != Part::Clavicle { Side::Middle } else { side };
            (0..bones.list.len()).rev().find(|&b| bones.list[b].part == part && bones.list[b].side == side)
        })
    };
    let mut give = |chain: &[Part], side, share: f32| shares[carrier(chain, side).unwrap_or(0)] += share;

    let neck = if bones.find(Part::Neck, Side::Middle).is_some() { NECK_OF_HEAD } else { 0.0 };
    give(&[Part::Head, Part::Neck, Part::Spine], Side::Middle, table.head * (1.0 - neck));
    let mut girdles = 0.0;
    for side in [Side::Left, Side::Right] {
        let arm = [Part::Hand, Part::Forearm, Part::UpperArm, Part::Clavicle, Part::Spine];
        give(&arm, side, table.hand.mass);
        give(&arm[1..], side, table.forearm.mass);
        give(&arm[2..], side, table.upper_arm.mass);
        let leg = [Part::Toes, Part::Foot, Part::Shank, Part::Thigh, Part::Pelvis];
        let toes = if bones.find(Part::Toes, side).is_some() { TOES_OF_FOOT } else { 0.0 };
        give(&leg, side, table.foot.mass * toes);
        give(&leg[1..], side, table.foot.mass * (1.0 - toes));
        give(&leg[2..], side, table.shank.mass);
        give(&leg[3..], side, table.thigh.mass);
        if bones.find(Part::Clavicle, side).is_some() {
            let girdle = GIRDLE_OF_UPPER_TRUNK * table.trunk[0].0;
            give(&[Part::Clavicle], side, girdle);
            girdles += girdle;
        }
    }
    share_necks(bones, &mut shares, table.head * neck);
    share_trunk(bones, &mut shares, table, girdles);
    share_others(bones, &mut shares);
    shares
}

/// Shares the neck's mass equally between several neck bones.
fn share_necks(bones: &Bones, shares: &mut [f32], neck: f32) {
    let necks: Vec<_> = (0..bones.list.len()).filter(|&b| bones.list[b].part == Part::Neck).collect();
    for &bone in &necks {
        shares[bone] += neck / necks.len() as f32;
    }
}

/// Distributes the trunk's mass over the pelvis and the spine. Each bone takes the table's mass between its own pivot
/// and the next, measured from the hips to the neck.
fn share_trunk(bones: &Bones, shares: &mut [f32], table: &Table, girdles: f32) {
    let mut chain = vec![0];
    while let Some(next) = bones.continuation(chain[chain.len() - 1]) {
        if bones.list[next].part != Part::Spine {
            break;
        }
        chain.push(next);
    }
    let hips: Vec<_> = [Side::Left, Side::Right]
        .into_iter()
        .filter_map(|side| bones.find(Part::Thigh, side))
        .map(|thigh| bones.list[thigh].head)
        .collect();
    let bottom = match hips.as_slice() {
        [left, right] => (*left + *right) * 0.5,
        _ => bones.list[0].head,
    };
    let last = chain[chain.len() - 1];
    let top = bones.tail(last).unwrap_or(bones.list[last].head + Vec3::Y * (0.1 * bones.height));
    let axis = top - bottom;
    let height_of = |p: Vec3| (p - bottom).dot(axis) / max(axis.dot(axis), 1e-9);
    let mut below = 0.0;
    let count = chain.len();
    let least = min(LEAST_TRUNK, 1.0 / (3.0 * count as f32));
    for (i, &bone) in chain.iter().enumerate() {
        let left = (count - 1 - i) as f32;
        let above = match chain.get(i + 1) {
            Some(&next) => clamp(height_of(bones.list[next].head), below + least, 1.0 - left * least),
            None => 1.0,
        };
        shares[bone] += trunk_between(table, below, above);
        below = above;
    }
    // Shoulder girdles that are bodies already have their part of the upper trunk's mass.
    shares[last] -= girdles;
}

/// Returns the share of the body's mass in the trunk between two heights, 0 at the hips and 1 at the neck.
fn trunk_between(table: &Table, lo: f32, hi: f32) -> f32 {
    let whole: f32 = table.trunk.iter().map(|part| part.1).sum();
    let mut start = 0.0;
    let mut share = 0.0;
    for (mass, length) in table.trunk.iter().rev() {
        let end = start + length / whole;
        let (a, b) = (max(lo, start), min(hi, end));
        share += mass * max(b - a, 0.0) / (end - start);
        start = end;
    }
    share
}

/// Gives a small share to each bone without a segment in the table (tails, ears, capes, fingers).
fn share_others(bones: &Bones, shares: &mut [f32]) {
    for (bone, share) in bones.list.iter().zip(shares) {
        if matches!(bone.part, Part::Tail | Part::Limb) {
            *share += 0.005;
        }
    }
}

/// Returns the de Leva segment of a limb bone with joints at both ends.
fn limb_segment(part: Part, table: &Table) -> Option<Segment> {
    match part {
        Part::UpperArm => Some(table.upper_arm),
        Part::Forearm => Some(table.forearm),
        Part::Thigh => Some(table.thigh),
        Part::Shank => Some(table.shank),
        _ => None,
    }
}

/// Returns centre and inertia of one body, in its frame.
fn properties(bones: &Bones, fit: &Fit, body: usize, mass: f32, sex: Sex) -> MassProperties {
    let shape_inertia = of_shape(&fit.shape, mass);
    let segment = match bones.anatomy {
        Anatomy::Human => limb_segment(bones.list[body].part, table(sex)).zip(bones.tail(body)),
        Anatomy::Creature => None,
    };
    // Rigs divide trunk, head, hands and feet differently, so the shape gives their centre.
    let Some((segment, tail)) = segment else {
        let inertia = Sym3::from_diagonal(conditioned(shape_inertia));
        return MassProperties { mass, center: Vec3::ZERO, inertia };
    };
    let head = bones.list[body].head;
    let body_from_character = fit.character_from_body.inverse();
    let center = body_from_character.point(head + (tail - head) * segment.center);
    let axis = body_from_character.rotation * bones.direction(body, None);
    let length = (tail - head).length();
    let [sagittal, transverse, longitudinal] = segment.gyration.map(|g| {
        let radius = g * length;
        mass * radius * radius
    });
    // Radii about the two cross axes differ by a few per cent only, and the rotation of a limb about its axis in the
    // bind pose is unknown, so both axes get the mean. Thick cartoon limbs get at least half of their shape's inertia
    // about the long axis.
    let across = 0.5 * (sagittal + transverse);
    let principal = conditioned(Vec3::new(across, max(longitudinal, 0.5 * shape_inertia.y), across));
    MassProperties {
        mass,
        center: inside(&fit.shape, center),
        inertia: Sym3::from_rotated_diagonal(Rotation::from_arc(Vec3::Y, axis), principal),
    }
}
