//! Tests of general quaternions.

use super::oracle::{Exact, largest, norm, off, wide, worst};
use core::f32::consts::PI;
use sinew_math::{Quaternion, Random, Rotation, Vec3, any_orthonormal, trig};

fn random_quaternion(random: &mut Random) -> Quaternion {
    let size = trig::pow(10.0, random.range(-3.0, 3.0));
    Quaternion::new(random.range(-1.0, 1.0), random.in_cube()) * size
}

/// Returns the distance of two quaternions over the length of the second.
fn apart(a: Quaternion, b: Quaternion) -> f64 {
    f64::from((a - b).norm()) / f64::from(b.norm())
}

#[test]
fn quotient_takes_one_vector_into_the_other() {
    let error = worst(40, |random| {
        let size = |random: &mut Random| trig::pow(10.0, random.range(-9.0, 9.0));
        let a = random.direction() * size(random);
        let b = random.direction() * size(random) * a.length();
        let q = Quaternion::quotient(b, a).expect("a is not zero");
        let stretch = (f64::from(q.norm()) * norm(wide(a)) / norm(wide(b)) - 1.0).abs();
        let product = q * Quaternion::from(a);
        let rest = f64::from(product.scalar.abs() / product.norm());
        let by_rotation = off(q.to_rotation() * a * q.norm(), wide(b));
        largest([stretch, rest, off(q.apply(a), wide(b)), off(product.vector, wide(b)), by_rotation])
    });
    assert!(error < 2.5e-6, "{error}");
}

#[test]
fn degenerate_vectors_have_stated_quotients() {
    let a = Vec3::new(0.0, 2.0, 0.0);
    assert_eq!(Quaternion::quotient(a, a), Some(Quaternion::ONE));
    assert_eq!(Quaternion::quotient(Vec3::ZERO, a), Some(Quaternion::ZERO));
    let opposite = Quaternion::quotient(a * -3.0, a).expect("a is not zero");
    assert_eq!((opposite.scalar, opposite.axis(), opposite.angle()), (-3.0, None, PI));
    assert_eq!(opposite.apply(a), a * -3.0);
    assert_eq!(opposite.to_rotation(), Rotation::from_xyzw(1.0, 0.0, 0.0, 0.0));
    for (to, from) in [(a, Vec3::ZERO), (a, Vec3::NAN), (Vec3::NAN, a), (a * f32::INFINITY, a)] {
        assert_eq!(Quaternion::quotient(to, from), None);
    }
}

#[test]
fn zero_has_answers() {
    let zero = Quaternion::ZERO;
    assert_eq!((zero.norm(), zero.angle(), zero.axis()), (0.0, 0.0, None));
    assert_eq!((zero.versor(), zero.inverse()), (Quaternion::ONE, None));
    assert_eq!((zero.to_rotation(), zero.apply(Vec3::ONE)), (Rotation::IDENTITY, Vec3::ZERO));
    assert_eq!(Quaternion::new(f32::NAN, Vec3::X).inverse(), None);
    assert_eq!(Quaternion::new(f32::INFINITY, Vec3::X).versor(), Quaternion::ONE);
}

#[test]
fn versor_times_scale() {
    let error = worst(41, |random| {
        let (scale, axis, angle) = (random.range(0.01, 9.0), random.direction(), random.range(0.0, PI));
        let q = Quaternion::from_scale_axis_angle(scale, axis, angle);
        let turned = Exact::about(wide(axis), f64::from(angle));
        // The vector need not be perpendicular to the axis.
        let v = random.direction();
        let expected = turned.turn(wide(v)).map(|x| x * f64::from(scale));
        largest([
            f64::from(q.norm() / scale - 1.0).abs(),
            f64::from(q.angle() - angle).abs(),
            apart(q.versor() * q.norm(), q),
            turned.error(q.to_rotation()),
            off(q.apply(v), expected),
        ])
    });
    assert!(error < 2e-6, "{error}");
}

#[test]
fn algebra() {
    let error = worst(42, |random| {
        let [p, q, r] = [0; 3].map(|_| random_quaternion(random));
        let inverse = q.inverse().expect("it is not zero");
        let size = p.norm() * q.norm() * r.norm();
        let (left, right) = ((p * q) * r, p * (q * r));
        let sum = (p + q) * r - (p * r + q * r);
        largest([
            f64::from((left - right).norm() / size),
            f64::from(sum.norm() / ((p.norm() + q.norm()) * r.norm())),
            apart(q * inverse, Quaternion::ONE),
            apart(inverse * q, Quaternion::ONE),
            f64::from(((p * q).conjugate() - q.conjugate() * p.conjugate()).norm() / (p * q).norm()),
            f64::from((p * q).norm() / (p.norm() * q.norm()) - 1.0).abs(),
            apart(q * q.conjugate(), Quaternion::new(q.norm_squared(), Vec3::ZERO)),
        ])
    });
    assert!(error < 2e-6, "{error}");
}

#[test]
fn hamiltons_table() {
    let [i, j, k] = [Vec3::X, Vec3::Y, Vec3::Z].map(Quaternion::from);
    let minus_one = -Quaternion::ONE;
    assert_eq!([i * i, j * j, k * k, i * j * k], [minus_one; 4]);
    assert_eq!([i * j, j * k, k * i], [k, i, j]);
    assert_eq!([j * i, k * j, i * k], [-k, -i, -j]);
}

#[test]
fn sandwich_is_a_rotation_by_twice_the_angle() {
    let error = worst(43, |random| {
        let (rotation, v) = (random.rotation(), random.direction());
        let unit = off(Quaternion::from(rotation).sandwich(v), Exact::of(rotation).turn(wide(v)));
        let [p, q] = [0; 2].map(|_| random_quaternion(random));
        let size = (p * q).norm_squared();
        let chained = ((p * q).sandwich(v) - p.sandwich(q.sandwich(v))).length() / size;
        largest([unit, f64::from(chained)])
    });
    assert!(error < 2e-6, "{error}");
    let quarter = Quaternion::from_scale_axis_angle(1.0, Vec3::Z, 0.5 * PI);
    assert!((quarter.apply(Vec3::X) - Vec3::Y).length() < 1e-6);
    assert!((quarter.sandwich(Vec3::X) + Vec3::X).length() < 1e-6);
}

#[test]
fn quotients_in_one_plane_follow_each_other() {
    // c/a = (c/b)(b/a) for any vectors; in one plane the rotations and stretches also compose.
    let error = worst(44, |random| {
        let [a, b, c] = [0; 3].map(|_| random.direction() * random.range(0.1, 5.0));
        let q = |to, from| Quaternion::quotient(to, from).expect("none is zero");
        let general = apart(q(c, b) * q(b, a), q(c, a));
        let axis = random.direction();
        let in_plane = any_orthonormal(axis);
        let [p, r] = [0; 2].map(|_| Quaternion::from_scale_axis_angle(1.5, axis, random.range(-1.5, 1.5)));
        let chained = ((p * r).apply(in_plane) - p.apply(r.apply(in_plane))).length();
        largest([general, f64::from(chained)])
    });
    assert!(error < 4e-6, "{error}");
}

#[test]
fn parts_recombine_to_the_quaternion() {
    let error = worst(45, |random| {
        let (q, t) = (random_quaternion(random), random.range(-2.0, 3.0));
        largest([apart(q.power(t) * q.power(1.0 - t), q), apart(q.power(2.0), q * q)])
    });
    assert!(error < 5e-6, "{error}");
    assert_eq!(Quaternion::ZERO.power(2.0), Quaternion::ZERO);
    assert_eq!(Quaternion::new(4.0, Vec3::ZERO).power(0.5), Quaternion::new(2.0, Vec3::ZERO));
    // The square root of −1.
    assert!((Quaternion::new(-1.0, Vec3::ZERO).power(0.5) - Quaternion::from(Vec3::X)).norm() < 1e-6);
}

#[test]
fn every_size_has_a_versor_and_an_inverse() {
    for size in [1e-36, 1e-20, 1.0, 1e20, 1e36] {
        let q = Quaternion::new(3.0, Vec3::new(0.0, 4.0, 0.0)) * size;
        assert!((q.versor() - Quaternion::new(0.6, Vec3::Y * 0.8)).norm() < 1e-6, "{size}");
        let inverse = q.inverse().expect("it is not zero");
        assert!((q * inverse - Quaternion::ONE).norm() < 1e-6, "{size}");
    }
}
