//! Cloth in the wind and as an obstacle.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, ball};
use sinew::math::{Vec3, max};
use sinew::physics::particles::{Cloth, ClothDef, ParticleGroup};
use sinew::physics::{BodyDef, BodyId, FieldDef, FieldId, FieldKind, Filter, GroupId, Velocity, Wind, World};

pub(in crate::scenes) const FLAG: Scene = Scene {
    chapter: Chapter::Particles,
    name: "flag",
    about: "two banners lean in two winds, one twice as fast, at the angles that balance pressure and weight",
    steps: 900,
    settings: &[Setting::number(
        "wind",
        1.0,
        (0.5, 3.0),
        "wind of the first banner, m/s; from 3 on they flutter",
    )],
    build: flag,
};

/// Width and length of a banner, metres.
const WIDE: f32 = 0.6;
const LONG: f32 = 0.8;
/// Number of springs along its edges.
const COLUMNS: u32 = 9;
const ROWS: u32 = 12;
/// Mass, kg, and radius of each particle, metres.
const MASS: f32 = 0.2;
const RADIUS: f32 = 0.01;
/// Density of air, kg/m³, and the drag coefficient of a sheet.
const AIR: f32 = 1.225;
const DRAG: f32 = 1.2;

fn banner(corner: Vec3, iterations: u32) -> Cloth {
    let mut cloth = ClothDef {
        corner,
        across: Vec3::X * WIDE,
        down: Vec3::NEG_Y * LONG,
        columns: COLUMNS,
        rows: ROWS,
        mass: MASS,
        stretching: 1000.0,
        shearing: 100.0,
        bending: 1e-5,
        damping_ratio: 0.2,
        radius: RADIUS,
    }
    .build();
    let row = cloth.row(0);
    cloth.hang(&row);
    cloth.group.iterations = iterations;
    cloth
}

fn flag(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let wind = setup.number("wind");
    let banners = [1.0, 2.0].map(|factor| {
        let layer = factor as u32;
        let cloth = banner(Vec3::new(factor * 1.0 - 1.8, 2.0, 0.0), 4);
        let filter = Filter { layers: layer, ..Filter::default() };
        let speed = wind * factor;
        let air = Wind { velocity: Vec3::Z * speed, density: AIR, drag: DRAG, ..Wind::default() };
        let field = world.add_field(&FieldDef { layers: layer, ..FieldDef::new(FieldKind::Wind(air)) });
        let mut group = cloth.group;
        group.filter = filter;
        // The damping stops its swing.
        group.linear_damping = 1.0;
        (world.add_particles(&group), field)
    });
    Instance::new(world, Flag { banners, wind, work: 0.0 })
}

/// Slope of a flat sheet in a wind: horizontal over vertical extent. At the angle `φ` from the vertical the pressure `½
/// ρ C v² cos² φ` balances the weight's component across it, `μ g sin φ`.
fn slope(wind: f32) -> f32 {
    let pressure = 0.5 * AIR * DRAG * wind * wind / (MASS / (WIDE * LONG) * GRAVITY);
    let sine = ((1.0 + 4.0 * pressure * pressure).sqrt() - 1.0) / (2.0 * pressure);
    sine / (1.0 - sine * sine).sqrt()
}

struct Flag {
    /// Banners with their winds.
    banners: [(GroupId, FieldId); 2],
    /// Wind of the first banner, m/s.
    wind: f32,
    /// Work of the winds, J.
    work: f32,
}

/// Slope from the upper edge of a banner to its lower one: along the wind over down.
fn lean(group: &ParticleGroup) -> f32 {
    let columns = COLUMNS as usize + 1;
    let positions = group.positions();
    let mean = |row: &[Vec3]| row.iter().copied().sum::<Vec3>() / row.len() as f32;
    let hung = mean(&positions[positions.len() - columns..]) - mean(&positions[..columns]);
    hung.z / -hung.y
}

impl Script for Flag {
    fn after_step(&mut self, world: &mut World) {
        for (banner, wind) in self.banners {
            let velocities = world.particles(banner).velocities().iter().zip(0..);
            let power: f32 =
                velocities.map(|(&v, i)| world.field_force_on_particle(wind, banner, i).dot(v)).sum();
            self.work += power * world.def().dt();
        }
    }

    fn work_in(&self, _world: &World) -> f32 {
        self.work
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let leans = self.banners.map(|(banner, _)| lean(world.particles(banner)));
        vec![
            Metric::new("slope", leans[0], Expected::near(slope(self.wind), 0.005)),
            Metric::new("slope_twice_as_fast", leans[1], Expected::near(slope(2.0 * self.wind), 0.005)),
        ]
    }
}

pub(in crate::scenes) const CURTAIN: Scene = Scene {
    chapter: Chapter::Particles,
    name: "curtain",
    about: "a ball flies through a curtain, which then returns to its shape and sleeps",
    steps: 1200,
    settings: &[Setting::number("speed", 1.5, (0.2, 4.0), "speed of the ball, m/s")],
    build: curtain,
};

/// Radius of the ball, metres.
const BALL: f32 = 0.2;
/// Density of the ball, kg/m³; the ball weighs about 5 kg, twenty times the curtain.
const BALL_DENSITY: f32 = 150.0;
/// Mass of each particle of the curtain, kg.
const GRAIN: f32 = 2e-3;
/// Steps after which the ball is stopped, far away.
const FLOWN: u64 = 300;

fn curtain(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    let cloth = banner(Vec3::new(-0.5 * WIDE, 2.0, 0.0), 4);
    let mut group = cloth.group;
    group.linear_damping = 1.0;
    let held = group.attachments.len();
    group.particles.iter_mut().for_each(|particle| particle.mass = GRAIN);
    let weight = GRAIN * group.particles.len() as f32 * GRAVITY;
    let curtain = world.add_particles(&group);
    let mut def = BodyDef { gravity_scale: 0.0, ..ball(BALL, Vec3::new(0.0, 1.35, -1.0)) };
    def.shapes[0].density = BALL_DENSITY;
    let ball = world.add_body(&def);
    world.set_velocity(ball, Velocity { linear: Vec3::Z * setup.number("speed"), ..Velocity::default() });
    Instance::new(world, Curtain { curtain, ball, held, weight, deepest: 0.0, pushed: 0.0 })
}

struct Curtain {
    curtain: GroupId,
    ball: BodyId,
    /// Number of attached particles.
    held: usize,
    /// Weight of the curtain, N.
    weight: f32,
    /// Largest depth of a particle in the ball, metres.
    deepest: f32,
    /// Largest displacement of a particle, metres.
    pushed: f32,
}

impl Script for Curtain {
    fn after_step(&mut self, world: &mut World) {
        let group = world.particles(self.curtain);
        let center = world.center_of_mass(self.ball);
        for &position in group.positions() {
            self.deepest = max(self.deepest, BALL + RADIUS - (position - center).length());
            self.pushed = max(self.pushed, position.z);
        }
        if world.step_count() == FLOWN {
            world.set_velocity(self.ball, Velocity::default());
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let group = world.particles(self.curtain);
        let substep = world.def().dt() / world.def().substeps as f32;
        let carried: f32 = group.attachment_impulses()[..self.held].iter().map(|p| -p.y / substep).sum();
        let off = group.positions().iter().fold(0.0, |most, p| max(most, p.z.abs()));
        vec![
            Metric::new("carried_n", carried, Expected::near(self.weight, 0.005)),
            Metric::new("deepest_m", self.deepest, Expected::AtMost(f64::from(RADIUS))),
            Metric::new("pushed_m", self.pushed, Expected::Near { value: 0.6, tolerance: 0.4 }),
            Metric::new("off_its_plane_m", off, Expected::AtMost(0.02)),
            Metric::new("awake", f64::from(u8::from(group.is_awake())), Expected::AtMost(0.0)),
        ]
    }
}
