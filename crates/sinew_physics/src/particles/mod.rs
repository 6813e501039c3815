//! Particles and springs: ropes, strands, cloth, blobs.
//!
//! [`ParticleGroup::substep`] moves a group under gravity, springs, attachments and contacts, after the bodies have
//! moved. It applies the reactions to the bodies that particles are attached to or touch.
//!
//! Springs of an implicit group (ropes, strands, bridges, load-bearing nets) are solved together, see `system.rs`: the
//! stretch at rest is exact, `m g / k`, for a chain as for a single mass, for any number of substeps. Springs of cloth
//! and blobs are projected, each once, see `net.rs`: exact at rest for one mass on one spring, softer by `h² (w₁ + w₂)`
//! per spring in a net. Damping acts on the velocity at the start of the substep, before forces.
//!
//! Contacts are part of the spring solve (`contact.rs`). Otherwise a rope bent over an edge would have the wrong
//! tension, and a rope that hits the floor would be compressed by the depth that its end would have sunk. Bounces and
//! remaining contacts follow (`impact.rs`).

mod added_mass;
mod around;
mod attach;
mod batches;
mod builders;
mod check;
mod conjugate;
mod contact;
mod def;
mod eights;
mod elastic;
mod elimination;
mod faces;
mod forest;
mod geodesic;
mod hub;
mod impact;
mod in_eights;
mod load;
mod near;
mod net;
mod pinched;
mod project;
mod rest;
mod self_collision;
mod snapshot;
mod spread;
mod sweep;
mod system;
mod tuning;

pub(crate) use added_mass::AddedMass;
pub use attach::Anchor;
pub use builders::{Blob, BlobDef, Cloth, ClothDef, Rope, RopeDef, StrandDef};
pub(crate) use contact::distance_at_least;
pub use contact::{BodyImpulse, Obstacle, ObstacleBody};
pub use def::{
    AttachmentDef, AttachmentTarget, BackstopDef, BendDef, GroupDef, ParticleDef, Resists, SpringDef,
    SpringScheme, TetherDef, VolumeDef,
};
pub(crate) use pinched::{Pinched, is_nipped};

use crate::arena::Item;
use crate::body::def::Sleeping;
use crate::body::material::Material;
use crate::body::shape::{Filter, Shape};
use crate::body::surface::Surface;
use crate::boxes::Aabb;
use crate::id::{BodyId, GroupId};
use crate::particles::tuning::STRIKE_GAP;
use around::{Around, NOTHING};
use batches::Batches;
use contact::{Grip, Placed, Touch};
use eights::Eights;
use faces::Faces;
use forest::{Forest, Holder};
use impact::MAX_TOUCHES;
use near::Near;
use rest::{GroupRest, SleepSupport};
use self_collision::SelfCollision;
use sinew_math::{Sym3, Transform, Vec3, dispatch, max};
use system::{Freedom, System};

/// Largest number of sphere-tracing steps along a particle's path.
const STRIDES: usize = 16;

/// Particles and springs in a world. One array per quantity, by index of the particle.
#[derive(Clone, Debug, Default)]
pub struct ParticleGroup {
    positions: Vec<Vec3>,
    velocities: Vec<Vec3>,
    masses: Vec<f32>,
    radii: Vec<f32>,
    /// Radius of all particles, metres, if it is the same for all.
    common_radius: Option<f32>,
    springs: Vec<SpringDef>,
    bends: Vec<BendDef>,
    tethers: Vec<TetherDef>,
    volumes: Vec<VolumeDef>,
    faces: Faces,
    attachments: Vec<AttachmentDef>,
    backstops: Vec<BackstopDef>,
    scheme: SpringScheme,
    iterations: u32,
    material: Material,
    linear_damping: f32,
    gravity_scale: f32,
    filter: Filter,
    /// Bodies that the group never collides with, ascending.
    passes: Vec<BodyId>,
    /// Grip of a surface on each particle.
    grips: Vec<Grip>,
    /// Length of the last iteration, seconds; 0 before the first.
    span: f32,
    /// Impulse of a surface on each particle in the last solve, N·s.
    contact_impulses: Vec<Vec3>,

    /// Position of each particle before the last step, world, metres, for drawing.
    drawn_from: Vec<Vec3>,
    sleeping: Sleeping,
    rest: GroupRest,
    /// Position of each particle at the start of its time at rest, world, metres.
    places: Vec<Vec3>,
    /// Surroundings of the group while it sleeps, or slept until it was woken since the last step.
    sleep_support: Option<SleepSupport>,

    forest: Forest,
    system: System,
    /// Position of each particle before the iteration, world, metres.
    previous: Vec<Vec3>,
    /// Inverse mass of each particle in projections, 1/kg: 0 for particles attached to an immovable anchor.
    weights: Vec<f32>,
    /// Damped velocity of each particle at the start of the iteration, m/s.
    begun: Vec<Vec3>,
    /// Bodies with the velocity changes by the particles in the iterations so far.
    holders: Vec<ObstacleBody>,
    /// Added mass of each body that particles are attached to.
    added: Vec<AddedMass>,
    /// Gradient of a volume by each particle's position, m².
    gradients: Vec<Vec3>,
    /// Start and end poses of the obstacles in the iteration.
    placed: Vec<Placed>,
    /// Shapes near each particle.
    near: Near,
    /// Attachment of each particle, or `u32::MAX`.
    attachment_of: Vec<u32>,
    attachment_impulses: Vec<Vec3>,
    body_impulses: Vec<BodyImpulse>,
    /// Impulse of springs, bends, tethers and volumes on each particle in this iteration, N·s.
    reactions: Vec<Vec3>,
    /// Impulse of bends on each particle included in this iteration's solve, N·s.
    bend_impulses: Vec<Vec3>,
    /// Self-collision pairs, if the group has a thickness.
    self_collision: Option<SelfCollision>,
    /// Particles that are attached or near a shape in this iteration.
    close: Vec<u32>,
    /// Particles that this iteration solves.
    solved: Vec<u32>,
    /// Particles whose contacts still change between solves.
    unsettled: Vec<u32>,
    /// Surface that each particle touches in this iteration.
    touches: Vec<Option<Touch>>,
    /// Lower bound of the distance to any shape at the start of the iteration, minus the shape's motion, metres.
    clearances: Vec<f32>,
    /// Contact search distance of each particle from its surface in this iteration, metres.
    sights: Vec<f32>,
    /// Share of a particle's impulse toward its surface that goes to the body: `M / (m + M)`, with `m` the particle's
    /// mass and `M` its share of the body's inertia.
    backings: Vec<f32>,
    /// Rows of the net without attached particles.
    batches: Batches,
    /// Lane data, and the particles in lanes.
    eights: Eights,
    /// Projected springs with an attached particle.
    held_springs: Vec<u32>,
    /// Bends with an attached particle.
    held_bends: Vec<u32>,
    /// Unit normal of each particle's surface, outward.
    press_normals: Vec<Vec3>,
    /// Impulse toward the surface that brings each particle onto it, N·s; negative if the particle already presses.
    rooms: Vec<f32>,
    /// Contacts of shapes through the group's particles.
    pub(crate) pinched: Pinched,
    /// Displacements that move particles into the corner of two surfaces, divided by the iteration, m/s.
    wedges: Vec<Vec3>,
    /// Mass of the particles on each body, kg.
    loads: Vec<f32>,
    /// Forces of fields on each particle in the coming substep, N; empty without fields.
    outer: Vec<Vec3>,
    /// Acceleration of each particle by gravity and external forces in the last substep, m/s².
    accelerations: Vec<Vec3>,
    /// Magnitude of each particle's acceleration, m/s².
    pulls: Vec<f32>,
    /// Bits of the acceleration of all particles, m/s², if they have the same.
    common_acceleration: Option<[u32; 3]>,
}

impl Item for ParticleGroup {
    type Id = GroupId;
}

impl ParticleGroup {
    /// Creates a group from its definition.
    ///
    /// # Panics
    /// If [`GroupDef::check`] rejects it.
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
            bends: def.bends.clone(),
            tethers: def.tethers.clone(),
            volumes: def.volumes.clone(),
            faces: Faces::new(&def.faces, count),
            scheme: def.scheme,
            iterations: def.iterations,
            attachments: def.attachments.clone(),
            backstops: def.backstops.clone(),
            material: def.material,
            linear_damping: def.linear_damping,
            gravity_scale: def.gravity_scale,
            filter: def.filter,
            sleeping: def.sleeping,
            grips: vec![Grip::Off; count],
            contact_impulses: vec![Vec3::ZERO; count],
            ..Self::default()
        };
        group.passes.clone_from(&def.passes);
        group.passes.sort_unstable();
        group.self_collision =
            (def.thickness > 0.0).then(|| SelfCollision::new(count, def.thickness, &group.springs));
        group.derive();
        group
    }

    /// Computes all data that follow from particles, springs and attachments.
    fn derive(&mut self) {
        let count = self.positions.len();
        self.common_radius =
            self.radii.first().copied().filter(|first| self.radii.iter().all(|r| r == first));
        self.attachment_of = vec![u32::MAX; count];
        let mut holders = vec![Holder::Nothing; count];
        for (index, a) in self.attachments.iter().enumerate() {
            self.attachment_of[a.particle as usize] = index as u32;
            holders[a.particle as usize] = match a.target {
                AttachmentTarget::World(_) => Holder::World,
                AttachmentTarget::Body { body, .. } => Holder::Body(body),
            };
        }
        self.forest = match self.scheme {
            SpringScheme::Implicit => Forest::new(&self.springs, &holders),
            SpringScheme::Projected => Forest::without_trees(&self.springs, &holders),
        };
        self.system = System::new(count, self.springs.len(), self.forest.hubs().len());
        self.added = vec![AddedMass::default(); self.forest.hubs().len()];
        self.previous = self.positions.clone();
        self.drawn_from = self.positions.clone();
        self.places = self.positions.clone();
        self.attachment_impulses = vec![Vec3::ZERO; self.attachments.len()];
        self.weights = self.masses.iter().map(|mass| 1.0 / mass).collect();
        self.accelerations = vec![Vec3::ZERO; count];
        self.pulls = vec![0.0; count];
        self.common_acceleration = Some([0; 3]);
        self.begun = vec![Vec3::ZERO; count];
        self.gradients = vec![Vec3::ZERO; count];
        self.touches = vec![None; count];
        self.close = Vec::with_capacity(count);
        self.solved = Vec::with_capacity(count);
        self.unsettled = Vec::with_capacity(count);
        self.clearances = vec![0.0; count];
        self.sights = vec![0.0; count];
        self.near = Near::new(count, &self.backstops);
        self.backings = vec![0.0; count];
        self.press_normals = vec![Vec3::ZERO; count];
        self.rooms = vec![0.0; count];
        self.wedges = vec![Vec3::ZERO; count];
        self.body_impulses = Vec::with_capacity(MAX_TOUCHES * count * self.iterations as usize);
        self.pinched.loads = vec![0.0; count];
        self.reactions = vec![Vec3::ZERO; count];
        self.bend_impulses = vec![Vec3::ZERO; count];
        self.sort_rows();
    }

    /// Positions of the particles, world, metres.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Positions between the previous step (`alpha` 0) and this one (1), world, metres, for drawing; see
    /// [`Update`](crate::Update).
    pub fn interpolated(&self, alpha: f32) -> impl Iterator<Item = Vec3> {
        let steps = self.drawn_from.iter().zip(&self.positions);
        steps.map(move |(&from, &to)| from * (1.0 - alpha) + to * alpha)
    }

    /// Stops particles whose state became non-finite in the step at their positions before the step, and sets
    /// non-finite contact impulses to zero. Returns true if there were such particles.
    pub(crate) fn roll_back(&mut self) -> bool {
        // A fold without early exit tests eight at a time.
        let finite = |vectors: &[Vec3]| vectors.iter().fold(true, |all, v| all & v.is_finite());
        if !finite(&self.contact_impulses) {
            self.contact_impulses.iter_mut().filter(|v| !v.is_finite()).for_each(|v| *v = Vec3::ZERO);
        }
        if finite(&self.positions) & finite(&self.velocities) {
            return false;
        }
        let mut any = false;
        for i in 0..self.positions.len() {
            if !(self.positions[i].is_finite() && self.velocities[i].is_finite()) {
                (self.positions[i], self.previous[i]) = (self.drawn_from[i], self.drawn_from[i]);
                self.velocities[i] = Vec3::ZERO;
                self.contact_impulses[i] = Vec3::ZERO;
                any = true;
            }
        }
        any
    }

    /// Stores the current positions as the previous ones, for drawing.
    pub(crate) fn begin_step(&mut self) {
        self.drawn_from.copy_from_slice(&self.positions);
        // The user may change shapes between steps.
        self.near.forget_distances();
    }

    /// Velocities of the particles, m/s.
    pub fn velocities(&self) -> &[Vec3] {
        &self.velocities
    }

    /// Masses of the particles, kg.
    pub fn masses(&self) -> &[f32] {
        &self.masses
    }

    /// Radii of the particles, metres.
    pub fn radii(&self) -> &[f32] {
        &self.radii
    }

    /// Springs, as in the group's definition.
    pub fn springs(&self) -> &[SpringDef] {
        &self.springs
    }

    /// Bends, as in the group's definition.
    pub fn bends(&self) -> &[BendDef] {
        &self.bends
    }

    /// Tethers, as in the group's definition.
    pub fn tethers(&self) -> &[TetherDef] {
        &self.tethers
    }

    /// Volumes, as in the group's definition.
    pub fn volumes(&self) -> &[VolumeDef] {
        &self.volumes
    }

    /// Faces, as in the group's definition.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces.list
    }

    /// True if a particle is a corner of a face.
    pub(crate) fn has_faces(&self, particle: usize) -> bool {
        self.faces.has(particle)
    }

    /// Third of the vector area of each face that a particle is a corner of, m².
    pub(crate) fn face_parts(&self, particle: usize) -> impl Iterator<Item = Vec3> + '_ {
        self.faces.parts(&self.positions, particle)
    }

    /// Attachments of the definition; [`substep`](Self::substep) takes one [`Anchor`] for each.
    pub fn attachments(&self) -> &[AttachmentDef] {
        &self.attachments
    }

    /// Backstops of the definition; [`substep`](Self::substep) takes one [`Obstacle`] for each.
    pub fn backstops(&self) -> &[BackstopDef] {
        &self.backstops
    }

    /// Factor on the world's gravity.
    pub fn gravity_scale(&self) -> f32 {
        self.gravity_scale
    }

    /// Collision filter of the group.
    pub fn filter(&self) -> Filter {
        self.filter
    }

    /// Material of the particles.
    pub(crate) fn material(&self) -> Material {
        self.material
    }

    /// Bodies that the group never collides with, ascending.
    pub fn passes(&self) -> &[BodyId] {
        &self.passes
    }

    /// True if the group collides with a shape that has this surface and belongs to this body.
    pub(crate) fn meets(&self, body: BodyId, surface: &Surface) -> bool {
        surface.is_wall_to(self.filter) && self.passes.binary_search(&body).is_err()
    }

    /// Bounds of all particles with their radii. For a group without particles, `min` is infinite and `max` negative
    /// infinite.
    pub fn bounds(&self) -> Aabb {
        self.bounds_of(&self.positions)
    }

    /// Bounds of balls with the particles' radii at these positions.
    fn bounds_of(&self, centers: &[Vec3]) -> Aabb {
        if let Some(radius) = self.common_radius {
            return dispatch::run(Around(centers)).expand(radius);
        }
        let balls = centers.iter().zip(&self.radii);
        let around = |(&center, &radius): (&Vec3, &f32)| Aabb::reaching(center, Vec3::splat(radius));
        balls.fold(NOTHING, |bounds, ball| bounds.merge(&around(ball)))
    }

    /// Largest speed of a particle, m/s.
    pub(crate) fn fastest(&self) -> f32 {
        self.velocities.iter().fold(0.0, |most, v| max(most, v.length_squared())).sqrt()
    }

    /// Bounds of all shapes for which [`strikes`](Self::strikes) may be true, given the largest speed of a particle
    /// (m/s).
    pub(crate) fn strike_bounds(&self, fastest: f32, dt: f32) -> Aabb {
        self.bounds().expand(fastest * dt + STRIKE_GAP + STRIKE_GAP)
    }

    /// True if a particle reaches a static shape within `dt` seconds with a normal speed above `speed` (m/s).
    pub(crate) fn strikes(&self, shape: &Shape, at: &Transform, speed: f32, dt: f32) -> bool {
        let mut particles = self.positions.iter().zip(&self.velocities).zip(&self.radii);
        particles.any(|((&position, &velocity), radius)| {
            let whole = velocity.length();
            if whole <= speed {
                return false;
            }
            let mut way = 0.0;
            // Moves as far as the particle certainly touches nothing, repeatedly (Hart, "Sphere Tracing", 1996).
            for _ in 0..STRIDES {
                let (distance, outward) = shape.signed_distance(at, position + velocity * (way / whole));
                let gap = distance - radius;
                if gap < STRIKE_GAP {
                    return velocity.dot(outward) < -speed;
                }
                way += gap;
                // The last step may be longer than the remaining path.
                if way > whole * dt {
                    return false;
                }
            }
            false
        })
    }

    /// Impulse of each attachment on the body or point that it is attached to, in the last substep, N·s, world.
    pub fn attachment_impulses(&self) -> &[Vec3] {
        &self.attachment_impulses
    }

    /// Impulses on bodies that particles touched in the last substep, in order of particles. Static and kinematic
    /// bodies are included only if they move.
    pub fn body_impulses(&self) -> &[BodyImpulse] {
        &self.body_impulses
    }

    /// Forces on the particles in the next substep, N, world: one per particle, or empty. The substep clears them.
    pub(crate) fn outer_forces(&mut self) -> &mut Vec<Vec3> {
        &mut self.outer
    }

    /// Changes a particle's velocity by an impulse (N·s, world).
    ///
    /// # Panics
    /// If the particle does not exist, or the impulse or the result is not finite.
    pub fn apply_impulse(&mut self, particle: u32, impulse: Vec3) {
        assert!(impulse.is_finite(), "an impulse must be finite, not {impulse:?}");
        let i = particle as usize;
        let velocity = self.velocities[i] + impulse / self.masses[i];
        assert!(velocity.is_finite(), "an impulse makes a finite velocity, not {velocity:?}");
        self.velocities[i] = velocity;
        self.wake();
    }

    /// Sets the velocity of a particle, m/s, world. An attached particle keeps the velocity of its anchor.
    ///
    /// # Panics
    /// If the particle does not exist, or the velocity is not finite.
    pub fn set_velocity(&mut self, particle: u32, velocity: Vec3) {
        assert!(velocity.is_finite(), "a velocity must be finite, not {velocity:?}");
        self.velocities[particle as usize] = velocity;
        self.wake();
    }

    /// Teleports a particle to `position` (world, metres) without a sweep.
    ///
    /// # Panics
    /// If the particle does not exist, or the position is not finite.
    pub fn set_position(&mut self, particle: u32, position: Vec3) {
        assert!(position.is_finite(), "a position must be finite, not {position:?}");
        self.positions[particle as usize] = position;
        self.previous[particle as usize] = position;
        self.wake();
    }

    /// Moves a particle by `by` (m, world), and adds the velocity of that motion within `h` seconds.
    ///
    /// # Panics
    /// If the particle does not exist, or a number is not finite.
    pub fn correct(&mut self, particle: u32, by: Vec3, h: f32) {
        let velocity = by / h;
        assert!(
            by.is_finite() && h.is_finite() && velocity.is_finite(),
            "a particle's way must be finite, not {by:?} and {h:?} and {velocity:?}"
        );
        self.positions[particle as usize] += by;
        self.velocities[particle as usize] += velocity;
        self.wake();
    }

    /// Moves a pin: the world position (metres) of attachment `index`.
    ///
    /// # Panics
    /// If the attachment does not exist or is to a body, or the position is not finite.
    pub fn move_pin(&mut self, index: usize, to: Vec3) {
        assert!(to.is_finite(), "a place must be finite, not {to:?}");
        let AttachmentTarget::World(place) = &mut self.attachments[index].target else {
            panic!("attachment {index} is to a place in the world");
        };
        *place = to;
        self.wake();
    }

    /// Moves the group by `h` seconds under `gravity` (m/s²), its springs, its attachments and its contacts.
    ///
    /// `anchors[k]` is the anchor of attachment `k`. Anchors on bodies react within the same solve, as whole bodies, so
    /// that a stiff rope does not shake a light body. [`attachment_impulses`](Self::attachment_impulses) returns the
    /// impulses on the bodies, for the caller to apply.
    ///
    /// `obstacles` and `bodies` are at the end of the substep; pass those near [`bounds`](Self::bounds). Nearby
    /// obstacles of each particle are cached between substeps, so pass them in the same order. The last ones are the
    /// balls of [`backstops`](Self::backstops), in their order. Particles push bodies: the call changes the velocities
    /// in `bodies`, and [`body_impulses`](Self::body_impulses) lists the impulses. Attached particles touch nothing.
    /// Particles between two shapes do not keep these apart: a [`World`](crate::World) has contacts for that.
    ///
    /// # Panics
    /// If there is not one anchor per attachment, there are fewer obstacles than backstops, or the body of an anchor or
    /// an obstacle is not in `bodies`.
    pub fn substep(
        &mut self,
        h: f32,
        gravity: Vec3,
        anchors: &[Anchor],
        obstacles: &[Obstacle],
        bodies: &mut [ObstacleBody],
    ) {
        self.begin_substep(h, gravity, anchors, obstacles, bodies);
        self.end_substep(h, anchors, obstacles, bodies);
    }

    /// First half of a substep, up to the solve of springs and contacts in its first iteration. Pushes no body yet.
    pub(crate) fn begin_substep(
        &mut self,
        h: f32,
        gravity: Vec3,
        anchors: &[Anchor],
        obstacles: &[Obstacle],
        bodies: &[ObstacleBody],
    ) {
        assert_eq!(anchors.len(), self.attachments.len(), "each attachment needs its anchor");
        assert!(obstacles.len() >= self.backstops.len(), "each backstop needs its ball");
        let gravity = gravity * self.gravity_scale;
        // Compares bits, because zeros have a sign that differs between restored and computed zeros.
        let bits = gravity.to_array().map(f32::to_bits);
        if self.common_acceleration != Some(bits) {
            self.accelerations.fill(gravity);
            self.pulls.fill(gravity.length());
        }
        self.common_acceleration = self.outer.is_empty().then_some(bits);
        for (i, force) in self.outer.drain(..).enumerate() {
            self.accelerations[i] += force / self.masses[i];
            self.pulls[i] = self.accelerations[i].length();
        }
        self.body_impulses.clear();
        self.attachment_impulses.fill(Vec3::ZERO);
        self.holders.clear();
        self.holders.extend_from_slice(bodies);
        self.enter_eights(obstacles, bodies);
        self.begin_iteration(Part { number: 0, of: self.iterations, whole: h }, anchors, obstacles, bodies);
    }

    /// Runs the second half of a substep: the rest of the first iteration, and all others.
    pub(crate) fn end_substep(
        &mut self,
        h: f32,
        anchors: &[Anchor],
        obstacles: &[Obstacle],
        bodies: &mut [ObstacleBody],
    ) {
        for number in 0..self.iterations {
            let part = Part { number, of: self.iterations, whole: h };
            if number > 0 {
                self.begin_iteration(part, anchors, obstacles, bodies);
            }
            self.end_iteration(part, anchors, obstacles, bodies);
        }
        if self.eights.on {
            self.leave_eights();
        }
    }

    /// Number of particles that are solved individually: all except those in lanes.
    fn one_by_one(&self) -> usize {
        if self.eights.on { self.eights.others.len() } else { self.positions.len() }
    }

    /// Index of individually solved particle number `at`.
    fn one(&self, at: usize) -> usize {
        if self.eights.on { self.eights.others[at] as usize } else { at }
    }

    /// Runs the first half of an iteration, which computes velocities.
    fn begin_iteration(
        &mut self,
        part: Part,
        anchors: &[Anchor],
        obstacles: &[Obstacle],
        bodies: &[ObstacleBody],
    ) {
        let h = part.h();
        self.span = h;
        self.place(part, obstacles, bodies);
        if self.eights.on {
            self.approach(h);
        } else {
            self.begin(h);
        }
        self.hold(part, anchors);
        self.find_near(h);
        self.find_contacts(h, obstacles, bodies);
        self.prepare_solve(h);
        self.settle_contacts(h, obstacles, bodies);
    }

    /// Runs the second half of an iteration, which moves the group.
    fn end_iteration(
        &mut self,
        part: Part,
        anchors: &[Anchor],
        obstacles: &[Obstacle],
        bodies: &mut [ObstacleBody],
    ) {
        let h = part.h();
        self.push_bodies(bodies);
        for at in 0..self.one_by_one() {
            let i = self.one(at);
            self.positions[i] += self.velocities[i] * h;
        }
        self.back_contacts(bodies);
        if self.eights.on {
            self.project_in_eights(h);
        } else {
            self.project_net(h);
        }
        self.press_bodies(h, bodies);
        self.let_go(part, anchors);
        self.bounce(h, bodies);
        if self.eights.on {
            self.depart(h, obstacles, bodies);
        }
        self.stop_impacts(h, obstacles, bodies);
        if self.eights.on {
            self.put_back();
        }
    }

    /// Applies damping, and enters particles into the system: all if it solves springs, otherwise the attached ones.
    fn begin(&mut self, h: f32) {
        let damping = 1.0 / (1.0 + h * self.linear_damping);
        self.previous.copy_from_slice(&self.positions);
        for (velocity, begun) in self.velocities.iter_mut().zip(&mut self.begun) {
            *velocity *= damping;
            *begun = *velocity;
        }
        for (weight, mass) in self.weights.iter_mut().zip(&self.masses) {
            *weight = 1.0 / *mass;
        }
        if self.forest.has_trees() {
            (0..self.positions.len()).for_each(|i| self.enter(i, h));
        } else {
            for k in 0..self.attachments.len() {
                self.enter(self.attachments[k].particle as usize, h);
            }
        }
    }

    /// Enters a free particle into the system.
    fn enter(&mut self, i: usize, h: f32) {
        let mass = self.masses[i];
        self.system.freedom[i] = Freedom::Free;
        self.system.inertia[i] = Sym3::from_diagonal(Vec3::splat(mass));
        self.system.momentum[i] = (self.velocities[i] + self.accelerations[i] * h) * mass;
    }
}

/// An iteration: a part of a substep.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// Number of the iteration, from 0.
    number: u32,
    /// Number of iterations in the substep.
    of: u32,
    /// Length of the substep, seconds.
    whole: f32,
}

impl Part {
    /// Length of the iteration, seconds.
    fn h(self) -> f32 {
        self.whole / self.of as f32
    }

    /// Shares of the substep that have elapsed at the start and at the end of the iteration.
    fn shares(self) -> [f32; 2] {
        [self.number, self.number + 1].map(|k| k as f32 / self.of as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Regression from random test 48: a particle with a finite position kept its non-finite contact impulse.
    #[test]
    fn non_finite_contact_impulses_are_reset_to_zero() {
        let particle = ParticleDef { position: Vec3::ZERO, velocity: Vec3::ZERO, mass: 0.1, radius: 0.01 };
        let mut group = ParticleGroup::new(&GroupDef { particles: vec![particle; 2], ..GroupDef::default() });
        group.contact_impulses = vec![Vec3::splat(f32::INFINITY), Vec3::X];
        assert!(!group.roll_back(), "the positions and velocities are finite");
        assert_eq!(group.contact_impulses, [Vec3::ZERO, Vec3::X]);
    }
}
