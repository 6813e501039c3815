//! Help, and errors reported before any work.

use crate::sinew::sinew;

#[test]
fn every_command_shows_an_example() {
    let commands: [&[&str]; 12] = [
        &["demo"],
        &["bake"],
        &["ragdoll", "build"],
        &["ragdoll", "doctor"],
        &["ragdoll", "export"],
        &["boxes"],
        &["convert"],
        &["events", "detect"],
        &["inspect"],
        &["run"],
        &["scenes"],
        &["view"],
    ];
    for command in commands {
        let run = sinew(&[command, &["--help"]].concat());
        let example = format!("Example:\n  sinew {}", command.join(" "));
        assert!(run.code == Some(0) && run.stdout.contains(&example), "{command:?}: {run:?}");
    }
}

#[test]
fn misspelt_command_gets_a_suggestion() {
    let typing_error = sinew(&["vieww"]);
    assert_eq!(typing_error.code, Some(2));
    assert!(typing_error.stderr.contains("view"), "{typing_error:?}");
}

#[test]
fn invalid_arguments_are_usage_errors() {
    let commands: [&[&str]; 22] = [
        &[],
        &["convert", "a.bvh"],
        &["convert", "a.bvh", "b.fbx"],
        &["convert", "a.bvh", "b.glb", "-o", "c.glb"],
        &["convert", "a.bvh", "b.glb", "--unit", "0"],
        &["convert", "a.glb", "b.bvh", "--up", "x"],
        &["events", "detect"],
        &["boxes", "a.glb"],
        &["boxes", "a.glb", "-o", "b.json", "--max", "0"],
        &["boxes", "a.glb", "-o", "b.json", "--picture", "b.bmp"],
        &["bake", "a.glb"],
        &["bake", "a.glb", "-o", "b.glb", "--hit", "chest=1,2@1"],
        &["bake", "a.glb", "-o", "b.glb", "--seconds", "0"],
        &["bake", "a.glb", "-o", "b.glb", "--seconds", "NaN"],
        &["bake", "a.glb", "-o", "b.glb", "--fps", "0"],
        &["bake", "a.glb", "-o", "b.glb", "--picture", "b.bmp"],
        &["run", "pendulum", "--steps", "0"],
        &["ragdoll", "build", "a.glb", "--shapes", "hull"],
        &["ragdoll", "doctor", "a.glb", "--fix"],
        &["ragdoll", "export", "a.glb"],
        &["ragdoll", "export", "a.glb", "--as", "urdf"],
        &["ragdoll", "doctor", "a.glb", "-o", "b.sinew.json"],
    ];
    for arguments in commands {
        let run = sinew(arguments);
        assert!(run.code == Some(2) && run.stdout.is_empty(), "{arguments:?}: {run:?}");
    }
}
