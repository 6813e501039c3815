//! Components in the type registry.

use super::*;
use bevy_ecs::entity::EntityHashMap;
use bevy_ecs::reflect::AppTypeRegistry;
use bevy_reflect::serde::{ReflectDeserializer, ReflectSerializer};
use bevy_reflect::{FromReflect, PartialReflect};
use bevy_sinew::physics::particles::RopeDef;
use serde::de::DeserializeSeed;

fn round<T: FromReflect + PartialReflect>(app: &App, value: &T) -> T {
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let text = serde_json::to_string(&ReflectSerializer::new(value, &registry))
        .expect("the value can be serialised");
    let mut read = serde_json::Deserializer::from_str(&text);
    let back =
        ReflectDeserializer::new(&registry).deserialize(&mut read).expect("the value can be deserialised");
    T::from_reflect(&*back).unwrap_or_else(|| panic!("{text} is one"))
}

#[test]
fn components_round_trip_through_a_scene() {
    let app = app();
    let shapes = vec![Shape::sphere(0.25).into(), Shape::cuboid(Vec3::splat(0.5)).into()];
    assert_eq!(round(&app, &Collider(shapes.clone())), Collider(shapes));
    assert_eq!(round(&app, &RigidBody::Kinematic), RigidBody::Kinematic);
    let velocity = Velocity { linear: Vec3::X, angular: Vec3::Y };
    assert_eq!(round(&app, &velocity), velocity);
    let up = Field(FieldDef::new(FieldKind::Uniform(UniformGravity { acceleration: Vec3::Y })));
    assert_eq!(round(&app, &up), up);
    let (a, b) = (Entity::from_raw_u32(1).expect("an index"), Entity::from_raw_u32(2).expect("an index"));
    let joint = Joint { a, b, anchor: Vec3::X, axis: Vec3::Z, kind: JointKind::Hinge { limit: None } };
    assert_eq!(round(&app, &joint), joint);
    let walk = Walk { velocity: Vec3::X, jump: 1.0 };
    assert_eq!(round(&app, &walk), walk);
    let mover = Mover(MoverDef { height: 1.5, ..MoverDef::default() });
    assert_eq!(round(&app, &mover), mover);
    let (from, to) = (Vec3::ZERO, Vec3::X);
    let rope = RopeDef { from, to, links: 4, mass: 1.0, stiffness: 1e4, radius: 0.02 }.build().group;
    let particles = Particles { def: rope, hangs: vec![Hang { particle: 0, body: a, point: Vec3::X }] };
    assert_eq!(round(&app, &particles), particles);
    // Spawned entities of a scene have other ids.
    let mut spawned = particles;
    Component::map_entities(&mut spawned, &mut EntityHashMap::from_iter([(a, b)]));
    assert_eq!(spawned.hangs[0].body, b);
}
