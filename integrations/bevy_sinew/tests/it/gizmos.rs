//! Debug lines.

use super::*;
use bevy_asset::{AssetPlugin, Assets};
use bevy_gizmos::{GizmoAsset, GizmoHandles, GizmoPlugin};
use bevy_sinew::physics::DrawKind;
use core::any::TypeId;

#[test]
fn world_is_drawn_in_its_colours() {
    let mut app = app();
    app.add_plugins((bevy_app::TaskPoolPlugin::default(), AssetPlugin::default(), GizmoPlugin));
    app.add_plugins(SinewGizmosPlugin);
    ground(&mut app);
    app.world_mut().spawn(ball(Vec3::Y * 0.25));
    run(&mut app, 3);
    let handle = app.world().resource::<GizmoHandles>().handles()[&TypeId::of::<PhysicsGizmos>()].clone();
    let asset = app.world().resource::<Assets<GizmoAsset>>().get(&handle.expect("something was drawn"));
    let colors = asset.expect("the asset exists").buffer().list_colors.clone();
    let of = |kind: DrawKind| {
        let wanted = GizmoColors::default().of(kind).into();
        colors.iter().filter(|&&color| color == wanted).count()
    };
    assert!(of(DrawKind::Static) > 0 && of(DrawKind::Awake) > 10 && of(DrawKind::Contact) > 0);
}
