//! Ropes, cloth and blobs.

use crate::{BodyHandle, Physics, order};
use bevy_ecs::entity::MapEntities;
use bevy_ecs::lifecycle::HookContext;
use bevy_ecs::prelude::*;
use bevy_ecs::world::DeferredWorld;
use bevy_math::Vec3;
#[cfg(feature = "reflect")]
use bevy_reflect::{ReflectDeserialize, ReflectSerialize};
use sinew_physics::particles::{AttachmentDef, AttachmentTarget, GroupDef};
use sinew_physics::{BodyId, GroupId};

/// A group of particles in the world: a rope, a cape, a blob. [`Physics`] returns their positions, by the id in [`ParticlesHandle`]; the
/// entity's `Transform` has no effect. The group is created once all bodies to which it is attached exist, and removed with any of them.
#[derive(Component, Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "reflect",
    derive(bevy_reflect::Reflect, serde::Serialize, serde::Deserialize),
    reflect(opaque),
    reflect(Component, Clone, Debug, PartialEq, Serialize, Deserialize)
)]
pub struct Particles {
    /// Particles and springs, world, metres. Change an existing group through [`Physics`].
    pub def: GroupDef,
    /// Particles attached to entities with a body.
    #[entities]
    pub hangs: Vec<Hang>,
}

impl From<GroupDef> for Particles {
    fn from(def: GroupDef) -> Self {
        Self { def, hangs: Vec::new() }
    }
}

/// A particle attached to a body.
#[derive(MapEntities, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(serde::Serialize, serde::Deserialize))]
pub struct Hang {
    /// Index of the particle.
    pub particle: u32,
    /// Entity with the body.
    #[entities]
    #[cfg_attr(feature = "reflect", serde(with = "crate::links::bits"))]
    pub body: Entity,
    /// Point in the body's axes, metres.
    pub point: Vec3,
}

/// Particles of an entity; available once the group is in the world.
#[derive(Component, Clone, Copy, Debug)]
#[component(on_remove = take_out)]
pub struct ParticlesHandle(GroupId);

impl ParticlesHandle {
    /// Returns the id of the group in [`Physics`]; stale if a body to which the group was attached was removed.
    pub fn id(&self) -> GroupId {
        self.0
    }
}

fn take_out(mut world: DeferredWorld, context: HookContext) {
    let Some(&ParticlesHandle(id)) = world.get::<ParticlesHandle>(context.entity) else { return };
    let Some(mut physics) = world.get_resource_mut::<Physics>() else { return };
    if physics.group_ids().any(|other| other == id) {
        physics.remove_particles(id);
    }
}

/// Removes the particles when their component is removed.
pub(crate) fn forget_particles(removed: On<Remove<Particles>>, mut commands: Commands) {
    commands.entity(removed.event().entity).try_remove::<ParticlesHandle>();
}

/// Removes the groups attached to a removed body.
pub(crate) fn remove_hanging(physics: &mut Physics, body: BodyId) {
    let hangs = |id: &GroupId| {
        let on = |target| matches!(target, AttachmentTarget::Body { body: other, .. } if other == body);
        physics.particles(*id).attachments().iter().any(|attachment| on(attachment.target))
    };
    let hanging: Vec<GroupId> = physics.group_ids().filter(hangs).collect();
    hanging.into_iter().for_each(|id| physics.remove_particles(id));
}

pub(crate) fn add_particles(
    mut commands: Commands,
    mut physics: ResMut<Physics>,
    new: Query<(Entity, &Particles), Without<ParticlesHandle>>,
    bodies: Query<&BodyHandle>,
) {
    let mut new: Vec<_> = new.iter().collect();
    new.sort_unstable_by_key(|&(entity, _)| order(entity));
    for (entity, particles) in new {
        let attach = |hang: &Hang| {
            let body = bodies.get(hang.body).ok()?.id();
            let target = AttachmentTarget::Body { body, point: hang.point };
            Some(AttachmentDef { particle: hang.particle, target })
        };
        let Some(hangs) = particles.hangs.iter().map(attach).collect::<Option<Vec<_>>>() else { continue };
        let mut def = particles.def.clone();
        def.attachments.extend(hangs);
        let id = physics.add_particles(&def);
        commands.entity(entity).insert(ParticlesHandle(id));
    }
}
