//! Bodies that start to roll by friction.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, ball, cuboid, floor, made_of};
use sinew::math::Vec3;
use sinew::physics::{BodyId, Material, Sleeping, World, WorldDef};

pub(in crate::scenes) const SLIDE_TO_ROLL: Scene = Scene {
    chapter: Chapter::Contacts,
    name: "slide_to_roll",
    about: "friction turns the slide of a pushed ball into rolling at 5/7 of its speed",
    steps: 150,
    settings: &[
        Setting::number("speed", 5.0, (1.0, 50.0), "speed after the push, m/s"),
        Setting::number("friction", 0.3, (0.05, 2.0), "coefficient"),
    ],
    build: |setup| {
        let mut world = setup.world();
        let (speed, friction) = (setup.number("speed"), setup.number("friction"));
        let material = Material { friction, ..Material::default() };
        world.add_body(&made_of(floor(), material));
        let ball = world.add_body(&made_of(ball(BALL_RADIUS, Vec3::Y * BALL_RADIUS), material));
        Instance::new(
            world,
            SlideToRoll { ball, speed, friction, pushed: None, sliding: None, rolling: None },
        )
    },
};

const BALL_RADIUS: f32 = 0.2;
/// Number of steps until the contact carries the weight, sinking by a millimetre: until then friction is incomplete.
const SETTLING: u64 = 60;
/// Share of the speed below which a slipping ball counts as rolling.
const ROLLING: f32 = 0.01;

struct SlideToRoll {
    ball: BodyId,
    /// Speed after the push, m/s.
    speed: f32,
    friction: f32,
    pushed: Option<Moment>,
    /// Motion one step ago, while the ball slides.
    sliding: Option<Moment>,
    /// Motion at the start of rolling, between two steps.
    rolling: Option<Moment>,
}

/// Motion of the ball at some time.
#[derive(Clone, Copy)]
struct Moment {
    /// Time, s.
    time: f32,
    /// Position, metres.
    x: f32,
    /// Speed, m/s.
    speed: f32,
    /// Speed of the contact point over the floor, m/s.
    slip: f32,
}

impl SlideToRoll {
    fn moment(&self, world: &World) -> Moment {
        let velocity = world.velocity(self.ball);
        let touch = velocity.angular.cross(Vec3::NEG_Y * BALL_RADIUS);
        Moment {
            time: world.time() as f32,
            x: world.transform(self.ball).translation.x,
            speed: velocity.linear.x,
            slip: velocity.linear.x + touch.x,
        }
    }
}

impl Script for SlideToRoll {
    fn after_step(&mut self, world: &mut World) {
        if world.step_count() == SETTLING {
            let impulse = Vec3::X * (world.mass(self.ball).mass * self.speed);
            world.apply_impulse_at_center(self.ball, impulse);
            self.pushed = Some(self.moment(world));
            self.sliding = self.pushed;
        } else if let (Some(before), None) = (self.sliding, self.rolling) {
            let now = self.moment(world);
            if now.slip > ROLLING * self.speed {
                self.sliding = Some(now);
            } else {
                // Friction reduces the remaining slip at this rate.
                let left = before.slip / (3.5 * self.friction * GRAVITY);
                let x = before.x + 0.5 * (before.speed + now.speed) * left;
                self.rolling = Some(Moment { time: before.time + left, x, ..now });
            }
        }
    }

    fn metrics(&self, _: &World) -> Vec<Metric> {
        let slid = self.pushed.zip(self.rolling);
        let seconds = slid.map(|(from, to)| to.time - from.time);
        let way = slid.map(|(from, to)| to.x - from.x);
        let brake = self.friction * GRAVITY;
        let right = |value: f32| Expected::near(value, 0.005);
        vec![
            Metric::awaited("slides_s", seconds, right(2.0 * self.speed / (7.0 * brake))),
            Metric::awaited("slides_m", way, right(12.0 * self.speed * self.speed / (49.0 * brake))),
            Metric::awaited("rolls_m_s", self.rolling.map(|to| to.speed), right(self.speed * 5.0 / 7.0)),
        ]
    }
}

pub(in crate::scenes) const ROLLING_BALLS: Scene = Scene {
    chapter: Chapter::Contacts,
    name: "rolling_balls",
    about: "an oblique force pulls a box with 25 balls on it: it slides on the floor, and they roll on it (SimBenchmark)",
    steps: 400,
    settings: &[Setting::number("step_ms", 10.0, (0.5, 20.0), "length of a step, ms")],
    build: rolling_balls,
};

/// SimBenchmark's "rolling": masses (kg), coefficients of friction, force (N) and its direction on the floor.
const BOX_MASS: f32 = 10.0;
const BALL_MASS: f32 = 1.0;
const BALLS: usize = 25;
const ON_FLOOR: f32 = 0.4;
const ON_BOX: f32 = 0.8;
const FORCE: f32 = 150.0;
const TOWARD: Vec3 = Vec3::new(0.5, 0.0, 0.866_025_4);
const BOX_HALF: Vec3 = Vec3::new(10.0, 0.5, 10.0);

fn rolling_balls(setup: &Setup<'_>) -> Instance {
    let step_nanoseconds = (setup.number("step_ms") * 1e6) as u64;
    let sleeping = Sleeping::Off;
    let mut world = World::new(WorldDef { step_nanoseconds, sleeping, ..setup.world_def() });
    // The friction of two surfaces is the geometric mean.
    let rubbing = |friction: f32| Material { friction, ..Material::default() };
    world.add_body(&made_of(floor(), rubbing(ON_FLOOR * ON_FLOOR / ON_BOX)));
    let mut tray = made_of(cuboid(BOX_HALF, Vec3::Y * BOX_HALF.y), rubbing(ON_BOX));
    tray.shapes[0].density = BOX_MASS / (8.0 * BOX_HALF.x * BOX_HALF.y * BOX_HALF.z);
    let tray = world.add_body(&tray);
    let radius = 0.5;
    let balls = (0..BALLS).map(|i| {
        let place = Vec3::new((i % 5) as f32 - 2.0, 0.0, (i / 5) as f32 - 2.0) * 2.0;
        let mut ball = made_of(ball(radius, place + Vec3::Y * (2.0 * BOX_HALF.y + radius)), rubbing(ON_BOX));
        ball.shapes[0].density = BALL_MASS / (4.0 / 3.0 * core::f32::consts::PI * radius * radius * radius);
        world.add_body(&ball)
    });
    let balls = balls.collect();
    let mut script = RollingBalls { tray, balls, squares: [0.0; 2], steps: 0 };
    script.pull(&mut world);
    Instance::new(world, script)
}

struct RollingBalls {
    tray: BodyId,
    balls: Vec<BodyId>,
    /// Sums over the steps of the squared velocity errors of the box and of the mean ball, m²/s².
    squares: [f64; 2],
    steps: u32,
}

impl RollingBalls {
    /// Applies the force for one step.
    fn pull(&mut self, world: &mut World) {
        let center = world.center_of_mass(self.tray);
        world.apply_force(self.tray, TOWARD * FORCE, center);
    }

    /// Returns the accelerations of the box and of a ball, m/s²: the floor's friction is `f₁`, a ball's `f₂`, and a
    /// homogeneous ball that is pulled at its foot has 2/7 of the acceleration of the box below the ball.
    fn accelerations() -> [f32; 2] {
        let balls = BALLS as f32;
        let f1 = ON_FLOOR * (BOX_MASS + balls * BALL_MASS) * GRAVITY;
        let f2 = (FORCE - f1) / BOX_MASS / (3.5 / BALL_MASS + balls / BOX_MASS);
        [(FORCE - f1 - balls * f2) / BOX_MASS, f2 / BALL_MASS]
    }
}

impl Script for RollingBalls {
    fn after_step(&mut self, world: &mut World) {
        let [tray, ball] = Self::accelerations().map(|a| TOWARD * (a * world.time() as f32));
        let square =
            |id: BodyId, right: Vec3| f64::from((world.velocity(id).linear - right).length_squared());
        self.squares[0] += square(self.tray, tray);
        self.squares[1] += self.balls.iter().map(|&id| square(id, ball)).sum::<f64>() / BALLS as f64;
        self.steps += 1;
        self.pull(world);
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let time = world.time() as f32;
        let [tray, ball] = Self::accelerations().map(|a| Expected::near(a * time, 0.01));
        let along = |id: BodyId| world.velocity(id).linear.dot(TOWARD);
        let slowest = self.balls.iter().map(|&id| along(id)).fold(f32::INFINITY, sinew::math::min);
        let mean = |sum: f64| sum / f64::from(self.steps.max(1));
        vec![
            Metric::new("box_m_s", along(self.tray), tray),
            Metric::new("slowest_ball_m_s", slowest, ball),
            Metric::new("box_error_m2_s2", mean(self.squares[0]), Expected::Anything),
            Metric::new("ball_error_m2_s2", mean(self.squares[1]), Expected::Anything),
        ]
    }

    fn work_in(&self, world: &World) -> f32 {
        FORCE * world.center_of_mass(self.tray).dot(TOWARD)
    }
}
