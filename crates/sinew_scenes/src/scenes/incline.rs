//! A box on a slope: Coulomb friction holds below its angle and slides above it.

use super::metric::{Expected, Metric};
use super::parts::{GRAVITY, body, cuboid, fixed, made_of, tilt};
use super::{Instance, Scene, Script, Setting, Setup};
use sinew::math::{Vec3, trig};
use sinew::physics::{BodyId, Material, Shape, World};

pub(super) const HOLDS: Scene = Scene {
    name: "incline_holds",
    about: "a box on a slope below its friction angle stays where it is",
    steps: 600,
    settings: &[ANGLE_BELOW, FRICTION],
    build: incline,
};

pub(super) const SLIDES: Scene = Scene {
    name: "incline_slides",
    about: "a box on a slope above its friction angle slides down by ½ g (sin − μ cos) t²",
    steps: 300,
    settings: &[ANGLE_ABOVE, FRICTION],
    build: incline,
};

/// The friction angle of the default friction is 26.565°.
const ANGLE_BELOW: Setting = Setting::number("angle", 26.0, (0.0, 80.0), "of the slope, degrees");
const ANGLE_ABOVE: Setting = Setting::number("angle", 30.0, (0.0, 80.0), "of the slope, degrees");
const FRICTION: Setting = Setting::number("friction", 0.5, (0.0, 2.0), "coefficient");

const HALF_EXTENTS: Vec3 = Vec3::new(0.3, 0.1, 0.3);
/// Where the box starts, along the slope from the origin, metres.
const UPHILL: f32 = 10.0;

fn incline(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    let (angle, friction) = (setup.number("angle"), setup.number("friction"));
    let (turn, material) = (tilt(angle), Material { friction, ..Material::default() });
    let mut slope = fixed(made_of(body(Shape::HalfSpace, Vec3::ZERO), material));
    slope.rotation = turn;
    world.add_body(&slope);
    let mut block = made_of(cuboid(HALF_EXTENTS, turn * Vec3::new(UPHILL, HALF_EXTENTS.y, 0.0)), material);
    block.rotation = turn;
    let block = world.add_body(&block);
    let (sin, cos) = trig::sin_cos(angle.to_radians());
    let pull = GRAVITY * (sin - friction * cos);
    let start = world.transform(block).translation;
    Instance::new(world, Incline { block, start, downhill: turn * Vec3::NEG_X, pull })
}

struct Incline {
    block: BodyId,
    start: Vec3,
    downhill: Vec3,
    /// Along the slope, less friction, m/s².
    pull: f32,
}

impl Script for Incline {
    fn after_step(&mut self, _: &mut World) {}

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let slid = (world.transform(self.block).translation - self.start).dot(self.downhill);
        let t = world.time() as f32;
        let expected = if self.pull > 0.0 {
            Expected::near(0.5 * self.pull * t * t, 0.009)
        } else {
            Expected::Near { value: 0.0, tolerance: 1e-3 }
        };
        let potential = world.body_energy(self.block).potential;
        let weight = world.mass(self.block).mass * GRAVITY;
        let height = (self.start + self.downhill * slid).y;
        vec![
            Metric::new("slid_m", slid, expected),
            Metric::new("potential_j", potential, Expected::near(weight * height, 0.005)),
        ]
    }
}
