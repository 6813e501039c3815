//! Equal random walks by our mover and by Rapier's controller: depth, blocked steps, climbed steps, time.

use crate::measure::quantile;
use cpu_time::ProcessTime;
use serde_json::{Value, json};
use sinew::formats::{TriangleMesh, load_mesh};
use sinew::math::{Random, Rotation, Vec3};
use sinew_scenes::walks::{Ours, Tally, Terrain, Walker};
use std::path::Path;

/// Number of walks with the same seed and clutter.
const SHARE: usize = 20;
/// Clearance around a capsule that counts as free space, metres: more than the 18 mm that Rapier's controller keeps by default.
const MARGIN: f32 = 0.025;
/// Heights of treads, metres, all below the height that a capsule climbs, and speeds of walking onto them, m/s.
const TREADS: [f32; 6] = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3];
const SPEEDS: [f32; 4] = [1.0, 2.0, 4.0, 6.0];
/// Angles between direction and tread, radians.
const SKEWS: [f32; 3] = [0.0, 0.5, 1.0];

/// Function that creates a walker with its feet on a terrain.
type Maker = fn(&Terrain, Vec3) -> Box<dyn Walker>;

fn ours(on: &Terrain, feet: Vec3) -> Box<dyn Walker> {
    Box::new(Ours::new(on.build(), feet))
}

/// Walkers of this build, by name.
const WALKERS: &[(&str, Maker)] = &[
    ("sinew", ours),
    #[cfg(feature = "rapier")]
    ("rapier", crate::engines::rapier::walker),
];

/// A walker whose moves are timed.
struct Timed {
    walker: Box<dyn Walker>,
    microseconds: Vec<f64>,
}

impl Walker for Timed {
    fn feet(&self) -> Vec3 {
        self.walker.feet()
    }

    fn is_grounded(&self) -> bool {
        self.walker.is_grounded()
    }

    fn step(&mut self, wish: Vec3) {
        let start = ProcessTime::now();
        self.walker.step(wish);
        self.microseconds.push(start.elapsed().as_secs_f64() * 1e6);
    }
}

/// Runs random walks, `count` on each terrain, and treads, with all walkers of this build. `worlds` is a folder with `house_2story_stairs.glb`
/// and `kaykit_dungeon`; missing ones are left out.
///
/// # Errors
/// If a file exists and cannot be read.
pub fn run(count: usize, worlds: &Path) -> Result<Value, sinew::formats::Error> {
    let terrains = terrains(worlds)?;
    let mut rows = Vec::new();
    for &(name, maker) in WALKERS {
        for (ground, terrain) in &terrains {
            rows.push(walks(name, maker, ground, terrain.as_ref(), count));
        }
        rows.push(treads(name, maker));
    }
    Ok(json!({ "walks": rows }))
}

/// Returns terrains by name; the clutter differs for each seed.
fn terrains(worlds: &Path) -> Result<Vec<(&'static str, Option<Terrain>)>, sinew::formats::Error> {
    let load = |name: &str, scale: f32| -> Result<Option<TriangleMesh>, sinew::formats::Error> {
        let path = worlds.join(name);
        if !path.is_file() {
            return Ok(None);
        }
        let mut mesh = load_mesh(&path)?;
        mesh.positions.iter_mut().for_each(|p| *p *= scale);
        Ok(Some(mesh))
    };
    let mut terrains = vec![("cabin", Some(Terrain::cabin())), ("clutter", None)];
    if let Some(house) = load("house_2story_stairs.glb", 3.0)? {
        terrains.push(("house", Some(Terrain::house(&house))));
    }
    let (stairs, wall) = (load("kaykit_dungeon/stairs.obj", 1.0)?, load("kaykit_dungeon/wall.obj", 1.0)?);
    if let (Some(stairs), Some(wall)) = (stairs, wall) {
        terrains.push(("dungeon", Some(Terrain::dungeon(&stairs, &wall))));
    }
    Ok(terrains)
}

fn walks(name: &str, maker: Maker, ground: &str, terrain: Option<&Terrain>, count: usize) -> Value {
    let mut tally = Tally { margin: MARGIN, ..Tally::default() };
    let mut times = Vec::new();
    for walk in 0..count {
        let (seed, walk) = ((walk / SHARE) as u64, walk % SHARE);
        let own = terrain.is_none().then(|| Terrain::clutter(seed));
        let on = terrain.or(own.as_ref()).expect("one of the two");
        let mut random = Random::new(1_000 * seed + walk as u64);
        let feet = on.free_place(&mut random);
        let mut walker = Timed { walker: maker(on, feet), microseconds: Vec::new() };
        let fast = if walk % 2 == 0 { 5.0 } else { 50.0 };
        tally.walk(on, &mut walker, &format!("seed {seed}, walk {walk}"), fast, &mut random);
        times.append(&mut walker.microseconds);
    }
    json!({
        "walker": name,
        "ground": ground,
        "walks": tally.walks,
        "deepest_m": tally.deepest,
        "inside_share": tally.inside as f64 / tally.steps.max(1) as f64,
        "through": tally.through,
        "floods": tally.floods,
        "stuck": tally.stuck,
        "step_us": { "median": quantile(&times, 0.5), "p99": quantile(&times, 0.99) },
        "wrong": tally.wrong.iter().take(3).collect::<Vec<_>>(),
    })
}

/// Walks onto treads at all speeds and angles; a tread counts as climbed if the capsule stands on it after two seconds.
fn treads(name: &str, maker: Maker) -> Value {
    let (mut offered, mut climbed, mut missed) = (0, 0, Vec::new());
    for height in TREADS {
        let on = Terrain::tread(height);
        for speed in SPEEDS {
            for skew in SKEWS {
                let way = Rotation::from_axis_angle(Vec3::Y, skew) * Vec3::X;
                let mut walker = maker(&on, Vec3::new(-0.6, 0.005, 0.0));
                (0..30).for_each(|_| walker.step(Vec3::ZERO));
                // Two metres of walking, and a second to come to rest.
                let steps = (2.0 / (speed * way.x) * 60.0) as usize + 30;
                (0..steps).for_each(|_| walker.step(way * speed));
                (0..30).for_each(|_| walker.step(Vec3::ZERO));
                offered += 1;
                if (walker.feet().y - height).abs() < 0.03 && walker.is_grounded() {
                    climbed += 1;
                } else {
                    missed.push(format!("{height} m at {speed} m/s, {skew} rad: {}", walker.feet()));
                }
            }
        }
    }
    missed.truncate(5);
    json!({ "walker": name, "ground": "treads", "offered": offered, "climbed": climbed, "missed": missed })
}
