//! Colliders from drawn meshes.

use super::*;
use bevy_asset::{AssetApp, AssetPlugin, Assets};
use bevy_mesh::{Mesh, Mesh3d, PrimitiveTopology};

/// Returns a square of two triangles that faces up, with sides of 2 m.
fn square() -> Mesh {
    let corners = vec![[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]];
    let usages = bevy_asset::RenderAssetUsages::default();
    let mesh = Mesh::new(PrimitiveTopology::TriangleList, usages);
    let indices = bevy_mesh::Indices::U32(vec![0, 2, 1, 0, 3, 2]);
    mesh.with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, corners).with_inserted_indices(indices)
}

#[test]
fn drawn_meshes_become_colliders() {
    let mut app = App::new();
    app.add_plugins((bevy_app::TaskPoolPlugin::default(), TimePlugin, AssetPlugin::default()));
    app.init_asset::<Mesh>();
    app.add_plugins((SinewPlugin::default(), SinewMeshPlugin));
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    let handle = app.world().resource::<Assets<Mesh>>().reserve_handle();
    // Twice as large, and mirrored.
    let scale = Transform { scale: Vec3::new(-2.0, 1.0, 2.0), ..Transform::from_xyz(0.0, 1.0, 0.0) };
    let floor = (RigidBody::Static, MeshCollider::Triangles, Mesh3d(handle.clone()), scale);
    let floor = app.world_mut().spawn(floor).id();
    run(&mut app, 3);
    assert!(app.world().get::<Collider>(floor).expect("an empty one").0.is_empty());
    app.world_mut().resource_mut::<Assets<Mesh>>().insert(&handle, square()).expect("the mesh can be stored");
    run(&mut app, 1);
    let ball = app.world_mut().spawn(ball(Vec3::new(1.7, 2.0, 1.7))).id();
    run(&mut app, 120);
    assert!((at(&app, ball).y - 1.25).abs() < 0.01, "{}", at(&app, ball));
    let flat = MeshCollider::Hull.of(&square(), Vec3::ONE);
    assert!(matches!(flat, Err(MeshColliderError::Hull(_))), "{flat:?}");
    let lines = Mesh::new(PrimitiveTopology::LineList, bevy_asset::RenderAssetUsages::default());
    assert!(MeshCollider::Triangles.of(&lines, Vec3::ONE).is_err());
}
