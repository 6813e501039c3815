//! Bounds of all shapes of a world in two trees, one for fixed and one for movable shapes. Bounds of movable shapes
//! have a margin, so that the tree need not change in every step. The trees are always valid, within a step and between
//! steps, and query results do not depend on their history: they are not part of the state.

mod layer;
mod motion;
mod search;

pub(crate) use layer::Leaf;
use layer::{Home, Layer};
pub(crate) use motion::{Ahead, Closing};
use motion::{Stride, Trace, UNKNOWN};

use crate::arena::Arena;
use crate::body::Body;
use crate::body::def::BodyKind;
use crate::body::shape::{Filter, Sensing, Shape};
use crate::body::surface::Surface;
use crate::boxes::Aabb;
use crate::contact::tuning::{BOUNDS_EXCESS, BOUNDS_ROOM, MARGIN};
use crate::tree::{Item, PAD};
use sinew_math::{Transform, Vec3, max, max3, min3};

/// Bodies with fewer shapes are inserted into a tree individually.
const FEW: usize = 64;

/// A shape of a body: indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Owner {
    pub body: u32,
    pub shape: u32,
}

/// The shapes of all bodies, by their bounds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Proxies {
    fixed: Layer,
    moving: Layer,
    /// Half-spaces: their bounds would be useless.
    unbounded: Vec<Owner>,
    /// Leaves of each body, by its index.
    homes: Vec<Option<Home>>,
    /// Static bodies with a single shape, by index: rays hit many, and a body spans several cache lines.
    lone: Vec<Option<Placed>>,
    /// Bounds of each leaf of `moving` during the coming step, world, metres; [`UNKNOWN`] if not needed.
    reach: Vec<Aabb>,
    /// Traces by the first leaf of each movable body.
    traces: Vec<Trace>,
    /// Strides by index of the body.
    strides: Vec<Stride>,
    /// Bodies that could touch something at the last pair search, and its time.
    active: Vec<u32>,
    active_before: Vec<u32>,
    stamp: u64,
    /// Step that the last `update_motion` was for, seconds.
    dt: f32,
    /// Bodies whose shapes are all pending a search.
    dirty: Vec<u32>,
    /// Leaves of `moving` whose bounds have changed since their last search.
    enlarged: Vec<u32>,
    /// Everything movable is pending a search.
    all_pending: bool,
    /// Leaves that are marked as pending.
    pending: Vec<Leaf>,
    /// Some of them belong to removed bodies.
    has_gone: bool,
    scratch: Vec<Item>,
}

/// A shape with its pose and owner.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub shape: Shape,
    pub world_from_shape: Transform,
    pub filter: Filter,
    pub sensing: Sensing,
}

/// Bounds of a shape at its current pose.
fn bounds(body: &Body, shape: u32) -> Aabb {
    body.shapes[shape as usize].shape.aabb(&body.world_from_shape(shape as usize))
}

/// Enlarged by the rounding error of an exact test; infinite for NaN, which would corrupt the bounds of others.
pub(crate) fn thick(bounds: &Aabb) -> Aabb {
    let far = max3(-bounds.min, bounds.max);
    let thick = bounds.expand(PAD * max(far.x, max(far.y, far.z)));
    if thick.min.cmple(thick.max).all() {
        thick
    } else {
        Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY }
    }
}

/// Bounds for the contact search of a shape, world: its own, grown by its motion and a margin.
fn grown(body: &Body, shape: u32, motion: f32) -> Aabb {
    bounds(body, shape).expand(MARGIN + motion)
}

impl Proxies {
    /// A body was added.
    pub fn add(&mut self, index: u32, body: &Body) {
        let home = self.move_in(index, body);
        let count = home.count as usize;
        let tree = &self.layer(home.moves).tree;
        if count > FEW && count * 2 > tree.len() {
            self.build(home.moves, &[(index, body)]);
        } else {
            for shape in 0..home.count {
                self.put(home, shape, body);
            }
            self.mend(home.moves);
        }
        self.mark_dirty(index);
    }

    /// A body was removed.
    pub fn remove(&mut self, index: u32) {
        let Some(home) = self.homes.get_mut(index as usize).and_then(Option::take) else { return };
        self.lone[index as usize] = None;
        let layer = self.layer_mut(home.moves);
        for leaf in home.first..home.first + home.count {
            if layer.tree.contains(leaf) {
                layer.tree.remove(leaf);
            }
        }
        layer.gaps.entry(home.count).or_default().push(home.first);
        self.unbounded.retain(|owner| owner.body != index);
        self.has_gone |= home.count > 0;
        for shape in 0..home.count {
            self.enqueue(home.leaf(shape));
        }
    }

    /// A body was teleported.
    pub fn place(&mut self, index: u32, body: &Body) {
        let Some(home) = self.homes[index as usize] else { return };
        self.refresh(index, body);
        for shape in (0..home.count).filter(|&shape| is_bounded(body, shape)) {
            self.cover(home, shape, &self.needed(home, body, shape), Vec3::ZERO, BOUNDS_ROOM);
        }
        self.mark_dirty(index);
    }

    /// A body has new surfaces.
    pub fn refresh(&mut self, index: u32, body: &Body) {
        self.lone[index as usize] = lone(body);
        if let Some(home) = self.home(index).filter(|home| home.moves && home.count > 0) {
            self.traces[home.first as usize].free = f32::NEG_INFINITY;
        }
    }

    /// All bodies may have changed: keeps what still matches.
    pub fn adopt(&mut self, bodies: &Arena<Body>) {
        for index in 0..self.homes.len() as u32 {
            let body = bodies.try_at(index);
            if !body.is_some_and(|body| self.fits(index, body)) {
                self.remove(index);
            }
        }
        for moves in [false, true] {
            let is_new = |&(index, body): &(u32, &Body)| {
                (body.kind != BodyKind::Static) == moves && self.home(index).is_none()
            };
            let new: Vec<(u32, &Body)> = bodies.iter().filter(is_new).collect();
            let count: usize = new.iter().map(|(_, body)| body.shapes.len()).sum();
            if count > FEW && count * 2 > self.layer(moves).tree.len() {
                for &(index, body) in &new {
                    self.move_in(index, body);
                    self.mark_dirty(index);
                }
                self.build(moves, &new);
            } else {
                for &(index, body) in &new {
                    self.add(index, body);
                }
            }
        }
        self.all_pending = true;
        self.traces.fill(Trace::NONE);
    }

    /// The shape of a single-shape static body, at its pose, as stored in the body.
    pub fn lone(&self, index: u32) -> Option<&Placed> {
        self.lone[index as usize].as_ref()
    }

    fn home(&self, index: u32) -> Option<Home> {
        self.homes.get(index as usize).copied().flatten()
    }

    fn layer(&self, moves: bool) -> &Layer {
        if moves { &self.moving } else { &self.fixed }
    }

    fn layer_mut(&mut self, moves: bool) -> &mut Layer {
        if moves { &mut self.moving } else { &mut self.fixed }
    }

    /// Allocates leaves for a body, not yet in a tree; half-spaces get none.
    fn move_in(&mut self, index: u32, body: &Body) -> Home {
        let moves = body.kind != BodyKind::Static;
        let count = body.shapes.len() as u32;
        let first = self.layer_mut(moves).claim(index, count);
        let home = Home { first, count, moves, dirty: false, active: 0 };
        if self.homes.len() <= index as usize {
            self.homes.resize(index as usize + 1, None);
            self.lone.resize(index as usize + 1, None);
            self.strides.resize(index as usize + 1, Stride::default());
        }
        self.homes[index as usize] = Some(home);
        self.strides[index as usize] = Stride::default();
        self.lone[index as usize] = lone(body);
        if moves {
            let count = self.moving.owners.len();
            self.reach.resize(count, UNKNOWN);
            self.traces.resize(count, Trace::NONE);
            let own = first as usize..(first + home.count) as usize;
            self.reach[own.clone()].fill(UNKNOWN);
            self.traces[own].fill(Trace::NONE);
            self.moving.tree.reserve(count);
            self.scratch.reserve(count);
            // All may leave their margins at once.
            self.enlarged.reserve(count);
            self.pending.reserve(count);
        }
        let unbounded = (0..count).filter(|&shape| !is_bounded(body, shape));
        self.unbounded.extend(unbounded.map(|shape| Owner { body: index, shape }));
        home
    }

    /// Rebuilds a degraded tree.
    fn mend(&mut self, moves: bool) {
        if moves && self.moving.tree.is_worn() {
            self.moving.tree.rebuild(&mut self.scratch);
        } else if !moves && self.fixed.tree.is_worn() {
            self.fixed.tree.rebuild(&mut Vec::new());
        }
    }

    /// True if a body's leaves are up to date and contain it.
    fn fits(&mut self, index: u32, body: &Body) -> bool {
        let Some(home) = self.home(index) else { return false };
        let tree = &self.layer(home.moves).tree;
        let is_there = |shape: u32| tree.contains(home.first + shape) == is_bounded(body, shape);
        let fits = home.moves == (body.kind != BodyKind::Static)
            && home.count as usize == body.shapes.len()
            && (0..home.count).all(is_there);
        if fits {
            self.place(index, body);
        }
        fits
    }

    /// Least bounds that the tree must hold for a shape.
    fn needed(&self, home: Home, body: &Body, shape: u32) -> Aabb {
        thick(&if home.moves { grown(body, shape, 0.0) } else { bounds(body, shape) })
    }

    fn put(&mut self, home: Home, shape: u32, body: &Body) {
        if is_bounded(body, shape) {
            let bounds = self.needed(home, body, shape);
            self.layer_mut(home.moves).tree.insert(home.first + shape, &bounds);
        }
    }

    /// Ensures that the bounds of a shape in its tree contain these; if they must change, adds a margin, mostly along
    /// the expected `way`, metres. Returns true if they changed.
    fn cover(&mut self, home: Home, shape: u32, needed: &Aabb, way: Vec3, room: f32) -> bool {
        let leaf = home.first + shape;
        let tree = &mut self.layer_mut(home.moves).tree;
        let own = tree.bounds(leaf);
        let room = if home.moves { room } else { 0.0 };
        // A resting body needs a smaller margin than a falling one.
        let fits =
            own.contains(needed) && needed.expand(BOUNDS_EXCESS * (room + way.length())).contains(&own);
        if !fits {
            let Aabb { min, max } = needed.expand(room);
            let roomy = Aabb { min: min + min3(way, Vec3::ZERO), max: max + max3(way, Vec3::ZERO) };
            tree.update(leaf, &roomy);
        }
        !fits
    }

    /// Makes all shapes of a body pending; its motion is unknown.
    fn mark_dirty(&mut self, index: u32) {
        let Some(home) = &mut self.homes[index as usize] else { return };
        if core::mem::replace(&mut home.dirty, true) {
            return;
        }
        if !home.moves && home.count as usize > FEW {
            // Cheaper from the other side.
            self.all_pending = true;
        }
        self.dirty.push(index);
    }

    fn enqueue(&mut self, leaf: Leaf) {
        let layer = if leaf.moves() { &mut self.moving } else { &mut self.fixed };
        if !core::mem::replace(&mut layer.is_pending[leaf.at()], true) {
            self.pending.push(leaf);
        }
    }

    /// Rebuilds a tree, including bodies with new leaves.
    fn build(&mut self, moves: bool, new: &[(u32, &Body)]) {
        let count = new.iter().map(|(_, body)| body.shapes.len()).sum::<usize>();
        let mut items = Vec::with_capacity(self.layer(moves).tree.len() + count);
        self.layer(moves).tree.collect(&mut items);
        for &(index, body) in new {
            let Some(home) = self.home(index) else { continue };
            let bounded = (0..home.count).filter(|&shape| is_bounded(body, shape));
            items.extend(
                bounded
                    .map(|shape| Item { bounds: self.needed(home, body, shape), leaf: home.first + shape }),
            );
        }
        let layer = self.layer_mut(moves);
        layer.tree.build(&mut items);
        if moves {
            let count = layer.owners.len();
            layer.tree.reserve(count);
        }
    }
}

/// The shape of a static body that has one.
fn lone(body: &Body) -> Option<Placed> {
    match (body.kind, body.shapes.as_slice()) {
        (BodyKind::Static, [only]) => {
            let &Surface { filter, sensing, .. } = body.surface(0);
            let (shape, world_from_shape) = (only.shape.clone(), body.world_from_shape(0));
            Some(Placed { shape, world_from_shape, filter, sensing })
        }
        _ => None,
    }
}

fn is_bounded(body: &Body, shape: u32) -> bool {
    body.shapes[shape as usize].shape != Shape::HalfSpace
}
