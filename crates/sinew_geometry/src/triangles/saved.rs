//! Meshes and height fields as bytes, for the shape library of a world.

use super::build::{self, Dropped};
use super::height_field::{HeightField, HeightFieldDef};
use super::mesh::{MAX_TRIANGLES, Mesh};
use sinew_math::{ReadError, Reader, Vec3, Writer};

impl Mesh {
    /// Writes the vertices, the triangles with their indices in the user's list, and the counts of dropped triangles.
    pub fn save(&self, w: &mut Writer) {
        w.count(self.vertices().len());
        for &vertex in self.vertices() {
            w.vec3(vertex);
        }
        let Dropped { degenerate, repeated } = self.dropped();
        w.u64(degenerate as u64);
        w.u64(repeated as u64);
        let mut numbered: Vec<(u32, [u32; 3])> = self.numbered().collect();
        numbered.sort_unstable();
        w.count(numbered.len());
        for (number, triangle) in numbered {
            w.u32(number);
            triangle.into_iter().for_each(|index| w.u32(index));
        }
    }

    /// Reads the bytes that [`save`](Self::save) writes. The result equals the saved mesh and has the same hash.
    ///
    /// # Errors
    /// If the bytes are not those of a mesh.
    pub fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let count = r.count(12)?;
        let mut vertices: Vec<Vec3> = Vec::with_capacity(count);
        for _ in 0..count {
            vertices.push(r.vec3()?);
        }
        let dropped = Dropped { degenerate: r.u64()? as usize, repeated: r.u64()? as usize };
        let count = r.count(16)?;
        let mut numbers: Vec<u32> = Vec::with_capacity(count);
        let mut triangles = Vec::with_capacity(count);
        for _ in 0..count {
            numbers.push(r.u32()?);
            triangles.push([r.u32()?, r.u32()?, r.u32()?]);
        }
        let ascend = numbers.is_sorted_by(|a, b| a < b);
        if !ascend || numbers.last().is_some_and(|&last| last as usize >= MAX_TRIANGLES) {
            return Err(r.error("triangles of a mesh are out of order"));
        }
        let sheet = build::sheet(&vertices, &triangles).map_err(|_| r.error("a mesh is not valid"))?;
        if sheet.vertices.len() != vertices.len() || sheet.triangles.len() != triangles.len() {
            return Err(r.error("a mesh contains triangles or vertices that a mesh never stores"));
        }
        Ok(Self::of_sheet(build::Sheet { numbers, dropped, ..sheet }))
    }
}

impl HeightField {
    /// Writes the heights, the spacing and the holes.
    pub fn save(&self, w: &mut Writer) {
        let def = self.def();
        w.u32(def.columns as u32);
        w.u32(def.rows as u32);
        def.spacing.into_iter().for_each(|x| w.f32(x));
        w.count(def.heights.len());
        def.heights.iter().for_each(|&h| w.f32(h));
        w.count(def.holes.len());
        def.holes.iter().for_each(|&hole| w.u32(hole));
    }

    /// Reads the bytes that [`save`](Self::save) writes. The result equals the saved height field and has the same
    /// hash.
    ///
    /// # Errors
    /// If the bytes are not those of a height field.
    pub fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let (columns, rows) = (r.u32()? as usize, r.u32()? as usize);
        let spacing = [r.f32()?, r.f32()?];
        let count = r.count(4)?;
        let mut heights = Vec::with_capacity(count);
        for _ in 0..count {
            heights.push(r.f32()?);
        }
        let count = r.count(4)?;
        let mut holes = Vec::with_capacity(count);
        for _ in 0..count {
            holes.push(r.u32()?);
        }
        let def = HeightFieldDef { columns, rows, spacing, heights, holes };
        Self::new(def).map_err(|_| r.error("a height field is not valid"))
    }
}
