//! Rays, pairs of boxes and cloth, on every engine of this build that has them.

use crate::engines::engines;
use sinew::physics::Shape;
use sinew::physics::ray::Ray;
use sinew_peers::engine::Unsupported;
use sinew_peers::scenes::{BoxPairs, ClothScene, RayScene};

/// Returns the feature of an engine; prints the reason if the engine lacks it.
fn offered<T>(result: Result<T, Unsupported>, name: &str) -> Option<T> {
    match result {
        Ok(offered) => Some(offered),
        Err(why) => {
            eprintln!("{name}: {why}");
            None
        }
    }
}

#[test]
fn rays_match_brute_force() {
    let scene = RayScene::new();
    const RAYS: usize = 2_000;
    let hits = |ray: &Ray| {
        scene.boxes.iter().any(|place| {
            let shape = Shape::Box { half_extents: place.half_extents };
            shape.cast_ray(&place.world_from_box, ray).is_some()
        })
    };
    let expected = scene.rays[..RAYS].iter().filter(|ray| hits(ray)).count();
    for engine in engines() {
        let name = engine.describe().name;
        let Some(mut caster) = offered(engine.build_rays(&scene), name) else { continue };
        let found = caster.count_hits(0..RAYS);
        // Engines differ on rays that start inside a box: 3 in 1,000.
        assert!(found.abs_diff(expected) <= RAYS / 200, "{name}: found {found} hits, expected {expected}");
    }
}

#[test]
fn half_of_the_box_pairs_overlap() {
    let pairs = BoxPairs::new(20_000, 1);
    for engine in engines() {
        let name = engine.describe().name;
        let Some(mut tester) = offered(engine.build_boxes(&pairs), name) else { continue };
        let share = tester.count_overlaps(0..20_000) as f32 / 20_000.0;
        // The expected share is 51.4 %.
        assert!((share - 0.514).abs() < 0.01, "{name}: {share}");
    }
}

#[test]
fn cloth_hangs_on_its_pins_and_stays_above_the_floor() {
    let scene = ClothScene { side: 20, ..ClothScene::new() };
    for engine in engines() {
        let name = engine.describe().name;
        let Some(mut cloth) = offered(engine.build_cloth(&scene), name) else { continue };
        for _ in 0..120 {
            cloth.step();
        }
        let mut particles = Vec::new();
        cloth.particles(&mut particles);
        assert_eq!(particles.len(), 400, "{name}");
        for pinned in scene.pinned() {
            let start = scene.position(pinned / scene.side, pinned % scene.side);
            assert!((particles[pinned].position - start).length() < 1e-3, "{name}: a pin moved");
        }
        let lowest = particles.iter().map(|particle| particle.position.y).fold(f32::INFINITY, f32::min);
        assert!(lowest > -0.01 && lowest < scene.corner.y - 0.3, "{name}: lowest particle at {lowest} m");
    }
}
