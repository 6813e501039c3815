//! An arch of stones without mortar, held by thrust and friction alone.

use crate::blueprint::arch::{Joint, arch, joints};
use crate::framework::camera_hint::CameraHint;
use crate::framework::flight::Flight;
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::framework::stand::{Bars, Stand};
use crate::parts::{GRAVITY, ball, hook};
use sinew::math::{Transform, Vec3, max, min};
use sinew::physics::{
    BodyId, BodyKind, JointDef, JointId, JointKind, Reaction, SleepThresholds, World, WorldDef,
};

pub(in crate::scenes) const ARCH: Scene = Scene {
    chapter: Chapter::Piles,
    name: "arch",
    about: "an arch of stones without mortar stands under blocks; the forces on its piers show that the thrust stays within the stones",
    steps: 600,
    settings: &[
        Setting::whole("stones", 15, (3, 31), "number of stones; an even number gets one more"),
        Setting::whole("blocks", 4, (0, 10), "number of blocks on the keystone"),
    ],
    build,
};

fn build(setup: &Setup<'_>) -> Instance {
    // Contacts yield until they carry the weight; the load is measured then.
    let sleep_thresholds = SleepThresholds { time: 2.0, ..SleepThresholds::default() };
    let mut world = World::new(WorldDef { sleep_thresholds, ..setup.world_def() });
    let (stones, blocks) = (setup.whole("stones") | 1, setup.whole("blocks"));
    let mut plan = arch(stones, blocks);
    for pier in &mut plan.bodies[..2] {
        pier.kind = BodyKind::Dynamic;
    }
    let bodies = plan.build_into(&mut world).bodies;
    let masonry = Masonry::new(&world, joints(stones), &bodies[2..]);
    let feet = [(bodies[0], 0), (bodies[1], stones)];
    let piers = feet.map(|(pier, joint)| Pier::hold(&mut world, pier, masonry.joints[joint].middle));
    let plumb = world.add_body(&ball(0.02, Vec3::new(0.0, 5.0, 50.0)));
    let flight = Flight::new(&world, vec![plumb]);
    let bars = Bars {
        shift: 0.002,
        top_drift: 0.002,
        sink: 0.01,
        turn: 0.2,
        depth: 0.005,
        asleep: Expected::AtMost(4.0),
    };
    let stand = Stand::new(&world, &bodies[2..], flight, bars);
    Instance::new(world, Arch { stand, piers, masonry })
}

struct Arch {
    stand: Stand,
    /// The piers at −x and at +x.
    piers: [Pier; 2],
    masonry: Masonry,
}

impl Script for Arch {
    fn after_step(&mut self, world: &mut World) {
        self.stand.after_step(world);
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let [left, right] = self.piers.map(|pier| pier.load(world));
        let weight: f32 = self.masonry.weights.iter().map(|weight| weight.newtons).sum();
        let line = self.masonry.line_of_thrust(left);
        let mut metrics = self.stand.metrics(world);
        metrics.extend([
            Metric::new("load_n", left.force.y + right.force.y, Expected::near(weight, 0.001)),
            Metric::new("thrust_n", left.force.x, self.masonry.thrust()),
            Metric::new("thrust_off_middle", line, Expected::AtMost(1.0)),
        ]);
        metrics
    }

    fn camera_hint(&self) -> CameraHint {
        self.stand.camera_hint()
    }
}

/// Pier on which one end of an arch stands.
#[derive(Clone, Copy)]
struct Pier {
    /// Weight of the pier, N.
    weight: f32,
    /// Joint that holds the pier at the centre of its joint with the arch.
    held: JointId,
}

impl Pier {
    fn hold(world: &mut World, pier: BodyId, foot: Vec3) -> Self {
        let hook = world.add_body(&hook());
        let [a, b] = [hook, pier].map(|id| world.transform(id));
        let at = Transform::from_translation(foot);
        let held = world.add_joint(&JointDef::new(hook, pier, a, b, at, JointKind::Fixed));
        Self { weight: world.mass(pier).mass * GRAVITY, held }
    }

    /// Reaction of the pier on the arch, about the centre of their joint.
    fn load(self, world: &World) -> Reaction {
        // The pier's own weight acts right below that point.
        let Reaction { force, torque } = world.reaction(self.held);
        Reaction { force: force - Vec3::Y * self.weight, torque }
    }
}

/// Weights of an arch, and the joints that transmit them.
struct Masonry {
    /// Joints from −x to +x.
    joints: Vec<Joint>,
    /// Weights of the stones between the joints; that of the keystone includes the blocks on it.
    weights: Vec<Weight>,
}

struct Weight {
    newtons: f32,
    /// Position of the weight's centre along x, metres.
    x: f32,
}

impl Masonry {
    /// Creates the masonry of stones and of the blocks after them.
    fn new(world: &World, joints: Vec<Joint>, bodies: &[BodyId]) -> Self {
        let newtons = |&id: &BodyId| world.mass(id).mass * GRAVITY;
        let (stones, blocks) = bodies.split_at(joints.len() - 1);
        let weight = |id: &BodyId| Weight { newtons: newtons(id), x: world.center_of_mass(*id).x };
        let mut weights: Vec<_> = stones.iter().map(weight).collect();
        weights[stones.len() / 2].newtons += blocks.iter().map(newtons).sum::<f32>();
        Self { joints, weights }
    }

    /// Largest distance from the centre of a joint at which the line of thrust crosses the joint, as a share of half
    /// the joint. The line follows from the reaction of the first pier. At 1 the joint opens like a hinge.
    fn line_of_thrust(&self, pier: Reaction) -> f32 {
        let mut force = pier.force;
        // Moment about the world's z axis.
        let mut moment = pier.torque.z + self.joints[0].middle.cross(force).z;
        let crossing = |joint: &Joint, force: Vec3, moment: f32| {
            let about_middle = moment - joint.middle.cross(force).z;
            (about_middle / joint.half.cross(force).z).abs()
        };
        let mut farthest = crossing(&self.joints[0], force, moment);
        for (joint, weight) in self.joints[1..].iter().zip(&self.weights) {
            force.y -= weight.newtons;
            moment -= weight.x * weight.newtons;
            farthest = max(farthest, crossing(joint, force, moment));
        }
        farthest
    }

    /// Thrust of the halves against each other: the smallest and the largest at which the line of thrust is within the
    /// foot and within the keystone's joint (Heyman 1966, "The stone skeleton").
    ///
    /// The moments about the foot at `p` of half of the keystone's load `P` and of the stones on this side balance that
    /// of the thrust `H` at `q` in the keystone's joint: `H (q − p)_y = Σ w (x − p_x) + P/2 (q − p)_x`.
    fn thrust(&self) -> Expected {
        let keystone = self.weights.len() / 2;
        let half_load = 0.5 * self.weights[keystone].newtons;
        let thrust = |foot: Vec3, top: Vec3| {
            let turning = |weight: &Weight| weight.newtons * (weight.x - foot.x);
            let stones: f32 = self.weights[..keystone].iter().map(turning).sum();
            (stones + half_load * (top.x - foot.x)) / (top.y - foot.y)
        };
        let (mut least, mut most) = (f32::INFINITY, 0.0);
        for foot in self.joints[0].ends() {
            for top in self.joints[keystone].ends() {
                least = min(least, thrust(foot, top));
                most = max(most, thrust(foot, top));
            }
        }
        let [value, tolerance] = [0.5 * (least + most), 0.5 * (most - least)].map(f64::from);
        Expected::Near { value, tolerance }
    }
}
