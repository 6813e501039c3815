//! Tests of the mathematics against arithmetic in `f64`, over random cases and those at the edge.

mod bits;
mod euler;
mod oracle;
mod orthonormal;
mod quaternion;
mod rotation;
mod trig;
