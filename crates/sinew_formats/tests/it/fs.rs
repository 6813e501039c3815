//! Tests of files on disk: they are written atomically, and nothing is read outside a glTF's folder.

use sinew_formats::{ErrorKind, ReadOptions, load_gltf, read_bytes, write_all_atomic, write_atomic};
use std::fs;
use std::path::PathBuf;

/// Returns an empty folder of this test run.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("sinew-formats-{}-{name}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn write_replaces_the_file_and_leaves_no_temporary() {
    let folder = folder("write");
    let path = folder.join("a.json");
    write_atomic(&path, b"one").unwrap();
    write_atomic(&path, b"two").unwrap();
    assert_eq!(read_bytes(&path).unwrap(), b"two");
    // A file cannot replace a folder: the write fails and cleans up.
    fs::create_dir(folder.join("taken")).unwrap();
    let error = write_atomic(folder.join("taken"), b"x").unwrap_err();
    assert_eq!(error.kind, ErrorKind::Io);
    assert!(error.file.ends_with("taken") && error.what.starts_with("cannot write: "), "{error}");
    let mut left: Vec<_> = fs::read_dir(&folder).unwrap().map(|e| e.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, ["a.json", "taken"]);
    fs::remove_dir_all(folder).unwrap();
}

/// For a link, the target is written and the link stays; only regular files are replaced.
#[cfg(unix)]
#[test]
fn only_regular_files_are_replaced() {
    use std::os::unix::fs::symlink;
    let folder = folder("replaced");
    fs::create_dir(folder.join("far")).unwrap();
    fs::write(folder.join("far/target.json"), "old").unwrap();
    symlink("far/target.json", folder.join("link.json")).unwrap();
    symlink("link.json", folder.join("second.json")).unwrap();
    symlink("far/new.json", folder.join("dangling.json")).unwrap();
    for (link, target) in [("second.json", "far/target.json"), ("dangling.json", "far/new.json")] {
        write_atomic(folder.join(link), b"new").unwrap();
        assert_eq!(fs::read(folder.join(target)).unwrap(), b"new", "{link}");
        assert!(fs::symlink_metadata(folder.join(link)).unwrap().is_symlink(), "{link}");
    }
    symlink("/dev/null", folder.join("device.json")).unwrap();
    symlink("circle.json", folder.join("circle.json")).unwrap();
    let socket = std::os::unix::net::UnixListener::bind(folder.join("socket.json")).unwrap();
    for (name, why) in [
        ("device.json", "exists and is not a regular file"),
        ("socket.json", "exists and is not a regular file"),
        ("far", "exists and is not a regular file"),
        ("circle.json", "is a link in a circle of links"),
    ] {
        let error = write_atomic(folder.join(name), b"new").unwrap_err();
        assert_eq!(error.what, format!("cannot write: {why}"), "{name}");
    }
    drop(socket);
    assert!(!fs::metadata("/dev/null").unwrap().is_file());
    assert_eq!(fs::read_dir(folder.join("far")).unwrap().count(), 2, "a temporary file remains");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn several_files_appear_only_when_all_are_written() {
    let folder = folder("several");
    let (good, bad) = (folder.join("a"), folder.join("none/b"));
    let error = write_all_atomic(&[(&good, "one"), (&bad, "two")]).unwrap_err();
    assert_eq!(error.file, bad.display().to_string());
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
    write_all_atomic(&[(&good, "one"), (&folder.join("b"), "two")]).unwrap();
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 2);
    assert_eq!(read_bytes(&good).unwrap(), b"one");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn missing_files_and_folders_are_named() {
    let folder = folder("missing");
    let missing = folder.join("none.glb");
    let error = load_gltf(&missing, ReadOptions::default()).unwrap_err();
    assert_eq!(error.to_string(), format!("{}: no such file", missing.display()));
    let error = read_bytes(&folder).unwrap_err();
    assert_eq!(error.to_string(), format!("{}: is not a regular file", folder.display()));
    let error = write_atomic(folder.join("none/a"), b"").unwrap_err();
    assert_eq!(error.what, "cannot write: no such folder");
    let below_a_file = folder.join("a.txt/b.glb");
    fs::write(folder.join("a.txt"), b"text").unwrap();
    for error in [read_bytes(&below_a_file).unwrap_err(), write_atomic(&below_a_file, b"").unwrap_err()] {
        assert!(!error.what.contains("os error") && error.what.contains("folder"), "{error}");
    }
    fs::remove_dir_all(folder).unwrap();
}

#[cfg(unix)]
#[test]
fn link_out_of_the_folder_is_not_followed() {
    let folder = folder("jail");
    let inside = folder.join("inside");
    fs::create_dir(&inside).unwrap();
    fs::write(folder.join("secret.bin"), [0; 4]).unwrap();
    fs::write(inside.join("own file.bin"), [0; 4]).unwrap();
    std::os::unix::fs::symlink(folder.join("secret.bin"), inside.join("link.bin")).unwrap();
    let gltf = |uri: &str| {
        let path = inside.join("a.gltf");
        let text = format!(r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":4,"uri":"{uri}"}}]}}"#);
        fs::write(&path, text).unwrap();
        load_gltf(path, ReadOptions::default())
    };
    assert!(gltf("own%20file.bin").is_ok());
    let error = gltf("link.bin").unwrap_err();
    assert_eq!(error.what, "`link.bin`: leaves the folder of the file");
    assert_eq!(error.where_, "buffers[0].uri");
    fs::remove_dir_all(folder).unwrap();
}
