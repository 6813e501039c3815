//! Trigonometry with the same bits on every target: the pure-Rust `libm`, not the platform's library.

/// Sine of `x` radians.
pub fn sin(x: f32) -> f32 {
    libm::sinf(x)
}
/// Cosine of `x` radians.
pub fn cos(x: f32) -> f32 {
    libm::cosf(x)
}
/// Sine and cosine of `x` radians.
pub fn sin_cos(x: f32) -> (f32, f32) {
    libm::sincosf(x)
}
/// Tangent of `x` radians.
pub fn tan(x: f32) -> f32 {
    libm::tanf(x)
}
/// Angle in radians whose sine is `x`, `x` limited to −1..=1.
pub fn asin(x: f32) -> f32 {
    libm::asinf(crate::clamp(x, -1.0, 1.0))
}
/// Angle in radians, 0..=π, whose cosine is `x`, `x` limited to −1..=1.
pub fn acos(x: f32) -> f32 {
    libm::acosf(crate::clamp(x, -1.0, 1.0))
}
/// Angle in radians, −π..=π, of the point (`x`, `y`) from the x axis.
pub fn atan2(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}
/// `e` to the power `x`.
pub fn exp(x: f32) -> f32 {
    libm::expf(x)
}
/// Returns `e` to the power `x`, minus 1, accurate near 0.
pub fn exp_m1(x: f32) -> f32 {
    libm::expm1f(x)
}
/// Natural logarithm of `x`.
pub fn ln(x: f32) -> f32 {
    libm::logf(x)
}
/// `x` to the power `y`.
pub fn pow(x: f32, y: f32) -> f32 {
    libm::powf(x, y)
}
/// Cube root of `x`.
pub fn cbrt(x: f32) -> f32 {
    libm::cbrtf(x)
}
