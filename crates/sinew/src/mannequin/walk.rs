//! Walking, running and standing: periodic motions written as curves.

use super::gait::{Gait, Path, Swing, laid_on};
use super::keys::{RATE, record};
use super::posture::{Hanging, Posture};
use super::skeleton::{HIPS_ABOVE_HIP, Side};
use crate::anim::Clip;
use crate::math::{Vec3, trig};

/// Speed at which the planted feet of the walk do not slide, m/s along +Z.
pub const WALK_SPEED: f32 = 1.25;
/// Speed at which the planted feet of the run do not slide, m/s along +Z.
pub const RUN_SPEED: f32 = 3.0;

pub(super) const WALK: Gait = Gait {
    speed: WALK_SPEED,
    frames: 32,
    stance: 0.625,
    heel_strike: 0.25,
    aside: 0.062,
    landing_pitch: -20.0,
    leaving_pitch: 58.0,
    flat: [0.09375, 0.3125],
    toe_out: 6.0,
    swing: Swing {
        phases: [0.70, 0.79, 0.89],
        aside: 0.060,
        height: [0.215, 0.180, 0.128],
        ahead: [-0.250, -0.010, 0.205],
        pitch: [52.0, 22.0, -8.0],
        toes: [20.0, 4.0, 2.0],
    },
};

/// Gait of the run. Both feet are in the air for a tenth of a cycle after each step.
pub(super) const RUN: Gait = Gait {
    speed: RUN_SPEED,
    frames: 22,
    stance: 0.36,
    heel_strike: 0.22,
    aside: 0.045,
    landing_pitch: -6.0,
    leaving_pitch: 64.0,
    flat: [0.05, 0.13],
    toe_out: 4.0,
    swing: Swing {
        phases: [0.50, 0.70, 0.88],
        aside: 0.055,
        height: [0.46, 0.44, 0.20],
        ahead: [-0.46, 0.02, 0.33],
        pitch: [88.0, 52.0, -2.0],
        toes: [14.0, 4.0, 2.0],
    },
};

/// One cycle of walking in place, starting at the left heel strike.
pub(super) fn walk() -> Clip {
    cycle("walk", &WALK, |phase| walking(phase, Path::Straight))
}

/// One cycle of walking along a path, relative to the character.
pub(super) fn walk_along(path: Path) -> Clip {
    cycle("walk", &WALK, |phase| walking(phase, path))
}

/// One cycle of running in place, starting at the left heel strike.
pub(super) fn run() -> Clip {
    cycle("run", &RUN, running)
}

fn cycle(name: &str, gait: &Gait, posture: impl Fn(f32) -> Posture) -> Clip {
    record(name, gait.frames, |time| {
        // The last key equals the first one.
        let phase = time * RATE / gait.frames as f32;
        posture(if phase > 0.999 { 0.0 } else { phase })
    })
}

pub(super) fn wave(phase: f32) -> f32 {
    trig::sin(phase * core::f32::consts::TAU)
}

fn half_on(phase: f32) -> f32 {
    if phase < 0.5 { phase + 0.5 } else { phase - 0.5 }
}

/// Posture of the walk at a phase of the cycle, 0..1.
fn walking(phase: f32, path: Path) -> Posture {
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
        left_foot: laid_on(path, WALK.foot(Side::Left, phase)),
        right_foot: laid_on(path, WALK.foot(Side::Right, half_on(phase))),
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

/// Posture of the run at a phase of the cycle, 0..1: lowest in the middle of each stance, leaning forward,
/// elbows bent.
fn running(phase: f32) -> Posture {
    let (stride, weight) = (wave(phase + 0.21), wave(phase - 0.02));
    let rise = -0.032 * wave(2.0 * (phase - 0.17) + 0.25);
    let mut posture = Posture {
        pelvis: Vec3::new(0.012 * weight, 0.868 + HIPS_ABOVE_HIP + rise, 0.0),
        pelvis_turn: Vec3::new(9.0, -9.0 * stride, 3.0 * weight),
        spine: Vec3::new(1.0, 9.0 * stride, -2.0 * weight),
        chest: Vec3::new(2.0, 10.0 * stride, -1.5 * weight),
        neck: Vec3::new(-3.0, -5.0 * stride, 0.5 * weight),
        head: Vec3::new(-7.0, -5.0 * stride, 0.0),
        left_foot: RUN.foot(Side::Left, phase),
        right_foot: RUN.foot(Side::Right, half_on(phase)),
        ..Posture::standing()
    };
    for side in Side::BOTH {
        let back = stride * side.sign();
        let hanging = Hanging { forward: -4.0 - 36.0 * back, out: 9.0, elbow: 88.0 - 14.0 * back };
        posture = posture.with_arm(side, hanging);
    }
    posture
}

/// Number of frames of one breath.
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
