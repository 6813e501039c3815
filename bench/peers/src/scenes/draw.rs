//! Random draws in the order of the baselines, so that a scene is the same wherever it is written down.

use sinew::math::{Random, Rotation, Vec3};

/// Each component uniform in `lo..hi`, x first.
pub fn vector(random: &mut Random, lo: f32, hi: f32) -> Vec3 {
    let [x, y, z] = [(); 3].map(|()| random.range(lo, hi));
    Vec3::new(x, y, z)
}

/// Uniform over all rotations, by three numbers (Shoemake, "Uniform random rotations", Graphics Gems III, 1992).
pub fn rotation(random: &mut Random) -> Rotation {
    use sinew::math::trig::sin_cos;
    let [u1, u2, u3] = [(); 3].map(|()| random.unit());
    let (near, far) = ((1.0 - u1).sqrt(), u1.sqrt());
    let (sin2, cos2) = sin_cos(core::f32::consts::TAU * u2);
    let (sin3, cos3) = sin_cos(core::f32::consts::TAU * u3);
    Rotation::from_xyzw(near * sin2, near * cos2, far * sin3, far * cos3).normalize()
}
