//! The first program with a window, as README prints it: `cargo +1.97.1 run -p window --example first`.

use bevy::prelude::*;
use bevy_sinew::prelude::*;

fn main() {
    let mut app = App::new();
    app.add_plugins((DefaultPlugins, SinewPlugin::default())).add_systems(Startup, setup);
    app.run();
}

/// A ball of 20 kg flies into a tower of boxes.
fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((Camera3d::default(), Transform::from_xyz(3.0, 2.5, 7.0).looking_at(Vec3::Y, Vec3::Y)));
    commands.spawn((
        DirectionalLight::default(),
        Transform::from_xyz(2.0, 5.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    let [gray, orange, blue] =
        [Color::srgb(0.5, 0.5, 0.5), Color::srgb(0.9, 0.5, 0.1), Color::srgb(0.1, 0.4, 0.8)]
            .map(|color| MeshMaterial3d(materials.add(color)));

    let plane = Mesh3d(meshes.add(Plane3d::default().mesh().size(20.0, 20.0)));
    commands.spawn((RigidBody::Static, Collider::from(Shape::HalfSpace), plane, gray));

    let cube = Mesh3d(meshes.add(Cuboid::from_length(0.5)));
    for number in 0..8 {
        let collider = Collider::from(Shape::cuboid(Vec3::splat(0.25))); // half extents, metres
        let place = Transform::from_xyz(0.0, 0.25 + 0.5 * number as f32, 0.0);
        commands.spawn((RigidBody::Dynamic, collider, place, cube.clone(), orange.clone()));
    }

    let ball = (RigidBody::Dynamic, Collider::from(Shape::sphere(0.3)), Mass(20.0));
    let flies = Velocity { linear: Vec3::new(12.0, 2.0, 0.0), ..default() };
    let sphere = Mesh3d(meshes.add(Sphere::new(0.3)));
    commands.spawn((ball, flies, Transform::from_xyz(-6.0, 1.5, 0.0), sphere, blue));
}
