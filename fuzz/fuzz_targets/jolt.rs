//! Text object files of Jolt: a ragdoll, or refused with a location; an animation of three joints likewise.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_anim::{BuiltClip, ClipBuildOptions, Joint, LocalTransform, Rig};
use sinew_formats::{read_jolt_animation, read_jolt_ragdoll, read_ragdoll, write_ragdoll};

fuzz_target!(|bytes: &[u8]| {
    match read_jolt_ragdoll(bytes) {
        Err(error) => assert!(!error.what.is_empty() && !error.where_.is_empty(), "{error}"),
        Ok(ragdoll) => {
            assert_eq!(ragdoll.motors.len(), ragdoll.def.bodies.len());
            let _ = read_ragdoll(write_ragdoll(&ragdoll.def).as_bytes());
        }
    }
    let joint = |(source, name): (usize, &str)| Joint {
        name: name.to_owned(),
        parent: source.checked_sub(1),
        rest: LocalTransform::default(),
        source,
    };
    let names = ["LowerBody", "MidBody", "UpperBody"];
    let rig = Rig { joints: names.into_iter().enumerate().map(joint).collect(), ..Rig::default() };
    match read_jolt_animation(bytes, &rig) {
        Err(error) => assert!(!error.what.is_empty() && !error.where_.is_empty(), "{error}"),
        Ok(clip) => drop(BuiltClip::build(&clip, &rig, &ClipBuildOptions::default())),
    }
});
