//! Rows of cloth and blobs, each solved once per iteration: `Δx = −C / (Σ w ∇C² + α/h²) w ∇C` with `α = 1/k` (Macklin
//! et al., "Small Steps in Physics Simulation", SCA 2019, without its multipliers). A single row is a step of implicit
//! Euler. Rows that share particles are solved one after the other, without a correction of earlier rows: each spring
//! of a net is softer by about `h² (w₁ + w₂)`.
//!
//! An impulse that presses a particle onto a surface moves the particle with its share of the body's inertia, and is
//! transmitted to the body; otherwise the cloth's own few grams would carry a ball. A surface only presses. A particle
//! has **room**, the impulse that brings it from the solve's position onto the surface. Rows use up the room before
//! they press, and a later row that pulls the particle away reduces the press first. Otherwise rows would pull
//! particles through the surface, or push the body by an impulse that no longer presses, and nets would vibrate under
//! loads. Static obstacles need none of this: see `eights.rs`.
//!
//! Rows with an attached particle are solved individually, because the impulse on the particle is counted. All other
//! rows are solved eight at a time, see `batches.rs`.

use super::batches::Batches;
use super::eights::Eights;
use super::{BendDef, ParticleGroup, Resists, SpringDef, TetherDef, VolumeDef};
use sinew_math::{Vec3, dispatch, max, min};

impl ParticleGroup {
    /// Projects tethers, springs outside the forest, bends, volumes and self-collision. Coarse rows come first, so that
    /// fine ones are solved last, except pressure and non-penetration.
    pub(super) fn project_net(&mut self, h: f32) {
        self.project_held(h);
        self.project_batches(h);
        let volumes = core::mem::take(&mut self.volumes);
        for volume in &volumes {
            self.project_volume(volume, h);
        }
        self.volumes = volumes;
        self.part_particles(h);
    }

    /// Projects tethers, and rows with an attached particle.
    pub(super) fn project_held(&mut self, h: f32) {
        for k in 0..self.tethers.len() {
            self.project_tether(self.tethers[k], h);
        }
        for k in 0..self.held_springs.len() {
            self.project_spring(self.springs[self.held_springs[k] as usize], h);
        }
        for k in 0..self.held_bends.len() {
            self.project_bend(self.bends[self.held_bends[k] as usize], h);
        }
    }

    /// Divides rows into those with an attached particle, whose impulses are counted, and batches of the others.
    pub(super) fn sort_rows(&mut self) {
        let Self { masses, springs, bends, forest, attachment_of, .. } = self;
        let is_free = |i: u32| attachment_of[i as usize] == u32::MAX;
        let free_spring = |&k: &u32| is_free(springs[k as usize].a) && is_free(springs[k as usize].b);
        let free_bend = |&k: &u32| bends[k as usize].particles.into_iter().all(is_free);
        let (batched, held): (Vec<u32>, _) = forest.projected().iter().partition(|k| free_spring(k));
        // In groups with trees, bends are part of the solve.
        let bent_later = if forest.has_trees() { 0 } else { bends.len() as u32 };
        let (batched_bends, held_bends): (Vec<u32>, _) = (0..bent_later).partition(free_bend);
        self.batches = Batches::new(
            masses,
            batched.iter().map(|&k| springs[k as usize]),
            batched_bends.iter().map(|&k| bends[k as usize]),
        );
        (self.held_springs, self.held_bends) = (held, held_bends);
        let springs = self.held_springs.iter().map(|&k| &self.springs[k as usize]);
        let bends = self.held_bends.iter().flat_map(|&k| self.bends[k as usize].particles);
        let tethers = self.tethers.iter().flat_map(|t| [t.particle, t.to]);
        let outside = springs.flat_map(|s| [s.a, s.b]).chain(bends).chain(tethers).collect();
        if !self.batches.is_empty() {
            let per_lane = self.batches.particles.len() - 1;
            self.eights = Eights::new(per_lane, &self.radii, &self.attachment_of, outside);
        }
    }

    fn project_batches(&mut self, h: f32) {
        if self.batches.is_empty() {
            return;
        }
        self.batches.put(&self.previous, &self.velocities, h);
        let mut touching = false;
        for &i in &self.solved {
            let i = i as usize;
            if self.backings[i] > 0.0 {
                self.batches.put_surface(i, self.press_normals[i], self.backings[i], self.rooms[i] * h);
                touching = true;
            }
        }
        dispatch::run(self.batches.project(h, touching));
        let per_second = 1.0 / h;
        let Self { positions, velocities, previous, attachment_of, .. } = self;
        self.batches.ways(|i, way| {
            if attachment_of[i] == u32::MAX {
                velocities[i] = way * per_second;
                positions[i] = previous[i] + way;
            }
        });
        for &i in self.solved.iter().filter(|_| touching) {
            let i = i as usize;
            if self.backings[i] > 0.0 {
                self.rooms[i] = self.batches.take_surface(i) * per_second;
            }
        }
    }

    /// Part of an impulse `along` the normal (N·s) that goes to the body that a particle touches, N·s.
    fn handed_on(&self, i: usize, along: f32) -> f32 {
        (min(self.rooms[i] + along, 0.0) - min(self.rooms[i], 0.0)) * self.backings[i]
    }

    /// Speed that a particle gains along `force` by an impulse of `force` times `impulse`, and its mobility after it,
    /// 1/kg: `∇Cᵀ W ∇C` if `force` is the gradient.
    fn moved(&self, i: usize, force: Vec3, impulse: f32) -> (f32, f32) {
        let along = force.dot(self.press_normals[i]);
        let after = self.rooms[i] + along * impulse;
        let presses = after < 0.0 || along < 0.0 && after <= 0.0;
        let backed = if presses { along * self.backings[i] } else { 0.0 };
        let (weight, square) = (self.weights[i], force.length_squared());
        (
            weight * (square * impulse - along * self.handed_on(i, along * impulse)),
            weight * (square - along * backed),
        )
    }

    /// Returns the impulse that gives a row a `speed`, and the mobility at that impulse, 1/kg. `ends` are particles
    /// with their forces per unit of the impulse. The method is that of `on_surfaces` in `project.rs`.
    pub(super) fn row_impulse(
        &self,
        ends: &(impl Iterator<Item = (usize, Vec3)> + Clone),
        speed: f32,
        compliance: f32,
    ) -> (f32, f32) {
        let (mut impulse, mut mobility) = (0.0, 0.0);
        for _ in 0..2 {
            let mut moved = 0.0;
            mobility = 0.0;
            for (i, force) in ends.clone() {
                let (by, gained) = self.moved(i, force, impulse);
                moved += by;
                mobility += gained;
            }
            if mobility <= 0.0 {
                break;
            }
            impulse += (speed - moved - compliance * impulse) / (mobility + compliance);
        }
        (impulse, mobility)
    }

    /// Applies an impulse as if it had acted since the start of the iteration.
    pub(super) fn nudge(&mut self, i: usize, impulse: Vec3, h: f32) {
        let normal = self.press_normals[i];
        let along = impulse.dot(normal);
        let handed_on = self.handed_on(i, along);
        self.rooms[i] += along;
        let change = (impulse - normal * handed_on) * self.weights[i];
        self.velocities[i] += change;
        self.positions[i] += change * h;
        self.reactions[i] += impulse;
    }

    fn project_tether(&mut self, tether: TetherDef, h: f32) {
        let (i, to) = (tether.particle as usize, tether.to as usize);
        let apart = self.positions[to] - self.positions[i];
        let length = apart.length();
        if length <= tether.length {
            return;
        }
        let direction = apart / length;
        let ends = [(i, direction), (to, -direction)];
        let speed = (length - tether.length) / h;
        let (mut impulse, _) = self.row_impulse(&ends.into_iter(), speed, 0.0);
        if self.backings[i] == 1.0 || self.backings[to] == 1.0 {
            // A particle on a fixed surface cannot pass through it: the tether pulls as if the surface did not exist,
            // not with the impulse that would overcome the surface.
            impulse = min(impulse, speed / (self.weights[i] + self.weights[to]));
        }
        if impulse > 0.0 {
            self.nudge(i, direction * impulse, h);
            self.nudge(to, direction * -impulse, h);
        }
    }

    fn project_spring(&mut self, s: SpringDef, h: f32) {
        let (a, b) = (s.a as usize, s.b as usize);
        let apart = self.positions[b] - self.positions[a];
        let length = apart.length();
        let stretch = length - s.rest_length;
        if length <= 1e-9 || s.resists == Resists::Stretch && stretch <= 0.0 {
            return;
        }
        let direction = apart / length;
        let pull = if stretch < 0.0 { -direction } else { direction };
        let compliance = 1.0 / (s.stiffness * h * h);
        let ends = [(a, pull), (b, -pull)];
        let (mut impulse, sum) = self.row_impulse(&ends.into_iter(), stretch.abs() / h, compliance);
        if impulse <= 0.0 {
            return;
        }
        // Damping of the axial speed that remains.
        let speed = (self.velocities[b] - self.velocities[a]).dot(pull) - impulse * sum;
        impulse += speed * h * s.damping / (1.0 + h * s.damping * sum);
        self.nudge(a, pull * impulse, h);
        self.nudge(b, pull * -impulse, h);
    }

    pub(super) fn project_bend(&mut self, bend: BendDef, h: f32) {
        let [a, b, c] = bend.particles.map(|i| i as usize);
        let bow = self.positions[a] - self.positions[b] * 2.0 + self.positions[c];
        let length = bow.length();
        if length <= 1e-9 {
            return;
        }
        let back = bow * (if bend.rest < length { -1.0 } else { 1.0 } / length);
        let compliance = 1.0 / (bend.stiffness * h * h);
        let ends = [(a, back), (b, back * -2.0), (c, back)];
        let speed = (bend.rest - length).abs() / h;
        let (impulse, _) = self.row_impulse(&ends.into_iter(), speed, compliance);
        if impulse > 0.0 {
            for (i, force) in ends {
                self.nudge(i, force * impulse, h);
            }
        }
    }

    /// Moves the particles of a closed surface along their area vectors, to correct its volume.
    fn project_volume(&mut self, volume: &VolumeDef, h: f32) {
        self.gradients.fill(Vec3::ZERO);
        let enclosed =
            enclosed_volume(&volume.triangles, &self.positions, |i, area| self.gradients[i] += area);
        let missing = volume.rest_volume - enclosed;
        let sign = if missing < 0.0 { -1.0 } else { 1.0 };
        let compliance = volume.rest_volume / (volume.bulk_modulus * h * h);
        let ends = self.gradients.iter().enumerate().map(|(i, &gradient)| (i, gradient * sign));
        let (impulse, _) = self.row_impulse(&ends, missing.abs() / h, compliance);
        if impulse <= 0.0 {
            return;
        }
        for i in 0..self.positions.len() {
            let along = self.gradients[i] * (sign * impulse);
            if along != Vec3::ZERO {
                self.nudge(i, along, h);
            }
        }
    }
}

/// Volume inside a closed surface, m³: sixths of `a·(b × c)`, relative to a point of the surface. `gradient` gets the
/// derivative of the volume at each corner of each triangle, m².
pub(super) fn enclosed_volume(
    triangles: &[[u32; 3]],
    positions: &[Vec3],
    mut gradient: impl FnMut(usize, Vec3),
) -> f32 {
    let Some(first) = triangles.first() else { return 0.0 };
    let origin = positions[first[0] as usize];
    let mut volume = 0.0;
    for triangle in triangles {
        let corners = triangle.map(|i| i as usize);
        let [a, b, c] = corners.map(|i| positions[i] - origin);
        let areas = [b.cross(c), c.cross(a), a.cross(b)];
        volume += a.dot(areas[0]) / 6.0;
        for (corner, area) in corners.into_iter().zip(areas) {
            gradient(corner, area / 6.0);
        }
    }
    volume
}

/// Length of a spring minus its rest length, metres; 0 if it is slack.
pub(super) fn stretch(s: &SpringDef, positions: &[Vec3]) -> f32 {
    let stretch = (positions[s.b as usize] - positions[s.a as usize]).length() - s.rest_length;
    match s.resists {
        Resists::Both => stretch,
        Resists::Stretch => max(stretch, 0.0),
    }
}
