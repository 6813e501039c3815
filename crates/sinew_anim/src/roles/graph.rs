//! Tree of the skinned joints; joints with an unsuitable parent are attached by geometry or name.

use super::bind::Bound;
use crate::rig::{JointIdx, Rig};
use crate::roles::tuning::{FOOT_AT_END, FOOT_AT_SKIN, LARGEST_FOOT, TWIN_AREA, TWIN_PLACE};
use sinew_math::Vec3;

/// A joint that moves skin.
pub(super) struct Node {
    pub joint: JointIdx,
    pub parent: Option<usize>,
    pub children: Vec<usize>,
    /// Bind position, model space.
    pub position: Vec3,
    /// Skin area that the joint moves.
    pub area: f32,
    /// Skin area that the joint and its descendants move.
    pub subtree_area: f32,
    /// Length of the longest path down from the joint.
    pub reach: f32,
}

/// Largest number of joints of a foot beside the body: the foot and its toes.
const LONGEST_FOOT: usize = 2;

/// A tree of [`Node`]s with one root.
pub(super) struct Graph {
    pub nodes: Vec<Node>,
    pub root: usize,
    /// Node indices, parents before children.
    pub order: Vec<usize>,
    /// Nodes whose parent was found by geometry.
    pub adopted: Vec<usize>,
}

impl Graph {
    /// Builds the tree of the joints in `is_part`; `None` if there is none. `carrier` returns the parent by name of a
    /// joint that the rig does not attach to the tree.
    pub fn of(
        rig: &Rig,
        bound: &Bound,
        is_part: impl Fn(JointIdx) -> bool,
        carrier: impl Fn(JointIdx) -> Option<JointIdx>,
    ) -> Option<Self> {
        let mut node_of: Vec<Option<usize>> = vec![None; rig.joints.len()];
        let mut nodes: Vec<Node> = Vec::new();
        for joint in 0..rig.joints.len() {
            if !is_part(joint) {
                continue;
            }
            let parent = ancestors(rig, joint).find_map(|ancestor| node_of[ancestor]);
            node_of[joint] = Some(nodes.len());
            if let Some(parent) = parent {
                let child = nodes.len();
                nodes[parent].children.push(child);
            }
            let position = bound.model[joint].translation;
            let area = bound.area[joint];
            nodes.push(Node {
                joint,
                parent,
                children: Vec::new(),
                position,
                area,
                subtree_area: area,
                reach: 0.0,
            });
        }
        let mut graph = Self { nodes, root: 0, order: Vec::new(), adopted: Vec::new() };
        graph.hang_named(|node| node_of[carrier(node)?]);
        graph.join(rig, bound, &node_of)?;
        Some(graph)
    }

    /// Attaches trees to the parent that their names give.
    fn hang_named(&mut self, carrier: impl Fn(JointIdx) -> Option<usize>) {
        let roots: Vec<usize> = (0..self.nodes.len()).filter(|&i| self.nodes[i].parent.is_none()).collect();
        for root in roots {
            let Some(parent) = carrier(self.nodes[root].joint) else { continue };
            if self.up_from(parent).any(|node| node == root) {
                continue;
            }
            self.nodes[root].parent = Some(parent);
            self.nodes[parent].children.push(root);
            self.adopted.push(root);
        }
    }

    /// Merges several trees: the tree with the most skin stays, and the others are attached to it, large ones first.
    fn join(&mut self, rig: &Rig, bound: &Bound, node_of: &[Option<usize>]) -> Option<()> {
        let mut roots: Vec<usize> =
            (0..self.nodes.len()).filter(|&i| self.nodes[i].parent.is_none()).collect();
        let area = |i: usize| self.subtree(i).iter().map(|&k| self.nodes[k].area).sum::<f32>();
        let areas: Vec<f32> = roots.iter().map(|&root| area(root)).collect();
        let main = (0..roots.len()).reduce(|a, b| if areas[b] > areas[a] { b } else { a })?;
        self.root = roots.remove(main);
        roots.sort_by_key(|&root| core::cmp::Reverse(self.subtree(root).len()));
        let ends = ends(rig, bound, node_of);
        let trunk = self.grow_trunk(&mut roots, bound);
        for stray in roots {
            let parent = self.place_for(stray, &trunk, &ends, bound);
            self.nodes[stray].parent = Some(parent);
            self.nodes[parent].children.push(stray);
            self.adopted.push(stray);
        }
        self.hang_feet(&ends, bound);
        self.order = self.subtree(self.root);
        for k in (0..self.order.len()).rev() {
            let i = self.order[k];
            if let Some(parent) = self.nodes[i].parent {
                let reach = self.distance(parent, i) + self.nodes[i].reach;
                self.nodes[parent].reach = sinew_math::max(self.nodes[parent].reach, reach);
                self.nodes[parent].subtree_area += self.nodes[i].subtree_area;
            }
        }
        Some(())
    }

    /// Removes the parts of the trunk from `strays`: parts without a mirrored twin whose skin is connected to the
    /// trunk. Returns the nodes of the trunk with these parts. If the root of a body has no skin, hips and back are
    /// separate trees.
    fn grow_trunk(&mut self, strays: &mut Vec<usize>, bound: &Bound) -> Vec<usize> {
        let all = strays.clone();
        loop {
            let trunk = self.subtree(self.root);
            let grown = strays.iter().enumerate().find_map(|(place, &stray)| {
                let is_single =
                    all.iter().all(|&other| other == stray || !self.are_twins(stray, other, bound));
                let parent = self.grows_into(stray, trunk.iter().copied(), bound).filter(|_| is_single);
                Some((place, parent?))
            });
            let Some((place, parent)) = grown else { return trunk };
            let stray = strays.remove(place);
            self.nodes[stray].parent = Some(parent);
            self.nodes[parent].children.push(stray);
            self.adopted.push(stray);
        }
    }

    /// True for a left and a right tree: equal numbers of joints, similar areas of skin, starts equally far from the
    /// root, and starts or middles in different places. Of trees that start in one place the middles are also equally
    /// far from it.
    fn are_twins(&self, a: usize, b: usize, bound: &Bound) -> bool {
        let [of_a, of_b] = [a, b].map(|tree| self.subtree(tree));
        let area = |tree: &[usize]| tree.iter().map(|&node| self.nodes[node].area).sum::<f32>();
        let (more, less) =
            (sinew_math::max(area(&of_a), area(&of_b)), sinew_math::min(area(&of_a), area(&of_b)));
        let away = |tree: usize| self.distance(self.root, tree);
        let near = TWIN_PLACE * bound.size();
        let middle = |tree: &[usize]| {
            tree.iter().map(|&node| self.nodes[node].position).sum::<Vec3>() / tree.len() as f32
        };
        let spread = || {
            let [start, end_a, end_b] = [self.nodes[a].position, middle(&of_a), middle(&of_b)];
            let lengths = [end_a, end_b].map(|end| (end - start).length());
            (end_a - end_b).length() > near && (lengths[0] - lengths[1]).abs() < near
        };
        of_a.len() == of_b.len()
            && less > TWIN_AREA * more
            && (away(a) - away(b)).abs() < near
            && (self.distance(a, b) > near || spread())
    }

    /// Attaches feet to their leg that are parented to the root, as for IK: those at the end of a leg, or whose skin is
    /// connected to it.
    fn hang_feet(&mut self, ends: &[(usize, Vec3)], bound: &Bound) {
        let size = bound.size();
        let mut moved_by = vec![None; bound.model.len()];
        self.nodes.iter().enumerate().for_each(|(node, own)| moved_by[own.joint] = Some(node));
        let touched: Vec<(usize, usize)> = self.nodes[self.root]
            .children
            .iter()
            .filter_map(|&child| Some((child, self.touched_by(child, &moved_by, bound)?)))
            .collect();
        for foot in self.nodes[self.root].children.clone() {
            let own = self.subtree(foot);
            if own.len() > LONGEST_FOOT {
                continue;
            }
            let start = self.nodes[foot].position;
            let large = own.iter().map(|&node| self.nodes[node].area).sum::<f32>() / LARGEST_FOOT;
            let is_leg = |node: usize| {
                let is_end = node != self.root && self.nodes[node].children.is_empty();
                is_end && !own.contains(&node) && self.nodes[node].area > large
            };
            let at_end =
                |&&(node, at): &&(usize, Vec3)| is_leg(node) && (at - start).length() < FOOT_AT_END * size;
            let grown = || self.grows_into(foot, 0..self.nodes.len(), bound).filter(|&leg| is_leg(leg));
            // Rigid parts have no common skin, so the nearest leg is chosen, and each leg gets one foot.
            let touching = || {
                let leg = touched.iter().find(|(child, _)| *child == foot).map(|&(_, leg)| leg)?;
                let is_own = touched.iter().filter(|(_, other)| *other == leg).count() == 1;
                // Two antennae on one root are not attached to each other.
                let is_limb = is_leg(leg) && self.nodes[leg].parent != Some(self.root);
                (is_own && is_limb).then_some(leg)
            };
            let at_end = ends.iter().find(at_end).map(|&(leg, _)| leg);
            let Some(leg) = at_end.or_else(grown).or_else(touching) else { continue };
            self.nodes[foot].parent = Some(leg);
            self.nodes[leg].children.push(foot);
            let root = self.root;
            self.nodes[root].children.retain(|&child| child != foot);
            if !self.adopted.contains(&foot) {
                self.adopted.push(foot);
            }
        }
    }

    /// Returns the node of another tree whose skin is nearest to a tree's start, if they touch; `moved_by` has the node
    /// of each joint.
    fn touched_by(&self, tree: usize, moved_by: &[Option<usize>], bound: &Bound) -> Option<usize> {
        let (own, start) = (self.subtree(tree), self.nodes[tree].position);
        let skin = bound.vertices.iter().zip(&bound.movers);
        let away = skin.filter_map(|(at, &mover)| {
            let node = moved_by[mover].filter(|node| !own.contains(node))?;
            Some(((*at - start).length(), node))
        });
        let (distance, node) = away.reduce(|a, b| if b.0 < a.0 { b } else { a })?;
        (distance < FOOT_AT_SKIN * bound.size()).then_some(node)
    }

    /// Parent of a stray tree. Rigs baked from IK parent feet to the root. Such a short tree belongs to the leaf with
    /// connected skin, to the leaf at whose end or skin it starts, or to a leaf much nearer than the root. All other
    /// trees belong to the node of `trunk` with connected skin, or at whose skin they start; else to the root.
    fn place_for(&self, stray: usize, trunk: &[usize], ends: &[(usize, Vec3)], bound: &Bound) -> usize {
        let (size, start) = (bound.size(), self.nodes[stray].position);
        let area = |tree: usize| self.subtree(tree).iter().map(|&node| self.nodes[node].area).sum::<f32>();
        // A hand beside the hips must not become the parent of a leg.
        let own = area(stray);
        let carries = |node: &usize| {
            !self.nodes[*node].children.is_empty() || own < LARGEST_FOOT * self.nodes[*node].area
        };
        let body: Vec<usize> = self.subtree(self.root).into_iter().filter(carries).collect();
        let nearest = |places: &mut dyn Iterator<Item = (usize, Vec3)>| {
            places
                .filter(|(node, _)| body.contains(node))
                .map(|(node, place)| ((place - start).length(), node))
                .reduce(|a, b| if b.0 < a.0 { b } else { a })
        };
        let at_skin = |(distance, node): (f32, usize)| (distance < FOOT_AT_SKIN * size).then_some(node);
        let end = nearest(&mut ends.iter().copied()).filter(|&(distance, _)| distance < 0.03 * size);
        if self.subtree(stray).len() > LONGEST_FOOT {
            let grown = self.grows_into(stray, trunk.iter().copied(), bound).or(end.map(|(_, node)| node));
            return grown.or(nearest(&mut self.skin_of(trunk, bound)).and_then(at_skin)).unwrap_or(self.root);
        }
        // A foot is never attached to another foot, so attached trees are not leaves.
        let is_leaf = |i: &usize| {
            let is_end = self.nodes[*i].children.iter().all(|child| self.adopted.contains(child));
            is_end && self.nodes[*i].parent.is_some() && !self.adopted.contains(i)
        };
        let leaves: Vec<usize> = body.iter().copied().filter(is_leaf).collect();
        if let Some(leaf) = self.grows_into(stray, body.iter().copied(), bound)
            && leaves.contains(&leaf)
        {
            return leaf;
        }
        if let Some((_, node)) = end {
            return node;
        }
        // A leg of two joints starts at the trunk.
        let at_trunk = || nearest(&mut self.skin_of(trunk, bound)).and_then(at_skin);
        if let Some(part) = self.grows_into(stray, trunk.iter().copied(), bound).or_else(at_trunk) {
            return part;
        }
        let from_root = (self.nodes[self.root].position - start).length();
        let leaf = nearest(&mut leaves.iter().map(|&i| (i, self.nodes[i].position)));
        if let Some((distance, leaf)) = leaf
            && distance < 0.75 * from_root
        {
            return leaf;
        }
        nearest(&mut self.skin_of(&leaves, bound)).and_then(at_skin).unwrap_or(self.root)
    }

    /// Iterates over the vertices that `nodes` move most, each with its node.
    fn skin_of<'a>(
        &'a self,
        nodes: &'a [usize],
        bound: &'a Bound,
    ) -> impl Iterator<Item = (usize, Vec3)> + 'a {
        nodes.iter().flat_map(|&node| {
            let joint = self.nodes[node].joint;
            let own = bound.vertices.iter().zip(&bound.movers).filter(move |(_, mover)| **mover == joint);
            own.map(move |(&vertex, _)| (node, vertex))
        })
    }

    /// Returns the node of `among` with the most skin connected to a tree outside of it; of equal ones, the nearer;
    /// `None` if they touch nowhere.
    fn grows_into(&self, tree: usize, among: impl Iterator<Item = usize>, bound: &Bound) -> Option<usize> {
        let own = self.subtree(tree);
        let links = |node: usize| -> u32 {
            let joint = self.nodes[node].joint;
            let between = |&part: &usize| {
                let other = self.nodes[part].joint;
                bound.links.get(&(usize::min(joint, other), usize::max(joint, other)))
            };
            own.iter().filter_map(between).sum()
        };
        let all = among.filter(|node| !own.contains(node));
        let all = all.map(|node| (links(node), node)).filter(|(links, _)| *links > 0);
        let away = |node: usize| self.distance(tree, node);
        let better = |a: &(u32, usize), b: &(u32, usize)| b.0 > a.0 || b.0 == a.0 && away(b.1) < away(a.1);
        all.reduce(|a, b| if better(&a, &b) { b } else { a }).map(|(_, node)| node)
    }

    /// Returns a node and all its descendants, parents before children.
    pub fn subtree(&self, from: usize) -> Vec<usize> {
        let mut found = vec![from];
        let mut next = 0;
        while next < found.len() {
            found.extend(&self.nodes[found[next]].children);
            next += 1;
        }
        found
    }

    /// Mean position of each node and all its descendants.
    pub fn middles(&self) -> Vec<Vec3> {
        let mut sums: Vec<(Vec3, f32)> = self.nodes.iter().map(|node| (node.position, 1.0)).collect();
        for &i in self.order.iter().rev() {
            if let Some(parent) = self.nodes[i].parent {
                let (sum, count) = sums[i];
                sums[parent].0 += sum;
                sums[parent].1 += count;
            }
        }
        sums.into_iter().map(|(sum, count)| sum / count).collect()
    }

    /// Iterates over a node, its parent and so on up to the root.
    pub fn up_from(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        core::iter::successors(Some(node), |&i| self.nodes[i].parent)
    }

    /// Distance of two nodes in the bind pose.
    pub fn distance(&self, a: usize, b: usize) -> f32 {
        (self.nodes[a].position - self.nodes[b].position).length()
    }
}

/// Iterates over a joint's parent, the parent's parent, and so on.
pub(super) fn ancestors(rig: &Rig, joint: JointIdx) -> impl Iterator<Item = JointIdx> + '_ {
    core::iter::successors(rig.joints[joint].parent, |&i| rig.joints[i].parent)
}

/// Returns joints without skin below a leaf, as the leaf and a position: the far ends of its bone.
fn ends(rig: &Rig, bound: &Bound, node_of: &[Option<usize>]) -> Vec<(usize, Vec3)> {
    let end = |joint: JointIdx| {
        let node = ancestors(rig, joint).find_map(|ancestor| node_of[ancestor])?;
        Some((node, bound.model[joint].translation))
    };
    (0..rig.joints.len()).filter(|&joint| node_of[joint].is_none()).filter_map(end).collect()
}
