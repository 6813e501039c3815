//! Bodies that swing freely: pendulum, double and triple pendulum.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, agm, ball, ghost, hook, join, thin_rod, tilt};
use sinew::math::{Vec3, max, trig};
use sinew::physics::{BodyId, JointId, World};

pub(in crate::scenes) const PENDULUM: Scene = Scene {
    chapter: Chapter::Joints,
    name: "pendulum",
    about: "a ball on a massless rod of 1 m: its period against the elliptic integral",
    steps: 1200,
    settings: &[Setting::number(
        "amplitude",
        0.0,
        (0.0, 170.0),
        "initial angle from the vertical, degrees; 0: 30, 90 and 150, side by side",
    )],
    build: pendulum,
};

const BOB_RADIUS: f32 = 0.04;

fn pendulum(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let amplitude = setup.number("amplitude");
    let swings = if amplitude > 0.0 {
        vec![("period_s", amplitude)]
    } else {
        vec![("period_30_s", 30.0), ("period_90_s", 90.0), ("period_150_s", 150.0)]
    };
    let swings = swings.into_iter().enumerate();
    let bobs = swings.map(|(i, (name, amplitude))| Bob::hang(&mut world, name, amplitude, i)).collect();
    Instance::new(world, Pendulums { bobs })
}

struct Bob {
    /// Name of the metric for the pendulum's period.
    name: &'static str,
    id: BodyId,
    joint: JointId,
    amplitude: f32,
    /// Energy at the start, J.
    start: f32,
    /// Largest difference of the energy from the start, J.
    drift: f32,
    /// Energy for one metre of height, J.
    depth: f32,
    /// Position along x in the last step.
    before: f32,
    /// Times of the first and of the last pass through the lowest point toward −x.
    passes: [Option<f32>; 2],
    /// Number of passes.
    count: u32,
    gap: f32,
}

/// Period `2π √(l/g) · 2 K(sin(θ/2)) / π` for a rod of 1 m and an amplitude in degrees; the bob of `radius` metres is
/// fixed to the rod, a compound pendulum of moment `m (l² + 0.4 r²)`.
pub(in crate::scenes) fn pendulum_period(amplitude: f32, radius: f32) -> f64 {
    let mean = agm(1.0, f64::from(trig::cos(0.5 * amplitude.to_radians())));
    let radius = f64::from(radius);
    core::f64::consts::TAU * ((1.0 + 0.4 * radius * radius) / f64::from(GRAVITY)).sqrt() / mean
}

impl Bob {
    /// Adds pendulum `index` beside the others.
    fn hang(world: &mut World, name: &'static str, amplitude: f32, index: usize) -> Self {
        let pivot = Vec3::Z * index as f32;
        let mut hook = hook();
        hook.position = pivot;
        let hook = world.add_body(&hook);
        let bob = ghost(ball(BOB_RADIUS, pivot + tilt(amplitude) * Vec3::NEG_Y));
        let id = world.add_body(&bob);
        let joint = join(world, hook, id, pivot);
        let start = world.body_energy(id).total();
        let depth = GRAVITY * world.mass(id).mass;
        let (passes, before) = ([None; 2], 1.0);
        Self { name, id, joint, amplitude, start, drift: 0.0, depth, before, passes, count: 0, gap: 0.0 }
    }

    fn after_step(&mut self, world: &World) {
        self.gap = max(self.gap, world.joint_gap(self.joint));
        self.drift = max(self.drift, (world.body_energy(self.id).total() - self.start).abs());
        let x = world.transform(self.id).translation.x;
        if self.before > 0.0 && x <= 0.0 {
            let ago = x / (x - self.before);
            let now = world.time() as f32 - ago * world.def().dt();
            self.passes = [self.passes[0].or(Some(now)), Some(now)];
            self.count += 1;
        }
        self.before = x;
    }

    fn period(&self) -> Metric {
        let period = match self.passes {
            [Some(first), Some(last)] if self.count > 1 => Some((last - first) / (self.count - 1) as f32),
            _ => None,
        };
        Metric::awaited(self.name, period, Expected::near(pendulum_period(self.amplitude, BOB_RADIUS), 0.001))
    }
}

struct Pendulums {
    bobs: Vec<Bob>,
}

impl Script for Pendulums {
    fn after_step(&mut self, world: &mut World) {
        for bob in &mut self.bobs {
            bob.after_step(world);
        }
    }

    fn metrics(&self, _: &World) -> Vec<Metric> {
        let worst = |figure: &dyn Fn(&Bob) -> f32| self.bobs.iter().map(figure).fold(0.0, max);
        let mut metrics: Vec<_> = self.bobs.iter().map(Bob::period).collect();
        metrics.extend([
            Metric::new("energy_drift", worst(&|bob| bob.drift / bob.depth), Expected::AtMost(0.01)),
            Metric::new("joint_gap_max_m", worst(&|bob| bob.gap), Expected::AtMost(1e-3)),
        ]);
        metrics
    }
}

pub(in crate::scenes) const DOUBLE_PENDULUM: Scene = Scene {
    chapter: Chapter::Joints,
    name: "double_pendulum",
    about: "a double pendulum released from the horizontal keeps its energy for a minute",
    steps: 3600,
    settings: &[],
    // Angular accelerations, from `[4/3 1/2; 1/2 1/3] α = g/l [3/2; 1/2]` (Lagrange).
    build: |setup| rods(setup, &[9.0 / 7.0, -3.0 / 7.0]),
};

pub(in crate::scenes) const TRIPLE_PENDULUM: Scene = Scene {
    chapter: Chapter::Joints,
    name: "triple_pendulum",
    about: "a triple pendulum released from the horizontal keeps its energy for a minute",
    steps: 3600,
    settings: &[],
    // Angular accelerations, from `[7/3 3/2 1/2; 3/2 4/3 1/2; 1/2 1/2 1/3] α = g/l [5/2; 3/2; 1/2]`.
    build: |setup| rods(setup, &[33.0 / 26.0, -9.0 / 26.0, 3.0 / 26.0]),
};

/// Length of a rod, metres.
const ROD_LENGTH: f32 = 1.0;
/// Mass of a rod, kg.
const ROD_MASS: f32 = 1.0;

/// Level rods end to end, with their initial angular accelerations, downward, in g/l.
fn rods(setup: &Setup<'_>, starts: &'static [f32]) -> Instance {
    let mut world = setup.sleepless_world();
    let mut last = world.add_body(&hook());
    let mut rods = Vec::new();
    let mut joints = Vec::new();
    for i in 0..starts.len() {
        let at = ROD_LENGTH * i as f32;
        let rod = world.add_body(&thin_rod(at, ROD_LENGTH, ROD_MASS));
        joints.push(join(&mut world, last, rod, Vec3::X * at));
        rods.push(rod);
        last = rod;
    }
    let start = world.energy().total();
    Instance::new(world, Rods { rods, joints, starts, start, drift: 0.0, first: Vec::new(), gap: 0.0 })
}

struct Rods {
    rods: Vec<BodyId>,
    joints: Vec<JointId>,
    starts: &'static [f32],
    /// Energy at the start, J.
    start: f32,
    /// Largest difference of the energy from the start, J.
    drift: f32,
    /// Angular accelerations in the first step, rad/s², downward.
    first: Vec<f32>,
    gap: f32,
}

impl Script for Rods {
    fn after_step(&mut self, world: &mut World) {
        self.gap = self.joints.iter().fold(self.gap, |gap, &joint| max(gap, world.joint_gap(joint)));
        self.drift = max(self.drift, (world.energy().total() - self.start).abs());
        if world.step_count() == 1 {
            let dt = world.def().dt();
            self.first = self.rods.iter().map(|&rod| -world.velocity(rod).angular.z / dt).collect();
        }
    }

    fn metrics(&self, _: &World) -> Vec<Metric> {
        let count = self.rods.len() as f32;
        // From horizontal to vertical, the centre of rod i falls by (i + ½) l.
        let depth = 0.5 * count * count * ROD_MASS * GRAVITY * ROD_LENGTH;
        let names = ["first_rad_s2", "second_rad_s2", "third_rad_s2"];
        let mut metrics: Vec<_> = names
            .into_iter()
            .zip(self.starts)
            .enumerate()
            .map(|(i, (name, start))| {
                let expected = Expected::near(start * GRAVITY / ROD_LENGTH, 0.005);
                Metric::awaited(name, self.first.get(i).copied(), expected)
            })
            .collect();
        metrics.extend([
            Metric::new("energy_drift", self.drift / depth, Expected::AtMost(0.01)),
            Metric::new("joint_gap_max_m", self.gap, Expected::AtMost(1e-3)),
        ]);
        metrics
    }
}
