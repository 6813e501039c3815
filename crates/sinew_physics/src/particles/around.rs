//! Bounds of particle positions, with SIMD.

use super::spread::copy_numbers;
use crate::boxes::Aabb;
use sinew_math::Vec3;
use sinew_math::dispatch::Kernel;
use sinew_math::lanes::{Lanes, WIDTH};

/// Empty bounds.
pub(super) const NOTHING: Aabb =
    Aabb { min: Vec3::splat(f32::INFINITY), max: Vec3::splat(f32::NEG_INFINITY) };

/// Computes the bounds of points.
pub(super) struct Around<'a>(pub &'a [Vec3]);

impl Kernel for Around<'_> {
    type Output = Aabb;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Aabb {
        let (eights, rest) = self.0.as_chunks::<WIDTH>();
        let (mut low, mut high) = ([L::splat(f32::INFINITY); 3], [L::splat(f32::NEG_INFINITY); 3]);
        for eight in eights {
            let mut numbers = [[0.0; WIDTH]; 3];
            copy_numbers(eight, &mut numbers);
            for part in 0..3 {
                let numbers = L::load(&numbers[part]);
                low[part] = L::min(numbers, low[part]);
                high[part] = L::max(numbers, high[part]);
            }
        }
        let [mut lowest, mut highest] = [[[0.0; WIDTH]; 3]; 2];
        for part in 0..3 {
            low[part].store(&mut lowest[part]);
            high[part].store(&mut highest[part]);
        }
        let bounds = rest.iter().fold(NOTHING, |bounds, &p| bounds.merge(&Aabb { min: p, max: p }));
        let corners = |numbers: &[[f32; WIDTH]; 3]| -> [Vec3; WIDTH] {
            let numbers = numbers.as_flattened();
            core::array::from_fn(|k| Vec3::new(numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2]))
        };
        let corners = corners(&lowest).into_iter().zip(corners(&highest));
        corners.fold(bounds, |bounds, (min, max)| bounds.merge(&Aabb { min, max }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_math::Random;
    use sinew_math::dispatch::{self, Level};

    #[test]
    fn simd_bounds_equal_bounds_of_each_point_in_turn() {
        let mut random = Random::new(1);
        for level in Level::available() {
            for count in [0, 1, 8, 13, 100] {
                let points: Vec<Vec3> = (0..count).map(|_| random.in_cube()).collect();
                let each = points.iter().fold(NOTHING, |all, &p| all.merge(&Aabb { min: p, max: p }));
                assert_eq!(dispatch::run_at(level, Around(&points)), each, "{count} at {level:?}");
            }
        }
    }
}
