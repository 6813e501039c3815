//! Weights on chains and ropes of light links: no joint opens.

use crate::blueprint::{Blueprint, chain_100_links, chain_hang, chain_swing, hanging_rope, heavy_rope};
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::framework::support::Support;
use crate::parts::GRAVITY;
use sinew::math::{Vec3, max};
use sinew::physics::{BodyId, BodyKind, JointId, World};

pub(in crate::scenes) const SWING_1000: Scene = Scene {
    chapter: Chapter::Joints,
    name: "chain_swing_1000",
    about: "1,000 kg on a chain of 1 kg links swing from the horizontal, and no joint opens",
    steps: 600,
    settings: &[LINK],
    build: |setup| swing(setup, 1000.0, Musts { gap: Expected::AtMost(0.001), ..NO_MUSTS }),
};

pub(in crate::scenes) const SWING_100: Scene = Scene {
    chapter: Chapter::Joints,
    name: "chain_swing_100",
    about: "100 kg on a chain of 1 kg links swing from the horizontal, and no joint opens",
    steps: 600,
    settings: &[LINK],
    build: |setup| swing(setup, 100.0, Musts { gap: Expected::AtMost(0.0002), ..NO_MUSTS }),
};

pub(in crate::scenes) const HANG_1000: Scene = Scene {
    chapter: Chapter::Joints,
    name: "chain_hang_1000",
    about: "1,000 kg hang on a chain of 1 kg links",
    steps: 600,
    settings: &[],
    build: |setup| hung(setup, &[chain_hang(1000.0)], Musts { gap: Expected::AtMost(0.001), ..NO_MUSTS }),
};

pub(in crate::scenes) const HANG_100: Scene = Scene {
    chapter: Chapter::Joints,
    name: "chain_hang_100",
    about: "100 kg hang on a chain of 1 kg links",
    steps: 600,
    settings: &[],
    build: |setup| hung(setup, &[chain_hang(100.0)], Musts { gap: Expected::AtMost(0.0002), ..NO_MUSTS }),
};

pub(in crate::scenes) const LINKS_100: Scene = Scene {
    chapter: Chapter::Joints,
    name: "chain_100_links",
    about: "100 kg on each of ten chains of 100 links of 1 kg swing from the horizontal",
    steps: 600,
    settings: &[],
    build: |setup| hung(setup, &[chain_100_links()], Musts { stretch: Expected::AtMost(0.001), ..NO_MUSTS }),
};

pub(in crate::scenes) const HEAVY_ROPE: Scene = Scene {
    chapter: Chapter::Joints,
    name: "heavy_rope",
    about: "1,800 kg on a rope of 1 kg links swing from the horizontal",
    steps: 600,
    settings: &[],
    build: |setup| hung(setup, &[heavy_rope()], Musts { gap_per_link: Expected::AtMost(0.005), ..NO_MUSTS }),
};

pub(in crate::scenes) const HANGING_ROPE: Scene = Scene {
    chapter: Chapter::Joints,
    name: "hanging_rope",
    about: "200 kg hang on a rope of 48 links of 1 kg",
    steps: 600,
    settings: &[],
    build: |setup| {
        hung(setup, &[hanging_rope()], Musts { gap_per_link: Expected::AtMost(0.005), ..NO_MUSTS })
    },
};

const LINK: Setting =
    Setting::number("link", 0.0, (0.0, 10.0), "length of a link, m; 0: three chains with 1, 0.5 and 0.25 m");

/// Expectations of a chain's metrics.
struct Musts {
    gap: Expected,
    gap_per_link: Expected,
    stretch: Expected,
}

const NO_MUSTS: Musts =
    Musts { gap: Expected::Anything, gap_per_link: Expected::Anything, stretch: Expected::Anything };

fn swing(setup: &Setup<'_>, ratio: f32, musts: Musts) -> Instance {
    let link = setup.number("link");
    let lengths = if link > 0.0 { vec![link] } else { vec![1.0, 0.5, 0.25] };
    let aside = |i: usize| Vec3::Z * (3.0 * i as f32);
    let plans = lengths.iter().enumerate().map(|(i, &length)| chain_swing(ratio, length).moved(aside(i)));
    hung(setup, &plans.collect::<Vec<_>>(), musts)
}

fn hung(setup: &Setup<'_>, plans: &[Blueprint], musts: Musts) -> Instance {
    let mut world = setup.sleepless_world();
    let chains: Vec<_> = plans.iter().flat_map(|plan| Chain::build_all(&mut world, plan)).collect();
    let start = world.energy().total();
    let depth = chains.iter().map(|chain| world.mass(chain.weight).mass * GRAVITY * chain.length).sum();
    let support = Support::new(&world);
    Instance::new(world, Hung { chains, musts, start, depth, drift: 0.0, first: None, support })
}

/// A chain in a world.
struct Chain {
    /// Joints from the hook down.
    joints: Vec<JointId>,
    weight: BodyId,
    /// Distance from the first joint to the last, metres.
    length: f32,
    level: bool,
    gap_peak: f32,
    stretch_peak: f32,
}

impl Chain {
    /// Builds all chains of a plan. Each chain begins with a joint to a static body.
    fn build_all(world: &mut World, plan: &Blueprint) -> Vec<Self> {
        let built = plan.build_into(world);
        let is_first = |place: &usize| plan.bodies[plan.joints[*place].a].kind == BodyKind::Static;
        let firsts: Vec<usize> = (0..plan.joints.len()).filter(is_first).collect();
        let ends = firsts.iter().skip(1).copied().chain([plan.joints.len()]);
        let chain = |(&first, end): (&usize, usize)| {
            let anchor = |place: usize| plan.joints[place].world_from_joint.translation;
            let along = anchor(end - 1) - anchor(first);
            Self {
                joints: built.joints[first..end].to_vec(),
                weight: built.bodies[plan.joints[end - 1].b],
                length: along.length(),
                level: along.y == 0.0,
                gap_peak: 0.0,
                stretch_peak: 0.0,
            }
        };
        firsts.iter().zip(ends).map(chain).collect()
    }

    /// Sum of the chain's gaps as a share of its length.
    fn stretch(&self, world: &World) -> f32 {
        self.joints.iter().map(|&joint| world.joint_gap(joint)).sum::<f32>() / self.length
    }

    fn after_step(&mut self, world: &World) {
        let gaps = self.joints.iter().map(|&joint| world.joint_gap(joint));
        self.gap_peak = gaps.fold(self.gap_peak, max);
        self.stretch_peak = max(self.stretch_peak, self.stretch(world));
    }

    fn gap_per_link(&self) -> f32 {
        self.gap_peak / (self.length / (self.joints.len() - 1) as f32)
    }
}

/// Chains and their measurements.
struct Hung {
    chains: Vec<Chain>,
    musts: Musts,
    /// Energy at the start, J.
    start: f32,
    /// Potential energy of the weights with level chains, relative to their lowest points, J.
    depth: f32,
    /// Largest deviation of the energy from the start, J.
    drift: f32,
    /// Smallest downward acceleration of a weight on a level chain in the first step, m/s².
    first: Option<f32>,
    support: Support,
}

impl Script for Hung {
    fn after_step(&mut self, world: &mut World) {
        for chain in &mut self.chains {
            chain.after_step(world);
        }
        self.support.after_step(world);
        self.drift = max(self.drift, (world.energy().total() - self.start).abs());
        if world.step_count() == 1 {
            let level = self.chains.iter().filter(|chain| chain.level);
            let rates = level.map(|chain| -world.velocity(chain.weight).linear.y / world.def().dt());
            self.first = rates.reduce(sinew::math::min);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let worst = |figure: &dyn Fn(&Chain) -> f32| self.chains.iter().map(figure).fold(0.0, max);
        let Musts { gap, gap_per_link, stretch } = self.musts;
        let mut metrics = vec![
            Metric::new("joint_gap_peak_m", worst(&|chain| chain.gap_peak), gap),
            Metric::new("gap_per_link", worst(&Chain::gap_per_link), gap_per_link),
            Metric::new("stretch", worst(&|chain| chain.stretch_peak), stretch),
            Metric::new("stretch_end", worst(&|chain| chain.stretch(world)), stretch),
            Metric::new("energy_drift", self.drift / self.depth, Expected::Anything),
            self.support.metric(),
        ];
        if self.chains.iter().any(|chain| chain.level) {
            // A level chain at rest carries none of its weight: the force of the hook decays link by link.
            metrics.push(Metric::awaited("first_m_s2", self.first, Expected::near(GRAVITY, 0.002)));
        }
        metrics
    }
}
