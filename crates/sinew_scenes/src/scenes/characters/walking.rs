//! Characters that walk through a world.

use crate::framework::actors::{Actor, Cast, Figure, Gone, mark_floor};
use crate::framework::camera_hint::{CameraHint, Trails};
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::mannequin::drills::{Cycle, walking};
use crate::mannequin::{Path, WALK_SPEED};
use crate::parts::{body, fixed, floor, ghost};
use core::f32::consts::TAU;
use sinew::anim::ik::{FootGround, FootPlacement, TwoBone, place_feet};
use sinew::anim::{TrackDef, Wrap, local_to_model, rest_pose, sample};
use sinew::math::{Affine, Transform, Vec3, max, trig};
use sinew::physics::ray::Ray;
use sinew::physics::{
    BodyDef, BodyId, BodyKind, BodyKinds, DebugDraw, HeightField, HeightFieldDef, QueryFilter, Shape,
    Velocity, World,
};
use std::sync::Arc;

pub(in crate::scenes) const ROOT_WALK: Scene = Scene {
    chapter: Chapter::Characters,
    name: "root_walk",
    about: "root motion moves a kinematic capsule on a circle, and no foot slides more than in its clip",
    steps: 604,
    settings: &[Setting::number("radius", 2.0, (1.0, 20.0), "radius of the circle, m")],
    build: root_walk,
};

pub(in crate::scenes) const UNEVEN_GROUND: Scene = Scene {
    chapter: Chapter::Characters,
    name: "uneven_ground",
    about: "inverse kinematics adapts a walk for a flat floor to waves, beside a walk without it",
    steps: 300,
    settings: &[Setting::number("height", 0.07, (0.0, 0.12), "height of the waves above their mean, m")],
    build: uneven_ground,
};

/// Half the length of the capsule's axis, and the capsule's radius, metres.
const CAPSULE: [f32; 2] = [0.57, 0.3];
/// Height of the mannequin, metres.
const HEIGHT: f32 = 1.75;
/// Vector from the soles to the centre of the capsule.
const MIDDLE: Vec3 = Vec3::new(0.0, CAPSULE[0] + CAPSULE[1], 0.0);

fn root_walk(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let cycle = walking(Path::Circle(setup.number("radius")));
    let mut cast = Cast::mannequin();
    let clip = cast.add_cycle(&cycle, Vec::new());
    let mut actor = Actor::new(&Arc::new(cast), Transform::IDENTITY);
    actor.animator.play(&actor.cast.set, &TrackDef::new(clip));
    let [half_height, radius] = CAPSULE;
    let capsule = ghost(body(Shape::Capsule { half_height, radius }, MIDDLE));
    let capsule = world.add_body(&BodyDef { kind: BodyKind::Kinematic, ..capsule });
    let balls = FEET.map(|foot| Ball::new(actor.cast.joint(foot)));
    Instance::new(
        world,
        RootWalk { actor, capsule, cycle, balls, alone: Vec::new(), off_path: 0.0, gone: Gone::default() },
    )
}

const FEET: [&str; 2] = ["leftToes", "rightToes"];

/// Contact of the ball of a foot while the foot is down.
struct Ball {
    joint: usize,
    /// Position in the world, and position by the clip alone, in the last step if the foot was down then.
    last: Option<[Vec3; 2]>,
    /// Positions in the world at which the ball touched down.
    prints: Vec<Vec3>,
    /// Total slide, metres, and total contact time, seconds.
    slid: [f32; 2],
    time: f32,
}

impl Ball {
    fn new(joint: usize) -> Self {
        Self { joint, last: None, prints: Vec::new(), slid: [0.0; 2], time: 0.0 }
    }

    fn watch(&mut self, now: Option<[Vec3; 2]>, dt: f32) {
        match (now, self.last) {
            (Some(now), Some(last)) => {
                for i in 0..2 {
                    let way = now[i] - last[i];
                    self.slid[i] += Vec3::new(way.x, 0.0, way.z).length();
                }
                self.time += dt;
            }
            (Some([place, _]), None) => self.prints.push(place),
            (None, _) => {}
        }
        self.last = now;
    }
}

struct RootWalk {
    actor: Actor,
    capsule: BodyId,
    cycle: Cycle,
    balls: [Ball; 2],
    /// Joints of the unchanged clip: world from joint.
    alone: Vec<Affine>,
    /// Largest distance from the closed form, metres.
    off_path: f32,
    gone: Gone,
}

impl RootWalk {
    fn place(&self, world: &World) -> Transform {
        world.transform(self.capsule) * Transform::from_translation(-MIDDLE)
    }

    fn share_of_lap(&self) -> f32 {
        share_of_lap(&self.actor, &self.cycle)
    }

    /// Computes the poses of the unchanged clip, lap by lap.
    fn play_alone(&mut self) {
        let Cycle { clip, path, speed, .. } = &self.cycle;
        let rig = &self.actor.cast.rig;
        let Some(track) = self.actor.animator.tracks().next() else { return };
        let mut local = rest_pose(rig);
        sample(clip, rig, track.playhead().clip_time(), Wrap::Clamp, &mut local);
        let laps = path.at(speed * clip.duration * track.playhead().lap() as f32);
        local_to_model(rig, &local, &Affine::from(laps), &mut self.alone);
    }
}

/// Position of an actor's track in its cycle, as a share of the cycle, 0..1.
fn share_of_lap(actor: &Actor, cycle: &Cycle) -> f32 {
    actor.animator.tracks().next().map_or(0.0, |track| track.playhead().clip_time() / cycle.clip.duration)
}

/// Phase of a foot in its own cycle. The right foot is half a cycle behind the left one.
fn phase_of(foot: usize, lap: f32) -> f32 {
    match foot {
        0 => lap,
        _ => lap + 0.5 - (lap + 0.5).floor(),
    }
}

impl Script for RootWalk {
    fn before_step(&mut self, world: &mut World) {
        let dt = world.def().dt();
        for _ in self.gone.due(world) {
            self.actor.update(dt);
        }
        let from = world.transform(self.capsule);
        let place = self.place(world) * self.actor.animator.root_motion();
        let to = place * Transform::from_translation(MIDDLE);
        let linear = (to.translation - from.translation) / dt;
        let angular = from.rotation.angular_velocity_to(to.rotation, dt);
        world.set_velocity(self.capsule, Velocity { linear, angular });
    }

    fn after_step(&mut self, world: &mut World) {
        let dt = world.def().dt();
        self.actor.place = self.place(world);
        self.actor.pose();
        let path = self.cycle.path.at(WALK_SPEED * world.time() as f32);
        self.off_path = max(self.off_path, (self.actor.place.translation - path.translation).length());
        self.play_alone();
        let lap = self.share_of_lap();
        for i in 0..2 {
            let phase = phase_of(i, lap);
            let [from, to] = self.cycle.ball_down;
            let ball = &mut self.balls[i];
            let places = [&self.actor.model, &self.alone].map(|model| model[ball.joint].translation);
            ball.watch((from..to).contains(&phase).then_some(places), dt);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let time = self.balls[0].time + self.balls[1].time;
        let mean = |i: usize| (self.balls[0].slid[i] + self.balls[1].slid[i]) / max(time, 1e-6);
        let Path::Circle(radius) = self.cycle.path else { return Vec::new() };
        let turned = WALK_SPEED * world.time() as f32 / radius;
        let start = 2.0 * radius * trig::sin(0.5 * turned).abs();
        let place = self.place(world).translation.length();
        vec![
            Metric::new("off_path_max_m", self.off_path, Expected::AtMost(2e-3)),
            Metric::new("from_start_m", place, Expected::Near { value: f64::from(start), tolerance: 2e-3 }),
            Metric::new("slide_cm_s_per_m", 100.0 * mean(0) / HEIGHT, Expected::AtMost(1.0)),
            Metric::new("slide_of_clip_cm_s_per_m", 100.0 * mean(1) / HEIGHT, Expected::Anything),
            Metric::new(
                "slide_beyond_clip_cm_s_per_m",
                100.0 * (mean(0) - mean(1)) / HEIGHT,
                Expected::AtMost(0.02),
            ),
        ]
    }

    fn camera_hint(&self) -> CameraHint {
        CameraHint { direction: Vec3::new(-0.35, 0.6, 1.0), trails: Trails::None, ..CameraHint::default() }
    }

    fn draw(&self, _: &World, out: &mut dyn DebugDraw) {
        for &print in self.balls.iter().flat_map(|ball| &ball.prints) {
            mark_floor(print, 0.06, out);
        }
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        vec![self.actor.figure()]
    }
}

/// Number of corners of the ground along x and z, and their spacing, metres.
const CORNERS: [usize; 2] = [17, 41];
const SPACING: f32 = 0.2;
/// Distance from crest to crest along x and z, metres.
const WAVES: [f32; 2] = [3.4, 2.2];
/// Positions of the two characters along x, and their start along z, metres.
const LANES: [f32; 2] = [-0.7, 0.7];
const BEGIN: f32 = -3.2;

fn ground(height: f32) -> BodyDef {
    let [columns, rows] = CORNERS;
    let wave = |i: usize| {
        let (row, column) = (i / columns, i % columns);
        let along_x = trig::sin(TAU * SPACING * column as f32 / WAVES[0]);
        height * (0.4 * along_x + trig::sin(TAU * SPACING * row as f32 / WAVES[1])) / 1.4
    };
    let heights = (0..columns * rows).map(wave).collect();
    let def = HeightFieldDef { columns, rows, spacing: [SPACING; 2], heights, holes: Vec::new() };
    let field = HeightField::new(def).expect("the height field is valid");
    let corner = Vec3::new((columns - 1) as f32, 0.0, (rows - 1) as f32) * (-0.5 * SPACING);
    fixed(body(Shape::HeightField(Arc::new(field)), corner))
}

fn uneven_ground(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&ground(setup.number("height")));
    let cycle = walking(Path::Straight);
    let mut cast = Cast::mannequin();
    let clip = cast.add_cycle(&cycle, Vec::new());
    let cast = Arc::new(cast);
    let mut walker = |x: f32| {
        let mut actor = Actor::new(&cast, Transform::from_translation(Vec3::new(x, 0.0, BEGIN)));
        actor.animator.play(&cast.set, &TrackDef::new(clip));
        actor.mark(&mut world);
        Walker { actor, gap: 0.0 }
    };
    let [plain, placed] = LANES.map(&mut walker);
    let leg = |side: &str| {
        let joint = |part: &str| cast.joint(&format!("{side}{part}"));
        TwoBone { upper: joint("UpperLeg"), lower: joint("LowerLeg"), end: joint("Foot") }
    };
    let legs = ["left", "right"].map(leg);
    Instance::new(
        world,
        Uneven { plain, placed, legs, cycle, pelvis: cast.joint("hips"), miss: 0.0, gone: Gone::default() },
    )
}

struct Walker {
    actor: Actor,
    /// Largest distance of a point of a flat sole from the ground, metres.
    gap: f32,
}

struct Uneven {
    plain: Walker,
    placed: Walker,
    legs: [TwoBone; 2],
    pelvis: usize,
    cycle: Cycle,
    /// Largest distance of an ankle from its target, metres.
    miss: f32,
    gone: Gone,
}

/// Height of the ankle above the sole, and vectors from the ankle to heel and ball in the axes of the foot,
/// metres.
const ANKLE: f32 = 0.08;
const SOLE: [Vec3; 2] = [Vec3::new(0.0, -ANKLE, -0.055), Vec3::new(0.0, -ANKLE, 0.135)];

/// Returns the ground below a point.
fn below(world: &World, point: Vec3) -> Option<FootGround> {
    let ray = Ray { origin: point + Vec3::Y, direction: Vec3::Y * -3.0 };
    let hit = world.query().filter(QueryFilter::of(BodyKinds::STATIC)).first(&ray)?;
    Some(FootGround { height: hit.point.y, normal: hit.normal })
}

impl Uneven {
    fn step(&mut self, world: &World, dt: f32) {
        for walker in [&mut self.plain, &mut self.placed] {
            walker.actor.update(dt);
            walker.actor.go();
            walker.actor.pose();
        }
        let settings = FootPlacement {
            up: Vec3::Y,
            forward: Vec3::Z,
            floor: 0.0,
            ankle_height: ANKLE,
            free_height: 0.12,
            max_step: 0.3,
            max_tilt: 0.5,
        };
        let Actor { cast, local, model, .. } = &mut self.placed.actor;
        let ground = |point| below(world, point);
        let placed = place_feet(&cast.rig, self.pelvis, &self.legs, &settings, ground, local, model);
        self.miss = placed.feet.iter().fold(self.miss, |miss, foot| max(miss, foot.miss));
        let lap = share_of_lap(&self.placed.actor, &self.cycle);
        let [from, to] = self.cycle.sole_down;
        for (i, leg) in self.legs.iter().enumerate() {
            let phase = phase_of(i, lap);
            if (from..to).contains(&phase) {
                self.plain.watch(world, leg.end);
                self.placed.watch(world, leg.end);
            }
        }
    }
}

impl Walker {
    fn watch(&mut self, world: &World, ankle: usize) {
        for point in SOLE.map(|point| self.actor.model[ankle].point(point)) {
            let Some(ground) = below(world, point) else { continue };
            self.gap = max(self.gap, (point.y - ground.height).abs());
        }
    }
}

impl Script for Uneven {
    fn before_step(&mut self, world: &mut World) {
        let dt = world.def().dt();
        for _ in self.gone.due(world) {
            self.step(world, dt);
        }
        self.plain.actor.lead_marks(world);
        self.placed.actor.lead_marks(world);
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let way = self.placed.actor.place.translation.z - BEGIN;
        let expected = Expected::near(f64::from(WALK_SPEED) * world.time(), 1e-3);
        vec![
            Metric::new("way_m", way, expected),
            Metric::new("gap_without_max_m", self.plain.gap, Expected::Anything),
            Metric::new("gap_max_m", self.placed.gap, Expected::AtMost(0.015)),
            Metric::new("ankle_miss_max_m", self.miss, Expected::AtMost(1e-3)),
        ]
    }

    fn camera_hint(&self) -> CameraHint {
        CameraHint { direction: Vec3::new(0.8, 0.32, 1.0), trails: Trails::None, ..CameraHint::default() }
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        vec![self.plain.actor.figure(), self.placed.actor.figure()]
    }
}
