//! `sinew record` and `sinew replay`.

use crate::contract::check_keys;
use crate::sinew::{Folder, sinew};
use sinew_scenes::recording::Recording;

#[test]
fn recording_verifies_and_diff_finds_the_step() {
    let folder = Folder::new("recordings");
    let (mine, theirs) = (folder.path("mine.sinewrec"), folder.path("theirs.sinewrec"));
    let object = sinew(&["record", "pendulum", "-o", &mine, "--steps", "50", "--json"]).json();
    check_keys("record", &object);
    assert_eq!((&object["steps"], &object["key_frames"]), (&50.into(), &3.into()));
    let ran = sinew(&["run", "pendulum", "--steps", "50", "--json"]).json();
    assert_eq!(ran["hash"], object["hash"], "the hashes of recording and run differ");
    let replayed = sinew(&["replay", &mine, "--verify", "--json"]).json();
    check_keys("replay", &replayed);
    assert_eq!(replayed["hash"], object["hash"]);
    assert!(replayed["diverged_at"].is_null());

    let other = ["record", "pendulum", "-o", &theirs, "--steps", "50", "--set", "amplitude=31"];
    assert_eq!(sinew(&other).code, Some(0));
    let differs = sinew(&["replay", &mine, "--diff", &theirs]);
    assert!(differs.refusal(1).contains("another scene or other settings"), "{differs:?}");
    assert!(sinew(&["replay", &mine, "--diff", &mine]).stdout.contains("50 steps, all equal"));

    // The recording is of another version, and has another hash at the last step.
    let mut recording =
        Recording::read(&std::fs::read(&mine).expect("the file can be read")).expect("a recording");
    recording.made_by = "9.1.0".to_owned();
    let tampered = folder.file("tampered.sinewrec", recording.to_bytes());
    assert_eq!(
        sinew(&["replay", &tampered, "--verify"]).code,
        Some(0),
        "equal bits of another version must be accepted"
    );
    recording.steps[49].hash ^= 1;
    let tampered = folder.file("tampered.sinewrec", recording.to_bytes());
    let refused = sinew(&["replay", &tampered, "--verify"]);
    let line = refused.refusal(1);
    assert!(line.contains("version 9.1.0, and this is 0.1.0 (step 50)"), "{line}");
    let run_again = sinew(&["replay", &tampered]);
    assert!(run_again.stdout.contains("from step 50 on"), "{run_again:?}");
    let diff = sinew(&["replay", &mine, "--diff", &tampered]);
    assert!(diff.refusal(1).contains("but not in the pose of a body"), "{diff:?}");
}

#[test]
fn damaged_and_tampered_recordings_are_reported() {
    let folder = Folder::new("recordings-damaged");
    let mine = folder.path("mine.sinewrec");
    assert_eq!(sinew(&["record", "pendulum", "-o", &mine, "--steps", "50"]).code, Some(0));
    let bytes = std::fs::read(&mine).expect("the file can be read");
    for k in 0..60 {
        let place = k * (bytes.len() - 1) / 59;
        let mut flipped = bytes.clone();
        flipped[place] ^= 1 << (k % 8);
        let damaged = folder.file("damaged.sinewrec", &flipped);
        let refused = sinew(&["replay", &damaged, "--verify"]);
        assert!(refused.refusal(1).contains("damaged.sinewrec: "), "damaged byte {place}: {refused:?}");
    }
    let mut recording = Recording::read(&bytes).expect("a recording");
    recording.key_frames[1].bodies[0].1.translation.y += 0.5;
    let tampered = folder.file("tampered.sinewrec", recording.to_bytes());
    let line = sinew(&["replay", &tampered, "--verify"]).refusal(1).to_owned();
    assert!(line.ends_with("by the same version (step 30)"), "{line}");
}

#[test]
fn invalid_recording_commands_fail_with_one_line() {
    let folder = Folder::new("recordings-refused");
    let file = folder.file("no.sinewrec", "nothing");
    assert_eq!(sinew(&["replay", &file]).refusal(1), format!("error: {file}: is no recording (byte 0)"));
    assert_eq!(sinew(&["replay", "nowhere.sinewrec"]).refusal(1), "error: nowhere.sinewrec: no such file");
    assert!(sinew(&["record", "nix", "-o", "r.sinewrec"]).refusal(2).contains("no scene 'nix'"));
    assert_eq!(sinew(&["record", "stairs", "-o", "r.txt"]).code, Some(2));
}
