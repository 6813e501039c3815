//! Elastic impacts: pairs, Newton's cradle, balls that bounce for ever.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::weightless_world;
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, ball, floor, hook, join, made_of, tilt};
use crate::scenes::joints::pendulums::pendulum_period;
use sinew::math::{Vec3, max};
use sinew::physics::{BodyDef, BodyId, Material, Sleeping, World, WorldDef};

const ELASTIC: Material = Material { friction: 0.0, restitution: 1.0, ..Material::DEFAULT };

/// A ball of a mass in kg without energy loss in impacts.
fn elastic_ball(mass: f32, radius: f32, position: Vec3) -> BodyDef {
    let mut def = made_of(ball(radius, position), ELASTIC);
    def.shapes[0].density = mass / (4.0 / 3.0 * core::f32::consts::PI * radius * radius * radius);
    def
}

pub(in crate::scenes) const ELASTIC_PAIRS: Scene = Scene {
    chapter: Chapter::Contacts,
    name: "elastic_pairs",
    about: "balls of 1 kg hit balls of 1, 3 and 100 kg head-on without energy loss; one hits a row of four",
    steps: 60,
    settings: &[],
    build: elastic_pairs,
};

/// Velocities before the hits, m/s.
const SPEEDS: [f32; 2] = [4.0, -1.0];
const PAIR_RADIUS: f32 = 0.1;
/// Mass of the second ball, kg (the first has 1 kg), with the names of the metrics that are the speeds after the hit.
const PAIRS: [(f32, [&str; 2]); 3] = [
    (1.0, ["first_of_equal_m_s", "second_of_equal_m_s"]),
    (3.0, ["first_at_3_m_s", "second_at_3_m_s"]),
    (100.0, ["first_at_100_m_s", "second_at_100_m_s"]),
];
/// Gap between balls of a row, metres: more than the fastest ball moves in a substep, so that the impacts are
/// sequential.
const ROW_GAP: f32 = 0.02;

fn elastic_pairs(_: &Setup<'_>) -> Instance {
    let mut world = weightless_world();
    let mut moving = |mass: f32, place: Vec3, speed: f32| {
        let mut def = elastic_ball(mass, PAIR_RADIUS, place);
        def.linear_velocity = Vec3::X * speed;
        world.add_body(&def)
    };
    let mut beside = Vec3::ZERO;
    let pairs = PAIRS.map(|(mass, names)| {
        beside += Vec3::Y * 0.4;
        let ids = [moving(1.0, beside, SPEEDS[0]), moving(mass, beside + Vec3::X, SPEEDS[1])];
        Pair { mass, names, ids }
    });
    let place = |i: usize| Vec3::X * (i as f32 * (2.0 * PAIR_RADIUS + ROW_GAP));
    let mut row = vec![moving(1.0, place(0) - Vec3::X, SPEEDS[0])];
    row.extend((0..4).map(|i| moving(1.0, place(i), 0.0)));
    Instance::new(world, ElasticPairs { pairs, row })
}

struct Pair {
    /// Mass of the second ball, kg.
    mass: f32,
    names: [&'static str; 2],
    ids: [BodyId; 2],
}

struct ElasticPairs {
    pairs: [Pair; 3],
    row: Vec<BodyId>,
}

impl Pair {
    /// Returns the speeds after the hit: `v₁' = ((m₁ − m₂) v₁ + 2 m₂ v₂) / (m₁ + m₂)`, and `v₂'` with 1 and 2
    /// exchanged; momentum and energy are conserved.
    fn metrics(&self, world: &World) -> [Metric; 2] {
        let after =
            |own: f32, other: f32, [v, u]: [f32; 2]| ((own - other) * v + 2.0 * other * u) / (own + other);
        let [v1, v2] = SPEEDS;
        let right = [after(1.0, self.mass, [v1, v2]), after(self.mass, 1.0, [v2, v1])];
        [0, 1].map(|i| {
            let expected = Expected::Near { value: f64::from(right[i]), tolerance: 1e-3 };
            Metric::new(self.names[i], world.velocity(self.ids[i]).linear.x, expected)
        })
    }
}

impl Script for ElasticPairs {
    fn metrics(&self, world: &World) -> Vec<Metric> {
        let mut metrics: Vec<_> = self.pairs.iter().flat_map(|pair| pair.metrics(world)).collect();
        let speed = |&id: &BodyId| world.velocity(id).linear;
        let (last, others) = self.row.split_last().expect("the row has five balls");
        let left = others.iter().fold(0.0, |most, id| max(most, speed(id).length()));
        metrics.push(Metric::new("last_of_row_m_s", speed(last).x, Expected::near(SPEEDS[0], 1e-3)));
        metrics.push(Metric::new("left_in_row_m_s", left, Expected::AtMost(4e-3)));
        metrics
    }
}

pub(in crate::scenes) const NEWTONS_CRADLE: Scene = Scene {
    chapter: Chapter::Contacts,
    name: "newtons_cradle",
    about: "five steel balls on rods: as many rise on one side as come in on the other, and as high",
    steps: 300,
    settings: &[
        Setting::number("lift", 30.0, (10.0, 60.0), "initial angle of the first ball, degrees"),
        Setting::number("gap", 0.01, (0.0, 0.05), "gap between the balls, m"),
    ],
    build: newtons_cradle,
};

const CRADLE_RADIUS: f32 = 0.1;
/// Distance from pivot to ball, metres.
const ROD: f32 = 1.0;

fn newtons_cradle(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let (lift, gap) = (setup.number("lift"), setup.number("gap"));
    let hung = |i: usize| {
        let pivot = Vec3::X * (i as f32 * (2.0 * CRADLE_RADIUS + gap));
        let turn = tilt(if i == 0 { -lift } else { 0.0 });
        let hook = world.add_body(&BodyDef { position: pivot, ..hook() });
        let ball = elastic_ball(1.0, CRADLE_RADIUS, pivot + turn * Vec3::NEG_Y * ROD);
        let ball = world.add_body(&BodyDef { rotation: turn, ..ball });
        join(&mut world, hook, ball, pivot);
        (ball, pivot)
    };
    let balls = (0..5).map(hung).collect();
    Instance::new(world, Cradle { balls, lift, before: -lift, quarter: None, out: 0.0, left_behind: 0.0 })
}

struct Cradle {
    /// Balls with their pivots.
    balls: Vec<(BodyId, Vec3)>,
    /// Initial angle of the first ball, degrees.
    lift: f32,
    /// Angle of the first ball from hanging straight one step ago, degrees.
    before: f32,
    /// Time at which the first ball first hung straight, s.
    quarter: Option<f32>,
    /// Largest angle of the last ball from hanging straight, degrees.
    out: f32,
    /// Largest angle of the other balls from hanging straight at the time `quarter`, degrees.
    left_behind: f32,
}

impl Script for Cradle {
    fn after_step(&mut self, world: &mut World) {
        let lean = |&(ball, pivot): &(BodyId, Vec3)| {
            let from = world.center_of_mass(ball) - pivot;
            sinew::math::trig::atan2(from.x, -from.y).to_degrees()
        };
        let first = lean(&self.balls[0]);
        if self.quarter.is_none() && first >= 0.0 {
            let ago = first / (first - self.before);
            self.quarter = Some(world.time() as f32 - ago * world.def().dt());
        }
        self.before = first;
        let (last, others) = self.balls.split_last().expect("the cradle has five balls");
        if lean(last) > self.out {
            self.out = lean(last);
            self.left_behind = others.iter().fold(0.0, |most, ball| max(most, lean(ball).abs()));
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        // Symplectic Euler leads by half a substep.
        let lead = 0.5 * f64::from(world.def().dt()) / f64::from(world.def().substeps);
        let quarter = 0.25 * pendulum_period(self.lift, CRADLE_RADIUS) - lead;
        vec![
            Metric::new("last_out_deg", self.out, Expected::near(self.lift, 0.02)),
            Metric::new("left_behind_deg", self.left_behind, Expected::AtMost(1.0)),
            Metric::awaited("quarter_s", self.quarter, Expected::near(quarter, 0.003)),
        ]
    }
}

pub(in crate::scenes) const BOUNCING_BALLS: Scene = Scene {
    chapter: Chapter::Contacts,
    name: "bouncing_balls",
    about: "49 balls fall from 5 m and bounce without loss: the error of their energy (SimBenchmark)",
    steps: 500,
    settings: &[Setting::number("step_ms", 10.0, (0.5, 20.0), "length of a step, ms")],
    build: bouncing_balls,
};

/// SimBenchmark's "bouncing": balls in a square, their mass in kg, lengths in metres.
const SIDE: usize = 7;
const BOUNCING_MASS: f32 = 10.0;
const BOUNCING_RADIUS: f32 = 0.1;
const BOUNCING_HEIGHT: f32 = 5.0;

fn bouncing_balls(setup: &Setup<'_>) -> Instance {
    let step_nanoseconds = (setup.number("step_ms") * 1e6) as u64;
    let sleeping = Sleeping::Off;
    let mut world = World::new(WorldDef { step_nanoseconds, sleeping, ..setup.world_def() });
    world.add_body(&made_of(floor(), ELASTIC));
    for i in 0..SIDE * SIDE {
        let place = Vec3::new((i % SIDE) as f32 - 3.0, BOUNCING_HEIGHT, (i / SIDE) as f32 - 3.0);
        world.add_body(&elastic_ball(BOUNCING_MASS, BOUNCING_RADIUS, place));
    }
    let start = f64::from(world.energy().total());
    Instance::new(world, BouncingBalls { start, squares: 0.0, steps: 0 })
}

struct BouncingBalls {
    /// Energy at the start, J.
    start: f64,
    /// Sum over the steps of the squared error of the energy, J².
    squares: f64,
    steps: u32,
}

impl Script for BouncingBalls {
    fn after_step(&mut self, world: &mut World) {
        let error = f64::from(world.energy().total()) - self.start;
        self.squares += error * error;
        self.steps += 1;
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let right = (SIDE * SIDE) as f32 * BOUNCING_MASS * GRAVITY * BOUNCING_HEIGHT;
        vec![
            Metric::new("energy_j", world.energy().total(), Expected::near(right, 0.005)),
            Metric::new("energy_error_j2", self.squares / f64::from(self.steps.max(1)), Expected::Anything),
        ]
    }
}
