//! The first program with Bevy, without a window: `cargo run --example hello`.
//!
//! A box falls on the ground; an observer hears of it.

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_sinew::{Collider, HitTold, RigidBody, Shape, SinewPlugin};
use bevy_time::{TimePlugin, TimeUpdateStrategy};
use bevy_transform::components::Transform;

fn thud(hit: On<HitTold>) {
    println!("{} hits {} at {:.1} m/s", hit.b, hit.a, hit.approach);
}

/// Drops a box from 2 m.
pub fn main() {
    let mut app = App::new();
    app.add_plugins((TimePlugin, SinewPlugin::default())); // in a game `DefaultPlugins` bring the first
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1)); // no window: as fast as it goes
    app.add_observer(thud);
    app.world_mut().spawn((RigidBody::Static, Collider::from(Shape::HalfSpace)));
    let shape = Shape::cuboid(Vec3::splat(0.5));
    let place = Transform::from_xyz(0.0, 2.5, 0.0);
    let falling = app.world_mut().spawn((RigidBody::Dynamic, Collider::from(shape), place)).id();
    for frame in 0..120 {
        app.update();
        if frame % 20 == 0 {
            let height = app.world().get::<Transform>(falling).map(|place| place.translation.y);
            println!("frame {frame}: {:.3} m", height.unwrap_or_default());
        }
    }
    let height = app.world().get::<Transform>(falling).map(|place| place.translation.y);
    assert!(height.is_some_and(|height| (height - 0.5).abs() < 0.01), "it lies on the ground");
}
