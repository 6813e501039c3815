//! Random lives: worlds that are created and changed by random sequences of all public calls, and checked after each
//! step.
//!
//! A seed defines a life (`life.rs`): a sequence of deeds (`deeds/`), each of which calls the world with numbers that
//! are round, equal, at their bounds, zero, huge or arbitrary (`numbers.rs`). Several worlds run the same life
//! (`run.rs`): on one thread, on two, loaded from a snapshot into a new world, and cloned. All of them must return the
//! same answers and events, bit for bit. Each must pass the checks of `watch.rs`: no panic, finite numbers, one end for
//! every begin, touching shapes near each other, no body below the floor, no energy from nothing. A failing life is
//! reduced to few deeds (`shrink.rs`) and printed as Rust code (`code.rs`).
//!
//! 40 lives run, or ten minutes of lives if `SINEW_FULL` is set. `SINEW_LIVES=17..1000` runs the seeds of the range,
//! `SINEW_LIVES=17.. SINEW_MINUTES=20` the seeds from 17 on for 20 minutes: `SINEW_LIVES=0..1000 cargo test -p
//! sinew_physics --test lives -- --nocapture lives_hold`.
//!
//! All files except `deltas.rs`, `extension.rs`, `lies.rs`, `planted.rs` and `printed.rs` are also part of the ragdoll
//! crate's tests, where characters live next to the world (`extension.rs`).

#[macro_use]
mod actor;
mod code;
mod deeds;
mod deltas;
mod extension;
mod functions;
mod interface;
mod lies;
mod life;
mod numbers;
mod planted;
mod printed;
mod run;
mod search;
mod shrink;
mod watch;

use planted::Plant;

/// Seeds of a default test run: those below 50 whose lives take less than a second, and three that found faults.
const SOME: &[u64] = &[
    0, 1, 2, 4, 5, 6, 7, 8, 9, 11, 13, 14, 15, 16, 18, 19, 20, 21, 22, 24, 25, 26, 27, 29, 31, 32, 33, 34,
    35, 36, 37, 39, 40, 41, 42, 43, 44, 45, 46, 49, 2938, 3437, 4734,
];

#[test]
fn lives_hold_and_make_every_call() {
    search::search(SOME);
}

#[test]
#[ignore = "manual tool: prints, asserts nothing"]
fn shorten() {
    search::shorten(SOME);
}

#[test]
fn methods_are_read_from_the_sources() {
    let found = interface::methods();
    assert!(found.len() > 120, "{} methods", found.len());
    for name in ["add_body", "object_mut", "set_mover_walk", "save_shapes", "query", "hash"] {
        assert!(found.contains(name), "{name}");
    }
    assert!(!found.contains("expect_mut"), "private methods must not count as calls");
}

/// Injected faults, each with seeds of lives that find it quickly.
const FINDERS: [(Plant, &[u64]); 7] = [
    (Plant::ForgottenField, &[5, 12, 17, 68, 11]),
    (Plant::ThreadOrder, &[51, 66, 29, 18, 39]),
    (Plant::NotANumber, &[51, 29, 39, 69, 16]),
    (Plant::EventTwice, &[39, 69, 71, 37, 45]),
    (Plant::EndForgotten, &[51, 29, 5, 76, 77]),
    (Plant::EnergyFromNothing, &[66]),
    (Plant::ThroughTheFloor, &[66, 18, 34, 6, 37]),
];

/// Number of lives that are searched if none of the listed ones finds the fault any more.
const LIVES: u64 = 80;

#[test]
fn injected_faults_of_each_kind_are_found() {
    for (plant, seeds) in FINDERS {
        let finds = |seed: u64| !plant.found_in(seed..seed + 1).is_empty();
        let is_found = seeds.iter().copied().chain(0..LIVES).any(finds);
        assert!(is_found, "the injected fault {plant:?} is not found in {LIVES} lives");
    }
}

/// Prints the lives that find each injected fault, and their running times.
#[test]
#[ignore = "manual tool: prints, asserts nothing"]
fn finders() {
    std::thread::scope(|scope| {
        for plant in Plant::ALL {
            scope.spawn(move || println!("{plant:?}: {:?}", plant.found_in(0..LIVES)));
        }
    });
}
