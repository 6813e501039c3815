//! Colliders from the meshes that Bevy draws.

use crate::Collider;
use bevy_app::{App, FixedPreUpdate, Plugin};
use bevy_asset::Assets;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_mesh::{Mesh, Mesh3d, PrimitiveTopology, VertexAttributeValues};
use bevy_transform::helper::TransformHelper;
use sinew_physics::Shape;

/// Makes colliders from meshes ([`MeshCollider`]). Needs Bevy's `MeshPlugin`, included in `DefaultPlugins`.
#[derive(Clone, Copy, Debug, Default)]
pub struct SinewMeshPlugin;

impl Plugin for SinewMeshPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(FixedPreUpdate, make_colliders);
    }
}

/// Gives its entity a [`Collider`] of the `Mesh3d` once the mesh is loaded, in the present scale of the entity. A body of triangles has no
/// mass: use triangles for static bodies, and the hull for moving ones.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshCollider {
    /// The triangles of the mesh.
    Triangles,
    /// The convex hull of the mesh.
    Hull,
}

/// Reason why a mesh gives no collider.
#[derive(Debug, thiserror::Error)]
pub enum MeshColliderError {
    /// The mesh has no positions in the main world.
    #[error("the mesh has no positions")]
    NoPositions,
    /// The mesh is no list of triangles.
    #[error("the mesh is no list of triangles but {0:?}")]
    NoTriangles(PrimitiveTopology),
    /// The triangles of the mesh are not valid.
    #[error(transparent)]
    Mesh(#[from] sinew_physics::MeshError),
    /// The mesh spans no solid.
    #[error(transparent)]
    Hull(#[from] sinew_physics::HullError),
}

impl MeshCollider {
    /// Returns the collider of a mesh that is scaled by these factors.
    ///
    /// # Errors
    /// If the mesh has no positions or triangles, or these are not valid.
    pub fn of(self, mesh: &Mesh, scale: Vec3) -> Result<Collider, MeshColliderError> {
        let positions = mesh.attribute(Mesh::ATTRIBUTE_POSITION);
        let Some(VertexAttributeValues::Float32x3(positions)) = positions else {
            return Err(MeshColliderError::NoPositions);
        };
        let vertices: Vec<Vec3> = positions.iter().map(|&at| Vec3::from_array(at) * scale).collect();
        let shape = match self {
            Self::Hull => Shape::hull(&vertices)?,
            Self::Triangles => Shape::mesh(&vertices, &triangles(mesh, scale, vertices.len())?)?,
        };
        Ok(Collider::from(shape))
    }
}

/// Returns the triangles of a mesh, counter-clockwise from outside even if the scale mirrors.
fn triangles(mesh: &Mesh, scale: Vec3, vertices: usize) -> Result<Vec<[u32; 3]>, MeshColliderError> {
    if mesh.primitive_topology() != PrimitiveTopology::TriangleList {
        return Err(MeshColliderError::NoTriangles(mesh.primitive_topology()));
    }
    let indices: Vec<u32> = match mesh.indices() {
        Some(indices) => indices.iter().map(|index| index as u32).collect(),
        None => (0..vertices as u32).collect(),
    };
    let is_mirrored = scale.x * scale.y * scale.z < 0.0;
    let turned = |&[a, b, c]: &[u32; 3]| if is_mirrored { [a, c, b] } else { [a, b, c] };
    Ok(indices.as_chunks().0.iter().map(turned).collect())
}

fn make_colliders(
    mut commands: Commands,
    meshes: Res<Assets<Mesh>>,
    waiting: Query<(Entity, &MeshCollider, &Mesh3d), Without<Made>>,
    global: TransformHelper,
) {
    for (entity, collider, Mesh3d(handle)) in &waiting {
        let (Some(mesh), Ok(pose)) = (meshes.get(handle), global.compute_global_transform(entity)) else {
            continue;
        };
        match collider.of(mesh, pose.scale()) {
            Ok(collider) => commands.entity(entity).insert((collider, Made)),
            Err(error) => panic!("{entity}: {error}"),
        };
    }
}

/// Marks entities whose [`MeshCollider`] was used.
#[derive(Component)]
struct Made;
