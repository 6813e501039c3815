//! Things that swing: pendulum, double pendulum, chain.

use super::metric::{Expected, Metric};
use super::parts::{GRAVITY, ball, ghost, hook, join, level_rod, mass, tilt};
use super::{Instance, Scene, Script, Setting, Setup};
use sinew::math::{Sym3, Vec3, max, trig};
use sinew::physics::{BodyId, JointId, MassProperties, World};

pub(super) const PENDULUM: Scene = Scene {
    name: "pendulum",
    about: "a ball on a massless rod of 1 m: its period against the elliptic integral",
    steps: 900,
    settings: &[Setting::number("amplitude", 90.0, (1.0, 170.0), "from the vertical, degrees")],
    build: pendulum,
};

const BOB_RADIUS: f32 = 0.04;

fn pendulum(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let amplitude = setup.number("amplitude");
    let hook = world.add_body(&hook());
    let bob = world.add_body(&ghost(ball(BOB_RADIUS, tilt(amplitude) * Vec3::NEG_Y)));
    let joint = join(&mut world, hook, bob, Vec3::ZERO);
    let start = world.energy().total();
    let depth = GRAVITY * world.mass(bob).mass;
    Instance::new(
        world,
        Pendulum { bob, joint, amplitude, start, depth, before: 1.0, passes: [None; 2], count: 0, gap: 0.0 },
    )
}

struct Pendulum {
    bob: BodyId,
    joint: JointId,
    amplitude: f32,
    start: f32,
    /// Energy of the bob for one metre of height, J.
    depth: f32,
    /// x one step ago.
    before: f32,
    /// Times of the first and of the last pass through the lowest point toward −x.
    passes: [Option<f32>; 2],
    /// Number of passes.
    count: u32,
    gap: f32,
}

/// `2π √(l/g) · 2 K(sin(θ/2)) / π`, with `K` by the arithmetic-geometric mean (Gauss); the bob is fixed to its rod, a
/// compound pendulum of moment `m (l² + 0.4 r²)`.
fn pendulum_period(amplitude: f32) -> f64 {
    let (mut a, mut b) = (1.0, f64::from(trig::cos(0.5 * amplitude.to_radians())));
    for _ in 0..6 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    let radius = f64::from(BOB_RADIUS);
    core::f64::consts::TAU * ((1.0 + 0.4 * radius * radius) / f64::from(GRAVITY)).sqrt() / a
}

impl Script for Pendulum {
    fn after_step(&mut self, world: &mut World) {
        self.gap = max(self.gap, world.joint_gap(self.joint));
        let x = world.transform(self.bob).translation.x;
        if self.before > 0.0 && x <= 0.0 {
            let ago = x / (x - self.before);
            let now = world.time() as f32 - ago * world.def().dt();
            self.passes = [self.passes[0].or(Some(now)), Some(now)];
            self.count += 1;
        }
        self.before = x;
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let period = match self.passes {
            [Some(first), Some(last)] if self.count > 1 => Some((last - first) / (self.count - 1) as f32),
            _ => None,
        };
        let drift = (world.energy().total() - self.start) / self.depth;
        vec![
            Metric::awaited("period_s", period, Expected::near(pendulum_period(self.amplitude), 0.003)),
            Metric::new("energy_drift", drift.abs(), Expected::AtMost(0.01)),
            Metric::new("joint_gap_max_m", self.gap, Expected::AtMost(1e-3)),
        ]
    }
}

pub(super) const DOUBLE_PENDULUM: Scene = Scene {
    name: "double_pendulum",
    about: "two rods let go from the horizontal keep their energy",
    steps: 1200,
    settings: &[],
    build: double_pendulum,
};

/// Metres.
const ROD_LENGTH: f32 = 1.0;
/// kg.
const ROD_MASS: f32 = 1.0;

fn double_pendulum(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let mut last = world.add_body(&hook());
    let mut rods = Vec::new();
    let mut joints = Vec::new();
    for i in 0..2 {
        let at = ROD_LENGTH * i as f32;
        let mut def = level_rod(at, ROD_LENGTH, 0.03);
        // A thin rod, m l²/12, whatever it looks like.
        let moment = ROD_MASS * ROD_LENGTH * ROD_LENGTH / 12.0;
        let inertia = Sym3::from_diagonal(Vec3::new(moment, 0.02 * moment, moment));
        def.mass = Some(MassProperties { mass: ROD_MASS, center: Vec3::ZERO, inertia });
        let rod = world.add_body(&def);
        joints.push(join(&mut world, last, rod, Vec3::X * at));
        rods.push(rod);
        last = rod;
    }
    let start = world.energy().total();
    Instance::new(
        world,
        DoublePendulum { rods: [rods[0], rods[1]], joints, start, first: [None; 2], gap: 0.0 },
    )
}

struct DoublePendulum {
    rods: [BodyId; 2],
    joints: Vec<JointId>,
    start: f32,
    /// Angular accelerations in the first step, rad/s², downward.
    first: [Option<f32>; 2],
    gap: f32,
}

impl Script for DoublePendulum {
    fn after_step(&mut self, world: &mut World) {
        self.gap = largest_gap(self.gap, &self.joints, world);
        if world.step_count() == 1 {
            let dt = world.def().dt();
            self.first = self.rods.map(|rod| Some(-world.velocity(rod).angular.z / dt));
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let depth = 2.0 * ROD_MASS * GRAVITY * ROD_LENGTH;
        let drift = (world.energy().total() - self.start) / depth;
        // Lagrange's equations of two equal rods, both level and at rest: `[4/3 1/2; 1/2 1/3] α = g/l [3/2; 1/2]`.
        let unit = GRAVITY / ROD_LENGTH / 7.0;
        vec![
            Metric::awaited("first_rad_s2", self.first[0], Expected::near(9.0 * unit, 0.005)),
            Metric::awaited("second_rad_s2", self.first[1], Expected::near(-3.0 * unit, 0.005)),
            Metric::new("energy_drift", drift.abs(), Expected::AtMost(0.01)),
            Metric::new("joint_gap_max_m", self.gap, Expected::AtMost(1e-3)),
        ]
    }
}

fn largest_gap(before: f32, joints: &[JointId], world: &World) -> f32 {
    joints.iter().fold(before, |gap, &joint| max(gap, world.joint_gap(joint)))
}

pub(super) const CHAIN: Scene = Scene {
    name: "chain",
    about: "a weight on a chain of light links swings from the horizontal, and no joint opens",
    steps: 240,
    settings: &[
        Setting::whole("links", 10, (1, 200), "number of links"),
        Setting::number("ratio", 1000.0, (1.0, 100_000.0), "mass of the weight over that of a link"),
    ],
    build: chain,
};

/// Metres.
const LINK_LENGTH: f32 = 1.0;
/// kg.
const LINK_MASS: f32 = 1.0;

fn chain(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let (links, ratio) = (setup.whole("links"), setup.number("ratio"));
    let mut last = world.add_body(&hook());
    let mut joints = Vec::new();
    for i in 0..links {
        let at = i as f32 * LINK_LENGTH;
        let mut def = level_rod(at, LINK_LENGTH, 0.05);
        def.mass = Some(mass(LINK_MASS, 0.1 * LINK_MASS * LINK_LENGTH * LINK_LENGTH));
        let link = world.add_body(&def);
        joints.push(join(&mut world, last, link, Vec3::X * at));
        last = link;
    }
    let length = links as f32 * LINK_LENGTH;
    let radius = 0.25 * LINK_LENGTH;
    let weight_mass = ratio * LINK_MASS;
    let mut def = ghost(ball(radius, Vec3::X * length));
    def.mass = Some(mass(weight_mass, 0.4 * weight_mass * radius * radius));
    let weight = world.add_body(&def);
    joints.push(join(&mut world, last, weight, Vec3::X * length));
    let start = world.energy().total();
    let depth = weight_mass * GRAVITY * length;
    Instance::new(world, Chain { weight, joints, start, depth, gap: 0.0, first: None, ratio })
}

struct Chain {
    weight: BodyId,
    joints: Vec<JointId>,
    start: f32,
    /// Energy that the weight loses from the horizontal to the lowest point, J.
    depth: f32,
    gap: f32,
    /// Downward acceleration of the weight in the first step, m/s².
    first: Option<f32>,
    /// Mass of the weight over that of a link.
    ratio: f32,
}

impl Script for Chain {
    fn after_step(&mut self, world: &mut World) {
        self.gap = largest_gap(self.gap, &self.joints, world);
        if world.step_count() == 1 {
            self.first = Some(-world.velocity(self.weight).linear.y / world.def().dt());
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let change = (world.energy().total() - self.start) / self.depth;
        // Level and at rest, the chain bears nothing of the weight, but for a share of what it weighs itself.
        let bound = f64::from(0.002 + 1.0 / self.ratio);
        vec![
            Metric::new("joint_gap_max_m", self.gap, Expected::AtMost(1e-3)),
            Metric::awaited("first_m_s2", self.first, Expected::near(GRAVITY, bound)),
            Metric::new("energy_change", change, Expected::Near { value: 0.0, tolerance: 0.02 }),
        ]
    }
}
