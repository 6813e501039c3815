//! Random falls: every character gets up again, and no joint jumps at hand-over to bodies and back.

use crate::actor::{floor, kaykit, shared, walker};
use crate::pops::Pops;
use core::fmt::Write as _;
use needs_data::needs_data;
use sinew_math::{Random, Rotation, Transform, Vec3};
use sinew_physics::{World, WorldDef};
use sinew_ragdoll::{Character, CharacterDef, CharacterEvent, State};
use std::sync::Arc;

/// Longest allowed time from the hit until the character is up, seconds.
const UP_WITHIN: f32 = 8.0;

/// Lying posture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Lying {
    Supine,
    Prone,
    LeftSide,
    RightSide,
}

const ALL: [Lying; 4] = [Lying::Supine, Lying::Prone, Lying::LeftSide, Lying::RightSide];

/// Classifies the posture by the directions of the pelvis's front and left.
fn lying(character: &Character, world: &World) -> Lying {
    let ragdoll = character.ragdoll().expect("the pose must follow the lying bodies");
    let bind = character.def().ragdoll.bodies[0].character_from_body.rotation;
    let turn = world.transform(ragdoll.bodies[0]).rotation * bind.inverse();
    let (forward, left) = (turn * Vec3::Z, turn * Vec3::X);
    if forward.y.abs() > left.y.abs() {
        if forward.y > 0.0 { Lying::Supine } else { Lying::Prone }
    } else if left.y > 0.0 {
        Lying::RightSide
    } else {
        Lying::LeftSide
    }
}

/// Result of one fall.
struct Fall {
    lying: Option<Lying>,
    /// Time from the hit until the character is up, seconds.
    up: Option<f32>,
}

fn head(character: &Character) -> f32 {
    let def = character.def();
    let body = def.body_named("head").expect("the character has a head");
    let mut model = Vec::new();
    sinew_anim::local_to_model(&def.rig, character.pose(), &character.world_from_model(), &mut model);
    model[def.ragdoll.bodies[body].joint].translation.y
}

/// Hits a character at a random time of its walk, on a random body, from a random direction.
fn fall(def: &Arc<CharacterDef>, random: &mut Random, pops: &mut Pops) -> Fall {
    let mut world = World::new(WorldDef::default());
    world.add_body(&floor());
    let facing = Rotation::from_axis_angle(Vec3::Y, random.range(-3.0, 3.0));
    let mut character =
        Character::new(def.clone(), Transform::new(Vec3::ZERO, facing), random.range(0.0, 1.0));
    let standing = head(&character);
    for _ in 0..random.index(40) {
        world.step();
        character.update(&mut world);
    }
    let body = ["chest", "head", "hips", "leftUpperLeg", "rightUpperArm"][random.index(5)];
    let body = def.body_named(body).unwrap_or(0);
    let way = random.direction();
    let push = Vec3::new(way.x, 0.3 * way.y, way.z) * (def.ragdoll.total_mass * random.range(0.3, 1.6));
    pops.go_limp(&character);
    pops.begin(&character);
    character.hit(&mut world, body, push);
    let mut fall = Fall { lying: None, up: None };
    let most = (12.0 / world.def().dt()) as u32;
    for step in 1..=most {
        world.step();
        let lies = character.ragdoll().is_some().then(|| lying(&character, &world));
        character.update(&mut world);
        pops.watch(&character);
        if fall.lying.is_none()
            && character
                .events()
                .iter()
                .any(|e| matches!(e, CharacterEvent::Settled { .. } | CharacterEvent::NeverSettled))
        {
            fall.lying = lies;
        }
        if fall.up.is_none() && character.state() == State::Animated {
            fall.up = Some(step as f32 * world.def().dt());
        }
    }
    assert!(
        head(&character) > 0.9 * standing,
        "the head is at {} m, standing at {standing} m",
        head(&character)
    );
    fall
}

fn check_all_stand_up(name: &str, def: CharacterDef) {
    let def = shared(def);
    let falls = if std::env::var_os("SINEW_FULL").is_some() { 500 } else { 20 };
    let (mut random, mut pops) = (Random::new(7), Pops::new(&def));
    let all: Vec<Fall> = (0..falls).map(|_| fall(&def, &mut random, &mut pops)).collect();
    let stood = |fall: &&Fall| fall.up.is_some_and(|up| up <= UP_WITHIN);
    let mut text =
        format!("{name}: {} of {falls} stand within {UP_WITHIN} s", all.iter().filter(stood).count());
    for class in ALL {
        let of = || all.iter().filter(move |fall| fall.lying == Some(class));
        let slowest = of().filter_map(|fall| fall.up).fold(0.0, sinew_math::max);
        let _ = write!(
            text,
            ", {class:?} {}/{} (slowest {slowest:.1} s)",
            of().filter(stood).count(),
            of().count()
        );
    }
    println!("{text}\n{pops}");
    assert!(all.iter().filter(stood).count() * 100 >= 95 * falls, "{text}");
    assert!(pops.worst() <= 1.0, "{pops}");
}

#[test]
fn mannequin_stands_up_after_random_falls() {
    check_all_stand_up("mannequin", walker());
}

#[needs_data]
#[test]
fn kaykit_mannequin_stands_up_after_random_falls() {
    let def = kaykit();
    check_all_stand_up("KayKit mannequin", def);
}
