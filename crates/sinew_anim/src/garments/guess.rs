//! Guesses garments from joint names.

use super::{Garment, GarmentColumn, is_ring, side_by_side};
use crate::rig::{JointIdx, Rig};
use crate::roles::words;

/// Words for each kind of garment, lower case.
const KINDS: [(&str, &[&str]); 3] = [
    ("cape", &["cape", "cloak", "mantle", "robe", "マント"]),
    ("skirt", &["skirt", "dress", "kilt", "スカート"]),
    ("coat", &["coat", "jacket", "コート"]),
];

/// Returns garments by joint names: capes, skirts and coats with at least two chains side by side. A single chain does
/// not count as cloth; it may swing as a spring ([`guess_springs`](crate::guess_springs)).
pub fn guess_garments(rig: &Rig) -> Vec<Garment> {
    let kind_of: Vec<Option<usize>> = rig.joints.iter().map(|joint| kind(&joint.name)).collect();
    let garment = |(kind, (name, _)): (usize, &(&str, &[&str]))| {
        let of_kind = |joint: JointIdx| kind_of[joint] == Some(kind);
        let columns = tops(rig, of_kind).into_iter().map(|top| GarmentColumn::below(rig, top));
        let columns: Vec<GarmentColumn> = columns.filter(|column| column.joints.len() > 1).collect();
        let columns = side_by_side(rig, &columns);
        let closed = is_ring(rig, &columns);
        Garment { name: (*name).to_owned(), columns, closed, ..Garment::default() }
    };
    KINDS.iter().enumerate().map(garment).filter(|garment| garment.columns.len() > 1).collect()
}

/// Start joints of the chains of a kind: the highest joint of the kind, or its children if there are several.
fn tops(rig: &Rig, of_kind: impl Fn(JointIdx) -> bool) -> Vec<JointIdx> {
    let mut children = vec![0; rig.joints.len()];
    for parent in
        (0..rig.joints.len()).filter(|&joint| of_kind(joint)).filter_map(|joint| rig.joints[joint].parent)
    {
        children[parent] += 1;
    }
    let mut bears = vec![false; rig.joints.len()];
    let mut tops = Vec::new();
    for joint in (0..rig.joints.len()).filter(|&joint| of_kind(joint)) {
        let parent = rig.joints[joint].parent;
        let starts = parent.is_none_or(|parent| !of_kind(parent) || bears[parent]);
        bears[joint] = starts && children[joint] > 1;
        if starts && !bears[joint] {
            tops.push(joint);
        }
    }
    tops
}

/// Index of the kind that a name implies; `None` for other names and for control joints.
fn kind(name: &str) -> Option<usize> {
    let words = words(name);
    if words.iter().any(|word| matches!(word.as_str(), "ik" | "ctrl" | "control" | "target")) {
        return None;
    }
    KINDS.iter().position(|(_, kind)| words.iter().any(|word| kind.contains(&word.as_str())))
}
