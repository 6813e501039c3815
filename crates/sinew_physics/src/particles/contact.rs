//! Contacts that a particle is in, or reaches slowly, as part of the spring solve.
//!
//! Without them the solve would let a particle on an edge fall freely, and a rope bent over the edge would hang with
//! the wrong tension. Each particle that touches a surface sticks to it or slides on it: its velocity, or one
//! component of it, is given in the linear system, which stays exact and cannot diverge. Impulses read off the
//! solution tell who must let go, slip or stick; grips are kept from substep to substep, so that at rest one solve is
//! enough. On bodies that can move, the body's inertia at the point is added instead.

use super::ParticleGroup;
use super::forest::Freedom;
use crate::contact::combine;
use crate::shape::{Material, Shape};
use sinew_math::{Mat3, Sym3, Transform, Vec3, max, min, normalize_or};

/// Faster approaches are impacts, which may bounce, m/s.
pub(super) const IMPACT_SPEED: f32 = 1.0;
/// Slower than that, nothing moves, m/s.
const NO_SPEED: f32 = 1e-6;
/// Solves per substep until grips have to be right.
const GRIP_ROUNDS: u32 = 4;

/// The motion of a body that particles may touch. Its velocity changes as they do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ObstacleBody {
    /// Centre of mass at the end of the substep, world, metres.
    pub center: Vec3,
    /// m/s.
    pub linear_velocity: Vec3,
    /// rad/s, world axes.
    pub angular_velocity: Vec3,
    /// 1/kg; 0 for static and kinematic bodies.
    pub inverse_mass: f32,
    /// World axes, about the centre, 1/(kg·m²).
    pub inverse_inertia: Sym3,
}

impl ObstacleBody {
    pub(super) fn velocity_at(&self, point: Vec3) -> Vec3 {
        self.linear_velocity + self.angular_velocity.cross(point - self.center)
    }

    /// Velocity gained at `point` along `direction` per impulse there, 1/kg.
    pub(super) fn yielding(&self, point: Vec3, direction: Vec3) -> f32 {
        let lever = (point - self.center).cross(direction);
        self.inverse_mass + lever.dot(self.inverse_inertia * lever)
    }

    /// Inertia that resists a push at `point`, kg: the inverse of `I/m − [r]× J⁻¹ [r]×`.
    fn inertia_at(&self, point: Vec3) -> Sym3 {
        let r = point - self.center;
        let gained = |e: Vec3| e * self.inverse_mass + (self.inverse_inertia * r.cross(e)).cross(r);
        Sym3::from_mat3(&Mat3::from_cols(gained(Vec3::X), gained(Vec3::Y), gained(Vec3::Z))).inverse()
    }

    pub(super) fn push(&mut self, point: Vec3, impulse: Vec3) {
        self.linear_velocity += impulse * self.inverse_mass;
        self.angular_velocity += self.inverse_inertia * (point - self.center).cross(impulse);
    }
}

/// A shape that particles may touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// Geometry.
    pub shape: Shape,
    /// Its frame at the end of the substep.
    pub world_from_shape: Transform,
    /// Index of its body in the slice given with it.
    pub body: u32,
    /// Surface.
    pub material: Material,
}

/// What a particle did to a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyImpulse {
    /// Index in the slice of bodies.
    pub body: u32,
    /// N·s, world.
    pub impulse: Vec3,
    /// World, metres.
    pub point: Vec3,
}

/// A particle and a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    pub obstacle: usize,
    pub body: usize,
    /// Unit, out of the shape.
    pub normal: Vec3,
    /// Gap, metres; negative inside.
    pub gap: f32,
    /// Where, on the surface.
    pub point: Vec3,
    /// Of the pair of surfaces.
    pub material: Material,
    /// Slowest allowed velocity along the normal, m/s: negative while there is a gap to be closed.
    pub speed_min: f32,
}

impl Touch {
    /// The impulse on the particle that keeps it from approaching faster than `speed_min`, rubbed by Coulomb's law,
    /// if an impulse changes its velocity by `response` alone; the body is pushed the other way.
    pub fn impulse(&self, response: f32, velocity: Vec3, body: &mut ObstacleBody) -> Vec3 {
        let n = self.normal;
        let approach = (velocity - body.velocity_at(self.point)).dot(n) - self.speed_min;
        let normal = max(-approach / (response + body.yielding(self.point, n)), 0.0);
        body.push(self.point, n * -normal);

        let relative = velocity + n * (normal * response) - body.velocity_at(self.point);
        let slip = relative - n * relative.dot(n);
        let along = normalize_or(slip, Vec3::ZERO);
        let stick = slip.length() / (response + body.yielding(self.point, along));
        let friction = along * -min(stick, self.material.friction * normal);
        body.push(self.point, -friction);
        n * normal + friction
    }
}

/// How a surface holds a particle that touches it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Grip {
    /// Not at all.
    #[default]
    Off,
    /// Along the normal; friction is a force.
    Slide,
    /// In all directions.
    Stick,
}

impl ParticleGroup {
    /// The nearest surface within reach of each particle that approaches it slowly.
    pub(super) fn find_contacts(&mut self, h: f32, obstacles: &[Obstacle], bodies: &[ObstacleBody]) {
        for i in 0..self.positions.len() {
            self.touches[i] = None;
            if self.attachment_of[i] == u32::MAX {
                self.touches[i] = self.slow_contact(i, h, obstacles, bodies);
            }
        }
        self.leave_light_bodies(bodies);
        for i in 0..self.positions.len() {
            if self.touches[i].is_none() {
                self.grips[i] = Grip::Off;
            }
        }
    }

    /// Each particle is solved as if it alone pushed the body. Where those that touch it outweigh it, their sum would
    /// push it too far: such contacts are left to the impacts, which come one after the other.
    fn leave_light_bodies(&mut self, bodies: &[ObstacleBody]) {
        self.loads.clear();
        self.loads.resize(bodies.len(), 0.0);
        for (touch, mass) in self.touches.iter().zip(&self.masses) {
            if let Some(touch) = touch {
                self.loads[touch.body] += mass;
            }
        }
        for slot in &mut self.touches {
            if slot.is_some_and(|touch| self.loads[touch.body] * bodies[touch.body].inverse_mass > 1.0) {
                *slot = None;
            }
        }
    }

    /// Solves for the velocities; repeats while contacts open, close, stick or slip.
    pub(super) fn solve_with_contacts(&mut self, h: f32, bodies: &[ObstacleBody]) {
        self.system.load_springs(&self.forest, &self.springs, &self.positions, h);
        for _ in 0..GRIP_ROUNDS {
            self.apply_grips(bodies);
            self.system.solve(&self.forest, &self.springs, h, &mut self.velocities);
            self.reactions.fill(Vec3::ZERO);
            self.system.add_spring_impulses(
                &self.forest,
                &self.springs,
                h,
                &self.velocities,
                &mut self.reactions,
            );
            if !self.change_grips(bodies) {
                break;
            }
        }
    }

    /// Turns grips into what the linear system knows: fixed velocities, or the inertia of a body that yields.
    fn apply_grips(&mut self, bodies: &[ObstacleBody]) {
        for i in 0..self.positions.len() {
            if self.attachment_of[i] != u32::MAX {
                continue;
            }
            let (mut freedom, mut inertia, mut momentum) = (Freedom::Free, Sym3::ZERO, Vec3::ZERO);
            if let Some(touch) = &self.touches[i] {
                let (n, body) = (touch.normal, &bodies[touch.body]);
                let target = body.velocity_at(touch.point) + n * touch.speed_min;
                let movable = body.inverse_mass > 0.0;
                match self.grips[i] {
                    Grip::Off => {}
                    Grip::Slide if movable => {
                        inertia = Sym3::outer(n) * (1.0 / body.yielding(touch.point, n));
                        momentum = inertia * target + self.friction(i, n);
                    }
                    Grip::Slide => {
                        freedom = Freedom::Along { normal: n, speed: target.dot(n) };
                        momentum = self.friction(i, n);
                    }
                    Grip::Stick if movable => {
                        inertia = body.inertia_at(touch.point);
                        momentum = inertia * target;
                    }
                    Grip::Stick => {
                        freedom = Freedom::Fixed;
                        self.velocities[i] = target;
                    }
                }
            }
            self.system.freedom[i] = freedom;
            self.system.added_inertia[i] = inertia;
            self.system.added_momentum[i] = momentum;
        }
    }

    /// The part along the surface of the last contact impulse.
    fn friction(&self, i: usize, normal: Vec3) -> Vec3 {
        let impulse = self.contact_impulses[i];
        impulse - normal * impulse.dot(normal)
    }

    /// Reads off the contact impulses of the last solve and decides again who is held how; whether anyone's grip has
    /// changed.
    fn change_grips(&mut self, bodies: &[ObstacleBody]) -> bool {
        let mut changed = false;
        for i in 0..self.positions.len() {
            let Some(touch) = self.touches[i] else {
                self.contact_impulses[i] = Vec3::ZERO;
                continue;
            };
            let n = touch.normal;
            let relative = self.velocities[i] - bodies[touch.body].velocity_at(touch.point);
            let impulse = self.velocities[i] * self.masses[i] - self.system.momentum[i] - self.reactions[i];
            let (normal, friction) = (impulse.dot(n), impulse - n * impulse.dot(n));
            let limit = touch.material.friction * normal;
            let slip = relative - n * relative.dot(n);
            let (grip, impulse) = match self.grips[i] {
                Grip::Off if relative.dot(n) < touch.speed_min - NO_SPEED => (Grip::Stick, Vec3::ZERO),
                Grip::Off => (Grip::Off, Vec3::ZERO),
                // A surface does not pull.
                _ if normal <= 0.0 => (Grip::Off, Vec3::ZERO),
                Grip::Stick if friction.length() > limit => {
                    (Grip::Slide, n * normal + friction * (limit / friction.length()))
                }
                Grip::Stick => (Grip::Stick, impulse),
                // Friction that drives the motion has stopped it on the way.
                Grip::Slide if slip.dot(friction) > 0.0 => (Grip::Stick, impulse),
                Grip::Slide => (Grip::Slide, n * normal - normalize_or(slip, Vec3::ZERO) * limit),
            };
            changed |= grip != self.grips[i];
            (self.grips[i], self.contact_impulses[i]) = (grip, impulse);
        }
        changed
    }

    fn slow_contact(
        &self,
        i: usize,
        h: f32,
        obstacles: &[Obstacle],
        bodies: &[ObstacleBody],
    ) -> Option<Touch> {
        let mut nearest: Option<Touch> = None;
        for (index, o) in obstacles.iter().enumerate() {
            let body = &bodies[o.body as usize];
            // Obstacles have moved already: where the particle is, seen from there.
            let drift = body.velocity_at(self.positions[i]);
            let seen = self.positions[i] + drift * h;
            let (distance, normal) = o.shape.signed_distance(&o.world_from_shape, seen);
            let gap = distance - self.radii[i];
            let approach = (self.velocities[i] - drift).dot(normal);
            // Within reach in this substep, gravity, outer force and a share of the other forces included.
            let reach =
                h * (max(-approach, 0.0) + 2.0 * h * self.accelerations[i].length()) + 0.05 * self.radii[i];
            if gap <= reach && approach > -IMPACT_SPEED && nearest.is_none_or(|touch| gap < touch.gap) {
                nearest = Some(Touch {
                    obstacle: index,
                    body: o.body as usize,
                    normal,
                    gap,
                    point: seen - normal * (self.radii[i] + gap),
                    material: combine(&self.material, &o.material),
                    speed_min: -max(gap, 0.0) / h,
                });
            }
        }
        nearest
    }

    /// Pushes bodies back by the impulses that the solve found.
    pub(super) fn push_bodies(&mut self, bodies: &mut [ObstacleBody]) {
        for i in 0..self.positions.len() {
            if let Some(touch) = self.touches[i] {
                let impulse = self.contact_impulses[i];
                bodies[touch.body].push(touch.point, -impulse);
                self.report(&touch, impulse, bodies);
            }
        }
    }

    /// Lists an impulse on a particle as its opposite on the body, if that can move.
    pub(super) fn report(&mut self, touch: &Touch, on_particle: Vec3, bodies: &[ObstacleBody]) {
        if bodies[touch.body].inverse_mass > 0.0 && on_particle != Vec3::ZERO {
            let body = touch.body as u32;
            self.body_impulses.push(BodyImpulse { body, impulse: -on_particle, point: touch.point });
        }
    }
}
