//! Reference computations in `f64`.

use sinew_anim::{LocalTransform, Rig};
use sinew_math::Rotation;

pub fn quaternion(q: Rotation) -> [f64; 4] {
    [q.x, q.y, q.z, q.w].map(f64::from)
}

pub fn dot(a: [f64; 4], b: [f64; 4]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub fn unit(q: [f64; 4]) -> [f64; 4] {
    let length = dot(q, q).sqrt();
    q.map(|x| x / length)
}

/// Returns the angle between rotations, radians.
pub fn angle(a: [f64; 4], b: [f64; 4]) -> f64 {
    let (a, b) = (unit(a), unit(b));
    let sign = if dot(a, b) < 0.0 { -1.0 } else { 1.0 };
    let chord = a.iter().zip(b).map(|(a, b)| (a - sign * b) * (a - sign * b)).sum::<f64>().sqrt();
    4.0 * (0.5 * chord).asin()
}

/// Returns the weighted mean on the hemisphere of `rest`.
pub fn mean(rest: Rotation, layers: &[(Rotation, f32)]) -> [f64; 4] {
    let rest = quaternion(rest);
    let mut sum = [0.0; 4];
    for &(q, weight) in layers {
        let q = quaternion(q);
        let sign = if dot(q, rest) < 0.0 { -1.0 } else { 1.0 };
        for i in 0..4 {
            sum[i] += sign * f64::from(weight) * q[i];
        }
    }
    unit(sum)
}

/// A 3×4 matrix by rows.
pub type Matrix = [[f64; 4]; 3];

fn local_matrix(local: &LocalTransform) -> Matrix {
    let [x, y, z, w] = quaternion(local.rotation);
    let s = local.scale.to_array().map(f64::from);
    let t = local.translation.to_array().map(f64::from);
    let r = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ];
    std::array::from_fn(|i| [r[i][0] * s[0], r[i][1] * s[1], r[i][2] * s[2], t[i]])
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let last = |j: usize| if j == 3 { 1.0 } else { 0.0 };
    std::array::from_fn(|i| {
        std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j] + a[i][3] * last(j))
    })
}

/// Returns the model-space matrices of a pose.
pub fn model(rig: &Rig, pose: &[LocalTransform]) -> Vec<Matrix> {
    let mut out: Vec<Matrix> = Vec::new();
    for (joint, local) in rig.joints.iter().zip(pose) {
        let own = local_matrix(local);
        out.push(joint.parent.map_or(own, |parent| product(&out[parent], &own)));
    }
    out
}
