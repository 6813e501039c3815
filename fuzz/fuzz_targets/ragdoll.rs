//! A ragdoll definition: refused with a location, or one that a world takes, and that is the same once written and read
//! again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_formats::{read_ragdoll, write_ragdoll};
use sinew_physics::{World, WorldDef};
use sinew_ragdoll::{BodySettings, BodyState, Ragdoll};

/// Bodies that a world is made of: more only take longer.
const MOST_BODIES: usize = 12;

fuzz_target!(|bytes: &[u8]| {
    let def = match read_ragdoll(bytes) {
        Err(error) => return assert!(!error.what.is_empty() && !error.where_.is_empty(), "{error}"),
        Ok(def) => def,
    };
    let written = write_ragdoll(&def);
    let again = read_ragdoll(written.as_bytes()).expect("what is written can be read");
    assert_eq!((def.bodies.len(), def.joints.len()), (again.bodies.len(), again.joints.len()));
    if def.bodies.len() <= MOST_BODIES {
        let mut world = World::new(WorldDef::default());
        let states: Vec<BodyState> = def
            .bodies
            .iter()
            .map(|body| BodyState { world_from_body: body.character_from_body, ..BodyState::default() })
            .collect();
        let ragdoll = Ragdoll::spawn(&mut world, &def, &states, &BodySettings::default());
        world.step();
        ragdoll.despawn(&mut world);
    }
});
