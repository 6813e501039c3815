//! Single particles: one that falls and bounces, one that slides, one that rests; and a thousand fast ones.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, cuboid, fixed, made_of, tilt};
use sinew::math::{Vec3, max, trig};
use sinew::physics::particles::{GroupDef, ParticleDef};
use sinew::physics::{BodyDef, GroupId, Material, World};

pub(in crate::scenes) const PARTICLE: Scene = Scene {
    chapter: Chapter::Particles,
    name: "particle",
    about: "on oriented boxes one particle bounces, one slides down a slope, one rests",
    steps: 120,
    settings: &[
        Setting::number("restitution", 0.5, (0.1, 1.0), "speed after the bounce over the speed before"),
        Setting::number("angle", 35.0, (30.0, 60.0), "angle of the slope, degrees"),
    ],
    build: particle,
};

/// Radius of the particles, metres.
const RADIUS: f32 = 0.05;
/// Height above the box, metres.
const HEIGHT: f32 = 2.0;
const FRICTION: f32 = 0.5;
/// Step at which the first particle still falls; its fall is measured until then.
const FALLING: u64 = 30;

/// A group of one particle of 1 kg.
fn lone(position: Vec3, velocity: Vec3) -> GroupDef {
    GroupDef {
        particles: vec![ParticleDef { position, velocity, mass: 1.0, radius: RADIUS }],
        material: Material { friction: FRICTION, ..Material::default() },
        ..GroupDef::default()
    }
}

fn particle(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    let rough = Material { friction: FRICTION, ..Material::default() };
    let block = |half: Vec3, at: Vec3| made_of(fixed(cuboid(half, at)), rough);
    let thickness = 0.2;
    world.add_body(&block(Vec3::new(0.5, thickness, 0.5), Vec3::Y * -thickness));
    let restitution = setup.number("restitution");
    let bouncy = Material { restitution, ..rough };
    let faller = lone(Vec3::Y * (HEIGHT + RADIUS), Vec3::ZERO);
    let falls = world.add_particles(&GroupDef { material: bouncy, ..faller });

    let angle = setup.number("angle");
    let slope = Vec3::new(3.0, 0.0, -2.0);
    let rotation = tilt(-angle);
    world.add_body(&BodyDef { rotation, ..block(Vec3::new(4.0, thickness, 0.5), slope) });
    let start = slope + rotation * Vec3::new(-3.5, thickness + RADIUS, 0.0);
    let slides = world.add_particles(&lone(start, Vec3::ZERO));

    world.add_body(&BodyDef {
        rotation: tilt(20.0),
        ..block(Vec3::splat(thickness), Vec3::new(0.0, 0.0, 2.0))
    });
    let top = Vec3::new(0.0, 0.0, 2.0) + tilt(20.0) * (Vec3::Y * (thickness + RADIUS));
    let rests = world.add_particles(&lone(top, Vec3::ZERO));
    Instance::new(
        world,
        Three { falls, slides, rests, start, top, angle, restitution, speed: None, apex: 0.0 },
    )
}

struct Three {
    falls: GroupId,
    slides: GroupId,
    rests: GroupId,
    /// Starts of the sliding and of the resting particle.
    start: Vec3,
    top: Vec3,
    /// Angle of the slope, degrees.
    angle: f32,
    restitution: f32,
    /// Speed of the first particle during its fall, m/s.
    speed: Option<f32>,
    /// Greatest height of the first particle after the bounce, metres.
    apex: f32,
}

impl Script for Three {
    fn after_step(&mut self, world: &mut World) {
        let first = world.particles(self.falls);
        let (height, speed) = (first.positions()[0].y - RADIUS, first.velocities()[0].y);
        if world.step_count() == FALLING {
            self.speed = Some(-speed);
        }
        // The first impact is at √(2 h / g), 0.64 s after its start.
        if world.time() > 0.7 {
            self.apex = max(self.apex, height);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let first = |id: GroupId| world.particles(id).positions()[0];
        let (sin, cos) = trig::sin_cos(self.angle.to_radians());
        // Symplectic Euler has `t (t + h) / 2` in place of `t² / 2`.
        let (t, h) = (world.time() as f32, world.def().dt() / world.def().substeps as f32);
        let slid = 0.5 * GRAVITY * (sin - FRICTION * cos) * t * (t + h);
        let falling = FALLING as f32 * world.def().dt() * GRAVITY;
        let bounced = self.restitution * self.restitution * HEIGHT;
        vec![
            Metric::awaited("fall_m_s", self.speed, Expected::near(falling, 1e-4)),
            Metric::new("apex_m", self.apex, Expected::near(bounced, 0.01)),
            Metric::new("slid_m", (first(self.slides) - self.start).length(), Expected::near(slid, 2e-3)),
            Metric::new("crept_m", (first(self.rests) - self.top).length(), Expected::AtMost(1e-4)),
        ]
    }
}

pub(in crate::scenes) const FAST_PARTICLE: Scene = Scene {
    chapter: Chapter::Particles,
    name: "fast_particle",
    about: "particles fly at 100 m/s in a room with walls of 5 cm, and none leaves it",
    steps: 60,
    settings: &[
        Setting::whole(
            "particles",
            1000,
            (1, 10_000),
            "number of particles, shot from the middle in all directions",
        ),
        Setting::number("speed", 100.0, (1.0, 1000.0), "m/s"),
    ],
    build: fast_particle,
};

/// Distance from the centre of the room to its walls, and half of their thickness, metres.
const ROOM: f32 = 1.0;
const WALL: f32 = 0.025;
/// Radius of a fast particle, metres.
const SHOT: f32 = 0.005;

fn fast_particle(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    // The room is rotated, so that its walls are not perpendicular to the axes.
    let turn = tilt(30.0);
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for side in [-1.0, 1.0] {
            let half = Vec3::splat(ROOM + 2.0 * WALL) - axis * (ROOM + WALL);
            let wall = fixed(cuboid(half, turn * axis * (side * (ROOM + WALL))));
            world.add_body(&BodyDef { rotation: turn, ..wall });
        }
    }
    let count = setup.whole("particles");
    let speed = setup.number("speed");
    let particle = |k: usize| ParticleDef {
        position: Vec3::ZERO,
        velocity: spiral(k, count) * speed,
        mass: 0.01,
        radius: SHOT,
    };
    let shots = world.add_particles(&GroupDef {
        particles: (0..count).map(particle).collect(),
        material: Material { friction: 0.1, restitution: 0.9, ..Material::DEFAULT },
        ..GroupDef::default()
    });
    Instance::new(world, Room { shots, speed, furthest: 0.0 })
}

/// Direction `k` of `count` evenly distributed directions: a spiral that turns by the golden angle.
fn spiral(k: usize, count: usize) -> Vec3 {
    let height = 1.0 - (2 * k + 1) as f32 / count as f32;
    let (sin, cos) = trig::sin_cos((k as f32 * 0.618_034) % 1.0 * core::f32::consts::TAU);
    let reach = (1.0 - height * height).sqrt();
    Vec3::new(reach * cos, height, reach * sin)
}

struct Room {
    shots: GroupId,
    speed: f32,
    /// Largest distance beyond a wall's inner side, metres.
    furthest: f32,
}

impl Script for Room {
    fn after_step(&mut self, world: &mut World) {
        for p in world.particles(self.shots).positions() {
            let local = tilt(30.0).inverse() * *p;
            let out = max(max(local.x.abs(), local.y.abs()), local.z.abs());
            self.furthest = max(self.furthest, out - (ROOM - SHOT));
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let shots = world.particles(self.shots);
        let fastest = shots.velocities().iter().fold(0.0, |most, v| max(most, v.length()));
        vec![
            Metric::new("beyond_wall_m", self.furthest, Expected::AtMost(1e-4)),
            // A fall in a room of 2 m gains no more than its potential energy.
            Metric::new("fastest_m_s", fastest, Expected::AtMost(f64::from(self.speed) + 7.0)),
        ]
    }
}
