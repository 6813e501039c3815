//! Contacts of particles, present or expected within the iteration, as part of the spring solve.
//!
//! If the spring solve ignored contacts, a particle on an edge would fall freely, and a rope bent over the edge would
//! have the wrong tension. A rope end that hits the floor would be moved back against its springs, which would create
//! energy. Each particle on a surface sticks to it or slides on it: its velocity, or one component of it, is
//! prescribed in the linear system, which remains exact and cannot diverge. The impulses of the solution decide
//! which particles must release, slip or stick. Grips persist from substep to substep, so that one solve suffices at
//! rest. On movable bodies the body's inertia at the point is added instead.

use super::forest::NO_HUB;
use super::sweep::{Meeting, sweep_ball};
use super::system::Freedom;
use super::{Part, ParticleGroup};
use crate::body::material::{ContactMaterial, Material};
use crate::body::shape::Shape;
use crate::boxes::Aabb;
use crate::particles::tuning::{DETOUR, NO_SPEED, PINCHING, REACH_SHARE, WALL_GAP};
use sinew_math::{Mat3, Sym3, Transform, Vec3, max, max3, min, normalize_or};

/// Largest number of solves per iteration to make grips consistent.
const GRIP_ROUNDS: u32 = 16;
/// Number of solves after which surfaces no longer release particles, and slow down particles that stop instead of
/// holding them, so that the grips converge. Otherwise the particles of a stiff rope would alternate between slip and
/// stick, each in response to the others (ADR 0023).
const LOOSE_ROUNDS: u32 = 4;
/// Depth at the end of an iteration below which a contact is left to the impact pass, metres.
const IMPACT_DEPTH: f32 = 1e-5;

/// Motion and mass of a body near particles. Particles change its velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ObstacleBody {
    /// Centre of mass at the end of the substep, world, metres.
    pub center: Vec3,
    /// Velocity of the centre of mass, m/s, world axes.
    pub linear_velocity: Vec3,
    /// Angular velocity, rad/s, world axes.
    pub angular_velocity: Vec3,
    /// Inverse mass, 1/kg; 0 for static and kinematic bodies.
    pub inverse_mass: f32,
    /// Inverse inertia about the centre of mass, world axes, 1/(kg·m²).
    pub inverse_inertia: Sym3,
}

impl ObstacleBody {
    pub(crate) fn velocity_at(&self, point: Vec3) -> Vec3 {
        self.linear_velocity + self.angular_velocity.cross(point - self.center)
    }

    /// Velocity gained at `point` along `direction` per impulse there, 1/kg.
    pub(super) fn yielding(&self, point: Vec3, direction: Vec3) -> f32 {
        let lever = (point - self.center).cross(direction);
        self.inverse_mass + lever.dot(self.inverse_inertia * lever)
    }

    /// Velocity gained at `point` per impulse there, 1/kg: `I/m − [r]× J⁻¹ [r]×`.
    pub(super) fn response_at(&self, point: Vec3) -> Sym3 {
        let r = point - self.center;
        let gained = |e: Vec3| e * self.inverse_mass + (self.inverse_inertia * r.cross(e)).cross(r);
        Sym3::from_mat3(&Mat3::from_cols(gained(Vec3::X), gained(Vec3::Y), gained(Vec3::Z)))
    }

    /// Effective inertia at `point`, kg, along a unit normal and tangentially: the inverse of the response at the point
    /// without the cross terms.
    ///
    /// A body that many particles push from below does not rotate. With the cross terms each particle would be solved
    /// as if its own push rotated the body, and would slide outward.
    fn inertia_at(&self, point: Vec3, normal: Vec3) -> Sym3 {
        let whole = self.response_at(point);
        let along = whole * normal;
        let aside = along - normal * normal.dot(along);
        let coupling = Sym3::outer(normal + aside) - Sym3::outer(normal) - Sym3::outer(aside);
        (whole - coupling).inverse()
    }

    /// Priority of this body over another body when a particle is squeezed between the two.
    pub(super) fn firmness(&self) -> Firmness {
        match self.inverse_mass {
            0.0 if self.rests() => Firmness::Rests,
            0.0 => Firmness::Led,
            _ => Firmness::Yields,
        }
    }

    /// True if the body neither moves nor can be moved.
    pub(super) fn rests(&self) -> bool {
        self.inverse_mass == 0.0 && self.linear_velocity == Vec3::ZERO && self.angular_velocity == Vec3::ZERO
    }

    /// Mass, kg, and inertia about the centre of mass, kg·m², world axes, of a body that can be moved.
    pub(super) fn inertia(&self) -> (f32, Sym3) {
        // A body that does not rotate has a singular inverse inertia.
        let least = max(1e-9, 1e-6 * self.inverse_inertia.to_mat3().x_axis.length());
        (1.0 / self.inverse_mass, (self.inverse_inertia + Sym3::IDENTITY * least).inverse())
    }

    pub(super) fn push(&mut self, point: Vec3, impulse: Vec3) {
        self.linear_velocity += impulse * self.inverse_mass;
        self.angular_velocity += self.inverse_inertia * (point - self.center).cross(impulse);
    }
}

/// Priority of a body against others: a particle between two bodies follows the one with the higher priority.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Firmness {
    /// A dynamic body, which yields to forces.
    Yields,
    /// A kinematic body in motion.
    Led,
    /// A body that does not move.
    Rests,
}

/// A shape that particles may touch.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Geometry of the shape.
    pub shape: Shape,
    /// Frame of the shape at the beginning of the substep.
    pub previous: Transform,
    /// Frame of the shape at the end of the substep.
    pub world_from_shape: Transform,
    /// Index of the obstacle's body in the slice of bodies.
    pub body: u32,
    /// Material of the surface.
    pub material: Material,
}

/// Start and end pose of an obstacle in one iteration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    pub start: Transform,
    pub end: Transform,
    /// Largest displacement of any of the obstacle's points, metres.
    pub way: f32,
    /// Bounds of the whole motion.
    pub bounds: Aabb,
}

impl Placed {
    fn new(o: &Obstacle, [from, to]: [f32; 2], turn: f32) -> Self {
        let at = |share: f32| match share {
            0.0 => o.previous,
            1.0 => o.world_from_shape,
            _ => between(&o.previous, &o.world_from_shape, share),
        };
        let (start, end) = (at(from), at(to));
        let bounds = o.shape.aabb(&start).merge(&o.shape.aabb(&end));
        // A rotating body exceeds the bounds of its end poses by the height of the arc.
        let size = (bounds.max - bounds.min).length();
        let bulge = if turn == 0.0 { 0.0 } else { size * turn * turn / 8.0 };
        let way = if start == end {
            0.0
        } else {
            let lever = (start.translation - end.translation).length();
            let reach = size + (bounds.min - start.translation).length();
            if start.rotation == end.rotation { lever } else { lever + DETOUR * turn * reach }
        };
        Self { start, end, way, bounds: bounds.expand(bulge) }
    }

    /// Length of the displacement in the iteration of a point that moves with the shape, metres.
    fn way_of(&self, point: Vec3) -> f32 {
        if self.way == 0.0 { 0.0 } else { self.displacement(point).length() }
    }

    /// Displacement in the iteration of a point that moves with the shape, metres.
    pub fn displacement(&self, point: Vec3) -> Vec3 {
        self.end.point(self.start.inverse_point(point)) - point
    }
}

/// A lower bound of the distance from a point to anything inside `bounds`, metres.
pub(crate) fn distance_at_least(bounds: &Aabb, point: Vec3) -> f32 {
    let beyond = max3(bounds.min - point, point - bounds.max);
    max(max(beyond.x, beyond.y), beyond.z)
}

/// True if a particle with displacement `way` (m) cannot reach an obstacle at distance `clearance` (m).
fn is_beyond(clearance: f32, way: Vec3) -> bool {
    clearance > 0.0 && clearance * clearance > DETOUR * DETOUR * way.length_squared()
}

fn between(from: &Transform, to: &Transform, share: f32) -> Transform {
    let translation = from.translation * (1.0 - share) + to.translation * share;
    Transform::new(translation, from.rotation.nlerp(to.rotation, share))
}

/// Impulse of a particle on a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyImpulse {
    /// Index of the body in the slice of bodies.
    pub body: u32,
    /// Impulse on the body, N·s, world axes.
    pub impulse: Vec3,
    /// Point at which the impulse acts, world, metres.
    pub point: Vec3,
}

/// Contact of a particle with a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    pub obstacle: usize,
    pub body: usize,
    /// Normal of the surface, unit length, outward.
    pub normal: Vec3,
    /// Gap, metres; negative inside. Before the solve it is the gap at the iteration's beginning, afterwards that at
    /// its end.
    pub gap: f32,
    /// Point of contact on the surface, world, metres.
    pub point: Vec3,
    /// Combined material of the pair of surfaces.
    pub material: ContactMaterial,
    /// Smallest allowed normal velocity, m/s: negative while a gap remains.
    pub speed_min: f32,
    /// Ratio of the mass of all particles that touch the body to that of this particle, if they outweigh the body; else
    /// 1. The body's inertia is divided by it, because the sum of the particles' impulses would push it too far.
    pub lightness: f32,
    /// Lower bound of the distance to other shapes at the start of the iteration, minus the shapes' motion, metres.
    pub beside: f32,
}

impl Touch {
    /// Computes the impulse on the particle that keeps its normal velocity above `speed_min`, with Coulomb friction,
    /// for a particle of inverse mass `response`; applies the opposite impulse to the body.
    pub fn impulse(&self, response: f32, velocity: Vec3, body: &mut ObstacleBody) -> Vec3 {
        let n = self.normal;
        let approach = (velocity - body.velocity_at(self.point)).dot(n) - self.speed_min;
        let normal = max(-approach / (response + body.yielding(self.point, n)), 0.0);
        body.push(self.point, n * -normal);
        n * normal + self.rub(normal, response, velocity + n * (normal * response), body)
    }

    /// Computes the friction impulse on the particle for a normal impulse; applies the opposite impulse to the body.
    pub(super) fn rub(&self, normal: f32, response: f32, velocity: Vec3, body: &mut ObstacleBody) -> Vec3 {
        let relative = velocity - self.surface_velocity(body);
        let slip = relative - self.normal * relative.dot(self.normal);
        let along = normalize_or(slip, Vec3::ZERO);
        let stick = slip.length() / (response + body.yielding(self.point, along));
        let holds = stick <= self.material.static_friction * normal;
        let friction = along * -if holds { stick } else { self.material.friction * normal };
        body.push(self.point, -friction);
        friction
    }

    /// True if a particle on this surface must not yield to the surface of `other`, whose body has a lower priority.
    pub fn pinches(&self, other: &Self, bodies: &[ObstacleBody]) -> bool {
        self.obstacle != other.obstacle
            && bodies[other.body].firmness() < bodies[self.body].firmness()
            && self.normal.dot(other.normal) < PINCHING
    }

    /// Height of a ball above the plane that it touches, at the end of the iteration, metres.
    pub fn height(&self, center: Vec3, radius: f32) -> f32 {
        (center - self.point).dot(self.normal) - radius
    }

    /// Velocity of the body's surface at the contact point, m/s.
    pub fn surface_velocity(&self, body: &ObstacleBody) -> Vec3 {
        body.velocity_at(self.point) + self.material.velocity
    }
}

/// Grip of a surface on a particle that touches it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Grip {
    /// The particle does not touch the surface.
    #[default]
    Off,
    /// The surface holds the particle along the normal; friction is a force.
    Slide,
    /// The surface holds the particle along the normal; friction is a viscosity, until the iteration ends.
    Slow,
    /// The surface holds the particle in all directions.
    Stick,
    /// The surface holds the particle in the corner with another surface, until the end of the iteration.
    Wedged,
}

impl ParticleGroup {
    /// Computes the obstacles' poses at the start and end of this iteration.
    pub(super) fn place(&mut self, part: Part, obstacles: &[Obstacle], bodies: &[ObstacleBody]) {
        let (h, shares) = (part.h(), part.shares());
        self.placed.clear();
        let turn = |o: &Obstacle| bodies[o.body as usize].angular_velocity.length() * h;
        self.placed.extend(obstacles.iter().map(|o| Placed::new(o, shares, turn(o))));
    }

    /// Finds the nearest surface that each particle touches or is about to touch, and the distance of all others.
    pub(super) fn find_contacts(&mut self, h: f32, obstacles: &[Obstacle], bodies: &[ObstacleBody]) {
        // Particles that were not solved in the previous iteration touched nothing.
        for &i in &self.solved {
            self.touches[i as usize] = None;
        }
        for at in 0..self.close.len() {
            let i = self.close[at] as usize;
            if self.attachment_of[i] == u32::MAX {
                self.find_contact(i, h, obstacles, bodies);
            }
            self.grips[i] = match self.grips[i] {
                _ if self.touches[i].is_none() => Grip::Off,
                Grip::Wedged => Grip::Stick,
                Grip::Slow => Grip::Slide,
                grip => grip,
            };
        }
    }

    /// Contact search distance of a particle from its surface, metres.
    pub(super) fn sight(&self, i: usize, h: f32) -> f32 {
        self.contact_reach(i, h) + DETOUR * (self.velocities[i].length() * h)
    }

    /// Gap that a particle may close by its acceleration, metres.
    fn contact_reach(&self, i: usize, h: f32) -> f32 {
        // Includes gravity, and a share of the other forces.
        2.0 * h * h * self.pulls[i] + REACH_SHARE * self.radii[i]
    }

    pub(super) fn find_contact(&mut self, i: usize, h: f32, obstacles: &[Obstacle], bodies: &[ObstacleBody]) {
        let (position, radius) = (self.positions[i], self.radii[i]);
        let (reach, sight) = (self.contact_reach(i, h), self.sights[i]);
        let mut beside = self.near.left_out_from(i, sight);
        let mut distance_now = beside;
        let mut nearest: Option<(usize, Meeting)> = None;
        let mut wall: Option<(usize, Meeting)> = None;
        let firmness = |index: usize| bodies[obstacles[index].body as usize].firmness();
        let mut clearance = f32::INFINITY;
        for index in self.near.within(i, sight, obstacles.len()) {
            let (o, placed) = (&obstacles[index], &self.placed[index]);
            let at_least = distance_at_least(&placed.bounds, position) - radius;
            if at_least > sight {
                (beside, distance_now) = (min(beside, at_least), min(distance_now, at_least));
                continue;
            }
            let at = placed.start.inverse_point(position);
            let (distance, normal) = o.shape.ball_distance(at, radius, sight + radius);
            let gap = distance - radius;
            distance_now = min(distance_now, gap);
            let clear = gap - placed.way_of(position);
            let is_firmer = |(than, best): (usize, Meeting)| {
                firmness(index) > firmness(than) || firmness(index) == firmness(than) && gap < best.gap
            };
            if gap <= WALL_GAP && wall.is_none_or(is_firmer) {
                wall = Some((index, Meeting { fraction: 0.0, at, normal, gap }));
            }
            if gap <= reach && nearest.is_none_or(|(_, best)| gap < best.gap) {
                nearest = Some((index, Meeting { fraction: 0.0, at, normal, gap }));
                beside = min(beside, clearance);
                clearance = clear;
            } else {
                beside = min(beside, clear);
            }
        }
        let touch = |(index, meeting)| self.touch(i, h, index, &meeting, obstacles, bodies);
        let mut touch_of_nearest = nearest.map(touch);
        // A particle on a wall stays on the wall when a body approaches from the other side: see `pinch`.
        if let (Some(near), Some(wall)) = (&mut touch_of_nearest, wall.map(touch))
            && wall.pinches(near, bodies)
        {
            beside = min(beside, clearance);
            *near = wall;
        }
        self.touches[i] = touch_of_nearest.map(|touch| Touch { beside, ..touch });
        self.clearances[i] = min(clearance, beside);
        self.near.note_distance(i, position, distance_now);
    }

    /// Contact of a particle with a plane, which the particle must not cross before the end of the iteration.
    pub(super) fn touch(
        &self,
        i: usize,
        h: f32,
        obstacle: usize,
        meeting: &Meeting,
        obstacles: &[Obstacle],
        bodies: &[ObstacleBody],
    ) -> Touch {
        let (o, placed) = (&obstacles[obstacle], &self.placed[obstacle]);
        let normal = placed.end.rotation * meeting.normal;
        let gap = meeting.height(placed.start.inverse_point(self.positions[i]));
        // Centre of the particle at contact; its present centre if it is inside.
        let touching = placed.end.point(meeting.at - meeting.normal * max(meeting.gap, 0.0));
        let point = touching - normal * (self.radii[i] + min(meeting.gap, 0.0));
        let body = &bodies[o.body as usize];
        // A backstop is no surface of the body: it has no friction and no bounce.
        let is_common = obstacle < self.near.common(obstacles.len());
        let of_pair = is_common.then(|| ContactMaterial::of(&self.material, &o.material));
        let mut material = of_pair.unwrap_or_default();
        if o.material.runs() {
            let spin = placed.end.rotation * o.material.surface_spin;
            let along = placed.end.rotation * o.material.surface_velocity
                + spin.cross(point - placed.end.translation);
            material.velocity = along - normal * along.dot(normal);
        }
        let speed = (touching - self.positions[i]).dot(normal) / h;
        Touch {
            obstacle,
            body: o.body as usize,
            normal,
            gap,
            point,
            material,
            speed_min: speed - body.velocity_at(point).dot(normal),
            lightness: 1.0,
            beside: 0.0,
        }
    }

    /// True if a particle certainly hits nothing on its path.
    pub(super) fn is_clear(&self, i: usize, way: Vec3) -> bool {
        is_beyond(self.clearances[i], way) || self.attachment_of[i] != u32::MAX
    }

    /// True if a particle certainly hits nothing on its path except the surface that it touches.
    pub(super) fn is_clear_beside(&self, i: usize, way: Vec3) -> bool {
        self.touches[i].map_or_else(|| self.is_clear(i, way), |touch| is_beyond(touch.beside, way))
    }

    /// First obstacle on a particle's path that the particle is in deeper than `depth` (m) at the end; ignores obstacle
    /// `but`.
    pub(super) fn first_met(
        &self,
        i: usize,
        (start, end): (Vec3, Vec3),
        but: Option<usize>,
        depth: f32,
        obstacles: &[Obstacle],
    ) -> Option<(usize, Meeting)> {
        let mut first: Option<(usize, Meeting)> = None;
        let way = (end - start).length();
        for index in self.near.within(i, DETOUR * way, obstacles.len()) {
            let (o, placed) = (&obstacles[index], &self.placed[index]);
            if but == Some(index) || distance_at_least(&placed.bounds, start) > self.radii[i] + way {
                continue;
            }
            let (from, to) = (placed.start.inverse_point(start), placed.end.inverse_point(end));
            if let Some(meeting) = sweep_ball(&o.shape, self.radii[i], from, to)
                && meeting.height(to) < -depth
                && first.is_none_or(|(_, best)| meeting.fraction < best.fraction)
            {
                first = Some((index, meeting));
            }
        }
        first
    }

    /// Finds the surface that a particle would hit within the iteration at its new velocity; returns true if the solve
    /// must include a new contact.
    fn predict_contact(&mut self, i: usize, h: f32, obstacles: &[Obstacle], bodies: &[ObstacleBody]) -> bool {
        let way = self.velocities[i] * h;
        if self.grips[i] == Grip::Wedged || self.is_clear_beside(i, way) {
            return false;
        }
        // Springs may take a particle farther than its search distance.
        self.near.follow(i, self.positions[i]);
        let known = self.touches[i].map(|touch| touch.obstacle);
        let ends = (self.positions[i], self.positions[i] + way);
        let Some((obstacle, meeting)) = self.first_met(i, ends, known, IMPACT_DEPTH, obstacles) else {
            return false;
        };
        let touch = self.touch(i, h, obstacle, &meeting, obstacles, bodies);
        let fixed = |body: usize| bodies[body].inverse_mass == 0.0;
        match self.touches[i] {
            Some(held) if self.grips[i] != Grip::Off => {
                // Between two walls a particle can only move along their edge. A yielding body is left to the impact
                // pass.
                let wedged = fixed(held.body) && fixed(touch.body);
                if wedged {
                    self.grips[i] = Grip::Wedged;
                    self.wedges[i] = self.velocities[i] * meeting.fraction;
                }
                wedged
            }
            _ => {
                self.grips[i] = self.first_grip(i, &touch, bodies);
                self.touches[i] = Some(touch);
                true
            }
        }
    }

    /// Initial grip on a particle that approaches a surface at its new velocity. A particle that friction cannot stop
    /// slides, with the friction of the normal impulse.
    fn first_grip(&mut self, i: usize, touch: &Touch, bodies: &[ObstacleBody]) -> Grip {
        let relative = self.velocities[i] - touch.surface_velocity(&bodies[touch.body]);
        let normal = max(touch.speed_min - relative.dot(touch.normal), 0.0) * self.masses[i];
        let borne = normal + self.pinched_by(i);
        let slip = relative - touch.normal * relative.dot(touch.normal);
        if slip.length() * self.masses[i] <= touch.material.static_friction * borne {
            return Grip::Stick;
        }
        let limit = touch.material.friction * borne;
        self.contact_impulses[i] = touch.normal * normal - normalize_or(slip, Vec3::ZERO) * limit;
        Grip::Slide
    }

    /// Updates the factors by which particles share their bodies' inertia (`lightness`); returns true if any has
    /// changed.
    fn share_bodies(&mut self, bodies: &[ObstacleBody]) -> bool {
        let mut changed = false;
        self.loads.clear();
        self.loads.resize(bodies.len(), 0.0);
        for &i in &self.solved {
            if let Some(touch) = &self.touches[i as usize] {
                self.loads[touch.body] += self.masses[i as usize];
            }
        }
        for &i in &self.solved {
            let mass = self.masses[i as usize];
            if let Some(touch) = &mut self.touches[i as usize] {
                let load = self.loads[touch.body];
                let lightness = if load * bodies[touch.body].inverse_mass > 1.0 { load / mass } else { 1.0 };
                changed |= lightness != touch.lightness;
                touch.lightness = lightness;
            }
        }
        changed
    }

    /// Chooses the particles to solve, and adds the impulses of bends.
    pub(super) fn prepare_solve(&mut self, h: f32) {
        self.choose_solved(h);
        if self.bends_ahead() {
            self.bend_ahead(h);
        }
    }

    /// True if bends are part of the spring solve.
    fn bends_ahead(&self) -> bool {
        self.forest.has_trees() && !self.bends.is_empty()
    }

    /// Solves for the velocities; repeats while contacts open, close, stick, slip or appear. Repeats for all particles
    /// if springs connect them, otherwise only for those with changes.
    pub(super) fn settle_contacts(&mut self, h: f32, obstacles: &[Obstacle], bodies: &[ObstacleBody]) {
        self.system.load_springs(&self.forest, &self.springs, &self.positions, h);
        // With lanes, reactions are cleared when particles are taken out of the lanes.
        if !self.eights.on {
            self.reactions.fill(Vec3::ZERO);
        }
        let mut unsettled = core::mem::take(&mut self.unsettled);
        unsettled.clone_from(&self.solved);
        let mut met = true;
        for round in 1..=GRIP_ROUNDS {
            let shares_changed = met && self.share_bodies(bodies);
            if shares_changed || self.forest.has_trees() {
                unsettled.clone_from(&self.solved);
            }
            self.apply_grips(&unsettled, bodies);
            if self.forest.has_trees() {
                let found = (self.velocities.as_mut_slice(), self.reactions.as_mut_slice());
                self.system.settle_springs(&self.forest, &self.springs, &self.positions, h, found);
            } else {
                self.system.solve_apart(&unsettled, &mut self.velocities);
            }
            if round == GRIP_ROUNDS {
                self.keep_grips(&unsettled);
                break;
            }
            met = false;
            unsettled.retain(|&i| {
                let changed = self.change_grip(i as usize, round <= LOOSE_ROUNDS, bodies);
                let found = self.predict_contact(i as usize, h, obstacles, bodies);
                met |= found;
                changed || found
            });
            if unsettled.is_empty() {
                break;
            }
        }
        self.unsettled = unsettled;
        if self.bends_ahead() {
            for (reaction, bend) in self.reactions.iter_mut().zip(&self.bend_impulses) {
                *reaction += *bend;
            }
        }
    }

    /// Projects the bends of a group with trees from the particles' positions without springs, and enters their
    /// impulses in the solve. The springs are solved after the bends, because they are far stiffer and bends would
    /// stretch them.
    fn bend_ahead(&mut self, h: f32) {
        self.reactions.fill(Vec3::ZERO);
        for i in 0..self.positions.len() {
            if self.system.freedom[i] != Freedom::Fixed {
                self.velocities[i] = match self.forest.hub_of(i) {
                    NO_HUB => self.system.inertia[i].inverse() * self.system.momentum[i],
                    hub => self.system.hubs[hub].coming_at(self.system.points[i]),
                };
            }
            self.positions[i] += self.velocities[i] * h;
        }
        for k in 0..self.bends.len() {
            self.project_bend(self.bends[k], h);
        }
        self.positions.copy_from_slice(&self.previous);
        core::mem::swap(&mut self.reactions, &mut self.bend_impulses);
        for (momentum, bend) in self.system.momentum.iter_mut().zip(&self.bend_impulses) {
            *momentum += *bend;
        }
    }

    /// Lists the particles to solve: all in spring trees, and those that are held, touch a surface or are about to
    /// touch one. The others move freely.
    fn choose_solved(&mut self, h: f32) {
        self.solved.clear();
        if self.forest.has_trees() {
            self.solved.extend(0..self.positions.len() as u32);
            return;
        }
        for at in 0..self.close.len() {
            let i = self.close[at] as usize;
            if self.attachment_of[i] != u32::MAX {
                self.solved.push(i as u32);
                continue;
            }
            let ahead = self.begun[i] + self.accelerations[i] * h;
            if self.is_clear(i, ahead * h) && self.touches[i].is_none() {
                self.contact_impulses[i] = Vec3::ZERO;
                continue;
            }
            self.solved.push(i as u32);
            self.enter(i, h);
        }
        // Free particles move on; the solve finds the velocities of the others.
        for at in 0..self.one_by_one() {
            let i = self.one(at);
            if self.attachment_of[i] == u32::MAX {
                self.velocities[i] = self.begun[i] + self.accelerations[i] * h;
            }
        }
    }

    /// Computes the backing of each touching particle, `M / (m + M)` with `M` its share of the body's inertia along the
    /// normal, and its room before it presses.
    pub(super) fn back_contacts(&mut self, bodies: &[ObstacleBody]) {
        for at in 0..self.solved.len() {
            let i = self.solved[at] as usize;
            let Some(touch) = self.touches[i] else { continue };
            let relative = self.velocities[i] - touch.surface_velocity(&bodies[touch.body]);
            let away = relative.dot(touch.normal) - touch.speed_min;
            self.rooms[i] = max(away, 0.0) / self.weights[i] - self.pinched_by(i);
            let yielding = bodies[touch.body].yielding(touch.point, touch.normal);
            self.press_normals[i] = touch.normal;
            // M / (m + M), with M = m / (load · yielding).
            self.backings[i] = 1.0 / (1.0 + self.loads[touch.body] * yielding);
        }
    }

    /// Transmits the pressing impulses to bodies, with friction.
    pub(super) fn press_bodies(&mut self, h: f32, bodies: &mut [ObstacleBody]) {
        for at in 0..self.solved.len() {
            let i = self.solved[at] as usize;
            if let Some(touch) = self.touches[i].filter(|_| self.backings[i] > 0.0) {
                // The contact of the two pinching shapes has already applied its load, and the solver the friction of this load.
                let pressing = self.backings[i] * (min(self.rooms[i], 0.0) + self.pinched_by(i));
                let impulse = self.press_normals[i] * pressing;
                (self.backings[i], self.press_normals[i], self.rooms[i]) = (0.0, Vec3::ZERO, 0.0);
                let (body, weight) = (&mut bodies[touch.body], self.weights[i]);
                body.push(touch.point, impulse);
                let friction = touch.rub(max(-pressing, 0.0), weight, self.velocities[i], body);
                self.velocities[i] += friction * weight;
                self.positions[i] += friction * (weight * h);
                self.report(&touch, friction - impulse, bodies);
            }
        }
    }

    /// Impulse in this iteration that presses a particle from two sides, N·s.
    pub(super) fn pinched_by(&self, i: usize) -> f32 {
        self.pinched.loads[i] * self.span
    }

    /// Converts grips for the linear system: prescribed velocities, or the inertia of a yielding body.
    fn apply_grips(&mut self, particles: &[u32], bodies: &[ObstacleBody]) {
        for &i in particles {
            let i = i as usize;
            if self.attachment_of[i] != u32::MAX {
                continue;
            }
            let (mut freedom, mut inertia, mut momentum) = (Freedom::Free, Sym3::ZERO, Vec3::ZERO);
            if let Some(touch) = &self.touches[i] {
                let (n, body) = (touch.normal, &bodies[touch.body]);
                let target = touch.surface_velocity(body) + n * touch.speed_min;
                match self.grips[i] {
                    Grip::Off => {}
                    Grip::Slide | Grip::Slow => {
                        (inertia, momentum) = self.rubbing(i, touch, body);
                        let yielding = body.yielding(touch.point, n) * touch.lightness;
                        freedom = Freedom::Along { normal: n, speed: target.dot(n), yielding };
                    }
                    Grip::Stick if body.inverse_mass > 0.0 => {
                        inertia = body.inertia_at(touch.point, n) * (1.0 / touch.lightness);
                        momentum = inertia * target;
                    }
                    Grip::Stick => {
                        freedom = Freedom::Fixed;
                        self.velocities[i] = target;
                    }
                    Grip::Wedged => {
                        freedom = Freedom::Fixed;
                        self.velocities[i] = self.wedges[i];
                    }
                }
            }
            self.system.freedom[i] = freedom;
            self.system.added_inertia[i] = inertia;
            self.system.added_momentum[i] = momentum;
        }
    }

    /// Friction on a sliding particle as additional inertia, kg, and momentum, kg·m/s: a force, or a viscosity by
    /// Coulomb's law at the last slip, which slows the particle and never drives it.
    fn rubbing(&self, i: usize, touch: &Touch, body: &ObstacleBody) -> (Sym3, Vec3) {
        let n = touch.normal;
        if self.grips[i] == Grip::Slide {
            return (Sym3::ZERO, self.friction(i, n));
        }
        let surface = touch.surface_velocity(body);
        let relative = self.velocities[i] - surface;
        let slip = max((relative - n * relative.dot(n)).length(), NO_SPEED);
        let most = touch.material.friction * (max(self.contact_impulses[i].dot(n), 0.0) + self.pinched_by(i));
        let viscosity = (Sym3::IDENTITY - Sym3::outer(n)) * (most / slip);
        (viscosity, viscosity * surface)
    }

    /// Tangential part of the last contact impulse, N·s.
    fn friction(&self, i: usize, normal: Vec3) -> Vec3 {
        let impulse = self.contact_impulses[i];
        impulse - normal * impulse.dot(normal)
    }

    /// Impulse of the surface on a particle in the solve, N·s.
    fn contact_impulse(&self, i: usize) -> Vec3 {
        self.velocities[i] * self.masses[i] - self.system.momentum[i] - self.reactions[i]
    }

    /// Stores the contact impulses of the last solve without changing grips.
    fn keep_grips(&mut self, particles: &[u32]) {
        for &i in particles {
            let i = i as usize;
            let held = self.touches[i].is_some() && self.grips[i] != Grip::Off;
            self.contact_impulses[i] = if held { self.contact_impulse(i) } else { Vec3::ZERO };
        }
    }

    /// Stores the contact impulse of the last solve and updates the particle's grip; without `may_loosen` the grip can
    /// only become firmer. Returns true if the grip has changed.
    fn change_grip(&mut self, i: usize, may_loosen: bool, bodies: &[ObstacleBody]) -> bool {
        let Some(touch) = self.touches[i] else {
            self.contact_impulses[i] = Vec3::ZERO;
            return false;
        };
        let n = touch.normal;
        let relative = self.velocities[i] - touch.surface_velocity(&bodies[touch.body]);
        let impulse = self.contact_impulse(i);
        let (normal, friction) = (impulse.dot(n), impulse - n * impulse.dot(n));
        let borne = normal + self.pinched_by(i);
        let limit = touch.material.friction * borne;
        let slip = relative - n * relative.dot(n);
        let (grip, impulse) = match self.grips[i] {
            Grip::Off if relative.dot(n) < touch.speed_min - NO_SPEED => {
                (self.first_grip(i, &touch, bodies), self.contact_impulses[i])
            }
            Grip::Off => (Grip::Off, Vec3::ZERO),
            Grip::Wedged => (Grip::Wedged, impulse),
            held if !may_loosen && borne <= 0.0 => (held, impulse),
            // A surface cannot pull.
            _ if borne <= 0.0 => (Grip::Off, Vec3::ZERO),
            Grip::Stick if friction.length() > touch.material.static_friction * borne => {
                (Grip::Slide, n * normal + friction * (limit / friction.length()))
            }
            Grip::Stick => (Grip::Stick, impulse),
            Grip::Slow => (Grip::Slow, impulse),
            // Friction along the motion has already stopped the particle within the iteration.
            Grip::Slide if limit > 0.0 && slip.dot(friction) > 0.0 => {
                (if may_loosen { Grip::Stick } else { Grip::Slow }, impulse)
            }
            Grip::Slide => (Grip::Slide, n * normal - normalize_or(slip, Vec3::ZERO) * limit),
        };
        let changed = grip != self.grips[i];
        (self.grips[i], self.contact_impulses[i]) = (grip, impulse);
        changed
    }

    /// Applies the reactions of the contact impulses to the bodies.
    pub(super) fn push_bodies(&mut self, bodies: &mut [ObstacleBody]) {
        for at in 0..self.solved.len() {
            let i = self.solved[at] as usize;
            if let Some(touch) = self.touches[i] {
                let impulse = self.contact_impulses[i];
                bodies[touch.body].push(touch.point, -impulse);
                self.report(&touch, impulse, bodies);
            }
        }
    }

    /// Lists the reaction on a body of an impulse on a particle, if the body moves or can be moved.
    pub(super) fn report(&mut self, touch: &Touch, on_particle: Vec3, bodies: &[ObstacleBody]) {
        if !bodies[touch.body].rests() && on_particle != Vec3::ZERO {
            let body = touch.body as u32;
            self.body_impulses.push(BodyImpulse { body, impulse: -on_particle, point: touch.point });
        }
    }
}
