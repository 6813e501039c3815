//! Getting up, from the back and from the face: key postures and the curves between them.
//!
//! Both end in [`Posture::standing`] at the origin, facing +Z. The lying pose defines the final facing: on the back
//! the feet point along +Z, on the face the head does.

use super::keys::{Key, RATE, between, record};
use super::posture::{Foot, Hand, Hanging, Posture};
use super::skeleton::Side::{self, Left, Right};
use crate::anim::{Clip, smoothstep};
use crate::math::Vec3;

fn clip(name: &str, keys: &[Key], steps: &[Step]) -> Clip {
    let frames = (keys[keys.len() - 1].at * RATE + 0.5) as usize;
    record(name, frames, |time| {
        let mut posture = between(keys, time);
        for step in steps.iter().filter(|step| step.from < time && time < step.to) {
            let foot = |of: Posture| if step.side == Left { of.left_foot } else { of.right_foot };
            let [from, to] = [step.from, step.to].map(|at| foot(between(keys, at)).ankle);
            let ankle = step.ankle(from, to, time);
            let moved = if step.side == Left { &mut posture.left_foot } else { &mut posture.right_foot };
            moved.ankle = ankle;
        }
        posture
    })
}

/// A step of a foot to another position: the foot goes up, over and down without sliding.
struct Step {
    side: Side,
    /// Seconds.
    from: f32,
    to: f32,
}

/// Height by which a step is lifted, metres.
const STEP_HEIGHT: f32 = 0.05;
/// Share of a step at each end in which the foot moves only vertically.
const STRAIGHT_UP: f32 = 0.08;

impl Step {
    fn ankle(&self, from: Vec3, to: Vec3, time: f32) -> Vec3 {
        let u = (time - self.from) / (self.to - self.from);
        let along = smoothstep((u - STRAIGHT_UP) / (1.0 - 2.0 * STRAIGHT_UP));
        from + (to - from) * along + Vec3::Y * (16.0 * u * u * (1.0 - u) * (1.0 - u) * STEP_HEIGHT)
    }
}

fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// Returns a turn that only leans forward, by `degrees`.
fn lean(degrees: f32) -> Vec3 {
    v(degrees, 0.0, 0.0)
}

/// Returns a hand with its palm on the floor.
fn palm(x: f32, z: f32, fingers_out: f32, elbow_out: f32) -> Hand {
    Hand { wrist: v(x, 0.032, z), flat: 1.0, fingers_out, elbow_out }
}

/// Returns a hand in the air or on a knee.
fn hand(x: f32, y: f32, z: f32, elbow_out: f32) -> Hand {
    Hand { wrist: v(x, y, z), flat: 0.0, fingers_out: 0.0, elbow_out }
}

/// Returns a foot in the air.
fn lifted(ankle: Vec3, pitch: f32, knee_out: f32) -> Foot {
    Foot { ankle, turn: lean(pitch), toes: 0.0, knee_out }
}

/// Gets up from the back: sits up on both hands, draws the feet in, rocks forward into a squat, stands.
pub(super) fn from_back() -> Clip {
    let [lying, curling, sitting] = sitting_up();
    let [pushing, squatting, rising, nearly] = standing_up(sitting);
    let postures = [
        (0.0, lying),
        (0.45, curling),
        (0.9, sitting),
        (1.2, pushing),
        (1.6, squatting),
        (2.0, rising),
        (2.4, nearly),
        (2.8, Posture::standing()),
    ];
    let steps = [Step { side: Left, from: 0.9, to: 1.2 }, Step { side: Right, from: 0.9, to: 1.2 }];
    clip("get_up_supine", &postures.map(|(at, posture)| Key { at, posture }), &steps)
}

fn sitting_up() -> [Posture; 3] {
    let lying = Posture {
        pelvis: v(0.0, 0.122, -0.44),
        pelvis_turn: lean(-90.0),
        spine: lean(0.0),
        chest: lean(0.0),
        neck: lean(0.0),
        head: v(0.0, 6.0, 0.0),
        left_foot: lifted(v(0.15, 0.093, 0.41), -65.0, 12.0),
        right_foot: lifted(v(-0.15, 0.093, 0.41), -65.0, 12.0),
        left_hand: palm(0.34, -0.62, 0.0, 98.0),
        right_hand: palm(-0.34, -0.62, 0.0, 98.0),
    };
    let curling = Posture {
        pelvis_turn: lean(-74.0),
        spine: lean(16.0),
        chest: lean(14.0),
        neck: lean(16.0),
        head: lean(8.0),
        left_foot: lifted(v(0.13, 0.16, 0.18), -25.0, 10.0),
        right_foot: lifted(v(-0.15, 0.10, 0.38), -50.0, 10.0),
        ..lying
    };
    let sitting = Posture {
        pelvis: v(0.0, 0.118, -0.42),
        pelvis_turn: lean(-32.0),
        spine: lean(10.0),
        chest: lean(8.0),
        neck: lean(6.0),
        head: lean(0.0),
        left_foot: lifted(v(0.11, 0.15, 0.06), -8.0, 8.0),
        right_foot: lifted(v(-0.13, 0.16, 0.16), -15.0, 8.0),
        left_hand: palm(0.34, -0.62, 10.0, 50.0),
        right_hand: palm(-0.34, -0.62, 10.0, 50.0),
    };
    [lying, curling, sitting]
}

fn standing_up(sitting: Posture) -> [Posture; 4] {
    let pushing = Posture {
        pelvis: v(-0.02, 0.15, -0.41),
        pelvis_turn: v(-15.0, -8.0, 10.0),
        spine: lean(20.0),
        chest: lean(12.0),
        left_foot: Foot { knee_out: 20.0, ..Foot::flat(Left, 0.105, 0.0, 8.0) },
        right_foot: Foot { knee_out: 20.0, ..Foot::flat(Right, -0.108, 0.0, 8.0) },
        left_hand: hand(0.28, 0.50, -0.02, 0.0),
        right_hand: palm(-0.34, -0.58, 20.0, 30.0),
        ..sitting
    };
    let squatting = Posture {
        pelvis: v(0.0, 0.37, -0.23),
        pelvis_turn: lean(18.0),
        spine: lean(20.0),
        chest: lean(14.0),
        neck: lean(-16.0),
        head: lean(-12.0),
        left_foot: Foot { knee_out: 24.0, ..Foot::on_ball(Left, 0.105, 0.0, 8.0, 8.0) },
        right_foot: Foot { knee_out: 24.0, ..Foot::on_ball(Right, -0.108, 0.0, 8.0, 12.0) },
        left_hand: hand(0.25, 0.40, 0.36, 0.0),
        right_hand: hand(-0.27, 0.36, 0.26, 0.0),
    };
    let rising = Posture {
        pelvis: v(0.0, 0.62, -0.15),
        pelvis_turn: lean(34.0),
        spine: lean(12.0),
        chest: lean(8.0),
        left_foot: Foot { knee_out: 14.0, ..Posture::standing().left_foot },
        right_foot: Foot { knee_out: 14.0, ..Posture::standing().right_foot },
        left_hand: hand(0.20, 0.58, 0.22, 10.0),
        right_hand: hand(-0.20, 0.58, 0.21, 10.0),
        ..squatting
    };
    let nearly = Posture {
        pelvis: v(0.0, 0.87, -0.05),
        pelvis_turn: lean(16.0),
        spine: lean(4.0),
        chest: lean(2.0),
        neck: lean(-8.0),
        head: lean(-6.0),
        ..rising
    }
    .with_arms(Hanging { forward: 16.0, out: 10.0, elbow: 26.0 });
    [pushing, squatting, rising, nearly]
}

/// Gets up from the face: presses the chest up, rises onto the knees, plants the left foot, rises over it.
pub(super) fn from_face() -> Clip {
    let [lying, pressing, drawing_in, on_all_fours] = pressing_up();
    let [stepping, half_kneeling, rising, nearly] = stepping_up(on_all_fours);
    let postures = [
        (0.0, lying),
        (0.45, pressing),
        (0.75, drawing_in),
        (1.05, on_all_fours),
        (1.4, stepping),
        (1.75, half_kneeling),
        (2.15, rising),
        (2.55, nearly),
        (2.9, Posture::standing()),
    ];
    let steps = [
        Step { side: Left, from: 1.4, to: 1.75 },
        Step { side: Right, from: 2.15, to: 2.55 },
        Step { side: Right, from: 2.55, to: 2.9 },
    ];
    clip("get_up_prone", &postures.map(|(at, posture)| Key { at, posture }), &steps)
}

fn pressing_up() -> [Posture; 4] {
    let lying = Posture {
        pelvis: v(0.0, 0.112, 0.0),
        pelvis_turn: lean(90.0),
        spine: lean(0.0),
        chest: lean(0.0),
        neck: v(0.0, 25.0, 0.0),
        head: v(0.0, 45.0, 0.0),
        left_foot: lifted(v(0.12, 0.082, -0.88), 152.0, 8.0),
        right_foot: lifted(v(-0.12, 0.082, -0.88), 152.0, 8.0),
        left_hand: palm(0.34, 0.40, 0.0, -35.0),
        right_hand: palm(-0.34, 0.40, 0.0, -35.0),
    };
    let pressing = Posture {
        pelvis: v(0.0, 0.150, -0.03),
        pelvis_turn: lean(78.0),
        spine: lean(-14.0),
        chest: lean(-12.0),
        neck: lean(-12.0),
        head: lean(-8.0),
        left_hand: palm(0.34, 0.40, 0.0, 10.0),
        right_hand: palm(-0.34, 0.40, 0.0, 10.0),
        ..lying
    }
    .with_knee_down(Left, 0.12, 0.205, 118.0, 20.0)
    .with_knee_down(Right, -0.12, 0.205, 118.0, 20.0);
    let drawing_in = Posture {
        pelvis: v(0.0, 0.33, -0.12),
        pelvis_turn: lean(82.0),
        spine: lean(0.0),
        chest: lean(-4.0),
        ..pressing
    }
    .with_knee_down(Left, 0.12, 0.195, 88.0, 40.0)
    .with_knee_down(Right, -0.12, 0.195, 88.0, 40.0);
    let on_all_fours = Posture {
        pelvis: v(0.0, 0.465, -0.23),
        pelvis_turn: lean(84.0),
        spine: lean(6.0),
        chest: lean(2.0),
        ..drawing_in
    }
    .with_knee_down(Left, 0.12, 0.172, 65.0, 62.0)
    .with_knee_down(Right, -0.12, 0.172, 65.0, 62.0);
    [lying, pressing, drawing_in, on_all_fours]
}

fn stepping_up(on_all_fours: Posture) -> [Posture; 4] {
    let stepping = Posture {
        pelvis: v(-0.02, 0.50, -0.24),
        pelvis_turn: v(66.0, 0.0, 8.0),
        spine: lean(18.0),
        chest: lean(14.0),
        left_foot: lifted(v(0.17, 0.19, -0.36), 35.0, 14.0),
        left_hand: Hand { flat: 0.8, ..hand(0.31, 0.20, 0.34, 10.0) },
        right_hand: palm(-0.34, 0.40, 0.0, 10.0),
        ..on_all_fours
    };
    let half_kneeling = Posture {
        pelvis: v(0.0, 0.475, -0.26),
        pelvis_turn: lean(24.0),
        spine: lean(16.0),
        chest: lean(10.0),
        neck: lean(-12.0),
        head: lean(-10.0),
        left_foot: Posture::standing().left_foot,
        left_hand: hand(0.18, 0.60, 0.14, 5.0),
        right_hand: hand(-0.27, 0.46, 0.10, 5.0),
        ..stepping
    };
    let rising = Posture {
        pelvis: v(0.02, 0.66, -0.17),
        pelvis_turn: lean(26.0),
        left_hand: hand(0.18, 0.64, 0.18, 5.0),
        right_hand: hand(-0.25, 0.60, 0.10, 5.0),
        ..half_kneeling
    };
    let nearly = Posture {
        pelvis: v(0.025, 0.86, -0.05),
        pelvis_turn: lean(14.0),
        spine: lean(4.0),
        chest: lean(2.0),
        neck: lean(-6.0),
        head: lean(-6.0),
        right_foot: lifted(v(-0.105, 0.20, -0.22), 24.0, 8.0),
        ..rising
    }
    .with_arms(Hanging { forward: 14.0, out: 9.0, elbow: 28.0 });
    [stepping, half_kneeling, rising, nearly]
}
