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

/// Number of shapes up to which a body's shapes are inserted into a tree one by one.
const FEW: usize = 64;

/// A shape of a body, by indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Owner {
    pub body: u32,
    pub shape: u32,
}

/// Bounds of the shapes of all bodies.
#[derive(Clone, Debug, Default)]
pub(crate) struct Proxies {
    fixed: Layer,
    moving: Layer,
    /// Half-spaces, which have no finite bounds.
    unbounded: Vec<Owner>,
    /// Leaves of each body, by its index.
    homes: Vec<Option<Home>>,
    /// Static bodies with a single shape, by index. Rays test many of them, and a body spans several cache lines.
    lone: Vec<Option<Placed>>,
    /// Bounds of each leaf of `moving` during the coming step, world, metres; [`UNKNOWN`] if not needed.
    reach: Vec<Aabb>,
    /// Last pose and motion of each movable body, by its first leaf.
    traces: Vec<Trace>,
    /// Motion of each body, by its index.
    strides: Vec<Stride>,
    /// Bodies that could touch something at the last pair search, and the number of that search.
    active: Vec<u32>,
    active_before: Vec<u32>,
    stamp: u64,
    /// Length of the step of the last `update_motion`, seconds.
    dt: f32,
    /// Bodies all of whose shapes must be searched for pairs.
    dirty: Vec<u32>,
    /// Leaves of `moving` whose bounds have changed since their last search.
    enlarged: Vec<u32>,
    /// True if all movable bodies are pending a search.
    all_pending: bool,
    /// Leaves that are marked as pending.
    pending: Vec<Leaf>,
    /// True if some pending leaves belong to removed bodies.
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

/// Enlarges bounds by the rounding error of an exact test; infinite for NaN, which would corrupt other bounds.
pub(crate) fn thick(bounds: &Aabb) -> Aabb {
    let far = max3(-bounds.min, bounds.max);
    let thick = bounds.expand(PAD * max(far.x, max(far.y, far.z)));
    if thick.min.cmple(thick.max).all() {
        thick
    } else {
        Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY }
    }
}

/// Bounds for the contact search of a shape, world: enlarged by `motion` (m) and a margin.
fn grown(body: &Body, shape: u32, motion: f32) -> Aabb {
    bounds(body, shape).expand(MARGIN + motion)
}

impl Proxies {
    /// Adds the shapes of a new body.
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

    /// Removes the shapes of a removed body.
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

    /// Updates the shapes of a teleported body.
    pub fn place(&mut self, index: u32, body: &Body) {
        let Some(home) = self.homes[index as usize] else { return };
        self.refresh(index, body);
        for shape in (0..home.count).filter(|&shape| is_bounded(body, shape)) {
            self.cover(home, shape, &self.needed(home, body, shape), Vec3::ZERO, BOUNDS_ROOM);
        }
        self.mark_dirty(index);
    }

    /// Updates the shapes of a body with new surfaces.
    pub fn refresh(&mut self, index: u32, body: &Body) {
        self.lone[index as usize] = lone(body);
        if let Some(home) = self.home(index).filter(|home| home.moves && home.count > 0) {
            self.traces[home.first as usize].free = f32::NEG_INFINITY;
        }
    }

    /// Updates all bodies, any of which may have changed; keeps data that still applies.
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

    /// Shape of a static body with a single shape, at its pose, as stored in the body.
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

    /// Allocates leaves for a body and returns them; does not insert them into a tree. Records its half-spaces.
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
            // All leaves may leave their margins in the same step.
            self.enlarged.reserve(count);
            self.pending.reserve(count);
        }
        let unbounded = (0..count).filter(|&shape| !is_bounded(body, shape));
        self.unbounded.extend(unbounded.map(|shape| Owner { body: index, shape }));
        home
    }

    /// Rebuilds one of the trees if it is degraded.
    fn mend(&mut self, moves: bool) {
        if moves && self.moving.tree.is_worn() {
            self.moving.tree.rebuild(&mut self.scratch);
        } else if !moves && self.fixed.tree.is_worn() {
            self.fixed.tree.rebuild(&mut Vec::new());
        }
    }

    /// True if a body's leaves match its shapes; updates the body in that case.
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

    /// Smallest bounds that the tree must hold for a shape.
    fn needed(&self, home: Home, body: &Body, shape: u32) -> Aabb {
        thick(&if home.moves { grown(body, shape, 0.0) } else { bounds(body, shape) })
    }

    fn put(&mut self, home: Home, shape: u32, body: &Body) {
        if is_bounded(body, shape) {
            let bounds = self.needed(home, body, shape);
            self.layer_mut(home.moves).tree.insert(home.first + shape, &bounds);
        }
    }

    /// Ensures that the bounds of a shape in its tree contain `needed`. If they must change, adds a margin of `room`
    /// (m) and the expected motion `way` (m). Returns true if they changed.
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

    /// Marks all shapes of a body as pending, with unknown motion.
    fn mark_dirty(&mut self, index: u32) {
        let Some(home) = &mut self.homes[index as usize] else { return };
        if core::mem::replace(&mut home.dirty, true) {
            return;
        }
        if !home.moves && home.count as usize > FEW {
            // With many pending shapes it is cheaper to search from the movable bodies.
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

    /// Rebuilds a tree, including new bodies.
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

/// Shape of a static body that has exactly one.
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
