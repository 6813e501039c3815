//! Runs the examples; their assertions must hold.

mod loaded;

#[path = "../../examples/active_ragdoll.rs"]
mod active_ragdoll;
#[path = "../../examples/character_get_up.rs"]
mod character_get_up;
#[path = "../../examples/door.rs"]
mod door;
#[path = "../../examples/door_and_cape.rs"]
mod door_and_cape;
#[path = "../../examples/events.rs"]
mod events;
#[path = "../../examples/flock.rs"]
mod flock;
#[path = "../../examples/hello_box.rs"]
mod hello_box;
#[path = "../../examples/level.rs"]
mod level;
#[path = "../../examples/pendulum_clock.rs"]
mod pendulum_clock;
#[path = "../../examples/player.rs"]
mod player;
#[path = "../../examples/probes.rs"]
mod probes;
#[path = "../../examples/ragdoll_from_file.rs"]
mod ragdoll_from_file;
#[path = "../../examples/rewind.rs"]
mod rewind;
#[path = "../../examples/rollback_fight.rs"]
mod rollback_fight;
#[path = "../../examples/rope.rs"]
mod rope;
#[path = "../../examples/shooter.rs"]
mod shooter;
mod snapshots;
#[path = "../../examples/stack.rs"]
mod stack;
#[path = "../../examples/stairs.rs"]
mod stairs;
#[path = "../../examples/threads.rs"]
mod threads;
#[path = "../../examples/wind.rs"]
mod wind;
#[expect(dead_code, reason = "its main reads the command line")]
#[path = "../../examples/your_character.rs"]
mod your_character;

mod motions;
mod pictures;
mod prelude;

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
fn the_walker_goes_up_stairs_and_down_a_ramp() {
    stairs::main();
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

#[test]
fn the_walker_is_struck_and_gets_up() {
    character_get_up::main();
}

#[test]
fn the_door_opens_and_closes() {
    door::main();
}

#[test]
fn everything_tells_of_the_ball_once() {
    events::main();
}

#[test]
fn the_box_falls_and_sleeps() {
    hello_box::main();
}

#[test]
fn the_ball_rolls_into_the_bowl() {
    level::main();
}

#[test]
fn the_ragdoll_falls_and_holds_together() {
    ragdoll_from_file::main();
}

#[test]
fn time_goes_the_same_way_again() {
    rewind::main();
}

#[test]
fn the_load_swings_on_its_rope() {
    rope::main();
}

#[test]
fn the_tower_stands_and_falls() {
    stack::main();
}

#[test]
fn threads_change_no_bit() {
    threads::main();
}

#[test]
fn wind_water_and_bombs_act() {
    wind::main();
}
