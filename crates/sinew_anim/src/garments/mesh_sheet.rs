//! Sheets of a rig, as plain data.

use crate::rig::JointIdx;

/// Sheet of cloth made from a mesh of a rig ([`lay_sheet`](super::lay_sheet)). Its particles are joints, each a child
/// of the joint that moved its vertex most.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshSheet {
    /// Name of the source mesh or material.
    pub name: String,
    /// Index into [`Rig::meshes`](crate::Rig::meshes).
    pub mesh: usize,
    /// Primitives of the mesh that are cloth, ascending.
    pub primitives: Vec<usize>,
    /// Joint of each particle.
    pub joints: Vec<JointIdx>,
    /// True for each particle that a body holds.
    pub held: Vec<bool>,
    /// Triangles of particles.
    pub faces: Vec<[u32; 3]>,
    /// Pairs of neighbouring particles, each pair once, the smaller index first.
    pub links: Vec<[u32; 2]>,
    /// Area of the mesh around each particle in the bind pose, m²; the areas of a connected piece sum to its whole
    /// area.
    pub areas: Vec<f32>,
    /// Number of unique vertex positions of the mesh.
    pub vertices: usize,
    /// Longest edge of the mesh in the bind pose, metres. If it exceeds the spacing, particles lie between vertices,
    /// and the drawn mesh is flat there.
    pub longest_edge: f32,
}
