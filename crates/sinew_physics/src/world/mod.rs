//! The world: owner of all bodies, joints, particles, fields, movers and objects.

mod body_ref;
mod body_type;
mod connect;
mod copy;
mod counts;
mod delta;
mod draw;
mod explosions;
mod fields;
mod forces;
mod joints;
mod library;
mod move_to;
mod moved;
mod objects;
mod owners;
mod pairs;
mod shapes;
mod snapshot;
mod surfaces;
mod update;
mod waking;
mod weight;

pub use body_ref::BodyRef;
pub use connect::LockedAxes;
pub use delta::Snapshot;
pub use joints::Reaction;
pub use shapes::MassUpdate;
pub use surfaces::{BodyContact, ContactPoint};
pub use update::Update;

use crate::activity::{Activity, sleeping_partner};
use crate::arena::Arena;
use crate::body::def::{BodyDef, BodyKind, WorldDef};
use crate::body::external_work::Work;
use crate::body::library::ShapeLibrary;
use crate::body::owner::Owners;
use crate::body::shape::{MassProperties, Sensing};
use crate::body::{Body, Velocity};
use crate::contact::Contact;
use crate::contact::disabled_pairs::DisabledPairs;
use crate::contact::events::Events;
use crate::contact::parts::Parts;
use crate::contact::tracking::ContactTracking;
use crate::context::StepContext;
use crate::field::{FieldDef, Functions};
use crate::id::Lineage;
use crate::id::{BodyId, GroupId, JointId};
use crate::joint::Joint;
use crate::mover::Movers;
use crate::particles::{GroupDef, ParticleGroup};
use crate::runner::{Serial, TaskRunner};
use crate::stage::{NoProfiler, Profiler};
use crate::step::islands::Islands;
use crate::step::pairs::BroadPhase;
use crate::step::pinched::Pinches;
use crate::step::step;
use crate::user_object::Objects;
use sinew_math::{Transform, Vec3};

/// A simulated world: bodies, joints, particles, fields and movers, stepped at a fixed rate.
///
/// # Panics
/// Every method that takes an id panics if the id is stale or from another world, and every method that takes a number
/// panics if it is not finite.
#[doc(alias = "PhysicsWorld")]
#[doc(alias = "PhysicsPipeline")]
#[doc(alias = "PhysicsSystem")]
pub struct World {
    pub(crate) def: WorldDef,
    pub(crate) bodies: Arena<Body>,
    pub(crate) joints: Arena<Joint>,
    /// Contacts of awake or moving bodies, in order of their keys; `activity` has the contacts of the others.
    pub(crate) contacts: Vec<Contact>,
    pub(crate) activity: Activity,
    pub(crate) groups: Arena<ParticleGroup>,
    pub(crate) fields: Arena<FieldDef>,
    pub(crate) functions: Functions,
    pub(crate) library: ShapeLibrary,
    pub(crate) owners: Owners,
    pub(crate) objects: Objects,
    pub(crate) movers: Movers,
    pub(crate) parted: DisabledPairs,
    pub(crate) meetings: ContactTracking,
    pub(crate) events: Events,
    pub(crate) broad: BroadPhase,
    pub(crate) parts: Parts,
    pub(crate) pinches: Pinches,
    pub(crate) islands: Islands,
    /// Number of islands that have fallen asleep so far.
    pub(crate) sleepers: u32,
    pub(crate) steps: u64,
    /// Time passed to `update` and not yet simulated, nanoseconds.
    pub(crate) pending_nanoseconds: u64,
    /// External work of the last step; not part of the state.
    pub(crate) work: Work,
    /// Scratch memory of `wake_neighbors`; empty between calls.
    pub(crate) around: Vec<u32>,
    pub(crate) marked: Vec<u8>,
}

impl World {
    /// Creates an empty world.
    ///
    /// # Panics
    /// If [`WorldDef::check`] rejects the definition.
    pub fn new(def: WorldDef) -> Self {
        if let Err(what) = def.check() {
            panic!("{what}");
        }
        let lineage = Lineage::fresh();
        Self {
            def,
            bodies: Arena::new(lineage),
            joints: Arena::new(lineage),
            contacts: Vec::new(),
            activity: Activity::default(),
            groups: Arena::new(lineage),
            fields: Arena::new(lineage),
            functions: Functions::default(),
            library: ShapeLibrary::default(),
            owners: Owners::default(),
            objects: Objects::new(lineage),
            movers: Movers::new(lineage),
            parted: DisabledPairs::default(),
            meetings: ContactTracking::default(),
            events: Events::default(),
            broad: BroadPhase::default(),
            parts: Parts::default(),
            pinches: Pinches::default(),
            islands: Islands::default(),
            sleepers: 0,
            steps: 0,
            pending_nanoseconds: 0,
            work: Work::default(),
            around: Vec::new(),
            marked: Vec::new(),
        }
    }

    /// Returns the settings of the world.
    pub fn def(&self) -> &WorldDef {
        &self.def
    }

    /// Adds a body.
    ///
    /// # Panics
    /// If a number is not finite, a shape is not valid or names a modifier that is not registered, or a dynamic body has no
    /// mass.
    #[doc(alias = "spawn")]
    #[doc(alias = "RigidBodySet::insert")]
    #[doc(alias = "CreateBody")]
    pub fn add_body(&mut self, def: &BodyDef) -> BodyId {
        def.shapes.iter().for_each(|shape| self.expect_modifier(shape.rule));
        let id = self.bodies.insert(Body::new(def));
        let index = id.index;
        for shape in &def.shapes {
            self.library.keep(&shape.shape);
        }
        self.activity.add(index, self.bodies.at(index));
        self.broad.proxies.add(index, self.bodies.at(index));
        let senses = def.shapes.iter().any(|shape| shape.sensing == Sensing::Sensor);
        if senses || def.kind == BodyKind::Kinematic || self.sleepers > 0 {
            // The body may overlap static bodies.
            self.look_anew(id);
        }
        id
    }

    /// Removes a body with its joints; touching bodies wake.
    ///
    /// # Panics
    /// If particles are attached to the body or have a backstop on it, or the body has an [owner](Self::own_bodies): a
    /// character removes its bodies by its own methods.
    #[track_caller]
    #[doc(alias = "despawn")]
    #[doc(alias = "destroy")]
    pub fn remove_body(&mut self, id: BodyId) {
        self.expect_own_body(id);
        let worn = self.groups.iter().any(|(_, group)| group.carriers().any(|body| body == id));
        assert!(
            !worn,
            "no particles are attached to a body that is taken out, nor have backstops there ({id:?})"
        );
        self.wake_neighbors(id.index);
        let joints: Vec<JointId> = self.joints_of(id).collect();
        for joint in joints {
            self.take_joint(joint);
        }
        self.meetings.changed.retain(|&index| index != id.index);
        for contact in self.contacts.extract_if(.., |contact| contact.key.has(id.index)) {
            self.meetings.part(&self.bodies, &contact);
        }
        self.groups.iter_mut().for_each(|(_, group)| group.pinched.forget(|key| key.has(id.index)));
        self.activity.remove(id.index, |contact| self.meetings.part(&self.bodies, &contact));
        self.parted.forget(id.index);
        self.movers.forget(id);
        self.bodies.remove(id);
        self.broad.proxies.remove(id.index);
    }

    /// Adds particles with their springs; bodies that hold them or carry their backstops wake. Groups sleep with their
    /// islands. A sleeping body acts on particles like a static one, unless one hits it faster than
    /// [`SleepThresholds::speed`](crate::SleepThresholds): then the body wakes.
    ///
    /// # Panics
    /// If the definition is invalid or names a body that does not exist.
    pub fn add_particles(&mut self, def: &GroupDef) -> GroupId {
        let group = ParticleGroup::new(def);
        group.carriers().for_each(|body| _ = self.expect(body));
        group.carriers().for_each(|body| self.wake_body(body.index));
        self.groups.insert(group)
    }

    /// Removes a particle group; bodies that slept with it or rested on it wake.
    #[track_caller]
    pub fn remove_particles(&mut self, id: GroupId) {
        let group = self.groups.take(id);
        if let Some(partner) = sleeping_partner(&self.bodies, &group) {
            self.wake_body(partner);
        }
        self.activity.wake_borne(&mut self.bodies, &group, 0.0, (&self.broad.proxies, &self.def));
    }

    /// Returns a particle group.
    #[track_caller]
    pub fn particles(&self, id: GroupId) -> &ParticleGroup {
        self.groups.expect(id)
    }

    /// Returns a particle group, mutable.
    #[track_caller]
    pub fn particles_mut(&mut self, id: GroupId) -> &mut ParticleGroup {
        self.groups.expect_mut(id)
    }

    /// Iterates over all particle groups, by index.
    pub fn group_ids(&self) -> impl Iterator<Item = GroupId> {
        self.groups.ids()
    }

    /// Takes one step on the calling thread.
    #[doc(alias = "CCD")]
    #[doc(alias = "continuous collision detection")]
    #[doc(alias = "simulate")]
    pub fn step(&mut self) {
        self.step_with(&Serial, &NoProfiler);
    }

    /// Takes one step with the host's threads and profiler. The result does not depend on either.
    pub fn step_with(&mut self, runner: &dyn TaskRunner, profiler: &dyn Profiler) {
        let (dt, substeps) = (self.def.dt(), self.def.substeps);
        let h = dt / substeps as f32;
        let context = StepContext { dt, h, substeps, time: self.time(), runner, profiler };
        self.work = Work::default();
        step(self, &context);
        self.report_counts(profiler);
        self.work = self.work + self.islands.work();
        self.steps += 1;
    }

    /// Number of steps taken.
    pub fn step_count(&self) -> u64 {
        self.steps
    }

    /// Simulated time, seconds.
    pub fn time(&self) -> f64 {
        self.steps as f64 * self.def.step_nanoseconds as f64 * 1e-9
    }

    /// Returns the events of the last step.
    pub fn events(&self) -> &Events {
        &self.events
    }

    /// Energy added during the last step, J; zero after [`load`](Self::load), until a step is taken. The energy of the
    /// bodies ([`energy`](Self::energy)) rises by at most this, plus the work of the user's forces, fields, moving
    /// surfaces and impulses between steps.
    pub fn work(&self) -> Work {
        self.work
    }

    /// Iterates over all bodies, by index.
    pub fn body_ids(&self) -> impl Iterator<Item = BodyId> {
        self.bodies.ids()
    }

    /// True if the id names an existing body.
    pub fn contains(&self, id: BodyId) -> bool {
        self.bodies.get(id).is_some()
    }

    /// Pose of the body's frame, world.
    #[track_caller]
    pub fn transform(&self, id: BodyId) -> Transform {
        self.expect(id).world_from_body()
    }

    /// Pose of the body between the last step (`alpha` 0) and this one (1), for drawing.
    #[track_caller]
    pub fn interpolated(&self, id: BodyId, alpha: f32) -> Transform {
        let body = self.expect(id);
        let (from, to) = (body.previous, body.world_from_principal);
        let between = Transform::new(
            from.translation * (1.0 - alpha) + to.translation * alpha,
            from.rotation.nlerp(to.rotation, alpha),
        );
        between * body.principal_from_body
    }

    /// Teleports a body without a sweep; the body wakes, with the bodies that touched it or are jointed to it.
    #[track_caller]
    #[doc(alias = "teleport")]
    #[doc(alias = "set_position")]
    pub fn set_transform(&mut self, id: BodyId, world_from_body: Transform) {
        assert!(
            world_from_body.is_finite(),
            "a body's pose must be finite, not {world_from_body:?} ({id:?})"
        );
        self.expect_mut(id).set_world_from_body(world_from_body);
        self.mark_changed(id);
        // The contact impulses of the body do not apply at the new position.
        let returned = self.activity.returned_mut();
        for contact in self.contacts.iter_mut().chain(returned).filter(|contact| contact.key.has(id.index)) {
            contact.memory = contact.memory.of_new_step();
        }
        self.broad.proxies.place(id.index, self.bodies.at(id.index));
    }

    /// World position of the centre of mass, metres.
    #[track_caller]
    pub fn center_of_mass(&self, id: BodyId) -> Vec3 {
        self.expect(id).center()
    }

    /// Velocity of the centre of mass (m/s) and angular velocity (rad/s), world axes.
    #[track_caller]
    #[doc(alias = "linvel")]
    #[doc(alias = "angvel")]
    pub fn velocity(&self, id: BodyId) -> Velocity {
        self.expect(id).velocity
    }

    /// Sets the velocity of a dynamic or kinematic body; the body wakes. No effect on a static body. The step limits the
    /// components of a kinematic body's velocity to 1e6 m/s and 1e6 rad/s, and reports such bodies in `Events::limited`.
    #[track_caller]
    #[doc(alias = "set_linvel")]
    #[doc(alias = "set_angvel")]
    pub fn set_velocity(&mut self, id: BodyId, velocity: Velocity) {
        assert!(
            velocity.linear.is_finite() && velocity.angular.is_finite(),
            "a velocity must be finite, not {velocity:?} ({id:?})"
        );
        let body = self.expect_mut(id);
        if body.kind == BodyKind::Static {
            return;
        }
        let stops = velocity.is_zero() && !body.velocity.is_zero();
        body.velocity = velocity;
        match body.kind {
            // The contacts of the body at its new position are not known yet.
            BodyKind::Kinematic if stops => self.mark_changed(id),
            _ => self.wake_body(id.index),
        }
        if self.bodies.at(id.index).can_touch() {
            self.activity.recall(id.index);
        }
    }

    /// Kind of a body: static, kinematic or dynamic.
    #[track_caller]
    #[doc(alias = "body_type")]
    pub fn kind(&self, id: BodyId) -> BodyKind {
        self.expect(id).kind
    }

    /// Mass (kg; 0 unless dynamic), centre (metres) and inertia (kg·m²) in the body's frame.
    #[track_caller]
    pub fn mass(&self, id: BodyId) -> MassProperties {
        self.expect(id).mass_properties()
    }

    /// User data of a body.
    #[track_caller]
    pub fn user_data(&self, id: BodyId) -> u64 {
        self.expect(id).user_data
    }

    #[track_caller]
    pub(crate) fn expect(&self, id: BodyId) -> &Body {
        self.bodies.expect(id)
    }

    #[track_caller]
    pub(crate) fn expect_mut(&mut self, id: BodyId) -> &mut Body {
        self.bodies.expect_mut(id)
    }
}
