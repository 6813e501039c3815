//! A character with Bevy: `cargo run --example character`; in a window `cargo run -p window -- character`.
//!
//! The character walks, is hit, falls, gets up and walks on. The joints that it moves are entities, like those of a
//! loaded scene.

use bevy_app::{App, FixedUpdate, PostStartup, Startup};
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_sinew::sinew::ragdoll::{CharacterDef, CharacterEvent as Told, State};
use bevy_sinew::{
    CharacterBody, CharacterHandle, CharacterTold, Collider, Physics, RigidBody, Shape, SinewPlugin,
};
use bevy_time::{TimePlugin, TimeUpdateStrategy};
use bevy_transform::components::Transform;
use std::sync::Arc;

/// Spawns the joints of a rig as named entities, as Bevy's loader does. In a game this is a `WorldAssetRoot`.
fn scene(mut commands: Commands, heroes: Query<(Entity, &CharacterBody)>) {
    for (root, CharacterBody(def)) in &heroes {
        let mut joints: Vec<Entity> = Vec::new();
        for joint in &def.rig.joints {
            let parent = joint.parent.map_or(root, |parent| joints[parent]);
            let bundle = (Name::new(joint.name.clone()), Transform::default(), ChildOf(parent));
            joints.push(commands.spawn(bundle).id());
        }
    }
}

fn kind() -> CharacterDef {
    #[cfg(feature = "gltf")]
    if let Some(path) = std::env::args().find(|path| path.ends_with(".glb")) {
        let bytes = std::fs::read(&path).expect("the file can be read");
        let file =
            bevy_sinew::read_character(&bytes, &path, &Default::default()).expect("the file is a character");
        return CharacterDef::clone(&file.def);
    }
    bevy_sinew::sinew::mannequin::character()
}

fn setup(mut commands: Commands) {
    commands.spawn((RigidBody::Static, Collider::from(Shape::HalfSpace)));
    commands.spawn(CharacterBody(Arc::new(kind())));
}

/// Hits the character once, after a second and a half.
fn hit(mut physics: ResMut<Physics>, mut heroes: Query<&mut CharacterHandle>) {
    for mut hero in &mut heroes {
        hero.set_move(Vec3::Z * 1.2);
        if physics.step_count() == 90 {
            let chest = hero.def().body_named("chest").unwrap_or(0);
            hero.hit(&mut physics, chest, Vec3::new(60.0, 0.0, -60.0));
        }
    }
}

#[derive(Resource, Default)]
struct Heard(Vec<Told>);

fn tell(told: On<CharacterTold>, mut heard: ResMut<Heard>, physics: Res<Physics>) {
    if !matches!(told.event, Told::Clip(_)) {
        println!("{:5.2} s: {:?}", physics.time(), told.event);
    }
    heard.0.push(told.event);
}

/// Spawns the character and hits it.
pub fn plugin(app: &mut App) {
    app.init_resource::<Heard>().add_observer(tell);
    app.add_systems(Startup, setup).add_systems(FixedUpdate, hit);
}

/// Shows a character that walks and falls.
pub fn main() {
    let mut app = App::new();
    app.add_plugins((TimePlugin, SinewPlugin::default(), plugin)); // in a game `DefaultPlugins` bring the first
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1)); // no window: as fast as it goes
    app.add_systems(PostStartup, scene);
    (0..900).for_each(|_| app.update());

    let heard = &app.world().resource::<Heard>().0;
    for due in [Told::WentLimp, Told::Up] {
        assert!(heard.contains(&due), "{due:?} in {heard:?}");
    }
    let world = app.world_mut();
    let (hero, place) =
        world.query::<(&CharacterHandle, &Transform)>().single(world).expect("one such entity exists");
    println!("it is {:?}, at {:.2}", hero.state(), place.translation);
    assert!(hero.state() == State::Animated && place.translation.z > 3.0);
}
