//! Walking and running: how feet are planted and swung, straight on or in a circle.

use super::keys::{RATE, monotone};
use super::posture::{Foot, turn};
use super::skeleton::{ANKLE_HEIGHT, Bone, Side, bind_position};
use crate::anim::smoothstep;
use crate::math::{Rotation, Transform, Vec3};

/// Path of a gait, relative to the character at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Path {
    /// A straight path along +Z.
    Straight,
    /// A circle to the left with this radius, metres: its centre is on +X.
    Circle(f32),
}

impl Path {
    /// Pose of the character after a distance along the path, metres, relative to its start.
    pub fn at(self, way: f32) -> Transform {
        match self {
            Self::Straight => Transform::from_translation(Vec3::Z * way),
            Self::Circle(radius) => {
                let (turn, center) = (Rotation::from_axis_angle(Vec3::Y, way / radius), Vec3::X * radius);
                Transform::new(center - turn * center, turn)
            }
        }
    }
}

/// Motion of the feet in one cycle of two steps.
pub(super) struct Gait {
    /// Speed at which the planted feet do not slide, m/s.
    pub speed: f32,
    /// Frames of a cycle.
    pub frames: usize,
    /// Fraction of the cycle in which a foot is on the ground.
    pub stance: f32,
    /// Distance of the landing heel in front of the hips and its lateral offset, metres.
    pub heel_strike: f32,
    pub aside: f32,
    /// Pitch of the landing foot (negative: toes up) and of the leaving foot (positive: heel up), degrees.
    pub landing_pitch: f32,
    pub leaving_pitch: f32,
    /// Phases at which the sole is down and at which the heel rises.
    pub flat: [f32; 2],
    /// Angle by which the toes point outward, degrees.
    pub toe_out: f32,
    pub swing: Swing,
}

/// The path of a foot through the air, at three phases between leaving and landing.
pub(super) struct Swing {
    pub phases: [f32; 3],
    /// Path of the ankle: lateral offset, height, distance in front of the hips; metres.
    pub aside: f32,
    pub height: [f32; 3],
    pub ahead: [f32; 3],
    /// Pitch of the foot (positive: heel up), and angle by which the toes bend up relative to it; degrees.
    pub pitch: [f32; 3],
    pub toes: [f32; 3],
}

/// Vector from the ankle to the heel's contact point in the bind pose.
const HEEL: Vec3 = Vec3::new(0.0, -ANKLE_HEIGHT, -0.055);

impl Gait {
    /// Distance covered in one cycle, metres.
    pub fn stride(&self) -> f32 {
        self.speed * self.frames as f32 / RATE
    }

    /// Seconds of one cycle.
    pub fn duration(&self) -> f32 {
        self.frames as f32 / RATE
    }

    /// Returns a foot at its own phase; phase 0 is its heel strike.
    pub fn foot(&self, side: Side, phase: f32) -> Foot {
        if phase < self.stance { self.planted(side, phase) } else { self.swinging(side, phase) }
    }

    /// Returns a foot on the ground: first heel rocker, then flat, then rolling over the ball with flat toes. The
    /// contact moves back at the gait's speed.
    fn planted(&self, side: Side, phase: f32) -> Foot {
        let pitch = if phase < self.flat[1] {
            self.landing_pitch * (1.0 - smoothstep(phase / self.flat[0]))
        } else {
            let x = (phase - self.flat[1]) / (self.stance - self.flat[1]);
            self.leaving_pitch * x * x
        };
        let ball = bind_position(Bone::LeftToes) - bind_position(Bone::LeftFoot);
        let pivot = if pitch < 0.0 { HEEL } else { ball };
        let heading = turn(Vec3::new(0.0, self.toe_out * side.sign(), 0.0));
        let heel = Vec3::new(self.aside * side.sign(), 0.0, self.heel_strike - self.stride() * phase);
        let contact = heel + heading * (pivot - HEEL);
        let turn_now = Vec3::new(pitch, self.toe_out * side.sign(), 0.0);
        let ankle = contact - turn(turn_now) * pivot;
        Foot { ankle, turn: turn_now, toes: if pitch > 0.0 { pitch } else { 0.0 }, knee_out: 4.0 }
    }

    /// Returns a foot from toe-off to heel strike: interpolates smoothly between the ends of the stances.
    fn swinging(&self, side: Side, phase: f32) -> Foot {
        let (leave, land) = (self.planted(side, self.stance), self.planted(side, 0.0));
        let before = self.planted(side, self.stance - 0.03);
        let [first, middle, last] = self.swing.phases;
        let phases = [self.stance - 0.03, self.stance, first, middle, last, 1.0];
        let ends = |f: fn(&Foot) -> f32, middle: [f32; 3]| {
            let [a, b, c] = middle;
            monotone(&phases, &[f(&before), f(&leave), a, b, c, f(&land)], phase)
        };
        let Swing { aside, height, ahead, pitch, toes, .. } = self.swing;
        let ankle = Vec3::new(
            ends(|f| f.ankle.x, [aside * side.sign(); 3]),
            ends(|f| f.ankle.y, height),
            ends(|f| f.ankle.z, ahead),
        );
        let pitch = ends(|f| f.turn.x, pitch);
        let toes = ends(|f| f.toes, toes);
        Foot { ankle, turn: Vec3::new(pitch, leave.turn.y, 0.0), toes, knee_out: 4.0 }
    }
}

/// Transfers a foot of a straight gait to another path. The path and the foot are both extended rigidly, and the
/// foot follows the path point of its ball; so a planted foot stays planted.
pub(super) fn laid_on(path: Path, foot: Foot) -> Foot {
    let Path::Circle(radius) = path else { return foot };
    let ball = bind_position(Bone::LeftToes) - bind_position(Bone::LeftFoot);
    let way = (foot.ankle + turn(foot.turn) * ball).z;
    let bend = path.at(way) * Transform::from_translation(Vec3::Z * -way);
    let heading = Vec3::Y * (way / radius).to_degrees();
    Foot { ankle: bend.point(foot.ankle), turn: foot.turn + heading, ..foot }
}
