//! The examples run, and what they assert holds.

#[path = "../../examples/active_ragdoll.rs"]
mod active_ragdoll;
#[path = "../../examples/door_and_cape.rs"]
mod door_and_cape;
#[path = "../../examples/flock.rs"]
mod flock;
#[path = "../../examples/pendulum_clock.rs"]
mod pendulum_clock;
#[path = "../../examples/player.rs"]
mod player;
#[path = "../../examples/probes.rs"]
mod probes;
#[path = "../../examples/rollback_fight.rs"]
mod rollback_fight;
#[path = "../../examples/shooter.rs"]
mod shooter;

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

#[test]
fn the_player_walks_rides_and_jumps() {
    player::main();
}

#[test]
fn the_target_flinches_and_falls() {
    shooter::main();
}

#[test]
fn the_active_ragdoll_stands_a_push() {
    active_ragdoll::main();
}

#[test]
fn the_walker_takes_its_cape_through_the_door() {
    door_and_cape::main();
}

#[test]
fn the_fight_is_the_same_with_news_that_come_late() {
    rollback_fight::main();
}
