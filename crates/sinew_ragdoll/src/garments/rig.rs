//! Garments ready to be simulated: sheets, and the joints that follow them, parents first.

use super::mesh::{Around, Grain};
use super::sheet::Sheet;
use crate::def::RagdollDef;
use crate::mapping::Mapping;
use sinew_anim::garments::MeshSheet;
use sinew_anim::{Garment, JointIdx, Rig};
use sinew_math::{Affine, Mat3, Rotation, Vec3, any_orthonormal, direction};

/// Joint that garments attach to or that follows a sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node {
    pub joint: JointIdx,
    /// Index of the parent among the nodes; smaller than the node's own.
    pub parent: Option<usize>,
    /// Manner in which the node moves with a garment.
    pub moves: Moves,
}

/// Manner in which a joint moves with a garment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Moves {
    /// The joint does not follow a sheet.
    Nothing,
    /// The joint follows a sheet: index of its bone.
    Bone(usize),
    /// The joint is a particle: index of the grain.
    Particle(usize),
}

/// Nodes that follow a sheet.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Hanging {
    Columns(Vec<Column>),
    /// Nodes of the particles, one per particle.
    Particles(Vec<usize>),
}

/// Bone that follows a sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bone {
    pub node: usize,
    pub sheet: usize,
    /// Line of the sheet at the bone's column.
    pub line: usize,
    /// Start and end of the bone, as shares of the distance from seam to hem.
    pub from: f32,
    pub to: f32,
    /// Rotation of the bone in the frame of the sheet under it, at rest.
    pub frame_from_bone: Rotation,
}

/// Column of a sheet.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Column {
    pub nodes: Vec<usize>,
    /// Position of the hem in the last joint's space, unless the last joint is at the hem.
    pub tip: Option<Vec3>,
}

/// Garments of a kind of character, ready to be simulated. Immutable.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GarmentRig {
    source: Vec<Garment>,
    pub(super) nodes: Vec<Node>,
    /// Bones that follow sheets, by node, ascending.
    pub(super) bones: Vec<Bone>,
    /// Sheets, one per garment that has one.
    pub(super) sheets: Vec<Sheet>,
    /// Particles that are joints, by node, ascending.
    pub(super) grains: Vec<Grain>,
    /// Nodes of each sheet.
    pub(super) hung: Vec<Hanging>,
    /// Joints that follow sheets, parents first.
    turning: Vec<JointIdx>,
    left_out: Vec<JointIdx>,
}

/// Column of a garment in the bind pose.
struct Hung<'a> {
    joints: &'a [JointIdx],
    tip: Option<Vec3>,
    /// Body that holds the column.
    body: usize,
    /// Positions of the column's joints and hem, character space, metres.
    way: Vec<Vec3>,
}

impl GarmentRig {
    /// Prepares the garments of a rig with a ragdoll; `bind_model` is the rig's bind pose in model space. A column is
    /// left out ([`left_out`](Self::left_out)) if no body carries it, it has no length, or it contains a joint that
    /// moves a body or belongs to another column. A garment is left out if it has fewer than two columns, and a mesh
    /// sheet if no body carries one of its held particles. A free particle that no body carries hangs from the body of
    /// the nearest held one.
    ///
    /// # Panics
    /// If a garment names a joint that does not exist, or one of its numbers is invalid.
    pub fn new(
        rig: &Rig,
        ragdoll: &RagdollDef,
        mapping: &Mapping,
        bind_model: &[Affine],
        garments: &[Garment],
    ) -> Self {
        let mut it = Self { source: garments.to_vec(), ..Self::default() };
        let mut taken = vec![false; rig.joints.len()];
        let mut worn: Vec<(&Garment, Vec<Hung<'_>>)> = Vec::new();
        let mut sheets: Vec<(&Garment, &MeshSheet, Vec<usize>)> = Vec::new();
        for garment in garments {
            if let Some(mesh) = &garment.sheet {
                match holders(rig, mapping, bind_model, mesh, &mut taken) {
                    Some(bodies) => sheets.push((garment, mesh, bodies)),
                    None => it.left_out.extend(&mesh.joints),
                }
                continue;
            }
            let hung = it.hang(rig, mapping, bind_model, garment, &mut taken);
            if hung.len() < 2 {
                it.left_out.extend(hung.iter().flat_map(|column| column.joints));
            } else {
                worn.push((garment, hung));
            }
        }
        let needed = worn.iter().flat_map(|(_, hung)| hung).flat_map(|column| column.joints);
        let of_meshes = sheets.iter().flat_map(|(_, mesh, _)| &mesh.joints);
        let node_of = it.add_nodes(rig, needed.chain(of_meshes).copied());
        let bind = |joint: JointIdx| mapping.character_from_model() * bind_model[joint];
        for (garment, hung) in &worn {
            let ways: Vec<Vec<Vec3>> = hung.iter().map(|column| column.way.clone()).collect();
            let held_by: Vec<usize> = hung.iter().map(|column| column.body).collect();
            let garment = Garment { closed: garment.closed && hung.len() > 2, ..Garment::clone(garment) };
            let sheet = Sheet::new(&garment, &ways, &held_by, ragdoll);
            it.add_bones(&sheet, hung, &node_of, bind);
            let node = |&joint: &JointIdx| node_of[joint].expect("its joints are nodes");
            let column = |column: &Hung<'_>| Column {
                nodes: column.joints.iter().map(node).collect(),
                tip: column.tip,
            };
            it.hung.push(Hanging::Columns(hung.iter().map(column).collect()));
            it.sheets.push(sheet);
        }
        for (garment, mesh, bodies) in sheets {
            it.add_mesh(garment, mesh, &bodies, &node_of, ragdoll, bind);
        }
        it.finish();
        it
    }

    /// Records for each node how it moves.
    fn finish(&mut self) {
        let it = self;
        it.bones.sort_by_key(|bone| bone.node);
        it.grains.sort_by_key(|grain| grain.node);
        for (index, bone) in it.bones.iter().enumerate() {
            it.nodes[bone.node].moves = Moves::Bone(index);
        }
        for (index, grain) in it.grains.iter().enumerate() {
            it.nodes[grain.node].moves = Moves::Particle(index);
        }
        let turning = it.nodes.iter().filter(|node| node.moves != Moves::Nothing);
        it.turning = turning.map(|node| node.joint).collect();
    }

    fn add_mesh(
        &mut self,
        garment: &Garment,
        mesh: &MeshSheet,
        bodies: &[usize],
        node_of: &[Option<usize>],
        ragdoll: &RagdollDef,
        bind: impl Fn(JointIdx) -> Affine,
    ) {
        let drawn: Vec<Vec3> = mesh.joints.iter().map(|&joint| bind(joint).translation).collect();
        let sheet = Sheet::of_mesh(garment, mesh, &drawn, bodies, ragdoll);
        let nodes: Vec<usize> =
            mesh.joints.iter().map(|&joint| node_of[joint].expect("its joints are nodes")).collect();
        let around = Around::new(&sheet, mesh);
        for (particle, &node) in nodes.iter().enumerate() {
            let bone = bind(mesh.joints[particle]).to_rigid().rotation;
            self.grains.push(Grain::new(node, self.sheets.len(), &sheet, &around, particle, bone));
        }
        self.hung.push(Hanging::Particles(nodes));
        self.sheets.push(sheet);
    }

    /// Finds the columns of a garment that can be worn.
    fn hang<'a>(
        &mut self,
        rig: &Rig,
        mapping: &Mapping,
        bind_model: &[Affine],
        garment: &'a Garment,
        taken: &mut [bool],
    ) -> Vec<Hung<'a>> {
        let character = mapping.character_from_model();
        let mut hung = Vec::new();
        for column in &garment.columns {
            let joints = column.joints.as_slice();
            let tip = (column.tip != Vec3::ZERO).then_some(column.tip);
            let is_free = joints.iter().all(|&joint| !mapping.moves_bodies(joint) && !taken[joint]);
            let place = |&joint: &JointIdx| character.point(bind_model[joint].translation);
            let mut way: Vec<Vec3> = joints.iter().map(place).collect();
            way.extend(tip.map(|tip| character.point(bind_model[joints[joints.len() - 1]].point(tip))));
            let body = joints.first().and_then(|&top| mapping.body_above(rig, top));
            match body {
                Some(body) if is_free && super::grid::length(&way) > 0.0 => {
                    joints.iter().for_each(|&joint| taken[joint] = true);
                    hung.push(Hung { joints, tip, body, way });
                }
                _ => self.left_out.extend(joints),
            }
        }
        hung
    }

    /// Adds nodes: the required joints and all their ancestors. Returns the node of every joint.
    fn add_nodes(&mut self, rig: &Rig, joints: impl Iterator<Item = JointIdx>) -> Vec<Option<usize>> {
        let mut needed = vec![false; rig.joints.len()];
        joints.for_each(|joint| needed[joint] = true);
        for joint in (0..needed.len()).rev() {
            if let Some(parent) = rig.joints[joint].parent.filter(|_| needed[joint]) {
                needed[parent] = true;
            }
        }
        let mut node_of: Vec<Option<usize>> = vec![None; needed.len()];
        for joint in (0..needed.len()).filter(|&joint| needed[joint]) {
            let parent = rig.joints[joint].parent.and_then(|parent| node_of[parent]);
            node_of[joint] = Some(self.nodes.len());
            self.nodes.push(Node { joint, parent, moves: Moves::Nothing });
        }
        node_of
    }

    /// Adds the bones of a sheet: every joint except a last one at the hem.
    fn add_bones(
        &mut self,
        sheet: &Sheet,
        hung: &[Hung<'_>],
        node_of: &[Option<usize>],
        bind: impl Fn(JointIdx) -> Affine,
    ) {
        let places: Vec<Vec3> = sheet.group.particles.iter().map(|particle| particle.position).collect();
        for (index, column) in hung.iter().enumerate() {
            let on_column = |line: &super::grid::Line| line.column == index && line.share == 0.0;
            let grid = sheet.grid.as_ref().expect("a sheet on columns is a grid");
            let line = grid.lines.iter().position(on_column).expect("each column has a line");
            let whole = super::grid::length(&column.way);
            let share = |at: usize| super::grid::length(&column.way[..=at]) / whole;
            for (at, &joint) in column.joints.iter().enumerate().take(column.way.len() - 1) {
                let mut bone = Bone {
                    node: node_of[joint].expect("its joints are nodes"),
                    sheet: self.sheets.len(),
                    line,
                    from: share(at),
                    to: share(at + 1),
                    frame_from_bone: Rotation::IDENTITY,
                };
                if bone.to <= bone.from {
                    continue;
                }
                if let Some(frame) = bone.frame(sheet, &places) {
                    bone.frame_from_bone = frame.inverse() * bind(joint).to_rigid().rotation;
                    self.bones.push(bone);
                }
            }
        }
    }

    /// Returns the garments from which the rig was made.
    pub fn source(&self) -> &[Garment] {
        &self.source
    }

    /// Returns the joints that follow sheets, parents first.
    pub fn joints(&self) -> impl ExactSizeIterator<Item = JointIdx> {
        self.turning.iter().copied()
    }

    /// Returns the joints that are particles and therefore also move, parents first.
    pub fn moving(&self) -> impl ExactSizeIterator<Item = JointIdx> {
        self.grains.iter().map(|grain| self.nodes[grain.node].joint)
    }

    /// Returns the joints of columns and sheets that were left out.
    pub fn left_out(&self) -> &[JointIdx] {
        &self.left_out
    }

    /// Returns the number of particles of each sheet.
    pub fn particles(&self) -> impl ExactSizeIterator<Item = usize> {
        self.sheets.iter().map(|sheet| sheet.group.particles.len())
    }

    /// Returns true if the rig has no garments.
    pub fn is_empty(&self) -> bool {
        self.sheets.is_empty()
    }
}

/// Returns the bodies from which the particles of a mesh hang. A free particle that no body carries uses the body of
/// its held particle. `None` if no body carries a held particle, or if a particle moves a body or belongs to another
/// garment.
fn holders(
    rig: &Rig,
    mapping: &Mapping,
    bind_model: &[Affine],
    mesh: &MeshSheet,
    taken: &mut [bool],
) -> Option<Vec<usize>> {
    if mesh.joints.iter().any(|&joint| mapping.moves_bodies(joint) || taken[joint]) {
        return None;
    }
    let above: Vec<Option<usize>> = mesh.joints.iter().map(|&joint| mapping.body_above(rig, joint)).collect();
    let places: Vec<Vec3> = mesh.joints.iter().map(|&joint| bind_model[joint].translation).collect();
    let (_, from) = super::mesh::ways_from_held(mesh, &places);
    let bodies: Option<Vec<usize>> =
        above.iter().zip(&from).map(|(own, &held)| own.or(above[held])).collect();
    if bodies.is_some() {
        mesh.joints.iter().for_each(|&joint| taken[joint] = true);
    }
    bodies
}

impl Bone {
    /// Returns the rotation of the sheet under the bone, for particles at `places`: y along the bone, x across where
    /// the sheet has a width. `None` where the sheet has no area.
    pub fn frame(&self, sheet: &Sheet, places: &[Vec3]) -> Option<Rotation> {
        let grid = sheet.grid.as_ref()?;
        let on = |line: usize, share: f32| grid.on_line(places, line, share);
        let y = direction(on(self.line, self.to) - on(self.line, self.from))?;
        let [before, after] = grid.beside(self.line);
        let across = |share: f32| on(after, share) - on(before, share);
        let across = across(self.from) + across(self.to);
        let x = direction(across - y * across.dot(y)).unwrap_or_else(|| any_orthonormal(y));
        Some(Rotation::from_mat3(&Mat3::from_cols(x, y, x.cross(y))))
    }
}
