//! Compares trigonometry with that of `f64`, in units of the last place.

use super::oracle::{angle, largest, worst};
use core::f32::consts::{FRAC_PI_2, PI};
use sinew_math::trig;

/// Returns the error in units of the last place of the exact result; results below 1e-30 count as 1e-30.
fn ulps(found: f32, exact: f64) -> f64 {
    let size = f32::max((exact as f32).abs(), 1e-30);
    let ulp = f64::from(f32::from_bits(size.to_bits() + 1)) - f64::from(size);
    (f64::from(found) - exact).abs() / ulp
}

#[test]
fn sine_cosine_and_tangent() {
    let error = worst(50, |random| {
        let x = if random.index(4) == 0 { random.range(-1e6, 1e6) } else { angle(random) };
        let (sin, cos) = f64::from(x).sin_cos();
        assert_eq!(trig::sin_cos(x), (trig::sin(x), trig::cos(x)));
        largest([ulps(trig::sin(x), sin), ulps(trig::cos(x), cos), ulps(trig::tan(x), sin / cos)])
    });
    assert!(error < 1.0, "{error}");
}

#[test]
fn inverse_functions() {
    let error = worst(51, |random| {
        let (x, y) =
            (random.range(-1.0, 1.0), random.range(-1.0, 1.0) * trig::pow(10.0, random.range(-9.0, 9.0)));
        let wide = f64::from(x);
        largest([
            ulps(trig::asin(x), wide.asin()),
            ulps(trig::acos(x), wide.acos()),
            ulps(trig::atan2(y, x), f64::from(y).atan2(wide)),
        ])
    });
    assert!(error < 1.5, "{error}");
    // Arguments beyond 1 through rounding are clamped to 1.
    assert_eq!((trig::asin(1.000_001), trig::asin(-2.0)), (FRAC_PI_2, -FRAC_PI_2));
    assert_eq!(trig::acos(1.000_001), 0.0);
    assert!((trig::acos(-2.0) - PI).abs() < 3e-7);
    assert_eq!((trig::atan2(0.0, 0.0), trig::atan2(0.0, -1.0), trig::atan2(-0.0, -1.0)), (0.0, PI, -PI));
}

#[test]
fn powers() {
    let error = worst(52, |random| {
        let (x, y) = (random.range(-20.0, 20.0), random.range(-3.0, 3.0));
        let (positive, wide) = (random.range(1e-3, 1e3), f64::from(x));
        largest([
            ulps(trig::exp(x), wide.exp()),
            ulps(trig::exp_m1(x), wide.exp_m1()),
            ulps(trig::ln(positive), f64::from(positive).ln()),
            ulps(trig::pow(positive, y), f64::from(positive).powf(f64::from(y))),
            ulps(trig::cbrt(x), wide.cbrt()),
        ])
    });
    assert!(error < 1.0, "{error}");
}
