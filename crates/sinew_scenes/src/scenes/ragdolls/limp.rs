//! The mannequin, limp: dropped, thrown at a wall, down the cabin's stairs.

use crate::cabin::{PORCH_HEIGHT, Site};
use crate::framework::flight::Flight;
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::ragdolls::{bind_pose, ragdoll_of_mannequin, spawn_at};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{cuboid, fixed, floor};
use sinew::math::{Rotation, Vec3, max, min};
use sinew::physics::{BodyId, World};
use sinew::ragdoll::{QualityMeter, Ragdoll, RagdollDef};

pub(in crate::scenes) const DROP: Scene = Scene {
    chapter: Chapter::Ragdolls,
    name: "ragdoll_drop",
    about: "the mannequin falls limp on the floor and comes to rest",
    steps: 600,
    settings: &[
        Setting::number("height", 1.0, (0.1, 50.0), "distance from its lowest point to the floor, m"),
        Setting::number("pitch", 25.0, (-180.0, 180.0), "leaning forward, degrees"),
        Setting::number("roll", 0.0, (-180.0, 180.0), "lean to its right, degrees"),
    ],
    build: drop,
};

pub(in crate::scenes) const WALL: Scene = Scene {
    chapter: Chapter::Ragdolls,
    name: "ragdoll_wall",
    about: "the mannequin is thrown at a wall: no joint stretches, no body flies away",
    steps: 480,
    settings: &[speed_to_wall(15.0)],
    build: wall,
};

pub(in crate::scenes) const WALL_FAST: Scene = Scene {
    chapter: Chapter::Ragdolls,
    name: "ragdoll_wall_fast",
    about: "the mannequin is thrown at a wall twice as fast",
    steps: 480,
    settings: &[speed_to_wall(30.0)],
    build: wall,
};

const fn speed_to_wall(default: f32) -> Setting {
    Setting::number("speed", default, (1.0, 60.0), "speed toward the wall, m/s")
}

/// Largest speed for which the stricter limits of the specification hold, m/s.
const WALL_SPEED: f32 = 15.0;

pub(in crate::scenes) const STAIRS: Scene = Scene {
    chapter: Chapter::Ragdolls,
    name: "stairs",
    about: "the limp mannequin moves out onto the cabin's stairs and is pushed in the back",
    steps: 900,
    settings: &[
        Setting::number("speed", 2.5, (0.0, 10.0), "speed at the edge of the porch, m/s"),
        Setting::number("impulse", 100.0, (0.0, 500.0), "forward push on its chest during the fall, N·s"),
    ],
    build: stairs,
};

fn drop(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let turn = Rotation::from_axis_angle(Vec3::Z, setup.number("roll").to_radians())
        * Rotation::from_axis_angle(Vec3::X, setup.number("pitch").to_radians());
    let limp = Limp::spawn(&mut world, turn, Vec3::Y * setup.number("height"), Vec3::ZERO);
    Instance::new(world, limp)
}

fn wall(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    world.add_body(&fixed(cuboid(Vec3::new(6.0, 4.0, 0.25), Vec3::new(0.0, 4.0, 3.0))));
    let speed = setup.number("speed");
    let mut limp = Limp::spawn(&mut world, Rotation::IDENTITY, Vec3::Y, Vec3::Z * speed);
    if speed > WALL_SPEED {
        limp.requirements = FAST;
    }
    Instance::new(world, limp)
}

fn stairs(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    for prop in Site::CabinWithStairs.props() {
        world.add_body(&prop.body);
    }
    // The start is a hand's breadth above the boards, at the edge.
    let edge = Vec3::new(0.0, PORCH_HEIGHT + 0.1, -0.3);
    let speed = Vec3::Z * setup.number("speed");
    let mut limp = Limp::spawn(&mut world, Rotation::IDENTITY, edge, speed);
    limp.push = Vec3::Z * setup.number("impulse");
    limp.asleep_within = 10.0;
    Instance::new(world, limp)
}

/// Joint bounds during a hit.
struct Requirements {
    gap_p99: Expected,
    gap_max: Expected,
    overshoot_p99: Expected,
    overshoot_max: Expected,
}

/// Expectations of the specification.
const USUAL: Requirements = Requirements {
    gap_p99: Expected::AtMost(1e-3),
    gap_max: Expected::AtMost(5e-3),
    overshoot_p99: Expected::AtMost(2.0),
    overshoot_max: Expected::AtMost(4.0),
};

/// Expectations of a throw faster than [`WALL_SPEED`].
const FAST: Requirements = Requirements {
    gap_p99: Expected::Anything,
    gap_max: Expected::AtMost(0.01),
    overshoot_p99: Expected::Anything,
    overshoot_max: Expected::Anything,
};

/// A limp mannequin and its measurements.
pub(in crate::scenes) struct Limp {
    def: RagdollDef,
    ragdoll: Ragdoll,
    meter: QualityMeter,
    flight: Flight,
    /// Push on the chest, N·s, at [`PUSH_STEP`].
    pub push: Vec3,
    /// Longest allowed time until the mannequin sleeps, seconds.
    pub asleep_within: f64,
    requirements: Requirements,
    lowest: f32,
    /// Last time before the first contact, seconds, and the kinetic energy then, J.
    struck: (f32, f32),
    /// Kinetic energy [`IMPACT`] seconds after the contact, as a share of the energy before it.
    left: Option<f32>,
}

/// Duration of the energy loss in a hit, seconds.
const IMPACT: f32 = 0.1;
/// Step of the push, during the stumble.
const PUSH_STEP: u64 = 12;

impl Limp {
    /// Spawns the mannequin in its bind pose, rotated about its soles and moving as one rigid piece, with its lowest
    /// point at `place`.
    fn spawn(world: &mut World, turn: Rotation, place: Vec3, speed: Vec3) -> Self {
        Self::spawn_of(ragdoll_of_mannequin(), world, turn, place, speed)
    }

    /// Adds another character as [`spawn`](Self::spawn) does.
    pub fn spawn_of(def: RagdollDef, world: &mut World, turn: Rotation, place: Vec3, speed: Vec3) -> Self {
        let ragdoll = spawn_at(world, &def, &bind_pose(&def), turn, place, speed);
        let mut meter = QualityMeter::new(&def, 10.0);
        meter.before_step(world);
        let flight = Flight::new(world, ragdoll.bodies.clone());
        Self {
            def,
            ragdoll,
            meter,
            flight,
            push: Vec3::ZERO,
            asleep_within: 6.0,
            requirements: USUAL,
            lowest: f32::INFINITY,
            struck: (0.0, 0.0),
            left: None,
        }
    }

    fn watch_hit(&mut self, world: &World) {
        let kinetic = world.energy().kinetic;
        if !self.flight.landed() {
            self.struck = (world.time() as f32, kinetic);
        } else if self.left.is_none() && world.time() as f32 > self.struck.0 + IMPACT {
            self.left = Some(kinetic / self.struck.1);
        }
    }

    fn push(&mut self, world: &mut World) {
        let chest = self.def.bodies.iter().position(|body| body.role == "chest");
        // Without a chest, the root is pushed.
        let chest = self.ragdoll.bodies[chest.unwrap_or(0)];
        let before = world.body_energy(chest).kinetic;
        world.apply_impulse_at_center(chest, self.push);
        self.meter.pushed(world.body_energy(chest).kinetic - before);
    }
}

impl Script for Limp {
    fn after_step(&mut self, world: &mut World) {
        self.meter.after_step(world, &self.ragdoll);
        self.flight.after_step(world);
        let center = |id: &BodyId| world.center_of_mass(*id).y;
        self.lowest = self.ragdoll.bodies.iter().map(center).fold(self.lowest, min);
        self.watch_hit(world);
        if world.step_count() == PUSH_STEP && self.push != Vec3::ZERO {
            self.push(world);
        }
        self.meter.before_step(world);
    }

    /// Returns the metrics with the specification's limits for the quality of a ragdoll.
    fn metrics(&self, world: &World) -> Vec<Metric> {
        let q = self.meter.quality();
        let Requirements { gap_p99, gap_max, overshoot_p99, overshoot_max } = self.requirements;
        let pelvis = world.center_of_mass(self.ragdoll.bodies[0]);
        vec![
            self.flight.metric(),
            Metric::new("joint_gap_p99_m", q.joint_gap_p99_m, gap_p99),
            Metric::new("joint_gap_max_m", q.joint_gap_max_m, gap_max),
            Metric::new("limit_overshoot_p99_deg", q.limit_overshoot_p99_deg, overshoot_p99),
            Metric::new("limit_overshoot_max_deg", q.limit_overshoot_max_deg, overshoot_max),
            Metric::new("penetration_max_m", q.penetration_max_m, Expected::Anything),
            Metric::new("penetration_rest_max_m", q.penetration_rest_max_m, Expected::AtMost(5e-3)),
            Metric::new("nonadjacent_overlap_max_m", q.nonadjacent_overlap_max_m, Expected::AtMost(0.01)),
            Metric::awaited("first_contact_s", q.first_contact_s, Expected::Anything),
            Metric::awaited("settled_s", q.settled_s, Expected::Anything),
            Metric::awaited("settled_omega_max_rad_s", q.settled_omega_max, Expected::AtMost(0.05)),
            Metric::awaited("asleep_s", q.asleep_s, Expected::AtMost(self.asleep_within)),
            Metric::awaited("calm_to_asleep_s", q.calm_to_asleep_s, Expected::AtMost(3.0)),
            Metric::new("fallen_through_m", max(-self.lowest, 0.0), Expected::AtMost(0.0)),
            Metric::new("pelvis_height_m", pelvis.y, Expected::AtMost(0.7)),
            Metric::new("pelvis_forward_m", pelvis.z, Expected::Anything),
            Metric::awaited("impact_energy_left", self.left, Expected::Anything),
            Metric::new("work_in_j", q.work_in_j, Expected::Anything),
        ]
    }
}
