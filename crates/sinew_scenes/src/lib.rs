//! Named scenarios and the embedded mannequin and cabin.
#![forbid(unsafe_code)]

pub mod blueprint;
pub mod cabin;
pub mod crowd;
pub mod demo;
pub mod dressed;
pub mod fallen;
mod framework;
pub mod maned;
pub mod played;
pub mod recording;
pub mod skirted;
pub mod staged;
pub use sinew::mannequin;
mod parts;
pub mod scenes;
pub mod walks;
