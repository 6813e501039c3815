//! Things that collide with nothing but each other.

use super::metric::{Expected, Metric};
use super::parts::{ball, cuboid};
use super::{Instance, Scene, Script, Setting, Setup};
use sinew::math::{Random, Vec3};
use sinew::physics::{Momentum, Sleeping, World, WorldDef};

pub(super) const ZERO_GRAVITY_PILE: Scene = Scene {
    name: "zero_gravity_pile",
    about: "balls and boxes collide in free space, and the sum of their momenta stays",
    steps: 1000,
    settings: &[Setting::whole("bodies", 60, (2, 2000), "number of bodies")],
    build: zero_gravity_pile,
};

fn zero_gravity_pile(setup: &Setup<'_>) -> Instance {
    let mut world =
        World::new(WorldDef { gravity: Vec3::ZERO, sleeping: Sleeping::Off, ..WorldDef::default() });
    let bodies = setup.whole("bodies");
    let mut random = Random::new(11);
    // As dense for any number of bodies.
    let spread = 0.8 * sinew::math::trig::cbrt(bodies as f32 / 60.0);
    let mut scale = 0.0;
    for i in 0..bodies {
        let place = random.in_cube() * spread;
        let mut def = if i % 2 == 0 { ball(0.12, place) } else { cuboid(Vec3::splat(0.1), place) };
        def.linear_velocity = -place * 2.0;
        def.angular_velocity = random.in_cube() * 3.0;
        let id = world.add_body(&def);
        scale += world.mass(id).mass * def.linear_velocity.length();
    }
    let start = world.momentum();
    Instance::new(world, Pile { start, scale })
}

struct Pile {
    start: Momentum,
    /// Σ|mv| at the start, N·s.
    scale: f32,
}

impl Script for Pile {
    fn metrics(&self, world: &World) -> Vec<Metric> {
        let now = world.momentum();
        let drift = (now.linear - self.start.linear).length() / self.scale;
        let thousands = world.step_count() as f64 / 1000.0;
        let turned = (now.angular - self.start.angular).length();
        vec![
            Metric::new("momentum_drift", drift, Expected::AtMost(1e-5 * thousands)),
            Metric::new("angular_momentum_drift_n_m_s", turned, Expected::Anything),
        ]
    }
}
