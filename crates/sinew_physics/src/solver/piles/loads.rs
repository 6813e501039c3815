//! Loads of contacts that do not know theirs yet: level by level from the top, each body shares what it bears among those that it
//! stands on. A wall of a hundred rows that began without them sank by 0.15 m before sweeps had found them.

use crate::solver::IslandSolver;
use crate::solver::body::SolverBody;
use crate::solver::piles::touch::Touch;
use crate::solver::tuning::STANDING_COSINE;
use core::cmp::Reverse;

/// A moving body, while loads are handed down.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::solver) struct Bearer {
    /// Load that it bears and weight of its own, as an impulse of a substep, N·s.
    load: f32,
    /// Contacts below that it stands on.
    supports: u32,
    /// A contact of it knows its load, or a joint holds it: nothing is to be guessed of what is below.
    is_settled: bool,
}

/// Memory for handing down.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct Scratch {
    bearers: Vec<Bearer>,
    /// Level of the upper body and place of each touch that supports one, from the top.
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

/// Cosine between what pulls at a body and the way from it through a contact, whose normal leads to it times `sign`.
fn slope(body: &SolverBody, touch: &Touch, sign: f32) -> f32 {
    -sign * touch.normal.dot(body.force) / body.force.length()
}

impl IslandSolver {
    /// Gives contacts between bodies that know nothing of their loads what stands on them, when a step begins.
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

    /// Body of a touch that is nearer to what cannot move, the other one, and 1 if the normal leads to that one, else -1.
    fn standing(&self, place: u32) -> (u32, u32, f32) {
        let [a, b] = self.touches[place as usize].bodies;
        if self.support.of(a) < self.support.of(b) { (a, b, 1.0) } else { (b, a, -1.0) }
    }
}
