//! Where all shapes of a world are: their bounds, in two trees, one for what is fixed and one for what may move. Bounds of
//! what moves have room to move in, so that the tree need not change in every step. The trees hold at any time, within a
//! step and between steps, and what they answer does not depend on how they came to be: they are no part of the state.

use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::Body;
use crate::boxes::Aabb;
use crate::def::BodyKind;
use crate::shape::{Filter, Sensing, Shape};
use crate::surface::Surface;
use crate::tree::{Item, PAD, Sweep, Tree};
use core::ops::ControlFlow;
use sinew_math::{Transform, Vec3, max, max3};
use std::collections::BTreeMap;

/// Distance within which contacts are looked for, beside the motion of the step, metres.
pub(crate) const MARGIN: f32 = 0.02;
/// Room that what moves has beyond that, metres and steps at its present speed.
const ROOM: f32 = 0.04;
const ROOM_STEPS: f32 = 2.0;
/// Bodies with fewer shapes are put into a tree one by one.
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
    /// Half-spaces: their bounds would tell nothing.
    unbounded: Vec<Owner>,
    /// Which leaves are a body's, by its index.
    homes: Vec<Option<Home>>,
    /// Static bodies of a single shape, by index: rays meet many, and a body is spread over several lines of the cache.
    lone: Vec<Option<Placed>>,
    /// Of each leaf of `moving`: where it may be within the coming step.
    reach: Vec<Aabb>,
    scratch: Vec<Item>,
}

/// A shape where it is, and who asks for it.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub shape: Shape,
    pub world_from_shape: Transform,
    pub filter: Filter,
    pub sensing: Sensing,
}

/// A tree, and whose its leaves are.
#[derive(Clone, Debug, Default)]
struct Layer {
    tree: Tree,
    owners: Vec<Owner>,
    /// Numbers of leaves that are not used, by how many there are in a row.
    gaps: BTreeMap<u32, Vec<u32>>,
}

/// Leaves of a body: so many from `first` on, one for each shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Home {
    first: u32,
    count: u32,
    moves: bool,
}

impl Layer {
    /// Numbers for the shapes of a body; the first of them.
    fn claim(&mut self, body: u32, count: u32) -> u32 {
        let first = match self.gaps.get_mut(&count).and_then(Vec::pop) {
            Some(first) => first,
            None => self.owners.len() as u32,
        };
        let end = (first + count) as usize;
        if self.owners.len() < end {
            if count as usize > FEW {
                self.owners.reserve_exact(count as usize);
            }
            self.owners.resize(end, Owner { body, shape: 0 });
        }
        for shape in 0..count {
            self.owners[(first + shape) as usize] = Owner { body, shape };
        }
        first
    }
}

/// Bounds of a shape as it is placed now.
fn bounds(body: &Body, shape: u32) -> Aabb {
    body.shapes[shape as usize].shape.aabb(&body.world_from_shape(shape as usize))
}

/// Larger by what rounding may do in an exact test; without end if a number is none, since that would spoil the bounds of
/// others.
pub(crate) fn thick(bounds: &Aabb) -> Aabb {
    let far = max3(-bounds.min, bounds.max);
    let thick = bounds.expand(PAD * max(far.x, max(far.y, far.z)));
    if thick.min.cmple(thick.max).all() {
        thick
    } else {
        Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY }
    }
}

/// How far a body may move within `dt` seconds, metres.
fn motion(body: &Body, dt: f32) -> f32 {
    match body.kind {
        BodyKind::Static => 0.0,
        _ => (body.velocity.linear.length() + body.velocity.angular.length() * body.reach()) * dt,
    }
}

/// Where contacts of a shape are looked for: its bounds, grown by its motion and a margin.
fn grown(body: &Body, shape: u32, motion: f32) -> Aabb {
    bounds(body, shape).expand(MARGIN + motion)
}

impl Proxies {
    /// A body has come.
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
    }

    /// A body has gone.
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
    }

    /// A body has been put somewhere else.
    pub fn place(&mut self, index: u32, body: &Body) {
        let Some(home) = self.homes[index as usize] else { return };
        self.refresh(index, body);
        for shape in (0..home.count).filter(|&shape| is_bounded(body, shape)) {
            self.cover(home, shape, &self.needed(home, body, shape), ROOM);
        }
    }

    /// A body has other surfaces than before.
    pub fn refresh(&mut self, index: u32, body: &Body) {
        self.lone[index as usize] = lone(body);
    }

    /// All bodies may be others than before: keeps what fits.
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
                }
                self.build(moves, &new);
            } else {
                for &(index, body) in &new {
                    self.add(index, body);
                }
            }
        }
    }

    /// Works out where all that moves may be within a step of `dt` seconds, and lets the tree follow.
    pub fn follow(&mut self, bodies: &Arena<Body>, activity: &Activity, dt: f32) {
        self.mend(false);
        self.mend(true);
        for index in activity.movers() {
            let body = bodies.at(index);
            if !body.can_touch() {
                continue;
            }
            let Some(home) = self.homes[index as usize] else { continue };
            let motion = motion(body, dt);
            for shape in 0..home.count {
                let reach = grown(body, shape, motion);
                self.reach[(home.first + shape) as usize] = reach;
                self.cover(home, shape, &thick(&reach), ROOM + ROOM_STEPS * motion);
            }
        }
    }

    /// Pairs of shapes whose bounds, grown by their motion in the coming step and a margin, overlap, and of which the first
    /// can start a contact: each once, in no order. [`follow`](Self::follow) comes before.
    pub fn pairs(&self, bodies: &Arena<Body>, activity: &Activity, mut visit: impl FnMut(Owner, Owner)) {
        for index in activity.movers() {
            let Some(home) = self.homes[index as usize].filter(|_| bodies.at(index).can_touch()) else {
                continue;
            };
            for shape in 0..home.count {
                let reach = self.reach[(home.first + shape) as usize];
                let owner = Owner { body: index, shape };
                self.meeting(bodies, index, &reach, |other| visit(owner, other));
            }
        }
    }

    /// Likewise, pairs of fixed bodies that were changed with what cannot start a contact itself.
    pub fn pairs_of_changed(
        &self,
        bodies: &Arena<Body>,
        changed: &[u32],
        mut visit: impl FnMut(Owner, Owner),
    ) {
        for &index in changed {
            let Some(home) = self.home(index).filter(|home| !home.moves) else { continue };
            for shape in 0..home.count {
                let reach = grown(bodies.at(index), shape, 0.0);
                let _ = self.moving.tree.overlapping(&reach, |leaf| {
                    let other = self.moving.owners[leaf as usize];
                    let body = bodies.at(other.body);
                    if !body.can_touch() && overlap(&reach, &grown(body, other.shape, 0.0)) {
                        visit(Owner { body: index, shape }, other);
                    }
                    ControlFlow::<()>::Continue(())
                });
            }
        }
    }

    /// What the bounds of a shape of a body meet, but for what finds this one.
    fn meeting(&self, bodies: &Arena<Body>, index: u32, reach: &Aabb, mut visit: impl FnMut(Owner)) {
        let mut visit_if = |other: Owner, its: &Aabb| {
            if overlap(reach, its) {
                visit(other);
            }
        };
        for &other in &self.unbounded {
            visit_if(other, &grown(bodies.at(other.body), other.shape, 0.0));
        }
        // The bounds of what is fixed lack its margin.
        let _ = self.fixed.tree.overlapping(&reach.expand(1.01 * MARGIN), |leaf| {
            let other = self.fixed.owners[leaf as usize];
            visit_if(other, &grown(bodies.at(other.body), other.shape, 0.0));
            ControlFlow::<()>::Continue(())
        });
        let _ = self.moving.tree.overlapping(reach, |leaf| {
            let other = self.moving.owners[leaf as usize];
            let body = bodies.at(other.body);
            if !body.can_touch() {
                visit_if(other, &grown(body, other.shape, 0.0));
            } else if index < other.body {
                visit_if(other, &self.reach[leaf as usize]);
            }
            ControlFlow::<()>::Continue(())
        });
    }

    /// Every shape whose bounds overlap these, touching ones and half-spaces too, and perhaps others near by; in no order,
    /// until one breaks off.
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

    /// Half-spaces.
    pub fn unbounded(&self) -> &[Owner] {
        &self.unbounded
    }

    /// All other shapes: trees that are not empty, each with whose its leaves are.
    pub fn trees(&self) -> impl Iterator<Item = (&Tree, &[Owner])> {
        let layers = [&self.fixed, &self.moving].into_iter().filter(|layer| layer.tree.len() > 0);
        layers.map(|layer| (&layer.tree, layer.owners.as_slice()))
    }

    /// Every shape that may be met along a line; see [`Tree::along`].
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

    /// Every shape that may be within `distance` (m) of a point; see [`Tree::nearest`].
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

    /// The shape of a static body that has no other, where it is: what the body would say.
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

    /// Gives a body leaves, which are not in a tree yet; of half-spaces they never are.
    fn move_in(&mut self, index: u32, body: &Body) -> Home {
        let moves = body.kind != BodyKind::Static;
        let count = body.shapes.len() as u32;
        let home = Home { first: self.layer_mut(moves).claim(index, count), count, moves };
        if self.homes.len() <= index as usize {
            self.homes.resize(index as usize + 1, None);
            self.lone.resize(index as usize + 1, None);
        }
        self.homes[index as usize] = Some(home);
        self.lone[index as usize] = lone(body);
        if moves {
            let count = self.moving.owners.len();
            self.reach.resize(count, Aabb::default());
            self.moving.tree.reserve(count);
            self.scratch.reserve(count);
        }
        let unbounded = (0..count).filter(|&shape| !is_bounded(body, shape));
        self.unbounded.extend(unbounded.map(|shape| Owner { body: index, shape }));
        home
    }

    /// Builds a tree anew if it is worn.
    fn mend(&mut self, moves: bool) {
        if moves && self.moving.tree.is_worn() {
            self.moving.tree.rebuild(&mut self.scratch);
        } else if !moves && self.fixed.tree.is_worn() {
            self.fixed.tree.rebuild(&mut Vec::new());
        }
    }

    /// Whether a body's leaves are those that it would be given now, and hold it.
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

    /// What the bounds of a shape in its tree hold at least.
    fn needed(&self, home: Home, body: &Body, shape: u32) -> Aabb {
        thick(&if home.moves { grown(body, shape, 0.0) } else { bounds(body, shape) })
    }

    fn put(&mut self, home: Home, shape: u32, body: &Body) {
        if is_bounded(body, shape) {
            let bounds = self.needed(home, body, shape);
            self.layer_mut(home.moves).tree.insert(home.first + shape, &bounds);
        }
    }

    /// Sees to it that the bounds of a shape in its tree hold these, with room to spare if they have to be changed.
    fn cover(&mut self, home: Home, shape: u32, needed: &Aabb, room: f32) {
        let leaf = home.first + shape;
        let tree = &mut self.layer_mut(home.moves).tree;
        if !tree.bounds(leaf).contains(needed) {
            tree.update(leaf, &needed.expand(if home.moves { room } else { 0.0 }));
        }
    }

    /// Builds a tree anew, with bodies that have just been given leaves.
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

fn overlap(a: &Aabb, b: &Aabb) -> bool {
    use crate::boxes::Overlap;
    a.overlaps(b)
}
