//! Bounds of all shapes of a world, in two trees, one for what is fixed and one for what may move. Bounds of
//! what moves have room to move in, so that the tree need not change in every step. The trees hold at any time, within a
//! step and between steps, and what they answer does not depend on how they came to be: they are no part of the state.

use crate::arena::Arena;
use crate::body::def::BodyKind;
use crate::body::shape::{Filter, Sensing, Shape};
use crate::body::surface::Surface;
use crate::body::{Body, Velocity};
use crate::boxes::Aabb;
use crate::contact::ContactKey;
use crate::contact::filter::kinds_meet;
use crate::contact::tuning::{
    BOUNDS_EXCESS, BOUNDS_ROOM, BOUNDS_ROOM_LED, BOUNDS_STEPS, BOUNDS_STEPS_ALONE, BOUNDS_STEPS_LED, MARGIN,
};
use crate::tree::{Item, PAD, Sweep, Tree};
use core::ops::ControlFlow;
use sinew_math::{Transform, Vec3, max, max3, min, min3};
use std::collections::BTreeMap;

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
    /// Leaves of each body, by its index.
    homes: Vec<Option<Home>>,
    /// Static bodies of a single shape, by index: rays meet many, and a body is spread over several lines of the cache.
    lone: Vec<Option<Placed>>,
    /// Bounds of each leaf of `moving` within the coming step, world, metres; [`UNKNOWN`] where nobody needed them.
    reach: Vec<Aabb>,
    /// By the first leaf of each body that may move.
    traces: Vec<Trace>,
    /// By index of the body.
    strides: Vec<Stride>,
    /// Bodies that could touch something when pairs were looked for last, and when that was.
    lively: Vec<u32>,
    lively_before: Vec<u32>,
    stamp: u64,
    /// Step that the last `follow` was for, seconds.
    dt: f32,
    /// Bodies all of whose shapes are to be looked for anew.
    soiled: Vec<u32>,
    /// Leaves of `moving` that have other bounds than when they were last looked for.
    stray: Vec<u32>,
    /// All that moves is to be looked for anew.
    all_loose: bool,
    /// Leaves that are marked as loose.
    loose: Vec<Leaf>,
    scratch: Vec<Item>,
}

/// Motion of a body in a step, metres.
#[derive(Clone, Copy, Debug, Default)]
struct Stride {
    /// Motion of its centre since pairs were last looked for, and of its points besides; without end if it was put
    /// somewhere. None at all unless `stamp` is the present one.
    shift: Vec3,
    turned: f32,
    stamp: u64,
    /// Motion in the coming step, at its present velocity.
    ahead: Vec3,
    spin: f32,
    /// Room by which its bounds are larger for that, metres.
    grown: f32,
}

impl Stride {
    /// Notes the motion in a step of `dt` seconds of a body that reaches so far from its centre, metres.
    fn set_ahead(&mut self, Velocity { linear, angular }: Velocity, arm: f32, dt: f32) {
        self.ahead = linear * dt;
        self.spin = angular.length() * arm * dt;
        self.grown = (linear.length() + angular.length() * arm) * dt;
    }
}

/// Relative motion of two bodies, metres: a bound for any two of their points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closing {
    /// By how much they may have come closer since pairs were last looked for.
    pub moved: f32,
    /// Largest gap within which points are looked for because of how fast they are, metres.
    pub ahead: f32,
}

/// Pose and motion of a body when its bounds were last worked out.
#[derive(Clone, Copy, Debug)]
struct Trace {
    /// The body's reach: its shapes never change.
    arm: f32,
    pose: Transform,
    velocity: Velocity,
    /// As in [`Stride`].
    shift: Vec3,
    turned: f32,
    /// Way that its centre may go until a ball around it, which holds all of it at rest, may leave its bounds in the tree, metres: of a
    /// kinematic body.
    free: f32,
}

/// Bounds that were not worked out.
const UNKNOWN: Aabb = Aabb { min: Vec3::NAN, max: Vec3::NAN };

impl Trace {
    /// Trace of a body that was put where it is.
    const NONE: Self = Self {
        arm: f32::NAN,
        pose: Transform { translation: Vec3::NAN, ..Transform::IDENTITY },
        velocity: Velocity { linear: Vec3::ZERO, angular: Vec3::ZERO },
        shift: Vec3::ZERO,
        turned: f32::INFINITY,
        free: f32::NEG_INFINITY,
    };
}

/// Share by which motion is taken as more than it is, and the same of the distance from the origin and of a body's size: what
/// rounding may do to a bound and to the gap that it is taken from.
const SLACK: f32 = 1e-3;
const BLUR: f32 = 2e-6;

/// Motion of a body's centre between two poses, and the most that any point within `arm` of it did besides, metres: by the chord of half the
/// turn, twice as long as that of a quarter.
fn way(from: &Transform, to: &Transform, arm: f32) -> (Vec3, f32) {
    let (p, q) = (from.rotation, to.rotation.toward(from.rotation));
    let turned = Vec3::new(q.x - p.x, q.y - p.y, q.z - p.z).length_squared() + (q.w - p.w) * (q.w - p.w);
    let far = to.translation.abs();
    let blur = BLUR * (far.x + far.y + far.z + arm);
    (to.translation - from.translation, 2.0 * arm * turned.sqrt() * (1.0 + SLACK) + blur)
}

/// A leaf of either tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Leaf(u32);

impl Leaf {
    const FIXED: u32 = 1 << 31;

    fn new(moves: bool, leaf: u32) -> Self {
        Self(if moves { leaf } else { leaf | Self::FIXED })
    }

    fn moves(self) -> bool {
        self.0 & Self::FIXED == 0
    }

    fn at(self) -> usize {
        (self.0 & !Self::FIXED) as usize
    }
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
    /// True for each leaf whose pairs are being looked for anew.
    is_loose: Vec<bool>,
    /// Numbers of leaves that are not used, by how many there are in a row.
    gaps: BTreeMap<u32, Vec<u32>>,
}

/// Leaves of a body: so many from `first` on, one for each shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Home {
    first: u32,
    count: u32,
    moves: bool,
    /// It is among those to be looked for anew.
    soiled: bool,
    /// When it last could touch something.
    lively: u64,
}

impl Home {
    fn leaf(&self, shape: u32) -> Leaf {
        Leaf::new(self.moves, self.first + shape)
    }
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
            self.is_loose.resize(end, false);
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

/// Bounds within which contacts of a shape are looked for, world: its own, grown by its motion and a margin.
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
        self.soil(index);
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
        for shape in 0..home.count {
            self.loosen(home.leaf(shape));
        }
    }

    /// A body has been put somewhere else.
    pub fn place(&mut self, index: u32, body: &Body) {
        let Some(home) = self.homes[index as usize] else { return };
        self.refresh(index, body);
        for shape in (0..home.count).filter(|&shape| is_bounded(body, shape)) {
            self.cover(home, shape, &self.needed(home, body, shape), Vec3::ZERO, BOUNDS_ROOM);
        }
        self.soil(index);
    }

    /// A body has other surfaces than before.
    pub fn refresh(&mut self, index: u32, body: &Body) {
        self.lone[index as usize] = lone(body);
        if let Some(home) = self.home(index).filter(|home| home.moves && home.count > 0) {
            self.traces[home.first as usize].free = f32::NEG_INFINITY;
        }
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
        self.all_loose = true;
        self.traces.fill(Trace::NONE);
    }

    /// Works out where the `movers` may be within a step of `dt` seconds, and lets the tree follow.
    pub fn follow(&mut self, bodies: &Arena<Body>, movers: impl Iterator<Item = u32>, dt: f32) {
        let same_step = self.begin(dt);
        for index in movers {
            let body = bodies.at(index);
            if let Some(home) = self.home(index).filter(|home| home.count > 0 && body.can_touch()) {
                self.foresee(index, home, body, same_step);
            }
        }
    }

    /// Works out where the `movers`, all that moves, may be within a step of `dt` seconds, and takes note of who can touch something in it and
    /// of how far all have moved. What was `changed`, comes to be able to touch, or no longer is, is to be looked for anew.
    pub fn take_stock(
        &mut self,
        bodies: &Arena<Body>,
        movers: impl Iterator<Item = u32>,
        changed: &[u32],
        dt: f32,
    ) {
        let same_step = self.begin(dt);
        self.stamp += 1;
        core::mem::swap(&mut self.lively, &mut self.lively_before);
        self.lively.clear();
        for index in movers {
            let body = bodies.at(index);
            let Some(home) = self.home(index).filter(|_| body.can_touch()) else { continue };
            if home.count > 0 && body.kind == BodyKind::Kinematic {
                self.foresee_led(index, home, body);
            } else if home.count > 0 {
                self.foresee(index, home, body, same_step);
                let (trace, stride) =
                    (&mut self.traces[home.first as usize], &mut self.strides[index as usize]);
                stride.shift = core::mem::take(&mut trace.shift);
                stride.turned = core::mem::take(&mut trace.turned);
                stride.stamp = self.stamp;
            }
            self.enliven(index);
        }
        for &index in changed {
            self.enliven(index);
            self.soil(index);
        }
        for at in 0..self.lively_before.len() {
            let index = self.lively_before[at];
            if self.home(index).is_some_and(|home| home.lively != self.stamp) {
                self.soil(index);
            }
        }
        if self.soiled.len() > self.lively.len() {
            // Cheaper from the other side.
            self.all_loose = true;
        }
        self.forget_strides(bodies);
    }

    /// Trees in good order for a step of `dt` seconds; true if the last was as long.
    fn begin(&mut self, dt: f32) -> bool {
        self.mend(false);
        self.mend(true);
        core::mem::replace(&mut self.dt, dt) == dt
    }

    /// Works out where a body that forces move may be within the step, and lets the tree follow.
    fn foresee(&mut self, index: u32, home: Home, body: &Body, same_step: bool) {
        let trace = &mut self.traces[home.first as usize];
        if same_step && trace.pose == body.world_from_principal && trace.velocity == body.velocity {
            return;
        }
        // Where it was is not known of what was put somewhere.
        let arm = if trace.arm >= 0.0 { trace.arm } else { body.reach() };
        let (shift, turned) = way(&trace.pose, &body.world_from_principal, arm);
        let (shift, turned) = (trace.shift + shift, trace.turned + turned);
        let is_known = shift.is_finite() && turned >= 0.0;
        let (shift, turned) = if is_known { (shift, turned) } else { (Vec3::ZERO, f32::INFINITY) };
        let Body { world_from_principal: pose, velocity, .. } = *body;
        *trace = Trace { arm, pose, velocity, shift, turned, free: f32::NEG_INFINITY };
        self.strides[index as usize].set_ahead(velocity, arm, self.dt);
        self.reach_out(index, home, body, BOUNDS_STEPS, BOUNDS_ROOM);
    }

    /// The same of a kinematic body, of which there may be many that meet nobody: as long as the tree has bounds for a small one that hold a
    /// ball around it, nothing else is worked out, and how far it moved counts as not known.
    fn foresee_led(&mut self, index: u32, home: Home, body: &Body) {
        let (trace, stride) = (&mut self.traces[home.first as usize], &mut self.strides[index as usize]);
        let arm = if trace.arm >= 0.0 { trace.arm } else { body.reach() };
        stride.set_ahead(body.velocity, arm, self.dt);
        (stride.turned, stride.stamp) = (f32::INFINITY, self.stamp);
        let grown = stride.grown;
        if home.count > 1 || arm > 2.0 * BOUNDS_ROOM_LED {
            *trace = Trace { arm, ..Trace::NONE };
            return self.reach_out(index, home, body, BOUNDS_STEPS, BOUNDS_ROOM);
        }
        let mut free = trace.free;
        if free < grown {
            // Should it come to be dynamic, nothing is known of how it moved.
            *trace = Trace { arm, ..Trace::NONE };
            free = self.free(home.first, body, arm);
        }
        if free >= grown {
            self.reach[home.first as usize] = UNKNOWN;
        } else {
            let room = BOUNDS_ROOM_LED + min(arm, BOUNDS_ROOM_LED);
            self.reach_out(index, home, body, BOUNDS_STEPS_LED, room);
            free = self.free(home.first, body, arm);
        }
        // It goes as its velocity says; what may be rounded there is less than its turning, which is taken off besides.
        let far = body.center().abs();
        let gone = grown * (1.0 + SLACK) + BLUR * (far.x + far.y + far.z + arm);
        self.traces[home.first as usize].free = free - gone;
    }

    /// Way that the centre of a body may go until a ball around it leaves its bounds in the tree, metres; negative if it does.
    fn free(&self, leaf: u32, body: &Body, arm: f32) -> f32 {
        let ball = thick(&Aabb::around(body.center(), Vec3::splat(arm + MARGIN)));
        let own = self.moving.tree.bounds(leaf);
        let spare = min3(ball.min - own.min, own.max - ball.max);
        min(spare.x, min(spare.y, spare.z))
    }

    /// Works out the bounds of a body within the step. Where the tree must change it gets `room` (m) around and `steps` of motion ahead.
    fn reach_out(&mut self, index: u32, home: Home, body: &Body, steps: f32, room: f32) {
        let Stride { grown: motion, ahead, .. } = self.strides[index as usize];
        for shape in 0..home.count {
            let is_alone = body.surface(shape as usize).filter.meets_none();
            let way = ahead * if is_alone { BOUNDS_STEPS_ALONE } else { steps };
            let reach = grown(body, shape, motion);
            self.reach[(home.first + shape) as usize] = reach;
            if self.cover(home, shape, &thick(&reach), way, room) {
                self.stray.push(home.first + shape);
            }
        }
    }

    #[inline]
    fn enliven(&mut self, index: u32) {
        let Some(home) = &mut self.homes[index as usize] else { return };
        let before = core::mem::replace(&mut home.lively, self.stamp);
        if before == self.stamp {
            return;
        }
        self.lively.push(index);
        if before + 1 != self.stamp {
            self.soil(index);
        }
    }

    /// Forgets the motion of what is to be looked for anew.
    fn forget_strides(&mut self, bodies: &Arena<Body>) {
        for at in 0..self.soiled.len() {
            let index = self.soiled[at];
            let (Some(home), Some(body)) = (self.home(index), bodies.try_at(index)) else { continue };
            let stride = &mut self.strides[index as usize];
            (stride.shift, stride.turned, stride.stamp) = (Vec3::ZERO, f32::INFINITY, self.stamp);
            if !home.moves {
                // What is static may have been given one, which counts when points are looked for.
                stride.ahead = body.velocity.linear * self.dt;
            } else if home.count > 0 && !body.can_touch() {
                // It rests, and nobody will work out its bounds.
                (stride.ahead, stride.spin, stride.grown) = (Vec3::ZERO, 0.0, 0.0);
                self.traces[home.first as usize] = Trace::NONE;
                for shape in 0..home.count {
                    self.reach[(home.first + shape) as usize] = grown(body, shape, 0.0);
                }
            }
        }
    }

    /// Relative motion of two bodies, metres.
    pub fn closing(&self, key: ContactKey) -> Closing {
        let [(p, p_turned), (q, q_turned)] = [key.a, key.b].map(|body| {
            let stride = &self.strides[body as usize];
            if stride.stamp == self.stamp { (stride.shift, stride.turned) } else { (Vec3::ZERO, 0.0) }
        });
        let moved = (p - q).length() * (1.0 + SLACK) + (p_turned + q_turned);
        Closing { moved, ahead: self.ahead(key) }
    }

    /// Largest gap within which points of two bodies are looked for because of how fast they are, metres: as far as they come
    /// closer, or one of them comes, whichever is more, and what both turn.
    pub fn ahead(&self, key: ContactKey) -> f32 {
        let [p, q] = [key.a, key.b].map(|body| &self.strides[body as usize]);
        let (p2, q2) = (p.ahead.length_squared(), q.ahead.length_squared());
        let fastest = max((p.ahead - q.ahead).length_squared(), max(p2, q2));
        (fastest.sqrt() + (p.spin + q.spin)) * (1.0 + SLACK)
    }

    /// True if there is anything to be looked for anew.
    pub fn has_loose(&self) -> bool {
        self.all_loose || !(self.soiled.is_empty() && self.stray.is_empty() && self.loose.is_empty())
    }

    /// True if that is no more than shapes that left their bounds.
    pub fn only_strayed(&self) -> bool {
        !self.all_loose && self.soiled.is_empty() && self.loose.len() == self.stray.len()
    }

    /// True if the pairs of a shape are being looked for anew.
    pub fn is_loose(&self, leaf: Leaf) -> bool {
        self.all_loose || self.layer(leaf.moves()).is_loose[leaf.at()]
    }

    /// Everything has been looked for.
    pub fn fasten(&mut self) {
        self.all_loose = false;
        for index in self.soiled.drain(..) {
            if let Some(home) = &mut self.homes[index as usize] {
                home.soiled = false;
            }
        }
        self.stray.clear();
        for leaf in self.loose.drain(..) {
            let layer = if leaf.moves() { &mut self.moving } else { &mut self.fixed };
            layer.is_loose[leaf.at()] = false;
        }
    }

    /// Pairs of a loose shape and another whose bounds in the trees overlap its own, of which one can touch something and whose kinds let them
    /// meet (another kind has a body looked for anew): each at least once, in no order. [`take_stock`](Self::take_stock) comes before.
    pub fn search(&mut self, bodies: &Arena<Body>, mut visit: impl FnMut((Owner, Leaf), (Owner, Leaf))) {
        if self.all_loose {
            for &index in &self.lively {
                let Some(home) = self.home(index) else { continue };
                for shape in 0..home.count {
                    self.neighbors(bodies, Owner { body: index, shape }, home.leaf(shape), &mut visit);
                }
            }
            return;
        }
        for at in 0..self.soiled.len() {
            let Some(home) = self.home(self.soiled[at]) else { continue };
            for shape in 0..home.count {
                self.loosen(home.leaf(shape));
            }
        }
        self.stray.retain(|&leaf| !self.moving.is_loose[leaf as usize]);
        for at in 0..self.stray.len() {
            self.loosen(Leaf::new(true, self.stray[at]));
        }
        for &leaf in &self.loose {
            let owner = self.layer(leaf.moves()).owners[leaf.at()];
            let is_there = self.home(owner.body).is_some_and(|home| home.leaf(owner.shape) == leaf);
            if is_there && bodies.try_at(owner.body).is_some() {
                self.neighbors(bodies, owner, leaf, &mut visit);
            }
        }
    }

    /// True if the neighbours of a shape that moves are asked for.
    fn is_asking(&self, owner: Owner, leaf: Leaf) -> bool {
        if self.all_loose {
            self.home(owner.body).is_some_and(|home| home.lively == self.stamp)
        } else {
            self.moving.is_loose[leaf.at()]
        }
    }

    /// Visits the pairs of a shape with the shapes whose bounds meet its own.
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
            // Two that move and are both looked for find each other.
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
        // The bounds of what is fixed lack its margin.
        let _ = self.fixed.tree.overlapping(&bounds.expand(1.01 * MARGIN), |leaf| {
            meet(self.fixed.owners[leaf as usize], Leaf::new(false, leaf))
        });
        for &other in &self.unbounded {
            if let Some(home) = self.home(other.body) {
                let _ = meet(other, home.leaf(other.shape));
            }
        }
    }

    /// Bounds that hold a shape and all that may touch it, as long as its tree does not change.
    fn wide_bounds(&self, body: &Body, owner: Owner, leaf: Leaf) -> Aabb {
        match (leaf.moves(), is_bounded(body, owner.shape)) {
            (true, _) => self.moving.tree.bounds(leaf.at() as u32),
            (false, true) => self.fixed.tree.bounds(leaf.at() as u32).expand(1.01 * MARGIN),
            (false, false) => Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY },
        }
    }

    /// True if the bounds of two shapes in their trees do not overlap. Both are there.
    pub fn are_parted(&self, leaves: [Leaf; 2]) -> bool {
        let bounds = |leaf: Leaf| {
            let tree = &self.layer(leaf.moves()).tree;
            let margin = if leaf.moves() { 0.0 } else { 1.01 * MARGIN };
            tree.contains(leaf.at() as u32).then(|| tree.bounds(leaf.at() as u32).expand(margin))
        };
        let [p, q] = leaves.map(bounds);
        p.is_some_and(|p| q.is_some_and(|q| !overlap(&p, &q)))
    }

    /// True if two shapes are near each other: their bounds, grown by the motion of the coming step and a margin, overlap. That
    /// does not depend on what the trees hold.
    pub fn are_near(&self, bodies: &Arena<Body>, key: ContactKey, leaves: [Leaf; 2]) -> bool {
        let [(p, _), (q, _)] = self.grown_bounds(bodies, key, leaves);
        overlap(&p, &q)
    }

    /// Gap of the bounds of two shapes, metres: they are at least so far apart.
    pub fn gap(&self, bodies: &Arena<Body>, key: ContactKey, leaves: [Leaf; 2]) -> f32 {
        let [(p, grown_p), (q, grown_q)] = self.grown_bounds(bodies, key, leaves);
        let beyond = max3(p.min - q.max, q.min - p.max);
        let apart = max3(beyond + Vec3::splat(2.0 * MARGIN + (grown_p + grown_q)), Vec3::ZERO);
        let far = max3(max3(-p.min, p.max), max3(-q.min, q.max));
        apart.length() - PAD * max(far.x, max(far.y, far.z))
    }

    /// Bounds of the shapes of a pair, grown by a margin and by motion, which is told besides.
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
        let layers = [&self.fixed, &self.moving].into_iter().filter(|layer| !layer.tree.is_empty());
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
        let first = self.layer_mut(moves).claim(index, count);
        let home = Home { first, count, moves, soiled: false, lively: 0 };
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
            self.reach.resize(count, Aabb::default());
            self.traces.resize(count, Trace::NONE);
            self.traces[first as usize..(first + home.count) as usize].fill(Trace::NONE);
            self.moving.tree.reserve(count);
            self.scratch.reserve(count);
            // All may leave their room at once.
            self.stray.reserve(count);
            self.loose.reserve(count);
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

    /// True if a body's leaves are those that it would be given now, and hold it.
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

    /// Sees to it that the bounds of a shape in its tree hold these, with room to spare if they have to be changed: most of it
    /// along the `way` that it is expected to go, metres. Tells whether they had to be.
    fn cover(&mut self, home: Home, shape: u32, needed: &Aabb, way: Vec3, room: f32) -> bool {
        let leaf = home.first + shape;
        let tree = &mut self.layer_mut(home.moves).tree;
        let own = tree.bounds(leaf);
        let room = if home.moves { room } else { 0.0 };
        // What comes to rest needs less room than what fell.
        let fits =
            own.contains(needed) && needed.expand(BOUNDS_EXCESS * (room + way.length())).contains(&own);
        if !fits {
            let Aabb { min, max } = needed.expand(room);
            let roomy = Aabb { min: min + min3(way, Vec3::ZERO), max: max + max3(way, Vec3::ZERO) };
            tree.update(leaf, &roomy);
        }
        !fits
    }

    /// Has all shapes of a body looked for anew; how far it moved is not known.
    fn soil(&mut self, index: u32) {
        let Some(home) = &mut self.homes[index as usize] else { return };
        if core::mem::replace(&mut home.soiled, true) {
            return;
        }
        if !home.moves && home.count as usize > FEW {
            // Cheaper from the other side.
            self.all_loose = true;
        }
        self.soiled.push(index);
    }

    fn loosen(&mut self, leaf: Leaf) {
        let layer = if leaf.moves() { &mut self.moving } else { &mut self.fixed };
        if !core::mem::replace(&mut layer.is_loose[leaf.at()], true) {
            self.loose.push(leaf);
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
