//! Kinds of joints at work, side by side: a linkage, a slider-crank, a joint that breaks, a rope, a rod.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, ball, floor, ghost, hinge, hook, thin_rod_between};
use sinew::math::{Range, Transform, Vec3, max, trig};
use sinew::physics::{BodyId, JointDef, JointId, JointKind, JointState, Motor, Strength, Velocity, World};

pub(in crate::scenes) const LINKAGE: Scene = Scene {
    chapter: Chapter::Joints,
    name: "linkage",
    about: "four bars in a loop, a motor on a slider-crank, a joint that breaks, a rope and a rod",
    steps: 600,
    settings: &[
        Setting::number("speed", 3.0, (0.1, 20.0), "angular velocity of the crank, rad/s"),
        Setting::number("strength", 100.0, (79.0, 120.0), "strength of the joint that breaks, N"),
    ],
    build: linkage,
};

/// Height of all hooks, metres.
const HEIGHT: f32 = 3.0;

fn linkage(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    world.add_body(&floor());
    let hook = world.add_body(&hook());
    let at = |x: f32| Vec3::new(x, HEIGHT, 0.0);
    let bars = FourBars::hang(&mut world, hook, at(-3.0));
    let crank = Crank::turn(&mut world, hook, at(-0.5), setup.number("speed"));
    let overloaded = Overloaded::hang(&mut world, hook, at(2.0), setup.number("strength"));
    let rope = Tied::to(&mut world, hook, at(3.0), Vec3::NEG_Y * 0.4, Range::new(0.0, ROPE));
    let rod = Tied::to(&mut world, hook, at(5.0), Vec3::X * ROPE, Range::new(ROPE, ROPE));
    let rod_start = world.body_energy(rod.body).total();
    Instance::new(world, Linkage { bars, crank, overloaded, rope, rod, rod_start, rod_drift: 0.0, gap: 0.0 })
}

/// A parallelogram that swings below its fixed upper bar: three bars, four hinges, one loop.
struct FourBars {
    bars: [BodyId; 3],
    hinges: [JointId; 4],
    /// Energy at the start, J.
    start: f32,
    /// Largest deviation of the energy from the start, J.
    drift: f32,
    /// Largest angle of the lower bar from the horizontal, radians.
    tilt: f32,
}

/// Mass of each bar, kg; each is 1 m long.
const BAR_MASS: f32 = 1.0;

impl FourBars {
    fn hang(world: &mut World, hook: BodyId, left_top: Vec3) -> Self {
        let [right_top, left, right] = [Vec3::X, Vec3::NEG_Y, Vec3::X + Vec3::NEG_Y].map(|v| left_top + v);
        let ends = [(left_top, left), (right_top, right), (left, right)];
        let [a, b, low] = ends.map(|(from, to)| world.add_body(&thin_rod_between(from, to, BAR_MASS)));
        let hinges = [(hook, a, left_top), (hook, b, right_top), (a, low, left), (b, low, right)];
        let hinges = hinges.map(|(p, q, at)| hinge_about_z(world, p, q, at));
        // The bars swing out at 1.5 rad/s.
        let swing = Vec3::Z * 1.5;
        for (bar, top) in [(a, left_top), (b, right_top)] {
            let linear = swing.cross(world.center_of_mass(bar) - top);
            world.set_velocity(bar, Velocity { linear, angular: swing });
        }
        world.set_velocity(low, Velocity { linear: swing.cross(Vec3::NEG_Y), angular: Vec3::ZERO });
        let mut new = Self { bars: [a, b, low], hinges, start: 0.0, drift: 0.0, tilt: 0.0 };
        new.start = new.energy(world);
        new
    }

    fn energy(&self, world: &World) -> f32 {
        self.bars.iter().map(|&bar| world.body_energy(bar).total()).sum()
    }

    fn after_step(&mut self, world: &World) {
        self.drift = max(self.drift, (self.energy(world) - self.start).abs());
        let [.., low] = self.bars;
        self.tilt = max(self.tilt, (world.transform(low).rotation * Vec3::Y).y.abs());
    }

    fn metrics(&self) -> [Metric; 2] {
        // The lower bar rises from its lowest point to the height of the hooks; the others rise half as much.
        let depth = 2.0 * BAR_MASS * GRAVITY;
        [
            Metric::new("four_bar_energy_drift", self.drift / depth, Expected::AtMost(0.01)),
            Metric::new("four_bar_tilt_rad", self.tilt, Expected::AtMost(1e-3)),
        ]
    }
}

fn hinge_about_z(world: &mut World, a: BodyId, b: BodyId, at: Vec3) -> JointId {
    let def = hinge(world, a, b, at, Vec3::Z);
    world.add_joint(&def)
}

/// A motor turns a crank, whose rod moves a piston back and forth.
struct Crank {
    axle: Vec3,
    piston: BodyId,
    motor: JointId,
    hinges: [JointId; 4],
    /// Angular velocity of the crank, rad/s.
    speed: f32,
    /// Largest deviation of the piston from its expected position, metres.
    error: f32,
    /// Work of the motor, J.
    work_in: f32,
}

/// Length of the crank, metres.
const CRANK: f32 = 0.3;
/// Length of the connecting rod, metres.
const CONNECTING_ROD: f32 = 1.0;

impl Crank {
    fn turn(world: &mut World, hook: BodyId, axle: Vec3, speed: f32) -> Self {
        let (pin, end) = (axle + Vec3::X * CRANK, axle + Vec3::X * (CRANK + CONNECTING_ROD));
        let crank = world.add_body(&thin_rod_between(axle, pin, 0.5));
        let rod = world.add_body(&thin_rod_between(pin, end, 0.5));
        let piston = world.add_body(&ghost(ball(0.06, end)));
        let driven = hinge(world, hook, crank, axle, Vec3::Z);
        let motor = world.add_joint(&JointDef { motor: Some(Motor::spin(speed, 1000.0)), ..driven });
        let pose = |id| world.transform(id);
        let (slot, kind) = (Transform::from_translation(end), JointKind::Slider { limit: None });
        let slider = JointDef::new(hook, piston, pose(hook), pose(piston), slot, kind);
        let hinges = [
            motor,
            hinge_about_z(world, crank, rod, pin),
            hinge_about_z(world, rod, piston, end),
            world.add_joint(&slider),
        ];
        // At the crank's dead centre the rod rotates about the piston, which rests.
        let linear = Vec3::Y * (0.5 * speed * CRANK);
        world.set_velocity(crank, Velocity { linear, angular: Vec3::Z * speed });
        world.set_velocity(rod, Velocity { linear, angular: Vec3::NEG_Z * (speed * CRANK / CONNECTING_ROD) });
        Self { axle, piston, motor, hinges, speed, error: 0.0, work_in: 0.0 }
    }

    fn after_step(&mut self, world: &World) {
        let (sin, cos) = trig::sin_cos(self.speed * world.time() as f32);
        let (along, off) = (CRANK * cos, CRANK * sin);
        let expected = along + (CONNECTING_ROD * CONNECTING_ROD - off * off).sqrt();
        let found = world.center_of_mass(self.piston) - self.axle;
        self.error = max(self.error, (found - Vec3::X * expected).length());
        self.work_in += world.reaction(self.motor).torque.z * self.speed * world.def().dt();
    }

    fn metrics(&self) -> [Metric; 1] {
        [Metric::new("piston_error_m", self.error, Expected::AtMost(1e-3))]
    }
}

/// A weight on a joint whose load grows until it breaks.
struct Overloaded {
    weight: BodyId,
    joint: JointId,
    /// Strength of the joint, N.
    strength: f32,
    /// Load of the joint by the weight and the pull in the step in which the joint broke, N.
    broken_at: Option<f32>,
}

/// Mass of the weight, kg.
const WEIGHT: f32 = 8.0;
/// Growth rate of the pull, N/s.
const PULL_RATE: f32 = 5.0;

impl Overloaded {
    fn hang(world: &mut World, hook: BodyId, at: Vec3, strength: f32) -> Self {
        let mut def = ball(0.15, at + Vec3::NEG_Y * 0.5);
        let shape = def.shapes[0].shape.mass_properties(1.0);
        def.mass = Some(shape.scaled_to(WEIGHT));
        let weight = world.add_body(&def);
        let pose = |id| world.transform(id);
        let kind = JointKind::Ball { limit: None };
        let joint =
            JointDef::new(hook, weight, pose(hook), pose(weight), Transform::from_translation(at), kind);
        let strength_of_joint = Strength { force: strength, ..Strength::UNBREAKABLE };
        let joint = world.add_joint(&JointDef { strength: strength_of_joint, ..joint });
        Self { weight, joint, strength, broken_at: None }
    }

    fn after_step(&mut self, world: &mut World) {
        if world.joint(self.joint).state == JointState::Enabled {
            let pull = Vec3::NEG_Y * (PULL_RATE * world.time() as f32);
            world.apply_force(self.weight, pull, world.center_of_mass(self.weight));
        } else if self.broken_at.is_none() {
            let pulled_since = world.time() as f32 - world.def().dt();
            self.broken_at = Some(WEIGHT * GRAVITY + PULL_RATE * pulled_since);
        }
    }

    fn metrics(&self) -> [Metric; 1] {
        // The pull grows by 0.08 N a step.
        let expected = Expected::Near { value: f64::from(self.strength), tolerance: 0.2 };
        [Metric::awaited("breaking_load_n", self.broken_at, expected)]
    }
}

/// A ball at a limited distance from a hook.
struct Tied {
    body: BodyId,
    joint: JointId,
}

/// Length of rope and rod, metres.
const ROPE: f32 = 1.5;

impl Tied {
    fn to(world: &mut World, hook: BodyId, at: Vec3, from_there: Vec3, range: Range) -> Self {
        let body = world.add_body(&ghost(ball(0.08, at + from_there)));
        let kind = JointKind::Distance { range };
        let joint = JointDef::between(hook, body, Transform::from_translation(at), Transform::IDENTITY, kind);
        Self { body, joint: world.add_joint(&joint) }
    }
}

struct Linkage {
    bars: FourBars,
    crank: Crank,
    overloaded: Overloaded,
    rope: Tied,
    rod: Tied,
    /// Energy of the ball on the rod, J.
    rod_start: f32,
    /// Largest deviation of the energy from the start, J.
    rod_drift: f32,
    gap: f32,
}

impl Script for Linkage {
    fn after_step(&mut self, world: &mut World) {
        let joints =
            self.bars.hinges.iter().chain(&self.crank.hinges).chain([&self.rope.joint, &self.rod.joint]);
        self.gap = joints.fold(self.gap, |gap, &joint| max(gap, world.joint_gap(joint)));
        self.rod_drift =
            max(self.rod_drift, (world.body_energy(self.rod.body).total() - self.rod_start).abs());
        self.bars.after_step(world);
        self.crank.after_step(world);
        self.overloaded.after_step(world);
    }

    fn work_in(&self, _: &World) -> f32 {
        self.crank.work_in
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let weight = |tied: &Tied| world.mass(tied.body).mass * GRAVITY;
        let rope = world.reaction(self.rope.joint).force.y / weight(&self.rope);
        let rod = self.rod_drift / (weight(&self.rod) * ROPE);
        let mut metrics = Vec::new();
        metrics.extend(self.bars.metrics());
        metrics.extend(self.crank.metrics());
        metrics.extend(self.overloaded.metrics());
        metrics.extend([
            Metric::new("rope_load", rope, Expected::near(1.0, 0.001)),
            Metric::new("rod_energy_drift", rod, Expected::AtMost(0.01)),
            Metric::new("joint_gap_max_m", self.gap, Expected::AtMost(1e-3)),
            Metric::new("work_in_j", self.crank.work_in, Expected::Anything),
        ]);
        metrics
    }
}
