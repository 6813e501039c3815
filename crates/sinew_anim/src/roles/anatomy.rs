//! Combines evidence into roles: stated by the file, else by geometry, else by names, else generic.

use super::assembly::{Carriers, bare_limbs, bare_twins, sides_agree};
use super::axes::{feet_lead, left_by_name, possible_ups, snap};
use super::bind::Bound;
use super::characters::main_skeleton;
use super::correct::{CorrectionError, corrected, needed};
use super::creature::{generic_roles, up_by_feet};
use super::gait::{Pair, Swing};
use super::graph::{Graph, ancestors};
use super::humanoid::{Evidence, Humanoid, Limb, Split, Stance};
use super::names::{Part, Reading, read_names, settle_duplicates, settle_limbs, settle_trunk};
use super::role::{Role, Side};
use super::species::Species;
use super::symmetry::Symmetry;
use super::units::Measured;
use super::{Basis, Hints, NoSkin, RoleGuess};
use crate::rig::{JointIdx, Rig};
use crate::roles::tuning::{
    CONTROL_SKIN, ELBOWS_BEHIND, FEET_AGAINST_NAMES, HANGING, LEAST_FOOT, STEP_CORRELATION,
};
use sinew_math::Vec3;

/// Roles per joint and the directions of the body.
pub(super) struct Anatomy {
    pub graph: Graph,
    pub roles: Vec<Option<RoleGuess>>,
    pub humanoid: bool,
    /// Up axis, a unit vector in model space.
    pub up: Vec3,
    /// Left direction, a unit vector in model space, perpendicular to `up`.
    pub left: Vec3,
    pub notes: Vec<String>,
    /// Longest stride in the clips, seconds, and the height of the leg's start above the floor, file units.
    stride: Option<(f32, f32)>,
}

/// Graph, symmetry and trusted names of a rig.
pub(super) struct Scene<'a> {
    rig: &'a Rig,
    bound: &'a Bound,
    hints: &'a Hints,
    graph: Graph,
    symmetry: Symmetry,
    /// Reading of each joint's name; empty readings where names are not trusted.
    readings: Vec<Reading>,
}

impl Anatomy {
    /// Builds the analysis; fails if no joint moves skin, or if `known` is impossible.
    pub fn of(
        rig: &Rig,
        bound: &Bound,
        known: &[(Role, JointIdx)],
        hints: &Hints,
    ) -> Result<Self, CorrectionError> {
        let (scene, mut notes) = Scene::of(rig, bound, known, hints).ok_or(NoSkin)?;
        let draft = scene.draft(&mut notes);
        let draft = corrected(&scene, draft, known, &mut notes)?;
        Ok(draft.finish(scene, notes))
    }

    /// Returns the sizes of the body from which the unit of its file follows.
    pub fn measured(&self, bound: &Bound, species: Option<Species>) -> Measured {
        let stance = Stance::new(bound, self.up);
        let is_head = |guess: &Option<RoleGuess>| guess.is_some_and(|guess| guess.role == Role::Head);
        let head = self.roles.iter().position(is_head);
        Measured {
            humanoid: self.humanoid,
            height: stance.height,
            size: bound.size(),
            head: head.map(|joint| 1.0 - stance.level(bound.model[joint].translation)),
            stride: self.stride,
            species,
        }
    }
}

/// Roles and directions before they are combined with the graph.
pub(super) struct Draft {
    pub roles: Vec<Option<RoleGuess>>,
    pub humanoid: bool,
    pub up: Vec3,
    pub left: Vec3,
}

impl Draft {
    fn finish(self, scene: Scene<'_>, notes: Vec<String>) -> Anatomy {
        let Self { roles, humanoid, up, left } = self;
        let stride = scene.stride(up);
        Anatomy { graph: scene.graph, roles, humanoid, up, left, notes, stride }
    }
}

impl<'a> Scene<'a> {
    fn of(
        rig: &'a Rig,
        bound: &'a Bound,
        known: &[(Role, JointIdx)],
        hints: &'a Hints,
    ) -> Option<(Self, Vec<String>)> {
        let mut notes = Vec::new();
        let names: Vec<&str> = rig.joints.iter().map(|joint| joint.name.as_str()).collect();
        let parents: Vec<Option<JointIdx>> = rig.joints.iter().map(|joint| joint.parent).collect();
        let mut readings = read_names(&names, &parents);
        let main = main_skeleton(rig, &bound.area);
        let moves_skin =
            |joint: JointIdx| bound.area[joint] > 0.0 && main.as_ref().is_none_or(|main| main[joint]);
        let mut graph = Graph::of(rig, bound, moves_skin, |_| None)?;
        let mut symmetry = Symmetry::find(&graph, bound.size());
        let twins = bare_twins(rig, bound, &graph, &symmetry);
        let is_twin = |joint: JointIdx| twins.contains(&joint);
        if !twins.is_empty()
            && let Some(filled) = Graph::of(rig, bound, |joint| moves_skin(joint) || is_twin(joint), |_| None)
        {
            symmetry = Symmetry::find(&filled, bound.size());
            graph = filled;
        }
        let trust = Trust::of(&graph, &symmetry, &readings, bound);
        let is_named = rig.joints.iter().any(|joint| !joint.name.is_empty());
        notes.extend(trust.note().filter(|_| is_named));
        trust.forget(&mut readings);
        settle_duplicates(&mut readings, &names, |joint| {
            (bound.area[joint] > 0.0).then(|| ancestors(rig, joint).count())
        });
        settle_limbs(&mut readings, &parents);
        settle_trunk(&mut readings, &parents, |joint| bound.area[joint] > 0.0);
        for &(role, joint) in known {
            (readings[joint].part, readings[joint].side) = (part_of(role), role.side());
        }
        if !matches!(trust, Trust::Nothing { .. }) {
            // A control with skin that no joint above it moves counts as a body part, regardless of its name.
            let fair = CONTROL_SKIN * bound.area.iter().sum::<f32>();
            let is_bone = |joint: JointIdx| {
                let carries = |ancestor: JointIdx| bound.area[ancestor] > 0.0;
                readings[joint].is_control && bound.area[joint] >= fair && !ancestors(rig, joint).any(carries)
            };
            let mut is_part: Vec<bool> = (0..readings.len())
                .map(|joint| {
                    let is_body = readings[joint].part != Some(Part::Appendix) || is_bone(joint);
                    (moves_skin(joint) || is_twin(joint)) && is_body
                })
                .collect();
            bare_limbs(rig, bound, &readings).into_iter().for_each(|joint| is_part[joint] = true);
            let carriers = Carriers::of(&readings, bound, |joint| is_part[joint]);
            let named = Graph::of(rig, bound, |joint| is_part[joint], |joint| carriers.of_joint(joint));
            if let Some(named) = named {
                symmetry = Symmetry::find(&named, bound.size());
                graph = named;
            }
        }
        Some((Self { rig, bound, hints, graph, symmetry, readings }, notes))
    }

    /// Drafts the roles: stated by the file, else by shape, else by names, else generic.
    fn draft(&self, notes: &mut Vec<String>) -> Draft {
        if let Some(stated) = self.stated_draft() {
            notes.push("roles are those that the file states".into());
            return stated;
        }
        let human = |up: Vec3| self.recognise(up).filter(|found| !self.is_beast(found));
        // Tries the file's own up axis first, because some bodies also look like a lying human.
        let ups = self.hints.up.into_iter().filter(|up| up.dot(self.symmetry.lateral).abs() < 0.5);
        let found = ups.chain(possible_ups(self.symmetry.lateral)).find_map(|up| Some((up, human(up)?)));
        if let Some((up, humanoid)) = found {
            let mut draft = self.shape_draft(up, &humanoid, notes);
            self.correct_limbs(&mut draft);
            return draft;
        }
        if let Some(named) = self.named_draft() {
            notes.push("the shape is not clear: roles are those of the names".into());
            return named;
        }
        notes.push("no human shape: generic roles".into());
        self.generic_draft(notes)
    }

    /// Distance of a joint from the midline toward `left`, a direction perpendicular to up.
    pub fn toward(&self, left: Vec3, joint: JointIdx) -> f32 {
        let lateral = self.symmetry.lateral;
        (self.bound.model[joint].translation.dot(lateral) - self.symmetry.centre) * left.dot(lateral)
    }

    /// Drafts a human from the known roles and names; fails with the missing roles.
    pub fn known_draft(&self, known: &[(Role, JointIdx)]) -> Result<Draft, Vec<Role>> {
        let mut all = known.to_vec();
        for (joint, reading) in self.readings.iter().enumerate() {
            let Some(role) = reading.part.and_then(|part| role_of(part, reading.side)) else { continue };
            if all.iter().all(|&(other, at)| other != role && at != joint) {
                all.push((role, joint));
            }
        }
        let missing: Vec<Role> = needed().filter(|role| all.iter().all(|(other, _)| other != role)).collect();
        let mut draft = self.draft_of(all, Basis::Name).ok_or(missing)?;
        self.add_named(&mut draft.roles);
        Ok(draft)
    }

    fn node_readings(&self) -> Vec<Reading> {
        self.graph.nodes.iter().map(|node| self.readings[node.joint].clone()).collect()
    }

    fn recognise(&self, up: Vec3) -> Option<Humanoid> {
        #[expect(
            clippy::redundant_closure_for_method_calls,
            reason = "the method itself is of one lifetime only"
        )]
        self.with_evidence(up, |evidence| evidence.recognise())
    }

    fn with_evidence<T>(&self, up: Vec3, see: impl FnOnce(&Evidence<'_>) -> T) -> T {
        let stance = Stance::new(self.bound, up);
        let readings = self.node_readings();
        see(&Evidence {
            graph: &self.graph,
            symmetry: &self.symmetry,
            stance: &stance,
            readings: &readings,
            swing: &|end| self.swing(up, end).map_or(0.0, |(swing, _)| swing.reach),
        })
    }

    /// Returns the swing of the limb that ends at a node against its mirror image, and the limb's first node; `None`
    /// without a mirror image.
    fn swing(&self, up: Vec3, end: usize) -> Option<(Swing, usize)> {
        let other = self.symmetry.other(end)?;
        let mut line: Vec<usize> =
            self.graph.up_from(end).take_while(|&node| !self.symmetry.on_midline(node)).collect();
        let begin = line.pop()?;
        let carrier = self.graph.nodes[self.graph.nodes[begin].parent?].joint;
        let pair = Pair {
            carrier,
            bind: self.bound.model[carrier],
            ends: [end, other].map(|node| self.graph.nodes[node].joint),
            forward: self.symmetry.lateral.cross(up),
            up,
            height: Stance::new(self.bound, up).height,
        };
        Some((self.hints.gait.swing(&pair), begin))
    }

    /// Returns the ends of limbs near the floor, one of each mirrored pair.
    fn low_ends(&self, up: Vec3) -> impl Iterator<Item = usize> + '_ {
        let stance = Stance::new(self.bound, up);
        (0..self.graph.nodes.len()).filter(move |&end| {
            let node = &self.graph.nodes[end];
            let is_first = self.symmetry.other(end).is_some_and(|other| other > end);
            is_first && node.children.is_empty() && stance.level(node.position) < 0.25
        })
    }

    /// Returns the longest stride of alternately swinging limbs near the floor, seconds, and the height of the limb's
    /// start, file units.
    fn stride(&self, up: Vec3) -> Option<(f32, f32)> {
        if self.hints.gait.is_empty() {
            return None;
        }
        let stance = Stance::new(self.bound, up);
        let strides = self.low_ends(up).filter_map(|end| self.swing(up, end));
        let strides = strides.filter(|(swing, _)| swing.stride > 0.0);
        let longest = strides.reduce(|a, b| if b.0.stride > a.0.stride { b } else { a })?;
        let (swing, begin) = longest;
        Some((swing.stride, stance.level(self.graph.nodes[begin].position) * stance.height))
    }

    /// Returns the mean correlation of height and speed along `forward` of alternately swinging limbs near the floor,
    /// weighted by swing: positive if the body walks toward `forward`.
    fn walks_toward(&self, up: Vec3) -> f32 {
        let swings = self.low_ends(up).filter_map(|end| self.swing(up, end));
        let (sum, weight) = swings.fold((0.0, 0.0), |(sum, weight), (swing, _)| {
            (sum + swing.reach * swing.ahead, weight + swing.reach)
        });
        if weight > 0.0 { sum / weight } else { 0.0 }
    }

    /// True if names contradict the shape: arms named as wings, a head named as a tail, or arms and legs named as limbs
    /// of a quadruped.
    fn is_beast(&self, found: &Humanoid) -> bool {
        let arms = found.arms.chain.iter().flatten().map(|&node| self.graph.nodes[node].joint);
        if arms.into_iter().any(|joint| self.readings[joint].is_wing) {
            return true;
        }
        let top = found.neck.iter().chain([&found.head]).map(|&node| self.graph.nodes[node].joint);
        if top.into_iter().any(|joint| self.readings[joint].part == Some(Part::Tail)) {
            return true;
        }
        let is_named = |limb: &Limb| {
            let mut joints = limb.chain.iter().flatten().map(|&node| self.graph.nodes[node].joint);
            joints.any(|joint| self.readings[joint].part == Some(Part::Beast))
        };
        is_named(&found.arms) && is_named(&found.legs)
    }

    /// Returns the left direction by names, unless several signs of the shape contradict them; else by the feet, the
    /// walking direction, the elbows; else so that the body faces the file's +Z.
    fn left(&self, up: Vec3, ankles: &[Vec3], arms: Option<&Limb>, notes: &mut Vec<String>) -> Vec3 {
        let lateral = self.symmetry.lateral;
        let forward = lateral.cross(up);
        let lead = feet_lead(self.bound, &Stance::new(self.bound, up), forward, ankles);
        let named = left_by_name(&self.graph, &self.symmetry, &self.node_readings());
        let elbows =
            arms.map_or(0.0, |arms| self.with_evidence(up, |seen| seen.elbows_behind(arms, forward)));
        let feet = if lead.abs() > FEET_AGAINST_NAMES { lead.signum() } else { 0.0 };
        let bent = if elbows.abs() > ELBOWS_BEHIND { elbows.signum() } else { 0.0 };
        if named != 0.0 && named * feet >= 0.0 {
            return lateral * named;
        }
        let steps = if named == 0.0 && feet != 0.0 { 0.0 } else { self.walks_toward(up) };
        let walk = if steps.abs() > STEP_CORRELATION { steps.signum() } else { 0.0 };
        if named != 0.0 {
            // The feet contradict the names, but a single heel, claw or boot may cause that.
            let shape = [feet, walk, bent, self.toes_lead(up, forward)];
            let against: f32 = shape.into_iter().map(|sign| -named * sign).sum();
            if against <= 0.0 {
                return lateral * named;
            }
            let (left, which) =
                if against >= 2.0 { (-named, "the shape counts") } else { (named, "the names count") };
            notes.push(format!(
                "the feet point opposite to the front that the names of left and right imply: {which}, and the front of the body is in doubt"
            ));
            return lateral * left;
        }
        if feet == 0.0 && walk != 0.0 {
            notes.push(
                "the feet hardly show the front of the body: it is taken from the walking direction".into(),
            );
            return lateral * walk;
        }
        if feet == 0.0 && bent != 0.0 {
            notes.push("the feet hardly show the front of the body: it is taken from the elbows".into());
            return lateral * bent;
        }
        // If the feet extend by at least half a per cent of the height, they show the front; less is noise.
        if lead.abs() > LEAST_FOOT {
            return lateral * lead.signum();
        }
        notes.push("the feet do not show the front of the body".into());
        let ahead = if up.y.abs() > 0.5 { Vec3::Z } else { -Vec3::Y };
        lateral * if forward.dot(ahead) < 0.0 { -1.0 } else { 1.0 }
    }

    /// Returns the sign of the direction from feet to toes, by name, along `forward`; 0 if unclear.
    fn toes_lead(&self, up: Vec3, forward: Vec3) -> f32 {
        let height = Stance::new(self.bound, up).height;
        let place = |part: Part, side: Side| {
            let is = |reading: &Reading| reading.part == Some(part) && reading.side == Some(side);
            self.readings.iter().position(is).map(|joint| self.bound.model[joint].translation)
        };
        let lead = |side: Side| Some((place(Part::Toes, side)? - place(Part::Foot, side)?).dot(forward));
        let sum: f32 = [Side::Left, Side::Right].into_iter().filter_map(lead).sum();
        if sum.abs() > FEET_AGAINST_NAMES * height { sum.signum() } else { 0.0 }
    }

    fn shape_draft(&self, up: Vec3, found: &Humanoid, notes: &mut Vec<String>) -> Draft {
        let legs = &found.legs;
        let ankles = legs.chain.each_ref().map(|chain| self.ankle(chain, legs.split));
        let left = self.left(up, &ankles, Some(&found.arms), notes);
        let first = if left.dot(self.symmetry.lateral) > 0.0 { Side::Left } else { Side::Right };
        let mut roles = vec![None; self.rig.joints.len()];
        let mut set_joint = |joint: JointIdx, role: Role| {
            roles[joint] = Some(RoleGuess::new(role, basis(role, &self.readings[joint])));
        };
        let parts = [Role::Spine, Role::Chest, Role::UpperChest];
        let spine = self.with_bare(&found.spine, Part::Spine);
        for (place, role) in thirds(spine.len()).zip(parts) {
            set_joint(spine[place], role);
        }
        if let Some(&neck) = self.with_bare(&found.neck, Part::Neck).first() {
            set_joint(neck, Role::Neck);
        }
        let mut set = |node: usize, role: Role| set_joint(self.graph.nodes[node].joint, role);
        set(found.pelvis, Role::Hips);
        set(found.head, Role::Head);
        for (k, side) in [(0, first), (1, first.mirror())] {
            for (node, role) in arm_roles(&found.arms, k, side).into_iter().chain(leg_roles(legs, k, side)) {
                set(node, role);
            }
        }
        self.add_named(&mut roles);
        Draft { roles, humanoid: true, up, left }
    }

    /// Uses the named joints of limbs if the names distinguish all long bones of both sides. A cuff or a clavicle may
    /// look like an upper arm.
    fn correct_limbs(&self, draft: &mut Draft) {
        let mut named: Vec<(Role, JointIdx)> = Vec::new();
        for (joint, reading) in self.readings.iter().enumerate() {
            let Some(role) = reading.part.and_then(|part| role_of(part, reading.side)) else { continue };
            let is_part = self.graph.nodes.iter().any(|node| node.joint == joint);
            if role.side().is_some() && is_part && named.iter().all(|(other, _)| *other != role) {
                named.push((role, joint));
            }
        }
        let tells = |role: Role| named.iter().any(|(other, _)| *other == role);
        if !needed().filter(|role| role.side().is_some()).all(tells) {
            return;
        }
        let at_side = |&(role, joint): &(Role, JointIdx)| {
            (self.toward(draft.left, joint) > 0.0) == (role.side() == Some(Side::Left))
        };
        if !named.iter().all(at_side) {
            return;
        }
        for &(role, joint) in &named {
            let holds = |guess: &Option<RoleGuess>| guess.is_some_and(|guess| guess.role == role);
            match draft.roles.iter().position(holds) {
                Some(holder) if holder == joint => continue,
                Some(holder) => draft.roles[holder] = None,
                None => {}
            }
            draft.roles[joint] = Some(RoleGuess::new(role, Basis::Name));
        }
    }

    /// Returns the joints of a chain of the trunk, with joints without skin between and directly above them that are
    /// named as the same part.
    fn with_bare(&self, chain: &[usize], part: Part) -> Vec<JointIdx> {
        let mut joints: Vec<JointIdx> = chain.iter().map(|&node| self.graph.nodes[node].joint).collect();
        let (Some(&first), Some(&last)) = (joints.first(), joints.last()) else { return joints };
        let named = |joint: &JointIdx| self.readings[*joint].part == Some(part);
        let mut path: Vec<JointIdx> = Vec::new();
        let mut passed_first = false;
        for joint in core::iter::once(last).chain(ancestors(self.rig, last)) {
            if passed_first && !(named(&joint) && self.bound.area[joint] <= 0.0) {
                break;
            }
            path.push(joint);
            passed_first |= joint == first;
        }
        if passed_first {
            path.retain(|joint| joints.contains(joint) || named(joint) && self.bound.area[*joint] <= 0.0);
            path.reverse();
            joints = path;
        }
        joints
    }

    /// Position of the ankle: the foot's node, or the end of the shank if the foot moves no skin.
    fn ankle(&self, chain: &[usize], split: Split) -> Vec3 {
        let node = chain[split.2.unwrap_or(split.1)];
        let joint = self.graph.nodes[node].joint;
        let bare_end =
            |&end: &JointIdx| self.rig.joints[end].parent == Some(joint) && self.bound.area[end] <= 0.0;
        let end = (0..self.rig.joints.len()).find(bare_end).filter(|_| split.2.is_none());
        self.bound.model[end.unwrap_or(joint)].translation
    }

    /// Adds parts that the shape does not show, by name: feet without skin beside the body, hands of arms posed
    /// differently on the two sides, a neck without skin.
    fn add_named(&self, roles: &mut [Option<RoleGuess>]) {
        let mut add = |role: Role, part: Part, on: Role| {
            let has = |role: Role| roles.iter().position(|r| r.is_some_and(|guess| guess.role == role));
            let (Some(on), None) = (has(on), has(role)) else { return };
            let named = |&joint: &JointIdx| {
                let (reading, side) = (&self.readings[joint], self.readings[on].side);
                let same_side =
                    if side.is_some() { reading.side == side } else { self.on_side_of(joint, on) };
                reading.part == Some(part) && roles[joint].is_none() && (part == Part::Neck || same_side)
            };
            // Among several joints, takes the one in line with its parent, because controls also have the names of
            // bones.
            let is_above =
                |above: JointIdx, joint: JointIdx| ancestors(self.rig, joint).any(|at| at == above);
            let all: Vec<JointIdx> = (0..roles.len()).filter(named).collect();
            let in_line = all.iter().find(|&&joint| is_above(on, joint) || is_above(joint, on));
            if let Some(&joint) = in_line.or(all.first()) {
                roles[joint] = Some(RoleGuess::new(role, Basis::Name));
            }
        };
        add(Role::Neck, Part::Neck, Role::Head);
        for side in [Side::Left, Side::Right] {
            add(Role::Shoulder(side), Part::Clavicle, Role::UpperArm(side));
            add(Role::Hand(side), Part::Hand, Role::LowerArm(side));
            add(Role::Foot(side), Part::Foot, Role::LowerLeg(side));
        }
    }

    fn on_side_of(&self, joint: JointIdx, other: JointIdx) -> bool {
        let side =
            |j: JointIdx| self.bound.model[j].translation.dot(self.symmetry.lateral) - self.symmetry.centre;
        side(joint) * side(other) > 0.0
    }

    /// Drafts the roles that the file states, if they form a body.
    fn stated_draft(&self) -> Option<Draft> {
        let stated = self.rig.stated_roles.iter();
        let known = stated.filter_map(|(name, joint)| Some((Role::from_name(name)?, *joint)));
        self.draft_of(known.filter(|&(_, joint)| joint < self.rig.joints.len()).collect(), Basis::Stated)
    }

    /// Drafts the roles by trusted names, if they form a body and the hands do not stand on the floor.
    fn named_draft(&self) -> Option<Draft> {
        if self.readings.iter().any(|reading| reading.part == Some(Part::Beast)) {
            return None;
        }
        let mut found: Vec<(Role, JointIdx)> = Vec::new();
        let (mut spine, mut necks): (Vec<usize>, Vec<usize>) = Default::default();
        for &i in &self.graph.order {
            let joint = self.graph.nodes[i].joint;
            let Reading { part: Some(part), side, .. } = &self.readings[joint] else { continue };
            if *part == Part::Spine {
                spine.push(i);
            } else if *part == Part::Neck {
                necks.push(i);
            } else if let Some(role) =
                role_of(*part, *side).filter(|role| found.iter().all(|(r, _)| r != role))
            {
                found.push((role, joint));
            }
        }
        let parts = [Role::Spine, Role::Chest, Role::UpperChest];
        if found.iter().all(|(role, _)| *role != Role::Head) {
            found.extend(self.bare_head(&spine, &necks).map(|head| (Role::Head, head)));
        }
        necks.truncate(1);
        found.extend(self.with_bare(&necks, Part::Neck).first().map(|&neck| (Role::Neck, neck)));
        let spine = self.with_bare(&spine, Part::Spine);
        found.extend(thirds(spine.len()).zip(parts).map(|(place, role)| (role, spine[place])));
        let mut draft = self.draft_of(found, Basis::Name)?;
        self.add_named(&mut draft.roles);
        let stance = Stance::new(self.bound, draft.up);
        let level = |role: Role| {
            let joint = draft.roles.iter().position(|r| r.is_some_and(|guess| guess.role == role));
            joint.map(|joint| stance.level(self.bound.model[joint].translation))
        };
        // True if the hands are in the lowest third of the leg.
        let low = |side: Side| {
            let foot = level(Role::Foot(side)).unwrap_or(0.0);
            let leg = level(Role::UpperLeg(side)).map_or(0.0, |hip| hip - foot);
            level(Role::Hand(side)).is_some_and(|hand| hand < foot + 0.35 * leg)
        };
        let walks_on_hands = [Side::Left, Side::Right].into_iter().any(low);
        if !self.stands(&draft) || self.is_on_all_fours(&draft) {
            return None;
        }
        (!walks_on_hands).then_some(draft)
    }

    /// Returns the joint without skin that is named as the head and stands above a part of the spine or the neck.
    fn bare_head(&self, spine: &[usize], necks: &[usize]) -> Option<JointIdx> {
        let trunk = || spine.iter().chain(necks).map(|&node| self.graph.nodes[node].joint);
        let is_head = |&joint: &JointIdx| {
            let on_trunk = || ancestors(self.rig, joint).any(|above| trunk().any(|part| part == above));
            self.readings[joint].part == Some(Part::Head) && self.bound.area[joint] <= 0.0 && on_trunk()
        };
        (0..self.readings.len()).find(is_head)
    }

    fn joint_in(&self, draft: &Draft, role: Role) -> Option<JointIdx> {
        draft.roles.iter().position(|guess| guess.is_some_and(|guess| guess.role == role))
    }

    /// Mean of the vertices that a joint moves most.
    fn middle(&self, joint: JointIdx) -> Option<Vec3> {
        let own = self.bound.vertices.iter().zip(&self.bound.movers).filter(|(_, mover)| **mover == joint);
        let (sum, count) =
            own.fold((Vec3::ZERO, 0.0), |(sum, count), (vertex, _)| (sum + *vertex, count + 1.0));
        (count > 0.0).then(|| sum / count)
    }

    /// True if the legs point away from the head; in quadrupeds with human names the legs are perpendicular to the
    /// trunk.
    fn stands(&self, draft: &Draft) -> bool {
        let place = |role: Role| {
            let joint = draft.roles.iter().position(|r| r.is_some_and(|guess| guess.role == role));
            joint.map(|joint| self.bound.model[joint].translation)
        };
        let along = |side: Side| {
            let thigh = self.joint_in(draft, Role::UpperLeg(side))?;
            let end =
                place(Role::Foot(side)).or(place(Role::LowerLeg(side))).or_else(|| self.middle(thigh))?;
            let leg = end - self.bound.model[thigh].translation;
            Some(leg.dot(draft.up) / sinew_math::max(leg.length(), 1e-12))
        };
        [Side::Left, Side::Right].into_iter().filter_map(along).all(|down| down < -0.5)
    }

    /// True if the trunk is horizontal and arms and legs hang down from it, by the file's up axis: a quadruped with
    /// human names.
    fn is_on_all_fours(&self, draft: &Draft) -> bool {
        let Some(up) = self.hints.up else { return false };
        let rise = |from: Role, to: Role| {
            let bone = self.bound.model[self.joint_in(draft, to)?].translation
                - self.bound.model[self.joint_in(draft, from)?].translation;
            Some(bone.dot(up) / sinew_math::max(bone.length(), 1e-12))
        };
        let hangs = |upper: fn(Side) -> Role, ends: [fn(Side) -> Role; 2]| {
            [Side::Left, Side::Right].into_iter().all(|side| {
                let end = ends.into_iter().find_map(|end| rise(upper(side), end(side)));
                end.is_some_and(|rise| rise < -HANGING)
            })
        };
        rise(Role::Hips, Role::Head).is_some_and(|rise| rise.abs() < HANGING)
            && hangs(Role::UpperArm, [Role::Hand, Role::LowerArm])
            && hangs(Role::UpperLeg, [Role::Foot, Role::LowerLeg])
    }

    /// Drafts a body from known roles; `None` if hips, head, or one of the upper limbs is missing.
    fn draft_of(&self, known: Vec<(Role, JointIdx)>, basis: Basis) -> Option<Draft> {
        let joint_of = |role: Role| known.iter().find(|(r, _)| *r == role).map(|&(_, joint)| joint);
        let place = |role: Role| joint_of(role).map(|joint| self.bound.model[joint].translation);
        let up = snap(place(Role::Head)? - place(Role::Hips)?);
        let mut across = Vec3::ZERO;
        for limb in [Role::UpperArm, Role::UpperLeg] {
            across += place(limb(Side::Left))? - place(limb(Side::Right))?;
        }
        for limb in [Role::LowerArm, Role::LowerLeg] {
            if let (Some(left), Some(right)) = (place(limb(Side::Left)), place(limb(Side::Right))) {
                across += left - right;
            }
        }
        let left = snap(across - up * across.dot(up));
        if left.dot(up).abs() > 0.5 {
            return None;
        }
        let mut roles = vec![None; self.rig.joints.len()];
        for (role, joint) in known {
            roles[joint] = Some(RoleGuess::new(role, basis));
        }
        Some(Draft { roles, humanoid: true, up, left })
    }

    fn generic_draft(&self, notes: &mut Vec<String>) -> Draft {
        let up = self.hints.up.unwrap_or_else(|| up_by_feet(&self.graph, self.bound, &self.symmetry));
        let lateral = self.symmetry.lateral;
        let stance = Stance::new(self.bound, up);
        let foot = |&i: &usize| {
            let node = &self.graph.nodes[i];
            node.children.is_empty() && self.symmetry.other(i).is_some() && stance.level(node.position) < 0.25
        };
        let feet: Vec<Vec3> =
            (0..self.graph.nodes.len()).filter(foot).map(|i| self.graph.nodes[i].position).collect();
        // A body without pairs may have a plane of symmetry across its up axis.
        let left = if lateral.dot(up).abs() < 0.5 { self.left(up, &feet, None, notes) } else { Vec3::X };
        let mut roles = vec![None; self.rig.joints.len()];
        let parts: Vec<Option<Part>> =
            self.graph.nodes.iter().map(|node| self.readings[node.joint].part).collect();
        let generic = generic_roles(&self.graph, &self.symmetry, left, &parts);
        for (node, role) in self.graph.nodes.iter().zip(generic) {
            roles[node.joint] = Some(RoleGuess::new(role, Basis::Place));
        }
        Draft { roles, humanoid: false, up, left }
    }
}

/// Trust in the names of a rig, from a comparison of the names of mirrored pairs.
enum Trust {
    /// The names are mirrored.
    All,
    /// Both joints of a pair have one name except for numbers ("Leg.1", "Leg.2"), so only words of the midline and of
    /// appendices count.
    Words,
    /// The names of pairs do not match; holds the numbers of matching pairs and of all pairs.
    Nothing { agreeing: usize, pairs: usize },
}

impl Trust {
    fn of(graph: &Graph, symmetry: &Symmetry, readings: &[Reading], bound: &Bound) -> Self {
        let (mut agreeing, mut alike, mut pairs) = (0, 0, 0);
        for (i, node) in graph.nodes.iter().enumerate() {
            let Some(other) = symmetry.other(i).filter(|&k| k > i) else { continue };
            let (a, b) = (&readings[node.joint], &readings[graph.nodes[other].joint]);
            pairs += 1;
            if a.key == b.key {
                agreeing += usize::from(a.side.is_some() && a.side.map(Side::mirror) == b.side);
                alike += usize::from(a.side.is_none() && b.side.is_none() && !a.key.is_empty());
            }
        }
        let most = |count: usize| 10 * count >= 6 * pairs;
        let agree = pairs == 0 && sides_pair_up(readings) || pairs > 0 && most(agreeing);
        if agree || sides_agree(readings, bound) {
            Self::All
        } else if pairs > 0 && most(alike) {
            Self::Words
        } else {
            Self::Nothing { agreeing, pairs }
        }
    }

    fn note(&self) -> Option<String> {
        let &Self::Nothing { agreeing, pairs } = self else { return None };
        (pairs > 0)
            .then(|| format!("names of only {agreeing} of {pairs} mirrored pairs match: names are ignored"))
    }

    /// Drops untrusted names.
    fn forget(&self, readings: &mut [Reading]) {
        use Part::{Appendix, Beast, Head, Neck, Spine, Tail};
        let keeps = |reading: &Reading| match self {
            Self::All => true,
            Self::Words => {
                matches!(reading.part, Some(Appendix | Beast | Head | Neck | Spine | Tail))
            }
            Self::Nothing { .. } => reading.part == Some(Beast),
        };
        readings
            .iter_mut()
            .filter(|reading| !keeps(reading))
            .for_each(|reading| *reading = Reading::default());
    }
}

/// True if nearly every part with a side is named on both sides; for a bind pose without mirror symmetry.
fn sides_pair_up(readings: &[Reading]) -> bool {
    let mut sides: Vec<(&str, Side)> = readings
        .iter()
        .filter_map(|reading| reading.part.and(reading.side).map(|side| (reading.key.as_str(), side)))
        .collect();
    let all = sides.len();
    sides.sort_unstable();
    let paired =
        sides.iter().filter(|(key, side)| sides.binary_search(&(key, side.mirror())).is_ok()).count();
    all >= 8 && 10 * paired >= 9 * all
}

/// Returns at most three evenly spaced positions in a chain, including the first.
fn thirds(length: usize) -> impl Iterator<Item = usize> {
    let count = length.min(3);
    (0..count).map(move |k| k * length / count)
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

/// Returns the evidence for a role found by shape: whether the name agrees, contradicts, or gives no part.
fn basis(role: Role, reading: &Reading) -> Basis {
    let Some(part) = reading.part else { return Basis::Shape };
    // Rigify and CesiumMan name the pelvis as a part of the spine.
    if role == Role::Hips && part == Part::Spine {
        return Basis::Shape;
    }
    let wrong_side = reading.side.is_some() && role.side().is_some() && reading.side != role.side();
    if part_of(role) == Some(part) && !wrong_side { Basis::ShapeAndName } else { Basis::ShapeAgainstName }
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

/// Returns the humanoid role of a part and a side; roles of the spine also depend on the position in the chain.
fn role_of(part: Part, side: Option<Side>) -> Option<Role> {
    let fits = |role: &Role| part_of(*role) == Some(part) && role.side() == side;
    super::role::HUMANOID_ROLES.into_iter().filter(|_| part != Part::Spine).find(fits)
}
