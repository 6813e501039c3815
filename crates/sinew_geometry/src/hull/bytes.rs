//! Hulls as bytes: corners and faces, from which all other data is computed.

use super::build::from_faces;
use super::{Hull, MAX_FACES, MAX_VERTICES};
use sinew_math::{ReadError, Reader, Vec3, Writer};

/// Sizes of a corner and of the smallest face, bytes.
const VERTEX_BYTES: usize = 12;
const FACE_BYTES: usize = 4 + 3;

fn write(w: &mut Writer, vertices: &[Vec3], loops: impl ExactSizeIterator<Item = Vec<u8>>) {
    w.count(vertices.len());
    vertices.iter().for_each(|&v| w.vec3(v));
    w.count(loops.len());
    for ring in loops {
        w.count(ring.len());
        w.raw(&ring);
    }
}

/// Returns the hash of the bytes that `write` produces.
pub(super) fn hash(vertices: &[Vec3], loops: &[Vec<u8>]) -> u64 {
    let mut w = Writer::new();
    write(&mut w, vertices, loops.iter().cloned());
    sinew_math::hash::hash_bytes(w.as_bytes())
}

impl Hull {
    /// Writes the corners and the faces.
    pub fn save(&self, w: &mut Writer) {
        let faces = self.faces().map(|face| face.corners().map(|corner| corner as u8).collect());
        write(w, &self.vertices, faces);
    }

    /// Reads a hull from the bytes that [`save`](Self::save) writes.
    ///
    /// # Errors
    /// If the bytes end too early or are not those of a convex solid.
    pub fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let count = r.count(VERTEX_BYTES)?;
        if !(4..=MAX_VERTICES).contains(&count) {
            return Err(r.error("a hull has too few or too many corners"));
        }
        let vertices = (0..count).map(|_| r.vec3()).collect::<Result<Vec<Vec3>, _>>()?;
        if !vertices.iter().all(|v| v.is_finite()) {
            return Err(r.error("a corner of a hull is not finite"));
        }
        let count = r.count(FACE_BYTES)?;
        if !(4..=MAX_FACES).contains(&count) {
            return Err(r.error("a hull has too few or too many faces"));
        }
        let mut loops = Vec::with_capacity(count);
        for _ in 0..count {
            let corners = r.count(1)?;
            if corners > vertices.len() {
                return Err(r.error("a face of a hull has too many corners"));
            }
            loops.push(r.raw(corners)?.to_vec());
        }
        from_faces(vertices, &loops).map_err(|what| r.error(what))
    }
}
