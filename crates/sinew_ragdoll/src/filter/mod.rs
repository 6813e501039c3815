//! Collision filter for pairs of bodies within a ragdoll.
//!
//! Bodies that overlap at the start would be pushed apart violently, and bodies that overlap in every joint pose would
//! push forever. Such pairs are shrunk or excluded from collision. Shrinking is preferred where a contact makes a
//! fallen pose look real: hand on thigh, thigh on thigh, arm on trunk.
//!
//! A pair is tested in the bind pose, in poses within the limits, and in poses of the character's clips. An overlap in
//! a few poses is not a fault of the shapes: limbs do touch. A ragdoll that starts in such a pose excludes the pair
//! itself (`Ragdoll::spawn`).
//!
//! ```
//! # let rig = sinew::mannequin::mannequin().rig;
//! # let analysis = sinew_anim::analyze(&rig)?;
//! use sinew_ragdoll::filter::{Remedy, TOLERATED};
//!
//! let (def, report) = sinew_ragdoll::build(&rig, &analysis, &sinew_ragdoll::BuildOptions::default())?;
//! for overlap in &report.overlaps {
//!     let named = |body: usize| &def.bodies[body].role;
//!     println!("{} and {}: {:?}", named(overlap.pair.0), named(overlap.pair.1), overlap.remedy);
//!     assert_eq!(overlap.remedy == Remedy::Disabled, def.disabled_pairs.contains(&overlap.pair));
//! }
//! assert_eq!(TOLERATED, 0.005); // metres
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod poses;
mod thin;

use crate::build::bones::Bones;
use crate::build::part::Part;
use crate::fit::Fit;
pub use crate::tuning::TOLERATED;
use crate::tuning::{A_FEW, ALWAYS, LEAST_SCALE, MOSTLY, SCALE_STEP, SELDOM};
use poses::Poses;
use sinew_math::{Transform, max};
use sinew_physics::Shape;
use sinew_physics::collide::{Manifold, collide};

/// Two bodies that overlap although no joint connects them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Indices of the bodies, the smaller first.
    pub pair: (usize, usize),
    /// Poses in which they overlap before any remedy.
    pub seen: Seen,
    /// Remedy that was applied.
    pub remedy: Remedy,
}

/// Poses in which two bodies overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// Depth in the bind pose, metres; 0 if they do not overlap there.
    pub bind: f32,
    /// Share of the poses within the limits in which they overlap by more than [`TOLERATED`].
    pub limits: f32,
    /// Share of the clip poses in which they overlap by more than [`TOLERATED`]; `None` without clips.
    pub clips: Option<f32>,
}

/// Remedy for an overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remedy {
    /// The overlap is below the solver's tolerance, or occurs in only a few poses, so it needs no remedy.
    Tolerated,
    /// The bodies overlap in the bind pose and in hardly any other: they collide, except in a ragdoll that starts in
    /// the bind pose.
    OnlyBound,
    /// Both shapes were thinned.
    Shrunk,
    /// The pair does not collide.
    Disabled,
}

/// Result of [`filter_pairs`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FilterReport {
    /// All overlaps found.
    pub overlaps: Vec<Overlap>,
    /// Pairs that must not collide, the smaller index first, sorted.
    pub disabled: Vec<(usize, usize)>,
    /// Factor on each body's cross-section; 1 for most bodies.
    pub scale: Vec<f32>,
}

/// Finds the overlaps between bodies that no joint connects, in the bind pose and in `poses`. Shrinks `fits` where that
/// suffices and lists the pairs that must not collide.
pub fn filter_pairs(bones: &Bones, fits: &mut [Fit], poses: &Poses) -> FilterReport {
    let mut report = FilterReport { scale: vec![1.0; fits.len()], ..FilterReport::default() };
    for a in 0..fits.len() {
        for b in a + 1..fits.len() {
            if bones.list[b].parent == Some(a) {
                continue;
            }
            if !may_need_room(fits, poses, (a, b)) {
                continue;
            }
            let seen = look(fits, poses, (a, b));
            if seen.bind <= 0.0 && !needs_more_room(bones, &seen, (a, b)) {
                continue;
            }
            let remedy = remedy(bones, fits, &mut report.scale, (a, b), (seen, poses));
            report.overlaps.push(Overlap { pair: (a, b), seen, remedy });
            if remedy == Remedy::Disabled {
                report.disabled.push((a, b));
            }
        }
    }
    mirror_remedies(bones, fits, poses, &mut report);
    report
}

/// Returns true if a pair must be tested in every pose. Most pairs are separate in the first few poses within the
/// limits and in all clips.
fn may_need_room(fits: &[Fit], poses: &Poses, (a, b): (usize, usize)) -> bool {
    let meeting = Meeting::of(fits, (a, b));
    let apart = |pose: &&Vec<Transform>| !meeting.is_in(pose);
    // One more separate pose proves that the bodies do not always overlap.
    let within = &poses.within_limits;
    let enough = ((1.0 - ALWAYS) * within.len() as f32) as usize + 1;
    depth(&fits[a], &fits[b]) > 0.0
        || within.iter().filter(apart).take(enough).count() < enough && !within.is_empty()
        || poses.of_clips.iter().any(|pose| meeting.is_in(pose))
}

/// Two shapes that may overlap.
struct Meeting<'a> {
    pair: (usize, usize),
    shapes: [&'a Shape; 2],
    /// Distance above which bodies cannot overlap, metres.
    reach: f32,
}

impl<'a> Meeting<'a> {
    fn of(fits: &'a [Fit], pair: (usize, usize)) -> Self {
        let [a, b] = [&fits[pair.0], &fits[pair.1]];
        Self { pair, shapes: [&a.shape, &b.shape], reach: reach(a) + reach(b) }
    }

    /// Returns true if the shapes overlap by more than the tolerance.
    fn is_in(&self, pose: &[Transform]) -> bool {
        let (at, there) = (&pose[self.pair.0], &pose[self.pair.1]);
        let apart = (at.translation - there.translation).length_squared() > self.reach * self.reach;
        !apart && depth_of((self.shapes[0], at), (self.shapes[1], there)) > TOLERATED
    }
}

/// Finds the overlaps of a pair in all poses.
fn look(fits: &[Fit], poses: &Poses, (a, b): (usize, usize)) -> Seen {
    let meeting = Meeting::of(fits, (a, b));
    let share = |poses: &[Vec<Transform>]| {
        let count = poses.iter().filter(|pose| meeting.is_in(pose)).count();
        (!poses.is_empty()).then(|| count as f32 / poses.len() as f32)
    };
    Seen {
        bind: depth(&fits[a], &fits[b]),
        limits: share(&poses.within_limits).unwrap_or(0.0),
        clips: share(&poses.of_clips),
    }
}

/// Returns the radius of a ball about the body's origin that contains its shape.
fn reach(fit: &Fit) -> f32 {
    let bounds = fit.shape.aabb(&Transform::IDENTITY);
    max(bounds.min.length(), bounds.max.length())
}

/// Returns true if a pair overlaps in poses in which the bodies should be separate.
fn needs_more_room(bones: &Bones, seen: &Seen, (a, b): (usize, usize)) -> bool {
    seen.bind > TOLERATED || seen.clips.unwrap_or(0.0) > A_FEW || is_never_apart(bones, seen, (a, b))
}

/// Returns true if a pair overlaps in so many poses that it cannot collide.
fn is_never_apart(bones: &Bones, seen: &Seen, (a, b): (usize, usize)) -> bool {
    let limb = |bone: usize| bones.list[bone].part.is_limb();
    let most = if limb(a) || limb(b) { MOSTLY } else { A_FEW };
    seen.limits >= ALWAYS || seen.clips.unwrap_or(0.0) > most
}

/// Applies the remedies of one side of the body to the other, so that a slight asymmetry of the mesh does not make the
/// ragdoll asymmetric.
fn mirror_remedies(bones: &Bones, fits: &mut [Fit], poses: &Poses, report: &mut FilterReport) {
    for body in 0..fits.len() {
        let Some(twin) = bones.twin(body) else { continue };
        let factor = report.scale[twin] / report.scale[body];
        if factor < 1.0 {
            report.scale[body] = report.scale[twin];
            fits[body].shape = thin::thinner(&fits[body].shape, factor);
        }
    }
    for index in 0..report.disabled.len() {
        let (a, b) = report.disabled[index];
        let (a, b) = (bones.twin(a).unwrap_or(a), bones.twin(b).unwrap_or(b));
        let pair = (usize::min(a, b), usize::max(a, b));
        // A joint may connect the pair on this side, if the rig is not symmetric.
        if report.disabled.contains(&pair) || bones.list[pair.1].parent == Some(pair.0) {
            continue;
        }
        report.disabled.push(pair);
        match report.overlaps.iter_mut().find(|overlap| overlap.pair == pair) {
            Some(overlap) => overlap.remedy = Remedy::Disabled,
            None => {
                let seen = look(fits, poses, pair);
                report.overlaps.push(Overlap { pair, seen, remedy: Remedy::Disabled });
            }
        }
    }
    report.overlaps.sort_unstable_by_key(|overlap| overlap.pair);
    report.disabled.sort_unstable();
    report.disabled.dedup();
}

fn remedy(
    bones: &Bones,
    fits: &mut [Fit],
    scale: &mut [f32],
    (a, b): (usize, usize),
    (seen, poses): (Seen, &Poses),
) -> Remedy {
    let trunk = |bone: usize| bones.list[bone].part.is_trunk() || bones.list[bone].part == Part::Neck;
    // Bodies of the trunk with one body between them overlap when the trunk bends, whatever their sizes.
    if bones.distance(a, b) <= 2
        && seen.bind > 0.0
        && (trunk(a) && trunk(b) || meets_at_pivot(bones, fits, a, b))
    {
        return Remedy::Disabled;
    }
    if !needs_more_room(bones, &seen, (a, b)) {
        return Remedy::Tolerated;
    }
    if is_worth_shrinking(bones, a, b) && shrink_apart(bones, fits, scale, (a, b), poses) {
        return Remedy::Shrunk;
    }
    if is_never_apart(bones, &seen, (a, b)) {
        return Remedy::Disabled;
    }
    if seen.bind <= TOLERATED {
        return Remedy::Tolerated;
    }
    if seen.limits < SELDOM { Remedy::OnlyBound } else { Remedy::Disabled }
}

/// Returns true if two bodies with one body between them touch around the joint of the later one (an upper arm and the
/// chest at the shoulder). Such bodies overlap there in every pose.
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

/// Thins both shapes until they overlap only in allowed poses. If the allowed thinning does not suffice, the shapes
/// stay unchanged and this returns false. A trunk is not thinned: its neighbours need its size.
fn shrink_apart(
    bones: &Bones,
    fits: &mut [Fit],
    scale: &mut [f32],
    (a, b): (usize, usize),
    poses: &Poses,
) -> bool {
    let before = (fits[a].clone(), fits[b].clone(), scale[a], scale[b]);
    loop {
        let mut any = false;
        for body in [a, b] {
            if !bones.list[body].part.is_trunk() && scale[body] * SCALE_STEP >= LEAST_SCALE {
                scale[body] *= SCALE_STEP;
                fits[body].shape = thin::thinner(&fits[body].shape, SCALE_STEP);
                any = true;
            }
        }
        if depth(&fits[a], &fits[b]) <= TOLERATED
            && !needs_more_room(bones, &look(fits, poses, (a, b)), (a, b))
        {
            return true;
        }
        if !any {
            (fits[a], fits[b], scale[a], scale[b]) = before;
            return false;
        }
    }
}

/// Returns the depth by which two fitted shapes overlap, metres; 0 if they do not.
pub fn depth(a: &Fit, b: &Fit) -> f32 {
    depth_of((&a.shape, &a.character_from_body), (&b.shape, &b.character_from_body))
}

/// Returns the depth by which two placed shapes overlap, metres; 0 if they do not.
pub(crate) fn depth_of((a, at): (&Shape, &Transform), (b, there): (&Shape, &Transform)) -> f32 {
    let mut manifold = Manifold::default();
    collide(a, at, b, there, 0.0, &mut manifold);
    manifold.points().iter().fold(0.0, |deepest, point| max(deepest, -point.separation))
}
