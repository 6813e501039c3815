//! Properties of bodies and joints as separate components.

use crate::bodies::BodyHandle;
use crate::links::JointHandle;
use crate::{Physics, order};
use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
#[cfg(feature = "reflect")]
use bevy_reflect::std_traits::ReflectDefault;
#[cfg(feature = "reflect")]
use bevy_reflect::{ReflectDeserialize, ReflectSerialize};
use sinew_physics::{BodyDef, BodyId, ForceDef, LockedAxes, Motor};

/// Coefficient of Coulomb friction, ≥ 0, of all shapes of a body, instead of that of its [`Collider`](crate::Collider).
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Debug, PartialEq))]
pub struct Friction(pub f32);

/// Restitution, 0..=1, of all shapes of a body, instead of that of its [`Collider`](crate::Collider): ratio of the speed after an impact to the
/// speed before it.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Debug, PartialEq))]
pub struct Restitution(pub f32);

/// Collision layers of all shapes of a body, instead of those of its [`Collider`](crate::Collider). Two shapes collide if each is on a layer of
/// the other's mask.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Default, Debug, PartialEq))]
pub struct Layers {
    /// Bits of the layers of the shapes. Default 1.
    pub layers: u32,
    /// Bits of the layers with which the shapes collide. Default all.
    pub mask: u32,
}

impl Default for Layers {
    fn default() -> Self {
        Self { layers: 1, mask: u32::MAX }
    }
}

/// Makes all shapes of the body sensors: they push nothing and report overlaps ([`SensorEntered`](crate::SensorEntered),
/// [`SensorLeft`](crate::SensorLeft)).
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Default, Debug, PartialEq))]
pub struct Sensor;

/// Mass of a body, kg, above 0, instead of that of its shapes' densities. The centre of mass stays.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Debug, PartialEq))]
pub struct Mass(pub f32);

/// Share of a body's velocity that is lost in a second, 1/s, ≥ 0.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Default, Debug, PartialEq))]
pub struct Damping {
    /// Damping of the linear velocity, 1/s.
    pub linear: f32,
    /// Damping of the angular velocity, 1/s.
    pub angular: f32,
}

/// Factor on gravity for a body.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Debug, PartialEq))]
pub struct GravityScale(pub f32);

/// A force and a torque in world axes, N and N·m, that act on a body in each step until you change them.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Default, Debug, PartialEq))]
pub struct ConstantForce {
    /// Force on the centre of mass, N.
    pub force: Vec3,
    /// Torque, N·m.
    pub torque: Vec3,
}

/// World axes along or about which a body does not move: [`LockedAxes::ROTATIONS`] keeps the body upright. The lock holds the position of the
/// body at the time when the component is added or changed, or the body is moved by its `Transform`.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "reflect",
    derive(bevy_reflect::Reflect),
    reflect(opaque),
    reflect(Component, Clone, Debug, PartialEq)
)]
pub struct Locked(pub LockedAxes);

/// Motor of the [`Joint`](crate::Joint) on the same entity.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "reflect",
    derive(bevy_reflect::Reflect, serde::Serialize, serde::Deserialize),
    reflect(opaque),
    reflect(Component, Clone, Debug, PartialEq, Serialize, Deserialize)
)]
pub struct JointMotor(pub Motor);

/// Adds observers that restore defaults when a component is removed.
pub(crate) fn add_observers(app: &mut App) {
    app.add_observer(remove_damping).add_observer(remove_gravity_scale).add_observer(remove_force);
    app.add_observer(remove_lock).add_observer(remove_motor);
}

fn body_of(handles: Query<&BodyHandle>, entity: Entity, physics: &Physics) -> Option<BodyId> {
    let body = handles.get(entity).ok()?.id();
    physics.contains(body).then_some(body)
}

fn remove_damping(removed: On<Remove<Damping>>, handles: Query<&BodyHandle>, mut physics: ResMut<Physics>) {
    if let Some(body) = body_of(handles, removed.event().entity, &physics) {
        let def = BodyDef::default();
        physics.set_linear_damping(body, def.linear_damping);
        physics.set_angular_damping(body, def.angular_damping);
    }
}

fn remove_gravity_scale(
    removed: On<Remove<GravityScale>>,
    handles: Query<&BodyHandle>,
    mut physics: ResMut<Physics>,
) {
    if let Some(body) = body_of(handles, removed.event().entity, &physics) {
        physics.set_gravity_scale(body, BodyDef::default().gravity_scale);
    }
}

fn remove_force(
    removed: On<Remove<ConstantForce>>,
    mut handles: Query<&mut BodyHandle>,
    mut physics: ResMut<Physics>,
) {
    let Ok(mut handle) = handles.get_mut(removed.event().entity) else { return };
    if let Some(force) = handle.force.take()
        && physics.contains(handle.id())
    {
        physics.remove_force(force);
    }
}

fn remove_lock(
    removed: On<Remove<Locked>>,
    mut handles: Query<&mut BodyHandle>,
    mut physics: ResMut<Physics>,
) {
    let Ok(mut handle) = handles.get_mut(removed.event().entity) else { return };
    unlock(&mut handle, &mut physics);
}

fn remove_motor(removed: On<Remove<JointMotor>>, handles: Query<&JointHandle>, mut physics: ResMut<Physics>) {
    let Ok(handle) = handles.get(removed.event().entity) else { return };
    if physics.contains_joint(handle.id()) {
        physics.set_motor(handle.id(), None);
    }
}

/// Releases the locked axes of a body, until [`lock_axes`] locks them at the new position.
pub(crate) fn unlock(handle: &mut BodyHandle, physics: &mut Physics) {
    if let Some(joint) = handle.lock.take()
        && physics.contains_joint(joint)
    {
        physics.remove_joint(joint);
    }
}

/// Applies damping and gravity scale of new bodies and changed components.
pub(crate) fn change_motion(
    mut physics: ResMut<Physics>,
    damped: Query<(&BodyHandle, &Damping), Or<(Added<BodyHandle>, Changed<Damping>)>>,
    scaled: Query<(&BodyHandle, &GravityScale), Or<(Added<BodyHandle>, Changed<GravityScale>)>>,
) {
    for (handle, damping) in &damped {
        physics.set_linear_damping(handle.id(), damping.linear);
        physics.set_angular_damping(handle.id(), damping.angular);
    }
    for (handle, scale) in &scaled {
        physics.set_gravity_scale(handle.id(), scale.0);
    }
}

/// Applies forces of new bodies and changed components.
pub(crate) fn change_forces(
    mut physics: ResMut<Physics>,
    mut changed: Query<(&mut BodyHandle, &ConstantForce), Or<(Added<BodyHandle>, Changed<ConstantForce>)>>,
) {
    for (mut handle, &ConstantForce { force, torque }) in &mut changed {
        let def = ForceDef { force, torque, ..ForceDef::default() };
        match handle.force {
            Some(force) => physics.set_force(force, &def),
            None => handle.force = Some(physics.add_force(handle.id(), &def)),
        }
    }
}

/// Locks the axes of bodies, in the order of their entities: a joint to a body that never moves.
pub(crate) fn lock_axes(
    mut physics: ResMut<Physics>,
    mut locked: Query<(Entity, &mut BodyHandle, Ref<Locked>)>,
) {
    let mut locked: Vec<_> = locked.iter_mut().collect();
    locked.sort_unstable_by_key(|(entity, ..)| order(*entity));
    for (_, mut handle, axes) in locked {
        if axes.is_changed() {
            unlock(&mut handle, &mut physics);
        }
        if handle.lock.is_none() {
            let ground = physics.ground();
            let joint = physics.axis_locks(ground, handle.id(), axes.0);
            handle.lock = Some(physics.add_joint(&joint));
        }
    }
}

/// Applies changed motors; [`add_joints`](crate::links::add_joints) sets those of new joints.
pub(crate) fn change_motors(
    mut physics: ResMut<Physics>,
    changed: Query<(Entity, &JointHandle, &JointMotor), Changed<JointMotor>>,
) {
    let mut changed: Vec<_> = changed.iter().collect();
    changed.sort_unstable_by_key(|&(entity, ..)| order(entity));
    for (_, handle, motor) in changed {
        if physics.contains_joint(handle.id()) {
            physics.set_motor(handle.id(), Some(motor.0));
        }
    }
}
