//! Motion of bodies in past and coming steps: bounds of their shapes during it, and the margins that save tree updates.

use super::{Home, Proxies, grown, thick};
use crate::arena::Arena;
use crate::body::def::BodyKind;
use crate::body::{Body, Velocity};
use crate::boxes::Aabb;
use crate::contact::ContactKey;
use crate::contact::tuning::{
    BOUNDS_ROOM, BOUNDS_ROOM_LED, BOUNDS_STEPS, BOUNDS_STEPS_ALONE, BOUNDS_STEPS_LED, MARGIN,
};
use sinew_math::{Transform, Vec3, max, min, min3};

/// Motion of a body in a step, metres.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stride {
    /// Motion of the body's centre since the last pair search, and additional motion of its other points (`turned`);
    /// infinite after a teleport. Counts as zero unless `stamp` is current.
    shift: Vec3,
    turned: f32,
    stamp: u64,
    /// Motion of the centre in the coming step at the current velocity.
    ahead: Vec3,
    spin: f32,
    /// Largest additional motion in the coming step due to an impulse, in any direction.
    blow: f32,
    /// Margin of the body's bounds for its motion in the coming step, metres.
    pub grown: f32,
}

impl Stride {
    /// Sets the motion in a step of `dt` seconds of a body whose points are within `arm` (m) of its centre.
    fn set_ahead(&mut self, Velocity { linear, angular }: Velocity, arm: f32, dt: f32) {
        self.ahead = linear * dt;
        self.spin = angular.length() * arm * dt;
        self.blow = 0.0;
        self.grown = (linear.length() + angular.length() * arm) * dt;
    }
}

/// Relative motion of two bodies, metres: a bound for any two of their points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closing {
    /// Largest approach since the last pair search.
    pub moved: f32,
    /// Distance up to which contact points are searched because of speed, metres.
    pub ahead: f32,
}

/// Distance up to which contact points of two bodies are searched because of speed, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ahead {
    /// Upper limit of the distance.
    pub most: f32,
    /// Part of the distance for impulses that joints will transmit.
    pub blow: f32,
}

/// Pose and motion of a body at its last bounds update.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trace {
    /// Reach of the body, metres; its shapes never change.
    arm: f32,
    pose: Transform,
    velocity: Velocity,
    /// Motion as in [`Stride`].
    shift: Vec3,
    turned: f32,
    /// Distance that a kinematic body's centre may move, metres, until a ball around it may leave the body's bounds in
    /// the tree. The ball contains the body in any orientation.
    pub free: f32,
}

/// Bounds that were not computed.
pub(super) const UNKNOWN: Aabb = Aabb { min: Vec3::NAN, max: Vec3::NAN };

impl Trace {
    /// Trace of a teleported body.
    pub const NONE: Self = Self {
        arm: f32::NAN,
        pose: Transform { translation: Vec3::NAN, ..Transform::IDENTITY },
        velocity: Velocity { linear: Vec3::ZERO, angular: Vec3::ZERO },
        shift: Vec3::ZERO,
        turned: f32::INFINITY,
        free: f32::NEG_INFINITY,
    };
}

/// Safety factors on motion, and on the distance from the origin and the body's size. They cover the rounding error of
/// bounds and of gaps computed from bounds.
const SLACK: f32 = 1e-3;
const BLUR: f32 = 2e-6;

/// Motion of a body's centre between two poses, and the largest additional motion of any point within `arm` of it,
/// metres. The second is twice the chord of half the rotation.
fn way(from: &Transform, to: &Transform, arm: f32) -> (Vec3, f32) {
    let (p, q) = (from.rotation, to.rotation.toward(from.rotation));
    let turned = Vec3::new(q.x - p.x, q.y - p.y, q.z - p.z).length_squared() + (q.w - p.w) * (q.w - p.w);
    let far = to.translation.abs();
    let blur = BLUR * (far.x + far.y + far.z + arm);
    (to.translation - from.translation, 2.0 * arm * turned.sqrt() * (1.0 + SLACK) + blur)
}

impl Proxies {
    /// Computes the bounds of `movers` during a step of `dt` seconds, and updates the tree.
    pub fn follow(&mut self, bodies: &Arena<Body>, movers: impl Iterator<Item = u32>, dt: f32) {
        let same_step = self.begin(dt);
        for index in movers {
            let body = bodies.at(index);
            if let Some(home) = self.home(index).filter(|home| home.count > 0 && body.can_touch()) {
                self.predict(index, home, body, same_step);
            }
        }
    }

    /// Computes the bounds of `movers` (all movable bodies) during a step of `dt` seconds, and records which bodies can
    /// touch something and how far each has moved. Bodies that were `changed`, or that gain or lose the ability to
    /// touch, become pending.
    pub fn update_motion(
        &mut self,
        bodies: &Arena<Body>,
        movers: impl Iterator<Item = u32>,
        changed: &[u32],
        dt: f32,
    ) {
        let same_step = self.begin(dt);
        self.stamp += 1;
        core::mem::swap(&mut self.active, &mut self.active_before);
        self.active.clear();
        for index in movers {
            let body = bodies.at(index);
            if !body.can_touch() {
                continue;
            }
            let Some(home) = self.mark_active(index) else { continue };
            if home.count > 0 && body.kind == BodyKind::Kinematic {
                self.predict_kinematic(index, home, body);
            } else if home.count > 0 {
                self.predict(index, home, body, same_step);
                let (trace, stride) =
                    (&mut self.traces[home.first as usize], &mut self.strides[index as usize]);
                stride.shift = core::mem::take(&mut trace.shift);
                stride.turned = core::mem::take(&mut trace.turned);
                stride.stamp = self.stamp;
            }
        }
        for &index in changed {
            self.mark_active(index);
            self.mark_dirty(index);
        }
        for at in 0..self.active_before.len() {
            let index = self.active_before[at];
            if self.home(index).is_some_and(|home| home.active != self.stamp) {
                self.mark_dirty(index);
            }
        }
        if self.dirty.len() > self.active.len() {
            // With many pending shapes it is cheaper to search from the movable bodies.
            self.all_pending = true;
        }
        self.forget_motion(bodies);
    }

    /// Rebuilds degraded trees and sets the length of the step, seconds; true if the last step was as long.
    fn begin(&mut self, dt: f32) -> bool {
        self.mend(false);
        self.mend(true);
        core::mem::replace(&mut self.dt, dt) == dt
    }

    /// Computes the bounds of a dynamic body during the step, and updates the tree.
    fn predict(&mut self, index: u32, home: Home, body: &Body, same_step: bool) {
        let trace = &mut self.traces[home.first as usize];
        if same_step && trace.pose == body.world_from_principal && trace.velocity == body.velocity {
            return;
        }
        // The motion of a teleported body is unknown: its trace has no pose.
        let arm = if trace.arm >= 0.0 { trace.arm } else { body.reach() };
        let (shift, turned) = way(&trace.pose, &body.world_from_principal, arm);
        let (shift, turned) = (trace.shift + shift, trace.turned + turned);
        let is_known = shift.is_finite() && turned >= 0.0;
        let (shift, turned) = if is_known { (shift, turned) } else { (Vec3::ZERO, f32::INFINITY) };
        let Body { world_from_principal: pose, velocity, .. } = *body;
        *trace = Trace { arm, pose, velocity, shift, turned, free: f32::NEG_INFINITY };
        self.strides[index as usize].set_ahead(velocity, arm, self.dt);
        self.predict_bounds(index, home, body, BOUNDS_STEPS, BOUNDS_ROOM);
    }

    /// Like [`predict`](Self::predict), for a kinematic body. There may be many without contacts. As long as the bounds
    /// of a small one in the tree contain a ball around it, nothing else is computed, and its motion counts as unknown.
    fn predict_kinematic(&mut self, index: u32, home: Home, body: &Body) {
        let (trace, stride) = (&mut self.traces[home.first as usize], &mut self.strides[index as usize]);
        let arm = if trace.arm >= 0.0 { trace.arm } else { body.reach() };
        stride.set_ahead(body.velocity, arm, self.dt);
        (stride.turned, stride.stamp) = (f32::INFINITY, self.stamp);
        let grown = stride.grown;
        if home.count > 1 || arm > 2.0 * BOUNDS_ROOM_LED {
            *trace = Trace { arm, ..Trace::NONE };
            return self.predict_bounds(index, home, body, BOUNDS_STEPS, BOUNDS_ROOM);
        }
        let mut free = trace.free;
        if free < grown {
            // The motion is unknown if the body becomes dynamic.
            *trace = Trace { arm, ..Trace::NONE };
            free = self.free(home.first, body, arm);
        }
        if free >= grown {
            self.reach[home.first as usize] = UNKNOWN;
        } else {
            let room = BOUNDS_ROOM_LED + min(arm, BOUNDS_ROOM_LED);
            self.predict_bounds(index, home, body, BOUNDS_STEPS_LED, room);
            free = self.free(home.first, body, arm);
        }
        // The body moves according to its velocity; the rounding error is less than its rotation, which `gone`
        // includes.
        let far = body.center().abs();
        let gone = grown * (1.0 + SLACK) + BLUR * (far.x + far.y + far.z + arm);
        self.traces[home.first as usize].free = free - gone;
    }

    /// Distance that the centre of a body may move until a ball around it leaves the body's bounds in the tree, metres;
    /// negative if the ball has already left them.
    fn free(&self, leaf: u32, body: &Body, arm: f32) -> f32 {
        let ball = thick(&Aabb::around(body.center(), Vec3::splat(arm + MARGIN)));
        let own = self.moving.tree.bounds(leaf);
        let spare = min3(ball.min - own.min, own.max - ball.max);
        min(spare.x, min(spare.y, spare.z))
    }

    /// Extends the contact search of a body in this step for an additional `speed` (m/s) in any direction.
    pub fn widen(&mut self, index: u32, body: &Body, speed: f32) {
        let Some(home) = self.home(index).filter(|home| home.count > 0 && body.can_touch()) else { return };
        let (stride, way) = (&mut self.strides[index as usize], speed * self.dt);
        stride.blow = way;
        stride.grown += way;
        // This makes the next step recompute the motion from the velocity at that time.
        self.traces[home.first as usize].velocity.linear = Vec3::NAN;
        self.predict_bounds(index, home, body, BOUNDS_STEPS, BOUNDS_ROOM);
    }

    /// Computes the bounds of a body during the step. If the tree must change, adds a margin of `room` (m) and `steps`
    /// steps of motion.
    fn predict_bounds(&mut self, index: u32, home: Home, body: &Body, steps: f32, room: f32) {
        let Stride { grown: motion, ahead, .. } = self.strides[index as usize];
        for shape in 0..home.count {
            let is_alone = body.surface(shape as usize).filter.meets_none();
            let way = ahead * if is_alone { BOUNDS_STEPS_ALONE } else { steps };
            let reach = grown(body, shape, motion);
            self.reach[(home.first + shape) as usize] = reach;
            if self.cover(home, shape, &thick(&reach), way, room) {
                self.enlarged.push(home.first + shape);
            }
        }
    }

    /// Records that a body can touch something in this step; returns its leaves, if any.
    #[inline(always)]
    fn mark_active(&mut self, index: u32) -> Option<Home> {
        let home = self.homes.get_mut(index as usize)?.as_mut()?;
        let before = core::mem::replace(&mut home.active, self.stamp);
        let home = *home;
        if before != self.stamp {
            self.active.push(index);
            if before + 1 != self.stamp {
                self.mark_dirty(index);
            }
        }
        Some(home)
    }

    /// Marks the motion of pending bodies as unknown.
    fn forget_motion(&mut self, bodies: &Arena<Body>) {
        for at in 0..self.dirty.len() {
            let index = self.dirty[at];
            let (Some(home), Some(body)) = (self.home(index), bodies.try_at(index)) else { continue };
            let stride = &mut self.strides[index as usize];
            (stride.shift, stride.turned, stride.stamp) = (Vec3::ZERO, f32::INFINITY, self.stamp);
            if !home.moves {
                // A static body may have a velocity, which counts in the contact search.
                stride.ahead = body.velocity.linear * self.dt;
            } else if home.count > 0 && !body.can_touch() {
                // The body rests, and its bounds will not be computed.
                (stride.ahead, stride.spin, stride.blow, stride.grown) = (Vec3::ZERO, 0.0, 0.0, 0.0);
                self.traces[home.first as usize] = Trace::NONE;
                for shape in 0..home.count {
                    self.reach[(home.first + shape) as usize] = grown(body, shape, 0.0);
                }
            } else if home.count > 0 && body.kind == BodyKind::Dynamic && !body.is_active() {
                // A body that the user put to sleep is searched although it does not move: its traced pose is outdated.
                self.traces[home.first as usize] = Trace::NONE;
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
        Closing { moved, ahead: self.ahead(key).most }
    }

    /// Distance up to which contact points of two bodies are searched because of speed: the largest of their relative
    /// and individual motions, plus their rotations and possible impulses.
    pub fn ahead(&self, key: ContactKey) -> Ahead {
        let [p, q] = [key.a, key.b].map(|body| &self.strides[body as usize]);
        let (p2, q2) = (p.ahead.length_squared(), q.ahead.length_squared());
        let fastest = max((p.ahead - q.ahead).length_squared(), max(p2, q2));
        let blow = p.blow + q.blow;
        Ahead { most: (fastest.sqrt() + (p.spin + q.spin)) * (1.0 + SLACK) + blow, blow }
    }
}
