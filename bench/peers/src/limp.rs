//! Cost of limp characters: each rig falls from random poses until it sleeps; compares the processor time with the simulated time.

use crate::measure::quantile;
use cpu_time::ProcessTime;
use serde_json::{Value, json};
use sinew::anim::analyze;
use sinew::math::{Random, Transform, Vec3};
use sinew::physics::{BodyDef, Shape, Velocity, World, WorldDef};
use sinew::ragdoll::{BodySettings, BodyState, BuildOptions, Ragdoll, RagdollDef, build};
use std::path::{Path, PathBuf};

/// Height of the lowest point above the floor at the start, metres.
const HEIGHT: f32 = 0.3;
/// Largest speed and spin at the start, m/s and rad/s.
const SPEED: f32 = 2.0;
const SPIN: f32 = 3.0;
/// Number of steps after which an unfinished fall is given up.
const MOST_STEPS: u32 = 1_200;

/// Runs `falls` falls of each file's character. Lists the files without a character or ragdoll, with the reason.
pub fn run(files: &[PathBuf], falls: u32) -> Value {
    let (mut factors, mut humanoids) = (Vec::new(), Vec::new());
    let characters: Vec<Value> = files
        .iter()
        .map(|file| match character(file) {
            Ok((def, humanoid)) => {
                let (factor, mut figures) = fall_often(file, &def, falls);
                factors.push(factor);
                humanoids.extend(humanoid.then_some(factor));
                figures["humanoid"] = json!(humanoid);
                figures
            }
            Err(reason) => json!({ "file": file, "refused": reason }),
        })
        .collect();
    let of = |factors: &[f64], share: f64| (!factors.is_empty()).then(|| quantile(factors, share));
    json!({
        "falls": falls,
        "realtime_factor": {
            "median": of(&factors, 0.5),
            "least": of(&factors, 0.0),
            "slowest_humanoid": of(&humanoids, 0.0),
        },
        "characters": characters,
    })
}

/// Returns the ragdoll of a file's character, and true if the character is a humanoid.
fn character(file: &Path) -> Result<(RagdollDef, bool), String> {
    let rig = sinew::load(file).map_err(|error| error.to_string())?.rig;
    let analysis = analyze(&rig).map_err(|error| error.to_string())?;
    let (def, _) = build(&rig, &analysis, &BuildOptions::default()).map_err(|error| error.to_string())?;
    Ok((def, analysis.humanoid))
}

/// Returns the simulated seconds per second of processor time, and the report.
fn fall_often(file: &Path, def: &RagdollDef, falls: u32) -> (f64, Value) {
    let (mut simulated, mut took, mut asleep) = (0.0, 0.0, 0);
    let mut random = Random::new(1);
    for _ in 0..falls {
        let (mut world, ragdoll) = release(def, &mut random);
        let start = ProcessTime::now();
        let mut steps = 0;
        while steps < MOST_STEPS && world.is_awake(ragdoll.bodies[0]) {
            world.step();
            steps += 1;
        }
        took += start.elapsed().as_secs_f64();
        simulated += f64::from(steps) * f64::from(world.def().dt());
        asleep += u32::from(steps < MOST_STEPS);
    }
    let factor = simulated / took;
    let each = |sum: f64| sum / f64::from(falls);
    let figures = json!({
        "file": file,
        "bodies": def.bodies.len(),
        "asleep": asleep,
        "seconds": each(simulated),
        "cpu_ms": 1e3 * each(took),
        "realtime_factor": factor,
    });
    (factor, figures)
}

/// Returns a world with a floor and the limp character above it, with random rotation and velocities.
fn release(def: &RagdollDef, random: &mut Random) -> (World, Ragdoll) {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let turned = Transform::new(Vec3::ZERO, random.rotation());
    let bounds = def.bodies.iter().map(|body| body.shape.aabb(&(turned * body.character_from_body)));
    let lowest = bounds.fold(f32::INFINITY, |lowest, bounds| f32::min(lowest, bounds.min.y));
    let placed = Transform::from_translation(Vec3::Y * (HEIGHT - lowest)) * turned;
    let (speed, spin) = (random.in_cube() * SPEED, random.in_cube() * SPIN);
    let middle = placed.point(def.bodies[0].character_from_body.translation);
    let state = |body: &sinew::ragdoll::RagdollBodyDef| {
        let world_from_body = placed * body.character_from_body;
        let arm = world_from_body.point(body.mass.center) - middle;
        BodyState { world_from_body, velocity: Velocity { linear: speed + spin.cross(arm), angular: spin } }
    };
    let states: Vec<BodyState> = def.bodies.iter().map(state).collect();
    let ragdoll = Ragdoll::spawn(&mut world, def, &states, &BodySettings::default());
    (world, ragdoll)
}
