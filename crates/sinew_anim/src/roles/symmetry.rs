//! Mirror symmetry of the bind pose.

use super::graph::Graph;
use crate::roles::tuning::MIRROR_TOLERANCE;
use sinew_math::{Vec3, min};

/// A mirror plane and the mirrored pairs of nodes.
pub(super) struct Symmetry {
    /// Unit normal of the plane.
    pub lateral: Vec3,
    /// Position of the plane along `lateral`, file units.
    pub centre: f32,
    /// Mirror image of each node: the node itself on the midline; `None` without one.
    pub partner: Vec<Option<usize>>,
    /// Nodes with a partner on the other side, minus half of those without.
    score: f32,
}

impl Symmetry {
    /// Finds the best mirror plane perpendicular to one of the model's axes; perpendicular to x on a tie.
    pub fn find(graph: &Graph, size: f32) -> Self {
        let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| Self::across(graph, axis, size));
        [z, y].into_iter().fold(x, |best, next| if next.score > best.score { next } else { best })
    }

    fn across(graph: &Graph, lateral: Vec3, size: f32) -> Self {
        let mut sides: Vec<f32> = graph.nodes.iter().map(|node| node.position.dot(lateral)).collect();
        sides.sort_by(f32::total_cmp);
        // The median lies on the midline, because as many joints are left as right.
        let centre = 0.5 * (sides[sides.len() / 2] + sides[(sides.len() - 1) / 2]);
        let mut symmetry = Self { lateral, centre, partner: vec![None; graph.nodes.len()], score: 0.0 };
        symmetry.pair_up(graph, MIRROR_TOLERANCE * size);
        let off = |i: &usize| symmetry.side(graph, *i).abs() > MIRROR_TOLERANCE * size;
        let paired = (0..graph.nodes.len()).filter(|&i| symmetry.partner[i].is_some_and(|k| k != i)).count();
        let alone = (0..graph.nodes.len()).filter(off).filter(|&i| symmetry.partner[i].is_none()).count();
        symmetry.score = paired as f32 - 0.5 * alone as f32;
        symmetry
    }

    /// Pairs joints with their mirror images from the root down. The image of a joint is a child of its parent's image;
    /// the best fits are paired first. Of several joints at one position, such as fingers at the wrist, the one whose
    /// whole subtree is nearest to the mirrored subtree is chosen.
    fn pair_up(&mut self, graph: &Graph, tolerance: f32) {
        let middles = graph.middles();
        let mirrored = |p: Vec3| p - self.lateral * (2.0 * (p.dot(self.lateral) - self.centre));
        // Along a limb posed differently from its twin, differences add up, so the difference of a single bone counts,
        // too; but not on the midline, where a bone up and a bone down would be twins in a wrong plane.
        let lengths = |nodes: [usize; 2], parents: [usize; 2]| {
            (graph.distance(parents[0], nodes[0]) - graph.distance(parents[1], nodes[1])).abs()
        };
        let off = |nodes: [usize; 2], parents: [usize; 2]| {
            let [i, k, on_i, on_k] =
                [nodes[0], nodes[1], parents[0], parents[1]].map(|node| graph.nodes[node].position);
            let away = (k - mirrored(i)).length();
            let of_bone = (k - on_k - mirrored(i) + mirrored(on_i)).length();
            let is_chain = parents.iter().all(|&parent| graph.nodes[parent].children.len() == 1);
            if parents[0] == parents[1] {
                away
            } else if is_chain {
                // An unbranched chain continues like its counterpart, with any bend.
                min(min(away, of_bone), lengths(nodes, parents))
            } else {
                min(away, of_bone)
            }
        };
        let mut partner: Vec<Option<usize>> = vec![None; graph.nodes.len()];
        partner[graph.root] = Some(graph.root);
        for &parent in &graph.order {
            let Some(other) = partner[parent].filter(|&other| other >= parent) else { continue };
            let mut fitting: Vec<(f32, usize, usize)> = Vec::new();
            for &i in &graph.nodes[parent].children {
                for &k in &graph.nodes[other].children {
                    let distance = off([i, k], [parent, other]);
                    if distance <= tolerance {
                        fitting.push((distance + (middles[k] - mirrored(middles[i])).length(), i, k));
                    }
                }
            }
            fitting.sort_by(|a, b| a.0.total_cmp(&b.0));
            for (_, i, k) in fitting {
                if partner[i].is_none() && partner[k].is_none() {
                    (partner[i], partner[k]) = (Some(k), Some(i));
                }
            }
        }
        self.partner = partner;
    }

    /// Signed distance of a node from the plane.
    pub fn side(&self, graph: &Graph, node: usize) -> f32 {
        self.side_of(graph.nodes[node].position)
    }

    /// Signed distance of a position from the plane.
    pub fn side_of(&self, place: Vec3) -> f32 {
        place.dot(self.lateral) - self.centre
    }

    /// True for a node that is its own mirror image.
    pub fn on_midline(&self, node: usize) -> bool {
        self.partner[node] == Some(node)
    }

    /// Returns the mirror image on the other side; `None` on the midline.
    pub fn other(&self, node: usize) -> Option<usize> {
        self.partner[node].filter(|&k| k != node)
    }
}
