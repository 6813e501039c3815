//! Mirror symmetry of the bind pose: which joint is whose mirror image.

use super::graph::Graph;
use sinew_math::Vec3;

/// A mirror plane and what it pairs.
pub(super) struct Symmetry {
    /// Unit normal of the plane.
    pub lateral: Vec3,
    /// Place of the plane along `lateral`, file units.
    pub centre: f32,
    /// Per node its mirror image: itself on the midline, `None` where there is none.
    pub partner: Vec<Option<usize>>,
    /// Nodes with a partner on the other side, less half of those without any.
    score: f32,
}

/// How far from its mirror image a joint may be, of the size of the skin.
const TOLERANCE: f32 = 0.025;

impl Symmetry {
    /// The best mirror plane at right angles to one of the model's axes; x on a tie.
    pub fn find(graph: &Graph, size: f32) -> Self {
        let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| Self::across(graph, axis, size));
        [z, y].into_iter().fold(x, |best, next| if next.score > best.score { next } else { best })
    }

    fn across(graph: &Graph, lateral: Vec3, size: f32) -> Self {
        let mut sides: Vec<f32> = graph.nodes.iter().map(|node| node.position.dot(lateral)).collect();
        sides.sort_by(f32::total_cmp);
        // The median: as many joints are left as right, so it lies on the midline.
        let centre = 0.5 * (sides[sides.len() / 2] + sides[(sides.len() - 1) / 2]);
        let mut symmetry = Self { lateral, centre, partner: vec![None; graph.nodes.len()], score: 0.0 };
        symmetry.pair_up(graph, TOLERANCE * size);
        let off = |i: &usize| symmetry.side(graph, *i).abs() > TOLERANCE * size;
        let paired = (0..graph.nodes.len()).filter(|&i| symmetry.partner[i].is_some_and(|k| k != i)).count();
        let alone = (0..graph.nodes.len()).filter(off).filter(|&i| symmetry.partner[i].is_none()).count();
        symmetry.score = paired as f32 - 0.5 * alone as f32;
        symmetry
    }

    /// From the root down: the image of a joint is sought among the children of its parent's image.
    fn pair_up(&mut self, graph: &Graph, tolerance: f32) {
        for &i in &graph.order {
            let Some(parent) = graph.nodes[i].parent else {
                self.partner[i] = Some(i);
                continue;
            };
            let p = graph.nodes[i].position;
            let image = p - self.lateral * (2.0 * self.side(graph, i));
            let pool = self.partner[parent].map_or(&[][..], |other| graph.nodes[other].children.as_slice());
            let nearest = pool
                .iter()
                .map(|&k| ((graph.nodes[k].position - image).length(), k))
                .reduce(|a, b| if b.0 < a.0 { b } else { a });
            self.partner[i] = nearest.filter(|&(distance, _)| distance <= tolerance).map(|(_, k)| k);
        }
        for i in 0..self.partner.len() {
            if self.partner[i].is_some_and(|k| self.partner[k] != Some(i)) {
                self.partner[i] = None;
            }
        }
    }

    /// Signed distance of a node from the plane.
    pub fn side(&self, graph: &Graph, node: usize) -> f32 {
        graph.nodes[node].position.dot(self.lateral) - self.centre
    }

    /// True for a node that is its own mirror image.
    pub fn on_midline(&self, node: usize) -> bool {
        self.partner[node] == Some(node)
    }

    /// The mirror image on the other side; `None` on the midline.
    pub fn other(&self, node: usize) -> Option<usize> {
        self.partner[node].filter(|&k| k != node)
    }
}
