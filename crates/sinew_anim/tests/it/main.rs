//! Compares the animation library with closed forms and known files.

mod allocations;
mod animators;
mod assembly;
mod blending;
mod built;
mod cleanup;
mod corrections;
mod creatures;
mod feeding;
mod hints;
mod ik;
mod learned_limits;
mod lost;
mod mocap;
mod playheads;
mod pose;
mod precise;
mod reduce;
mod retarget;
mod rigs;
mod roles;
mod root_motion;
mod sample;
mod saving;
mod sheets;
mod skinning;
mod spaces;
mod stage;
mod take;
mod toy;
mod transitions;
mod weights;
mod wild;

/// Number of random cases: all with `SINEW_FULL` set, otherwise a hundredth.
fn cases(all: u32) -> u32 {
    if std::env::var_os("SINEW_FULL").is_some() { all } else { all / 100 }
}
