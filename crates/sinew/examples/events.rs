//! Events: `cargo run -p sinew --example events`.
//!
//! A ball rolls through a sensor, onto a plate, and against a wall; the sensor and the wall report one event
//! each.

use sinew::prelude::*;

/// Rolls a ball through the sensor, onto the plate and against the wall.
pub fn main() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let gate =
        ShapeDef { sensing: Sensing::Sensor, ..ShapeDef::new(Shape::cuboid(Vec3::new(0.5, 1.0, 1.0))) };
    let gate = world.add_body(&BodyDef::fixed(gate).at(Vec3::new(3.0, 1.0, 0.0)));
    let wall =
        world.add_body(&BodyDef::fixed(Shape::cuboid(Vec3::new(0.1, 1.0, 1.0))).at(Vec3::new(6.0, 1.0, 0.0)));
    let roll = Velocity { linear: Vec3::X * 5.0, angular: Vec3::Z * -25.0 };
    let ball = BodyDef {
        linear_velocity: roll.linear,
        angular_velocity: roll.angular,
        user_data: 7, // what the game knows it by
        ..BodyDef::dynamic(Shape::sphere(0.2)).at(Vec3::Y * 0.2)
    };
    let ball = world.add_body(&ball);

    let mut told = Vec::new();
    for _ in 0..120 {
        world.step();
        let events = world.events();
        let mut tell = |what: &'static str, pairs: &[(BodyId, BodyId)]| {
            for &(a, b) in pairs {
                let other = if a == ball { b } else { a };
                println!("{:.2} s: {} {what} {other:?}", world.time(), world.user_data(ball));
                told.push((what, other));
            }
        };
        tell("touches", &events.begin);
        tell("leaves", &events.end);
        tell("enters", &events.sensor_begin);
        tell("has passed", &events.sensor_end);
        for hit in &events.hits {
            println!("{:.2} s: a hit of {:.1} m/s", world.time(), hit.approach);
            told.push(("hits", if hit.a.body == ball { hit.b.body } else { hit.a.body }));
        }
    }
    for what in [("enters", gate), ("has passed", gate), ("touches", wall), ("hits", wall)] {
        assert_eq!(told.iter().filter(|&&one| one == what).count(), 1, "{what:?} once in {told:?}");
    }
}
