//! Lists of the joints that each body has.

use super::Joint;
use crate::arena::Arena;

/// The joints of each body, ascending. Derived from the joints, and so not part of the state.
#[derive(Clone, Debug, Default)]
pub(crate) struct Incidence {
    /// Joints of each body by slot, up to the last body that has any.
    of_body: Vec<Vec<u32>>,
}

impl Incidence {
    /// Incidence of all joints of a world.
    pub fn new(joints: &Arena<Joint>) -> Self {
        let mut incidence = Self::default();
        for (index, joint) in joints.iter() {
            incidence.insert(index, joint);
        }
        incidence
    }

    /// The joints of a body, ascending.
    pub fn body(&self, body: u32) -> &[u32] {
        self.of_body.get(body as usize).map_or(&[], Vec::as_slice)
    }

    pub fn insert(&mut self, index: u32, joint: &Joint) {
        for body in [joint.a as usize, joint.b as usize] {
            if self.of_body.len() <= body {
                self.of_body.resize_with(body + 1, Vec::new);
            }
            let list = &mut self.of_body[body];
            if let Err(place) = list.binary_search(&index) {
                list.insert(place, index);
            }
        }
    }

    pub fn remove(&mut self, index: u32, joint: &Joint) {
        for body in [joint.a, joint.b] {
            self.of_body[body as usize].retain(|&other| other != index);
        }
    }
}
