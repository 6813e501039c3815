//! From evidence to roles: stated by the file, else seen in the geometry, else named, else generic.

use super::RoleGuess;
use super::axes::{feet_lead, left_by_name, possible_ups, snap};
use super::bind::Bound;
use super::creature::{generic_roles, up_by_feet};
use super::graph::{Graph, ancestors};
use super::humanoid::{Evidence, Humanoid, Limb, Split, Stance};
use super::names::{Part, Reading, read_names, settle_duplicates};
use super::role::{Role, Side};
use super::symmetry::Symmetry;
use crate::rig::{JointIdx, Rig};
use sinew_math::Vec3;

/// Roles per joint and the directions of the body.
pub(super) struct Anatomy {
    pub graph: Graph,
    pub roles: Vec<Option<RoleGuess>>,
    pub humanoid: bool,
    /// Unit, model space.
    pub up: Vec3,
    /// Unit, model space, at right angles to `up`.
    pub left: Vec3,
    pub notes: Vec<String>,
}

/// Confidence of a role seen in the geometry: names agree, are silent, contradict.
const CONFIDENCE: [f32; 3] = [0.95, 0.8, 0.5];
/// Confidence of a role that only the names tell.
const CONFIDENCE_NAMED: f32 = 0.6;
/// Confidence of a generic role.
const CONFIDENCE_GENERIC: f32 = 0.6;

/// Graph, symmetry and names of a rig, as far as the names can be trusted.
struct Scene<'a> {
    rig: &'a Rig,
    bound: &'a Bound,
    graph: Graph,
    symmetry: Symmetry,
    /// Per joint; empty readings where names are not trusted.
    readings: Vec<Reading>,
}

impl Anatomy {
    /// `None` if no joint moves skin.
    pub fn of(rig: &Rig, bound: &Bound) -> Option<Self> {
        let (scene, mut notes) = Scene::of(rig, bound)?;
        if let Some(stated) = scene.stated_draft() {
            notes.push("roles are those that the file states".into());
            return Some(stated.finish(scene, notes));
        }
        let found = possible_ups(scene.symmetry.lateral).find_map(|up| Some((up, scene.recognise(up)?)));
        if let Some((up, humanoid)) = found {
            let draft = scene.shape_draft(up, &humanoid, &mut notes);
            return Some(draft.finish(scene, notes));
        }
        if let Some(named) = scene.named_draft() {
            notes.push("the shape is not clear: roles are those of the names".into());
            return Some(named.finish(scene, notes));
        }
        notes.push("no human shape: generic roles".into());
        Some(scene.generic_draft(&mut notes).finish(scene, notes))
    }
}

/// Roles and directions before they are put together with the graph.
struct Draft {
    roles: Vec<Option<RoleGuess>>,
    humanoid: bool,
    up: Vec3,
    left: Vec3,
}

impl Draft {
    fn finish(self, scene: Scene<'_>, notes: Vec<String>) -> Anatomy {
        let Self { roles, humanoid, up, left } = self;
        Anatomy { graph: scene.graph, roles, humanoid, up, left, notes }
    }
}

impl<'a> Scene<'a> {
    fn of(rig: &'a Rig, bound: &'a Bound) -> Option<(Self, Vec<String>)> {
        let mut notes = Vec::new();
        let mut readings = read_names(rig.joints.iter().map(|joint| joint.name.as_str()));
        let names: Vec<&str> = rig.joints.iter().map(|joint| joint.name.as_str()).collect();
        settle_duplicates(&mut readings, &names, |joint| {
            (bound.area[joint] > 0.0).then(|| ancestors(rig, joint).count())
        });
        let mut graph = Graph::of(rig, bound, |_| true)?;
        let mut symmetry = Symmetry::find(&graph, bound.size());
        let (agreeing, pairs) = mirrored_names(&graph, &symmetry, &readings);
        if 10 * agreeing >= 6 * pairs && pairs > 0 {
            let body = |joint: JointIdx| readings[joint].part != Some(Part::Appendix);
            if let Some(smaller) = Graph::of(rig, bound, body) {
                symmetry = Symmetry::find(&smaller, bound.size());
                graph = smaller;
            }
        } else {
            if pairs > 0 && rig.joints.iter().any(|joint| !joint.name.is_empty()) {
                notes.push(format!(
                    "names of only {agreeing} of {pairs} mirrored pairs match: names are ignored"
                ));
            }
            readings = vec![Reading::default(); readings.len()];
        }
        Some((Self { rig, bound, graph, symmetry, readings }, notes))
    }

    fn node_readings(&self) -> Vec<Reading> {
        self.graph.nodes.iter().map(|node| self.readings[node.joint].clone()).collect()
    }

    fn recognise(&self, up: Vec3) -> Option<Humanoid> {
        let stance = Stance::new(self.bound, up);
        let readings = self.node_readings();
        Evidence { graph: &self.graph, symmetry: &self.symmetry, stance: &stance, readings: &readings }
            .recognise()
    }

    /// Left by the feet, else by names, else so that the body faces the file's +Z.
    fn left(&self, up: Vec3, ankles: &[Vec3], notes: &mut Vec<String>) -> Vec3 {
        let lateral = self.symmetry.lateral;
        let forward = lateral.cross(up);
        let lead = feet_lead(self.bound, &Stance::new(self.bound, up), forward, ankles);
        let named = left_by_name(&self.graph, &self.symmetry, &self.node_readings());
        // Half a per cent of the height and more is a foot; less is noise.
        if lead.abs() > 0.005 {
            if named * lead < 0.0 {
                notes.push(
                    "the feet point the other way than left and right are named: the feet count".into(),
                );
            }
            return lateral * lead.signum();
        }
        notes.push("the feet do not tell which way the body faces".into());
        if named.abs() > 0.0 {
            return lateral * named;
        }
        let ahead = if up.y.abs() > 0.5 { Vec3::Z } else { -Vec3::Y };
        lateral * if forward.dot(ahead) < 0.0 { -1.0 } else { 1.0 }
    }

    fn shape_draft(&self, up: Vec3, found: &Humanoid, notes: &mut Vec<String>) -> Draft {
        let legs = &found.legs;
        let ankles = legs.chain.each_ref().map(|chain| self.ankle(chain, legs.split));
        let left = self.left(up, &ankles, notes);
        let first = if left.dot(self.symmetry.lateral) > 0.0 { Side::Left } else { Side::Right };
        let mut roles = vec![None; self.rig.joints.len()];
        let mut set = |node: usize, role: Role| {
            let joint = self.graph.nodes[node].joint;
            roles[joint] = Some(RoleGuess { role, confidence: confidence(role, &self.readings[joint]) });
        };
        set(found.pelvis, Role::Hips);
        let parts = [Role::Spine, Role::Chest, Role::UpperChest];
        for (part, role) in thirds(&found.spine).into_iter().zip(parts) {
            set(part, role);
        }
        if let Some(&neck) = found.neck.first() {
            set(neck, Role::Neck);
        }
        set(found.head, Role::Head);
        for (k, side) in [(0, first), (1, first.mirror())] {
            for (node, role) in arm_roles(&found.arms, k, side).into_iter().chain(leg_roles(legs, k, side)) {
                set(node, role);
            }
        }
        self.find_bare_feet(&mut roles);
        Draft { roles, humanoid: true, up, left }
    }

    /// Where the foot begins: its node, or the end of the shank where the foot moves no skin of its own.
    fn ankle(&self, chain: &[usize], split: Split) -> Vec3 {
        let node = chain[split.2.unwrap_or(split.1)];
        let joint = self.graph.nodes[node].joint;
        let bare_end =
            |&end: &JointIdx| self.rig.joints[end].parent == Some(joint) && self.bound.area[end] <= 0.0;
        let end = (0..self.rig.joints.len()).find(bare_end).filter(|_| split.2.is_none());
        self.bound.model[end.unwrap_or(joint)].translation
    }

    /// Feet without skin of their own, beside the body in the rig: found by name at the end of the shank.
    fn find_bare_feet(&self, roles: &mut [Option<RoleGuess>]) {
        for side in [Side::Left, Side::Right] {
            let has =
                |role: Role| roles.iter().position(|r| r.is_some_and(|guess: RoleGuess| guess.role == role));
            let (Some(shank), None) = (has(Role::LowerLeg(side)), has(Role::Foot(side))) else { continue };
            let named = |&joint: &JointIdx| {
                let reading = &self.readings[joint];
                reading.part == Some(Part::Foot) && roles[joint].is_none() && self.on_side_of(joint, shank)
            };
            if let Some(foot) = (0..roles.len()).find(named) {
                roles[foot] = Some(RoleGuess { role: Role::Foot(side), confidence: CONFIDENCE_NAMED });
            }
        }
    }

    fn on_side_of(&self, joint: JointIdx, other: JointIdx) -> bool {
        let side =
            |j: JointIdx| self.bound.model[j].translation.dot(self.symmetry.lateral) - self.symmetry.centre;
        side(joint) * side(other) > 0.0
    }

    /// Roles that the file states, if they make a body.
    fn stated_draft(&self) -> Option<Draft> {
        let stated = self.rig.stated_roles.iter();
        let known = stated.filter_map(|(name, joint)| Some((Role::from_name(name)?, *joint)));
        self.draft_of(known.filter(|&(_, joint)| joint < self.rig.joints.len()).collect(), 1.0)
    }

    /// Roles that trusted names tell, if they make a body and the hands do not walk on the floor.
    fn named_draft(&self) -> Option<Draft> {
        let mut found: Vec<(Role, JointIdx)> = Vec::new();
        let mut spine: Vec<usize> = Vec::new();
        for &i in &self.graph.order {
            let joint = self.graph.nodes[i].joint;
            let Reading { part: Some(part), side, .. } = &self.readings[joint] else { continue };
            if *part == Part::Spine {
                spine.push(i);
            } else if let Some(role) =
                role_of(*part, *side).filter(|role| found.iter().all(|(r, _)| r != role))
            {
                found.push((role, joint));
            }
        }
        let parts = [Role::Spine, Role::Chest, Role::UpperChest];
        found
            .extend(thirds(&spine).into_iter().zip(parts).map(|(i, role)| (role, self.graph.nodes[i].joint)));
        let draft = self.draft_of(found, CONFIDENCE_NAMED)?;
        let stance = Stance::new(self.bound, draft.up);
        let low = |role: Role| {
            let joint = draft.roles.iter().position(|r| r.is_some_and(|guess| guess.role == role));
            joint.is_some_and(|joint| stance.level(self.bound.model[joint].translation) < 0.2)
        };
        let walks_on_hands = [Side::Left, Side::Right].into_iter().any(|side| low(Role::Hand(side)));
        (!walks_on_hands).then_some(draft)
    }

    /// A draft from known roles; `None` if hips, head, or one of the upper and lower limbs is missing.
    fn draft_of(&self, known: Vec<(Role, JointIdx)>, confidence: f32) -> Option<Draft> {
        let joint_of = |role: Role| known.iter().find(|(r, _)| *r == role).map(|&(_, joint)| joint);
        let place = |role: Role| joint_of(role).map(|joint| self.bound.model[joint].translation);
        let up = snap(place(Role::Head)? - place(Role::Hips)?);
        let mut across = Vec3::ZERO;
        for limb in [Role::UpperArm, Role::LowerArm, Role::UpperLeg, Role::LowerLeg] {
            across += place(limb(Side::Left))? - place(limb(Side::Right))?;
        }
        let left = snap(across - up * across.dot(up));
        if left.dot(up).abs() > 0.5 {
            return None;
        }
        let mut roles = vec![None; self.rig.joints.len()];
        for (role, joint) in known {
            roles[joint] = Some(RoleGuess { role, confidence });
        }
        Some(Draft { roles, humanoid: true, up, left })
    }

    fn generic_draft(&self, notes: &mut Vec<String>) -> Draft {
        let up = up_by_feet(&self.graph, self.bound, &self.symmetry);
        let lateral = self.symmetry.lateral;
        let stance = Stance::new(self.bound, up);
        let foot = |&i: &usize| {
            let node = &self.graph.nodes[i];
            node.children.is_empty() && self.symmetry.other(i).is_some() && stance.level(node.position) < 0.25
        };
        let feet: Vec<Vec3> =
            (0..self.graph.nodes.len()).filter(foot).map(|i| self.graph.nodes[i].position).collect();
        // A body without pairs may have its plane of symmetry across its own up.
        let left = if lateral.dot(up).abs() < 0.5 { self.left(up, &feet, notes) } else { Vec3::X };
        let mut roles = vec![None; self.rig.joints.len()];
        for (node, role) in self.graph.nodes.iter().zip(generic_roles(&self.graph, &self.symmetry, left)) {
            roles[node.joint] = Some(RoleGuess { role, confidence: CONFIDENCE_GENERIC });
        }
        Draft { roles, humanoid: false, up, left }
    }
}

/// How many mirrored pairs have names that mirror each other, and how many pairs there are.
fn mirrored_names(graph: &Graph, symmetry: &Symmetry, readings: &[Reading]) -> (usize, usize) {
    let (mut agreeing, mut pairs) = (0, 0);
    for (i, node) in graph.nodes.iter().enumerate() {
        let Some(other) = symmetry.other(i).filter(|&k| k > i) else { continue };
        let (a, b) = (&readings[node.joint], &readings[graph.nodes[other].joint]);
        pairs += 1;
        agreeing += usize::from(a.key == b.key && a.side.is_some() && a.side.map(Side::mirror) == b.side);
    }
    (agreeing, pairs)
}

/// At most three of a chain, evenly spread, the first among them.
fn thirds(chain: &[usize]) -> Vec<usize> {
    let count = chain.len().min(3);
    (0..count).map(|k| chain[k * chain.len() / count]).collect()
}

fn arm_roles(arms: &Limb, k: usize, side: Side) -> Vec<(usize, Role)> {
    let (upper, lower, hand) = arms.split;
    let chain = &arms.chain[k];
    let mut roles = vec![(chain[upper], Role::UpperArm(side)), (chain[lower], Role::LowerArm(side))];
    roles.extend(hand.map(|hand| (chain[hand], Role::Hand(side))));
    roles.extend((upper > 0).then(|| (chain[0], Role::Shoulder(side))));
    roles
}

fn leg_roles(legs: &Limb, k: usize, side: Side) -> Vec<(usize, Role)> {
    let (upper, lower, foot) = legs.split;
    let chain = &legs.chain[k];
    let mut roles = vec![(chain[upper], Role::UpperLeg(side)), (chain[lower], Role::LowerLeg(side))];
    if let Some(foot) = foot {
        roles.push((chain[foot], Role::Foot(side)));
        roles.extend(chain.get(foot + 1).map(|&toes| (toes, Role::Toes(side))));
    }
    roles
}

fn confidence(role: Role, reading: &Reading) -> f32 {
    let [agree, silent, contradict] = CONFIDENCE;
    let Some(part) = reading.part else { return silent };
    // Rigify and CesiumMan count the pelvis among the spine.
    if role == Role::Hips && part == Part::Spine {
        return silent;
    }
    let wrong_side = reading.side.is_some() && role.side().is_some() && reading.side != role.side();
    if part_of(role) == Some(part) && !wrong_side { agree } else { contradict }
}

fn part_of(role: Role) -> Option<Part> {
    Some(match role {
        Role::Hips => Part::Hips,
        Role::Spine | Role::Chest | Role::UpperChest => Part::Spine,
        Role::Neck => Part::Neck,
        Role::Head => Part::Head,
        Role::Shoulder(_) => Part::Clavicle,
        Role::UpperArm(_) => Part::UpperArm,
        Role::LowerArm(_) => Part::LowerArm,
        Role::Hand(_) => Part::Hand,
        Role::UpperLeg(_) => Part::UpperLeg,
        Role::LowerLeg(_) => Part::LowerLeg,
        Role::Foot(_) => Part::Foot,
        Role::Toes(_) => Part::Toes,
        Role::SpineSegment(_) | Role::TailSegment(_) | Role::LimbSegment { .. } => return None,
    })
}

/// The humanoid role that a part and a side make; the spine needs its place in the chain and is not told here.
fn role_of(part: Part, side: Option<Side>) -> Option<Role> {
    let fits = |role: &Role| part_of(*role) == Some(part) && role.side() == side;
    super::role::HUMANOID_ROLES.into_iter().filter(|_| part != Part::Spine).find(fits)
}
