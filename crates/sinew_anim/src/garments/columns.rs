//! Columns of garments: chains of joints and their order side by side.

use super::GarmentColumn;
use crate::rig::{JointIdx, Rig};
use crate::tuning::{HEM_SHARE, RING_GAP};
use sinew_math::{Affine, Vec3, max};

impl GarmentColumn {
    /// Returns the column of a joint and its descendants along the longest branch, without joints of
    /// [sheets](Rig::sheets). If the skin of the last joint extends beyond that joint, the hem is at the end of that
    /// skin.
    ///
    /// # Panics
    /// If the joint does not exist.
    pub fn below(rig: &Rig, top: JointIdx) -> Self {
        let is_cloth = rig.is_of_sheet();
        // Joints come before their children.
        let mut longest = vec![(0, None); rig.joints.len()];
        for joint in (0..rig.joints.len()).rev() {
            if let Some(parent) = rig.joints[joint].parent.filter(|_| !is_cloth[joint]) {
                let length = longest[joint].0 + 1;
                if length >= longest[parent].0 {
                    longest[parent] = (length, Some(joint));
                }
            }
        }
        let mut joints = vec![top];
        while let Some(next) = longest[joints[joints.len() - 1]].1 {
            joints.push(next);
        }
        Self { tip: tip(rig, &joints), joints }
    }
}

/// End of the last joint's skin in the joint's own space, in the direction of the bone above; zero if it is close.
fn tip(rig: &Rig, joints: &[JointIdx]) -> Vec3 {
    let [.., above, last] = joints else { return Vec3::ZERO };
    let rest = &rig.joints[*last].rest;
    let length = rest.translation.length();
    if length == 0.0 {
        return Vec3::ZERO;
    }
    let way = rest.to_affine().inverse().vector(rest.translation / length);
    let scale = way.length();
    let reach = skin_of(rig, *last).map(|place| place.dot(way / scale)).fold(0.0, max);
    debug_assert!(
        rig.joints[*last].parent == Some(*above),
        "each joint of a column is the parent of the next"
    );
    if reach > HEM_SHARE * length * scale { way * (reach / scale) } else { Vec3::ZERO }
}

/// Vertices that a joint moves more than all other joints together, in the joint's space.
fn skin_of(rig: &Rig, joint: JointIdx) -> impl Iterator<Item = Vec3> {
    let skinned = rig.meshes.iter().filter_map(|mesh| Some((mesh, &rig.skins[mesh.skin?])));
    skinned.flat_map(move |(mesh, skin)| {
        let slot = skin.joints.iter().position(|&at| at == joint);
        let inverse = slot.map_or(Affine::IDENTITY, |slot| skin.inverse_bind[slot]);
        let primitives = mesh.primitives.iter().filter(move |_| slot.is_some());
        primitives.flat_map(move |primitive| {
            let vertices = primitive.positions.iter().zip(&primitive.joints).zip(&primitive.weights);
            let own = vertices.filter(move |((_, slots), weights)| {
                slots.iter().zip(*weights).any(|(&at, &weight)| Some(at as usize) == slot && weight > 0.5)
            });
            own.map(move |((&position, _), _)| inverse.point(position))
        })
    })
}

/// Mean position of each column's joints in the rest pose, file units.
fn middles(rig: &Rig, columns: &[GarmentColumn]) -> Vec<Vec3> {
    let mut places: Vec<Affine> = Vec::with_capacity(rig.joints.len());
    for joint in &rig.joints {
        let local = joint.rest.to_affine();
        places.push(joint.parent.map_or(local, |parent| places[parent] * local));
    }
    let middle = |column: &GarmentColumn| {
        let sum = column.joints.iter().fold(Vec3::ZERO, |sum, &joint| sum + places[joint].translation);
        sum / max(column.joints.len() as f32, 1.0)
    };
    columns.iter().map(middle).collect()
}

/// Sorts columns side by side: starts with the column farthest from the mean position, then always takes the
/// nearest.
pub fn side_by_side(rig: &Rig, columns: &[GarmentColumn]) -> Vec<GarmentColumn> {
    let places = middles(rig, columns);
    let middle = places.iter().copied().sum::<Vec3>() / max(places.len() as f32, 1.0);
    let mut left: Vec<usize> = (0..columns.len()).collect();
    let mut order: Vec<usize> = Vec::with_capacity(columns.len());
    while !left.is_empty() {
        let cost = |at: usize| match order.last() {
            Some(&last) => (places[at] - places[last]).length(),
            None => -(places[at] - middle).length(),
        };
        let mut best = 0;
        for k in 1..left.len() {
            if cost(left[k]) < cost(left[best]) {
                best = k;
            }
        }
        order.push(left.remove(best));
    }
    order.into_iter().map(|at| columns[at].clone()).collect()
}

/// True if columns form a ring, as in a skirt: the last column is about as near to the first as neighbours are to
/// each other.
pub fn is_ring(rig: &Rig, columns: &[GarmentColumn]) -> bool {
    let places = middles(rig, columns);
    let [first, .., last] = places.as_slice() else { return false };
    let widest = places.windows(2).map(|pair| (pair[1] - pair[0]).length()).fold(0.0, max);
    places.len() >= 4 && (*last - *first).length() <= RING_GAP * widest
}
