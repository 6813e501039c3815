//! The mannequin dropped in random poses.

use crate::framework::flight::Flight;
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::ragdolls::{ragdoll_of_mannequin, spawn_at};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::floor;
use sinew::math::{Random, Vec3, max};
use sinew::physics::{Energy, World};
use sinew::ragdoll::quality::random_pose;
use sinew::ragdoll::{QualityMeter, Ragdoll, RagdollDef};

pub(in crate::scenes) const POSES: Scene = Scene {
    chapter: Chapter::Ragdolls,
    name: "ragdoll_poses",
    about: "the mannequin falls limp in random poses, comes to rest and falls asleep",
    steps: 600,
    settings: &[
        Setting::whole("poses", 6, (1, 500), "number of mannequins, each in its own pose"),
        Setting::whole("first", 0, (0, 10_000), "index of the first pose; with poses=1 it falls alone"),
        Setting::number("height", 1.0, (0.1, 50.0), "distance from their lowest points to the floor, m"),
    ],
    build: poses,
};

/// Distance from one mannequin to the next, metres: so large that they do not touch.
const APART: f32 = 6.0;

fn poses(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let def = ragdoll_of_mannequin();
    let (poses, first, height) = (setup.whole("poses"), setup.whole("first"), setup.number("height"));
    let side = (1..).find(|side| side * side >= poses).unwrap_or(poses);
    let fall = |i: usize| {
        let place = Vec3::new((i % side) as f32 * APART, height, (i / side) as f32 * APART);
        Fall::start(&mut world, &def, (first + i) as u64, place)
    };
    let falls: Vec<_> = (0..poses).map(fall).collect();
    let flight = Flight::new(&world, falls[0].ragdoll.bodies.clone());
    Instance::new(world, Falls { falls, flight })
}

/// Fall of one mannequin.
struct Fall {
    ragdoll: Ragdoll,
    meter: QualityMeter,
    mass: f32,
    before: Energy,
    energy_gain_max: f32,
}

impl Fall {
    fn start(world: &mut World, def: &RagdollDef, seed: u64, place: Vec3) -> Self {
        let mut random = Random::new(seed);
        let turn = random.rotation();
        let pose = random_pose(def, &mut random);
        let ragdoll = spawn_at(world, def, &pose, turn, place, Vec3::ZERO);
        let mut meter = QualityMeter::new(def, 10.0);
        meter.before_step(world);
        let before = energy(world, &ragdoll);
        let mass = ragdoll.bodies.iter().map(|&id| world.mass(id).mass).sum();
        Self { ragdoll, meter, mass, before, energy_gain_max: 0.0 }
    }

    fn after_step(&mut self, world: &World) {
        self.meter.after_step(world, &self.ragdoll);
        // Measure each mannequin's energy separately: a rise in one would disappear in the losses of all.
        let after = energy(world, &self.ragdoll);
        let rise = (after.kinetic - self.before.kinetic) + (after.potential - self.before.potential);
        let gain = rise / max(self.before.kinetic, self.mass);
        self.energy_gain_max = max(self.energy_gain_max, gain);
        self.before = after;
        self.meter.before_step(world);
    }
}

fn energy(world: &World, ragdoll: &Ragdoll) -> Energy {
    ragdoll.bodies.iter().map(|&id| world.body_energy(id)).fold(Energy::default(), |sum, energy| Energy {
        kinetic: sum.kinetic + energy.kinetic,
        potential: sum.potential + energy.potential,
    })
}

struct Falls {
    falls: Vec<Fall>,
    /// Free fall of the first one.
    flight: Flight,
}

impl Script for Falls {
    fn after_step(&mut self, world: &mut World) {
        self.flight.after_step(world);
        for fall in &mut self.falls {
            fall.after_step(world);
        }
    }

    /// Returns the worst metrics of all mannequins.
    fn metrics(&self, _: &World) -> Vec<Metric> {
        let all: Vec<_> = self.falls.iter().map(|fall| fall.meter.quality()).collect();
        let worst = |figure: fn(&sinew::ragdoll::FallQuality) -> f32| all.iter().map(figure).fold(0.0, max);
        let last = all.iter().map(|quality| quality.asleep_s).reduce(|a, b| Some(max(a?, b?))).flatten();
        let gain = self.falls.iter().fold(0.0, |gain, fall| max(gain, fall.energy_gain_max));
        let awake = all.iter().filter(|quality| quality.asleep_s.is_none()).count() as u32;
        vec![
            self.flight.metric(),
            Metric::awaited("asleep_s", last, Expected::AtMost(6.0)),
            Metric::new("awake", awake, Expected::AtMost(0.0)),
            Metric::new(
                "limit_overshoot_max_deg",
                worst(|q| q.limit_overshoot_max_deg),
                Expected::AtMost(4.0),
            ),
            Metric::new(
                "limit_overshoot_p99_deg",
                worst(|q| q.limit_overshoot_p99_deg),
                Expected::AtMost(2.0),
            ),
            Metric::new("own_energy_gain_max", gain, Expected::AtMost(0.01)),
            Metric::new("joint_gap_max_m", worst(|q| q.joint_gap_max_m), Expected::AtMost(5e-3)),
            Metric::new("penetration_max_m", worst(|q| q.penetration_max_m), Expected::Anything),
            Metric::new(
                "penetration_rest_max_m",
                worst(|q| q.penetration_rest_max_m),
                Expected::AtMost(5e-3),
            ),
            Metric::new(
                "nonadjacent_overlap_max_m",
                worst(|q| q.nonadjacent_overlap_max_m),
                Expected::AtMost(0.01),
            ),
        ]
    }
}
