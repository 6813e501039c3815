//! Looped clips that travel: their path is extracted from the poses as root motion, so that each lap continues where
//! the last one ended.

use super::CharacterDef;
use crate::character::tuning::{OFF_ORIGIN, STAYS_TURNED, STAYS_WITHIN, STRAIGHT};
use sinew_anim::take::Take;
use sinew_anim::{Clip, MotionTrack, Wrap, local_to_model, sample};
use sinew_math::{Affine, Rotation, Transform, Vec3, trig};

/// A motion over the ground: from start to end of a clip, along an arc at constant speed.
#[derive(Clone, Copy, Debug)]
struct Lap {
    /// Displacement, level, metres.
    way: Vec3,
    /// Rotation about the vertical, radians.
    turn: f32,
}

impl Lap {
    /// Measures the lap of the pelvis, in character space.
    fn of(def: &CharacterDef, take: &Take) -> Self {
        let [start, end] = [0, take.frames() - 1].map(|frame| stand(def, take, frame));
        let lap = end * start.inverse();
        Self { way: lap.translation, turn: lap.rotation.twist_angle(Vec3::Y) }
    }

    fn travels(self) -> bool {
        self.way.length() > STAYS_WITHIN || self.turn.abs() > STAYS_TURNED
    }

    /// Returns the transform after a share of the lap.
    fn at(self, share: f32) -> Transform {
        let turned = |angle: f32| Rotation::from_axis_angle(Vec3::Y, angle);
        if self.turn.abs() < STRAIGHT {
            return Transform::new(self.way * share, turned(self.turn * share));
        }
        // The motion rotates about the fixed centre c: way = c − R c.
        let half = 0.5 * self.turn;
        let across = Vec3::new(self.way.z, 0.0, -self.way.x);
        let center = (self.way + across * (trig::cos(half) / trig::sin(half))) * 0.5;
        let rotation = turned(self.turn * share);
        Transform::new(center - rotation * center, rotation)
    }
}

/// Returns the position of the pelvis over the ground and its heading in a frame of the take, as a transform.
fn stand(def: &CharacterDef, take: &Take, frame: usize) -> Transform {
    let (mut model, mut bodies) = (Vec::new(), Vec::new());
    local_to_model(&def.rig, take.pose(frame), &Affine::IDENTITY, &mut model);
    def.mapping().bodies_from_model(&model, Transform::IDENTITY, &mut bodies);
    let bind = def.ragdoll.bodies[0].character_from_body;
    let heading = (bodies[0].rotation * bind.rotation.inverse()).twist_angle(Vec3::Y);
    let place = model[def.ragdoll.bodies[0].joint].translation;
    let place = def.mapping().character_from_model().point(place) * Vec3::new(1.0, 0.0, 1.0);
    Transform::new(place, Rotation::from_axis_angle(Vec3::Y, heading))
}

/// Returns the horizontal displacement that moves the start of a clip to the position of the character, character
/// space: captures often begin metres from their origin. Zero if the pelvis starts near its position in the rest pose.
pub(super) fn to_origin(def: &CharacterDef, clip: &Clip) -> Vec3 {
    let mut poses = def.rest().to_vec();
    sample(clip, &def.rig, 0.0, Wrap::Clamp, &mut poses);
    poses.extend_from_slice(def.rest());
    let both = Take { frame_time: 1.0, joints: def.rig.joints.len(), poses };
    let [start, rest] = [0, 1].map(|frame| stand(def, &both, frame).translation);
    let way = rest - start;
    if way.length() > OFF_ORIGIN * def.ragdoll.height { way } else { Vec3::ZERO }
}

/// Returns the clip in place and the extracted path, model space. `None` if the clip does not travel.
pub(super) fn parted(def: &CharacterDef, take: &Take) -> Option<(Take, MotionTrack)> {
    let last = take.frames() - 1;
    if last == 0 {
        return None;
    }
    let lap = Lap::of(def, take);
    if !lap.travels() {
        return None;
    }
    let mut still = take.clone();
    let model = def.mapping().character_from_model().inverse();
    let up = model.to_rigid().rotation * Vec3::Y;
    let (mut times, mut positions, mut turns) = (Vec::new(), Vec::new(), Vec::new());
    for frame in 0..=last {
        let share = frame as f32 / last as f32;
        let stands = lap.at(share);
        def.mapping().reframe(still.pose_mut(frame), Transform::IDENTITY, stands);
        times.push(take.time(frame));
        positions.push(model.vector(stands.translation));
        turns.push(lap.turn * share);
    }
    Some((still, MotionTrack::through(times, positions, turns, up)))
}
