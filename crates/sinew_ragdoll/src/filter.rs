//! Which bodies of a ragdoll collide with each other.
//!
//! Bodies that overlap where they start would be blown apart, so such pairs must be shrunk or left out. Shrinking is
//! preferred where the contact is what makes a crumple look real: hand on thigh, thigh on thigh, arm on trunk.

use crate::build::bones::Bones;
use crate::build::part::Part;
use crate::fit::{Fit, stretched};
use sinew_math::{Transform, Vec3, max};
use sinew_physics::Shape;
use sinew_physics::collide::{Manifold, collide};

/// Overlap in the bind pose that is let be, metres: about the solver's slop.
pub const TOLERATED: f32 = 0.005;
/// The most that a shape's cross-section may be shrunk.
const LEAST_SCALE: f32 = 0.86;
/// Shrinking is done in steps of this factor.
const STEP: f32 = 0.975;

/// Two bodies that overlap in the bind pose although no joint connects them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Indices of the bodies, the smaller first.
    pub pair: (usize, usize),
    /// Depth before anything was done, metres.
    pub depth: f32,
    /// What was done.
    pub remedy: Remedy,
}

/// How an overlap was dealt with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remedy {
    /// It is less than the solver notices.
    Tolerated,
    /// Both shapes were made thinner.
    Shrunk,
    /// The pair does not collide.
    Disabled,
}

/// Result of [`filter_pairs`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FilterReport {
    /// Every overlap that was found.
    pub overlaps: Vec<Overlap>,
    /// Pairs that must not collide, the smaller index first, sorted.
    pub disabled: Vec<(usize, usize)>,
    /// Factor on each body's cross-section; 1 for most.
    pub scale: Vec<f32>,
}

/// Finds the overlaps of the bind pose between bodies that no joint connects; shrinks `fits` where that is enough and
/// names the pairs that must not collide.
pub fn filter_pairs(bones: &Bones, fits: &mut [Fit]) -> FilterReport {
    let mut report = FilterReport { scale: vec![1.0; fits.len()], ..FilterReport::default() };
    for a in 0..fits.len() {
        for b in a + 1..fits.len() {
            if bones.list[b].parent == Some(a) {
                continue;
            }
            let depth = depth(&fits[a], &fits[b]);
            if depth <= 0.0 {
                continue;
            }
            let remedy = remedy(bones, fits, &mut report.scale, (a, b), depth);
            report.overlaps.push(Overlap { pair: (a, b), depth, remedy });
            if remedy == Remedy::Disabled {
                report.disabled.push((a, b));
            }
        }
    }
    mirror_remedies(bones, fits, &mut report);
    report
}

/// What was done on one side is done on the other, so that a slight asymmetry of the mesh makes no limping ragdoll.
fn mirror_remedies(bones: &Bones, fits: &mut [Fit], report: &mut FilterReport) {
    for body in 0..fits.len() {
        let Some(twin) = bones.twin(body) else { continue };
        let factor = report.scale[twin] / report.scale[body];
        if factor < 1.0 {
            report.scale[body] = report.scale[twin];
            fits[body].shape = thinner(&fits[body].shape, factor);
        }
    }
    for index in 0..report.disabled.len() {
        let (a, b) = report.disabled[index];
        let (a, b) = (bones.twin(a).unwrap_or(a), bones.twin(b).unwrap_or(b));
        report.disabled.push((core::cmp::min(a, b), core::cmp::max(a, b)));
    }
    report.disabled.sort_unstable();
    report.disabled.dedup();
}

fn remedy(bones: &Bones, fits: &mut [Fit], scale: &mut [f32], (a, b): (usize, usize), depth: f32) -> Remedy {
    let trunk = |bone: usize| bones.list[bone].part.is_trunk() || bones.list[bone].part == Part::Neck;
    // Neighbours but one within the trunk move over each other whatever their sizes.
    if bones.distance(a, b) <= 2 && (trunk(a) && trunk(b) || meets_at_pivot(bones, fits, a, b)) {
        return Remedy::Disabled;
    }
    if depth <= TOLERATED {
        return Remedy::Tolerated;
    }
    if is_worth_shrinking(bones, a, b) && shrink_apart(bones, fits, scale, (a, b)) {
        return Remedy::Shrunk;
    }
    Remedy::Disabled
}

/// Whether two bodies with one between them touch around the very joint that hangs the later one (an upper arm and the
/// chest beside the shoulder): whatever the pose, they then overlap there.
fn meets_at_pivot(bones: &Bones, fits: &[Fit], a: usize, b: usize) -> bool {
    let pivot = bones.list[b].head;
    let (distance, _) = fits[a].shape.signed_distance(&fits[a].character_from_body, pivot);
    distance < 0.5 * fits[b].shape.inner_radius()
}

fn is_worth_shrinking(bones: &Bones, a: usize, b: usize) -> bool {
    let (a, b) = (bones.list[a].part, bones.list[b].part);
    let limb = |part: Part| part.is_limb();
    limb(a) && (limb(b) || b.is_trunk()) || limb(b) && a.is_trunk()
}

/// Makes both shapes thinner until they no longer overlap by more than is tolerated; leaves them as they are and says
/// so if the most that is allowed does not do it. A trunk is not made thinner: its neighbours need its size.
fn shrink_apart(bones: &Bones, fits: &mut [Fit], scale: &mut [f32], (a, b): (usize, usize)) -> bool {
    let before = (fits[a].clone(), fits[b].clone(), scale[a], scale[b]);
    loop {
        let mut any = false;
        for body in [a, b] {
            if !bones.list[body].part.is_trunk() && scale[body] * STEP >= LEAST_SCALE {
                scale[body] *= STEP;
                fits[body].shape = thinner(&fits[body].shape, STEP);
                any = true;
            }
        }
        if depth(&fits[a], &fits[b]) <= TOLERATED {
            return true;
        }
        if !any {
            (fits[a], fits[b], scale[a], scale[b]) = before;
            return false;
        }
    }
}

/// The shape with its cross-section scaled; its length along y stays.
fn thinner(shape: &Shape, factor: f32) -> Shape {
    match shape {
        Shape::Box { half_extents: h } => {
            Shape::Box { half_extents: Vec3::new(h.x * factor, h.y, h.z * factor) }
        }
        Shape::Capsule { half_height, radius } => {
            let thin = radius * factor;
            Shape::Capsule { half_height: half_height + (radius - thin), radius: thin }
        }
        Shape::Sphere { radius } => Shape::Sphere { radius: radius * factor },
        Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
            let [low, high] = [radius_bottom * factor, radius_top * factor];
            // Both ends stay where they are.
            let half_height = half_height + 0.5 * (radius_bottom - low + radius_top - high);
            Shape::TaperedCapsule { half_height, radius_bottom: low, radius_top: high }
        }
        Shape::Cylinder { half_height, radius } => {
            Shape::Cylinder { half_height: *half_height, radius: radius * factor }
        }
        Shape::Cone { half_height, radius } => {
            Shape::Cone { half_height: *half_height, radius: radius * factor }
        }
        Shape::Hull(hull) => stretched(hull, Vec3::new(factor, 1.0, factor)).unwrap_or_else(|| shape.clone()),
        // A fit is none of these.
        Shape::HalfSpace | Shape::Mesh(_) | Shape::HeightField(_) => shape.clone(),
    }
}

/// How deep two fitted shapes overlap, metres; 0 if they do not.
pub fn depth(a: &Fit, b: &Fit) -> f32 {
    depth_of((&a.shape, &a.character_from_body), (&b.shape, &b.character_from_body))
}

/// How deep two placed shapes overlap, metres; 0 if they do not.
pub(crate) fn depth_of((a, at): (&Shape, &Transform), (b, there): (&Shape, &Transform)) -> f32 {
    let mut manifold = Manifold::default();
    collide(a, at, b, there, 0.0, &mut manifold);
    manifold.points().iter().fold(0.0, |deepest, point| max(deepest, -point.separation))
}
