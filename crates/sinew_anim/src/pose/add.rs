//! Adds differences to a pose.

use super::blend::BlendLayer;
use super::parts::Parts;
use super::quaternions::Quaternions;
use super::soa::ROWS;
use sinew_math::dispatch::Kernel;
use sinew_math::lanes::{Block, Lanes, Vector3};

/// Adds layers to a pose, as documented at [`Blender::add`](super::Blender::add).
pub(super) struct Add<'a, 'b> {
    pub layers: &'a [BlendLayer<'b>],
    pub order: &'a [usize],
    pub pose: &'a mut [Block<ROWS>],
}

impl Kernel for Add<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let identity = Quaternions { v: Vector3::new(zero, zero, zero), w: one };
        let ones = Vector3::new(one, one, one);
        for index in 0..self.pose.len() {
            let mut sum = Parts { translation: identity.v, rotation: identity, scale: ones };
            for &layer in self.order {
                let weight = self.layers[layer].weight::<L>(index);
                let difference = Parts::<L>::load(&self.layers[layer].pose.blocks()[index]);
                let turn = difference.rotation.toward(identity).minus(identity);
                sum.translation = sum.translation + difference.translation * weight;
                sum.rotation = sum.rotation.plus(turn.times(weight));
                sum.scale = sum.scale + (difference.scale - ones) * weight;
            }
            let square = sum.rotation.dot(sum.rotation);
            let turn =
                Quaternions::select(L::gt(square, L::splat(1e-8)), sum.rotation.unit(square), identity);
            let pose = Parts::<L>::load(&self.pose[index]);
            let scale = Vector3::new(
                pose.scale.x * sum.scale.x,
                pose.scale.y * sum.scale.y,
                pose.scale.z * sum.scale.z,
            );
            let translation = pose.translation + sum.translation;
            Parts { translation, rotation: pose.rotation.after(turn), scale }.store(&mut self.pose[index]);
        }
    }
}
