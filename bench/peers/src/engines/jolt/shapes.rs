//! Shapes of Jolt, and masses.

use super::{quaternion, refused, vector};
use crate::engine::Unsupported;
use crate::parry::triangles;
use oxijolt::{BodySettings, CompoundChild, Inertia};
use sinew::math::{Transform, Vec3, min};
use sinew::physics::{BodyDef, BodyKind, MassProperties, Shape, ShapeDef};

/// Radius by which Jolt rounds the edges of boxes for speed, metres (its default).
pub const CONVEX_RADIUS: f32 = 0.05;

/// Half sizes of the box that replaces a half-space, metres; its upper face is the plane.
const HALF_SPACE: Vec3 = Vec3::new(900.0, 10.0, 900.0);

/// Returns the rounding of the edges of a shape that contains a ball of this radius.
fn edge_radius(inner_radius: f32) -> f32 {
    min(CONVEX_RADIUS, 0.5 * inner_radius)
}

/// Returns the given mass, or that of the shapes with their densities.
fn mass(def: &BodyDef) -> MassProperties {
    def.mass.unwrap_or_else(|| sum(&def.shapes, |part| part.shape.mass_properties(part.density)))
}

/// Returns the total mass of shapes, in their body's frame.
fn sum(shapes: &[ShapeDef], mass: impl Fn(&ShapeDef) -> MassProperties) -> MassProperties {
    shapes.iter().fold(MassProperties::default(), |sum, part| {
        sum.combine(&mass(part).transformed(&part.body_from_shape))
    })
}

/// Returns the mass of a shape in Jolt: all shapes have the same density, and a tapered capsule is a box of its mean width.
fn mass_in_jolt(part: &ShapeDef) -> MassProperties {
    let Shape::TaperedCapsule { half_height, radius_bottom, radius_top } = part.shape else {
        return part.shape.mass_properties(1.0);
    };
    let radius = 0.5 * (radius_bottom + radius_top);
    let half_extents = Vec3::new(radius, half_height + radius, radius);
    let middle = Transform::from_translation(Vec3::Y * (0.5 * (radius_top - radius_bottom)));
    Shape::Box { half_extents }.mass_properties(1.0).transformed(&middle)
}

/// Sets the mass of a dynamic body to ours, because Jolt's shapes have no density of their own here.
pub fn with_mass(settings: BodySettings, def: &BodyDef) -> BodySettings {
    let properties = mass(def);
    let rows = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (properties.inertia * axis).to_array());
    settings.mass_and_inertia(properties.mass, Inertia::Tensor(rows))
}

/// Returns all shapes of a body as one, with the body's centre of mass.
pub fn shape(def: &BodyDef) -> Result<oxijolt::Shape, Unsupported> {
    let placed = |part: &ShapeDef| Ok((shape_alone(&part.shape)?, body_from_shape(part)));
    let mut parts = def.shapes.iter().map(placed).collect::<Result<Vec<_>, Unsupported>>()?;
    let shape = match parts.len() {
        // Jolt has no bodies without shapes; the layer disables the contacts of this one.
        0 => return oxijolt::Shape::new_sphere(CONVEX_RADIUS).map_err(refused),
        1 if parts[0].1 == Transform::IDENTITY => parts.remove(0).0,
        _ => compound(&parts)?,
    };
    if def.kind == BodyKind::Static {
        return Ok(shape);
    }
    let offset = mass(def).center - sum(&def.shapes, mass_in_jolt).center;
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
        oxijolt::Shape::new_box_with_convex_radius(vector(half), edge_radius(half.min_element()))
    };
    match *shape {
        Shape::Box { half_extents } => rounded_box(half_extents),
        Shape::Sphere { radius } => oxijolt::Shape::new_sphere(radius),
        Shape::Capsule { half_height, radius } => oxijolt::Shape::new_capsule(half_height, radius),
        Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
            oxijolt::Shape::new_tapered_capsule(half_height, radius_top, radius_bottom)
        }
        Shape::Cylinder { half_height, radius } => {
            let rounding = edge_radius(min(half_height, radius));
            oxijolt::Shape::new_cylinder_with_convex_radius(half_height, radius, rounding)
        }
        Shape::Cone { .. } => return Err(Unsupported::new("no cones")),
        Shape::Hull(ref hull) => {
            let corners: Vec<_> = hull.vertices().iter().copied().map(vector).collect();
            oxijolt::Shape::new_convex_hull_with_convex_radius(&corners, edge_radius(hull.inner_radius()))
        }
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
