//! Particles and springs: ropes, strands, cloth, blobs.
//!
//! [`ParticleGroup::substep`] moves a group under gravity, springs, attachments and contacts, after the bodies have
//! moved. It acts back on the bodies that particles are attached to and on those they touch.
//!
//! Springs that form no loops (a mass on a spring, a rope, a strand of hair) are solved in one implicit step, see
//! `forest.rs`: the stretch at rest is the exact one, `m g / k`, for a chain as for a single mass, whatever the
//! substeps. A spring that closes a loop is projected once per substep instead, with compliance `1/k` and no
//! accumulated multiplier: exact at rest for one mass on one spring, softer by `h² (w₁ + w₂)` per particle in a net.
//! Damping acts on the velocity at the start of the substep, before forces.
//!
//! Contacts that are there before the substep are part of the spring solve, or a rope bent over an edge would hang
//! with the wrong tension (`contact.rs`). Impacts and what is left are dealt with after it (`impact.rs`).

mod contact;
mod def;
mod forest;
mod impact;
mod snapshot;

pub use contact::{BodyImpulse, Obstacle, ObstacleBody};
pub use def::{AttachmentDef, AttachmentTarget, GroupDef, ParticleDef, RopeDef, SpringDef};

use crate::boxes::Aabb;
use crate::shape::{Filter, Material};
use contact::{Grip, Touch};
use forest::{Forest, Freedom, System};
use impact::MAX_TOUCHES;
use sinew_math::{Sym3, Vec3};

/// The point that holds an attached particle, in one substep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Anchor {
    /// World, metres.
    pub position: Vec3,
    /// m/s, at the start of the substep, forces on the body included.
    pub velocity: Vec3,
    /// How the point yields, 1/kg: velocity gained per impulse at the point, `I/m − [r]× J⁻¹ [r]×`. Zero if nothing
    /// moves it.
    pub inverse_mass: Sym3,
}

/// Particles and springs at run time. One array per quantity, by index of the particle.
#[derive(Clone, Debug, Default)]
pub struct ParticleGroup {
    positions: Vec<Vec3>,
    velocities: Vec<Vec3>,
    masses: Vec<f32>,
    radii: Vec<f32>,
    springs: Vec<SpringDef>,
    attachments: Vec<AttachmentDef>,
    material: Material,
    linear_damping: f32,
    gravity_scale: f32,
    filter: Filter,
    /// How surfaces hold the particles.
    grips: Vec<Grip>,
    /// Impulse of a surface on each particle in the last solve.
    contact_impulses: Vec<Vec3>,

    /// Where each particle was before the last step, for drawing.
    drawn_from: Vec<Vec3>,

    forest: Forest,
    system: System,
    /// Where each particle was before the substep.
    previous: Vec<Vec3>,
    /// Attachment of each particle, or `u32::MAX`.
    attachment_of: Vec<u32>,
    attachment_impulses: Vec<Vec3>,
    body_impulses: Vec<BodyImpulse>,
    /// Impulse of the springs on each particle in this substep.
    reactions: Vec<Vec3>,
    /// What each particle touches in this substep.
    touches: Vec<Option<Touch>>,
    /// Mass of the particles that touch each body.
    loads: Vec<f32>,
    /// Forces of fields on each particle in the substep to come, N; none without fields.
    outer: Vec<Vec3>,
    /// Gravity and outer force of the last substep on each particle, over its mass, m/s².
    accelerations: Vec<Vec3>,
}

impl ParticleGroup {
    /// From its definition.
    ///
    /// # Panics
    /// If [`GroupDef::check`] finds something wrong.
    pub fn new(def: &GroupDef) -> Self {
        if let Err(what) = def.check() {
            panic!("{what}");
        }
        let count = def.particles.len();
        let mut group = Self {
            positions: def.particles.iter().map(|p| p.position).collect(),
            velocities: def.particles.iter().map(|p| p.velocity).collect(),
            masses: def.particles.iter().map(|p| p.mass).collect(),
            radii: def.particles.iter().map(|p| p.radius).collect(),
            springs: def.springs.clone(),
            attachments: def.attachments.clone(),
            material: def.material,
            linear_damping: def.linear_damping,
            gravity_scale: def.gravity_scale,
            filter: def.filter,
            grips: vec![Grip::Off; count],
            contact_impulses: vec![Vec3::ZERO; count],
            drawn_from: Vec::new(),
            forest: Forest::default(),
            system: System::default(),
            previous: Vec::new(),
            attachment_of: Vec::new(),
            attachment_impulses: Vec::new(),
            body_impulses: Vec::new(),
            reactions: Vec::new(),
            touches: Vec::new(),
            loads: Vec::new(),
            outer: Vec::new(),
            accelerations: Vec::new(),
        };
        group.derive();
        group
    }

    /// Everything that follows from particles, springs and attachments.
    fn derive(&mut self) {
        let count = self.positions.len();
        self.attachment_of = vec![u32::MAX; count];
        let mut held_in_world = vec![false; count];
        for (index, a) in self.attachments.iter().enumerate() {
            self.attachment_of[a.particle as usize] = index as u32;
            held_in_world[a.particle as usize] = matches!(a.target, AttachmentTarget::World(_));
        }
        self.forest = Forest::new(count, &self.springs, &held_in_world);
        self.system = System::new(count, self.springs.len());
        self.previous = self.positions.clone();
        self.drawn_from = self.positions.clone();
        self.attachment_impulses = vec![Vec3::ZERO; self.attachments.len()];
        self.touches = vec![None; count];
        self.body_impulses = Vec::with_capacity(MAX_TOUCHES * count);
        self.reactions = vec![Vec3::ZERO; count];
    }

    /// World, metres.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Positions between the last step (`alpha` 0) and this one (1), for drawing; see [`Update`](crate::Update).
    pub fn interpolated(&self, alpha: f32) -> impl Iterator<Item = Vec3> {
        let steps = self.drawn_from.iter().zip(&self.positions);
        steps.map(move |(&from, &to)| from * (1.0 - alpha) + to * alpha)
    }

    /// Where particles are is from now on where they were before the step.
    pub(crate) fn begin_step(&mut self) {
        self.drawn_from.copy_from_slice(&self.positions);
    }

    /// m/s.
    pub fn velocities(&self) -> &[Vec3] {
        &self.velocities
    }

    /// kg.
    pub fn masses(&self) -> &[f32] {
        &self.masses
    }

    /// Metres.
    pub fn radii(&self) -> &[f32] {
        &self.radii
    }

    /// As they were defined.
    pub fn springs(&self) -> &[SpringDef] {
        &self.springs
    }

    /// As they were defined; [`substep`](Self::substep) takes one [`Anchor`] for each.
    pub fn attachments(&self) -> &[AttachmentDef] {
        &self.attachments
    }

    /// Factor on the world's gravity.
    pub fn gravity_scale(&self) -> f32 {
        self.gravity_scale
    }

    /// Which shapes it meets.
    pub fn filter(&self) -> Filter {
        self.filter
    }

    /// Around all particles, with their radii, and where they were before the last substep. Empty, with infinite
    /// corners the wrong way round, for a group without particles.
    pub fn bounds(&self) -> Aabb {
        let mut bounds = Aabb { min: Vec3::splat(f32::INFINITY), max: Vec3::splat(f32::NEG_INFINITY) };
        for i in 0..self.positions.len() {
            for center in [self.positions[i], self.previous[i]] {
                bounds = bounds.merge(&Aabb::reaching(center, Vec3::splat(self.radii[i])));
            }
        }
        bounds
    }

    /// Impulse (N·s, world) of each attachment on what holds it, in the last substep.
    pub fn attachment_impulses(&self) -> &[Vec3] {
        &self.attachment_impulses
    }

    /// Impulses on bodies that particles touched in the last substep, in order of particles.
    pub fn body_impulses(&self) -> &[BodyImpulse] {
        &self.body_impulses
    }

    /// Forces on the particles, one for each or none at all, that the next substep feels and uses up, N, world.
    pub(crate) fn outer_forces(&mut self) -> &mut Vec<Vec3> {
        &mut self.outer
    }

    /// Changes a particle's velocity by an impulse (N·s, world).
    ///
    /// # Panics
    /// If there is no such particle, or the impulse is not finite.
    pub fn apply_impulse(&mut self, particle: u32, impulse: Vec3) {
        assert!(impulse.is_finite(), "an impulse is finite");
        let i = particle as usize;
        self.velocities[i] += impulse / self.masses[i];
    }

    /// Moves a particle by `by` (m, world), with the velocity that takes it there within `h` seconds.
    ///
    /// # Panics
    /// If there is no such particle, or a number is not finite.
    pub fn correct(&mut self, particle: u32, by: Vec3, h: f32) {
        let velocity = by / h;
        assert!(by.is_finite() && h.is_finite() && velocity.is_finite(), "a particle's way is finite");
        self.positions[particle as usize] += by;
        self.velocities[particle as usize] += velocity;
    }

    /// Moves the group by `h` seconds under `gravity` (m/s²), its springs, its attachments and its contacts.
    ///
    /// `anchors[k]` holds attachment `k`. Anchors that are bodies yield to the springs within the same solve, so that
    /// a stiff rope does not shake a light body; each such point is solved as if it were the body's only one. What
    /// the body gains is in [`attachment_impulses`](Self::attachment_impulses), for the caller to apply.
    ///
    /// `obstacles` and `bodies` are at the end of the substep; every particle is tried against every obstacle, so
    /// pass those that come near [`bounds`](Self::bounds). Bodies are pushed back: their velocities change at once,
    /// and [`body_impulses`](Self::body_impulses) lists how. Attached particles touch nothing.
    ///
    /// # Panics
    /// If there is not one anchor for each attachment, or an obstacle's body is not in `bodies`.
    pub fn substep(
        &mut self,
        h: f32,
        gravity: Vec3,
        anchors: &[Anchor],
        obstacles: &[Obstacle],
        bodies: &mut [ObstacleBody],
    ) {
        assert_eq!(anchors.len(), self.attachments.len(), "each attachment needs its anchor");
        let gravity = gravity * self.gravity_scale;
        self.accelerations.clear();
        self.accelerations.resize(self.positions.len(), gravity);
        for ((sum, force), mass) in self.accelerations.iter_mut().zip(self.outer.drain(..)).zip(&self.masses)
        {
            *sum += force / *mass;
        }
        self.body_impulses.clear();
        self.begin(h);
        self.hold(h, anchors);
        self.find_contacts(h, obstacles, bodies);
        self.solve_with_contacts(h, bodies);
        self.push_bodies(bodies);
        for i in 0..self.positions.len() {
            self.positions[i] += self.velocities[i] * h;
        }
        self.project_loops(h);
        self.collect_attachment_impulses(h, anchors);
        self.stop_impacts(h, obstacles, bodies);
    }

    /// Puts attached particles where their anchors are.
    fn hold(&mut self, h: f32, anchors: &[Anchor]) {
        for (a, anchor) in self.attachments.iter().zip(anchors) {
            let i = a.particle as usize;
            let mass = anchor.inverse_mass.inverse();
            self.positions[i] = anchor.position;
            self.previous[i] = anchor.position;
            self.velocities[i] = anchor.velocity;
            if mass == Sym3::ZERO {
                self.system.freedom[i] = Freedom::Fixed;
            }
            self.system.inertia[i] += mass;
            self.system.momentum[i] =
                mass * anchor.velocity + (anchor.velocity + self.accelerations[i] * h) * self.masses[i];
        }
    }

    /// Damping, and what each particle brings into the system.
    fn begin(&mut self, h: f32) {
        let damping = 1.0 / (1.0 + h * self.linear_damping);
        for i in 0..self.positions.len() {
            let mass = self.masses[i];
            self.previous[i] = self.positions[i];
            self.velocities[i] *= damping;
            self.system.freedom[i] = Freedom::Free;
            self.system.inertia[i] = Sym3::from_diagonal(Vec3::splat(mass));
            self.system.momentum[i] = (self.velocities[i] + self.accelerations[i] * h) * mass;
        }
    }

    /// Springs that close a loop, each once: `Δx = −C / (w₁ + w₂ + α/h²) ∇C` with `α = 1/k` (Macklin et al., "Small
    /// Steps in Physics Simulation", SCA 2019, without its multiplier), then damping of the axial speed.
    fn project_loops(&mut self, h: f32) {
        for &index in self.forest.loops() {
            let s = &self.springs[index as usize];
            let (a, b) = (s.a as usize, s.b as usize);
            let weight =
                |i: usize| if self.system.freedom[i] == Freedom::Fixed { 0.0 } else { 1.0 / self.masses[i] };
            let (wa, wb) = (weight(a), weight(b));
            let (apart, sum) = (self.positions[b] - self.positions[a], wa + wb);
            let length = apart.length();
            if length <= 1e-9 || sum == 0.0 {
                continue;
            }
            let direction = apart / length;
            let compliance = 1.0 / (s.stiffness * h * h);
            let mut impulse = (length - s.rest_length) / (sum + compliance) / h;
            let speed = (self.velocities[b] - self.velocities[a]).dot(direction) - impulse * sum;
            impulse += speed * h * s.damping / (1.0 + h * s.damping * sum);
            let (to_a, to_b) = (direction * (impulse * wa), direction * (-impulse * wb));
            self.velocities[a] += to_a;
            self.velocities[b] += to_b;
            self.positions[a] += to_a * h;
            self.positions[b] += to_b * h;
            self.reactions[a] += direction * impulse;
            self.reactions[b] -= direction * impulse;
        }
    }

    fn collect_attachment_impulses(&mut self, h: f32, anchors: &[Anchor]) {
        for (k, (a, anchor)) in self.attachments.iter().zip(anchors).enumerate() {
            let i = a.particle as usize;
            self.attachment_impulses[k] = if self.system.freedom[i] == Freedom::Fixed {
                self.reactions[i] + self.accelerations[i] * (self.masses[i] * h)
            } else {
                anchor.inverse_mass.inverse() * (self.velocities[i] - anchor.velocity)
            };
        }
    }
}
