//! Impacts, and what is left of other contacts, at the end of the substep: signed distance to the shapes there, a ray
//! along the way there. Each particle answers with its own mass.

use super::ParticleGroup;
use super::contact::{IMPACT_SPEED, Obstacle, ObstacleBody, Touch};
use crate::contact::combine;
use crate::ray::Ray;
use sinew_math::{Vec3, max};

/// Impulses on bodies per particle and substep: one in the solve, and two impacts, in a corner.
pub(super) const MAX_TOUCHES: usize = 3;

impl ParticleGroup {
    /// Puts particles that are inside a shape, or crossed one, on its surface, on the side they came from. They stop
    /// or bounce (above 1 m/s), and rub.
    pub(super) fn stop_impacts(&mut self, h: f32, obstacles: &[Obstacle], bodies: &mut [ObstacleBody]) {
        for i in 0..self.positions.len() {
            if self.attachment_of[i] != u32::MAX {
                continue;
            }
            let crossed = self.first_crossed(i, h, obstacles, bodies);
            let Some(first) = crossed.or_else(|| self.deepest(i, None, obstacles)) else { continue };
            self.respond(i, h, first, bodies);
            if let Some(second) = self.deepest(i, Some(first.obstacle), obstacles) {
                self.respond(i, h, second, bodies);
            }
        }
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
            let gap = (position - hit.point).dot(hit.normal) - radius;
            // A start inside says nothing about the side it came from.
            if hit.fraction > 0.0 && gap < 0.0 && first.is_none_or(|(fraction, _)| hit.fraction < fraction) {
                first = Some((hit.fraction, self.touch(i, index, o, hit.normal, gap)));
            }
        }
        first.map(|(_, touch)| touch)
    }

    /// The shape it is deepest in.
    fn deepest(&self, i: usize, but: Option<usize>, obstacles: &[Obstacle]) -> Option<Touch> {
        let mut deepest: Option<Touch> = None;
        for (index, o) in obstacles.iter().enumerate() {
            if but == Some(index) {
                continue;
            }
            let (distance, normal) = o.shape.signed_distance(&o.world_from_shape, self.positions[i]);
            let gap = distance - self.radii[i];
            if gap < 0.0 && deepest.is_none_or(|touch| gap < touch.gap) {
                deepest = Some(self.touch(i, index, o, normal, gap));
            }
        }
        deepest
    }

    fn touch(&self, i: usize, index: usize, o: &Obstacle, normal: Vec3, gap: f32) -> Touch {
        Touch {
            obstacle: index,
            body: o.body as usize,
            normal,
            gap,
            point: self.positions[i] - normal * (self.radii[i] + gap),
            material: combine(&self.material, &o.material),
            speed_min: 0.0,
        }
    }

    fn respond(&mut self, i: usize, h: f32, mut touch: Touch, bodies: &mut [ObstacleBody]) {
        let body = &mut bodies[touch.body];
        let approach = (self.velocities[i] - body.velocity_at(touch.point)).dot(touch.normal);
        touch.speed_min = self.rebound(i, approach, h, &touch);
        let own = 1.0 / self.masses[i];
        let impulse = touch.impulse(own, self.velocities[i], body);
        let change = impulse * own;
        self.velocities[i] += change;
        // What friction took from the velocity, the position must not have gained.
        let aside = change - touch.normal * change.dot(touch.normal);
        self.positions[i] += aside * h - touch.normal * touch.gap;
        self.report(&touch, impulse, bodies);
    }

    /// Normal speed after an impact at `approach` (negative), so that a bounce neither gains nor loses height by the
    /// length of the substep. A velocity of symplectic Euler is that of half a substep ago, and gravity kept working
    /// between the surface and where the particle ended.
    fn rebound(&self, i: usize, approach: f32, h: f32, touch: &Touch) -> f32 {
        if approach >= -IMPACT_SPEED || touch.material.restitution == 0.0 {
            return 0.0;
        }
        let pull = max(-self.accelerations[i].dot(touch.normal), 0.0);
        let at_end = approach - 0.5 * pull * h;
        let at_surface = max(at_end * at_end + 2.0 * pull * touch.gap, 0.0).sqrt();
        touch.material.restitution * at_surface + 0.5 * pull * h
    }
}
