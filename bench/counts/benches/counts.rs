//! Instructions of the kernels, counted under valgrind, which do not depend on other load.
//!
//! Six scenes as whole steps (`scene_step`), then kernels, one character in each of its states (`character_step`: the world and the character's
//! update), a hundred walkers with and without hit bodies (`walkers_step`), and springs (`springs_step`). `cargo xtask bench --counts` runs these and
//! compares them with `bench/counts/baseline.txt`. Private code is measured by the step of a world that does little else.

use gungraun::Callgrind;
use gungraun::prelude::*;
use sinew::anim::springs::{ColliderShape, Side, SpringBone, SpringChain, SpringCollider, Springs};
use sinew::anim::{Joint, LocalTransform, analyze};
use sinew::math::{Random, Rotation, Transform, Vec3, trig};
use sinew::physics::collide::{Manifold, collide};
use sinew::physics::{BodyDef, BodyKind, Shape, ShapeDef, SleepThresholds, Sleeping, World, WorldDef};
use sinew::ragdoll::{BuildOptions, Character, CharacterDef, Detail, Preset, SpringStep, SpringSwing, build};
use sinew_scenes::blueprint;
use sinew_scenes::crowd::{Crowd, CrowdScene};
use sinew_scenes::scenes::{self, Instance};
use std::hint::black_box;
use std::sync::Arc;

/// Returns the mannequin of `ragdoll_drop` after `steps`, with warm buffers.
fn ragdoll(steps: u32) -> Instance {
    let scene = scenes::find("ragdoll_drop").expect("the registry has it");
    let mut drop = scene.start(&scene.settings());
    for _ in 0..steps {
        drop.world_mut().step();
    }
    let world = drop.world();
    assert!(world.body_ids().any(|id| world.is_awake(id)), "the scene is asleep already");
    drop
}

/// Returns the mannequin in the air, 0.2 s after release.
fn falling() -> Instance {
    ragdoll(12)
}

/// Returns the mannequin while it lands: the busiest steps of the fall.
fn landing() -> Instance {
    ragdoll(60)
}

/// Returns a ragdoll at rest on the floor, awake.
fn lying() -> Instance {
    ragdoll(95)
}

#[library_benchmark]
#[bench::falling(falling())]
#[bench::landing(landing())]
#[bench::lying(lying())]
fn ragdoll_step(mut drop: Instance) -> Instance {
    drop.world_mut().step();
    drop
}

/// Returns ten chains of a hundred links and a weight: factor and solve of long trees.
fn chains() -> World {
    let (mut world, ..) = blueprint::chain_100_links().build();
    world.step();
    world
}

/// Returns a box on a floor: a manifold of four points, and its complementarity problem.
fn lone_box() -> World {
    let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
    let cuboid = |half_extents, y| BodyDef {
        position: Vec3::Y * y,
        shapes: vec![ShapeDef::new(Shape::Box { half_extents })],
        ..BodyDef::default()
    };
    world.add_body(&BodyDef { kind: BodyKind::Static, ..cuboid(Vec3::new(5.0, 1.0, 5.0), -1.0) });
    world.add_body(&cuboid(Vec3::splat(0.5), 0.5));
    for _ in 0..30 {
        world.step();
    }
    world
}

/// Returns `awake` balls in flight beside `asleep` boxes that sleep on a floor.
fn beside_sleepers(awake: u32, asleep: u32) -> World {
    // Resting bodies sleep after one step.
    let sleep_thresholds = SleepThresholds { time: 0.0, ..SleepThresholds::default() };
    let mut world = World::new(WorldDef { sleep_thresholds, ..WorldDef::default() });
    let body =
        |shape, position| BodyDef { position, shapes: vec![ShapeDef::new(shape)], ..BodyDef::default() };
    world.add_body(&BodyDef { kind: BodyKind::Static, ..body(Shape::HalfSpace, Vec3::ZERO) });
    let place = |i: u32, height: f32| Vec3::new((i % 100) as f32, height, (i / 100) as f32);
    for i in 0..asleep {
        world.add_body(&body(Shape::Box { half_extents: Vec3::splat(0.2) }, place(i, 0.2)));
    }
    for i in 0..awake {
        let linear_velocity = Vec3::Y * 5.0;
        world.add_body(&BodyDef { linear_velocity, ..body(Shape::Sphere { radius: 0.1 }, place(i, 20.0)) });
    }
    for _ in 0..10 {
        world.step();
    }
    assert_eq!(world.body_ids().filter(|&id| !world.is_awake(id)).count(), asleep as usize);
    world
}

/// Returns a scene after this many steps.
fn after(steps: u32, blueprint: &blueprint::Blueprint) -> World {
    let (mut world, ..) = blueprint.build();
    for _ in 0..steps {
        world.step();
    }
    world
}

/// Returns four humanoids of 15 bodies in a heap, still moving.
fn ragdoll_pile() -> World {
    after(40, &blueprint::ragdoll_column(4))
}

/// Returns a pyramid of 1,240 cubes with 8,555 manifolds.
fn box_pyramid() -> World {
    after(1, &blueprint::box_pyramid())
}

/// Returns a layer of 144 boxes that has landed.
fn box_rain() -> World {
    after(50, &blueprint::box_rain_of(144))
}

/// Returns the mannequin's ragdoll on its back, at rest and awake.
fn humanoid_lying() -> World {
    after(90, &blueprint::humanoid_lying())
}

/// Returns 14 cubes with a humanoid that fell onto them.
fn ragdoll_on_boxes() -> World {
    after(40, &blueprint::ragdoll_on_boxes(3))
}

#[library_benchmark]
#[bench::ragdoll_pile(ragdoll_pile())]
#[bench::box_pyramid(box_pyramid())]
#[bench::box_rain(box_rain())]
#[bench::chain_100_links(chains())]
#[bench::humanoid_lying(humanoid_lying())]
#[bench::ragdoll_on_boxes(ragdoll_on_boxes())]
fn scene_step(mut world: World) -> World {
    world.step();
    world
}

#[library_benchmark]
#[bench::manifold_of_one_box(lone_box())]
#[bench::awake_100(beside_sleepers(100, 0))]
#[bench::awake_100_asleep_10_000(beside_sleepers(100, 10_000))]
#[bench::asleep_10_000(beside_sleepers(0, 10_000))]
fn step(mut world: World) -> World {
    world.step();
    world
}

/// Number of pairs of a box and another shape that touch, or nearly.
const PAIRS: usize = 64;

type Placed = (Shape, Transform);

fn pairs(other: fn(&mut Random) -> Shape) -> Vec<(Placed, Placed)> {
    let mut random = Random::new(42);
    let pair = |_| {
        let [a, b] = [cuboid(&mut random), other(&mut random)];
        let mut turn = || {
            let axis = Vec3::new(random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(0.1, 1.0));
            Rotation::from_axis_angle(axis.normalize(), random.range(0.0, 3.0))
        };
        let [turn_a, turn_b] = [turn(), turn()];
        let side = |random: &mut Random| random.range(-0.8, 0.8);
        let offset = Vec3::new(side(&mut random), side(&mut random), side(&mut random));
        ((a, Transform::new(Vec3::ZERO, turn_a)), (b, Transform::new(offset, turn_b)))
    };
    (0..PAIRS).map(pair).collect()
}

fn cuboid(random: &mut Random) -> Shape {
    let mut half = || random.range(0.2, 0.6);
    Shape::Box { half_extents: Vec3::new(half(), half(), half()) }
}

fn capsule(random: &mut Random) -> Shape {
    Shape::Capsule { half_height: random.range(0.1, 0.5), radius: random.range(0.1, 0.4) }
}

#[library_benchmark]
#[bench::box_box(pairs(cuboid))]
#[bench::box_capsule(pairs(capsule))]
fn collide_64(pairs: Vec<(Placed, Placed)>) -> usize {
    let mut manifold = Manifold::default();
    let mut points = 0;
    for ((a, world_from_a), (b, world_from_b)) in black_box(&pairs) {
        collide(a, world_from_a, b, world_from_b, 0.02, &mut manifold);
        points += black_box(&manifold).count;
    }
    core::mem::forget(pairs);
    points
}

/// Number of steps after which no search or allocation happens any more.
const WARM: usize = 4;

/// Returns a hundred characters that each blend two clips of 50 joints, warm.
fn crowd() -> Crowd {
    let mut crowd = Crowd::new(CrowdScene::new(100));
    for step in 0..WARM {
        crowd.step(step);
    }
    crowd
}

#[library_benchmark]
#[bench::characters_100(crowd())]
fn blend_two_clips(mut crowd: Crowd) -> Crowd {
    crowd.step(WARM);
    crowd
}

/// The mannequin on a floor, in one of its states.
struct Actor {
    world: World,
    character: Character,
}

impl Actor {
    fn step(&mut self) {
        self.world.step();
        self.character.update(&mut self.world);
    }
}

/// Returns the mannequin after a second of walking, an action, and `steps` more steps.
fn actor(done: fn(&mut World, &mut Character), steps: u32) -> Actor {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let def = Arc::new(sinew::mannequin::character());
    let character = Character::spawn(&mut world, &def, Transform::IDENTITY);
    let mut actor = Actor { world, character };
    (0..60).for_each(|_| actor.step());
    done(&mut actor.world, &mut actor.character);
    (0..steps).for_each(|_| actor.step());
    actor
}

fn frozen() -> Actor {
    actor(|world, character| character.set_level_of_detail(world, Detail::Frozen), 10)
}

fn keyed() -> Actor {
    actor(|world, character| character.set_level_of_detail(world, Detail::Keyed), 10)
}

fn hit_bodies() -> Actor {
    actor(|_, _| {}, 10)
}

fn flinching() -> Actor {
    let blow = |world: &mut World, character: &mut Character| {
        character.hit(world, 5, Vec3::X * 5.0);
    };
    actor(blow, 4)
}

fn powered() -> Actor {
    actor(|world, character| character.set_preset(world, Preset::Powered), 60)
}

fn stumbling() -> Actor {
    let push = |world: &mut World, character: &mut Character| {
        character.set_preset(world, Preset::Powered);
        character.hit(world, 2, Vec3::X * 60.0);
    };
    actor(push, 6)
}

fn limp() -> Actor {
    actor(|world, character| character.go_limp(world), 40)
}

#[library_benchmark]
#[bench::frozen(frozen())]
#[bench::keyed(keyed())]
#[bench::hit_bodies(hit_bodies())]
#[bench::flinching(flinching())]
#[bench::powered(powered())]
#[bench::stumbling(stumbling())]
#[bench::limp(limp())]
fn character_step(mut actor: Actor) -> Actor {
    actor.step();
    actor
}

/// A hundred walking mannequins on a floor, three metres apart.
struct Walkers {
    world: World,
    characters: Vec<Character>,
}

impl Walkers {
    fn step(&mut self) {
        self.world.step();
        self.characters.iter_mut().for_each(|character| character.update(&mut self.world));
    }
}

fn walkers(detail: Detail) -> Walkers {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let def = Arc::new(sinew::mannequin::character());
    let place = |i: u8| Vec3::new(3.0 * f32::from(i % 10), 0.0, 3.0 * f32::from(i / 10));
    let characters = (0..100).map(|i| {
        let mut character = Character::spawn(&mut world, &def, Transform::from_translation(place(i)));
        character.set_level_of_detail(&mut world, detail);
        character
    });
    let characters = characters.collect();
    let mut walkers = Walkers { world, characters };
    (0..20).for_each(|_| walkers.step());
    walkers
}

#[library_benchmark]
#[bench::hit_bodies(walkers(Detail::Full))]
#[bench::none(walkers(Detail::Keyed))]
fn walkers_step(mut walkers: Walkers) -> Walkers {
    walkers.step();
    walkers
}

/// A hundred characters with eight strands of five spring bones each, whose heads walk and sway.
struct Maned {
    def: CharacterDef,
    swings: Vec<SpringSwing>,
    frame: u16,
}

impl Maned {
    fn step(&mut self, moves: fn(&mut SpringSwing, &SpringStep<'_>)) {
        self.frame += 1;
        let (rig, mapping) = (self.def.springs(), self.def.mapping());
        let (seconds, pose) = (1.0 / 60.0, self.def.rest());
        let time = f32::from(self.frame) * seconds;
        let turn = Rotation::from_axis_angle(Vec3::Y, 0.5 * trig::sin(5.0 * time));
        for (number, swing) in (0u8..).zip(&mut self.swings) {
            let way = Vec3::new(f32::from(number) + 0.1 * trig::sin(8.0 * time), 0.0, time);
            let world_from_model = mapping.world_from_model(Transform::new(way, turn));
            moves(swing, &SpringStep { rig, pose, world_from_model, bodies: &[], world: None, seconds });
        }
    }
}

/// Returns the mannequin with eight strands around its head, each with a ball for the head as collider.
fn strands() -> CharacterDef {
    let mut rig = sinew::mannequin::mannequin().rig;
    let head = rig.joints.iter().position(|joint| joint.name == "head").expect("it has a head");
    let shape = ColliderShape::Sphere { offset: Vec3::Y * 0.1, radius: 0.09, keeps: Side::Outside };
    let mut springs =
        Springs { colliders: vec![SpringCollider { joint: head, shape }], ..Springs::default() };
    for strand in 0..8u8 {
        let angle = f32::from(strand) * core::f32::consts::FRAC_PI_4;
        let out = Vec3::new(trig::cos(angle), 0.0, trig::sin(angle));
        let tail = out * 0.02 - Vec3::Y * 0.06;
        let (mut parent, mut bones) = (head, Vec::new());
        for link in 0..=5u8 {
            let joint = rig.joints.len();
            let translation = if link == 0 { (out + Vec3::Y) * 0.1 } else { tail };
            let rest = LocalTransform { translation, ..LocalTransform::default() };
            rig.joints.push(Joint {
                name: format!("hair_{strand}_{link}"),
                parent: Some(parent),
                rest,
                source: joint,
            });
            bones.push(SpringBone { joint, tail, ..sinew_scenes::maned::HAIR });
            parent = joint;
        }
        bones.pop();
        springs.chains.push(SpringChain { bones, colliders: vec![0], ..SpringChain::default() });
    }
    rig.springs = springs;
    let analysis = analyze(&rig).expect("the mannequin has a skin");
    let (ragdoll, _) = build(&rig, &analysis, &BuildOptions::default()).expect("and bones");
    CharacterDef::new(rig, ragdoll, &analysis.bind_model)
}

/// Returns hair after a second of swinging and `eased` steps of easing.
fn maned(eased: u32) -> Maned {
    let mut maned = Maned { def: strands(), swings: vec![SpringSwing::new(); 100], frame: 0 };
    assert_eq!(maned.def.springs().joints().len(), 40);
    (0..60).for_each(|_| maned.step(SpringSwing::step));
    (0..eased).for_each(|_| maned.step(SpringSwing::ease));
    assert_eq!(maned.swings.iter().all(SpringSwing::is_away), eased > 300);
    maned
}

// 4,000 spring bones, a step: 7.5 million instructions are about 1 ms.
#[library_benchmark]
#[bench::near(maned(0), SpringSwing::step)]
#[bench::easing(maned(10), SpringSwing::ease)]
#[bench::far(maned(360), SpringSwing::ease)]
fn springs_step(mut maned: Maned, moves: fn(&mut SpringSwing, &SpringStep<'_>)) -> Maned {
    maned.step(moves);
    maned
}

library_benchmark_group!(
    name = kernels,
    benchmarks = [
        scene_step,
        ragdoll_step,
        step,
        collide_64,
        blend_two_clips,
        character_step,
        walkers_step,
        springs_step
    ]
);
// Caches are not simulated: only instructions are compared, in half the time.
main!(
    config = LibraryBenchmarkConfig::default().tool(Callgrind::with_args(["--cache-sim=no"])),
    library_benchmark_groups = kernels
);
