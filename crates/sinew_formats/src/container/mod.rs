//! Containers that formats share: GLB chunks, JSON as an ordered value, URIs.

pub(crate) mod glb;
pub(crate) mod json;
pub(crate) mod uri;
