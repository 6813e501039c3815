//! Moves a group into the lanes of `eights.rs`, extracts the particles that are solved individually, and moves them
//! back.

use super::ParticleGroup;
use super::batches::{FIELDS, WAY};
use super::contact::{Grip, Obstacle, ObstacleBody};
use super::eights::{ACCELERATION, Approach, Depart, Form, STRIP, Solid};
use super::spread::{Collect, Spread};
use crate::body::material::ContactMaterial;
use crate::body::shape::Shape;
use crate::particles::tuning::MOST_SOLIDS;
use sinew_math::lanes::Block;
use sinew_math::{Vec3, dispatch};

/// Number of grips that are tested together.
const GRIPS: usize = 64;

impl Solid {
    /// Converts an obstacle; `None` if it is not a resting ball, box, capsule or half-space.
    fn of(group: &ParticleGroup, o: &Obstacle, bodies: &[ObstacleBody]) -> Option<Self> {
        if !bodies[o.body as usize].rests() || o.previous != o.world_from_shape || o.material.runs() {
            return None;
        }
        let turn = o.world_from_shape.rotation;
        let wide = |v: Vec3| Block::splat(v.to_array());
        let form = match o.shape {
            Shape::Box { half_extents } => {
                Form::Box(wide(half_extents), [Vec3::X, Vec3::Y, Vec3::Z].map(|e| wide(turn * e)))
            }
            Shape::Sphere { radius } => Form::Round(Block::splat([0.0, radius]), wide(Vec3::Y)),
            Shape::Capsule { half_height, radius } => {
                Form::Round(Block::splat([half_height, radius]), wide(turn * Vec3::Y))
            }
            Shape::HalfSpace => Form::Half(wide(turn * Vec3::Y)),
            _ => return None,
        };
        let material = ContactMaterial::of(&group.material, &o.material);
        let bounces = f32::from(u8::from(material.restitution > 0.0));
        Some(Self {
            form,
            at: wide(o.world_from_shape.translation),
            surface: Block::splat([material.friction, material.static_friction, bounces]),
        })
    }
}

impl ParticleGroup {
    /// Decides whether a substep uses lanes, and loads all particles if so.
    pub(super) fn enter_eights(&mut self, obstacles: &[Obstacle], bodies: &[ObstacleBody]) {
        self.eights.on = !self.forest.has_trees()
            && !self.batches.is_empty()
            && self.volumes.is_empty()
            && self.self_collision.is_none()
            && self.backstops.is_empty()
            && obstacles.len() <= MOST_SOLIDS;
        if !self.eights.on {
            return;
        }
        let mut eights = core::mem::take(&mut self.eights);
        eights.solids.clear();
        eights.foreign.clear();
        eights.others.clear();
        for (index, o) in obstacles.iter().enumerate() {
            match Solid::of(self, o, bodies) {
                Some(solid) => eights.solids.push(solid),
                None => eights.foreign.push(index as u32),
            }
        }
        let per_lane = eights.strips.len();
        let Self { positions, velocities, accelerations, batches, .. } = self;
        dispatch::run(Spread::<FIELDS, 0> { vectors: positions, blocks: &mut batches.particles, per_lane });
        dispatch::run(Spread::<STRIP, 0> { vectors: velocities, blocks: &mut eights.strips, per_lane });
        if self.common_acceleration.is_none() || eights.common_acceleration != self.common_acceleration {
            let blocks = &mut eights.strips;
            dispatch::run(Spread::<STRIP, ACCELERATION> { vectors: accelerations, blocks, per_lane });
            eights.common_acceleration = self.common_acceleration;
        }
        for (at, grips) in self.grips.chunks(GRIPS).enumerate() {
            // Nearly all grips are off, and loops without early exit test them in whole registers.
            if grips.iter().fold(false, |any, grip| any | (*grip != Grip::Off)) {
                let gripped = (at * GRIPS..).zip(grips).filter(|(_, grip)| **grip != Grip::Off);
                eights.others.extend(gripped.map(|(i, _)| i as u32));
            }
        }
        self.eights = eights;
    }

    /// Stores all particles at the end of the substep.
    pub(super) fn leave_eights(&mut self) {
        let Self { positions, velocities, batches, eights, .. } = self;
        let per_lane = eights.strips.len();
        dispatch::run(Collect::<FIELDS> { vectors: positions, blocks: &batches.particles, per_lane });
        dispatch::run(Collect::<STRIP> { vectors: velocities, blocks: &eights.strips, per_lane });
    }

    /// Starts an iteration of `h` seconds: finds each particle's contact and velocity; takes particles out that lanes
    /// cannot handle.
    pub(super) fn approach(&mut self, h: f32) {
        let Self { eights, placed, batches, linear_damping, .. } = self;
        eights.foreign_bounds.clear();
        eights.foreign_bounds.extend(eights.foreign.iter().map(|&k| placed[k as usize].bounds));
        let damping = 1.0 / (1.0 + h * *linear_damping);
        dispatch::run(Approach { eights, particles: &mut batches.particles, h, damping });
        for at in 0..self.eights.others.len() {
            let i = self.eights.others[at] as usize;
            if self.eights.is_easy(i) {
                (self.grips[i], self.contact_impulses[i]) = (Grip::Off, Vec3::ZERO);
            }
        }
        self.eights.others.clear();
        for k in 0..self.attachments.len() {
            let i = self.attachments[k].particle;
            self.eights.others.push(i);
            self.velocities[i as usize] *= damping;
        }
        let per_lane = self.eights.strips.len();
        for block in 0..per_lane {
            let mut left = self.eights.present[block] & !self.eights.easy[block];
            while left != 0 {
                let lane = left.trailing_zeros() as usize;
                left &= left - 1;
                let i = lane * per_lane + block;
                self.eights.others.push(i as u32);
                let (particle, strip) = (&self.batches.particles[block].0, &self.eights.strips[block].0);
                self.positions[i] = Vec3::new(particle[0][lane], particle[1][lane], particle[2][lane]);
                self.velocities[i] = Vec3::new(strip[0][lane], strip[1][lane], strip[2][lane]);
            }
        }
        self.eights.others.sort_unstable();
        for at in 0..self.eights.others.len() {
            let i = self.eights.others[at] as usize;
            self.previous[i] = self.positions[i];
            self.begun[i] = self.velocities[i];
            self.weights[i] = 1.0 / self.masses[i];
            self.reactions[i] = Vec3::ZERO;
        }
        for k in 0..self.attachments.len() {
            self.enter(self.attachments[k].particle as usize, h);
        }
    }

    /// Projects the rows, in lanes and individually. `Depart` applies the contacts of particles in lanes afterwards.
    pub(super) fn project_in_eights(&mut self, h: f32) {
        let per_second = 1.0 / h;
        let outside = core::mem::take(&mut self.eights.outside);
        for i in outside.iter().map(|&i| i as usize).filter(|&i| self.eights.is_easy(i)) {
            let [from, way] = [0, WAY].map(|field| self.batches.vector_of(i, field));
            (self.previous[i], self.positions[i], self.velocities[i]) = (from, from + way, way * per_second);
        }
        self.project_held(h);
        let others = core::mem::take(&mut self.eights.others);
        let mut touching = false;
        for &i in outside.iter().chain(&others) {
            let i = i as usize;
            self.batches.put_way(i, self.previous[i], self.velocities[i] * h);
            if self.backings[i] > 0.0 {
                self.batches.put_surface(i, self.press_normals[i], self.backings[i], self.rooms[i] * h);
                touching = true;
            }
        }
        dispatch::run(self.batches.project(h, touching));
        for i in others.iter().map(|&i| i as usize).filter(|&i| self.attachment_of[i] == u32::MAX) {
            let way = self.batches.vector_of(i, WAY);
            (self.velocities[i], self.positions[i]) = (way * per_second, self.previous[i] + way);
            if self.backings[i] > 0.0 {
                self.rooms[i] = self.batches.take_surface(i) * per_second;
            }
        }
        (self.eights.outside, self.eights.others) = (outside, others);
    }

    /// Ends the iteration of particles in lanes; takes out particles that may have hit something on their path.
    pub(super) fn depart(&mut self, h: f32, obstacles: &[Obstacle], bodies: &[ObstacleBody]) {
        dispatch::run(Depart { eights: &mut self.eights, particles: &mut self.batches.particles, h });
        let per_lane = self.eights.strips.len();
        let mut others = core::mem::take(&mut self.eights.others);
        let solved = others.len();
        for block in 0..per_lane {
            let mut left = self.eights.strayed[block];
            while left != 0 {
                let lane = left.trailing_zeros() as usize;
                left &= left - 1;
                let i = lane * per_lane + block;
                others.push(i as u32);
                let strip = &self.eights.strips[block].0;
                self.velocities[i] = Vec3::new(strip[0][lane], strip[1][lane], strip[2][lane]);
                let from = self.batches.vector_of(i, 0);
                (self.previous[i], self.positions[i]) = (from, from);
                self.sights[i] = self.sight(i, h);
                self.near.follow(i, from);
                self.find_contact(i, h, obstacles, bodies);
                self.positions[i] = from + self.batches.vector_of(i, WAY);
            }
        }
        others[solved..].sort_unstable();
        self.eights.others = others;
    }

    /// Puts back the particles that were taken out.
    pub(super) fn put_back(&mut self) {
        let per_lane = self.eights.strips.len();
        for at in 0..self.eights.others.len() {
            let i = self.eights.others[at] as usize;
            let (block, lane) = (i % per_lane, i / per_lane);
            if self.eights.strayed[block] >> lane & 1 == 1 {
                self.touches[i] = None;
            }
            let (at, velocity) = (self.positions[i], self.velocities[i]);
            let (particle, strip) = (&mut self.batches.particles[block].0, &mut self.eights.strips[block].0);
            for (k, (at, velocity)) in at.to_array().into_iter().zip(velocity.to_array()).enumerate() {
                (particle[k][lane], strip[k][lane]) = (at, velocity);
            }
        }
    }
}
