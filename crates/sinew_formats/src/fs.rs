//! All file access of the libraries: reading, atomic writing, and reading files in the folder of another file.
//!
//! ```
//! use sinew_formats::{load_world, write_atomic};
//!
//! let file = std::env::temp_dir().join(format!("sinew-doc-{}.json", std::process::id()));
//! let level = r#"{"sinew": "world", "version": 1, "bodies": [{"shapes": [{"type": "half_space"}]}]}"#;
//! write_atomic(&file, level.as_bytes())?;
//! assert_eq!(load_world(&file)?.len(), 1);
//! std::fs::remove_file(&file)?;
//! let error = load_world(&file).expect_err("the file was removed");
//! assert!(error.to_string().contains("sinew-doc"), "{error}"); // errors name the file
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::deepmimic::{DeepMimicCharacter, read_deepmimic_character};
use crate::error::{Error, Result, quoted};
use crate::events::read_events;
use crate::gltf::{Document, ReadOptions, read_gltf};
use crate::mesh::TriangleMesh;
use crate::motion::{MotionFile, MotionFormat, MotionOptions, read_motion};
use crate::obj::read_obj;
use crate::world::read_world;
use sinew_physics::BodyDef;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Reads the bytes of a file.
///
/// # Errors
/// Returns an error that names the file: it is missing, is no regular file, or may not be read.
pub fn read_bytes(path: impl AsRef<Path>) -> Result<Vec<u8>> {
    let path = path.as_ref();
    read_regular(path).map_err(|what| Error::io(what).with_file(path.display().to_string()))
}

fn read_regular(path: &Path) -> Result<Vec<u8>, String> {
    // A device or a pipe may never end.
    let metadata = fs::metadata(path).map_err(|e| reason(path, &e))?;
    if !metadata.is_file() {
        return Err("is not a regular file".into());
    }
    fs::read(path).map_err(|e| reason(path, &e))
}

/// Returns a one-line text of an operating-system error, equal on all systems where it matters.
fn reason(path: &Path, error: &io::Error) -> String {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    match error.kind() {
        io::ErrorKind::NotFound if folder.is_some_and(|folder| !folder.is_dir()) => "no such folder".into(),
        io::ErrorKind::NotFound => "no such file".into(),
        io::ErrorKind::NotADirectory => "its folder is a file".into(),
        io::ErrorKind::IsADirectory => "is a folder".into(),
        io::ErrorKind::PermissionDenied => "permission denied".into(),
        io::ErrorKind::StorageFull => "no space left".into(),
        // Removes the error number, which differs between systems.
        _ => error.to_string().split(" (os error ").next().unwrap_or_default().to_owned(),
    }
}

/// Writes a file atomically: into a temporary file in the same folder, which is then renamed. If the path is a symbolic
/// link, its target is written. Only regular files are replaced.
///
/// # Errors
/// Returns an error that names the file: its folder is missing, full or write-protected; it is a folder, a device or a
/// pipe. The temporary file is removed.
pub fn write_atomic(path: impl AsRef<Path>, bytes: &[u8]) -> Result<()> {
    write_all_atomic(&[(path, bytes)])
}

/// Writes files that belong together, like [`write_atomic`]; a file is renamed only after the bytes of all files are on
/// disk.
///
/// # Errors
/// Returns an error that names the first file that could not be written. Files already renamed stay.
pub fn write_all_atomic(files: &[(impl AsRef<Path>, impl AsRef<[u8]>)]) -> Result<()> {
    let mut staged = Vec::with_capacity(files.len());
    for (path, bytes) in files {
        let path = path.as_ref();
        let place = place_of(path).map_err(|e| cannot_write(path, &e))?;
        staged.push(Staged::write(path, place, bytes.as_ref()).map_err(|e| cannot_write(path, &e))?);
    }
    staged.into_iter().try_for_each(|file| file.publish().map_err(|e| cannot_write(file.path, &e)))
}

fn cannot_write(path: &Path, error: &io::Error) -> Error {
    Error::io(format!("cannot write: {}", reason(path, error))).with_file(path.display().to_string())
}

/// Returns the target path of an output: symbolic links are resolved; all but regular files are rejected.
fn place_of(path: &Path) -> io::Result<PathBuf> {
    // Largest number of links, the same as on Linux.
    const MOST_LINKS: usize = 40;
    let mut place = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        let data = match fs::symlink_metadata(&place) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(place),
            data => data?,
        };
        if data.is_file() {
            return Ok(place);
        }
        if !data.is_symlink() {
            return Err(io::Error::other("exists and is not a regular file"));
        }
        let target = fs::read_link(&place)?;
        place = place.parent().unwrap_or(Path::new("")).join(target);
    }
    Err(io::Error::other("is a link in a circle of links"))
}

/// Bytes of a file under a temporary name next to the target; the file is deleted on drop if it was not renamed.
struct Staged<'a> {
    /// Path as given by the user.
    path: &'a Path,
    place: PathBuf,
    temporary: PathBuf,
}

impl<'a> Staged<'a> {
    fn write(path: &'a Path, place: PathBuf, bytes: &[u8]) -> io::Result<Self> {
        let name = place.file_name().ok_or(io::ErrorKind::IsADirectory)?;
        let mut temporary_name = std::ffi::OsString::from(".");
        temporary_name.push(name);
        temporary_name.push(format!(".{}.tmp", std::process::id()));
        let temporary = place.with_file_name(temporary_name);
        let staged = Self { path, place, temporary };
        let mut file = fs::File::create(&staged.temporary)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        Ok(staged)
    }

    fn publish(&self) -> io::Result<()> {
        fs::rename(&self.temporary, &self.place)
    }
}

impl Drop for Staged<'_> {
    fn drop(&mut self) {
        // Renamed files no longer exist here; for others the first error is the one to report.
        let _ = fs::remove_file(&self.temporary);
    }
}

/// Reads a GLB, glTF, VRM or VRMA with the files next to it.
///
/// # Errors
/// As [`read_gltf`], with the file name; also for a URI that leaves the file's folder, by `..` or through a link.
pub fn load_gltf(path: impl AsRef<Path>, options: ReadOptions) -> Result<Document> {
    let path = path.as_ref();
    let bytes = read_bytes(path)?;
    let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
    let mut resolve = |relative: &str| read_beside(&folder, relative);
    read_gltf(&bytes, options, &mut resolve).map_err(|e| e.with_file(path.display().to_string()))
}

/// Reads any file with clips. The events file `NAME.events.json` next to it overrides the events of the clips that it
/// lists. Clips of formats without clip names are named after the file.
///
/// Without a character in `options`, a DeepMimic clip uses the first character in its folder, by name, that matches it.
///
/// # Errors
/// As [`read_motion`] and [`read_events`], with the file name.
pub fn load_motion(path: impl AsRef<Path>, options: &MotionOptions<'_>) -> Result<MotionFile> {
    let path = path.as_ref();
    let mut file = read_any(path, options).map_err(|e| e.with_file(path.display().to_string()))?;
    if let ([clip], Some(stem)) = (&mut file.clips[..], path.file_stem())
        && clip.name.is_empty()
        && !matches!(file.format, MotionFormat::Glb | MotionFormat::Gltf)
    {
        clip.name = stem.to_string_lossy().into_owned();
    }
    let beside = events_path(path);
    if beside.is_file() {
        let found = read_bytes(&beside)
            .and_then(|bytes| read_events(&bytes, &file.clips))
            .map_err(|e| e.with_file(beside.display().to_string()))?;
        for (events, found) in file.events.iter_mut().zip(found) {
            *events = found.unwrap_or(core::mem::take(events));
        }
    }
    Ok(file)
}

/// Returns the path of the events of a clip file: `walk.events.json` for `walk.bvh`.
pub fn events_path(clip_file: impl AsRef<Path>) -> PathBuf {
    clip_file.as_ref().with_extension("events.json")
}

/// Returns the path of the settings of a character's ragdoll: `hero.ragdoll.json` for `hero.glb`.
pub fn settings_path(character_file: impl AsRef<Path>) -> PathBuf {
    character_file.as_ref().with_extension("ragdoll.json")
}

fn read_any(path: &Path, options: &MotionOptions<'_>) -> Result<MotionFile> {
    let bytes = read_bytes(path)?;
    let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
    let mut resolve = |relative: &str| read_beside(&folder, relative);
    if options.deepmimic.is_some() || MotionFormat::of(&bytes)? != MotionFormat::DeepMimic {
        return read_motion(&bytes, options, &mut resolve);
    }
    for (name, character) in characters_beside(path) {
        let options = MotionOptions { deepmimic: Some(&character), ..*options };
        if let Ok(mut file) = read_motion(&bytes, &options, &mut resolve) {
            file.notes.push(format!("the joints are those of {name}, which is beside it"));
            return Ok(file);
        }
    }
    read_motion(&bytes, options, &mut resolve).map_err(|mut error| {
        let extension = path.extension().map_or("no extension".into(), |it| format!(".{}", it.display()));
        error.what += &format!("; none beside it, in its folder with {extension}, fits");
        error
    })
}

/// Returns the DeepMimic characters in the folder of a clip, by name.
fn characters_beside(path: &Path) -> Vec<(String, DeepMimicCharacter)> {
    // A character file is short, but the folder may contain any files, so their size and number are limited.
    const LARGEST: u64 = 1 << 20;
    const MOST_FILES: usize = 1000;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let of_kind = |other: &PathBuf| {
        let is_small = fs::metadata(other).is_ok_and(|data| data.is_file() && data.len() <= LARGEST);
        other.extension() == path.extension() && other != path && is_small
    };
    let mut files: Vec<PathBuf> = entries.take(MOST_FILES).filter(of_kind).collect();
    files.sort();
    let read = |file: PathBuf| {
        let character = read_deepmimic_character(&fs::read(&file).ok()?).ok()?;
        Some((file.file_name()?.to_string_lossy().into_owned(), character))
    };
    files.into_iter().filter_map(read).collect()
}

/// Reads the triangles of a mesh file: an OBJ by its extension, else a file that [`load_gltf`] reads.
///
/// # Errors
/// As [`load_gltf`] and [`read_obj`], with the file name.
pub fn load_mesh(path: impl AsRef<Path>) -> Result<TriangleMesh> {
    let path = path.as_ref();
    let name = path.display().to_string();
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj")) {
        return read_obj(&read_bytes(path)?).map_err(|e| e.with_file(name));
    }
    TriangleMesh::from_document(&load_gltf(path, ReadOptions::default())?).map_err(|e| e.with_file(name))
}

/// Reads the bodies of a level: a world file, or a mesh file (GLB, glTF, VRM or OBJ), which becomes one static body.
///
/// # Errors
/// As [`read_world`] and [`load_mesh`], with the file name.
pub fn load_world(path: impl AsRef<Path>) -> Result<Vec<BodyDef>> {
    let path = path.as_ref();
    let name = || path.display().to_string();
    let is_mesh = path.extension().is_some_and(|extension| {
        ["glb", "gltf", "vrm", "obj"].iter().any(|known| extension.eq_ignore_ascii_case(known))
    });
    if is_mesh {
        return Ok(vec![load_mesh(path)?.to_body().map_err(|e| e.with_file(name()))?]);
    }
    read_world(&read_bytes(path)?).map_err(|e| e.with_file(name()))
}

/// Reads `relative` inside `folder`; rejects links out of the folder.
fn read_beside(folder: &Path, relative: &str) -> Result<Vec<u8>> {
    let fail = |what: String| Error::io(format!("{}: {what}", quoted(relative)));
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let real =
        |path: &Path| -> Result<PathBuf> { fs::canonicalize(path).map_err(|e| fail(reason(path, &e))) };
    let target = real(&folder.join(relative))?;
    if !target.starts_with(real(folder)?) {
        return Err(fail("leaves the folder of the file".into()));
    }
    read_regular(&target).map_err(fail)
}
