//! Copies vectors of particles into lanes and back, with SIMD: particle `i` is in block `i mod n` of `n`, lane `i / n`.

use sinew_math::Vec3;
use sinew_math::dispatch::Kernel;
use sinew_math::lanes::{Block, Lanes, WIDTH};

/// Writes vectors, one per particle, into blocks from field `FIELD` on: eight blocks of eight at a time.
pub(super) struct Spread<'a, const F: usize, const FIELD: usize> {
    pub vectors: &'a [Vec3],
    pub blocks: &'a mut [Block<F>],
    pub per_lane: usize,
}

impl<const F: usize, const FIELD: usize> Kernel for Spread<'_, F, FIELD> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { vectors, blocks, per_lane } = self;
        let whole = whole_eights(vectors.len(), per_lane);
        for (at, eight) in blocks.as_chunks_mut::<WIDTH>().0[..whole].iter_mut().enumerate() {
            let mut numbers = [[[0.0; WIDTH]; 3]; WIDTH];
            for (lane, numbers) in numbers.iter_mut().enumerate() {
                copy_numbers(&vectors[lane * per_lane + at * WIDTH..][..WIDTH], numbers);
            }
            for part in 0..3 {
                let columns = L::transpose(numbers.each_ref().map(|numbers| L::load(&numbers[part])));
                for (k, column) in columns.into_iter().enumerate() {
                    let k = part * WIDTH + k;
                    column.store(&mut eight[k / 3].0[FIELD + k % 3]);
                }
            }
        }
        for block in whole * WIDTH..per_lane {
            for (lane, vector) in vectors[block..].iter().step_by(per_lane).enumerate() {
                for (k, number) in vector.to_array().into_iter().enumerate() {
                    blocks[block].0[FIELD + k][lane] = number;
                }
            }
        }
    }
}

/// Reads vectors, one per particle, from the first fields of blocks.
pub(super) struct Collect<'a, const F: usize> {
    pub vectors: &'a mut [Vec3],
    pub blocks: &'a [Block<F>],
    pub per_lane: usize,
}

impl<const F: usize> Kernel for Collect<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { vectors, blocks, per_lane } = self;
        let whole = whole_eights(vectors.len(), per_lane);
        for (at, eight) in blocks.as_chunks::<WIDTH>().0[..whole].iter().enumerate() {
            let mut numbers = [[[0.0; WIDTH]; 3]; WIDTH];
            for part in 0..3 {
                let column = |k: usize| L::load(&eight[k / 3].0[k % 3]);
                let lanes = L::transpose(core::array::from_fn(|k| column(part * WIDTH + k)));
                for (lane, numbers) in lanes.into_iter().zip(&mut numbers) {
                    lane.store(&mut numbers[part]);
                }
            }
            for (lane, numbers) in numbers.iter().enumerate() {
                let to = &mut vectors[lane * per_lane + at * WIDTH..][..WIDTH];
                for (vector, numbers) in to.iter_mut().zip(numbers.as_flattened().as_chunks::<3>().0) {
                    *vector = Vec3::from_array(*numbers);
                }
            }
        }
        for block in whole * WIDTH..per_lane {
            let Block(fields) = &blocks[block];
            for (lane, vector) in vectors[block..].iter_mut().step_by(per_lane).enumerate() {
                *vector = Vec3::new(fields[0][lane], fields[1][lane], fields[2][lane]);
            }
        }
    }
}

/// Number of groups of eight full blocks.
fn whole_eights(count: usize, per_lane: usize) -> usize {
    count.saturating_sub((WIDTH - 1) * per_lane) / WIDTH
}

/// Copies the numbers of eight vectors, one vector after the other.
#[inline(always)]
pub(super) fn copy_numbers(from: &[Vec3], to: &mut [[f32; WIDTH]; 3]) {
    for (vector, numbers) in from.iter().zip(to.as_flattened_mut().as_chunks_mut::<3>().0) {
        *numbers = vector.to_array();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::batches::FIELDS;
    use sinew_math::dispatch::{self, Level};

    #[test]
    fn vectors_copied_into_lanes_and_back_are_unchanged() {
        for level in Level::available() {
            for count in [1, 7, 9, 64, 65, 120, 128, 200, 1003] {
                let vector = |i: usize| Vec3::new(i as f32, i as f32 + 0.25, i as f32 + 0.5);
                let vectors: Vec<Vec3> = (0..count).map(vector).collect();
                let per_lane = count.div_ceil(WIDTH);
                let mut blocks = vec![Block::splat([-1.0; FIELDS]); per_lane];
                let spread = Spread::<FIELDS, 0> { vectors: &vectors, blocks: &mut blocks, per_lane };
                dispatch::run_at(level, spread);
                for (i, vector) in vectors.iter().enumerate() {
                    assert_eq!(
                        blocks[i % per_lane].get(i / per_lane)[..3],
                        vector.to_array(),
                        "{count} at {level:?}"
                    );
                }
                let mut back = vec![Vec3::ZERO; count];
                dispatch::run_at(level, Collect { vectors: &mut back, blocks: &blocks, per_lane });
                assert_eq!(back, vectors, "{count} at {level:?}");
            }
        }
    }
}
