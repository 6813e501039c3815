//! Parts from which scenes are built.

use sinew::math::{Rotation, Sym3, Transform, Vec3};
use sinew::physics::{
    BodyDef, BodyId, BodyKind, Filter, JointDef, JointId, JointKind, MassProperties, Material, Shape,
    ShapeDef, World,
};

/// Gravity of all closed forms, m/s².
pub(crate) const GRAVITY: f32 = 9.81;

/// A dynamic body of one shape.
pub(crate) fn body(shape: Shape, position: Vec3) -> BodyDef {
    BodyDef { position, shapes: vec![ShapeDef::new(shape)], ..BodyDef::default() }
}

pub(crate) fn ball(radius: f32, position: Vec3) -> BodyDef {
    body(Shape::Sphere { radius }, position)
}

pub(crate) fn cuboid(half_extents: Vec3, position: Vec3) -> BodyDef {
    body(Shape::Box { half_extents }, position)
}

/// Makes a body collide with nothing.
pub(crate) fn ghost(mut def: BodyDef) -> BodyDef {
    for shape in &mut def.shapes {
        shape.filter = Filter { mask: 0, ..Filter::default() };
    }
    def
}

/// Sets the material of a body.
pub(crate) fn made_of(mut def: BodyDef, material: Material) -> BodyDef {
    for shape in &mut def.shapes {
        shape.material = material;
    }
    def
}

/// Makes a body static.
pub(crate) fn fixed(def: BodyDef) -> BodyDef {
    BodyDef { kind: BodyKind::Static, ..def }
}

/// A floor at y = 0.
pub(crate) fn floor() -> BodyDef {
    fixed(body(Shape::HalfSpace, Vec3::ZERO))
}

/// A static body to hang things on.
pub(crate) fn hook() -> BodyDef {
    BodyDef { kind: BodyKind::Static, ..BodyDef::default() }
}

/// A capsule along x, from `start` to `start + length`, that collides with nothing.
pub(crate) fn level_rod(start: f32, length: f32, radius: f32) -> BodyDef {
    let half_height = 0.5 * length - radius;
    let def = body(Shape::Capsule { half_height, radius }, Vec3::X * (start + 0.5 * length));
    BodyDef { rotation: tilt(90.0), ..ghost(def) }
}

/// A thin rod along x, from `start` to `start + length`, with the moment `m l²/12` about its centre. The rod collides
/// with nothing.
pub(crate) fn thin_rod(start: f32, length: f32, mass: f32) -> BodyDef {
    let moment = mass * length * length / 12.0;
    // The axis of the rod's own frame is y.
    let inertia = Sym3::from_diagonal(Vec3::new(moment, 0.02 * moment, moment));
    let mass = Some(MassProperties { mass, center: Vec3::ZERO, inertia });
    BodyDef { mass, ..level_rod(start, length, 0.03 * length) }
}

/// A thin rod from one point to another.
pub(crate) fn thin_rod_between(from: Vec3, to: Vec3, mass: f32) -> BodyDef {
    let along = to - from;
    let turn = Rotation::from_arc(Vec3::X, along.normalize());
    let level = thin_rod(0.0, along.length(), mass);
    BodyDef { position: from + turn * level.position, rotation: turn * level.rotation, ..level }
}

/// A hinge of two bodies about an axis through a world point.
pub(crate) fn hinge(world: &World, a: BodyId, b: BodyId, at: Vec3, axis: Vec3) -> JointDef {
    let frame = Transform::new(at, Rotation::from_arc(Vec3::X, axis));
    let kind = JointKind::Hinge { limit: None };
    JointDef::new(a, b, world.transform(a), world.transform(b), frame, kind)
}

/// Joins two bodies at a world point by a ball joint.
pub(crate) fn join(world: &mut World, a: BodyId, b: BodyId, at: Vec3) -> JointId {
    let joint = Transform::from_translation(at);
    let kind = JointKind::Ball { limit: None };
    world.add_joint(&JointDef::new(a, b, world.transform(a), world.transform(b), joint, kind))
}

/// Rotation about z, from x toward y.
pub(crate) fn tilt(degrees: f32) -> Rotation {
    Rotation::from_axis_angle(Vec3::Z, degrees.to_radians())
}

/// Distance of a free fall from rest so far, metres: symplectic Euler gives `g t (t + h) / 2` instead of `g t² / 2`.
pub(crate) fn fallen(world: &World) -> f64 {
    let dt = f64::from(world.def().dt());
    let t = world.step_count() as f64 * dt;
    let h = dt / f64::from(world.def().substeps);
    0.5 * f64::from(GRAVITY) * t * (t + h)
}

/// Arithmetic-geometric mean of two positive numbers; the complete elliptic integral of the first kind is
/// `K(k) = π / (2 agm(1, √(1 − k²)))` (Gauss).
pub(crate) fn agm(mut a: f64, mut b: f64) -> f64 {
    for _ in 0..6 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}
