//! Character movers: upright capsules that walk.

use crate::pose::to_quat;
use crate::{Physics, order};
use bevy_ecs::lifecycle::HookContext;
use bevy_ecs::prelude::*;
use bevy_ecs::world::DeferredWorld;
use bevy_math::Vec3;
#[cfg(feature = "reflect")]
use bevy_reflect::std_traits::ReflectDefault;
#[cfg(feature = "reflect")]
use bevy_reflect::{ReflectDeserialize, ReflectSerialize};
use bevy_time::{Fixed, Time};
use bevy_transform::components::Transform;
use sinew_math::Rotation;
use sinew_physics::{MoverDef, MoverId};

/// A mover: an upright capsule that walks, climbs steps, rides and pushes without being a body. The entity's `Transform` is that of the
/// mover's feet, in the world; the entity must have no parent and no [`RigidBody`](crate::RigidBody).
#[derive(Component, Clone, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "reflect",
    derive(bevy_reflect::Reflect, serde::Serialize, serde::Deserialize),
    reflect(opaque),
    reflect(Component, Clone, Default, Debug, PartialEq, Serialize, Deserialize)
)]
#[require(Transform, Walk, MoverState)]
pub struct Mover(pub MoverDef);

/// Input of a mover.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Default, Debug, PartialEq))]
pub struct Walk {
    /// Velocity over the ground, m/s, until you change it.
    pub velocity: Vec3,
    /// Speed of a jump in the next step, m/s; reset to 0 after the step.
    pub jump: f32,
}

/// State of a mover after the last step.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Default, Debug, PartialEq))]
pub struct MoverState {
    /// Velocity in the world, m/s.
    pub velocity: Vec3,
    /// True if ground that is not too steep supports the mover.
    pub grounded: bool,
}

/// Mover of an entity; available once the mover is in the world.
#[derive(Component, Clone, Copy, Debug)]
#[component(on_remove = take_out)]
pub struct MoverHandle {
    id: MoverId,
    transform: Transform,
    yaw: f32,
}

impl MoverHandle {
    /// Returns the id of the mover in [`Physics`].
    pub fn id(&self) -> MoverId {
        self.id
    }
}

fn take_out(mut world: DeferredWorld, context: HookContext) {
    let Some(&MoverHandle { id, .. }) = world.get::<MoverHandle>(context.entity) else { return };
    let Some(mut physics) = world.get_resource_mut::<Physics>() else { return };
    if physics.contains_mover(id) {
        physics.remove_mover(id);
    }
}

/// Removes the mover when its component is removed.
pub(crate) fn forget_mover(removed: On<Remove<Mover>>, mut commands: Commands) {
    commands.entity(removed.event().entity).try_remove::<MoverHandle>();
}

pub(crate) fn add_movers(
    mut commands: Commands,
    mut physics: ResMut<Physics>,
    new: Query<(Entity, &Mover, &Transform), Without<MoverHandle>>,
) {
    let mut new: Vec<_> = new.iter().collect();
    new.sort_unstable_by_key(|&(entity, ..)| order(entity));
    for (entity, Mover(def), &transform) in new {
        let def = MoverDef { position: transform.translation, user_data: entity.to_bits(), ..def.clone() };
        let id = physics.add_mover(&def);
        commands.entity(entity).insert(MoverHandle { id, transform, yaw: 0.0 });
    }
}

/// Moves movers whose entities the user has moved, and applies their input.
pub(crate) fn lead_movers(
    mut physics: ResMut<Physics>,
    mut movers: Query<(Entity, &mut MoverHandle, &Mover, &mut Walk, &Transform)>,
) {
    let mut all: Vec<_> = movers.iter_mut().collect();
    all.sort_unstable_by_key(|(entity, ..)| order(*entity));
    for (_, mut handle, Mover(def), mut walk, &transform) in all {
        if handle.transform.translation != transform.translation {
            physics.set_mover_position(handle.id, transform.translation);
        }
        handle.transform = transform;
        let now = physics.mover(handle.id).def();
        if now.height != def.height {
            // Without room, the change is retried in the next step.
            physics.set_mover_height(handle.id, def.height);
        }
        if physics.mover(handle.id).def().filter != def.filter {
            physics.set_mover_filter(handle.id, def.filter);
        }
        physics.set_mover_walk(handle.id, walk.velocity);
        if walk.jump > 0.0 {
            physics.mover_jump(handle.id, walk.jump);
            walk.jump = 0.0;
        }
    }
}

pub(crate) fn write_mover_states(physics: Res<Physics>, mut movers: Query<(&MoverHandle, &mut MoverState)>) {
    for (handle, mut state) in &mut movers {
        let mover = physics.mover(handle.id);
        let now = MoverState { velocity: mover.velocity(), grounded: mover.is_grounded() };
        state.set_if_neq(now);
    }
}

/// Writes the positions of feet, and rotates entities with the ground below them.
pub(crate) fn write_movers(
    physics: Res<Physics>,
    time: Res<Time<Fixed>>,
    interpolation: Res<crate::Interpolation>,
    mut movers: Query<(&mut MoverHandle, &mut Transform)>,
) {
    let alpha = interpolation.alpha(&time);
    for (mut handle, mut transform) in &mut movers {
        // Changes by the user since the last step must be read first.
        if handle.transform.translation != transform.translation {
            continue;
        }
        let mover = physics.mover(handle.id);
        let turn = mover.yaw() - handle.yaw;
        let turned = to_quat(Rotation::from_axis_angle(mover.def().up, turn)) * transform.rotation;
        let rotation = if turn == 0.0 { transform.rotation } else { turned };
        let new = Transform { translation: mover.interpolated(alpha), rotation, ..*transform };
        if *transform != new {
            *transform = new;
        }
        (handle.transform, handle.yaw) = (new, mover.yaw());
    }
}
