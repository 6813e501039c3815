//! Heaps that fall asleep. The number of steps is compared to Box3D where `bench/peers` runs it on the same scene.

use crate::blueprint::{self, Blueprint};
use crate::framework::flight::Flight;
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::Setup;
use crate::framework::stand::deepest;
use sinew::math::max;
use sinew::physics::{BodyId, JointId, World};

pub(in crate::scenes) const RAGDOLLS: Scene = Scene {
    chapter: Chapter::Piles,
    name: "ragdolls",
    about: "8 figures fall from 14 m onto tilted boxes and the ground, and sleep no later than in Box3D",
    steps: 600,
    settings: &[],
    build: |setup| settling(setup, &blueprint::ragdolls(), FIGURES, 307),
};

pub(in crate::scenes) const WAVE_PILE: Scene = Scene {
    chapter: Chapter::Piles,
    name: "wave_pile",
    about: "100 balls, capsules and boxes fall onto waves, and sleep no later than in Box3D",
    steps: 600,
    settings: &[],
    build: |setup| settling(setup, &blueprint::wave_pile(), 1, 361),
};

pub(in crate::scenes) const MESH_DROP: Scene = Scene {
    chapter: Chapter::Piles,
    name: "mesh_drop",
    about: "400 sticks fall spinning onto waves, and sleep no later than in Box3D",
    steps: 400,
    settings: &[],
    build: |setup| settling(setup, &blueprint::mesh_drop(), 1, 213),
};

pub(in crate::scenes) const ROCKS: Scene = Scene {
    chapter: Chapter::Piles,
    name: "rocks",
    about: "64 rocks pour onto waves, none goes through, and all sleep",
    steps: 600,
    settings: &[],
    build: |setup| settling(setup, &blueprint::rocks(), 1, 600),
};

/// Number of bodies of two ragdolls, which touch from the start.
const FIGURES: usize = 30;

/// Builds the scene of a blueprint whose bodies start apart; all must sleep after the given number of steps.
fn settling(setup: &Setup<'_>, plan: &Blueprint, first: usize, asleep_within: u32) -> Instance {
    let mut world = setup.world();
    let built = plan.build_into(&mut world);
    let bodies: Vec<_> = plan.dynamic().map(|place| built.bodies[place]).collect();
    let damping = plan.bodies[plan.bodies.len() - 1].linear_damping;
    let flight = Flight::damped(&world, bodies[..first].to_vec(), damping);
    let settling =
        Settling { bodies, joints: built.joints, flight, asleep_within, gap_max: 0.0, asleep: None };
    Instance::new(world, settling)
}

struct Settling {
    bodies: Vec<BodyId>,
    joints: Vec<JointId>,
    flight: Flight,
    /// Expected number of steps until all sleep.
    asleep_within: u32,
    gap_max: f32,
    /// First step after which all sleep.
    asleep: Option<u64>,
}

/// Height below which a body has fallen through the ground, metres.
const LOWEST: f32 = -1.0;

impl Script for Settling {
    fn after_step(&mut self, world: &mut World) {
        self.flight.after_step(world);
        self.gap_max = self.joints.iter().fold(self.gap_max, |gap, &joint| max(gap, world.joint_gap(joint)));
        if self.asleep.is_none() && self.bodies.iter().all(|&id| !world.is_awake(id)) {
            self.asleep = Some(world.step_count());
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let lost = self.bodies.iter().filter(|&&id| world.center_of_mass(id).y < LOWEST).count();
        let mut metrics = vec![
            self.flight.metric(),
            Metric::awaited(
                "asleep_steps",
                self.asleep.map(|step| step as f32),
                Expected::AtMost(self.asleep_within.into()),
            ),
            Metric::new("lost", lost as u32, Expected::AtMost(0.0)),
            Metric::new("depth_end_m", deepest(world, self.bodies.iter().copied()), Expected::AtMost(0.005)),
        ];
        if !self.joints.is_empty() {
            metrics.push(Metric::new("joint_gap_max_m", self.gap_max, Expected::AtMost(0.002)));
        }
        metrics
    }
}
