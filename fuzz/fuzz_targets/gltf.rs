//! A glTF, GLB or VRM without files beside it, with its pictures: read, or refused with a location; its clips are built
//! or refused, and the roles that it states are those of joints that there are.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_anim::{BuiltClip, ClipBuildOptions};
use sinew_formats::{ReadOptions, Textures, no_files, read_gltf};

fuzz_target!(|bytes: &[u8]| {
    let options = ReadOptions { textures: Textures::Decode };
    match read_gltf(bytes, options, &mut no_files) {
        Err(error) => assert!(!error.what.is_empty() && !error.where_.is_empty(), "{error}"),
        Ok(document) => {
            let joints = document.rig.joints.len();
            assert!(document.rig.stated_roles.iter().all(|&(_, joint)| joint < joints));
            for clip in &document.clips {
                let _ = BuiltClip::build(clip, &document.rig, &ClipBuildOptions::default());
            }
        }
    }
});
