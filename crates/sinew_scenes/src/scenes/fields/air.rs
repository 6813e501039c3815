//! Air: bodies carried by wind, tilt of hanging bodies in wind, and terminal velocities.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, ball, cuboid, ghost, hook, join};
use core::f32::consts::PI;
use sinew::math::{Vec3, trig};
use sinew::physics::particles::{GroupDef, ParticleDef};
use sinew::physics::{BodyDef, BodyId, Drag, FieldDef, FieldId, FieldKind, Filter, GroupId, Wind, World};

/// Density of air, kg/m³.
const AIR: f32 = 1.225;

/// Frontal area of a ball of this radius, m².
fn disk(radius: f32) -> f32 {
    PI * radius * radius
}

/// Energy that fields give bodies, step by step.
struct Work {
    fields: Vec<FieldId>,
    bodies: Vec<BodyId>,
    power: f32,
    sum: f32,
}

impl Work {
    fn new(world: &World, fields: Vec<FieldId>, bodies: Vec<BodyId>) -> Self {
        let mut work = Self { fields, bodies, power: 0.0, sum: 0.0 };
        work.power = work.power_now(world);
        work
    }

    fn power_now(&self, world: &World) -> f32 {
        let pairs = self.fields.iter().flat_map(|&field| self.bodies.iter().map(move |&body| (field, body)));
        pairs
            .map(|(field, body)| {
                let (wrench, v) = (world.field_force(field, body), world.velocity(body));
                wrench.force.dot(v.linear) + wrench.torque.dot(v.angular)
            })
            .sum()
    }

    fn after_step(&mut self, world: &World) {
        let now = self.power_now(world);
        self.sum += 0.5 * (self.power + now) * world.def().dt();
        self.power = now;
    }
}

pub(in crate::scenes) const WIND: Scene = Scene {
    chapter: Chapter::Fields,
    name: "wind",
    about: "wind carries a plate and a particle along, and tilts a ball on a string",
    steps: 600,
    settings: &[Setting::number("speed", 10.0, (0.0, 40.0), "speed of the wind along x, m/s")],
    build: wind,
};

const PLATE: Vec3 = Vec3::new(0.01, 0.5, 0.5);
const DRAG: f32 = 1.1;
const BALL_RADIUS: f32 = 0.15;
const BALL_DENSITY: f32 = 30.0;
const STRING: f32 = 1.0;

fn wind(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let mut plate = ghost(cuboid(PLATE, Vec3::new(0.0, 0.0, -2.0)));
    plate.shapes[0].density = 100.0;
    let plate = world.add_body(&BodyDef { gravity_scale: 0.0, ..plate });
    let mut def = ghost(ball(BALL_RADIUS, Vec3::NEG_Y * STRING));
    def.shapes[0].density = BALL_DENSITY;
    // The damping stops its swing.
    def.linear_damping = 2.0;
    let hung = world.add_body(&def);
    let hook = world.add_body(&hook());
    join(&mut world, hook, hung, Vec3::ZERO);
    let position = Vec3::Z * 2.0;
    let leaf = ParticleDef { position, velocity: Vec3::ZERO, mass: 0.01, radius: 0.05 };
    let leaf = world.add_particles(&GroupDef {
        particles: vec![leaf],
        gravity_scale: 0.0,
        filter: Filter { mask: 0, ..Filter::default() },
        ..GroupDef::default()
    });
    let speed = setup.number("speed");
    let air = Wind { velocity: Vec3::X * speed, density: AIR, drag: DRAG, ..Wind::default() };
    let field = world.add_field(&FieldDef::new(FieldKind::Wind(air)));
    let work = Work::new(&world, vec![field], vec![plate, hung]);
    Instance::new(world, Windy { plate, hung, leaf, speed, work })
}

struct Windy {
    plate: BodyId,
    hung: BodyId,
    leaf: GroupId,
    speed: f32,
    work: Work,
}

impl Windy {
    /// Speed of a body that starts at rest: `m v̇ = ½ ρ C A (w − v)²`, so `v = w² t/(L + w t)` with `L = 2 m/(ρ C A)`.
    fn carried(&self, time: f32, mass: f32, area: f32) -> f32 {
        let length = 2.0 * mass / (AIR * DRAG * area);
        self.speed * self.speed * time / (length + self.speed * time)
    }
}

impl Script for Windy {
    fn after_step(&mut self, world: &mut World) {
        self.work.after_step(world);
    }

    fn work_in(&self, world: &World) -> f32 {
        // All energy of the particle is work of the wind.
        self.work.sum + world.group_energy(self.leaf).kinetic
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let time = world.time() as f32;
        let group = world.particles(self.leaf);
        let plate = self.carried(time, world.mass(self.plate).mass, 4.0 * PLATE.y * PLATE.z);
        let leaf = self.carried(time, group.masses()[0], disk(group.radii()[0]));
        let at = world.center_of_mass(self.hung);
        let drag = 0.5 * AIR * DRAG * disk(BALL_RADIUS) * self.speed * self.speed;
        let tilt = trig::atan2(drag, world.mass(self.hung).mass * GRAVITY);
        let found = trig::atan2(at.x, -at.y);
        vec![
            Metric::new("plate_m_s", world.velocity(self.plate).linear.x, Expected::near(plate, 2e-3)),
            Metric::new("particle_m_s", group.velocities()[0].x, Expected::near(leaf, 2e-3)),
            Metric::new("tilt_deg", found.to_degrees(), Expected::near(tilt.to_degrees(), 2e-3)),
        ]
    }
}

pub(in crate::scenes) const TERMINAL_VELOCITY: Scene = Scene {
    chapter: Chapter::Fields,
    name: "terminal_velocity",
    about: "balls fall through still air and through a viscous medium until drag balances weight",
    steps: 600,
    settings: &[],
    build: terminal_velocity,
};

/// Drag coefficient of the viscous medium, N·s/m.
const VISCOUS: f32 = 2.0;

fn terminal_velocity(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let mut drop = |x: f32, layers: u32| {
        let mut def = ghost(ball(BALL_RADIUS, Vec3::X * x));
        def.shapes[0].density = BALL_DENSITY;
        def.shapes[0].filter.layers = layers;
        world.add_body(&def)
    };
    let (in_air, in_oil) = (drop(-1.0, 1), drop(1.0, 2));
    let air = Wind { density: AIR, drag: 0.47, ..Wind::default() };
    let air = world.add_field(&FieldDef { layers: 1, ..FieldDef::new(FieldKind::Wind(air)) });
    let oil = Drag { linear: VISCOUS, ..Drag::default() };
    let oil = world.add_field(&FieldDef { layers: 2, ..FieldDef::new(FieldKind::Drag(oil)) });
    let work = Work::new(&world, vec![air, oil], vec![in_air, in_oil]);
    Instance::new(world, Falling { in_air, in_oil, work })
}

struct Falling {
    in_air: BodyId,
    in_oil: BodyId,
    work: Work,
}

impl Script for Falling {
    fn after_step(&mut self, world: &mut World) {
        self.work.after_step(world);
    }

    fn work_in(&self, _: &World) -> f32 {
        self.work.sum
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let weight = world.mass(self.in_air).mass * GRAVITY;
        let air = (2.0 * weight / (AIR * 0.47 * disk(BALL_RADIUS))).sqrt();
        let speed = |body| -world.velocity(body).linear.y;
        vec![
            Metric::new("air_m_s", speed(self.in_air), Expected::near(air, 1e-3)),
            Metric::new("viscous_m_s", speed(self.in_oil), Expected::near(weight / VISCOUS, 1e-4)),
        ]
    }
}
