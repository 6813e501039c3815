//! A door with Bevy: `cargo run --example door`; in a window `cargo run -p window -- door`.
//!
//! A mover pushes a door open, a lamp hangs from a rope beside it, and a motor closes the door behind the mover.

use bevy_app::{App, FixedUpdate, Startup};
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_sinew::math::Range;
use bevy_sinew::physics::Motor;
use bevy_sinew::physics::particles::RopeDef;
use bevy_sinew::{
    BodyHandle, Collider, Hang, Joint, JointHandle, JointKind, Mover, MoverDef, Particles, Physics,
    RigidBody, Shape, ShapeDef, SinewPlugin, Walk,
};
use bevy_time::{TimePlugin, TimeUpdateStrategy};
use bevy_transform::components::Transform;

#[derive(Component)]
struct Lamp;

fn setup(mut commands: Commands) {
    commands.spawn((RigidBody::Static, Collider::from(Shape::HalfSpace)));
    let wall = |x: f32| {
        let shape = Shape::cuboid(Vec3::new(0.95, 1.2, 0.05));
        (RigidBody::Static, Collider::from(shape), Transform::from_xyz(x, 1.2, 1.5))
    };
    let frame = commands.spawn(wall(-1.5)).id();
    commands.spawn(wall(1.5));
    let leaf = ShapeDef { density: 300.0, ..ShapeDef::new(Shape::cuboid(Vec3::new(0.5, 1.0, 0.02))) };
    let leaf = (RigidBody::Dynamic, Collider::from(leaf), Transform::from_xyz(0.0, 1.02, 1.5));
    let leaf = commands.spawn(leaf).id();
    let kind = JointKind::Hinge { limit: Some(Range::degrees(-120.0, 120.0)) };
    commands.spawn(Joint { a: frame, b: leaf, anchor: Vec3::new(-0.5, 1.02, 1.5), axis: Vec3::Y, kind });
    let walk = Walk { velocity: Vec3::Z * 1.2, ..Walk::default() };
    commands.spawn((Mover(MoverDef::default()), walk));

    let top = Vec3::new(2.0, 3.0, 0.0);
    let hook = commands.spawn((RigidBody::Static, Transform::from_translation(top))).id();
    let lamp =
        (Lamp, RigidBody::Dynamic, Collider::from(Shape::sphere(0.1)), Transform::from_xyz(3.1, 3.0, 0.0));
    let lamp = commands.spawn(lamp).id();
    let to = top + Vec3::X;
    let rope = RopeDef { from: top, to, links: 10, mass: 0.1, stiffness: 10_000.0, radius: 0.01 }.build();
    let hangs = vec![
        Hang { particle: rope.first, body: hook, point: Vec3::ZERO },
        Hang { particle: rope.last, body: lamp, point: Vec3::X * -0.1 },
    ];
    commands.spawn(Particles { def: rope.group, hangs });
}

fn angle(app: &mut App) -> f32 {
    let world = app.world_mut();
    let hinge = world.query::<&JointHandle>().single(world).expect("one such entity exists").id();
    world.resource::<Physics>().joint_transform(hinge).rotation.twist_angle(Vec3::X).to_degrees().abs()
}

/// Sets a motor through the resource: after 2.5 s the door gets one.
fn shut(mut physics: ResMut<Physics>, hinges: Query<&JointHandle>) {
    if physics.step_count() != 150 {
        return;
    }
    for hinge in &hinges {
        let turn = physics.joint_transform(hinge.id()).rotation.twist_angle(Vec3::X);
        physics.set_motor(hinge.id(), Some(Motor::spin(-turn.signum(), 100.0)));
    }
}

/// The door, the mover and the lamp.
pub fn plugin(app: &mut App) {
    app.add_systems(Startup, setup).add_systems(FixedUpdate, shut);
}

/// Runs until the mover is through the door.
pub fn main() {
    let mut app = App::new();
    app.add_plugins((TimePlugin, SinewPlugin::default(), plugin)); // in a game `DefaultPlugins` bring the first
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1)); // no window: as fast as it goes
    (0..150).for_each(|_| app.update());
    let open = angle(&mut app);
    let world = app.world_mut();
    let mover = world
        .query_filtered::<&Transform, With<Mover>>()
        .single(world)
        .expect("one such entity exists")
        .translation;
    println!("the mover is at {mover:.2}, the door is open by {open:.0}°");
    assert!(mover.z > 2.0 && open > 30.0);

    let mut least = open;
    for _ in 0..180 {
        app.update();
        least = least.min(angle(&mut app));
    }
    println!("it was shut to {least:.1}°");
    assert!(least < 5.0);

    let world = app.world_mut();
    let lamp = world.query_filtered::<(&Transform, &BodyHandle), With<Lamp>>().single(world).expect("a lamp");
    let down = Vec3::new(2.0, 3.0, 0.0) - lamp.0.translation;
    println!("the lamp hangs {:.2} m from its hook", down.length());
    assert!((down.length() - 1.1).abs() < 0.05);
}
