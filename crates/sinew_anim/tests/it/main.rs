//! Tests of the animation library against closed forms and known files.

mod pose;
mod sample;
mod skinning;
mod toy;
