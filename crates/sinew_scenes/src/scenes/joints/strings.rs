//! Ropes and chains compared to formulas: a catenary, the modes of a chain.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::GRAVITY;
use sinew::math::{Vec3, min, trig};
use sinew::physics::particles::{GroupDef, ParticleDef, RopeDef, SpringDef};
use sinew::physics::{GroupId, World};

pub(in crate::scenes) const CATENARY: Scene = Scene {
    chapter: Chapter::Joints,
    name: "catenary",
    about: "a rope between two hooks comes to rest as a catenary",
    steps: 600,
    settings: &[Setting::number(
        "length",
        12.0,
        (10.5, 20.0),
        "length of the rope between hooks 10 m apart, m",
    )],
    build: catenary,
};

/// Distance between the hooks, metres.
const SPAN: f32 = 10.0;
const LINKS: u32 = 60;
/// Mass of the rope per length, kg/m.
const LINE_MASS: f32 = 0.1;

fn catenary(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    let length = setup.number("length");
    let rope = RopeDef {
        from: Vec3::ZERO,
        to: Vec3::X * length,
        links: LINKS,
        mass: LINE_MASS * length,
        stiffness: 5.0e4,
        radius: 0.01,
    };
    let mut rope = rope.build();
    // The rope starts in the shape of a V and swings until its drag stops it.
    let depth = (0.25 * (length * length - SPAN * SPAN)).sqrt();
    for (k, p) in rope.group.particles.iter_mut().enumerate() {
        let share = k as f32 / LINKS as f32;
        p.position = Vec3::new(SPAN * share, -depth * (1.0 - (2.0 * share - 1.0).abs()), 0.0);
    }
    rope.group.linear_damping = 2.0;
    rope.group.hold_in_world(&[rope.first, rope.last]);
    let group = world.add_particles(&rope.group);
    Instance::new(world, Hanging { group, length })
}

struct Hanging {
    group: GroupId,
    length: f32,
}

/// The catenary's parameter `a` = horizontal tension over weight per length, metres, from `2 a sinh(d/2a) = L`.
fn parameter(length: f32) -> f32 {
    let half_sum = |x: f32| 0.5 * (trig::exp(x) - trig::exp(-x));
    let (mut low, mut high) = (0.5, 100.0);
    for _ in 0..60 {
        let a = 0.5 * (low + high);
        if 2.0 * a * half_sum(0.5 * SPAN / a) > length { low = a } else { high = a }
    }
    low
}

impl Script for Hanging {
    fn metrics(&self, world: &World) -> Vec<Metric> {
        let group = world.particles(self.group);
        let substep = world.def().dt() / world.def().substeps as f32;
        let pull = group.attachment_impulses()[0] / substep;
        let lowest = group.positions().iter().fold(0.0, |low, p| min(low, p.y));
        let a = parameter(self.length);
        let x = 0.5 * SPAN / a;
        let sag = a * (0.5 * (trig::exp(x) + trig::exp(-x)) - 1.0);
        let angle = trig::atan2(0.5 * self.length, a).to_degrees();
        let tension = LINE_MASS * GRAVITY * (a + sag);
        let found = trig::atan2(-pull.y, pull.x).to_degrees();
        vec![
            Metric::new("sag_m", -lowest, Expected::near(sag, 0.005)),
            Metric::new("end_angle_deg", found, Expected::near(angle, 0.005)),
            Metric::new("end_tension_n", pull.length(), Expected::near(tension, 0.005)),
        ]
    }
}

pub(in crate::scenes) const CHAIN_MODES: Scene = Scene {
    chapter: Chapter::Joints,
    name: "chain_modes",
    about: "masses between springs swing at the frequencies of the chain's modes",
    steps: 600,
    settings: &[],
    build: chain_modes,
};

/// Number of masses in each chain, their mass in kg, stiffness of each spring in N/m.
const MASSES: usize = 10;
const MASS: f32 = 1.0;
const STIFFNESS: f32 = 1000.0;
/// Rest length and hanging length of the springs, metres: without a stretch the weight would fold the lower ones.
const LENGTH: f32 = 0.5;
const STRETCHED: f32 = 0.8;
/// Speed of the swing at its start, m/s.
const SWING: f32 = 0.5;
/// Number of observed modes.
const MODES: usize = 3;

fn chain_modes(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    let chains: Vec<Mode> = (1..=MODES).map(|mode| swinging(&mut world, mode)).collect();
    Instance::new(world, Modes { chains })
}

/// Relative amplitude of mass `i` (from 1) in mode `mode`.
fn shape(mode: usize, i: usize) -> f32 {
    trig::sin(core::f32::consts::PI * (mode * i) as f32 / (MASSES + 1) as f32)
}

/// Depth of mass `i` at rest below the upper hook: the load stretches its springs, `i (N + 1 − i) m g / 2k` lower than
/// without weight.
fn rest(i: usize) -> f32 {
    let sunk = MASS * GRAVITY * (i * (MASSES + 1 - i)) as f32 / (2.0 * STIFFNESS);
    STRETCHED * i as f32 + sunk
}

fn swinging(world: &mut World, mode: usize) -> Mode {
    let x = mode as f32;
    let particle = |i: usize| ParticleDef {
        position: Vec3::new(x, -rest(i), 0.0),
        velocity: Vec3::NEG_Y * (SWING * shape(mode, i)),
        mass: MASS,
        radius: 0.05,
    };
    let spring = |i: usize| SpringDef::new([i as u32, i as u32 + 1], LENGTH, STIFFNESS);
    let mut chain = GroupDef {
        particles: (0..MASSES + 2).map(particle).collect(),
        springs: (0..=MASSES).map(spring).collect(),
        // A step of implicit Euler damps a swing by ω h / 2, so shorter steps damp less.
        iterations: 4,
        ..GroupDef::default()
    };
    chain.hold_in_world(&[0, MASSES as u32 + 1]);
    Mode {
        mode,
        group: world.add_particles(&chain),
        before: 0.0,
        first: None,
        last: 0.0,
        crossings: 0,
        lowest: 0.0,
    }
}

/// A chain, the displacement of its mode, and the times at which it passes its rest position.
struct Mode {
    mode: usize,
    group: GroupId,
    before: f32,
    /// Time of the first pass, seconds.
    first: Option<f64>,
    last: f64,
    crossings: u32,
    /// Sum over the steps of the depth of the chain's central mass below the hook, metres.
    lowest: f32,
}

struct Modes {
    chains: Vec<Mode>,
}

impl Mode {
    fn after_step(&mut self, world: &World) {
        let group = world.particles(self.group);
        let swung =
            (1..=MASSES).map(|i| shape(self.mode, i) * (-group.positions()[i].y - rest(i))).sum::<f32>();
        if self.before < 0.0 && swung >= 0.0 {
            let share = f64::from(swung / (swung - self.before));
            self.last = world.time() - share * f64::from(world.def().dt());
            if self.first.is_none() {
                self.first = Some(self.last);
            } else {
                self.crossings += 1;
            }
        }
        self.before = swung;
        self.lowest += -group.positions()[MASSES / 2].y;
    }

    fn frequency(&self) -> Option<f32> {
        let first = self.first.filter(|_| self.crossings > 0)?;
        Some((f64::from(self.crossings) / (self.last - first)) as f32)
    }
}

impl Script for Modes {
    fn after_step(&mut self, world: &mut World) {
        for chain in &mut self.chains {
            chain.after_step(world);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        const NAMES: [&str; MODES] = ["mode_1_hz", "mode_2_hz", "mode_3_hz"];
        let frequency = |mode: usize| {
            let sin = trig::sin(mode as f32 * core::f32::consts::FRAC_PI_2 / (MASSES + 1) as f32);
            (STIFFNESS / MASS).sqrt() * sin / core::f32::consts::PI
        };
        let mut metrics: Vec<Metric> = self
            .chains
            .iter()
            .map(|chain| {
                let expected = Expected::near(frequency(chain.mode), 0.01);
                Metric::awaited(NAMES[chain.mode - 1], chain.frequency(), expected)
            })
            .collect();
        // Mode 3 oscillates fastest; its mean over many swings is the rest position under gravity.
        let mean = self.chains[MODES - 1].lowest / world.step_count() as f32;
        let sunk = STRETCHED * (MASSES / 2) as f32;
        let expected = Expected::near(rest(MASSES / 2) - sunk, 0.005);
        metrics.push(Metric::new("middle_sunk_m", mean - sunk, expected));
        metrics
    }
}
