//! Converts played steps to a clip.

use sinew::anim::{Channel, Clip, Interpolation, KeyBound, LocalTransform, Property, Rig, reduce_keys};
use sinew::math::{Affine, Rotation, Vec3};

/// Name of the clip.
const NAME: &str = "played";
/// Largest error of the joints of the clip: a tenth of a millimetre and a hundredth of a degree.
const BOUND: KeyBound = KeyBound { distance: 1e-4, angle: 1.745_329_3e-4 };
/// Largest difference from the rest pose that counts as rounding, as a share of 1 or of a bone's length.
const ROUNDING: f32 = 1e-5;

/// Converts poses (world from joint, every `dt` seconds) to a clip of the rig, whose model space is placed in the world by
/// `world_from_model`.
pub(super) fn clip_of(rig: &Rig, poses: &[Vec<Affine>], world_from_model: &Affine, dt: f32) -> Clip {
    let times: Vec<f32> = (0..poses.len()).map(|i| i as f32 * dt).collect();
    let mut channels = Vec::new();
    for (joint, node) in rig.joints.iter().enumerate() {
        let locals: Vec<LocalTransform> = poses
            .iter()
            .map(|pose| {
                let parent = node.parent.map_or(*world_from_model, |parent| pose[parent]);
                local(&(parent.inverse() * pose[joint]))
            })
            .collect();
        let mut add = |property: Property, values: Vec<f32>| {
            let times = times.clone();
            channels.push(Channel { joint, property, interpolation: Interpolation::Linear, times, values });
        };
        let length = node.rest.translation.length().max(ROUNDING);
        if locals.iter().any(|it| (it.translation - node.rest.translation).length() > ROUNDING * length) {
            add(Property::Translation, locals.iter().flat_map(|it| it.translation.to_array()).collect());
        }
        if locals.iter().any(|it| it.rotation.angle_to(node.rest.rotation) > ROUNDING) {
            add(Property::Rotation, rotations(&locals));
        }
    }
    let clip = Clip { name: NAME.to_owned(), duration: times.last().copied().unwrap_or(0.0), channels };
    reduce_keys(rig, &clip, world_from_model, BOUND).clip
}

/// Returns rotations without sign changes: players that blend keys by component would go the long way round.
fn rotations(locals: &[LocalTransform]) -> Vec<f32> {
    let mut last: Option<Rotation> = None;
    let mut values = Vec::with_capacity(4 * locals.len());
    for local in locals {
        let q = last.map_or(local.rotation, |last| local.rotation.toward(last));
        values.extend([q.x, q.y, q.z, q.w]);
        last = Some(q);
    }
    values
}

fn local(affine: &Affine) -> LocalTransform {
    let columns = affine.linear;
    LocalTransform {
        translation: affine.translation,
        rotation: Rotation::from_mat3_lossy(&columns),
        scale: Vec3::new(columns.x_axis.length(), columns.y_axis.length(), columns.z_axis.length()),
    }
}
