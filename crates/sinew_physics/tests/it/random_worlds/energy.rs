//! Energy of a world, including that of springs, soft welds and soft limits.

use sinew_math::{Range, Rotation, SwingTwistLimit, Transform, Vec3, limits, min};
use sinew_physics::*;

/// Energies, J, and mass, kg, of all dynamic bodies.
#[derive(Clone, Copy, Debug, Default)]
pub struct Energies {
    pub kinetic: f64,
    /// Sum of kinetic energy, potential energy in gravity, and energy of springs.
    pub total: f64,
    /// Energy of springs, soft welds and soft limits.
    pub elastic: f64,
    pub mass: f64,
}

/// Returns the energies, with heights and springs measured half a substep back, because velocities are half a substep
/// behind positions. Without that, the energy of an undamped spring would vary by the share `ωh/2`.
pub fn energies(world: &World) -> Energies {
    let back = -0.5 * world.def().dt() / world.def().substeps as f32;
    let mut sum = Energies::default();
    for id in world.body_ids().filter(|&id| world.kind(id) == BodyKind::Dynamic) {
        let mass = world.mass(id).mass;
        let center = world.center_of_mass(id) + world.velocity(id).linear * back;
        sum.mass += f64::from(mass);
        sum.kinetic += f64::from(world.body_energy(id).kinetic);
        sum.total -= f64::from(mass * world.def().gravity.dot(center));
    }
    for def in world.joint_ids().map(|id| world.joint(id)).filter(|def| def.state == JointState::Enabled) {
        let frame_a = moved(world, def.body_a, back) * def.frame_a;
        let frame_b = moved(world, def.body_b, back) * def.frame_b;
        sum.elastic += f64::from(elastic(&def, &(frame_a.inverse() * frame_b)));
    }
    sum.total += sum.kinetic + sum.elastic;
    sum
}

/// Returns the pose of a body after `time` seconds (before, if negative) at its current velocity.
fn moved(world: &World, id: BodyId, time: f32) -> Transform {
    let (pose, v, center) = (world.transform(id), world.velocity(id), world.center_of_mass(id));
    let rotation = pose.rotation.integrate(v.angular, time);
    let arm = pose.rotation.inverse() * (pose.translation - center);
    Transform::new(center + v.linear * time + rotation * arm, rotation)
}

fn stiffness(softness: Option<Softness>) -> f32 {
    match softness {
        Some(Softness::Stiffness { stiffness, .. }) => stiffness,
        _ => 0.0,
    }
}

/// Returns the elastic energy of a joint's weld, limit and spring, as far as their stiffnesses are given in N/m or N·m,
/// J. `seen` is the pose of frame B in frame A.
fn elastic(def: &JointDef, seen: &Transform) -> f32 {
    let locks = locks(&def.kind);
    let weld = stiffness(def.weld) * weld_square(&def.kind, &locks, seen);
    let limit = stiffness(def.limit_softness) * overshoot_square(&def.kind, seen);
    let spring = def.spring.map_or(0.0, |spring| {
        stiffness(Some(spring.softness)) * spring_square(&def.kind, &locks, seen, &spring.rest)
    });
    0.5 * (weld + limit + spring)
}

/// Returns which directions are locked: three translations, then the twist and two swings.
fn locks(kind: &JointKind) -> [bool; 6] {
    match kind {
        JointKind::Ball { .. } => [true, true, true, false, false, false],
        JointKind::Hinge { .. } => [true, true, true, false, true, true],
        JointKind::Universal { .. } => [true, true, true, true, false, false],
        JointKind::Fixed => [true; 6],
        JointKind::Slider { .. } => [false, true, true, true, true, true],
        JointKind::Distance { range } => [range.lo == range.hi, false, false, false, false, false],
        JointKind::SixDof(six) => {
            let [x, y, z] = six.linear;
            [x, y, z, six.twist, six.swing_y, six.swing_z].map(|motion| motion == AxisMotion::Locked)
        }
    }
}

fn masked_square(v: Vec3, mask: &[bool]) -> f32 {
    let of = |x: f32, counts: bool| if counts { x * x } else { 0.0 };
    of(v.x, mask[0]) + of(v.y, mask[1]) + of(v.z, mask[2])
}

/// Returns the square of the displacement along the locked directions.
fn weld_square(kind: &JointKind, locks: &[bool; 6], seen: &Transform) -> f32 {
    let linear = match kind {
        JointKind::Distance { range } if locks[0] => {
            let stretch = seen.translation.length() - range.lo;
            stretch * stretch
        }
        _ => masked_square(seen.translation, &locks[..3]),
    };
    let x_b = seen.rotation * Vec3::X;
    let angular = match locks[3..] {
        [true, true, true] => seen.rotation.to_scaled_axis().length_squared(),
        [twist, y, z] => {
            // The twist fades out near a swing of half a turn, where it is undefined.
            let (_, turn) = SwingTwistLimit::angles(seen.rotation);
            masked_square(Vec3::new(turn * 0.5 * (1.0 + x_b.x), x_b.z, x_b.y), &[twist, y, z])
        }
        _ => 0.0,
    };
    linear + angular
}

fn spring_square(kind: &JointKind, locks: &[bool; 6], seen: &Transform, rest: &Transform) -> f32 {
    let open = locks.map(|lock| !lock);
    let linear = match kind {
        JointKind::Distance { .. } if locks[0] => 0.0,
        JointKind::Distance { .. } => {
            let stretch = seen.translation.length() - rest.translation.x;
            stretch * stretch
        }
        _ => masked_square(seen.translation - rest.translation, &open[..3]),
    };
    if matches!(kind, JointKind::Distance { .. }) {
        return linear;
    }
    let turn = (seen.rotation * rest.rotation.inverse()).to_scaled_axis();
    linear + masked_square(turn, &open[3..])
}

/// Returns the sum of the squares of the joint's overshoots.
fn overshoot_square(kind: &JointKind, seen: &Transform) -> f32 {
    let square = |room: f32| min(room, 0.0) * min(room, 0.0);
    let outside = |range: Range, x: f32| square(x - range.lo) + square(range.hi - x);
    let cone = |limit: &SwingTwistLimit| square(limit.swing_state(seen.rotation).slack);
    let twist = |range: Range| twist_square(range, seen.rotation);
    match kind {
        JointKind::Ball { limit: Some(limit) } => cone(limit) + twist(limit.twist),
        JointKind::Universal { limit: Some(limit) } => cone(limit),
        JointKind::Hinge { limit: Some(range) } => {
            let half = 0.5 * (range.hi - range.lo);
            let angle = limits::wrap(limits::hinge_angle(seen.rotation) - range.center());
            outside(Range::symmetric(half), angle)
        }
        JointKind::Slider { limit: Some(range) } => outside(*range, seen.translation.x),
        JointKind::Distance { range } if range.lo < range.hi => outside(*range, seen.translation.length()),
        JointKind::SixDof(six) => {
            let t = seen.translation;
            let mut sum = 0.0;
            for (motion, x) in six.linear.iter().zip([t.x, t.y, t.z]) {
                if let AxisMotion::Limited(range) = motion {
                    sum += outside(*range, x);
                }
            }
            sum
        }
        _ => 0.0,
    }
}

fn twist_square(range: Range, rotation: Rotation) -> f32 {
    let free = Range::symmetric(core::f32::consts::PI);
    let limit = SwingTwistLimit { swing_y: free, swing_z: free, twist: range };
    limit.twist_states(rotation).iter().map(|state| min(state.slack, 0.0) * min(state.slack, 0.0)).sum()
}

#[test]
fn an_undamped_swing_keeps_its_energy() {
    let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
    let a = world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() });
    let b = world.add_body(&crate::build::sphere_body(0.1, Vec3::ZERO));
    let kind = JointKind::Slider { limit: None };
    let def = JointDef::between(a, b, Transform::IDENTITY, Transform::IDENTITY, kind);
    let softness = Softness::Stiffness { stiffness: 400.0, damping: 0.0 };
    let rest = Transform::from_translation(Vec3::X * 0.5);
    world.add_joint(&JointDef { spring: Some(Spring { softness, rest }), ..def });
    for step in 0..120 {
        let found = energies(&world).total;
        assert!((found - 50.0).abs() < 0.25, "step {step}: {found} J, expected ½ k x² = 50 J");
        world.step();
    }
}
