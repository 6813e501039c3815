//! Small rigs made by hand.

use sinew_anim::{Joint, LocalTransform, Rig};
use sinew_math::{Random, Rotation, Vec3};

/// A chain of `n` joints, each `offset` from its parent.
pub fn chain(n: usize, offset: Vec3) -> Rig {
    let joint = |i: usize| Joint {
        name: format!("joint{i}"),
        parent: i.checked_sub(1),
        rest: LocalTransform { translation: offset, ..LocalTransform::default() },
        source: i,
    };
    Rig { joints: (0..n).map(joint).collect(), ..Rig::default() }
}

/// A pose of `n` joints at random.
pub fn random_pose(random: &mut Random, n: usize) -> Vec<LocalTransform> {
    let local = |_| LocalTransform {
        translation: random.in_cube(),
        rotation: Rotation::from_scaled_axis(random.in_cube() * 1.2),
        scale: Vec3::splat(random.range(0.5, 2.0)),
    };
    (0..n).map(local).collect()
}
