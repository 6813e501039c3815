//! Runs the same scenes on Sinew and on other engines, and measures time and quality with one tool.
#![deny(unsafe_code)] // `ffi` alone allows it
// ozz-animation-rs returns vectors of `std::simd`.
#![cfg_attr(feature = "ozz", feature(portable_simd))]

pub mod engine;
pub mod engines;
mod ffi;
pub mod limp;
pub mod measure;
pub mod mjcf;
mod parry;
pub mod quality;
pub mod resume;
pub mod run;
pub mod scenes;
pub mod trace;
pub mod walks;
