//! A shooter with Bevy: `cargo run --example shooter`; in a window `cargo run -p window -- shooter`.
//!
//! A ray from the gun finds the limb of a character: a weak shot makes the character flinch, a strong one makes it fall. A mover walks
//! behind a wall and is not hit.

use bevy_app::{App, FixedUpdate, Startup};
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_sinew::physics::ray::Ray;
use bevy_sinew::sinew::ragdoll::State;
use bevy_sinew::{
    CharacterBody, CharacterHandle, Collider, Mover, MoverDef, MoverState, Physics, RigidBody, Shape,
    SinewPlugin, Walk,
};
use bevy_time::{TimePlugin, TimeUpdateStrategy};
use bevy_transform::components::Transform;
use std::sync::Arc;

/// Scheduled shots: step, limb, impulse, N·s.
#[derive(Resource)]
struct Shots(Vec<(u64, &'static str, f32)>);

fn setup(mut commands: Commands) {
    commands.spawn((RigidBody::Static, Collider::from(Shape::HalfSpace)));
    let wall = Collider::from(Shape::cuboid(Vec3::new(2.0, 1.0, 0.1)));
    commands.spawn((RigidBody::Static, wall, Transform::from_xyz(6.0, 1.0, 3.0)));
    commands.spawn(CharacterBody(Arc::new(bevy_sinew::sinew::mannequin::character())));
    let walk = Walk { velocity: Vec3::X * 2.0, ..Walk::default() };
    commands.spawn((Mover(MoverDef::default()), walk, Transform::from_xyz(3.0, 0.0, 0.0)));
}

fn shoot(
    mut physics: ResMut<Physics>,
    mut targets: Query<(Entity, &mut CharacterHandle)>,
    shots: Res<Shots>,
) {
    for &(step, limb, impulse) in &shots.0 {
        if physics.step_count() != step {
            continue;
        }
        for (entity, mut target) in &mut targets {
            let Some(body) = target.def().body_named(limb) else { continue };
            let aim = physics.center_of_mass(target.bodies()[body]);
            let shot = Ray { origin: aim + Vec3::Z * 20.0, direction: Vec3::Z * -40.0 };
            let Some(hit) = physics.query().first(&shot) else { continue };
            assert_eq!(physics.entity(hit.body), Some(entity), "a limb belongs to its character");
            target.hit_at(&mut physics, &hit, Vec3::Z * -impulse);
            println!("{limb}: {impulse} N·s, {:?}", target.state());
        }
    }
}

/// The target, the mover, and two shots.
pub fn plugin(app: &mut App) {
    app.insert_resource(Shots(vec![(60, "head", 5.0), (180, "chest", 90.0)]));
    app.add_systems(Startup, setup).add_systems(FixedUpdate, shoot);
}

/// Shoots twice.
pub fn main() {
    let mut app = App::new();
    app.add_plugins((TimePlugin, SinewPlugin::default(), plugin)); // in a game `DefaultPlugins` bring the first
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1)); // no window: as fast as it goes
    let mut seen = Vec::new();
    for _ in 0..240 {
        app.update();
        let world = app.world_mut();
        if let Ok(target) = world.query::<&CharacterHandle>().single(world)
            && seen.last() != Some(&target.state())
        {
            seen.push(target.state());
        }
    }
    println!("{seen:?}");
    assert_eq!(seen, [State::Animated, State::Flinching, State::Animated, State::Limp]);
    let world = app.world_mut();
    let (place, state) =
        world.query::<(&Transform, &MoverState)>().single(world).expect("one such entity exists");
    println!("the mover is at {:.2}", place.translation);
    assert!(place.translation.x > 9.0 && state.grounded);
}
