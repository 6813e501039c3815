//! A door and a cape: `cargo run -p sinew --example door_and_cape`.
//!
//! A walker pushes a door open and walks through, falls, and drops its sword. The cape hangs on the chest's body in
//! every state.

use sinew::prelude::*;
use std::sync::Arc;

/// Adds a door on a hinge between two walls, 1.5 m ahead.
fn door(world: &mut World) -> BodyId {
    let cuboid = |x: f32, y: f32, z: f32| Shape::Box { half_extents: Vec3::new(x, y, z) };
    let wall = |x: f32| BodyDef::fixed(cuboid(0.95, 1.2, 0.05)).at(Vec3::new(x, 1.2, 1.5));
    let walls = [-1.5, 1.5].map(|x| world.add_body(&wall(x)));
    let leaf = ShapeDef { density: 500.0, ..ShapeDef::new(cuboid(0.5, 1.0, 0.02)) };
    let leaf = world.add_body(&BodyDef::dynamic(leaf).at(Vec3::new(0.0, 1.02, 1.5)));
    let hinge = world.hinge(walls[0], leaf, Vec3::new(-0.5, 1.02, 1.5), Vec3::Y);
    world.add_joint(&JointDef { friction_torque: 20.0, ..hinge });
    leaf
}

/// Adds a cape whose first row is attached to a body.
fn cape(world: &mut World, chest: BodyId, shoulders: Vec3) -> GroupId {
    let mut cloth = ClothDef {
        corner: shoulders + Vec3::X * 0.2,
        across: Vec3::X * -0.4,
        down: Vec3::Y * -0.9,
        columns: 6,
        rows: 12,
        mass: 0.4,
        stretching: 1000.0,
        shearing: 100.0,
        bending: 1e-5,
        damping_ratio: 0.2,
        radius: 0.012,
    }
    .build();
    for particle in cloth.row(0) {
        let place = cloth.group.particles[particle as usize].position;
        let point = world.transform(chest).inverse_point(place);
        let target = AttachmentTarget::Body { body: chest, point };
        cloth.group.attachments.push(AttachmentDef { particle, target });
    }
    world.add_particles(&cloth.group)
}

/// Lets a character walk through the door and fall behind it.
pub fn main() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let leaf = door(&mut world);
    let def = Arc::new(sinew::mannequin::character());
    let mut hero = Character::spawn(&mut world, &def, Transform::IDENTITY);
    let chest = hero.bodies()[hero.def().body_named("chest").expect("the character has this body")];
    let cape = cape(&mut world, chest, Vec3::new(0.0, 1.42, -0.17));
    let blade = Shape::Box { half_extents: Vec3::new(0.01, 0.01, 0.4) };
    let sword = world.add_body(&BodyDef::dynamic(blade));
    let bone_from_held = Transform::from_translation(Vec3::Z * 0.35);
    hero.hold(&mut world, "rightHand", sword, &Grip { bone_from_held, drops: true, ..Grip::default() });
    let mut told = Vec::new();
    for frame in 0..540 {
        world.step();
        hero.update(&mut world);
        told.extend_from_slice(hero.events());
        let hem = world.particles(cape).positions()[45] - world.transform(chest).translation;
        assert!(hem.length() < 0.9, "the cape stays attached: {hem}");
        if frame == 239 {
            let turned = world.transform(leaf).rotation.to_scaled_axis().length().to_degrees();
            let at = hero.world_from_character().translation.z;
            println!("the door is open by {turned:.0}°, it is at {at:.1} m");
            assert!(at > 2.5 && turned > 20.0 && hero.held().count() == 1);
            hero.hit(&mut world, 2, Vec3::Z * 90.0);
        }
    }
    assert!(told.iter().any(|event| matches!(event, CharacterEvent::LetGo { held, .. } if *held == sword)));
    assert!(world.transform(sword).translation.y < 0.1);
}
