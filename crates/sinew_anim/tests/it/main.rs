//! Tests of the animation library against closed forms and known files.

mod pose;
mod rigs;
mod roles;
mod sample;
mod skinning;
mod toy;
