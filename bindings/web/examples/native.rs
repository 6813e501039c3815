//! Prints hashes and times of the native library as JSON, for the scenes of `tests/scenes.mjs`, which compares the package with them.
//! Arguments: the folder of rigs, their names, and `--measure` for times.

use sinew::formats::{ReadOptions, no_files, read_gltf, write_gltf};
use sinew::prelude::*;
use sinew::ragdoll::Settings;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Impulse of a hard shove toward +Z, N·s.
const SHOVE: f32 = 120.0;

fn ground() -> World {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    world
}

fn def(bytes: &[u8], name: &str) -> Result<Arc<CharacterDef>, String> {
    let document = read_gltf(bytes, ReadOptions::default(), &mut no_files).map_err(|e| e.to_string())?;
    let loaded = sinew::character_of(document, name, &Settings::default()).map_err(|e| e.to_string())?;
    Ok(Arc::new(loaded.def))
}

fn step(world: &mut World, characters: &mut [Character], count: u32) {
    for _ in 0..count {
        world.step();
        characters.iter_mut().for_each(|one| one.update(world));
    }
}

/// Simulates two copies of a character, one shoved after a second; returns the hash after ten seconds.
fn fall(def: &Arc<CharacterDef>) -> u64 {
    let mut world = ground();
    let place = |x: f32| Transform::from_translation(Vec3::new(x, 0.0, 0.0));
    let mut both = [0.0, 1.5].map(|x| Character::spawn(&mut world, def, place(x)));
    step(&mut world, &mut both, 60);
    both[0].hit(&mut world, 0, Vec3::Z * SHOVE);
    step(&mut world, &mut both, 540);
    world.hash()
}

/// Simulates a wall of boxes, a thrown ball and a hanging chain; returns the hash after ten seconds.
fn boxes() -> u64 {
    let mut world = ground();
    let cube = Shape::cuboid(Vec3::new(0.25, 0.25, 0.25));
    for i in 0..20 {
        let (column, row) = ((i % 5) as f32, (i / 5) as f32);
        world.add_body(&BodyDef::dynamic(cube.clone()).at(Vec3::new(
            0.5 * column - 1.0,
            0.25 + 0.5 * row,
            0.0,
        )));
    }
    let ball = BodyDef::dynamic(Shape::sphere(0.25)).at(Vec3::new(0.0, 1.0, 4.0));
    world.add_body(&BodyDef { linear_velocity: Vec3::new(0.0, 2.0, -8.0), ..ball });
    let mut above = world.add_body(&BodyDef::fixed(cube).at(Vec3::new(3.0, 3.0, 0.0)));
    for i in 1..=5 {
        let link = BodyDef::dynamic(Shape::capsule(0.1, 0.05)).at(Vec3::new(3.0 + 0.5 * i as f32, 3.0, 0.0));
        let link = world.add_body(&link);
        world.add_ball(above, link, Vec3::new(2.75 + 0.5 * i as f32, 3.0, 0.0));
        above = link;
    }
    (0..600).for_each(|_| world.step());
    world.hash()
}

/// Milliseconds per step of a limp character, and of 30 walking and 10 falling ones: the best of several rounds, because other programs may
/// run.
fn times(def: &Arc<CharacterDef>) -> [f64; 2] {
    let mut limp = Vec::new();
    for _ in 0..9 {
        let mut world = ground();
        let mut one = [Character::spawn(&mut world, def, Transform::IDENTITY)];
        step(&mut world, &mut one, 1);
        one[0].go_limp(&mut world);
        let start = Instant::now();
        step(&mut world, &mut one, 120);
        limp.push(start.elapsed().as_secs_f64() * 1e3 / 120.0);
    }
    let mut crowd = Vec::new();
    for _ in 0..5 {
        let mut world = ground();
        let place = |i: usize| {
            Transform::from_translation(Vec3::new((i % 8) as f32 * 1.5, 0.0, (i / 8) as f32 * 1.5))
        };
        let mut all: Vec<Character> = (0..40).map(|i| Character::spawn(&mut world, def, place(i))).collect();
        step(&mut world, &mut all, 10);
        for one in all.iter_mut().step_by(4) {
            one.go_limp(&mut world);
        }
        let start = Instant::now();
        step(&mut world, &mut all, 90);
        crowd.push(start.elapsed().as_secs_f64() * 1e3 / 90.0);
    }
    [limp, crowd].map(|rounds| rounds.into_iter().fold(f64::INFINITY, f64::min))
}

fn main() -> Result<(), String> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("no folder of rigs")?;
    let mut names: Vec<String> = arguments.collect();
    let measures = names.iter().position(|name| name == "--measure").map(|at| names.remove(at)).is_some();
    let mannequin = sinew::mannequin::mannequin();
    let bytes = write_gltf(&mannequin.rig, &mannequin.clips).map_err(|error| error.to_string())?;
    let mut files = vec![("mannequin".to_owned(), bytes)];
    files.extend(names.into_iter().filter_map(|name| {
        let bytes = std::fs::read(Path::new(&folder).join(&name)).ok()?;
        Some((name, bytes))
    }));
    let mut rows = vec![format!("\"boxes\": \"{:016x}\"", boxes())];
    let mut timed = Vec::new();
    for (name, bytes) in &files {
        let def = def(bytes, name)?;
        rows.push(format!("{name:?}: \"{:016x}\"", fall(&def)));
        if measures {
            let [limp, crowd] = times(&def);
            timed.push(format!("{name:?}: {{\"limp\": {limp}, \"crowd\": {crowd}}}"));
        }
    }
    println!("{{\"hashes\": {{{}}}, \"times\": {{{}}}}}", rows.join(", "), timed.join(", "));
    Ok(())
}
