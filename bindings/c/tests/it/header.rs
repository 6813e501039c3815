//! Checks that the committed header equals the generated one.

use std::fs;
use std::path::Path;

#[test]
fn header_is_up_to_date() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(here.join("cbindgen.toml"))
        .expect("cbindgen.toml is a valid configuration");
    let made = cbindgen::Builder::new()
        .with_crate(here)
        .with_config(config)
        .generate()
        .expect("the header can be generated");
    let mut text = Vec::new();
    made.write(&mut text);
    // Removes rustdoc headings that C documentation does not need.
    let text = String::from_utf8(text)
        .expect("the header is UTF-8")
        .replace("// # Safety", "// The caller promises:");
    let path = here.join("include/sinew.h");
    if std::env::var_os("SINEW_BLESS").is_some() {
        fs::write(&path, &text).expect("the file can be written");
    }
    let committed = fs::read_to_string(&path).unwrap_or_default();
    assert!(committed == text, "include/sinew.h is out of date; run this test with SINEW_BLESS=1");
}
