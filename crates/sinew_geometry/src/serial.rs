//! Serde formats of shapes with data. They store the source data; deserialization builds the shape again.

use crate::hull::Hull;
use crate::triangles::{HeightField, HeightFieldDef, Mesh};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use sinew_math::Vec3;
use std::sync::Arc;

pub(crate) mod hull {
    use super::*;

    type Data = Vec<Vec3>;

    pub(crate) fn serialize<S: Serializer>(hull: &Arc<Hull>, serializer: S) -> Result<S::Ok, S::Error> {
        let data: Data = hull.vertices().to_vec();
        data.serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Arc<Hull>, D::Error> {
        let data = Data::deserialize(deserializer)?;
        Hull::new(&data).map(Arc::new).map_err(Error::custom)
    }
}

pub(crate) mod mesh {
    use super::*;

    type Data = (Vec<Vec3>, Vec<[u32; 3]>);

    pub(crate) fn serialize<S: Serializer>(mesh: &Arc<Mesh>, serializer: S) -> Result<S::Ok, S::Error> {
        let data: Data = (mesh.vertices().to_vec(), mesh.triangles().collect());
        data.serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Arc<Mesh>, D::Error> {
        let data = Data::deserialize(deserializer)?;
        Mesh::new(&data.0, &data.1).map(Arc::new).map_err(Error::custom)
    }
}

pub(crate) mod height_field {
    use super::*;

    type Data = HeightFieldDef;

    pub(crate) fn serialize<S: Serializer>(
        height_field: &Arc<HeightField>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let data: Data = height_field.def().clone();
        data.serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Arc<HeightField>, D::Error> {
        let data = Data::deserialize(deserializer)?;
        HeightField::new(data).map(Arc::new).map_err(Error::custom)
    }
}
