//! Infers the length unit of a file from the size of the body, because the format does not state the unit.

use super::hierarchy::Hierarchy;
use sinew_math::max;

/// Length of the unit of a BVH file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum BvhUnit {
    /// The unit that gives the skeleton the size of a human; centimetres if none does.
    #[default]
    Infer,
    /// This number of metres, above 0.
    ///
    /// [`read_bvh`](super::read_bvh) replaces a value that is not finite and above 0 by 1.
    Metres(f32),
}

/// Distance from toe to fingertip along the bones of an adult, metres: 1.4 times the height, in any pose.
const SPAN: f32 = 2.4;
/// Largest factor by which a body's distance may differ from [`SPAN`].
const SLACK: f32 = 1.5;
/// Number of joints below which the body may be of any kind.
const LEAST_JOINTS: usize = 12;

/// Units in use. The unit of the motion capture lab of Carnegie Mellon University is an inch over 0.45.
const UNITS: [(f32, &str); 5] = [
    (1.0, "metres"),
    (0.01, "centimetres"),
    (0.0254, "inches"),
    (0.0254 / 0.45, "units of the CMU library (inches / 0.45)"),
    (0.001, "millimetres"),
];

impl BvhUnit {
    /// Returns the metres per unit, and adds the reason to the notes.
    pub(super) fn resolve(self, hierarchy: &Hierarchy, notes: &mut Vec<String>) -> f32 {
        match self {
            Self::Metres(metres) if metres > 0.0 && metres.is_finite() => metres,
            Self::Metres(_) => 1.0,
            Self::Infer => infer(hierarchy, notes),
        }
    }
}

fn infer(hierarchy: &Hierarchy, notes: &mut Vec<String>) -> f32 {
    let span = longest_way(hierarchy);
    let named = hierarchy.joints.iter().filter(|joint| !joint.name.is_empty()).count();
    let misfit = |metres: f32| max(span * metres / SPAN, SPAN / (span * metres));
    let best = UNITS.into_iter().reduce(|a, b| if misfit(b.0) < misfit(a.0) { b } else { a });
    if let Some((metres, name)) = best
        && named >= LEAST_JOINTS
        && misfit(metres) < SLACK
    {
        let long = span * metres;
        notes.push(format!(
            "the longest way along the bones is {span:.1} units: taken as {name}, which makes it {long:.2} m"
        ));
        return metres;
    }
    notes.push(format!(
        "the skeleton, {span:.1} units along the bones, does not fit a human: units taken as centimetres"
    ));
    0.01
}

/// Longest path between two joints along the bones, file units; independent of the pose.
fn longest_way(hierarchy: &Hierarchy) -> f32 {
    let joints = &hierarchy.joints;
    // Children follow their parents, so in reverse order every joint's reach is known before its parent's.
    let mut reach = vec![0.0_f32; joints.len()];
    let mut longest = 0.0;
    for (i, joint) in joints.iter().enumerate().rev() {
        let Some(parent) = joint.parent else { continue };
        let way = reach[i] + joint.offset.length();
        longest = max(longest, reach[parent] + way);
        reach[parent] = max(reach[parent], way);
    }
    longest
}
