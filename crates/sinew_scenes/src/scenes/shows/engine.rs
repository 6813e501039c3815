//! The main loop with frames of any length, and a kind of object that the user defines.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::Setup;
use crate::parts::{GRAVITY, ball, cuboid, fallen, floor, ghost, hook, join, level_rod};
use core::f64::consts::PI;
use core::time::Duration;
use sinew::math::{Random, ReadError, Reader, Vec3, Writer, max, min, trig};
use sinew::physics::particles::RopeDef;
use sinew::physics::{BodyId, Corrections, ObjectId, PhysicsObject, World};

pub(in crate::scenes) const FRAME_RATES: Scene = Scene {
    chapter: Chapter::Shows,
    name: "frame_rates",
    about: "a world gives the same bits after every second at 24, 30, 60, 144 and at uneven frames per second",
    steps: 240,
    settings: &[],
    build: frame_rates,
};

/// Rates of even frames, per second, and the metric of each.
const RATES: [(u32, &str); 4] =
    [(24, "differ_24"), (30, "differ_30"), (60, "differ_60"), (144, "differ_144")];

/// Steps after which hashes are compared.
const COMPARED: u64 = 60;

fn frame_rates(setup: &Setup<'_>) -> Instance {
    let (world, dropped) = crowd(setup);
    let even = RATES.map(|(rate, name)| (name, Frames::Even(Duration::from_secs(1) / rate)));
    let frames = even.into_iter().chain([("differ_uneven", Frames::Uneven(Random::new(24)))]);
    let others = frames.map(|(name, frames)| Other::new(name, frames, crowd(setup).0)).collect();
    Instance::new(world, FrameRates { dropped, compared: 0, stepped: crowd(setup).0, others })
}

/// Initial height of the ball, m.
const DROP: f32 = 100.0;

/// Bodies of several kinds, and a ball that falls past them.
fn crowd(setup: &Setup<'_>) -> (World, BodyId) {
    let mut world = setup.world();
    world.add_body(&floor());
    for i in 0..4 {
        let i = i as f32;
        world.add_body(&cuboid(Vec3::splat(0.1), Vec3::new(0.04 * i, 0.15 + 0.25 * i, -0.03 * i)));
    }
    let mut hung = hook();
    hung.position = Vec3::new(1.0, 1.5, 0.0);
    let mut last = world.add_body(&hung);
    for i in 0..3 {
        let start = 1.0 + 0.3 * i as f32;
        let mut rod = level_rod(start, 0.3, 0.03);
        rod.position.y = 1.5;
        let rod = world.add_body(&rod);
        join(&mut world, last, rod, Vec3::new(start, 1.5, 0.0));
        last = rod;
    }
    let (from, to) = (Vec3::new(-1.2, 0.8, 0.0), Vec3::new(-0.5, 0.8, 0.1));
    world.add_particles(
        &RopeDef { from, to, links: 8, mass: 0.2, stiffness: 500.0, radius: 0.02 }.build().group,
    );
    string(&mut world, &[2.0], -2.0);
    let dropped = world.add_body(&ghost(ball(0.1, Vec3::Y * DROP)));
    (world, dropped)
}

enum Frames {
    Even(Duration),
    Uneven(Random),
}

/// A copy of the world at another frame rate.
struct Other {
    /// Name of the copy's metric.
    name: &'static str,
    frames: Frames,
    world: World,
    /// Total time of the copy's frames.
    time: Duration,
    /// Number of times that the copy's state differed.
    differed: u32,
}

impl Other {
    fn new(name: &'static str, frames: Frames, world: World) -> Self {
        Self { name, frames, world, time: Duration::ZERO, differed: 0 }
    }

    /// Advances frame by frame. The last frame ends exactly at `until`, because a remaining time would change the
    /// state.
    fn advance(&mut self, until: Duration) {
        while self.time < until {
            let frame = match &mut self.frames {
                Frames::Even(frame) => *frame,
                Frames::Uneven(random) => Duration::from_secs_f32(random.range(0.001, 0.1)),
            };
            let frame = Duration::min(frame, until - self.time);
            self.world.update(frame);
            self.time += frame;
        }
    }
}

struct FrameRates {
    dropped: BodyId,
    /// Number of times that states were compared.
    compared: u32,
    /// The world in single steps without frames.
    stepped: World,
    others: Vec<Other>,
}

impl Script for FrameRates {
    fn after_step(&mut self, world: &mut World) {
        self.stepped.step();
        if !world.step_count().is_multiple_of(COMPARED) {
            return;
        }
        self.compared += 1;
        let hash = self.stepped.hash();
        for other in &mut self.others {
            other.advance(Duration::from_nanos(world.step_count() * world.def().step_nanoseconds));
            other.differed += u32::from(other.world.hash() != hash);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let mut metrics: Vec<Metric> = self
            .others
            .iter()
            .map(|other| Metric::new(other.name, other.differed, Expected::AtMost(0.0)))
            .collect();
        let drop = DROP - world.transform(self.dropped).translation.y;
        metrics.extend([
            Metric::new("compared", self.compared, Expected::Near { value: 4.0, tolerance: 0.0 }),
            Metric::new("drop_m", drop, Expected::near(fallen(world), 1e-4)),
        ]);
        metrics
    }
}

pub(in crate::scenes) const TAUTOCHRONE: Scene = Scene {
    chapter: Chapter::Shows,
    name: "tautochrone",
    about: "beads on cycloids, wires defined by the user, take the same time down from any height",
    steps: 600,
    settings: &[],
    build: |setup| {
        let mut world = setup.sleepless_world();
        let wire = string(&mut world, &[0.5, 1.2, 2.0], 0.0);
        let beads = world.object::<Wire>(wire).beads.iter().map(|bead| bead.id);
        let beads: Vec<Bead> = beads.zip(PERIODS).map(|(id, name)| Bead::new(&world, id, name)).collect();
        Instance::new(world, Tautochrone { wire, beads })
    },
};

/// Metrics of the periods, from the lowest start to the highest.
const PERIODS: [&str; 3] = ["period_low_s", "period_middle_s", "period_high_s"];

/// Radius of the circle that draws the cycloid, metres.
const CIRCLE: f32 = 0.25;
/// Radius of a bead, metres.
const BEAD: f32 = 0.03;

/// Cycloids side by side along z, open upwards, with a bead on each; a wire is neither a shape nor a joint of the
/// engine.
struct Wire {
    beads: Vec<OnWire>,
}

struct OnWire {
    id: BodyId,
    /// Angle by which the circle has rolled from the bottom, radians: the last position of the bead on the wire.
    rolled: f32,
    z: f32,
}

impl OnWire {
    /// Point of the cycloid: `r (φ + sin φ)`, `r (1 − cos φ)`.
    fn place(&self) -> Vec3 {
        let (sin, cos) = trig::sin_cos(self.rolled);
        Vec3::new(CIRCLE * (self.rolled + sin), CIRCLE * (1.0 - cos), self.z)
    }

    fn tangent(&self) -> Vec3 {
        let (sin, cos) = trig::sin_cos(self.rolled);
        Vec3::new(1.0 + cos, sin, 0.0) * CIRCLE
    }

    /// Rolls to the point at which the line through `place` along the normal at the bead's old position crosses the
    /// wire, by Newton's method (SHAKE; with the normal at the new position the bead would lose energy in every bend).
    fn follow(&mut self, place: Vec3) {
        let came = self.tangent();
        for _ in 0..4 {
            self.rolled += (place - self.place()).dot(came) / self.tangent().dot(came);
        }
    }
}

/// Puts beads on wires, at angles by which the circle has rolled.
fn string(world: &mut World, rolled: &[f32], z: f32) -> ObjectId {
    let mut thread = |(i, &rolled): (usize, &f32)| {
        let mut bead = OnWire { id: BodyId::from_bits(0), rolled, z: z + 0.2 * i as f32 };
        bead.id = world.add_body(&ghost(ball(BEAD, bead.place())));
        bead
    };
    let beads = rolled.iter().enumerate().map(&mut thread).collect();
    world.add_object(Box::new(Wire { beads }))
}

impl PhysicsObject for Wire {
    fn kind(&self) -> &'static str {
        "wire"
    }

    fn satisfy_constraints(&mut self, corrections: &mut Corrections<'_>) {
        for bead in &mut self.beads {
            let place = corrections.center_of_mass(bead.id);
            bead.follow(place);
            let mass = corrections.mass(bead.id).mass;
            let impulse = (bead.place() - place) * (mass / corrections.h());
            corrections.correct(bead.id, impulse, place);
        }
    }

    fn save(&self, w: &mut Writer) {
        w.count(self.beads.len());
        for bead in &self.beads {
            w.u64(bead.id.to_bits());
            w.f32(bead.rolled);
            w.f32(bead.z);
        }
    }

    fn load(&mut self, r: &mut Reader<'_>) -> Result<(), ReadError> {
        self.beads.clear();
        for _ in 0..r.count(16)? {
            self.beads.push(OnWire { id: BodyId::from_bits(r.u64()?), rolled: r.f32()?, z: r.f32()? });
        }
        Ok(())
    }
}

/// Measurements of a bead.
struct Bead {
    id: BodyId,
    /// Name of the metric of the bead's period.
    name: &'static str,
    /// Energy at the start, and largest deviation from it, J.
    start: f32,
    drift: f32,
    /// Position along x in the last step.
    before: f32,
    /// Times of the first and the last pass through the bottom toward −x, s.
    passes: Option<(f64, f64)>,
    /// Number of periods between those passes.
    periods: u32,
}

impl Bead {
    fn new(world: &World, id: BodyId, name: &'static str) -> Self {
        let start = world.body_energy(id).total();
        Self { id, name, start, drift: 0.0, before: 1.0, passes: None, periods: 0 }
    }

    fn after_step(&mut self, world: &World) {
        let energy = world.body_energy(self.id).total();
        self.drift = max(self.drift, (energy - self.start).abs() / self.start);
        let x = world.center_of_mass(self.id).x;
        if self.before > 0.0 && x <= 0.0 {
            let now = world.time() - f64::from(x / (x - self.before)) * f64::from(world.def().dt());
            self.periods += u32::from(self.passes.is_some());
            self.passes = Some((self.passes.map_or(now, |(first, _)| first), now));
        }
        self.before = x;
    }

    fn first_pass(&self) -> Option<f32> {
        self.passes.map(|(first, _)| first as f32)
    }

    fn period(&self) -> Option<f32> {
        let (first, last) = self.passes.filter(|_| self.periods > 0)?;
        Some(((last - first) / f64::from(self.periods)) as f32)
    }
}

struct Tautochrone {
    wire: ObjectId,
    beads: Vec<Bead>,
}

impl Script for Tautochrone {
    fn after_step(&mut self, world: &mut World) {
        for bead in &mut self.beads {
            bead.after_step(world);
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        // Huygens, Horologium Oscillatorium (1673): along the wire `s" = −g s / (4 r)`, so `T = 4π √(r/g)` from any
        // height.
        let period = 4.0 * PI * f64::from(CIRCLE / GRAVITY).sqrt();
        let of = |bead: &Bead| Metric::awaited(bead.name, bead.period(), Expected::near(period, 0.0005));
        let mut metrics: Vec<Metric> = self.beads.iter().map(of).collect();
        let arrivals: Option<Vec<f32>> = self.beads.iter().map(Bead::first_pass).collect();
        let spread = arrivals
            .map(|all| all.iter().copied().fold(0.0, max) - all.iter().copied().fold(f32::INFINITY, min));
        let drift = self.beads.iter().map(|bead| bead.drift).fold(0.0, max);
        let off = world
            .object::<Wire>(self.wire)
            .beads
            .iter()
            .fold(0.0, |most, bead| max(most, (world.center_of_mass(bead.id) - bead.place()).length()));
        metrics.extend([
            Metric::awaited("spread_s", spread, Expected::AtMost(0.0005)),
            Metric::new("energy_drift", drift, Expected::AtMost(0.01)),
            Metric::new("off_wire_m", off, Expected::AtMost(1e-4)),
        ]);
        metrics
    }
}
