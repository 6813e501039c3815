//! Shapes with data (hulls, meshes, height fields): content hashes and conversion to bytes.

use crate::hull::Hull;
use crate::shape::Shape;
use crate::triangles::{HeightField, Mesh};
use sinew_math::{ReadError, Reader, Writer};
use std::sync::Arc;

/// Kind of a shape with data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DataKind {
    /// Convex hull of points.
    Hull,
    /// Triangle mesh.
    Mesh,
    /// Height field.
    HeightField,
}

/// Kinds in the order of their tags; the first tag is [`FIRST_TAG`].
const KINDS: [DataKind; 3] = [DataKind::Hull, DataKind::Mesh, DataKind::HeightField];
/// First tag of a shape with data. Lower tags belong to shapes without data.
const FIRST_TAG: u8 = 16;

impl DataKind {
    /// Tag that identifies the kind in saved bytes, at least 16. Lower tags belong to shapes without data.
    pub fn tag(self) -> u8 {
        FIRST_TAG + self as u8
    }

    /// Returns the kind with this tag, if there is one.
    pub fn of_tag(tag: u8) -> Option<Self> {
        KINDS.into_iter().find(|kind| kind.tag() == tag)
    }
}

impl core::fmt::Display for DataKind {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Hull => "hull",
            Self::Mesh => "mesh",
            Self::HeightField => "height field",
        })
    }
}

impl Shape {
    /// Hash of the shape's data, the same on every machine; `None` for shapes without data.
    pub fn content_hash(&self) -> Option<u64> {
        match self {
            Self::Mesh(mesh) => Some(mesh.content_hash()),
            Self::HeightField(field) => Some(field.content_hash()),
            Self::Hull(hull) => Some(hull.content_hash()),
            _ => None,
        }
    }

    /// Kind of the shape's data; `None` for shapes without data.
    pub fn data_kind(&self) -> Option<DataKind> {
        match self {
            Self::Hull(_) => Some(DataKind::Hull),
            Self::Mesh(_) => Some(DataKind::Mesh),
            Self::HeightField(_) => Some(DataKind::HeightField),
            _ => None,
        }
    }

    /// Writes the shape's data; nothing for shapes without data.
    pub fn save_data(&self, w: &mut Writer) {
        match self {
            Self::Hull(hull) => hull.save(w),
            Self::Mesh(mesh) => mesh.save(w),
            Self::HeightField(field) => field.save(w),
            _ => {}
        }
    }

    /// Reads a shape of this kind from the bytes that [`save_data`](Self::save_data) writes.
    ///
    /// # Errors
    /// If the bytes are not those of a shape of this kind.
    pub fn load_data(kind: DataKind, data: &mut Reader<'_>) -> Result<Self, ReadError> {
        match kind {
            DataKind::Hull => Ok(Self::Hull(Arc::new(Hull::load(data)?))),
            DataKind::Mesh => Ok(Self::Mesh(Arc::new(Mesh::load(data)?))),
            DataKind::HeightField => Ok(Self::HeightField(Arc::new(HeightField::load(data)?))),
        }
    }
}
