//! Queries with extreme arguments, and queries of extreme worlds.

use super::random::{KINDS, Populated, shape};
use crate::cases::cases;
use sinew_math::{Random, Rotation, Transform, Vec3};
use sinew_physics::ray::Ray;
use sinew_physics::*;

const BAD: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

/// Returns vectors with a bad number in each component in turn.
fn bad_vectors() -> impl Iterator<Item = Vec3> {
    BAD.into_iter().flat_map(|x| [Vec3::new(x, 0.0, 0.0), Vec3::new(0.1, x, 0.0), Vec3::new(0.0, 0.2, x)])
}

fn check_no_answer<Q: QueryKind>(world: &World, question: &Q)
where
    Q::Answer: Copy + PartialEq + core::fmt::Debug,
{
    let mut all = Vec::new();
    world.query().all(question, &mut all);
    assert_eq!(all, []);
    assert_eq!(world.query().first(question), None);
    assert!(!world.query().any(question));
}

#[test]
fn queries_with_nonfinite_arguments_return_nothing() {
    let mut random = Random::new(408);
    let world = Populated::new(30, 1.0, &mut random).world;
    for bad in bad_vectors() {
        check_no_answer(&world, &Ray { origin: bad, direction: Vec3::X });
        check_no_answer(&world, &Ray { origin: Vec3::ZERO, direction: bad });
        check_no_answer(&world, &ContainsPoint(bad));
        check_no_answer(&world, &NearestTo { point: bad, within: 1.0 });
        let ball = Shape::Sphere { radius: 1.0 };
        check_no_answer(&world, &OverlapWith(Probe::at(ball.clone(), bad)));
        check_no_answer(&world, &PenetrationOf(Probe::at(ball.clone(), bad)));
        check_no_answer(&world, &NearestToShape { probe: Probe::at(ball.clone(), bad), within: 1.0 });
        check_no_answer(&world, &ShapeCast { probe: Probe::at(ball.clone(), bad), translation: Vec3::X });
        check_no_answer(&world, &ShapeCast { probe: Probe::at(ball, Vec3::ZERO), translation: bad });
        check_no_answer(&world, &OverlapWith(Probe::at(Shape::Box { half_extents: bad }, Vec3::ZERO)));
    }
    check_no_answer(&world, &NearestTo { point: Vec3::ZERO, within: f32::NAN });
    check_no_answer(&world, &NearestTo { point: Vec3::ZERO, within: -1.0 });
    for radius in [f32::NAN, -1.0, f32::INFINITY] {
        check_no_answer(&world, &OverlapWith(Probe::at(Shape::Sphere { radius }, Vec3::ZERO)));
    }
}

#[test]
#[should_panic(expected = "a probe is convex and bounded")]
fn half_space_as_a_probe_is_refused() {
    let world = World::new(WorldDef::default());
    world.query().any(&OverlapWith(Probe::at(Shape::HalfSpace, Vec3::ZERO)));
}

/// A ray hits a shape on its path, however long the ray is.
#[test]
fn long_rays_hit() {
    let mut world = World::new(WorldDef::default());
    let half = Vec3::new(0.5, 1.0, 2.0);
    for kind in 0..KINDS {
        let shape = match kind {
            0 => Shape::Box { half_extents: half },
            1 => Shape::Sphere { radius: 0.5 },
            2 | 3 => Shape::Capsule { half_height: 1.0, radius: 0.5 },
            4 => Shape::TaperedCapsule { half_height: 1.0, radius_bottom: 0.5, radius_top: 0.5 },
            5 => Shape::Cylinder { half_height: 1.0, radius: 0.5 },
            // At this height the cone is as wide as the other shapes.
            _ => Shape::Cone { half_height: 1.0, radius: 10.0 / 9.0 },
        };
        let def =
            BodyDef { kind: BodyKind::Static, shapes: vec![ShapeDef::new(shape)], ..BodyDef::default() };
        let id = world.add_body(&def);
        for length in [1e3f32, 1e7, 1e12, 1e17, 1e25, 1e37] {
            let ray = Ray { origin: Vec3::new(-3.0, 0.1, 0.1), direction: Vec3::X * length };
            let hit = world.query().first(&ray).expect("the shape is on the ray's path");
            let place = hit.fraction * length;
            assert!((place - 2.5).abs() < 0.05, "{kind}: {hit:?}, length {length}");
        }
        world.remove_body(id);
    }
}

/// Returns a number of any magnitude, sometimes a special one.
fn wild(random: &mut Random) -> f32 {
    const SPECIAL: [f32; 10] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f32::MIN_POSITIVE,
        1e-42,
        f32::MAX,
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
    ];
    match random.index(12) {
        0 => SPECIAL[random.index(SPECIAL.len())],
        1 => f32::from_bits(random.bits() as u32),
        2..=4 => random.range(-1.0, 1.0) * 1e6,
        _ => random.range(-3.0, 3.0),
    }
}

fn wild3(random: &mut Random) -> Vec3 {
    Vec3::new(wild(random), wild(random), wild(random))
}

/// Returns a shape that may be thin, small or large.
fn extreme_shape(random: &mut Random) -> Shape {
    let mut size = || [1e-4f32, 1e-2, 1.0, 1e2, 1e5][random.index(5)] * random.range(0.5, 1.0);
    let (a, b, c) = (size(), size(), size());
    match random.index(6) {
        0 => Shape::Box { half_extents: Vec3::new(a, b, c) },
        1 => Shape::Sphere { radius: a },
        2 => Shape::Capsule { half_height: a, radius: b },
        3 => Shape::Cylinder { half_height: a, radius: b },
        4 => Shape::Cone { half_height: a, radius: b },
        _ => shape(random.index(KINDS), random),
    }
}

/// Returns a world with many bodies at one position, tiny beside huge, possibly far from the origin.
fn extreme_world(random: &mut Random) -> World {
    let mut world = World::new(WorldDef::default());
    let far = [0.0f32, 1.0, 1e3, 1e6][random.index(4)];
    let place = random.in_cube() * far;
    for _ in 0..random.index(12) {
        let spread = [0.0f32, 1e-3, 1.0, 100.0][random.index(4)];
        let shapes = (0..random.index(3)).map(|_| ShapeDef::new(extreme_shape(random))).collect();
        let (position, rotation) = (place + random.in_cube() * spread, random.rotation());
        world.add_body(&BodyDef { kind: BodyKind::Static, position, rotation, shapes, ..BodyDef::default() });
    }
    if random.index(2) == 0 {
        let shapes = vec![ShapeDef::new(Shape::HalfSpace)];
        world.add_body(&BodyDef {
            kind: BodyKind::Static,
            rotation: random.rotation(),
            shapes,
            ..BodyDef::default()
        });
    }
    world
}

fn finite(v: Vec3) -> bool {
    v.is_finite()
}

fn check_hits<Q: QueryKind<Answer = BodyHit> + core::fmt::Debug>(world: &World, way: &Q) {
    let mut hits = Vec::new();
    world.query().all(way, &mut hits);
    for hit in &hits {
        assert!((0.0..=1.0).contains(&hit.fraction) && finite(hit.point), "invalid hit {hit:?} of {way:?}");
        assert!((hit.normal.length() - 1.0).abs() < 1e-3, "invalid hit {hit:?} of {way:?}");
        if let Some(start) = hit.start {
            let sound = start.depth >= 0.0 && start.depth.is_finite() && finite(start.direction);
            assert!(sound, "invalid hit {hit:?} of {way:?}");
        }
    }
    assert_eq!(world.query().first(way), hits.first().copied(), "{way:?}");
    assert_eq!(world.query().any(way), !hits.is_empty());
}

fn check_near<Q: QueryKind<Answer = BodySurface> + core::fmt::Debug>(world: &World, question: &Q) {
    if let Some(near) = world.query().first(question) {
        let sound = finite(near.point) && finite(near.normal) && near.distance.is_finite();
        assert!(sound, "wrong answer {near:?} to {question:?}");
    }
}

#[test]
fn extreme_queries_of_extreme_worlds_return_valid_results() {
    let mut random = Random::new(409);
    for _ in 0..cases(10_000) {
        let world = extreme_world(&mut random);
        for _ in 0..10 {
            check_hits(&world, &Ray { origin: wild3(&mut random), direction: wild3(&mut random) });
            let aim = world.body_ids().next().map_or(Vec3::ZERO, |id| world.transform(id).translation);
            check_hits(&world, &Ray::between(wild3(&mut random), aim));
            let point = if random.index(2) == 0 { wild3(&mut random) } else { aim };
            world.query().any(&ContainsPoint(point));
            check_near(&world, &NearestTo { point, within: wild(&mut random) });
            let rotation = if random.index(3) == 0 { Rotation::IDENTITY } else { random.rotation() };
            let probe = Probe::new(extreme_shape(&mut random), Transform::new(point, rotation));
            let way = world.query().first(&PenetrationOf(probe.clone()));
            if let Some(way) = way {
                assert!(
                    way.depth >= 0.0 && way.depth.is_finite() && finite(way.direction),
                    "{way:?} of {probe:?}"
                );
            }
            assert_eq!(world.query().any(&OverlapWith(probe.clone())), way.is_some(), "{probe:?}");
            check_near(&world, &NearestToShape { probe: probe.clone(), within: wild(&mut random) });
            check_hits(&world, &ShapeCast { probe, translation: wild3(&mut random) });
        }
    }
}
