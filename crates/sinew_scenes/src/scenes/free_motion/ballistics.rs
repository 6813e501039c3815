//! Flying bodies: free fall, projectile, bounce.

use crate::framework::flight::Flight;
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{ball, fallen, floor, made_of};
use sinew::math::{Vec3, max};
use sinew::physics::{BodyId, Material, World};

pub(in crate::scenes) const FREE_FALL: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "free_fall",
    about: "a ball falls through empty space by the integrator's formula, exact to the last digits",
    steps: 600,
    settings: &[],
    build: |setup| {
        let mut world = setup.sleepless_world();
        let ball = world.add_body(&ball(0.1, Vec3::ZERO));
        Instance::new(world, Thrown { ball, velocity: Vec3::ZERO })
    },
};

pub(in crate::scenes) const PROJECTILE: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "projectile",
    about: "a ball thrown without drag flies along its parabola",
    steps: 120,
    settings: &[
        Setting::number("forward", 10.0, (-100.0, 100.0), "speed along x, m/s"),
        Setting::number("up", 12.0, (-100.0, 100.0), "speed along y, m/s"),
    ],
    build: |setup| {
        let mut world = setup.sleepless_world();
        let velocity = Vec3::new(setup.number("forward"), setup.number("up"), 0.0);
        let mut def = ball(0.05, Vec3::ZERO);
        def.linear_velocity = velocity;
        let ball = world.add_body(&def);
        Instance::new(world, Thrown { ball, velocity })
    },
};

/// A ball that left the origin at some velocity.
struct Thrown {
    ball: BodyId,
    velocity: Vec3,
}

impl Script for Thrown {
    fn metrics(&self, world: &World) -> Vec<Metric> {
        let at = world.transform(self.ball).translation;
        let drop = fallen(world);
        let height = f64::from(self.velocity.y) * world.time() - drop;
        let range = f64::from(self.velocity.x) * world.time();
        // The tolerance is the rounding error of a position and a velocity of this size, added up over all substeps.
        let tolerance = 6e-6 * (drop + range.abs());
        vec![
            Metric::new("x_m", at.x, Expected::Near { value: range, tolerance }),
            Metric::new("y_m", at.y, Expected::Near { value: height, tolerance }),
        ]
    }
}

pub(in crate::scenes) const BOUNCE: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "bounce",
    about: "a dropped ball rebounds to its height times its restitution squared",
    steps: 300,
    settings: &[
        Setting::number("height", 1.0, (0.2, 10.0), "height of the drop, m"),
        Setting::number("restitution", 0.8, (0.1, 1.0), "speed after the bounce over the speed before"),
    ],
    build: bounce,
};

const BOUNCE_RADIUS: f32 = 0.1;

fn bounce(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    let (height, restitution) = (setup.number("height"), setup.number("restitution"));
    let rubber = Material { restitution, ..Material::default() };
    world.add_body(&floor());
    let ball = world.add_body(&made_of(ball(BOUNCE_RADIUS, Vec3::Y * (BOUNCE_RADIUS + height)), rubber));
    let flight = Flight::new(&world, vec![ball]);
    Instance::new(world, Bounce { ball, height, restitution, flight, rebound: None })
}

struct Bounce {
    ball: BodyId,
    height: f32,
    restitution: f32,
    flight: Flight,
    /// Greatest height since the ball first moved upward, metres.
    rebound: Option<f32>,
}

impl Script for Bounce {
    fn after_step(&mut self, world: &mut World) {
        self.flight.after_step(world);
        let speed = world.velocity(self.ball).linear.y;
        let height = world.transform(self.ball).translation.y - BOUNCE_RADIUS;
        if speed > 0.0 || self.rebound.is_some() {
            self.rebound = Some(max(height, self.rebound.unwrap_or(0.0)));
        }
    }

    fn metrics(&self, _: &World) -> Vec<Metric> {
        let rebound = self.height * self.restitution * self.restitution;
        let rebound = Metric::awaited("rebound_m", self.rebound, Expected::near(rebound, 0.002));
        vec![self.flight.metric(), rebound]
    }
}
