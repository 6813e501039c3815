//! Meshes in Draco bit streams: `KHR_draco_mesh_compression`.

use super::source::Source;
use crate::container::json::At;
use crate::error::{Result, quoted};
use draco_core::{DecodeLimits, DecoderBuffer, ErrorKind, Mesh, MeshDecoder};

/// Name of the extension.
pub(super) const NAME: &str = "KHR_draco_mesh_compression";

/// Upper bound of the decoder's working memory per face, bytes: its corner table and vertex data.
const BYTES_PER_FACE: usize = 64;

/// A decoded stream.
pub(super) struct Decoded<'a> {
    /// The extension's object in the file.
    at: At<'a>,
    mesh: Mesh,
}

impl<'a> Decoded<'a> {
    /// Returns the primitive's stream; `None` if its vertices are uncompressed, or an uncompressed fallback
    /// exists.
    pub(super) fn of(source: &Source<'a>, primitive: At<'a>, position: At<'a>) -> Result<Option<Self>> {
        let accessor = source.accessors[position.index(source.accessors.len(), "accessors")?];
        let plain = accessor.get("bufferView")?.is_some() || accessor.get("sparse")?.is_some();
        let extensions = primitive.get("extensions")?;
        let Some(at) = extensions.map(|all| all.get(NAME)).transpose()?.flatten().filter(|_| !plain) else {
            return Ok(None);
        };
        let (bytes, _) = source.view(at.need("bufferView")?)?;
        // The sizes of the accessors count against the budget, and the stream may not exceed them.
        let faces = match primitive.get("indices")? {
            Some(indices) => {
                let index = indices.index(source.accessors.len(), "accessors")?;
                source.accessors[index].need("count")?.usize()? / 3
            }
            None => accessor.need("count")?.usize()? / 3,
        };
        source.spend(at, faces, BYTES_PER_FACE)?;
        let limits = DecodeLimits::default()
            .with_max_faces(faces as u64)
            .with_max_points(3 * faces as u64)
            .with_max_decoded_bytes(source.left() as u64);
        let mut mesh = Mesh::new();
        let decoded =
            MeshDecoder::new().decode(&mut DecoderBuffer::new(bytes).with_limits(limits), &mut mesh);
        if let Err(error) = decoded {
            if error.kind() == ErrorKind::LimitExceeded {
                return Err(at.malformed(
                    "the Draco stream has more than its accessors say, or the file's size justifies",
                ));
            }
            let what = quoted(&error.to_string());
            return Err(at.malformed(format!("the Draco stream cannot be decoded: {what}")));
        }
        Ok(Some(Self { at, mesh }))
    }

    /// Number of vertices.
    pub(super) fn count(&self) -> usize {
        self.mesh.num_points()
    }

    /// True if the stream has that attribute; other attributes of the primitive are uncompressed.
    pub(super) fn holds(&self, name: &str) -> Result<bool> {
        Ok(self.at.need("attributes")?.get(name)?.is_some())
    }

    /// Returns an attribute's numbers as stored in the stream, `N` per vertex.
    pub(super) fn numbers<const N: usize>(&self, source: &Source<'a>, name: &str) -> Result<Vec<[f32; N]>> {
        let id_at = self.at.need("attributes")?.need(name)?;
        let id = id_at.usize()?;
        let attribute = u32::try_from(id).ok().and_then(|id| self.mesh.attribute_by_unique_id(id));
        let Some(attribute) = attribute else {
            return Err(id_at.malformed(format!("the Draco stream has no attribute {id}")));
        };
        let there = usize::from(attribute.num_components());
        if there != N {
            return Err(
                id_at.malformed(format!("elements have {there} numbers in the Draco stream, not {N}"))
            );
        }
        source.spend(id_at, self.count(), N * 4)?;
        let flat = attribute.read_f32s(self.count(), N);
        Ok(flat.chunks_exact(N).map(|chunk| core::array::from_fn(|i| chunk[i])).collect())
    }

    /// Returns the corners of all triangles.
    pub(super) fn triangles(&self, source: &Source<'a>) -> Result<Vec<u32>> {
        let faces = self.mesh.faces();
        source.spend(self.at, faces.len(), 12)?;
        let corners: Vec<u32> = faces.iter().flatten().map(|corner| corner.0).collect();
        if corners.iter().any(|&corner| corner as usize >= self.count()) {
            return Err(self
                .at
                .malformed("a triangle of the Draco stream names a vertex that it does not have"));
        }
        Ok(corners)
    }
}
