//! Parts of a character: joints, skins, meshes.

use crate::garments::mesh_sheet::MeshSheet;
use crate::springs::Springs;
use sinew_math::{Affine, Rotation, Vec2, Vec3};

/// Index of a joint in [`Rig::joints`].
pub type JointIdx = usize;

/// Translation, rotation and scale of a joint relative to its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalTransform {
    /// Translation, file units, parent's axes.
    pub translation: Vec3,
    /// Rotation, of unit length.
    pub rotation: Rotation,
    /// Scale along each axis, 1 by default.
    pub scale: Vec3,
}

impl Default for LocalTransform {
    fn default() -> Self {
        Self { translation: Vec3::ZERO, rotation: Rotation::IDENTITY, scale: Vec3::ONE }
    }
}

impl LocalTransform {
    /// Returns the map from the joint's space to its parent's.
    pub fn to_affine(self) -> Affine {
        Affine::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

/// A node of the file's scene: a bone, or an ancestor or attachment of one.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name in the file, or `""`.
    pub name: String,
    /// Parent, always with a smaller index. `None` for a root.
    pub parent: Option<JointIdx>,
    /// Rest pose of the file (the node's own transform).
    pub rest: LocalTransform,
    /// Index of the node in the source file (glTF node index), the target of a baked clip's channels.
    pub source: usize,
}

/// Skin of a mesh: the joints that move it, and their inverse bind matrices.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin {
    /// Name in the file, or `""`.
    pub name: String,
    /// Joints by skin slot; vertices refer to slots.
    pub joints: Vec<JointIdx>,
    /// Inverse bind matrix per slot: from mesh space to the joint's space. Same length as `joints`.
    pub inverse_bind: Vec<Affine>,
}

/// Part of a mesh with one material. All vertex arrays have the length of `positions` or are empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Primitive {
    /// Positions in mesh space, file units.
    pub positions: Vec<Vec3>,
    /// Unit normals, or empty for flat shading.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, (0, 0) at the top left; or empty.
    pub uvs: Vec<Vec2>,
    /// Linear RGBA per vertex, 0..=1; or empty.
    pub colors: Vec<[f32; 4]>,
    /// Skin slots, up to four per vertex; empty for a rigid mesh.
    pub joints: Vec<[u16; 4]>,
    /// Weights of the slots, their sum 1; empty for a rigid mesh.
    pub weights: Vec<[f32; 4]>,
    /// Vertex indices, three per triangle, counter-clockwise seen from outside.
    pub indices: Vec<u32>,
    /// Base colour, linear RGBA.
    pub base_color: [f32; 4],
    /// Index into [`Rig::textures`] of the base colour texture.
    pub texture: Option<usize>,
    /// Name of the material in the file, or `""`.
    pub material: String,
}

/// A mesh as placed by one node.
#[derive(Clone, Debug, PartialEq)]
pub struct RigMesh {
    /// Name in the file, or `""`.
    pub name: String,
    /// The node that carries the mesh. Ignored for a skinned mesh (glTF 2.0 §3.7.3.3).
    pub joint: JointIdx,
    /// Index into [`Rig::skins`]; `None` for a mesh that moves rigidly with `joint`.
    pub skin: Option<usize>,
    /// Parts of the mesh.
    pub primitives: Vec<Primitive>,
}

/// A picture on a surface: 8-bit sRGB with alpha, rows from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TextureImage {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// `width × height × 4` bytes, RGBA.
    pub rgba: Vec<u8>,
}

/// A character as plain data: every node of its scene, parents before children, with meshes and skins.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rig {
    /// All nodes of the scene, parent before child.
    pub joints: Vec<Joint>,
    /// Skins of the meshes.
    pub skins: Vec<Skin>,
    /// Meshes of the file.
    pub meshes: Vec<RigMesh>,
    /// Decoded base colour textures; empty if pictures were not requested.
    pub textures: Vec<TextureImage>,
    /// Roles that the file itself states (VRM humanoid): VRM 1 bone name and joint.
    pub stated_roles: Vec<(String, JointIdx)>,
    /// Springs that the file itself states (VRM).
    pub springs: Springs,
    /// Meshes converted to cloth ([`lay_sheet`](crate::garments::lay_sheet)); not from a file.
    pub sheets: Vec<MeshSheet>,
}

impl Rig {
    /// True for each joint that is a particle of a [sheet](Self::sheets).
    pub fn is_of_sheet(&self) -> Vec<bool> {
        let mut is_of_sheet = vec![false; self.joints.len()];
        self.sheets.iter().flat_map(|sheet| &sheet.joints).for_each(|&joint| is_of_sheet[joint] = true);
        is_of_sheet
    }
}
