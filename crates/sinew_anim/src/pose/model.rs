//! Converts local to model space: eight conversions to a matrix at a time, then one product per joint.

use super::soa::{Pose, ROTATION, ROWS, SCALE, TRANSLATION};
use crate::rig::Rig;
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{Block, Lanes, WIDTH};
use sinew_math::{Affine, Mat3, Vec3};

/// Columns of a 4×4 matrix whose last row is 0 0 0 1.
pub(super) type Columns = [[f32; 4]; 4];

/// Parts of a [`Rig`] for run time: parents and the rest pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    /// Parent + 1 for each joint, 0 for a root.
    parents: Vec<u32>,
    rest: Pose,
}

impl Skeleton {
    /// Creates the skeleton of a rig.
    ///
    /// # Panics
    /// If a joint's parent does not come before it.
    pub fn new(rig: &Rig) -> Self {
        let parent = |(joint, parent): (usize, Option<usize>)| {
            assert!(parent.is_none_or(|parent| parent < joint), "joint {joint} comes before its parent");
            parent.map_or(0, |parent| u32::try_from(parent + 1).expect("fewer than 2^32 joints"))
        };
        let parents = rig.joints.iter().map(|joint| joint.parent).enumerate().map(parent).collect();
        Self { parents, rest: Pose::rest(rig) }
    }

    /// Number of joints.
    pub fn len(&self) -> usize {
        self.parents.len()
    }

    /// True if the skeleton has no joints.
    pub fn is_empty(&self) -> bool {
        self.parents.is_empty()
    }

    /// Rest pose of the file.
    pub fn rest(&self) -> &Pose {
        &self.rest
    }

    /// Parent of `joint`, `None` for a root.
    ///
    /// # Panics
    /// If the joint is out of range.
    pub fn parent(&self, joint: usize) -> Option<usize> {
        (self.parents[joint] as usize).checked_sub(1)
    }

    /// Computes the model-space transform of every joint: `root` times the chain of local transforms down to the
    /// joint, with the bits of [`local_to_model`](super::local_to_model). `root` maps the file's scene to the
    /// caller's space. `model` is resized to the skeleton, which allocates only the first time.
    ///
    /// # Panics
    /// If `local` is not as long as the skeleton.
    pub fn to_model(&self, local: &Pose, root: &Affine, model: &mut ModelPose) {
        assert_eq!(local.len(), self.len(), "a pose has one local transform per joint");
        model.joints.resize(self.len() + 1, columns(&Affine::IDENTITY));
        model.joints[0] = columns(root);
        dispatch::run(ToModel { parents: &self.parents, local: local.blocks(), model: &mut model.joints });
    }
}

/// A transform from each joint's space to model space, as columns of 4×4 matrices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelPose {
    /// The root's own transform, then one per joint.
    joints: Vec<Columns>,
}

impl ModelPose {
    /// Number of joints.
    pub fn len(&self) -> usize {
        self.joints.len().saturating_sub(1)
    }

    /// True if the pose has no joints.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the transform of `joint`; file units.
    ///
    /// # Panics
    /// If the joint is out of range.
    pub fn get(&self, joint: usize) -> Affine {
        let [x, y, z, w] = self.joints[joint + 1].map(|[x, y, z, _]| Vec3::new(x, y, z));
        Affine { linear: Mat3::from_cols(x, y, z), translation: w }
    }

    /// Returns the matrices, one per joint, column by column, in the layout of graphics processors: the last row is 0
    /// 0 0 1.
    pub fn matrices(&self) -> &[[[f32; 4]; 4]] {
        self.joints.get(1..).unwrap_or_default()
    }

    /// Iterates over the transforms of the joints in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Affine> {
        (0..self.len()).map(|joint| self.get(joint))
    }
}

fn columns(affine: &Affine) -> Columns {
    let column = |v: Vec3, w| [v.x, v.y, v.z, w];
    let m = &affine.linear;
    [column(m.x_axis, 0.0), column(m.y_axis, 0.0), column(m.z_axis, 0.0), column(affine.translation, 1.0)]
}

pub(super) struct ToModel<'a> {
    pub parents: &'a [u32],
    pub local: &'a [Block<ROWS>],
    pub model: &'a mut [Columns],
}

impl Kernel for ToModel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let mut rows = [[0.0; WIDTH]; 9];
        for (index, (parents, block)) in self.parents.chunks(WIDTH).zip(self.local).enumerate() {
            linear_rows::<L>(block, &mut rows);
            for (lane, &parent) in parents.iter().enumerate() {
                let own = own_columns(&rows, block, lane);
                self.model[index * WIDTH + lane + 1] = product(&self.model[parent as usize], &own);
            }
        }
    }
}

/// Computes scaled rotation matrices of a block's joints, column by column, by the formulas of `Rotation::to_mat3`.
#[inline(always)]
fn linear_rows<L: Lanes>(block: &Block<ROWS>, rows: &mut [[f32; WIDTH]; 9]) {
    let [one, two] = [L::splat(1.0), L::splat(2.0)];
    let x = L::load(&block.0[ROTATION]);
    let y = L::load(&block.0[ROTATION + 1]);
    let z = L::load(&block.0[ROTATION + 2]);
    let w = L::load(&block.0[ROTATION + 3]);
    let sx = L::load(&block.0[SCALE]);
    let sy = L::load(&block.0[SCALE + 1]);
    let sz = L::load(&block.0[SCALE + 2]);
    ((one - two * (y * y + z * z)) * sx).store(&mut rows[0]);
    (two * (x * y + w * z) * sx).store(&mut rows[1]);
    (two * (x * z - w * y) * sx).store(&mut rows[2]);
    (two * (x * y - w * z) * sy).store(&mut rows[3]);
    ((one - two * (x * x + z * z)) * sy).store(&mut rows[4]);
    (two * (y * z + w * x) * sy).store(&mut rows[5]);
    (two * (x * z + w * y) * sz).store(&mut rows[6]);
    (two * (y * z - w * x) * sz).store(&mut rows[7]);
    ((one - two * (x * x + y * y)) * sz).store(&mut rows[8]);
}

/// Returns the columns of the local transform in `lane`.
#[inline(always)]
fn own_columns(rows: &[[f32; WIDTH]; 9], block: &Block<ROWS>, lane: usize) -> [[f32; 3]; 4] {
    let place = &block.0;
    [
        [rows[0][lane], rows[1][lane], rows[2][lane]],
        [rows[3][lane], rows[4][lane], rows[5][lane]],
        [rows[6][lane], rows[7][lane], rows[8][lane]],
        [place[TRANSLATION][lane], place[TRANSLATION + 1][lane], place[TRANSLATION + 2][lane]],
    ]
}

/// Returns parent times own, with the order of additions of `Affine`.
#[inline(always)]
fn product(parent: &Columns, own: &[[f32; 3]; 4]) -> Columns {
    let (at, origin) = (image(parent, &own[3]), &parent[3]);
    [
        image(parent, &own[0]),
        image(parent, &own[1]),
        image(parent, &own[2]),
        [at[0] + origin[0], at[1] + origin[1], at[2] + origin[2], at[3] + origin[3]],
    ]
}

/// Maps a vector by the linear part; returns four numbers, the last of them 0, so that the compiler uses one register
/// per column.
#[inline(always)]
fn image([x, y, z, _]: &Columns, v: &[f32; 3]) -> [f32; 4] {
    [
        x[0] * v[0] + y[0] * v[1] + z[0] * v[2],
        x[1] * v[0] + y[1] * v[1] + z[1] * v[2],
        x[2] * v[0] + y[2] * v[1] + z[2] * v[2],
        x[3] * v[0] + y[3] * v[1] + z[3] * v[2],
    ]
}
