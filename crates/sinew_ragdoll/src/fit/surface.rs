//! Assigns the skin to bones.
//!
//! ```
//! use sinew_ragdoll::fit::surface::for_each_part;
//!
//! // A triangle cut into nine: each is a ninth of it.
//! let mut area = 0.0;
//! for_each_part(3, |[a, b, c]| {
//!     area += 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]));
//! });
//! assert!((area - 0.5).abs() < 1e-6);
//! ```

use crate::build::bones::Bones;
use crate::tuning::{FINEST, LEAST_PULL, MOST_CUTS};
use sinew_anim::skinning::skin_vertices;
use sinew_anim::{JointIdx, Primitive, Rig};
use sinew_math::{Affine, Transform, Vec3, clamp, max, min};

/// A triangle of the skin with its weight for one bone.
#[derive(Clone, Copy, Debug)]
pub struct Share {
    /// Corners, character space at the bind pose, metres.
    pub corners: [Vec3; 3],
    /// Mean weight of the bone (with the bones merged into it) at the corners, 0..=1.
    pub weight: f32,
    /// True if no other bone has more weight on the triangle.
    pub most: bool,
}

/// Returns the index of the bone, if any, that carries each joint of the rig.
///
/// A joint that is neither kept nor merged follows its nearest kept or merged ancestor.
pub fn owners(rig: &Rig, bones: &Bones) -> Vec<Option<usize>> {
    carried(rig, bones.list.iter().map(|bone| (bone.joint, bone.merged.as_slice())))
}

/// Like [`owners`], for bodies by their joints and the joints merged into them; joints that the rig does not have are
/// skipped.
pub(crate) fn carried<'a>(
    rig: &Rig,
    bodies: impl Iterator<Item = (JointIdx, &'a [JointIdx])> + Clone,
) -> Vec<Option<usize>> {
    let mut owner = vec![None; rig.joints.len()];
    let mut own = |joint: JointIdx, bone| {
        if let Some(slot) = owner.get_mut(joint) {
            *slot = Some(bone);
        }
    };
    for (index, (_, merged)) in bodies.clone().enumerate() {
        merged.iter().for_each(|&joint| own(joint, index));
    }
    for (index, (joint, _)) in bodies.enumerate() {
        own(joint, index);
    }
    for joint in 0..owner.len() {
        if owner[joint].is_none() {
            owner[joint] = rig.joints[joint].parent.and_then(|parent| owner[parent]);
        }
    }
    owner
}

/// Bind pose of a rig, with the transform to character space.
#[derive(Clone, Copy, Debug)]
pub struct BindPose<'a> {
    /// Joint to model space, per joint of the rig, file units.
    pub model: &'a [Affine],
    /// Metres per file unit.
    pub unit_scale: f32,
    /// Transform from model space in metres to character space.
    pub character_from_model: Transform,
}

impl BindPose<'_> {
    /// Converts a point from model space, file units, to character space, metres.
    pub fn character_point(&self, model_point: Vec3) -> Vec3 {
        self.character_from_model.point(model_point * self.unit_scale)
    }

    /// Returns the transform from model space, file units, to character space, metres.
    pub fn character_from_file(&self) -> Affine {
        let turn = self.character_from_model;
        let scale = Vec3::splat(self.unit_scale);
        Affine::from_scale_rotation_translation(scale, turn.rotation, turn.translation)
    }
}

/// Returns the skin's triangles by bone. Meshes without a skin (armour, robots) count only for bones that have no skin,
/// so that a sword does not lengthen a hand.
pub fn share_surface(rig: &Rig, bones: &Bones, bind: BindPose<'_>) -> Vec<Vec<Share>> {
    let owner = owners(rig, bones);
    let mut skinned = vec![Vec::new(); bones.list.len()];
    let mut rigid = vec![Vec::new(); bones.list.len()];
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for (m, mesh) in rig.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            skin_vertices(rig, m, p, bind.model, &mut positions, &mut normals);
            for position in &mut positions {
                *position = bind.character_point(*position);
            }
            match mesh.skin.filter(|_| !primitive.joints.is_empty()) {
                Some(skin) => {
                    let slots: Vec<_> = rig.skins[skin].joints.iter().map(|&joint| owner[joint]).collect();
                    share_skinned(primitive, &positions, &slots, FINEST * bones.size(), &mut skinned);
                }
                None => {
                    if let Some(bone) = owner[mesh.joint] {
                        let whole = |corners| Share { corners, weight: 1.0, most: true };
                        rigid[bone].extend(triangles(primitive, &positions).map(|(_, c)| whole(c)));
                    }
                }
            }
        }
    }
    for (bone, shares) in skinned.iter_mut().enumerate() {
        if shares.is_empty() {
            *shares = core::mem::take(&mut rigid[bone]);
        }
    }
    skinned
}

/// Returns all triangles that move with a body, in character space at the bind pose, metres.
pub fn skin_triangles(rig: &Rig, bones: &Bones, bind: BindPose<'_>) -> Vec<[Vec3; 3]> {
    let owner = owners(rig, bones);
    let mut all = Vec::new();
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for (m, mesh) in rig.meshes.iter().enumerate() {
        if mesh.skin.is_none() && owner[mesh.joint].is_none() {
            continue;
        }
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            skin_vertices(rig, m, p, bind.model, &mut positions, &mut normals);
            positions.iter_mut().for_each(|position| *position = bind.character_point(*position));
            all.extend(triangles(primitive, &positions).map(|(_, corners)| corners));
        }
    }
    all
}

/// Returns the indices and positions of the triangles whose corners exist and are finite.
fn triangles<'a>(
    primitive: &'a Primitive,
    positions: &'a [Vec3],
) -> impl Iterator<Item = ([usize; 3], [Vec3; 3])> + 'a {
    primitive.indices.chunks_exact(3).filter_map(|corner| {
        let index = [corner[0] as usize, corner[1] as usize, corner[2] as usize];
        let at = |i: usize| positions.get(i).copied().filter(|p| p.is_finite());
        Some((index, [at(index[0])?, at(index[1])?, at(index[2])?]))
    })
}

/// Index of a bone, and its weights at the corners of a triangle.
type Pull = (usize, [f32; 3]);

/// Subdivides triangles moved by several bones until no side is longer than `finest` (metres), so that each bone gets
/// its own part of them even on a coarse mesh. Weights are linear over a triangle.
fn share_skinned(
    primitive: &Primitive,
    positions: &[Vec3],
    slots: &[Option<usize>],
    finest: f32,
    by_bone: &mut [Vec<Share>],
) {
    // A triangle has at most three corners with four weights each.
    let mut pulls: Vec<Pull> = Vec::with_capacity(12);
    for (index, corners) in triangles(primitive, positions) {
        pulls.clear();
        for (corner, vertex) in index.into_iter().enumerate() {
            for (slot, weight) in primitive.joints[vertex].iter().zip(primitive.weights[vertex]) {
                let Some(&Some(bone)) = slots.get(usize::from(*slot)) else { continue };
                if !pulls.iter().any(|(b, _)| *b == bone) {
                    pulls.push((bone, [0.0; 3]));
                }
                if let Some((_, weights)) = pulls.iter_mut().find(|(b, _)| *b == bone) {
                    weights[corner] += weight;
                }
            }
        }
        pulls.retain(|(_, weights)| weights.iter().any(|&w| w > LEAST_PULL));
        let cuts = if pulls.len() > 1 { cuts_of(&corners, finest) } else { 1 };
        for_each_part(cuts, |at| share_part(&corners, at, &pulls, by_bone));
    }
}

/// Returns the number of parts into which a triangle's sides are cut.
fn cuts_of(corners: &[Vec3; 3], finest: f32) -> usize {
    let [p, q, r] = *corners;
    let longest = max((q - p).length(), max((r - q).length(), (p - r).length()));
    clamp(longest / finest + 0.999, 1.0, MOST_CUTS) as usize
}

/// Cuts a triangle into `cuts`² equal parts and calls `f` with the corners of each, in coordinates along the triangle's
/// first two sides.
pub fn for_each_part(cuts: usize, mut f: impl FnMut([[f32; 2]; 3])) {
    let step = 1.0 / cuts as f32;
    for i in 0..cuts {
        for j in 0..cuts - i {
            let (u, v) = (i as f32 * step, j as f32 * step);
            f([[u, v], [u + step, v], [u, v + step]]);
            if i + j + 1 < cuts {
                f([[u + step, v + step], [u, v + step], [u + step, v]]);
            }
        }
    }
}

fn share_part(corners: &[Vec3; 3], at: [[f32; 2]; 3], pulls: &[Pull], by_bone: &mut [Vec<Share>]) {
    let [p, q, r] = *corners;
    let part = at.map(|[u, v]| p + (q - p) * u + (r - p) * v);
    let (u, v) = ((at[0][0] + at[1][0] + at[2][0]) / 3.0, (at[0][1] + at[1][1] + at[2][1]) / 3.0);
    let weight_of = |w: &[f32; 3]| w[0] * (1.0 - u - v) + w[1] * u + w[2] * v;
    let most = pulls.iter().fold(0.0, |a, (_, w)| max(a, weight_of(w)));
    for (bone, weights) in pulls {
        let weight = weight_of(weights);
        if weight > LEAST_PULL {
            by_bone[*bone].push(Share { corners: part, weight: min(weight, 1.0), most: weight >= most });
        }
    }
}
