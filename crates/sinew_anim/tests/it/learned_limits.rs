//! Limits learned from motions: synthetic motions give the known limits, and captured knees are hinges.

use crate::mocap::actor;
use crate::toy;
use needs_data::needs_data;
use sinew_anim::learned_limits::{LearnedLimit, learn_limits};
use sinew_anim::{LocalTransform, Take};
use sinew_math::{Random, Rotation, SwingTwistLimit, Vec3};

fn learn(turns: impl Iterator<Item = Rotation>) -> LearnedLimit {
    let local =
        |rotation| [LocalTransform { rotation, ..LocalTransform::default() }, LocalTransform::default()];
    let take = Take { frame_time: 0.01, joints: 2, poses: turns.flat_map(local).collect() };
    let found = learn_limits(&toy::chain(2, Vec3::Y), &[&take]);
    assert_eq!(found.len(), 1, "a joint without motion must have no limit");
    found[0]
}

/// Swings uniform in an ellipse and twists uniform in a range, about a bone along y with a rotated rest pose.
#[test]
fn swing_ellipse_is_recovered() {
    let mut random = Random::new(5);
    let rest = Rotation::from_scaled_axis(Vec3::new(0.3, -0.7, 0.4));
    let main = 0.5;
    let frame = Rotation::from_arc(Vec3::X, Vec3::Y) * Rotation::from_axis_angle(Vec3::X, main);
    let turn = |_| {
        let (y, z) = loop {
            let (y, z) = (random.range(-1.0, 1.0), random.range(-1.0, 1.0));
            if y * y + z * z < 1.0 {
                break (0.8 * y, 0.3 * z);
            }
        };
        let twist = Rotation::from_axis_angle(Vec3::X, random.range(-0.4, 0.4));
        rest * frame * Rotation::from_scaled_axis(Vec3::new(0.0, y, z)) * twist * frame.inverse()
    };
    let found = learn((0..20_000).map(turn));
    assert!(found.center.angle_to(rest) < 0.03, "{}", found.center.angle_to(rest).to_degrees());
    assert!((found.swing[0] - 0.8).abs() < 0.03 && (found.swing[1] - 0.3).abs() < 0.02, "{:?}", found.swing);
    assert!((found.twist.lo + 0.4).abs() < 0.03 && (found.twist.hi - 0.4).abs() < 0.03, "{:?}", found.twist);
    assert!(found.hinge.is_none());
    let long = found.frame * Vec3::Y;
    assert!(long.dot(frame * Vec3::Y).abs() > 0.99, "{long}");
    assert!((found.frame * Vec3::X - Vec3::Y).length() < 1e-4);
    // The joint limit contains the motion, except for one sample in two hundred.
    let (limit, mut random) = (found.swing_twist(), Random::new(5));
    let _ = &mut random;
    let beyond = |turn: Rotation| {
        let joint = (found.center * found.frame).inverse() * turn * found.frame;
        limit.overshoot(joint) > 0.01
    };
    let mut again = Random::new(6);
    let outside = (0..4000)
        .filter(|_| {
            let (y, z) = (again.range(-0.5, 0.5) * 0.8, again.range(-0.5, 0.5) * 0.3);
            let twist = Rotation::from_axis_angle(Vec3::X, again.range(-0.35, 0.35));
            beyond(rest * frame * Rotation::from_scaled_axis(Vec3::new(0.0, y, z)) * twist * frame.inverse())
        })
        .count();
    assert_eq!(outside, 0);
    let far = rest * frame * Rotation::from_scaled_axis(Vec3::new(0.0, 1.2, 0.0)) * frame.inverse();
    assert!(beyond(far));
    // Projection gives a rotation on the limit; rotations inside stay unchanged.
    let back = found.project(far);
    let (swing, _) = SwingTwistLimit::angles((found.center * found.frame).inverse() * back * found.frame);
    let radius = (swing.y / found.swing[0]).abs() + (swing.z / found.swing[1]).abs();
    assert!((0.97..1.15).contains(&radius), "{radius}");
    assert_eq!(found.project(found.center), found.center);
}

#[test]
fn hinge_axis_and_range_are_recovered() {
    let mut random = Random::new(7);
    for _ in 0..20 {
        let (axis, rest) = (random.direction(), random.rotation());
        let turn = |i: usize| rest * Rotation::from_axis_angle(axis, 1.2 * i as f32 / 999.0);
        let found = learn((0..1000).map(turn));
        let hinge = found.hinge.expect("one axis");
        assert!(hinge.axis.dot(axis).abs() > 0.9999, "{} {axis}", hinge.axis);
        assert!((hinge.range.hi - hinge.range.lo - 1.2).abs() < 0.02 && hinge.off_axis < 1e-3, "{hinge:?}");
        let over = found.center * Rotation::from_axis_angle(axis, 0.9);
        assert!((found.project(over).angle_to(over) - 0.3).abs() < 0.02);
    }
    // A rotation about one axis that is too small does not make a hinge.
    let turn = |i: usize| Rotation::from_axis_angle(Vec3::X, 0.15 * i as f32 / 999.0);
    assert!(learn((0..1000).map(turn)).hinge.is_none());
}

/// The capture's skeleton has one degree of freedom in knees and elbows, and three in hips and shoulders.
#[needs_data]
#[test]
fn captured_knees_and_elbows_are_hinges() {
    for file in ["cmu_12_01_walk.bvh", "cmu_01_01_jumps.bvh"] {
        let found = actor(file);
        let take = Take::of(&found.rig, &found.clip, 1.0 / 120.0);
        let limits = learn_limits(&found.rig, &[&take]);
        let of = |name: &str| {
            let joint = found.rig.joints.iter().position(|joint| joint.name == name).unwrap();
            *limits
                .iter()
                .find(|limit| limit.joint == joint)
                .unwrap_or_else(|| panic!("{file}: {name} does not move"))
        };
        for name in ["LeftLeg", "RightLeg", "LeftForeArm", "RightForeArm"] {
            let limit = of(name);
            let hinge = limit.hinge.unwrap_or_else(|| panic!("{file}: {name} is not a hinge: {limit:?}"));
            let range = (hinge.range.hi - hinge.range.lo).to_degrees();
            println!(
                "{file} {name}: hinge about {}, range {range:.0}°, off-axis {:.2}°",
                hinge.axis,
                hinge.off_axis.to_degrees()
            );
            assert!((12.0..150.0).contains(&range) && hinge.off_axis < 0.02, "{file} {name}: {hinge:?}");
        }
        for name in ["LeftUpLeg", "RightUpLeg", "LeftArm", "RightArm"] {
            assert!(of(name).hinge.is_none(), "{file}: {name} {:?}", of(name));
        }
    }
}
