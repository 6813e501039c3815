//! Body properties used by contacts, computed once a step for each body instead of for each contact.

use crate::body::material::{ContactMaterial, Material};
use crate::body::{Body, BodyShape};
use crate::contact::ContactKey;
use crate::solver::articulation::tree::NONE;
use crate::solver::contact_rows::Placed;
use crate::solver::view::View;

/// Number of materials of an island whose pairs are combined once; pairs of further materials are combined for each contact.
const MATERIALS: usize = 8;

/// Properties of a body's first shape, which is the only one for most bodies.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Face {
    /// Smallest extent, metres.
    pub smallest_extent: f32,
    /// True if the shape has a rounding or a rim.
    pub is_curved: bool,
    /// True if the body spins so fast that its contacts may get other points within the step.
    pub turns: bool,
    /// Index of the shape's material, or [`NONE`] if it has to be computed for each contact.
    material: u32,
}

/// Faces of the bodies of an island, by local index.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct Faces {
    of: Vec<Face>,
    materials: Vec<Material>,
    /// Combined material of each pair of materials, by their indices.
    pairs: Vec<Option<ContactMaterial>>,
    /// The last combined material that was not in the table, and its pair, or [`NONE`].
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
    /// Reserves memory for `bodies` bodies.
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

    /// Returns the index of a material; adds it if it is new.
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
