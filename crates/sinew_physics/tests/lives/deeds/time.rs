//! Deeds that advance time or save and restore the state: frames, snapshots, copies.

use super::Deed;
use crate::actor::{Actor, Twin};
use crate::functions;
use crate::numbers::Numbers;
use core::time::Duration;
use sinew_physics::*;

pub const ALL: &[Deed] = &[
    Deed::new("update", 1, update),
    Deed::new("update_with", 1, update_with),
    Deed::new("reload", 1, reload),
    Deed::new("stranger", 2, stranger),
    Deed::new("clone", 1, clone),
    Deed::new("mark_and_reset", 1, mark_and_reset),
];

/// Returns a frame time of at most one step.
fn frame(a: &Actor, n: &mut Numbers) -> Duration {
    let length = a.world.def().step_nanoseconds;
    Duration::from_nanos(n.one_of(&[0, length / 2, length]))
}

fn update(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let time = frame(a, n);
    a.line(format!("world.update(core::time::Duration::from_nanos({}));", time.as_nanos()));
    a.count("update");
    let told = a.world.update(time);
    crate::actor::say(&mut a.said, "update", &told);
    Some(())
}

fn update_with(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let time = frame(a, n);
    a.line(format!("world.update_with(core::time::Duration::from_nanos({}), World::step);", time.as_nanos()));
    a.count("update_with");
    let told = a.world.update_with(time, World::step);
    crate::actor::say(&mut a.said, "update_with", &told);
    Some(())
}

/// Makes the world load its own snapshot.
fn reload(a: &mut Actor, _: &mut Numbers) -> Option<()> {
    crate::actor::reload(&mut a.world);
    ["save", "load", "save_shapes", "load_shapes"].into_iter().for_each(|name| a.count(name));
    a.line("reload(&mut world);".to_owned());
    functions::register(&mut a.world);
    let registered = ["register_pair_function", "register_modifier", "register_field", "register_kind"];
    registered.into_iter().for_each(|name| a.count(name));
    Some(())
}

fn stranger(a: &mut Actor, _: &mut Numbers) -> Option<()> {
    a.wanted = Some(Twin::Stranger);
    Some(())
}

fn clone(a: &mut Actor, _: &mut Numbers) -> Option<()> {
    a.wanted = Some(Twin::Clone);
    Some(())
}

/// Marks the state, takes some steps, and resets the world to the mark.
fn mark_and_reset(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let steps = 1 + n.index(8);
    ["mark", "reset", "hash"].into_iter().for_each(|name| a.count(name));
    let hash = a.world.hash();
    a.world.mark();
    (0..steps).for_each(|_| a.world.step());
    a.world.reset();
    assert_eq!(a.world.hash(), hash, "a reset must restore the marked world");
    a.line(format!("world.mark();\n    (0..{steps}).for_each(|_| world.step());\n    world.reset();"));
    Some(())
}
