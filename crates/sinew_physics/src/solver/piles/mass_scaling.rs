//! Mass scaling for bodies squeezed by loads far above their weight.
//!
//! In 32 bits, one ulp of the impulses on such a body, divided by its mass, may exceed any realistic speed: 4 m/s under
//! a tower of ten cubes, each ten times as heavy as the one below. Loads that press from both sides scale the body's
//! mass: while the loads last, the body responds to forces and impulses as if it were heavier. Its weight does not
//! change, nor does its response to a hit from one side.

use crate::solver::IslandSolver;
use crate::solver::piles::touch::{Pressing, Touch};
use crate::solver::tuning::MASS_SCALE;
use sinew_math::max;

impl IslandSolver {
    /// Computes mass scales from the loads of this substep, if masses are very unequal.
    pub(in crate::solver) fn refresh_mass_scale(&mut self) {
        if self.is_unequal {
            self.touches.clear();
            self.contacts.list_pushes(&mut self.touches);
            self.scale_masses();
            self.contacts.spoil();
        }
    }

    /// Applies mass scales to the bodies that were squeezed in the last substep.
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
