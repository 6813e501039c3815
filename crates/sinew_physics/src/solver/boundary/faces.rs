//! Properties of bodies that contacts ask for: looked up once a step for each body, not for each contact.

use crate::body::material::{ContactMaterial, Material};
use crate::body::{Body, BodyShape};
use crate::contact::ContactKey;
use crate::solver::articulation::tree::NONE;
use crate::solver::contact_rows::Placed;
use crate::solver::view::View;

/// Different materials of an island of which pairs are combined once; others are combined for each contact.
const MATERIALS: usize = 8;

/// Properties of a body's first shape, the only one that most have.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Face {
    /// Metres.
    pub smallest_extent: f32,
    /// It has a rounding or a rim.
    pub is_curved: bool,
    /// The body turns so fast that contacts may have other points before the step is over.
    pub turns: bool,
    /// Place of its material, or [`NONE`] if it has to be looked at.
    material: u32,
}

/// Faces of the bodies of an island, by local index.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct Faces {
    of: Vec<Face>,
    materials: Vec<Material>,
    /// Combined material of each pair of materials, by their places.
    pairs: Vec<Option<ContactMaterial>>,
    /// Combined material that was asked for last, and its pair, or [`NONE`].
    material: ContactMaterial,
    pair: u32,
}

impl Face {
    fn of(shape: &BodyShape, turns: bool, material: u32) -> Self {
        let BodyShape { shape, principal_from_shape, .. } = shape;
        let is_curved = Placed { shape, principal_from_shape }.is_curved();
        Self { smallest_extent: shape.smallest_extent(), is_curved, turns, material }
    }
}

impl Faces {
    /// For so many bodies.
    pub fn make_room(&mut self, bodies: usize) {
        self.of.clear();
        self.of.reserve(bodies);
        self.materials.reserve(MATERIALS);
        self.clear();
    }

    pub fn clear(&mut self) {
        self.of.clear();
        self.materials.clear();
        self.pairs.clear();
        self.pairs.resize(MATERIALS * MATERIALS, None);
        self.pair = NONE;
    }

    /// Adds a body.
    pub fn push(&mut self, body: &Body, turns: bool) {
        let face = match body.shapes.first() {
            Some(shape) => Face::of(shape, turns, self.place(&body.surface(0).material)),
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

    /// Faces of the two shapes of a contact.
    #[inline]
    pub fn of(&self, view: &View<'_>, key: ContactKey, [a, b]: [u32; 2]) -> [Face; 2] {
        [self.one(view, key.a, key.shape_a, a), self.one(view, key.b, key.shape_b, b)]
    }

    #[inline]
    fn one(&self, view: &View<'_>, body: u32, shape: u32, local: u32) -> Face {
        let first = self.of[local as usize];
        match shape {
            0 => first,
            _ => Face::of(&view.bodies.at(body).shapes[shape as usize], first.turns, NONE),
        }
    }

    /// Combined material of the surfaces of a contact in this step.
    #[inline]
    pub fn material(&mut self, view: &View<'_>, index: u32, [a, b]: &[Face; 2]) -> &ContactMaterial {
        let (a, b) = (a.material, b.material);
        if a == NONE || b == NONE || view.modifiers.have_changed(index) {
            self.pair = NONE;
            self.material = view.modifiers.material(view.bodies, view.contacts, index);
            return &self.material;
        }
        let pair = a * MATERIALS as u32 + b;
        if pair != self.pair {
            let Self { materials, pairs, .. } = self;
            let combined = || ContactMaterial::of(&materials[a as usize], &materials[b as usize]);
            self.material = *pairs[pair as usize].get_or_insert_with(combined);
            self.pair = pair;
        }
        &self.material
    }
}
