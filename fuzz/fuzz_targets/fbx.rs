//! An FBX file: read, or refused; its clips are built or refused, and its skins fit their meshes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_anim::{BuildOptions, BuiltClip};
use sinew_formats::read_fbx;

fuzz_target!(|bytes: &[u8]| {
    let Ok(file) = read_fbx(bytes) else { return };
    let joints = file.rig.joints.len();
    assert!(
        file.rig.joints.iter().enumerate().all(|(i, joint)| joint.parent.is_none_or(|parent| parent < i))
    );
    for skin in &file.rig.skins {
        assert_eq!(skin.joints.len(), skin.inverse_bind.len());
        assert!(skin.joints.iter().all(|&joint| joint < joints));
    }
    for mesh in &file.rig.meshes {
        for part in &mesh.primitives {
            assert!(part.indices.iter().all(|&vertex| (vertex as usize) < part.positions.len()));
        }
    }
    for clip in &file.clips {
        let _ = BuiltClip::build(clip, &file.rig, &BuildOptions::default());
    }
});
