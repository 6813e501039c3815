//! MuJoCo's humanoid falls limp on its face and on its back, and must come to rest as in MuJoCo.

use crate::framework::flight::Flight;
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use sinew::formats::mjcf::{MjcfInstance, MjcfModel};
use sinew::math::{Transform, Vec3, max};
use sinew::physics::{BodyId, BodyKind, JointId, World};

/// Fall of MuJoCo's humanoid; not listed, because it needs an external file.
pub(in crate::scenes) const DROP: Scene = Scene {
    chapter: Chapter::Ragdolls,
    name: "mjcf_drop",
    about: "MuJoCo's humanoid falls on its face and on its back, and rests as high as in MuJoCo",
    steps: 600,
    settings: &[
        Setting::model("file", "the humanoid, or another model in MJCF"),
        Setting::whole("pose", 0, (0, 2), "1: on its face, 2: on its back, 0: both beside each other"),
        Setting::number("height", 1.0, (0.0, 50.0), "height above the pose in the file, m"),
    ],
    build: drop,
};

/// A keyframe to start from.
struct Start {
    keyframe: &'static str,
    /// Height of the centre of mass at rest, metres: MuJoCo 4.0.0 after 10 s, in which its soft friction lets the
    /// humanoid creep. Without slip (stiff contacts, `noslip_iterations`) it rests at 0.082 and 0.090.
    rest_height: f64,
    names: Names,
}

/// Names of the metrics for a start.
struct Names {
    rest_height: &'static str,
    asleep: &'static str,
    gap_max: &'static str,
    gap_p99: &'static str,
    overshoot_max: &'static str,
    overshoot_p99: &'static str,
    penetration_max: &'static str,
    penetration_rest: &'static str,
}

const STARTS: [Start; 2] = [
    Start {
        keyframe: "prone",
        rest_height: 0.079,
        names: Names {
            rest_height: "prone_rest_height_m",
            asleep: "prone_asleep_s",
            gap_max: "prone_joint_gap_max_m",
            gap_p99: "prone_joint_gap_p99_m",
            overshoot_max: "prone_limit_overshoot_max_deg",
            overshoot_p99: "prone_limit_overshoot_p99_deg",
            penetration_max: "prone_penetration_max_m",
            penetration_rest: "prone_penetration_rest_max_m",
        },
    },
    Start {
        keyframe: "supine",
        rest_height: 0.083,
        names: Names {
            rest_height: "supine_rest_height_m",
            asleep: "supine_asleep_s",
            gap_max: "supine_joint_gap_max_m",
            gap_p99: "supine_joint_gap_p99_m",
            overshoot_max: "supine_limit_overshoot_max_deg",
            overshoot_p99: "supine_limit_overshoot_p99_deg",
            penetration_max: "supine_penetration_max_m",
            penetration_rest: "supine_penetration_rest_max_m",
        },
    },
];

/// Distance from one humanoid to the next, metres.
const APART: f32 = 3.0;

fn drop(setup: &Setup<'_>) -> Instance {
    let model = setup.model();
    let mut world = setup.world();
    let asked = setup.whole("pose");
    let mut figures = Vec::new();
    for (place, start) in STARTS.iter().enumerate().filter(|(place, _)| asked == 0 || asked == place + 1) {
        let aside = Vec3::new(0.0, setup.number("height"), APART * place as f32);
        let ground = if figures.is_empty() { Ground::Keep } else { Ground::Remove };
        figures.push(Figure::spawn(&mut world, model, start, aside, ground));
    }
    let bodies = figures[0].bodies.clone();
    let flight = Flight::new(&world, bodies);
    Instance::new(world, Fallen { figures, flight })
}

/// Choice to add the model's static body to the world or not.
#[derive(Clone, Copy, PartialEq)]
enum Ground {
    Keep,
    /// The world already has a floor, and contacts with a second one at the same position would push twice.
    Remove,
}

/// A falling model and its measurements.
struct Figure {
    start: &'static Start,
    bodies: Vec<BodyId>,
    joints: Vec<JointId>,
    /// Gaps and overshoots of each joint after each step, metres and degrees.
    gaps: Vec<f32>,
    overshoots: Vec<f32>,
    penetration_max: f32,
    asleep: Option<f32>,
}

impl Figure {
    /// Returns the pose of the keyframe, or of the file if it has none of that name, moved by `aside`.
    fn spawn(
        world: &mut World,
        model: &MjcfModel,
        start: &'static Start,
        aside: Vec3,
        ground: Ground,
    ) -> Self {
        let keyframe = model.keyframe(start.keyframe);
        let mut pose = keyframe.map_or_else(|| model.rest_pose(), |keyframe| model.pose(keyframe));
        for (at, body) in pose.iter_mut().zip(&model.bodies) {
            if body.def.kind == BodyKind::Dynamic {
                *at = Transform::from_translation(aside) * *at;
            }
        }
        let MjcfInstance { bodies, joints } = model.spawn_at(world, &pose);
        if ground == Ground::Remove {
            world.remove_body(bodies[0]);
        }
        Self {
            start,
            bodies: bodies[1..].to_vec(),
            joints,
            gaps: Vec::new(),
            overshoots: Vec::new(),
            penetration_max: 0.0,
            asleep: None,
        }
    }

    fn after_step(&mut self, world: &World) {
        for &joint in &self.joints {
            self.gaps.push(world.joint_gap(joint));
            self.overshoots.push(world.joint_overshoot(joint).to_degrees());
        }
        self.penetration_max = max(self.penetration_max, self.penetration(world));
        let sleeps = self.bodies.iter().all(|&body| !world.is_awake(body));
        self.asleep = self.asleep.filter(|_| sleeps).or_else(|| sleeps.then(|| world.time() as f32));
    }

    fn penetration(&self, world: &World) -> f32 {
        self.bodies.iter().fold(0.0, |deepest, &body| max(deepest, world.penetration(body)))
    }

    /// Height of the centre of mass of the whole humanoid, metres.
    fn height(&self, world: &World) -> f32 {
        let mass = |body: &BodyId| world.mass(*body).mass;
        let moment: f32 = self.bodies.iter().map(|body| mass(body) * world.center_of_mass(*body).y).sum();
        moment / self.bodies.iter().map(mass).sum::<f32>()
    }

    fn metrics(&self, world: &World) -> [Metric; 8] {
        let Start { rest_height, names, .. } = self.start;
        let height = Expected::Near { value: *rest_height, tolerance: 0.01 };
        let deepest = |values: &[f32]| values.iter().copied().fold(0.0, max);
        [
            Metric::new(names.rest_height, self.height(world), height),
            Metric::awaited(names.asleep, self.asleep, Expected::AtMost(6.0)),
            Metric::new(names.gap_max, deepest(&self.gaps), Expected::AtMost(5e-3)),
            Metric::new(names.gap_p99, p99(&self.gaps), Expected::AtMost(1e-3)),
            Metric::new(names.overshoot_max, deepest(&self.overshoots), Expected::AtMost(4.0)),
            Metric::new(names.overshoot_p99, p99(&self.overshoots), Expected::AtMost(2.0)),
            Metric::new(names.penetration_max, self.penetration_max, Expected::Anything),
            Metric::new(names.penetration_rest, self.penetration(world), Expected::AtMost(5e-3)),
        ]
    }
}

fn p99(values: &[f32]) -> f32 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f32::total_cmp);
    let rank = (sorted.len() * 99).div_ceil(100).saturating_sub(1);
    sorted.get(rank).copied().unwrap_or(0.0)
}

struct Fallen {
    figures: Vec<Figure>,
    /// Free fall of the first humanoid.
    flight: Flight,
}

impl Script for Fallen {
    fn after_step(&mut self, world: &mut World) {
        self.flight.after_step(world);
        self.figures.iter_mut().for_each(|figure| figure.after_step(world));
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let mut metrics = vec![self.flight.metric()];
        metrics.extend(self.figures.iter().flat_map(|figure| figure.metrics(world)));
        metrics
    }
}
