//! Tests of matrices that are nearly rotations.

use super::oracle::{Exact, matrix_off, worst};
use sinew_math::{
    Mat3, MatrixDrift, Orthonormalization, Orthonormalized, Random, Rotation, Sym3, Uniqueness, Vec3,
    orthonormalize,
};

const BOTH: [Orthonormalization; 2] = [Orthonormalization::Polar, Orthonormalization::GramSchmidt];

fn random_matrix(random: &mut Random) -> Mat3 {
    Mat3::from_cols(random.in_cube(), random.in_cube(), random.in_cube())
}

fn length(m: &Mat3) -> f32 {
    m.to_cols_array().iter().map(|x| x * x).sum::<f32>().sqrt()
}

#[test]
fn drift_of_rotations_is_rounding() {
    let deviation = worst(30, |random| f64::from(MatrixDrift::of(&random.rotation().to_mat3()).deviation));
    let volume =
        worst(30, |random| f64::from(MatrixDrift::of(&random.rotation().to_mat3()).determinant - 1.0).abs());
    assert!(deviation < 2e-6 && volume < 1.5e-6, "{deviation} {volume}");
}

#[test]
fn drift_of_known_matrices() {
    let of = |x, y, z| MatrixDrift::of(&Mat3::from_diagonal(Vec3::new(x, y, z)));
    assert_eq!(of(1.0, 1.0, 1.0), MatrixDrift { deviation: 0.0, determinant: 1.0 });
    assert_eq!(of(1.0, -1.0, 1.0), MatrixDrift { deviation: 0.0, determinant: -1.0 });
    assert_eq!(of(2.0, 1.0, 1.0), MatrixDrift { deviation: 3.0, determinant: 2.0 });
    assert_eq!(of(0.0, 1.0, 1.0), MatrixDrift { deviation: 1.0, determinant: 0.0 });
    let shear = Mat3::from_cols(Vec3::X, Vec3::new(0.1, 1.0, 0.0), Vec3::Z);
    let drift = MatrixDrift::of(&shear);
    assert!(
        (drift.deviation - (0.02f32 + 1e-4).sqrt()).abs() < 1e-6 && drift.determinant == 1.0,
        "{drift:?}"
    );
}

#[test]
fn rotations_are_kept() {
    for method in BOTH {
        let error = worst(31, |random| {
            let rotation = random.rotation();
            let found = orthonormalize(&rotation.to_mat3(), method);
            assert_eq!(found.answer, Uniqueness::Unique);
            assert!(found.residual < 2e-6, "{found:?}");
            Exact::of(rotation).error(found.rotation)
        });
        assert!(error < 2e-6, "{method:?}: {error}");
    }
}

#[test]
fn polar_removes_all_stretch() {
    // M = R S with S symmetric and positive: the polar rotation is R for every S.
    let error = worst(32, |random| {
        let (rotation, frame) = (random.rotation(), random.rotation());
        let sizes = Vec3::new(random.range(0.2, 3.0), random.range(0.2, 3.0), random.range(0.2, 3.0));
        let stretch = Sym3::from_rotated_diagonal(frame, sizes).to_mat3();
        let found = orthonormalize(&(rotation.to_mat3() * stretch), Orthonormalization::Polar);
        assert_eq!(found.answer, Uniqueness::Unique);
        let changed = (sizes - Vec3::ONE).length();
        assert!((found.residual - changed).abs() < 1e-5, "{found:?} {changed}");
        Exact::of(rotation).error(found.rotation)
    });
    assert!(error < 1.5e-5, "{error}");
}

/// Checks that no other rotation is nearer: neither Gram-Schmidt's nor any neighbouring one.
#[test]
fn polar_is_nearest() {
    worst(33, |random| {
        let m = random_matrix(random);
        let found = orthonormalize(&m, Orthonormalization::Polar);
        let scale = length(&m);
        let rival = orthonormalize(&m, Orthonormalization::GramSchmidt);
        assert!(
            found.residual <= rival.residual + 2e-6 * scale,
            "{m:?}: {found:?}, a better one is {rival:?}"
        );
        let beside = Rotation::from_axis_angle(random.direction(), random.range(-1.0, 1.0)) * found.rotation;
        let distance = length(&(m - beside.to_mat3()));
        assert!(found.residual <= distance + 2e-6 * scale, "{m:?}: {found:?}, better nearby is {beside:?}");
        0.0
    });
}

#[test]
fn polar_is_independent_of_axes() {
    // In other axes the polar result is the same, but Gram-Schmidt's is not.
    let turned = |m: &Mat3, method| {
        let axes = Rotation::from_axis_angle(Vec3::ONE.normalize(), 1.0);
        let there = orthonormalize(&(*m * axes.to_mat3()), method).rotation;
        orthonormalize(m, method).rotation.angle_to(there * axes.inverse())
    };
    let shear = Mat3::from_cols(Vec3::X, Vec3::new(0.5, 1.0, 0.0), Vec3::new(0.0, 0.3, 1.0));
    assert!(turned(&shear, Orthonormalization::Polar) < 1e-6);
    assert!(turned(&shear, Orthonormalization::GramSchmidt) > 0.01);
}

#[test]
fn size_does_not_matter() {
    for size in [1e-36, 1e-6, 1e6, 1e36] {
        let rotation = Rotation::from_axis_angle(Vec3::ONE.normalize(), 2.0);
        let found = orthonormalize(&(rotation.to_mat3() * size), Orthonormalization::Polar);
        assert!(
            found.rotation.angle_to(rotation) < 1e-6 && found.answer == Uniqueness::Unique,
            "{size}: {found:?}"
        );
    }
}

#[test]
fn mirrored_matrices_have_an_answer() {
    // The axis with the smallest stretch is reversed.
    let mirror = Mat3::from_diagonal(Vec3::new(2.0, -0.5, 1.0));
    let found = orthonormalize(&mirror, Orthonormalization::Polar);
    assert!(
        found.rotation.angle_to(Rotation::IDENTITY) < 1e-6 && found.answer == Uniqueness::Unique,
        "{found:?}"
    );
    assert!((found.residual - (1.0f32 + 2.25).sqrt()).abs() < 1e-6);
    for method in BOTH {
        let found = orthonormalize(&Mat3::from_diagonal(Vec3::new(1.0, 1.0, -1.0)), method);
        assert!(matrix_off(&found.rotation.to_mat3(), &Mat3::IDENTITY) < 2.0 + 1e-6, "{found:?}");
        assert!((found.residual - 2.0).abs() < 1e-6, "{found:?}");
    }
}

#[test]
fn degenerate_matrices_have_an_answer() {
    let parallel = Mat3::from_cols(Vec3::X, Vec3::X * 2.0, Vec3::X * -1.0);
    let cases = [Mat3::ZERO, parallel, parallel * 1e-20, Mat3::from_diagonal(Vec3::X)];
    for method in BOTH {
        for m in cases {
            let found = orthonormalize(&m, method);
            assert_eq!(found.answer, Uniqueness::Arbitrary, "{method:?} {m:?} {found:?}");
            assert!((found.rotation.length() - 1.0).abs() < 1e-6, "{method:?} {m:?} {found:?}");
        }
        assert_eq!(orthonormalize(&Mat3::ZERO, method).rotation, Rotation::IDENTITY);
        let poisoned = orthonormalize(&Mat3::from_diagonal(Vec3::new(1.0, f32::NAN, 1.0)), method);
        let expected = Orthonormalized {
            rotation: Rotation::IDENTITY,
            residual: f32::INFINITY,
            answer: Uniqueness::Arbitrary,
        };
        assert_eq!(poisoned, expected);
    }
    let point_mirror = orthonormalize(&(Mat3::IDENTITY * -1.0), Orthonormalization::Polar);
    assert_eq!(point_mirror.answer, Uniqueness::Arbitrary);
    // A flat matrix of rank 2 still has one nearest rotation.
    let flat = orthonormalize(&Mat3::from_diagonal(Vec3::new(1.0, 2.0, 0.0)), Orthonormalization::Polar);
    assert!(flat.answer == Uniqueness::Unique && flat.rotation.angle_to(Rotation::IDENTITY) < 1e-6);
}
