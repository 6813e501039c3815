//! Water: floating and sinking bodies.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, ball, body, cuboid, ghost, tilt};
use sinew::math::Vec3;
use sinew::physics::field::WaterPlane;
use sinew::physics::{BodyDef, BodyId, Buoyancy, FieldDef, FieldKind, Shape, World};

pub(in crate::scenes) const FLOAT: Scene = Scene {
    chapter: Chapter::Fields,
    name: "float",
    about: "a box, a ball and a capsule float at the depth of their density; a stone sinks at its terminal speed",
    steps: 600,
    settings: &[Setting::number("density", 400.0, (50.0, 950.0), "density of the floating bodies, kg/m³")],
    build: float,
};

const WATER: f32 = 1000.0;
const STONE: f32 = 2500.0;
/// Damping of the velocity relative to the water, per second.
const DAMPING: f32 = 4.0;

fn float(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let mut add = |def: BodyDef, density: f32| {
        let mut def = ghost(def);
        def.shapes[0].density = density;
        world.add_body(&def)
    };
    let density = setup.number("density");
    let capsule = body(Shape::Capsule { half_height: 0.4, radius: 0.2 }, Vec3::new(2.0, 0.1, 0.0));
    let floating = [
        add(
            BodyDef { rotation: tilt(10.0), ..cuboid(Vec3::new(0.5, 0.15, 0.3), Vec3::new(-2.0, 0.1, 0.0)) },
            density,
        ),
        add(ball(0.3, Vec3::Y * 0.1), density),
        add(BodyDef { rotation: tilt(70.0), ..capsule }, density),
    ];
    let stone = add(ball(0.1, Vec3::new(4.0, -0.2, 0.0)), STONE);
    let water = Buoyancy { density: WATER, damping: DAMPING, drag: 0.0, ..Buoyancy::default() };
    world.add_field(&FieldDef::new(FieldKind::Buoyancy(water)));
    Instance::new(world, Floating { floating, stone, density })
}

struct Floating {
    floating: [BodyId; 3],
    stone: BodyId,
    density: f32,
}

impl Floating {
    /// Share of a body's volume under water.
    fn share(world: &World, body: BodyId) -> f32 {
        let plane = WaterPlane { normal: Vec3::Y, height: 0.0 };
        let shapes = world.shapes(body);
        shapes.map(|(shape, at)| shape.submerged(&at, &plane).volume / shape.volume()).sum()
    }
}

impl Script for Floating {
    fn metrics(&self, world: &World) -> Vec<Metric> {
        let [cuboid, ball, capsule] = self.floating.map(|body| Self::share(world, body));
        // The weight `ρ V g` of the displaced water equals that of the body (Archimedes).
        let depth = || Expected::near(self.density / WATER, 2e-3);
        let sinks = (STONE / WATER - 1.0) * GRAVITY / DAMPING;
        vec![
            Metric::new("box_submerged", cuboid, depth()),
            Metric::new("ball_submerged", ball, depth()),
            Metric::new("capsule_submerged", capsule, depth()),
            Metric::new("stone_m_s", -world.velocity(self.stone).linear.y, Expected::near(sinks, 1e-3)),
        ]
    }
}
