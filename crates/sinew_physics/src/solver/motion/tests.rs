//! Tests of the kernels that move bodies.

use super::*;
use crate::solver::body::{SolverBody, advance};
use crate::solver::tuning::MOST_HALF_TURN;
use crate::spatial::{angular, join, linear};
use sinew_math::dispatch::{Level, run_at};
use sinew_math::{Random, Vec3};

const H: f32 = 1.0 / 240.0;
const MAX_SPEED: f32 = 4000.0;
const MAX_SPIN: f32 = 377.0;

fn random_vector(random: &mut Random, most: f32) -> Vec3 {
    random.direction() * random.range(0.0, most)
}

fn random_body(random: &mut Random) -> SolverBody {
    let inertia = Vec3::new(random.range(0.5, 1.0), random.range(0.5, 1.0), random.range(0.5, 1.0));
    let rotation = random.rotation();
    SolverBody {
        index: 0,
        pose: Transform::new(random_vector(random, 10.0), rotation),
        mass: random.range(0.1, 50.0),
        inertia: inertia * random.range(0.01, 2.0),
        excess: Vec3::ZERO,
        mass_scale: 1.0,
        inverse_inertia: Sym3::from_rotated_diagonal(rotation, Vec3::ONE / inertia),
        force: random_vector(random, 100.0),
        torque: random_vector(random, 5.0),
        momentum: Vec3::ZERO,
        is_limited: false,
        linear_damping: random.range(0.0, 0.5),
        angular_damping: random.range(0.0, 0.5),
    }
}

fn random_island(count: usize) -> (Vec<SolverBody>, Vec<Vec6>) {
    let mut random = Random::new(11);
    let bodies = (0..count).map(|_| random_body(&mut random)).collect();
    // Some bodies turn by more than the range of the series.
    let fastest = |k: usize| if k.is_multiple_of(5) { 1500.0 } else { 30.0 };
    let velocity = |k: usize| join(random_vector(&mut random, 20.0), random_vector(&mut random, fastest(k)));
    (bodies, (0..count).map(velocity).collect())
}

/// Runs all kernels and returns the bits of all results.
fn substep(level: Level, bodies: &mut [SolverBody], velocities: &mut [Vec6]) -> Vec<u32> {
    let mut bits = Vec::new();
    let energy = run_at(
        level,
        IntegrateVelocity { bodies, velocities, h: H, max_speed: MAX_SPEED, max_spin: MAX_SPIN },
    );
    let before = velocities.to_vec();
    for v in &mut *velocities {
        *v = v.map(|x| x * 1.125);
    }
    let mut gains = Vec::new();
    run_at(level, ListGains { bodies, velocities, before: &before, list: &mut gains });
    let mut poses = vec![Transform::IDENTITY; bodies.len()];
    run_at(level, Predict { bodies, velocities, h: H, poses: &mut poses });
    run_at(level, IntegratePosition { bodies, velocities, before: &before, h: H });
    assert!(
        poses.iter().zip(&*bodies).all(|(pose, body)| *pose == body.pose),
        "predicted poses equal integrated ones"
    );
    run_at(level, RefreshInertia(bodies));
    let after = run_at(level, KineticEnergy { bodies, velocities });
    bits.extend([energy, after].map(f32::to_bits));
    bits.extend(velocities.iter().chain(&gains).flatten().map(|x| x.to_bits()));
    for body in bodies {
        let Transform { translation, rotation } = body.pose;
        let inverse = body.inverse_inertia;
        let vectors = [translation, rotation.vector(), body.momentum, inverse.diagonal, inverse.off];
        bits.extend(vectors.iter().flat_map(Vec3::to_array).map(f32::to_bits));
    }
    bits
}

#[test]
fn kernels_give_the_same_bits_at_every_simd_level() {
    let (bodies, velocities) = random_island(21);
    let results: Vec<_> = Level::available()
        .map(|level| substep(level, &mut bodies.clone(), &mut velocities.clone()))
        .collect();
    assert!(results.windows(2).all(|pair| pair[0] == pair[1]));
}

#[test]
fn body_in_a_batch_has_the_same_bits_as_alone() {
    let (mut bodies, mut velocities) = random_island(21);
    let alone: Vec<_> = bodies
        .iter()
        .zip(&velocities)
        .map(|(body, v)| {
            let (mut body, mut v) = ([body.clone()], [*v]);
            substep(Level::best(), &mut body, &mut v);
            (body[0].pose, v[0])
        })
        .collect();
    substep(Level::best(), &mut bodies, &mut velocities);
    let together = bodies.iter().map(|body| body.pose).zip(velocities);
    assert!(together.eq(alone));
}

#[test]
fn kernel_poses_and_momenta_match_scalar_formulas() {
    let (mut bodies, mut velocities) = random_island(21);
    let before = bodies.clone();
    let kernel = IntegrateVelocity {
        bodies: &mut bodies,
        velocities: &mut velocities,
        h: H,
        max_speed: MAX_SPEED,
        max_spin: MAX_SPIN,
    };
    run_at(Level::best(), kernel);
    for (k, (body, v)) in bodies.iter().zip(&velocities).enumerate() {
        assert!(angular(v).length() <= MAX_SPIN * 1.001, "body {k}");
        // The midpoint spin keeps the momentum of the beginning: I m + τ m × I m equals it.
        let r = body.pose.rotation;
        let (m, momentum) = (r.inverse() * angular(v), r.inverse() * body.momentum);
        let l = m * body.inertia;
        let along = (0.5 * H * m.length()).min(MOST_HALF_TURN);
        let tau = sinew_math::trig::tan(along) / m.length();
        let off = (l + m.cross(l) * tau - momentum).length() / momentum.length();
        assert!(off < 2e-5 || along >= MOST_HALF_TURN, "body {k}: {off}");
    }
    let forces = velocities.clone();
    let kernel =
        IntegratePosition { bodies: &mut bodies, velocities: &mut velocities, before: &forces, h: H };
    run_at(Level::best(), kernel);
    for (k, (body, was)) in bodies.iter().zip(&before).enumerate() {
        let there = advance(&was.pose, &forces[k], H);
        assert!((body.pose.translation - there.translation).length() < 1e-5, "body {k}");
        assert!(body.pose.rotation.angle_to(there.rotation) < 1e-6, "body {k}");
        let spun = body.angular_momentum(angular(&velocities[k]));
        assert!((spun - body.momentum).length() < 1e-5 * body.momentum.length(), "body {k}");
        assert_eq!(linear(&velocities[k]), linear(&forces[k]), "body {k}");
    }
}
