//! Compares every operation, at every level that the processor has, with `f32` and with a hash that is the same on
//! all processors.

use super::{LaneMask, Lanes, Real, WIDTH};
use crate::dispatch::{self, Kernel, Level};
use crate::{Random, StableHasher};

/// Hash of the results of [`soup`], on x86-64, aarch64 and wasm.
const GOLDEN: u64 = 0xa6ab_2171_d2ba_4a5b;

/// Numbers at which arithmetic has special cases.
const CORNERS: [f32; 24] = [
    0.0,
    -0.0,
    f32::from_bits(1),
    -f32::from_bits(1),
    f32::from_bits(0x007F_FFFF),
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE,
    1e-30,
    0.1,
    -0.3,
    1.0,
    -1.0,
    1.0 + f32::EPSILON,
    1.0 - f32::EPSILON,
    3.0,
    1e10,
    -1e19,
    1.9e19,
    f32::MAX,
    -f32::MAX,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    f32::from_bits(0xFFC1_2345),
];

/// Returns all pairs of corners, then pairs of random bits and pairs of random numbers near 1.
fn soup() -> Vec<[f32; 2]> {
    let mut random = Random::new(20_26);
    let mut pairs: Vec<[f32; 2]> = CORNERS.iter().flat_map(|&a| CORNERS.map(|b| [a, b])).collect();
    for _ in 0..4096 {
        let bits = random.bits();
        pairs.push([f32::from_bits(bits as u32), f32::from_bits((bits >> 32) as u32)]);
        pairs.push([random.range(-2.0, 2.0), random.range(-2.0, 2.0)]);
    }
    pairs
}

const OPERATIONS: usize = 17;

/// Applies each operation once; masks are observed through selections.
#[inline(always)]
fn operations<R: Real>(a: R, b: R) -> [R; OPERATIONS] {
    let (less, same) = (R::lt(a, b), R::eq(a, b));
    [
        a + b,
        a - b,
        a * b,
        a / b,
        -a,
        a.sqrt(),
        a.abs(),
        R::min(a, b),
        R::max(a, b),
        R::select(less, a, b),
        R::select(R::le(a, b), a, b),
        R::select(R::gt(a, b) | same, a, b),
        R::select(R::ge(a, b) & !same, a, b),
        a.masked(less),
        b.masked(!less & !same),
        a.nan_where(same),
        (a * b + R::splat(0.1)) / b.abs().sqrt(),
    ]
}

/// Returns the bits of a number; all NaN count as equal, because neither sign nor payload is promised.
fn bits(number: f32) -> u32 {
    if number.is_nan() { f32::NAN.to_bits() } else { number.to_bits() }
}

struct Operations<'a>(&'a [[f32; 2]]);

impl Kernel for Operations<'_> {
    /// Results of each pair; then the lanes in which the first is less, eight pairs at a time.
    type Output = (Vec<[u32; OPERATIONS]>, Vec<u8>);

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Output {
        let (mut results, mut masks) = (Vec::new(), Vec::new());
        for eight in self.0.chunks_exact(WIDTH) {
            let [mut a, mut b] = [[0.0; WIDTH]; 2];
            for (lane, pair) in eight.iter().enumerate() {
                [a[lane], b[lane]] = *pair;
            }
            let [a, b] = [L::load(&a), L::load(&b)];
            masks.push(L::lt(a, b).bits());
            let first = results.len();
            results.resize(first + WIDTH, [0; OPERATIONS]);
            for (operation, result) in operations(a, b).into_iter().enumerate() {
                let mut row = [0.0; WIDTH];
                result.store(&mut row);
                for lane in 0..WIDTH {
                    results[first + lane][operation] = bits(row[lane]);
                }
            }
        }
        (results, masks)
    }
}

#[test]
fn lanes_match_scalar_arithmetic() {
    let soup = soup();
    for level in Level::available() {
        let (results, masks) = dispatch::run_at(level, Operations(&soup));
        assert_eq!(results.len(), soup.len());
        for (index, (&[a, b], result)) in soup.iter().zip(&results).enumerate() {
            assert_eq!(*result, operations(a, b).map(bits), "{level:?}: {a:e} and {b:e}");
            assert_eq!(masks[index / WIDTH] >> (index % WIDTH) & 1 == 1, a < b, "{level:?}: {a:e} < {b:e}");
        }
    }
}

struct WideOperations<'a>(&'a [[f32; 2]]);

impl Kernel for WideOperations<'_> {
    /// Results of each pair, narrowed.
    type Output = Vec<[u32; OPERATIONS]>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Output {
        let mut results = Vec::new();
        for eight in self.0.chunks_exact(WIDTH) {
            let [mut a, mut b] = [[0.0; WIDTH]; 2];
            for (lane, pair) in eight.iter().enumerate() {
                [a[lane], b[lane]] = *pair;
            }
            let first = results.len();
            results.resize(first + WIDTH, [0; OPERATIONS]);
            let wide = operations(L::load(&a).widen(), L::load(&b).widen());
            for (operation, result) in wide.into_iter().enumerate() {
                let mut row = [0.0; WIDTH];
                L::narrow(result).store(&mut row);
                for lane in 0..WIDTH {
                    results[first + lane][operation] = bits(row[lane]);
                }
            }
        }
        results
    }
}

#[test]
fn wide_lanes_match_scalar_arithmetic() {
    let soup = soup();
    for level in Level::available() {
        for (&[a, b], result) in soup.iter().zip(dispatch::run_at(level, WideOperations(&soup))) {
            let one = operations(f64::from(a), f64::from(b)).map(|x| bits(x as f32));
            assert_eq!(result, one, "{level:?}: {a:e} and {b:e}");
        }
    }
}

#[test]
fn golden_soup_of_operations() {
    let soup = soup();
    for level in Level::available() {
        let mut hasher = StableHasher::default();
        for result in dispatch::run_at(level, Operations(&soup)).0.as_flattened() {
            hasher.write(&result.to_le_bytes());
        }
        assert_eq!(hasher.finish(), GOLDEN, "{level:?}: {:#018x}", hasher.finish());
    }
}

/// Documented results for NaN and −0, by name.
fn answers<R: Real>() -> [R; 6] {
    let [zero, minus, nan] = [0.0, -0.0, f32::NAN].map(R::splat);
    let one = R::splat(1.0);
    [
        R::min(zero, minus),
        R::max(minus, zero),
        R::min(nan, one),
        R::max(nan, one),
        R::min(one, nan),
        minus.sqrt(),
    ]
}

struct Answers;

impl Kernel for Answers {
    type Output = [u32; 6];

    #[inline(always)]
    fn run<L: Lanes>(self) -> [u32; 6] {
        let mut found = [0; 6];
        for (found, answer) in found.iter_mut().zip(answers::<L>()) {
            let mut row = [0.0; WIDTH];
            answer.store(&mut row);
            *found = bits(row[WIDTH - 1]);
        }
        found
    }
}

#[test]
fn min_returns_the_second_of_unordered_numbers() {
    let expected = [-0.0, 0.0, 1.0, 1.0, f32::NAN, -0.0].map(bits);
    assert_eq!(answers::<f32>().map(bits), expected);
    for level in Level::available() {
        assert_eq!(dispatch::run_at(level, Answers), expected, "{level:?}");
    }
}

struct Masks;

impl Kernel for Masks {
    type Output = [u8; 4];

    #[inline(always)]
    fn run<L: Lanes>(self) -> [u8; 4] {
        let numbers = L::load(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        let small = L::lt(numbers, L::splat(3.0));
        let all = small | !small;
        assert!(small.any() && !small.all() && all.all() && !(!all).any());
        let tops = L::ge(numbers, L::splat(6.0));
        [small.bits(), (!small).bits(), (small | tops).bits(), (small & tops).bits()]
    }
}

#[test]
fn bit_k_of_a_mask_is_lane_k() {
    for level in Level::available() {
        assert_eq!(dispatch::run_at(level, Masks), [0b0000_0111, 0b1111_1000, 0b1100_0111, 0], "{level:?}");
    }
}

#[test]
fn best_level_is_the_last_available_one() {
    assert_eq!(Level::available().last(), Some(Level::best()));
    assert!(Level::available().any(|level| level == Level::Scalar));
    let has_registers =
        cfg!(any(target_arch = "x86_64", target_arch = "aarch64", target_feature = "simd128"));
    assert_eq!(Level::best() != Level::Scalar, has_registers, "{:?}", Level::best());
}

#[test]
#[should_panic = "is not available on this processor"]
fn run_at_a_level_of_another_processor_panics() {
    let foreign = Level::ALL.into_iter().find(|level| !level.is_available());
    dispatch::run_at(foreign.expect("no processor has them all"), Masks);
}

struct Turned(usize);

impl Kernel for Turned {
    type Output = [f32; WIDTH];

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Output {
        let mut numbers = core::array::from_fn(|lane| lane as f32);
        L::load(&numbers).turn(self.0).store(&mut numbers);
        numbers
    }
}

#[test]
fn lanes_are_reversed() {
    for level in Level::available() {
        for by in 0..WIDTH {
            let expected = core::array::from_fn(|lane| ((lane + by) % WIDTH) as f32);
            assert_eq!(dispatch::run_at(level, Turned(by)), expected, "{level:?} by {by}");
        }
    }
}

struct Transposed;

impl Kernel for Transposed {
    type Output = [[f32; WIDTH]; WIDTH];

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Output {
        let mut records = [[0.0; WIDTH]; WIDTH];
        for (i, record) in records.iter_mut().enumerate() {
            for (j, number) in record.iter_mut().enumerate() {
                *number = (10 * i + j) as f32;
            }
        }
        let fields = L::transpose(records.map(|record| L::load(&record)));
        for (record, field) in records.iter_mut().zip(fields) {
            field.store(record);
        }
        records
    }
}

#[test]
fn records_become_fields() {
    for level in Level::available() {
        let fields = dispatch::run_at(level, Transposed);
        for (j, field) in fields.iter().enumerate() {
            for (i, &number) in field.iter().enumerate() {
                assert_eq!(number, (10 * i + j) as f32, "{level:?}: lane {i} of field {j}");
            }
        }
    }
}
