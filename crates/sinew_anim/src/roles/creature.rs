//! Generic roles for bodies that are not human.

use super::axes::possible_ups;
use super::bind::Bound;
use super::graph::Graph;
use super::humanoid::Stance;
use super::names::Part;
use super::role::Role;
use super::symmetry::Symmetry;
use sinew_math::Vec3;

/// Returns a role per node: the midline chain with the most skin is the trunk, the first other midline chain the tail,
/// every other chain a limb. If names contain a head or a tail (`parts`, per node), the trunk ends at the head, not at
/// the tail.
pub(super) fn generic_roles(
    graph: &Graph,
    symmetry: &Symmetry,
    left: Vec3,
    parts: &[Option<Part>],
) -> Vec<Role> {
    let mut roles: Vec<Option<Role>> = vec![None; graph.nodes.len()];
    let [to_head, to_tail] = [Part::Head, Part::Tail].map(|part| leads_to(graph, parts, part));
    // Among several continuations, prefers one toward the wanted part, then one not toward the unwanted part, then the
    // one with the most skin.
    let better = |a: usize, b: usize, wanted: &[bool], unwanted: Option<&[bool]>| {
        let rank = |i: usize| (wanted[i], unwanted.is_none_or(|unwanted| !unwanted[i]));
        let skin = |i: usize| graph.nodes[i].subtree_area;
        if rank(b) > rank(a) || rank(b) == rank(a) && skin(b) > skin(a) { b } else { a }
    };
    // A chain that bends sideways without branching continues.
    let midline = |from: usize, roles: &[Option<Role>], wanted: &[bool], unwanted: Option<&[bool]>| {
        let children = &graph.nodes[from].children;
        let goes_on = |i: &usize| roles[*i].is_none() && (children.len() == 1 || symmetry.on_midline(*i));
        children.iter().copied().filter(goes_on).reduce(|a, b| better(a, b, wanted, unwanted))
    };
    let mut trunk = vec![graph.root];
    while let Some(next) = midline(trunk[trunk.len() - 1], &roles, &to_head, Some(&to_tail)) {
        trunk.push(next);
    }
    for (n, &node) in (0..).zip(&trunk) {
        roles[node] = Some(Role::SpineSegment(n));
    }
    let tail_from = |node: usize, roles: &[Option<Role>]| midline(node, roles, &to_tail, None);
    let tail_root = trunk.iter().find_map(|&node| tail_from(node, &roles));
    let tail: Vec<usize> = core::iter::successors(tail_root, |&node| tail_from(node, &roles)).collect();
    for (n, &node) in (0..).zip(&tail) {
        roles[node] = Some(Role::TailSegment(n));
    }
    let mut begins = Vec::new();
    let mut in_limb: Vec<bool> = roles.iter().map(Option::is_some).collect();
    for &node in &graph.order {
        if in_limb[node] {
            continue;
        }
        // Parents come first, so a node without a role starts a chain; its side branches start other chains.
        begins.push(node);
        along(graph, node).for_each(|part| in_limb[part] = true);
    }
    number(graph, symmetry, left, &mut begins);
    for (limb, &node) in (0..).zip(&begins) {
        for (segment, part) in (0..).zip(along(graph, node)) {
            roles[part] = Some(Role::LimbSegment { limb, segment });
        }
    }
    roles.into_iter().map(|role| role.expect("every node is in a chain")).collect()
}

/// True for each node that is named as `part` or has such a descendant.
fn leads_to(graph: &Graph, parts: &[Option<Part>], part: Part) -> Vec<bool> {
    let mut leads: Vec<bool> = parts.iter().map(|named| *named == Some(part)).collect();
    for &node in graph.order.iter().rev() {
        if let Some(parent) = graph.nodes[node].parent.filter(|_| leads[node]) {
            leads[parent] = true;
        }
    }
    leads
}

/// Sorts limbs by their point of attachment and reach, independently of the file order: limbs near the root first, and
/// the left limb of a mirrored pair first. A pair uses its mean, so that rounding puts no third limb between the two.
fn number(graph: &Graph, symmetry: &Symmetry, left: Vec3, begins: &mut [usize]) {
    let mean = |node: usize, of: &dyn Fn(usize) -> f32| of(node) + of(symmetry.other(node).unwrap_or(node));
    let key = |node: usize| {
        let distance = mean(node, &|i| graph.distance(graph.root, i));
        let reach = mean(node, &|i| graph.nodes[i].reach);
        (graph.up_from(node).count(), [distance, reach, -graph.nodes[node].position.dot(left)])
    };
    begins.sort_by(|&a, &b| {
        let ((depth_a, a), (depth_b, b)) = (key(a), key(b));
        let lengths = a.iter().zip(&b).map(|(a, b)| a.total_cmp(b));
        lengths.fold(depth_a.cmp(&depth_b), core::cmp::Ordering::then)
    });
}

/// Iterates over a limb from `node` to its farthest end.
fn along(graph: &Graph, node: usize) -> impl Iterator<Item = usize> {
    core::iter::successors(Some(node), |&i| longest(graph, i))
}

fn longest(graph: &Graph, node: usize) -> Option<usize> {
    let way = |child: usize| graph.distance(node, child) + graph.nodes[child].reach;
    graph.nodes[node].children.iter().copied().reduce(|a, b| if way(b) > way(a) { b } else { a })
}

/// Returns the up direction, opposite to the ends of most mirrored chains; +Y without such chains.
pub(super) fn up_by_feet(graph: &Graph, bound: &Bound, symmetry: &Symmetry) -> Vec3 {
    let feet: Vec<Vec3> = (0..graph.nodes.len())
        .filter(|&i| graph.nodes[i].children.is_empty() && symmetry.other(i).is_some())
        .map(|i| graph.nodes[i].position)
        .collect();
    let low = |up: Vec3| {
        let stance = Stance::new(bound, up);
        feet.iter().filter(|&&foot| stance.level(foot) < 0.25).count()
    };
    let best =
        possible_ups(symmetry.lateral).map(|up| (low(up), up)).reduce(|a, b| if b.0 > a.0 { b } else { a });
    best.filter(|&(count, _)| count > 0).map_or(Vec3::Y, |(_, up)| up)
}
