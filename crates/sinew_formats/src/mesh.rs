//! Render meshes as plain triangles, the input of `sinew boxes`: a glTF scene in its rest pose, or an OBJ.
//!
//! ```
//! use sinew_formats::{ReadOptions, TriangleMesh, no_files, read_gltf, write_gltf};
//!
//! let file = write_gltf(&sinew::mannequin::mannequin().rig, &[])?;
//! let document = read_gltf(&file, ReadOptions::default(), &mut no_files)?;
//! let mesh = TriangleMesh::from_document(&document)?;
//! let height = mesh.positions.iter().fold(0.0, |top, vertex| f32::max(top, vertex.y));
//! assert!((height - 1.75).abs() < 0.05, "{height} m");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{Error, Result};
use crate::gltf::Document;
use sinew_anim::{Primitive, Rig, local_to_model, rest_pose, skin_vertices};
use sinew_math::{Affine, Mat3, Vec3};

/// Triangles with a common list of vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// Vertices in file units: metres in a glTF; undefined in an OBJ.
    pub positions: Vec<Vec3>,
    /// Linear RGB of each vertex, 0..=1, without textures.
    pub colors: Vec<[f32; 3]>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Omissions with their reasons, one sentence each.
    pub warnings: Vec<String>,
}

impl TriangleMesh {
    /// Collects all meshes of a glTF's scene at their nodes' transforms, skinned ones in the rest pose. The outside of
    /// parts mirrored by a node stays outside.
    ///
    /// # Errors
    /// If there are more vertices than an index can address.
    pub fn from_document(document: &Document) -> Result<Self> {
        let mut mesh = Self { warnings: document.warnings.clone(), ..Self::default() };
        let rig = &document.rig;
        let mut model = Vec::new();
        local_to_model(rig, &rest_pose(rig), &Affine::IDENTITY, &mut model);
        for (index, of_rig) in rig.meshes.iter().enumerate() {
            let mirrored = of_rig.skin.is_none() && is_mirrored(&model[of_rig.joint].linear);
            for (part, primitive) in of_rig.primitives.iter().enumerate() {
                mesh.append(rig, [index, part], primitive, &model, mirrored)?;
            }
        }
        Ok(mesh)
    }

    fn append(
        &mut self,
        rig: &Rig,
        [index, part]: [usize; 2],
        primitive: &Primitive,
        model: &[Affine],
        mirrored: bool,
    ) -> Result<()> {
        let first = u32::try_from(self.positions.len() + primitive.positions.len())
            .map(|end| end - primitive.positions.len() as u32)
            .map_err(|_| Error::unsupported("more vertices than 32 bits can count", ""))?;
        let (mut positions, mut normals) = (Vec::new(), Vec::new());
        skin_vertices(rig, index, part, model, &mut positions, &mut normals);
        self.positions.extend(positions);
        let [r, g, b, _] = primitive.base_color;
        self.colors.extend((0..primitive.positions.len()).map(|vertex| {
            let [vr, vg, vb, _] = primitive.colors.get(vertex).copied().unwrap_or([1.0; 4]);
            [r * vr, g * vg, b * vb]
        }));
        self.triangles.extend(primitive.indices.chunks_exact(3).map(|corners| {
            let [a, b, c] = [corners[0], corners[1], corners[2]].map(|i| i + first);
            if mirrored { [a, c, b] } else { [a, b, c] }
        }));
        Ok(())
    }
}

fn is_mirrored(m: &Mat3) -> bool {
    m.x_axis.cross(m.y_axis).dot(m.z_axis) < 0.0
}
