//! Questions see bodies where they are now, whatever brought them there.

use super::random::{Populated, body, frame};
use crate::boxes::cases;
use crate::build::{box_body, floor};
use sinew_math::{Random, Transform, Vec3};
use sinew_physics::ray::Ray;
use sinew_physics::{BodyId, ContainsPoint, NearestTo, QueryFilter, Velocity, World, WorldDef};

/// First hit, holders of a point and nearest surface, by asking every shape.
fn agrees(populated: &Populated, random: &mut Random) {
    let filter = QueryFilter::default();
    let query = populated.world.query();
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
fn after_every_kind_of_change() {
    let mut random = Random::new(406);
    for case in 0..cases(20_000).div_ceil(40) {
        let mut populated = Populated::new(20, 3.0, &mut random);
        for _ in 0..40 {
            let (id, def) = &populated.bodies[random.index(populated.bodies.len())];
            let is_ground = def.shapes[0].shape == sinew_physics::Shape::HalfSpace;
            match random.index(5) {
                0 => populated.world.set_transform(*id, frame(3.0, &mut random)),
                1 if !is_ground => {
                    let velocity =
                        Velocity { linear: random.in_cube() * 50.0, angular: random.in_cube() * 9.0 };
                    populated.world.set_velocity(*id, velocity);
                    populated.world.step();
                }
                2 => populated.world.step(),
                3 => populated.remove(&mut random),
                _ => {
                    populated.add(body(3.0, &mut random));
                }
            }
            if populated.bodies.len() < 5 {
                populated.add(body(3.0, &mut random));
            }
            agrees(&populated, &mut random);
        }
        assert!(populated.world.step_count() > 0, "case {case}");
    }
}

/// Where a ray from above meets a body.
fn top(world: &World, id: BodyId) -> Option<f32> {
    let at = world.center_of_mass(id);
    let ray = Ray { origin: at + Vec3::Y * 5.0, direction: Vec3::Y * -10.0 };
    world.query().accept(|body, _| body == id).first(&ray).map(|hit| hit.point.y)
}

#[test]
fn asleep_and_awake_alike() {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let id = world.add_body(&box_body(Vec3::splat(0.5), Vec3::Y * 0.5));
    while world.is_awake(id) {
        world.step();
        assert!(world.step_count() < 200, "it lies still");
    }
    assert!((top(&world, id).expect("it lies there") - 1.0).abs() < 0.01);
    world.set_transform(id, Transform::from_translation(Vec3::new(7.0, 3.0, 0.0)));
    assert!((top(&world, id).expect("it was put there") - 3.5).abs() < 1e-5);
    assert!(!world.query().any(&ContainsPoint(Vec3::Y * 0.5)));
    world.remove_body(id);
    assert!(!world.query().any(&ContainsPoint(Vec3::new(7.0, 3.0, 0.0))));
}

/// The pose after the step is asked, not the one with which it began, however fast the body is.
#[test]
fn after_a_step_the_new_pose() {
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
