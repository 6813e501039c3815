//! Trees of joints with very different masses.

use crate::framework::flight::Flight;
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, body, cuboid, floor, ghost, hook};
use sinew::math::{Random, Range, Rotation, Transform, Vec3, max, trig};
use sinew::physics::{BodyDef, BodyId, JointDef, JointId, JointKind, MassProperties, Shape, Velocity, World};

pub(in crate::scenes) const HEAVY_FOOT: Scene = Scene {
    chapter: Chapter::Joints,
    name: "heavy_foot",
    about: "a leg of 69 kg lands on its foot of 1 kg at 3 m/s, and the foot does not sink in",
    steps: 600,
    settings: &[Setting::number("speed", 3.0, (0.1, 10.0), "speed at the landing, m/s")],
    build: heavy_foot,
};

const FOOT_HALF: Vec3 = Vec3::new(0.05, 0.03, 0.11);
/// Limit of the ankle in both directions, degrees: so small that a leg that reaches it cannot tip over its toes.
const ANKLE: f32 = 2.0;

/// A slightly tilted leg of 69 kg on a hinged foot.
fn heavy_foot(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    let floor = world.add_body(&floor());
    let speed = setup.number("speed");
    let height = speed * speed / (2.0 * GRAVITY);
    let ankle = Vec3::Y * (height + 2.0 * FOOT_HALF.y);
    let foot = world.add_body(&BodyDef {
        mass: Some(weighing(1.0, &Shape::Box { half_extents: FOOT_HALF })),
        ..cuboid(FOOT_HALF, ankle - Vec3::Y * FOOT_HALF.y)
    });
    let thigh = Shape::Capsule { half_height: 0.7, radius: 0.1 };
    let lean = Rotation::from_axis_angle(Vec3::X, 0.005);
    let leg = world.add_body(&BodyDef {
        rotation: lean,
        mass: Some(weighing(69.0, &thigh)),
        ..ghost(body(thigh, ankle + lean * (Vec3::Y * 0.85)))
    });
    let at = Transform::from_translation(ankle);
    let kind = JointKind::Hinge { limit: Some(Range::degrees(-ANKLE, ANKLE)) };
    let mut joint = JointDef::new(leg, foot, world.transform(leg), world.transform(foot), at, kind);
    // The joint's angle is zero where the leg is vertical.
    joint.frame_a = Transform::new(world.transform(leg).inverse_point(ankle), Rotation::IDENTITY);
    let joint = world.add_joint(&joint);
    let flight = Flight::new(&world, vec![foot, leg]);
    let stand =
        Stand { floor, foot, leg, joint, flight, sunk: 0.0, sunk_end: 0.0, overshoot: 0.0, asleep: None };
    Instance::new(world, stand)
}

fn weighing(mass: f32, shape: &Shape) -> MassProperties {
    shape.mass_properties(1.0).scaled_to(mass)
}

struct Stand {
    floor: BodyId,
    foot: BodyId,
    leg: BodyId,
    joint: JointId,
    flight: Flight,
    /// Deepest overlap of foot and floor, metres.
    sunk: f32,
    /// Present overlap of foot and floor, metres.
    sunk_end: f32,
    overshoot: f32,
    asleep: Option<f32>,
}

impl Script for Stand {
    fn after_step(&mut self, world: &mut World) {
        self.flight.after_step(world);
        self.sunk_end = world.overlap(self.foot, self.floor);
        self.sunk = max(self.sunk, self.sunk_end);
        self.overshoot = max(self.overshoot, world.joint_overshoot(self.joint));
        if self.asleep.is_none() && !world.is_awake(self.leg) {
            self.asleep = Some(world.time() as f32);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let sinks = Expected::AtMost(0.002);
        let standing = Expected::Near { value: f64::from(2.0 * FOOT_HALF.y) + 0.85, tolerance: 0.01 };
        vec![
            self.flight.metric(),
            Metric::new("penetration_max_m", self.sunk, sinks),
            Metric::new("penetration_end_m", self.sunk_end, sinks),
            Metric::awaited("asleep_s", self.asleep, Expected::AtMost(6.0)),
            Metric::new("height_m", world.center_of_mass(self.leg).y, standing),
            Metric::new("joint_gap_end_m", world.joint_gap(self.joint), Expected::AtMost(1e-3)),
            Metric::new("limit_overshoot_max_deg", self.overshoot.to_degrees(), Expected::AtMost(4.0)),
        ]
    }
}

pub(in crate::scenes) const MASS_RATIO: Scene = Scene {
    chapter: Chapter::Joints,
    name: "mass_ratio",
    about: "trees of light and heavy rods, one hanging and one falling, hold together",
    steps: 300,
    settings: &[
        Setting::number("ratio", 1e5, (1.0, 1e6), "mass of the heaviest rods over that of the lightest"),
        Setting::whole("links", 40, (2, 200), "number of rods of each tree"),
    ],
    build: mass_ratio,
};

fn mass_ratio(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let hook = world.add_body(&hook());
    let (ratio, links) = (setup.number("ratio"), setup.whole("links"));
    let mut hung = Tree::grow(&mut world, ratio, links, Vec3::ZERO);
    let root = hung.bodies[0];
    hung.join(&mut world, hook, root, Vec3::ZERO);
    let free = Tree::grow(&mut world, ratio, links, Vec3::X * 20.0);
    let spin = Vec3::new(1.0, 3.0, 2.0);
    for &id in &free.bodies {
        let linear = spin.cross(world.center_of_mass(id) - Vec3::X * 20.0);
        world.set_velocity(id, Velocity { linear, angular: spin });
    }
    let flight = Flight::new(&world, free.bodies.clone());
    Instance::new(world, Uneven { trees: [hung, free], flight, residual: 0.0, gap: 0.0 })
}

/// Half the length of a rod, metres.
const HALF_ROD: f32 = 0.2;

/// A tree of rods.
struct Tree {
    bodies: Vec<BodyId>,
    joints: Vec<Anchors>,
}

/// A joint and its anchors in the frames of its bodies.
struct Anchors {
    joint: JointId,
    a: (BodyId, Vec3),
    b: (BodyId, Vec3),
}

impl Tree {
    /// Adds rods with masses from 0.01 kg to `ratio` times that. The first starts at `root`, each other one at the end
    /// of one of the three rods before, in any direction.
    fn grow(world: &mut World, ratio: f32, links: usize, root: Vec3) -> Self {
        let mut random = Random::new(5);
        let mut tree = Self { bodies: Vec::new(), joints: Vec::new() };
        let mut ends: Vec<Vec3> = Vec::new();
        for i in 0..links {
            let mass = 0.01 * trig::exp(random.unit() * trig::ln(ratio));
            let parent = (i > 0).then(|| i - 1 - random.index(usize::min(i, 3)));
            let from = parent.map_or(root, |parent| ends[parent]);
            let along = random.direction();
            let shape = Shape::Capsule { half_height: HALF_ROD - 0.04, radius: 0.04 };
            let rod = world.add_body(&BodyDef {
                rotation: Rotation::from_arc(Vec3::Y, along),
                mass: Some(weighing(mass, &shape)),
                ..ghost(body(shape, from + along * HALF_ROD))
            });
            ends.push(from + along * (2.0 * HALF_ROD));
            tree.bodies.push(rod);
            if let Some(parent) = parent {
                tree.join(world, tree.bodies[parent], rod, from);
            }
        }
        tree
    }

    fn join(&mut self, world: &mut World, a: BodyId, b: BodyId, at: Vec3) {
        let joint = crate::parts::join(world, a, b, at);
        let [a, b] = [a, b].map(|id| (id, world.transform(id).inverse_point(at)));
        self.joints.push(Anchors { joint, a, b });
    }

    /// Largest relative speed of the two sides of a joint, as a share of the joint speeds.
    fn residual(&self, world: &World) -> f32 {
        let velocity = |(id, point): (BodyId, Vec3)| {
            world.velocity(id).at(world.transform(id).point(point) - world.center_of_mass(id))
        };
        let (mut parting, mut fastest) = (0.0, 0.0);
        for joint in &self.joints {
            let [a, b] = [joint.a, joint.b].map(velocity);
            parting = max(parting, (b - a).length());
            fastest = max(fastest, b.length());
        }
        parting / fastest
    }
}

struct Uneven {
    /// The suspended tree and the free one.
    trees: [Tree; 2],
    flight: Flight,
    residual: f32,
    gap: f32,
}

impl Script for Uneven {
    fn after_step(&mut self, world: &mut World) {
        self.flight.after_step(world);
        for tree in &self.trees {
            self.residual = max(self.residual, tree.residual(world));
            let gaps = tree.joints.iter().map(|anchors| world.joint_gap(anchors.joint));
            self.gap = gaps.fold(self.gap, max);
        }
    }

    fn metrics(&self, _: &World) -> Vec<Metric> {
        vec![
            self.flight.metric(),
            Metric::new("velocity_residual", self.residual, Expected::AtMost(1e-3)),
            Metric::new("joint_gap_max_m", self.gap, Expected::Anything),
        ]
    }
}
