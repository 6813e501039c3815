//! Volume, centre and inertia of a hull: sums over the tetrahedra between an inner point and the triangles of its faces
//! (after Mirtich, "Fast and Accurate Computation of Polyhedral Mass Properties", 1996), in `f64`, since large terms
//! cancel.

use sinew_math::{Sym3, Vec3};

/// Integrals over a solid, relative to a point inside.
pub(super) struct Integrals {
    from: [f64; 3],
    /// ∫ dV.
    volume: f64,
    /// ∫ x dV.
    first: [f64; 3],
    /// ∫ x² dV, ∫ y² dV, ∫ z² dV.
    squares: [f64; 3],
    /// ∫ yz dV, ∫ xz dV, ∫ xy dV.
    products: [f64; 3],
}

impl Integrals {
    /// Computes the integrals over the solid between faces given by their corner indices, counter-clockwise from
    /// outside.
    pub fn new(vertices: &[Vec3], loops: &[Vec<u8>]) -> Self {
        let wide = |v: &Vec3| v.to_array().map(f64::from);
        let mut from = [0.0; 3];
        for vertex in vertices {
            let v = wide(vertex);
            (0..3).for_each(|k| from[k] += v[k] / vertices.len() as f64);
        }
        let arm = |i: u8| {
            let v = wide(&vertices[usize::from(i)]);
            core::array::from_fn(|k| v[k] - from[k])
        };
        let mut sum = Self { from, volume: 0.0, first: [0.0; 3], squares: [0.0; 3], products: [0.0; 3] };
        for ring in loops {
            for pair in ring[1..].windows(2) {
                sum.add([arm(ring[0]), arm(pair[0]), arm(pair[1])]);
            }
        }
        sum
    }

    /// Adds the tetrahedron between the inner point and three corners. With `d` six times its volume and `s` the sum of
    /// the corners: `∫ x = d s/24`, `∫ x xᵀ = d (s sᵀ + a aᵀ + b bᵀ + c cᵀ)/120`.
    fn add(&mut self, [a, b, c]: [[f64; 3]; 3]) {
        let d = a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        let s: [f64; 3] = core::array::from_fn(|k| a[k] + b[k] + c[k]);
        self.volume += d / 6.0;
        let second = |i: usize, j: usize| d / 120.0 * (s[i] * s[j] + a[i] * a[j] + b[i] * b[j] + c[i] * c[j]);
        for k in 0..3 {
            self.first[k] += d / 24.0 * s[k];
            self.squares[k] += second(k, k);
            self.products[k] += second((k + 1) % 3, (k + 2) % 3);
        }
    }

    /// Returns volume, centre, and inertia about the centre at density 1; `None` if the volume is zero or not finite.
    pub fn solid(&self) -> Option<(f32, Vec3, Sym3)> {
        let volume = self.volume as f32;
        if !(volume > 0.0 && volume < f32::INFINITY) {
            return None;
        }
        let mean = self.first.map(|x| x / self.volume);
        let about = |i: usize, j: usize| self.volume * mean[i] * mean[j];
        let squares: [f64; 3] = core::array::from_fn(|k| self.squares[k] - about(k, k));
        let [x, y, z] = core::array::from_fn(|k| (self.from[k] + mean[k]) as f32);
        let diagonal: [f64; 3] = core::array::from_fn(|k| squares[(k + 1) % 3] + squares[(k + 2) % 3]);
        let off: [f64; 3] = core::array::from_fn(|k| about((k + 1) % 3, (k + 2) % 3) - self.products[k]);
        let vector = |v: [f64; 3]| Vec3::from_array(v.map(|x| x as f32));
        let inertia = Sym3 { diagonal: vector(diagonal), off: vector(off) };
        inertia.is_finite().then(|| (volume, Vec3::new(x, y, z), inertia))
    }
}
