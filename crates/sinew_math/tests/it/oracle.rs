//! Rotations in `f64` by their definitions, and random cases.

use sinew_math::{Mat3, Random, Rotation, Vec3};

/// Number of random cases per test.
pub const CASES: usize = 100_000;

/// A quaternion (w, x, y, z).
#[derive(Clone, Copy, Debug)]
pub struct Exact(pub [f64; 4]);

impl Exact {
    pub const IDENTITY: Self = Self([1.0, 0.0, 0.0, 0.0]);

    pub fn of(r: Rotation) -> Self {
        Self([r.w, r.x, r.y, r.z].map(f64::from)).normalize()
    }

    pub fn about(axis: [f64; 3], angle: f64) -> Self {
        let (sin, cos) = (0.5 * angle).sin_cos();
        let scale = sin / norm(axis);
        Self([cos, axis[0] * scale, axis[1] * scale, axis[2] * scale])
    }

    pub fn normalize(self) -> Self {
        let length = self.0.iter().map(|x| x * x).sum::<f64>().sqrt();
        Self(self.0.map(|x| x / length))
    }

    pub fn inverse(self) -> Self {
        let [w, x, y, z] = self.0;
        Self([w, -x, -y, -z])
    }

    pub fn then(self, first: Self) -> Self {
        let ([a, b, c, d], [e, f, g, h]) = (self.0, first.0);
        Self([
            a * e - b * f - c * g - d * h,
            a * f + b * e + c * h - d * g,
            a * g - b * h + c * e + d * f,
            a * h + b * g - c * f + d * e,
        ])
    }

    pub fn turn(self, v: [f64; 3]) -> [f64; 3] {
        let [_, x, y, z] = self.then(Self([0.0, v[0], v[1], v[2]])).then(self.inverse()).0;
        [x, y, z]
    }

    /// Angle of the rotation, 0..=π.
    pub fn angle(self) -> f64 {
        let [w, x, y, z] = self.0;
        2.0 * norm([x, y, z]).atan2(w.abs())
    }

    /// Returns the angle from this rotation to `r`, radians; a deviation from length 1 counts, too.
    pub fn error(self, r: Rotation) -> f64 {
        let [w, x, y, z] = [r.w, r.x, r.y, r.z].map(f64::from);
        let distance = |sign: f64| {
            let [a, b, c, d] = self.0;
            let of = [a - sign * w, b - sign * x, c - sign * y, d - sign * z];
            2.0 * of.iter().map(|x| x * x).sum::<f64>().sqrt()
        };
        if distance(1.0) < distance(-1.0) { distance(1.0) } else { distance(-1.0) }
    }
}

pub fn wide(v: Vec3) -> [f64; 3] {
    v.to_array().map(f64::from)
}

pub fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Returns the largest of several errors; NaN counts as the largest.
pub fn largest(errors: impl IntoIterator<Item = f64>) -> f64 {
    errors
        .into_iter()
        .fold(0.0, |most, error| if error.is_nan() { f64::INFINITY } else { f64::max(most, error) })
}

/// Returns the relative error of a vector: its distance from an exact vector over the length of that vector.
pub fn off(found: Vec3, expected: [f64; 3]) -> f64 {
    let found = wide(found);
    norm([found[0] - expected[0], found[1] - expected[1], found[2] - expected[2]]) / norm(expected)
}

/// Returns the largest difference of the entries of two matrices.
pub fn matrix_off(a: &Mat3, b: &Mat3) -> f64 {
    let (a, b) = (a.to_cols_array(), b.to_cols_array());
    largest(a.iter().zip(b).map(|(x, y)| f64::from(x - y).abs()))
}

/// Returns angles of every size: from 1e-9 to 7 with either sign, and angles at which formulas switch.
pub fn angle(random: &mut Random) -> f32 {
    const EDGES: [f64; 6] = [
        0.0,
        core::f64::consts::FRAC_PI_2,
        core::f64::consts::PI,
        core::f64::consts::TAU,
        1e-4,
        2.0 * core::f64::consts::TAU,
    ];
    let sign = if random.index(2) == 0 { 1.0 } else { -1.0 };
    let small = 10f64.powf(f64::from(random.range(-9.0, 0.0)));
    let size = match random.index(3) {
        0 => f64::from(random.range(0.0, 7.0)),
        1 => small,
        _ => EDGES[random.index(EDGES.len())] + sign * small,
    };
    (sign * size) as f32
}

/// Runs [`CASES`], returns the largest error and prints its case.
pub fn worst(seed: u64, error: impl FnMut(&mut Random) -> f64) -> f64 {
    worst_of(CASES, seed, error)
}

/// Like [`worst`], with another number of cases.
pub fn worst_of(cases: usize, seed: u64, mut error: impl FnMut(&mut Random) -> f64) -> f64 {
    let mut random = Random::new(seed);
    let (mut most, mut at) = (0.0, 0);
    for case in 0..cases {
        let found = largest([most, error(&mut random)]);
        if found != most {
            (most, at) = (found, case);
        }
    }
    println!("worst {most:.3e} at case {at} of seed {seed}");
    most
}
