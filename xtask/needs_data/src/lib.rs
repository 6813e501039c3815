//! An attribute for tests that read the data beside the repository.
#![forbid(unsafe_code)]

use proc_macro::TokenStream;
use std::path::Path;

/// The data beside a clone; they are not part of the repository.
const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data");

/// Ignores a test if the data were absent when it was compiled: `cargo test` then counts it as ignored.
/// It stands above `#[test]`, which reads the attributes below it.
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
    let mut ignored: TokenStream =
        "#[ignore = \"no ../shared/data\"]".parse().expect("an attribute is made of tokens");
    ignored.extend(test);
    ignored
}
