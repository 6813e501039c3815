//! The only file IO of the libraries: read, atomic write, and files beside a file that stay beside it.

use crate::error::{Error, Result};
use crate::gltf::{Document, ReadOptions, read_gltf};
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The bytes of a file.
///
/// # Errors
/// Names the file: it is missing, is no regular file, or may not be read.
pub fn read_bytes(path: impl AsRef<Path>) -> Result<Vec<u8>> {
    let path = path.as_ref();
    read_regular(path).map_err(|what| Error::io(what).with_file(path.display().to_string()))
}

fn read_regular(path: &Path) -> Result<Vec<u8>, String> {
    // A device or a pipe may never end.
    let metadata = fs::metadata(path).map_err(|e| reason(&e))?;
    if !metadata.is_file() {
        return Err("is not a regular file".into());
    }
    fs::read(path).map_err(|e| reason(&e))
}

/// One line for what the operating system said, the same on every system where it matters.
fn reason(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "no such file".into(),
        io::ErrorKind::PermissionDenied => "permission denied".into(),
        _ => error.to_string(),
    }
}

/// Writes a file so that nobody ever sees half of it: into a temporary file in the same folder, then renamed.
///
/// # Errors
/// Names the file: its folder is missing, full or write-protected. The temporary file is removed.
pub fn write_atomic(path: impl AsRef<Path>, bytes: &[u8]) -> Result<()> {
    let path = path.as_ref();
    let fail = |e: io::Error| {
        Error::io(format!("cannot write: {}", reason(&e))).with_file(path.display().to_string())
    };
    let name = path.file_name().ok_or_else(|| fail(io::ErrorKind::IsADirectory.into()))?;
    let mut temporary_name = std::ffi::OsString::from(".");
    temporary_name.push(name);
    temporary_name.push(format!(".{}.tmp", std::process::id()));
    let temporary = path.with_file_name(temporary_name);
    let written = fs::File::create(&temporary)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
        .and_then(|()| fs::rename(&temporary, path));
    written.map_err(|e| {
        // Best effort: the error to report is the first one.
        let _ = fs::remove_file(&temporary);
        fail(e)
    })
}

/// Reads a GLB, glTF, VRM or VRMA with the files beside it.
///
/// # Errors
/// As [`read_gltf`], naming the file; also a URI that leaves the file's folder, by `..` or through a link.
pub fn load_gltf(path: impl AsRef<Path>, options: ReadOptions) -> Result<Document> {
    let path = path.as_ref();
    let bytes = read_bytes(path)?;
    let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
    let mut resolve = |relative: &str| read_beside(&folder, relative);
    read_gltf(&bytes, options, &mut resolve).map_err(|e| e.with_file(path.display().to_string()))
}

/// Reads `relative` inside `folder`, refusing links that lead out of it.
fn read_beside(folder: &Path, relative: &str) -> Result<Vec<u8>> {
    let fail = |what: String| Error::io(format!("`{relative}`: {what}"));
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let real = |path: &Path| -> Result<PathBuf> { fs::canonicalize(path).map_err(|e| fail(reason(&e))) };
    let target = real(&folder.join(relative))?;
    if !target.starts_with(real(folder)?) {
        return Err(fail("leaves the folder of the file".into()));
    }
    read_regular(&target).map_err(fail)
}
