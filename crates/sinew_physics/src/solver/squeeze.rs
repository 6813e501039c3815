//! Bodies between others that press on them with far more than they weigh.
//!
//! In 32 bits an ulp of the impulses on such a body, over its mass, may be more than any speed that it could have: under a
//! tower of ten cubes, each ten times as heavy as the one that it stands on, 4 m/s. What presses from both sides gives it
//! ballast: it answers to forces and impulses as if it were heavier, for as long as they press. That changes neither its weight
//! nor what hits it from one side alone.

use super::IslandSolver;
use crate::contact::Contact;
use sinew_math::{Vec3, max};

/// Least mass of a body per impulse that cancels itself on it in a substep, kg/(N·s): what bears less than 4,000 times its
/// weight has no ballast, and an ulp of that impulse is worth 1e-5 m/s.
const BALLAST: f32 = 6e-3;
/// Before contacts know their loads, they are guessed where masses differ by more than this: less gives nobody ballast.
const GUESSED: f32 = 1e3;

/// What presses on a body in a substep, N·s.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pressing {
    sum: Vec3,
    size: f32,
    /// What stands on it, as long as contacts do not know.
    guess: f32,
}

/// Two bodies that touch, when a step begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    /// Local.
    pub bodies: [u32; 2],
    /// What B got along the normal in the last substep, N·s.
    pub push: Vec3,
    /// They touch, and do not know their load yet.
    pub is_new: bool,
}

impl Touch {
    /// A contact in substeps `stretch` times as long as the world's, whose points are taken for touching at gaps below `slop`,
    /// metres.
    pub fn new(bodies: [u32; 2], contact: &Contact, stretch: f32, slop: f32) -> Self {
        let points = contact.manifold.points();
        let load =
            stretch * contact.memory.points[..points.len()].iter().fold(0.0, |sum, point| sum + point.now);
        let is_new = load == 0.0 && points.iter().any(|point| point.separation < slop);
        Self { bodies, push: contact.manifold.normal * load, is_new }
    }
}

impl Pressing {
    fn add(&mut self, push: Vec3, size: f32) {
        self.sum += push;
        self.size += size;
    }

    /// The part that cancels itself.
    fn squeeze(&self) -> f32 {
        max(0.5 * (self.size - self.sum.length()), self.guess)
    }
}

impl IslandSolver {
    /// When a step begins.
    pub(super) fn guess_loads(&mut self) {
        self.pressing.clear();
        self.pressing.resize(self.links.len(), Pressing::default());
        self.is_unequal = self.mass_ratio() >= GUESSED;
        let unknown = self.touches.iter().any(|touch| touch.is_new);
        if !unknown || !self.is_unequal {
            return;
        }
        for (pressing, body) in self.pressing.iter_mut().zip(&self.bodies) {
            pressing.guess = body.force.length() * self.h;
        }
        for level in (2..=self.levels.highest()).rev() {
            self.hand_down(level);
        }
        // Their own weight squeezes nobody.
        for (pressing, body) in self.pressing.iter_mut().zip(&self.bodies) {
            pressing.guess -= body.force.length() * self.h;
        }
    }

    /// Bodies of a level share what they bear, and themselves, among those that they stand on.
    fn hand_down(&mut self, level: u32) {
        let Self { touches, pressing, levels, scratch, .. } = self;
        let supports = |touch: &Touch| {
            let [a, b] = touch.bodies;
            [(a, b), (b, a)]
                .into_iter()
                .find(|&(below, above)| levels.of(above) == level && levels.of(below) == level - 1)
        };
        let shares = &mut scratch.shares;
        shares.clear();
        shares.resize(pressing.len(), 0.0);
        for (_, above) in touches.iter().filter_map(supports) {
            shares[above as usize] += 1.0;
        }
        for (below, above) in touches.iter().filter_map(supports) {
            pressing[below as usize].guess += pressing[above as usize].guess / shares[above as usize];
        }
    }

    /// Where masses are very unequal, ballast follows from what presses in this substep.
    pub(super) fn refresh_ballast(&mut self) {
        if self.is_unequal {
            self.touches.clear();
            self.contacts.list_pushes(&mut self.touches);
            self.add_ballast();
            self.contacts.spoil();
        }
    }

    /// Gives ballast to what was squeezed in the last substep.
    pub(super) fn add_ballast(&mut self) {
        for pressing in &mut self.pressing {
            *pressing = Pressing { guess: pressing.guess, ..Pressing::default() };
        }
        for &Touch { bodies: [a, b], push, .. } in &self.touches {
            let size = push.length();
            for (body, push) in [(a, -push), (b, push)] {
                if let Some(pressing) = self.pressing.get_mut(body as usize) {
                    pressing.add(push, size);
                }
            }
        }
        for i in 0..self.pressing.len() {
            let (squeeze, mass) = (self.pressing[i].squeeze(), self.bodies[i].mass);
            let is_jointed = self.is_jointed(i as u32);
            self.bodies[i].ballast = if is_jointed { 1.0 } else { max(1.0, BALLAST * squeeze / mass) };
        }
    }
}
