//! Balls of nearly equal triangles.

use sinew_math::Vec3;
use std::collections::BTreeMap;

/// Returns the directions of the corners, and the triangles, counterclockwise from outside, of an icosahedron whose
/// faces are split in four `subdivisions` times.
pub(super) fn sphere(subdivisions: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut corners, mut triangles) = icosahedron();
    for _ in 0..subdivisions {
        let mut middles = BTreeMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry([u32::min(a, b), u32::max(a, b)]).or_insert_with(|| {
                corners.push((corners[a as usize] + corners[b as usize]).normalize());
                corners.len() as u32 - 1
            })
        };
        let split = |[a, b, c]: [u32; 3]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(split).collect();
    }
    (corners, triangles)
}

/// Returns each edge of a closed surface of triangles once, ascending.
pub(super) fn edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    // A closed surface has each edge in both directions.
    let mut edges: Vec<[u32; 2]> = sides.filter(|[a, b]| a < b).collect();
    edges.sort_unstable();
    edges
}

/// Returns corners and triangles: one corner at the top, one at the bottom, and two rings of five between them.
fn icosahedron() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    // A regular pentagon: cosines and sines of 72° and 144°.
    let (c1, s1, c2, s2) = (0.309_017, 0.951_056_5, -0.809_017, 0.587_785_25);
    let ring = [[1.0, 0.0], [c1, s1], [c2, s2], [c2, -s2], [c1, -s1]];
    // The rings are at heights of ±1/√5, with a radius of 2/√5.
    let (height, reach) = (0.447_213_6, 0.894_427_2);
    let upper = ring.map(|[x, z]| Vec3::new(reach * x, height, reach * z));
    let lower = ring.map(|[x, z]| Vec3::new(-reach * x, -height, -reach * z));
    let corners = [[Vec3::Y].as_slice(), &upper, &lower, &[Vec3::NEG_Y]].concat();
    let (up, low) = (|k: u32| 1 + k % 5, |k: u32| 6 + k % 5);
    // The lower corner opposite to upper corner k is low(k); below the side from k to k + 1 is low(k + 3).
    let faces = |k: u32| {
        [
            [0, up(k + 1), up(k)],
            [up(k), up(k + 1), low(k + 3)],
            [up(k + 1), low(k + 4), low(k + 3)],
            [11, low(k), low(k + 1)],
        ]
    };
    let triangles = (0..5).flat_map(faces).collect();
    (corners, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::net::enclosed_volume;

    /// Checks Euler's formula, that all corners are on the sphere, and that the volume is nearly that of a ball.
    #[test]
    fn geodesic_sphere_is_closed_and_round() {
        let mut least = 0.0;
        for subdivisions in 0..4 {
            let (corners, triangles) = sphere(subdivisions);
            let edges = edges(&triangles);
            assert_eq!(corners.len() + triangles.len(), edges.len() + 2);
            assert_eq!(2 * edges.len(), 3 * triangles.len());
            assert!(corners.iter().all(|c| (c.length() - 1.0).abs() < 1e-6));
            let volume = enclosed_volume(&triangles, &corners, |_, _| ());
            assert!(volume > least && volume < 4.18879, "{subdivisions} subdivisions: volume {volume}");
            least = volume;
        }
        assert!(least > 0.99 * 4.18879 * 0.99, "{least}");
    }
}
