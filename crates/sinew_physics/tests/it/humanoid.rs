//! A humanoid of 14 bodies, dropped and thrown, meets the quality limits of ragdolls.

use crate::build::{floor, joint};
use sinew_math::{Random, Range, Rotation, SwingTwistLimit, Transform, Vec3};
use sinew_physics::*;

pub struct Figure {
    pub world: World,
    pub bodies: Vec<BodyId>,
    pub joints: Vec<JointId>,
}

struct Builder {
    world: World,
    placed: Transform,
    velocity: Vec3,
    bodies: Vec<BodyId>,
    joints: Vec<JointId>,
}

/// Dry friction of the joints, N·m, and rolling resistance of the limbs, metres.
const FRICTION: f32 = 2.0;
const ROLLING: f32 = 0.01;

impl Builder {
    fn body(&mut self, shape: Shape, at: Vec3, lies_along_x: bool) -> BodyId {
        let turn = if lies_along_x {
            Rotation::from_axis_angle(Vec3::Z, core::f32::consts::FRAC_PI_2)
        } else {
            Rotation::IDENTITY
        };
        let pose = self.placed * Transform::new(at, turn);
        let mut def = ShapeDef::new(shape);
        def.material.rolling = ROLLING;
        let id = self.world.add_body(&BodyDef {
            position: pose.translation,
            rotation: pose.rotation,
            linear_velocity: self.velocity,
            shapes: vec![def],
            ..BodyDef::default()
        });
        self.bodies.push(id);
        id
    }

    /// Adds a joint at `at` whose x axis is `axis`, both in the humanoid's frame.
    fn join(&mut self, a: BodyId, b: BodyId, at: Vec3, axis: Vec3, kind: JointKind) {
        let frame = Transform::new(at, Rotation::from_arc(Vec3::X, axis));
        let mut def = joint(&self.world, a, b, self.placed * frame, kind);
        def.friction_torque = FRICTION;
        self.joints.push(self.world.add_joint(&def));
    }
}

fn cone(degrees: f32, twist: f32) -> JointKind {
    let half = Range::degrees(-degrees, degrees);
    JointKind::Ball {
        limit: Some(SwingTwistLimit { swing_y: half, swing_z: half, twist: Range::degrees(-twist, twist) }),
    }
}

fn hinge(lo: f32, hi: f32) -> JointKind {
    JointKind::Hinge { limit: Some(Range::degrees(lo, hi)) }
}

/// Adds the humanoid with its feet at the origin of `placed` and its arms stretched out.
pub fn figure(mut world: World, placed: Transform, velocity: Vec3) -> Figure {
    world.step(); // registers the static bodies
    let mut b = Builder { world, placed, velocity, bodies: Vec::new(), joints: Vec::new() };
    let cuboid = |x, y, z| Shape::Box { half_extents: Vec3::new(x, y, z) };
    let capsule = |radius, half_height| Shape::Capsule { half_height, radius };
    let v = Vec3::new;
    let pelvis = b.body(cuboid(0.15, 0.09, 0.09), v(0.0, 0.95, 0.0), false);
    let chest = b.body(cuboid(0.17, 0.18, 0.10), v(0.0, 1.28, 0.0), false);
    let head = b.body(capsule(0.10, 0.04), v(0.0, 1.62, 0.0), false);
    b.join(pelvis, chest, v(0.0, 1.07, 0.0), Vec3::Y, cone(30.0, 30.0));
    b.join(chest, head, v(0.0, 1.47, 0.0), Vec3::Y, cone(40.0, 45.0));
    for s in [1.0, -1.0] {
        let thigh = b.body(capsule(0.07, 0.13), v(0.10 * s, 0.66, 0.0), false);
        let shin = b.body(capsule(0.055, 0.145), v(0.10 * s, 0.26, 0.0), false);
        let foot = b.body(cuboid(0.045, 0.03, 0.11), v(0.10 * s, 0.03, 0.04), false);
        let upper = b.body(capsule(0.05, 0.10), v(0.34 * s, 1.40, 0.0), true);
        let fore = b.body(capsule(0.042, 0.098), v(0.64 * s, 1.40, 0.0), true);
        let hand = b.body(cuboid(0.07, 0.02, 0.04), v(0.86 * s, 1.40, 0.0), false);
        b.join(pelvis, thigh, v(0.10 * s, 0.86, 0.0), -Vec3::Y, cone(50.0, 20.0));
        b.join(thigh, shin, v(0.10 * s, 0.46, 0.0), Vec3::X, hinge(0.0, 130.0));
        b.join(shin, foot, v(0.10 * s, 0.06, 0.0), Vec3::X, hinge(-30.0, 30.0));
        b.join(chest, upper, v(0.18 * s, 1.40, 0.0), Vec3::X * s, cone(80.0, 45.0));
        b.join(upper, fore, v(0.495 * s, 1.40, 0.0), Vec3::Y * -s, hinge(0.0, 135.0));
        b.join(fore, hand, v(0.785 * s, 1.40, 0.0), Vec3::X * s, cone(30.0, 10.0));
    }
    Figure { world: b.world, bodies: b.bodies, joints: b.joints }
}

/// Measurements of a run.
#[derive(Debug, Default)]
pub struct Report {
    pub gap_max: f32,
    pub overshoot_max: f32,
    pub overshoot_p99: f32,
    pub penetration_max: f32,
    pub penetration_rest: f32,
    pub gain: f32,
    pub settled: Option<f32>,
    pub asleep: Option<f32>,
}

pub fn observe(figure: &mut Figure, seconds: f32) -> Report {
    let Figure { world, bodies, joints } = figure;
    let mut report = Report::default();
    let mass: f32 = bodies.iter().map(|&id| world.mass(id).mass).sum();
    let mut overshoots = Vec::new();
    let mut calm_since = None;
    let dt = world.def().dt();
    for step in 0..(seconds / dt) as usize {
        let before = world.energy();
        world.step();
        let after = world.energy();
        let rise = (after.total() - before.total()) / before.kinetic.max(after.kinetic).max(mass);
        report.gain = report.gain.max(rise);
        report.penetration_rest = 0.0;
        for &id in bodies.iter() {
            let depth = world.penetration(id);
            report.penetration_max = report.penetration_max.max(depth);
            report.penetration_rest = report.penetration_rest.max(depth);
        }
        for &id in joints.iter() {
            report.gap_max = report.gap_max.max(world.joint_gap(id));
            overshoots.push(world.joint_overshoot(id).to_degrees());
        }
        let calm = bodies.iter().all(|&id| {
            let v = world.velocity(id);
            v.linear.length() < 0.02 && v.angular.length() < 0.05
        });
        let t = step as f32 * dt;
        calm_since = if calm { calm_since.or(Some(t)) } else { None };
        if report.settled.is_none() && calm_since.is_some_and(|since| t - since >= 0.5) {
            report.settled = calm_since;
        }
        if report.asleep.is_none() && bodies.iter().all(|&id| !world.is_awake(id)) {
            report.asleep = Some(t);
        }
    }
    overshoots.sort_by(f32::total_cmp);
    report.overshoot_p99 = overshoots[overshoots.len() * 99 / 100];
    report.overshoot_max = overshoots[overshoots.len() - 1];
    report
}

/// Returns a rotated humanoid whose lowest body is about `height` metres above the floor.
fn dropped(turn: Rotation, height: f32) -> Figure {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let lowest =
        [Vec3::new(0.0, 1.75, 0.0), Vec3::ZERO, Vec3::new(0.93, 1.4, 0.0), Vec3::new(-0.93, 1.4, 0.0)]
            .map(|p| (turn * p).y)
            .into_iter()
            .fold(f32::INFINITY, f32::min);
    figure(world, Transform::new(Vec3::Y * (height - lowest + 0.12), turn), Vec3::ZERO)
}

fn thrown_at_a_wall(speed: f32, turn: Rotation) -> Figure {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    world.add_body(&BodyDef {
        kind: BodyKind::Static,
        position: Vec3::new(0.0, 0.0, 2.2),
        rotation: Rotation::from_axis_angle(Vec3::X, -core::f32::consts::FRAC_PI_2),
        shapes: vec![ShapeDef::new(Shape::HalfSpace)],
        ..BodyDef::default()
    });
    figure(world, Transform::new(Vec3::new(0.0, 2.2, 0.0), turn), Vec3::Z * speed)
}

#[test]
fn drops_from_one_metre() {
    let mut random = Random::new(1);
    let quarter = core::f32::consts::FRAC_PI_2;
    let turns = [
        Rotation::IDENTITY,
        Rotation::from_axis_angle(Vec3::X, quarter),
        Rotation::from_axis_angle(Vec3::Z, quarter),
        Rotation::from_axis_angle(Vec3::X, 2.0 * quarter),
    ];
    for i in 0..12 {
        let turn = if i < turns.len() { turns[i] } else { random.rotation() };
        let mut figure = dropped(turn, 1.0);
        let report = observe(&mut figure, 8.0);
        assert!(report.gap_max < 1e-4, "drop {i}: {report:?}");
        assert!(report.overshoot_max < 4.0 && report.overshoot_p99 < 2.0, "drop {i}: {report:?}");
        assert!(report.gain < 0.01 && report.penetration_rest < 0.005, "drop {i}: {report:?}");
        assert!(report.asleep.is_some_and(|t| t < 6.0), "drop {i}: {report:?}");
    }
}

#[test]
fn wall_hits() {
    let mut random = Random::new(2);
    for (speed, gap) in [(15.0, 1e-3), (30.0, 1e-2)] {
        for i in 0..10 {
            let turn = if i == 0 { Rotation::IDENTITY } else { random.rotation() };
            let mut figure = thrown_at_a_wall(speed, turn);
            let report = observe(&mut figure, 3.0);
            assert!(report.gap_max < gap, "wall, speed {speed}, run {i}: {report:?}");
            assert!(
                report.overshoot_max < 4.0 && report.overshoot_p99 < 2.0,
                "wall, speed {speed}, run {i}: {report:?}"
            );
            assert!(
                report.gain < 0.01 && report.penetration_rest < 0.005,
                "wall, speed {speed}, run {i}: {report:?}"
            );
        }
    }
}
