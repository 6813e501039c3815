//! The state of a character, with the data of that state.

use super::get_up::Rising;
use super::limp::{Lying, Stillness};
use super::prepare::Preparing;
use super::stumble::{Balance, Stumble};
use super::{CharacterDef, State};
use crate::character::tuning::{FLINCH_HALF_LIFE, FLINCH_TIME, RETURNED_AFTER};
use sinew_anim::Animator;
use sinew_math::{clamp, max};

/// State of a character and the data of this state. [`State`] is the same without data.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Activity {
    Animated,
    Flinching(Flinch),
    Powered(Balance),
    Limp(Lying),
    Preparing(Preparing),
    GettingUp(Rising),
}

impl Activity {
    pub fn state(&self) -> State {
        match self {
            Self::Animated => State::Animated,
            Self::Flinching(_) => State::Flinching,
            Self::Powered(_) => State::Powered,
            Self::Limp(_) => State::Limp,
            Self::Preparing(_) => State::Preparing,
            Self::GettingUp(_) => State::GettingUp,
        }
    }

    /// Returns the current stumble, if any.
    pub fn stumble(&self) -> Option<&Stumble> {
        match self {
            Self::Powered(balance) => balance.stumble.as_ref(),
            _ => None,
        }
    }

    /// Returns the time for which a limp or preparing character has lain; `None` in other states.
    pub fn stillness(&self) -> Option<&Stillness> {
        match self {
            Self::Limp(lying) => Some(&lying.stillness),
            Self::Preparing(preparing) => Some(&preparing.stillness),
            _ => None,
        }
    }

    /// Returns [`stillness`](Self::stillness), mutable.
    pub fn stillness_mut(&mut self) -> Option<&mut Stillness> {
        match self {
            Self::Limp(lying) => Some(&mut lying.stillness),
            Self::Preparing(preparing) => Some(&mut preparing.stillness),
            _ => None,
        }
    }

    /// Returns true for a limp character that is being moved out of a wall.
    pub fn is_clearing(&self) -> bool {
        matches!(self, Self::Limp(lying) if !lying.clearing.velocities.is_empty())
    }

    /// Returns the remaining share of a get-up until the character stands upright: 1 and more while it lies, 0 and less
    /// once it stands. 0 in all other states.
    pub fn left_to_rise(&self, def: &CharacterDef, animator: &Animator) -> f32 {
        match self {
            Self::GettingUp(rising) => rising.left(def, animator),
            _ => 0.0,
        }
    }

    /// Returns how near to the ground the body is: 1 for a body that lies, 0 for one that stands upright.
    pub fn lowness(&self, def: &CharacterDef, animator: &Animator) -> f32 {
        match self {
            Self::Limp(_) | Self::Preparing(_) => 1.0,
            Self::GettingUp(rising) => clamp(rising.left(def, animator), 0.0, 1.0),
            Self::Animated | Self::Flinching(_) | Self::Powered(_) => 0.0,
        }
    }
}

/// Flinch of a character after a hit on a limb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Flinch {
    /// Seconds until the limb has returned.
    pub seconds: f32,
}

/// Returns the time that a struck limb takes to return to its clips, seconds.
fn comes_back() -> f32 {
    RETURNED_AFTER * FLINCH_HALF_LIFE
}

impl Flinch {
    /// Creates the flinch of a limb that was struck in this step.
    pub fn begun() -> Self {
        Self { seconds: FLINCH_TIME + comes_back() }
    }

    /// Keeps the limb weak while a hand or joint holds it.
    pub fn go_on(&mut self) {
        self.seconds = max(self.seconds, Self::begun().seconds);
    }

    /// Advances the flinch; returns true in the step in which the limb begins to return.
    pub fn turns_back(&mut self, dt: f32) -> bool {
        let before = self.seconds;
        self.seconds -= dt;
        before > comes_back() && self.seconds <= comes_back()
    }
}
