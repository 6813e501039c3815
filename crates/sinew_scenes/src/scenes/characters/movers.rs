//! Movers on a course: each has its own lane.

use crate::framework::camera_hint::{CameraHint, Trails};
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, cuboid, fixed, floor, ghost};
use sinew::math::{Rotation, Transform, Vec3, max};
use sinew::physics::boxes::Aabb;
use sinew::physics::{
    BodyDef, BodyId, BodyKind, MoverDef, MoverId, PenetrationOf, Probe, QueryFilter, Shape, World,
};

pub(in crate::scenes) const COURSE: Scene = Scene {
    chapter: Chapter::Characters,
    name: "mover_course",
    about: "movers climb stairs and a ramp, push a crate, ride a turntable and a belt, and jump",
    steps: 420,
    settings: &[
        Setting::number("speed", 2.0, (1.0, 4.0), "walking speed, m/s"),
        Setting::number("jump", 5.0, (2.0, 8.0), "initial speed of a jump, m/s"),
        Setting::number("rise", 0.2, (0.05, 0.34), "height of each step of the stairs, metres"),
    ],
    build: course,
};

/// Number of steps until all movers are at rest.
const SETTLING: u64 = 60;
/// Number of steps up, which equals the number of steps down, and the depth of each, metres.
const STEPS: u8 = 6;
const TREAD: f32 = 0.3;
/// Width of a lane, metres.
const LANE: f32 = 2.4;
/// Speed of the belt, m/s.
const BELT: f32 = 0.5;
/// Angular velocity of the turntable, rad/s.
const SPIN: f32 = 0.8;
/// Mass of the crate, kg, and its coefficient of friction.
const CRATE: f32 = 60.0;
const FRICTION: f32 = 0.6;

fn lane(number: u8) -> f32 {
    LANE * (f32::from(number) - 2.5)
}

fn course(setup: &Setup<'_>) -> Instance {
    let (speed, jump, rise) = (setup.number("speed"), setup.number("jump"), setup.number("rise"));
    let mut world = setup.world();
    world.add_body(&floor());
    stairs(&mut world, rise);
    ramp(&mut world);
    let crate_ = crate_of(&mut world);
    let table = turntable(&mut world);
    belt(&mut world);
    let starts = [-4.0, -4.0, -4.0, 0.9, -4.0, 0.0];
    let on = [0.0, 0.0, 0.0, 0.2, 0.2, 0.0];
    let mut place = |number: u8| {
        let at = Vec3::new(starts[usize::from(number)], on[usize::from(number)] + 0.01, lane(number));
        let mover = world.add_mover(&MoverDef::at(at));
        let def = world.mover(mover).def();
        let shape = Shape::Capsule { half_height: 0.5 * def.height - def.radius, radius: def.radius };
        let shown =
            BodyDef { kind: BodyKind::Kinematic, ..ghost(crate::parts::body(shape, at + Vec3::Y * 0.9)) };
        (mover, world.add_body(&shown))
    };
    let movers = [0, 1, 2, 3, 4, 5].map(&mut place);
    let watch = Watch { highest: [0.0; 6], deepest: 0.0, aloft: 0, drift: 0.0, on_table: None, gone: None };
    Instance::new(world, Course { movers, crate_, table, speed, jump, rise, watch })
}

fn stairs(world: &mut World, rise: f32) {
    for i in 0..2 * STEPS {
        let high = rise * f32::from(if i < STEPS { i + 1 } else { 2 * STEPS - i });
        let at = Vec3::new(-2.0 + TREAD * f32::from(i), 0.5 * high, lane(0));
        world.add_body(&fixed(cuboid(Vec3::new(0.5 * TREAD, 0.5 * high, 1.0), at)));
    }
}

fn ramp(world: &mut World) {
    let turn = Rotation::from_axis_angle(Vec3::Z, 30.0_f32.to_radians());
    let up = turn * Vec3::Y;
    let mut slab = fixed(cuboid(
        Vec3::new(4.0, 0.1, 1.0),
        Vec3::new(-2.0, 0.0, lane(1)) + turn * Vec3::X * 3.8 - up * 0.1,
    ));
    slab.rotation = turn;
    world.add_body(&slab);
}

fn crate_of(world: &mut World) -> BodyId {
    let half = 0.4;
    let mut def = cuboid(Vec3::splat(half), Vec3::new(-2.0, half, lane(2)));
    def.shapes[0].material.friction = FRICTION;
    def.shapes[0].density = CRATE / (8.0 * half * half * half);
    world.add_body(&def)
}

fn turntable(world: &mut World) -> BodyId {
    let shape = Shape::Cylinder { half_height: 0.1, radius: 1.15 };
    let mut def = crate::parts::body(shape, Vec3::new(0.0, 0.1, lane(3)));
    (def.kind, def.angular_velocity) = (BodyKind::Kinematic, Vec3::Y * SPIN);
    world.add_body(&def)
}

fn belt(world: &mut World) {
    let mut belt = fixed(cuboid(Vec3::new(12.0, 0.1, 1.0), Vec3::new(7.0, 0.1, lane(4))));
    belt.shapes[0].material.surface_velocity = Vec3::X * BELT;
    world.add_body(&belt);
}

struct Course {
    /// Movers with the bodies that show them, which collide with nothing.
    movers: [(MoverId, BodyId); 6],
    crate_: BodyId,
    table: BodyId,
    speed: f32,
    jump: f32,
    rise: f32,
    watch: Watch,
}

struct Watch {
    /// Greatest height of each mover's feet since all movers came to rest, metres.
    highest: [f32; 6],
    deepest: f32,
    /// Number of steps in which a mover on the stairs, the ramp or the table was off the ground.
    aloft: u32,
    /// Distance of the mover on the table from its first position on the table, metres.
    drift: f32,
    on_table: Option<Vec3>,
    /// Position along x at the start of the last second on the belt, and the displacement since then, metres.
    gone: Option<(f32, f32)>,
}

impl Course {
    fn feet(&self, world: &World, number: usize) -> Vec3 {
        world.mover(self.movers[number].0).position()
    }

    fn depth(world: &World, id: MoverId) -> f32 {
        let mover = world.mover(id);
        let shape = Shape::Capsule { half_height: mover.half_height(), radius: mover.def().radius };
        let probe = Probe::new(shape, Transform::from_translation(mover.center()));
        let deepest = world.query().filter(QueryFilter::default()).first(&PenetrationOf(probe));
        deepest.map_or(0.0, |deepest| deepest.depth)
    }
}

impl Script for Course {
    fn before_step(&mut self, world: &mut World) {
        if world.step_count() == SETTLING {
            for number in [0, 1, 2, 4] {
                world.set_mover_walk(self.movers[number].0, Vec3::X * self.speed);
            }
            world.mover_jump(self.movers[5].0, self.jump);
        }
    }

    fn after_step(&mut self, world: &mut World) {
        for &(mover, shown) in &self.movers {
            world.set_transform(shown, Transform::from_translation(world.mover(mover).center()));
        }
        if world.step_count() <= SETTLING {
            return;
        }
        let on_table = world.transform(self.table).inverse_point(self.feet(world, 3));
        let stood = *self.watch.on_table.get_or_insert(on_table);
        self.watch.drift = max(self.watch.drift, (on_table - stood).length());
        for number in 0..6 {
            let (feet, id) = (self.feet(world, number), self.movers[number].0);
            self.watch.highest[number] = max(self.watch.highest[number], feet.y);
            self.watch.deepest = max(self.watch.deepest, Self::depth(world, id));
            let off_ramp = number == 1 && feet.x > 4.0;
            self.watch.aloft += u32::from(number < 4 && !off_ramp && !world.mover(id).is_grounded());
        }
        let (begins, x) = (u64::from(COURSE.steps) - 60, self.feet(world, 4).x);
        if world.step_count() >= begins {
            let from = self.watch.gone.map_or(x, |(from, _)| from);
            self.watch.gone = Some((from, x - from));
        }
    }

    /// Work of the mover behind the crate, J: against friction, and for the crate's motion.
    fn work_in(&self, world: &World) -> f32 {
        let pushed = world.transform(self.crate_).translation.x + 2.0;
        let speed = world.velocity(self.crate_).linear.length();
        CRATE * (FRICTION * GRAVITY * pushed + 0.5 * speed * speed)
    }

    fn metrics(&self, world: &World) -> Vec<Metric> {
        let Watch { highest, deepest, aloft, drift, gone, .. } = self.watch;
        let top = Expected::Near { value: f64::from(self.rise * f32::from(STEPS)), tolerance: 0.01 };
        let second = 60.0 * world.def().dt();
        let pushed = world.transform(self.crate_).translation.x + 2.0;
        let ramp = 0.5 * 7.8 - 0.05;
        vec![
            Metric::new("stairs_m", highest[0], top),
            Metric::new("off_the_ground", aloft, Expected::AtMost(0.0)),
            Metric::new("short_of_ramp_m", ramp - highest[1], Expected::AtMost(0.0)),
            Metric::new("crate_short_m", 4.0 - pushed, Expected::AtMost(0.0)),
            Metric::new("table_drift_m", drift, Expected::AtMost(1e-3)),
            Metric::awaited(
                "belt_m",
                gone.map(|(_, way)| way),
                Expected::near((self.speed + BELT) * second, 0.002),
            ),
            Metric::new(
                "jump_m",
                highest[5] - 0.005,
                Expected::near(self.jump * self.jump / (2.0 * GRAVITY), 0.004),
            ),
            Metric::new("deepest_m", deepest, Expected::AtMost(1e-3)),
        ]
    }

    fn camera_hint(&self) -> CameraHint {
        let bounds =
            Aabb { min: Vec3::new(-5.0, 0.0, lane(0) - 1.0), max: Vec3::new(8.0, 4.0, lane(5) + 1.0) };
        CameraHint { direction: Vec3::new(-0.5, 0.9, 1.0), bounds: Some(bounds), trails: Trails::None }
    }
}
