//! Damaged snapshots: bytes of a saved world, some of them replaced. Loading returns an error or creates a world that
//! can be stepped, without a panic and within a short time.

use crate::actor::Actor;
use crate::functions;
use crate::life::Life;
use crate::run::caught;
use sinew_math::{Random, Reader, Writer};
use sinew_physics::*;
use std::time::{Duration, Instant};

/// Number of damaged snapshots of each world with `SINEW_FULL` set (otherwise a fifth of it), and number of worlds.
const DAMAGED: usize = 500;
const WORLDS: u64 = 20;
/// Number of steps of a world that loads a damaged snapshot.
const STEPS: usize = 3;
/// Longest time for loading and stepping one snapshot.
const LONG: Duration = Duration::from_secs(5);

/// Returns the shape library and the snapshot of a world after the first steps of a life.
fn saved(seed: u64) -> (Vec<u8>, Vec<u8>) {
    let mut last = (Vec::new(), Vec::new());
    at_each_step(seed, |world| {
        let (mut shapes, mut state) = (Writer::new(), Writer::new());
        world.save_shapes(&mut shapes);
        world.save(&mut state);
        last = (shapes.into_bytes(), state.into_bytes());
    });
    last
}

/// Calls a function with the world after each of the first steps of a life.
pub fn at_each_step(seed: u64, mut show: impl FnMut(&World)) {
    let life = Life::of(seed);
    let (world, floor) = life.world();
    let mut actor = Actor::new(world, floor, None);
    for step in 0..15 {
        for act in life.acts.iter().filter(|act| act.step == step) {
            actor.begin(act.number);
            _ = (act.deed.run)(&mut actor, &mut life.numbers(act));
        }
        actor.step();
        show(&actor.world);
    }
}

fn damage(bytes: &mut Vec<u8>, random: &mut Random) {
    let at = random.index(bytes.len());
    match random.index(6) {
        0 => bytes[at] ^= 1 << random.index(8),
        1 => bytes[at] = random.index(256) as u8,
        2 => bytes[at] = [0, 1, 0x7f, 0x80, 0xff][random.index(5)],
        3 => bytes.truncate(at),
        4 => {
            // Writes NaN, infinity, a huge number, -1, 0 or a small integer.
            let number = [f32::NAN, f32::INFINITY, f32::MAX, -1.0, 0.0][random.index(5)].to_bits();
            let number = if random.unit() < 0.3 { random.index(40) as u32 } else { number };
            let end = usize::min(at + 4, bytes.len());
            bytes[at..end].copy_from_slice(&number.to_le_bytes()[..end - at]);
        }
        _ => {
            // Copies a range of the bytes over another range.
            let (from, length) = (random.index(bytes.len()), 1 + random.index(32));
            let length = usize::min(length, bytes.len() - usize::max(at, from));
            bytes.copy_within(from..from + length, at);
        }
    }
}

/// Loads a snapshot and steps the world. Returns whether the snapshot was accepted.
fn load_and_step(shapes: &[u8], state: &[u8]) -> bool {
    let mut world = World::new(WorldDef::default());
    functions::register(&mut world);
    world.load_shapes(&mut Reader::new(shapes)).expect("the saved shape library must load");
    let before = world.hash();
    if world.load(&mut Reader::new(state)).is_err() {
        assert_eq!(world.hash(), before, "a refused snapshot must not change the world");
        return false;
    }
    (0..STEPS).for_each(|_| world.step());
    true
}

#[test]
fn damaged_snapshots_are_refused_or_step() {
    let mut random = Random::new(57);
    let (mut taken, mut all) = (0, 0);
    let count = if std::env::var_os("SINEW_FULL").is_some() { DAMAGED } else { DAMAGED / 5 };
    for seed in 0..WORLDS {
        let (shapes, state) = saved(seed);
        assert!(load_and_step(&shapes, &state), "the undamaged snapshot must load");
        for number in 0..count {
            let mut bytes = state.clone();
            for _ in 0..1 + random.index(3) {
                if !bytes.is_empty() {
                    damage(&mut bytes, &mut random);
                }
            }
            let start = Instant::now();
            let outcome = caught(|| load_and_step(&shapes, &bytes));
            let time = start.elapsed();
            assert!(time < LONG, "world {seed}, damage {number}: loading took {time:?}");
            match outcome {
                Ok(was_taken) => taken += usize::from(was_taken),
                Err(text) => panic!("world {seed}, damage {number}: {text}"),
            }
            all += 1;
        }
    }
    eprintln!("{all} damaged snapshots, {taken} loaded");
}
