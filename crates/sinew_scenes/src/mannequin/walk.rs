//! Walking and standing: periodic motions written as curves.

use super::keys::{RATE, monotone, record};
use super::posture::{Foot, Hanging, Posture, turn};
use super::skeleton::{ANKLE_HEIGHT, Bone, HIPS_ABOVE_HIP, Side, bind_position};
use sinew::anim::{Clip, smoothstep};
use sinew::math::{Vec3, trig};

/// Speed at which the planted feet of the walk do not slide, m/s along +Z.
pub const WALK_SPEED: f32 = 1.25;

/// Frames of one cycle, two steps.
const CYCLE_FRAMES: usize = 32;
/// Way in one cycle, metres.
const STRIDE: f32 = WALK_SPEED * CYCLE_FRAMES as f32 / RATE;
/// Share of the cycle that a foot is on the ground.
const STANCE: f32 = 0.625;
/// Where the heel lands, metres in front of the hips.
const HEEL_STRIKE: f32 = 0.25;
/// Pitch of the foot as it lands: toes up 20°.
const LANDING_PITCH: f32 = -20.0;
/// Pitch of the foot as it leaves: heel up.
const LEAVING_PITCH: f32 = 58.0;
/// Phase at which the sole is down, and at which the heel rises.
const FLAT: [f32; 2] = [0.09375, 0.3125];
/// From the ankle to the heel's contact point in the bind pose.
const HEEL: Vec3 = Vec3::new(0.0, -ANKLE_HEIGHT, -0.055);

/// One cycle of walking on the spot, starting with the left heel's strike.
pub(super) fn walk() -> Clip {
    record("walk", CYCLE_FRAMES, |time| {
        // The last key is the first one again.
        let phase = time * RATE / CYCLE_FRAMES as f32;
        posture(if phase > 0.999 { 0.0 } else { phase })
    })
}

fn wave(phase: f32) -> f32 {
    trig::sin(phase * core::f32::consts::TAU)
}

/// Posture at a phase of the cycle, 0..1.
fn posture(phase: f32) -> Posture {
    // +1 with the left foot forward; +1 with the weight on the left leg.
    let (stride, weight) = (wave(phase + 0.25), wave(phase - 0.05));
    let rise = -0.0145 * wave(2.0 * (phase - 0.04) + 0.25);
    let mut posture = Posture {
        pelvis: Vec3::new(0.02 * weight, 0.897 + HIPS_ABOVE_HIP + rise, 0.0),
        pelvis_turn: Vec3::new(3.0, -6.0 * stride, 3.0 * weight),
        spine: Vec3::new(-1.0, 5.0 * stride, -2.5 * weight),
        chest: Vec3::new(1.0, 6.0 * stride, -1.5 * weight),
        neck: Vec3::new(2.0, -2.5 * stride, 0.5 * weight),
        head: Vec3::new(-4.0, -2.0 * stride, 0.5 * weight),
        left_foot: foot(Side::Left, phase),
        right_foot: foot(Side::Right, if phase < 0.5 { phase + 0.5 } else { phase - 0.5 }),
        ..Posture::standing()
    };
    for side in Side::BOTH {
        let back = stride * side.sign();
        // The forearm follows the upper arm a little late.
        let late_back = wave(phase + 0.19) * side.sign();
        let hanging = Hanging { forward: 3.0 - 21.0 * back, out: 6.0, elbow: 24.0 - 11.0 * late_back };
        posture = posture.with_arm(side, hanging);
    }
    posture
}

/// A foot at its own phase: 0 at heel strike.
fn foot(side: Side, phase: f32) -> Foot {
    if phase < STANCE { planted(side, phase) } else { swinging(side, phase) }
}

/// Heel rocker, flat, then rolling over the ball with the toes flat: the contact moves back at the walking speed.
fn planted(side: Side, phase: f32) -> Foot {
    let pitch = if phase < FLAT[1] {
        LANDING_PITCH * (1.0 - smoothstep(phase / FLAT[0]))
    } else {
        let x = (phase - FLAT[1]) / (STANCE - FLAT[1]);
        LEAVING_PITCH * x * x
    };
    let ball = bind_position(Bone::LeftToes) - bind_position(Bone::LeftFoot);
    let pivot = if pitch < 0.0 { HEEL } else { ball };
    let heading = turn(Vec3::new(0.0, 6.0 * side.sign(), 0.0));
    let heel = Vec3::new(0.062 * side.sign(), 0.0, HEEL_STRIKE - STRIDE * phase);
    let contact = heel + heading * (pivot - HEEL);
    let turn_now = Vec3::new(pitch, 6.0 * side.sign(), 0.0);
    let ankle = contact - turn(turn_now) * pivot;
    Foot { ankle, turn: turn_now, toes: if pitch > 0.0 { pitch } else { 0.0 }, knee_out: 4.0 }
}

/// From toe-off to heel strike: phase, ankle height, ankle z, pitch, toes between the ends that the stance gives.
fn swinging(side: Side, phase: f32) -> Foot {
    let (leave, land) = (planted(side, STANCE), planted(side, 0.0));
    let before = planted(side, STANCE - 0.03);
    let phases = [STANCE - 0.03, STANCE, 0.70, 0.79, 0.89, 1.0];
    let ends = |f: fn(&Foot) -> f32, middle: [f32; 3]| {
        let [a, b, c] = middle;
        monotone(&phases, &[f(&before), f(&leave), a, b, c, f(&land)], phase)
    };
    let ankle = Vec3::new(
        ends(|f| f.ankle.x, [0.060 * side.sign(); 3]),
        ends(|f| f.ankle.y, [0.215, 0.180, 0.128]),
        ends(|f| f.ankle.z, [-0.250, -0.010, 0.205]),
    );
    let pitch = ends(|f| f.turn.x, [52.0, 22.0, -8.0]);
    let toes = ends(|f| f.toes, [20.0, 4.0, 2.0]);
    Foot { ankle, turn: Vec3::new(pitch, leave.turn.y, 0.0), toes, knee_out: 4.0 }
}

/// Frames of one breath.
const BREATH_FRAMES: usize = 96;

/// Standing and breathing, starting from [`Posture::standing`].
pub(super) fn idle() -> Clip {
    record("idle", BREATH_FRAMES, |time| {
        let phase = time * RATE / BREATH_FRAMES as f32;
        let breath = 0.5 - 0.5 * wave(phase + 0.25);
        let sway = if phase > 0.999 { 0.0 } else { wave(phase) };
        let standing = Posture::standing();
        let posture = Posture {
            pelvis: standing.pelvis + Vec3::new(0.006 * sway, -0.003 * breath, 0.0),
            spine: standing.spine + Vec3::new(-0.6 * breath, 0.0, -0.4 * sway),
            chest: standing.chest + Vec3::new(-1.6 * breath, 0.0, -0.3 * sway),
            neck: standing.neck + Vec3::new(1.4 * breath, 0.8 * sway, 0.0),
            head: standing.head + Vec3::new(0.6 * breath, 0.8 * sway, 0.0),
            ..standing
        };
        posture.with_arms(Hanging { forward: 2.0, out: 7.0 + 0.8 * breath, elbow: 16.0 + 1.5 * breath })
    })
}
