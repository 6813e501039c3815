//! Completes bodies by names if the hierarchy or the skin of a rig omits a part.
//!
//! Exports of deform bones only make thighs, shoulders and upper arms roots; low-poly characters have limb bones
//! without skin; and an asymmetric pose hides the mirrored pairs that the names show.

use super::bind::Bound;
use super::graph::{Graph, ancestors};
use super::names::{Part, Reading};
use super::role::Side;
use super::symmetry::Symmetry;
use crate::rig::{JointIdx, Rig};
use crate::roles::tuning::{LEAST_NAMED_PAIRS, MIRROR_TOLERANCE, NAMED_ALIKE};
use sinew_math::{Vec3, direction};

const LONG: [Part; 4] = [Part::UpperArm, Part::LowerArm, Part::UpperLeg, Part::LowerLeg];

/// Returns limb bones without skin that carry a skinned part of the same limb, or whose mirrored bone does or has
/// skin: the nearest bone for each part of a side.
///
/// The name and the hierarchy confirm such a bone, even without skin.
pub(super) fn bare_limbs(rig: &Rig, bound: &Bound, readings: &[Reading]) -> Vec<JointIdx> {
    let moves = |joint: JointIdx| bound.area[joint] > 0.0;
    let has_skin = |part: Part, side: Option<Side>| {
        let named = |(joint, reading): (usize, &Reading)| {
            moves(joint) && reading.part == Some(part) && reading.side == side
        };
        readings.iter().enumerate().any(named)
    };
    let mut found: Vec<(Part, Option<Side>, JointIdx)> = Vec::new();
    for (joint, reading) in readings.iter().enumerate().filter(|&(joint, _)| moves(joint)) {
        let Some(part) = reading.part.filter(|&part| below(part).is_some()) else { continue };
        if reading.side.is_none() {
            continue;
        }
        for above in ancestors(rig, joint) {
            let other = &readings[above];
            let Some(bare) = other.part.filter(|other| LONG.contains(other)) else { continue };
            let is_further_in = other.side == reading.side && is_of_one_limb(bare, part) && bare != part;
            let is_new = found.iter().all(|&(part, side, _)| (part, side) != (bare, other.side));
            if is_further_in && is_new && !moves(above) && !has_skin(bare, other.side) {
                found.push((bare, other.side, above));
            }
        }
    }
    // The mirrored bone has skin or carries some, and a mirrored figure has both.
    let first = found.clone();
    for (joint, reading) in readings.iter().enumerate().filter(|&(joint, _)| !moves(joint)) {
        let Some(part) = reading.part.filter(|part| LONG.contains(part)) else { continue };
        let Some(side) = reading.side else { continue };
        let is_new = found.iter().all(|&(other, of, _)| (other, of) != (part, Some(side)));
        let is_there = |side: Side| {
            has_skin(part, Some(side))
                || first.iter().any(|&(other, of, _)| (other, of) == (part, Some(side)))
        };
        if is_new && is_there(side.mirror()) && !is_there(side) {
            found.push((part, Some(side), joint));
        }
    }
    found.into_iter().map(|(_, _, joint)| joint).collect()
}

/// Returns joints without skin inside a limb whose mirror image moves skin but has no counterpart in `graph`.
pub(super) fn bare_twins(rig: &Rig, bound: &Bound, graph: &Graph, symmetry: &Symmetry) -> Vec<JointIdx> {
    let moves = |joint: JointIdx| bound.area[joint] > 0.0;
    let near = MIRROR_TOLERANCE * bound.size();
    let place = |joint: JointIdx| bound.model[joint].translation;
    let is_inside = |joint: JointIdx| {
        let carries = |other: JointIdx| moves(other) && ancestors(rig, other).any(|above| above == joint);
        ancestors(rig, joint).any(moves) && (0..rig.joints.len()).any(carries)
    };
    let single = |node: &usize| symmetry.partner[*node].is_none();
    let alone: Vec<Vec3> = (0..graph.nodes.len())
        .filter(single)
        .map(|node| graph.nodes[node].position)
        .filter(|at| symmetry.side_of(*at).abs() > near)
        .map(|at: Vec3| at - symmetry.lateral * (2.0 * symmetry.side_of(at)))
        .collect();
    let is_twin = |joint: &JointIdx| {
        !moves(*joint) && alone.iter().any(|at| (place(*joint) - *at).length() < near) && is_inside(*joint)
    };
    (0..rig.joints.len()).filter(is_twin).collect()
}

/// Returns the limb of a part and its position in the limb, from the trunk outward; `None` for other parts.
fn below(part: Part) -> Option<(usize, usize)> {
    use Part::{Clavicle, Foot, Hand, LowerArm, LowerLeg, Toes, UpperArm, UpperLeg};
    let limbs = [[Clavicle, UpperArm, LowerArm, Hand], [UpperLeg, LowerLeg, Foot, Toes]];
    limbs.iter().enumerate().find_map(|(limb, parts)| Some((limb, parts.iter().position(|p| *p == part)?)))
}

/// True if `inner` is nearer to the trunk than `outer` in the same limb.
fn is_of_one_limb(inner: Part, outer: Part) -> bool {
    match (below(inner), below(outer)) {
        (Some((a, i)), Some((b, k))) => a == b && i < k,
        _ => false,
    }
}

/// Joints by the body part in their name, for finding parents by name.
pub(super) struct Carriers<'a> {
    readings: &'a [Reading],
    is_human: bool,
    /// Parts of the spine from the hips upward.
    spine: Vec<JointIdx>,
    /// The part of the spine that carries the arms.
    chest: Option<JointIdx>,
    is_part: Vec<bool>,
}

impl<'a> Carriers<'a> {
    /// Finds the carriers among the joints that are parts of the body.
    pub fn of(readings: &'a [Reading], bound: &Bound, is_part: impl Fn(JointIdx) -> bool) -> Self {
        let is_part: Vec<bool> = (0..readings.len()).map(is_part).collect();
        let named = |part: Part| {
            let is = move |&joint: &JointIdx| readings[joint].part == Some(part);
            (0..readings.len()).filter(is).filter(|&joint| is_part[joint])
        };
        let place = |joint: JointIdx| bound.model[joint].translation;
        let mean = |part: Part| {
            let places: Vec<Vec3> = named(part).map(place).collect();
            let sum = places.iter().fold(Vec3::ZERO, |sum, at| sum + *at);
            (!places.is_empty()).then(|| sum / places.len() as f32)
        };
        let mut spine: Vec<JointIdx> = named(Part::Spine).collect();
        let mut chest = None;
        // Follows the spine from the hips upward to the arms.
        if let Some(low) = named(Part::Hips).next().map(place).or_else(|| mean(Part::UpperLeg)) {
            spine.sort_by(|&a, &b| (place(a) - low).length().total_cmp(&(place(b) - low).length()));
            // If no joint is named neck or head, the spine continues to the crown.
            let has_top = [Part::Neck, Part::Head].into_iter().any(|part| named(part).next().is_some());
            if let Some(arms) = mean(Part::UpperArm).filter(|_| !has_top) {
                let below = |&&joint: &&JointIdx| {
                    (place(joint) - low).dot(arms - low) <= (arms - low).length_squared()
                };
                chest = spine.iter().rfind(below).copied();
            }
        }
        let chest = chest.or(spine.last().copied());
        Self { readings, is_human: sides_agree(readings, bound), spine, chest, is_part }
    }

    /// Returns the parent of a joint by name; `None` if the names give no parent.
    pub fn of_joint(&self, joint: JointIdx) -> Option<JointIdx> {
        use Part::{
            Clavicle, Foot, Hand, Head, Hips, LowerArm, LowerLeg, Neck, Spine, Toes, UpperArm, UpperLeg,
        };
        let side = self.readings[joint].side;
        let part = self.readings[joint].part.filter(|_| self.is_human)?;
        let parts: &[Part] = match part {
            Spine => {
                let at = self.spine.iter().position(|&part| part == joint)?;
                return at.checked_sub(1).map(|below| self.spine[below]).or_else(|| self.find(Hips, None));
            }
            Neck => &[],
            Head => &[Neck],
            Clavicle => &[],
            UpperArm => &[Clavicle],
            LowerArm => &[UpperArm],
            Hand => &[LowerArm, UpperArm],
            UpperLeg => return self.find(Hips, None).or(self.spine.first().copied()),
            LowerLeg => &[UpperLeg],
            Foot => &[LowerLeg, UpperLeg],
            Toes => &[Foot],
            Part::Hips | Part::Tail | Part::Beast | Part::Appendix => return None,
        };
        let carrier = parts.iter().find_map(|&part| self.find(part, side.filter(|_| part != Neck)));
        let trunk = match part {
            Neck | Head => self.spine.last().copied(),
            Clavicle | UpperArm => self.chest,
            _ => return carrier,
        };
        carrier.or(trunk).or_else(|| self.find(Hips, None))
    }

    fn find(&self, part: Part, side: Option<Side>) -> Option<JointIdx> {
        let is = |reading: &Reading| reading.part == Some(part) && reading.side == side;
        (0..self.readings.len()).find(|&joint| self.is_part[joint] && is(&self.readings[joint]))
    }
}

/// True if names consistently distinguish left and right for several pairs, including arms and legs.
///
/// Needs no mirror symmetry: the two sides may be posed differently.
pub(super) fn sides_agree(readings: &[Reading], bound: &Bound) -> bool {
    let mut ways: Vec<(Part, Vec3)> = Vec::new();
    for part in [Part::UpperArm, Part::LowerArm, Part::Hand, Part::UpperLeg, Part::LowerLeg, Part::Foot] {
        let only = |side: Side| {
            let is = |&i: &usize| readings[i].part == Some(part) && readings[i].side == Some(side);
            let mut all = (0..readings.len()).filter(is).filter(|&i| bound.area[i] > 0.0);
            all.next().filter(|_| all.next().is_none())
        };
        let (Some(left), Some(right)) = (only(Side::Left), only(Side::Right)) else { continue };
        let way = direction(bound.model[left].translation - bound.model[right].translation);
        ways.extend(way.map(|way| (part, way)));
    }
    let sum = ways.iter().fold(Vec3::ZERO, |sum, (_, way)| sum + *way);
    let has = |parts: [Part; 2]| ways.iter().any(|(part, _)| parts.contains(part));
    let Some(mean) = direction(sum) else { return false };
    ways.len() >= LEAST_NAMED_PAIRS
        && has([Part::UpperArm, Part::LowerArm])
        && has([Part::UpperLeg, Part::LowerLeg])
        && ways.iter().all(|(_, way)| way.dot(mean) > NAMED_ALIKE)
}
