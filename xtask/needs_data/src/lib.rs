//! An attribute for tests that read the data beside the repository.
#![forbid(unsafe_code)]

use proc_macro::TokenStream;
use std::path::Path;

/// Folder of the data, beside the repository.
const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data");

/// Ignores a test if the data were absent when the test was compiled: `cargo test` then counts it as ignored.
/// Write the attribute above `#[test]`, because it reads the attributes below it.
///
/// ```text
/// #[needs_data]
/// #[test]
/// fn a_rig_is_read() {}
/// ```
#[proc_macro_attribute]
pub fn needs_data(_: TokenStream, test: TokenStream) -> TokenStream {
    if Path::new(DATA).is_dir() {
        return test;
    }
    let mut ignored: TokenStream = "#[ignore = \"no ../shared/data\"]".parse().expect("the attribute parses");
    ignored.extend(test);
    ignored
}
