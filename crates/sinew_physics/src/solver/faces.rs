//! What contacts ask of bodies: looked up once a step for each body, not for each contact.

use super::View;
use super::contact_rows::Placed;
use super::tree::NONE;
use crate::body::{Body, BodyShape};
use crate::contact::{Contact, ContactKey};
use crate::material::{ContactMaterial, Material};
use sinew_math::min;

/// Different materials of an island of which pairs are combined once; others are combined for each contact.
const MATERIALS: usize = 8;

/// Of a body's first shape, the only one that most have.
#[derive(Clone, Copy, Debug)]
struct Face {
    /// Metres.
    smallest_extent: f32,
    is_curved: bool,
    /// The body turns so fast that contacts may have other points before the step is over.
    turns: bool,
    /// Place of its material, or [`NONE`] if it has to be looked at.
    material: u32,
}

/// Of the bodies of an island, by local index.
#[derive(Clone, Debug, Default)]
pub(super) struct Faces {
    of: Vec<Face>,
    materials: Vec<Material>,
    /// Of two materials, by their places.
    pairs: Vec<Option<ContactMaterial>>,
}

fn is_curved(shape: &BodyShape) -> bool {
    Placed { shape: &shape.shape, principal_from_shape: &shape.principal_from_shape }.is_curved()
}

impl Faces {
    pub fn clear(&mut self) {
        self.of.clear();
        self.materials.clear();
        self.pairs.clear();
        self.pairs.resize(MATERIALS * MATERIALS, None);
    }

    /// Adds a body.
    pub fn push(&mut self, body: &Body, turns: bool) {
        let face = match body.shapes.first() {
            Some(shape) => Face {
                smallest_extent: shape.shape.smallest_extent(),
                is_curved: is_curved(shape),
                turns,
                material: self.place(&body.surface(0).material),
            },
            None => Face { smallest_extent: f32::INFINITY, is_curved: false, turns, material: NONE },
        };
        self.of.push(face);
    }

    /// Place of a material, known or new.
    fn place(&mut self, material: &Material) -> u32 {
        if material.runs() {
            return NONE;
        }
        match self.materials.iter().rposition(|known| known == material) {
            Some(place) => place as u32,
            None if self.materials.len() < MATERIALS => {
                self.materials.push(*material);
                self.materials.len() as u32 - 1
            }
            None => NONE,
        }
    }

    /// Whether one of two bodies turns fast.
    pub fn turn(&self, bodies: [u32; 2]) -> bool {
        bodies.into_iter().any(|body| self.of[body as usize].turns)
    }

    /// Of both shapes of a contact, metres.
    pub fn smallest_extent(&self, view: &View<'_>, key: ContactKey, bodies: [u32; 2]) -> f32 {
        let of = |index: u32, shape: u32, local: u32| match shape {
            0 => self.of[local as usize].smallest_extent,
            _ => view.bodies.at(index).shapes[shape as usize].shape.smallest_extent(),
        };
        min(of(key.a, key.shape_a, bodies[0]), of(key.b, key.shape_b, bodies[1]))
    }

    /// Whether one of the shapes of a contact has a rounding or a rim.
    pub fn is_curved(&self, view: &View<'_>, key: ContactKey, bodies: [u32; 2]) -> bool {
        let of = |index: u32, shape: u32, local: u32| match shape {
            0 => self.of[local as usize].is_curved,
            _ => is_curved(&view.bodies.at(index).shapes[shape as usize]),
        };
        of(key.a, key.shape_a, bodies[0]) || of(key.b, key.shape_b, bodies[1])
    }

    /// What the surfaces of a contact are to each other in this step.
    pub fn material(
        &mut self,
        view: &View<'_>,
        index: u32,
        contact: &Contact,
        bodies: [u32; 2],
    ) -> ContactMaterial {
        let [a, b] = bodies.map(|body| self.of[body as usize].material);
        let is_first = contact.key.shape_a == 0 && contact.key.shape_b == 0;
        if !is_first || a == NONE || b == NONE || view.modifiers.have_changed(index) {
            return view.modifiers.material(view.bodies, view.contacts, index);
        }
        let Self { materials, pairs, .. } = self;
        let combined = || ContactMaterial::of(&materials[a as usize], &materials[b as usize]);
        *pairs[a as usize * MATERIALS + b as usize].get_or_insert_with(combined)
    }
}
