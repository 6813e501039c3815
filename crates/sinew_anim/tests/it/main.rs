//! Tests of the animation library against closed forms and known files.

mod cleanup;
mod ik;
mod learned_limits;
mod mocap;
mod pose;
mod retarget;
mod rigs;
mod roles;
mod sample;
mod skinning;
mod take;
mod toy;
