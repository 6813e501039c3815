//! Discs that roll on their rims.

use crate::build::floor;
use sinew_math::{Rotation, Vec3, trig};
use sinew_physics::*;

const RADIUS: f32 = 0.5;
const HALF_THICKNESS: f32 = 0.02;
const GRAVITY: f32 = 9.81;

/// Disc that rolls in a circle: its axis rotates about the vertical at `rate` rad/s and leans by `lean` radians from
/// the horizontal.
struct Rolling {
    axis: Vec3,
    angular_velocity: Vec3,
    velocity: Vec3,
    height: f32,
}

/// Returns steady rolling about the vertical `y` at the rate `Ω` and spin `s`. With the axis `e`, the arm `r` from the
/// centre to the lowest point of the rim, and `ω = Ω y + s e`: the rim does not slip, `v = −ω × r`; the centre moves in
/// a circle, `a = Ω y × v`; the ground's force `m (a + g y)` turns the angular momentum, `Ω y × L = r × m (a + g y)`.
/// These equations are linear in `s`.
fn rolling(rate: f32, lean: f32) -> Rolling {
    let (sin, cos) = trig::sin_cos(lean);
    let (a, h) = (RADIUS, HALF_THICKNESS);
    // Moments of inertia divided by the mass.
    let (across, along) = (a * a / 4.0 + h * h / 3.0, a * a / 2.0);
    let axis = Vec3::new(cos, sin, 0.0);
    let arm = Vec3::new(sin, -cos, 0.0) * a - axis * h;
    let side = cos * arm.y - sin * arm.x;
    let due = arm.x * (GRAVITY - arm.y * rate * rate) + rate * rate * (along - across) * sin * cos;
    let spin = -due / (rate * (along * cos + arm.y * side));
    let angular_velocity = Vec3::Y * rate + axis * spin;
    Rolling { axis, angular_velocity, velocity: -angular_velocity.cross(arm), height: -arm.y }
}

/// Returns the mean rate of a disc's axis in the first second, divided by that of the closed form.
fn share_of_rate(ground: impl Fn(&mut World), rate: f32, lean: f32) -> f32 {
    let mut world = World::new(WorldDef::default());
    ground(&mut world);
    let start = rolling(rate, lean);
    let mut shape = ShapeDef::new(Shape::Cylinder { half_height: HALF_THICKNESS, radius: RADIUS });
    shape.material.friction = 1.0;
    let disc = world.add_body(&BodyDef {
        position: Vec3::Y * start.height,
        rotation: Rotation::from_arc(Vec3::Y, start.axis),
        linear_velocity: start.velocity,
        angular_velocity: start.angular_velocity,
        shapes: vec![shape],
        ..BodyDef::default()
    });
    let (mut turned, mut before) = (0.0, start.axis);
    for _ in 0..60 {
        world.step();
        let axis = world.transform(disc).rotation * Vec3::Y;
        turned += trig::atan2(before.z * axis.x - before.x * axis.z, before.x * axis.x + before.z * axis.z);
        before = axis;
    }
    turned / (rate * 60.0 * world.def().dt())
}

fn plane(world: &mut World) {
    floor(world);
}

/// Adds a slab as ground, for which the collision of two shapes is used instead of that with a plane.
fn slab(world: &mut World) {
    let half_extents = Vec3::new(10.0, 0.5, 10.0);
    let mut shape = ShapeDef::new(Shape::Box { half_extents });
    shape.material.friction = 1.0;
    world.add_body(&BodyDef {
        kind: BodyKind::Static,
        position: Vec3::Y * -0.5,
        shapes: vec![shape],
        ..BodyDef::default()
    });
}

/// The rates are high enough to be stable: slower than `√(g a / 3)` a disc falls over.
#[test]
fn a_disc_rolls_in_a_circle_at_the_rate_of_its_closed_form() {
    for (rate, lean) in [(0.5, 10.0f32), (1.0, 20.0), (1.5, 30.0), (2.0, 40.0), (3.0, 50.0)] {
        for ground in [plane as fn(&mut World), slab] {
            let share = share_of_rate(ground, rate, lean.to_radians());
            println!("{rate} rad/s, leaning by {lean}°: {share}");
            assert!(
                (share - 1.0).abs() < 0.015,
                "{rate} rad/s, leaning by {lean}°: {share} times the expected rate"
            );
        }
    }
}
