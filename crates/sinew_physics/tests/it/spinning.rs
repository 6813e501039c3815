//! Fast spinning rods hit the balls that fly into them, and no balls at positions that the rods have already left.

use sinew_math::{Random, Rotation, Transform, Vec3, clamp};
use sinew_physics::*;

/// Radii of rod and ball, metres.
const ROD: f32 = 0.03;
const BALL: f32 = 0.06;
/// Number of balls of each rod, and their initial height, metres.
const BALLS: u64 = 80;
const HEIGHT: f32 = 1.0;

/// Returns the smallest distance between the surfaces of the rod and of a ball that flies freely, metres; negative for
/// an overlap.
fn nearest(start: Vec3, speed: f32, spin: f32, phase: f32, half: f32) -> f32 {
    let moments = 20_000;
    let distance = |moment: i32| {
        let t = 2.0 * HEIGHT / speed * moment as f32 / moments as f32;
        let turn = Rotation::from_axis_angle(Vec3::Y, phase + spin * t);
        let seen = turn.inverse() * (start - Vec3::Y * (speed * t));
        (seen - Vec3::X * clamp(seen.x, -half, half)).length() - ROD - BALL
    };
    (0..moments).map(distance).fold(f32::INFINITY, sinew_math::min)
}

/// Returns `[missed, ghosts]`: the number of balls that a spinning rod meets but does not hit, and the number of balls
/// that change their velocity although the rod never reaches them.
fn misses_and_ghosts(kind: BodyKind, spin: f32, length: f32) -> [u32; 2] {
    let half = 0.5 * length - ROD;
    let (mut missed, mut ghosts) = (0, 0);
    for seed in 0..BALLS {
        let mut random = Random::new(seed);
        let (phase, along) = (random.range(0.0, core::f32::consts::TAU), random.range(0.2, 0.95) * half);
        let (speed, start) = (random.range(3.0, 12.0), Vec3::new(along, HEIGHT, 0.0));
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        let lying = Rotation::from_axis_angle(Vec3::Z, core::f32::consts::FRAC_PI_2);
        let mut shape = ShapeDef::new(Shape::capsule(half, ROD));
        (shape.body_from_shape, shape.density) = (Transform::new(Vec3::ZERO, lying), 1e5);
        world.add_body(&BodyDef {
            kind,
            rotation: Rotation::from_axis_angle(Vec3::Y, phase),
            angular_velocity: Vec3::Y * spin,
            shapes: vec![shape],
            ..BodyDef::default()
        });
        let velocity = Vec3::NEG_Y * speed;
        let ball = BodyDef { linear_velocity: velocity, ..BodyDef::dynamic(Shape::sphere(BALL)).at(start) };
        let ball = world.add_body(&ball);
        (0..(120.0 * HEIGHT / speed) as u32 + 2).for_each(|_| world.step());
        let is_struck = (world.velocity(ball).linear - velocity).length() > 0.01 * speed;
        let nearest = nearest(start, speed, spin, phase, half);
        missed += u32::from(nearest < -2e-3 && !is_struck);
        ghosts += u32::from(nearest > 1e-2 && is_struck);
    }
    [missed, ghosts]
}

#[test]
fn rods_hit_balls_that_fly_through_their_discs() {
    for kind in [BodyKind::Kinematic, BodyKind::Dynamic] {
        for (spin, length) in [(30.0, 1.0), (60.0, 1.0), (120.0, 1.0), (200.0, 1.0), (120.0, 0.5)] {
            let [missed, ghosts] = misses_and_ghosts(kind, spin, length);
            let what = format!(
                "{kind:?}, {length} m at {spin} rad/s: {missed} missed, {ghosts} hit without contact"
            );
            assert!(missed == 0 && ghosts <= 5, "of {BALLS} balls: {what}");
        }
    }
}
