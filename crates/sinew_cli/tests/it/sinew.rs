//! Runs the binary, and makes its input files.

use serde_json::Value;
use sinew::anim::{Clip, Rig};
use sinew::formats::write_gltf;
use sinew_scenes::mannequin::mannequin;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Result of a run of the command.
#[derive(Debug)]
pub struct Run {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    /// Runs a prepared command.
    pub fn of(command: &mut Command) -> Self {
        let Output { status, stdout, stderr } = command.output().expect("the binary starts");
        let text = |bytes| String::from_utf8(bytes).expect("the output is UTF-8");
        Self { code: status.code(), stdout: text(stdout), stderr: text(stderr) }
    }

    /// Returns the object of a successful run with `--json`.
    pub fn json(&self) -> Value {
        assert_eq!((self.code, self.stderr.as_str()), (Some(0), ""), "{self:?}");
        serde_json::from_str(&self.stdout).expect("stdout is one JSON object and nothing else")
    }

    /// Returns the line of a run that failed with `code`.
    pub fn refusal(&self, code: i32) -> &str {
        assert_eq!(self.code, Some(code), "{self:?}");
        let line = self.stderr.strip_suffix('\n').expect("the line ends");
        assert!(line.starts_with("error: ") && !line.contains('\n'), "not one line: {self:?}");
        line
    }
}

/// Returns `sinew` with arguments.
pub fn command<A: AsRef<std::ffi::OsStr>>(arguments: &[A]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sinew"));
    command.args(arguments);
    command
}

/// Runs `sinew` with arguments.
pub fn sinew<A: AsRef<std::ffi::OsStr>>(arguments: &[A]) -> Run {
    Run::of(&mut command(arguments))
}

/// An empty folder for one test, removed at the end.
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    pub fn new(test: &str) -> Self {
        // Two tests may use the same name.
        static FOLDERS: AtomicUsize = AtomicUsize::new(0);
        let number = FOLDERS.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("sinew-cli-{}-{number}-{test}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).expect("a folder for outputs");
        Self { path }
    }

    pub fn path(&self, name: &str) -> String {
        self.path.join(name).display().to_string()
    }

    /// Writes a file into the folder.
    pub fn file(&self, name: &str, bytes: impl AsRef<[u8]>) -> String {
        let path = self.path(name);
        fs::write(&path, bytes).expect("a file for the test");
        path
    }

    /// Writes the mannequin with its walk as a user's file.
    pub fn mannequin(&self) -> String {
        let mannequin = mannequin();
        let walk = Clip { name: "Walk".into(), ..mannequin.clips[mannequin.motions.walk].clone() };
        self.file("mannequin.glb", glb(&mannequin.rig, &[walk]))
    }

    /// Returns the sorted names of the folder's entries.
    pub fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.path).expect("the folder exists");
        let name = |entry: std::io::Result<fs::DirEntry>| {
            entry.expect("an entry").file_name().to_string_lossy().into_owned()
        };
        let mut names: Vec<String> = entries.map(name).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.path);
    }
}

pub fn glb(rig: &Rig, clips: &[Clip]) -> Vec<u8> {
    write_gltf(rig, clips).expect("a rig made by code can be written")
}

/// Returns the folder of test data beside the workspace, for tests with `needs_data`.
pub fn shared_data() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"))
}

/// Returns every glTF, GLB, VRM and VRMA file below `folder`, sorted.
pub fn gltf_files(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of test data") {
            let path = entry.expect("an entry").path();
            let kind = path.extension().and_then(|kind| kind.to_str());
            if path.is_dir() {
                open.push(path);
            } else if matches!(kind, Some("glb" | "gltf" | "vrm" | "vrma")) {
                found.push(path.display().to_string());
            }
        }
    }
    found.sort();
    found
}
