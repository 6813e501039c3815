//! Tools needed to build the peers besides Rust.

use anyhow::{Result, bail};
use std::env;
use std::fs;
use std::path::{Path, PathBuf};

/// A tool that must be installed.
struct Need {
    name: &'static str,
    /// Name of the Debian package.
    package: &'static str,
    is_there: fn() -> bool,
}

const NEEDS: &[Need] = &[
    Need { name: "cmake", package: "cmake", is_there: || is_program("cmake") },
    Need { name: "a C++ compiler", package: "g++", is_there: has_cpp_compiler },
    Need { name: "libclang", package: "libclang-dev", is_there: has_libclang },
];

/// Checks for all tools, so that a build does not fail after minutes.
///
/// # Errors
/// One line with the missing tools and how to install them.
pub fn check() -> Result<()> {
    match complaint(&NEEDS.iter().filter(|need| !(need.is_there)()).collect::<Vec<_>>()) {
        Some(complaint) => bail!(complaint),
        None => Ok(()),
    }
}

fn complaint(missing: &[&Need]) -> Option<String> {
    if missing.is_empty() {
        return None;
    }
    let list = |part: fn(&Need) -> &str, between: &str| {
        missing.iter().map(|need| part(need)).collect::<Vec<_>>().join(between)
    };
    let (names, packages) = (list(|need| need.name, ", "), list(|need| need.package, " "));
    Some(format!("missing to build Box3D and Jolt: {names}; on Debian `apt-get install {packages}`"))
}

fn is_program(name: &str) -> bool {
    let paths = env::var_os("PATH").unwrap_or_default();
    env::split_paths(&paths)
        .any(|folder| folder.join(name).with_extension(env::consts::EXE_EXTENSION).is_file())
}

fn has_cpp_compiler() -> bool {
    env::var_os("CXX").is_some() || ["c++", "g++", "clang++", "cl"].into_iter().any(is_program)
}

/// Checks roughly the paths that bindgen searches.
fn has_libclang() -> bool {
    if let Some(path) = env::var_os("LIBCLANG_PATH") {
        return holds_libclang(Path::new(&path)) || PathBuf::from(path).is_file();
    }
    let mut folders: Vec<PathBuf> = ["/usr/lib", "/usr/lib64", "/usr/local/lib"].map(PathBuf::from).into();
    folders.extend(subfolders("/usr/lib"));
    folders.extend(subfolders("/usr/lib").into_iter().map(|folder| folder.join("lib")));
    folders.extend(
        ["/Library/Developer/CommandLineTools/usr/lib", "C:/Program Files/LLVM/bin"].map(PathBuf::from),
    );
    folders.iter().any(|folder| holds_libclang(folder))
}

fn subfolders(folder: &str) -> Vec<PathBuf> {
    fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect()
}

fn holds_libclang(folder: &Path) -> bool {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.into_iter().any(|entry| {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let is_library = [".so", ".dylib", ".dll"].iter().any(|extension| name.contains(extension));
        is_library
            && (name.starts_with("libclang.") || name.starts_with("libclang-") && !name.contains("cpp"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_tools_are_listed_in_one_line() {
        assert_eq!(complaint(&[]), None);
        assert_eq!(
            complaint(&[&NEEDS[0], &NEEDS[2]]).as_deref(),
            Some(
                "missing to build Box3D and Jolt: cmake, libclang; on Debian `apt-get install cmake libclang-dev`"
            )
        );
    }

    #[test]
    fn a_program_is_found_on_the_path() {
        assert!(is_program("cargo"));
        assert!(!is_program("cargo-that-is-nowhere"));
    }
}
