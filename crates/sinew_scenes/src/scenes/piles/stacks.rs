//! Stacks that stand only if contacts are accurate: heavy on light, crosswise, leaning, a hundred rows high.

use crate::blueprint::{self, Blueprint};
use crate::framework::flight::Flight;
use crate::framework::instance::Instance;
use crate::framework::metric::Expected;
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::framework::stand::{Bars, Stand};
use crate::parts::ball;
use sinew::math::Vec3;
use sinew::physics::{World, WorldDef};

pub(in crate::scenes) const MASS_RATIO: Scene = Scene {
    chapter: Chapter::Piles,
    name: "stack_mass_ratio",
    about: "10 boxes of one size, each ten times as heavy as the one that it stands on, stay where they are",
    steps: 600,
    settings: &[
        Setting::whole("boxes", 10, (2, 20), "number of boxes"),
        Setting::number("ratio", 10.0, (1.0, 100.0), "mass of a box over that of the one below"),
    ],
    build: |setup| {
        let boxes = setup.whole("boxes");
        let plan = blueprint::stack_mass_ratio(boxes, setup.number("ratio"));
        let depth = 0.01;
        let bars = Bars {
            shift: 0.005,
            top_drift: 0.005,
            sink: depth * boxes as f64,
            turn: 0.5,
            depth,
            asleep: SOON,
        };
        standing(setup, &plan, bars)
    },
};

pub(in crate::scenes) const SIZE_RATIO: Scene = Scene {
    chapter: Chapter::Piles,
    name: "stack_ratio",
    about: "6 boxes, each twice as large as the one that it stands on, so eight times as heavy, stay where they are",
    steps: 600,
    settings: &[Setting::whole("boxes", 6, (2, 8), "number of boxes")],
    build: |setup| {
        // The allowed depth is two slops of the lowest box, 2 % of its side.
        let depth = 0.005;
        let bars = Bars { shift: 0.005, top_drift: 0.005, sink: 2.0 * depth, turn: 0.5, depth, asleep: SOON };
        standing(setup, &blueprint::stack_ratio(setup.whole("boxes")), bars)
    },
};

pub(in crate::scenes) const JENGA: Scene = Scene {
    chapter: Chapter::Piles,
    name: "jenga",
    about: "a tower of blocks of 75 × 25 × 15 mm, three to a level, laid crosswise, stands and falls asleep",
    steps: 600,
    settings: &[Setting::whole("levels", 18, (1, 60), "number of levels of three blocks")],
    build: |setup| {
        let levels = setup.whole("levels");
        // The slops are 0.3 mm.
        let sink = 3e-4 * levels as f64;
        let bars = Bars { shift: 0.002, top_drift: 0.002, sink, turn: 1.0, depth: 6e-4, asleep: SOON };
        standing(setup, &blueprint::jenga(levels), bars)
    },
};

pub(in crate::scenes) const CARDS: Scene = Scene {
    chapter: Chapter::Piles,
    name: "cards",
    about: "a house of cards 0.4 m long and 2 mm thick stands and falls asleep",
    steps: 600,
    settings: &[Setting::whole("pairs", 3, (1, 5), "number of leaning pairs in the lowest storey")],
    build: |setup| {
        let bars = Bars { shift: 0.005, top_drift: 0.005, sink: 0.002, turn: 1.0, depth: 2e-4, asleep: SOON };
        standing(setup, &blueprint::cards(setup.whole("pairs")), bars)
    },
};

pub(in crate::scenes) const LARGE_PYRAMID: Scene = Scene {
    chapter: Chapter::Piles,
    name: "large_pyramid",
    about: "a wall of unit cubes side by side, one fewer in each row, stands for 1,000 steps",
    steps: 1000,
    settings: &[Setting::whole("base", 10, (1, 100), "number of cubes in the lowest row")],
    build: |setup| {
        let base = setup.whole("base");
        let depth = 0.01;
        let sink = depth * base as f64;
        let bars = Bars { shift: 0.02, top_drift: 0.005, sink, turn: 1.0, depth, asleep: Expected::Anything };
        standing(setup, &blueprint::large_pyramid_of(base), bars)
    },
};

/// Time limit for falling asleep, seconds.
const SOON: Expected = Expected::AtMost(8.0);

/// The bodies of a blueprint, which should not move, and a ball that falls far away.
fn standing(setup: &Setup<'_>, plan: &Blueprint, bars: Bars) -> Instance {
    let mut world = World::new(WorldDef { sleeping: plan.sleeping, ..setup.world_def() });
    let built = plan.build_into(&mut world);
    let bodies: Vec<_> = plan.dynamic().map(|place| built.bodies[place]).collect();
    let plumb = world.add_body(&ball(0.02, Vec3::new(0.0, 5.0, 50.0)));
    let flight = Flight::new(&world, vec![plumb]);
    let stand = Stand::new(&world, &bodies, flight, bars);
    Instance::new(world, stand)
}
