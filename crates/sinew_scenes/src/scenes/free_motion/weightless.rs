//! Bodies in free space.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::ragdolls::ragdoll_of_mannequin;
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::weightless_world;
use crate::framework::setting::{Setting, Setup};
use crate::parts::{ball, cuboid, join, thin_rod, tilt};
use sinew::math::{Random, Rotation, Transform, Vec3, max};
use sinew::physics::{BodyId, JointId, Momentum, Velocity, World};
use sinew::ragdoll::{BodySettings, BodyState, Ragdoll};

pub(in crate::scenes) const ZERO_GRAVITY_PILE: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "zero_gravity_pile",
    about: "balls and boxes collide in free space, and the sum of their momenta stays",
    steps: 1000,
    settings: &[Setting::whole("bodies", 60, (2, 2000), "number of bodies")],
    build: zero_gravity_pile,
};

fn zero_gravity_pile(setup: &Setup<'_>) -> Instance {
    let mut world = weightless_world();
    let bodies = setup.whole("bodies");
    let mut random = Random::new(11);
    // Choose the spread so that the density is the same for any number of bodies.
    let spread = 0.8 * sinew::math::trig::cbrt(bodies as f32 / 60.0);
    let mut scale = 0.0;
    for i in 0..bodies {
        let place = random.in_cube() * spread;
        let mut def = if i % 2 == 0 { ball(0.12, place) } else { cuboid(Vec3::splat(0.1), place) };
        def.linear_velocity = -place * 2.0;
        def.angular_velocity = random.in_cube() * 3.0;
        let id = world.add_body(&def);
        scale += world.mass(id).mass * def.linear_velocity.length();
    }
    let start = world.momentum();
    Instance::new(world, Pile { start, scale })
}

struct Pile {
    start: Momentum,
    /// Sum of the bodies' momenta, Σ|mv|, at the start, N·s.
    scale: f32,
}

impl Script for Pile {
    fn metrics(&self, world: &World) -> Vec<Metric> {
        let now = world.momentum();
        let drift = (now.linear - self.start.linear).length() / self.scale;
        let thousands = world.step_count() as f64 / 1000.0;
        let turned = (now.angular - self.start.angular).length();
        vec![
            Metric::new("momentum_drift", drift, Expected::AtMost(1e-5 * thousands)),
            Metric::new("angular_momentum_drift_n_m_s", turned, Expected::Anything),
        ]
    }
}

pub(in crate::scenes) const SPIN_DOUBLE: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "spin_double",
    about: "two joined rods spin in free space, and their angular momentum stays",
    steps: 600,
    settings: &[SPIN],
    build: |setup| spinning_rods(setup, 2),
};

pub(in crate::scenes) const SPIN_TRIPLE: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "spin_triple",
    about: "three joined rods spin in free space, and their angular momentum stays",
    steps: 600,
    settings: &[SPIN],
    build: |setup| spinning_rods(setup, 3),
};

pub(in crate::scenes) const SPIN_RAGDOLL: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "spin_ragdoll",
    about: "the mannequin, limp, spins in free space, and its angular momentum stays",
    steps: 600,
    settings: &[SPIN],
    build: spinning_ragdoll,
};

const SPIN: Setting = Setting::number("spin", 9.0, (0.1, 30.0), "angular velocity at the start, rad/s");

/// Rods of 1 m and 1 kg, each at an angle to the previous rod and out of its plane, that start to spin as one rigid
/// body.
fn spinning_rods(setup: &Setup<'_>, count: usize) -> Instance {
    let mut world = weightless_world();
    let bend = tilt(50.0) * Rotation::from_axis_angle(Vec3::Y, 0.4);
    let (mut turn, mut end) = (Rotation::IDENTITY, Vec3::ZERO);
    let (mut bodies, mut joints) = (Vec::<BodyId>::new(), Vec::new());
    for _ in 0..count {
        let mut def = thin_rod(0.0, 1.0, 1.0);
        def.position = end + turn * def.position;
        def.rotation = turn * def.rotation;
        let rod = world.add_body(&def);
        joints.extend(bodies.last().map(|&last| join(&mut world, last, rod, end)));
        bodies.push(rod);
        end += turn * Vec3::X;
        turn = turn * bend;
    }
    let spin = Spin::start(&mut world, &bodies, joints, Vec3::Z * setup.number("spin"));
    Instance::new(world, spin)
}

fn spinning_ragdoll(setup: &Setup<'_>) -> Instance {
    let mut world = weightless_world();
    let def = ragdoll_of_mannequin();
    let state = |pose: Transform| BodyState { world_from_body: pose, velocity: Velocity::default() };
    let states: Vec<_> = def.bodies.iter().map(|body| state(body.character_from_body)).collect();
    // Damping of tissue would reduce the angular momentum.
    let body_settings = BodySettings { angular_damping: 0.0, ..BodySettings::default() };
    let Ragdoll { bodies, joints, .. } = Ragdoll::spawn(&mut world, &def, &states, &body_settings);
    let axis = Vec3::new(3.0, 8.0, 2.0).normalize();
    let spin = Spin::start(&mut world, &bodies, joints, axis * setup.number("spin"));
    Instance::new(world, spin)
}

/// Connected bodies in free space.
struct Spin {
    joints: Vec<JointId>,
    start: Momentum,
    /// Kinetic energy at the start, J.
    energy: f32,
    /// Largest relative deviation of the angular momentum from the start.
    turned: f32,
    gap: f32,
    overshoot: f32,
}

impl Spin {
    /// Starts resting bodies as one rigid body that rotates about its centre of mass.
    fn start(world: &mut World, bodies: &[BodyId], joints: Vec<JointId>, spin: Vec3) -> Self {
        let masses = || bodies.iter().map(|&id| world.mass(id).mass);
        let moments = bodies.iter().zip(masses()).map(|(&id, mass)| world.center_of_mass(id) * mass);
        let center = moments.sum::<Vec3>() / masses().sum::<f32>();
        for &id in bodies {
            // Move the centre of mass to the origin, about which the world measures angular momentum.
            let Transform { translation, rotation } = world.transform(id);
            world.set_transform(id, Transform::new(translation - center, rotation));
            let linear = spin.cross(world.center_of_mass(id));
            world.set_velocity(id, Velocity { linear, angular: spin });
        }
        let (start, energy) = (world.momentum(), world.energy().kinetic);
        Self { joints, start, energy, turned: 0.0, gap: 0.0, overshoot: 0.0 }
    }
}

impl Script for Spin {
    fn after_step(&mut self, world: &mut World) {
        let off = (world.momentum().angular - self.start.angular).length();
        self.turned = max(self.turned, off / self.start.angular.length());
        for &joint in &self.joints {
            self.gap = max(self.gap, world.joint_gap(joint));
            self.overshoot = max(self.overshoot, world.joint_overshoot(joint));
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let drift = (world.momentum().linear - self.start.linear).length();
        let change = world.energy().kinetic / self.energy - 1.0;
        vec![
            Metric::new("angular_momentum_error", self.turned, Expected::AtMost(0.005)),
            Metric::new("momentum_n_s", drift, Expected::Anything),
            Metric::new("energy_change", change, Expected::Anything),
            Metric::new("joint_gap_max_m", self.gap, Expected::AtMost(1e-3)),
            Metric::new("limit_overshoot_max_deg", self.overshoot.to_degrees(), Expected::Anything),
        ]
    }
}
