//! Transforms: read after changes by the user, and written after motion of bodies.

use crate::properties::unlock;
use crate::{BodyHandle, Physics, order};
use bevy_ecs::prelude::*;
use bevy_math::{Affine3A, Quat};
#[cfg(feature = "reflect")]
use bevy_reflect::std_traits::ReflectDefault;
use bevy_time::{Fixed, Time};
use bevy_transform::components::Transform;
use sinew_math::{Rotation, Transform as Pose};

/// Interpolation of drawn poses between two steps.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Resource, Default, Debug, PartialEq))]
pub enum Interpolation {
    /// Interpolates between the last two steps, with a delay of one step: smooth at any frame rate. Default.
    #[default]
    On,
    /// Draws the pose of the last step.
    Off,
}

impl Interpolation {
    /// Returns the fraction of the drawn pose between the last two steps.
    pub(crate) fn alpha(self, time: &Time<Fixed>) -> f32 {
        match self {
            Self::On => time.overstep_fraction(),
            Self::Off => 1.0,
        }
    }
}

/// Converts to a pose without scale.
pub(crate) fn to_pose(transform: &Transform) -> Pose {
    let [x, y, z, w] = transform.rotation.to_array();
    Pose::new(transform.translation, Rotation::from_xyzw(x, y, z, w).normalize())
}

pub(crate) fn to_quat(rotation: Rotation) -> Quat {
    Quat::from_xyzw(rotation.x, rotation.y, rotation.z, rotation.w)
}

/// Returns the transform from the parent's space to the world, by the present transforms of all ancestors.
fn world_from_parent(
    parent: Entity,
    parents: &Query<&ChildOf>,
    transform: impl Fn(Entity) -> Option<Transform>,
) -> Affine3A {
    core::iter::once(parent)
        .chain(parents.iter_ancestors(parent))
        .filter_map(transform)
        .fold(Affine3A::IDENTITY, |below, transform| transform.compute_affine() * below)
}

/// Moves bodies whose entities the user has moved.
pub(crate) fn read_transforms(
    mut physics: ResMut<Physics>,
    changed: Query<Entity, (Changed<Transform>, With<BodyHandle>)>,
    mut handles: Query<&mut BodyHandle>,
    transforms: Query<&Transform>,
    parents: Query<&ChildOf>,
) {
    let mut changed: Vec<Entity> = changed.iter().collect();
    changed.sort_unstable_by_key(|&entity| order(entity));
    for entity in changed {
        let (Ok(mut handle), Ok(transform)) = (handles.get_mut(entity), transforms.get(entity)) else {
            continue;
        };
        if handle.transform == *transform {
            continue;
        }
        handle.transform = *transform;
        let of = |ancestor| transforms.get(ancestor).ok().copied();
        let pose = match parents.get(entity) {
            Ok(&ChildOf(parent)) => {
                let global = world_from_parent(parent, &parents, of) * transform.compute_affine();
                to_pose(&Transform::from_matrix(global.into()))
            }
            Err(_) => to_pose(transform),
        };
        physics.set_transform(handle.id(), pose);
        // The next lock holds the new position.
        unlock(&mut handle, &mut physics);
    }
}

/// Writes the transforms of moved bodies, and of all bodies with a parent; parents before children.
pub(crate) fn write_transforms(
    physics: Res<Physics>,
    time: Res<Time<Fixed>>,
    interpolation: Res<Interpolation>,
    bodies: Query<(Entity, &ChildOf), With<BodyHandle>>,
    parents: Query<&ChildOf>,
    mut handles: Query<(&mut BodyHandle, &mut Transform)>,
    others: Query<&Transform, Without<BodyHandle>>,
) {
    let alpha = interpolation.alpha(&time);
    let moved = physics.bodies_moved().filter_map(|id| physics.entity(id));
    for entity in moved.filter(|&entity| !parents.contains(entity)) {
        let Ok((mut handle, mut transform)) = handles.get_mut(entity) else { continue };
        let pose = physics.interpolated(handle.id(), alpha);
        write(&mut handle, &mut transform, |now| Transform {
            translation: pose.translation,
            rotation: to_quat(pose.rotation),
            ..*now
        });
    }
    let depth = |entity| parents.iter_ancestors(entity).count();
    let mut children: Vec<(usize, Entity, Entity)> =
        bodies.iter().map(|(entity, &ChildOf(parent))| (depth(entity), entity, parent)).collect();
    children.sort_unstable();
    for (_, entity, parent) in children {
        let of = |ancestor| {
            let body = handles.get(ancestor).ok().map(|(_, transform)| *transform);
            body.or_else(|| others.get(ancestor).ok().copied())
        };
        let parent_from_world = world_from_parent(parent, &parents, of).inverse();
        let Ok((mut handle, mut transform)) = handles.get_mut(entity) else { continue };
        let pose = physics.interpolated(handle.id(), alpha);
        let rotation = to_quat(pose.rotation);
        let local = parent_from_world * Affine3A::from_rotation_translation(rotation, pose.translation);
        let local = Transform::from_matrix(local.into());
        write(&mut handle, &mut transform, |now| Transform { scale: now.scale, ..local });
    }
}

/// Writes a transform if it differs, so that change detection ignores it otherwise.
fn write(
    handle: &mut Mut<BodyHandle>,
    transform: &mut Mut<Transform>,
    make: impl FnOnce(&Transform) -> Transform,
) {
    // Changes by the user since the last step must be read first.
    if handle.transform != **transform {
        return;
    }
    let new = make(transform);
    if **transform != new {
        **transform = new;
        handle.transform = new;
    }
}
