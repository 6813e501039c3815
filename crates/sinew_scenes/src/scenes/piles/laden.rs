//! Structures that carry jointed loads, on them, below them or leaning on them: they must stand as well as without
//! loads.

use crate::blueprint::{self, Blueprint, arch, loads};
use crate::framework::flight::Flight;
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::framework::stand::{center, deepest, shift};
use crate::parts::{ball, ghost};
use sinew::math::{Rotation, Transform, Vec3, max, min};
use sinew::physics::{BodyId, BodyKind, Sleeping, World, WorldDef};

const STEPS: u32 = 600;
const SETTINGS: &[Setting] = &[
    Setting::number(
        "light",
        0.1,
        (0.001, 10.0),
        "mass of the light pair and of each rope, relative to the body below them",
    ),
    Setting::number("heavy", 1.0, (0.001, 10.0), "mass of the heavy pair, relative to the body below it"),
];

/// Scene of a standing structure, beside copies of it with loads.
const fn laden(name: &'static str, about: &'static str, build: fn(&Setup<'_>) -> Instance) -> Scene {
    Scene { chapter: Chapter::Piles, name, about, steps: STEPS, settings: SETTINGS, build }
}

pub(in crate::scenes) const JENGA: Scene = laden(
    "jenga_laden",
    "`jenga` stands under a jointed pair, a rope, a doll, with a rope hanging from it, a plank leaning on it",
    |setup| side_by_side(setup, &jenga()),
);

pub(in crate::scenes) const SIZE_RATIO: Scene = laden(
    "stack_ratio_laden",
    "`stack_ratio` stands under a jointed pair, a rope, a figure, with a rope hanging from it, a plank leaning on it",
    |setup| side_by_side(setup, &size_ratio()),
);

pub(in crate::scenes) const MASS_RATIO: Scene = laden(
    "stack_mass_ratio_laden",
    "`stack_mass_ratio` stands under a jointed pair, a rope, a figure, with a rope hanging from it, a plank leaning on it",
    |setup| side_by_side(setup, &tower(blueprint::stack_mass_ratio(10, 10.0))),
);

pub(in crate::scenes) const CARDS: Scene = laden(
    "cards_laden",
    "`cards` stands with a jointed pair or a doll on its ceiling, a rope over its ridge, a plank leaning on it",
    |setup| side_by_side(setup, &cards()),
);

pub(in crate::scenes) const PYRAMID: Scene = laden(
    "pyramid_laden",
    "`large_pyramid` stands under a jointed pair, a rope, a figure, with a rope hanging from it, a plank leaning on it",
    |setup| side_by_side(setup, &pyramid()),
);

pub(in crate::scenes) const ARCH: Scene = laden(
    "arch_laden",
    "`arch` stands under a jointed pair, a rope, a figure, with a rope hanging from it, a plank leaning on it",
    |setup| side_by_side(setup, &masonry()),
);

pub(in crate::scenes) const STACK: Scene = laden(
    "stack_laden",
    "`stack` stands under a jointed pair, a rope, a figure, with a rope hanging from it, a plank leaning on it",
    |setup| side_by_side(setup, &tower(blueprint::loads::stack(10))),
);

/// A structure that carries jointed loads.
struct Host {
    plan: Blueprint,
    /// True if the first body of `plan` is a floor, which all copies share.
    on_floor: bool,
    /// Middle of the structure's level top.
    top: Transform,
    /// Half of the top's width along x, metres.
    half: f32,
    /// Size of the ragdoll on the structure, relative to a man.
    figure: f32,
    /// Mass of one of the supporting bodies, kg.
    mass: f32,
    /// Points of the rope over the top.
    rope: Vec<Vec3>,
    /// Body from which a rope hangs, and the point.
    edge: (usize, Vec3),
    /// Point at which a plank touches the structure, and the plank's tilt in degrees.
    touch: (Vec3, f32),
    /// Mass of the plank, kg.
    plank: f32,
}

/// Radius of a rope over its host, as a share of half the host's width.
const ROPE_RADIUS: f32 = 0.06;
/// Half of the smallest width on which a man's trunk fits, metres: narrower tops get a smaller ragdoll.
const CHEST: f32 = 0.35;
/// Mass of the plank, as a share of the lightest body's mass.
const PLANK: f32 = 0.1;

impl Host {
    /// Creates a host with a level top; its last body has the edge at +x.
    fn level(plan: Blueprint, top: Vec3, half: f32, touch: (Vec3, f32)) -> Self {
        let last = plan.bodies.len() - 1;
        let mass = mass_of(&plan, last);
        let plank = PLANK * plan.dynamic().map(|place| mass_of(&plan, place)).fold(f32::INFINITY, min);
        let rope = loads::over(top, half, ROPE_RADIUS * half);
        let edge = (last, top + Vec3::X * half);
        let top = Transform::from_translation(top);
        Self {
            plan,
            on_floor: true,
            top,
            half,
            figure: min(half / CHEST, 1.0),
            mass,
            rope,
            edge,
            touch,
            plank,
        }
    }

    /// A copy of the structure with a load.
    fn laden(&self, setup: &Setup<'_>, load: &Load) -> Blueprint {
        let mut plan = self.plan.clone();
        (load.add)(setup, self, &mut plan);
        plan
    }
}

fn mass_of(plan: &Blueprint, place: usize) -> f32 {
    let shape = &plan.bodies[place].shapes[0];
    shape.shape.mass_properties(shape.density).mass
}

/// A kind of load, and the names of its metrics.
struct Load {
    shift: &'static str,
    sink: &'static str,
    depth: &'static str,
    add: fn(&Setup<'_>, &Host, &mut Blueprint),
}

const LOADS: [Load; 6] = [
    Load {
        shift: "light_pair_shift_m",
        sink: "light_pair_sink_m",
        depth: "light_pair_depth_m",
        add: |setup, host, plan| loads::pair(plan, host.top, host.half, setup.number("light") * host.mass),
    },
    Load {
        shift: "heavy_pair_shift_m",
        sink: "heavy_pair_sink_m",
        depth: "heavy_pair_depth_m",
        add: |setup, host, plan| loads::pair(plan, host.top, host.half, setup.number("heavy") * host.mass),
    },
    Load {
        shift: "rope_shift_m",
        sink: "rope_sink_m",
        depth: "rope_depth_m",
        add: |setup, host, plan| {
            loads::rope(plan, &host.rope, ROPE_RADIUS * host.half, setup.number("light") * host.mass);
        },
    },
    Load {
        shift: "hanging_shift_m",
        sink: "hanging_sink_m",
        depth: "hanging_depth_m",
        add: |setup, host, plan| {
            let (body, at) = host.edge;
            // The ragdoll lies beside its support.
            let link = 0.5 * host.half;
            loads::hanging(plan, body, at + Vec3::X * (0.15 * link), link, setup.number("light") * host.mass);
        },
    },
    Load {
        shift: "leaning_shift_m",
        sink: "leaning_sink_m",
        depth: "leaning_depth_m",
        add: |_, host, plan| loads::leaning(plan, host.touch.0, host.touch.1, host.plank),
    },
    Load {
        shift: "figure_shift_m",
        sink: "figure_sink_m",
        depth: "figure_depth_m",
        add: |_, host, plan| loads::figure(plan, host.top, host.figure),
    },
];

fn jenga() -> Host {
    const LEVELS: usize = 18;
    // The plank touches the outer face of an odd level, half-way up the eighth level.
    let touch = Vec3::new(0.0377, 0.1125, 0.0);
    Host::level(blueprint::jenga(LEVELS), Vec3::Y * (0.015 * LEVELS as f32), 0.0377, (touch, 20.0))
}

fn size_ratio() -> Host {
    // The loads lie on the largest cube, of 4 m.
    Host::level(blueprint::stack_ratio(6), Vec3::Y * 7.875, 2.0, (Vec3::new(2.0, 5.0, 0.0), 20.0))
}

/// Host of ten cubes of 0.5 m.
fn tower(plan: Blueprint) -> Host {
    Host::level(plan, Vec3::Y * 5.0, 0.25, (Vec3::new(0.25, 1.25, 0.0), 20.0))
}

fn pyramid() -> Host {
    let plan = blueprint::large_pyramid_of(10);
    Host::level(plan, Vec3::Y * 10.0, 0.5, (Vec3::new(5.0, 0.75, 0.0), 20.0))
}

/// House of cards: loads lie on the uppermost ceiling, between the two cards of the last storey, and the rope lies
/// over these cards.
fn cards() -> Host {
    const PAIRS: usize = 3;
    let plan = blueprint::cards(PAIRS);
    let count = plan.bodies.len();
    // Axes of a card: x out of the card, y along it.
    let pose = |place: usize| Transform::new(plan.bodies[place].position, plan.bodies[place].rotation);
    let flat = Rotation::from_axis_angle(Vec3::Z, -core::f32::consts::FRAC_PI_2);
    let half_thickness = 0.001;
    let ceiling = pose(count - 3);
    let top = ceiling * Transform::new(Vec3::X * half_thickness, flat);
    let [left, right] = [pose(count - 2), pose(count - 1)];
    let half = 0.1;
    let radius = ROPE_RADIUS * half;
    let beside =
        |card: Transform, way: f32, y: f32| card.point(Vec3::new(way * (half_thickness + radius), y, 0.0));
    let steepness = steepness(right);
    let apex = Vec3::new(0.0, right.point(Vec3::new(half_thickness, 0.2, 0.0)).y + radius * steepness, 0.0);
    let down = [0.05, 0.10, 0.15].map(|down| 0.2 - down);
    let rope = [
        down.iter().rev().map(|&y| beside(left, -1.0, y)).collect::<Vec<_>>(),
        vec![apex],
        down.iter().map(|&y| beside(right, 1.0, y)).collect(),
    ]
    .concat();
    let outer = pose(2 * PAIRS);
    let touch = (outer.point(Vec3::new(half_thickness, 0.05, 0.0)), 45.0);
    let edge = (count - 1, right.point(Vec3::X * half_thickness));
    let mass = mass_of(&plan, count - 1);
    Host { on_floor: true, top, half, figure: 0.13, mass, rope, edge, touch, plank: PLANK * mass, plan }
}

/// Reciprocal sine of a leaning card's angle from the vertical.
fn steepness(card: Transform) -> f32 {
    1.0 / max((card.rotation * Vec3::Y).x.abs(), 0.1)
}

fn masonry() -> Host {
    const STONES: usize = 15;
    let plan = blueprint::arch(STONES, 4);
    let last = plan.bodies.len() - 1;
    let top = plan.bodies[last].position + Vec3::Y * 0.15;
    let joints = arch::joints(STONES);
    let [foot, next] = [STONES, STONES - 1].map(|i| {
        let [a, b] = joints[i].ends();
        if a.x > b.x { a } else { b }
    });
    let touch = foot.lerp(next, 0.6);
    Host { on_floor: false, ..Host::level(plan, top, 0.3, (touch, 40.0)) }
}

/// Copies of a structure: the first without a load, each other one with one of the loads.
fn side_by_side(setup: &Setup<'_>, host: &Host) -> Instance {
    let mut world = World::new(WorldDef { sleeping: Sleeping::On, ..setup.world_def() });
    let apart = 4.0 * host.half + 2.0 * host.figure;
    let plans = core::iter::once(host.plan.clone()).chain(LOADS.iter().map(|load| host.laden(setup, load)));
    let copies = plans.enumerate().map(|(i, mut plan)| {
        if host.on_floor && i > 0 {
            plan.bodies[0] = ghost(plan.bodies[0].clone());
        }
        let built = plan.moved(Vec3::Z * (apart * i as f32)).build_into(&mut world);
        Copy::new(&world, built.bodies, host.plan.bodies.len())
    });
    let copies: Vec<_> = copies.collect();
    let plumb = world.add_body(&ball(0.02, Vec3::new(0.0, 5.0, -50.0)));
    let flight = Flight::new(&world, vec![plumb]);
    Instance::new(world, Laden { copies, flight, asleep: None })
}

/// A structure and its load.
struct Copy {
    /// Initial poses of the host's bodies.
    placed: Vec<(BodyId, Transform)>,
    load: Vec<BodyId>,
}

impl Copy {
    fn new(world: &World, mut bodies: Vec<BodyId>, of_host: usize) -> Self {
        let load = bodies.split_off(of_host);
        bodies.retain(|&id| world.kind(id) == BodyKind::Dynamic);
        let placed = bodies.into_iter().map(|id| (id, center(world, id))).collect();
        Self { placed, load }
    }

    fn worst(&self, world: &World, of: impl Fn(Transform, Transform) -> f32) -> f32 {
        self.placed.iter().fold(0.0, |worst, &(id, from)| max(worst, of(from, center(world, id))))
    }

    /// Returns the largest shift, sink and depth, metres.
    fn figures(&self, world: &World) -> [f32; 3] {
        let sink = self.worst(world, |a, b| a.translation.y - b.translation.y);
        let depth = deepest(world, self.placed.iter().map(|&(id, _)| id));
        [self.worst(world, shift), sink, depth]
    }

    fn sleeps(&self, world: &World) -> bool {
        !self.placed.iter().map(|&(id, _)| id).chain(self.load.iter().copied()).any(|id| world.is_awake(id))
    }
}

struct Laden {
    /// Copies of the structure; the first has no load.
    copies: Vec<Copy>,
    /// Free fall of a ball, to verify gravity.
    flight: Flight,
    asleep: Option<f32>,
}

/// Shift, sink and depth, metres, that a loaded structure may have in any case. A bound of twice the unloaded value
/// would be too strict where that value is near zero. In its own scene an unloaded structure may shift by 5 mm.
const ROOM: [f32; 3] = [0.005, 0.005, 0.001];

impl Script for Laden {
    fn after_step(&mut self, world: &mut World) {
        self.flight.after_step(world);
        if self.asleep.is_none() && self.copies.iter().all(|copy| copy.sleeps(world)) {
            self.asleep = Some(world.time() as f32);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let without = self.copies[0].figures(world);
        let names = ["shift_m", "sink_m", "depth_m"];
        let mut metrics = vec![self.flight.metric()];
        metrics.extend(names.iter().zip(without).map(|(name, it)| Metric::new(name, it, Expected::Anything)));
        for (load, copy) in LOADS.iter().zip(&self.copies[1..]) {
            let with = copy.figures(world);
            let names = [load.shift, load.sink, load.depth];
            for (k, name) in names.into_iter().enumerate() {
                let most = max(2.0 * without[k], ROOM[k]);
                metrics.push(Metric::new(name, with[k], Expected::AtMost(f64::from(most))));
            }
        }
        // Some copies of towers sway by tenths of a millimetre for longer than the scene lasts.
        metrics.push(Metric::awaited("asleep_s", self.asleep, Expected::Anything));
        metrics
    }
}
