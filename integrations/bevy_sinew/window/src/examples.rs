//! The examples of the plugin; each has a `main` that runs it without a window.
#![allow(dead_code)]

#[path = "../../examples/character.rs"]
pub mod character;
#[path = "../../examples/crowd.rs"]
pub mod crowd;
#[path = "../../examples/door.rs"]
pub mod door;
#[path = "../../examples/hello.rs"]
pub mod hello;
#[path = "../../examples/shooter.rs"]
pub mod shooter;
