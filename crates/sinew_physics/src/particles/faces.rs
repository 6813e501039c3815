//! Faces of a sheet: triangles between its particles, for aerodynamic forces.

use sinew_math::Vec3;

/// Faces of a group, and the faces of each particle.
#[derive(Clone, Debug, Default)]
pub(super) struct Faces {
    pub list: Vec<[u32; 3]>,
    /// Start of each particle's part of `corners`, and the end of the last part; empty without faces.
    starts: Vec<u32>,
    /// The other two corners of each face of each particle, in the face's order.
    corners: Vec<[u32; 2]>,
}

impl Faces {
    /// Lists the faces of a group of `count` particles.
    pub fn new(list: &[[u32; 3]], count: usize) -> Self {
        if list.is_empty() {
            return Self::default();
        }
        let mut starts = vec![0; count + 1];
        for &corner in list.iter().flatten() {
            starts[corner as usize + 1] += 1;
        }
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut corners = vec![[0; 2]; 3 * list.len()];
        for &[a, b, c] in list {
            for (corner, others) in [(a, [b, c]), (b, [c, a]), (c, [a, b])] {
                corners[next[corner as usize] as usize] = others;
                next[corner as usize] += 1;
            }
        }
        Self { list: list.to_vec(), starts, corners }
    }

    /// True if a particle is a corner of a face.
    pub fn has(&self, particle: usize) -> bool {
        !self.at(particle).is_empty()
    }

    /// Third of the vector area of each face that a particle is a corner of, m²: the part of the face assigned to it.
    pub fn parts<'a>(&'a self, positions: &'a [Vec3], particle: usize) -> impl Iterator<Item = Vec3> + 'a {
        let at = positions[particle];
        let side = move |corner: u32| positions[corner as usize] - at;
        self.at(particle).iter().map(move |&[b, c]| side(b).cross(side(c)) / 6.0)
    }

    /// The other two corners of each face of a particle.
    fn at(&self, particle: usize) -> &[[u32; 2]] {
        match self.starts.get(particle..particle + 2) {
            Some(range) => &self.corners[range[0] as usize..range[1] as usize],
            None => &[],
        }
    }
}
