//! Random lives with characters: the random lives of the physics crate (this test includes its files), with characters
//! beside the world (`extension.rs`) and random actions on them (`characters.rs`, `grips.rs`).
//!
//! All worlds of a life stay equal, and so do their characters: on one thread and on two, loaded into fresh worlds,
//! cloned. In addition to the checks of every world (`watch.rs`), poses are finite, no body of a character sinks
//! through the floor, limb speeds and joint gaps are bounded some time after the last action, and removed characters
//! leave nothing behind.
//!
//! A few lives, or ten minutes of them when `SINEW_FULL` is set. `SINEW_LIVES=17..1000` runs the seeds of the range:
//! `SINEW_LIVES=0..1000 cargo test --release -p sinew_ragdoll --test lives -- --nocapture lives_hold`.

#[macro_use]
#[path = "../../../sinew_physics/tests/lives/actor.rs"]
mod actor;
mod characters;
#[path = "../../../sinew_physics/tests/lives/code.rs"]
mod code;
#[path = "../../../sinew_physics/tests/lives/deeds/mod.rs"]
mod deeds;
mod extension;
#[path = "../../../sinew_physics/tests/lives/functions.rs"]
mod functions;
mod grips;
#[path = "../../../sinew_physics/tests/lives/interface.rs"]
mod interface;
#[path = "../../../sinew_physics/tests/lives/life.rs"]
mod life;
#[path = "../../../sinew_physics/tests/lives/numbers.rs"]
mod numbers;
#[path = "../../../sinew_physics/tests/lives/planted.rs"]
mod planted;
#[allow(dead_code, reason = "hashes are for the physics crate's own tests")]
#[path = "../../../sinew_physics/tests/lives/run.rs"]
mod run;
#[path = "../../../sinew_physics/tests/lives/search.rs"]
mod search;
#[path = "../../../sinew_physics/tests/lives/shrink.rs"]
mod shrink;
#[path = "../../../sinew_physics/tests/lives/watch.rs"]
mod watch;

use planted::Plant;

/// Seeds of a plain test run.
const SOME: &[u64] = &[1, 6, 9, 13, 14];

#[test]
fn lives_hold_and_make_every_call() {
    search::search(SOME);
}

#[test]
#[ignore = "a manual tool: prints, asserts nothing"]
fn shorten() {
    search::shorten(SOME);
}

#[test]
fn methods_are_read_from_the_sources() {
    let found = interface::methods();
    assert!(found.len() > 50, "{} methods", found.len());
    for name in ["Character::go_limp", "Character::detach", "Limb::despawn", "GrabPoint::take"] {
        assert!(found.contains(name), "{name}");
    }
}

/// Prints which lives find each injected fault, and after how many steps.
#[test]
#[ignore = "manual tool: prints, asserts nothing"]
fn finders() {
    for plant in Plant::ALL {
        println!("{plant:?}: {:?}", plant.found_in(0..20));
    }
}
