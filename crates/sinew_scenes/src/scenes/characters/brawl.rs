//! A brawl in a room: characters walk at random among crates and stairs and are hit; fallen ones get up. The metrics
//! measure how well all character features work together.

mod readings;
mod watch;

use crate::framework::actors::Figure;
use crate::framework::camera_hint::{CameraHint, Trails};
use crate::framework::instance::{Instance, Script};
use crate::framework::metric::Metric;
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use crate::parts::{cuboid, fixed, floor};
use sinew::anim::local_to_model;
use sinew::math::{Affine, Random, ReadError, Reader, Rotation, Transform, Vec3, Writer, min};
use sinew::physics::{BodyDef, BodyId, World};
use sinew::ragdoll::{Character, CharacterDef, GroundContact, Preset, State};
use std::sync::Arc;
use watch::{Watch, Watched};

pub(in crate::scenes) const BRAWL: Scene = Scene {
    chapter: Chapter::Characters,
    name: "brawl",
    about: "mannequins walk about in a room with crates and stairs, are struck, fall and get up",
    steps: 600,
    settings: &[
        Setting::whole("n", 20, (1, 200), "number of mannequins"),
        Setting::whole("crates", 12, (0, 200), "number of crates"),
        Setting::number("hits", 4.0, (0.0, 60.0), "number of blows per second, each of 5 to 90 N·s"),
        Setting::whole(
            "powered",
            0,
            (0, 1),
            "1: standing mannequins are powered, 0: they follow their clips",
        ),
        Setting::whole("tiles", 0, (0, 1), "1: the floor is of boxes of 1 m, 0: one half-space"),
        Setting::whole("seed", 1, (0, 10_000), "seed of places, directions and blows"),
    ],
    build: brawl,
};

/// Half of the room's inner width, metres.
const ROOM: f32 = 6.0;
/// Distance from a wall at which a walker turns back, metres.
const TURNS_BACK: f32 = 0.9;
/// Range of walking speeds, m/s, and range of times between changes of direction, seconds.
const SPEEDS: (f32, f32) = (0.7, 1.4);
const KEEPS: (f32, f32) = (1.0, 4.0);
/// Time after which a fallen character gets up although it still moves, seconds: in a crowd other characters push it.
const PATIENCE: f32 = 2.0;
/// Impulses of hits, N·s.
const BLOWS: (f32, f32) = (5.0, 90.0);
/// Stairs: number of steps, their height and depth, half their width, metres.
const STAIRS: (usize, f32, f32, f32) = (4, 0.18, 0.32, 1.0);

fn brawl(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    let mut stands: Vec<BodyId> = ground(setup).iter().map(|def| world.add_body(def)).collect();
    stands.extend(walls_and_stairs().into_iter().map(|(half, at)| world.add_body(&fixed(cuboid(half, at)))));
    let mut random = Random::new(setup.whole("seed") as u64);
    for index in 0..setup.whole("crates") {
        let across = 0.9 * (index % 12) as f32 - 5.2;
        let mut crate_ = cuboid(Vec3::splat(0.25), Vec3::new(across, 0.25 + 0.5 * (index / 12) as f32, 3.2));
        crate_.shapes[0].density = 300.0;
        world.add_body(&crate_);
    }
    let mut def = sinew::mannequin::character();
    def.patience = PATIENCE;
    def.ground_contact = GroundContact::Enforced;
    let def = Arc::new(def);
    let count = setup.whole("n");
    let row = (count as f32).sqrt().ceil() as usize;
    let apart = 1.8 * ROOM / row as f32;
    let mut fighters = Vec::new();
    for index in 0..count {
        let place = Vec3::new((index % row) as f32 + 0.5, 0.0, (index / row) as f32 + 0.5) * apart;
        let place = place - Vec3::new(0.9 * ROOM, 0.0, 0.9 * ROOM) + on_stairs(place, apart);
        let turn = Rotation::from_axis_angle(Vec3::Y, random.range(-3.0, 3.0));
        let character = Character::spawn(&mut world, &def, Transform::new(place, turn));
        let model = Vec::new();
        fighters.push(Fighter { character, way: Vec3::ZERO, keeps: 0.0, model, watched: Watched::default() });
    }
    let (hits, powered) = (setup.number("hits"), setup.whole("powered") == 1);
    let watch = Watch::new(stands);
    let mut script = Brawl { def, fighters, hits, powered, due: 0.0, seed: random.bits(), watch };
    script.fighters.iter_mut().for_each(Fighter::show);
    Instance::new(world, script)
}

/// Static boxes on which all characters stand.
fn ground(setup: &Setup<'_>) -> Vec<BodyDef> {
    if setup.whole("tiles") == 0 {
        return vec![floor()];
    }
    let half = ROOM as i32 + 1;
    let side = || (-half..half).map(|at| at as f32 + 0.5);
    let tile = |x, z| fixed(cuboid(Vec3::splat(0.5), Vec3::new(x, -0.5, z)));
    side().flat_map(|x| side().map(move |z| tile(x, z))).collect()
}

/// Half extents and centres of the boxes.
fn walls_and_stairs() -> Vec<(Vec3, Vec3)> {
    let (thick, high) = (0.2, 1.5);
    let far = ROOM + thick;
    let mut boxes = Vec::new();
    for side in [-far, far] {
        boxes.push((Vec3::new(thick, high, far), Vec3::new(side, high, 0.0)));
        boxes.push((Vec3::new(far, high, thick), Vec3::new(0.0, high, side)));
    }
    let (steps, height, depth, half) = STAIRS;
    for step in 0..steps {
        let high = 0.5 * height * (step + 1) as f32;
        // The last is a landing that reaches to the wall.
        let from = -1.5 - depth * step as f32;
        let to = if step + 1 == steps { -ROOM } else { from - depth };
        let middle = Vec3::new(ROOM - half, high, 0.5 * (from + to));
        boxes.push((Vec3::new(half, high, 0.5 * (from - to)), middle));
    }
    boxes
}

/// Height of the stairs under a position of the initial grid, which is relative to the room's corner.
fn on_stairs(place: Vec3, apart: f32) -> Vec3 {
    let (steps, height, depth, half) = STAIRS;
    let (x, z) = (place.x - 0.9 * ROOM, place.z - 0.9 * ROOM);
    let beside = x + 0.25 * apart > ROOM - 2.0 * half;
    let step = ((-1.5 - z) / depth + 1.0).floor();
    if beside && step > 0.0 { Vec3::Y * (height * min(step, steps as f32)) } else { Vec3::ZERO }
}

pub(super) struct Fighter {
    character: Character,
    /// Wanted velocity, m/s, and seconds until the velocity changes.
    way: Vec3,
    keeps: f32,
    /// World from joint.
    model: Vec<Affine>,
    watched: Watched,
}

impl Fighter {
    fn show(&mut self) {
        let character = &self.character;
        let root = character.world_from_model();
        local_to_model(&character.def().rig, character.pose(), &root, &mut self.model);
    }

    /// Lets the character walk on; its direction changes after its time or at a wall.
    fn walk(&mut self, random: &mut Random, dt: f32) {
        self.keeps -= dt;
        let place = self.character.world_from_character().translation;
        let leaves = |x: f32, v: f32| x.abs() > ROOM - TURNS_BACK && x * v > 0.0;
        let outward = leaves(place.x, self.way.x) || leaves(place.z, self.way.z);
        if self.keeps <= 0.0 || outward {
            let (turn, speed) = (random.range(-3.2, 3.2), random.range(SPEEDS.0, SPEEDS.1));
            let back = if outward { place * Vec3::new(-1.0, 0.0, -1.0) } else { Vec3::ZERO };
            let any = Rotation::from_axis_angle(Vec3::Y, turn) * Vec3::Z;
            self.way = (back + any).normalize() * speed;
            self.keeps = random.range(KEEPS.0, KEEPS.1);
        }
        self.character.set_move(self.way);
        self.character.face(self.way);
    }
}

struct Brawl {
    def: Arc<CharacterDef>,
    fighters: Vec<Fighter>,
    /// Number of hits per second.
    hits: f32,
    powered: bool,
    /// Number of hits that are due.
    due: f32,
    seed: u64,
    watch: Watch,
}

impl Brawl {
    fn strike(&mut self, world: &mut World) {
        self.due += self.hits * world.def().dt();
        while self.due >= 1.0 {
            self.due -= 1.0;
            let mut random = Random::new(self.seed);
            self.seed = random.bits();
            let body = random.index(self.def.ragdoll.bodies.len());
            let fighter = random.index(self.fighters.len());
            let fighter = &mut self.fighters[fighter];
            fighter.character.hit(world, body, random.direction() * random.range(BLOWS.0, BLOWS.1));
            fighter.watched.be_struck();
            self.watch.count_blow();
        }
    }
}

impl Script for Brawl {
    fn before_step(&mut self, world: &mut World) {
        self.strike(world);
    }

    fn after_step(&mut self, world: &mut World) {
        self.watch.add_work(world.work().total());
        let dt = world.def().dt();
        let mut random = Random::new(self.seed);
        self.seed = random.bits();
        for fighter in &mut self.fighters {
            fighter.character.update(world);
            if self.powered && fighter.character.state() == State::Animated {
                fighter.character.set_preset(world, Preset::Powered);
            }
            fighter.walk(&mut random, dt);
            fighter.show();
        }
        self.watch.look(world, &mut self.fighters);
    }

    fn save(&self, out: &mut Writer) {
        for fighter in &self.fighters {
            fighter.character.save(out);
            out.vec3(fighter.way);
            out.f32(fighter.keeps);
            fighter.watched.save(out);
        }
        out.f32(self.due);
        out.u64(self.seed);
        self.watch.save(out);
    }

    fn load(&mut self, bytes: &mut Reader<'_>) -> Result<(), ReadError> {
        for fighter in &mut self.fighters {
            fighter.character.load(bytes)?;
            fighter.way = bytes.vec3()?;
            fighter.keeps = bytes.f32()?;
            fighter.watched.load(bytes)?;
            fighter.show();
        }
        (self.due, self.seed) = (bytes.f32()?, bytes.u64()?);
        self.watch.load(bytes)
    }

    fn work_in(&self, _: &World) -> f32 {
        self.watch.work_in()
    }

    fn metrics(&self, _: &World) -> Vec<Metric> {
        self.watch.metrics()
    }

    fn camera_hint(&self) -> CameraHint {
        CameraHint { direction: Vec3::new(0.4, 0.9, 1.0), bounds: None, trails: Trails::None }
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
