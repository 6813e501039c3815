//! The shape library, snapshots that refer to it, and damaged bytes.

use super::{box_hull, pebble};
use crate::build::floor;
use sinew_math::{Random, Reader, Vec3, Writer};
use sinew_physics::*;

fn saved(world: &World) -> Vec<u8> {
    let mut w = Writer::new();
    world.save(&mut w);
    w.into_bytes()
}

fn library(world: &World) -> Vec<u8> {
    let mut w = Writer::new();
    world.save_shapes(&mut w);
    w.into_bytes()
}

fn body(shape: Shape, position: Vec3) -> BodyDef {
    BodyDef { position, shapes: vec![ShapeDef::new(shape)], ..BodyDef::default() }
}

/// Returns a world with falling hulls, and a wind inside a hull.
fn pebbles() -> World {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let mut random = Random::new(16);
    for k in 0..6 {
        world.add_body(&body(pebble(0.2, &mut random), Vec3::new(0.1 * k as f32, 0.5 + 0.5 * k as f32, 0.0)));
    }
    let shape = pebble(3.0, &mut random);
    let region = Region::Inside {
        shape,
        world_from_shape: sinew_math::Transform::IDENTITY,
        margin: 0.5,
        fade: Fade::Linear,
    };
    let wind = FieldKind::Wind(Wind { velocity: Vec3::X * 3.0, ..Wind::default() });
    world.add_field(&FieldDef { region, ..FieldDef::new(wind) });
    world
}

#[test]
fn snapshot_loads_in_another_world_with_the_shape_library() {
    let mut world = pebbles();
    (0..60).for_each(|_| world.step());
    let (state, shapes) = (saved(&world), library(&world));
    let corners = &shapes[shapes.len() / 2..][..48];
    assert!(!state.windows(corners.len()).any(|bytes| bytes == corners), "the state must not contain shapes");
    let mut other = World::new(WorldDef::default());
    let unknown = other
        .load(&mut Reader::new(&state))
        .expect_err("a world without the shape library must refuse the snapshot");
    assert!(matches!(unknown, LoadError::UnknownShape { kind: DataKind::Hull, .. }), "{unknown}");
    assert!(unknown.to_string().starts_with("names a hull of hash "), "{unknown}");
    assert_eq!(
        saved(&other),
        saved(&World::new(WorldDef::default())),
        "a refused snapshot must not change the world"
    );
    other.load_shapes(&mut Reader::new(&shapes)).expect("the saved shape library must load");
    other.load(&mut Reader::new(&state)).expect("the snapshot must load");
    assert_eq!(library(&other), shapes);
    for step in 0..60 {
        world.step();
        other.step();
        assert_eq!(world.hash(), other.hash(), "step {step}");
    }
}

#[test]
fn reset_brings_removed_hulls_back() {
    let mut world = pebbles();
    (0..20).for_each(|_| world.step());
    world.mark();
    let marked = world.hash();
    let run = |world: &mut World| {
        (0..40).for_each(|_| world.step());
        world.hash()
    };
    let first = run(&mut world);
    let ids: Vec<BodyId> = world.body_ids().skip(1).collect();
    ids.into_iter().for_each(|id| world.remove_body(id));
    world.add_body(&body(box_hull(Vec3::splat(0.2)), Vec3::Y));
    world.step();
    world.reset();
    assert_eq!(world.hash(), marked);
    assert_eq!(run(&mut world), first);
}

#[test]
fn worlds_with_different_hull_corners_have_different_hashes() {
    let world = |half: Vec3| {
        let mut world = World::new(WorldDef::default());
        let mass = Some(Shape::Sphere { radius: 1.0 }.mass_properties(1.0));
        world.add_body(&BodyDef { mass, ..body(box_hull(half), Vec3::ZERO) });
        world.hash()
    };
    assert_eq!(world(Vec3::ONE), world(Vec3::ONE));
    assert_ne!(world(Vec3::ONE), world(Vec3::new(1.0, 1.0, 1.000_1)));
}

/// A library with changed bytes or a truncated library gives an error or a valid library, never a panic.
#[test]
fn damaged_shape_libraries_give_errors() {
    let bytes = library(&pebbles());
    let mut errors = 0;
    for at in 0..bytes.len() {
        let mut world = World::new(WorldDef::default());
        assert!(world.load_shapes(&mut Reader::new(&bytes[..at])).is_err(), "cut at {at}");
        for flip in [0x01, 0x80, 0xFF] {
            let mut wrong = bytes.clone();
            wrong[at] ^= flip;
            match world.load_shapes(&mut Reader::new(&wrong)) {
                Ok(()) => drop(library(&world)),
                Err(_) => errors += 1,
            }
        }
    }
    assert!(errors > 2 * bytes.len(), "{errors} of {} mutations are errors", 3 * bytes.len());
}
