//! Fits one shape per bone to the skin, along the flesh instead of the bone's own axes, and picks the candidate kind
//! nearest to the skin.
//!
//! Bone-aligned boxes are 3 to 4 times too large (measured on CesiumMan's arms). The axes of the area-weighted
//! covariance come from the surface itself.
//!
//! ```
//! # let rig = sinew::mannequin::mannequin().rig;
//! # let analysis = sinew_anim::analyze(&rig)?;
//! use sinew_physics::Shape;
//! use sinew_ragdoll::{BuildOptions, ShapeChoice, build};
//!
//! let options = BuildOptions { shapes: ShapeChoice::Capsule, ..BuildOptions::default() };
//! let (def, _) = build(&rig, &analysis, &options)?;
//! assert!(def.bodies.iter().all(|body| matches!(body.shape, Shape::Capsule { .. })));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod frame;
pub mod patch;
pub mod rectangle;
mod round;
mod solid;
pub mod surface;

use crate::build::bones::{Anatomy, Bone, Bones};
use crate::build::part::Part;
use crate::tuning::{
    BURDENED, HOLLOW, INTRICATE, LEAST_HALF, PAST_JOINT, PROTRUDING, SHRINK, SPIKED, TAPERED, UNLIKE, UNUSUAL,
};
use core::mem::discriminant;
use patch::{Patch, Selection, Symmetry};
use sinew_math::{Mat3, Rotation, Transform, Vec3, clamp, max, min};
use sinew_physics::{Hull, Shape};
use std::sync::Arc;
use surface::Share;

/// Kinds of shapes that a build uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShapeChoice {
    /// Boxes for all bodies.
    Box,
    /// Capsules for all bodies.
    Capsule,
    /// Boxes for trunk, hands, feet and carried objects; capsules for limbs, neck and head, unless the other kind is
    /// clearly closer to the skin.
    #[default]
    Auto,
}

/// A fitted shape and its error.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Geometry, metres.
    pub shape: Shape,
    /// Body frame in character space: origin at the shape's centre, y along the bone.
    pub character_from_body: Transform,
    /// Area-weighted mean distance between the bone's skin and the shape's surface, metres; 0 without skin.
    pub error: f32,
    /// Area of the bone's skin, m².
    pub area: f32,
    /// Selection of the skin to which the shape was fitted.
    pub selection: Selection,
}

/// Fits one shape per bone. `surface` is a result of [`surface::share_surface`].
pub fn fit_shapes(bones: &Bones, surface: &[Vec<Share>], choice: ShapeChoice) -> Vec<Fit> {
    let fits: Vec<_> =
        (0..bones.list.len()).map(|bone| fit_bone(bones, bone, &surface[bone], choice)).collect();
    let shape = |bone: usize| {
        let fit = reconciled(bones, &fits, bone);
        if choice != ShapeChoice::Auto {
            return fit;
        }
        protruding_end(bones, bone, &surface[bone], &fit).unwrap_or(fit)
    };
    (0..fits.len()).map(shape).collect()
}

/// Returns the hull of the end of a limb if some of its skin protrudes far from its shape (a sword in a hand, a gun on
/// a forearm, a big shoe); this skin would otherwise sink into the floor. `None` if nothing protrudes, for other bones
/// and for props.
fn protruding_end(bones: &Bones, bone: usize, shares: &[Share], fit: &Fit) -> Option<Fit> {
    let Bone { part, is_prop, .. } = bones.list[bone];
    let is_limb = !is_trunk(part) && !matches!(part, Part::Head | Part::Neck | Part::Tail);
    if is_prop || !is_limb || !bones.children[bone].is_empty() {
        return None;
    }
    let patch = Patch::select(shares, Symmetry::AsIs)?;
    let out = |sample: &patch::Sample| fit.shape.signed_distance(&fit.character_from_body, sample.point).0;
    let farthest = patch.samples.iter().map(out).fold(0.0, max);
    if farthest <= PROTRUDING * bones.size() {
        return None;
    }
    solid::fit_whole_hull(&solid::fit_box(bones, bone, &patch), &patch, |point| point)
}

/// Returns the shape of a bone, or the mirror image of its counterpart's shape if that fits better: a pad skinned to a
/// shoulder is not part of the shoulder, and a coarse mesh may give the two sides different shapes.
fn reconciled(bones: &Bones, fits: &[Fit], bone: usize) -> Fit {
    let own = fits[bone].clone();
    let Some(twin) = bones.twin(bone) else { return own };
    let other = fits[twin].clone();
    let plane = bones.plane_of_symmetry();
    let image = |p: Vec3| Vec3::new(2.0 * plane - p.x, p.y, p.z);
    let mirrored_pivots = (image(bones.list[twin].head) - bones.list[bone].head).length();
    if other.selection == Selection::Nothing || mirrored_pivots > 0.05 * bones.size() {
        return own;
    }
    let burdened = own.shape.bounding_radius() > BURDENED * other.shape.bounding_radius();
    let burdens = BURDENED * own.shape.bounding_radius() < other.shape.bounding_radius();
    let (v, w) = (own.shape.volume(), other.shape.volume());
    let alike = discriminant(&own.shape) == discriminant(&other.shape) && max(v, w) < UNLIKE * min(v, w);
    if !burdened && (burdens || alike || own.error <= other.error) {
        return own;
    }
    let frame = other.character_from_body;
    let axes = frame.rotation.to_mat3();
    let turned = |v: Vec3| Vec3::new(-v.x, v.y, v.z);
    // The mirror image of three axes is left-handed, so negate x. All shapes except hulls are symmetric in x, so this
    // does not change them.
    let axes = Mat3::from_cols(-turned(axes.x_axis), turned(axes.y_axis), turned(axes.z_axis));
    let character_from_body = Transform::new(image(frame.translation), Rotation::from_mat3(&axes));
    let Some(shape) = with_x_turned(&other.shape) else { return own };
    Fit { shape, character_from_body, selection: Selection::Twin, ..other }
}

/// Returns the mirror image of a shape in the plane x = 0 of its own axes.
fn with_x_turned(shape: &Shape) -> Option<Shape> {
    match shape {
        Shape::Hull(hull) => stretched(hull, Vec3::new(-1.0, 1.0, 1.0)),
        even => Some(even.clone()),
    }
}

/// Returns a hull scaled by one factor per axis; `None` if rounding makes the scaled corners degenerate.
pub(crate) fn stretched(hull: &Hull, factors: Vec3) -> Option<Shape> {
    let corners: Vec<Vec3> = hull.vertices().iter().map(|&corner| corner * factors).collect();
    Hull::new(&corners).ok().map(|hull| Shape::Hull(Arc::new(hull)))
}

fn fit_bone(bones: &Bones, bone: usize, shares: &[Share], choice: ShapeChoice) -> Fit {
    let symmetry =
        if bones.is_central(bone) { Symmetry::Mirrored(bones.plane_of_symmetry()) } else { Symmetry::AsIs };
    let Some(patch) = Patch::select(shares, symmetry) else { return stand_in(bones, bone) };
    match choice {
        ShapeChoice::Box => solid::fit_box(bones, bone, &patch),
        ShapeChoice::Capsule => round::fit_capsule(bones, bone, &patch),
        ShapeChoice::Auto => {
            let fit = nearest(bones, bone, &patch);
            let hull = protruding(bones, bone, &patch, &fit).or_else(|| hollow(bones, bone, &patch, &fit));
            hull.unwrap_or(fit)
        }
    }
}

/// Returns the hull of a part if some of its skin protrudes far from the nearest shape (a hat, a crest, spikes, a
/// pack); this skin would otherwise sink into the floor. `None` if nothing protrudes, and for limbs.
fn protruding(bones: &Bones, bone: usize, patch: &Patch, nearest: &Fit) -> Option<Fit> {
    let part = bones.list[bone].part;
    let is_end = bones.children[bone].is_empty();
    let is_central = part == Part::Head || is_trunk(part) && (is_end || bones.anatomy == Anatomy::Human);
    if part != Part::Tail && !is_central {
        return None;
    }
    let far = if part == Part::Tail { SPIKED } else { PROTRUDING } * bones.size();
    let frame = solid::fit_box(bones, bone, patch);
    let within = solid::within_joints(bones, bone, patch, &frame);
    // The spikes of a tail may continue its direction.
    let within = |point: Vec3| if part == Part::Tail { point } else { within(point) };
    let out = |sample: &patch::Sample| {
        nearest.shape.signed_distance(&nearest.character_from_body, within(sample.point)).0
    };
    let farthest = patch.samples.iter().map(out).fold(0.0, max);
    if farthest <= far {
        return None;
    }
    solid::fit_whole_hull(&frame, patch, within)
}

/// Returns the hull of a part of the trunk if a corner of its box is far from all skin (as for a trunk with its arms);
/// the character would float on that corner. `None` for other shapes.
fn hollow(bones: &Bones, bone: usize, patch: &Patch, nearest: &Fit) -> Option<Fit> {
    let Shape::Box { half_extents: half } = nearest.shape else { return None };
    let far = HOLLOW * bones.size();
    let is_bare = |corner: u32| {
        let sign = |bit: u32| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let at = nearest.character_from_body.point(half * Vec3::new(sign(0), sign(1), sign(2)));
        patch.samples.iter().all(|sample| (sample.point - at).length_squared() > far * far)
    };
    let is_hollow = is_trunk(bones.list[bone].part) && (0..8).any(is_bare);
    is_hollow.then(|| solid::fit_hull(nearest, patch))?
}

fn is_trunk(part: Part) -> bool {
    matches!(part, Part::Pelvis | Part::Spine)
}

/// Returns the shape with the least error among all kinds; a factor on the error favours kinds that suit the part.
fn nearest(bones: &Bones, bone: usize, patch: &Patch) -> Fit {
    let is_square = prefers_box(bones.list[bone].part) || bones.list[bone].is_prop;
    let [flat, round] = if is_square { [1.0, UNUSUAL] } else { [UNUSUAL, 1.0] };
    let capsule = round::fit_capsule(bones, bone, patch);
    let tapered = round::taper(&capsule, patch).map(|fit| (fit, round * TAPERED));
    let cuboid = solid::fit_box(bones, bone, patch);
    let hull = solid::fit_hull(&cuboid, patch).map(|fit| (fit, INTRICATE));
    let first = (round::rounded(capsule), round);
    let least = [Some((cuboid, flat)), tapered, hull].into_iter().flatten().fold(first, |best, other| {
        if other.0.error * other.1 < best.0.error * best.1 { other } else { best }
    });
    least.0
}

fn prefers_box(part: Part) -> bool {
    matches!(part, Part::Pelvis | Part::Spine | Part::Hand | Part::Foot | Part::Toes)
}

/// Returns a thin capsule along a bone that moves no skin.
fn stand_in(bones: &Bones, bone: usize) -> Fit {
    let direction = bones.direction(bone, None);
    let parent_length = bones.list[bone].parent.and_then(|parent| bones.length(parent));
    let length = bones.length(bone).or(parent_length.map(|l| 0.5 * l)).unwrap_or(0.1 * bones.size());
    let radius = max(clamp(0.2 * length, 0.01 * bones.size(), 0.05 * bones.size()), LEAST_HALF);
    let half_height = max(0.5 * length - radius, 0.0);
    let middle = bones.list[bone].head + direction * (0.5 * length);
    Fit {
        shape: Shape::Capsule { half_height, radius },
        character_from_body: Transform::new(middle, Rotation::from_arc(Vec3::Y, direction)),
        error: 0.0,
        area: 0.0,
        selection: Selection::Nothing,
    }
}

/// Returns the extent `lo..hi` of a shape along `axis` from `origin`. The extent is cut at [`PAST_JOINT`] of the bone's
/// length beyond the bone's own joint and that of its continuation; for the trunk it is extended to reach these joints.
/// Shapes across the bone (feet) and held objects are not changed.
fn clip_at_joints(bones: &Bones, bone: usize, origin: Vec3, axis: Vec3, lo: f32, hi: f32) -> (f32, f32) {
    let direction = bones.direction(bone, Some(origin));
    let Bone { part, is_prop, .. } = bones.list[bone];
    if axis.dot(direction) < 0.7 || part == Part::Foot || is_prop {
        return (lo, hi);
    }
    let own = bones.list[bone].parent.map(|_| (bones.list[bone].head - origin).dot(axis));
    let next = bones.continuation(bone).map(|next| (bones.list[next].head - origin).dot(axis));
    let past = PAST_JOINT * bones.length(bone).unwrap_or(hi - lo);
    let (mut new_lo, mut new_hi) =
        (own.map_or(lo, |own| max(lo, own - past)), next.map_or(hi, |next| min(hi, next + past)));
    if bones.is_central(bone) && bones.list[bone].part.is_trunk() {
        // Where weights fade from one bone to the next, neither bone owns the skin, so extend the shape to the joint.
        new_lo = own.map_or(new_lo, |own| min(new_lo, own));
        new_hi = next.map_or(new_hi, |next| max(new_hi, next));
    }
    // If the rig's pivots are outside its skin, nothing remains of the extent. Then use the extent of the skin.
    if new_hi - new_lo > 0.2 * (hi - lo) { (new_lo, new_hi) } else { (lo, hi) }
}

fn measured(shape: Shape, character_from_body: Transform, patch: &Patch) -> Fit {
    let sum: f32 = patch
        .samples
        .iter()
        .map(|s| shape.signed_distance(&character_from_body, s.point).0.abs() * s.area)
        .sum();
    let area: f32 = patch.samples.iter().map(|s| s.area).sum();
    Fit { shape, character_from_body, error: sum / area, area: patch.area, selection: patch.selection }
}
