//! A DeepMimic character and a clip for it, one after the other with a zero byte between.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_formats::{read_deepmimic, read_deepmimic_character};

/// Three joints: a root, a ball, a hinge.
const CHARACTER: &[u8] = br#"{"Skeleton":{"Joints":[
    {"ID":0,"Name":"root","Type":"none","Parent":-1,"AttachX":0,"AttachY":0,"AttachZ":0},
    {"ID":1,"Name":"chest","Type":"spherical","Parent":0,"AttachX":0,"AttachY":0.2,"AttachZ":0},
    {"ID":2,"Name":"elbow","Type":"revolute","Parent":1,"AttachX":0,"AttachY":0.2,"AttachZ":0}]}}"#;

fuzz_target!(|bytes: &[u8]| {
    let cut = bytes.iter().position(|&byte| byte == 0);
    let (clip, character) = cut.map_or((bytes, CHARACTER), |cut| (&bytes[..cut], &bytes[cut + 1..]));
    let Ok(character) = read_deepmimic_character(character) else { return };
    if let Ok(clip) = read_deepmimic(clip, &character) {
        assert!(clip.clip.duration.is_finite());
    }
});
