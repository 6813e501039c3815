//! Queries use the current poses, shapes and filters after any change.

use super::random::{Populated, body, filter, frame};
use crate::build::{box_body, floor};
use crate::cases::cases;
use sinew_math::{Random, Reader, Transform, Vec3, Writer};
use sinew_physics::ray::Ray;
use sinew_physics::{
    BodyDef, BodyId, BodyKind, ContainsPoint, Filter, NearestTo, OverlapWith, Probe, QueryFilter, Sensing,
    Sensors, Shape, ShapeDef, ShapeId, Velocity, World, WorldDef,
};

/// Compares the first hit of a ray, the shapes that contain a point and the nearest surface with tests of every shape.
fn check_against_all_shapes(populated: &Populated, random: &mut Random) {
    let filter = filter(&[], random);
    let query = populated.world.query().filter(filter);
    let ray = Ray { origin: random.in_cube() * 4.0, direction: random.in_cube() * 8.0 };
    let fractions = populated.shapes(&filter).filter_map(|(_, shape, frame)| shape.cast_ray(&frame, &ray));
    let least = fractions.map(|hit| hit.fraction).reduce(f32::min);
    assert_eq!(query.first(&ray).map(|hit| hit.fraction), least);
    let point = random.in_cube() * 4.0;
    let distances = populated.shapes(&filter).map(|(_, shape, frame)| shape.signed_distance(&frame, point).0);
    let (mut held, mut nearest) = (0, f32::INFINITY);
    for distance in distances {
        held += usize::from(distance <= 0.0);
        nearest = nearest.min(distance);
    }
    let mut shapes = Vec::new();
    query.all(&ContainsPoint(point), &mut shapes);
    assert_eq!(shapes.len(), held);
    let found = query.first(&NearestTo { point, within: 100.0 });
    assert_eq!(found.map_or(f32::INFINITY, |answer| answer.distance), nearest);
}

#[test]
fn queries_after_random_changes_match_tests_of_all_shapes() {
    let mut random = Random::new(406);
    for case in 0..cases(20_000).div_ceil(40) {
        let mut populated = Populated::new(20, 3.0, &mut random);
        for _ in 0..40 {
            let (id, def) = {
                let number = random.index(populated.bodies.len());
                &mut populated.bodies[number]
            };
            let is_ground = def.shapes[0].shape == Shape::HalfSpace;
            match random.index(7) {
                0 => populated.world.set_transform(*id, frame(3.0, &mut random)),
                1 if !is_ground => {
                    let velocity =
                        Velocity { linear: random.in_cube() * 50.0, angular: random.in_cube() * 9.0 };
                    populated.world.set_velocity(*id, velocity);
                    populated.world.step();
                }
                2 => populated.world.step(),
                3 => populated.remove(&mut random),
                4 => {
                    let filter = Filter { mask: random.bits() as u32 & 7, ..def.shapes[0].filter };
                    def.shapes[0].filter = filter;
                    populated.world.set_filter(ShapeId { body: *id, shape: 0 }, filter);
                }
                5 => {
                    let sensing = [Sensing::Solid, Sensing::Sensor][random.index(2)];
                    def.shapes[0].sensing = sensing;
                    populated.world.set_sensing(ShapeId { body: *id, shape: 0 }, sensing);
                }
                _ => {
                    populated.add(body(3.0, &mut random));
                }
            }
            if populated.bodies.len() < 5 {
                populated.add(body(3.0, &mut random));
            }
            check_against_all_shapes(&populated, &mut random);
        }
        assert!(populated.world.step_count() > 0, "case {case}");
    }
}

/// Returns the height at which a ray from above hits a body, in world coordinates, metres.
fn top(world: &World, id: BodyId) -> Option<f32> {
    let at = world.center_of_mass(id);
    let ray = Ray { origin: at + Vec3::Y * 5.0, direction: Vec3::Y * -10.0 };
    world.query().accept(|body, _| body == id).first(&ray).map(|hit| hit.point.y)
}

#[test]
fn queries_find_sleeping_and_awake_bodies_alike() {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let id = world.add_body(&box_body(Vec3::splat(0.5), Vec3::Y * 0.5));
    while world.is_awake(id) {
        world.step();
        assert!(world.step_count() < 200, "the body must fall asleep");
    }
    assert!((top(&world, id).expect("the ray must hit the sleeping body") - 1.0).abs() < 0.01);
    world.set_transform(id, Transform::from_translation(Vec3::new(7.0, 3.0, 0.0)));
    assert!((top(&world, id).expect("the ray must hit the moved body") - 3.5).abs() < 1e-5);
    assert!(!world.query().any(&ContainsPoint(Vec3::Y * 0.5)));
    world.remove_body(id);
    assert!(!world.query().any(&ContainsPoint(Vec3::new(7.0, 3.0, 0.0))));
}

/// Queries use the pose after the step, not the pose before it, for any speed of the body.
#[test]
fn queries_after_a_step_use_the_new_pose() {
    let mut world = World::new(WorldDef::default());
    let mut def = box_body(Vec3::splat(0.1), Vec3::ZERO);
    def.linear_velocity = Vec3::X * 600.0;
    let id = world.add_body(&def);
    for _ in 0..5 {
        world.step();
        let at = world.center_of_mass(id);
        let mut bodies = Vec::new();
        world.query().bodies(&ContainsPoint(at), &mut bodies);
        assert_eq!(bodies, [id]);
        assert!(!world.query().any(&ContainsPoint(at - Vec3::X * 1.0)));
    }
}

/// Returns whether a ray from above, a box around the body, and a ball on it each find the body.
fn met(world: &mut World, id: BodyId, filter: QueryFilter<'_>) -> [bool; 3] {
    let query = world.query().filter(filter).accept(|body, _| body == id);
    let around = OverlapWith(Probe::at(Shape::Box { half_extents: Vec3::splat(2.0) }, Vec3::ZERO));
    let down = Ray { origin: Vec3::Y * 3.0, direction: Vec3::Y * -3.0 };
    let seen = [query.any(&down), query.any(&around)];
    let ball = ShapeDef {
        filter: Filter { layers: filter.meets.layers, ..Filter::default() },
        ..ShapeDef::new(Shape::Sphere { radius: 0.1 })
    };
    let position = Vec3::Y * 0.55;
    let ball = world.add_body(&BodyDef { position, shapes: vec![ball], ..BodyDef::default() });
    world.step();
    let touches = world.contacts_of(ball).next().is_some();
    world.remove_body(ball);
    [seen[0], seen[1], touches]
}

/// A change of filter takes effect immediately, also for a static body with a single shape, because the tree stores a
/// copy of that shape.
#[test]
fn queries_use_a_changed_filter_immediately() {
    let mut world = World::new(WorldDef::default());
    let mut def = box_body(Vec3::splat(0.5), Vec3::ZERO);
    def.kind = BodyKind::Static;
    let id = world.add_body(&def);
    let shape = ShapeId { body: id, shape: 0 };
    let of_layer =
        |layers| QueryFilter { meets: Filter { layers, ..Filter::default() }, ..QueryFilter::default() };
    assert_eq!([1, 2].map(|layer| met(&mut world, id, of_layer(layer))), [[true; 3]; 2]);
    world.mark();
    world.set_filter(shape, Filter { mask: 2, ..Filter::default() });
    let mut saved = Writer::new();
    world.save(&mut saved);
    let only_second = [[false; 3], [true; 3]];
    assert_eq!([1, 2].map(|layer| met(&mut world, id, of_layer(layer))), only_second);
    world.set_filter(shape, Filter::default());
    assert_eq!([1, 2].map(|layer| met(&mut world, id, of_layer(layer))), [[true; 3]; 2]);
    world.load(&mut Reader::new(saved.as_bytes())).expect("the snapshot must load");
    assert_eq!([1, 2].map(|layer| met(&mut world, id, of_layer(layer))), only_second);
    world.reset();
    assert_eq!([1, 2].map(|layer| met(&mut world, id, of_layer(layer))), [[true; 3]; 2]);
    world.set_sensing(shape, Sensing::Sensor);
    assert_eq!(met(&mut world, id, QueryFilter::default())[..2], [false; 2]);
    let sensors = QueryFilter { sensors: Sensors::Included, ..QueryFilter::default() };
    assert_eq!(met(&mut world, id, sensors)[..2], [true; 2]);
    world.set_sensing(shape, Sensing::Solid);
    assert_eq!(met(&mut world, id, QueryFilter::default()), [true; 3]);
}
