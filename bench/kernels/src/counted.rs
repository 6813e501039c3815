//! Lanes that count operations.

use sinew_math::dispatch::Kernel;
use sinew_math::lanes::{LaneMask, Lanes, Mask, Real, WIDTH};
use std::cell::Cell;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Number of operations on eight lanes. Loads and stores are not counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Number of multiplications.
    pub mul: u64,
    /// Number of additions, subtractions, comparisons, minima and maxima: operations of an adder.
    pub add: u64,
    /// Number of divisions.
    pub div: u64,
    /// Number of square roots.
    pub sqrt: u64,
    /// Number of signs, masks and selections.
    pub logic: u64,
}

thread_local! {
    static COUNT: Cell<Operations> = const {
        Cell::new(Operations { mul: 0, add: 0, div: 0, sqrt: 0, logic: 0 })
    };
}

fn tick(field: impl Fn(&mut Operations) -> &mut u64) {
    COUNT.with(|count| {
        let mut now = count.get();
        *field(&mut now) += 1;
        count.set(now);
    });
}

/// Returns the operations of a kernel.
pub fn count<K: Kernel>(kernel: K) -> Operations {
    COUNT.set(Operations::default());
    kernel.run::<Counted>();
    COUNT.get()
}

/// One number for all eight lanes, because only the operations count.
#[derive(Clone, Copy)]
pub struct Counted(f32);

/// A mask for all eight lanes.
#[derive(Clone, Copy)]
pub struct CountedMask(bool);

macro_rules! counted {
    ($($operator:ident $method:ident $of:ident $field:ident),*) => {$(
        impl $operator for $of {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                tick(|count| &mut count.$field);
                Self($operator::$method(self.0, other.0))
            }
        }
    )*};
}

counted!(
    Add add Counted add, Sub sub Counted add, Mul mul Counted mul, Div div Counted div,
    BitAnd bitand CountedMask logic, BitOr bitor CountedMask logic
);

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        tick(|count| &mut count.logic);
        Self(-self.0)
    }
}

impl Not for CountedMask {
    type Output = Self;
    fn not(self) -> Self {
        tick(|count| &mut count.logic);
        Self(!self.0)
    }
}

impl Mask for CountedMask {}

impl LaneMask for CountedMask {
    fn bits(self) -> u8 {
        if self.0 { u8::MAX } else { 0 }
    }

    /// Returns true: among eight lanes nearly always one continues.
    fn any(self) -> bool {
        true
    }
}

impl Real for Counted {
    type Mask = CountedMask;

    fn splat(value: f32) -> Self {
        Self(value)
    }

    fn sqrt(self) -> Self {
        tick(|count| &mut count.sqrt);
        Self(self.0.sqrt())
    }

    fn abs(self) -> Self {
        tick(|count| &mut count.logic);
        Self(self.0.abs())
    }

    fn lt(a: Self, b: Self) -> CountedMask {
        tick(|count| &mut count.add);
        CountedMask(a.0 < b.0)
    }

    fn le(a: Self, b: Self) -> CountedMask {
        tick(|count| &mut count.add);
        CountedMask(a.0 <= b.0)
    }

    fn eq(a: Self, b: Self) -> CountedMask {
        tick(|count| &mut count.add);
        CountedMask(Real::eq(a.0, b.0))
    }

    fn select(mask: CountedMask, a: Self, b: Self) -> Self {
        tick(|count| &mut count.logic);
        if mask.0 { a } else { b }
    }

    fn masked(self, mask: CountedMask) -> Self {
        tick(|count| &mut count.logic);
        Self(self.0.masked(mask.0))
    }

    fn nan_where(self, mask: CountedMask) -> Self {
        tick(|count| &mut count.logic);
        Self(self.0.nan_where(mask.0))
    }

    fn min(a: Self, b: Self) -> Self {
        tick(|count| &mut count.add);
        Self(f32::select(a.0 < b.0, a.0, b.0))
    }

    fn max(a: Self, b: Self) -> Self {
        tick(|count| &mut count.add);
        Self(f32::select(a.0 > b.0, a.0, b.0))
    }
}

impl Lanes for Counted {
    type Wide = f64;

    fn widen(self) -> f64 {
        f64::from(self.0)
    }

    fn narrow(wide: f64) -> Self {
        Self(wide as f32)
    }

    fn load(from: &[f32; WIDTH]) -> Self {
        Self(from[0])
    }

    fn store(self, to: &mut [f32; WIDTH]) {
        *to = [self.0; WIDTH];
    }
}
