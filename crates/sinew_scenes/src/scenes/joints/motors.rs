//! Arms on motors, against the formulas of a damped oscillator.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, hinge, hook, thin_rod};
use sinew::math::{Rotation, Transform, Vec3, max, min, trig};
use sinew::physics::{JointDef, JointId, Motor, Softness, World};

pub(in crate::scenes) const ARM: Scene = Scene {
    chapter: Chapter::Joints,
    name: "motor_arm",
    about: "motors hold arms against gravity, swing arms to a target, and do not exceed their largest torque",
    steps: 600,
    settings: &[
        Setting::number(
            "hertz",
            0.0,
            (0.0, 25.0),
            "natural frequency, Hz; 0: arms with 1, 2, 5 and 10 Hz side by side",
        ),
        Setting::number("damping_ratio", 0.4, (0.1, 2.0), "1 is critical"),
    ],
    build: motor_arm,
};

/// Length of an arm, metres.
const LENGTH: f32 = 1.0;
/// Mass of an arm, kg.
const MASS: f32 = 2.0;
/// Moment of inertia about the hinge at its end, kg·m².
const MOMENT: f32 = MASS * LENGTH * LENGTH / 3.0;
/// Torque of the weight of a level arm about its hinge, N·m.
const LEVEL_TORQUE: f32 = 0.5 * MASS * GRAVITY * LENGTH;
/// Target angle of the arms, radians from their start.
const GOAL: f32 = 0.2;
/// Torque limit of the weak motor, N·m: half of the torque that holds its arm.
const CAP: f32 = 0.5 * LEVEL_TORQUE;
/// Angle below level to which an arm falls with half of the holding torque, radians: the positive root of `sin x = x /
/// 2`, at which the work of the weight equals the work that the motor absorbed.
const WEAK_FALL: f32 = 1.895_494_3;

fn motor_arm(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let damping_ratio = setup.number("damping_ratio");
    let hertz = setup.number("hertz");
    let all = if hertz > 0.0 { vec![hertz] } else { vec![1.0, 2.0, 5.0, 10.0] };
    let mut arms = Vec::new();
    let mut aside = 0.0;
    let mut attach = |world: &mut World, axis: Vec3, motor: Motor| {
        aside += 0.5;
        arm(world, aside, axis, motor)
    };
    for &hertz in &all {
        let softness = Softness::Frequency { hertz, damping_ratio };
        let oscillator = Oscillator { omega: core::f32::consts::TAU * hertz, damping_ratio };
        // A hinge about z loads the motor with the weight; a hinge about the vertical does not.
        let held = attach(&mut world, Vec3::Z, Motor::toward(Transform::IDENTITY, softness));
        let swung = attach(&mut world, Vec3::Y, Motor::toward(turned(GOAL), softness));
        arms.push(Arm {
            oscillator,
            held,
            swung,
            error: 0.0,
            found: Peak::default(),
            formula: Peak::default(),
        });
    }
    let upright = Motor::toward(turned(0.5), Softness::Frequency { hertz: 20.0, damping_ratio: 1.0 });
    let weak = attach(&mut world, Vec3::Z, Motor { max_torque: CAP, ..upright });
    Instance::new(world, Arms { arms, weak, hardest: 0.0, lowest: 0.0 })
}

/// A level arm, hinged to the world at its end about an axis.
fn arm(world: &mut World, aside: f32, axis: Vec3, motor: Motor) -> JointId {
    let at = Vec3::Z * aside;
    let hook = world.add_body(&hook());
    let mut rod = thin_rod(0.0, LENGTH, MASS);
    rod.position += at;
    let rod = world.add_body(&rod);
    let joint = hinge(world, hook, rod, at, axis);
    world.add_joint(&JointDef { motor: Some(motor), ..joint })
}

fn turned(angle: f32) -> Transform {
    Transform::new(Vec3::ZERO, Rotation::from_axis_angle(Vec3::X, angle))
}

fn angle(world: &World, hinge: JointId) -> f32 {
    world.joint_transform(hinge).rotation.twist_angle(Vec3::X)
}

/// The differential equation `x″ + 2ζω x′ + ω² x = ω²`.
#[derive(Clone, Copy)]
struct Oscillator {
    /// Natural frequency, rad/s.
    omega: f32,
    damping_ratio: f32,
}

impl Oscillator {
    /// Motion from rest at 0 toward 1: `1 − e^(−ζωt) (cos φ + ζωt sin φ / φ)`, `φ² = (1 − ζ²)(ωt)²`.
    fn step_response(&self, t: f32) -> f32 {
        let Self { omega, damping_ratio } = *self;
        let turned = omega * t;
        let decay = -damping_ratio * turned;
        let squared = (1.0 - damping_ratio * damping_ratio) * turned * turned;
        let phase = squared.abs().sqrt();
        let (cos, sin_over_phase) = if phase < 1e-3 {
            (trig::exp(decay), trig::exp(decay))
        } else if squared > 0.0 {
            let (sin, cos) = trig::sin_cos(phase);
            (trig::exp(decay) * cos, trig::exp(decay) * sin / phase)
        } else {
            let (up, down) = (trig::exp(decay + phase), trig::exp(decay - phase));
            (0.5 * (up + down), 0.5 * (up - down) / phase)
        };
        1.0 - cos - damping_ratio * turned * sin_over_phase
    }

    /// Stiffness, N·m/rad.
    fn stiffness(&self) -> f32 {
        MOMENT * self.omega * self.omega
    }

    /// Angle below level at which the motor holds an arm, radians: `k x = m g l/2 cos x`, by Newton's method.
    fn sag(&self) -> f32 {
        let weight = LEVEL_TORQUE / self.stiffness();
        (0..8).fold(0.0, |x, _| {
            let (sin, cos) = trig::sin_cos(x);
            x - (x - weight * cos) / (1.0 + weight * sin)
        })
    }
}

/// The first maximum of a sampled value.
#[derive(Default)]
struct Peak {
    /// The last two values, the later one last.
    last: [f32; 2],
    /// Step and value of the maximum.
    found: Option<(f32, f32)>,
}

impl Peak {
    fn see(&mut self, step: u64, value: f32) {
        let [a, b] = self.last;
        if self.found.is_none() && a < b && b >= value {
            // Maximum of the parabola through three values.
            let after = 0.5 * (value - a) / (2.0 * b - a - value);
            self.found = Some(((step - 1) as f32 + after, b + 0.25 * (value - a) * after));
        }
        self.last = [b, value];
    }
}

/// Two arms on equal motors.
struct Arm {
    oscillator: Oscillator,
    /// Joint of the arm that carries its weight.
    held: JointId,
    /// Joint of the arm that swings to its target.
    swung: JointId,
    /// Largest deviation of the swung arm from the formula, as a share of the target angle.
    error: f32,
    found: Peak,
    formula: Peak,
}

impl Arm {
    fn after_step(&mut self, world: &World) {
        let def = world.def();
        // Positions lead by half a substep, as those of a falling body do.
        let t = world.time() as f32 + 0.5 * def.dt() / def.substeps as f32;
        let expected = self.oscillator.step_response(t);
        let found = angle(world, self.swung) / GOAL;
        self.error = max(self.error, (found - expected).abs());
        self.found.see(world.step_count(), found);
        self.formula.see(world.step_count(), expected);
    }

    /// Errors of the sag and of the holding torque, relative to their expected values.
    fn static_errors(&self, world: &World) -> [f32; 2] {
        let sag = self.oscillator.sag();
        let torque = LEVEL_TORQUE * trig::cos(sag);
        [-angle(world, self.held) / sag - 1.0, world.reaction(self.held).torque.z / torque - 1.0]
    }

    /// Errors of the peak time and of the overshoot, relative to their expected values; `None` without overshoot.
    fn peak_errors(&self) -> Option<[f32; 2]> {
        let ((time, top), (right_time, right_top)) = self.found.found.zip(self.formula.found)?;
        Some([time / right_time - 1.0, (top - 1.0) / (right_top - 1.0) - 1.0])
    }

    /// Energy added by the motors, J: the energy that a spring would have lost.
    fn work_in(&self, world: &World) -> f32 {
        let spent = |hinge: JointId, goal: f32| {
            let off = angle(world, hinge) - goal;
            goal * goal - off * off
        };
        0.5 * self.oscillator.stiffness() * (spent(self.held, 0.0) + spent(self.swung, GOAL))
    }
}

struct Arms {
    arms: Vec<Arm>,
    weak: JointId,
    /// Largest torque of the weak motor, N·m.
    hardest: f32,
    /// Smallest angle of the weak motor's arm, radians.
    lowest: f32,
}

impl Script for Arms {
    fn after_step(&mut self, world: &mut World) {
        for arm in &mut self.arms {
            arm.after_step(world);
        }
        self.hardest = max(self.hardest, world.reaction(self.weak).torque.z.abs());
        self.lowest = min(self.lowest, angle(world, self.weak));
    }

    fn work_in(&self, world: &World) -> f32 {
        let of_springs: f32 = self.arms.iter().map(|arm| arm.work_in(world)).sum();
        of_springs + CAP * angle(world, self.weak)
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let worst = |errors: &mut dyn Iterator<Item = f32>| errors.fold(0.0, |most, e| max(most, e.abs()));
        let of_holding = |i: usize| worst(&mut self.arms.iter().map(|arm| arm.static_errors(world)[i]));
        let of_peaks = |i: usize| {
            let errors: Option<Vec<_>> =
                self.arms.iter().map(|arm| arm.peak_errors().map(|e| e[i])).collect();
            errors.map(|errors| worst(&mut errors.into_iter()))
        };
        let must = Expected::AtMost(0.02);
        let mut metrics = vec![
            Metric::new("static_error", of_holding(0), Expected::AtMost(0.005)),
            Metric::new("holding_torque_error", of_holding(1), Expected::AtMost(0.001)),
            Metric::new("step_error", worst(&mut self.arms.iter().map(|arm| arm.error)), must),
            Metric::new("torque_over_cap", self.hardest / CAP, Expected::AtMost(1.001)),
            Metric::new("weak_fall_rad", -self.lowest, Expected::near(WEAK_FALL, 0.01)),
        ];
        if self.arms.iter().all(|arm| arm.oscillator.damping_ratio < 0.9) {
            metrics.push(Metric::awaited("peak_time_error", of_peaks(0), must));
            metrics.push(Metric::awaited("overshoot_error", of_peaks(1), must));
        }
        metrics
    }
}
