//! Chooses the joints that become bodies, the joints merged into them, and their parents.

use super::bind::Bound;
use super::graph::{Graph, ancestors};
use super::role::{Role, Side};
use super::{KeptBone, RoleGuess};
use crate::rig::{JointIdx, Rig};
use crate::roles::tuning::{
    LARGEST_ON_ARMATURE, LARGEST_WORN, LEAST_BODY_SKIN, LEAST_CLAVICLE, LEAST_SPINE_SKIN, ON_BARE_ARM,
    VOTERS, WORN_WITHIN,
};
use crate::skinning::skin_vertices;
use crate::weights::distance_squared;
use sinew_math::{Vec3, max, max3, min, min3};

/// Input of the selection.
pub(super) struct Selection<'a> {
    pub rig: &'a Rig,
    pub bound: &'a Bound,
    pub graph: &'a Graph,
    /// Role per joint.
    pub roles: &'a [Option<RoleGuess>],
    /// Height from floor to crown, file units.
    pub height: f32,
    /// Parent of each joint: the rig's parent, or one found by geometry if that is not suitable.
    pub carrier: Vec<Option<JointIdx>>,
}

/// The bodies, and for each joint the body that it follows.
pub(super) struct Kept {
    pub bones: Vec<KeptBone>,
    pub merge_into: Vec<Option<JointIdx>>,
}

/// Returns the parent of each joint: the rig's parent; for stray trees, the joint to which they were attached; for a
/// stray joint without skin, the bone whose end it marks; for joints at a wrist beside the hand, the hand.
pub(super) fn carriers(
    rig: &Rig,
    bound: &Bound,
    graph: &Graph,
    roles: &[Option<RoleGuess>],
) -> Vec<Option<JointIdx>> {
    let mut carrier: Vec<Option<JointIdx>> = rig.joints.iter().map(|joint| joint.parent).collect();
    let mut in_body = vec![false; rig.joints.len()];
    let mut above = vec![false; rig.joints.len()];
    for node in &graph.nodes {
        in_body[node.joint] = true;
        ancestors(rig, node.joint).for_each(|ancestor| above[ancestor] = true);
    }
    for &stray in &graph.adopted {
        let node = &graph.nodes[stray];
        carrier[node.joint] = node.parent.map(|parent| graph.nodes[parent].joint);
    }
    let mut hangs = in_body.clone();
    for joint in 0..rig.joints.len() {
        hangs[joint] |= rig.joints[joint].parent.is_some_and(|parent| hangs[parent]);
    }
    for joint in 0..rig.joints.len() {
        if hangs[joint] || above[joint] {
            continue;
        }
        let place = bound.model[joint].translation;
        let sits = |&end: &JointIdx| {
            hangs[end]
                && !in_body[end]
                && (bound.model[end].translation - place).length() < 0.01 * bound.size()
        };
        if let Some(end) = (0..rig.joints.len()).find(sits) {
            carrier[joint] = Some(end);
        }
    }
    for (hand, guess) in roles.iter().enumerate() {
        let (Some(Role::Hand(_)), Some(forearm)) = (guess.map(|guess| guess.role), carrier[hand]) else {
            continue;
        };
        let distance =
            |joint: JointIdx| (bound.model[joint].translation - bound.model[hand].translation).length();
        let near = 0.2 * distance(forearm);
        for joint in 0..rig.joints.len() {
            if joint != hand && carrier[joint] == Some(forearm) && distance(joint) < near {
                carrier[joint] = Some(hand);
            }
        }
    }
    carrier
}

impl Selection<'_> {
    /// Returns the bodies of a humanoid: one per role, without toes, tiny clavicles, and parts with too little skin.
    pub fn humanoid(&self) -> Kept {
        let mut joints: Vec<JointIdx> = Vec::new();
        for role in super::role::HUMANOID_ROLES {
            joints.extend(self.joint_of(role).filter(|_| !matches!(role, Role::Toes(_))));
        }
        self.drop_short_clavicles(&mut joints);
        self.join_thin_spine(&mut joints);
        self.drop_bare(&mut joints);
        let place = self.places(&joints);
        let parent = |joint: JointIdx| {
            let parents = self.role(joint).anatomical_parents().iter();
            parents.filter_map(|&role| self.joint_of(role)).find_map(|parent| place[parent])
        };
        self.bones(&joints, parent)
    }

    /// Returns the bodies of a creature: every joint with a fair share of skin.
    pub fn creature(&self) -> Kept {
        let total: f32 = self.bound.area.iter().sum();
        let nodes = &self.graph.nodes;
        // Goes from the tips inward, so that a small toe merges into its foot and adds to its area.
        let mut area: Vec<f32> = nodes.iter().map(|node| node.area).collect();
        for &i in self.graph.order.iter().rev() {
            let Some(parent) = nodes[i].parent else { continue };
            if area[i] < LEAST_BODY_SKIN * total {
                area[parent] += area[i];
            }
        }
        let fair = |&&i: &&usize| i == self.graph.root || area[i] >= LEAST_BODY_SKIN * total;
        let mut joints: Vec<JointIdx> =
            self.graph.order.iter().filter(fair).map(|&i| nodes[i].joint).collect();
        // Sorts by roles, independently of the file: trunk, tail, then limbs, whose parents have smaller numbers.
        joints.sort_by_key(|&joint| match self.role(joint) {
            Role::LimbSegment { limb, segment } => (2, limb, segment),
            Role::TailSegment(segment) => (1, 0, segment),
            Role::SpineSegment(segment) => (0, 0, segment),
            // Creatures have no other roles.
            _ => (3, 0, 0),
        });
        self.parents_first(&mut joints);
        let place = self.places(&joints);
        self.bones(&joints, |joint| place[self.carried_by(joint, |i| place[i].is_some())?])
    }

    /// Moves each part that comes before its parent behind the parent; roles given by the user can cause such an order.
    fn parents_first(&self, joints: &mut Vec<JointIdx>) {
        let mut sorted: Vec<JointIdx> = Vec::with_capacity(joints.len());
        // The root comes first, because joints without a parent are attached to it.
        let root = self.graph.nodes[self.graph.root].joint;
        let root = joints.iter().position(|&joint| joint == root).map(|at| joints.remove(at));
        sorted.extend(root);
        while !joints.is_empty() {
            let waits = |joint: JointIdx| self.carried_by(joint, |at| joints.contains(&at)).is_some();
            let next = joints.iter().position(|&joint| !waits(joint)).unwrap_or(0);
            sorted.push(joints.remove(next));
        }
        *joints = sorted;
    }

    /// Returns the index of each joint among the kept joints.
    fn places(&self, kept: &[JointIdx]) -> Vec<Option<usize>> {
        let mut place = vec![None; self.rig.joints.len()];
        kept.iter().enumerate().for_each(|(i, &joint)| place[joint] = Some(i));
        place
    }

    fn role(&self, joint: JointIdx) -> Role {
        self.roles[joint].as_ref().expect("kept joints have roles").role
    }

    fn joint_of(&self, role: Role) -> Option<JointIdx> {
        self.roles.iter().position(|guess| guess.as_ref().is_some_and(|guess| guess.role == role))
    }

    /// Returns the nearest suitable parent. Attachment cannot form a cycle, but the loop is bounded anyway.
    fn carried_by(&self, joint: JointIdx, wanted: impl Fn(JointIdx) -> bool) -> Option<JointIdx> {
        let chain = core::iter::successors(self.carrier[joint], |&i| self.carrier[i]);
        chain.take(self.rig.joints.len()).find(|&i| wanted(i))
    }

    fn drop_short_clavicles(&self, joints: &mut Vec<JointIdx>) {
        joints.retain(|&joint| match self.role(joint) {
            Role::Shoulder(side) => self.joint_of(Role::UpperArm(side)).is_some_and(|arm| {
                let bone = self.bound.model[arm].translation - self.bound.model[joint].translation;
                bone.length() >= LEAST_CLAVICLE * self.height
            }),
            _ => true,
        });
    }

    /// Merges parts of the spine with hardly any skin with the part above, which then rotates at the lower joint.
    fn join_thin_spine(&self, joints: &mut Vec<JointIdx>) {
        let total: f32 = self.bound.area.iter().sum();
        let spine = [Role::Spine, Role::Chest, Role::UpperChest];
        let parts: Vec<JointIdx> =
            joints.iter().copied().filter(|&j| spine.contains(&self.role(j))).collect();
        let mut open = false;
        let mut sum = 0.0;
        for part in parts {
            if open {
                joints.retain(|&joint| joint != part);
            } else {
                sum = 0.0;
            }
            sum += self.bound.area[part] * (1.0 - self.share_on_bare_arms(part));
            open = sum < LEAST_SPINE_SKIN * total;
        }
    }

    /// Share, 0 to 1, of the vertices of a part of the spine that belong to upper arms without skin: beyond the
    /// shoulder, and far nearer to the arm's bone than to the trunk's line.
    fn share_on_bare_arms(&self, part: JointIdx) -> f32 {
        let place = |role: Role| self.joint_of(role).map(|joint| self.bound.model[joint].translation);
        let bare_arm = |side: Side| {
            let upper = self.joint_of(Role::UpperArm(side)).filter(|&upper| self.bound.area[upper] <= 0.0)?;
            Some([self.bound.model[upper].translation, place(Role::LowerArm(side))?])
        };
        let arms: Vec<[Vec3; 2]> = [Side::Left, Side::Right].into_iter().filter_map(bare_arm).collect();
        let (Some(hips), Some(neck)) = (place(Role::Hips), place(Role::Neck).or(place(Role::Head))) else {
            return 0.0;
        };
        let is_on = |at: Vec3, [shoulder, elbow]: [Vec3; 2]| {
            (at - shoulder).dot(elbow - shoulder) > 0.0
                && distance_squared(at, [shoulder, elbow])
                    < ON_BARE_ARM * ON_BARE_ARM * distance_squared(at, [hips, neck])
        };
        let (mut all, mut on_arms) = (0.0, 0.0);
        let moved = self.bound.vertices.iter().zip(&self.bound.movers);
        for (&at, _) in moved.filter(|(_, mover)| **mover == part) {
            all += 1.0;
            on_arms += f32::from(u8::from(arms.iter().any(|&arm| is_on(at, arm))));
        }
        on_arms / max(all, 1.0)
    }

    /// Removes joints without skin that also merge no joints with skin; the root stays.
    fn drop_bare(&self, joints: &mut Vec<JointIdx>) {
        loop {
            let place = self.places(joints);
            let mut area = vec![0.0; joints.len()];
            for joint in 0..self.rig.joints.len() {
                let follows =
                    place[joint].or_else(|| place[self.carried_by(joint, |i| place[i].is_some())?]);
                if let Some(bone) = follows {
                    area[bone] += self.bound.area[joint];
                }
            }
            // A limb's bone without skin is the pivot of the lower part, so it stays.
            let is_limb = |joint: JointIdx| self.graph.nodes.iter().any(|node| node.joint == joint);
            let is_bare = |&i: &usize| area[i] <= 0.0 && !is_limb(joints[i]);
            let Some(bare) = (1..joints.len()).find(is_bare) else { return };
            joints.remove(bare);
        }
    }

    /// Returns the index of the kept joint that each joint follows: its parent, else the joint with connected skin,
    /// else that of the joint above it, else the nearest. Joints without skin and parent follow none.
    fn owners(&self, joints: &[JointIdx], place: &[Option<usize>]) -> Vec<Option<usize>> {
        let mut owner = place.to_vec();
        let mut waiting: Vec<JointIdx> = Vec::new();
        for joint in (0..self.rig.joints.len()).filter(|&joint| place[joint].is_none()) {
            match self.carried_by(joint, |i| place[i].is_some()) {
                Some(carrier) => owner[joint] = place[carrier],
                None if self.bound.area[joint] > 0.0 || self.is_worn(joint) => waiting.push(joint),
                None => {}
            }
        }
        // Starts with the strongest connection: a finger follows the hand through the finger joint before it. Of equal
        // ones, the shorter comes first.
        loop {
            let mut best: Option<(u32, f32, usize, usize)> = None;
            for (at, &joint) in waiting.iter().enumerate() {
                let mut links = vec![0; joints.len()];
                for (&(a, b), &count) in &self.bound.links {
                    let other = if a == joint { b } else { a };
                    if let Some(owner) = owner[other].filter(|_| a == joint || b == joint) {
                        links[owner] += count;
                    }
                }
                for body in (0..links.len()).filter(|&body| links[body] > 0) {
                    let way =
                        self.bound.model[joint].translation - self.bound.model[joints[body]].translation;
                    let (count, away) = (links[body], way.length());
                    if best.is_none_or(|(most, least, ..)| count > most || count == most && away < least) {
                        best = Some((count, away, at, body));
                    }
                }
            }
            let Some((_, _, at, body)) = best else { break };
            owner[waiting.remove(at)] = Some(body);
        }
        // Parents come first: strands of hair follow the owner of their root, not the nearest part of each.
        for joint in waiting {
            let above = ancestors(self.rig, joint).find_map(|above| owner[above]);
            owner[joint] = Some(above.unwrap_or_else(|| self.nearest(joint, joints, &owner)));
        }
        self.own_hung(&mut owner);
        self.own_beside(&mut owner);
        // Joints below a node that follows a body: hair on a head without a bone.
        for joint in 0..self.rig.joints.len() {
            let parent = self.rig.joints[joint].parent.filter(|&parent| place[parent].is_none());
            owner[joint] = owner[joint].or_else(|| owner[parent?]);
        }
        owner
    }

    /// True if a node without a bone carries a mesh smaller than the body and within or close to it: a hat, eyes or a
    /// pack without a parent. A mesh directly on the skeleton's node only has to touch the body: a head parented to the
    /// armature.
    fn is_worn(&self, joint: JointIdx) -> bool {
        let (mut positions, mut normals) = (Vec::new(), Vec::new());
        let margin = Vec3::splat(WORN_WITHIN * self.bound.size());
        let (lo, hi) = (self.bound.lo - margin, self.bound.hi + margin);
        let (mut all, mut within) = (0, 0);
        let mut extent: Option<(Vec3, Vec3)> = None;
        for (m, p) in self.rigid_parts(joint) {
            skin_vertices(self.rig, m, p, &self.bound.model, &mut positions, &mut normals);
            all += positions.len();
            within += positions.iter().filter(|at| min3(max3(**at, lo), hi) == **at).count();
            for &at in &positions {
                let (low, high) = extent.unwrap_or((at, at));
                extent = Some((min3(low, at), max3(high, at)));
            }
        }
        let sides = extent.map_or(Vec3::ZERO, |(low, high)| high - low);
        let longest = max(sides.x, max(sides.y, sides.z));
        let (is_close, largest) = if self.hangs_on_armature(joint) {
            (true, LARGEST_ON_ARMATURE)
        } else {
            (2 * within > all, LARGEST_WORN)
        };
        within > 0 && is_close && longest < largest * self.bound.size()
    }

    /// True if no bone is between a node and the skeleton's node.
    fn hangs_on_armature(&self, joint: JointIdx) -> bool {
        self.hung_on_armature(joint).is_some()
    }

    /// Returns the ancestor of a joint (or the joint itself) directly below the skeleton's node; `None` if a bone is in
    /// between. In converted files a mesh may be a node below its object.
    fn hung_on_armature(&self, joint: JointIdx) -> Option<JointIdx> {
        let first = self.graph.nodes[self.graph.root].joint;
        let is_bone = |joint: JointIdx| self.rig.skins.iter().any(|skin| skin.joints.contains(&joint));
        let armature = ancestors(self.rig, first).find(|&above| !is_bone(above))?;
        let line = core::iter::once(joint).chain(ancestors(self.rig, joint));
        line.take_while(|&at| !is_bone(at)).find(|&at| self.rig.joints[at].parent == Some(armature))
    }

    /// Assigns meshes on the armature that touch worn parts to the owner of these parts: eyes in a head without a bone.
    fn own_beside(&self, owner: &mut [Option<usize>]) {
        let extent = |joint: JointIdx| {
            let points = self.points_of_meshes(joint);
            let first = *points.first()?;
            let bounds = points.iter().fold((first, first), |(lo, hi), &at| (min3(lo, at), max3(hi, at)));
            self.hung_on_armature(joint).map(|_| bounds)
        };
        let hung: Vec<(JointIdx, (Vec3, Vec3))> =
            (0..self.rig.joints.len()).filter_map(|joint| Some((joint, extent(joint)?))).collect();
        let longest = |(lo, hi): (Vec3, Vec3)| max((hi - lo).x, max((hi - lo).y, (hi - lo).z));
        let touch = |a: (Vec3, Vec3), b: (Vec3, Vec3)| {
            let overlap = min3(a.1, b.1) - max3(a.0, b.0);
            min(overlap.x, min(overlap.y, overlap.z)) >= -WORN_WITHIN * self.bound.size()
        };
        for &(joint, bounds) in &hung {
            let is_small = longest(bounds) < LARGEST_ON_ARMATURE * self.bound.size();
            if owner[joint].is_some() || !is_small {
                continue;
            }
            let worn = hung.iter().find(|(other, around)| owner[*other].is_some() && touch(*around, bounds));
            owner[joint] = worn.and_then(|(other, _)| owner[*other]);
        }
        self.own_hung(owner);
    }

    /// Assigns nodes on the armature to the owner of the worn parts below them: an object with its mesh node and its
    /// hair.
    fn own_hung(&self, owner: &mut [Option<usize>]) {
        for joint in 0..self.rig.joints.len() {
            if owner[joint].is_none() || self.bound.area[joint] > 0.0 {
                continue;
            }
            let Some(top) = self.hung_on_armature(joint) else { continue };
            let line = core::iter::once(joint).chain(ancestors(self.rig, joint));
            for at in line {
                owner[at] = owner[at].or(owner[joint]);
                if at == top {
                    break;
                }
            }
        }
    }

    /// Returns the index of the kept joint whose skin is nearest to a joint's skin, by votes of the vertices; the first
    /// kept joint if one of both has no skin.
    fn nearest(&self, joint: JointIdx, joints: &[JointIdx], owner: &[Option<usize>]) -> usize {
        let own = self.bound.vertices.iter().zip(&self.bound.movers).filter(|(_, mover)| **mover == joint);
        let mut points: Vec<Vec3> = own.map(|(vertex, _)| *vertex).collect();
        if points.is_empty() {
            points = self.points_of_meshes(joint);
        }
        if points.is_empty() {
            points.push(self.bound.model[joint].translation);
        }
        let mut votes = vec![0; joints.len()];
        for point in points.iter().step_by(points.len().div_ceil(VOTERS)) {
            let others = self.bound.vertices.iter().zip(&self.bound.movers);
            let away = others
                .filter_map(|(vertex, mover)| Some(((*vertex - *point).length_squared(), owner[*mover]?)));
            let nearest = away.reduce(|a, b| if b.0 < a.0 { b } else { a });
            votes[nearest.map_or(0, |(_, body)| body)] += 1;
        }
        (0..votes.len()).reduce(|a, b| if votes[b] > votes[a] { b } else { a }).unwrap_or(0)
    }

    /// Iterates over mesh and primitive of the rigid parts of a node: unskinned meshes, and unweighted parts of others.
    fn rigid_parts(&self, joint: JointIdx) -> impl Iterator<Item = (usize, usize)> + '_ {
        let own = self.rig.meshes.iter().enumerate().filter(move |(_, mesh)| mesh.joint == joint);
        own.flat_map(|(m, mesh)| {
            let is_rigid = |p: &usize| mesh.skin.is_none() || mesh.primitives[*p].joints.is_empty();
            (0..mesh.primitives.len()).filter(is_rigid).map(move |p| (m, p))
        })
    }

    /// Returns the vertices of the rigid parts of a joint, model space.
    fn points_of_meshes(&self, joint: JointIdx) -> Vec<Vec3> {
        let (mut positions, mut normals) = (Vec::new(), Vec::new());
        let mut points = Vec::new();
        for (m, p) in self.rigid_parts(joint) {
            skin_vertices(self.rig, m, p, &self.bound.model, &mut positions, &mut normals);
            points.extend(positions.iter().filter(|at| at.is_finite()));
        }
        points
    }

    fn bones(&self, joints: &[JointIdx], parent: impl Fn(JointIdx) -> Option<usize>) -> Kept {
        let mut bones: Vec<KeptBone> = Vec::with_capacity(joints.len());
        for (i, &joint) in joints.iter().enumerate() {
            let guess = self.roles[joint].as_ref().expect("kept joints have roles");
            bones.push(KeptBone {
                joint,
                role: guess.role,
                confidence: guess.confidence,
                // All kept joints but the first have a parent: the first kept joint if none is nearer.
                parent: parent(joint).or((i > 0).then_some(0)),
                merged: Vec::new(),
                bind_model: self.bound.model[joint],
                is_prop: false,
            });
        }
        let place = self.places(joints);
        let owners = self.owners(joints, &place);
        let mut merge_into = vec![None; self.rig.joints.len()];
        for joint in 0..self.rig.joints.len() {
            if place[joint].is_some() {
                continue;
            }
            if let Some(bone) = owners[joint] {
                bones[bone].merged.push(joint);
                merge_into[joint] = Some(joints[bone]);
            }
        }
        Kept { bones, merge_into }
    }
}
