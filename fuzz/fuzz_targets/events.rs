//! An events file for two clips, one of them without a name: read, or refused with a location; events lie within their
//! clips.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_anim::Clip;
use sinew_formats::read_events;

fuzz_target!(|bytes: &[u8]| {
    let walk = Clip { name: "walk".into(), duration: 1.0, ..Clip::default() };
    let clips = [walk, Clip { duration: 0.5, ..Clip::default() }];
    match read_events(bytes, &clips) {
        Err(error) => assert!(!error.what.is_empty() && !error.where_.is_empty(), "{error}"),
        Ok(events) => {
            for (clip, events) in clips.iter().zip(&events) {
                for event in events.iter().flatten() {
                    assert!((0.0..=clip.duration).contains(&event.time), "{event:?}");
                }
            }
        }
    }
});
