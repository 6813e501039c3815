//! A pendulum clock: `cargo run -p sinew --example pendulum_clock`.
//!
//! The pendulum is a body on a hinge. The escapement is a custom object: near the plumb line it pushes the pendulum in
//! its direction, which compensates the drag of the air, and it counts the swings for the hands. A push that is
//! symmetric about the plumb line does not change the period (Airy 1826), so the clock has the period of the free
//! pendulum, `T = 2π √(I/(m g l)) (1 + A²/16)` at an amplitude of `A` radians.

use core::f32::consts::{PI, TAU};
use sinew::prelude::*;
use std::time::Duration;

/// Gravity of the Earth, m/s².
const GRAVITY: f32 = 9.81;
/// Period of the pendulum, seconds; each swing takes one second.
const PERIOD: f32 = 2.0;
/// Amplitude of the pendulum, radians.
const AMPLITUDE: f32 = 0.06;
/// Angle from the plumb line within which the escapement pushes, radians.
const REACH: f32 = 0.02;
/// Share of its speed that the pendulum would lose in a second without a push.
const DRAG: f32 = 0.02;
/// Radius of the bob, metres.
const RADIUS: f32 = 0.06;

/// Side of the pendulum relative to the plumb line.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Left,
    Right,
}

/// An escapement, which keeps a pendulum swinging and counts its swings.
struct Escapement {
    pendulum: BodyId,
    /// Torque in the direction of motion, N·m.
    torque: f32,
    /// Last side of the pendulum.
    side: Side,
    /// Number of passes through the plumb line.
    ticks: u32,
}

impl Escapement {
    /// Returns an escapement for a pendulum that starts on the right.
    fn new(pendulum: BodyId, torque: f32) -> Self {
        Self { pendulum, torque, side: Side::Right, ticks: 0 }
    }

    /// Returns the angle from the plumb line, radians. The clock's axle is at the world's origin.
    fn angle(bob: Vec3) -> f32 {
        trig::atan2(bob.x, -bob.y)
    }

    /// Returns the vector of a hand from its axle; the hand makes one turn in `seconds`.
    fn hand(&self, seconds: u32, length: f32) -> Vec3 {
        let angle = TAU * (self.ticks % seconds) as f32 / seconds as f32;
        Vec3::new(trig::sin(angle), trig::cos(angle), 0.1) * length
    }
}

impl PhysicsObject for Escapement {
    fn kind(&self) -> &'static str {
        "escapement"
    }

    fn add_forces(&mut self, forces: &mut Forces<'_>) {
        let angle = Self::angle(forces.center_of_mass(self.pendulum));
        let side = if angle < 0.0 { Side::Left } else { Side::Right };
        if side != self.side {
            self.side = side;
            self.ticks += 1;
        }
        if angle.abs() < REACH {
            let way = forces.velocity(self.pendulum).angular.z.signum();
            forces.apply_torque(self.pendulum, Vec3::Z * (self.torque * way));
        }
    }

    fn draw(&self, _: &World, out: &mut dyn DebugDraw) {
        for (seconds, length) in [(60, 0.20), (3_600, 0.18), (43_200, 0.12)] {
            out.line(Vec3::ZERO, self.hand(seconds, length), DrawKind::Object);
        }
    }

    fn save(&self, w: &mut Writer) {
        w.u64(self.pendulum.to_bits());
        w.f32(self.torque);
        w.bool(self.side == Side::Right);
        w.u32(self.ticks);
    }

    fn load(&mut self, r: &mut Reader<'_>) -> Result<(), ReadError> {
        self.pendulum = BodyId::from_bits(r.u64()?);
        self.torque = r.f32()?;
        self.side = if r.bool()? { Side::Right } else { Side::Left };
        self.ticks = r.u32()?;
        Ok(())
    }
}

/// Returns the clock, released at its steady amplitude.
fn clock() -> (World, ObjectId) {
    let gravity = Vec3::NEG_Y * GRAVITY;
    let mut world = World::new(WorldDef { gravity, sleeping: Sleeping::Off, ..WorldDef::default() });
    let case = world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() });

    // I/(m l) is the length of the thread with the same period; for a ball I = m (l² + 0.4 r²).
    let round = 1.0 + AMPLITUDE * AMPLITUDE / 16.0;
    let thread = GRAVITY * (PERIOD / (TAU * round)) * (PERIOD / (TAU * round));
    let length = 0.5 * (thread + (thread * thread - 1.6 * RADIUS * RADIUS).sqrt());
    let pendulum = world.add_body(&BodyDef {
        position: Vec3::new(trig::sin(AMPLITUDE), -trig::cos(AMPLITUDE), 0.0) * length,
        linear_damping: DRAG,
        angular_damping: DRAG,
        ..BodyDef::dynamic(Shape::Sphere { radius: RADIUS })
    });
    let at = Transform::new(Vec3::ZERO, Rotation::from_arc(Vec3::X, Vec3::Z));
    let hinge = JointKind::Hinge { limit: None };
    let poses = [case, pendulum].map(|id| world.transform(id));
    world.add_joint(&JointDef::new(case, pendulum, poses[0], poses[1], at, hinge));

    // In a period the drag takes the energy π I ω A² DRAG; the escapement adds its torque times 4 REACH.
    let inertia = world.mass(pendulum).mass * length * thread;
    let torque = PI * inertia * (TAU / PERIOD) * AMPLITUDE * AMPLITUDE * DRAG / (4.0 * REACH);
    let escapement = world.add_object(Box::new(Escapement::new(pendulum, torque)));
    println!(
        "a pendulum of {length:.4} m for a period of {PERIOD} s; {:.2} mN·m keep it going",
        torque * 1e3
    );
    (world, escapement)
}

/// Runs the clock for some minutes; returns the mean period of the last one, s, and the amplitude, radians.
fn run(world: &mut World, escapement: ObjectId, minutes: u32) -> (f64, f32) {
    let mut passed: Vec<f64> = Vec::new();
    let (mut before, mut swing) = (0.0, 0.0);
    for frame in 0..minutes * 60 * 30 {
        // Thirty frames per second, two steps each.
        world.update_with(Duration::from_nanos(33_333_334), |world| {
            world.step();
            let bob = world.center_of_mass(world.object::<Escapement>(escapement).pendulum);
            let angle = Escapement::angle(bob);
            if frame + 60 * 30 >= minutes * 60 * 30 {
                swing = f32::max(swing, angle);
                if before > 0.0 && angle <= 0.0 {
                    let ago = f64::from(angle / (angle - before) * world.def().dt());
                    passed.push(world.time() - ago);
                }
            }
            before = angle;
        });
    }
    let periods = (passed.len() - 1) as f64;
    ((passed[passed.len() - 1] - passed[0]) / periods, swing)
}

/// Starts the clock, compares it with theory, and checks that a snapshot has its whole state.
pub fn main() {
    let (mut world, escapement) = clock();
    world.mark();
    let (period, swing) = run(&mut world, escapement, 3);
    let ticks = world.object::<Escapement>(escapement).ticks;
    let fast = (f64::from(PERIOD) / period - 1.0) * 86_400.0;
    println!(
        "three minutes: {ticks} ticks of a second; {fast:+.1} s a day; it swings to {swing:.4} rad for {AMPLITUDE}"
    );
    assert_eq!(ticks, 180);
    // The escapement reads the pendulum 240 times a second, so it pushes half a substep late, which causes 2 s a day.
    assert!(fast.abs() < 5.0, "within 5 s a day");
    assert!((swing / AMPLITUDE - 1.0).abs() < 0.01);

    let after = world.hash();
    world.reset();
    assert_eq!(world.object::<Escapement>(escapement).ticks, 0);
    run(&mut world, escapement, 3);
    assert_eq!(world.hash(), after, "the same three minutes again, bit for bit");

    let mut snapshot = Writer::new();
    world.save(&mut snapshot);
    let mut other = World::new(WorldDef::default());
    // A new escapement without a pendulum: the saved state has the id of the pendulum.
    other.register_kind(|| Box::new(Escapement::new(BodyId::from_bits(0), 0.0)));
    other.load(&mut Reader::new(snapshot.as_bytes())).expect("the saved state can be loaded");
    let goes_on = [&mut world, &mut other].map(|world| {
        run(world, escapement, 1);
        world.hash()
    });
    assert_eq!(goes_on[0], goes_on[1]);
    println!("reset: the same again; a snapshot goes on in another world: state {after:016x}");
}
