//! Capsules, tapered capsules and balls around skin.

use super::patch::{Patch, quantiles_of};
use super::{Fit, LEAST_HALF, SHRINK, clip_at_joints, measured};
use crate::build::bones::Bones;
use crate::build::part::Part;
use crate::fit::frame::long_axis;
use crate::tuning::{BALL, STEEPEST};
use sinew_math::{Rotation, Transform, Vec3, clamp, max, min};
use sinew_physics::Shape;

/// Range of distances from a limb's end, as shares of its length, in which the radius of this end is measured.
const NEAR_END: [f32; 2] = [0.1, 0.4];

/// Returns the capsule that is nearest to the skin, of those along all candidate axes.
pub(super) fn fit_capsule(bones: &Bones, bone: usize, patch: &Patch) -> Fit {
    let axis = long_axis(bones, bone, patch);
    let along = capsule_along(bones, bone, patch, axis);
    if bones.list[bone].part != Part::Head {
        return along;
    }
    // A head may be longest from chin to crown or from nose to nape, and its bone may point along neither.
    [Vec3::Y, Vec3::Z].into_iter().map(|axis| capsule_along(bones, bone, patch, axis)).fold(along, nearer)
}

fn nearer(a: Fit, b: Fit) -> Fit {
    if b.error < a.error { b } else { a }
}

fn capsule_along(bones: &Bones, bone: usize, patch: &Patch, axis: Vec3) -> Fit {
    let height_of = |p: Vec3| (p - patch.center).dot(axis);
    let [lo, hi] = patch.quantiles([0.01, 0.99], height_of);
    let (lo, hi) = clip_at_joints(bones, bone, patch.center, axis, lo, hi);
    let middle = patch.center + axis * (0.5 * (lo + hi));
    let half = 0.5 * (hi - lo);
    // The ends are excluded: the surface there reaches around joints and is wider than the limb.
    let mut radial: Vec<_> = patch
        .samples
        .iter()
        .filter(|s| (s.point - middle).dot(axis).abs() < 0.8 * half)
        .map(|s| (((s.point - middle) - axis * (s.point - middle).dot(axis)).length(), s.area))
        .collect();
    if radial.is_empty() {
        radial.push((half, 1.0));
    }
    let frame = Transform::new(middle, Rotation::from_arc(Vec3::Y, axis));
    // The 80 % quantile of the radial distance suits a cylinder. On a tapered limb it is too large, and a lower
    // quantile is nearer.
    let [thick, thin] = quantiles_of(&mut radial, [0.8, 0.65]).map(|radius| {
        let radius = max(min(radius * SHRINK, half), LEAST_HALF);
        measured(Shape::Capsule { half_height: max(half - radius, 0.0), radius }, frame, patch)
    });
    if thin.error < 0.95 * thick.error { thin } else { thick }
}

/// Returns the capsule, or a ball if the capsule is nearly a ball.
pub(super) fn rounded(fit: Fit) -> Fit {
    match fit.shape {
        Shape::Capsule { half_height, radius } if half_height < BALL * radius => {
            Fit { shape: Shape::Sphere { radius: radius + 0.5 * half_height }, ..fit }
        }
        _ => fit,
    }
}

/// Returns a tapered capsule, with a radius of its own at each end; `None` for a ball, or if there is no skin near an
/// end.
pub(super) fn taper(capsule: &Fit, patch: &Patch) -> Option<Fit> {
    let Shape::Capsule { half_height, radius } = capsule.shape else { return None };
    if half_height < BALL * radius {
        return None;
    }
    let frame = capsule.character_from_body;
    let half = half_height + radius;
    let end = |sign: f32, share: f32| {
        let mut radial: Vec<_> = patch
            .samples
            .iter()
            .map(|sample| (frame.inverse_point(sample.point), sample.area))
            .filter(|(p, _)| {
                let from_end = 0.5 * (1.0 - sign * p.y / half);
                NEAR_END[0] < from_end && from_end < NEAR_END[1]
            })
            .map(|(p, area)| (Vec3::new(p.x, 0.0, p.z).length(), area))
            .collect();
        (!radial.is_empty()).then(|| quantiles_of(&mut radial, [share])[0])
    };
    // As for capsules, the higher quantile suits round limbs, the lower one flat limbs.
    [0.8, 0.65]
        .into_iter()
        .filter_map(|share| Some(tapered([end(-1.0, share)?, end(1.0, share)?], half, frame, patch)))
        .reduce(|a, b| if b.error < a.error { b } else { a })
}

/// Returns a tapered capsule with the capsule's extent, from radii a quarter of the length from each end.
fn tapered([low, high]: [f32; 2], half: f32, frame: Transform, patch: &Patch) -> Fit {
    let (mean, slope) = (0.5 * (low + high), high - low);
    let least = 0.3 * mean;
    let limited = |r: f32| clamp(r * SHRINK, max(least, LEAST_HALF), 0.9 * half);
    let [mut low, mut high] = [limited(mean - slope), limited(mean + slope)];
    // The centres of the two balls are one radius inside the ends.
    let distance = 2.0 * half - low - high;
    let steep = (high - low).abs() / max(distance, LEAST_HALF);
    if steep > STEEPEST {
        let (middle, apart) = (0.5 * (low + high), 0.5 * (high - low) * (STEEPEST / steep));
        (low, high) = (middle - apart, middle + apart);
    }
    let half_height = max(half - 0.5 * (low + high), LEAST_HALF);
    // The ends keep their positions: the frame's origin is halfway between the two centres.
    let middle = frame.point(Vec3::Y * (0.5 * (low - high)));
    let shape = Shape::TaperedCapsule { half_height, radius_bottom: low, radius_top: high };
    measured(shape, Transform::new(middle, frame.rotation), patch)
}
