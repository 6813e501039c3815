//! Shapes of Jolt, and masses.

use super::{quaternion, refused, vector};
use crate::engine::Unsupported;
use crate::parry::triangles;
use oxijolt::{BodySettings, CompoundChild, Inertia};
use sinew::math::{Transform, Vec3, min};
use sinew::physics::{BodyDef, BodyKind, MassProperties, Shape, ShapeDef};

/// Jolt rounds the edges of boxes by this for speed, metres (its default).
pub const CONVEX_RADIUS: f32 = 0.05;

/// Half sizes of the box that stands for a half-space, metres; its upper face is the plane.
const HALF_SPACE: Vec3 = Vec3::new(900.0, 10.0, 900.0);

/// As given, or that of the shapes with their densities.
fn mass(def: &BodyDef) -> MassProperties {
    def.mass.unwrap_or_else(|| mass_of_shapes(&def.shapes, |shape| shape.density))
}

fn mass_of_shapes(shapes: &[ShapeDef], density: impl Fn(&ShapeDef) -> f32) -> MassProperties {
    shapes.iter().fold(MassProperties::default(), |sum, part| {
        sum.combine(&part.shape.mass_properties(density(part)).transformed(&part.body_from_shape))
    })
}

/// Gives a dynamic body its mass: ours, for Jolt's shapes have no density of their own here.
pub fn with_mass(settings: BodySettings, def: &BodyDef) -> BodySettings {
    let properties = mass(def);
    let rows = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (properties.inertia * axis).to_array());
    settings.mass_and_inertia(properties.mass, Inertia::Tensor(rows))
}

/// All shapes of a body as one, its centre of mass where the body has it.
pub fn shape(def: &BodyDef) -> Result<oxijolt::Shape, Unsupported> {
    let placed = |part: &ShapeDef| Ok((shape_alone(&part.shape)?, body_from_shape(part)));
    let mut parts = def.shapes.iter().map(placed).collect::<Result<Vec<_>, Unsupported>>()?;
    let shape = match parts.len() {
        // Bodies without shapes there are none; its layer keeps this one from meeting anything.
        0 => return oxijolt::Shape::new_sphere(CONVEX_RADIUS).map_err(refused),
        1 if parts[0].1 == Transform::IDENTITY => parts.remove(0).0,
        _ => compound(&parts)?,
    };
    if def.kind == BodyKind::Static {
        return Ok(shape);
    }
    // Jolt's shapes all have the same density.
    let offset = mass(def).center - mass_of_shapes(&def.shapes, |_| 1.0).center;
    if offset.length() < 1e-6 {
        return Ok(shape);
    }
    oxijolt::Shape::new_offset_center_of_mass(&shape, vector(offset)).map_err(refused)
}

fn compound(parts: &[(oxijolt::Shape, Transform)]) -> Result<oxijolt::Shape, Unsupported> {
    let children: Vec<_> = parts
        .iter()
        .map(|(shape, place)| CompoundChild {
            shape,
            position: vector(place.translation),
            rotation: quaternion(place.rotation),
            user_data: 0,
        })
        .collect();
    oxijolt::Shape::new_compound(&children).map_err(refused)
}

fn shape_alone(shape: &Shape) -> Result<oxijolt::Shape, Unsupported> {
    let rounded_box = |half: Vec3| {
        let radius = min(CONVEX_RADIUS, 0.5 * half.min_element());
        oxijolt::Shape::new_box_with_convex_radius(vector(half), radius)
    };
    match *shape {
        Shape::Box { half_extents } => rounded_box(half_extents),
        Shape::Sphere { radius } => oxijolt::Shape::new_sphere(radius),
        Shape::Capsule { half_height, radius } => oxijolt::Shape::new_capsule(half_height, radius),
        Shape::HalfSpace => rounded_box(HALF_SPACE),
        Shape::Mesh(_) | Shape::HeightField(_) => {
            let (vertices, triangles) = triangles(shape).expect("it has triangles");
            let vertices: Vec<_> = vertices.into_iter().map(vector).collect();
            oxijolt::Shape::new_mesh(&vertices, &triangles).map(|(mesh, _)| mesh)
        }
    }
    .map_err(refused)
}

fn body_from_shape(def: &ShapeDef) -> Transform {
    match def.shape {
        Shape::HalfSpace => def.body_from_shape * Transform::from_translation(Vec3::NEG_Y * HALF_SPACE.y),
        _ => def.body_from_shape,
    }
}
