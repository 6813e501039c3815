//! Picking of bodies by pointers.

use crate::Physics;
use bevy_app::{App, Plugin, PreUpdate};
use bevy_camera::Camera;
use bevy_ecs::prelude::*;
use bevy_picking::backend::ray::RayMap;
use bevy_picking::backend::{HitData, PointerHits};
use bevy_picking::{Pickable, PickingSystems};
use sinew_physics::BodyHit;
use sinew_physics::ray::Ray;

/// A backend of `bevy_picking` that casts rays at bodies: pointers find entities with a
/// [`RigidBody`](crate::RigidBody), and characters by their limbs. Needs Bevy's `PickingPlugin`, included in
/// `DefaultPlugins`.
#[derive(Clone, Copy, Debug, Default)]
pub struct SinewPickingPlugin;

impl Plugin for SinewPickingPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(PreUpdate, find.in_set(PickingSystems::Backend));
    }
}

/// Length of a pointer's ray, metres.
const REACH: f32 = 10_000.0;

fn find(
    physics: Res<Physics>,
    rays: Res<RayMap>,
    cameras: Query<&Camera>,
    pickable: Query<&Pickable>,
    mut out: MessageWriter<PointerHits>,
) {
    let mut hits: Vec<BodyHit> = Vec::new();
    for (id, ray) in rays.iter() {
        let Ok(camera) = cameras.get(id.camera) else { continue };
        let way = Ray { origin: ray.origin, direction: ray.direction * REACH };
        hits.clear();
        physics.query().all(&way, &mut hits);
        let pick = |hit: &BodyHit| {
            let entity = physics.entity(hit.body)?;
            let hoverable = pickable.get(entity).map_or(true, |pickable| pickable.is_hoverable);
            let data = HitData::new(id.camera, hit.fraction * REACH, Some(hit.point), Some(hit.normal));
            hoverable.then_some((entity, data))
        };
        let picks: Vec<_> = hits.iter().filter_map(pick).collect();
        if !picks.is_empty() {
            out.write(PointerHits::new(id.pointer, picks, camera.order as f32));
        }
    }
}
