//! Tree queries: candidate pairs, and shapes near a box, along a line or around a point.

use super::layer::Home;
use super::{Leaf, Owner, Proxies, grown, is_bounded};
use crate::arena::Arena;
use crate::body::Body;
use crate::boxes::Aabb;
use crate::contact::ContactKey;
use crate::contact::filter::kinds_meet;
use crate::contact::tuning::MARGIN;
use crate::tree::{PAD, Sweep, Tree};
use core::ops::ControlFlow;
use sinew_math::{Vec3, max, max3};

impl Proxies {
    /// True if any search is pending.
    pub fn has_pending(&self) -> bool {
        self.all_pending || !(self.dirty.is_empty() && self.enlarged.is_empty() && self.pending.is_empty())
    }

    /// True if the only pending shapes are those that left their bounds.
    pub fn only_enlarged(&self) -> bool {
        !self.all_pending && self.dirty.is_empty() && !self.has_gone
    }

    /// True if the pairs of a shape are pending a search.
    pub fn is_pending(&self, leaf: Leaf) -> bool {
        self.all_pending || self.layer(leaf.moves()).is_pending[leaf.at()]
    }

    /// Clears all pending searches.
    pub fn clear_pending(&mut self) {
        (self.all_pending, self.has_gone) = (false, false);
        for index in self.dirty.drain(..) {
            if let Some(home) = &mut self.homes[index as usize] {
                home.dirty = false;
            }
        }
        self.enlarged.clear();
        for leaf in self.pending.drain(..) {
            let layer = if leaf.moves() { &mut self.moving } else { &mut self.fixed };
            layer.is_pending[leaf.at()] = false;
        }
    }

    /// Visits the pairs of a pending shape and another shape whose tree bounds overlap, if one of them can touch and
    /// their kinds may collide (a body whose kind changes becomes pending). Each pair is visited at least once, in
    /// unspecified order. Call [`update_motion`](Self::update_motion) first.
    pub fn search(&mut self, bodies: &Arena<Body>, mut visit: impl FnMut((Owner, Leaf), (Owner, Leaf))) {
        if self.all_pending {
            for &index in &self.active {
                let Some(home) = self.home(index) else { continue };
                for shape in 0..home.count {
                    self.neighbors(bodies, Owner { body: index, shape }, home.leaf(shape), &mut visit);
                }
            }
            return;
        }
        for at in 0..self.dirty.len() {
            let Some(home) = self.home(self.dirty[at]) else { continue };
            for shape in 0..home.count {
                self.enqueue(home.leaf(shape));
            }
        }
        self.enlarged.retain(|&leaf| !self.moving.is_pending[leaf as usize]);
        for at in 0..self.enlarged.len() {
            self.enqueue(Leaf::new(true, self.enlarged[at]));
        }
        for &leaf in &self.pending {
            let owner = self.layer(leaf.moves()).owners[leaf.at()];
            let is_at = |home: Home| owner.shape < home.count && home.leaf(owner.shape) == leaf;
            let is_there = self.home(owner.body).is_some_and(is_at);
            if is_there && bodies.try_at(owner.body).is_some() {
                self.neighbors(bodies, owner, leaf, &mut visit);
            }
        }
    }

    /// True if the search visits the neighbours of a movable shape.
    fn is_asking(&self, owner: Owner, leaf: Leaf) -> bool {
        if self.all_pending {
            self.home(owner.body).is_some_and(|home| home.active == self.stamp)
        } else {
            self.moving.is_pending[leaf.at()]
        }
    }

    /// Visits the pairs of a shape with shapes whose bounds overlap its own.
    fn neighbors(
        &self,
        bodies: &Arena<Body>,
        owner: Owner,
        leaf: Leaf,
        visit: &mut impl FnMut((Owner, Leaf), (Owner, Leaf)),
    ) {
        let body = bodies.at(owner.body);
        if body.surface(owner.shape as usize).filter.meets_none() {
            return;
        }
        let bounds = self.wide_bounds(body, owner, leaf);
        let sensing = body.surface(owner.shape as usize).sensing;
        let mut meet = |other: Owner, its: Leaf| {
            // The search finds a pair of pending movable shapes from both shapes; the second time it is skipped.
            let is_found = leaf.moves() && its.moves() && its.at() < leaf.at() && self.is_asking(other, its);
            let its_body = bodies.at(other.body);
            let its_sensing = its_body.surface(other.shape as usize).sensing;
            if other.body != owner.body
                && !is_found
                && (body.can_touch() || its_body.can_touch())
                && kinds_meet([(body.kind, sensing), (its_body.kind, its_sensing)])
            {
                visit((owner, leaf), (other, its));
            }
            ControlFlow::<()>::Continue(())
        };
        let _ = self
            .moving
            .tree
            .overlapping(&bounds, |leaf| meet(self.moving.owners[leaf as usize], Leaf::new(true, leaf)));
        if !leaf.moves() {
            return;
        }
        // The bounds of fixed shapes include no search margin.
        let _ = self.fixed.tree.overlapping(&bounds.expand(1.01 * MARGIN), |leaf| {
            meet(self.fixed.owners[leaf as usize], Leaf::new(false, leaf))
        });
        for &other in &self.unbounded {
            if let Some(home) = self.home(other.body) {
                let _ = meet(other, home.leaf(other.shape));
            }
        }
    }

    /// Tree bounds of a shape including the search margin.
    fn wide_bounds(&self, body: &Body, owner: Owner, leaf: Leaf) -> Aabb {
        match (leaf.moves(), is_bounded(body, owner.shape)) {
            (true, _) => self.moving.tree.bounds(leaf.at() as u32),
            (false, true) => self.fixed.tree.bounds(leaf.at() as u32).expand(1.01 * MARGIN),
            (false, false) => Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY },
        }
    }

    /// True if the bounds of two shapes in their trees do not overlap. Both must be in the trees.
    pub fn are_parted(&self, leaves: [Leaf; 2]) -> bool {
        let bounds = |leaf: Leaf| {
            let tree = &self.layer(leaf.moves()).tree;
            let margin = if leaf.moves() { 0.0 } else { 1.01 * MARGIN };
            tree.contains(leaf.at() as u32).then(|| tree.bounds(leaf.at() as u32).expand(margin))
        };
        let [p, q] = leaves.map(bounds);
        p.is_some_and(|p| q.is_some_and(|q| !overlap(&p, &q)))
    }

    /// True if two shapes are near each other: their bounds, grown by the motion of the coming step and a margin,
    /// overlap. Does not depend on the trees' history.
    pub fn are_near(&self, bodies: &Arena<Body>, key: ContactKey, leaves: [Leaf; 2]) -> bool {
        let [(p, _), (q, _)] = self.grown_bounds(bodies, key, leaves);
        overlap(&p, &q)
    }

    /// Gap between the bounds of two shapes, metres: a lower bound of their distance.
    pub fn gap(&self, bodies: &Arena<Body>, key: ContactKey, leaves: [Leaf; 2]) -> f32 {
        let [(p, grown_p), (q, grown_q)] = self.grown_bounds(bodies, key, leaves);
        let beyond = max3(p.min - q.max, q.min - p.max);
        let apart = max3(beyond + Vec3::splat(2.0 * MARGIN + (grown_p + grown_q)), Vec3::ZERO);
        let far = max3(max3(-p.min, p.max), max3(-q.min, q.max));
        apart.length() - PAD * max(far.x, max(far.y, far.z))
    }

    /// Bounds of the two shapes, grown by a margin and by motion, and the motion of each, metres.
    fn grown_bounds(&self, bodies: &Arena<Body>, key: ContactKey, leaves: [Leaf; 2]) -> [(Aabb, f32); 2] {
        let grown = |leaf: Leaf, body: u32, shape: u32| {
            if leaf.moves() {
                let (reach, motion) = (self.reach[leaf.at()], self.strides[body as usize].grown);
                let reach = if reach.min.x.is_nan() { grown(bodies.at(body), shape, motion) } else { reach };
                (reach, motion)
            } else {
                (grown(bodies.at(body), shape, 0.0), 0.0)
            }
        };
        [grown(leaves[0], key.a, key.shape_a), grown(leaves[1], key.b, key.shape_b)]
    }

    /// Visits every shape whose bounds overlap `bounds`, including touching ones and half-spaces, and possibly other
    /// nearby ones, in unspecified order, until `visit` breaks.
    pub fn overlapping<B>(
        &self,
        bounds: &Aabb,
        mut visit: impl FnMut(Owner) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        for &owner in &self.unbounded {
            visit(owner)?;
        }
        for layer in [&self.fixed, &self.moving] {
            layer.tree.overlapping(bounds, |leaf| visit(layer.owners[leaf as usize]))?;
        }
        ControlFlow::Continue(())
    }

    /// Half-spaces of all bodies.
    pub fn unbounded(&self) -> &[Owner] {
        &self.unbounded
    }

    /// Trees of all other shapes that are not empty, with the owners of their leaves.
    pub fn trees(&self) -> impl Iterator<Item = (&Tree, &[Owner])> {
        let layers = [&self.fixed, &self.moving].into_iter().filter(|layer| !layer.tree.is_empty());
        layers.map(|layer| (&layer.tree, layer.owners.as_slice()))
    }

    /// Visits every shape that a line may hit; see [`Tree::along`].
    pub fn along(&self, sweep: &Sweep, mut visit: impl FnMut(Owner) -> f32) {
        let mut sweep = *sweep;
        for &owner in &self.unbounded {
            sweep.limit = visit(owner);
        }
        for layer in [&self.fixed, &self.moving] {
            let mut limit = sweep.limit;
            layer.tree.along(&sweep, |leaf| {
                limit = visit(layer.owners[leaf as usize]);
                limit
            });
            sweep.limit = limit;
        }
    }

    /// Visits every shape that may be within `distance` (m) of a point; see [`Tree::nearest`].
    pub fn nearest(&self, point: Vec3, mut distance: f32, mut visit: impl FnMut(Owner) -> f32) {
        for &owner in &self.unbounded {
            distance = visit(owner);
        }
        for layer in [&self.fixed, &self.moving] {
            let start = distance;
            layer.tree.nearest(point, start, |leaf| {
                distance = visit(layer.owners[leaf as usize]);
                distance
            });
        }
    }
}

fn overlap(a: &Aabb, b: &Aabb) -> bool {
    use crate::boxes::Overlap;
    a.overlaps(b)
}
