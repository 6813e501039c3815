//! Many ragdolls at once.

use crate::blueprint::{box_rain_of, ragdoll_pile};
use crate::framework::flight::Flight;
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::framework::stand::deepest;
use sinew::math::max;
use sinew::physics::{BodyId, BodyKind, JointId, World};

pub(in crate::scenes) const PILE: Scene = Scene {
    chapter: Chapter::Piles,
    name: "ragdoll_pile",
    about: "100 figures of 15 bodies fall into a heap, and no joint opens or bends too far",
    steps: 600,
    settings: &[],
    build: pile,
};

pub(in crate::scenes) const RAIN: Scene = Scene {
    chapter: Chapter::Piles,
    name: "box_rain",
    about: "boxes of all sizes fall into a pit: none is lost, none ends deep in another",
    steps: 400,
    settings: &[Setting::whole("boxes", 60, (1, 10_000), "number of boxes")],
    build: |setup| {
        let mut world = setup.world();
        let plan = box_rain_of(setup.whole("boxes"));
        let built = plan.build_into(&mut world);
        let bodies: Vec<_> = plan.dynamic().map(|place| built.bodies[place]).collect();
        let damping = plan.bodies[plan.bodies.len() - 1].linear_damping;
        let flight = Flight::damped(&world, bodies[..1].to_vec(), damping);
        Instance::new(world, Rain { bodies, flight })
    },
};

/// Falling boxes and their measurements.
struct Rain {
    bodies: Vec<BodyId>,
    /// Free fall of the first box.
    flight: Flight,
}

impl Script for Rain {
    fn after_step(&mut self, world: &mut World) {
        self.flight.after_step(world);
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        // Half of the smallest box's height is above this.
        let lost = self.bodies.iter().filter(|&&id| world.center_of_mass(id).y < 0.05).count();
        let depth = deepest(world, self.bodies.iter().copied());
        vec![
            self.flight.metric(),
            Metric::new("lost", lost as u32, Expected::AtMost(0.0)),
            Metric::new("depth_end_m", depth, Expected::AtMost(0.02)),
            Metric::new("kinetic_end_j", world.energy().kinetic, Expected::Anything),
        ]
    }
}

fn pile(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let plan = ragdoll_pile();
    let built = plan.build_into(&mut world);
    let bodies: Vec<_> = plan.dynamic().map(|place| built.bodies[place]).collect();
    let damping = plan.bodies[plan.bodies.len() - 1].linear_damping;
    let flight = Flight::damped(&world, bodies[..BODIES_OF_ONE].to_vec(), damping);
    let joints = built.joints;
    let heap = Pile { bodies, joints, flight, gap_max: 0.0, exceeded: 0, penetration_max: 0.0 };
    Instance::new(world, heap)
}

/// Number of bodies of a ragdoll.
const BODIES_OF_ONE: usize = 15;
/// Overshoot that counts as exceeded, radians.
const EXCEEDED: f32 = 0.1;
/// Number of steps between two checks of all overlaps: a check costs more than a step.
const LOOK: u64 = 30;

struct Pile {
    bodies: Vec<BodyId>,
    joints: Vec<JointId>,
    /// Free fall of the first ragdoll.
    flight: Flight,
    gap_max: f32,
    /// Largest number of joints beyond their limits at the same time.
    exceeded: usize,
    penetration_max: f32,
}

impl Pile {
    fn exceeded(&self, world: &World) -> usize {
        self.joints.iter().filter(|&&joint| world.joint_overshoot(joint) > EXCEEDED).count()
    }

    fn gap(&self, world: &World) -> f32 {
        self.joints.iter().fold(0.0, |gap, &joint| max(gap, world.joint_gap(joint)))
    }

    /// Overlaps of all touching pairs, shallowest first.
    fn penetrations(&self, world: &World) -> Vec<f32> {
        let of = |&id: &BodyId| {
            world
                .neighbors(id)
                .filter(move |&other| other > id || world.kind(other) == BodyKind::Static)
                .map(move |other| world.overlap(id, other))
        };
        let mut depths: Vec<f32> = self.bodies.iter().flat_map(of).collect();
        depths.sort_unstable_by(f32::total_cmp);
        depths
    }
}

impl Script for Pile {
    fn after_step(&mut self, world: &mut World) {
        self.flight.after_step(world);
        self.gap_max = max(self.gap_max, self.gap(world));
        self.exceeded = usize::max(self.exceeded, self.exceeded(world));
        if world.step_count().is_multiple_of(LOOK) {
            let deepest = self.penetrations(world).last().copied();
            self.penetration_max = max(self.penetration_max, deepest.unwrap_or(0.0));
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let depths = self.penetrations(world);
        let rank = |percent: usize| depths.get((depths.len() * percent).div_ceil(100).saturating_sub(1));
        let depth = |percent: usize| rank(percent).copied().unwrap_or(0.0);
        let count = |joints: usize| joints as u32;
        vec![
            self.flight.metric(),
            Metric::new("joint_gap_max_m", self.gap_max, Expected::AtMost(0.002)),
            Metric::new("joint_gap_end_m", self.gap(world), Expected::AtMost(0.002)),
            Metric::new("limits_exceeded", count(self.exceeded), Expected::AtMost(0.0)),
            Metric::new("limits_exceeded_end", count(self.exceeded(world)), Expected::AtMost(0.0)),
            Metric::new("penetration_max_m", max(self.penetration_max, depth(100)), Expected::Anything),
            Metric::new("penetration_end_max_m", depth(100), Expected::Anything),
            Metric::new("penetration_end_p99_m", depth(99), Expected::Anything),
            Metric::new("kinetic_end_j", world.energy().kinetic, Expected::Anything),
        ]
    }
}
