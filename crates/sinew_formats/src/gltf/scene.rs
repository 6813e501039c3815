//! Nodes and skins: the tree of joints (glTF 2.0 §3.5, §3.7.3).

use super::source::Source;
use crate::container::json::At;
use crate::error::Result;
use sinew_anim::{Joint, JointIdx, LocalTransform, Rig, Skin};
use sinew_math::{Affine, Mat3, Rotation, Vec3};

/// Tree of a file's nodes, in the rig's order.
pub(super) struct Scene {
    /// Rig with joints and skins; meshes are read later.
    pub(super) rig: Rig,
    /// Joint of each node; `None` for nodes outside the scene that no skin needs.
    pub(super) joint_of_node: Vec<Option<JointIdx>>,
    /// Number of joints that belong to the scene; later joints exist only for a skin.
    pub(super) shown: usize,
}

pub(super) fn read(source: &Source<'_>) -> Result<Scene> {
    let mut tree = Tree::new(source)?;
    for root in scene_roots(source, &tree.parent)? {
        tree.grow(source, root)?;
    }
    let shown = tree.joints.len();
    let skins = source.root.list("skins")?;
    for &skin in &skins {
        for joint in skin.need("joints")?.items()? {
            let node = joint.index(source.nodes.len(), "nodes")?;
            if tree.joint_of_node[node].is_none() {
                let root = tree.topmost(source, node)?;
                tree.grow(source, root)?;
            }
        }
    }
    let skins = skins.iter().map(|&skin| read_skin(source, skin, &tree)).collect::<Result<_>>()?;
    let rig = Rig { joints: tree.joints, skins, ..Rig::default() };
    Ok(Scene { rig, joint_of_node: tree.joint_of_node, shown })
}

/// Returns the root nodes of the default scene, else of the first scene, else all nodes without a parent.
fn scene_roots<'a>(source: &Source<'a>, parent: &[Option<usize>]) -> Result<Vec<usize>> {
    let scenes = source.root.list("scenes")?;
    let chosen = match source.root.get("scene")? {
        Some(at) => Some(scenes[at.index(scenes.len(), "scenes")?]),
        None => scenes.first().copied(),
    };
    match chosen {
        Some(scene) => {
            scene.list("nodes")?.into_iter().map(|at| at.index(source.nodes.len(), "nodes")).collect()
        }
        None => Ok((0..parent.len()).filter(|&i| parent[i].is_none()).collect()),
    }
}

struct Tree {
    parent: Vec<Option<usize>>,
    children: Vec<Vec<usize>>,
    joints: Vec<Joint>,
    joint_of_node: Vec<Option<JointIdx>>,
}

impl Tree {
    fn new(source: &Source<'_>) -> Result<Self> {
        let n = source.nodes.len();
        let mut parent = vec![None; n];
        let mut children = vec![Vec::new(); n];
        for (i, node) in source.nodes.iter().enumerate() {
            for at in node.list("children")? {
                let child = at.index(n, "nodes")?;
                if parent[child].is_some() {
                    return Err(at.malformed(format!("node {child} is a child of two nodes")));
                }
                parent[child] = Some(i);
                children[i].push(child);
            }
        }
        Ok(Self { parent, children, joints: Vec::new(), joint_of_node: vec![None; n] })
    }

    /// Adds a node and its descendants, parents first. Not recursive, because the file determines the depth.
    fn grow(&mut self, source: &Source<'_>, root: usize) -> Result<()> {
        let mut open = vec![(root, None)];
        while let Some((node, parent)) = open.pop() {
            let at = source.nodes[node];
            if self.joint_of_node[node].is_some() {
                return Err(at.malformed("node is its own ancestor, or listed twice in a scene"));
            }
            let joint = self.joints.len();
            self.joint_of_node[node] = Some(joint);
            self.joints.push(Joint { name: at.name(), parent, rest: read_transform(at)?, source: node });
            open.extend(self.children[node].iter().rev().map(|&child| (child, Some(joint))));
        }
        Ok(())
    }

    /// Returns the root above a node.
    fn topmost(&self, source: &Source<'_>, node: usize) -> Result<usize> {
        let mut top = node;
        for _ in 0..self.parent.len() {
            match self.parent[top] {
                Some(up) => top = up,
                None => return Ok(top),
            }
        }
        Err(source.nodes[node].malformed("node is its own ancestor"))
    }
}

fn read_transform(node: At<'_>) -> Result<LocalTransform> {
    if let Some(matrix) = node.get("matrix")? {
        let m = affine(&matrix.numbers()?);
        return Ok(decompose(&m));
    }
    let [x, y, z, w] = node.numbers_or("rotation", [0.0, 0.0, 0.0, 1.0])?;
    Ok(LocalTransform {
        translation: Vec3::from_array(node.numbers_or("translation", [0.0; 3])?),
        rotation: unit(Rotation::from_xyzw(x, y, z, w)),
        scale: Vec3::from_array(node.numbers_or("scale", [1.0; 3])?),
    })
}

/// Normalises a rotation. A quaternion that is unit within rounding is unchanged, so that a file's numbers are
/// preserved.
fn unit(rotation: Rotation) -> Rotation {
    if (rotation.dot(rotation) - 1.0).abs() < 1e-6 { rotation } else { rotation.normalize() }
}

/// Converts column-major 4×4 numbers to an affine map; the last row is (0, 0, 0, 1) by the rules of the format.
fn affine(m: &[f32; 16]) -> Affine {
    let column = |i: usize| Vec3::new(m[4 * i], m[4 * i + 1], m[4 * i + 2]);
    Affine { linear: Mat3::from_cols(column(0), column(1), column(2)), translation: column(3) }
}

/// Decomposes a node matrix without shear into scale, rotation and translation (§3.5.3). A mirror becomes a
/// negative z scale.
fn decompose(m: &Affine) -> LocalTransform {
    let columns = m.linear;
    let mirrored = columns.x_axis.cross(columns.y_axis).dot(columns.z_axis) < 0.0;
    let depth = columns.z_axis.length();
    let depth = if mirrored { -depth } else { depth };
    LocalTransform {
        translation: m.translation,
        rotation: Rotation::from_mat3_lossy(&columns),
        scale: Vec3::new(columns.x_axis.length(), columns.y_axis.length(), depth),
    }
}

fn read_skin<'a>(source: &Source<'a>, skin: At<'a>, tree: &Tree) -> Result<Skin> {
    let joints_at = skin.need("joints")?;
    let mut joints = Vec::new();
    for at in joints_at.items()? {
        let node = at.index(source.nodes.len(), "nodes")?;
        let joint = tree.joint_of_node[node].ok_or_else(|| at.malformed("joint is in no scene"))?;
        joints.push(joint);
    }
    if joints.is_empty() {
        return Err(joints_at.malformed("a skin needs joints"));
    }
    let inverse_bind = match skin.get("inverseBindMatrices")? {
        None => vec![Affine::IDENTITY; joints.len()],
        Some(at) => {
            let matrices = source.floats::<16>(at)?;
            if matrices.len() < joints.len() {
                let (there, needed) = (matrices.len(), joints.len());
                return Err(at.malformed(format!("{there} inverse bind matrices for {needed} joints")));
            }
            matrices[..joints.len()].iter().map(affine).collect()
        }
    };
    Ok(Skin { name: skin.name(), joints, inverse_bind })
}
