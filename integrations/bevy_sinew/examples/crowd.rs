//! A crowd with Bevy: `cargo run --release --example crowd`; in a window `cargo run -p window -- crowd`.
//!
//! Forty characters walk on a square; those far from the camera have less detail. Now and then one of them faints.

use bevy_app::{App, FixedUpdate, Startup};
use bevy_ecs::prelude::*;
use bevy_math::{Quat, Vec3};
use bevy_sinew::sinew::ragdoll::{Detail, Distances, State};
use bevy_sinew::{CharacterBody, CharacterHandle, Collider, Physics, RigidBody, Shape, SinewPlugin};
use bevy_time::{TimePlugin, TimeUpdateStrategy};
use bevy_transform::components::Transform;
use std::sync::Arc;

/// Position of the viewer, metres.
const CAMERA: Vec3 = Vec3::new(0.0, 1.7, -6.0);

fn setup(mut commands: Commands) {
    commands.spawn((RigidBody::Static, Collider::from(Shape::HalfSpace)));
    let def = Arc::new(bevy_sinew::sinew::mannequin::character()); // one for all
    for i in 0..40 {
        let place = Vec3::new((i % 8) as f32 * 3.0 - 10.5, 0.0, (i / 8) as f32 * 10.0);
        let turn = Quat::from_rotation_y(0.7 * i as f32);
        let place = Transform { translation: place, rotation: turn, ..Transform::default() };
        commands.spawn((CharacterBody(def.clone()), place));
    }
}

/// Makes the first character of each row faint.
fn faint(mut physics: ResMut<Physics>, mut crowd: Query<&mut CharacterHandle>) {
    if physics.step_count() == 60 {
        for mut character in crowd.iter_mut().step_by(8) {
            character.go_limp(&mut physics);
        }
    }
}

fn choose_detail(mut physics: ResMut<Physics>, mut crowd: Query<&mut CharacterHandle>) {
    let distances = Distances::default();
    for mut character in &mut crowd {
        let distance = (character.world_from_character().translation - CAMERA).length();
        let detail = distances.detail(distance, character.level_of_detail());
        character.set_level_of_detail(&mut physics, detail);
    }
}

/// Spawns the crowd and updates it.
pub fn plugin(app: &mut App) {
    app.add_systems(Startup, setup).add_systems(FixedUpdate, (faint, choose_detail).chain());
}

/// Lets the crowd walk for three seconds.
pub fn main() {
    let mut app = App::new();
    app.add_plugins((TimePlugin, SinewPlugin::default(), plugin)); // in a game `DefaultPlugins` bring the first
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1)); // no window: as fast as it goes
    (0..180).for_each(|_| app.update());
    let world = app.world_mut();
    let crowd: Vec<(Detail, State)> = world
        .query::<&CharacterHandle>()
        .iter(world)
        .map(|one| (one.level_of_detail(), one.state()))
        .collect();
    let of = |detail| crowd.iter().filter(|one| one.0 == detail).count();
    let fallen = crowd.iter().filter(|one| one.1 != State::Animated).count();
    let (full, hit_bodies, keyed) = (of(Detail::Full), of(Detail::HitBodies), of(Detail::Keyed));
    println!("{full} in full, {hit_bodies} with hit bodies, {keyed} keyed; {fallen} lie or get up");
    assert!(full > 5 && hit_bodies > 10 && keyed > 3 && fallen == 5);
}
