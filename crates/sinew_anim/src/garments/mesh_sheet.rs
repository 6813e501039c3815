//! Sheets of a rig, as plain data.

use crate::rig::JointIdx;

/// Sheet of cloth that a mesh of a rig became ([`lay_sheet`](super::lay_sheet)). Its particles are joints, each a child of the joint that moved its vertex most.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshSheet {
    /// Name of the mesh or material that it was made of.
    pub name: String,
    /// Index into [`Rig::meshes`](crate::Rig::meshes).
    pub mesh: usize,
    /// Primitives of the mesh that are of cloth, ascending.
    pub primitives: Vec<usize>,
    /// Joint of each particle.
    pub joints: Vec<JointIdx>,
    /// Particles that bodies hold.
    pub held: Vec<bool>,
    /// Triangles of particles.
    pub faces: Vec<[u32; 3]>,
    /// Pairs of particles that are beside each other, each once, the smaller first.
    pub links: Vec<[u32; 2]>,
    /// Area of the mesh about each particle as it was bound, m²: what hangs together has all of its area, however far it was reduced.
    pub areas: Vec<f32>,
    /// Places of vertices of the mesh, those that are in one place counted once.
    pub vertices: usize,
    /// Longest edge of the mesh as it was bound, metres: where it is longer than the spacing, particles lie between its vertices, and what is drawn is flat there.
    pub longest_edge: f32,
}
