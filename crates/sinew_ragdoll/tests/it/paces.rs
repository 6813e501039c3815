//! Clips of a character at walking, running and intermediate speeds.

use crate::actor::{shared, walker};
use crate::in_world::level;
use sinew_anim::{Clip, ClipEvent};
use sinew_math::{Reader, Transform, Vec3, Writer, max};
use sinew_physics::World;
use sinew_ragdoll::{Character, CharacterDef, CharacterEvent, Locomotion, MotionSet, State};
use sinew_scenes::mannequin::{RUN_SPEED, WALK_SPEED, drills};
use std::sync::Arc;

/// Returns a character with a walk in place and a travelling run, with footstep events.
fn runner() -> Arc<CharacterDef> {
    let mut def = walker();
    let MotionSet { mut clips, looped, .. } = def.motions().clone();
    let walk = looped.expect("the character walks");
    let run = drills::running();
    let step = |clip: usize, time: f32, side: &str| {
        (clip, ClipEvent { payload: side.to_owned(), ..ClipEvent::new(time, "footstep") })
    };
    let half = 0.5 * clips[walk].duration;
    let mut events = vec![step(walk, 0.0, "left"), step(walk, half, "right")];
    events.extend([step(clips.len(), run.strikes[0], "left"), step(clips.len(), run.strikes[1], "right")]);
    let faster = vec![(clips.len(), Locomotion::ByClip)];
    clips.push(run.clip);
    let motions = MotionSet { clips, faster, events, ..def.motions().clone() };
    def.set_motions(motions).expect("clips made by code can be played");
    shared(def)
}

/// Moves a character forward. Returns its clip events, and the mean speed over the ground of the ball of its lower
/// foot, m/s.
fn moved(world: &mut World, hero: &mut Character, speed: f32, steps: usize) -> (Vec<CharacterEvent>, f32) {
    let def = hero.def().clone();
    let feet = ["leftFoot", "rightFoot"].map(|role| def.body_named(role).expect("a foot"));
    hero.set_move(Vec3::Z * speed);
    let (mut events, mut slide) = (Vec::new(), 0.0);
    let soles = |world: &World, hero: &Character| {
        feet.map(|foot| world.transform(hero.bodies()[foot]).point(Vec3::ZERO))
    };
    let mut before = soles(world, hero);
    for _ in 0..steps {
        world.step();
        hero.update(world);
        events.extend_from_slice(hero.events());
        let now = soles(world, hero);
        let lower = usize::from(now[1].y < now[0].y);
        let way = now[lower] - before[lower];
        slide += Vec3::new(way.x, 0.0, way.z).length() * 60.0 / steps as f32;
        before = now;
    }
    (events, slide)
}

fn steps_of<'a>(def: &'a CharacterDef, events: &[CharacterEvent]) -> Vec<(&'a str, &'a str)> {
    let name = |event: &CharacterEvent| match event {
        CharacterEvent::Clip(fired) => {
            Some((def.set().clip(fired.clip).clip.name(), def.set().event(fired).payload.as_str()))
        }
        _ => None,
    };
    events.iter().filter_map(name).collect()
}

#[test]
fn clips_play_at_the_movers_speed() {
    let def = runner();
    let (walk, run) = (&def.motions().clips[0].name, &def.motions().clips[def.motions().faster[0].0].name);
    let mut world = level();
    let mut hero = Character::spawn(&mut world, &def, Transform::IDENTITY);
    for (speed, clip) in [(WALK_SPEED, walk), (RUN_SPEED, run), (WALK_SPEED, walk)] {
        moved(&mut world, &mut hero, speed, 90);
        let from = hero.world_from_character().translation.z;
        let (events, slide) = moved(&mut world, &mut hero, speed, 120);
        let steps = steps_of(&def, &events);
        println!("{speed} m/s: {steps:?}, lower foot {slide:.2} m/s");
        assert!(steps.iter().all(|(name, _)| name == clip), "{speed} m/s: steps of other clips: {steps:?}");
        let sides: Vec<&str> = steps.iter().map(|(_, side)| *side).collect();
        assert!(
            sides.len() >= 3 && sides.windows(2).all(|pair| pair[0] != pair[1]),
            "{speed} m/s: feet must alternate: {sides:?}"
        );
        let went = (hero.world_from_character().translation.z - from) / 2.0;
        assert!((went - speed).abs() < 0.02 * speed, "moved at {went} m/s, expected {speed} m/s");
        assert_eq!(hero.state(), State::Animated);
    }
}

/// Between walk and run the clips are synchronised: left and right foot alternate, and the lower foot slides little
/// more than in the clips themselves.
#[test]
fn feet_alternate_between_walk_and_run() {
    let def = runner();
    let mut world = level();
    let mut hero = Character::spawn(&mut world, &def, Transform::IDENTITY);
    let mut slides = Vec::new();
    for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
        let speed = WALK_SPEED + share * (RUN_SPEED - WALK_SPEED);
        moved(&mut world, &mut hero, speed, 90);
        let (events, slide) = moved(&mut world, &mut hero, speed, 240);
        let sides: Vec<&str> = steps_of(&def, &events).iter().map(|(_, side)| *side).collect();
        println!("{speed:.2} m/s: {} steps, lower foot {slide:.2} m/s", sides.len());
        assert!(
            sides.windows(2).all(|pair| pair[0] != pair[1]),
            "{speed} m/s: feet must alternate: {sides:?}"
        );
        slides.push(slide / speed);
    }
    let ends = max(slides[0], slides[4]);
    assert!(
        slides.iter().all(|&slide| slide < ends + 0.1),
        "feet slide at these shares of the speed: {slides:?}"
    );
}

#[test]
fn saved_runner_continues_identically() {
    let def = runner();
    let mut world = level();
    let mut hero = Character::spawn(&mut world, &def, Transform::IDENTITY);
    moved(&mut world, &mut hero, 0.5 * (WALK_SPEED + RUN_SPEED), 37);
    let mut bytes = Writer::default();
    world.save(&mut bytes);
    hero.save(&mut bytes);
    let bytes = bytes.into_bytes();
    let mut reader = Reader::new(&bytes);
    let (mut again, mut twin) = (level(), Character::new(def, Transform::IDENTITY, 0.0));
    again.load(&mut reader).expect("the world was saved just now");
    twin.load(&mut reader).expect("the character was saved just now");
    for step in 0..120 {
        let speed = if step < 60 { RUN_SPEED } else { 0.0 };
        hero.set_move(Vec3::Z * speed);
        twin.set_move(Vec3::Z * speed);
        world.step();
        again.step();
        hero.update(&mut world);
        twin.update(&mut again);
        assert_eq!(hero.pose(), twin.pose(), "step {step}");
    }
    assert_eq!(world.hash(), again.hash());
}

/// A clip without displacement has no known speed.
#[test]
fn run_in_place_without_known_speed_is_ignored() {
    let mut def = walker();
    let clips: Vec<Clip> = def.motions().clips.clone();
    let faster = vec![(1, Locomotion::InPlace), (0, Locomotion::Forward { speed: 0.2 })];
    let motions = MotionSet { clips, faster, ..def.motions().clone() };
    def.set_motions(motions).expect("the clips can be played");
    let def = shared(def);
    let mut world = level();
    let mut hero = Character::spawn(&mut world, &def, Transform::IDENTITY);
    moved(&mut world, &mut hero, RUN_SPEED, 60);
    assert!(hero.world_from_character().translation.z > 2.0);
}
