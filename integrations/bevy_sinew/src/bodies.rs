//! Bodies, their shapes and velocities.

use crate::colliders::Surface;
use crate::pose::to_pose;
use crate::{Physics, order};
use bevy_ecs::lifecycle::HookContext;
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_ecs::world::DeferredWorld;
use bevy_math::Vec3;
#[cfg(feature = "reflect")]
use bevy_reflect::std_traits::ReflectDefault;
#[cfg(feature = "reflect")]
use bevy_reflect::{ReflectDeserialize, ReflectSerialize};
use bevy_transform::components::Transform;
use bevy_transform::helper::TransformHelper;
use sinew_physics::{BodyDef, BodyId, BodyKind, ForceId, JointId, MassProperties, Shape, ShapeDef};

/// Kind of a rigid body.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Default, Debug, PartialEq))]
#[require(Transform, Collider)]
pub enum RigidBody {
    /// The body never moves.
    Static,
    /// The body moves at its [`Velocity`]; nothing pushes it.
    Kinematic,
    /// Forces move the body. Default.
    #[default]
    Dynamic,
}

impl From<RigidBody> for BodyKind {
    fn from(body: RigidBody) -> Self {
        match body {
            RigidBody::Static => Self::Static,
            RigidBody::Kinematic => Self::Kinematic,
            RigidBody::Dynamic => Self::Dynamic,
        }
    }
}

/// Shapes of a body, metres, in its own axes; the mass is computed from their densities. Shapes of an entity without a [`RigidBody`] belong to
/// the nearest body above it. A dynamic body without shapes is a point of 1 kg without contacts.
#[derive(Component, Clone, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "reflect",
    derive(bevy_reflect::Reflect, serde::Serialize, serde::Deserialize),
    reflect(opaque),
    reflect(Component, Clone, Default, Debug, PartialEq, Serialize, Deserialize)
)]
pub struct Collider(pub Vec<ShapeDef>);

impl From<Shape> for Collider {
    fn from(shape: Shape) -> Self {
        Self(vec![shape.into()])
    }
}

impl From<ShapeDef> for Collider {
    fn from(shape: ShapeDef) -> Self {
        Self(vec![shape])
    }
}

/// Velocity of a body's centre of mass and angular velocity, world axes.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Default, Debug, PartialEq))]
pub struct Velocity {
    /// Linear velocity, m/s.
    pub linear: Vec3,
    /// Angular velocity, rad/s.
    pub angular: Vec3,
}

impl From<Velocity> for sinew_physics::Velocity {
    fn from(Velocity { linear, angular }: Velocity) -> Self {
        Self { linear, angular }
    }
}

/// Body of an entity; exists as soon as the entity has a [`RigidBody`].
#[derive(Component, Clone, Copy, Debug)]
#[component(on_remove = take_out)]
pub struct BodyHandle {
    id: BodyId,
    /// The last written or read transform; any difference is a change by the user.
    pub(crate) transform: Transform,
    velocity: Velocity,
    /// Mass given by a [`Mass`](crate::Mass), kg.
    pub(crate) mass: Option<f32>,
    /// Force of a [`ConstantForce`](crate::ConstantForce).
    pub(crate) force: Option<ForceId>,
    /// Joint of a [`Locked`](crate::Locked).
    pub(crate) lock: Option<JointId>,
}

impl BodyHandle {
    /// Returns the id of the body in [`Physics`].
    pub fn id(&self) -> BodyId {
        self.id
    }
}

fn take_out(mut world: DeferredWorld, context: HookContext) {
    let Some(&BodyHandle { id, .. }) = world.get::<BodyHandle>(context.entity) else { return };
    let Some(mut physics) = world.get_resource_mut::<Physics>() else { return };
    if physics.contains(id) {
        crate::particles::remove_hanging(&mut physics, id);
        physics.remove_body(id);
        physics.gone.push(id);
    }
}

/// Removes the body when its component is removed.
pub(crate) fn forget_body(removed: On<Remove<RigidBody>>, mut commands: Commands) {
    commands.entity(removed.event().entity).try_remove::<BodyHandle>();
}

/// Mass of a body without shapes, kg, and its moment for each kg, m².
const POINT_MASS: f32 = 1.0;
const POINT_MOMENT: f32 = 0.1;

/// Returns mass and moments of a body without shapes.
pub(crate) fn point(mass: Option<f32>) -> MassProperties {
    let mass = mass.unwrap_or(POINT_MASS);
    let inertia = sinew_math::Sym3 { diagonal: Vec3::splat(POINT_MOMENT * mass), off: Vec3::ZERO };
    MassProperties { mass, center: Vec3::ZERO, inertia }
}

/// Components that define the body of an entity.
pub(crate) type Body = (Entity, &'static RigidBody, Surface, Option<&'static Velocity>, &'static Transform);

fn add_body(
    commands: &mut Commands,
    physics: &mut Physics,
    (entity, &kind, surface, velocity, &transform): <Body as QueryData>::Item<'_, '_>,
    global: &TransformHelper,
) {
    let Ok(pose) = global.compute_global_transform(entity) else { return };
    let pose = to_pose(&pose.compute_transform());
    let velocity = velocity.copied().unwrap_or_default();
    let shapes = surface.own_shapes();
    let mass = shapes.is_empty().then(|| point(None));
    let id = physics.add_body(&BodyDef {
        kind: kind.into(),
        shapes,
        mass,
        position: pose.translation,
        rotation: pose.rotation,
        linear_velocity: velocity.linear,
        angular_velocity: velocity.angular,
        user_data: entity.to_bits(),
        ..BodyDef::default()
    });
    physics.entities.insert(id, entity);
    let handle = BodyHandle { id, transform, velocity, mass: None, force: None, lock: None };
    commands.entity(entity).insert(handle);
}

/// Adds the body of a new entity without waiting for the next step.
pub(crate) fn add_at_once(
    added: On<Add<RigidBody>>,
    mut commands: Commands,
    physics: Option<ResMut<Physics>>,
    bodies: Query<Body, Without<BodyHandle>>,
    global: TransformHelper,
) {
    if let (Some(mut physics), Ok(body)) = (physics, bodies.get(added.event().entity)) {
        add_body(&mut commands, &mut physics, body, &global);
    }
}

/// Adds bodies of entities that were spawned while there was no [`Physics`], in the order of the entities.
pub(crate) fn add_bodies(
    mut commands: Commands,
    mut physics: ResMut<Physics>,
    new: Query<Body, Without<BodyHandle>>,
    global: TransformHelper,
) {
    let mut new: Vec<_> = new.iter().collect();
    new.sort_unstable_by_key(|&(entity, ..)| order(entity));
    for body in new {
        add_body(&mut commands, &mut physics, body, &global);
    }
}

pub(crate) fn change_kinds(
    mut physics: ResMut<Physics>,
    changed: Query<(&BodyHandle, &RigidBody), Changed<RigidBody>>,
) {
    let mut changed: Vec<_> = changed.iter().collect();
    changed.sort_unstable_by_key(|(handle, _)| handle.id);
    for (handle, &kind) in changed {
        physics.set_kind(handle.id, kind.into());
    }
}

pub(crate) fn read_velocities(
    mut physics: ResMut<Physics>,
    mut changed: Query<(&mut BodyHandle, &Velocity), Changed<Velocity>>,
) {
    for (mut handle, &velocity) in &mut changed {
        if handle.velocity != velocity {
            physics.set_velocity(handle.id, velocity.into());
            handle.velocity = velocity;
        }
    }
}

pub(crate) fn write_velocities(physics: Res<Physics>, mut bodies: Query<(&mut BodyHandle, &mut Velocity)>) {
    for (mut handle, mut velocity) in &mut bodies {
        let sinew_physics::Velocity { linear, angular } = physics.velocity(handle.id);
        let now = Velocity { linear, angular };
        if handle.velocity != now {
            (handle.velocity, *velocity) = (now, now);
        }
    }
}
