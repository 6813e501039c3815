//! Removes foot sliding.

use super::smooth_above;
use crate::clip::take::Take;
use crate::contact::{FootContact, FootSlide, Ground, foot_slide, frames_of, sole_points};
use crate::ik::{Pole, TwoBoneGoal, two_bone_ik};
use crate::legs::{Foot, Legs};
use crate::pose::{local_to_model, smoothstep};
use crate::rig::Rig;
use crate::tuning::{LEG_REACH, PELVIS_TIME};
use sinew_math::{Affine, Vec3, max, min};

/// Result of holding the feet on the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FootSlideReport {
    /// Number of contacts during which the foot was held in place.
    pub contacts: usize,
    /// Foot slide before and after.
    pub slide: [FootSlide; 2],
    /// Largest shift of an ankle, metres.
    pub shifted: f32,
    /// Largest lowering of the pelvis so that the legs reach, metres.
    pub lowered: f32,
    /// Largest remaining distance of an ankle from its target, metres.
    pub miss: f32,
}

/// Holds the ball of each foot at one point of the floor through each of its contacts, by inverse kinematics of the
/// legs; between contacts the correction blends over. Feet keep their rotations, no sole goes below the floor, and the
/// pelvis is lowered if a leg is too short.
///
/// Lengths are metres in the space of `root`, y up; `ground` is the floor in that space.
///
/// # Panics
/// If the take does not fit the rig.
pub fn remove_foot_slide(
    rig: &Rig,
    root: &Affine,
    legs: &Legs,
    contacts: &[FootContact],
    ground: &Ground,
    take: &mut Take,
) -> FootSlideReport {
    let feet = &legs.feet;
    let seen = |take: &Take| ground.seen_from(take, sole_points(rig, root, feet, take));
    let points = seen(take);
    let before = foot_slide(take, feet, &points, contacts);
    let shifts = [0, 1].map(|k| shifts_of(take, &feet[k], k, contacts, &points, ground.height));
    let mut model = Vec::new();
    let mut needed = Vec::new();
    for frame in 0..take.frames() {
        local_to_model(rig, take.pose(frame), root, &mut model);
        let need = |k: usize| pelvis_need(&model, &feet[k], shifts[k][frame]);
        needed.push(max(need(0), need(1)));
    }
    let lowered = smooth_above(&needed, take.frames_in(PELVIS_TIME));
    let mut report = FootSlideReport { contacts: contacts.len(), ..FootSlideReport::default() };
    for frame in 0..take.frames() {
        local_to_model(rig, take.pose(frame), root, &mut model);
        let ankles = [0, 1].map(|k| model[feet[k].leg.end].to_rigid());
        legs.carry(rig, Vec3::Y * -lowered[frame], take.pose_mut(frame), &mut model);
        for (k, foot) in feet.iter().enumerate() {
            let side = model[foot.leg.upper].to_rigid().rotation * foot.forward;
            let goal = TwoBoneGoal::at(ankles[k].translation + shifts[k][frame], Pole::Keep(side));
            let solved = two_bone_ik(rig, foot.leg, &goal, take.pose_mut(frame), &mut model);
            legs.plant(rig, foot, ankles[k].rotation, take.pose_mut(frame), &mut model);
            report.miss = max(report.miss, solved.miss);
            report.shifted = max(report.shifted, shifts[k][frame].length());
        }
    }
    report.lowered = lowered.into_iter().fold(0.0, max);
    report.slide = [before, foot_slide(take, feet, &seen(take), contacts)];
    report
}

/// Returns the shift of a foot to its contact point in each frame, metres.
fn shifts_of(
    take: &Take,
    foot: &Foot,
    k: usize,
    contacts: &[FootContact],
    points: &[[[Vec3; 2]; 2]],
    floor: f32,
) -> Vec<Vec3> {
    let mut shifts = vec![Vec3::ZERO; points.len()];
    let mut free_from = None;
    for contact in contacts.iter().filter(|contact| contact.foot == foot.side) {
        let [first, last] = frames_of(take, contact, points.len());
        let spot = (first..=last).map(|frame| points[frame][k][1]).sum::<Vec3>() / (last + 1 - first) as f32;
        for frame in first..=last {
            let ball = points[frame][k][1];
            shifts[frame] = Vec3::new(spot.x - ball.x, down_to(floor - ball.y, foot.length), spot.z - ball.z);
        }
        blend_over(&mut shifts, free_from, first);
        free_from = Some(last);
    }
    if let Some(last) = free_from {
        let held = shifts[last];
        shifts[last..].fill(held);
    }
    for (shift, frame) in shifts.iter_mut().zip(points) {
        let low = min(frame[k][0].y, frame[k][1].y) + shift.y;
        shift.y += max(floor - low, 0.0);
    }
    shifts
}

/// Returns the vertical shift of a ball of the foot that is `below` the floor (negative: above it), metres. Within a
/// sixtieth of the leg's length the shift brings the ball to the floor; from three times that distance it is zero, so
/// that a foot that is about to leave the floor is not pressed down again.
fn down_to(below: f32, leg: f32) -> f32 {
    let near = leg / 60.0;
    below * (1.0 - smoothstep((-below - near) / (2.0 * near)))
}

/// Blends between the end of one contact and the start of the next; before the first contact, the shift at its start
/// holds.
fn blend_over(shifts: &mut [Vec3], from: Option<usize>, to: usize) {
    let next = shifts[to];
    let Some(from) = from else { return shifts[..to].fill(next) };
    let last = shifts[from];
    for frame in from + 1..to {
        let t = (frame - from) as f32 / (to - from) as f32;
        shifts[frame] = last + (next - last) * smoothstep(t);
    }
}

/// Distance by which the pelvis must be lowered so that a foot reaches its ankle's target, metres; 0 if it reaches
/// already, or if lowering would not help.
fn pelvis_need(model: &[Affine], foot: &Foot, shift: Vec3) -> f32 {
    let [hip, knee, ankle] =
        [foot.leg.upper, foot.leg.lower, foot.leg.end].map(|joint| model[joint].translation);
    let full = LEG_REACH * ((knee - hip).length() + (ankle - knee).length());
    let way = hip - (ankle + shift);
    let aside = way.x * way.x + way.z * way.z;
    if aside >= full * full { 0.0 } else { max(way.y - (full * full - aside).sqrt(), 0.0) }
}
