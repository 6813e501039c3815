//! A raw clip of any numbers: refused with a reason, or built, and then what is sampled, blended and brought to model
//! space is finite, and does not depend on what was sampled before.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_anim::{
    BlendLayer, Blender, BuiltClip, Channel, Clip, ClipBuildOptions, Cursor, Interpolation, Joint,
    LocalTransform, ModelPose, Pose, Property, Rig, Skeleton,
};
use sinew_math::{Affine, Reader};

const JOINTS: usize = 10;

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = Reader::new(bytes);
    let rig = rig();
    let Some(clip) = clip(&mut bytes) else { return };
    let Ok(built) = BuiltClip::build(&clip, &rig, &ClipBuildOptions::default()) else { return };
    let skeleton = Skeleton::new(&rig);
    let (mut cursor, mut blender) = (Cursor::new(), Blender::default());
    let [mut pose, mut fresh, mut blended] = [(); 3].map(|()| Pose::new(JOINTS));
    let mut model = ModelPose::default();
    for _ in 0..16 {
        let Ok(time) = bytes.f32() else { return };
        built.sample(time, &mut cursor, &mut pose);
        built.sample(time, &mut Cursor::new(), &mut fresh);
        assert_eq!(pose, fresh, "at {time}");
        let is_finite = |local: &LocalTransform| {
            let q = local.rotation;
            [q.x, q.y, q.z, q.w].iter().all(|number| number.is_finite())
                && local.translation.is_finite()
                && local.scale.is_finite()
        };
        assert!(pose.iter().all(|local| is_finite(&local)), "at {time}: {pose:?}");
        let layers = [BlendLayer::new(&pose, 0.4), BlendLayer::new(skeleton.rest(), 0.6)];
        blender.blend(skeleton.rest(), &layers, &mut blended);
        skeleton.to_model(&blended, &Affine::IDENTITY, &mut model);
    }
});

fn rig() -> Rig {
    let joint = |source: usize| Joint {
        name: format!("joint{source}"),
        parent: source.checked_sub(1),
        rest: LocalTransform::default(),
        source,
    };
    Rig { joints: (0..JOINTS).map(joint).collect(), ..Rig::default() }
}

/// Up to 15 channels of up to 15 keys; `None` where the bytes end.
fn clip(bytes: &mut Reader<'_>) -> Option<Clip> {
    let mut clip = Clip { name: String::new(), duration: bytes.f32().ok()?, channels: Vec::new() };
    for _ in 0..bytes.u8().ok()? % 16 {
        let property = [Property::Translation, Property::Rotation, Property::Scale][kind(bytes)?];
        let interpolation =
            [Interpolation::Step, Interpolation::Linear, Interpolation::CubicSpline][kind(bytes)?];
        // One that the rig does not have, too.
        let joint = usize::from(bytes.u8().ok()?) % (JOINTS + 1);
        let keys = usize::from(bytes.u8().ok()?) % 16;
        let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let mut numbers = |count| (0..count).map(|_| bytes.f32().ok()).collect::<Option<Vec<f32>>>();
        let (times, values) = (numbers(keys)?, numbers(keys * per_key * property.width())?);
        clip.channels.push(Channel { joint, property, interpolation, times, values });
    }
    Some(clip)
}

fn kind(bytes: &mut Reader<'_>) -> Option<usize> {
    Some(usize::from(bytes.u8().ok()?) % 3)
}
