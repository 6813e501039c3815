//! Events on a clip's timeline.

use crate::framework::actors::{Actor, Cast, Figure, Gone, mark_floor};
use crate::framework::camera_hint::{CameraHint, Trails};
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::mannequin::Path;
use crate::mannequin::drills::{PUNCH_ARRIVES, punch, walking};
use crate::parts::{GRAVITY, ball, cuboid, fixed, floor, made_of};
use sinew::anim::{ClipEvent, TrackDef, TrackId};
use sinew::math::{Transform, Vec3, max};
use sinew::physics::{BodyId, DebugDraw, Material, World};
use std::sync::Arc;

pub(in crate::scenes) const FOOTSTEPS: Scene = Scene {
    chapter: Chapter::Characters,
    name: "footsteps",
    about: "a walk reports each footfall exactly once: faster, standing still and backward",
    steps: 400,
    settings: &[Setting::number(
        "speed",
        1.5,
        (0.5, 3.0),
        "speed of the second stretch, clip seconds per second",
    )],
    build: footsteps,
};

pub(in crate::scenes) const PUNCH: Scene = Scene {
    chapter: Chapter::Characters,
    name: "punch",
    about: "an event of a punch gives the impulse when the fist arrives, and a ball flies off its post",
    steps: 90,
    settings: &[Setting::number("impulse", 2.0, (0.5, 10.0), "impulse in the event's payload, N·s")],
    build: punched,
};

/// The feet, by the payload of their events.
const FEET: [&str; 2] = ["leftToes", "rightToes"];
/// Clip time of the first footfall, seconds; between two steps of the world.
const FIRST: f32 = 0.0625;

/// A stretch of the walk at one speed.
#[derive(Clone, Copy)]
struct Stretch {
    steps: u64,
    /// Speed, clip seconds per second.
    speed: f32,
}

fn footsteps(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let cycle = walking(Path::Straight);
    let lap = cycle.clip.duration;
    let falls = [FIRST, FIRST + 0.5 * lap];
    let mut cast = Cast::mannequin();
    let event = |i: usize| ClipEvent { payload: FEET[i].to_owned(), ..ClipEvent::new(falls[i], "footstep") };
    let clip = cast.add_cycle(&cycle, vec![event(0), event(1)]);
    let cast = Arc::new(cast);
    let mut actor = Actor::new(&cast, Transform::IDENTITY);
    let track = actor.animator.play(&cast.set, &TrackDef::new(clip));
    actor.mark(&mut world);
    let stretch = |steps, speed| Stretch { steps, speed };
    let plan =
        vec![stretch(120, 1.0), stretch(30, 0.0), stretch(130, setup.number("speed")), stretch(120, -1.0)];
    let step_length = 0.5 * cycle.speed * lap;
    let script =
        Footsteps { actor, track, plan, falls, lap, step_length, heard: Vec::new(), gone: Gone::default() };
    Instance::new(world, script)
}

/// A footfall reported by an event.
#[derive(Clone, Copy)]
struct Heard {
    foot: usize,
    /// Time since the start, seconds.
    time: f64,
    /// World position of the ball of the foot in the step of the event.
    place: Vec3,
}

struct Footsteps {
    actor: Actor,
    track: TrackId,
    plan: Vec<Stretch>,
    /// Time of each footfall, clip seconds.
    falls: [f32; 2],
    /// Duration of a lap, seconds.
    lap: f32,
    /// Length of a walking step, metres.
    step_length: f32,
    heard: Vec<Heard>,
    gone: Gone,
}

impl Footsteps {
    fn speed_at(&self, step: u64) -> f32 {
        let mut left = step;
        for stretch in &self.plan {
            if left < stretch.steps {
                return stretch.speed;
            }
            left -= stretch.steps;
        }
        0.0
    }

    fn step(&mut self, step: u64, dt: f32) {
        let set = &self.actor.cast.set;
        self.actor.animator.set_speed(self.track, self.speed_at(step));
        self.actor.animator.update(set, dt);
        self.actor.go();
        self.actor.pose();
        for fired in self.actor.animator.events() {
            let payload = &self.actor.cast.set.event(fired).payload;
            let Some(foot) = FEET.iter().position(|foot| foot == payload) else { continue };
            let place = self.actor.model[self.actor.cast.joint(payload)].translation;
            self.heard.push(Heard { foot, time: step as f64 * f64::from(dt) + fired.seconds, place });
        }
    }

    /// Returns the times at which a footfall should have been reported so far: those at which the clip time passes
    /// `e + k L`, for footfalls at `e` in laps of length `L`.
    fn expected(&self, foot: usize, world: &World) -> Vec<f64> {
        let dt = f64::from(world.def().dt());
        let (lap, fall) = (f64::from(self.lap), f64::from(self.falls[foot]));
        let (mut times, mut from, mut step) = (Vec::new(), 0.0, 0);
        for stretch in &self.plan {
            let steps = u64::min(stretch.steps, world.step_count() - step);
            let speed = f64::from(stretch.speed);
            let to = from + speed * steps as f64 * dt;
            let passed = |t: f64| ((t - fall) / lap).floor() as i64;
            let moment = |k: i64| step as f64 * dt + (fall + k as f64 * lap - from) / speed;
            if speed >= 0.0 {
                times.extend((passed(from) + 1..=passed(to)).map(moment));
            } else {
                times.extend((passed(to) + 1..=passed(from)).rev().map(moment));
            }
            (from, step) = (to, step + steps);
        }
        times
    }

    fn times(&self, foot: usize) -> impl Iterator<Item = f64> {
        self.heard.iter().filter(move |heard| heard.foot == foot).map(|heard| heard.time)
    }
}

impl Script for Footsteps {
    fn before_step(&mut self, world: &mut World) {
        let dt = world.def().dt();
        for step in self.gone.due(world) {
            self.step(step, dt);
        }
        self.actor.lead_marks(world);
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let expected = [0, 1].map(|foot| self.expected(foot, world));
        let count = |foot: usize| Expected::Near { value: expected[foot].len() as f64, tolerance: 0.0 };
        let error = |foot: usize| {
            let pairs = self.times(foot).zip(&expected[foot]);
            pairs.map(|(heard, expected)| (heard - expected).abs() as f32).fold(0.0, max)
        };
        let first_two = self.heard.get(..2).map(|two| (two[1].place.z - two[0].place.z).abs());
        vec![
            Metric::new("left_steps", self.times(0).count() as u32, count(0)),
            Metric::new("right_steps", self.times(1).count() as u32, count(1)),
            Metric::new("time_error_max_s", max(error(0), error(1)), Expected::AtMost(1e-6)),
            Metric::awaited("step_length_m", first_two, Expected::near(self.step_length, 0.02)),
        ]
    }

    fn camera_hint(&self) -> CameraHint {
        CameraHint { direction: Vec3::new(1.0, 0.45, 0.25), ..CameraHint::default() }
    }

    fn draw(&self, _: &World, out: &mut dyn DebugDraw) {
        for heard in &self.heard {
            mark_floor(heard.place, 0.09, out);
        }
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        vec![self.actor.figure()]
    }
}

/// Radius, metres, and density, kg/m³, of a football: 0.43 kg.
const BALL_RADIUS: f32 = 0.11;
const DENSITY: f32 = 77.0;
/// Number of steps of each of the two compared spans of the flight.
const SPAN: u64 = 12;

fn punched(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let payload = setup.number("impulse").to_string();
    let mut cast = Cast::mannequin();
    let clip = cast.add(&punch(), vec![ClipEvent { payload, ..ClipEvent::new(PUNCH_ARRIVES, "punch") }]);
    let cast = Arc::new(cast);
    let mut actor = Actor::new(&cast, Transform::IDENTITY);
    actor.animator.play(&cast.set, &TrackDef::new(clip));
    // Target of the fist: a hand's length beyond its wrist.
    let mut rehearsal = Actor::new(&cast, Transform::IDENTITY);
    rehearsal.animator.play(&cast.set, &TrackDef { start: PUNCH_ARRIVES, ..TrackDef::new(clip) });
    rehearsal.update(0.0);
    rehearsal.pose();
    let fist = rehearsal.model[cast.joint("rightHand")].translation + Vec3::Z * HAND;
    let at = fist + Vec3::Z * BALL_RADIUS;
    let smooth = Material { friction: 0.0, restitution: 0.0, ..Material::DEFAULT };
    let mut football = made_of(ball(BALL_RADIUS, at), smooth);
    football.shapes[0].density = DENSITY;
    let struck = world.add_body(&football);
    let top = at.y - BALL_RADIUS;
    let post = cuboid(Vec3::new(0.03, 0.5 * top, 0.03), Vec3::new(at.x, 0.5 * top, at.z));
    world.add_body(&fixed(made_of(post, smooth)));
    actor.mark(&mut world);
    let impulse = setup.number("impulse");
    let script = Punched {
        actor,
        ball: struck,
        impulse,
        fist,
        hit: None,
        heights: Vec::new(),
        speed: None,
        gone: Gone::default(),
    };
    Instance::new(world, script)
}

/// Distance from the wrist to the knuckles, metres.
const HAND: f32 = 0.1;

/// A hit reported by the callback.
#[derive(Clone, Copy)]
struct Hit {
    step: u64,
    /// Time since the start, seconds.
    time: f64,
    /// Distance of the knuckles from their target, metres.
    miss: f32,
}

struct Punched {
    actor: Actor,
    ball: BodyId,
    /// Requested impulse, N·s.
    impulse: f32,
    /// Target of the knuckles in the world.
    fist: Vec3,
    hit: Option<Hit>,
    /// Heights of the ball, at three times of its flight, metres.
    heights: Vec<f32>,
    /// Speed of the ball after the punch, m/s.
    speed: Option<f32>,
    gone: Gone,
}

impl Punched {
    /// Returns the payload of a punch event in this step, N·s.
    fn step(&mut self, step: u64, dt: f32) -> Option<f32> {
        self.actor.update(dt);
        let fired = self.actor.animator.events().first().copied()?;
        if self.hit.is_some() {
            return None;
        }
        self.actor.pose();
        let wrist = self.actor.model[self.actor.cast.joint("rightHand")].translation;
        let miss = (wrist + Vec3::Z * HAND - self.fist).length();
        self.hit = Some(Hit { step, time: step as f64 * f64::from(dt) + fired.seconds, miss });
        self.actor.cast.set.event(&fired).payload.parse().ok()
    }
}

impl Script for Punched {
    fn before_step(&mut self, world: &mut World) {
        let dt = world.def().dt();
        for step in self.gone.due(world) {
            // A punch reported while catching up has already hit.
            let heard = self.step(step, dt).filter(|_| step == world.step_count());
            if let Some(impulse) = heard {
                world.apply_impulse_at_center(self.ball, Vec3::Z * impulse);
            }
        }
        self.actor.pose();
        self.actor.lead_marks(world);
    }

    fn after_step(&mut self, world: &mut World) {
        let Some(hit) = self.hit else { return };
        let since = world.step_count() - hit.step;
        if since == 1 {
            self.speed = Some(world.velocity(self.ball).linear.z);
        }
        if [SPAN / 2, SPAN / 2 + SPAN, SPAN / 2 + 2 * SPAN].contains(&since) {
            self.heights.push(world.transform(self.ball).translation.y);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let mass = world.mass(self.ball).mass;
        let span = SPAN as f32 * world.def().dt();
        let fall = match self.heights[..] {
            [a, b, c] => Some((2.0 * b - a - c) / (span * span)),
            _ => None,
        };
        let time = self.hit.map(|hit| hit.time as f32);
        vec![
            Metric::awaited("struck_s", time, Expected::near(PUNCH_ARRIVES, 1e-6)),
            Metric::awaited("ball_speed_m_s", self.speed, Expected::near(self.impulse / mass, 1e-3)),
            Metric::awaited("ball_falls_m_s2", fall, Expected::near(GRAVITY, 2e-3)),
            Metric::awaited("fist_miss_m", self.hit.map(|hit| hit.miss), Expected::AtMost(0.03)),
        ]
    }

    fn camera_hint(&self) -> CameraHint {
        CameraHint { direction: Vec3::new(-1.0, 0.25, 0.45), trails: Trails::None, ..CameraHint::default() }
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        vec![self.actor.figure()]
    }
}
