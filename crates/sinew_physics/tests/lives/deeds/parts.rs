//! Definitions from which deeds create objects.

use crate::functions::NUMBER;
use crate::numbers::{Numbers, Temper};
use sinew_math::{Transform, Vec3};
use sinew_physics::*;

/// Returns a solid with sizes between `lo` and `hi`, metres.
pub fn shape(n: &mut Numbers, lo: f32, hi: f32) -> Shape {
    match n.index(9) {
        0..3 => Shape::cuboid(Vec3::new(n.between(lo, hi), n.between(lo, hi), n.between(lo, hi))),
        3 | 4 => Shape::sphere(n.between(lo, hi)),
        5 => Shape::capsule(n.between(lo, hi), n.between(lo, hi)),
        6 => Shape::cylinder(n.between(lo, hi), n.between(lo, hi)),
        7 => Shape::cone(n.between(lo, hi), n.between(lo, hi)),
        _ => wedge(n.between(lo, hi)),
    }
}

/// Returns a hull of six corners.
fn wedge(size: f32) -> Shape {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)];
    let points: Vec<Vec3> =
        corners.iter().flat_map(|&(x, y)| [-0.7, 0.7].map(|z| Vec3::new(x, y, z) * size)).collect();
    Shape::hull(&points).expect("the hull is valid")
}

pub fn scaled(shape: &Shape, by: f32) -> Option<Shape> {
    Some(match shape {
        Shape::Box { half_extents } => Shape::Box { half_extents: *half_extents * by },
        Shape::Sphere { radius } => Shape::Sphere { radius: radius * by },
        Shape::Capsule { half_height, radius } => Shape::capsule(half_height * by, radius * by),
        Shape::Cylinder { half_height, radius } => Shape::cylinder(half_height * by, radius * by),
        Shape::Cone { half_height, radius } => Shape::cone(half_height * by, radius * by),
        Shape::Hull(hull) => {
            let points: Vec<Vec3> = hull.vertices().iter().map(|&point| point * by).collect();
            Shape::hull(&points).ok()?
        }
        _ => return None,
    })
}

pub fn material(n: &mut Numbers) -> Material {
    let mut material = Material { friction: n.least(0.0, 1.0), ..Material::default() };
    if n.chance(0.2) {
        material.restitution = n.between(0.0, 1.0);
    }
    if n.chance(0.2) {
        material.rolling = n.between(0.0, 0.02);
    }
    if n.chance(0.1) {
        material.surface_velocity = n.vector(2.0);
    }
    if n.chance(0.05) {
        material.surface_spin = n.vector(2.0);
    }
    if n.chance(0.1) {
        material.static_friction = Some(material.friction + n.between(0.0, 1.0));
    }
    if n.chance(0.1) {
        material.combine.friction = Some(n.one_of(&[Combine::Average, Combine::Minimum, Combine::Maximum]));
    }
    material
}

pub fn filter(n: &mut Numbers) -> Filter {
    match n.index(4) {
        0 => Filter { mask: 0, ..Filter::default() },
        1 => Filter { layers: 2, mask: 3, group: 0 },
        2 => Filter { group: n.one_of(&[-1, 1]), ..Filter::default() },
        _ => Filter::default(),
    }
}

pub fn rule(n: &mut Numbers) -> ContactRule {
    match n.index(5) {
        0 => ContactRule::Ghost,
        1 => ContactRule::OneWay(OneWay { direction: n.direction(), tolerance: n.between(0.0, 3.0) }),
        2 => ContactRule::Yields(Yields { max_force: n.least(0.0, 200.0), max_impulse: n.least(0.0, 50.0) }),
        3 => ContactRule::Modified { modifier: NUMBER },
        _ => ContactRule::Push,
    }
}

pub fn shape_def(n: &mut Numbers) -> ShapeDef {
    let sensor = n.chance(0.12);
    let shape = if sensor { shape(n, 0.3, 1.5) } else { shape(n, 0.1, 0.5) };
    let mut def = ShapeDef::new(shape);
    if sensor {
        def.sensing = Sensing::Sensor;
    }
    if n.chance(0.4) {
        def.material = material(n);
    }
    if n.chance(0.15) {
        def.rule = rule(n);
    }
    if n.chance(0.15) {
        def.filter = filter(n);
    }
    if n.chance(0.2) {
        let by = Vec3::new(n.between(-0.3, 0.3), 0.0, n.between(-0.3, 0.3));
        def.body_from_shape = Transform::new(by, n.rotation());
    }
    if n.chance(0.1) {
        def.density = n.between(10.0, 8000.0);
    }
    def
}

pub fn body(n: &mut Numbers, at: Vec3) -> BodyDef {
    let kind = match n.index(12) {
        0 => BodyKind::Static,
        1 | 2 => BodyKind::Kinematic,
        _ => BodyKind::Dynamic,
    };
    let mut def = BodyDef { kind, rotation: n.rotation(), ..BodyDef::dynamic(shape_def(n)).at(at) };
    def.kind = kind;
    if n.chance(0.3) {
        let Velocity { linear, angular } = n.velocity();
        (def.linear_velocity, def.angular_velocity) = (linear, angular);
    }
    if n.chance(0.2) {
        def.shapes.push(shape_def(n));
    }
    if n.chance(0.1) {
        (def.linear_damping, def.angular_damping) = (n.least(0.0, 2.0), n.least(0.0, 2.0));
    }
    if n.chance(0.1) {
        def.sleeping = Sleeping::Off;
    }
    if n.chance(0.1) {
        def.quality = Some(n.one_of(&[Quality::Fast, Quality::Exact]));
    }
    if n.chance(0.1) {
        def.gravity_scale = n.signed(1.0);
    }
    if n.chance(0.1) {
        let kilograms = if n.temper == Temper::Wild { n.one_of(&[1e-6, 1e9]) } else { n.between(0.5, 100.0) };
        def.mass = Some(Shape::sphere(0.3).mass_properties(1000.0).scaled_to(kilograms));
    }
    def.user_data = n.index(4) as u64;
    def
}

/// Returns whether every shape of a body's definition is valid.
pub fn is_valid(def: &BodyDef) -> bool {
    def.shapes.iter().all(|shape| shape.check().is_ok())
}

/// Returns whether a body has a shape with mass other than `without`.
pub fn weighs(world: &World, id: BodyId, without: Option<u32>) -> bool {
    world.shape_ids(id).filter(|shape| Some(shape.shape) != without).any(|shape| {
        let def = world.shape_def(shape);
        def.shape.mass_properties(def.density).mass > 0.0
    })
}
