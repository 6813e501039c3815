//! Tests of trees against a search through all leaves.

use super::*;
use core::ops::ControlFlow;
use sinew_math::{Random, Vec3};

/// Number of cases: a hundredth unless `SINEW_FULL` is set.
fn cases(all: usize) -> usize {
    if std::env::var_os("SINEW_FULL").is_some() { all } else { all / 100 }
}

/// Returns a random box, near the origin or far away, large or without extent.
fn some_box(random: &mut Random, scale: f32) -> Aabb {
    let center = random.in_cube() * scale;
    let size = scale * if random.unit() < 0.1 { 1.0 } else { 0.05 };
    let half = match random.index(8) {
        0 => Vec3::ZERO,
        1 => Vec3::new(size, 0.0, 0.0),
        _ => (random.in_cube() * size).abs(),
    };
    Aabb { min: center - half, max: center + half }
}

/// A tree and its expected content.
struct Pair {
    tree: Tree,
    leaves: Vec<Option<Aabb>>,
}

impl Pair {
    fn change(&mut self, random: &mut Random, scale: f32) {
        let leaf = random.index(self.leaves.len()) as u32;
        let bounds = some_box(random, scale);
        match (self.leaves[leaf as usize], random.index(3)) {
            (Some(_), 0) => {
                self.tree.remove(leaf);
                self.leaves[leaf as usize] = None;
            }
            (Some(old), 1) => {
                // A small displacement.
                let way = random.in_cube() * 0.02 * scale;
                let bounds = Aabb { min: old.min + way, max: old.max + way };
                self.tree.update(leaf, &bounds);
                self.leaves[leaf as usize] = Some(bounds);
            }
            (Some(_), _) => {
                self.tree.update(leaf, &bounds);
                self.leaves[leaf as usize] = Some(bounds);
            }
            (None, _) => {
                self.tree.insert(leaf, &bounds);
                self.leaves[leaf as usize] = Some(bounds);
            }
        }
    }

    fn check(&self) {
        let there = self.leaves.iter().flatten().count();
        assert_eq!(self.tree.len(), there);
        assert!(self.tree.levels <= MOST_LEVELS);
        for (leaf, bounds) in self.leaves.iter().enumerate() {
            assert_eq!(self.tree.contains(leaf as u32), bounds.is_some());
            if let Some(bounds) = bounds {
                assert_eq!(self.tree.bounds(leaf as u32), *bounds);
            }
        }
        if let Some(root) = self.tree.root {
            assert_eq!(self.count(root, self.tree.levels), there);
        }
    }

    /// Checks that all leaves are on the same level and that each box bounds its content; returns the number of leaves.
    fn count(&self, node: u32, levels: usize) -> usize {
        let own = &self.tree.nodes[node as usize];
        let slots = (0..WIDTH).filter(|&slot| !own.child(slot).is_none());
        let below = slots.map(|slot| match own.child(slot).get() {
            Ok(leaf) => {
                assert_eq!(levels, 1);
                assert_eq!(self.tree.places[leaf as usize], Place::new(node, slot));
                1
            }
            Err(child) => {
                assert_eq!(own.bounds(slot), self.tree.nodes[child as usize].total());
                assert_eq!(self.tree.parents[child as usize], Place::new(node, slot));
                self.count(child, levels - 1)
            }
        });
        below.sum()
    }

    fn overlapping(&self, bounds: &Aabb) -> Vec<u32> {
        let mut found = Vec::new();
        let _ = self.tree.overlapping(bounds, |leaf| {
            found.push(leaf);
            ControlFlow::<()>::Continue(())
        });
        found.sort_unstable();
        found
    }

    fn brute_force(&self, holds: impl Fn(&Aabb) -> bool) -> Vec<u32> {
        let leaves = self.leaves.iter().enumerate();
        let held = leaves.filter(|(_, bounds)| bounds.as_ref().is_some_and(&holds));
        held.map(|(leaf, _)| leaf as u32).collect()
    }

    fn ask(&self, random: &mut Random, scale: f32) {
        use crate::boxes::Overlap;
        let query = some_box(random, scale);
        assert_eq!(self.overlapping(&query), self.brute_force(|bounds| bounds.overlaps(&query)));
        let mut direction = random.in_cube() * 2.0 * scale;
        if random.index(4) == 0 {
            direction[random.index(3)] = 0.0;
        }
        let sweep = Sweep {
            origin: random.in_cube() * scale,
            direction,
            half_extents: if random.index(2) == 0 { Vec3::ZERO } else { query.half_extents() },
            limit: random.unit(),
        };
        let mut met = Vec::new();
        self.tree.along(&sweep, |leaf| {
            met.push(leaf);
            sweep.limit
        });
        let missing = self.brute_force(|bounds| meets(bounds, &sweep));
        assert!(missing.iter().all(|leaf| met.contains(leaf)), "{sweep:?}: {missing:?}, met {met:?}");
        let distance = scale * random.unit();
        let mut near = Vec::new();
        self.tree.nearest(sweep.origin, distance, |leaf| {
            near.push(leaf);
            distance
        });
        let missing = self.brute_force(|bounds| {
            let outside = (bounds.min - sweep.origin).max(sweep.origin - bounds.max).max(Vec3::ZERO);
            outside.as_dvec3().length() <= f64::from(distance)
        });
        assert!(missing.iter().all(|leaf| near.contains(leaf)), "{missing:?}, near {near:?}");
    }
}

/// True if a swept box hits a box, by clipping in `f64`.
fn meets(bounds: &Aabb, sweep: &Sweep) -> bool {
    let (mut first, mut last) = (0.0_f64, f64::from(sweep.limit));
    for axis in 0..3 {
        let half = f64::from(sweep.half_extents[axis]);
        let low = f64::from(bounds.min[axis]) - half - f64::from(sweep.origin[axis]);
        let high = f64::from(bounds.max[axis]) + half - f64::from(sweep.origin[axis]);
        let way = f64::from(sweep.direction[axis]);
        if way == 0.0 {
            if low > 0.0 || high < 0.0 {
                return false;
            }
        } else {
            let (a, b) = (low / way, high / way);
            first = first.max(a.min(b));
            last = last.min(a.max(b));
        }
    }
    first <= last
}

#[test]
fn changing_tree_matches_brute_force() {
    let mut random = Random::new(1);
    for case in 0..cases(20_000) {
        let scale = [1.0, 100.0, 1e6][case % 3];
        let count = 1 + random.index(if case % 10 == 0 { 600 } else { 60 });
        let mut pair = Pair { tree: Tree::default(), leaves: vec![None; count] };
        for _ in 0..5 {
            for _ in 0..count {
                pair.change(&mut random, scale);
            }
            pair.check();
            pair.ask(&mut random, scale);
            if random.index(4) == 0 {
                pair.tree.rebuild(&mut Vec::new());
                pair.check();
                pair.ask(&mut random, scale);
            }
        }
    }
}

#[test]
fn large_tree_has_full_nodes_and_finds_every_leaf() {
    let mut random = Random::new(2);
    for count in [0_usize, 1, 7, 8, 9, 63, 64, 65, 512, 513, 5000] {
        let leaves: Vec<Option<Aabb>> = (0..count).map(|_| Some(some_box(&mut random, 10.0))).collect();
        let items = leaves.iter().flatten().enumerate();
        let mut items: Vec<Item> = items.map(|(leaf, &bounds)| Item { bounds, leaf: leaf as u32 }).collect();
        let mut pair = Pair { tree: Tree::default(), leaves };
        pair.tree.build(&mut items);
        pair.check();
        let full = count.div_ceil(WIDTH);
        assert!(pair.tree.nodes.len() <= full + full / 3 + 1, "{count}: {} nodes", pair.tree.nodes.len());
        for _ in 0..20 {
            pair.ask(&mut random, 10.0);
        }
    }
}

/// Inserts a row of boxes in order.
#[test]
fn leaves_in_a_row_give_a_shallow_tree() {
    let mut tree = Tree::default();
    for i in 0..10_000 {
        let at = Vec3::new(i as f32, 0.0, 0.0);
        tree.insert(i, &Aabb { min: at, max: at + Vec3::ONE });
    }
    assert!(tree.levels <= 9, "{} levels", tree.levels);
    let used = tree.nodes.len() - tree.free.len();
    assert!(used < 10_000 / 3, "{used} nodes");
}

#[test]
fn queries_find_infinite_boxes_and_the_other_boxes() {
    let mut random = Random::new(3);
    let mut pair = Pair { tree: Tree::default(), leaves: Vec::new() };
    for i in 0..200 {
        let mut bounds = some_box(&mut random, 10.0);
        if i % 10 == 0 {
            bounds = Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };
        }
        pair.leaves.push(Some(bounds));
        pair.tree.insert(i, &bounds);
    }
    pair.check();
    pair.ask(&mut random, 10.0);
    pair.tree.rebuild(&mut Vec::new());
    pair.check();
    pair.ask(&mut random, 10.0);
}

/// Empty slots of nodes must not be reported.
#[test]
fn infinite_queries_find_every_leaf_once() {
    let mut random = Random::new(4);
    for count in [1, 3, 8, 9, 61] {
        let mut tree = Tree::default();
        for leaf in 0..count {
            tree.insert(leaf, &some_box(&mut random, [1.0, 1e30][leaf as usize % 2]));
        }
        let everywhere = Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };
        let (mut overlapping, mut near, mut met) = (Vec::new(), Vec::new(), Vec::new());
        let _ = tree.overlapping(&everywhere, |leaf| {
            overlapping.push(leaf);
            ControlFlow::<()>::Continue(())
        });
        tree.nearest(Vec3::ONE, f32::INFINITY, |leaf| {
            near.push(leaf);
            f32::INFINITY
        });
        let half_extents = Vec3::INFINITY;
        tree.along(&Sweep { origin: Vec3::ONE, direction: Vec3::X, half_extents, limit: 1.0 }, |leaf| {
            met.push(leaf);
            1.0
        });
        for mut found in [overlapping, near, met] {
            found.sort_unstable();
            assert!(found.iter().copied().eq(0..count), "{found:?} of {count}");
        }
    }
}
