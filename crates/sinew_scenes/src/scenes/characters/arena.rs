//! An arena: powered characters walk up to each other and push; fallen ones get up and continue.

use super::street::apart;
use crate::framework::actors::Figure;
use crate::framework::camera_hint::{CameraHint, Trails};
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::{Expected, Metric};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{GRAVITY, cuboid, fixed, floor};
use sinew::anim::local_to_model;
use sinew::math::{Affine, Random, ReadError, Reader, Rotation, Transform, Vec3, Writer, max, min};
use sinew::physics::{BodyId, Mover, World};
use sinew::ragdoll::{Character, CharacterDef, CharacterEvent, Preset, State};
use std::sync::Arc;

pub(in crate::scenes) const ARENA: Scene = Scene {
    chapter: Chapter::Characters,
    name: "arena",
    about: "powered mannequins push each other: each stands, takes a step for balance, or falls and gets up",
    steps: 600,
    settings: &[
        Setting::whole("n", 8, (2, 200), "number of mannequins"),
        Setting::number("push", 60.0, (0.0, 500.0), "mean impulse of a push, N·s"),
    ],
    build: arena,
};

/// Radius of the ring divided by the square root of the number of mannequins, and smallest radius of the ring, metres.
const ROOM: f32 = 1.1;
const LEAST: f32 = 3.0;
/// Walking speed, m/s, and distance at which a mannequin pushes, metres.
const SPEED: f32 = 0.9;
const ARM: f32 = 0.85;
/// Number of steps between two pushes of one mannequin.
const RESTS: u32 = 75;
/// Step at which the referee, beside the ring, jumps.
const JUMPS: u64 = 60;
/// Sides of the ring.
const SIDES: usize = 12;

fn arena(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    world.add_body(&floor());
    let count = setup.whole("n");
    let radius = max(LEAST, ROOM * (count as f32).sqrt());
    for side in 0..SIDES {
        let turn = Rotation::from_axis_angle(Vec3::Y, core::f32::consts::TAU * side as f32 / SIDES as f32);
        let half = Vec3::new((radius + 0.3) * 0.28, 0.5, 0.1);
        let mut wall = fixed(cuboid(half, turn * Vec3::new(0.0, 0.5, radius + 0.3)));
        wall.rotation = turn;
        world.add_body(&wall);
    }
    let def = Arc::new(sinew::mannequin::character());
    let mut random = Random::new(20);
    let mut fighters = Vec::new();
    for index in 0..count {
        let turn = Rotation::from_axis_angle(Vec3::Y, core::f32::consts::TAU * index as f32 / count as f32);
        let place = turn * Vec3::Z * (radius - 0.8 - 0.5 * (index % 2) as f32);
        let place = Transform::new(place, turn * Rotation::from_axis_angle(Vec3::Y, core::f32::consts::PI));
        let mut character = Character::spawn(&mut world, &def, place);
        character.set_move(Vec3::ZERO);
        character.set_preset(&mut world, Preset::Powered);
        fighters.push(Fighter { character, rests: random.index(RESTS as usize) as u32, model: Vec::new() });
    }
    let aside = Transform::from_translation(Vec3::X * (radius + 2.0));
    let mut character = Character::spawn(&mut world, &def, aside);
    character.set_move(Vec3::ZERO);
    fighters.push(Fighter { character, rests: 0, model: Vec::new() });
    let watch = Watch { nearest: f32::INFINITY, ..Watch::default() };
    let mut script = Arena { def, fighters, radius, push: setup.number("push"), seed: 11, watch };
    script.fighters.iter_mut().for_each(Fighter::show);
    Instance::new(world, script)
}

struct Fighter {
    character: Character,
    /// Number of steps until the character's next push.
    rests: u32,
    /// World from joint.
    model: Vec<Affine>,
}

impl Fighter {
    fn show(&mut self) {
        let character = &self.character;
        let root = character.world_from_model();
        local_to_model(&character.def().rig, character.pose(), &root, &mut self.model);
    }

    fn place(&self) -> Vec3 {
        self.character.world_from_character().translation
    }

    fn stands(&self) -> bool {
        self.character.mover().is_some() && self.character.state() != State::GettingUp
    }
}

#[derive(Default)]
struct Watch {
    /// Least distance of two movers' surfaces, metres.
    nearest: f32,
    /// Greatest height of the referee's soles, metres.
    highest: f32,
    /// Number of steps in which a standing character was outside the ring.
    outside: u32,
    /// Number of quarantined bodies.
    lost: u32,
    pushes: u32,
    stumbles: u32,
    caught: u32,
    falls: u32,
    ups: u32,
    work_in: f32,
}

struct Arena {
    def: Arc<CharacterDef>,
    /// All characters; the last is the referee.
    fighters: Vec<Fighter>,
    radius: f32,
    /// Mean impulse of a push, N·s.
    push: f32,
    seed: u64,
    watch: Watch,
}

impl Arena {
    /// Returns the index of the nearest other character that stands, and the horizontal vector to that
    /// character, metres.
    fn nearest(&self, of: usize) -> Option<(usize, Vec3)> {
        let from = self.fighters[of].place();
        let others = self.fighters[..self.fighters.len() - 1].iter().enumerate();
        others
            .filter(|&(other, fighter)| other != of && fighter.stands())
            .map(|(other, fighter)| (other, (fighter.place() - from) * Vec3::new(1.0, 0.0, 1.0)))
            .reduce(|a, b| if b.1.length() < a.1.length() { b } else { a })
    }

    /// Lets each character walk to the nearest one and push those in reach.
    fn fight(&mut self, world: &mut World) {
        let chest = self.def.body_named("chest").expect("a mannequin has a chest");
        for index in 0..self.fighters.len() - 1 {
            let fighter = &mut self.fighters[index];
            fighter.rests = fighter.rests.saturating_sub(1);
            if fighter.character.state() == State::Animated {
                fighter.character.set_preset(world, Preset::Powered);
            }
            if !fighter.stands() {
                continue;
            }
            let Some((other, way)) = self.nearest(index) else {
                self.fighters[index].character.set_move(Vec3::ZERO);
                continue;
            };
            let (far, fighter) = (way.length(), &mut self.fighters[index]);
            fighter.character.face(way);
            let near = far < ARM || fighter.character.stumbles();
            fighter.character.set_move(if near { Vec3::ZERO } else { way * (SPEED / far) });
            if far < ARM && fighter.rests == 0 {
                fighter.rests = RESTS;
                let mut random = Random::new(self.seed);
                self.seed = random.bits();
                let size = self.push * random.range(0.4, 1.6);
                let turn = Rotation::from_axis_angle(Vec3::Y, random.range(-0.4, 0.4));
                self.fighters[other].character.hit(world, chest, turn * way * (size / max(far, 0.1)));
                self.watch.pushes += 1;
            }
        }
    }

    fn look(&mut self, world: &World) {
        let watch = &mut self.watch;
        watch.lost += world.events().quarantined.len() as u32;
        for event in self.fighters.iter().flat_map(|fighter| fighter.character.events()) {
            watch.stumbles += u32::from(*event == CharacterEvent::Stumbled);
            watch.caught += u32::from(matches!(event, CharacterEvent::Caught { .. }));
            watch.falls += u32::from(*event == CharacterEvent::WentLimp);
            watch.ups += u32::from(*event == CharacterEvent::Up);
        }
        let (referee, fighters) = self.fighters.split_last().expect("the arena has a referee");
        let standing: Vec<&Mover> =
            fighters.iter().filter_map(|fighter| Some(world.mover(fighter.character.mover()?))).collect();
        for (i, mover) in standing.iter().enumerate() {
            watch.nearest = standing[..i].iter().map(|other| apart(mover, other)).fold(watch.nearest, min);
            let a = mover.position();
            watch.outside += u32::from(Vec3::new(a.x, 0.0, a.z).length() > self.radius + 0.3);
        }
        watch.highest = max(watch.highest, referee.place().y);
    }
}

impl Script for Arena {
    fn before_step(&mut self, world: &mut World) {
        if world.step_count() == JUMPS
            && let Some(referee) = self.fighters.last_mut()
        {
            referee.character.jump(world);
        }
    }

    fn after_step(&mut self, world: &mut World) {
        self.watch.work_in += world.work().total();
        self.fighters.iter_mut().for_each(|fighter| fighter.character.update(world));
        self.look(world);
        self.fight(world);
        self.fighters.iter_mut().for_each(Fighter::show);
    }

    fn save(&self, out: &mut Writer) {
        for fighter in &self.fighters {
            fighter.character.save(out);
            out.u32(fighter.rests);
        }
        out.u64(self.seed);
        let Watch { nearest, highest, outside, lost, pushes, stumbles, caught, falls, ups, work_in } =
            self.watch;
        [nearest, highest, work_in].into_iter().for_each(|x| out.f32(x));
        [outside, lost, pushes, stumbles, caught, falls, ups].into_iter().for_each(|x| out.u32(x));
    }

    fn load(&mut self, bytes: &mut Reader<'_>) -> Result<(), ReadError> {
        for fighter in &mut self.fighters {
            fighter.character.load(bytes)?;
            fighter.rests = bytes.u32()?;
            fighter.show();
        }
        self.seed = bytes.u64()?;
        let (nearest, highest, work_in) = (bytes.f32()?, bytes.f32()?, bytes.f32()?);
        let mut count = || bytes.u32();
        let (outside, lost, pushes, stumbles) = (count()?, count()?, count()?, count()?);
        let (caught, falls, ups) = (count()?, count()?, count()?);
        self.watch = Watch { nearest, highest, outside, lost, pushes, stumbles, caught, falls, ups, work_in };
        Ok(())
    }

    fn work_in(&self, _: &World) -> f32 {
        self.watch.work_in
    }

    fn metrics(&self, _: &World) -> Vec<Metric> {
        let Watch { nearest, highest, outside, lost, pushes, stumbles, caught, falls, ups, .. } = self.watch;
        let speed = self.def.in_world.jump_speed;
        vec![
            Metric::new("jump_m", highest, Expected::near(speed * speed / (2.0 * GRAVITY), 0.006)),
            Metric::new("overlap_m", max(-nearest, 0.0), Expected::AtMost(0.01)),
            Metric::new("outside", outside, Expected::AtMost(0.0)),
            Metric::new("lost", lost, Expected::AtMost(0.0)),
            Metric::new("pushes", pushes, Expected::Anything),
            Metric::new("stumbles", stumbles, Expected::Anything),
            Metric::new("caught", caught, Expected::Anything),
            Metric::new("falls", falls, Expected::Anything),
            Metric::new("got_up", ups, Expected::Anything),
        ]
    }

    fn camera_hint(&self) -> CameraHint {
        CameraHint { direction: Vec3::new(0.4, 0.7, 1.0), bounds: None, trails: Trails::None }
    }

    fn figures(&self) -> Vec<Figure<'_>> {
        let figure = |fighter| {
            let Fighter { model, .. }: &Fighter = fighter;
            Figure { rig: &self.def.rig, world_from_joint: model }
        };
        self.fighters.iter().map(figure).collect()
    }

    fn bodies_of_figures(&self) -> Vec<BodyId> {
        self.fighters.iter().flat_map(|fighter| fighter.character.bodies().iter().copied()).collect()
    }
}
