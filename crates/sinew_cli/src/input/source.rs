//! Files given as arguments; `-` is standard input.

use sinew::formats::{
    Document, Error, MotionFile, MotionOptions, ReadOptions, Result, TriangleMesh, no_files, read_gltf,
    read_motion,
};
use std::io::Read as _;
use std::path::Path;
use std::sync::OnceLock;

/// Returns true for the path of standard input.
pub fn is_stdin(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Returns the name of a file in messages.
pub fn name(path: &Path) -> String {
    if is_stdin(path) { "standard input".to_owned() } else { path.display().to_string() }
}

/// Returns the bytes of standard input, read once and cached.
fn stdin() -> Result<&'static [u8]> {
    static BYTES: OnceLock<std::result::Result<Vec<u8>, String>> = OnceLock::new();
    let read = BYTES.get_or_init(|| {
        let mut bytes = Vec::new();
        std::io::stdin().read_to_end(&mut bytes).map(|_| bytes).map_err(|error| error.to_string())
    });
    match read {
        Ok(bytes) => Ok(bytes),
        Err(what) => Err(Error::unsupported(what.clone(), "").with_file("standard input")),
    }
}

/// Returns the bytes of a file.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    if is_stdin(path) { stdin().map(<[u8]>::to_vec) } else { sinew::formats::read_bytes(path) }
}

/// Reads a character; standard input has no neighbouring files.
pub fn load_gltf(path: &Path, options: ReadOptions) -> Result<Document> {
    if !is_stdin(path) {
        return sinew::formats::load_gltf(path, options);
    }
    read_gltf(stdin()?, options, &mut no_files).map_err(|error| error.with_file(name(path)))
}

/// Reads a file with clips, like [`load_gltf`].
pub fn load_motion(path: &Path, options: &MotionOptions<'_>) -> Result<MotionFile> {
    if !is_stdin(path) {
        return sinew::formats::load_motion(path, options);
    }
    read_motion(stdin()?, options, &mut no_files).map_err(|error| error.with_file(name(path)))
}

/// Reads a mesh from a GLB or glTF, like [`load_gltf`].
pub fn load_mesh(path: &Path) -> Result<TriangleMesh> {
    if !is_stdin(path) {
        return sinew::formats::load_mesh(path);
    }
    let document = load_gltf(path, ReadOptions::default())?;
    TriangleMesh::from_document(&document).map_err(|error| error.with_file(name(path)))
}
