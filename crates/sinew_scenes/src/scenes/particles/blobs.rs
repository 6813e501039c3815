//! Soft balls beside rigid ones.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, ball, floor, made_of};
use sinew::math::{Vec3, max, min};
use sinew::physics::particles::{BlobDef, ParticleGroup};
use sinew::physics::{BodyId, GroupId, Material, World};

pub(in crate::scenes) const BLOB: Scene = Scene {
    chapter: Chapter::Particles,
    name: "blob",
    about: "a ball of skin and air falls on the floor, flattens, and comes to rest with its initial volume",
    steps: 300,
    settings: &[Setting::whole("subdivisions", 2, (0, 4), "number of subdivisions of its skin"), MASS],
    build: |setup| {
        let mut world = setup.world();
        world.add_body(&floor());
        let def =
            BlobDef { bulk_modulus: 2e4, damping_ratio: 0.2, ..soft(setup, setup.whole("subdivisions")) };
        let mut blob = def.build();
        blob.group.linear_damping = 0.2;
        blob.group.iterations = 8;
        let volume = blob.group.volumes[0].rest_volume;
        let blob = world.add_particles(&blob.group);
        Instance::new(world, Dropped { blob, volume, fall: None, squeezed: 1.0 })
    },
};

const MASS: Setting = Setting::number("mass", 0.6, (0.05, 10.0), "mass of the ball, kg");
/// Radius of the balls with their skin, and thickness of the skin, metres.
const RADIUS: f32 = 0.12;
const SKIN: f32 = 0.005;
/// Initial height of their lowest points, metres.
const HEIGHT: f32 = 1.0;
/// Number of steps in which the balls certainly fall.
const FALLING: u64 = 20;

fn soft(setup: &Setup<'_>, subdivisions: usize) -> BlobDef {
    BlobDef {
        center: Vec3::Y * (HEIGHT + RADIUS),
        radius: RADIUS - SKIN,
        subdivisions: subdivisions as u32,
        mass: setup.number("mass"),
        stiffness: 400.0,
        damping_ratio: 0.0,
        bulk_modulus: 1e5,
        skin: SKIN,
    }
}

/// Mean position and velocity of the particles.
fn middle(group: &ParticleGroup) -> (Vec3, Vec3) {
    let mean = |all: &[Vec3]| all.iter().copied().sum::<Vec3>() / all.len() as f32;
    (mean(group.positions()), mean(group.velocities()))
}

struct Dropped {
    blob: GroupId,
    /// Volume without pressure, m³.
    volume: f32,
    fall: Option<f32>,
    /// Smallest height of the ball relative to the initial one.
    squeezed: f32,
}

impl Script for Dropped {
    fn after_step(&mut self, world: &mut World) {
        let group = world.particles(self.blob);
        if world.step_count() == FALLING {
            self.fall = Some(-middle(group).1.y / world.time() as f32);
        }
        let (low, high) = extent(group);
        self.squeezed = min(self.squeezed, (high - low) / (2.0 * RADIUS));
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let group = world.particles(self.blob);
        let fastest = group.velocities().iter().fold(0.0, |most, v| max(most, v.length()));
        // The drag of the ball is air resistance.
        vec![
            Metric::awaited("fall_m_s2", self.fall, Expected::near(0.967 * GRAVITY, 0.005)),
            Metric::new(
                "volume_kept",
                group.volume(0) / self.volume,
                Expected::Near { value: 1.0, tolerance: 0.01 },
            ),
            Metric::new("squeezed_to", self.squeezed, Expected::AtMost(0.9)),
            Metric::new("fastest_m_s", fastest, Expected::AtMost(0.05)),
        ]
    }
}

/// Heights of the lowest and the highest point of a skin.
fn extent(group: &ParticleGroup) -> (f32, f32) {
    group.positions().iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), p| {
        (min(low, p.y - SKIN), max(high, p.y + SKIN))
    })
}

pub(in crate::scenes) const STEEL_VS_BASKETBALL: Scene = Scene {
    chapter: Chapter::Particles,
    name: "steel_vs_basketball",
    about: "a steel ball and a basketball of the same size fall side by side: the steel ball's impact takes no time, the basketball flattens",
    steps: 90,
    settings: &[MASS],
    build: |setup| {
        let mut world = setup.world();
        let springy = Material { restitution: STEEL, ..Material::default() };
        world.add_body(&floor());
        let mut steel = made_of(ball(RADIUS, Vec3::new(-0.5, HEIGHT + RADIUS, 0.0)), springy);
        steel.shapes[0].density = 7850.0;
        let steel = world.add_body(&steel);
        let mut basketball = soft(setup, 2).build();
        // A step of implicit Euler damps a swing by ω h / 2, so bouncing needs short steps.
        basketball.group.iterations = 32;
        let basketball = world.add_particles(&basketball.group);
        let bounces = [Bounce::default(); 2];
        Instance::new(world, Side { steel, basketball, bounces })
    },
};

/// Restitution of the steel ball.
const STEEL: f32 = 0.8;

/// Measurements of one ball's bounce.
#[derive(Clone, Copy, Default)]
struct Bounce {
    /// Speed of the ball's centre during the fall, m/s.
    fall: Option<f32>,
    /// Number of steps in which the ball touched the floor.
    contact: u32,
    /// Greatest height of the lowest point since the bounce, if the ball were round, metres.
    rebound: Option<f32>,
    /// Largest speed just before and just after the bounce, m/s.
    before: f32,
    after: f32,
}

impl Bounce {
    /// Updates after a step that ends with this height and contact state.
    fn after_step(&mut self, world: &World, height: f32, speed: f32, touches: bool) {
        if world.step_count() == FALLING {
            self.fall = Some(-speed);
        }
        let again = self.rebound.is_some();
        if touches && !again {
            self.contact += 1;
        }
        let risen = self.contact > 0 && !touches && speed > 0.0 || again;
        if risen {
            self.rebound = Some(max(self.rebound.unwrap_or(0.0), height - RADIUS));
        }
        self.before = max(self.before, -speed);
        self.after = max(self.after, speed);
    }

    /// Contact time, s; accurate to a step.
    fn contact(&self, world: &World) -> f32 {
        self.contact as f32 * world.def().dt()
    }

    /// Mean force of the floor divided by the weight.
    fn force(&self, world: &World) -> f32 {
        (self.before + self.after) / (max(self.contact(world), world.def().dt()) * GRAVITY)
    }
}

struct Side {
    steel: BodyId,
    basketball: GroupId,
    bounces: [Bounce; 2],
}

impl Script for Side {
    fn after_step(&mut self, world: &mut World) {
        let [steel, soft] = &mut self.bounces;
        let center = world.center_of_mass(self.steel);
        steel.after_step(world, center.y, world.velocity(self.steel).linear.y, center.y < RADIUS + 1e-3);
        let group = world.particles(self.basketball);
        let (position, velocity) = middle(group);
        soft.after_step(world, position.y, velocity.y, extent(group).0 < 1e-3);
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let [steel, soft] = &self.bounces;
        let falling = FALLING as f32 * world.def().dt() * GRAVITY;
        let step = f64::from(world.def().dt());
        let longer = soft.contact(world) / max(steel.contact(world), world.def().dt());
        let bounced = Expected::near(STEEL * STEEL * HEIGHT, 0.02);
        vec![
            Metric::awaited("steel_fall_m_s", steel.fall, Expected::near(falling, 1e-3)),
            Metric::awaited("soft_fall_m_s", soft.fall, Expected::near(falling, 1e-3)),
            Metric::awaited("steel_rebound_m", steel.rebound, bounced),
            Metric::awaited("soft_rebound_m", soft.rebound, Expected::AtMost(f64::from(HEIGHT))),
            Metric::new("steel_contact_s", steel.contact(world), Expected::AtMost(1.01 * step)),
            Metric::new("soft_contact_s", soft.contact(world), Expected::AtMost(0.1)),
            Metric::new("shorter_contact", 1.0 / longer, Expected::AtMost(0.5)),
            Metric::new("steel_force_weights", steel.force(world), Expected::Anything),
            Metric::new("soft_force_weights", soft.force(world), Expected::Anything),
        ]
    }
}
