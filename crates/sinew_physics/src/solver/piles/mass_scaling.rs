//! Bodies between others that press on them with far more than they weigh.
//!
//! In 32 bits an ulp of the impulses on such a body, over its mass, may be more than any speed that it could have: under a
//! tower of ten cubes, each ten times as heavy as the one that it stands on, 4 m/s. What presses from both sides gives it
//! mass scaling: it answers to forces and impulses as if it were heavier, for as long as they press. That changes neither its weight
//! nor what hits it from one side alone.

use crate::solver::IslandSolver;
use crate::solver::piles::touch::{Pressing, Touch};
use crate::solver::tuning::MASS_SCALE;
use sinew_math::max;

impl IslandSolver {
    /// Derives mass scales from what presses in this substep, where masses are very unequal.
    pub(in crate::solver) fn refresh_mass_scale(&mut self) {
        if self.is_unequal {
            self.touches.clear();
            self.contacts.list_pushes(&mut self.touches);
            self.scale_masses();
            self.contacts.spoil();
        }
    }

    /// Gives a mass scale to what was squeezed in the last substep.
    pub(in crate::solver) fn scale_masses(&mut self) {
        self.pressing.clear();
        self.pressing.resize(self.links.len(), Pressing::default());
        for &Touch { bodies: [a, b], normal, load, .. } in &self.touches {
            let (push, size) = (normal * load, load);
            for (body, push) in [(a, -push), (b, push)] {
                if let Some(pressing) = self.pressing.get_mut(body as usize) {
                    pressing.add(push, size);
                }
            }
        }
        for i in 0..self.pressing.len() {
            let (scaled_load, mass) = (self.pressing[i].scaled_load(), self.bodies[i].mass);
            let is_jointed = self.is_jointed(i as u32);
            self.bodies[i].mass_scale =
                if is_jointed { 1.0 } else { max(1.0, MASS_SCALE * scaled_load / mass) };
        }
    }
}
