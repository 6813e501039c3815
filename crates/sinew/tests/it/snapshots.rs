//! Measures the costs of snapshots:
//! `cargo test --release -p sinew --test it -- --ignored --nocapture cost_of_snapshots`.
//!
//! Prints a table with the bytes of a snapshot, and of its delta from the previous step's; microseconds to save, load
//! and clone a world and to make and apply a delta; milliseconds to go back eight ticks and repeat them.

use sinew::physics::Snapshot;
use sinew::prelude::*;
use std::sync::Arc;
use std::time::Instant;

/// Number of ticks that a rollback repeats.
const TICKS: usize = 8;

/// A world with its characters.
struct Match {
    world: World,
    characters: Vec<Character>,
}

impl Match {
    fn of(world: World) -> Self {
        Self { world, characters: Vec::new() }
    }

    fn tick(&mut self) {
        self.world.step();
        self.characters.iter_mut().for_each(|character| character.update(&mut self.world));
    }

    fn save(&self) -> Snapshot {
        let mut out = Writer::new();
        self.world.save(&mut out);
        self.characters.iter().for_each(|character| character.save(&mut out));
        Snapshot::from_bytes(out.into_bytes())
    }

    fn load(&mut self, snapshot: &Snapshot) {
        let mut bytes = Reader::new(snapshot.as_bytes());
        self.world.load(&mut bytes).expect("the saved state can be loaded");
        self.characters
            .iter_mut()
            .for_each(|one| one.load(&mut bytes).expect("the saved state can be loaded"));
    }
}

/// Makes separate boxes that fall, or lie on the ground asleep.
fn boxes(count: usize, height: f32, steps: usize) -> Match {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    for i in 0..count {
        let at = Vec3::new((i % 20) as f32, height, (i / 20) as f32);
        world.add_body(&BodyDef::dynamic(Shape::cuboid(Vec3::splat(0.25))).at(at));
    }
    (0..steps).for_each(|_| world.step());
    Match::of(world)
}

/// Makes walls of boxes with contacts.
fn walls(count: usize) -> Match {
    let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    for i in 0..count {
        let at = Vec3::new((i / 5) as f32 * 0.51, 0.25 + (i % 5) as f32 * 0.5, 0.0);
        world.add_body(&BodyDef::dynamic(Shape::cuboid(Vec3::splat(0.25))).at(at));
    }
    (0..60).for_each(|_| world.step());
    Match::of(world)
}

/// Makes characters that play a clip, or have just been knocked down.
fn characters(count: usize, falling: bool) -> Match {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let def = Arc::new(sinew::mannequin::character());
    let place =
        |i: usize| Transform::from_translation(Vec3::new((i % 10) as f32 * 2.0, 0.0, (i / 10) as f32 * 2.0));
    let all = (0..count).map(|i| Character::spawn(&mut world, &def, place(i))).collect();
    let mut them = Match { world, characters: all };
    (0..10).for_each(|_| them.tick());
    if falling {
        let Match { world, characters } = &mut them;
        characters.iter_mut().for_each(|one| _ = one.hit(world, 2, Vec3::new(250.0, 0.0, 30.0)));
        (0..20).for_each(|_| them.tick());
    }
    them
}

/// Returns the median duration of a call, microseconds.
fn median(times: usize, mut call: impl FnMut()) -> f64 {
    let mut all: Vec<f64> = (0..times)
        .map(|_| {
            let start = Instant::now();
            call();
            start.elapsed().as_secs_f64() * 1e6
        })
        .collect();
    all.sort_unstable_by(f64::total_cmp);
    all[all.len() / 2]
}

fn row(name: &str, mut it: Match, times: usize) {
    it.tick();
    let earlier = it.save();
    it.tick();
    let later = it.save();
    let delta = later.delta(&earlier);
    let save = median(times, || _ = it.save());
    let load = median(times, || it.load(&later));
    let clone = median(times, || _ = it.world.clone());
    let make = median(times, || _ = later.delta(&earlier));
    let take = median(times, || _ = Snapshot::from_delta(&earlier, &delta));
    assert_eq!(Snapshot::from_delta(&earlier, &delta).as_ref(), Ok(&later));
    let again = median(times.div_ceil(4), || {
        it.load(&later);
        (0..TICKS).for_each(|_| it.tick());
    });
    let (bodies, contacts) = (it.world.body_ids().count() - 1, it.world.contacts().count());
    let of_body = later.as_bytes().len() / usize::max(bodies, 1);
    println!(
        "| {name} | {bodies} | {contacts} | {} | {of_body} | {} | {save:.0} | {load:.0} | {clone:.0} | {make:.0} | {take:.0} | {:.2} |",
        later.as_bytes().len(),
        delta.len(),
        again / 1e3
    );
}

/// Prints the table; each value is the median of `times` runs.
fn table(times: usize, counts: &[usize]) {
    println!(
        "| world | bodies | contacts | bytes | per body | delta, bytes | save, µs | load, µs | clone, µs | delta, µs | its snapshot, µs | 8 ticks again, ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    row("200 boxes that fall", boxes(200, 60.0, 0), times);
    row("200 boxes asleep", boxes(200, 0.25, 120), times);
    row("200 boxes in a wall", walls(200), times);
    for &count in counts {
        row(&format!("{count} characters that stand"), characters(count, false), times);
        row(&format!("{count} characters that fall"), characters(count, true), times);
    }
}

#[test]
fn deltas_restore_their_snapshots() {
    table(1, &[2]);
}

#[test]
#[ignore = "for people: prints, asserts nothing"]
fn cost_of_snapshots() {
    table(41, &[2, 8, 100]);
}
