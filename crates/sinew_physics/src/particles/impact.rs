//! Bounces and remaining contacts at the end of the iteration: a sweep along the path, the signed distance at its end.
//! Each particle reacts with its own mass.

use super::ParticleGroup;
use super::contact::{Firmness, Obstacle, ObstacleBody, Placed, Touch};
use super::pinched::is_nipped;
use super::sweep::Meeting;
use crate::particles::tuning::{DETOUR, EXIT_SPEED, IMPACT_SPEED, PINCHING, ROUNDING};
use core::cmp::Ordering;
use sinew_math::{Vec3, clamp, max, min, normalize_or};

/// Largest number of surfaces out of which a particle is moved; at the next one it stops.
const ROUNDS: usize = 2;
/// Largest number of impulses on bodies per particle and iteration: one each from the solve, the net and the bounce,
/// and one per impact, of which the last may involve two bodies.
pub(super) const MAX_TOUCHES: usize = 3 + ROUNDS + 2;

/// A particle at the end of the iteration, after the solve.
struct Came {
    /// Position, world, metres.
    position: Vec3,
    /// Velocity, m/s.
    velocity: Vec3,
    /// Number of impulses on bodies listed before this particle.
    reported: usize,
}

impl ParticleGroup {
    /// Applies restitution to particles that the solve has stopped.
    pub(super) fn bounce(&mut self, h: f32, bodies: &mut [ObstacleBody]) {
        for at in 0..self.solved.len() {
            let i = self.solved[at] as usize;
            let Some(mut touch) = self.touches[i] else { continue };
            if touch.material.restitution == 0.0 || self.contact_impulses[i].dot(touch.normal) <= 0.0 {
                continue;
            }
            let approach = (self.begun[i] - touch.surface_velocity(&bodies[touch.body])).dot(touch.normal);
            touch.speed_min = self.rebound(i, approach, h, &touch);
            if touch.speed_min > 0.0 {
                self.push_off(i, &touch, bodies);
            }
        }
    }

    /// Moves particles that are inside a shape, or crossed one, to the surface of the shape, on the side from which
    /// they came. They stop or bounce, with friction.
    pub(super) fn stop_impacts(&mut self, h: f32, obstacles: &[Obstacle], bodies: &mut [ObstacleBody]) {
        for at in 0..self.one_by_one() {
            let i = self.one(at);
            if self.is_clear(i, self.positions[i] - self.previous[i]) || self.rests(i, obstacles) {
                continue;
            }
            self.near.follow(i, self.previous[i]);
            let mut but = None;
            let came = Came {
                position: self.positions[i],
                velocity: self.velocities[i],
                reported: self.body_impulses.len(),
            };
            let mut wall = self.touches[i].filter(|touch| self.leans_on(i, touch));
            for round in 0..=ROUNDS {
                let ends = (self.previous[i], self.positions[i]);
                if self.is_clear(i, ends.1 - ends.0) {
                    break;
                }
                let Some((obstacle, meeting)) = self.entered(i, ends, but, obstacles) else { break };
                let mut touch = self.touch(i, h, obstacle, &meeting, obstacles, bodies);
                let Placed { start, end, .. } = self.placed[obstacle];
                touch.gap = meeting.height(end.inverse_point(ends.1));
                if bodies[touch.body].firmness() > Firmness::Yields {
                    // A particle that was inside at the start of the iteration comes out slowly: an instant move would
                    // stretch its springs.
                    let goal = min(meeting.height(start.inverse_point(ends.0)) + EXIT_SPEED * h, 0.0);
                    touch.gap = min(touch.gap - goal, 0.0);
                }
                if let Some(wall) = wall.filter(|wall| wall.pinches(&touch, bodies)) {
                    self.pinch(i, &wall, &touch, h * (1.0 - meeting.fraction), bodies);
                    break;
                }
                if let Some(other) = but
                    && self.squeeze(i, h, &came, [other, obstacle], (obstacles, bodies))
                {
                    self.leave_walls(i, [other, obstacle], obstacles, bodies);
                    break;
                }
                if round == ROUNDS {
                    // The particle is in the corner of three surfaces.
                    self.positions[i] = end.point(meeting.at);
                    self.velocities[i] = touch.surface_velocity(&bodies[touch.body]);
                    break;
                }
                // The solve has already moved the particle correctly to this surface.
                let known = self.touches[i].is_some_and(|touch| touch.obstacle == obstacle);
                if !(known && touch.gap > -ROUNDING) {
                    self.respond(i, h, touch, h * (1.0 - meeting.fraction), bodies);
                }
                wall = Some(touch);
                but = Some(obstacle);
            }
        }
    }

    /// True if a particle is on a surface at the end of the iteration.
    fn leans_on(&self, i: usize, touch: &Touch) -> bool {
        touch.height(self.positions[i], self.radii[i]) < ROUNDING
    }

    /// Resolves a particle between two surfaces without room, each of which would push it into the other. It moves out
    /// of the firmer one, or midway if neither is firmer. It moves with them along the normal, and stays free
    /// tangentially, so that its springs can pull it out. Returns true if there is no room.
    fn squeeze(
        &mut self,
        i: usize,
        h: f32,
        came: &Came,
        shapes: [usize; 2],
        (obstacles, bodies): (&[Obstacle], &[ObstacleBody]),
    ) -> bool {
        let (at, radius) = (came.position, self.radii[i]);
        let [(gap, normal, body), (opposite_gap, opposite, opposite_body)] = shapes.map(|k| {
            let (o, end) = (&obstacles[k], &self.placed[k].end);
            let (distance, normal) = o.shape.ball_distance(end.inverse_point(at), radius, radius);
            (distance - radius, end.rotation * normal, &bodies[o.body as usize])
        });
        if normal.dot(opposite) >= PINCHING || gap + opposite_gap >= 0.0 {
            return false;
        }
        let (speed, opposite_speed) = (body.velocity_at(at), opposite_body.velocity_at(at));
        let across = normalize_or(normal - opposite, normal);
        let most = EXIT_SPEED * h;
        // Distance by which the particle moves out of the first surface, and the first's share in its velocity.
        let (out, share) = match body.firmness().cmp(&opposite_body.firmness()) {
            Ordering::Greater => (-gap, 1.0),
            Ordering::Equal => (0.5 * (opposite_gap - gap), 0.5),
            Ordering::Less => (opposite_gap, 0.0),
        };
        self.positions[i] = at + across * clamp(out, -most, most);
        let behind = speed * share + opposite_speed * (1.0 - share) - came.velocity;
        self.velocities[i] = came.velocity + across * behind.dot(across);
        // Drops impulses on fixed bodies. The impulse on a dynamic body that pushed the particle here stays.
        let mut kept = came.reported;
        for k in came.reported..self.body_impulses.len() {
            let hit = self.body_impulses[k];
            if bodies[hit.body as usize].inverse_mass > 0.0 {
                self.body_impulses[kept] = hit;
                kept += 1;
            }
        }
        self.body_impulses.truncate(kept);
        true
    }

    /// Moves a particle out of all fixed shapes except the two that leave no room; the last shape has priority.
    fn leave_walls(&mut self, i: usize, but: [usize; 2], obstacles: &[Obstacle], bodies: &[ObstacleBody]) {
        let (at, radius) = (self.positions[i], self.radii[i]);
        let way = DETOUR * (at - self.previous[i]).length();
        let (mut out, mut velocity) = (at, self.velocities[i]);
        for index in self.near.within(i, way, obstacles.len()) {
            let (o, end) = (&obstacles[index], &self.placed[index].end);
            if but.contains(&index) || bodies[o.body as usize].firmness() != Firmness::Rests {
                continue;
            }
            let (distance, normal) = o.shape.ball_distance(end.inverse_point(out), radius, radius);
            if distance < radius {
                let normal = end.rotation * normal;
                out += normal * (radius - distance);
                velocity -= normal * min(velocity.dot(normal), 0.0);
            }
        }
        (self.positions[i], self.velocities[i]) = (out, velocity);
    }

    /// Resolves a particle on a wall that a body approaches. The particle stays on the wall, and both apply friction,
    /// the wall last. If the particle is nipped, a contact of the two shapes transmits the body's pressure to the wall;
    /// otherwise the body pushes the particle aside along the wall.
    fn pinch(&mut self, i: usize, wall: &Touch, touch: &Touch, left: f32, bodies: &mut [ObstacleBody]) {
        let (own, load, begun) = (1.0 / self.masses[i], self.pinched_by(i), self.velocities[i]);
        let along_wall = |v: Vec3| v - wall.normal * v.dot(wall.normal);
        let mut pushed = 0.0;
        let friction = min(touch.material.static_friction, wall.material.static_friction);
        if !is_nipped(touch.normal.dot(wall.normal), friction) {
            let (n, aside) = (touch.normal, along_wall(touch.normal));
            let body = &mut bodies[touch.body];
            let approach = (begun - touch.surface_velocity(body)).dot(n);
            pushed = max(-approach / (own * aside.length_squared() + body.yielding(touch.point, n)), 0.0);
            body.push(touch.point, n * -pushed);
            self.velocities[i] += aside * (own * pushed);
            self.positions[i] -= aside * (touch.gap / aside.length_squared());
        }
        // The wall returns the part of the body's impulse along the wall's normal.
        let back = -pushed * touch.normal.dot(wall.normal);
        for (touch, pressing, push) in
            [(touch, load + pushed, touch.normal * pushed), (wall, back, Vec3::ZERO)]
        {
            let friction = touch.rub(pressing, own, self.velocities[i], &mut bodies[touch.body]);
            self.velocities[i] += friction * own;
            self.report(touch, push + friction, bodies);
        }
        self.positions[i] += along_wall(self.velocities[i] - begun) * left;
    }

    /// True if a particle is still on the convex solid that it touches, and hit nothing else.
    fn rests(&self, i: usize, obstacles: &[Obstacle]) -> bool {
        self.touches[i].is_some_and(|touch| {
            touch.height(self.positions[i], self.radii[i]) > -ROUNDING
                && self.is_clear_beside(i, self.positions[i] - self.previous[i])
                && obstacles[touch.obstacle].shape.surface().is_none()
        })
    }

    /// Surface that a particle has crossed, otherwise the one that it is deepest in.
    fn entered(
        &self,
        i: usize,
        ends: (Vec3, Vec3),
        but: Option<usize>,
        obstacles: &[Obstacle],
    ) -> Option<(usize, Meeting)> {
        self.first_met(i, ends, but, 0.0, obstacles).or_else(|| self.deepest(i, ends, but, obstacles))
    }

    fn deepest(
        &self,
        i: usize,
        (start, end): (Vec3, Vec3),
        but: Option<usize>,
        obstacles: &[Obstacle],
    ) -> Option<(usize, Meeting)> {
        let mut deepest: Option<(usize, Meeting)> = None;
        for index in self.near.within(i, DETOUR * (end - start).length(), obstacles.len()) {
            if but == Some(index) {
                continue;
            }
            let (o, placed) = (&obstacles[index], &self.placed[index]);
            let at = placed.end.inverse_point(end);
            let (distance, normal) = o.shape.ball_distance(at, self.radii[i], self.radii[i]);
            let gap = distance - self.radii[i];
            if gap < 0.0 && deepest.is_none_or(|(_, best)| gap < best.gap) {
                deepest = Some((index, Meeting { fraction: 0.0, at, normal, gap }));
            }
        }
        deepest
    }

    /// Moves a particle out of a surface that it hit when `left` seconds of the iteration remained.
    fn respond(&mut self, i: usize, h: f32, mut touch: Touch, left: f32, bodies: &mut [ObstacleBody]) {
        let approach = (self.velocities[i] - touch.surface_velocity(&bodies[touch.body])).dot(touch.normal);
        touch.speed_min = self.rebound(i, approach, h, &touch);
        let change = self.push_off(i, &touch, bodies);
        // Removes from the position the motion that friction removed from the velocity.
        let aside = change - touch.normal * change.dot(touch.normal);
        self.positions[i] += aside * left - touch.normal * touch.gap;
    }

    /// Raises a particle's normal velocity to its contact's minimum; returns the velocity gained.
    fn push_off(&mut self, i: usize, touch: &Touch, bodies: &mut [ObstacleBody]) -> Vec3 {
        let own = 1.0 / self.masses[i];
        let impulse = touch.impulse(own, self.velocities[i], &mut bodies[touch.body]);
        self.velocities[i] += impulse * own;
        self.report(touch, impulse, bodies);
        impulse * own
    }

    /// Normal speed after an impact at `approach` (negative), corrected so that a bounce neither gains nor loses height
    /// due to the iteration's length. A velocity of symplectic Euler belongs to half an iteration ago, and gravity acts
    /// between the surface and the particle's position at that time.
    fn rebound(&self, i: usize, approach: f32, h: f32, touch: &Touch) -> f32 {
        if approach >= -IMPACT_SPEED || touch.material.restitution == 0.0 {
            return 0.0;
        }
        let pull = max(-self.accelerations[i].dot(touch.normal), 0.0);
        let there = approach - 0.5 * pull * h;
        let at_surface = max(there * there + 2.0 * pull * touch.gap, 0.0).sqrt();
        touch.material.restitution * at_surface + 0.5 * pull * h
    }
}
