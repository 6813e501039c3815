//! Joints and fields.

use crate::properties::JointMotor;
use crate::{BodyHandle, Physics, order};
use bevy_ecs::lifecycle::HookContext;
use bevy_ecs::prelude::*;
use bevy_ecs::world::DeferredWorld;
use bevy_math::Vec3;
#[cfg(feature = "reflect")]
use bevy_reflect::{ReflectDeserialize, ReflectSerialize};
use sinew_physics::{FieldDef, FieldId, JointDef, JointId, JointKind};

/// Stores entities as bits, because Bevy serialises entities only with a feature of its scenes.
#[cfg(feature = "reflect")]
pub(crate) mod bits {
    use bevy_ecs::entity::Entity;
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer>(entity: &Entity, out: S) -> Result<S::Ok, S::Error> {
        out.serialize_u64(entity.to_bits())
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(input: D) -> Result<Entity, D::Error> {
        let bits = u64::deserialize(input)?;
        Entity::try_from_bits(bits).ok_or_else(|| D::Error::custom("not the bits of an entity"))
    }
}

/// A joint between two bodies, on its own entity. The joint is created once both bodies are in the world, and removed with either
/// of them.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "reflect",
    derive(bevy_reflect::Reflect, serde::Serialize, serde::Deserialize),
    reflect(opaque),
    reflect(Component, Clone, Debug, PartialEq, Serialize, Deserialize)
)]
pub struct Joint {
    /// First body.
    #[entities]
    #[cfg_attr(feature = "reflect", serde(with = "bits"))]
    pub a: Entity,
    /// Second body.
    #[entities]
    #[cfg_attr(feature = "reflect", serde(with = "bits"))]
    pub b: Entity,
    /// Anchor of both bodies at creation, world, metres.
    pub anchor: Vec3,
    /// Direction of the joint's x axis at creation, world, any length but 0: the axis of a hinge or a slider.
    pub axis: Vec3,
    /// Kind of the joint: its free motions.
    pub kind: JointKind,
}

/// Joint of an entity; available once the joint is in the world.
#[derive(Component, Clone, Copy, Debug)]
#[component(on_remove = take_out_joint)]
pub struct JointHandle(JointId);

impl JointHandle {
    /// Returns the id of the joint in [`Physics`]; stale if one of its bodies was removed.
    pub fn id(&self) -> JointId {
        self.0
    }
}

/// A field, everywhere or in a region of the world.
#[derive(Component, Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "reflect",
    derive(bevy_reflect::Reflect, serde::Serialize, serde::Deserialize),
    reflect(opaque),
    reflect(Component, Clone, Debug, PartialEq, Serialize, Deserialize)
)]
pub struct Field(pub FieldDef);

/// Field of an entity; available once the field is in the world.
#[derive(Component, Clone, Copy, Debug)]
#[component(on_remove = take_out_field)]
pub struct FieldHandle(FieldId);

impl FieldHandle {
    /// Returns the id of the field in [`Physics`].
    pub fn id(&self) -> FieldId {
        self.0
    }
}

fn take_out_joint(mut world: DeferredWorld, context: HookContext) {
    let Some(&JointHandle(id)) = world.get::<JointHandle>(context.entity) else { return };
    let Some(mut physics) = world.get_resource_mut::<Physics>() else { return };
    if physics.contains_joint(id) {
        physics.remove_joint(id);
    }
}

fn take_out_field(mut world: DeferredWorld, context: HookContext) {
    let Some(&FieldHandle(id)) = world.get::<FieldHandle>(context.entity) else { return };
    let Some(mut physics) = world.get_resource_mut::<Physics>() else { return };
    if physics.contains_field(id) {
        physics.remove_field(id);
    }
}

/// Removes the joint when its component is removed.
pub(crate) fn forget_joint(removed: On<Remove<Joint>>, mut commands: Commands) {
    commands.entity(removed.event().entity).try_remove::<JointHandle>();
}

/// Removes the field when its component is removed.
pub(crate) fn forget_field(removed: On<Remove<Field>>, mut commands: Commands) {
    commands.entity(removed.event().entity).try_remove::<FieldHandle>();
}

/// Adds joints whose bodies both exist, in the order of their entities.
pub(crate) fn add_joints(
    mut commands: Commands,
    mut physics: ResMut<Physics>,
    new: Query<(Entity, &Joint, Option<&JointMotor>), Without<JointHandle>>,
    bodies: Query<&BodyHandle>,
) {
    let mut new: Vec<_> = new.iter().collect();
    new.sort_unstable_by_key(|&(entity, ..)| order(entity));
    for (entity, joint, motor) in new {
        let (Ok(a), Ok(b)) = (bodies.get(joint.a), bodies.get(joint.b)) else { continue };
        // The frames of a hinge fit joints of any kind.
        let hinge = physics.hinge(a.id(), b.id(), joint.anchor, joint.axis);
        let motor = motor.map(|motor| motor.0);
        let id = physics.add_joint(&JointDef { kind: joint.kind, motor, ..hinge });
        commands.entity(entity).insert(JointHandle(id));
    }
}

/// Changes kind or limits of an existing joint, which keeps its bodies and frames.
pub(crate) fn change_joints(
    mut physics: ResMut<Physics>,
    changed: Query<(Entity, &JointHandle, &Joint), Changed<Joint>>,
) {
    let mut changed: Vec<_> = changed.iter().collect();
    changed.sort_unstable_by_key(|&(entity, ..)| order(entity));
    for (_, &JointHandle(id), joint) in changed {
        if !physics.contains_joint(id) {
            continue;
        }
        let now = physics.joint(id);
        if now.kind != joint.kind {
            physics.set_joint(id, &JointDef { kind: joint.kind, ..now });
        }
    }
}

pub(crate) fn add_fields(
    mut commands: Commands,
    mut physics: ResMut<Physics>,
    new: Query<(Entity, &Field), Without<FieldHandle>>,
) {
    let mut new: Vec<_> = new.iter().collect();
    new.sort_unstable_by_key(|&(entity, _)| order(entity));
    for (entity, field) in new {
        let id = physics.add_field(&field.0);
        commands.entity(entity).insert(FieldHandle(id));
    }
}

pub(crate) fn change_fields(
    mut physics: ResMut<Physics>,
    changed: Query<(Entity, &FieldHandle, &Field), Changed<Field>>,
) {
    let mut changed: Vec<_> = changed.iter().collect();
    changed.sort_unstable_by_key(|&(entity, ..)| order(entity));
    for (_, &FieldHandle(id), field) in changed {
        if *physics.field(id) != field.0 {
            physics.set_field(id, &field.0);
        }
    }
}
