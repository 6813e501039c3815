//! Checks that bits are equal on every target and in every profile. The stored hash of a few thousand rotations
//! changes only if a formula does.

use sinew_math::{
    EulerConvention, Orthonormalization, Quaternion, Random, Rotation, StableHasher, Vec3, orthonormalize,
};

fn hash_of(numbers: impl Fn(&mut Random) -> Vec<f32>) -> String {
    let mut hasher = StableHasher::default();
    let mut random = Random::new(60);
    for _ in 0..2000 {
        for number in numbers(&mut random) {
            hasher.write(&number.to_bits().to_le_bytes());
        }
    }
    format!("{:016x}", hasher.finish())
}

fn four(r: Rotation) -> [f32; 4] {
    [r.x, r.y, r.z, r.w]
}

#[test]
fn rotations() {
    let hash = hash_of(|random| {
        let (a, b, v, t) = (random.rotation(), random.rotation(), random.direction(), random.unit());
        let near = Rotation::from_scaled_axis(v * (1e-3 * t)) * a;
        let (swing, twist) = a.swing_twist(v);
        let turns = [
            a * b,
            Rotation::about(v, 10.0 * t),
            a.slerp(b, t),
            a.slerp(near, t),
            a.nlerp(b, t),
            swing,
            twist,
            a.integrate(v * 20.0, 0.01),
            Rotation::from_arc(v, a * v),
            Rotation::from_arc(a * v, -(near * v)),
            Rotation::from_mat3(&a.to_mat3()),
        ];
        let vectors =
            [a * v, a.turn(v), a.to_scaled_axis(), a.to_axis_angle().0, a.angular_velocity_to(b, 0.1)];
        turns
            .map(four)
            .into_iter()
            .flatten()
            .chain(vectors.map(|v| v.to_array()).into_iter().flatten())
            .collect()
    });
    assert_eq!(hash, "287ea0c827fc6735");
}

#[test]
fn euler_angles() {
    let hash = hash_of(|random| {
        let rotation = random.rotation();
        let of = |convention| {
            let found = rotation.to_euler(convention);
            let back = Rotation::from_euler(convention, found.angles);
            found.angles.into_iter().chain([found.lock_margin]).chain(four(back))
        };
        EulerConvention::all().flat_map(of).collect()
    });
    assert_eq!(hash, "f4230dff136883cb");
}

#[test]
fn matrices_and_quotients() {
    let hash = hash_of(|random| {
        let m = random.rotation().to_mat3() + random.rotation().to_mat3() * 0.5;
        let methods = [Orthonormalization::Polar, Orthonormalization::GramSchmidt];
        let mended = methods.map(|method| four(orthonormalize(&m, method).rotation));
        let (v, from) = (random.in_cube(), random.direction());
        let q = Quaternion::quotient(v, from).expect("a direction is not zero");
        let vectors = [q.apply(v), q.sandwich(v), q.power(0.3).apply(v), (q * Quaternion::from(v)).vector];
        let turns = [mended[0], mended[1], four(q.to_rotation())];
        turns.into_iter().flatten().chain(vectors.map(|v: Vec3| v.to_array()).into_iter().flatten()).collect()
    });
    assert_eq!(hash, "99e758ac74477988");
}
