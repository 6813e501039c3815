//! Surfaces with special behaviour: static friction, conveyor belts, one-way platforms, sensors.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, ball, body, cuboid, fixed, floor, made_of, tilt};
use sinew::math::{Vec3, max, trig};
use sinew::physics::{BodyId, ContactRule, Material, OneWay, Sensing, Shape, ShapeId, Velocity, World};

pub(in crate::scenes) const STATIC_FRICTION: Scene = Scene {
    chapter: Chapter::Contacts,
    name: "static_friction",
    about: "a block stays half a degree below the angle of static friction, and slides with less friction half a degree above it",
    steps: 300,
    settings: &[
        Setting::number("static", 0.6, (0.1, 2.0), "coefficient of static friction"),
        Setting::number("share", 0.5, (0.1, 0.9), "sliding friction as a share of static friction"),
    ],
    build: static_friction,
};

pub(in crate::scenes) const CONVEYOR: Scene = Scene {
    chapter: Chapter::Contacts,
    name: "conveyor",
    about: "a starting belt accelerates a box at μ g to its speed",
    steps: 180,
    settings: &[
        Setting::number("speed", 3.0, (1.0, 5.0), "speed of the belt, m/s"),
        Setting::number("friction", 0.3, (0.3, 1.0), "coefficient"),
    ],
    build: conveyor,
};

pub(in crate::scenes) const ONE_WAY: Scene = Scene {
    chapter: Chapter::Contacts,
    name: "one_way",
    about: "a ball thrown up through a one-way platform lands on it",
    steps: 240,
    settings: &[Setting::number("speed", 7.0, (5.0, 12.0), "up, m/s")],
    build: one_way,
};

pub(in crate::scenes) const SENSORS: Scene = Scene {
    chapter: Chapter::Contacts,
    name: "sensors",
    about: "a sensor reports when a falling ball enters and when it leaves",
    steps: 150,
    settings: &[Setting::number(
        "height",
        10.0,
        (3.0, 20.0),
        "distance from the ball down to the gate, metres",
    )],
    build: sensors,
};

/// Number of steps until contacts carry the weight, sinking by a millimetre: until then friction is incomplete.
const SETTLING: u64 = 60;

const HALF_EXTENTS: Vec3 = Vec3::new(0.3, 0.1, 0.3);

/// Duration of a substep, seconds.
fn substep(world: &World) -> f32 {
    world.def().dt() / world.def().substeps as f32
}

fn static_friction(setup: &Setup<'_>) -> Instance {
    let hold = setup.number("static");
    let friction = hold * setup.number("share");
    let material = Material { friction, static_friction: Some(hold), ..Material::DEFAULT };
    let angle = trig::atan2(hold, 1.0).to_degrees();
    let mut world = setup.world();
    let mut block = |angle: f32, z: f32| {
        let turn = tilt(angle);
        let slab = cuboid(Vec3::new(60.0, 0.5, 1.0), turn * (Vec3::Y * -0.5) + Vec3::Z * z);
        let mut slab = fixed(made_of(slab, material));
        slab.rotation = turn;
        world.add_body(&slab);
        let mut block =
            made_of(cuboid(HALF_EXTENTS, turn * (Vec3::Y * HALF_EXTENTS.y) + Vec3::Z * z), material);
        block.rotation = turn;
        (world.add_body(&block), turn * -Vec3::X)
    };
    let (holds, slides) = (block(angle - 0.5, -2.0), block(angle + 0.5, 2.0));
    let (sin, cos) = trig::sin_cos((angle + 0.5).to_radians());
    let pull = GRAVITY * (sin - friction * cos);
    Instance::new(world, StaticFriction { holds, slides, pull, settled: None })
}

struct StaticFriction {
    /// Both blocks with their downhill directions.
    holds: (BodyId, Vec3),
    slides: (BodyId, Vec3),
    /// Remaining acceleration of the weight along the slope, m/s².
    pull: f32,
    /// Position of the first block, metres, speed of the second, m/s, and the time, seconds.
    settled: Option<(f32, f32, f32)>,
}

impl StaticFriction {
    fn now(&self, world: &World) -> (f32, f32, f32) {
        let place = world.transform(self.holds.0).translation.dot(self.holds.1);
        (place, world.velocity(self.slides.0).linear.dot(self.slides.1), world.time() as f32)
    }
}

impl Script for StaticFriction {
    fn after_step(&mut self, world: &mut World) {
        if world.step_count() == SETTLING {
            self.settled = Some(self.now(world));
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let (place, speed, time) = self.now(world);
        let crept = self.settled.map(|(from, ..)| (place - from).abs());
        let pull = self.settled.map(|(_, before, since)| (speed - before) / (time - since));
        vec![
            Metric::awaited("crept_m", crept, Expected::AtMost(1e-3)),
            Metric::awaited("pull_m_s2", pull, Expected::near(self.pull, 0.005)),
        ]
    }
}

fn conveyor(setup: &Setup<'_>) -> Instance {
    let (speed, friction) = (setup.number("speed"), setup.number("friction"));
    let rubber = Material { friction, ..Material::DEFAULT };
    let mut world = setup.world();
    let belt = cuboid(Vec3::new(40.0, 0.5, 1.0), Vec3::Y * -0.5);
    let belt = world.add_body(&fixed(made_of(belt, rubber)));
    let load = world.add_body(&made_of(cuboid(HALF_EXTENTS, Vec3::Y * HALF_EXTENTS.y), rubber));
    let belt = ShapeId { body: belt, shape: 0 };
    let script = Conveyor { belt, load, speed, friction, work: 0.0, before: 0.0, half_way: None };
    Instance::new(world, script)
}

struct Conveyor {
    belt: ShapeId,
    load: BodyId,
    /// Speed of the belt, m/s.
    speed: f32,
    friction: f32,
    /// Energy added by friction, J.
    work: f32,
    /// Speed of the load in the last step, m/s.
    before: f32,
    /// Speed of the load, m/s, after half the needed time, and time since the start, seconds.
    half_way: Option<(f32, f32)>,
}

impl Script for Conveyor {
    fn after_step(&mut self, world: &mut World) {
        let speed = world.velocity(self.load).linear.x;
        let given: f32 = world.contacts_of(self.load).map(|contact| contact.friction.x).sum();
        self.work += given * 0.5 * (self.before + speed);
        self.before = speed;
        if world.step_count() == SETTLING {
            let material = world.material(self.belt);
            let surface_velocity = Vec3::X * self.speed;
            world.set_material(self.belt, Material { surface_velocity, ..material });
        }
        let since = world.step_count().saturating_sub(SETTLING) as f32 * world.def().dt();
        if self.half_way.is_none() && since >= 0.5 * self.speed / (self.friction * GRAVITY) {
            self.half_way = Some((speed, since));
        }
    }

    fn work_in(&self, _: &World) -> f32 {
        self.work
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let pull = self.half_way.map(|(speed, since)| speed / since);
        let slip = (world.velocity(self.load).linear.x - self.speed).abs();
        vec![
            Metric::awaited("pull_m_s2", pull, Expected::near(self.friction * GRAVITY, 0.005)),
            Metric::new("slip_m_s", slip, Expected::AtMost(1e-3)),
        ]
    }
}

const BALL_RADIUS: f32 = 0.2;
/// Top of the platform, metres.
const TOP: f32 = 1.5;

fn one_way(setup: &Setup<'_>) -> Instance {
    let speed = setup.number("speed");
    let mut world = setup.world();
    world.add_body(&floor());
    let mut platform = fixed(cuboid(Vec3::new(2.0, 0.05, 2.0), Vec3::Y * (TOP - 0.05)));
    platform.shapes[0].rule = ContactRule::OneWay(OneWay::default());
    world.add_body(&platform);
    let mut thrown = ball(BALL_RADIUS, Vec3::Y * BALL_RADIUS);
    thrown.linear_velocity = Vec3::Y * speed;
    let thrown = world.add_body(&thrown);
    Instance::new(world, Thrown { ball: thrown, speed, highest: 0.0 })
}

struct Thrown {
    ball: BodyId,
    /// Initial speed of the ball, m/s.
    speed: f32,
    /// Greatest height of the ball's centre, metres.
    highest: f32,
}

impl Script for Thrown {
    fn after_step(&mut self, world: &mut World) {
        self.highest = max(self.highest, world.transform(self.ball).translation.y);
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        // Symplectic Euler leads by half a substep of gravity.
        let speed = self.speed - 0.5 * GRAVITY * substep(world);
        let risen = Expected::near(speed * speed / (2.0 * GRAVITY), 0.003);
        let rests = Expected::Near { value: f64::from(TOP + BALL_RADIUS), tolerance: 0.002 };
        vec![
            Metric::new("risen_m", self.highest - BALL_RADIUS, risen),
            Metric::new("rests_at_m", world.transform(self.ball).translation.y, rests),
        ]
    }
}

/// Half of the gate's height, metres.
const GATE: f32 = 0.5;

fn sensors(setup: &Setup<'_>) -> Instance {
    let height = setup.number("height");
    let mut world = setup.world();
    let mut gate = fixed(body(Shape::Box { half_extents: Vec3::new(1.0, GATE, 1.0) }, Vec3::ZERO));
    gate.shapes[0].sensing = Sensing::Sensor;
    world.add_body(&gate);
    let falling = world.add_body(&ball(BALL_RADIUS, Vec3::Y * (GATE + BALL_RADIUS + height)));
    Instance::new(world, Gate { falling, height, entered: Vec::new(), left: Vec::new() })
}

struct Gate {
    falling: BodyId,
    /// Height of the fall to the gate, metres.
    height: f32,
    /// Times at which the ball entered and left, seconds.
    entered: Vec<f32>,
    left: Vec<f32>,
}

impl Gate {
    /// Time at which the ball was at a height, seconds: events refer to the start of the step, so the ball was
    /// there within the previous step.
    fn moment(&self, world: &World, height: f32) -> f32 {
        let Velocity { linear, .. } = world.velocity(self.falling);
        let beyond = height - world.transform(self.falling).translation.y;
        let mean = -linear.y - 0.5 * GRAVITY * beyond / -linear.y;
        world.time() as f32 - beyond / mean
    }

    /// Duration of a fall by symplectic Euler, seconds.
    fn fall(world: &World, height: f32) -> f32 {
        let h = substep(world);
        0.5 * ((h * h + 8.0 * height / GRAVITY).sqrt() - h)
    }
}

impl Script for Gate {
    fn after_step(&mut self, world: &mut World) {
        let rim = GATE + BALL_RADIUS;
        if !world.events().sensor_begin.is_empty() {
            self.entered.push(self.moment(world, rim));
        }
        if !world.events().sensor_end.is_empty() {
            self.left.push(self.moment(world, -rim));
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let out = self.height + 2.0 * (GATE + BALL_RADIUS);
        let once = Expected::Near { value: 1.0, tolerance: 0.0 };
        let at = |height| Expected::near(Self::fall(world, height), 0.002);
        vec![
            Metric::new("entries", self.entered.len() as u32, once),
            Metric::new("exits", self.left.len() as u32, once),
            Metric::awaited("entered_s", self.entered.first().copied(), at(self.height)),
            Metric::awaited("left_s", self.left.first().copied(), at(out)),
        ]
    }
}
