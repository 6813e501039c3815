//! The examples run, and what they assert holds.

#[path = "../../examples/flock.rs"]
mod flock;
#[path = "../../examples/pendulum_clock.rs"]
mod pendulum_clock;
#[path = "../../examples/probes.rs"]
mod probes;

mod motions;

#[test]
fn the_flock_flies() {
    flock::main();
}

#[test]
fn the_clock_keeps_time() {
    pendulum_clock::main();
}

#[test]
fn the_questions_are_answered() {
    probes::main();
}
