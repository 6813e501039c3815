//! The only module with `unsafe`: C and C++ functions of the engines, each library in a file, with safe interfaces.

#[cfg(feature = "box3d")]
pub mod box3d;
