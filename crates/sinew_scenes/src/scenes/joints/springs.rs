//! Particles and springs: a mass on a spring, a chain of them, a rope over a box.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, cuboid, floor};
use sinew::math::{Vec3, max, min};
use sinew::physics::particles::{
    AttachmentDef, AttachmentTarget, GroupDef, ParticleDef, ParticleGroup, Resists, RopeDef, SpringDef,
};
use sinew::physics::{BodyId, GroupId, World};

pub(in crate::scenes) const SPRING: Scene = Scene {
    chapter: Chapter::Joints,
    name: "spring",
    about: "a mass on a spring comes to rest at a stretch of m g / k",
    steps: 600,
    settings: &[Setting::whole("masses", 1, (1, 50), "number of masses below each other"), MASS, STIFFNESS],
    build: hung_alike,
};

pub(in crate::scenes) const SPRING_CHAIN: Scene = Scene {
    chapter: Chapter::Joints,
    name: "spring_chain",
    about: "the weight below it stretches each spring of a hanging chain",
    steps: 900,
    settings: &[Setting::whole("masses", 10, (1, 50), "number of masses below each other"), MASS, STIFFNESS],
    build: hung_alike,
};

pub(in crate::scenes) const SPRINGS_RATIO: Scene = Scene {
    chapter: Chapter::Joints,
    name: "springs_ratio",
    about: "springs of 1,000 and 1,000,000 N/m in one hanging chain stretch by their closed forms",
    steps: 900,
    settings: &[],
    build: |setup| {
        let stiffness = |i: usize| if i.is_multiple_of(2) { 1e6 } else { 1e3 };
        hung(setup, 1.0, &(0..8).map(stiffness).collect::<Vec<_>>())
    },
};

const MASS: Setting = Setting::number("mass", 1.0, (0.001, 100.0), "of each, kg");
const STIFFNESS: Setting = Setting::number("stiffness", 1000.0, (10.0, 1e6), "stiffness of each spring, N/m");

/// Rest length of each spring, metres.
const LENGTH: f32 = 0.2;

fn hung_alike(setup: &Setup<'_>) -> Instance {
    hung(setup, setup.number("mass"), &vec![setup.number("stiffness"); setup.whole("masses")])
}

/// Creates a hanging chain of as many masses as springs; stiffnesses from above.
fn hung(setup: &Setup<'_>, mass: f32, stiffnesses: &[f32]) -> Instance {
    let mut world = setup.world();
    let particle = |i: usize| ParticleDef {
        position: Vec3::NEG_Y * (LENGTH * i as f32),
        velocity: Vec3::ZERO,
        mass,
        radius: 0.02,
    };
    let spring = |(i, &stiffness): (usize, &f32)| SpringDef {
        a: i as u32,
        b: i as u32 + 1,
        rest_length: LENGTH,
        stiffness,
        // A fifth of the critical damping of one mass on one spring.
        damping: 0.4 * (mass * stiffness).sqrt(),
        resists: Resists::Both,
    };
    let springs: Vec<_> = stiffnesses.iter().enumerate().map(spring).collect();
    let group = world.add_particles(&GroupDef {
        particles: (0..=springs.len()).map(particle).collect(),
        springs,
        attachments: vec![AttachmentDef { particle: 0, target: AttachmentTarget::World(Vec3::ZERO) }],
        // The slowest mode of a long chain stretches its springs too slowly to be damped by them.
        linear_damping: 2.0,
        ..GroupDef::default()
    });
    let hanging = |i: usize| (stiffnesses.len() - i) as f32 * mass * GRAVITY;
    let stretches = stiffnesses.iter().enumerate().map(|(i, stiffness)| hanging(i) / stiffness).collect();
    Instance::new(world, Hung { group, stretches })
}

struct Hung {
    group: GroupId,
    /// Expected stretch of each spring, metres: the weight below it divided by `k`.
    stretches: Vec<f32>,
}

impl Script for Hung {
    fn metrics(&self, world: &World) -> Vec<Metric> {
        let group = world.particles(self.group);
        let springs = 0..group.springs().len();
        let found: f32 = springs.clone().map(|i| group.stretch(i)).sum();
        let gaps = springs.zip(&self.stretches).map(|(i, right)| group.stretch(i) - right);
        let worst = gaps.fold(0.0, |worst, gap| max(worst, gap.abs()));
        vec![
            Metric::new("stretch_m", found, Expected::near(self.stretches.iter().sum::<f32>(), 1e-3)),
            Metric::new("gap_per_link", worst / LENGTH, Expected::AtMost(0.005)),
            Metric::new("fastest_m_s", fastest(group), Expected::Anything),
        ]
    }
}

fn fastest(group: &ParticleGroup) -> f32 {
    group.velocities().iter().fold(0.0, |most, v| max(most, v.length()))
}

pub(in crate::scenes) const ROPE_ON_BOX: Scene = Scene {
    chapter: Chapter::Joints,
    name: "rope_on_box",
    about: "a rope falls onto a box and hangs over its edges",
    steps: 600,
    settings: &[
        Setting::whole("links", 24, (2, 400), "number of springs"),
        Setting::number("mass", 1.0, (0.01, 50.0), "mass of the rope, kg"),
        Setting::number("length", 1.2, (0.2, 5.0), "length of the rope, m"),
    ],
    build: rope_on_box,
};

/// Half extent of the box, metres.
const HALF: f32 = 0.25;
const ROPE_RADIUS: f32 = 0.01;
/// Height at which the rope starts, metres.
const HEIGHT: f32 = 0.8;
/// Least number of steps in which the rope falls freely.
const FALLING: u64 = 6;

fn rope_on_box(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let mut block = cuboid(Vec3::splat(HALF), Vec3::Y * HALF);
    // The box has only 5 kg, so that the rope could push it.
    block.shapes[0].density = 40.0;
    let block = world.add_body(&block);
    let (length, middle) = (setup.number("length"), Vec3::new(0.0, HEIGHT, 0.02));
    let rope = world.add_particles(
        &RopeDef {
            from: middle - Vec3::X * (0.5 * length),
            to: middle + Vec3::X * (0.5 * length),
            links: setup.whole("links") as u32,
            mass: setup.number("mass"),
            stiffness: 2000.0,
            radius: ROPE_RADIUS,
        }
        .build()
        .group,
    );
    Instance::new(world, Rope { block, rope, fall: None })
}

struct Rope {
    block: BodyId,
    rope: GroupId,
    fall: Option<f32>,
}

impl Script for Rope {
    fn after_step(&mut self, world: &mut World) {
        if world.step_count() == FALLING {
            self.fall = Some(-world.particles(self.rope).velocities()[0].y / world.time() as f32);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let rope = world.particles(self.rope);
        let (mut lowest, mut highest) = (f32::INFINITY, f32::NEG_INFINITY);
        for p in rope.positions() {
            (lowest, highest) = (min(lowest, p.y), max(highest, p.y));
        }
        let pushed = (world.center_of_mass(self.block) - Vec3::Y * HALF).length();
        let on_top = Expected::Near { value: f64::from(2.0 * HALF + ROPE_RADIUS), tolerance: 0.01 };
        vec![
            Metric::awaited("fall_m_s2", self.fall, Expected::near(GRAVITY, 1e-3)),
            Metric::new("highest_m", highest, on_top),
            Metric::new("fallen_through_m", max(-lowest, 0.0), Expected::AtMost(0.0)),
            Metric::new("fastest_m_s", fastest(rope), Expected::AtMost(0.02)),
            Metric::new("box_pushed_m", pushed, Expected::AtMost(0.01)),
        ]
    }
}
