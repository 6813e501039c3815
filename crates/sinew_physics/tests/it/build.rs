//! Small worlds for tests.

use sinew_math::{Rotation, Transform, Vec3};
use sinew_physics::*;

pub fn sphere_body(radius: f32, position: Vec3) -> BodyDef {
    BodyDef { position, shapes: vec![ShapeDef::new(Shape::Sphere { radius })], ..BodyDef::default() }
}

pub fn box_body(half_extents: Vec3, position: Vec3) -> BodyDef {
    BodyDef { position, shapes: vec![ShapeDef::new(Shape::Box { half_extents })], ..BodyDef::default() }
}

pub fn capsule_body(half_height: f32, radius: f32, position: Vec3) -> BodyDef {
    BodyDef {
        position,
        shapes: vec![ShapeDef::new(Shape::Capsule { half_height, radius })],
        ..BodyDef::default()
    }
}

pub fn floor(world: &mut World) -> BodyId {
    half_space_tilted(world, 0.0, 0.6)
}

/// Adds a plane through the origin, tilted about z by `angle` radians.
pub fn half_space_tilted(world: &mut World, angle: f32, friction: f32) -> BodyId {
    let mut shape = ShapeDef::new(Shape::HalfSpace);
    shape.material.friction = friction;
    world.add_body(&BodyDef {
        kind: BodyKind::Static,
        rotation: Rotation::from_axis_angle(Vec3::Z, angle),
        shapes: vec![shape],
        ..BodyDef::default()
    })
}

/// Returns a ball joint at a world point.
pub fn ball(world: &World, a: BodyId, b: BodyId, at: Vec3) -> JointDef {
    joint(world, a, b, Transform::from_translation(at), JointKind::Ball { limit: None })
}

pub fn joint(world: &World, a: BodyId, b: BodyId, at: Transform, kind: JointKind) -> JointDef {
    JointDef::new(a, b, world.transform(a), world.transform(b), at, kind)
}
