//! Gravitation: a planet around a fixed centre, two bodies around each other, three on one path.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::Setup;
use crate::framework::setting::weightless_world;
use crate::parts::{ball, ghost};
use core::f32::consts::{PI, TAU};
use sinew::math::{Sym3, Vec3, max, trig};
use sinew::physics::particles::{GroupDef, ParticleDef};
use sinew::physics::{
    BodyDef, BodyId, FieldDef, FieldId, FieldKind, GroupId, MassProperties, Momentum, MutualGravity,
    PointGravity, World,
};

/// A ball with a given mass that collides with nothing.
fn star(mass: f32, radius: f32, position: Vec3, linear_velocity: Vec3) -> BodyDef {
    let inertia = Sym3::from_diagonal(Vec3::splat(0.4 * mass * radius * radius));
    let mass = Some(MassProperties { mass, center: Vec3::ZERO, inertia });
    BodyDef { mass, linear_velocity, ..ghost(ball(radius, position)) }
}

pub(in crate::scenes) const KEPLER: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "kepler",
    about: "a planet and a particle move on ellipses about a centre: period, energy, angular momentum and axis stay",
    steps: 1140,
    settings: &[],
    build: kepler,
};

/// Eccentricity of the ellipse; its semi-major axis is 1 m, and `μ` is 1 m³/s².
const ECCENTRICITY: f32 = 0.5;

fn kepler(setup: &Setup<'_>) -> Instance {
    let mut world = weightless_world();
    // Distance and speed at the nearest point: r = 1 − e, v = √((1 + e)/(1 − e)).
    let near = 1.0 - ECCENTRICITY;
    let fast = ((1.0 + ECCENTRICITY) / near).sqrt();
    let planet = world.add_body(&star(2.0, 0.05, Vec3::X * near, Vec3::Y * fast));
    let particle = ParticleDef { position: Vec3::Z * near, velocity: Vec3::X * fast, mass: 0.1, radius: 0.0 };
    let particles = world.add_particles(&GroupDef { particles: vec![particle], ..GroupDef::default() });
    let pull = PointGravity { strength: setup.gravity_factor, ..PointGravity::default() };
    world.add_field(&FieldDef::new(FieldKind::Point(pull)));
    let orbits = [Orbit::new(Vec3::X * near, Vec3::Y * fast), Orbit::new(Vec3::Z * near, Vec3::X * fast)];
    let start = world.momentum().angular;
    let energy = world.energy().total();
    Instance::new(world, Kepler { planet, particles, orbits, start, energy, drift: 0.0, turned: 0.0 })
}

/// Observed orbit of the planet or the particle.
struct Orbit {
    position: Vec3,
    velocity: Vec3,
    /// Times at which the distance from the centre was largest, in steps, with fractions.
    far: Vec<f32>,
    /// Directions of the nearest point when the distance was largest for the first and for the last time.
    axes: Option<[Vec3; 2]>,
}

impl Orbit {
    fn new(position: Vec3, velocity: Vec3) -> Self {
        Self { position, velocity, far: Vec::new(), axes: None }
    }

    fn after_step(&mut self, step: u64, position: Vec3, velocity: Vec3) {
        let (before, now) = (self.position.dot(self.velocity), position.dot(velocity));
        if before > 0.0 && now <= 0.0 {
            self.far.push(step as f32 - now / (now - before));
            // Laplace's vector, of length e, points to the nearest point: v × L/μ − r̂.
            let axis = |r: Vec3, v: Vec3| v.cross(r.cross(v)) - r / r.length();
            let share = before / (before - now);
            let here = axis(self.position, self.velocity) * (1.0 - share) + axis(position, velocity) * share;
            self.axes = Some([self.axes.map_or(here, |[first, _]| first), here]);
        }
        (self.position, self.velocity) = (position, velocity);
    }

    fn period(&self, world: &World) -> Option<f32> {
        let rounds = self.far.len().checked_sub(1).filter(|&rounds| rounds > 0)?;
        Some((self.far[rounds] - self.far[0]) / rounds as f32 * world.def().dt())
    }

    /// Precession of the axis, radians per round.
    fn precession(&self) -> Option<f32> {
        let [first, last] = self.axes?;
        let rounds = max(self.far.len() as f32 - 1.0, 1.0);
        Some(trig::atan2(first.cross(last).length(), first.dot(last)) / rounds)
    }
}

struct Kepler {
    planet: BodyId,
    particles: GroupId,
    orbits: [Orbit; 2],
    /// Angular momentum and energy at the start.
    start: Vec3,
    energy: f32,
    /// Largest relative deviations of energy and of angular momentum from the start.
    drift: f32,
    turned: f32,
}

impl Script for Kepler {
    fn after_step(&mut self, world: &mut World) {
        let group = world.particles(self.particles);
        let states = [
            (world.center_of_mass(self.planet), world.velocity(self.planet).linear),
            (group.positions()[0], group.velocities()[0]),
        ];
        for (orbit, (position, velocity)) in self.orbits.iter_mut().zip(states) {
            orbit.after_step(world.step_count(), position, velocity);
        }
        self.drift = max(self.drift, (world.energy().total() / self.energy - 1.0).abs());
        let turned = world.momentum().angular - self.start;
        self.turned = max(self.turned, turned.length() / self.start.length());
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let [planet, particle] = &self.orbits;
        // Kepler's period `T = 2π √(a³/μ)`.
        let period = || Expected::near(TAU, 1e-3);
        vec![
            Metric::awaited("period_s", planet.period(world), period()),
            Metric::awaited("particle_period_s", particle.period(world), period()),
            Metric::awaited("precession_rad", planet.precession(), Expected::AtMost(1e-3)),
            // The energy is `E = −(M + m)/2`, and oscillates within each round by the length of the substep.
            Metric::new("energy_error_max", self.drift, Expected::AtMost(0.02)),
            Metric::new("angular_momentum_error_max", self.turned, Expected::AtMost(1e-5)),
        ]
    }
}

pub(in crate::scenes) const SUN_EARTH: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "sun_earth",
    about: "Sun and Earth pull each other with the same force; their accelerations differ by their masses",
    steps: 120,
    settings: &[],
    build: sun_earth,
};

/// Mass of the Earth in solar masses.
const EARTH: f32 = 3.003_490e-6;

fn sun_earth(setup: &Setup<'_>) -> Instance {
    let mut world = weightless_world();
    // The orbit is a circle about the common centre of mass, which rests, with a distance of 1 astronomical unit and 2π
    // units of speed a year.
    let total = 1.0 + EARTH;
    let speed = TAU * total.sqrt();
    let at = |share: f32| (Vec3::X * share, Vec3::Z * (-speed * share));
    let (position, velocity) = at(-EARTH / total);
    let sun = world.add_body(&star(1.0, 0.05, position, velocity));
    let (position, velocity) = at(1.0 / total);
    let earth = world.add_body(&star(EARTH, 0.02, position, velocity));
    let constant = MutualGravity::ASTRONOMICAL * setup.gravity_factor;
    let law = MutualGravity { constant, softening: 0.0 };
    let field = world.add_field(&FieldDef::new(FieldKind::Mutual(law)));
    let scale = EARTH * speed;
    let velocities = [world.velocity(sun).linear, velocity];
    let angle = AngleTurned { direction: position, sum: 0.0 };
    let momentum = 0.0;
    Instance::new(world, SunEarth { sun, earth, field, scale, velocities, gained: [0.0; 2], angle, momentum })
}

/// Angle by which an object has turned about y, radians.
struct AngleTurned {
    direction: Vec3,
    sum: f32,
}

impl AngleTurned {
    fn after_step(&mut self, direction: Vec3) {
        let sine = self.direction.cross(direction).y;
        self.sum += trig::atan2(sine, self.direction.dot(direction));
        self.direction = direction;
    }
}

struct SunEarth {
    sun: BodyId,
    earth: BodyId,
    field: FieldId,
    /// Momentum of the Earth, solar masses × astronomical units per year.
    scale: f32,
    velocities: [Vec3; 2],
    /// Sum of the changes of each velocity.
    gained: [f32; 2],
    angle: AngleTurned,
    /// Largest sum of both momenta, relative to the Earth's.
    momentum: f32,
}

impl Script for SunEarth {
    fn after_step(&mut self, world: &mut World) {
        for (i, body) in [self.sun, self.earth].into_iter().enumerate() {
            let velocity = world.velocity(body).linear;
            self.gained[i] += (velocity - self.velocities[i]).length();
            self.velocities[i] = velocity;
        }
        self.angle.after_step(world.center_of_mass(self.earth) - world.center_of_mass(self.sun));
        self.momentum = max(self.momentum, world.momentum().linear.length() / self.scale);
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let force = |body| world.field_force(self.field, body).force;
        let (on_sun, on_earth) = (force(self.sun), force(self.earth));
        let share = |sun: f32, earth: f32| 100.0 * f64::from(earth) / (f64::from(sun) + f64::from(earth));
        let mass_share = 100.0 / (1.0 + f64::from(EARTH));
        let year = world.time() as f32 * TAU / self.angle.sum;
        // Newton's law `G m₁ m₂/d²` with G = 4π².
        let pull = 4.0 * PI * PI * EARTH;
        vec![
            Metric::new("force_on_earth", on_earth.length(), Expected::near(pull, 2e-3)),
            Metric::new("forces_differ_by", (on_sun + on_earth).length(), Expected::AtMost(0.0)),
            Metric::new(
                "force_on_earth_percent",
                share(on_sun.length(), on_earth.length()),
                Expected::near(50.0, 1e-9),
            ),
            Metric::new(
                "acceleration_of_earth_percent",
                share(self.gained[0], self.gained[1]),
                Expected::Near { value: mass_share, tolerance: 1e-6 },
            ),
            Metric::new("year", year, Expected::near(1.0, 1e-3)),
            Metric::new("momentum_error_max", self.momentum, Expected::AtMost(1e-5)),
        ]
    }
}

pub(in crate::scenes) const THREE_BODIES: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "three_bodies",
    about: "three equal bodies move on the same path, a figure of eight",
    steps: 380,
    settings: &[],
    build: three_bodies,
};

/// Period of the figure with `G`, masses and size 1 (Chenciner and Montgomery, Annals of Mathematics 152, 2000; numbers
/// by Simó).
const EIGHT_PERIOD: f32 = 6.325_914;

fn three_bodies(setup: &Setup<'_>) -> Instance {
    let mut world = weightless_world();
    let (place, speed) =
        (Vec3::new(0.970_004_36, -0.243_087_53, 0.0), Vec3::new(-0.932_407_4, -0.864_731_5, 0.0));
    let starts = [(place, speed * -0.5), (-place, speed * -0.5), (Vec3::ZERO, speed)];
    let bodies = starts.map(|(position, velocity)| world.add_body(&star(1.0, 0.05, position, velocity)));
    let law = MutualGravity { constant: setup.gravity_factor, softening: 0.0 };
    world.add_field(&FieldDef::new(FieldKind::Mutual(law)));
    let (start, energy) = (world.momentum(), world.energy().total());
    Instance::new(world, Eight { bodies, places: starts.map(|(at, _)| at), start, energy, drift: 0.0 })
}

struct Eight {
    bodies: [BodyId; 3],
    places: [Vec3; 3],
    start: Momentum,
    energy: f32,
    drift: f32,
}

impl Script for Eight {
    fn after_step(&mut self, world: &mut World) {
        self.drift = max(self.drift, (world.energy().total() / self.energy - 1.0).abs());
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        // Extrapolates back to the time of the full period.
        let rest = world.time() as f32 - EIGHT_PERIOD;
        let off = self.bodies.iter().zip(self.places).map(|(&body, place)| {
            (world.center_of_mass(body) - world.velocity(body).linear * rest - place).length()
        });
        let now = world.momentum();
        vec![
            Metric::new("off_after_a_round_m", off.fold(0.0, max), Expected::AtMost(0.02)),
            Metric::new("energy_error_max", self.drift, Expected::AtMost(0.01)),
            Metric::new("momentum_n_s", (now.linear - self.start.linear).length(), Expected::AtMost(1e-5)),
            Metric::new(
                "angular_momentum_n_m_s",
                (now.angular - self.start.angular).length(),
                Expected::AtMost(1e-5),
            ),
        ]
    }
}
