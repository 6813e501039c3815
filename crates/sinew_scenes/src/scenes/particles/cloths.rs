//! Cloth that hangs by two corners.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::GRAVITY;
use sinew::math::{Vec3, max};
use sinew::physics::particles::{Cloth, ClothDef};
use sinew::physics::{GroupId, World};

pub(in crate::scenes) const CLOTH: Scene = Scene {
    chapter: Chapter::Particles,
    name: "cloth",
    about: "a cloth swings down and hangs by two corners with almost no stretch",
    steps: 480,
    settings: &[SIDE, MASS],
    build: |setup| {
        let mut world = setup.world();
        let mut cloth = level(setup);
        let [a, b, ..] = cloth.corners();
        cloth.hang(&[a, b]);
        cloth.group.linear_damping = 2.0;
        let cloth = world.add_particles(&cloth.group);
        Instance::new(world, Held { cloth, weight: setup.number("mass") * GRAVITY })
    },
};

const SIDE: Setting = Setting::whole("side", 12, (2, 100), "number of springs along each edge");
const MASS: Setting = Setting::number("mass", 0.3, (0.01, 10.0), "mass of the cloth, kg");
/// Length of each edge, metres.
const EDGE: f32 = 1.0;

/// A level square of cotton around the origin.
fn level(setup: &Setup<'_>) -> Cloth {
    let side = setup.whole("side") as u32;
    let mut cloth = ClothDef {
        corner: Vec3::new(-0.5, 0.0, -0.5) * EDGE,
        across: Vec3::X * EDGE,
        down: Vec3::Z * EDGE,
        columns: side,
        rows: side,
        mass: setup.number("mass"),
        stretching: 2000.0,
        shearing: 200.0,
        bending: 1e-5,
        damping_ratio: 0.1,
        radius: 0.01,
    }
    .build();
    // With so many iterations the springs reach their full stiffness.
    cloth.group.iterations = 12;
    cloth
}

struct Held {
    cloth: GroupId,
    /// Weight that the corners carry, including the cloth, N.
    weight: f32,
}

impl Script for Held {
    fn metrics(&self, world: &World) -> Vec<Metric> {
        let cloth = world.particles(self.cloth);
        let substep = world.def().dt() / world.def().substeps as f32;
        let carried: f32 = cloth.attachment_impulses().iter().map(|p| -p.y / substep).sum();
        // Measure along the threads only: the diagonals are soft.
        let threads = cloth.springs().iter().enumerate().filter(|(_, s)| s.stiffness > 500.0);
        let mut stretches: Vec<f32> = threads.map(|(i, s)| cloth.stretch(i).abs() / s.rest_length).collect();
        stretches.sort_unstable_by(f32::total_cmp);
        let fastest = cloth.velocities().iter().fold(0.0, |most, v| max(most, v.length()));
        vec![
            Metric::new("carried_n", carried, Expected::near(self.weight, 0.005)),
            Metric::new("stretch_p95", stretches[stretches.len() * 95 / 100], Expected::AtMost(0.002)),
            Metric::new("fastest_m_s", fastest, Expected::AtMost(0.05)),
        ]
    }
}
