//! A rest pose before the motion.

use super::hierarchy::Hierarchy;
use super::motion::Motion;

/// Handling of a rest pose in the first frame. The BVH files of the CMU library have one (arms out, legs straight),
/// which shows programs the body at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RestFrame {
    /// The rest pose is not part of the clip; [`rest_pose`](super::BvhDocument::rest_pose) holds it.
    #[default]
    Skip,
    /// The rest pose is the first frame of the clip, as in the file.
    Keep,
}

/// True if the first frame is a rest pose: authored in whole degrees, followed by measured motion.
pub(super) fn find(
    hierarchy: &Hierarchy,
    motion: &Motion,
    wanted: RestFrame,
    notes: &mut Vec<String>,
) -> bool {
    let mut rows = motion.rows.chunks_exact(hierarchy.width);
    let (Some(first), Some(second), Some(_)) = (rows.next(), rows.next(), rows.next()) else { return false };
    let columns: Vec<usize> = hierarchy
        .joints
        .iter()
        .flat_map(|joint| joint.channels.iter().zip(joint.column..))
        .filter(|(channel, _)| channel.is_rotation())
        .map(|(_, column)| column)
        .collect();
    let whole = |row: &[f32]| columns.iter().filter(|&&column| row[column].fract() == 0.0).count();
    let step =
        columns.iter().map(|&column| (second[column] - first[column]).abs()).fold(0.0, sinew_math::max);
    let found =
        columns.len() >= 6 && whole(first) * 10 >= columns.len() * 9 && whole(second) * 2 < columns.len();
    if found && step > 5.0 {
        let fate = if wanted == RestFrame::Skip { "left out of the clip" } else { "kept" };
        notes.push(format!(
            "frame 0 is a rest pose: {} of {} angles are whole degrees, and the motion starts {step:.0}° away; {fate}",
            whole(first),
            columns.len()
        ));
        return true;
    }
    false
}
