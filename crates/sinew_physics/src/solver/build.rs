//! `prepare`: from the world to the arrays of one island's solver.

use super::contact_rows::{ManifoldRows, ManifoldSource, PlacedShape};
use super::drives::SoftRow;
use super::loops::MAX_EXACT_ROWS;
use super::tree::{Link, NONE};
use super::{IslandSolver, SolverBody, SolverJoint};
use crate::arena::Arena;
use crate::body::Body;
use crate::contact::{Contact, combine, slop};
use crate::islands::Island;
use crate::joint::{DIRECTIONS, Joint, JointPose, JointRows, MAX_LIMITS, locked_count};
use crate::spatial::{ZERO6, join};
use sinew_math::{Sym3, Vec3, min};

/// At most this many bodies are solved as one tree; joints beyond become loop rows.
const MAX_TREE: usize = 1024;

/// An island whose loops have at least this share (its inverse) of the rows of its trees is solved without trees.
const ENTANGLED: usize = 2;

/// What an island's solver reads of the world.
pub(crate) struct View<'a> {
    pub bodies: &'a Arena<Body>,
    pub joints: &'a Arena<Joint>,
    pub contacts: &'a [Contact],
    pub gravity: Vec3,
    /// Substep, seconds.
    pub h: f32,
}

/// Memory for building.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    /// World indices of the moving bodies in tree order, with the local parent and the joint's place in the island.
    order: Vec<(u32, u32, u32)>,
    /// Per body of the island (by its place there): local index.
    local: Vec<u32>,
    /// World indices of the fixed bodies, ascending.
    fixed: Vec<u32>,
    /// Per joint of the island: used by a tree.
    used: Vec<bool>,
    /// (body's place, joint's place), ascending: which joints a body has.
    adjacent: Vec<(u32, u32)>,
}

impl IslandSolver {
    /// Fills the solver with an island of the world.
    pub fn prepare(&mut self, island: &Island, view: &View<'_>) {
        self.h = view.h;
        self.order_trees(island, view);
        self.copy_bodies(island, view);
        self.copy_joints(island, view);
        self.weigh_joints();
        self.refresh_joints();
        self.refresh_inertia();
        self.factor_joints();
        self.copy_contacts(island, view);
        self.limits.clear();
        self.choose_limits();
        self.refresh_response();
    }

    /// Spanning trees by breadth-first search: first from bodies jointed to fixed ones (a tree has one ground at most),
    /// then from the smallest body that is left.
    fn order_trees(&mut self, island: &Island, view: &View<'_>) {
        let s = &mut self.scratch.build;
        s.order.clear();
        s.local.clear();
        s.local.resize(island.bodies.len(), NONE);
        s.used.clear();
        s.used.resize(island.joints.len(), false);
        s.adjacent.clear();
        let place = |body: u32| island.bodies.binary_search(&body).ok().map(|i| i as u32);
        for (j, &index) in island.joints.iter().enumerate() {
            let joint = view.joints.at(index);
            for body in [joint.a, joint.b] {
                if let Some(place) = place(body) {
                    s.adjacent.push((place, j as u32));
                }
            }
        }
        s.adjacent.sort_unstable();
        self.links.clear();
        self.tree_count = 0;
        // Ground joints first, so that a chain hung on a wall is one tree with the wall as its root.
        for j in 0..island.joints.len() {
            let joint = view.joints.at(island.joints[j]);
            let (a, b) = (place(joint.a), place(joint.b));
            if let (Some(root), None) | (None, Some(root)) = (a, b) {
                self.grow_tree(island, view, root, j as u32);
            }
        }
        for root in 0..island.bodies.len() as u32 {
            self.grow_tree(island, view, root, NONE);
        }
        self.articulated = self.links.iter().any(|link| link.joint != NONE);
        if self.is_entangled(island, view) {
            self.cut_trees(island);
        }
    }

    /// More rows of loops than of trees: a net, not a tree with a few loops.
    fn is_entangled(&self, island: &Island, view: &View<'_>) -> bool {
        let mut rows = [0, 0];
        for (&index, &used) in island.joints.iter().zip(&self.scratch.build.used) {
            rows[usize::from(used)] += locked_count(&view.joints.at(index).kind);
        }
        rows[0] > MAX_EXACT_ROWS && rows[0] * ENTANGLED > rows[1]
    }

    /// Every body by itself, every joint for the sweeps.
    fn cut_trees(&mut self, island: &Island) {
        let s = &mut self.scratch.build;
        s.used.fill(false);
        s.order.clear();
        self.links.clear();
        for (place, &body) in island.bodies.iter().enumerate() {
            s.local[place] = place as u32;
            s.order.push((body, NONE, NONE));
            self.links.push(Link::new(NONE, NONE, place as u32));
        }
        self.tree_count = self.links.len();
        self.articulated = false;
    }

    /// Adds the tree of `root` (a place in the island), held by `ground` (a joint's place) or free.
    fn grow_tree(&mut self, island: &Island, view: &View<'_>, root: u32, ground: u32) {
        let s = &mut self.scratch.build;
        if s.local[root as usize] != NONE {
            return;
        }
        let first = s.order.len();
        s.local[root as usize] = first as u32;
        if ground != NONE {
            s.used[ground as usize] = true;
        }
        s.order.push((island.bodies[root as usize], NONE, ground));
        let mut next = first;
        while next < s.order.len() {
            let (body, _, _) = s.order[next];
            let place = island.bodies.binary_search(&body).unwrap_or(0) as u32;
            let start = s.adjacent.partition_point(|&(p, _)| p < place);
            for k in start..s.adjacent.len() {
                let (p, j) = s.adjacent[k];
                if p != place || s.order.len() - first >= MAX_TREE {
                    break;
                }
                let joint = view.joints.at(island.joints[j as usize]);
                let other = if joint.a == body { joint.b } else { joint.a };
                let Ok(other) = island.bodies.binary_search(&other) else { continue };
                if s.local[other] == NONE {
                    s.local[other] = s.order.len() as u32;
                    s.used[j as usize] = true;
                    s.order.push((island.bodies[other], next as u32, j));
                }
            }
            next += 1;
        }
        for &(_, parent, joint) in &s.order[first..] {
            self.links.push(Link::new(parent, joint, self.tree_count as u32));
        }
        self.tree_count += 1;
    }

    fn copy_bodies(&mut self, island: &Island, view: &View<'_>) {
        let s = &mut self.scratch.build;
        s.fixed.clear();
        let moving = |body: u32| view.bodies.at(body).is_active();
        for &index in &island.joints {
            let joint = view.joints.at(index);
            s.fixed.extend([joint.a, joint.b].into_iter().filter(|&body| !moving(body)));
        }
        for &index in &island.contacts {
            let key = view.contacts[index as usize].key;
            s.fixed.extend([key.a, key.b].into_iter().filter(|&body| !moving(body)));
        }
        s.fixed.sort_unstable();
        s.fixed.dedup();
        self.bodies.clear();
        self.velocities.clear();
        let ordered = s.order.iter().map(|&(body, _, _)| body);
        for index in ordered.chain(s.fixed.iter().copied()) {
            let body = view.bodies.at(index);
            self.bodies.push(SolverBody {
                index,
                pose: body.world_from_principal,
                mass: body.mass,
                inertia: body.inertia,
                excess: Vec3::ZERO,
                inverse_inertia: Sym3::ZERO,
                force: body.force + view.gravity * (body.gravity_scale * body.mass),
                torque: body.torque,
                linear_damping: body.linear_damping,
                angular_damping: body.angular_damping,
            });
            let still = body.kind == crate::BodyKind::Dynamic && !body.is_active();
            let velocity = if still { ZERO6 } else { join(body.velocity.linear, body.velocity.angular) };
            self.velocities.push(velocity);
        }
    }

    /// Local index of a world body.
    fn local(&self, island: &Island, body: u32) -> u32 {
        let s = &self.scratch.build;
        match island.bodies.binary_search(&body) {
            Ok(place) => s.local[place],
            Err(_) => (self.links.len() + s.fixed.binary_search(&body).unwrap_or(0)) as u32,
        }
    }

    fn copy_joints(&mut self, island: &Island, view: &View<'_>) {
        self.joints.clear();
        self.loops.clear();
        for (place, &index) in island.joints.iter().enumerate() {
            let joint = view.joints.at(index);
            let (a, b) = (self.local(island, joint.a), self.local(island, joint.b));
            let geometry = joint.geometry();
            let pose =
                JointPose::new(&geometry, &self.bodies[a as usize].pose, &self.bodies[b as usize].pose);
            self.joints.push(SolverJoint {
                index,
                a,
                b,
                geometry,
                drive: joint.drive,
                pose,
                rows: JointRows::new(&geometry, &pose, [false; DIRECTIONS]),
                rigid: 0,
                soft: [SoftRow::default(); DIRECTIONS],
                mass: ZERO6,
                start_rate: ZERO6,
                saturated: joint.saturated,
                limits: joint.limits,
                limit_impulse: [Vec3::ZERO; MAX_LIMITS],
                force: joint.force,
                reaction: ZERO6,
            });
            if !self.scratch.build.used[place] {
                self.loops.push(place as u32, joint.loop_impulse);
            }
        }
        self.loops.group(&self.joints, &self.links);
        // A grounded root's parent is the fixed body of its joint.
        for i in 0..self.links.len() {
            let link = &self.links[i];
            if link.parent == NONE && link.joint != NONE {
                let joint = &self.joints[link.joint as usize];
                self.links[i].parent = if joint.a as usize == i { joint.b } else { joint.a };
            }
        }
    }

    fn copy_contacts(&mut self, island: &Island, view: &View<'_>) {
        self.manifolds.clear();
        for &index in &island.contacts {
            let contact = &view.contacts[index as usize];
            let (a, b) = (view.bodies.at(contact.key.a), view.bodies.at(contact.key.b));
            let shape_a = &a.shapes[contact.key.shape_a as usize];
            let shape_b = &b.shapes[contact.key.shape_b as usize];
            let extent = min(shape_a.shape.smallest_extent(), shape_b.shape.smallest_extent());
            let source = ManifoldSource {
                contact: index,
                a: self.local(island, contact.key.a),
                b: self.local(island, contact.key.b),
                a_moves: a.is_active(),
                b_moves: b.is_active(),
                manifold: &contact.manifold,
                memory: contact.memory,
                material: combine(&shape_a.material, &shape_b.material),
                slop: slop(extent),
                shapes: [shape_a, shape_b].map(|s| PlacedShape::new(s.shape, s.principal_from_shape)),
                h: view.h,
            };
            self.manifolds.push(ManifoldRows::new(&source, &self.bodies, &self.velocities));
        }
    }
}
