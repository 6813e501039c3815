//! Containers shared by several formats: GLB chunks, JSON as an ordered value, URIs.

pub(crate) mod glb;
pub(crate) mod json;
pub(crate) mod uri;
