//! The move of one mover in a step.

use super::crowd::Crowd;
use super::obstacle::{Obstacle, Owner, Surroundings, gather};
use super::planes::Planes;
use super::press::{Press, meet, weigh};
use super::sweep::{Course, Manner, Touch};
use super::{Bearer, Footing, Mover, Movers, surface_velocity};
use crate::arena::Arena;
use crate::body::Body;
use crate::body::def::BodyKind;
use crate::mover::tuning::{BEHIND_EDGE, GRIP, LOOK_AHEAD, OVER_EDGE, STOPPED_SHARE, WEDGED_SHARE};
use crate::ray::Ray;
use crate::world::World;
use sinew_math::{Vec3, clamp, max, min, normalize_or, trig};

/// Data of one move: the world, the other movers, the obstacles and the sliding parameters.
struct Move<'a> {
    world: &'a World,
    movers: &'a Arena<Mover>,
    sight: Surroundings<'a>,
    manner: Manner,
    dt: f32,
}

/// Moves one mover by one step.
pub(super) fn advance(world: &World, movers: &mut Movers, index: u32, dt: f32) {
    let Movers { all, crowd, obstacles, presses } = movers;
    let mut mover = all.at(index).clone();
    mover.previous = mover.position;
    let slips = mover.refresh_ground(&world.bodies, dt);
    let carried = mover.carried(&world.bodies, slips, dt);
    mover.accelerate(dt);
    let gravity = world.def.gravity * mover.def.gravity_scale;
    look_around(world, (all, crowd), index, (&mover, carried, gravity, dt), obstacles);
    {
        let steps = Move::new(world, all, obstacles, &mover, dt);
        steps.run(&mut mover, carried, gravity, presses);
    }
    crowd.note(all.at(index).center(), mover.center());
    *all.at_mut(index) = mover;
}

/// Collects the possible obstacles of this step.
fn look_around(
    world: &World,
    (movers, crowd): (&Arena<Mover>, &Crowd),
    index: u32,
    (mover, carried, gravity, dt): (&Mover, Vec3, Vec3, f32),
    obstacles: &mut Vec<Obstacle>,
) {
    let def = &mover.def;
    let (center, way) = (mover.center(), mover.velocity() * dt + carried);
    let jump = (mover.jump + gravity.length() * dt) * dt;
    let margin =
        LOOK_AHEAD + jump + 2.0 * def.step_height + 0.5 * def.radius + 4.0 * def.skin + 0.3 * way.length();
    let bounds = Surroundings::new(&world.bodies, &[], mover).bounds(center, way, margin);
    gather(world, (movers, crowd.near(&bounds)), index, &bounds, obstacles);
}

impl Mover {
    /// Makes the mover leave its ground, with the ground's velocity.
    pub(super) fn leave_ground(&mut self) {
        if let Some(footing) = self.ground.take() {
            self.velocity += footing.velocity;
        }
    }

    /// Updates the ground, which may have been removed or have changed its velocity. A dynamic body carries the mover
    /// by friction. Returns true if the body accelerates more than friction allows, so that the mover slips.
    fn refresh_ground(&mut self, bodies: &Arena<Body>, dt: f32) -> bool {
        let Some(footing) = &mut self.ground else { return false };
        let Bearer::Shape { body, shape } = footing.on else { return false };
        let Some(body) = bodies.get(body) else {
            self.leave_ground();
            return false;
        };
        let change = surface_velocity(body, shape, footing.point) - footing.velocity;
        let (length, most) = (change.length(), GRIP * dt);
        let slips = body.kind == BodyKind::Dynamic && length > most;
        footing.velocity += if slips { change * (most / length) } else { change };
        slips
    }

    /// Returns the displacement by the ground in this step, metres, and turns the yaw with the ground unless the mover
    /// slips.
    fn carried(&mut self, bodies: &Arena<Body>, slips: bool, dt: f32) -> Vec3 {
        let Some(Footing { on: Bearer::Shape { body, shape }, velocity, .. }) = self.ground else {
            return Vec3::ZERO;
        };
        if slips {
            return velocity * dt;
        }
        let body = bodies.at(body.index);
        let runs = body.surface_velocity(shape as usize, self.position);
        self.yaw += (body.velocity.angular + runs.angular).dot(self.def.up) * dt;
        let moved = if body.previous == body.world_from_principal || !body.is_awake() {
            Vec3::ZERO
        } else {
            let on_body = body.previous.inverse_point(self.position);
            body.world_from_principal.point(on_body) - self.position
        };
        moved + runs.linear * dt
    }

    /// Accelerates the mover toward the wanted velocity, and starts a requested jump.
    fn accelerate(&mut self, dt: f32) {
        let up = self.def.up;
        if self.jump > 0.0 && self.ground.is_some() {
            self.leave_ground();
            self.velocity += up * self.jump;
        }
        self.jump = 0.0;
        let across = |v: Vec3| v - up * v.dot(up);
        let wanted = across(self.walk);
        let most = match self.ground {
            Some(_) => self.def.ground_acceleration * dt,
            None if wanted == Vec3::ZERO => 0.0,
            None => self.def.air_acceleration * dt,
        };
        let change = wanted - across(self.velocity);
        let length = change.length();
        self.velocity += if length > most { change * (most / length) } else { change };
    }
}

impl<'a> Move<'a> {
    fn new(
        world: &'a World,
        movers: &'a Arena<Mover>,
        obstacles: &'a [Obstacle],
        mover: &Mover,
        dt: f32,
    ) -> Self {
        let sight = Surroundings::new(&world.bodies, obstacles, mover);
        let flattest = trig::cos(mover.def.slope_limit);
        let manner = Manner { skin: mover.def.skin, flattest, course: Course::Free };
        Self { world, movers, sight, manner, dt }
    }

    /// Runs the whole move: carry, depenetration, hits, motion, ground snap.
    fn run(mut self, mover: &mut Mover, carried: Vec3, gravity: Vec3, presses: &mut Vec<Press>) {
        let mut center = mover.center();
        let stood = mover.ground.map(|footing| footing.on);
        if carried != Vec3::ZERO {
            self.sight.without = match stood {
                Some(Bearer::Shape { body, .. }) => Some(body.index),
                _ => None,
            };
            center = self.sight.slide(center, carried, &self.manner);
            self.sight.without = None;
        }
        let met = center;
        center = self.sight.recover(center, &self.manner);
        let pushed = center - met;
        let up = mover.def.up;
        let change = meet(&self.sight, mover, center, self.dt, presses);
        if change != Vec3::ZERO {
            let change = if stood.is_some() { change - up * change.dot(up) } else { change };
            mover.velocity += change;
        }
        center = match mover.ground {
            Some(_) => self.walk(mover, center),
            // In the step in which the mover jumps, its ground has already carried it.
            None => self.fly(mover, center, (gravity, carried, pushed)),
        };
        mover.put(center);
        let is_new = mover.ground.map(|footing| footing.on) != stood;
        weigh((self.sight.bodies, self.world.def.gravity), mover, is_new, presses);
    }

    fn level(&self) -> Manner {
        Manner { course: Course::Level, ..self.manner }
    }

    /// Walks along the ground, up steps, and down to the ground; returns the new centre.
    fn walk(&self, mover: &mut Mover, start: Vec3) -> Vec3 {
        let up = mover.def.up;
        let wanted = mover.velocity * self.dt;
        let mut center = self.sight.slide(start, wanted, &self.level());
        let across = |v: Vec3| v - up * v.dot(up);
        let missing = wanted - across(center - start);
        if missing.dot(wanted) > STOPPED_SHARE * wanted.length_squared() {
            center = self.step_up(mover, start, center, missing).unwrap_or(center);
        }
        let (found, footing) = self.snap(mover, center);
        let gone = across(found - start);
        let longest = mover.velocity.length() * self.dt;
        if across(wanted - gone).length() > 1e-6 {
            let length = gone.length();
            let kept = if length > longest { gone * (longest / length) } else { gone };
            mover.velocity = kept / self.dt;
        }
        match footing {
            Some(footing) => mover.ground = Some(self.taken_along(mover, footing)),
            None => mover.leave_ground(),
        }
        found
    }

    /// Returns the footing with the velocity that the mover takes over: on a dynamic body that of the previous footing,
    /// otherwise that of the new one.
    fn taken_along(&self, mover: &Mover, footing: Footing) -> Footing {
        let (Some(before), Bearer::Shape { body, .. }) = (mover.ground, footing.on) else { return footing };
        let is_dynamic = self.sight.bodies.at(body.index).kind == BodyKind::Dynamic;
        let velocity = if is_dynamic { before.velocity } else { footing.velocity };
        Footing { velocity, ..footing }
    }

    /// Moves the mover up, forward and down onto a tread at most one step height above the feet; returns the new
    /// centre.
    fn step_up(&self, mover: &Mover, start: Vec3, blocked: Vec3, missing: Vec3) -> Option<Vec3> {
        let (up, step) = (mover.def.up, mover.def.step_height);
        let length = missing.length();
        if step <= 0.0 {
            return None;
        }
        let (share, _) = self.sight.sweep(blocked, up * step, &self.manner);
        let raised = blocked + up * (step * share);
        let feet = start - up * (0.5 * mover.def.height);
        // A smaller step would not bring the mover over the edge from its skin distance. If the mover would land on a
        // low flank that is too steep, the tread may be behind the flank.
        let radius = mover.def.radius;
        for length in [max(length, 2.0 * mover.def.skin), 0.25 * radius, 0.5 * radius] {
            let way = missing * (length / missing.length());
            let there = self.sight.slide(raised, way, &self.level());
            if (there - raised).dot(way) < 0.25 * length * length {
                return None;
            }
            let depth = (there - blocked).dot(up) + mover.def.skin;
            let (share, hit) = self.sight.sweep(there, -up * depth, &self.manner);
            let landed = there - up * (depth * share);
            let touch = hit?;
            if (touch.point - feet).dot(up) > step + mover.def.skin {
                return None;
            }
            if self.bears(&touch, mover, landed) {
                return Some(landed);
            }
        }
        None
    }

    /// Moves the mover down to the ground, at most one step height; returns the new centre and the footing.
    fn snap(&self, mover: &Mover, center: Vec3) -> (Vec3, Option<Footing>) {
        let up = mover.def.up;
        if let Some(footing) = self.ground_at(mover, center, Edges::Bear) {
            return (center, Some(footing));
        }
        let depth = mover.def.step_height + mover.def.skin;
        let (share, hit) = self.sight.sweep(center, -up * depth, &self.manner);
        if hit.is_none() {
            return (center, None);
        }
        // Beside an obstacle that stops the mover but does not support it, such as the edge of a riser, the mover may
        // get lower.
        let below = center - up * (depth * share);
        let beside = || self.sight.slide(below, -up * (depth * (1.0 - share)), &self.manner);
        let stands = |at: Vec3| self.ground_at(mover, at, Edges::Bear).map(|footing| (at, Some(footing)));
        stands(below).or_else(|| stands(beside())).unwrap_or((center, None))
    }

    /// Moves the mover through the air, under gravity. Carrying and faster bodies have already done a part of the
    /// motion.
    fn fly(&self, mover: &mut Mover, start: Vec3, (gravity, carried, pushed): (Vec3, Vec3, Vec3)) -> Vec3 {
        let (dt, up) = (self.dt, mover.def.up);
        let mut wanted = mover.velocity * dt + gravity * (0.5 * dt * dt) - carried;
        let (length, out) = (pushed.length(), normalize_or(pushed, Vec3::ZERO));
        wanted -= out * clamp(wanted.dot(out), 0.0, length);
        mover.velocity += gravity * dt;
        let speed = mover.velocity.length();
        if speed > self.world.def.max_speed {
            mover.velocity *= self.world.def.max_speed / speed;
        }
        let center = self.sight.slide(start, wanted, &self.manner);
        let free = mover.velocity;
        mover.velocity = self.stops(center).closest(free).unwrap_or(Vec3::ZERO);
        let fell = -wanted.dot(up);
        let wedged = fell > 0.0 && (center - start).length() < WEDGED_SHARE * fell;
        let edges = if wedged { Edges::Wedge } else { Edges::Fall };
        if let Some(footing) = self.ground_at(mover, center, edges) {
            let beside = free - footing.velocity;
            if beside.dot(up) <= 0.01 {
                mover.ground = Some(footing);
                let beside = mover.velocity - footing.velocity;
                mover.velocity = beside - up * beside.dot(up);
            }
        }
        center
    }

    /// Returns the velocities that the touches at a position allow: none toward an obstacle, unless the obstacle
    /// recedes.
    fn stops(&self, center: Vec3) -> Planes {
        self.sight.planes_of(center, &self.manner, |touch, wall| {
            min(self.footing(touch).velocity.dot(wall.unwrap_or(touch.normal)), 0.0)
        })
    }

    /// Returns the footing of a mover at a position: the flattest touch that supports it.
    fn ground_at(&self, mover: &Mover, center: Vec3, edges: Edges) -> Option<Footing> {
        let touches = self.sight.bearers(center, self.manner.skin);
        let rise = |touch: &Touch| touch.normal.dot(mover.def.up);
        let mut best: Option<&Touch> = None;
        for touch in touches.as_slice() {
            let bears = match edges {
                Edges::Fall => rise(touch) >= self.manner.flattest,
                Edges::Bear => self.bears(touch, mover, center),
                Edges::Wedge => rise(touch) > 0.02,
            };
            if bears && best.is_none_or(|best| rise(touch) > rise(best)) {
                best = Some(touch);
            }
        }
        best.map(|touch| self.footing(touch))
    }

    /// True if a touch supports the mover: it is flat, or it is the edge of a flat tread.
    fn bears(&self, touch: &Touch, mover: &Mover, center: Vec3) -> bool {
        let up = mover.def.up;
        let rise = touch.normal.dot(up);
        if rise >= self.manner.flattest {
            return true;
        }
        let feet = center - up * (0.5 * mover.def.height);
        let Owner::Shape(index, shape, _) = self.sight.obstacles[touch.obstacle].owner else { return false };
        if rise < 0.02 || (touch.point - feet).dot(up) > mover.def.step_height + mover.def.skin {
            return false;
        }
        let inward = -super::segment::level(touch.normal, up);
        let origin = touch.point + inward * BEHIND_EDGE + up * OVER_EDGE;
        let ray = Ray { origin, direction: -up * (2.0 * OVER_EDGE) };
        let hit =
            self.world.query().accept(|body, number| (body.index, number) == (index, shape)).first(&ray);
        hit.is_some_and(|hit| hit.fraction > 0.0 && hit.normal.dot(up) >= self.manner.flattest)
    }

    fn footing(&self, touch: &Touch) -> Footing {
        let Touch { normal, point, obstacle, .. } = *touch;
        let (on, velocity) = match self.sight.obstacles[obstacle].owner {
            Owner::Shape(index, shape, _) => {
                let on = Bearer::Shape { body: self.sight.bodies.id(index), shape };
                (on, surface_velocity(self.sight.bodies.at(index), shape, point))
            }
            Owner::Mover(index) => {
                let on = Bearer::Mover(self.movers.id(index));
                (on, Vec3::ZERO)
            }
        };
        Footing { on, point, normal, velocity }
    }
}

/// Kinds of supporting edges.
#[derive(Clone, Copy, PartialEq)]
enum Edges {
    /// Edges of treads support the mover; used on the ground.
    Bear,
    /// No edge supports the mover; used in the air.
    Fall,
    /// Every touch that stops a fall supports the mover.
    Wedge,
}
