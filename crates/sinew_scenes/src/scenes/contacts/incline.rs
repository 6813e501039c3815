//! Bodies on a slope: Coulomb friction holds a box below its angle and lets it slide above it; a ball rolls.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, ball, body, cuboid, fixed, made_of, tilt};
use sinew::math::{Vec3, trig};
use sinew::physics::{BodyDef, BodyId, Material, Shape, World};

pub(in crate::scenes) const HOLDS: Scene = Scene {
    chapter: Chapter::Contacts,
    name: "incline_holds",
    about: "a box pushed up a slope below its friction angle stops and stays there",
    steps: 600,
    settings: &[
        Setting::number("angle", 26.0, (0.0, 80.0), "angle of the slope, degrees"),
        FRICTION,
        Setting::number("speed", 3.0, (1.5, 20.0), "initial speed up the slope, m/s"),
    ],
    build: |setup| {
        let (world, slope) = box_on_incline(setup);
        let speed = setup.number("speed");
        Instance::new(world, Holds { slope, speed, pushed: None, stopped: None })
    },
};

pub(in crate::scenes) const SLIDES: Scene = Scene {
    chapter: Chapter::Contacts,
    name: "incline_slides",
    about: "a box on a slope above its friction angle slides down at g (sin − μ cos)",
    steps: 240,
    settings: &[Setting::number("angle", 35.0, (0.0, 80.0), "angle of the slope, degrees"), FRICTION],
    build: |setup| {
        let (world, slope) = box_on_incline(setup);
        let pull = slope.pull - slope.hold;
        Instance::new(world, Slides { slope, pull, settled: None })
    },
};

pub(in crate::scenes) const ROLLS: Scene = Scene {
    chapter: Chapter::Contacts,
    name: "incline_rolls",
    about: "a ball rolls down a slope at 5/7 g sin, whatever its friction",
    steps: 240,
    settings: &[Setting::number("angle", 35.0, (0.0, 60.0), "angle of the slope, degrees"), FRICTION],
    build: |setup| {
        let (world, slope) = incline(setup, ball(BALL_RADIUS, Vec3::Y * BALL_RADIUS));
        // A homogeneous ball has `1 / (1 + 2/5)` of the acceleration.
        let pull = slope.pull * 5.0 / 7.0;
        Instance::new(world, Slides { slope, pull, settled: None })
    },
};

const BALL_RADIUS: f32 = 0.25;

/// Coefficient of friction. With the default the friction angle is 26.565°.
const FRICTION: Setting = Setting::number("friction", 0.5, (0.0, 2.0), "coefficient");

const HALF_EXTENTS: Vec3 = Vec3::new(0.3, 0.1, 0.3);
/// Distance uphill from the origin, along the slope, at which the box starts, metres.
const UPHILL: f32 = 10.0;
/// Number of steps until the contact carries the weight, sinking by a millimetre: until then friction is incomplete.
const SETTLING: u64 = 60;

fn box_on_incline(setup: &Setup<'_>) -> (World, Slope) {
    incline(setup, cuboid(HALF_EXTENTS, Vec3::Y * HALF_EXTENTS.y))
}

/// Builds a slope with a body given at the origin of a horizontal floor.
fn incline(setup: &Setup<'_>, body_at_origin: BodyDef) -> (World, Slope) {
    let mut world = setup.world();
    let (angle, friction) = (setup.number("angle"), setup.number("friction"));
    let (turn, material) = (tilt(angle), Material { friction, ..Material::default() });
    let mut ground = fixed(made_of(body(Shape::HalfSpace, Vec3::ZERO), material));
    ground.rotation = turn;
    world.add_body(&ground);
    let mut block = made_of(body_at_origin, material);
    block.position = turn * (block.position + Vec3::X * UPHILL);
    block.rotation = turn;
    let block = world.add_body(&block);
    let (sin, cos) = trig::sin_cos(angle.to_radians());
    let slope = Slope { block, uphill: turn * Vec3::X, pull: GRAVITY * sin, hold: GRAVITY * friction * cos };
    (world, slope)
}

/// A body on a slope.
struct Slope {
    block: BodyId,
    uphill: Vec3,
    /// Component of gravity along the slope, m/s².
    pull: f32,
    /// Largest acceleration that friction can resist, m/s².
    hold: f32,
}

/// Motion of the box at some time.
#[derive(Clone, Copy)]
struct Motion {
    /// Position along the slope, metres.
    place: f32,
    /// Speed, m/s.
    speed: f32,
    /// Time, s.
    time: f32,
}

impl Slope {
    /// Motion along the slope; uphill is positive.
    fn motion(&self, world: &World) -> Motion {
        Motion {
            place: world.transform(self.block).translation.dot(self.uphill),
            speed: world.velocity(self.block).linear.dot(self.uphill),
            time: world.time() as f32,
        }
    }
}

struct Holds {
    slope: Slope,
    /// Speed after the push, m/s.
    speed: f32,
    pushed: Option<Motion>,
    stopped: Option<Motion>,
}

impl Script for Holds {
    fn after_step(&mut self, world: &mut World) {
        if world.step_count() == SETTLING {
            let block = self.slope.block;
            let impulse = self.slope.uphill * (world.mass(block).mass * self.speed);
            world.apply_impulse_at_center(block, impulse);
            self.pushed = Some(self.slope.motion(world));
        } else if self.pushed.is_some() && self.stopped.is_none() {
            self.stopped = Some(self.slope.motion(world)).filter(|motion| motion.speed < 1e-3);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let way = self.pushed.zip(self.stopped).map(|(from, to)| to.place - from.place);
        let h = world.def().dt() / world.def().substeps as f32;
        let brake = self.slope.pull + self.slope.hold;
        // Symplectic Euler moves by the speed at the end of each substep.
        let expected = 0.5 * self.speed * (self.speed / brake - h);
        let crept = self.stopped.map(|from| (self.slope.motion(world).place - from.place).abs());
        vec![
            Metric::awaited("way_up_m", way, Expected::near(expected, 0.006)),
            Metric::awaited("crept_m", crept, Expected::AtMost(1e-3)),
        ]
    }
}

struct Slides {
    slope: Slope,
    /// Component of gravity along the slope less friction, m/s².
    pull: f32,
    settled: Option<Motion>,
}

impl Script for Slides {
    fn after_step(&mut self, world: &mut World) {
        if world.step_count() == SETTLING {
            self.settled = Some(self.slope.motion(world));
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let slid = self.settled.map(|from| {
            let now = self.slope.motion(world);
            let t = now.time - from.time;
            let acceleration = 2.0 * (from.place - now.place + from.speed * t) / (t * t);
            (from.place - now.place, acceleration)
        });
        vec![
            Metric::awaited("slid_m", slid.map(|(way, _)| way), Expected::Anything),
            Metric::awaited("pull_m_s2", slid.map(|(_, pull)| pull), Expected::near(self.pull, 0.005)),
        ]
    }
}
