//! Finds a human shape in a tree of joints by geometry alone. Mirrored chains to the floor are legs, the highest and
//! widest mirrored chains on the trunk are arms, and the unpaired chain above them ends in the head.

use super::bind::Bound;
use super::graph::Graph;
use super::names::{Part, Reading};
use super::symmetry::Symmetry;
use crate::roles::tuning::{
    AS_HIGH, AT_SHOULDER, AT_WRIST, FORKED, INNER_END, LONGEST_PALM, LOWEST_HIP, SHORT_BONE, SIDEWAYS,
};
use sinew_math::{Vec3, clamp, max, min, trig};

/// Directions and sizes of the bind pose if `up` is the up axis.
pub(super) struct Stance {
    /// Up axis, a unit vector in model space.
    pub up: Vec3,
    /// Lowest height of the skin, file units along `up`.
    pub floor: f32,
    /// Height from floor to crown, file units.
    pub height: f32,
}

impl Stance {
    pub fn new(bound: &Bound, up: Vec3) -> Self {
        let heights = bound.vertices.iter().map(|v| v.dot(up));
        let (mut floor, mut crown) = (f32::INFINITY, f32::NEG_INFINITY);
        for h in heights {
            (floor, crown) = (min(floor, h), max(crown, h));
        }
        Self { up, floor, height: max(crown - floor, 1e-12) }
    }

    /// Height of a point: 0 at the floor, 1 at the crown.
    pub fn level(&self, point: Vec3) -> f32 {
        (point.dot(self.up) - self.floor) / self.height
    }
}

/// Indices in a chain of the upper part, the lower part, and the hand or foot, which may be missing.
pub(super) type Split = (usize, usize, Option<usize>);

/// An arm or a leg with its mirror image. Index 0 is on the side toward [`Symmetry::lateral`].
#[derive(Clone, Debug)]
pub(super) struct Limb {
    /// Joints from the trunk outward, as far as both sides correspond.
    pub chain: [Vec<usize>; 2],
    pub split: Split,
}

/// The joints of a human shape.
#[derive(Clone, Debug)]
pub(super) struct Humanoid {
    pub pelvis: usize,
    /// Joints from above the pelvis to the joint to which the arms attach.
    pub spine: Vec<usize>,
    /// Joints from above the chest to below the head.
    pub neck: Vec<usize>,
    pub head: usize,
    pub arms: Limb,
    pub legs: Limb,
}

/// Evidence for the recognition of a humanoid.
pub(super) struct Evidence<'a> {
    pub graph: &'a Graph,
    pub symmetry: &'a Symmetry,
    pub stance: &'a Stance,
    /// Parsed names per node; all empty when the names cannot be trusted.
    pub readings: &'a [Reading],
    /// Function that returns the alternating swing of the limb that ends at a node:
    /// [`Swing::reach`](super::gait::Swing::reach).
    pub swing: &'a dyn Fn(usize) -> f32,
}

impl Evidence<'_> {
    fn level(&self, node: usize) -> f32 {
        self.stance.level(self.graph.nodes[node].position)
    }

    fn part(&self, node: usize) -> Option<Part> {
        self.readings[node].part
    }

    /// Finds the human shape that stands upright along `up`; `None` if there is none.
    pub fn recognise(&self) -> Option<Humanoid> {
        let mut limbs = self.limbs();
        let legs = self.take_legs(&mut limbs)?;
        let arms = self.take_arms(&limbs, &legs)?;
        let pelvis = self.pelvis(&legs, &arms);
        let chest = self.attachment(&arms);
        let mut spine: Vec<usize> = self.graph.up_from(chest).take_while(|&i| i != pelvis).collect();
        spine.reverse();
        // Arms may be parented to a joint of the trunk far below the shoulders.
        spine.extend(self.trunk_below_shoulders(chest, &arms, pelvis));
        let top = spine.last().copied().unwrap_or(chest);
        let (mut neck, head) = self.neck_and_head(top, &arms, pelvis)?;
        // Arms may be parented to the neck.
        let trunk = spine.iter().position(|&i| self.part(i) == Some(Part::Neck)).unwrap_or(spine.len());
        neck.splice(..0, spine.drain(trunk..));
        let limb = |chain: [Vec<usize>; 2], wanted: [Part; 3]| {
            let split = self.split(&chain[0], wanted)?;
            Some(Limb { chain, split })
        };
        let found = Humanoid {
            pelvis,
            spine,
            neck,
            head,
            arms: self.without_fingers(limb(arms, [Part::UpperArm, Part::LowerArm, Part::Hand])?),
            legs: limb(legs, [Part::UpperLeg, Part::LowerLeg, Part::Foot])?,
        };
        self.stands(&found).then_some(found)
    }

    /// Removes the hand of arms whose fingers start at the forearm, if no joint is named a hand.
    fn without_fingers(&self, arms: Limb) -> Limb {
        let (upper, lower, hand) = arms.split;
        let is_hand = |&hand: &usize| {
            let [forearm, hand] = [lower, hand].map(|at| arms.chain[0][at]);
            let away = |child: usize| self.graph.distance(forearm, child);
            let as_far =
                |&&child: &&usize| self.symmetry.other(child).is_some() && away(child) > FORKED * away(hand);
            let children = &self.graph.nodes[forearm].children;
            let fingers: Vec<usize> = children.iter().filter(as_far).copied().collect();
            let named = fingers.iter().filter(|&&finger| self.part(finger) == Some(Part::Hand)).count();
            self.part(hand) == Some(Part::Hand) && named < 2 || fingers.len() < 2
        };
        let hand = hand.filter(is_hand);
        Limb { split: (upper, lower, hand), ..arms }
    }

    /// Distance of both elbows together behind the line from shoulder to hand, opposite to `forward`, in body heights.
    /// Elbows only bend that way.
    pub fn elbows_behind(&self, arms: &Limb, forward: Vec3) -> f32 {
        let (upper, lower, hand) = arms.split;
        let behind = |chain: &Vec<usize>| {
            let end = hand.unwrap_or(chain.len() - 1);
            let [shoulder, elbow, wrist] = [upper, lower, end].map(|at| self.graph.nodes[chain[at]].position);
            let (arm, bend) = (wrist - shoulder, elbow - shoulder);
            let off = bend - arm * (bend.dot(arm) / max(arm.dot(arm), 1e-12));
            -off.dot(forward) / self.stance.height
        };
        arms.chain.iter().map(behind).sum()
    }

    /// True if the trunk extends upward and the legs downward.
    fn stands(&self, found: &Humanoid) -> bool {
        let position = |i: usize| self.graph.nodes[i].position;
        let along = |from: usize, to: usize| {
            let d = position(to) - position(from);
            d.dot(self.stance.up) / max(d.length(), 1e-12)
        };
        let leg = &found.legs.chain[0];
        along(found.pelvis, found.head) > 0.8 && along(leg[0], leg[leg.len() - 1]) < -0.6
    }

    /// Returns all mirrored chains that start at the midline.
    fn limbs(&self) -> Vec<[Vec<usize>; 2]> {
        // A clavicle may start on the midline; its side is that of its descendants.
        let middles = self.graph.middles();
        let starts = |&i: &usize| {
            let parent_on_midline = self.graph.nodes[i].parent.is_some_and(|p| self.symmetry.on_midline(p));
            parent_on_midline && self.symmetry.other(i).is_some() && self.symmetry.side_of(middles[i]) > 0.0
        };
        (0..self.graph.nodes.len()).filter(starts).map(|root| self.limb_from(root)).collect()
    }

    /// Returns the main chain from `root` and its mirror image, up to the joint at which fingers branch.
    fn limb_from(&self, root: usize) -> [Vec<usize>; 2] {
        let mut chain = vec![root];
        loop {
            let node = &self.graph.nodes[chain[chain.len() - 1]];
            let mut ways: Vec<usize> =
                node.children.iter().copied().filter(|&child| self.symmetry.other(child).is_some()).collect();
            let long = ways.iter().filter(|&&way| !self.graph.nodes[way].children.is_empty()).count();
            let is_fork = chain.len() > 2 && (long >= 2 || ways.len() >= 3);
            if ways.is_empty() || is_fork && !self.ends_at_wrist(&chain, &ways) {
                break;
            }
            let reach =
                |way: usize| self.graph.distance(chain[chain.len() - 1], way) + self.graph.nodes[way].reach;
            ways.sort_by(|&a, &b| reach(b).total_cmp(&reach(a)));
            chain.push(ways[0]);
            if is_fork {
                break;
            }
        }
        let mirrored = chain.iter().filter_map(|&i| self.symmetry.other(i)).collect();
        [chain, mirrored]
    }

    /// True if a chain ends in a forearm with fingers: all fingers start at one position away from it, or farther away
    /// than the length of a palm.
    fn ends_at_wrist(&self, chain: &[usize], fingers: &[usize]) -> bool {
        let [.., before, forearm] = chain else { return false };
        let away = |&finger: &usize| self.graph.distance(*forearm, finger);
        let (nearest, farthest) =
            (fingers.iter().map(away).fold(f32::INFINITY, min), fingers.iter().map(away).fold(0.0, max));
        let apart = fingers.iter().map(|&finger| self.graph.distance(fingers[0], finger)).fold(0.0, max);
        apart < AT_WRIST * farthest || nearest > LONGEST_PALM * self.graph.distance(*before, *forearm)
    }

    /// Removes the legs from `limbs`: pairs of at least two joints per side that reach the floor. If any of these swing
    /// alternately, only those count; the pair with the most skin is chosen. Other hanging parts swing less than half
    /// as far.
    fn take_legs(&self, limbs: &mut Vec<[Vec<usize>; 2]>) -> Option<[Vec<usize>; 2]> {
        let reaches_floor = |chain: &[usize]| {
            let lowest = chain.iter().map(|&i| self.level(i)).fold(f32::INFINITY, min);
            // Without a foot joint the chain ends at the knee.
            let limit = if chain.len() > 2 + self.inner_ends(chain, true) { 0.2 } else { 0.35 };
            chain.len() > 1 && lowest < limit && (LOWEST_HIP..0.75).contains(&self.level(chain[0]))
        };
        let low: Vec<usize> = (0..limbs.len()).filter(|&i| reaches_floor(&limbs[i][0])).collect();
        let swing = |i: usize| match limbs[i][0].last() {
            // A single pair needs no choice by swing.
            Some(&end) if low.len() > 1 => (self.swing)(end),
            _ => 0.0,
        };
        let swings: Vec<f32> = low.iter().map(|&i| swing(i)).collect();
        let widest = swings.iter().copied().fold(0.0, max);
        let best = low
            .iter()
            .zip(swings)
            .map(|(&i, swing)| ((2.0 * swing >= widest, self.graph.nodes[limbs[i][0][0]].subtree_area), i))
            .reduce(|a, b| if b.0 > a.0 { b } else { a })?;
        Some(limbs.swap_remove(best.1))
    }

    /// Returns the widest pair of chains of at least two joints that is above the legs and off the floor.
    fn take_arms(&self, limbs: &[[Vec<usize>; 2]], legs: &[Vec<usize>; 2]) -> Option<[Vec<usize>; 2]> {
        let hip = self.level(legs[0][0]);
        let width = |chain: &[usize]| chain.iter().map(|&i| self.symmetry.side(self.graph, i)).fold(0.0, max);
        let candidate = |chain: &[usize]| {
            let lowest = chain.iter().map(|&i| self.level(i)).fold(f32::INFINITY, min);
            chain.len() > 1 && self.level(chain[0]) > hip + 0.1 && lowest > min(0.22, hip + 0.02)
        };
        // Ears are attached to the end of the trunk.
        let goes_on = |chain: &[usize]| {
            let attachment = self.graph.nodes[chain[0]].parent;
            attachment.is_some_and(|at| {
                self.graph.nodes[at].children.iter().any(|&child| self.symmetry.on_midline(child))
            })
        };
        let is_arm = |chain: &[usize]| chain.iter().all(|&i| self.part(i) != Some(Part::Beast));
        let best = (0..limbs.len())
            .filter(|&i| candidate(&limbs[i][0]))
            .map(|i| ((is_arm(&limbs[i][0]), goes_on(&limbs[i][0]), width(&limbs[i][0])), i))
            .reduce(|a, b| if b.0 > a.0 { b } else { a })?;
        Some(limbs[best.1].clone())
    }

    fn attachment(&self, limb: &[Vec<usize>; 2]) -> usize {
        self.graph.nodes[limb[0][0]].parent.expect("limbs grow out of the midline")
    }

    /// Returns the midline joint at the height of the hips. Thighs may be parented to another joint of the trunk, so
    /// all joints from the root to the chest are compared: by name, else the lowest of those near the hips with a fair
    /// share of skin.
    fn pelvis(&self, legs: &[Vec<usize>; 2], arms: &[Vec<usize>; 2]) -> usize {
        let hip = self.level(legs[0][0]);
        let mut trunk: Vec<usize> = self.graph.up_from(self.attachment(arms)).collect();
        trunk.reverse();
        let off = |i: usize| (self.level(i) - hip).abs();
        let nearest = trunk.iter().map(|&i| off(i)).fold(f32::INFINITY, min);
        let near: Vec<usize> =
            trunk.iter().copied().filter(|&i| off(i) < max(nearest + 0.01, 0.07)).collect();
        let named = |&&i: &&usize| self.part(i) == Some(Part::Hips) && (near.contains(&i) || off(i) < 0.15);
        if let Some(&named) = trunk.iter().find(named) {
            return named;
        }
        let most = near.iter().map(|&i| self.graph.nodes[i].area).fold(0.0, max);
        let fair = near.iter().copied().filter(|&i| self.graph.nodes[i].area >= 0.2 * most);
        // In a chain of two, takes the lower joint, because the other is a handle for the body. Of two at one height,
        // the joint that moves less than half as much skin is a handle, too.
        let leads = |handle: usize, body: usize| {
            let (above, areas) =
                (self.level(handle) - self.level(body), [handle, body].map(|i| self.graph.nodes[i].area));
            if above.abs() > AS_HIGH || max(areas[0], areas[1]) < 2.0 * min(areas[0], areas[1]) {
                above > 0.0
            } else {
                areas[0] < areas[1]
            }
        };
        fair.reduce(|a, b| if leads(a, b) { b } else { a }).unwrap_or(trunk[0])
    }

    /// Returns the midline chain from the joint that carries the arms up to their height.
    fn trunk_below_shoulders(&self, chest: usize, arms: &[Vec<usize>; 2], pelvis: usize) -> Vec<usize> {
        let shoulder = self.level(arms[0][0]);
        let mut chain = Vec::new();
        let mut at = chest;
        loop {
            let rises = |&i: &usize| {
                let is_trunk = self.symmetry.on_midline(i) && i != pelvis && self.level(i) > self.level(at);
                is_trunk && self.level(i) <= shoulder - AT_SHOULDER
            };
            let next = self.graph.nodes[at].children.iter().copied().filter(rises);
            let Some(next) = self.with_most_skin(next) else { return chain };
            chain.push(next);
            at = next;
        }
    }

    fn with_most_skin(&self, nodes: impl Iterator<Item = usize>) -> Option<usize> {
        let sized = nodes.map(|i| (self.graph.nodes[i].subtree_area, i));
        sized.reduce(|a, b| if b.0 > a.0 { b } else { a }).map(|(_, i)| i)
    }

    /// Returns the midline chain above the arms with the most skin; its last joint with a fair share of skin is the
    /// head.
    fn neck_and_head(
        &self,
        chest: usize,
        arms: &[Vec<usize>; 2],
        pelvis: usize,
    ) -> Option<(Vec<usize>, usize)> {
        let shoulder = self.level(arms[0][0]);
        let above =
            |&i: &usize| self.symmetry.on_midline(i) && i != pelvis && self.level(i) > shoulder - AT_SHOULDER;
        let mut chain: Vec<usize> = Vec::new();
        let mut at = chest;
        loop {
            let next = self.graph.nodes[at].children.iter().copied().filter(above);
            let Some(next) = self.with_most_skin(next) else { break };
            chain.push(next);
            at = next;
        }
        let all = self.graph.nodes[*chain.first()?].subtree_area;
        let named = chain.iter().position(|&i| self.part(i) == Some(Part::Head));
        let fair = chain.iter().rposition(|&i| self.graph.nodes[i].subtree_area >= 0.15 * all).unwrap_or(0);
        let head = chain[named.unwrap_or(fair)];
        chain.truncate(named.unwrap_or(fair));
        Some((chain, head))
    }

    /// Number of joints before the first long bone of a limb: inner ends of clavicles or hips. Such a joint is on the
    /// midline, or its bone is short; in a leg the bone also points sideways.
    fn inner_ends(&self, chain: &[usize], leg: bool) -> usize {
        let side = |place: usize| self.symmetry.side(self.graph, chain[place]).abs();
        let length = |place: usize| self.graph.distance(chain[place], chain[place + 1]);
        let on_midline = |place: usize| place == 0 && side(0) < INNER_END * side(1);
        let is_stub = |place: usize| {
            let sideways = side(place + 1) - side(place) > SIDEWAYS * length(place);
            length(place) < SHORT_BONE * length(place + 1) && (!leg || sideways)
        };
        let mut count = 0;
        while chain.len() > count + 2 && (on_midline(count) || is_stub(count)) {
            count += 1;
        }
        count
    }

    /// Indices in a chain of the upper part, the lower part, and the hand or foot: by name, else by length.
    fn split(&self, chain: &[usize], parts: [Part; 3]) -> Option<Split> {
        let place = |part: Part| chain.iter().position(|&i| self.part(i) == Some(part));
        if let (Some(upper), Some(lower)) = (place(parts[0]), place(parts[1])) {
            let last = place(parts[2]).filter(|&last| last > lower);
            if upper < lower && chain.iter().filter(|&&i| self.part(i) == Some(parts[1])).count() == 1 {
                return Some((upper, lower, last.or((lower + 1 < chain.len()).then_some(lower + 1))));
            }
        }
        let leg = parts[2] == Part::Foot;
        let from = self.inner_ends(chain, leg);
        match chain.len() - from {
            0 | 1 => None,
            2 => Some((from, from + 1, None)),
            _ if chain.len() == 3 || leg && chain.len() == 4 => Some((from, from + 1, Some(from + 2))),
            _ => Some(self.split_by_length(chain)),
        }
    }

    /// In a chain of four or more joints, takes the two consecutive segments whose lengths are most like an upper arm
    /// and a forearm, or a thigh and a shank (0.9 : 1), and which cover at least half of the length. A joint with
    /// hardly any bone after it (the end of a clavicle, a wrist before the hand) starts neither segment.
    fn split_by_length(&self, chain: &[usize]) -> Split {
        let mut way = vec![0.0];
        for pair in chain.windows(2) {
            way.push(way[way.len() - 1] + self.graph.distance(pair[0], pair[1]));
        }
        let longest = way.windows(2).map(|w| w[1] - w[0]).fold(0.0, max);
        let short = |i: usize| way[i + 1] - way[i] < 0.35 * longest;
        let mut best = (f32::INFINITY, (0, 1, Some(2)));
        for lower in 1..chain.len() - 1 {
            for upper in 0..lower {
                for last in lower + 1..chain.len() {
                    let (a, b) = (way[lower] - way[upper], way[last] - way[lower]);
                    if short(upper) || short(lower) || a + b < 0.5 * way[way.len() - 1] {
                        continue;
                    }
                    let misfit = trig::ln(clamp(b / max(a, 1e-12), 1e-3, 1e3) / 0.9).abs();
                    if misfit < best.0 {
                        best = (misfit, (upper, lower, Some(last)));
                    }
                }
            }
        }
        best.1
    }
}
