//! Sinew's physics in Bevy: bodies, joints, fields, movers, particles and characters as components, stepped in `FixedPostUpdate`.
//!
//! ```
//! use bevy_app::{App, Update};
//! use bevy_ecs::prelude::*;
//! use bevy_sinew::prelude::*;
//! use bevy_time::{TimePlugin, TimeUpdateStrategy};
//! use bevy_transform::components::Transform;
//!
//! let mut app = App::new();
//! app.add_plugins((TimePlugin, SinewPlugin::default())); // in a game `DefaultPlugins` bring the first
//! app.world_mut().spawn((RigidBody::Static, Collider::from(Shape::HalfSpace)));
//! let ball = (RigidBody::Dynamic, Collider::from(Shape::sphere(0.5)), Transform::from_xyz(0.0, 3.0, 0.0));
//! let ball = app.world_mut().spawn(ball).id();
//! # app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
//! (0..180).for_each(|_| app.update());
//! let height = app.world().get::<Transform>(ball).expect("the entity has this component").translation.y;
//! assert!((height - 0.5).abs() < 0.01);
//! ```
//!
//! # Data flow
//!
//! | component | read | written |
//! |---|---|---|
//! | [`RigidBody`], [`Collider`]; [`Friction`], [`Restitution`], [`Layers`], [`Sensor`], [`Mass`] | when added, changed or removed | never |
//! | [`Damping`], [`GravityScale`], [`ConstantForce`], [`Locked`] | the same | never |
//! | `Transform` | when a body is added, and when another system changes it | each frame, of bodies that moved: between the last two steps |
//! | [`Velocity`], if present | when added or changed | after each step |
//! | [`Joint`], [`JointMotor`], [`Field`] | when added or changed | never |
//! | [`Mover`], [`Walk`] | before each step; its height and filter may change | a jump is reset after it was applied |
//! | [`MoverState`] | never | after each step |
//! | [`Particles`] | when added | never |
//! | [`CharacterBody`] | when added | never |
//! | [`CharacterHandle`] | before and after each step | each step |
//! | [`BevyAnimation`] | when its character is added | never |
//!
//! # Features
//!
//! | feature | adds | default |
//! |---|---|---|
//! | `characters` | [`CharacterBody`]: walks, is hit, falls, gets up, on the joints of a scene | yes |
//! | `diagnostics` | `SinewDiagnosticsPlugin`: time of steps, bodies awake, contacts | no |
//! | `gltf` | `CharacterScene`: characters from GLB files | no |
//! | `mesh` | `MeshCollider`: colliders from drawn meshes | no |
//! | `gizmos` | `SinewGizmosPlugin`: debug drawing of the world | no |
//! | `picking` | `SinewPickingPlugin`: pointers hit bodies | no |
//! | `reflect` | components in the type registry, for scenes and inspectors | no |
//!
//! A body moves in world space, not with its parent: if an ancestor or the parent changes, the body stays and its `Transform` is adjusted.
//! Scales are kept, but do not scale shapes. All other features of a world are available through the resource [`Physics`], with the id in
//! [`BodyHandle`].
#![forbid(unsafe_code)]
// The types of queries show what a system reads; type aliases would hide that.
#![allow(clippy::type_complexity)]

#[cfg(feature = "characters")]
mod animation;
mod bodies;
#[cfg(feature = "characters")]
mod characters;
mod colliders;
#[cfg(feature = "diagnostics")]
mod diagnostics;
mod events;
#[cfg(feature = "gizmos")]
mod gizmos;
#[cfg(feature = "gltf")]
mod gltf;
mod links;
#[cfg(feature = "mesh")]
mod mesh;
mod movers;
mod particles;
#[cfg(feature = "picking")]
mod picking;
mod pose;
pub mod prelude;
mod properties;
mod threads;

#[cfg(feature = "characters")]
pub use animation::BevyAnimation;
pub use bodies::{BodyHandle, Collider, RigidBody, Velocity};
#[cfg(feature = "characters")]
pub use characters::{CharacterBody, CharacterHandle, CharacterJoints, CharacterTold};
pub use colliders::ColliderOf;
#[cfg(feature = "diagnostics")]
pub use diagnostics::SinewDiagnosticsPlugin;
pub use events::{HitTold, SensorEntered, SensorLeft, TouchBegan, TouchEnded};
#[cfg(feature = "gizmos")]
pub use gizmos::{GizmoColors, PhysicsGizmos, SinewGizmosPlugin};
#[cfg(feature = "gltf")]
pub use gltf::{
    CharacterFile, CharacterFileError, CharacterLoader, CharacterScene, CharacterSettings, SinewGltfPlugin,
    read_character,
};
pub use links::{Field, FieldHandle, Joint, JointHandle};
#[cfg(feature = "mesh")]
pub use mesh::{MeshCollider, MeshColliderError, SinewMeshPlugin};
pub use movers::{Mover, MoverHandle, MoverState, Walk};
pub use particles::{Hang, Particles, ParticlesHandle};
#[cfg(feature = "picking")]
pub use picking::SinewPickingPlugin;
pub use pose::Interpolation;
pub use properties::{
    ConstantForce, Damping, Friction, GravityScale, JointMotor, Layers, Locked, Mass, Restitution, Sensor,
};
#[cfg(feature = "characters")]
pub use sinew;
pub use sinew_math as math;
pub use sinew_physics::{
    self as physics, FieldDef, FieldKind, JointKind, MoverDef, Shape, ShapeDef, WorldDef,
};
pub use threads::{BevyTasks, StepThreads};

#[cfg(feature = "characters")]
use bevy_app::{AnimationSystems, PostUpdate};
use bevy_app::{App, FixedPostUpdate, Plugin, RunFixedMainLoop, RunFixedMainLoopSystems};
use bevy_ecs::entity::Entity;
use bevy_ecs::prelude::{IntoScheduleConfigs, Resource, SystemSet};
use bevy_time::{Fixed, Time};
#[cfg(feature = "characters")]
use bevy_transform::TransformSystems;
use core::ops::{Deref, DerefMut};
use core::time::Duration;
use sinew_physics::{BodyDef, BodyId, BodyKind, World};
use std::collections::{BTreeMap, BTreeSet};

/// Stages of the plugin, in order. The first three run in `FixedPostUpdate`, the last in `RunFixedMainLoop`, after the fixed
/// steps of a frame.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PhysicsSystems {
    /// New, changed and removed components are applied to the world.
    Prepare,
    /// The world takes a step.
    Step,
    /// Velocities are written, messages sent, observers triggered.
    Tell,
    /// Transforms are written.
    Write,
}

/// The physics of an app: a [`World`], with a map from bodies to entities.
#[derive(Resource)]
pub struct Physics {
    world: World,
    entities: BTreeMap<BodyId, Entity>,
    /// Bodies of characters, with the entity of each character.
    limbs: BTreeMap<BodyId, Entity>,
    /// Removed bodies, kept until the step has reported the ends of their contacts.
    gone: Vec<BodyId>,
    /// Entities of bodies whose shapes or mass must be checked, because a component was removed or a child moved.
    stale: BTreeSet<Entity>,
    /// A static body without shapes; exists once axes are locked.
    ground: Option<BodyId>,
}

impl Physics {
    /// Returns the entity of a body, or of the character of a limb; also for bodies removed since the last step.
    pub fn entity(&self, body: BodyId) -> Option<Entity> {
        self.entities.get(&body).or_else(|| self.limbs.get(&body)).copied()
    }

    /// Returns the number of bodies with an entity, including those removed since the last step.
    pub fn len(&self) -> usize {
        self.entities.len()
    }

    /// Returns true if no entity has a body.
    pub fn is_empty(&self) -> bool {
        self.entities.is_empty()
    }

    /// Returns the body to which locked axes are locked.
    fn ground(&mut self) -> BodyId {
        if let Some(ground) = self.ground.filter(|&ground| self.world.contains(ground)) {
            return ground;
        }
        let (kind, mass) = (BodyKind::Static, Some(bodies::point(None)));
        *self.ground.insert(self.world.add_body(&BodyDef { kind, mass, ..BodyDef::default() }))
    }
}

impl Deref for Physics {
    type Target = World;

    fn deref(&self) -> &World {
        &self.world
    }
}

impl DerefMut for Physics {
    fn deref_mut(&mut self) -> &mut World {
        &mut self.world
    }
}

/// Returns a key that orders entities by creation: the order in which they are added to the world.
pub(crate) fn order(entity: Entity) -> (u32, u64) {
    (entity.index_u32(), entity.to_bits())
}

/// Plugin of the physics. Needs Bevy's `TimePlugin`; sets the length of the fixed step to that of the world.
#[derive(Default)]
pub struct SinewPlugin {
    /// Settings of the world. Default [`WorldDef::default`].
    pub def: WorldDef,
}

impl Plugin for SinewPlugin {
    fn build(&self, app: &mut App) {
        let step = Duration::from_nanos(self.def.step_nanoseconds);
        app.insert_resource(Time::<Fixed>::from_duration(step));
        let world = World::new(self.def.clone());
        app.insert_resource(Physics {
            world,
            entities: BTreeMap::new(),
            limbs: BTreeMap::new(),
            gone: Vec::new(),
            stale: BTreeSet::new(),
            ground: None,
        });
        app.init_resource::<Interpolation>().init_resource::<StepThreads>();
        events::add_messages(app);
        let order = (PhysicsSystems::Prepare, PhysicsSystems::Step, PhysicsSystems::Tell);
        app.configure_sets(FixedPostUpdate, order.chain());
        let after = RunFixedMainLoopSystems::AfterFixedMainLoop;
        app.configure_sets(RunFixedMainLoop, PhysicsSystems::Write.in_set(after));
        app.add_observer(bodies::add_at_once);
        app.add_observer(bodies::forget_body);
        colliders::add_observers(app);
        properties::add_observers(app);
        app.add_observer(links::forget_joint);
        app.add_observer(links::forget_field);
        app.add_observer(movers::forget_mover);
        app.add_observer(particles::forget_particles);
        let prepare = (
            bodies::add_bodies,
            bodies::change_kinds,
            colliders::find_bodies,
            colliders::change_shapes,
            pose::read_transforms,
            bodies::read_velocities,
            (properties::change_motion, properties::change_forces, properties::lock_axes).chain(),
            links::add_joints,
            links::change_joints,
            properties::change_motors,
            links::add_fields,
            links::change_fields,
            movers::add_movers,
            movers::lead_movers,
            particles::add_particles,
        );
        app.add_systems(FixedPostUpdate, prepare.chain().in_set(PhysicsSystems::Prepare));
        app.add_systems(FixedPostUpdate, events::step.in_set(PhysicsSystems::Step));
        let tell = (bodies::write_velocities, movers::write_mover_states, events::tell);
        app.add_systems(FixedPostUpdate, tell.chain().in_set(PhysicsSystems::Tell));
        let write = (pose::write_transforms, movers::write_movers);
        app.add_systems(RunFixedMainLoop, write.chain().in_set(PhysicsSystems::Write));
        #[cfg(feature = "characters")]
        add_characters(app);
        #[cfg(feature = "reflect")]
        register_types(app);
    }
}

#[cfg(feature = "characters")]
fn add_characters(app: &mut App) {
    app.add_message::<CharacterTold>().add_observer(characters::forget_character);
    let prepare = (characters::add_characters, characters::read_characters, animation::feed_characters);
    let prepare = prepare.chain();
    app.add_systems(FixedPostUpdate, prepare.in_set(PhysicsSystems::Prepare).after(particles::add_particles));
    // Runs before the world's events are reported, while bodies released by a character are still known.
    let update = characters::update_characters.in_set(PhysicsSystems::Tell);
    app.add_systems(FixedPostUpdate, update.after(movers::write_mover_states).before(events::tell));
    let write = (characters::find_joints, characters::write_characters).chain();
    app.add_systems(RunFixedMainLoop, write.in_set(PhysicsSystems::Write).after(movers::write_movers));
    app.add_systems(PostUpdate, animation::give_back.before(AnimationSystems));
    let show = animation::take_and_show.after(AnimationSystems).before(TransformSystems::Propagate);
    app.add_systems(PostUpdate, show);
}

#[cfg(feature = "reflect")]
fn register_types(app: &mut App) {
    app.register_type::<RigidBody>().register_type::<Collider>().register_type::<Velocity>();
    app.register_type::<Field>().register_type::<Joint>().register_type::<Interpolation>();
    app.register_type::<Walk>().register_type::<MoverState>().register_type::<StepThreads>();
    app.register_type::<Mover>().register_type::<Particles>();
    app.register_type::<Friction>().register_type::<Restitution>().register_type::<Layers>();
    app.register_type::<Sensor>().register_type::<Mass>().register_type::<Damping>();
    app.register_type::<GravityScale>().register_type::<ConstantForce>();
    app.register_type::<Locked>().register_type::<JointMotor>();
    #[cfg(feature = "characters")]
    app.register_type::<BevyAnimation>();
}

/// The README's example.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// The guide's chapter.
#[cfg(all(doctest, feature = "characters"))]
#[doc = include_str!("../../../docs/guide/src/bevy.md")]
struct Guide;
