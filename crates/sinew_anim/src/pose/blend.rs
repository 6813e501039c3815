//! Blends any number of poses into one, independently of their order.

use super::add::Add;
use super::parts::Parts;
use super::quaternions::Quaternions;
use super::soa::{Pose, ROWS};
use super::symmetric4::Symmetric4;
use core::cmp::Ordering;
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{Block, Blocks, LaneMask, Lanes, Vector3, WIDTH};

/// A share per joint, 0 to 1, by which a pose affects the joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    blocks: Vec<Block<1>>,
    joints: usize,
}

impl Mask {
    /// Creates a mask with the same share for all joints.
    ///
    /// # Panics
    /// If `share` is not in 0..=1.
    pub fn splat(joints: usize, share: f32) -> Self {
        core::iter::repeat_n(share, joints).collect()
    }

    /// Number of joints.
    pub fn len(&self) -> usize {
        self.joints
    }

    /// True if the mask has no joints.
    pub fn is_empty(&self) -> bool {
        self.joints == 0
    }

    /// Share of a joint.
    ///
    /// # Panics
    /// If the joint is out of range.
    pub fn get(&self, joint: usize) -> f32 {
        assert!(joint < self.joints, "joint {joint} of {}", self.joints);
        self.blocks[joint / WIDTH].get(joint % WIDTH)[0]
    }

    fn bits(&self) -> impl Iterator<Item = u32> {
        self.blocks.iter().flat_map(|block| block.0[0].map(f32::to_bits))
    }
}

/// Creates a mask from a share per joint.
///
/// # Panics
/// If a share is not in 0..=1.
impl FromIterator<f32> for Mask {
    fn from_iter<I: IntoIterator<Item = f32>>(shares: I) -> Self {
        let shares = shares.into_iter().map(|share| {
            assert!((0.0..=1.0).contains(&share), "a share of a mask must be in 0..=1, not {share}");
            [share]
        });
        let records: Blocks<1> = shares.collect();
        Self { blocks: records.blocks().to_vec(), joints: records.len() }
    }
}

/// Input of a blend: a pose, its weight and its mask.
#[derive(Clone, Copy, Debug)]
pub struct BlendLayer<'a> {
    /// One local transform per joint.
    pub pose: &'a Pose,
    /// Weight in the blend, ≥ 0; weights need not add up to 1. Negative and NaN count as 0.
    pub weight: f32,
    /// Factor of the weight per joint; `None` is 1 everywhere.
    pub mask: Option<&'a Mask>,
}

impl<'a> BlendLayer<'a> {
    /// Creates a layer without a mask.
    pub fn new(pose: &'a Pose, weight: f32) -> Self {
        Self { pose, weight, mask: None }
    }

    fn share(&self) -> f32 {
        if self.weight > 0.0 { self.weight } else { 0.0 }
    }

    /// Returns the weights of a block's joints.
    #[inline(always)]
    pub(super) fn weight<L: Lanes>(&self, index: usize) -> L {
        match self.mask {
            None => L::splat(self.weight),
            Some(mask) => L::splat(self.weight) * L::load(&mask.blocks[index].0[0]),
        }
    }

    /// Sorts by weight, the heaviest first, then by content. Layers that are equal in both may change places without
    /// effect.
    fn order(&self, other: &Self) -> Ordering {
        let pose = || {
            if core::ptr::eq(self.pose, other.pose) { Ordering::Equal } else { self.pose.order(other.pose) }
        };
        let mask_bits = |layer: &Self| layer.mask.into_iter().flat_map(Mask::bits);
        other
            .share()
            .total_cmp(&self.share())
            .then_with(pose)
            .then_with(|| mask_bits(self).cmp(mask_bits(other)))
    }
}

/// Definition of the mean of several rotations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RotationMean {
    /// Sum of the quaternions on the hemisphere of the rest pose, normalised.
    #[default]
    Sum,
    /// The rotation with the smallest weighted sum of squared chords to all rotations (Markley et al., "Averaging
    /// quaternions", 2007): the eigenvector of `Σ w q qᵀ` with the largest eigenvalue. It does not depend on
    /// hemispheres.
    Exact,
}

/// Options of a blend.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BlendOptions {
    /// Sum of weights at a joint below which the rest pose is blended in, ≥ 0. With 0, the default, a single track has
    /// full effect at any positive weight, and the joint jumps to the rest pose when the weight becomes 0. With 0.1 the
    /// joint blends to the rest pose over the last tenth of the ramp.
    pub fill_below: f32,
    /// Definition of the mean of rotations.
    pub mean: RotationMean,
}

/// Blends poses; reuses a buffer for sorting them.
#[derive(Clone, Debug, Default)]
pub struct Blender {
    options: BlendOptions,
    order: Vec<usize>,
}

impl Blender {
    /// # Panics
    /// If `fill_below` is negative or not finite.
    pub fn new(options: BlendOptions) -> Self {
        let fill_below = options.fill_below;
        assert!(
            fill_below >= 0.0 && fill_below.is_finite(),
            "`fill_below` must be at least 0, not {fill_below}"
        );
        Self { options, order: Vec::new() }
    }

    /// Writes the weighted mean of any number of poses to `out`, joint by joint. `out`, `rest`, all layers and masks
    /// have one entry per joint.
    ///
    /// The result has the same bits for any order of the layers: they are added in the order of weight, then of
    /// content. It is the heaviest pose plus weighted differences, so that a pose blended with itself keeps its bits.
    /// If the weights sum to zero, or rotations cancel, the result has the bits of the rest pose.
    ///
    /// Allocates only for more layers than before.
    ///
    /// # Panics
    /// If lengths differ.
    pub fn blend(&mut self, rest: &Pose, layers: &[BlendLayer<'_>], out: &mut Pose) {
        assert_eq!(rest.len(), out.len(), "a pose has one local transform per joint");
        self.sort(layers, out.len());
        if self.order.is_empty() {
            out.copy_from(rest);
            return;
        }
        let BlendOptions { fill_below, mean } = self.options;
        let out = out.blocks_mut();
        dispatch::run(Blend { rest: rest.blocks(), layers, order: &self.order, fill_below, mean, out });
    }
}

impl Blender {
    /// Adds differences to a pose, joint by joint, each times its weight and mask. Layers come from
    /// [`Clip::difference_from`](crate::Clip::difference_from). A rotation becomes `pose · difference` (in the joint's
    /// own axes), a translation the sum, a scale the product.
    ///
    /// Several differences at a joint are first summed in the order of [`blend`](Self::blend). So the bits do not
    /// depend on the order of the layers, and the result does not jump where two weights become equal. For rotations
    /// the sum is `1 + Σ w (difference − 1)`, normalised.
    ///
    /// # Panics
    /// If lengths differ.
    pub fn add(&mut self, layers: &[BlendLayer<'_>], pose: &mut Pose) {
        self.sort(layers, pose.len());
        if !self.order.is_empty() {
            dispatch::run(Add { layers, order: &self.order, pose: pose.blocks_mut() });
        }
    }

    /// Checks lengths and sorts the layers with positive weight.
    fn sort(&mut self, layers: &[BlendLayer<'_>], joints: usize) {
        for layer in layers {
            assert_eq!(layer.pose.len(), joints, "all poses are of one rig");
            assert!(layer.mask.is_none_or(|mask| mask.len() == joints), "a mask has one share per joint");
        }
        self.order.clear();
        self.order.extend((0..layers.len()).filter(|&i| layers[i].share() > 0.0));
        self.order.sort_unstable_by(|&a, &b| layers[a].order(&layers[b]));
    }
}

pub(super) struct Blend<'a, 'b> {
    pub rest: &'a [Block<ROWS>],
    pub layers: &'a [BlendLayer<'b>],
    pub order: &'a [usize],
    pub fill_below: f32,
    pub mean: RotationMean,
    pub out: &'a mut [Block<ROWS>],
}

impl Kernel for Blend<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        for index in 0..self.out.len() {
            let total = self.total::<L>(index);
            let fill = L::max(L::splat(self.fill_below) - total, L::splat(0.0));
            let shares = Shares { fill, scale: L::splat(1.0) / (total + fill) };
            let mut mean = self.mean::<L>(index, shares);
            if self.mean == RotationMean::Exact {
                let rotation = self.exact_rotation::<L>(index, fill, mean.rotation);
                // If all rotations are equal, the mean is exactly that rotation.
                mean.rotation = Quaternions::select(mean.unanimous, mean.rotation, rotation);
            }
            mean.store(&self.rest[index], L::gt(total, L::splat(0.0)), &mut self.out[index]);
        }
    }
}

/// Factors that scale the weights to a sum of 1.
#[derive(Clone, Copy)]
struct Shares<L> {
    /// Weight of the rest pose.
    fill: L,
    /// Reciprocal of the sum of all weights.
    scale: L,
}

impl Blend<'_, '_> {
    #[inline(always)]
    fn total<L: Lanes>(&self, index: usize) -> L {
        let mut total = L::splat(0.0);
        for &layer in self.order {
            total = total + self.layers[layer].weight::<L>(index);
        }
        total
    }

    #[inline(always)]
    fn mean<L: Lanes>(&self, index: usize, shares: Shares<L>) -> Mean<L> {
        let rest = &self.rest[index];
        let mut mean = Mean::of(&self.layers[self.order[0]].pose.blocks()[index], rest);
        for &layer in &self.order[1..] {
            let weight = self.layers[layer].weight::<L>(index);
            mean.add(&self.layers[layer].pose.blocks()[index], rest, weight * shares.scale);
        }
        if self.fill_below > 0.0 {
            mean.add(rest, rest, shares.fill * shares.scale);
        }
        mean.finish(rest)
    }

    /// Returns Markley's mean, or `start` if it is undefined. The matrix is squared four times, which equals sixteen
    /// steps of a power iteration.
    #[inline(always)]
    fn exact_rotation<L: Lanes>(&self, index: usize, fill: L, start: Quaternions<L>) -> Quaternions<L> {
        let mut sum = Symmetric4::outer(Quaternions::load(&self.rest[index]), fill);
        for &layer in self.order {
            let q = Quaternions::load(&self.layers[layer].pose.blocks()[index]);
            sum = sum.plus(Symmetric4::outer(q, self.layers[layer].weight::<L>(index)));
        }
        sum = sum.normalized().squared().normalized().squared();
        sum = sum.normalized().squared().normalized().squared().normalized();
        let q = sum.times(start);
        let square = q.dot(q);
        Quaternions::select(L::gt(square, L::splat(1e-12)), q.unit(square), start)
    }
}

/// Mean of a block's joints during summation: the heaviest pose and the sum of weighted differences from it.
struct Mean<L: Lanes> {
    heaviest: Parts<L>,
    difference: Parts<L>,
    rotation: Quaternions<L>,
    /// Lanes in which no rotation differs from that of the heaviest pose.
    unanimous: L::Mask,
}

impl<L: Lanes> Mean<L> {
    #[inline(always)]
    fn of(heaviest: &Block<ROWS>, rest: &Block<ROWS>) -> Self {
        let mut heaviest = Parts::load(heaviest);
        let zero = L::splat(0.0);
        let none = Vector3::new(zero, zero, zero);
        let difference = Parts { translation: none, rotation: Quaternions::zero(), scale: none };
        let rotation = heaviest.rotation;
        heaviest.rotation = rotation.toward(Quaternions::load(rest));
        Self { heaviest, difference, rotation, unanimous: L::eq(zero, zero) }
    }

    #[inline(always)]
    fn add(&mut self, pose: &Block<ROWS>, rest: &Block<ROWS>, share: L) {
        let (pose, from, sum) = (Parts::<L>::load(pose), &self.heaviest, &mut self.difference);
        let rotation = pose.rotation.toward(Quaternions::load(rest));
        sum.translation = sum.translation + (pose.translation - from.translation) * share;
        sum.rotation = sum.rotation.plus(rotation.minus(from.rotation).times(share));
        sum.scale = sum.scale + (pose.scale - from.scale) * share;
    }

    #[inline(always)]
    fn finish(mut self, rest: &Block<ROWS>) -> Self {
        let zero = L::splat(0.0);
        let change = self.difference.rotation;
        self.unanimous = L::eq(change.dot(change), zero);
        let sum = self.heaviest.rotation.plus(change);
        let square = sum.dot(sum);
        // Opposite rotations cancel, so their sum cannot be normalised.
        let mean =
            Quaternions::select(L::gt(square, L::splat(1e-8)), sum.unit(square), Quaternions::load(rest));
        self.rotation = Quaternions::select(self.unanimous, self.rotation, mean);
        self
    }

    /// Writes the mean where it is `wanted`, the rest pose elsewhere.
    #[inline(always)]
    fn store(self, rest: &Block<ROWS>, wanted: L::Mask, out: &mut Block<ROWS>) {
        let translation = self.heaviest.translation + self.difference.translation;
        let scale = self.heaviest.scale + self.difference.scale;
        let mean = Parts { translation, rotation: self.rotation, scale };
        if wanted.all() {
            mean.store(out);
            return;
        }
        let rest = Parts::load(rest);
        Parts {
            translation: select(wanted, mean.translation, rest.translation),
            rotation: Quaternions::select(wanted, mean.rotation, rest.rotation),
            scale: select(wanted, mean.scale, rest.scale),
        }
        .store(out);
    }
}

#[inline(always)]
fn select<L: Lanes>(mask: L::Mask, a: Vector3<L>, b: Vector3<L>) -> Vector3<L> {
    Vector3::new(L::select(mask, a.x, b.x), L::select(mask, a.y, b.y), L::select(mask, a.z, b.z))
}
