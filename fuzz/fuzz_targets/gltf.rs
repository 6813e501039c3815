//! A glTF or GLB without files beside it: read, or refused with a place; its clips are built or refused.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_anim::{BuildOptions, BuiltClip};
use sinew_formats::{ReadOptions, no_files, read_gltf};

fuzz_target!(|bytes: &[u8]| {
    match read_gltf(bytes, ReadOptions::default(), &mut no_files) {
        Err(error) => assert!(!error.what.is_empty() && !error.where_.is_empty(), "{error}"),
        Ok(document) => {
            for clip in &document.clips {
                let _ = BuiltClip::build(clip, &document.rig, &BuildOptions::default());
            }
        }
    }
});
