//! Closest point of a triangle.

use glam::Vec3;

/// Feature of a triangle that a point lies on, with its coordinates there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Nearest {
    /// Corner 0, 1 or 2.
    Corner(usize),
    /// Edge 0 (from corner 0 to 1), 1 (from 1 to 2) or 2 (from 0 to 2), and the parameter along it.
    Edge(usize, f32),
    /// Weights of corners 1 and 2; corner 0 has the rest.
    Face(f32, f32),
}

impl Nearest {
    /// Returns the weights of the three corners, which sum to 1.
    pub fn shares(self) -> [f32; 3] {
        match self {
            Self::Corner(0) => [1.0, 0.0, 0.0],
            Self::Corner(1) => [0.0, 1.0, 0.0],
            Self::Corner(_) => [0.0, 0.0, 1.0],
            Self::Edge(0, along) => [1.0 - along, along, 0.0],
            Self::Edge(1, along) => [0.0, 1.0 - along, along],
            Self::Edge(_, along) => [1.0 - along, 0.0, along],
            Self::Face(v, w) => [1.0 - v - w, v, w],
        }
    }
}

/// Returns the point of a triangle nearest to `p`, with the feature that it lies on, by the region of the plane that
/// `p` projects into (Ericson, "Real-Time Collision Detection", 2005, §5.1.5).
#[inline]
pub fn nearest(&[a, b, c]: &[Vec3; 3], p: Vec3) -> Nearest {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return Nearest::Corner(0);
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return Nearest::Corner(1);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return Nearest::Edge(0, d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return Nearest::Corner(2);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return Nearest::Edge(2, d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return Nearest::Edge(1, (d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let scale = 1.0 / (va + vb + vc);
    Nearest::Face(vb * scale, vc * scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Random, max, min};

    /// Checks that no sampled point of the triangle is nearer than the computed one.
    #[test]
    fn closest_points_are_nearest() {
        let mut random = Random::new(3);
        let mut found = [0; 3];
        for _ in 0..1_000 {
            let corners = [random.in_cube(), random.in_cube(), random.in_cube()];
            let p = random.in_cube() * 2.0;
            let at = |[u, v, w]: [f32; 3]| corners[0] * u + corners[1] * v + corners[2] * w;
            let nearest = nearest(&corners, p);
            found[match nearest {
                Nearest::Corner(_) => 0,
                Nearest::Edge(..) => 1,
                Nearest::Face(..) => 2,
            }] += 1;
            let shares = nearest.shares();
            assert!(
                shares.iter().all(|share| *share > -1e-4),
                "barycentric coordinates outside the triangle: {shares:?}"
            );
            assert!((shares.iter().sum::<f32>() - 1.0).abs() < 1e-5);
            let away = (at(shares) - p).length();
            let mut least = f32::INFINITY;
            for i in 0..=40 {
                for j in 0..=40 - i {
                    let [u, v] = [i, j].map(|k| k as f32 / 40.0);
                    least = min(least, (at([u, v, max(1.0 - u - v, 0.0)]) - p).length());
                }
            }
            assert!(
                away < least + 1e-4 && away > least - 0.06,
                "distance {away}, sampled {least}: {nearest:?}"
            );
        }
        assert!(found.iter().all(|count| *count > 20), "{found:?}");
    }
}
