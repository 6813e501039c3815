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
fn flock_forms_and_stays_in_its_aviary() {
    flock::main();
}

#[test]
fn pendulum_clock_has_the_theoretical_period() {
    pendulum_clock::main();
}

#[test]
fn each_query_gives_the_expected_result() {
    probes::main();
}

#[test]
fn player_walks_rides_and_jumps() {
    player::main();
}

#[test]
fn walker_climbs_stairs_and_descends_a_ramp() {
    stairs::main();
}

#[test]
fn target_flinches_and_falls() {
    shooter::main();
}

#[test]
fn active_ragdoll_recovers_from_a_light_push() {
    active_ragdoll::main();
}

#[test]
fn walker_with_a_cape_passes_the_door() {
    door_and_cape::main();
}

#[test]
fn fight_has_the_same_bits_with_late_inputs() {
    rollback_fight::main();
}

#[test]
fn struck_walker_falls_and_gets_up() {
    character_get_up::main();
}

#[test]
fn door_opens_and_closes() {
    door::main();
}

#[test]
fn sensor_and_wall_report_one_event_each() {
    events::main();
}

#[test]
fn box_falls_and_sleeps() {
    hello_box::main();
}

#[test]
fn stone_rolls_into_the_bowl() {
    level::main();
}

#[test]
fn ragdoll_falls_and_its_joints_hold() {
    ragdoll_from_file::main();
}

#[test]
fn rewound_world_takes_the_same_steps() {
    rewind::main();
}

#[test]
fn load_swings_on_its_rope() {
    rope::main();
}

#[test]
fn tower_stands_until_it_is_hit() {
    stack::main();
}

#[test]
fn thread_count_does_not_change_the_bits() {
    threads::main();
}

#[test]
fn wind_water_and_bombs_act() {
    wind::main();
}
