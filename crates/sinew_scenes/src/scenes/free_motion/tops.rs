//! Free and spinning rigid bodies, compared to Euler's equations.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::weightless_world;
use crate::framework::setting::{Setting, Setup};
use crate::framework::support::Support;
use crate::framework::turn::Turn;
use crate::parts::{GRAVITY, agm, body, cuboid, ghost, hook, join, tilt};
use sinew::math::{Rotation, Sym3, Vec3, max, trig};
use sinew::physics::{BodyDef, BodyId, JointId, MassProperties, Momentum, Shape, ShapeDef, World};

pub(in crate::scenes) const DZHANIBEKOV: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "dzhanibekov",
    about: "a box that spins about its middle axis flips again and again, at the times of Euler's equations",
    steps: 700,
    settings: &[
        Setting::number("spin", 10.0, (1.0, 30.0), "angular velocity about the middle axis, rad/s"),
        Setting::number("nudge", 0.1, (0.001, 0.5), "angular velocity about the long axis, rad/s"),
    ],
    build: dzhanibekov,
};

/// Half extents of a box of 0.4 × 0.2 × 0.1 m: longest along x, which has the smallest moment of inertia.
const BRICK: Vec3 = Vec3::new(0.2, 0.1, 0.05);
/// Number of flips that are compared to the closed form.
const FLIPS: usize = 5;

fn dzhanibekov(setup: &Setup<'_>) -> Instance {
    let mut world = weightless_world();
    let (spin, nudge) = (setup.number("spin"), setup.number("nudge"));
    let mut brick = cuboid(BRICK, Vec3::ZERO);
    brick.angular_velocity = Vec3::new(nudge, spin, 0.0);
    let brick = world.add_body(&brick);
    let period = flip_period(world.mass(brick).inertia, [nudge, spin, 0.0].map(f64::from));
    let (start, energy) = (world.momentum(), world.energy().kinetic);
    let flips = Vec::with_capacity(FLIPS);
    Instance::new(world, Flips { brick, period, start, energy, before: 1.0, flips, turned: 0.0, gained: 0.0 })
}

/// Time between two turns of a body with principal moments `x < y < z` that spins about y: `2 K(k) / r` with
/// `r² = (I₃ − I₂) (L² − 2E I₁) / (I₁ I₂ I₃)` and `k² = (I₂ − I₁) (2E I₃ − L²) / ((I₃ − I₂) (L² − 2E I₁))`, with I₁ and
/// I₃ exchanged where `L² < 2E I₂` (Landau and Lifshitz, Mechanics, §37).
fn flip_period(inertia: Sym3, omega: [f64; 3]) -> f64 {
    let moments = inertia.diagonal.to_array().map(f64::from);
    let sum = |power: i32| -> f64 {
        let term =
            |(moment, omega): (f64, f64)| if power == 1 { moment } else { moment * moment } * omega * omega;
        moments.into_iter().zip(omega).map(term).sum()
    };
    let (twice_energy, momentum2) = (sum(1), sum(2));
    let [x, i2, z] = moments;
    let (i1, i3) = if momentum2 < twice_energy * i2 { (z, x) } else { (x, z) };
    let fast = (i3 - i2) * (momentum2 - twice_energy * i1);
    let k2 = (i2 - i1) * (twice_energy * i3 - momentum2) / fast;
    let rate = (fast / (i1 * i2 * i3)).sqrt();
    core::f64::consts::PI / (agm(1.0, (1.0 - k2).sqrt()) * rate)
}

struct Flips {
    brick: BodyId,
    /// Time between two flips, s.
    period: f64,
    start: Momentum,
    /// Kinetic energy at the start, J.
    energy: f32,
    /// Component of the angular momentum along the intermediate axis in the last step.
    before: f32,
    /// Times of the flips, s.
    flips: Vec<f64>,
    /// Largest relative deviation of the angular momentum from the start.
    turned: f32,
    /// Largest relative deviation of the energy from the start.
    gained: f32,
}

impl Script for Flips {
    fn after_step(&mut self, world: &mut World) {
        let Momentum { angular, .. } = world.momentum();
        self.turned = max(self.turned, (angular - self.start.angular).length() / self.start.angular.length());
        self.gained = max(self.gained, (world.energy().kinetic / self.energy - 1.0).abs());
        let along = (world.transform(self.brick).rotation * Vec3::Y).dot(angular);
        if (along > 0.0) != (self.before > 0.0) {
            let ago = f64::from(along / (along - self.before)) * f64::from(world.def().dt());
            self.flips.push(world.time() - ago);
        }
        self.before = along;
    }

    fn metrics(&self, _: &World) -> Vec<Metric> {
        let flips = self.flips.get(..FLIPS);
        let every = flips.map(|flips| (flips[FLIPS - 1] - flips[0]) / (FLIPS - 1) as f64);
        // The motion starts halfway between two flips.
        let off = |(i, time): (usize, &f64)| (time / self.period - (i as f64 + 0.5)).abs() as f32;
        let off = flips.map(|flips| flips.iter().enumerate().map(off).fold(0.0, max));
        vec![
            Metric::awaited("flip_every_s", every.map(|s| s as f32), Expected::near(self.period, 0.05)),
            Metric::awaited("flip_off_periods", off, Expected::AtMost(0.05)),
            Metric::new("angular_momentum_error", self.turned, Expected::AtMost(1e-3)),
            Metric::new("energy_error", self.gained, Expected::AtMost(0.01)),
        ]
    }
}

pub(in crate::scenes) const SYMMETRIC_TOP: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "symmetric_top",
    about: "a free disc spins and wobbles: its angular velocity circles its axis at (I3 − I1) / I1 times its spin",
    steps: 600,
    settings: &[
        Setting::number("spin", 10.0, (1.0, 30.0), "angular velocity about the axis, rad/s"),
        Setting::number("wobble", 1.0, (0.1, 10.0), "across it, rad/s"),
    ],
    build: |setup| {
        let mut world = weightless_world();
        let mut disc = disc(Vec3::ZERO, Vec3::ZERO);
        disc.angular_velocity = Vec3::new(setup.number("wobble"), setup.number("spin"), 0.0);
        let disc = world.add_body(&disc);
        Instance::new(
            world,
            Wobble { disc, spin: setup.number("spin"), body: Turn::default(), space: Turn::default() },
        )
    },
};

/// Radius and mass of the disc, metres and kg.
const DISC_RADIUS: f32 = 0.1;
const DISC_MASS: f32 = 1.0;
/// Moment of inertia `m R² / 2` about the disc's axis; half of it about a diameter.
const DISC_MOMENT: f32 = 0.5 * DISC_MASS * DISC_RADIUS * DISC_RADIUS;

/// A thin disc across y that collides with nothing, on a pin from its centre down to `foot` in its own frame.
fn disc(center: Vec3, foot: Vec3) -> BodyDef {
    let plate = Shape::Box { half_extents: Vec3::new(0.7 * DISC_RADIUS, 0.006, 0.7 * DISC_RADIUS) };
    let pin = Shape::Capsule { half_height: 0.5 * foot.length(), radius: 0.004 };
    let mut def = body(plate.clone(), center);
    let mut other = ShapeDef::new(plate);
    other.body_from_shape.rotation = Rotation::from_axis_angle(Vec3::Y, core::f32::consts::FRAC_PI_4);
    let mut pin = ShapeDef::new(pin);
    pin.body_from_shape.translation = foot * 0.5;
    def.shapes.extend([other, pin]);
    let inertia = Sym3::from_diagonal(Vec3::new(0.5, 1.0, 0.5) * DISC_MOMENT);
    def.mass = Some(MassProperties { mass: DISC_MASS, center: Vec3::ZERO, inertia });
    ghost(def)
}

struct Wobble {
    disc: BodyId,
    /// Angular velocity about the axis, rad/s.
    spin: f32,
    /// Turn of the angular velocity about the axis, seen from the disc.
    body: Turn,
    /// Turn of the axis about the angular momentum, seen from the world.
    space: Turn,
}

impl Script for Wobble {
    fn after_step(&mut self, world: &mut World) {
        let dt = world.def().dt();
        let rotation = world.transform(self.disc).rotation;
        let omega = rotation.inverse() * world.velocity(self.disc).angular;
        self.body.after_step(trig::atan2(omega.x, omega.z), dt);
        let along = world.momentum().angular.normalize();
        let axis = rotation * Vec3::Y;
        let across = along.cross(Vec3::Z).normalize();
        self.space.after_step(trig::atan2(axis.dot(along.cross(across)), axis.dot(across)), dt);
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let Vec3 { x: across, y: along, .. } = world.mass(self.disc).inertia.diagonal;
        let body = (along - across) / across * self.spin;
        let space = world.momentum().angular.length() / across;
        vec![
            Metric::awaited("body_cone_rad_s", self.body.rate(), Expected::near(body, 0.005)),
            Metric::awaited("space_cone_rad_s", self.space.rate(), Expected::near(space, 0.005)),
        ]
    }
}

pub(in crate::scenes) const SPINNING_TOP: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "spinning_top",
    about: "a fast top on a pivot does not fall: it precesses slowly, at the rate that its weight's torque gives",
    steps: 420,
    settings: &[
        Setting::number("spin", 200.0, (60.0, 300.0), "angular velocity about its axis, rad/s"),
        Setting::number("lean", 30.0, (5.0, 90.0), "angle of its axis from the vertical, degrees"),
    ],
    build: spinning_top,
};

/// Distance from the pivot to the disc, metres.
const STEM: f32 = 0.1;

fn spinning_top(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let (spin, lean) = (setup.number("spin"), setup.number("lean"));
    let turn = tilt(-lean);
    let axis = turn * Vec3::Y;
    let rate = precession(spin, lean);
    let mut def = disc(axis * STEM, Vec3::NEG_Y * STEM);
    def.rotation = turn;
    // The component `spin` of the angular velocity is along the axis, for any rate of precession.
    def.angular_velocity = axis * spin + (Vec3::Y - axis * axis.y) * rate;
    def.linear_velocity = def.angular_velocity.cross(axis * STEM);
    let top = world.add_body(&def);
    let hook = world.add_body(&hook());
    let joint = join(&mut world, hook, top, Vec3::ZERO);
    let support = Support::new(&world);
    Instance::new(world, Top { top, joint, rate, lean, support, turn: Turn::default(), nods: 0.0, gap: 0.0 })
}

/// The slow root of `I₁ Ω² cos θ − I₃ ω₃ Ω + m g r = 0`, rad/s, where `I₁` is about the pivot.
fn precession(spin: f32, lean: f32) -> f32 {
    let torque = DISC_MASS * GRAVITY * STEM;
    let a = (0.5 * DISC_MOMENT + DISC_MASS * STEM * STEM) * trig::cos(lean.to_radians());
    let b = DISC_MOMENT * spin;
    // This form avoids the difference of two large numbers.
    2.0 * torque / (b + (b * b - 4.0 * a * torque).sqrt())
}

struct Top {
    top: BodyId,
    joint: JointId,
    /// Expected rate of precession, rad/s.
    rate: f32,
    /// Initial lean of the axis, degrees.
    lean: f32,
    support: Support,
    /// Turn of the axis about the vertical.
    turn: Turn,
    /// Largest deviation of the lean from the start, degrees.
    nods: f32,
    gap: f32,
}

impl Script for Top {
    fn after_step(&mut self, world: &mut World) {
        let axis = world.transform(self.top).rotation * Vec3::Y;
        self.turn.after_step(trig::atan2(-axis.z, axis.x), world.def().dt());
        self.nods = max(self.nods, (trig::acos(axis.y).to_degrees() - self.lean).abs());
        self.gap = max(self.gap, world.joint_gap(self.joint));
        self.support.after_step(world);
    }

    fn metrics(&self, _: &World) -> Vec<Metric> {
        vec![
            Metric::awaited("precession_rad_s", self.turn.rate(), Expected::near(self.rate, 0.03)),
            Metric::new("nods_deg", self.nods, Expected::AtMost(1.0)),
            Metric::new("joint_gap_max_m", self.gap, Expected::AtMost(1e-3)),
            self.support.metric(),
        ]
    }
}
