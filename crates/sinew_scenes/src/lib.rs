//! Named scenarios and the embedded mannequin and cabin.
#![forbid(unsafe_code)]

pub mod cabin;
pub mod demo;
pub mod mannequin;
pub mod scenes;
