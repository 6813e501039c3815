//! Springs between light particles that carry much heavier loads.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, cuboid};
use sinew::math::{Vec3, max};
use sinew::physics::particles::{GroupDef, ParticleDef, SpringDef};
use sinew::physics::{BodyId, World};

pub(in crate::scenes) const TRAMPOLINE: Scene = Scene {
    chapter: Chapter::Particles,
    name: "trampoline",
    about: "two heavy boxes sink onto springs, trees below one and a net below the other, and come to rest at the depth of a closed form",
    steps: 900,
    settings: &[Setting::number("mass", 100.0, (1.0, 1000.0), "mass of each box, kg")],
    build: trampoline,
};

/// Half extents of a box, metres.
const BOX: Vec3 = Vec3::new(0.3, 0.1, 0.3);
/// Number of particles along each edge of the mat below a box, and their spacing, metres.
const SIDE: u32 = 3;
const SPACING: f32 = 0.25;
/// Length of the ties to both sides along x, metres.
const SPAN: f32 = 1.0;
const TIES: u32 = 2 * SIDE * SIDE;
/// Stiffness of each tie, N/m.
const STIFFNESS: f32 = 2500.0;
/// Length of each tie at rest, as a share of the span.
const TAUT: f32 = 0.9;
/// Mass and radius of each particle, kg and metres.
const KNOT: f32 = 0.05;
const KNOT_RADIUS: f32 = 0.02;
/// Depth at which a box is released, metres: less than its rest depth.
const RELEASE_DEPTH: f32 = 0.12;

fn trampoline(setup: &Setup<'_>) -> Instance {
    // With sleep the boxes would stop within the few millimetres that count as rest.
    let mut world = setup.sleepless_world();
    let mass = setup.number("mass");
    let boxes = [(false, -0.8), (true, 0.8)].map(|(is_net, z)| {
        let mut falling = cuboid(BOX, Vec3::new(0.0, KNOT_RADIUS + BOX.y - RELEASE_DEPTH, z));
        falling.shapes[0].density = mass / (8.0 * BOX.x * BOX.y * BOX.z);
        world.add_particles(&mat(mass, is_net, Vec3::Z * z));
        world.add_body(&falling)
    });
    let weight = (mass + KNOT * (SIDE * SIDE) as f32) * GRAVITY;
    Instance::new(world, Trampoline { boxes, sag: sag(weight), heights: [0.0; 2], moved: 0.0 })
}

/// A square of particles, each on two ties. In a net springs connect neighbours; under a level box these springs keep
/// their length.
fn mat(mass: f32, is_net: bool, center: Vec3) -> GroupDef {
    let mut group = GroupDef { iterations: 4, ..GroupDef::default() };
    let critical = [f32::INFINITY, mass / TIES as f32];
    for k in 0..SIDE * SIDE {
        let place = |k: u32| (k as f32 - 0.5 * (SIDE - 1) as f32) * SPACING;
        let at = center + Vec3::new(place(k % SIDE), 0.0, place(k / SIDE));
        let [knot, left, right] = [0, 1, 2].map(|end| 3 * k + end);
        for position in [at - Vec3::Y * RELEASE_DEPTH, at - Vec3::X * SPAN, at + Vec3::X * SPAN] {
            group.particles.push(ParticleDef {
                position,
                velocity: Vec3::ZERO,
                mass: KNOT,
                radius: KNOT_RADIUS,
            });
        }
        group.hold_in_world(&[left, right]);
        for end in [left, right] {
            group.springs.push(SpringDef::new([knot, end], TAUT * SPAN, STIFFNESS).damped(1.0, critical));
        }
        if is_net {
            let next = [(k % SIDE + 1 < SIDE, 3), (k / SIDE + 1 < SIDE, 3 * SIDE)];
            for (_, further) in next.into_iter().filter(|(is_there, _)| *is_there) {
                let spring = SpringDef::new([knot, knot + further], SPACING, STIFFNESS);
                group.springs.push(spring.damped(0.1, [KNOT; 2]));
            }
        }
    }
    group
}

/// Returns the depth at which `n k (l − l₀) d/l` with `l = √(a² + d²)` supports a weight, metres, by bisection.
fn sag(weight: f32) -> f64 {
    let (span, stiffness) = (f64::from(SPAN), f64::from(STIFFNESS * TIES as f32));
    let (mut low, mut high) = (0.0, 10.0);
    for _ in 0..60 {
        let d: f64 = 0.5 * (low + high);
        let length = (span * span + d * d).sqrt();
        let borne = stiffness * (length - f64::from(TAUT) * span) * d / length;
        *(if borne < f64::from(weight) { &mut low } else { &mut high }) = d;
    }
    0.5 * (low + high)
}

struct Trampoline {
    boxes: [BodyId; 2],
    /// Expected depth, metres.
    sag: f64,
    /// Height of each box at the end of the last step, metres, and the larger of the two displacements in that step.
    heights: [f32; 2],
    moved: f32,
}

impl Script for Trampoline {
    fn after_step(&mut self, world: &mut World) {
        let heights = self.boxes.map(|id| world.center_of_mass(id).y);
        let moved = |k: usize| (heights[k] - self.heights[k]).abs();
        self.moved = max(moved(0), moved(1));
        self.heights = heights;
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let sags = self.boxes.map(|id| KNOT_RADIUS + BOX.y - world.center_of_mass(id).y);
        vec![
            Metric::new("sag_trees_m", sags[0], Expected::near(self.sag, 0.001)),
            Metric::new("sag_net_m", sags[1], Expected::near(self.sag, 0.02)),
            Metric::new("moved_in_last_step_m", self.moved, Expected::AtMost(1e-5)),
        ]
    }
}
