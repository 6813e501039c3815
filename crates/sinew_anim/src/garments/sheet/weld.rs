//! Merges vertices at equal positions.

use super::{MeshPart, SheetOptions};
use crate::rig::{Primitive, Rig};
use sinew_math::{Affine, Vec3, max, min};
use std::collections::{BTreeMap, BTreeSet};

/// A mesh with merged vertices.
pub(super) struct Welded {
    /// Position of each vertex in the bind pose, metres, +Y up.
    pub places: Vec<Vec3>,
    /// Position of each vertex in mesh space.
    pub at: Vec<Vec3>,
    /// Skin slot that moves the vertex most.
    pub slots: Vec<u16>,
    /// Triangles with three distinct corners; a triangle of the same corners, in either orientation, appears
    /// once.
    pub faces: Vec<[usize; 3]>,
    /// New index of each vertex of each primitive; `None` if no triangle uses it.
    pub of_vertex: Vec<Vec<Option<usize>>>,
}

impl Welded {
    /// Area of a triangle, m².
    pub fn area(&self, &[a, b, c]: &[usize; 3]) -> f32 {
        let [a, b, c] = [a, b, c].map(|at| self.places[at]);
        0.5 * (b - a).cross(c - a).length()
    }

    /// Lowest and highest y of triangles with area, metres; `None` if there are none.
    pub fn heights(&self) -> Option<(f32, f32)> {
        let faces = self.faces.iter().filter(|face| self.area(face) > 0.0);
        let heights = faces.flatten().map(|&corner| self.places[corner].y);
        let (low, high) =
            heights.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), y| (min(low, y), max(high, y)));
        (low <= high).then_some((low, high))
    }
}

pub(super) fn weld(rig: &Rig, part: &MeshPart, options: &SheetOptions<'_>) -> Welded {
    let mesh = &rig.meshes[part.mesh];
    let skin = &rig.skins[mesh.skin.expect("a part has a skin")];
    let bound = |(&joint, inverse): (&usize, &Affine)| {
        options.metres_from_model
            * (options.bind_model.get(joint).copied().unwrap_or(Affine::IDENTITY) * *inverse)
    };
    let palette: Vec<Affine> = skin.joints.iter().zip(&skin.inverse_bind).map(bound).collect();
    let mut welded = Welded {
        places: Vec::new(),
        at: Vec::new(),
        slots: Vec::new(),
        faces: Vec::new(),
        of_vertex: Vec::new(),
    };
    let mut known: BTreeMap<[u32; 3], usize> = BTreeMap::new();
    let mut faces: BTreeSet<[usize; 3]> = BTreeSet::new();
    for &at in &part.primitives {
        let primitive = &mesh.primitives[at];
        let mut of_vertex = vec![None; primitive.positions.len()];
        for triangle in primitive.indices.chunks_exact(3) {
            let corners = [0, 1, 2].map(|corner| {
                let vertex = triangle[corner] as usize;
                let one = welded.one(primitive, vertex, &palette, &mut known);
                of_vertex[vertex] = Some(one);
                one
            });
            let [a, b, c] = corners;
            let mut sorted = corners;
            sorted.sort_unstable();
            if a != b && b != c && c != a && faces.insert(sorted) {
                welded.faces.push(corners);
            }
        }
        welded.of_vertex.push(of_vertex);
    }
    welded
}

impl Welded {
    /// Returns the merged index of a vertex; adds the vertex if it is new.
    fn one(
        &mut self,
        primitive: &Primitive,
        vertex: usize,
        palette: &[Affine],
        known: &mut BTreeMap<[u32; 3], usize>,
    ) -> usize {
        let at = primitive.positions[vertex];
        // Maps −0 to 0, so that both give one key.
        let key = at.to_array().map(|x| (x + 0.0).to_bits());
        *known.entry(key).or_insert_with(|| {
            let (mut place, mut heaviest) = (Vec3::ZERO, 0);
            let (slots, weights) = (primitive.joints[vertex], primitive.weights[vertex]);
            for k in 0..4 {
                place += palette[usize::from(slots[k])].point(at) * weights[k];
                if weights[k] > weights[heaviest] {
                    heaviest = k;
                }
            }
            self.places.push(place);
            self.at.push(at);
            self.slots.push(slots[heaviest]);
            self.places.len() - 1
        })
    }
}
