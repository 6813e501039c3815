//! Checks that every kernel gives the same bits on all registers of this processor.

use super::add::Add;
use super::blend::{Blend, BlendLayer, Mask, RotationMean};
use super::model::ToModel;
use super::soa::Pose;
use crate::rig::LocalTransform;
use sinew_math::dispatch::{Level, run_at};
use sinew_math::{Random, Vec3};

const JOINTS: usize = 21;

fn pose(random: &mut Random) -> Pose {
    let local = |_| LocalTransform {
        translation: random.in_cube(),
        rotation: random.rotation(),
        scale: Vec3::splat(random.range(0.5, 2.0)),
    };
    (0..JOINTS).map(local).collect()
}

/// Asserts that `run` changes a pose that starts as `start`, with the same result on each level.
fn same_on_all(start: &Pose, run: impl Fn(Level, &mut Pose)) {
    let result = |level| {
        let mut out = start.clone();
        run(level, &mut out);
        out
    };
    let scalar = result(Level::Scalar);
    assert_ne!(scalar, *start, "the operation changes the pose");
    for level in Level::available() {
        assert_eq!(result(level), scalar, "{level:?}");
    }
}

#[test]
fn blends_have_the_same_bits_on_all_registers() {
    let mut random = Random::new(1);
    let poses: Vec<Pose> = (0..4).map(|_| pose(&mut random)).collect();
    let mask: Mask = (0..JOINTS).map(|joint| if joint % 5 == 0 { 0.0 } else { random.unit() }).collect();
    let layer = |i: usize, weight| BlendLayer { pose: &poses[i], weight, mask: Some(&mask) };
    let layers = [layer(0, 0.7), layer(1, 0.4), layer(2, 0.01)];
    let (order, rest) = ([0, 1, 2], poses[3].blocks());
    for (mean, fill_below) in [(RotationMean::Sum, 0.0), (RotationMean::Exact, 0.5)] {
        same_on_all(&Pose::new(JOINTS), |level, out| {
            let out = out.blocks_mut();
            run_at(level, Blend { rest, layers: &layers, order: &order, fill_below, mean, out });
        });
    }
    same_on_all(&poses[3], |level, out| {
        run_at(level, Add { layers: &layers, order: &order, pose: out.blocks_mut() });
    });
}

#[test]
fn model_space_has_the_same_bits_on_all_registers() {
    let local = pose(&mut Random::new(2));
    let parents: Vec<u32> = (0..JOINTS as u32).map(|joint| joint.div_ceil(2)).collect();
    let on = |level| {
        let mut model = vec![[[1.0, 0.5, 0.25, 0.0]; 4]; JOINTS + 1];
        run_at(level, ToModel { parents: &parents, local: local.blocks(), model: &mut model });
        model
    };
    for level in Level::available() {
        assert_eq!(on(level), on(Level::Scalar), "{level:?}");
    }
}
