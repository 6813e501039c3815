//! Particles against shapes: signed distance at the end of the substep, a ray along the way there.
//!
//! The impulse that a shape gave a particle in the last substep enters the next one's spring solve as an expected
//! force, and the contact only corrects it: otherwise a rope bent over an edge would hang with the wrong tension,
//! since its solve would let the particle on the edge fall freely. After an impact the expected impulse would be far
//! too large, so the smaller one of the last two substeps is expected.

use super::ParticleGroup;
use crate::contact::combine;
use crate::ray::Ray;
use crate::shape::{Material, Shape};
use sinew_math::{Sym3, Transform, Vec3, max, normalize_or};

/// Slower impacts do not bounce, m/s.
const BOUNCE_SPEED: f32 = 1.0;

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
    fn velocity_at(&self, point: Vec3) -> Vec3 {
        self.linear_velocity + self.angular_velocity.cross(point - self.center)
    }

    /// Velocity gained at `point` along `direction` per impulse there, 1/kg.
    fn yielding(&self, point: Vec3, direction: Vec3) -> f32 {
        let lever = (point - self.center).cross(direction);
        self.inverse_mass + lever.dot(self.inverse_inertia * lever)
    }

    fn push(&mut self, point: Vec3, impulse: Vec3) {
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

/// A particle and a shape within reach of each other.
#[derive(Clone, Copy)]
struct Touch {
    obstacle: usize,
    /// Unit, out of the shape.
    normal: Vec3,
    /// Gap at the end of the substep, metres.
    gap: f32,
}

impl ParticleGroup {
    /// Keeps particles out of shapes, after [`integrate`](Self::integrate) with the same `h`: places them on the
    /// surface, stops them (they bounce above 1 m/s), rubs them by Coulomb's law. Bodies are pushed back: their
    /// velocities change at once, and [`body_impulses`](Self::body_impulses) lists how. Particles that cross a shape
    /// within the substep are stopped on the side they came from.
    ///
    /// Attached particles are left alone. A particle touches at most two shapes in one substep. Every particle is
    /// tried against every obstacle: pass those that come near [`bounds`](Self::bounds).
    pub fn collide(&mut self, h: f32, obstacles: &[Obstacle], bodies: &mut [ObstacleBody]) {
        self.body_impulses.clear();
        self.contact_impulses.swap(0, 1);
        for i in 0..self.positions.len() {
            let expected = self.expected_from(1, i);
            self.contact_impulses[0][i] = Vec3::ZERO;
            if self.attachment_of[i] != u32::MAX {
                continue;
            }
            let reach = expected.length() * h / self.masses[i];
            let crossed = self.first_crossed(i, h, obstacles, bodies);
            let Some(touch) = crossed.or_else(|| self.deepest(i, reach, None, obstacles)) else {
                self.take_back(i, h, expected);
                continue;
            };
            self.respond(i, h, &touch, expected, obstacles, bodies);
            if let Some(second) = self.deepest(i, 0.0, Some(touch.obstacle), obstacles) {
                self.respond(i, h, &second, Vec3::ZERO, obstacles, bodies);
            }
        }
    }

    /// The contact impulse that the solve of this substep counts on.
    pub(super) fn expected_contact_impulse(&self, i: usize) -> Vec3 {
        if self.attachment_of[i] == u32::MAX { self.expected_from(0, i) } else { Vec3::ZERO }
    }

    /// The impulse in slot `last`, cut to the length of that in the other slot.
    fn expected_from(&self, last: usize, i: usize) -> Vec3 {
        let (impulse, before) = (self.contact_impulses[last][i], self.contact_impulses[1 - last][i]);
        let (length, limit) = (impulse.length(), before.length());
        if length > limit { impulse * (limit / length) } else { impulse }
    }

    /// The expected contact is gone: without it the particle would be flung away by a force that nothing exerts.
    fn take_back(&mut self, i: usize, h: f32, expected: Vec3) {
        let change = expected / self.masses[i];
        self.velocities[i] -= change;
        self.positions[i] -= change * h;
    }

    /// The first shape on the way of a particle that moves further than half its radius, seen from the shape.
    fn first_crossed(
        &self,
        i: usize,
        h: f32,
        obstacles: &[Obstacle],
        bodies: &[ObstacleBody],
    ) -> Option<Touch> {
        let (position, radius) = (self.positions[i], self.radii[i]);
        let mut first: Option<(f32, Touch)> = None;
        for (index, o) in obstacles.iter().enumerate() {
            let start = self.previous[i] + bodies[o.body as usize].velocity_at(position) * h;
            let way = position - start;
            let length = way.length();
            if length <= 0.5 * radius {
                continue;
            }
            let ray = Ray { origin: start, direction: way * (1.0 + radius / length) };
            let Some(hit) = o.shape.cast_ray(&o.world_from_shape, &ray) else { continue };
            // A start inside says nothing about the side it came from.
            let gap = (position - hit.point).dot(hit.normal) - radius;
            if hit.fraction > 0.0 && gap < 0.0 && first.is_none_or(|(fraction, _)| hit.fraction < fraction) {
                first = Some((hit.fraction, Touch { obstacle: index, normal: hit.normal, gap }));
            }
        }
        first.map(|(_, touch)| touch)
    }

    /// The shape it is deepest in, or nearest to if that is within `reach`.
    fn deepest(&self, i: usize, reach: f32, but: Option<usize>, obstacles: &[Obstacle]) -> Option<Touch> {
        let mut deepest: Option<Touch> = None;
        for (index, o) in obstacles.iter().enumerate() {
            if but == Some(index) {
                continue;
            }
            let (distance, normal) = o.shape.signed_distance(&o.world_from_shape, self.positions[i]);
            let gap = distance - self.radii[i];
            if gap <= reach && deepest.is_none_or(|touch| gap < touch.gap) {
                deepest = Some(Touch { obstacle: index, normal, gap });
            }
        }
        deepest
    }

    /// Normal impulse, friction, bounce; `expected` is what the solve has already given the particle.
    fn respond(
        &mut self,
        i: usize,
        h: f32,
        touch: &Touch,
        expected: Vec3,
        obstacles: &[Obstacle],
        bodies: &mut [ObstacleBody],
    ) {
        let (n, own) = (touch.normal, 1.0 / self.masses[i]);
        let obstacle = &obstacles[touch.obstacle];
        let body = &mut bodies[obstacle.body as usize];
        let material = combine(&self.material, &obstacle.material);
        let point = self.positions[i] - n * (self.radii[i] + touch.gap);
        body.push(point, -expected);

        // Along the normal: no approach, and no pull.
        let approach = (self.velocities[i] - body.velocity_at(point)).dot(n);
        let yielding = own + body.yielding(point, n);
        let wanted = if touch.gap > 0.0 {
            approach - touch.gap / h
        } else {
            self.rebound(approach, h, touch, material.restitution)
        };
        let normal = max(expected.dot(n) + (wanted - approach) / yielding, 0.0);
        let change = n * (normal - expected.dot(n));
        self.velocities[i] += change * own;
        body.push(point, -change);

        // Along the surface: stick if Coulomb's cone allows it.
        let relative = self.velocities[i] - body.velocity_at(point);
        let slip = relative - n * relative.dot(n);
        let along = normalize_or(slip, Vec3::ZERO);
        let before = expected - n * expected.dot(n);
        let mut friction = before - slip / (own + body.yielding(point, along));
        let limit = material.friction * normal;
        if friction.length() > limit {
            friction = normalize_or(friction, Vec3::ZERO) * limit;
        }
        self.velocities[i] += (friction - before) * own;
        body.push(point, before - friction);

        // What the velocity lost, the position must not have gained.
        let lift = if touch.gap > 0.0 { change * (own * h) } else { n * -touch.gap };
        self.positions[i] += lift + (friction - before) * (own * h);
        let impulse = n * normal + friction;
        self.contact_impulses[0][i] += impulse;
        if body.inverse_mass > 0.0 {
            self.body_impulses.push(BodyImpulse { body: obstacle.body, impulse: -impulse, point });
        }
    }

    /// Normal speed after an impact at `approach` (negative), so that a bounce neither gains nor loses height by the
    /// length of the substep. A velocity of symplectic Euler is that of half a substep ago, and gravity kept working
    /// between the surface and where the particle ended.
    fn rebound(&self, approach: f32, h: f32, touch: &Touch, restitution: f32) -> f32 {
        if approach >= -BOUNCE_SPEED || restitution == 0.0 {
            return 0.0;
        }
        let pull = max(-self.gravity.dot(touch.normal), 0.0);
        let at_end = approach - 0.5 * pull * h;
        let at_surface = max(at_end * at_end + 2.0 * pull * touch.gap, 0.0).sqrt();
        restitution * at_surface + 0.5 * pull * h
    }
}
