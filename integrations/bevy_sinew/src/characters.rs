//! Characters that move the joints of a scene: they walk, are hit, fall and get up.

use crate::animation::{BevyAnimation, LedKinds, led, to_place};
use crate::events::both;
use crate::pose::to_pose;
use crate::{Physics, order};
use bevy_ecs::lifecycle::HookContext;
use bevy_ecs::prelude::*;
use bevy_ecs::world::DeferredWorld;
use bevy_math::{Affine3A, Mat3A, Vec3A};
use bevy_time::{Fixed, Time};
use bevy_transform::components::Transform;
use core::ops::{Deref, DerefMut};
use sinew::anim::{LocalTransform, Rig};
use sinew::ragdoll::{Character, CharacterDef, CharacterEvent};
use sinew_math::Affine;
use sinew_physics::BodyId;
use std::collections::VecDeque;
use std::sync::Arc;

/// Definition of a character. Inserted at the root of a scene loaded from the same file, the component moves the scene's joints, found by
/// name among the entity's descendants. It also works without a scene.
///
/// The entity's `Transform` sets the initial position, in metres, facing +Z. Later the plugin writes it as the transform of the file's own
/// space (scaled if the file is in centimetres), and reads it when the user changes it. The entity must have no parent and no
/// [`RigidBody`](crate::RigidBody).
#[derive(Component, Clone, Debug)]
#[require(Transform)]
pub struct CharacterBody(pub Arc<CharacterDef>);

/// The [`Character`] of an entity; available from the first fixed step on. Pass `&mut physics` of [`ResMut<Physics>`](Physics) to calls
/// that take a world.
#[derive(Component, Clone, Debug)]
#[component(on_remove = take_out)]
pub struct CharacterHandle {
    character: Character,
    /// The last written or read transform.
    transform: Transform,
    /// Bodies registered as limbs of the character.
    bodies: Vec<BodyId>,
}

impl Deref for CharacterHandle {
    type Target = Character;

    fn deref(&self) -> &Character {
        &self.character
    }
}

impl DerefMut for CharacterHandle {
    fn deref_mut(&mut self) -> &mut Character {
        &mut self.character
    }
}

/// Entities of a character's joints, in the order of its rig; inserted once the scene is loaded.
#[derive(Component, Clone, Debug, Default)]
pub struct CharacterJoints(pub Vec<Option<Entity>>);

/// An event of a character.
#[derive(Event, Message, Clone, Copy, Debug, PartialEq)]
pub struct CharacterTold {
    /// Entity of the character.
    pub character: Entity,
    /// Event of the character in this step.
    pub event: CharacterEvent,
}

fn take_out(mut world: DeferredWorld, context: HookContext) {
    let Some(handle) = world.get::<CharacterHandle>(context.entity) else { return };
    let (character, bodies) = (handle.character.clone(), handle.bodies.clone());
    let Some(mut physics) = world.get_resource_mut::<Physics>() else { return };
    for &body in &bodies {
        if physics.contains(body) {
            crate::particles::remove_hanging(&mut physics, body);
        }
    }
    character.despawn(&mut physics);
    physics.gone.extend(bodies);
}

/// Removes the character when its component is removed.
pub(crate) fn forget_character(removed: On<Remove<CharacterBody>>, mut commands: Commands) {
    commands.entity(removed.event().entity).try_remove::<(CharacterHandle, CharacterJoints)>();
}

pub(crate) fn add_characters(
    mut commands: Commands,
    mut physics: ResMut<Physics>,
    new: Query<(Entity, &CharacterBody, &Transform, Has<BevyAnimation>), Without<CharacterHandle>>,
    mut kinds: Local<LedKinds>,
) {
    let mut new: Vec<_> = new.iter().collect();
    new.sort_unstable_by_key(|&(entity, ..)| order(entity));
    for (entity, CharacterBody(def), &transform, is_led) in new {
        let def = if is_led { &led(&mut kinds, def) } else { def };
        let character = Character::spawn(&mut physics, def, to_pose(&transform));
        let mut handle = CharacterHandle { character, transform, bodies: Vec::new() };
        register(&mut physics, entity, &mut handle);
        commands.entity(entity).insert(handle);
    }
}

/// Registers the bodies of a character in the world.
fn register(physics: &mut Physics, entity: Entity, handle: &mut CharacterHandle) {
    if handle.bodies != handle.character.bodies() {
        physics.gone.extend(handle.bodies.iter().filter(|body| !handle.character.bodies().contains(body)));
        handle.bodies = handle.character.bodies().to_vec();
        physics.limbs.extend(handle.bodies.iter().map(|&body| (body, entity)));
    }
}

/// Moves characters whose entities the user has moved.
pub(crate) fn read_characters(
    mut physics: ResMut<Physics>,
    mut changed: Query<(Entity, &mut CharacterHandle, &Transform), Changed<Transform>>,
) {
    let mut changed: Vec<_> = changed.iter_mut().collect();
    changed.sort_unstable_by_key(|(entity, ..)| order(*entity));
    for (_, mut handle, &transform) in changed {
        if handle.transform == transform {
            continue;
        }
        handle.transform = transform;
        let model_from_character = affine(&handle.def().mapping().character_from_model()).inverse();
        let place = Transform::from_matrix((transform.compute_affine() * model_from_character).into());
        handle.character.teleport(&mut physics, to_pose(&place));
    }
}

/// Updates the characters after the step, in the order of their entities.
pub(crate) fn update_characters(
    mut physics: ResMut<Physics>,
    mut commands: Commands,
    mut characters: Query<(Entity, &mut CharacterHandle)>,
) {
    let mut all: Vec<_> = characters.iter_mut().collect();
    all.sort_unstable_by_key(|(entity, _)| order(*entity));
    for (character, mut handle) in all {
        handle.character.update(&mut physics);
        register(&mut physics, character, &mut handle);
        for &event in handle.events() {
            both(&mut commands, CharacterTold { character, event });
        }
    }
}

/// Finds the joints of characters whose scenes have loaded.
pub(crate) fn find_joints(
    mut commands: Commands,
    waiting: Query<(Entity, &CharacterBody), Without<CharacterJoints>>,
    children: Query<&Children>,
    names: Query<&Name>,
) {
    for (entity, CharacterBody(def)) in &waiting {
        let joints = joints_below(entity, &def.rig, &children, &names);
        let skinned = def.rig.skins.iter().flat_map(|skin| &skin.joints);
        if skinned.clone().next().is_some() && skinned.clone().all(|&joint| joints[joint].is_some()) {
            commands.entity(entity).insert(CharacterJoints(joints));
        }
    }
}

/// Returns the entity of each joint: a child of the parent's entity with the joint's name; for a root, the nearest descendant. If a name
/// occurs several times, each entity is used once.
fn joints_below(
    root: Entity,
    rig: &Rig,
    children: &Query<&Children>,
    names: &Query<&Name>,
) -> Vec<Option<Entity>> {
    let mut found: Vec<Option<Entity>> = Vec::with_capacity(rig.joints.len());
    for joint in &rig.joints {
        // Bevy's loader gives these names to nameless nodes.
        let unnamed = format!("GltfNode{}", joint.source);
        let wanted = if joint.name.is_empty() { &unnamed } else { &joint.name };
        let from = joint.parent.map_or(Some(root), |parent| found[parent]);
        let depth = if joint.parent.is_some() { 1 } else { usize::MAX };
        let mut queue: VecDeque<(Entity, usize)> = from.into_iter().map(|from| (from, 0)).collect();
        let mut hit = None;
        while let Some((entity, level)) = queue.pop_front() {
            let named = names.get(entity).is_ok_and(|name| name.as_str() == wanted);
            if level > 0 && named && !found.contains(&Some(entity)) {
                hit = Some(entity);
                break;
            }
            if level < depth
                && let Ok(below) = children.get(entity)
            {
                queue.extend(below.iter().map(|child| (child, level + 1)));
            }
        }
        found.push(hit);
    }
    found
}

fn affine(affine: &Affine) -> Affine3A {
    let [x, y, z] = [affine.linear.x_axis, affine.linear.y_axis, affine.linear.z_axis].map(Vec3A::from);
    Affine3A { matrix3: Mat3A::from_cols(x, y, z), translation: affine.translation.into() }
}

/// Writes the transforms of characters and of their joints, interpolated between the last two steps.
pub(crate) fn write_characters(
    time: Res<Time<Fixed>>,
    interpolation: Res<crate::Interpolation>,
    mut characters: Query<(Entity, &mut CharacterHandle, Option<&CharacterJoints>, Has<BevyAnimation>)>,
    mut transforms: Query<&mut Transform>,
    mut pose: Local<Vec<LocalTransform>>,
) {
    let alpha = interpolation.alpha(&time);
    for (entity, mut handle, joints, is_led) in &mut characters {
        let place = handle.character.interpolated(alpha, &mut pose);
        let world_from_model = affine(&handle.def().mapping().world_from_model(place));
        if let Ok(mut transform) = transforms.get_mut(entity)
            // Changes by the user since the last step must be read first.
            && *transform == handle.transform
        {
            let new = Transform::from_matrix(world_from_model.into());
            if *transform != new {
                *transform = new;
                handle.transform = new;
            }
        }
        // Bevy would overwrite joints that it animates after this: see `animation`.
        if let Some(CharacterJoints(joints)) = joints.filter(|_| !is_led) {
            write_joints(joints, &pose, &mut transforms);
        }
    }
}

pub(crate) fn write_joints(
    joints: &[Option<Entity>],
    pose: &[LocalTransform],
    transforms: &mut Query<&mut Transform>,
) {
    for (joint, local) in joints.iter().zip(pose) {
        if let Some(mut transform) = joint.and_then(|joint| transforms.get_mut(joint).ok()) {
            transform.set_if_neq(to_place(local));
        }
    }
}
