//! Vectors in `f64`, for brute force.

use sinew_math::{Rotation, Vec3};

pub type Wide = [f64; 3];

pub fn wide(v: Vec3) -> Wide {
    [f64::from(v.x), f64::from(v.y), f64::from(v.z)]
}

pub fn add(a: Wide, b: Wide, k: f64) -> Wide {
    [0, 1, 2].map(|i| a[i] + b[i] * k)
}

pub fn dot(a: Wide, b: Wide) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn length(a: Wide) -> f64 {
    dot(a, a).sqrt()
}

/// Returns the columns of a rotation's matrix, from the normalised quaternion.
pub fn axes(r: Rotation) -> [Wide; 3] {
    let q = [r.x, r.y, r.z, r.w].map(f64::from);
    let n = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [x, y, z, w] = q.map(|x| x / n);
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)],
        [2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)],
        [2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}
