//! Standing and toppling blocks: stack, pyramid, dominoes.

use crate::framework::flight::Flight;
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, ball, cuboid, floor, hook, join, tilt};
use sinew::math::{Transform, Vec3, max, trig};
use sinew::physics::{BodyId, World};

pub(in crate::scenes) const STACK: Scene = Scene {
    chapter: Chapter::Piles,
    name: "stack",
    about: "a stack of boxes, the last one dropped, stands and falls asleep",
    steps: 600,
    settings: &[Setting::whole("boxes", 10, (1, 100), "number of boxes")],
    build: |setup| {
        let places = (0..setup.whole("boxes")).map(|i| Vec3::Y * (HALF * (2 * i + 1) as f32));
        standing(setup, places)
    },
};

pub(in crate::scenes) const PYRAMID: Scene = Scene {
    chapter: Chapter::Piles,
    name: "pyramid",
    about: "a wall of boxes, one fewer in each row, the last one dropped, stands and falls asleep",
    steps: 600,
    settings: &[Setting::whole("base", 10, (1, 60), "number of boxes in the lowest row")],
    build: |setup| {
        let base = setup.whole("base");
        let place = |row: usize, i: usize| {
            let x = (2 * i + row) as f32 - (base - 1) as f32;
            Vec3::new(x * (HALF + 0.01), HALF * (2 * row + 1) as f32, 0.0)
        };
        standing(setup, (0..base).flat_map(|row| (0..base - row).map(move |i| place(row, i))))
    },
};

/// Half a side of a box, metres.
const HALF: f32 = 0.25;
/// Height from which the last box falls, metres.
const DROP: f32 = 0.1;

fn standing(setup: &Setup<'_>, places: impl Iterator<Item = Vec3>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let boxes: Vec<_> = places.map(|at| (world.add_body(&cuboid(Vec3::splat(HALF), at)), at)).collect();
    let &(last, place) = boxes.last().expect("the setting allows only one box or more");
    world.set_transform(last, Transform::from_translation(place + Vec3::Y * DROP));
    let flight = Flight::new(&world, vec![last]);
    Instance::new(world, Standing { boxes, flight, asleep: None })
}

struct Standing {
    /// Boxes with their target positions.
    boxes: Vec<(BodyId, Vec3)>,
    flight: Flight,
    asleep: Option<f32>,
}

impl Script for Standing {
    fn after_step(&mut self, world: &mut World) {
        self.flight.after_step(world);
        if self.asleep.is_none() && self.boxes.iter().all(|&(id, _)| !world.is_awake(id)) {
            self.asleep = Some(world.time() as f32);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let (mut shift, mut sink) = (0.0, 0.0);
        for &(id, place) in &self.boxes {
            let moved = world.center_of_mass(id) - place;
            shift = max(shift, Vec3::new(moved.x, 0.0, moved.z).length());
            sink = max(sink, -moved.y);
        }
        vec![
            self.flight.metric(),
            Metric::new("shift_max_m", shift, Expected::AtMost(0.01)),
            // Soft contacts sink by the weight above them.
            Metric::new("sink_max_m", sink, Expected::AtMost(0.04)),
            Metric::awaited("asleep_s", self.asleep, Expected::AtMost(8.0)),
        ]
    }
}

pub(in crate::scenes) const DOMINOES: Scene = Scene {
    chapter: Chapter::Piles,
    name: "dominoes",
    about: "a ball on a rod strikes the first of a row of dominoes, and all of them fall",
    steps: 360,
    settings: &[
        Setting::whole("dominoes", 20, (1, 500), "number of dominoes"),
        Setting::number("amplitude", 40.0, (30.0, 80.0), "amplitude of the ball's swing, degrees"),
    ],
    build: dominoes,
};

const DOMINO_HALF: Vec3 = Vec3::new(0.03, 0.25, 0.12);
/// Distance from one domino to the next, metres.
const SPACING: f32 = 0.25;
/// Radius of the ball, metres.
const RADIUS: f32 = 0.1;
/// Height of the ball's centre at its lowest point, where it strikes, metres.
const STRIKE_HEIGHT: f32 = 0.4;
const ROD: f32 = 1.0;
/// Distance behind its lowest point at which the ball touches the first domino, metres. The ball thus reaches its
/// largest speed before the strike.
const LATE: f32 = 0.02;

fn dominoes(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    let amplitude = setup.number("amplitude");
    world.add_body(&floor());
    let first = LATE + RADIUS + DOMINO_HALF.x;
    let place = |i: usize| Vec3::new(first + SPACING * i as f32, DOMINO_HALF.y, 0.0);
    let row: Vec<BodyId> =
        (0..setup.whole("dominoes")).map(|i| world.add_body(&cuboid(DOMINO_HALF, place(i)))).collect();
    let mut pivot = hook();
    pivot.position = Vec3::Y * (STRIKE_HEIGHT + ROD);
    let at = pivot.position;
    let pivot = world.add_body(&pivot);
    let striker = world.add_body(&ball(RADIUS, at + tilt(-amplitude) * (Vec3::NEG_Y * ROD)));
    join(&mut world, pivot, striker, at);
    let weight = world.mass(striker).mass * GRAVITY;
    let swing = weight * ROD * (1.0 - trig::cos(amplitude.to_radians()));
    Instance::new(world, Dominoes { row, striker, swing, strike: 0.0, all_down: None })
}

struct Dominoes {
    row: Vec<BodyId>,
    striker: BodyId,
    /// Energy of the ball at its lowest point, J.
    swing: f32,
    /// Largest energy so far, J.
    strike: f32,
    all_down: Option<f32>,
}

impl Dominoes {
    fn down(&self, world: &World) -> usize {
        // A domino that leans on the next one is down.
        let is_down = |&&id: &&BodyId| (world.transform(id).rotation * Vec3::Y).y < 0.8;
        self.row.iter().filter(is_down).count()
    }
}

impl Script for Dominoes {
    fn after_step(&mut self, world: &mut World) {
        self.strike = max(self.strike, world.body_energy(self.striker).kinetic);
        if self.all_down.is_none() && self.down(world) == self.row.len() {
            self.all_down = Some(world.time() as f32);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let all = self.row.len() as u32;
        let down = self.down(world) as u32;
        vec![
            Metric::new("strike_j", self.strike, Expected::near(self.swing, 0.006)),
            Metric::new("down", down, Expected::near(all, 0.0)),
            Metric::awaited("all_down_s", self.all_down, Expected::Anything),
        ]
    }
}
