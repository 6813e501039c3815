//! Places feet on ground that differs from the animation's flat floor.

use super::two_bone::{Pole, TwoBone, TwoBoneGoal, two_bone_ik};
use super::{set_rotation, shift};
use crate::pose::smoothstep;
use crate::rig::{JointIdx, LocalTransform, Rig};
use sinew_math::{Affine, Rotation, Transform, Vec3, clamp, direction, max, min};

/// Ground below a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FootGround {
    /// Height along the up axis, from the origin of the space.
    pub height: f32,
    /// Unit normal of the ground.
    pub normal: Vec3,
}

/// Settings for placing feet. Lengths are in units of the pose, angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FootPlacement {
    /// Unit vector away from the ground.
    pub up: Vec3,
    /// Direction that the body faces, any length. A straight knee bends toward it.
    pub forward: Vec3,
    /// Height of the floor that the animation was made for.
    pub floor: f32,
    /// Height of the ankles above that floor when a foot is flat on the floor.
    pub ankle_height: f32,
    /// Height above the floor at which a foot is free and keeps its tilt, above 0.
    pub free_height: f32,
    /// Largest vertical shift of a foot, and of the pelvis downward.
    pub max_step: f32,
    /// Largest tilt of a foot to match the ground.
    pub max_tilt: f32,
}

/// Result of placing one foot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlacedFoot {
    /// Height by which the foot was raised; negative if lowered.
    pub raised: f32,
    /// Angle by which the foot was tilted.
    pub tilted: f32,
    /// Distance of the ankle from its target.
    pub miss: f32,
}

/// Result of placing both feet of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlacedFeet {
    /// Height by which the pelvis was raised; negative if lowered.
    pub pelvis: f32,
    /// Results of both feet, in the order given.
    pub feet: [PlacedFoot; 2],
}

/// Places both feet on the ground: moves the pelvis with the lower foot, bends the knees, and tilts standing feet.
/// `ground` is called once per leg with the position of its ankle in the space of `model`, and returns the ground
/// below; `None` leaves that foot unchanged. `local` and `model` have one entry per joint; both are updated. No state
/// is kept: on ground with edges, smooth the heights that `ground` returns.
///
/// # Panics
/// If a slice does not have one entry per joint of the rig, or a joint is not in the rig.
pub fn place_feet(
    rig: &Rig,
    pelvis: JointIdx,
    legs: &[TwoBone; 2],
    settings: &FootPlacement,
    mut ground: impl FnMut(Vec3) -> Option<FootGround>,
    local: &mut [LocalTransform],
    model: &mut [Affine],
) -> PlacedFeet {
    assert_eq!(
        (local.len(), model.len()),
        (rig.joints.len(), rig.joints.len()),
        "the poses must be of one rig"
    );
    let steps = legs.map(|leg| Step::of(model, leg, settings, ground(model[leg.end].translation)));
    let mut lift =
        steps.iter().filter_map(|step| step.as_ref()).map(|step| step.raise).reduce(min).unwrap_or(0.0);
    for (leg, step) in legs.iter().zip(&steps) {
        lift = step
            .as_ref()
            .map_or(lift, |step| min(lift, highest_pelvis(model, leg, step.target, settings.up)));
    }
    let lift = clamp(lift, -settings.max_step, settings.max_step);
    shift(rig, pelvis, settings.up * lift, local, model);
    let mut placed = PlacedFeet { pelvis: lift, ..PlacedFeet::default() };
    for ((leg, step), foot) in legs.iter().zip(&steps).zip(&mut placed.feet) {
        let Some(step) = step else { continue };
        let goal = TwoBoneGoal::at(step.target, Pole::Keep(settings.forward));
        let miss = two_bone_ik(rig, *leg, &goal, local, model).miss;
        set_rotation(rig, leg.end, step.tilt * step.rotation, local, model);
        *foot = PlacedFoot { raised: step.raise, tilted: step.tilt.to_scaled_axis().length(), miss };
    }
    placed
}

/// Moves both ankles to target poses in the space of `model` (up: +Y, forward: +Z), and lowers the pelvis if a leg is
/// too short, by at least `least` and at most `most`. Returns the lowering. `local` and `model` have one entry per
/// joint; both are updated.
///
/// # Panics
/// If a slice does not have one entry per joint of the rig, or a joint is not in the rig.
pub fn hold_feet(
    rig: &Rig,
    pelvis: JointIdx,
    legs: &[TwoBone; 2],
    ankles: &[Transform; 2],
    [least, most]: [f32; 2],
    local: &mut [LocalTransform],
    model: &mut [Affine],
) -> f32 {
    assert_eq!(
        (local.len(), model.len()),
        (rig.joints.len(), rig.joints.len()),
        "the poses must be of one rig"
    );
    let highest =
        |(leg, ankle): (&TwoBone, &Transform)| highest_pelvis(model, leg, ankle.translation, Vec3::Y);
    let lift = legs.iter().zip(ankles).map(highest).fold(-least, min);
    let lift = max(lift, -most);
    shift(rig, pelvis, Vec3::Y * lift, local, model);
    for (leg, ankle) in legs.iter().zip(ankles) {
        let goal = TwoBoneGoal::at(ankle.translation, Pole::Keep(Vec3::Z));
        two_bone_ik(rig, *leg, &goal, local, model);
        set_rotation(rig, leg.end, ankle.rotation, local, model);
    }
    -lift
}

/// Largest rise of the pelvis at which its leg still reaches the ankle's target; negative if the pelvis must be
/// lowered.
fn highest_pelvis(model: &[Affine], leg: &TwoBone, target: Vec3, up: Vec3) -> f32 {
    let place = |joint: JointIdx| model[joint].translation;
    let long = (place(leg.lower) - place(leg.upper)).length() + (place(leg.end) - place(leg.lower)).length();
    let way = target - place(leg.upper);
    let down = way.dot(up);
    let aside = (way - up * down).length();
    let full = 0.999 * long;
    // A target whose horizontal distance exceeds the leg's reach is out of reach at every height.
    if aside >= full { f32::INFINITY } else { down + (full * full - aside * aside).sqrt() }
}

/// Goal of one foot.
struct Step {
    raise: f32,
    target: Vec3,
    /// Rotation of the foot before placement.
    rotation: Rotation,
    tilt: Rotation,
}

impl Step {
    fn of(
        model: &[Affine],
        leg: TwoBone,
        settings: &FootPlacement,
        ground: Option<FootGround>,
    ) -> Option<Self> {
        let up = settings.up;
        let ankle = model[leg.end].to_rigid();
        let ground = ground?;
        let normal = direction(ground.normal).filter(|normal| normal.dot(up) > 0.1)?;
        let height = ankle.translation.dot(up) - settings.floor;
        let stands = 1.0 - smoothstep((height - settings.ankle_height) / max(settings.free_height, 1e-6));
        // On a slope, an ankle at the same distance from the ground as on the floor is farther from it along `up`.
        let slope = (1.0 / normal.dot(up) - 1.0) * settings.ankle_height * stands;
        let raise = clamp(ground.height - settings.floor + slope, -settings.max_step, settings.max_step);
        let whole = Rotation::from_arc(up, normal).to_scaled_axis() * stands;
        let angle = whole.length();
        let tilt = if angle > settings.max_tilt { whole * (settings.max_tilt / angle) } else { whole };
        Some(Self {
            raise,
            target: ankle.translation + up * raise,
            rotation: ankle.rotation,
            tilt: Rotation::from_scaled_axis(tilt),
        })
    }
}
