//! Library of all hulls, meshes and height fields that were added to the world, by content hash (ADR 0014).
//!
//! A snapshot references such a shape by kind and hash, and a restore finds the shape here, which keeps snapshots small
//! and fast. [`World::save_shapes`](crate::World::save_shapes) transfers the library to another process.

use crate::body::shape::Shape;
use core::fmt;
use sinew_geometry::DataKind;
use sinew_math::{ReadError, Reader, Writer};
use std::collections::BTreeMap;

/// First bytes of a written library; the last of them is the version.
pub(crate) const MAGIC: &[u8; 8] = b"sinew-s\x01";
/// Bytes of the smallest entry: its kind and the length of its data.
pub(crate) const ENTRY_BYTES: usize = 5;

/// Reason why a snapshot could not be loaded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LoadError {
    /// The bytes are not a snapshot of this version.
    Bytes(ReadError),
    /// The snapshot references a shape that was never added to this world: see
    /// [`World::load_shapes`](crate::World::load_shapes).
    UnknownShape {
        /// Offset of the hash in the bytes, bytes.
        at: usize,
        /// Expected kind of data.
        kind: DataKind,
        /// Hash of the shape's content.
        hash: u64,
    },
}

impl From<ReadError> for LoadError {
    fn from(error: ReadError) -> Self {
        Self::Bytes(error)
    }
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bytes(error) => error.fmt(f),
            Self::UnknownShape { at, kind, hash } => {
                write!(f, "names a {kind} of hash {hash:016x} that the world does not have (at byte {at})")
            }
        }
    }
}

impl core::error::Error for LoadError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Bytes(error) => error.source(),
            Self::UnknownShape { .. } => None,
        }
    }
}

/// Shapes with data by their content hash. Shapes are never removed: a state that is loaded later may reference any.
#[derive(Clone, Debug, Default)]
pub(crate) struct ShapeLibrary {
    pub shapes: BTreeMap<u64, Shape>,
}

impl ShapeLibrary {
    /// Adds a hull, mesh or height field; ignores other shapes.
    ///
    /// # Panics
    /// If another shape has the same hash.
    pub fn keep(&mut self, shape: &Shape) {
        if let Some(hash) = shape.content_hash() {
            let kept = self.shapes.entry(hash).or_insert_with(|| shape.clone());
            assert!(kept == shape, "no two shapes have the same hash ({hash:016x})");
        }
    }

    /// Reads a hash and returns its shape.
    ///
    /// # Errors
    /// If the world was never given such a shape.
    pub fn find(&self, r: &mut Reader<'_>, kind: DataKind) -> Result<Shape, LoadError> {
        let (at, hash) = (r.position(), r.u64()?);
        let found = self.shapes.get(&hash).filter(|shape| shape.data_kind() == Some(kind));
        found.cloned().ok_or(LoadError::UnknownShape { at, kind, hash })
    }
}

/// Writes the reference to a shape with data. Returns false, and writes nothing, for shapes without data.
pub(crate) fn save_name(shape: &Shape, w: &mut Writer) -> bool {
    let Some((kind, hash)) = shape.data_kind().zip(shape.content_hash()) else { return false };
    w.u8(kind.tag());
    w.u64(hash);
    true
}
