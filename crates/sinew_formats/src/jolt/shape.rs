//! Reads Jolt shapes: one or several solids per body, each with an offset.

use super::objects::{Object, Objects};
use crate::error::{Result, quoted};
use sinew_math::{Transform, Vec3, trig};
use sinew_physics::{Hull, MassProperties, Shape};
use std::sync::Arc;

/// Deepest nesting of shapes, and largest number of solids of a body.
const DEEPEST: usize = 8;
const MOST: usize = 64;

/// A solid of a body.
pub(super) struct Solid {
    pub shape: Shape,
    pub part_from_shape: Transform,
    /// Mass properties in the shape's frame.
    pub mass: MassProperties,
}

impl Solid {
    /// Reads a shape: a sphere, box, capsule or tapered capsule, with or without an offset. A compound collides as its
    /// convex hull; its mass is the sum over its solids.
    pub fn read(objects: &Objects, object: &Object) -> Result<Self> {
        let mut solids = Vec::new();
        collect(objects, object, Transform::IDENTITY, DEEPEST, &mut solids)?;
        if solids.len() == 1
            && let Some(only) = solids.pop()
        {
            return Ok(only);
        }
        let middle =
            solids.iter().map(|solid| solid.part_from_shape.translation).sum::<Vec3>() / solids.len() as f32;
        let (mut mass, mut points) = (MassProperties::default(), Vec::new());
        for solid in &solids {
            let shape_from_solid = Transform::from_translation(-middle) * solid.part_from_shape;
            mass = mass.combine(&solid.mass.transformed(&shape_from_solid));
            points.extend(outline(&solid.shape).into_iter().map(|point| shape_from_solid.point(point)));
        }
        let hull = Hull::new(&points).map_err(|error| object.malformed(error.to_string()))?;
        Ok(Self {
            shape: Shape::Hull(Arc::new(hull)),
            part_from_shape: Transform::from_translation(middle),
            mass,
        })
    }
}

/// Collects all solids of a shape, in the axes of its part.
fn collect(
    objects: &Objects,
    object: &Object,
    part_from_this: Transform,
    depth: usize,
    solids: &mut Vec<Solid>,
) -> Result<()> {
    if depth == 0 {
        return Err(object.unsupported("shapes nested deeper than 8"));
    }
    match object.class.as_str() {
        "StaticCompoundShapeSettings" | "MutableCompoundShapeSettings" => {
            let parts = object.member("mSubShapes")?;
            if parts.list()?.is_empty() {
                return Err(object.malformed("an empty compound"));
            }
            for part in parts.list()? {
                let part = objects.need(part)?;
                let inner = objects.need(part.member("mShape")?)?;
                collect(objects, inner, part_from_this * place(part)?, depth - 1, solids)?;
            }
            Ok(())
        }
        "RotatedTranslatedShapeSettings" => {
            let inner = objects.need(object.member("mInnerShape")?)?;
            collect(objects, inner, part_from_this * place(object)?, depth - 1, solids)
        }
        _ if solids.len() == MOST => Err(object.unsupported("a body of more than 64 solids")),
        _ => {
            let shape = primitive(object)?;
            shape.check().map_err(|error| object.malformed(error.what()))?;
            let density = object.member("mDensity")?.number()?;
            if density <= 0.0 {
                return Err(object.malformed("a density that is not positive"));
            }
            let mass = shape.mass_properties(density);
            if !(mass.mass > 0.0 && mass.mass.is_finite() && mass.inertia.is_finite()) {
                return Err(object.malformed("a solid of zero or infinite mass"));
            }
            solids.push(Solid { shape, part_from_shape: part_from_this, mass });
            Ok(())
        }
    }
}

fn place(object: &Object) -> Result<Transform> {
    Ok(Transform::new(object.member("mPosition")?.vec3()?, object.member("mRotation")?.rotation()?))
}

fn primitive(object: &Object) -> Result<Shape> {
    let number = |name: &str| object.member(name)?.number();
    Ok(match object.class.as_str() {
        "SphereShapeSettings" => Shape::Sphere { radius: number("mRadius")? },
        "BoxShapeSettings" => Shape::Box { half_extents: object.member("mHalfExtent")?.vec3()? },
        "CapsuleShapeSettings" => {
            Shape::Capsule { half_height: number("mHalfHeightOfCylinder")?, radius: number("mRadius")? }
        }
        "TaperedCapsuleShapeSettings" => Shape::TaperedCapsule {
            half_height: number("mHalfHeightOfTaperedCylinder")?,
            radius_bottom: number("mBottomRadius")?,
            radius_top: number("mTopRadius")?,
        },
        other => return Err(object.unsupported(format!("a shape of class {}", quoted(other)))),
    })
}

/// Returns sample points on a solid: corners of a box, else rings on the balls at both ends.
fn outline(shape: &Shape) -> Vec<Vec3> {
    const AROUND: usize = 8;
    let balls = match *shape {
        Shape::Box { half_extents: h } => {
            let sign = |bit: usize| if bit == 0 { -1.0 } else { 1.0 };
            return (0..8).map(|i| h * Vec3::new(sign(i & 1), sign(i & 2), sign(i & 4))).collect();
        }
        Shape::Capsule { half_height, radius } => [(-half_height, radius), (half_height, radius)],
        Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
            [(-half_height, radius_bottom), (half_height, radius_top)]
        }
        Shape::Sphere { radius } => [(0.0, radius); 2],
        _ => unreachable!("the reader accepts no other solid"),
    };
    let mut points = Vec::new();
    for (y, radius) in balls {
        points.extend([Vec3::Y * (y - radius), Vec3::Y * (y + radius)]);
        for ring in [-0.707_106_77, 0.0, 0.707_106_77_f32] {
            let across = radius * (1.0 - ring * ring).sqrt();
            points.extend((0..AROUND).map(|i| {
                let (sin, cos) = trig::sin_cos(i as f32 * core::f32::consts::TAU / AROUND as f32);
                Vec3::new(across * cos, y + radius * ring, across * sin)
            }));
        }
    }
    points
}
