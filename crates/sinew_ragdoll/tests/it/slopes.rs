//! Getting up on ground that is not level.

use crate::actor::{floor, shared, walker};
use sinew_anim::local_to_model;
use sinew_math::{Affine, Reader, Rotation, Transform, Vec3, Writer, max, min, trig};
use sinew_physics::ray::Ray;
use sinew_physics::{BodyDef, BodyKind, BodyKinds, QueryFilter, Shape, ShapeDef, World, WorldDef};
use sinew_ragdoll::{Character, CharacterDef, Locomotion, MotionSet, State};
use std::sync::Arc;

fn fixed(half_extents: Vec3, position: Vec3, rotation: Rotation) -> BodyDef {
    let shapes = vec![ShapeDef::new(Shape::Box { half_extents })];
    BodyDef { kind: BodyKind::Static, position, rotation, shapes, ..BodyDef::default() }
}

/// Returns a plane that descends toward +Z.
fn slope(degrees: f32) -> Vec<BodyDef> {
    let turn = Rotation::from_axis_angle(Vec3::X, degrees.to_radians());
    vec![fixed(Vec3::new(20.0, 1.0, 20.0), turn * Vec3::NEG_Y, turn)]
}

/// Returns steps of 17 by 30 cm that descend toward +Z.
fn stairs() -> Vec<BodyDef> {
    let step = |k: i32| {
        let top = -0.17 * k as f32;
        fixed(Vec3::new(10.0, 1.0, 0.15), Vec3::new(0.0, top - 1.0, 0.3 * k as f32), Rotation::IDENTITY)
    };
    (-20..20).map(step).collect()
}

const PUSHES: [Vec3; 4] = [
    Vec3::new(0.0, 0.0, 60.0),
    Vec3::new(0.0, 0.0, -60.0),
    Vec3::new(60.0, 0.0, 0.0),
    Vec3::new(-40.0, 0.0, 40.0),
];

fn height(world: &World, at: Vec3) -> f32 {
    let ray = Ray { origin: Vec3::new(at.x, at.y + 1.0, at.z), direction: Vec3::Y * -10.0 };
    let hit = world.query().filter(QueryFilter::of(BodyKinds::STATIC)).first(&ray);
    hit.map_or(f32::NEG_INFINITY, |hit| hit.point.y)
}

/// Returns the largest depth of joints in the ground and the largest height of the lower foot above it while getting
/// up, metres; then the largest acceleration of pelvis and feet after the body pose has decayed, m/s².
fn gets_up(def: &Arc<CharacterDef>, ground: &[BodyDef], push: Vec3) -> [f32; 3] {
    let mut world = world_of(ground);
    let mut character = Character::new(def.clone(), Transform::IDENTITY, 0.2);
    character.hit(&mut world, def.body_named("chest").expect("the character has a chest"), push);
    let joint =
        |name: &str| def.rig.joints.iter().position(|joint| joint.name == name).expect("the joint exists");
    let watched =
        ["hips", "head", "leftHand", "rightHand", "leftLowerLeg", "rightLowerLeg", "leftFoot", "rightFoot"];
    let heavy = ["hips", "leftFoot", "rightFoot"].map(joint);
    let watched = watched.map(joint);
    let (mut deepest, mut highest, mut rising, mut model) = (0.0, 0.0, 0, Vec::new());
    let (mut hardest, mut places) = (0.0, Vec::<[Vec3; 3]>::new());
    for _ in 0..900 {
        world.step();
        character.update(&mut world);
        if rising > 0 && character.state() == State::Animated {
            break;
        }
        rising = if character.state() == State::GettingUp { rising + 1 } else { 0 };
        // The body pose has decayed.
        if rising > 25 {
            local_to_model(&def.rig, character.pose(), &character.world_from_model(), &mut model);
            let over = |joint: usize| model[joint].translation.y - height(&world, model[joint].translation);
            deepest = watched.iter().fold(deepest, |deepest, &joint| max(deepest, -over(joint)));
            places.push(heavy.map(|joint| model[joint].translation));
            if let [.., a, b, c] = &places[..] {
                let hard = (0..3).map(|i| (c[i] - b[i] * 2.0 + a[i]).length() * 3600.0);
                hardest = hard.fold(hardest, max);
            }
        }
        if rising > 120 {
            let [left, right] = held(def, &world, &character);
            highest = max(highest, min(left, right));
        }
    }
    assert_eq!(character.state(), State::Animated, "it never got up");
    [deepest, highest, hardest]
}

#[test]
fn rising_character_neither_sinks_nor_floats_on_a_slope() {
    let def = shared(walker());
    let grounds =
        [("floor", vec![floor()]), ("10°", slope(10.0)), ("20°", slope(20.0)), ("stairs", stairs())];
    let mut on_floor = 0.0;
    for (name, ground) in grounds {
        let mut worst = [0.0_f32; 3];
        for push in PUSHES {
            let found = gets_up(&def, &ground, push);
            worst = core::array::from_fn(|i| max(worst[i], found[i]));
        }
        let [deepest, highest, hardest] = worst;
        println!("{name}: joints {deepest:.3} m deep, lower foot {highest:.3} m high, {hardest:.1} m/s²");
        assert!((deepest < 0.1 || name == "stairs") && highest < 0.05, "{name}: {worst:?}");
        if name == "floor" {
            on_floor = hardest;
        }
        // Following an edge accelerates a foot no more than a transition between clips may: 6 x₀/t₁² for a step of 17
        // cm within 0.3 s.
        assert!(hardest < on_floor + 12.0, "{name}: {hardest} m/s², on a floor {on_floor} m/s²");
    }
}

/// The resting position on stairs is random, and a clip recorded on a floor sometimes moves a hand or knee through an
/// edge. In three builds this happened in 3, 4 and 6 of 32 falls, by at most 16, 20 and 19 cm.
#[test]
fn few_joints_pass_through_the_edge_of_a_step() {
    let def = shared(walker());
    let push = |k: usize| {
        let angle = k as f32 * core::f32::consts::TAU / 64.0;
        Vec3::new(trig::sin(angle), 0.0, trig::cos(angle)) * (45.0 + (k % 4) as f32 * 8.0)
    };
    let mut depths: Vec<f32> = (0..64).map(|k| gets_up(&def, &stairs(), push(k))[0]).collect();
    depths.sort_unstable_by(f32::total_cmp);
    println!("deepest of each, m: {depths:.3?}");
    assert!(depths[51] < 0.1, "at most 12 of 64 get-ups may be deep in the ground: {depths:?}");
    assert!(depths[63] < 0.25, "{depths:?}");
}

/// Returns the height of heel and ball of both feet above the ground, minus their height in the rest pose, metres.
fn soles(def: &CharacterDef, world: &World, character: &Character) -> [[f32; 2]; 2] {
    let (mut model, mut stands) = (Vec::new(), Vec::new());
    local_to_model(&def.rig, character.pose(), &character.world_from_model(), &mut model);
    local_to_model(&def.rig, def.rest(), &def.mapping().character_from_model(), &mut stands);
    let joint =
        |name: &str| def.rig.joints.iter().position(|joint| joint.name == name).expect("the joint exists");
    [["leftFoot", "leftToes"], ["rightFoot", "rightToes"]].map(|foot| {
        foot.map(joint).map(|joint| {
            let place = model[joint].translation;
            place.y - height(world, place) - stands[joint].translation.y
        })
    })
}

/// Returns the height of both feet, metres. Across the edge of a step a foot stands on the ground under its heel or
/// under its ball.
fn held(def: &CharacterDef, world: &World, character: &Character) -> [f32; 2] {
    soles(def, world, character).map(|[heel, ball]| min(heel, ball))
}

/// Returns a pushed mannequin that has got up and stood for a second and a half.
fn stands_again(def: &Arc<CharacterDef>, world: &mut World, start: Transform, push: Vec3) -> Character {
    let mut character = Character::new(def.clone(), start, 0.0);
    character.hit(world, def.body_named("chest").expect("the character has a chest"), push);
    let mut up = 0;
    for _ in 0..1200 {
        world.step();
        character.update(world);
        up = if character.state() == State::Animated { up + 1 } else { 0 };
        if up > 90 {
            return character;
        }
    }
    panic!("it never got up");
}

/// Returns a character without a walk, which stands.
fn stander() -> Arc<CharacterDef> {
    let mut def = walker();
    let motions = MotionSet { looped: None, locomotion: Locomotion::InPlace, ..def.motions().clone() };
    def.set_motions(motions).expect("the motions were accepted before");
    shared(def)
}

fn world_of(ground: &[BodyDef]) -> World {
    let mut world = World::new(WorldDef::default());
    ground.iter().for_each(|body| {
        world.add_body(body);
    });
    world
}

#[test]
fn feet_align_with_a_slope() {
    let def = stander();
    for degrees in [5.0, 10.0, 20.0] {
        let mut worst = 0.0_f32;
        for push in PUSHES {
            let mut world = world_of(&slope(degrees));
            let character = stands_again(&def, &mut world, Transform::IDENTITY, push);
            let soles = soles(&def, &world, &character);
            worst = soles.as_flattened().iter().fold(worst, |worst, over| max(worst, over.abs()));
        }
        println!("{degrees}°: heels and balls {worst} m off");
        assert!(worst < 0.01, "slope of {degrees}°: off by {worst} m");
    }
}

#[test]
fn both_feet_touch_the_ground_across_an_edge() {
    let def = stander();
    let (mut worst, mut bent) = (0.0_f32, 0);
    // The positions of the edges below the character are random.
    for k in 0..6_u8 {
        for push in PUSHES {
            let mut world = world_of(&stairs());
            let start = Transform::from_translation(Vec3::Z * (0.05 * f32::from(k)));
            let character = stands_again(&def, &mut world, start, push);
            let held = held(&def, &world, &character);
            worst = held.into_iter().fold(worst, |worst, over| max(worst, over.abs()));
            let knee = |name: &str| {
                let joint =
                    def.rig.joints.iter().position(|joint| joint.name == name).expect("the rig has a knee");
                character.pose()[joint].rotation.angle_to(def.rest()[joint].rotation)
            };
            bent += u32::from(max(knee("leftLowerLeg"), knee("rightLowerLeg")) > 0.5);
        }
    }
    println!("largest error {worst} m; a leg bent {bent} times");
    assert!(worst < 0.005, "{worst} m off");
    assert!(bent > 0, "no character got up across an edge");
}

#[test]
fn planted_feet_survive_snapshots_and_hand_over() {
    let def = stander();
    let mut world = world_of(&stairs());
    let mut character = Character::new(def.clone(), Transform::IDENTITY, 0.0);
    character.hit(&mut world, def.body_named("chest").expect("the character has a chest"), PUSHES[0]);
    // Snapshots restored while getting up and once standing continue identically.
    let (mut rising, mut up) = (0, 0);
    while up < 90 {
        world.step();
        character.update(&mut world);
        rising += u32::from(character.state() == State::GettingUp);
        up += u32::from(character.state() == State::Animated);
        if !(up == 5 || rising == 110 && up == 0) {
            continue;
        }
        let mut saved = Writer::new();
        character.save(&mut saved);
        let mut other = Character::new(def.clone(), Transform::IDENTITY, 0.0);
        other.load(&mut Reader::new(saved.as_bytes())).expect("it can be restored");
        assert_eq!(other.pose(), character.pose());
        let mut original = character.clone();
        for step in 0..40 {
            other.update(&mut world);
            original.update(&mut world);
            assert_eq!(other.pose(), original.pose(), "other pose: step {step} after {rising} and {up}");
        }
    }
    // While the character stands still, its bodies are still as well, and match the drawn pose.
    let (mut model, mut shown) = (Vec::new(), Vec::new());
    local_to_model(&def.rig, character.pose(), &Affine::IDENTITY, &mut model);
    def.mapping().bodies_from_model(&model, character.world_from_character(), &mut shown);
    character.go_limp(&mut world);
    let bodies = &character.ragdoll().expect("the character is limp").bodies;
    for ((&body, def), shown) in bodies.iter().zip(&def.ragdoll.bodies).zip(&shown) {
        let speed = world.velocity(body).linear.length();
        assert!(speed < 0.02, "{}: {speed} m/s", def.role);
        let off = (world.transform(body).translation - shown.translation).length();
        assert!(off < 1e-5, "{}: {off} m from the drawn pose", def.role);
    }
}

/// A character without a mover used to walk on in the air where its ground ends.
#[test]
fn walker_falls_over_the_edge_of_its_ground() {
    let def = shared(walker());
    let table = || fixed(Vec3::new(3.0, 0.5, 1.0), Vec3::NEG_Y * 0.5, Rotation::IDENTITY);
    let pit = fixed(Vec3::new(20.0, 0.5, 20.0), Vec3::NEG_Y * 3.5, Rotation::IDENTITY);
    let walked = |ground: &[BodyDef]| {
        let mut world = world_of(ground);
        let mut character = Character::new(def.clone(), Transform::IDENTITY, 0.0);
        let mut far: f32 = 0.0;
        for _ in 0..240 {
            world.step();
            character.update(&mut world);
            if character.state() == State::Animated {
                far = max(far, character.world_from_character().translation.z);
            }
        }
        (far, character.state())
    };
    for ground in [vec![table()], vec![table(), pit]] {
        let (far, state) = walked(&ground);
        assert!((0.9..1.3).contains(&far) && state != State::Animated, "{far} m: {state:?}");
    }
    for ground in [slope(20.0), stairs(), vec![floor()]] {
        let (far, state) = walked(&ground);
        assert!(far > 4.0 && state == State::Animated, "{far} m: {state:?}");
    }
}
