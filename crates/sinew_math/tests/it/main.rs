//! Tests of the mathematics against arithmetic in `f64`, over random and extreme cases.

mod bits;
mod euler;
mod oracle;
mod orthonormal;
mod quaternion;
mod rotation;
mod trig;
