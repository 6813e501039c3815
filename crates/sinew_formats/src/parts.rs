//! Parts shared by world files and ragdoll files: poses, shapes, masses.

use crate::container::json::{At, number, numbers};
use crate::error::{Result, quoted};
use crate::triangles;
use serde_json::{Map, Value};
use sinew_math::{Rotation, Sym3, Transform, Vec3};
use sinew_physics::{Hull, MassProperties, Shape};
use std::sync::Arc;

/// Keys of a pose, for the key list of its object.
pub(crate) const POSE_KEYS: [&str; 2] = ["position", "rotation"];

/// Reads `position` and `rotation` of an object; the identity if both are absent.
pub(crate) fn read_pose(at: At<'_>) -> Result<Transform> {
    let translation = read_vector(at, "position")?;
    let rotation = at.get("rotation")?.map_or(Ok(Rotation::IDENTITY), read_rotation)?;
    Ok(Transform { translation, rotation })
}

/// Reads the vector under an optional key; zero if absent.
pub(crate) fn read_vector(at: At<'_>, key: &str) -> Result<Vec3> {
    Ok(Vec3::from_array(at.numbers_or(key, [0.0; 3])?))
}

/// Reads a quaternion `[x, y, z, w]` of length 1, or `{"axis": [x, y, z], "degrees": d}`.
fn read_rotation(at: At<'_>) -> Result<Rotation> {
    if at.value().is_object() {
        at.only(&["axis", "degrees"])?;
        let axis_at = at.need("axis")?;
        let axis = Vec3::from_array(axis_at.numbers()?);
        let length = axis.length();
        if !(length > 1e-6 && length.is_finite()) {
            return Err(axis_at.malformed("axis has no direction"));
        }
        return Ok(Rotation::from_axis_angle(axis / length, at.need("degrees")?.f32()?.to_radians()));
    }
    let [x, y, z, w] = at.numbers()?;
    let rotation = Rotation::from_xyzw(x, y, z, w);
    let square = rotation.dot(rotation);
    if (square - 1.0).abs() >= 1e-2 {
        return Err(at.malformed("quaternion must have length 1"));
    }
    // A rotation that Sinew wrote is not normalised again, so that its bits stay the same.
    Ok(if (square - 1.0).abs() < 1e-6 { rotation } else { rotation.normalize() })
}

/// Writes the format of [`read_pose`]; nothing for the identity.
pub(crate) fn write_pose(pose: Transform, object: &mut Map<String, Value>) {
    let r = pose.rotation;
    // Compares bits, because −0 differs from 0 in a snapshot.
    let bits = |numbers: &[f32]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    let (position, rotation) = (pose.translation.to_array(), [r.x, r.y, r.z, r.w]);
    if bits(&position) != bits(&[0.0; 3]) {
        object.insert("position".into(), numbers(&position));
    }
    if bits(&rotation) != bits(&[0.0, 0.0, 0.0, 1.0]) {
        object.insert("rotation".into(), numbers(&rotation));
    }
}

/// Keys of a shape's geometry.
pub(crate) const SHAPE_KEYS: [&str; 14] = [
    "type",
    "half_extents",
    "radius",
    "half_height",
    "radius_bottom",
    "radius_top",
    "points",
    "vertices",
    "triangles",
    "columns",
    "rows",
    "spacing",
    "heights",
    "holes",
];

/// Reads a shape by its `type` and sizes.
pub(crate) fn read_shape(at: At<'_>) -> Result<Shape> {
    let kind = at.need("type")?;
    let (shape, needed): (Shape, &[&str]) = match kind.str()? {
        "box" => (Shape::Box { half_extents: read_half_extents(at)? }, &["half_extents"]),
        "sphere" => (Shape::Sphere { radius: at.need("radius")?.positive()? }, &["radius"]),
        "capsule" => {
            let half_height = at.need("half_height")?.not_negative()?;
            (
                Shape::Capsule { half_height, radius: at.need("radius")?.positive()? },
                &["half_height", "radius"],
            )
        }
        "tapered_capsule" => {
            let positive = |key: &str| at.need(key)?.positive();
            let (half_height, radius_bottom, radius_top) =
                (positive("half_height")?, positive("radius_bottom")?, positive("radius_top")?);
            (
                Shape::TaperedCapsule { half_height, radius_bottom, radius_top },
                &["half_height", "radius_bottom", "radius_top"],
            )
        }
        "cylinder" | "cone" => {
            let half_height = at.need("half_height")?.positive()?;
            let radius = at.need("radius")?.positive()?;
            let shape = if kind.str()? == "cone" {
                Shape::Cone { half_height, radius }
            } else {
                Shape::Cylinder { half_height, radius }
            };
            (shape, &["half_height", "radius"])
        }
        "half_space" => (Shape::HalfSpace, &[]),
        "hull" => (Shape::Hull(Arc::new(read_hull(at)?)), &["points"]),
        "mesh" => (triangles::read_mesh(at)?, &["vertices", "triangles"]),
        "height_field" => {
            (triangles::read_height_field(at)?, &["columns", "rows", "spacing", "heights", "holes"])
        }
        other => {
            let other = quoted(other);
            let known =
                "box, sphere, capsule, tapered_capsule, cylinder, cone, hull, half_space, mesh, height_field";
            return Err(kind.malformed(format!("unknown shape {other}; known are {known}")));
        }
    };
    shape.check().map_err(|error| at.malformed(error.what()))?;
    for size in &SHAPE_KEYS[1..] {
        if let Some(extra) = at.get(size)?
            && !needed.contains(size)
        {
            return Err(extra.malformed(format!("a shape of this type has no `{size}`")));
        }
    }
    Ok(shape)
}

fn read_half_extents(at: At<'_>) -> Result<Vec3> {
    let at = at.need("half_extents")?;
    let sizes = at.numbers::<3>()?;
    for (item, size) in at.items()?.into_iter().zip(sizes) {
        if size <= 0.0 {
            return Err(item.malformed("must be more than 0"));
        }
    }
    Ok(Vec3::from_array(sizes))
}

/// Reads a hull from points that it must contain.
fn read_hull(at: At<'_>) -> Result<Hull> {
    let at = at.need("points")?;
    let points = at.items()?.into_iter().map(|item| item.numbers().map(Vec3::from_array));
    let points: Vec<Vec3> = points.collect::<Result<_>>()?;
    Hull::new(&points).map_err(|error| at.malformed(error.to_string()))
}

/// Writes the format of [`read_shape`].
pub(crate) fn write_shape(shape: &Shape, object: &mut Map<String, Value>) {
    let mut put = |key: &str, value: Value| drop(object.insert(key.into(), value));
    match *shape {
        Shape::Box { half_extents } => {
            put("type", "box".into());
            put("half_extents", numbers(&half_extents.to_array()));
        }
        Shape::Sphere { radius } => {
            put("type", "sphere".into());
            put("radius", number(radius));
        }
        Shape::Capsule { half_height, radius } => {
            put("type", "capsule".into());
            put("half_height", number(half_height));
            put("radius", number(radius));
        }
        Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
            put("type", "tapered_capsule".into());
            put("half_height", number(half_height));
            put("radius_bottom", number(radius_bottom));
            put("radius_top", number(radius_top));
        }
        Shape::Cylinder { half_height, radius } => {
            put("type", "cylinder".into());
            put("half_height", number(half_height));
            put("radius", number(radius));
        }
        Shape::Cone { half_height, radius } => {
            put("type", "cone".into());
            put("half_height", number(half_height));
            put("radius", number(radius));
        }
        Shape::HalfSpace => put("type", "half_space".into()),
        Shape::Mesh(ref mesh) => triangles::write_mesh(mesh, object),
        Shape::HeightField(ref field) => triangles::write_height_field(field, object),
        Shape::Hull(ref hull) => {
            put("type", "hull".into());
            put("points", hull.vertices().iter().map(|v| numbers(&v.to_array())).collect());
        }
    }
}

/// Reads `{"kg": m, "center": [x, y, z], "inertia": [xx, yy, zz, yz, xz, xy]}`, the inertia in kg·m² about
/// the centre.
pub(crate) fn read_mass(at: At<'_>) -> Result<MassProperties> {
    at.only(&["kg", "center", "inertia"])?;
    let inertia_at = at.need("inertia")?;
    let [xx, yy, zz, yz, xz, xy] = inertia_at.numbers()?;
    // Leading minors (Sylvester) in f64, in which products of small numbers do not underflow.
    let [a, b, c, d, e, f] = [xx, yy, zz, yz, xz, xy].map(f64::from);
    let minors = [a, a * b - f * f, a * (b * c - d * d) - f * (f * c - d * e) + e * (f * d - b * e)];
    if minors.iter().any(|&m| m <= 0.0) {
        return Err(inertia_at.malformed("must be positive definite"));
    }
    Ok(MassProperties {
        mass: at.need("kg")?.positive()?,
        center: read_vector(at, "center")?,
        inertia: Sym3 { diagonal: Vec3::new(xx, yy, zz), off: Vec3::new(yz, xz, xy) },
    })
}

/// Writes the format of [`read_mass`].
pub(crate) fn write_mass(mass: &MassProperties) -> Value {
    let (d, o) = (mass.inertia.diagonal, mass.inertia.off);
    let mut object = Map::new();
    object.insert("kg".into(), number(mass.mass));
    object.insert("center".into(), numbers(&mass.center.to_array()));
    object.insert("inertia".into(), numbers(&[d.x, d.y, d.z, o.x, o.y, o.z]));
    object.into()
}
