//! Measures the limit of the machine's arithmetic: additions, multiplications, both alternately, divisions and roots
//! of eight lanes per second without dependencies.

use crate::counted::Operations;
use crate::seconds;
use sinew_math::dispatch::{self, Kernel, Level};
use sinew_math::lanes::{Lanes, WIDTH};
use std::hint::black_box;

/// Number of operations of each chain in a run.
const LENGTH: u64 = 256;

/// Repeated operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Operation {
    Mul,
    Add,
    /// Multiplications in half of the chains, additions in the other half.
    MulAdd,
    Div,
    Sqrt,
}

const OPERATIONS: [Operation; 5] =
    [Operation::Mul, Operation::Add, Operation::MulAdd, Operation::Div, Operation::Sqrt];

/// `N` chains of operations that do not depend on each other.
struct Chains<const N: usize>(Operation);

impl<const N: usize> Kernel for Chains<N> {
    type Output = [f32; WIDTH];

    #[inline(always)]
    fn run<L: Lanes>(self) -> [f32; WIDTH] {
        let mut chains = [L::splat(1.5); N];
        for chain in &mut chains {
            *chain = L::splat(black_box(1.5));
        }
        let by = L::splat(black_box(1.000_000_1));
        // One loop per operation, otherwise the branch would be inside the loop.
        match self.0 {
            Operation::Mul => {
                for _ in 0..LENGTH {
                    for chain in &mut chains {
                        *chain = *chain * by;
                    }
                }
            }
            Operation::Add => {
                for _ in 0..LENGTH {
                    for chain in &mut chains {
                        *chain = *chain + by;
                    }
                }
            }
            Operation::MulAdd => {
                for _ in 0..LENGTH {
                    for pair in chains.as_chunks_mut::<2>().0 {
                        pair[0] = pair[0] * by;
                        pair[1] = pair[1] + by;
                    }
                }
            }
            Operation::Div => {
                for _ in 0..LENGTH {
                    for chain in &mut chains {
                        *chain = *chain / by;
                    }
                }
            }
            Operation::Sqrt => {
                for _ in 0..LENGTH {
                    for chain in &mut chains {
                        *chain = chain.sqrt();
                    }
                }
            }
        }
        let mut sum = chains[0];
        for chain in &chains[1..] {
            sum = sum + *chain;
        }
        let mut row = [0.0; WIDTH];
        sum.store(&mut row);
        row
    }
}

/// Time of each operation on eight lanes, seconds: the smallest measured.
#[derive(Clone, Copy, Debug)]
pub struct Limits([f64; OPERATIONS.len()]);

impl Default for Limits {
    fn default() -> Self {
        Self([f64::INFINITY; OPERATIONS.len()])
    }
}

impl Limits {
    /// Adds a sample of each operation.
    pub fn measure(&mut self, level: Level) {
        for (operation, best) in OPERATIONS.into_iter().zip(&mut self.0) {
            // The best number of chains hides the latency and fits the registers; it depends on the machine.
            let times = [
                time::<4>(level, operation),
                time::<6>(level, operation),
                time::<8>(level, operation),
                time::<12>(level, operation),
                time::<14>(level, operation),
            ];
            *best = times.into_iter().fold(*best, f64::min);
        }
    }

    /// Returns the least time in which the machine can do these operations.
    pub fn seconds(&self, operations: &Operations) -> f64 {
        let [mul, add, either, div, sqrt] = self.0;
        let &Operations { mul: muls, add: adds, div: divs, sqrt: roots, .. } = operations;
        let (muls, adds, divs, roots) = (muls as f64, adds as f64, divs as f64, roots as f64);
        let bounds = [muls * mul, adds * add, (muls + adds) * either, divs * div + roots * sqrt];
        bounds.into_iter().fold(0.0, f64::max)
    }

    /// Prints operations on eight lanes per second.
    pub fn print(&self, level: Level) {
        for (operation, time) in OPERATIONS.iter().zip(self.0) {
            println!("{level:?} limit.{operation:?} {:.4e} {:.4e}", 1.0 / time, 1.0 / time);
        }
    }
}

fn time<const N: usize>(level: Level, operation: Operation) -> f64 {
    let run = || {
        black_box(dispatch::run_at(level, Chains::<N>(operation)));
    };
    seconds(run) / (LENGTH * N as u64) as f64
}
