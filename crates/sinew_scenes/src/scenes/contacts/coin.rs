//! A coin that whirls on its rim.

use crate::framework::flight::Flight;
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::framework::turn::Turn;
use crate::parts::{GRAVITY, ball, body, floor, tilt};
use sinew::math::{Vec3, trig};
use sinew::physics::{BodyDef, BodyId, Material, Shape, ShapeId, World};

pub(in crate::scenes) const COIN: Scene = Scene {
    chapter: Chapter::Contacts,
    name: "coin",
    about: "a leaning coin rolls in a circle on its rim at the rate of a closed form, sinks and comes to rest flat",
    steps: 600,
    settings: &[Setting::number(
        "tilt",
        50.0,
        (50.0, 75.0),
        "initial angle of its faces from the level, degrees",
    )],
    build,
};

/// Radius of the coin, metres.
const RADIUS: f32 = 0.5;
const HALF_THICKNESS: f32 = 0.02;
/// Duration of the rate measurement, seconds.
const MEASURED: f64 = 0.5;
/// Rolling resistance after the measurement, metres: without it the coin would whirl for minutes.
const ROLLING: f32 = 0.02;

fn build(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let degrees = setup.number("tilt");
    let (sin, cos) = trig::sin_cos(degrees.to_radians());
    let rotation = tilt(degrees);
    // Rotates the coin about the line from its centre to the contact point, so that neither moves.
    let line = rotation * Vec3::new(1.0, HALF_THICKNESS / RADIUS, 0.0);
    let cylinder = Shape::Cylinder { half_height: HALF_THICKNESS, radius: RADIUS };
    let coin = world.add_body(&BodyDef {
        rotation,
        angular_velocity: line * (rate(sin, cos) * sin),
        ..body(cylinder, Vec3::Y * (RADIUS * sin + HALF_THICKNESS * cos))
    });
    let plumb = world.add_body(&ball(0.02, Vec3::new(0.0, 5.0, 20.0)));
    let flight = Flight::new(&world, vec![plumb]);
    Instance::new(world, Coin { coin, turn: Turn::default(), due: 0.0, looks: 0, asleep: None, flight })
}

/// Rate at which the contact point circles while the centre of mass stays at rest, rad/s, for sine and cosine of the
/// tilt: the torque of the weight turns the tilted angular momentum. For a thin disc it is `√(4 g / (a sin θ))`
/// (Moffatt 2000, "Euler's disk and its finite-time singularity").
fn rate(sin: f32, cos: f32) -> f32 {
    let (a, h) = (RADIUS, HALF_THICKNESS);
    // Moments of inertia divided by the mass.
    let (across, along) = (a * a / 4.0 + h * h / 3.0, a * a / 2.0);
    (GRAVITY * (a * cos - h * sin) / (sin * (across * cos - along * (h / a) * sin))).sqrt()
}

struct Coin {
    coin: BodyId,
    /// Rotation of the coin's axis about the vertical.
    turn: Turn,
    /// Sum of the theoretical rates at the observed tilts, rad/s.
    due: f32,
    /// Number of rates in `due`.
    looks: u16,
    /// Time at which the coin fell asleep, seconds.
    asleep: Option<f32>,
    /// Free fall of a ball, to verify gravity.
    flight: Flight,
}

impl Script for Coin {
    fn after_step(&mut self, world: &mut World) {
        self.flight.after_step(world);
        if self.asleep.is_none() && !world.is_awake(self.coin) {
            self.asleep = Some(world.time() as f32);
        }
        if world.time() > MEASURED {
            return;
        }
        let axis = world.transform(self.coin).rotation * Vec3::Y;
        self.turn.after_step(trig::atan2(-axis.z, axis.x), world.def().dt());
        self.due += rate((1.0 - axis.y * axis.y).sqrt(), axis.y);
        self.looks += 1;
        if world.time() + f64::from(world.def().dt()) > MEASURED {
            let material = Material { rolling: ROLLING, ..Material::default() };
            world.set_material(ShapeId { body: self.coin, shape: 0 }, material);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let height = world.center_of_mass(self.coin).y;
        let flat = Expected::Near { value: HALF_THICKNESS.into(), tolerance: 1e-3 };
        let due = self.due / f32::from(self.looks.max(1));
        vec![
            self.flight.metric(),
            Metric::awaited("whirl_rad_s", self.turn.rate(), Expected::near(due, 0.02)),
            Metric::new("height_end_m", height, flat),
            Metric::awaited("asleep_s", self.asleep, Expected::AtMost(10.0)),
        ]
    }
}
