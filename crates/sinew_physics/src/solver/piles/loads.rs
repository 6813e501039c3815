//! Guesses the loads of new contacts: level by level from the top, each body distributes its load over the bodies that
//! it stands on. Without guessed loads, a wall of a hundred rows sank by 0.15 m before the sweeps had found them.

use crate::solver::IslandSolver;
use crate::solver::body::SolverBody;
use crate::solver::piles::touch::Touch;
use crate::solver::tuning::STANDING_COSINE;
use core::cmp::Reverse;

/// A moving body while loads are distributed downward.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::solver) struct Bearer {
    /// Load and weight of the body, as an impulse of a substep, N·s.
    load: f32,
    /// Number of contacts on which the body stands.
    supports: u32,
    /// True if a contact of the body has a known load or a joint holds the body: the loads below are not guessed.
    is_settled: bool,
}

/// Work memory of the guess.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct Scratch {
    bearers: Vec<Bearer>,
    /// Level of the upper body and index of each supporting touch, from the top.
    supports: Vec<(Reverse<u32>, u32)>,
}

impl Scratch {
    pub fn make_room(&mut self, bodies: usize, contacts: usize) {
        self.bearers.clear();
        self.bearers.reserve(bodies);
        self.supports.clear();
        self.supports.reserve(contacts);
    }
}

/// Cosine between the force on a body and the direction from the body to a contact, which is the contact's normal times `−sign`.
fn slope(body: &SolverBody, touch: &Touch, sign: f32) -> f32 {
    -sign * touch.normal.dot(body.force) / body.force.length()
}

impl IslandSolver {
    /// Guesses the loads of new contacts between bodies at the start of a step.
    pub(in crate::solver) fn guess_loads(&mut self) {
        if !self.touches.iter().any(|touch| touch.is_new) {
            return;
        }
        let mut scratch = core::mem::take(&mut self.scratch.loads);
        self.list_bearers(&mut scratch.bearers);
        self.list_supports(&mut scratch);
        let Scratch { bearers, supports } = &mut scratch;
        for &(_, place) in &*supports {
            let (below, above, sign) = self.standing(place);
            let Bearer { load, supports, .. } = bearers[above as usize];
            let share = load / supports as f32;
            let touch = &mut self.touches[place as usize];
            touch.load = share / slope(&self.bodies[above as usize], touch, sign);
            if let Some(bearer) = bearers.get_mut(below as usize) {
                bearer.load += share;
            }
        }
        self.scratch.loads = scratch;
    }

    fn list_bearers(&self, bearers: &mut Vec<Bearer>) {
        bearers.clear();
        bearers.extend(self.bodies[..self.links.len()].iter().enumerate().map(|(i, body)| Bearer {
            load: body.force.length() * self.h,
            supports: 0,
            is_settled: self.is_jointed(i as u32),
        }));
        for touch in self.touches.iter().filter(|touch| touch.load > 0.0) {
            for body in touch.bodies {
                if let Some(bearer) = bearers.get_mut(body as usize) {
                    bearer.is_settled = true;
                }
            }
        }
    }

    fn list_supports(&self, Scratch { bearers, supports }: &mut Scratch) {
        supports.clear();
        for (place, touch) in (0..).zip(&self.touches).filter(|(_, touch)| touch.is_new) {
            let (below, above, sign) = self.standing(place);
            let [below, level] = [below, above].map(|body| self.support.of(body));
            let Some(bearer) = bearers.get_mut(above as usize) else { continue };
            if below.checked_add(1) == Some(level)
                && !bearer.is_settled
                && slope(&self.bodies[above as usize], touch, sign) > STANDING_COSINE
            {
                bearer.supports += 1;
                supports.push((Reverse(level), place));
            }
        }
        supports.sort_unstable();
    }

    /// Returns the body of a touch that is nearer to the ground, the other body, and 1 if the normal points to the
    /// other body, else −1.
    fn standing(&self, place: u32) -> (u32, u32, f32) {
        let [a, b] = self.touches[place as usize].bodies;
        if self.support.of(a) < self.support.of(b) { (a, b, 1.0) } else { (b, a, -1.0) }
    }
}
