//! Nested gimbal rings, which show the limits of three Euler angles.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::weightless_world;
use crate::framework::setting::{Setting, Setup};
use crate::parts::{ball, ghost, hinge, hook};
use core::f32::consts::{FRAC_PI_2, TAU};
use sinew::math::{EulerConvention, EulerOrder, Rotation, Sym3, Transform, Vec3, max, min, trig};
use sinew::physics::{BodyDef, BodyId, JointId, MassProperties, Motor, Shape, ShapeDef, Velocity, World};

pub(in crate::scenes) const GIMBAL: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "gimbal",
    about: "bodies in three rings pitch into gimbal lock and lose a degree of freedom; one without rings does not",
    steps: 180,
    settings: &[Setting::number(
        "margin",
        5.0,
        (1.0, 60.0),
        "smallest angle between the free body and gimbal lock, degrees",
    )],
    build: gimbal,
};

/// The outer ring gives heading about y, the inner ring pitch about x, the body in the rings roll about z.
const RINGS: EulerConvention = EulerOrder::Yxz.intrinsic();

/// Pitches of the gimbals, degrees.
const PITCHES: [f32; 4] = [0.0, 45.0, 80.0, 90.0];
/// Number of steps for the pitch.
const PITCHING: u64 = 60;
/// Inertia of the inner body about any axis, kg·m².
const INERTIA: f32 = 0.02;
/// Inertia of each of the two rings that the inner body can turn, relative to the body's.
const RING: f32 = 0.1;
/// Angular velocity of a free body after the kick, rad/s.
const KICK: f32 = 0.1;

fn gimbal(setup: &Setup<'_>) -> Instance {
    let mut world = weightless_world();
    let frame = world.add_body(&hook());
    let gimbals = [0, 1, 2, 3].map(|i| {
        let center = Vec3::X * (1.2 * i as f32 - 1.8);
        Gimbal::hang(&mut world, frame, center, PITCHES[i].to_radians())
    });
    let free = world.add_body(&round(ghost(ball(0.2, Vec3::new(0.6, 1.3, 0.0))), 1.0));
    let flyer = Flyer::start(&mut world, setup.number("margin").to_radians());
    Instance::new(world, Gimbals { gimbals, free, free_spin: None, flyer })
}

/// Gives a body equal inertia about every axis: `share` times that of the inner body.
fn round(def: BodyDef, share: f32) -> BodyDef {
    let inertia = Sym3::from_diagonal(Vec3::splat(share * INERTIA));
    BodyDef { mass: Some(MassProperties { mass: share, center: Vec3::ZERO, inertia }), ..def }
}

/// A ring of short capsules about an axis.
fn ring(center: Vec3, radius: f32, axis: Vec3) -> BodyDef {
    const PIECES: usize = 16;
    let upright = Rotation::from_arc(Vec3::Z, axis);
    let piece = |i: usize| {
        let turn = upright * Rotation::from_axis_angle(Vec3::Z, i as f32 * TAU / PIECES as f32);
        let half_height = radius * TAU / (2.0 * PIECES as f32);
        let body_from_shape = Transform::new(turn * (Vec3::X * radius), turn);
        ShapeDef { body_from_shape, ..ShapeDef::new(Shape::Capsule { half_height, radius: 0.02 }) }
    };
    let shapes = (0..PIECES).map(piece).collect();
    round(ghost(BodyDef { position: center, shapes, ..BodyDef::default() }), RING)
}

/// Two rings and a body in them, with hinges about y, x and z in the initial pose.
struct Gimbal {
    rings: [BodyId; 2],
    body: BodyId,
    /// Motor of the pitch.
    motor: JointId,
    /// Target pitch, radians.
    pitch: f32,
    /// Work of the motor, J.
    work: f32,
    /// Angular velocity of the body about the kick's axis right after the kick, rad/s.
    answer: Option<f32>,
    /// Distance of the three angles from gimbal lock before the kick, radians.
    margin: Option<f32>,
}

impl Gimbal {
    fn hang(world: &mut World, frame: BodyId, center: Vec3, pitch: f32) -> Self {
        // Each ring is in the plane of its own axis and the next one's.
        let outer = world.add_body(&ring(center, 0.5, Vec3::Z));
        let middle = world.add_body(&ring(center, 0.4, Vec3::Y));
        let body = world.add_body(&round(ghost(ball(0.2, center)), 1.0));
        let joint = |world: &mut World, a, b, axis| {
            let def = hinge(world, a, b, center, axis);
            world.add_joint(&def)
        };
        joint(world, frame, outer, Vec3::Y);
        let motor = joint(world, outer, middle, Vec3::X);
        joint(world, middle, body, Vec3::Z);
        let speed = pitch / (PITCHING as f32 * world.def().dt());
        world.set_motor(motor, Some(Motor::spin(speed, f32::INFINITY)));
        Self { rings: [outer, middle], body, motor, pitch, work: 0.0, answer: None, margin: None }
    }

    fn after_pitching(&mut self, world: &World) {
        // The gimbal turns by equal angles in each step.
        self.work += world.reaction(self.motor).torque.x * self.pitch / PITCHING as f32;
    }

    /// Stops all motion, and gives the body an angular impulse about z.
    fn kick(&mut self, world: &mut World) {
        self.margin = Some(world.transform(self.body).rotation.to_euler(RINGS).lock_margin);
        world.set_motor(self.motor, None);
        for id in self.rings.into_iter().chain([self.body]) {
            world.set_velocity(id, Velocity::default());
        }
        world.apply_angular_impulse(self.body, Vec3::Z * (KICK * INERTIA));
    }

    /// Returns the angular velocity of the body after the impulse, as a share of a free body's. Rings turn about
    /// `A = (y, x, z″)`, the body with `A q̇`: an impulse L gives `A (Aᵀ I A + J)⁻¹ Aᵀ L`. For L along z, with the
    /// inertia r of both rings relative to the body's and the cosine c of the pitch, it is `c² (1 + r) / (c² + r)`.
    fn expected(&self) -> f32 {
        let c = trig::cos(self.pitch);
        let (square, r) = (c * c, 2.0 * RING);
        square * (1.0 + r) / (square + r)
    }
}

/// A body without rings that rotates at constant speed past an orientation in which three angles would lock.
struct Flyer {
    body: BodyId,
    spin: Vec3,
    /// Smallest distance from gimbal lock, radians.
    miss: f32,
    last: Transform,
    /// Largest angle by which the outermost ring would turn within a step, radians.
    heading_step: f32,
    margin: f32,
    /// Largest deviation of the body's angular velocity from constant, rad/s.
    unsteady: f32,
}

/// Steps in which the flyer makes its first quarter turn: the flyer is closest to gimbal lock in the middle of a step.
const QUARTER: f32 = 90.5;

impl Flyer {
    fn start(world: &mut World, miss: f32) -> Self {
        let (sin, cos) = trig::sin_cos(miss);
        let spin = Vec3::new(cos, sin, 0.0) * (FRAC_PI_2 / (QUARTER * world.def().dt()));
        let shape = Shape::Box { half_extents: Vec3::new(0.1, 0.05, 0.25) };
        let def = BodyDef {
            position: Vec3::new(-0.6, 1.3, 0.0),
            angular_velocity: spin,
            shapes: vec![ShapeDef::new(shape)],
            ..BodyDef::default()
        };
        let body = world.add_body(&round(ghost(def), 1.0));
        let last = world.transform(body);
        Self { body, spin, miss, last, heading_step: 0.0, margin: FRAC_PI_2, unsteady: 0.0 }
    }

    fn after_step(&mut self, world: &World) {
        let (last, now) = (self.last, world.transform(self.body));
        self.last = now;
        let [before, after] = [last, now].map(|pose| pose.rotation.to_euler(RINGS));
        let step = (after.angles[0] - before.angles[0]).abs();
        self.heading_step = max(self.heading_step, min(step, TAU - step));
        self.margin = min(self.margin, after.lock_margin);
        let angular = last.rotation.angular_velocity_to(now.rotation, world.def().dt());
        self.unsteady = max(self.unsteady, (angular - self.spin).length());
    }

    fn metrics(&self, dt: f32) -> [Metric; 3] {
        // The body's nose moves on a great circle that passes the pole at a distance of `miss`.
        let half_step = 0.5 * self.spin.length() * dt;
        let heading_step = 2.0 * trig::atan2(trig::tan(half_step), trig::sin(self.miss));
        let closest = trig::acos(trig::cos(self.miss) * trig::cos(half_step));
        let rate = |step: f32| step / dt;
        [
            Metric::new(
                "flyer_margin_deg",
                self.margin.to_degrees(),
                Expected::near(closest.to_degrees(), 1e-3),
            ),
            Metric::new(
                "flyer_heading_max_rad_s",
                rate(self.heading_step),
                Expected::near(rate(heading_step), 1e-3),
            ),
            Metric::new("flyer_unsteady_rad_s", self.unsteady, Expected::AtMost(1e-3)),
        ]
    }
}

struct Gimbals {
    gimbals: [Gimbal; 4],
    free: BodyId,
    /// Angular velocity of the free body about the axis of the kick right after the kick, rad/s.
    free_spin: Option<f32>,
    flyer: Flyer,
}

impl Script for Gimbals {
    fn after_step(&mut self, world: &mut World) {
        self.flyer.after_step(world);
        if world.step_count() <= PITCHING {
            for gimbal in &mut self.gimbals {
                gimbal.after_pitching(world);
            }
        }
        if world.step_count() == PITCHING {
            for gimbal in &mut self.gimbals {
                gimbal.kick(world);
            }
            world.apply_angular_impulse(self.free, Vec3::Z * (KICK * INERTIA));
        }
        if world.step_count() == PITCHING + 1 {
            let spin = |body| world.velocity(body).angular.z;
            for gimbal in &mut self.gimbals {
                gimbal.answer = Some(spin(gimbal.body));
            }
            self.free_spin = Some(spin(self.free));
        }
    }

    fn work_in(&self, _: &World) -> f32 {
        self.gimbals.iter().map(|gimbal| gimbal.work).sum()
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        const NAMES: [&str; 4] =
            ["answer_at_0_deg", "answer_at_45_deg", "answer_at_80_deg", "answer_at_90_deg"];
        let share = |spin: Option<f32>| spin.map(|spin| spin / KICK);
        let answers = self.gimbals.iter().zip(NAMES).map(|(gimbal, name)| {
            let expected = Expected::Near { value: gimbal.expected().into(), tolerance: 1e-4 };
            Metric::awaited(name, share(gimbal.answer), expected)
        });
        let mut metrics: Vec<_> = answers.collect();
        let [.., locked] = &self.gimbals;
        let margin = locked.margin.map(f32::to_degrees);
        metrics.push(Metric::awaited("lock_margin_deg", margin, Expected::AtMost(0.01)));
        metrics.push(Metric::awaited(
            "answer_without_rings",
            share(self.free_spin),
            Expected::near(1.0, 1e-5),
        ));
        metrics.extend(self.flyer.metrics(world.def().dt()));
        metrics
    }
}
