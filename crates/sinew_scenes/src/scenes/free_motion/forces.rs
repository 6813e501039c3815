//! Forces: opposed and added, through the centre and off-centre, and of a bullet.

use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::weightless_world;
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, ball, cuboid, floor, ghost, hook, join, made_of};
use sinew::math::{Transform, Vec3, max};
use sinew::physics::{BodyDef, BodyId, ForceDef, Material, World};

pub(in crate::scenes) const TWO_MEN: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "two_men",
    about: "two men push a cart together and against each other: forces add up as vectors",
    steps: 120,
    settings: &[
        Setting::number("first", 300.0, (0.0, 2000.0), "force of the first man, N"),
        Setting::number("second", 250.0, (0.0, 2000.0), "force of the second man, N"),
    ],
    build: two_men,
};

const CART_MASS: f32 = 96.0;
const CART_FRICTION: f32 = 0.2;

fn two_men(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let iron = Material { friction: CART_FRICTION, ..Material::default() };
    world.add_body(&made_of(floor(), iron));
    let (first, second) = (setup.number("first"), setup.number("second"));
    let mut cart = |place: f32, forces: [f32; 2]| {
        // The cart is low and long, so that friction does not tip it when a force acts at its centre.
        let half = Vec3::new(0.8, 0.1, 0.3);
        let mut def = made_of(cuboid(half, Vec3::new(0.0, half.y, place)), iron);
        def.shapes[0].density = CART_MASS / def.shapes[0].shape.volume();
        let body = world.add_body(&def);
        for force in forces {
            world.add_force(body, &ForceDef { force: Vec3::X * force, ..ForceDef::default() });
        }
        Cart { body, sum: forces.iter().sum() }
    };
    let carts = [cart(-2.0, [first, second]), cart(0.0, [first, -second]), cart(2.0, [first, -first])];
    Instance::new(world, TwoMen { carts })
}

struct Cart {
    body: BodyId,
    /// Sum of the forces on the cart, N along x.
    sum: f32,
}

impl Cart {
    fn way(&self, world: &World) -> f32 {
        world.transform(self.body).translation.x
    }

    /// By Coulomb friction the cart rests while the push is at most `μ m g`; else `a = (F − μ m g)/m`.
    fn metric(&self, world: &World, name: &'static str) -> Metric {
        let free = self.sum / CART_MASS - CART_FRICTION * GRAVITY;
        if free <= 0.0 {
            return Metric::new(name, self.way(world).abs(), Expected::AtMost(1e-3));
        }
        let time = world.time() as f32;
        let expected = 0.5 * free * time * (time + world.def().dt() / world.def().substeps as f32);
        Metric::new(name, self.way(world), Expected::near(expected, 2e-3))
    }
}

struct TwoMen {
    /// Carts with two forces forward, with two opposed forces, and with an internal force.
    carts: [Cart; 3],
}

impl Script for TwoMen {
    fn work_in(&self, world: &World) -> f32 {
        self.carts.iter().map(|cart| cart.sum * cart.way(world)).sum()
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let [joined, opposed, even] = &self.carts;
        vec![
            joined.metric(world, "joined_m"),
            opposed.metric(world, "opposed_m"),
            even.metric(world, "even_m"),
        ]
    }
}

pub(in crate::scenes) const PUSH: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "push_centre_off_centre",
    about: "a push beside the centre moves a ball like a push through the centre, and also rotates it",
    steps: 60,
    settings: &[Setting::number("force", 100.0, (0.0, 1000.0), "force of each push, N")],
    build: push,
};

/// Radius of the wheels, metres.
const RADIUS: f32 = 0.2;

fn push(setup: &Setup<'_>) -> Instance {
    let mut world = weightless_world();
    let mut wheel = |z: f32| world.add_body(&ball(RADIUS, Vec3::Z * z));
    let bodies = [wheel(-1.0), wheel(0.0), wheel(1.0)];
    let pushed = Pushed { bodies, force: Vec3::X * setup.number("force"), work: 0.0 };
    pushed.push(&mut world);
    Instance::new(world, pushed)
}

/// Three balls: one is pushed through the centre, one at its top as by an unwinding string, and one at top and bottom
/// in opposite directions.
struct Pushed {
    bodies: [BodyId; 3],
    force: Vec3,
    work: f32,
}

impl Pushed {
    /// Force and point of application of each push.
    fn pushes(&self) -> [(BodyId, Vec3, Vec3); 4] {
        let [through, beside, couple] = self.bodies;
        let top = Vec3::Y * RADIUS;
        [
            (through, self.force, Vec3::ZERO),
            (beside, self.force, top),
            (couple, self.force, top),
            (couple, -self.force, -top),
        ]
    }

    fn push(&self, world: &mut World) {
        for (body, force, arm) in self.pushes() {
            world.apply_force(body, force, world.center_of_mass(body) + arm);
        }
    }
}

impl Script for Pushed {
    fn after_step(&mut self, world: &mut World) {
        let power = |(body, force, arm): (BodyId, Vec3, Vec3)| force.dot(world.velocity(body).at(arm));
        self.work += self.pushes().map(power).iter().sum::<f32>() * world.def().dt();
        self.push(world);
    }

    fn work_in(&self, _: &World) -> f32 {
        self.work
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let time = world.time() as f32;
        let properties = world.mass(self.bodies[0]);
        let [through, beside, couple] = self.bodies.map(|body| world.velocity(body));
        let a = self.force.x / properties.mass;
        let alpha = RADIUS * self.force.x / properties.inertia.diagonal.z;
        let near = |value: f32| Expected::near(value, 1e-5);
        let none = Expected::AtMost(1e-6);
        vec![
            Metric::new("through_m_s2", through.linear.x / time, near(a)),
            Metric::new("through_rad_s2", through.angular.length() / time, none),
            Metric::new("beside_m_s2", beside.linear.x / time, near(a)),
            Metric::new("beside_rad_s2", -beside.angular.z / time, near(alpha)),
            Metric::new("couple_m_s2", couple.linear.length() / time, none),
            Metric::new("couple_rad_s2", -couple.angular.z / time, near(2.0 * alpha)),
        ]
    }
}

pub(in crate::scenes) const BULLET: Scene = Scene {
    chapter: Chapter::FreeMotion,
    name: "bullet",
    about: "a bullet stops in three blocks: a free one, one hit beside the centre, and a ballistic pendulum",
    steps: 90,
    settings: &[
        Setting::number("mass", 0.01, (0.001, 0.1), "mass of the bullet, kg"),
        Setting::number("speed", 400.0, (10.0, 1000.0), "speed of the bullet, m/s"),
    ],
    build: bullet,
};

/// Distance from the hook to the centre of the block, metres.
const ROPE: f32 = 1.5;
/// Number of steps before the shot.
const WAIT: u64 = 10;
/// Distance of the off-centre shot from the centre, metres.
const ASIDE: f32 = 0.06;

fn bullet(setup: &Setup<'_>) -> Instance {
    let mut world = setup.sleepless_world();
    let mut block = |z: f32, gravity_scale: f32| {
        let mut def = cuboid(Vec3::splat(0.1), Vec3::Z * z);
        def.shapes[0].density = 600.0;
        world.add_body(&BodyDef { gravity_scale, ..ghost(def) })
    };
    let blocks = [block(-1.0, 0.0), block(0.0, 0.0), block(1.0, 1.0)];
    let at = Vec3::new(0.0, ROPE, 1.0);
    let hook = world.add_body(&BodyDef { position: at, ..hook() });
    join(&mut world, hook, blocks[2], at);
    let (mass, speed) = (setup.number("mass"), setup.number("speed"));
    Instance::new(world, Shot { blocks, mass, speed, highest: 0.0 })
}

struct Shot {
    /// The blocks: hit at the centre, hit off-centre, and hanging.
    blocks: [BodyId; 3],
    mass: f32,
    speed: f32,
    /// Greatest height of the hanging block above its rest height, metres.
    highest: f32,
}

impl Script for Shot {
    fn after_step(&mut self, world: &mut World) {
        let [middle, beside, hung] = self.blocks;
        self.highest = max(self.highest, world.transform(hung).translation.y);
        if world.step_count() == WAIT {
            let velocity = Vec3::X * self.speed;
            for (block, aside) in [(middle, 0.0), (beside, ASIDE), (hung, 0.0)] {
                let Transform { translation, .. } = world.transform(block);
                // The bullet stops at the centre of the block.
                let point = translation + Vec3::Y * aside;
                world.apply_bullet_impact(block, self.mass, velocity, point);
            }
        }
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let [middle, beside, _] = self.blocks.map(|block| world.velocity(block));
        let block = world.mass(self.blocks[0]);
        let (m, inertia) = (block.mass, block.inertia.diagonal.z);
        let momentum = self.mass * self.speed;
        // The bullet of the off-centre hit moves on with the point that it hit.
        let spin = -beside.angular.z;
        let struck = beside.linear.x + spin * ASIDE;
        let reduced = 1.0 / (1.0 / self.mass + 1.0 / m);
        let yields = 1.0 + reduced * ASIDE * ASIDE / inertia;
        let speed = reduced * self.speed / m;
        // The rope transmits no angular momentum about the hook.
        let about_hook = m * ROPE * ROPE + inertia;
        let swing = m * speed * ROPE / about_hook;
        let rise = about_hook * swing * swing / (2.0 * m * GRAVITY);
        let near = |value: f32, share: f64| Expected::near(value, share);
        vec![
            Metric::new("momentum_n_s", middle.linear.x * (m + self.mass), near(momentum, 1e-5)),
            Metric::new(
                "beside_momentum_n_s",
                beside.linear.x * m + struck * self.mass,
                near(momentum, 1e-5),
            ),
            Metric::new("speed_m_s", middle.linear.x, near(momentum / (m + self.mass), 1e-5)),
            Metric::new("beside_speed_m_s", beside.linear.x, near(speed / yields, 1e-5)),
            Metric::new("beside_spin_rad_s", spin, near(m * speed / yields * ASIDE / inertia, 1e-4)),
            Metric::new("rise_m", self.highest, near(rise, 5e-3)),
        ]
    }
}
