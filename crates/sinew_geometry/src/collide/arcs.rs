//! Pairs of edges of two polytopes whose arcs cross on the Gauss map, tested eight at a time with SIMD.

use crate::hull::Polytope;
use sinew_math::Vec3;
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{LaneMask, Lanes, Vector3, WIDTH};

/// Number of edges of one polytope that are compared with eight of the other in one call.
const CHUNK: usize = 64;

/// An edge with the normals of its two faces, which are the ends of its arc on the Gauss map.
#[derive(Clone, Copy)]
pub(super) struct Arc {
    /// Index of the half-edge that represents the edge.
    pub side: usize,
    pub from: Vec3,
    pub along: Vec3,
    normals: [Vec3; 2],
}

impl Arc {
    const NONE: Self = Self { side: 0, from: Vec3::ZERO, along: Vec3::ZERO, normals: [Vec3::ZERO; 2] };

    pub fn new(of: &Polytope<'_>, side: usize) -> Self {
        let [from, to] = of.edge(side).ends;
        Self {
            side,
            from,
            along: to - from,
            normals: of.topology.faces_of(side).map(|face| of.planes[face].normal),
        }
    }

    /// Returns the cross product of both edges, pointing out of this polytope, not of unit length. `None` if the
    /// Minkowski difference has no face with this normal, which means that this arc and the reversed other arc do not
    /// cross. The arc of a triangle's edge, between opposite normals, is half a circle; `along` selects the half.
    pub fn crossing(&self, other: &Self) -> Option<Vec3> {
        let [c, d] = other.normals.map(|n| n.dot(self.along));
        if c * d >= 0.0 {
            return None;
        }
        let [a, b] = self.normals.map(|n| n.dot(other.along));
        if a * b >= 0.0 || c * b >= 0.0 {
            return None;
        }
        let across = self.along.cross(other.along);
        Some(if c < 0.0 { -across } else { across })
    }
}

/// Calls `visit` with all pairs of edges whose arcs cross, in an unspecified order.
pub(super) fn for_each_crossing(a: &Polytope<'_>, b: &Polytope<'_>, mut visit: impl FnMut(&Arc, &Arc)) {
    let mut left = b.topology.edge_numbers();
    loop {
        let (mut others, mut count) = ([Arc::NONE; CHUNK], 0);
        for (other, side) in others.iter_mut().zip(left.by_ref()) {
            *other = Arc::new(b, side);
            count += 1;
        }
        if count == 0 {
            return;
        }
        let mut sides = a.topology.edge_numbers();
        loop {
            let (mut arcs, mut lanes) = ([Arc::NONE; WIDTH], 0);
            for (arc, side) in arcs.iter_mut().zip(sides.by_ref()) {
                *arc = Arc::new(a, side);
                lanes += 1;
            }
            if lanes == 0 {
                break;
            }
            let crossed = dispatch::run(Cross { arcs: &ArcLanes::new(&arcs), others: &others[..count] });
            for (other, mut bits) in others[..count].iter().zip(crossed) {
                while bits != 0 {
                    visit(&arcs[bits.trailing_zeros() as usize], other);
                    bits &= bits - 1;
                }
            }
        }
    }
}

/// Eight arcs: directions of the edges, and the normals on both sides.
struct ArcLanes {
    along: [[f32; WIDTH]; 3],
    normals: [[[f32; WIDTH]; 3]; 2],
}

impl ArcLanes {
    /// Loads eight arcs. Arcs without normals cross no other arc.
    fn new(arcs: &[Arc; WIDTH]) -> Self {
        let lanes = |of: fn(&Arc) -> Vec3| {
            let rows = arcs.each_ref().map(|arc| of(arc).to_array());
            core::array::from_fn(|axis| rows.map(|row| row[axis]))
        };
        Self {
            along: lanes(|arc| arc.along),
            normals: [lanes(|arc| arc.normals[0]), lanes(|arc| arc.normals[1])],
        }
    }
}

/// Kernel that tests eight arcs against each of `others`. Bit `k` of a result is set if arc `k` crosses that other arc:
/// see [`Arc::crossing`].
struct Cross<'a> {
    arcs: &'a ArcLanes,
    others: &'a [Arc],
}

impl Kernel for Cross<'_> {
    type Output = [u8; CHUNK];

    #[inline(always)]
    fn run<L: Lanes>(self) -> [u8; CHUNK] {
        let mut crossed = [0; CHUNK];
        let along = load::<L>(&self.arcs.along);
        let [m, n] = [load::<L>(&self.arcs.normals[0]), load::<L>(&self.arcs.normals[1])];
        let zero = L::splat(0.0);
        for (bits, other) in crossed.iter_mut().zip(self.others) {
            let (c, d) = (splat::<L>(other.normals[0]).dot(along), splat::<L>(other.normals[1]).dot(along));
            let edge = splat::<L>(other.along);
            let (a, b) = (m.dot(edge), n.dot(edge));
            *bits = !(L::ge(c * d, zero) | L::ge(a * b, zero) | L::ge(c * b, zero)).bits();
        }
        crossed
    }
}

#[inline(always)]
fn load<L: Lanes>(rows: &[[f32; WIDTH]; 3]) -> Vector3<L> {
    Vector3::new(L::load(&rows[0]), L::load(&rows[1]), L::load(&rows[2]))
}

#[inline(always)]
fn splat<L: Lanes>(v: Vec3) -> Vector3<L> {
    Vector3::new(L::splat(v.x), L::splat(v.y), L::splat(v.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hull::Hull;
    use sinew_math::Random;

    #[test]
    fn simd_test_of_arcs_finds_the_same_pairs_as_the_scalar_test() {
        let mut random = Random::new(12);
        let mut found = 0;
        for corners in [4, 5, 8, 20, 60, 120] {
            let [a, b] = [0, 1].map(|_| {
                let points: Vec<Vec3> = (0..corners).map(|_| random.direction()).collect();
                Hull::new(&points).expect("points on a ball")
            });
            let (a, b) = (a.polytope(), b.polytope());
            let mut expected = Vec::new();
            for arc in a.topology.edge_numbers().map(|i| Arc::new(&a, i)) {
                for other in b.topology.edge_numbers().map(|j| Arc::new(&b, j)) {
                    if arc.crossing(&other).is_some() {
                        expected.push((arc.side, other.side));
                    }
                }
            }
            let mut crossed = Vec::new();
            for_each_crossing(&a, &b, |arc, other| crossed.push((arc.side, other.side)));
            crossed.sort_unstable();
            assert_eq!(crossed, expected, "{corners} corners");
            found += crossed.len();
        }
        assert!(found > 300, "only {found} pairs of arcs cross");
    }
}
