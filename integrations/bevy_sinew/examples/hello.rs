//! The first program with Bevy: `cargo run --example hello`; in a window `cargo run -p window -- hello`.
//!
//! A box falls on the ground, and an observer is notified.

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_sinew::{Collider, HitTold, RigidBody, Shape, SinewPlugin};
use bevy_time::{TimePlugin, TimeUpdateStrategy};
use bevy_transform::components::Transform;

fn thud(hit: On<HitTold>) {
    println!("{} hits {} at {:.1} m/s", hit.b, hit.a, hit.approach);
}

#[derive(Component)]
struct Falling;

/// A box 2 m above the ground.
pub fn plugin(app: &mut App) {
    app.add_observer(thud);
    app.world_mut().spawn((RigidBody::Static, Collider::from(Shape::HalfSpace)));
    let shape = Shape::cuboid(Vec3::splat(0.5));
    let place = Transform::from_xyz(0.0, 2.5, 0.0);
    app.world_mut().spawn((Falling, RigidBody::Dynamic, Collider::from(shape), place));
}

fn height(app: &mut App) -> f32 {
    let world = app.world_mut();
    let place =
        world.query_filtered::<&Transform, With<Falling>>().single(world).expect("one such entity exists");
    place.translation.y
}

/// Shows a falling box.
pub fn main() {
    let mut app = App::new();
    app.add_plugins((TimePlugin, SinewPlugin::default(), plugin)); // in a game `DefaultPlugins` bring the first
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1)); // no window: as fast as it goes
    for frame in 0..120 {
        app.update();
        if frame % 20 == 0 {
            println!("frame {frame}: {:.3} m", height(&mut app));
        }
    }
    assert!((height(&mut app) - 0.5).abs() < 0.01, "it is not on the ground");
}
