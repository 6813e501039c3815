use crate::rig::{LocalTransform, Rig};
use core::cmp::Ordering;
use sinew_math::lanes::{Block, WIDTH};
use sinew_math::{Rotation, Vec3};

/// Rows of a block: translation x y z, rotation x y z w, scale x y z.
pub(crate) const ROWS: usize = 10;
/// First row of the translation.
pub(crate) const TRANSLATION: usize = 0;
/// First row of the rotation.
pub(crate) const ROTATION: usize = 3;
/// First row of the scale.
pub(crate) const SCALE: usize = 7;

/// Local transforms of a rig's joints, eight side by side, for sampling and blending.
///
/// Spaces and units are those of [`LocalTransform`]: each joint relative to its parent, file units, unit rotations.
/// Block `i` holds joints `8 i` to `8 i + 7`; the last block is padded with identities.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    blocks: Vec<Block<ROWS>>,
    joints: usize,
}

impl Pose {
    /// Creates a pose of identities.
    pub fn new(joints: usize) -> Self {
        let identity = Block::splat(record(&LocalTransform::default()));
        Self { blocks: vec![identity; joints.div_ceil(WIDTH)], joints }
    }

    /// Returns the rest pose of the file: the nodes' own transforms.
    pub fn rest(rig: &Rig) -> Self {
        rig.joints.iter().map(|joint| joint.rest).collect()
    }

    /// Number of joints.
    pub fn len(&self) -> usize {
        self.joints
    }

    /// True if the pose has no joints.
    pub fn is_empty(&self) -> bool {
        self.joints == 0
    }

    /// Local transform of `joint`.
    ///
    /// # Panics
    /// If the joint is out of range.
    pub fn get(&self, joint: usize) -> LocalTransform {
        assert!(joint < self.joints, "joint {joint} of {}", self.joints);
        let [tx, ty, tz, x, y, z, w, sx, sy, sz] = self.blocks[joint / WIDTH].get(joint % WIDTH);
        LocalTransform {
            translation: Vec3::new(tx, ty, tz),
            rotation: Rotation::from_xyzw(x, y, z, w),
            scale: Vec3::new(sx, sy, sz),
        }
    }

    /// Sets the local transform of `joint`.
    ///
    /// # Panics
    /// If the joint is out of range.
    pub fn set(&mut self, joint: usize, local: &LocalTransform) {
        assert!(joint < self.joints, "joint {joint} of {}", self.joints);
        self.blocks[joint / WIDTH].set(joint % WIDTH, record(local));
    }

    /// Iterates over the local transforms of the joints in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = LocalTransform> {
        (0..self.joints).map(|joint| self.get(joint))
    }

    /// Copies a pose of the same length; allocates nothing.
    ///
    /// # Panics
    /// If the poses differ in length.
    pub fn copy_from(&mut self, other: &Self) {
        assert_eq!(self.joints, other.joints, "the poses must be of one rig");
        self.blocks.copy_from_slice(&other.blocks);
    }

    pub(crate) fn blocks(&self) -> &[Block<ROWS>] {
        &self.blocks
    }

    pub(crate) fn blocks_mut(&mut self) -> &mut [Block<ROWS>] {
        &mut self.blocks
    }

    /// Total order of poses by bits; only poses equal to the bit compare equal.
    pub(crate) fn order(&self, other: &Self) -> Ordering {
        fn bits(pose: &Pose) -> impl Iterator<Item = u32> {
            pose.blocks.iter().flat_map(|block| block.0.as_flattened()).map(|number| number.to_bits())
        }
        bits(self).cmp(bits(other))
    }
}

fn record(local: &LocalTransform) -> [f32; ROWS] {
    let (t, q, s) = (local.translation, local.rotation, local.scale);
    [t.x, t.y, t.z, q.x, q.y, q.z, q.w, s.x, s.y, s.z]
}

impl FromIterator<LocalTransform> for Pose {
    fn from_iter<I: IntoIterator<Item = LocalTransform>>(locals: I) -> Self {
        let mut pose = Self::default();
        for local in locals {
            if pose.joints % WIDTH == 0 {
                pose.blocks.push(Block::splat(record(&LocalTransform::default())));
            }
            pose.joints += 1;
            pose.set(pose.joints - 1, &local);
        }
        pose
    }
}

impl From<&[LocalTransform]> for Pose {
    fn from(locals: &[LocalTransform]) -> Self {
        locals.iter().copied().collect()
    }
}
