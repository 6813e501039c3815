//! Shapes of bodies: those of their own entity and of the entities below, with the surface components of each.

use crate::bodies::{BodyHandle, Collider, RigidBody, point};
use crate::properties::{Friction, Layers, Mass, Restitution, Sensor};
use crate::{Physics, order};
use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_math::Affine3A;
use bevy_transform::components::Transform;
use sinew_math::{Sym3, Transform as Pose};
use sinew_physics::{BodyId, Filter, MassProperties, MassUpdate, Sensing, ShapeDef, ShapeId};

/// Body above an entity with a [`Collider`] and without a [`RigidBody`]: the entity's shapes belong to that body.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct ColliderOf {
    body: Entity,
    body_from_collider: Pose,
}

impl ColliderOf {
    /// Returns the entity of the body.
    pub fn body(&self) -> Entity {
        self.body
    }
}

/// Components that define the shapes of an entity.
#[derive(QueryData)]
pub(crate) struct Surface {
    collider: Ref<'static, Collider>,
    friction: Option<Ref<'static, Friction>>,
    restitution: Option<Ref<'static, Restitution>>,
    layers: Option<Ref<'static, Layers>>,
    sensor: Option<Ref<'static, Sensor>>,
}

impl SurfaceItem<'_, '_> {
    /// Returns the shapes, with the surface properties of the components.
    fn shapes(&self) -> impl Iterator<Item = ShapeDef> + '_ {
        self.collider.0.iter().map(|shape| {
            let mut shape = shape.clone();
            if let Some(friction) = &self.friction {
                shape.material.friction = friction.0;
                shape.material.static_friction = None;
            }
            if let Some(restitution) = &self.restitution {
                shape.material.restitution = restitution.0;
            }
            if let Some(layers) = &self.layers {
                shape.filter = Filter { layers: layers.layers, mask: layers.mask, ..shape.filter };
            }
            if self.sensor.is_some() {
                shape.sensing = Sensing::Sensor;
            }
            shape
        })
    }

    pub(crate) fn own_shapes(&self) -> Vec<ShapeDef> {
        self.shapes().collect()
    }

    fn is_changed(&self) -> bool {
        self.collider.is_changed()
            || self.friction.as_ref().is_some_and(|friction| friction.is_changed())
            || self.restitution.as_ref().is_some_and(|restitution| restitution.is_changed())
            || self.layers.as_ref().is_some_and(|layers| layers.is_changed())
            || self.sensor.as_ref().is_some_and(|sensor| sensor.is_changed())
    }
}

/// Adds observers that mark a body for [`change_shapes`] when a component of it, or of an entity below it, is removed.
pub(crate) fn add_observers(app: &mut App) {
    app.add_observer(mark::<Friction>).add_observer(mark::<Restitution>).add_observer(mark::<Layers>);
    app.add_observer(mark::<Sensor>).add_observer(mark::<Mass>);
    app.add_observer(mark_owner).add_observer(leave);
}

fn mark<T: Component>(removed: On<Remove<T>>, owners: Query<&ColliderOf>, physics: Option<ResMut<Physics>>) {
    let entity = removed.event().entity;
    let Some(mut physics) = physics else { return };
    physics.stale.insert(owners.get(entity).map_or(entity, |owner| owner.body));
}

fn mark_owner(removed: On<Remove<ColliderOf>>, owners: Query<&ColliderOf>, physics: Option<ResMut<Physics>>) {
    if let (Ok(owner), Some(mut physics)) = (owners.get(removed.event().entity), physics) {
        physics.stale.insert(owner.body);
    }
}

/// Removes the body of an entity without a collider.
fn leave(removed: On<Remove<Collider>>, mut commands: Commands) {
    commands.entity(removed.event().entity).try_remove::<ColliderOf>();
}

/// Finds the body above each collider, and the collider's pose on the body.
pub(crate) fn find_bodies(
    mut commands: Commands,
    mut physics: ResMut<Physics>,
    colliders: Query<(Entity, Option<&ColliderOf>), (With<Collider>, Without<RigidBody>)>,
    bodies: Query<Entity, (With<ColliderOf>, With<RigidBody>)>,
    parents: Query<&ChildOf>,
    transforms: Query<&Transform>,
    is_body: Query<(), With<RigidBody>>,
) {
    for entity in &bodies {
        commands.entity(entity).remove::<ColliderOf>();
    }
    for (entity, before) in &colliders {
        let mut affine = Affine3A::IDENTITY;
        let mut below = Some(entity);
        let body = parents.iter_ancestors(entity).find(|&above| {
            let local = below.replace(above).and_then(|below| transforms.get(below).ok());
            affine = local.map_or(Affine3A::IDENTITY, Transform::compute_affine) * affine;
            is_body.contains(above)
        });
        let now = body.map(|body| {
            let local = Transform::from_matrix(affine.into());
            ColliderOf { body, body_from_collider: crate::pose::to_pose(&local) }
        });
        if before == now.as_ref() {
            continue;
        }
        for owner in [before, now.as_ref()].into_iter().flatten() {
            physics.stale.insert(owner.body);
        }
        match now {
            Some(now) => commands.entity(entity).insert(now),
            None => commands.entity(entity).remove::<ColliderOf>(),
        };
    }
}

/// Applies the shapes and the mass of changed components to bodies, which keep their ids.
pub(crate) fn change_shapes(
    mut physics: ResMut<Physics>,
    mut bodies: Query<(Entity, &mut BodyHandle, &RigidBody, Surface, Option<Ref<Mass>>)>,
    below: Query<(Entity, &ColliderOf, Surface), Without<RigidBody>>,
) {
    let mut stale = core::mem::take(&mut physics.stale);
    stale.extend(below.iter().filter(|(.., surface)| surface.is_changed()).map(|(_, owner, _)| owner.body));
    for (entity, .., surface, mass) in &bodies {
        if surface.is_changed() || mass.is_some_and(|mass| mass.is_changed()) {
            stale.insert(entity);
        }
    }
    if stale.is_empty() {
        return;
    }
    let mut children: Vec<_> = below.iter().collect();
    children.sort_unstable_by_key(|&(child, owner, _)| (owner.body, order(child)));
    let id = |entity: Entity| bodies.get(entity).ok().map(|(_, handle, ..)| (handle.id(), entity));
    let mut stale: Vec<_> = stale.into_iter().filter_map(id).collect();
    stale.sort_unstable();
    for (_, entity) in stale {
        let Ok((_, mut handle, &kind, surface, mass)) = bodies.get_mut(entity) else { continue };
        let mut shapes = surface.own_shapes();
        let first = children.partition_point(|(_, owner, _)| owner.body < entity);
        for (_, owner, surface) in children[first..].iter().take_while(|(_, owner, _)| owner.body == entity) {
            shapes.extend(surface.shapes().map(|shape| {
                let body_from_shape = owner.body_from_collider * shape.body_from_shape;
                ShapeDef { body_from_shape, ..shape }
            }));
        }
        let mass = mass.map(|mass| mass.0);
        let is_new = replace_shapes(&mut physics, handle.id(), &shapes);
        if kind == RigidBody::Dynamic && (is_new || handle.mass != mass) {
            set_mass(&mut physics, handle.id(), &shapes, mass);
            handle.mass = mass;
        }
    }
}

/// Replaces the shapes of a body that differ; returns true if any did.
fn replace_shapes(physics: &mut Physics, body: BodyId, shapes: &[ShapeDef]) -> bool {
    let now: Vec<ShapeDef> = physics.shape_ids(body).map(|id| physics.shape_def(id)).collect();
    if now == shapes {
        return false;
    }
    let common = now.len().min(shapes.len());
    for (shape, def) in shapes.iter().enumerate() {
        if shape < common {
            physics.set_shape(ShapeId { body, shape: shape as u32 }, def, MassUpdate::Keep);
        } else {
            physics.add_shape(body, def, MassUpdate::Keep);
        }
    }
    for shape in (common..now.len()).rev() {
        physics.remove_shape(ShapeId { body, shape: shape as u32 }, MassUpdate::Keep);
    }
    true
}

/// Sets the mass of a body: that of its shapes, or `mass` distributed like them. A body without shapes is a point.
fn set_mass(physics: &mut Physics, body: BodyId, shapes: &[ShapeDef], mass: Option<f32>) {
    if shapes.is_empty() {
        physics.set_mass(body, point(mass));
        return;
    }
    physics.set_mass_of_shapes(body);
    if let Some(mass) = mass {
        let of_shapes = physics.mass(body);
        let factor = mass / of_shapes.mass;
        let inertia =
            Sym3 { diagonal: of_shapes.inertia.diagonal * factor, off: of_shapes.inertia.off * factor };
        physics.set_mass(body, MassProperties { mass, inertia, ..of_shapes });
    }
}
