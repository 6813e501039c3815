//! Meshes as sheets of cloth, with one joint per particle, to which the vertices are weighted.

mod bind;
mod graph;
mod reduce;
mod split;
mod weld;

use super::MeshSheet;
use crate::rig::{Joint, JointIdx, LocalTransform, Rig, RigMesh, Skin};
use bind::Bound;
use sinew_math::Affine;
use weld::Welded;

/// Part of a rig that becomes a sheet: a whole mesh, or its parts with one material.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshPart {
    /// Name by which the part was requested.
    pub name: String,
    /// Index into [`Rig::meshes`].
    pub mesh: usize,
    /// Primitives of the mesh, ascending.
    pub primitives: Vec<usize>,
}

/// Reason why a part of a rig cannot be cloth.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SheetError {
    /// No mesh or material has the name.
    #[error("no mesh or material has that name")]
    Unknown,
    /// Several meshes have the name: lists their nodes.
    #[error("{} meshes have that name or material, and a garment is of one: {}", .0.len(), .0.join(", "))]
    Several(Vec<String>),
    /// The part has no weights, but another part of its mesh has weights.
    #[error("that part of the mesh has no weights, and others have: give it some")]
    NoSkin,
    /// The mesh is cloth already.
    #[error("that mesh is a garment already")]
    Twice,
    /// The part has no triangles, or all of them lie in a point.
    #[error("that mesh has no triangles with an area")]
    Empty,
    /// The whole mesh is held.
    #[error("all of that mesh is held: no part can move")]
    AllHeld,
    /// Most of the mesh is not connected to the held part.
    #[error("most of that mesh is not connected to the held part at its top: use a larger `held`")]
    MostlyLoose,
    /// The held pieces are more than the particles allowed.
    #[error(
        "{0} separate pieces of that mesh are held, and each needs a particle: use a larger `most_particles`"
    )]
    TooManyPieces(usize),
    /// The skin would have more joints than its indices can address.
    #[error("its skin has no room for {0} joints more: 65536 is the most")]
    TooManyJoints(usize),
}

/// Settings of a sheet, and the frame of the rig.
#[derive(Clone, Copy, Debug)]
pub struct SheetOptions<'a> {
    /// Bind pose of every joint in model space.
    pub bind_model: &'a [Affine],
    /// Transform to +Y up and metres.
    pub metres_from_model: Affine,
    /// Largest distance between neighbouring particles, metres, positive. Larger if there would be too many particles,
    /// and along diagonals of square cells.
    pub spacing: f32,
    /// Depth below the top of the mesh down to which it is held, metres; `None`: a tenth of its height.
    pub held: Option<f32>,
    /// Largest number of particles, at least 4: finer meshes are reduced to this number, and coarser ones are not split
    /// beyond it.
    pub most_particles: usize,
    /// File node of the first new joint ([`Joint::source`]); the others follow.
    pub first_source: usize,
}

impl MeshPart {
    /// Returns the mesh of a node with that name, the mesh with that name, or the parts with a material of that name.
    ///
    /// # Errors
    /// If there is none or more than one, or the part is the unweighted part of a skinned mesh.
    pub fn named(rig: &Rig, name: &str) -> Result<Self, SheetError> {
        let node = |mesh: usize| rig.joints[rig.meshes[mesh].joint].name.as_str();
        let all = |mesh: usize| (0..rig.meshes[mesh].primitives.len()).collect::<Vec<usize>>();
        let of_material = |mesh: usize| {
            let mut found = all(mesh);
            found.retain(|&at| rig.meshes[mesh].primitives[at].material == name);
            found
        };
        let by_node = |mesh: usize| if node(mesh) == name { all(mesh) } else { Vec::new() };
        let by_name = |mesh: usize| if rig.meshes[mesh].name == name { all(mesh) } else { Vec::new() };
        let ways: [&dyn Fn(usize) -> Vec<usize>; 3] = [&by_node, &by_name, &of_material];
        for way in ways {
            let found = (0..rig.meshes.len()).map(|mesh| (mesh, way(mesh)));
            let found: Vec<(usize, Vec<usize>)> = found.filter(|(_, part)| !part.is_empty()).collect();
            if found.is_empty() {
                continue;
            }
            return match found.as_slice() {
                [(mesh, _)] if rig.is_beside_skin(*mesh) => Err(SheetError::NoSkin),
                [(mesh, primitives)] => {
                    Ok(Self { name: name.to_owned(), mesh: *mesh, primitives: primitives.clone() })
                }
                several => {
                    Err(SheetError::Several(several.iter().map(|(mesh, _)| node(*mesh).to_owned()).collect()))
                }
            };
        }
        Err(SheetError::Unknown)
    }

    /// Returns the names of all meshes, their nodes and their materials, each only once.
    pub fn names(rig: &Rig) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for mesh in &rig.meshes {
            let materials = mesh.primitives.iter().map(|primitive| &primitive.material);
            for name in [&rig.joints[mesh.joint].name, &mesh.name].into_iter().chain(materials) {
                if !name.is_empty() && !names.contains(name) {
                    names.push(name.clone());
                }
            }
        }
        names
    }
}

/// Makes a sheet of a part of a rig. Coinciding vertices are merged; a finer mesh is reduced to particles no farther
/// apart than the spacing, borders first; longer edges are split. The rig gets a joint per particle, and each vertex
/// is weighted to its own particle, or to the three of its triangle. While the new joints are not moved, the mesh
/// follows the old ones.
///
/// Loose parts (buttons, a buckle) follow the cloth under them.
///
/// Returns the index of the sheet in [`Rig::sheets`].
///
/// # Errors
/// If the part cannot be a sheet; the rig is unchanged then.
///
/// # Panics
/// If the part or the bind pose is of another rig.
pub fn lay_sheet(rig: &mut Rig, part: &MeshPart, options: &SheetOptions<'_>) -> Result<usize, SheetError> {
    let overlaps = |sheet: &MeshSheet| {
        sheet.mesh == part.mesh
            && sheet.primitives.iter().any(|primitive| part.primitives.contains(primitive))
    };
    if rig.sheets.iter().any(overlaps) {
        return Err(SheetError::Twice);
    }
    if rig.is_beside_skin(part.mesh) {
        return Err(SheetError::NoSkin);
    }
    if rig.meshes[part.mesh].skin.is_some() {
        return lay(rig, part, options);
    }
    rig.hang_on_its_joint(part.mesh);
    let laid = lay(rig, part, options);
    if laid.is_err() {
        rig.hang_rigidly(part.mesh);
    }
    laid
}

impl Rig {
    /// True if a mesh without a skin is part of a skinned one.
    fn is_beside_skin(&self, mesh: usize) -> bool {
        let RigMesh { joint, skin, .. } = self.meshes[mesh];
        skin.is_none() && self.meshes.iter().any(|other| other.joint == joint && other.skin.is_some())
    }

    /// Gives a rigid mesh its own skin, with all weights on its joint.
    fn hang_on_its_joint(&mut self, mesh: usize) {
        let mesh = &mut self.meshes[mesh];
        mesh.skin = Some(self.skins.len());
        let joints = vec![mesh.joint];
        self.skins.push(Skin { name: mesh.name.clone(), joints, inverse_bind: vec![Affine::IDENTITY] });
        for primitive in &mut mesh.primitives {
            primitive.joints = vec![[0; 4]; primitive.positions.len()];
            primitive.weights = vec![[1.0, 0.0, 0.0, 0.0]; primitive.positions.len()];
        }
    }

    /// Removes the skin that [`hang_on_its_joint`](Self::hang_on_its_joint) added (the last one).
    fn hang_rigidly(&mut self, mesh: usize) {
        self.skins.pop();
        let mesh = &mut self.meshes[mesh];
        mesh.skin = None;
        for primitive in &mut mesh.primitives {
            (primitive.joints, primitive.weights) = (Vec::new(), Vec::new());
        }
    }
}

fn lay(rig: &mut Rig, part: &MeshPart, options: &SheetOptions<'_>) -> Result<usize, SheetError> {
    let mut welded = weld::weld(rig, part, options);
    let (vertices, longest_edge) = (welded.places.len(), welded.longest_edge());
    let (low, high) = welded.heights().ok_or(SheetError::Empty)?;
    let above = high - options.held.unwrap_or(crate::tuning::HELD_SHARE * (high - low));
    welded.split_connected(above, options);
    let graph = graph::Graph::new(&welded);
    let is_held = |vertex: usize| welded.places[vertex].y >= above;
    let reduced = reduce::reduce(&welded, &graph, is_held, options)?;
    let held: Vec<bool> = reduced.seeds.iter().map(|&seed| is_held(seed)).collect();
    if held.iter().all(|&held| held) {
        return Err(SheetError::AllHeld);
    }
    let bound = bind::bind(&welded, &reduced);
    let joints = add_joints(rig, part, &welded, &reduced.seeds, options)?;
    rewrite(rig, part, &welded, &bound, joints.len());
    let sheet = MeshSheet {
        name: part.name.clone(),
        mesh: part.mesh,
        primitives: part.primitives.clone(),
        joints,
        held,
        faces: reduced.faces,
        links: reduced.links,
        areas: reduced.areas,
        vertices,
        longest_edge,
    };
    rig.sheets.push(sheet);
    Ok(rig.sheets.len() - 1)
}

/// Adds a joint for each particle, and its slot at the end of the skin. Each joint moves with its parent.
fn add_joints(
    rig: &mut Rig,
    part: &MeshPart,
    welded: &Welded,
    seeds: &[usize],
    options: &SheetOptions<'_>,
) -> Result<Vec<JointIdx>, SheetError> {
    let number = rig.sheets.len();
    let skin = &mut rig.skins[rig.meshes[part.mesh].skin.expect("a part has a skin")];
    if skin.joints.len() + seeds.len() > usize::from(u16::MAX) + 1 {
        return Err(SheetError::TooManyJoints(seeds.len()));
    }
    let mut joints = Vec::with_capacity(seeds.len());
    for (particle, &seed) in seeds.iter().enumerate() {
        let slot = usize::from(welded.slots[seed]);
        let inverse = skin.inverse_bind[slot];
        let translation = inverse.point(welded.at[seed]);
        joints.push(rig.joints.len());
        skin.joints.push(rig.joints.len());
        skin.inverse_bind.push(Affine { translation: inverse.translation - translation, ..inverse });
        rig.joints.push(Joint {
            name: format!("cloth_{number}_{particle}"),
            parent: Some(skin.joints[slot]),
            rest: LocalTransform { translation, ..LocalTransform::default() },
            source: options.first_source + particle,
        });
    }
    Ok(joints)
}

/// Weights the vertices to the last `particles` slots of their skin.
fn rewrite(rig: &mut Rig, part: &MeshPart, welded: &Welded, bound: &[Bound], particles: usize) {
    let mesh = &mut rig.meshes[part.mesh];
    let first = rig.skins[mesh.skin.expect("a part has a skin")].joints.len() - particles;
    for (&at, of_vertex) in part.primitives.iter().zip(&welded.of_vertex) {
        let primitive = &mut mesh.primitives[at];
        for (vertex, of) in of_vertex.iter().enumerate() {
            // Vertices that no triangle uses are not drawn.
            let Some(Bound { particles, weights }) = of.map_or(bound.first(), |of| bound.get(of)) else {
                continue;
            };
            // The slot of a zero weight is 0, as glTF 2.0 §3.7.3.3 requires.
            let slot = |k: usize| if weights[k] > 0.0 { (first + particles[k]) as u16 } else { 0 };
            primitive.joints[vertex] = [0, 1, 2, 3].map(slot);
            primitive.weights[vertex] = *weights;
        }
    }
}
