//! Passes the compiler's flags and Sinew's version to the program, which prints them beside its results.

/// Manifest with the version of Sinew's workspace.
const ROOT_MANIFEST: &str = "../../Cargo.toml";

fn main() {
    let variable = |name: &str| std::env::var(name).unwrap_or_default();
    // The release profile is that of Cargo.toml; Cargo does not pass its LTO to build scripts.
    let lto = if variable("PROFILE") == "release" { ", lto=fat, codegen-units=1" } else { "" };
    let flags = variable("CARGO_ENCODED_RUSTFLAGS").replace('\u{1f}', " ");
    let flags = if flags.is_empty() { String::new() } else { format!(", {flags}") };
    println!("cargo:rustc-env=PEERS_FLAGS=opt-level={}{lto}{flags}", variable("OPT_LEVEL"));
    let manifest = std::fs::read_to_string(ROOT_MANIFEST).expect("the root manifest is readable");
    let version = manifest.lines().find_map(|line| line.strip_prefix("version = \""));
    println!("cargo:rustc-env=SINEW_VERSION={}", version.expect("a version").trim_end_matches('"'));
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed={ROOT_MANIFEST}");
}
