//! An FBX file with its materials and pictures: read, or refused; its clips are built or refused, and its skins fit their meshes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_anim::{BuiltClip, ClipBuildOptions};
use sinew_formats::{ReadOptions, Textures, no_files, read_fbx_with};

fuzz_target!(|bytes: &[u8]| {
    let options = ReadOptions { textures: Textures::Decode };
    let Ok(file) = read_fbx_with(bytes, options, &mut no_files) else { return };
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
            assert!(part.texture.is_none_or(|texture| texture < file.rig.textures.len()));
        }
    }
    for clip in &file.clips {
        let _ = BuiltClip::build(clip, &file.rig, &ClipBuildOptions::default());
    }
});
