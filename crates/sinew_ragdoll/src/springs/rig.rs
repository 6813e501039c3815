//! Springs prepared for stepping: in metres, only the relevant joints, parents first.

use super::limit::Limit;
use crate::def::RagdollDef;
use crate::mapping::Mapping;
use sinew_anim::springs::{ColliderShape, SpringLink, Springs};
use sinew_anim::{JointIdx, Rig};
use sinew_math::{Affine, Transform, Vec3, clamp, max, normalize_or};
use sinew_physics::Shape;

/// Joint that is needed by springs: they are attached to it or move with it, or it carries colliders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node {
    pub joint: JointIdx,
    /// Index of the parent among the nodes; smaller than the node's own.
    pub parent: Option<usize>,
    /// Bone that rotates the joint.
    pub bone: Option<usize>,
    /// True if the joint or one of its ancestors swings. Such nodes come after all others.
    pub swings: bool,
    /// True if another node, a collider or a centre is attached to the joint.
    pub carries: bool,
}

/// Bone that swings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bone {
    pub node: usize,
    pub chain: usize,
    /// Tip in the joint's space, file units; `axis` is its direction there, unit.
    pub tail: Vec3,
    pub axis: Vec3,
    /// Length of the bone, file units.
    pub length: f32,
    /// Speed toward the rest pose caused by stiffness, m/s.
    pub stiffness: f32,
    /// Velocity caused by gravity, m/s, character axes. The character's facing does not rotate it.
    pub gravity: Vec3,
    pub drag: f32,
    /// Radius of the tip, metres.
    pub radius: f32,
    pub limit: Option<Limit>,
}

/// Chain of bones.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chain {
    /// Node in whose space inertia is measured.
    pub center: Option<usize>,
    /// Indices of existing colliders.
    pub colliders: Vec<usize>,
    pub hits_body: bool,
}

/// Collider on a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Collider {
    pub node: usize,
    pub shape: ColliderShape,
}

/// Link between two tips.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Link {
    pub bones: [usize; 2],
    /// Distance of the tips in the bind pose, metres.
    pub length: f32,
    pub share: f32,
    pub holds_apart: bool,
}

/// Springs of a kind of character, ready to be stepped. Immutable.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpringRig {
    source: Springs,
    pub(super) nodes: Vec<Node>,
    /// Number of nodes that do not swing; these nodes come first.
    pub(super) stills: usize,
    /// Bones that swing, by node, ascending, so that descendants of a bone come after it.
    pub(super) bones: Vec<Bone>,
    pub(super) chains: Vec<Chain>,
    pub(super) colliders: Vec<Collider>,
    pub(super) links: Vec<Link>,
    /// True if a collider is attached to a swinging node.
    pub(super) swinging_colliders: bool,
    /// Shapes of the ragdoll's bodies, for chains that collide with them.
    pub(super) bodies: Vec<Shape>,
    /// Bit mask, for each bone, of the bodies among the first 64 that the bone does not touch in the bind pose and so
    /// collides with.
    pub(super) meets: Vec<u64>,
    /// Nodes to which chains are attached, each with the largest distance of a tip from the node, metres.
    pub(super) anchors: Vec<(usize, f32)>,
    left_out: Vec<JointIdx>,
}

impl SpringRig {
    /// Prepares the springs of a rig with a ragdoll; `bind_model` is the rig's bind pose in model space. A bone is left
    /// out ([`left_out`](Self::left_out)) if a body moves its joint or a descendant, or if the bone is listed twice,
    /// has no parent, or has no length.
    ///
    /// # Panics
    /// If a named joint or collider does not exist.
    pub fn new(
        rig: &Rig,
        ragdoll: &RagdollDef,
        mapping: &Mapping,
        bind_model: &[Affine],
        springs: &Springs,
    ) -> Self {
        let mut it = Self { source: springs.clone(), ..Self::default() };
        let mut bone_at: Vec<Option<(usize, usize)>> = vec![None; rig.joints.len()];
        for (c, chain) in springs.chains.iter().enumerate() {
            for (b, bone) in chain.bones.iter().enumerate() {
                let hangs = rig.joints[bone.joint].parent.is_some() && bone.tail.length() > 0.0;
                let is_free = !mapping.moves_bodies(bone.joint) && bone_at[bone.joint].is_none();
                if hangs && is_free {
                    bone_at[bone.joint] = Some((c, b));
                } else {
                    it.left_out.push(bone.joint);
                }
            }
        }
        let mut used = vec![false; springs.chains.len()];
        bone_at.iter().flatten().for_each(|&(chain, _)| used[chain] = true);
        let node_of = it.add_nodes(rig, springs, &bone_at, &used);
        it.add_bones(mapping, springs, &bone_at);
        let mut kept: Vec<Option<usize>> = Vec::with_capacity(springs.colliders.len());
        for collider in &springs.colliders {
            let node = node_of[collider.joint];
            kept.push(node.map(|_| it.colliders.len()));
            it.colliders.extend(node.map(|node| Collider { node, shape: collider.shape }));
        }
        it.chains = springs
            .chains
            .iter()
            .map(|chain| Chain {
                center: chain.center.and_then(|joint| node_of[joint]),
                colliders: chain.colliders.iter().filter_map(|&collider| kept[collider]).collect(),
                hits_body: chain.hits_body,
            })
            .collect();
        it.mark_carriers();
        it.swinging_colliders = it.colliders.iter().any(|collider| it.nodes[collider.node].swings);
        it.add_links(mapping, bind_model);
        it.meet_bodies(ragdoll, mapping, bind_model);
        it.add_anchors(mapping, bind_model);
        it
    }

    /// Adds nodes: joints of bones, centres and colliders of chains that have a bone, and all their ancestors. Returns
    /// the node of every joint.
    fn add_nodes(
        &mut self,
        rig: &Rig,
        springs: &Springs,
        bone_at: &[Option<(usize, usize)>],
        used: &[bool],
    ) -> Vec<Option<usize>> {
        let mut needed: Vec<bool> = bone_at.iter().map(Option::is_some).collect();
        for chain in springs.chains.iter().zip(used).filter(|(_, used)| **used).map(|(chain, _)| chain) {
            chain.center.iter().for_each(|&joint| needed[joint] = true);
            chain.colliders.iter().for_each(|&c| needed[springs.colliders[c].joint] = true);
        }
        for joint in (0..needed.len()).rev() {
            if let Some(parent) = rig.joints[joint].parent.filter(|_| needed[joint]) {
                needed[parent] = true;
            }
        }
        let mut swings: Vec<bool> = Vec::with_capacity(needed.len());
        for (joint, bone) in rig.joints.iter().zip(bone_at) {
            swings.push(bone.is_some() || joint.parent.is_some_and(|parent| swings[parent]));
        }
        let swings = &swings;
        let joints = |swing: bool| (0..swings.len()).filter(move |&joint| swings[joint] == swing);
        let mut node_of: Vec<Option<usize>> = vec![None; needed.len()];
        let mut bones = 0;
        for joint in joints(false).chain(joints(true)).filter(|&joint| needed[joint]) {
            let parent = rig.joints[joint].parent.and_then(|parent| node_of[parent]);
            let bone = bone_at[joint].map(|_| bones);
            bones += usize::from(bone.is_some());
            node_of[joint] = Some(self.nodes.len());
            self.nodes.push(Node { joint, parent, bone, swings: swings[joint], carries: false });
        }
        self.stills = self.nodes.iter().filter(|node| !node.swings).count();
        node_of
    }

    fn mark_carriers(&mut self) {
        let parents = self.nodes.iter().filter_map(|node| node.parent);
        let centers = self.chains.iter().filter_map(|chain| chain.center);
        let colliders = self.colliders.iter().map(|collider| collider.node);
        let carriers: Vec<usize> = parents.chain(centers).chain(colliders).collect();
        carriers.into_iter().for_each(|node| self.nodes[node].carries = true);
    }

    fn add_bones(&mut self, mapping: &Mapping, springs: &Springs, bone_at: &[Option<(usize, usize)>]) {
        let character = mapping.character_from_model();
        let metres = character.linear.x_axis.length();
        for (node, at) in self.nodes.iter().enumerate().filter(|(_, node)| node.bone.is_some()) {
            let (chain, index) = bone_at[at.joint].expect("a bone's node has one");
            let bone = &springs.chains[chain].bones[index];
            let axis = normalize_or(bone.tail, Vec3::Y);
            self.bones.push(Bone {
                node,
                chain,
                tail: bone.tail,
                axis,
                length: bone.tail.length(),
                stiffness: bone.stiffness * metres,
                gravity: character.vector(bone.gravity),
                drag: bone.drag,
                radius: bone.radius * metres,
                limit: bone.limit.map(|limit| Limit::new(&limit, axis)),
            });
        }
    }

    /// Adds links between swinging bones, with their length in the bind pose.
    fn add_links(&mut self, mapping: &Mapping, bind_model: &[Affine]) {
        let character = mapping.character_from_model();
        let bone_of = |joint| self.bones.iter().position(|bone| self.nodes[bone.node].joint == joint);
        let tip = |bone: usize| {
            let bone = &self.bones[bone];
            character.point(bind_model[self.nodes[bone.node].joint].point(bone.tail))
        };
        let link = |link: &SpringLink| {
            let bones = [bone_of(link.joints[0])?, bone_of(link.joints[1])?];
            let length = (tip(bones[1]) - tip(bones[0])).length();
            Some(Link { bones, length, share: clamp(link.share, 0.0, 1.0), holds_apart: link.holds_apart })
        };
        self.links = self.source.links.iter().filter_map(link).collect();
    }

    /// Adds anchors, with their reach along the bones in the bind pose.
    fn add_anchors(&mut self, mapping: &Mapping, bind_model: &[Affine]) {
        let character = mapping.character_from_model();
        let place = |node: &Node| character.point(bind_model[node.joint].translation);
        // For each node, its anchor and its largest distance from the anchor.
        let mut ways: Vec<(usize, f32)> = Vec::with_capacity(self.nodes.len());
        for (k, node) in self.nodes.iter().enumerate() {
            ways.push(match node.parent.filter(|_| node.swings) {
                Some(parent) => {
                    let (anchor, way) = ways[parent];
                    (anchor, way + (place(node) - place(&self.nodes[parent])).length())
                }
                None => (k, 0.0),
            });
        }
        let mut farthest = vec![0.0; self.nodes.len()];
        for bone in &self.bones {
            let (anchor, way) = ways[bone.node];
            let bind = &bind_model[self.nodes[bone.node].joint];
            let length = character.vector(bind.vector(bone.tail)).length();
            farthest[anchor] = max(farthest[anchor], way + length + bone.radius);
        }
        self.anchors = farthest.into_iter().enumerate().filter(|(_, reach)| *reach > 0.0).collect();
    }

    /// Finds the bodies that each bone collides with: all bodies except those that the bone's tip touches in the bind
    /// pose.
    fn meet_bodies(&mut self, ragdoll: &RagdollDef, mapping: &Mapping, bind_model: &[Affine]) {
        if !self.chains.iter().any(|chain| chain.hits_body) {
            self.meets = vec![0; self.bones.len()];
            return;
        }
        let (mut frames, bodies) = (Vec::new(), &ragdoll.bodies[..ragdoll.bodies.len().min(64)]);
        mapping.bodies_from_model(bind_model, Transform::IDENTITY, &mut frames);
        let character = mapping.character_from_model();
        let clear = |bone: &Bone| {
            let tip = character.point(bind_model[self.nodes[bone.node].joint].point(bone.tail));
            bodies.iter().zip(&frames).enumerate().fold(0, |bits, (index, (body, frame))| {
                let is_clear = body.shape.signed_distance(frame, tip).0 >= bone.radius;
                bits | (u64::from(is_clear) << index)
            })
        };
        self.meets = self
            .bones
            .iter()
            .map(|bone| if self.chains[bone.chain].hits_body { clear(bone) } else { 0 })
            .collect();
        self.bodies = bodies.iter().map(|body| body.shape.clone()).collect();
    }

    /// Returns the springs from which the rig was made.
    pub fn source(&self) -> &Springs {
        &self.source
    }

    /// Returns the joints that swing, parents first.
    pub fn joints(&self) -> impl ExactSizeIterator<Item = JointIdx> {
        self.bones.iter().map(|bone| self.nodes[bone.node].joint)
    }

    /// Returns the number of links between bones that swing.
    pub fn link_count(&self) -> usize {
        self.links.len()
    }

    /// Returns the joints of bones that were left out.
    pub fn left_out(&self) -> &[JointIdx] {
        &self.left_out
    }

    /// Returns true if a chain collides with the character's bodies.
    pub fn meets_bodies(&self) -> bool {
        !self.bodies.is_empty()
    }

    /// Returns true if no bone swings.
    pub fn is_empty(&self) -> bool {
        self.bones.is_empty()
    }
}
