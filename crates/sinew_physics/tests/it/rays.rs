//! Rays and regions in worlds with trees, against trying every shape of every body: the bits are the same, whatever came,
//! went and moved before. 100,000 rays, or a hundredth unless `SINEW_FULL` is set.

use crate::build::box_body;
use sinew_math::{Random, Reader, Rotation, Transform, Vec3, Writer};
use sinew_physics::ray::Ray;
use sinew_physics::*;

fn cases(all: usize) -> usize {
    if std::env::var_os("SINEW_FULL").is_some() { all } else { all / 100 }
}

/// The first shape on a ray, by trying all; the smaller body wins a tie.
fn tried(world: &World, ray: &Ray, accept: impl Fn(BodyId) -> bool) -> Option<BodyHit> {
    let mut first: Option<BodyHit> = None;
    for body in world.body_ids().filter(|&id| accept(id)) {
        for (shape, frame) in world.shapes(body) {
            if let Some(hit) = shape.cast_ray(&frame, ray)
                && first.is_none_or(|first| hit.fraction < first.hit.fraction)
            {
                first = Some(BodyHit { body, hit });
            }
        }
    }
    first
}

fn some_shape(random: &mut Random, size: f32, kind: BodyKind) -> ShapeDef {
    let shape = match random.index(if kind == BodyKind::Static { 9 } else { 8 }) {
        0..3 => Shape::Box { half_extents: (random.in_cube() * size).abs() + Vec3::splat(1e-3 * size) },
        // Thin as a sheet.
        3 => Shape::Box { half_extents: Vec3::new(size, 1e-4 * size, size) },
        4..6 => Shape::Sphere { radius: size * (0.1 + random.unit()) },
        6..8 => Shape::Capsule { half_height: size * random.unit(), radius: 0.5 * size },
        _ => Shape::HalfSpace,
    };
    let body_from_shape = match random.index(3) {
        0 => Transform::IDENTITY,
        _ => Transform::new(random.in_cube() * size, random.rotation()),
    };
    ShapeDef { body_from_shape, ..ShapeDef::new(shape) }
}

/// Axis-aligned half of the time, on a grid at times, so that rays run along faces and meet several at once.
fn some_pose(random: &mut Random, center: Vec3, range: f32) -> Transform {
    let place = random.in_cube() * range;
    let on_grid = Vec3::new(place.x.round(), place.y.round(), place.z.round());
    match random.index(3) {
        0 => Transform::from_translation(center + on_grid),
        1 => Transform::from_translation(center + place),
        _ => Transform::new(center + place, random.rotation()),
    }
}

fn add(world: &mut World, random: &mut Random, center: Vec3, range: f32) {
    let kind = [BodyKind::Static, BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic][random.index(4)];
    let Transform { translation: position, rotation } = some_pose(random, center, range);
    let size = range * if random.unit() < 0.1 { 0.5 } else { 0.1 };
    let count = if random.unit() < 0.02 { 150 } else { 1 + random.index(2) };
    world.add_body(&BodyDef {
        kind,
        position,
        rotation,
        linear_velocity: if kind == BodyKind::Static { Vec3::ZERO } else { random.in_cube() },
        shapes: (0..count).map(|_| some_shape(random, size, kind)).collect(),
        ..BodyDef::default()
    });
}

fn some_ray(random: &mut Random, center: Vec3, range: f32) -> Ray {
    let origin = some_pose(random, center, 1.5 * range).translation;
    let mut direction = random.in_cube() * 3.0 * range;
    match random.index(6) {
        0 => direction[random.index(3)] = 0.0,
        1 => {
            let axis = random.index(3);
            direction = Vec3::ZERO;
            direction[axis] = if random.unit() < 0.5 { -2.0 * range } else { 2.0 * range };
        }
        2 if random.unit() < 0.1 => direction = Vec3::ZERO,
        _ => {}
    }
    Ray { origin, direction }
}

/// What changes between rays: bodies come, go, are put elsewhere, move, and return to what was saved.
fn change(world: &mut World, random: &mut Random, center: Vec3, range: f32, saved: &mut Vec<Vec<u8>>) {
    let ids: Vec<BodyId> = world.body_ids().collect();
    let id = ids[random.index(ids.len())];
    match random.index(8) {
        0 if ids.len() > 5 => world.remove_body(id),
        0..4 => add(world, random, center, range),
        4 | 5 => world.set_transform(id, some_pose(random, center, range)),
        6 => world.step(),
        _ if random.unit() < 0.5 || saved.is_empty() => {
            let mut w = Writer::new();
            world.save(&mut w);
            saved.push(w.into_bytes());
        }
        _ => {
            let bytes = &saved[random.index(saved.len())];
            world.load(&mut Reader::new(bytes)).expect("it was saved");
        }
    }
}

#[test]
fn rays_hit_what_trying_every_shape_finds() {
    let mut random = Random::new(21);
    let (mut hits, mut rays_cast) = (0, 0);
    while rays_cast < cases(100_000) {
        let mut world = World::new(WorldDef::default());
        // Near the origin, and where neighbouring numbers are 8 mm or 6 cm apart.
        let far = [0.0, 0.0, 1e5, 1e6][random.index(4)];
        let (center, range) = (random.in_cube() * far, [1.0, 20.0, 500.0][random.index(3)]);
        for _ in 0..5 + random.index(60) {
            add(&mut world, &mut random, center, range);
        }
        let mut saved = Vec::new();
        for _ in 0..10 {
            let rays: Vec<Ray> = (0..10).map(|_| some_ray(&mut random, center, range)).collect();
            let mut all = Vec::new();
            world.cast_rays(&rays, |_| true, &mut all);
            for (ray, hit) in rays.iter().zip(all) {
                assert_eq!(hit, tried(&world, ray, |_| true), "{ray:?}");
                let fixed = |id| world.kind(id) == BodyKind::Static;
                assert_eq!(world.cast_ray(ray, fixed), tried(&world, ray, fixed), "{ray:?}");
                hits += usize::from(hit.is_some());
            }
            rays_cast += rays.len();
            for _ in 0..random.index(4) {
                change(&mut world, &mut random, center, range, &mut saved);
            }
        }
    }
    assert!(hits * 4 > rays_cast, "{hits} hits of {rays_cast} rays say little");
}

/// Boxes of one size on a grid, and a ray that meets two of them at once: the body that came first is hit, however the tree
/// came to be.
#[test]
fn of_equal_hits_the_smaller_body_counts() {
    for order in [[0, 1, 2], [2, 1, 0], [1, 2, 0]] {
        let mut world = World::new(WorldDef::default());
        let places: Vec<Vec3> = order.iter().map(|&i| Vec3::new(0.0, i as f32, 0.0)).collect();
        let ids: Vec<BodyId> =
            places.iter().map(|&at| world.add_body(&box_body(Vec3::splat(0.5), at))).collect();
        let ray = Ray { origin: Vec3::new(-2.0, 0.5, 0.0), direction: Vec3::X * 4.0 };
        let hit = world.cast_ray(&ray, |_| true).expect("it meets two boxes at once");
        let touched = ids.iter().zip(&places).find(|(_, place)| place.y < 1.5).expect("two of three are met");
        assert_eq!((hit.body, hit.hit.fraction), (*touched.0, 0.375));
    }
}

#[test]
fn rays_without_number_or_far_away_hit_nothing() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&box_body(Vec3::ONE, Vec3::ZERO));
    for bad in [f32::NAN, f32::INFINITY] {
        assert_eq!(world.cast_ray(&Ray { origin: Vec3::X * bad, direction: Vec3::X }, |_| true), None);
        assert_eq!(world.cast_ray(&Ray { origin: Vec3::ZERO, direction: Vec3::Y * bad }, |_| true), None);
    }
    let far = Ray { origin: Vec3::splat(3e38), direction: Vec3::splat(3e38) };
    assert_eq!(world.cast_ray(&far, |_| true), None);
    let tiny = Ray { origin: Vec3::new(-2.0, 0.0, 0.0), direction: Vec3::X * 1e-40 };
    assert_eq!(world.cast_ray(&tiny, |_| true), None);
}

#[test]
fn regions_hold_what_trying_every_shape_finds() {
    let mut random = Random::new(22);
    for _ in 0..cases(2_000) {
        let mut world = World::new(WorldDef::default());
        for _ in 0..60 {
            add(&mut world, &mut random, Vec3::ZERO, 10.0);
        }
        for _ in 0..10 {
            let half = (random.in_cube() * 3.0).abs();
            let region = Obb::new(random.in_cube() * 10.0, random.rotation(), half);
            let found: Vec<BodyId> = world.bodies_in(&region).collect();
            // Each body alone in a world: no tree to speak of.
            let alone = |&id: &BodyId| {
                let mut one = World::new(WorldDef::default());
                let shapes = world
                    .shapes(id)
                    .map(|(shape, body_from_shape)| ShapeDef { body_from_shape, ..ShapeDef::new(shape) });
                one.add_body(&BodyDef {
                    kind: BodyKind::Static,
                    rotation: Rotation::IDENTITY,
                    shapes: shapes.collect(),
                    ..BodyDef::default()
                });
                one.bodies_in(&region).count() > 0
            };
            let all: Vec<BodyId> = world.body_ids().filter(alone).collect();
            assert_eq!(found, all);
        }
    }
}

/// A level of boxes as the shapes of one static body: what the world keeps for each of them, and that a snapshot gives it
/// back exactly.
#[test]
fn a_box_of_a_level_takes_less_than_100_bytes() {
    const COUNT: usize = 50_000;
    let mut random = Random::new(5);
    let shapes: Vec<ShapeDef> = (0..COUNT)
        .map(|_| ShapeDef {
            body_from_shape: Transform::new(random.in_cube() * 200.0, random.rotation()),
            ..ShapeDef::new(Shape::Box { half_extents: (random.in_cube()).abs() + Vec3::splat(0.1) })
        })
        .collect();
    let def = BodyDef { kind: BodyKind::Static, shapes, ..BodyDef::default() };
    let mut world = World::new(WorldDef::default());
    let kept = allocation_counter::measure(|| {
        world.add_body(&def);
    });
    let each = kept.bytes_current as f32 / COUNT as f32;
    assert!(each < 100.0, "{each} bytes for each box");
    let mut w = Writer::new();
    world.save(&mut w);
    let mut other = World::new(WorldDef::default());
    other.load(&mut Reader::new(w.as_bytes())).expect("it was saved");
    assert_eq!(other.hash(), world.hash());
    for _ in 0..200 {
        let ray = some_ray(&mut random, Vec3::ZERO, 200.0);
        assert_eq!(world.cast_ray(&ray, |_| true), other.cast_ray(&ray, |_| true));
    }
}
