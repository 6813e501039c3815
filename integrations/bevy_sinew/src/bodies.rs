//! Bodies, their shapes and velocities.

use crate::pose::to_pose;
use crate::{Physics, order};
use bevy_ecs::lifecycle::HookContext;
use bevy_ecs::prelude::*;
use bevy_ecs::world::DeferredWorld;
use bevy_math::Vec3;
#[cfg(feature = "reflect")]
use bevy_reflect::std_traits::ReflectDefault;
#[cfg(feature = "reflect")]
use bevy_reflect::{ReflectDeserialize, ReflectSerialize};
use bevy_transform::components::Transform;
use bevy_transform::helper::TransformHelper;
use sinew_physics::{BodyDef, BodyId, BodyKind, MassUpdate, Shape, ShapeDef, ShapeId};

/// A rigid body of a kind.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Default, Debug, PartialEq))]
#[require(Transform, Collider)]
pub enum RigidBody {
    /// The body never moves.
    Static,
    /// Moves at its [`Velocity`]; nothing pushes it.
    Kinematic,
    /// Moved by forces. Default.
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

/// The shapes of a body, metres, in its own axes; mass is computed from their densities. A dynamic body without shapes is a point of 1 kg
/// without contacts.
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

/// The body of an entity; available from the first fixed step on.
#[derive(Component, Clone, Copy, Debug)]
#[component(on_remove = take_out)]
pub struct BodyHandle {
    id: BodyId,
    /// The last written or read transform; any difference is a change by the user.
    pub(crate) transform: Transform,
    velocity: Velocity,
}

impl BodyHandle {
    /// Id of the body in [`Physics`].
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

/// Mass of a body without shapes, kg, and its moments, kg·m².
const POINT_MASS: f32 = 1.0;
const POINT_MOMENT: f32 = 0.1;

fn body_def(kind: RigidBody, shapes: &[ShapeDef]) -> BodyDef {
    let inertia = sinew_math::Sym3 { diagonal: Vec3::splat(POINT_MOMENT), off: Vec3::ZERO };
    let point = sinew_physics::MassProperties { mass: POINT_MASS, center: Vec3::ZERO, inertia };
    let mass = shapes.is_empty().then_some(point);
    BodyDef { kind: kind.into(), shapes: shapes.to_vec(), mass, ..BodyDef::default() }
}

/// Adds new bodies in the order of their entities.
pub(crate) fn add_bodies(
    mut commands: Commands,
    mut physics: ResMut<Physics>,
    new: Query<(Entity, &RigidBody, &Collider, Option<&Velocity>), Without<BodyHandle>>,
    transforms: Query<&Transform>,
    global: TransformHelper,
) {
    let mut new: Vec<_> = new.iter().collect();
    new.sort_unstable_by_key(|&(entity, ..)| order(entity));
    for (entity, &kind, collider, velocity) in new {
        let (Ok(pose), Ok(&transform)) = (global.compute_global_transform(entity), transforms.get(entity))
        else {
            continue;
        };
        let pose = to_pose(&pose.compute_transform());
        let velocity = velocity.copied().unwrap_or_default();
        let id = physics.add_body(&BodyDef {
            position: pose.translation,
            rotation: pose.rotation,
            linear_velocity: velocity.linear,
            angular_velocity: velocity.angular,
            user_data: entity.to_bits(),
            ..body_def(kind, &collider.0)
        });
        physics.entities.insert(id, entity);
        commands.entity(entity).insert(BodyHandle { id, transform, velocity });
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

/// Replaces the shapes of a changed collider; the body keeps its id.
pub(crate) fn change_shapes(
    mut physics: ResMut<Physics>,
    changed: Query<(&BodyHandle, &RigidBody, Ref<Collider>), Changed<Collider>>,
) {
    let mut changed: Vec<_> = changed.iter().collect();
    changed.sort_unstable_by_key(|(handle, ..)| handle.id);
    for (handle, &kind, collider) in changed {
        let body = handle.id;
        let now: Vec<ShapeDef> = physics.shape_ids(body).map(|id| physics.shape_def(id)).collect();
        if now == collider.0 {
            continue;
        }
        let common = now.len().min(collider.0.len());
        for (shape, def) in collider.0.iter().enumerate() {
            if shape < common {
                physics.set_shape(ShapeId { body, shape: shape as u32 }, def, MassUpdate::Keep);
            } else {
                physics.add_shape(body, def, MassUpdate::Keep);
            }
        }
        for shape in (common..now.len()).rev() {
            physics.remove_shape(ShapeId { body, shape: shape as u32 }, MassUpdate::Keep);
        }
        if kind == RigidBody::Dynamic && !collider.0.is_empty() {
            physics.set_mass_of_shapes(body);
        }
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
