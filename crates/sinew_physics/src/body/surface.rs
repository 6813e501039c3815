//! Surfaces: the non-geometric properties of a body's shapes, shared where equal.

use crate::body::contact_rule::ContactRule;
use crate::body::material::Material;
use crate::body::shape::{Filter, Sensing, ShapeDef};

/// All properties of a shape except its geometry and pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Surface {
    /// Density, kg/m³.
    pub density: f32,
    pub material: Material,
    pub filter: Filter,
    pub sensing: Sensing,
    pub rule: ContactRule,
}

/// The different surfaces of a body's shapes, in order of first use.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Surfaces(Vec<Surface>);

/// Number of recent surfaces that a new one is compared with, so that a body with a million different ones does not
/// cost quadratic time.
const LOOK_BACK: usize = 16;

impl Surface {
    pub fn of(def: &ShapeDef) -> Self {
        let &ShapeDef { density, material, filter, sensing, rule, .. } = def;
        Self { density, material, filter, sensing, rule }
    }

    /// True if particles with `filter` collide with the surface: one-way shapes and shapes with a modifier are walls to
    /// them.
    pub fn is_wall_to(&self, filter: Filter) -> bool {
        self.sensing == Sensing::Solid && self.rule != ContactRule::Ghost && self.filter.meets(filter)
    }
}

impl Surfaces {
    /// Creates the list from surfaces that were read from a snapshot.
    pub fn new(surfaces: Vec<Surface>) -> Self {
        Self(surfaces)
    }

    /// Returns the number of a surface; adds the surface if it is new.
    pub fn intern(&mut self, surface: &Surface) -> u32 {
        let known = self.0.iter().rev().take(LOOK_BACK).position(|other| other == surface);
        let place = known.map_or(self.0.len(), |back| self.0.len() - 1 - back);
        if place == self.0.len() {
            self.0.push(*surface);
        }
        place as u32
    }

    /// Releases excess memory.
    pub fn shrink(&mut self) {
        self.0.shrink_to_fit();
    }

    /// Replaces a surface that no other shape shares.
    pub fn set(&mut self, number: u32, surface: Surface) {
        self.0[number as usize] = surface;
    }

    pub fn as_slice(&self) -> &[Surface] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::shape::Shape;

    #[test]
    fn equal_surfaces_are_kept_once() {
        let mut surfaces = Surfaces::default();
        let with =
            |density: f32| Surface::of(&ShapeDef { density, ..ShapeDef::new(Shape::Sphere { radius: 1.0 }) });
        for (density, number) in [(1.0, 0), (2.0, 1), (1.0, 0), (2.0, 1), (3.0, 2)] {
            assert_eq!(surfaces.intern(&with(density)), number);
        }
        assert_eq!(surfaces.as_slice(), [with(1.0), with(2.0), with(3.0)]);
    }
}
