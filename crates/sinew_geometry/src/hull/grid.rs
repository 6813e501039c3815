//! Points as whole numbers, so that tests on which side of a plane a point is are exact for every cloud.

use super::HullError;
use sinew_math::{Vec3, max3, min3};

/// Largest number of steps along the longest side of the bounds. With at most this many steps, every multiple of the
/// step is exact in `f32`.
const STEPS: f64 = 8_388_608.0;
/// Valid range of the longest side of a hull, metres. Outside this range the inertia would leave the range of `f32`.
pub(super) const SIZES: core::ops::RangeInclusive<f64> = 1e-6..=1e6;

/// Points of a cloud on a grid whose step is a power of two, at most 2⁻²² of the longest side; sorted and unique, so
/// that the input order has no effect.
pub(super) struct Grid {
    /// Coordinates in steps from the lowest corner, 0..=2²³.
    pub points: Vec<[i64; 3]>,
    lowest: [f64; 3],
    step: f64,
}

impl Grid {
    pub fn new(points: &[Vec3]) -> Result<Self, HullError> {
        if !points.iter().all(|p| p.is_finite()) {
            return Err(HullError::NotFinite);
        }
        let (Some(low), Some(high)) =
            (points.iter().copied().reduce(min3), points.iter().copied().reduce(max3))
        else {
            return Err(HullError::TooFewPoints);
        };
        let [mut low, mut high] = [low, high].map(wide);
        let mut step = step_for(low, high)?;
        // Rounding may lengthen the bounds beyond what the step allows.
        loop {
            [low, high] = [low, high].map(|corner| corner.map(|x| (x / step).round_ties_even() * step));
            let again = step_for(low, high)?;
            if again <= step {
                break;
            }
            step = again;
        }
        let on_grid = |p: &Vec3| {
            let p = wide(*p);
            core::array::from_fn(|k| ((p[k] / step).round_ties_even() - low[k] / step) as i64)
        };
        let mut points: Vec<[i64; 3]> = points.iter().map(on_grid).collect();
        points.sort_unstable();
        points.dedup();
        Ok(Self { points, lowest: low, step })
    }

    /// Returns a point of the grid as an exact position, metres.
    pub fn place(&self, index: usize) -> Vec3 {
        let [x, y, z] = core::array::from_fn(|k| self.lowest[k] + self.points[index][k] as f64 * self.step);
        Vec3::new(x as f32, y as f32, z as f32)
    }
}

fn wide(p: Vec3) -> [f64; 3] {
    p.to_array().map(f64::from)
}

/// Returns the smallest power of two for which at most [`STEPS`] steps cover the bounds.
fn step_for(low: [f64; 3], high: [f64; 3]) -> Result<f64, HullError> {
    let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, |a: f64, b| if b > a { b } else { a });
    if size == 0.0 {
        return Err(HullError::TooFewPoints);
    }
    if !SIZES.contains(&size) {
        return Err(HullError::Size);
    }
    let mut step = 1.0;
    while step * STEPS < size {
        step *= 2.0;
    }
    while step * 0.5 * STEPS >= size {
        step *= 0.5;
    }
    Ok(step)
}
