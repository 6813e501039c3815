//! Settings of a ragdoll's build: read, or refused with a location.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_formats::read_ragdoll_settings;

fuzz_target!(|bytes: &[u8]| {
    match read_ragdoll_settings(bytes) {
        Err(error) => assert!(!error.what.is_empty() && !error.where_.is_empty(), "{error}"),
        Ok(settings) => {
            let positive = |x: Option<f32>| x.is_none_or(|x| x > 0.0 && x.is_finite());
            assert!(positive(settings.mass));
            let names = settings.bones.iter().map(|(name, _)| name);
            assert!(
                names
                    .clone()
                    .enumerate()
                    .all(|(i, name)| names.clone().skip(i + 1).all(|other| other != name))
            );
        }
    }
});
