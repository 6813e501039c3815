//! Help, and errors reported before any work.

use crate::sinew::{Run, command, sinew};

const COMMANDS: [&[&str]; 14] = [
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
    &["record"],
    &["replay"],
];

#[test]
fn every_command_shows_an_example() {
    for command in COMMANDS {
        let run = sinew(&[command, &["--help"]].concat());
        let example = format!("Example:\n  sinew {}", command.join(" "));
        assert!(run.code == Some(0) && run.stdout.contains(&example), "{command:?}: {run:?}");
    }
}

/// A narrow terminal breaks paragraphs only where a line is full, and does not break the lines of examples.
#[test]
fn help_wraps_once() {
    let narrow = 80;
    for arguments in COMMANDS.iter().copied().chain([&[][..]]) {
        let help = |width: usize| {
            let mut run = command(&[arguments, &["--help"]].concat());
            Run::of(run.env("COLUMNS", width.to_string())).stdout
        };
        let text = help(narrow);
        let long = text.lines().find(|line| line.chars().count() > narrow);
        assert_eq!(long, None, "{arguments:?}");
        let wide = help(100);
        let (_, after) = wide.split_once("\n\nExample:\n").unwrap_or_default();
        let (examples, prose) = after.split_once("\n\n").unwrap_or((after, ""));
        for line in examples.lines() {
            assert!(text.lines().any(|other| other == line), "{arguments:?}: {line}");
        }
        // The first word after a break did not fit into the line before.
        for paragraph in prose.split("\n\n") {
            let lines: Vec<&str> = paragraph.lines().collect();
            for pair in lines.windows(2) {
                let next = pair[1].split_whitespace().next().unwrap_or_default();
                let needed = pair[0].chars().count() + 1 + next.chars().count();
                assert!(needed > 100, "{arguments:?}: the line breaks too early, after {:?}", pair[0]);
            }
        }
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
