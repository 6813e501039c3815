//! A street: characters with movers walk up and down among crates, some are hit, one rides a lift, one jumps.

use crate::framework::actors::Figure;
use crate::framework::camera_hint::{CameraHint, Trails};
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, cuboid, fixed, floor};
use sinew::anim::local_to_model;
use sinew::math::{Affine, Random, ReadError, Reader, Rotation, Transform, Vec3, Writer, max, min};
use sinew::physics::{BodyId, BodyKind, Mover, Velocity, World};
use sinew::ragdoll::{Character, CharacterDef, CharacterEvent, HitBodies, State};
use std::sync::Arc;

pub(in crate::scenes) const STREET: Scene = Scene {
    chapter: Chapter::Characters,
    name: "street",
    about: "mannequins with movers walk among crates, push them, flinch and fall when hit, ride a lift and jump",
    steps: 600,
    settings: &[
        Setting::whole("n", 24, (2, 1_000), "number of mannequins"),
        Setting::whole("crates", 12, (0, 1_000), "number of crates"),
        Setting::number(
            "hits",
            3.6,
            (0.0, 200.0),
            "number of hits per second, half of them strong enough for a fall",
        ),
        Setting::whole("bodies", 1, (0, 1), "1: with hit bodies, 0: without"),
    ],
    build: street,
};

/// Width of a lane, and half the length of the street, metres.
const LANE: f32 = 1.1;
const HALF_LENGTH: f32 = 9.0;
/// Range of walking speeds, m/s.
const SPEEDS: (f32, f32) = (0.8, 1.5);
/// Number of steps between reversals of the lift, and its speed, m/s.
const LIFT_TURNS: u64 = 150;
const LIFT: f32 = 0.8;
/// Index of the character that a user may control. The space around it is free.
const LED: usize = 1;
/// Step at which the last character jumps.
const JUMPS: u64 = 90;

fn street(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let (count, crates) = (setup.whole("n"), setup.whole("crates"));
    let lanes = (count - 2).div_ceil(4) + 1;
    let half_width = 0.5 * LANE * lanes as f32 + 1.0;
    walls(&mut world, half_width);
    let mut random = Random::new(22);
    for _ in 0..crates {
        let half = random.range(0.15, 0.35);
        let across = random.range(-half_width + 1.5, half_width - 1.5);
        let at = Vec3::new(random.range(-HALF_LENGTH + 1.0, HALF_LENGTH - 1.0), half, across);
        let mut def = cuboid(Vec3::splat(half), at);
        def.shapes[0].density = 300.0;
        world.add_body(&def);
    }
    let mut platform = cuboid(Vec3::new(1.0, 0.1, 1.0), Vec3::new(HALF_LENGTH + 3.0, 0.1, 0.0));
    platform.kind = BodyKind::Kinematic;
    let lift = world.add_body(&platform);
    let mut def = sinew::mannequin::character();
    if setup.whole("bodies") == 0 {
        def.in_world.hit_bodies = HitBodies::Absent;
    }
    let def = Arc::new(def);
    let walker = |index: usize| {
        let place = match index {
            0 => Vec3::new(HALF_LENGTH + 3.0, 0.2, 0.0),
            1 => Vec3::new(HALF_LENGTH + 3.0, 0.0, 4.0),
            _ => {
                let (row, lane) = ((index - 2) % 4, (index - 2) / 4);
                let z = LANE * (lane as f32 + 0.5) - half_width + 1.0;
                Vec3::new(-6.0 + 4.0 * row as f32 + random.range(-0.5, 0.5), 0.0, z)
            }
        };
        let ahead = if random.unit() < 0.5 { 1.0 } else { -1.0 };
        let speed = if index < 2 { 0.0 } else { ahead * random.range(SPEEDS.0, SPEEDS.1) };
        let turn = Rotation::from_axis_angle(Vec3::Y, ahead * core::f32::consts::FRAC_PI_2);
        let mut character = Character::spawn(&mut world, &def, Transform::new(place, turn));
        character.set_move(Vec3::X * speed);
        Walker { character, speed, model: Vec::new() }
    };
    let walkers: Vec<Walker> = (0..count).map(walker).collect();
    let watch = Watch { nearest: f32::INFINITY, drift: 0.0, ..Watch::default() };
    let hits = setup.number("hits");
    let mut script = Street { def, walkers, lift, half_width, hits, due: 0.0, seed: 7, watch, led: None };
    script.walkers.iter_mut().for_each(Walker::show);
    Instance::new(world, script)
}

fn walls(world: &mut World, half_width: f32) {
    for side in [-1.0, 1.0] {
        let (thick, high) = (0.2, 1.5);
        let along = Vec3::new(HALF_LENGTH + 1.2, high, thick);
        world.add_body(&fixed(cuboid(along, Vec3::new(0.0, high, side * half_width))));
        let across = Vec3::new(thick, high, half_width);
        world.add_body(&fixed(cuboid(across, Vec3::new(side * (HALF_LENGTH + 1.0), high, 0.0))));
    }
}

struct Walker {
    character: Character,
    /// Velocity along x, m/s.
    speed: f32,
    /// World from joint.
    model: Vec<Affine>,
}

impl Walker {
    fn show(&mut self) {
        let character = &self.character;
        local_to_model(
            &character.def().rig,
            character.pose(),
            &character.world_from_model(),
            &mut self.model,
        );
    }

    fn place(&self) -> Vec3 {
        self.character.world_from_character().translation
    }
}

#[derive(Default)]
struct Watch {
    /// Least distance of two movers' surfaces, metres.
    nearest: f32,
    /// Largest drift of the character on the lift, metres.
    drift: f32,
    highest: f32,
    /// Number of steps in which a standing character was outside the walls.
    outside: u32,
    flinches: u32,
    falls: u32,
    ups: u32,
    work_in: f32,
}

struct Street {
    def: Arc<CharacterDef>,
    walkers: Vec<Walker>,
    lift: BodyId,
    half_width: f32,
    /// Number of hits per second.
    hits: f32,
    /// Number of hits that are due.
    due: f32,
    seed: u64,
    watch: Watch,
    /// Velocity of the character controlled by a user, m/s.
    led: Option<Vec3>,
}

impl Street {
    /// Hits the next character, lightly or hard.
    fn hit(&mut self, world: &mut World) {
        self.due += self.hits * world.def().dt();
        while self.due >= 1.0 {
            self.due -= 1.0;
            let mut random = Random::new(self.seed);
            self.seed = random.bits();
            let (index, body) =
                (random.index(self.walkers.len()), random.index(self.def.ragdoll.bodies.len()));
            let size = if random.unit() < 0.5 { 8.0 } else { 70.0 };
            let way = Rotation::from_axis_angle(Vec3::Y, random.range(-3.0, 3.0)) * Vec3::Z;
            if index > 1 {
                let body = if size > 50.0 { 0 } else { body };
                self.walkers[index].character.hit(world, body, way * size);
            }
        }
    }

    fn look(&mut self, world: &World) {
        let watch = &mut self.watch;
        for walker in &self.walkers {
            for event in walker.character.events() {
                watch.flinches += u32::from(matches!(event, CharacterEvent::Flinched { .. }));
                watch.falls += u32::from(matches!(event, CharacterEvent::WentLimp));
                watch.ups += u32::from(matches!(event, CharacterEvent::Up));
            }
        }
        let standing: Vec<&Mover> =
            self.walkers.iter().filter_map(|walker| Some(world.mover(walker.character.mover()?))).collect();
        for (i, mover) in standing.iter().enumerate() {
            watch.nearest = standing[..i].iter().map(|other| apart(mover, other)).fold(watch.nearest, min);
            let a = mover.position();
            let in_street = a.x < HALF_LENGTH + 1.0;
            watch.outside +=
                u32::from(in_street && (a.z.abs() > self.half_width || a.x < -HALF_LENGTH - 1.0));
        }
        let rider = self.walkers[0].place() - world.transform(self.lift).translation;
        watch.drift = max(watch.drift, (rider - Vec3::Y * 0.1).length());
        watch.highest = max(watch.highest, self.walkers[1].place().y);
    }
}

/// Distance of two upright movers' surfaces, metres; negative where they overlap.
pub(super) fn apart(a: &Mover, b: &Mover) -> f32 {
    let way = b.center() - a.center();
    let over = max(way.y.abs() - a.half_height() - b.half_height(), 0.0);
    Vec3::new(way.x, over, way.z).length() - a.def().radius - b.def().radius
}

impl Script for Street {
    fn before_step(&mut self, world: &mut World) {
        let step = world.step_count();
        if step.is_multiple_of(LIFT_TURNS) {
            let up = if (step / LIFT_TURNS).is_multiple_of(2) { LIFT } else { -LIFT };
            world.set_velocity(self.lift, Velocity { linear: Vec3::Y * up, ..Velocity::default() });
        }
        // A controlled character jumps only on command.
        if step == JUMPS && self.led.is_none() {
            self.walkers[1].character.jump(world);
        }
    }

    fn after_step(&mut self, world: &mut World) {
        self.watch.work_in += world.work().total();
        for (index, walker) in self.walkers.iter_mut().enumerate() {
            walker.character.update(world);
            if let Some(way) = self.led.filter(|_| index == LED) {
                walker.character.set_move(way);
                if way != Vec3::ZERO {
                    walker.character.face(way);
                }
                continue;
            }
            let x = walker.place().x;
            if walker.speed != 0.0 && x * walker.speed > 0.0 && x.abs() > HALF_LENGTH - 1.0 {
                walker.speed = -walker.speed;
            }
            walker.character.set_move(Vec3::X * walker.speed);
            walker.character.face(Vec3::X * walker.speed);
        }
        self.look(world);
        self.hit(world);
        self.walkers.iter_mut().for_each(Walker::show);
    }

    fn save(&self, out: &mut Writer) {
        for walker in &self.walkers {
            walker.character.save(out);
            out.f32(walker.speed);
        }
        out.f32(self.due);
        out.u64(self.seed);
        out.u8(u8::from(self.led.is_some()));
        out.vec3(self.led.unwrap_or(Vec3::ZERO));
        let Watch { nearest, drift, highest, outside, flinches, falls, ups, work_in } = self.watch;
        [nearest, drift, highest, work_in].into_iter().for_each(|x| out.f32(x));
        [outside, flinches, falls, ups].into_iter().for_each(|x| out.u32(x));
    }

    fn load(&mut self, bytes: &mut Reader<'_>) -> Result<(), ReadError> {
        for walker in &mut self.walkers {
            walker.character.load(bytes)?;
            walker.speed = bytes.f32()?;
            walker.show();
        }
        (self.due, self.seed) = (bytes.f32()?, bytes.u64()?);
        let (is_led, way) = (bytes.u8()? != 0, bytes.vec3()?);
        self.led = is_led.then_some(way);
        let (nearest, drift) = (bytes.f32()?, bytes.f32()?);
        let (highest, work_in) = (bytes.f32()?, bytes.f32()?);
        let (outside, flinches) = (bytes.u32()?, bytes.u32()?);
        let (falls, ups) = (bytes.u32()?, bytes.u32()?);
        self.watch = Watch { nearest, drift, highest, outside, flinches, falls, ups, work_in };
        Ok(())
    }

    fn work_in(&self, _: &World) -> f32 {
        self.watch.work_in
    }

    fn metrics(&self, _: &World) -> Vec<Metric> {
        let Watch { nearest, drift, highest, outside, flinches, falls, ups, .. } = self.watch;
        let speed = self.def.in_world.jump_speed;
        let down = |walker: &&Walker| walker.character.state() == State::Limp;
        vec![
            Metric::new("jump_m", highest, Expected::near(speed * speed / (2.0 * GRAVITY), 0.006)),
            Metric::new("overlap_m", max(-nearest, 0.0), Expected::AtMost(0.01)),
            Metric::new("outside", outside, Expected::AtMost(0.0)),
            Metric::new("lift_drift_m", drift, Expected::AtMost(0.02)),
            Metric::new("flinches", flinches, Expected::Anything),
            Metric::new("falls", falls, Expected::Anything),
            Metric::new("got_up", ups, Expected::Anything),
            Metric::new("limp", self.walkers.iter().filter(down).count() as u32, Expected::Anything),
        ]
    }

    fn camera_hint(&self) -> CameraHint {
        CameraHint { direction: Vec3::new(0.5, 0.7, 1.0), bounds: None, trails: Trails::None }
    }

    fn steer(&mut self, way: Vec3) {
        self.led = Some(way);
    }

    fn steered(&self) -> Option<Vec3> {
        Some(self.walkers[LED].place())
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        self.walkers
            .iter()
            .map(|walker| Figure { rig: &self.def.rig, world_from_joint: &walker.model })
            .collect()
    }

    fn bodies_of_figures(&self) -> Vec<BodyId> {
        self.walkers.iter().flat_map(|walker| walker.character.bodies().iter().copied()).collect()
    }
}
