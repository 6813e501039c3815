//! The only place with `unsafe`: what the engines need of C and C++ libraries, each a file, safe to call from outside.

#[cfg(feature = "box3d")]
pub mod box3d;
