//! Runs of Sinew that start from a saved state, to compare two builds by times or by counts of instructions.

use crate::measure::StepTimes;
use crate::run::Start;
use crate::scenes::{Scene, Work};
use serde_json::{Value, json};
use sinew::math::{Reader, Writer};
use sinew::physics::{World, WorldDef};
use std::fs;
use std::path::Path;

/// Writes the state of a scene after this many steps to a file.
///
/// # Errors
/// If the scene has no bodies, or the file cannot be written; as text.
pub fn save(scene: &Scene, start: Start, steps: u32, to: &Path) -> Result<Value, String> {
    let Work::Bodies(blueprint) = start.of((scene.work)()) else {
        return Err(format!("{} is not a scene of bodies", scene.name));
    };
    let (mut world, ..) = blueprint.build();
    (0..steps).for_each(|_| world.step());
    let mut state = Writer::new();
    world.save(&mut state);
    fs::write(to, state.into_bytes()).map_err(|error| format!("{}: {error}", to.display()))?;
    Ok(json!({ "scene": scene.name, "steps": steps, "hash": format!("{:016x}", world.hash()) }))
}

/// Continues from a saved state for this many steps.
///
/// # Errors
/// If the file cannot be read or is not a state of this version; as text.
pub fn resume(from: &Path, steps: u32) -> Result<Value, String> {
    let named = |error: &dyn core::fmt::Display| format!("{}: {error}", from.display());
    let state = fs::read(from).map_err(|error| named(&error))?;
    let mut world = World::new(WorldDef::default());
    world.load(&mut Reader::new(&state)).map_err(|error| named(&error))?;
    let times = StepTimes::measure(steps as usize, |_| world.step());
    Ok(json!({ "steps": steps, "cpu_ms": times.to_json(), "hash": format!("{:016x}", world.hash()) }))
}
