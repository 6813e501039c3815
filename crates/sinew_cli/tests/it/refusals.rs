//! Files that must be rejected: exit code 1, one line, little memory, no output.

use crate::sinew::{Folder, Run, command, glb, gltf_files, shared_data, sinew};
use needs_data::needs_data;
use sinew::anim::Rig;
use sinew_scenes::mannequin::mannequin;
use std::process::Command;

/// Memory that a rejection may use, KiB, besides the program's code, which is large with a window.
const MEMORY_KIB: u32 = 40 * 1024;

/// Runs `sinew` with that memory limit, if the system supports it.
fn run_with_little_memory(arguments: &[&str]) -> Run {
    if !cfg!(target_os = "linux") {
        return sinew(arguments);
    }
    let limited = format!("ulimit -d {MEMORY_KIB} && exec \"$0\" \"$@\"");
    let mut shell = Command::new("sh");
    shell.args(["-c", &limited]).arg(command(arguments).get_program()).args(arguments);
    Run::of(&mut shell)
}

/// Checks that `bake` and `ragdoll build` reject the file with a line that contains `reason`, and write nothing.
fn check_refused(folder: &Folder, file: &str, reason: &str) {
    let before = folder.names();
    let (out, def) = (folder.path("out.glb"), folder.path("out.json"));
    for arguments in [["bake", file, "-o", &out].as_slice(), &["ragdoll", "build", file, "-o", &def]] {
        let run = run_with_little_memory(arguments);
        let line = run.refusal(1);
        assert!(line.starts_with(&format!("error: {file}: ")) && line.contains(reason), "{line}");
        assert_eq!(run.stdout, "");
    }
    assert_eq!(folder.names(), before);
}

#[test]
fn broken_containers_are_rejected() {
    let folder = Folder::new("containers");
    let whole = glb(&mannequin().rig, &[]);
    let truncated = folder.file("truncated.glb", &whole[..whole.len() / 2]);
    check_refused(&folder, &truncated, "claims");
    let text = folder.file("text.glb", "To whom it may concern");
    check_refused(&folder, &text, "not a glTF file");
    let mut huge = whole.clone();
    huge[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    let huge = folder.file("huge.glb", huge);
    check_refused(&folder, &huge, "chunk claims 4294967295 bytes");
    let empty = folder.file("empty.glb", "");
    check_refused(&folder, &empty, "empty");
    check_refused(&folder, &folder.path("missing.glb"), "no such file");
}

#[test]
fn joint_out_of_range_is_rejected() {
    let folder = Folder::new("joint");
    let file = folder.file(
        "joint.gltf",
        r#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0,"skin":0}],"skins":[{"joints":[7]}],"meshes":[]}"#,
    );
    let run = sinew(&["ragdoll", "build", &file, "--json"]);
    assert!(run.refusal(1).contains("(skins[0].joints[0])"), "{run:?}");
    let object: serde_json::Value = serde_json::from_str(&run.stdout).expect("one JSON object");
    assert_eq!(object["error"]["where"], "skins[0].joints[0]");
    check_refused(&folder, &file, "skins[0].joints[0]");
}

#[test]
fn mesh_without_a_skin_is_rejected() {
    let folder = Folder::new("skinless");
    let mut rig = Rig { skins: Vec::new(), ..mannequin().rig };
    for mesh in &mut rig.meshes {
        mesh.skin = None;
        for part in &mut mesh.primitives {
            (part.joints, part.weights) = (Vec::new(), Vec::new());
        }
    }
    let file = folder.file("skinless.glb", glb(&rig, &[]));
    check_refused(&folder, &file, "no skin: nothing to build a ragdoll from");
    assert_eq!(sinew(&["inspect", &file]).code, Some(0));
}

#[needs_data]
#[test]
fn files_without_a_character_are_rejected() {
    let data = shared_data();
    let folder = Folder::new("negative");
    let files = gltf_files(&data.join("negative"));
    assert!(!files.is_empty());
    for file in files {
        check_refused(&folder, &file, "no skin: nothing to build a ragdoll from");
        let inspected = run_with_little_memory(&["inspect", &file, "--json"]).json();
        assert_eq!(inspected["skins"], 0, "{file}");
    }
}

#[needs_data]
#[test]
fn bad_input_is_inspected_or_rejected() {
    let data = shared_data();
    let files = gltf_files(&data.join("bad_input"));
    assert!(!files.is_empty());
    for file in files {
        let run = sinew(&["inspect", &file]);
        match run.code {
            Some(0) => assert!(run.stderr.is_empty() && !run.stdout.is_empty(), "{file}: {run:?}"),
            _ => assert!(run.refusal(1).starts_with(&format!("error: {file}: ")), "{file}: {run:?}"),
        }
    }
}
