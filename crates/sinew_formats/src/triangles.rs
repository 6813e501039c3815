//! Meshes and height fields in world files, and mesh files as levels.

use crate::container::json::{At, number, numbers};
use crate::error::{Error, Result};
use crate::mesh::TriangleMesh;
use serde_json::{Map, Value};
use sinew_math::Vec3;
use sinew_physics::{BodyDef, BodyKind, HeightField, HeightFieldDef, Mesh, Shape, ShapeDef};
use std::sync::Arc;

/// Reads `vertices`, a list of `[x, y, z]`, and `triangles`, a list of three indices each.
pub(crate) fn read_mesh(at: At<'_>) -> Result<Shape> {
    let vertices_at = at.need("vertices")?;
    let mut vertices = Vec::new();
    for vertex in vertices_at.items()? {
        vertices.push(Vec3::from_array(vertex.numbers()?));
    }
    let mut triangles = Vec::new();
    for triangle in at.need("triangles")?.items()? {
        let corners = triangle.items()?;
        let [a, b, c] = corners[..] else {
            return Err(triangle.malformed(format!("must have 3 indices, has {}", corners.len())));
        };
        let index = |at: At<'_>| at.index(vertices.len(), "vertices").map(|index| index as u32);
        triangles.push([index(a)?, index(b)?, index(c)?]);
    }
    let mesh = Mesh::new(&vertices, &triangles).map_err(|error| at.malformed(error.to_string()))?;
    Ok(Shape::Mesh(Arc::new(mesh)))
}

/// Reads `columns` and `rows` of vertices, `spacing` `[x, z]`, `heights` row after row, and `holes` by cell.
pub(crate) fn read_height_field(at: At<'_>) -> Result<Shape> {
    let mut heights = Vec::new();
    for height in at.need("heights")?.items()? {
        heights.push(height.f32()?);
    }
    let mut holes = Vec::new();
    for hole in at.list("holes")? {
        let cell = u32::try_from(hole.usize()?);
        holes.push(cell.map_err(|_| hole.malformed("must fit 32 bits"))?);
    }
    let def = HeightFieldDef {
        columns: at.need("columns")?.usize()?,
        rows: at.need("rows")?.usize()?,
        spacing: at.need("spacing")?.numbers()?,
        heights,
        holes,
    };
    let field = HeightField::new(def).map_err(|error| at.malformed(error.to_string()))?;
    Ok(Shape::HeightField(Arc::new(field)))
}

/// Writes the format of [`read_mesh`].
pub(crate) fn write_mesh(mesh: &Mesh, object: &mut Map<String, Value>) {
    let vertices = mesh.vertices().iter().map(|vertex| numbers(&vertex.to_array()));
    let triangles = mesh.triangles().map(|triangle| Value::from(triangle.to_vec()));
    object.insert("type".into(), "mesh".into());
    object.insert("vertices".into(), vertices.collect());
    object.insert("triangles".into(), triangles.collect());
}

/// Writes the format of [`read_height_field`].
pub(crate) fn write_height_field(field: &HeightField, object: &mut Map<String, Value>) {
    let HeightFieldDef { columns, rows, spacing, heights, holes } = field.def();
    object.insert("type".into(), "height_field".into());
    object.insert("columns".into(), (*columns).into());
    object.insert("rows".into(), (*rows).into());
    object.insert("spacing".into(), numbers(spacing));
    object.insert("heights".into(), heights.iter().map(|&height| number(height)).collect());
    if !holes.is_empty() {
        object.insert("holes".into(), holes.clone().into());
    }
}

impl TriangleMesh {
    /// Converts the mesh to a level: one static body with a mesh shape.
    ///
    /// # Errors
    /// If no triangle has an area, or coordinates are not finite.
    pub fn to_body(&self) -> Result<BodyDef> {
        let mesh = Mesh::new(&self.positions, &self.triangles);
        let mesh = mesh.map_err(|error| Error::malformed(error.to_string(), ""))?;
        Ok(BodyDef {
            kind: BodyKind::Static,
            shapes: vec![ShapeDef::new(Shape::Mesh(Arc::new(mesh)))],
            ..BodyDef::default()
        })
    }
}
