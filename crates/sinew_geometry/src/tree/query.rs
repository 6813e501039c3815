//! Tree queries. Each query traverses the nodes with a fixed stack, without allocation, and calls a closure with every
//! candidate leaf; the closure performs the exact test.

use super::Tree;
use super::node::Line;
use super::waiting::{MASK, STACK, Waiting};
use crate::boxes::Aabb;
use core::ops::ControlFlow;
use sinew_math::Vec3;
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{Lanes, WIDTH};

/// A line segment along which a box moves; for a ray the box is a point.
#[derive(Clone, Copy, Debug)]
pub struct Sweep {
    /// Centre of the box at the start, metres.
    pub origin: Vec3,
    /// Displacement at fraction 1, metres.
    pub direction: Vec3,
    /// Half extents of the box, metres, ≥ 0.
    pub half_extents: Vec3,
    /// Fraction at which the sweep ends, ≥ 0.
    pub limit: f32,
}

impl Tree {
    /// Visits every leaf whose bounds overlap or touch these bounds, in unspecified order, until `visit` breaks.
    pub fn overlapping<B>(&self, bounds: &Aabb, visit: impl FnMut(u32) -> ControlFlow<B>) -> ControlFlow<B> {
        match self.root {
            Some(root) => dispatch::run(Overlapping { tree: self, root, bounds, visit }),
            None => ControlFlow::Continue(()),
        }
    }

    /// Visits every leaf that a sweep may hit; within a node the nearer boxes come first. `visit` returns the new limit
    /// of the fraction: unchanged, smaller after a hit, or below 0 to stop.
    pub fn along(&self, sweep: &Sweep, visit: impl FnMut(u32) -> f32) {
        if let Some(root) = self.root {
            dispatch::run(Along { tree: self, root, sweep, visit });
        }
    }

    /// Visits every leaf whose bounds are within `distance` (metres) of a point; within a node the nearer boxes come
    /// first. `visit` returns the new limit of the distance, metres, ≥ 0.
    pub fn nearest(&self, point: Vec3, distance: f32, visit: impl FnMut(u32) -> f32) {
        if let Some(root) = self.root {
            dispatch::run(Nearest { tree: self, root, point, distance, visit });
        }
    }
}

struct Overlapping<'a, V> {
    tree: &'a Tree,
    root: u32,
    bounds: &'a Aabb,
    visit: V,
}

impl<B, V: FnMut(u32) -> ControlFlow<B>> Kernel for Overlapping<'_, V> {
    type Output = ControlFlow<B>;

    #[inline(always)]
    fn run<L: Lanes>(mut self) -> ControlFlow<B> {
        let Aabb { min, max } = *self.bounds;
        let query = [min.x, min.y, min.z, max.x, max.y, max.z].map(L::splat);
        let mut stack = [0; STACK];
        stack[0] = self.root;
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let node = &self.tree.nodes[stack[depth & MASK] as usize];
            for (_, child) in node.held(node.overlapping(&query)) {
                match child.get() {
                    Ok(leaf) => (self.visit)(leaf)?,
                    Err(child) => {
                        stack[depth & MASK] = child;
                        depth += 1;
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }
}

struct Along<'a, V> {
    tree: &'a Tree,
    root: u32,
    sweep: &'a Sweep,
    visit: V,
}

impl<V: FnMut(u32) -> f32> Kernel for Along<'_, V> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self) {
        let Sweep { origin, direction, half_extents, mut limit } = *self.sweep;
        let line = Line::new(origin, direction, half_extents, limit);
        let mut waiting = Waiting::new(self.root);
        let mut enter = [0.0; WIDTH];
        while let Some((key, child)) = waiting.pop() {
            // A leaf at the distance of the best result so far may contain an equal result, so it is tested, too.
            if key > limit * (1.0 + super::PAD) {
                continue;
            }
            match child.get() {
                Ok(leaf) => limit = (self.visit)(leaf),
                Err(index) => {
                    let node = &self.tree.nodes[index as usize];
                    let mask = node.entered::<L>(&line, limit, &mut enter);
                    waiting.push(node, mask, &enter);
                }
            }
        }
    }
}

struct Nearest<'a, V> {
    tree: &'a Tree,
    root: u32,
    point: Vec3,
    distance: f32,
    visit: V,
}

impl<V: FnMut(u32) -> f32> Kernel for Nearest<'_, V> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self) {
        let far = self.point.abs();
        let pad = super::PAD * sinew_math::max(far.x, sinew_math::max(far.y, far.z));
        let point = self.point.to_array().map(L::splat);
        // Square of a distance, enlarged to cover rounding errors.
        let square = |distance: f32| distance * distance * (1.0 + super::PAD);
        let mut limit = square(self.distance);
        let mut waiting = Waiting::new(self.root);
        let mut squares = [0.0; WIDTH];
        while let Some((key, child)) = waiting.pop() {
            if key > limit {
                continue;
            }
            match child.get() {
                Ok(leaf) => limit = square((self.visit)(leaf)),
                Err(index) => {
                    let node = &self.tree.nodes[index as usize];
                    let mask = node.distances(&point, L::splat(pad), limit, &mut squares);
                    waiting.push(node, mask, &squares);
                }
            }
        }
    }
}
