//! Random joints.

use super::plan::{JointPlan, WorldPlan};
use super::{chance, decades};
use core::f32::consts::PI;
use sinew_math::{Random, Range, Rotation, SwingTwistLimit, Transform, Vec3, min};
use sinew_physics::*;

/// Allowed features of the joints of a world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Temper {
    /// Only features that remove energy or store energy that a test can compute: no motors, no soft zones, and only
    /// stiffnesses in N/m or N·m (a stiffness from a frequency depends on the pose through the effective mass).
    Passive,
    /// All features.
    Driven,
}

/// Returns a joint between two bodies of the plan at a point of the world.
pub fn joint(r: &mut Random, plan: &WorldPlan, bodies: [usize; 2], at: Vec3, temper: Temper) -> JointPlan {
    let [a, b] = bodies;
    let world_from_joint = Transform::new(at, r.rotation());
    let kind = kind(r, temper);
    let light = [a, b].iter().map(|&i| lightest(plan, i)).fold(f32::INFINITY, min);
    let mut joint = JointPlan {
        a,
        b,
        born: 0,
        frame_a: plan.bodies[a].pose.inverse() * world_from_joint,
        anchor_b: r.in_cube() * plan.bodies[b].shape.bounding_radius(),
        kind,
        weld: None,
        limit_softness: None,
        soft_zone: None,
        spring: None,
        motor: None,
        friction: if chance(r, 0.3) { decades(r, -2.0, 2.0) } else { 0.0 },
        strength: strength(r),
        collision: if chance(r, 0.8) { JointCollision::Disabled } else { JointCollision::Enabled },
    };
    if chance(r, 0.12) {
        joint.weld = Some(softness(r, temper, light));
    }
    if chance(r, 0.15) && stores_limits(&kind, temper) {
        joint.limit_softness = Some(softness(r, temper, light));
    }
    if chance(r, 0.2) && stores_springs(&kind, temper) {
        joint.spring = Some(Spring { softness: softness(r, temper, light), rest: rest(r, &kind) });
    }
    if temper == Temper::Driven {
        if chance(r, 0.15) {
            joint.soft_zone =
                Some(SoftZone { width: r.range(0.0, 0.5), softness: softness(r, temper, light) });
        }
        joint.motor = motor(r).filter(|_| chance(r, 0.4));
    }
    joint
}

/// Returns roughly the smaller of a body's mass (kg) and its smallest moment of inertia (kg·m²); infinity if the body
/// does not move.
fn lightest(plan: &WorldPlan, body: usize) -> f32 {
    let body = &plan.bodies[body];
    let thin = body.shape.inner_radius();
    if body.kind == BodyKind::Dynamic { min(body.mass, 0.4 * body.mass * thin * thin) } else { f32::INFINITY }
}

fn strength(r: &mut Random) -> Strength {
    let force = if chance(r, 0.1) { decades(r, 1.0, 4.0) } else { f32::INFINITY };
    let torque = if chance(r, 0.1) { decades(r, 0.0, 3.0) } else { f32::INFINITY };
    Strength { force, torque }
}

/// Returns a random range around zero.
fn around(r: &mut Random, widest: f32) -> Range {
    let mut side = || if chance(r, 0.1) { 0.0 } else { r.range(0.02, widest) };
    Range::new(-side(), side())
}

fn cone(r: &mut Random) -> SwingTwistLimit {
    SwingTwistLimit { swing_y: around(r, 2.5), swing_z: around(r, 2.5), twist: around(r, 3.0) }
}

/// Returns a range that may exclude zero if the joint may release energy.
fn interval(r: &mut Random, widest: f32, temper: Temper) -> Range {
    if temper == Temper::Driven && chance(r, 0.1) {
        let lo = r.range(-widest, widest);
        return Range::new(lo, r.range(lo, widest));
    }
    around(r, widest)
}

/// Returns a random kind for the joints of a net.
pub fn net_kind(r: &mut Random) -> JointKind {
    match r.index(4) {
        0 => JointKind::Distance { range: Range::new(0.0, 1.0) },
        1 => JointKind::Distance { range: Range::new(1.0, 1.0) },
        2 => JointKind::Fixed,
        _ => JointKind::Ball { limit: None },
    }
}

fn kind(r: &mut Random, temper: Temper) -> JointKind {
    let limited = chance(r, 0.6);
    match r.index(10) {
        0..3 => JointKind::Ball { limit: limited.then(|| cone(r)) },
        3..5 => JointKind::Hinge { limit: limited.then(|| interval(r, PI, temper)) },
        5 => JointKind::Universal { limit: limited.then(|| cone(r)) },
        6 => JointKind::Fixed,
        7 => JointKind::Slider { limit: limited.then(|| interval(r, 0.5, temper)) },
        8 => JointKind::Distance { range: distance(r) },
        _ => JointKind::SixDof(six(r)),
    }
}

/// Returns a range in units of the initial distance: a rod, a rope, or a band.
fn distance(r: &mut Random) -> Range {
    match r.index(3) {
        0 => Range::new(1.0, 1.0),
        1 => Range::new(0.0, r.range(1.0, 1.5)),
        _ => Range::new(r.range(0.3, 1.0), r.range(1.0, 2.0)),
    }
}

fn axis(r: &mut Random, widest: f32) -> AxisMotion {
    match r.index(3) {
        0 => AxisMotion::Locked,
        1 => AxisMotion::Free,
        _ => AxisMotion::Limited(around(r, widest)),
    }
}

fn six(r: &mut Random) -> SixDof {
    let linear = core::array::from_fn(|_| axis(r, 0.3));
    SixDof { linear, twist: axis(r, 3.0), swing_y: axis(r, 1.5), swing_z: axis(r, 1.5) }
}

/// Returns whether soft limits are allowed. A test cannot compute the energy of a cone limit far beyond the limit,
/// where the overshoot is exact to first order only.
fn stores_limits(kind: &JointKind, temper: Temper) -> bool {
    let turns = matches!(kind, JointKind::Ball { .. } | JointKind::Universal { .. } | JointKind::SixDof(_));
    temper == Temper::Driven || !turns
}

/// Returns whether springs are allowed: springs about only some axes of rotation have no potential energy.
fn stores_springs(kind: &JointKind, temper: Temper) -> bool {
    temper == Temper::Driven || !matches!(kind, JointKind::SixDof(_))
}

fn rest(r: &mut Random, kind: &JointKind) -> Transform {
    match kind {
        JointKind::Distance { .. } => Transform::from_translation(Vec3::X * r.range(0.5, 1.5)),
        JointKind::Universal { .. } => Transform::IDENTITY,
        JointKind::Hinge { .. } => {
            Transform::new(Vec3::ZERO, Rotation::from_axis_angle(Vec3::X, r.range(-1.0, 1.0)))
        }
        JointKind::Slider { .. } => Transform::from_translation(Vec3::X * r.range(-0.3, 0.3)),
        _ => Transform::new(r.in_cube() * 0.2, Rotation::from_scaled_axis(r.in_cube())),
    }
}

/// Returns a random softness. Passive springs are damped unless they are slow compared with a substep: for an undamped
/// spring whose period is a few substeps, no energy can be computed from positions and velocities half a substep apart.
fn softness(r: &mut Random, temper: Temper, light: f32) -> Softness {
    if temper == Temper::Driven && chance(r, 0.5) {
        let damping_ratio = if chance(r, 0.2) { 0.0 } else { decades(r, -2.0, 1.0) };
        return Softness::Frequency { hertz: decades(r, -1.0, 2.0), damping_ratio };
    }
    let stiffness = if chance(r, 0.05) { 0.0 } else { decades(r, 0.0, 6.0) };
    let slow = stiffness < 100.0 * light;
    let time =
        if (temper == Temper::Driven || slow) && chance(r, 0.5) { 0.0 } else { decades(r, -2.3, -0.7) };
    Softness::Stiffness { stiffness, damping: stiffness * time }
}

pub fn motor(r: &mut Random) -> Option<Motor> {
    if chance(r, 0.1) {
        return None;
    }
    let mut cap = || match r.index(3) {
        0 => 0.0,
        1 => f32::INFINITY,
        _ => decades(r, -1.0, 4.0),
    };
    let (max_force, max_torque) = (cap(), cap());
    let gains =
        if chance(r, 0.5) { Gains::Velocity } else { Gains::Position(softness(r, Temper::Driven, 0.0)) };
    let velocity = Velocity { linear: r.in_cube() * 2.0, angular: r.in_cube() * 10.0 };
    let target = Transform::new(r.in_cube() * 0.3, Rotation::from_scaled_axis(r.in_cube() * 2.0));
    let velocity = if chance(r, 0.5) { velocity } else { Velocity::default() };
    Some(Motor { gains, target, velocity, max_force, max_torque })
}
