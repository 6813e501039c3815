//! Submerged part of a solid of revolution, disk by disk.

use super::{Submerged, WaterPlane, segment};
use crate::revolved::Slice;
use sinew_math::{Vec3, normalize_or};

/// Nodes and weights of the Gauss rule for polynomials up to degree 15 on −1..1; the negative nodes are not listed.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// Returns the volume and the moment below the water surface of a solid of revolution about y, exact to about 1e-5 of
/// the whole. The Gauss rule is applied between the heights at which the water surface starts and stops cutting the
/// disks. A substitution smooths the integrand toward both ends, where the cut part grows like a square root.
pub(super) fn revolved_below(slices: &[Slice], plane: &WaterPlane) -> Submerged {
    let mut sums = [0.0; 3];
    for slice in slices {
        let mut from = slice.from;
        for to in crossings(slice, plane) {
            for (sum, part) in sums.iter_mut().zip(between(slice, plane, from, to)) {
                *sum += part;
            }
            from = to;
        }
    }
    let up = normalize_or(Vec3::new(plane.normal.x, 0.0, plane.normal.z), Vec3::X);
    let [volume, along, aside] = sums.map(|sum| sum as f32);
    Submerged::of_moment(volume, Vec3::Y * along + up * aside)
}

/// Heights of a slice at which the surface touches its rim, ascending, and the end of the slice.
fn crossings(slice: &Slice, plane: &WaterPlane) -> [f64; 3] {
    let [a, b, c] = slice.radius_squared;
    let (cos, height) = (f64::from(plane.normal.y), f64::from(plane.height));
    let flat = 1.0 - cos * cos;
    // (height − cos y)² = flat (a + b y + c y²)
    let (p, q, r) = (cos * cos - flat * c, -(cos * height + 0.5 * flat * b), height * height - flat * a);
    let root = q * q - p * r;
    let inside = |y: f64| if y > slice.from && y < slice.to { y } else { slice.to };
    if root < 0.0 {
        return [slice.to; 3];
    }
    // This form of the roots avoids the difference of nearly equal numbers.
    let sum = if q > 0.0 { -(q + root.sqrt()) } else { -q + root.sqrt() };
    let (y0, y1) = (inside(sum / p), inside(r / sum));
    if y0 < y1 { [y0, y1, slice.to] } else { [y1, y0, slice.to] }
}

/// Volume, and moments along the axis and toward the surface, between two heights.
fn between(slice: &Slice, plane: &WaterPlane, from: f64, to: f64) -> [f64; 3] {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (cos, height) = (f64::from(plane.normal.y), f64::from(plane.height));
    let flat = (1.0 - cos * cos).sqrt();
    let mut sums = [0.0; 3];
    for (node, weight) in GAUSS.into_iter().flat_map(|(x, w)| [(x, w), (-x, w)]) {
        let y = middle + half * 0.5 * node * (3.0 - node * node);
        let weight = weight * half * 1.5 * (1.0 - node * node);
        let squared = slice.radius_squared_at(y);
        let (radius, depth) = (squared.sqrt(), height - cos * y);
        // Position at which the surface cuts the disk, in radii along the upward direction.
        let t = if depth >= flat * radius {
            1.0
        } else if depth <= -flat * radius {
            -1.0
        } else {
            depth / (flat * radius)
        };
        let area = weight * squared * f64::from(segment(t as f32));
        let chord = 1.0 - t * t;
        sums[0] += area;
        sums[1] += area * y;
        sums[2] -= weight * squared * radius * (2.0 / 3.0 * chord * chord.sqrt());
    }
    sums
}
