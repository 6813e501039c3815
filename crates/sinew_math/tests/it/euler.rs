//! Euler angles in all 24 conventions.

use super::oracle::{CASES, Exact, angle, worst_of};
use core::f32::consts::{FRAC_PI_2, PI, TAU};
use sinew_math::{EulerAngles, EulerAxes, EulerConvention, EulerOrder, GimbalLock, Random, Rotation, trig};

/// Number of cases per convention, if all conventions together give enough cases.
const SHARE: usize = CASES / 20;

/// Returns the rotation by definition.
fn exact(convention: EulerConvention, angles: [f64; 3]) -> Exact {
    let turn = |i: usize| {
        let mut axis = [0.0; 3];
        axis[convention.order.indices()[i]] = 1.0;
        Exact::about(axis, angles[i])
    };
    match convention.axes {
        EulerAxes::Moving => turn(0).then(turn(1)).then(turn(2)),
        EulerAxes::Fixed => turn(2).then(turn(1)).then(turn(0)),
    }
}

/// Middle angles at which a convention is in gimbal lock.
fn locks(convention: EulerConvention) -> [f32; 2] {
    if convention.order.is_proper() { [0.0, PI] } else { [-FRAC_PI_2, FRAC_PI_2] }
}

fn check_range(convention: EulerConvention, found: EulerAngles) {
    let [first, second, third] = found.angles;
    let [lo, hi] = locks(convention);
    assert!(
        first.abs() <= PI && third.abs() <= PI && (lo..=hi).contains(&second),
        "{convention:?}: angles out of range: {found:?}"
    );
    assert!(
        (0.0..=FRAC_PI_2 + 1e-6).contains(&found.lock_margin),
        "{convention:?}: lock margin out of range: {found:?}"
    );
}

/// Returns the largest result of a function over all conventions and cases, called with a rotation, its angles, and
/// the largest error of the angles.
fn worst(cases: usize, seed: u64, mut rotation: impl FnMut(EulerConvention, &mut Random) -> Rotation) -> f64 {
    let mut most = 0.0;
    for convention in EulerConvention::all() {
        let mut random = Random::new(seed);
        for case in 0..cases {
            let rotation = rotation(convention, &mut random);
            let found = rotation.to_euler(convention);
            check_range(convention, found);
            let error = exact(convention, found.angles.map(f64::from)).error(rotation);
            assert!(error < 1e-5, "{convention:?}, case {case}: {rotation:?} gives {found:?}");
            most = if error > most { error } else { most };
        }
    }
    println!("worst {most:.3e}");
    most
}

#[test]
fn there_are_twenty_four() {
    let all: Vec<_> = EulerConvention::all().collect();
    let different: std::collections::HashSet<_> = all.iter().collect();
    assert_eq!((all.len(), different.len()), (24, 24));
    assert_eq!(EulerOrder::ALL.iter().filter(|order| order.is_proper()).count(), 6);
}

#[test]
fn from_angles() {
    for convention in EulerConvention::all() {
        let error = worst_of(SHARE, 20, |random| {
            let angles = [angle(random), angle(random), angle(random)];
            exact(convention, angles.map(f64::from)).error(Rotation::from_euler(convention, angles))
        });
        assert!(error < 1e-6, "{convention:?}: error {error} rad");
        assert_eq!(Rotation::from_euler(convention, [0.0, f32::NAN, 0.0]), Rotation::IDENTITY);
    }
}

#[test]
fn random_rotations_round_trip() {
    let error = worst(CASES, 21, |_, random| random.rotation());
    assert!(error < 1.5e-6, "{error}");
}

#[test]
fn rotations_close_to_lock_round_trip() {
    let error = worst(SHARE, 22, |convention, random| {
        let lock = locks(convention)[random.index(2)];
        let near = 10f64.powf(f64::from(random.range(-8.0, -1.0))) as f32;
        let sign = if random.index(2) == 0 { 1.0 } else { -1.0 };
        Rotation::from_euler(convention, [random.range(-PI, PI), lock + sign * near, random.range(-PI, PI)])
    });
    // At gimbal lock the error is at most the margin.
    assert!(error < 4.5e-6, "{error}");
}

#[test]
fn angles_round_trip_away_from_lock() {
    for convention in EulerConvention::all() {
        let error = worst_of(SHARE, 23, |random| {
            let [lo, hi] = locks(convention);
            let angles = [random.range(-PI, PI), random.range(lo, hi), random.range(-PI, PI)];
            let found = Rotation::from_euler(convention, angles).to_euler(convention);
            let nearest_lock = f32::min(angles[1] - lo, hi - angles[1]);
            assert!(
                (found.lock_margin - nearest_lock).abs() < 1e-6,
                "{convention:?}: lock margin of {angles:?}: {found:?}"
            );
            if found.lock != GimbalLock::Free {
                return 0.0;
            }
            let off = |i: usize| {
                let apart = f64::from(found.angles[i] - angles[i]).rem_euclid(f64::from(TAU));
                f64::min(apart, f64::from(TAU) - apart)
            };
            // An error of the rotation is amplified in the outer angles near the lock.
            let outer = f64::max(off(0), off(2)) * f64::from(trig::sin(found.lock_margin));
            f64::max(outer, off(1))
        });
        assert!(error < 2e-6, "{convention:?}: error {error} rad");
    }
}

#[test]
fn lock_is_reported() {
    for convention in EulerConvention::all() {
        let mut random = Random::new(24);
        for case in 0..SHARE {
            let [lo, hi] = locks(convention);
            let (middle, is_high) = if case % 2 == 0 { (lo, false) } else { (hi, true) };
            let (a, c) = (random.range(-PI, PI), random.range(-PI, PI));
            let rotation = Rotation::from_euler(convention, [a, middle, c]);
            let found = rotation.to_euler(convention);
            let story = format!("{convention:?} {:?} {found:?}", [a, middle, c]);
            assert_eq!(found.angles[2], 0.0, "{story}");
            let blend = match found.lock {
                GimbalLock::Free => panic!("{story}"),
                GimbalLock::OnlySum => a + c,
                GimbalLock::OnlyDifference => a - c,
            };
            assert!(trig::sin((blend - found.angles[0]) / 2.0).abs() < 1e-6, "{story}");
            if convention.order.is_proper() {
                let expected = if is_high { GimbalLock::OnlyDifference } else { GimbalLock::OnlySum };
                assert_eq!(found.lock, expected, "{story}");
            }
        }
    }
}

#[test]
fn small_rotations_keep_full_precision() {
    for order in EulerOrder::ALL.into_iter().filter(|order| !order.is_proper()) {
        let angles = [3e-9, -2e-12, 5e-10];
        for convention in [order.intrinsic(), order.extrinsic()] {
            let found = Rotation::from_euler(convention, angles).to_euler(convention).angles;
            assert!((found[1] / angles[1] - 1.0).abs() < 1e-5, "{convention:?}: angles {found:?}");
        }
        assert_eq!(Rotation::IDENTITY.to_euler(order.intrinsic()).angles, [0.0; 3]);
    }
}

#[test]
fn extrinsic_equals_reversed_intrinsic() {
    let mut random = Random::new(25);
    for _ in 0..1000 {
        let [a, b, c] = [0; 3].map(|_| random.range(-PI, PI));
        let fixed = Rotation::from_euler(EulerOrder::Xyz.extrinsic(), [a, b, c]);
        let moving = Rotation::from_euler(EulerOrder::Zyx.intrinsic(), [c, b, a]);
        assert_eq!(fixed, moving);
    }
}
