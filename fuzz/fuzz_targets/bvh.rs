//! A BVH file: read, or refused with a location. What was read is a good clip, and can be written and read again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_anim::{BuiltClip, ClipBuildOptions};
use sinew_formats::bvh::BvhRows;
use sinew_formats::{BvhOptions, BvhWriteOptions, read_bvh, write_bvh};

fuzz_target!(|bytes: &[u8]| {
    for rows in [BvhRows::AsDeclared, BvhRows::AsPresent] {
        let options = BvhOptions { rows, ..BvhOptions::default() };
        match read_bvh(bytes, options) {
            Err(error) => assert!(!error.what.is_empty() && !error.where_.is_empty(), "{error}"),
            Ok(file) => {
                assert!(file.clip.duration.is_finite() && file.frames > 0);
                let _ = BuiltClip::build(&file.clip, &file.rig, &ClipBuildOptions::default());
                if let Ok(written) = write_bvh(&file.rig, &file.clip, &BvhWriteOptions::default()) {
                    read_bvh(written.text.as_bytes(), BvhOptions::default()).expect("what we write we read");
                }
            }
        }
    }
});
