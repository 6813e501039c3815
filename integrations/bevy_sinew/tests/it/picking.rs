//! Picking by pointers.

use super::*;
use bevy_camera::Camera;
use bevy_math::Dir3;
use bevy_picking::backend::PointerHits;
use bevy_picking::backend::ray::{RayId, RayMap};
use bevy_picking::pointer::PointerId;
use bevy_shape::Ray3d;

#[test]
fn pointer_finds_the_body_under_it() {
    let mut app = app();
    app.init_resource::<RayMap>().add_message::<PointerHits>();
    app.add_plugins(SinewPickingPlugin);
    let floor = ground(&mut app);
    let ball = app.world_mut().spawn(ball(Vec3::Y * 0.25)).id();
    let camera = app.world_mut().spawn(Camera::default()).id();
    run(&mut app, 2);
    let ray = Ray3d { origin: Vec3::Y * 5.0, direction: Dir3::NEG_Y };
    app.world_mut().resource_mut::<RayMap>().map.insert(RayId::new(camera, PointerId::Mouse), ray);
    app.world_mut().resource_mut::<Messages<PointerHits>>().clear();
    run(&mut app, 1);
    let messages = app.world().resource::<Messages<PointerHits>>();
    let hits: Vec<&PointerHits> = messages.iter_current_update_messages().collect();
    assert_eq!((hits.len(), hits[0].pointer), (1, PointerId::Mouse));
    let mut picks: Vec<(Entity, f32)> = hits[0].picks.iter().map(|(one, data)| (*one, data.depth)).collect();
    picks.sort_by(|a, b| a.1.total_cmp(&b.1));
    assert_eq!((picks[0].0, picks[1].0), (ball, floor));
    assert!((picks[0].1 - 4.5).abs() < 0.01 && (picks[1].1 - 5.0).abs() < 0.01, "{picks:?}");
}
