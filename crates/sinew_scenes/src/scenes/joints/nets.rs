//! Nets of joints, which form loops.

use crate::blueprint::{Blueprint, joint_grid_of, net};
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::framework::support::Support;
use sinew::math::max;
use sinew::physics::{JointId, World};

pub(in crate::scenes) const JOINT_GRID: Scene = Scene {
    chapter: Chapter::Joints,
    name: "joint_grid",
    about: "a net of jointed balls hangs from its upper edge",
    steps: 100,
    settings: &[Setting::whole("side", 100, (2, 200), "number of rows, and of balls in each")],
    build: |setup| woven(setup, &joint_grid_of(setup.whole("side"))),
};

pub(in crate::scenes) const NET: Scene = Scene {
    chapter: Chapter::Joints,
    name: "net",
    about: "a net with a weight hangs from its upper corners and swings",
    steps: 600,
    settings: &[],
    build: |setup| woven(setup, &net()),
};

/// Largest gap allowed, metres. The benchmark compares it to the best of the other engines.
const GAP: f64 = 0.005;

fn woven(setup: &Setup<'_>, plan: &Blueprint) -> Instance {
    let mut world = setup.sleepless_world();
    let joints = plan.build_into(&mut world).joints;
    let start = world.energy().total();
    let support = Support::new(&world);
    Instance::new(world, Woven { joints, start, gap_peak: 0.0, kinetic_peak: 0.0, rise: 0.0, support })
}

struct Woven {
    joints: Vec<JointId>,
    /// Energy at the start, J.
    start: f32,
    gap_peak: f32,
    /// Largest kinetic energy, J.
    kinetic_peak: f32,
    /// Largest rise of the energy above its start, J.
    rise: f32,
    support: Support,
}

impl Woven {
    fn gaps<'a>(&'a self, world: &'a World) -> impl Iterator<Item = f32> + 'a {
        self.joints.iter().map(|&joint| world.joint_gap(joint))
    }
}

impl Script for Woven {
    fn after_step(&mut self, world: &mut World) {
        self.gap_peak = self.gaps(world).fold(self.gap_peak, max);
        self.support.after_step(world);
        let energy = world.energy();
        self.kinetic_peak = max(self.kinetic_peak, energy.kinetic);
        self.rise = max(self.rise, energy.total() - self.start);
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        vec![
            Metric::new("joint_gap_peak_m", self.gap_peak, Expected::AtMost(GAP)),
            Metric::new("joint_gap_end_m", self.gaps(world).fold(0.0, max), Expected::Anything),
            Metric::new("kinetic_peak_j", self.kinetic_peak, Expected::Anything),
            Metric::new("energy_rise_j", self.rise, Expected::Anything),
            self.support.metric(),
        ]
    }
}
