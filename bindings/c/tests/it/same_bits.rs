//! Checks that a world stepped from C has the bits of one stepped from Rust, on any number of threads, and after
//! a snapshot.

use sinew::physics::{BodyDef, Shape, World, WorldDef};
use sinew_c::*;
use std::ptr::{null, null_mut};

const STEPS: u32 = 120;

fn in_rust() -> u64 {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    for i in 0..20 {
        let cube = Shape::Box { half_extents: sinew::math::Vec3::splat(0.25) };
        let at = sinew::math::Vec3::new(0.6 * (i % 4) as f32, 1.0 + 0.6 * (i / 4) as f32, 0.01 * i as f32);
        world.add_body(&BodyDef::dynamic(cube).at(at));
    }
    (0..STEPS).for_each(|_| world.step());
    world.hash()
}

fn in_c(threads: u32, saves_at: Option<u32>) -> u64 {
    let (mut world, mut hash) = (null_mut(), 0);
    // SAFETY: all pointers are valid, and the world is freed once.
    unsafe {
        assert_eq!(sinew_world_new(null(), &mut world), SinewStatus::Ok);
        let mut def = std::mem::MaybeUninit::uninit();
        sinew_body_def_default(def.as_mut_ptr());
        let mut def: SinewBodyDef = def.assume_init();
        let mut shape = SinewShape { kind: SinewShapeKind::HalfSpace as u32, size: SinewVec3::default() };
        let mut id = SinewBodyId::default();
        (def.shapes, def.shape_count, def.kind) = (&shape, 1, SinewBodyKind::Static as u32);
        assert_eq!(sinew_world_add_body(world, &def, &mut id), SinewStatus::Ok);
        shape =
            SinewShape { kind: SinewShapeKind::Box as u32, size: SinewVec3 { x: 0.25, y: 0.25, z: 0.25 } };
        (def.shapes, def.kind) = (&shape, SinewBodyKind::Dynamic as u32);
        for i in 0..20 {
            let (x, y) = (0.6 * (i % 4) as f32, 1.0 + 0.6 * (i / 4) as f32);
            def.pose.position = SinewVec3 { x, y, z: 0.01 * i as f32 };
            assert_eq!(sinew_world_add_body(world, &def, &mut id), SinewStatus::Ok);
        }
        if let Some(at) = saves_at {
            sinew_world_step(world, at, threads);
            let mut size = 0;
            sinew_world_save(world, null_mut(), 0, &mut size);
            let mut bytes = vec![0; size];
            assert_eq!(sinew_world_save(world, bytes.as_mut_ptr(), size, &mut size), SinewStatus::Ok);
            sinew_world_step(world, 7, threads);
            assert_eq!(sinew_world_load(world, bytes.as_ptr(), size), SinewStatus::Ok);
        }
        assert_eq!(sinew_world_step(world, STEPS - saves_at.unwrap_or(0), threads), SinewStatus::Ok);
        assert_eq!(sinew_world_hash(world, &mut hash), SinewStatus::Ok);
        sinew_world_free(world);
    }
    hash
}

#[test]
fn bits_equal_those_of_rust() {
    let due = in_rust();
    for (threads, saves_at) in [(0, None), (1, None), (2, None), (3, Some(40))] {
        assert_eq!(in_c(threads, saves_at), due, "{threads} threads, snapshot at step {saves_at:?}");
    }
}
