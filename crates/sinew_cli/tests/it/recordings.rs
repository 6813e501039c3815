//! `sinew record` and `sinew replay`.

use crate::contract::check_keys;
use crate::sinew::{Folder, sinew};

#[test]
fn a_recording_verifies_and_differs_where_it_differs() {
    let folder = Folder::new("recordings");
    let (mine, theirs) = (folder.path("mine.sinewrec"), folder.path("theirs.sinewrec"));
    let object = sinew(&["record", "pendulum", "-o", &mine, "--steps", "50", "--json"]).json();
    check_keys("record", &object);
    assert_eq!((&object["steps"], &object["key_frames"]), (&50.into(), &3.into()));
    let ran = sinew(&["run", "pendulum", "--steps", "50", "--json"]).json();
    assert_eq!(ran["hash"], object["hash"], "a recording is a run");
    let replayed = sinew(&["replay", &mine, "--verify", "--json"]).json();
    check_keys("replay", &replayed);
    assert_eq!(replayed["hash"], object["hash"]);
    assert!(replayed["diverged_at"].is_null());

    let other = ["record", "pendulum", "-o", &theirs, "--steps", "50", "--set", "amplitude=31"];
    assert_eq!(sinew(&other).code, Some(0));
    let differs = sinew(&["replay", &mine, "--diff", &theirs]);
    assert!(differs.refusal(1).contains("another scene or other settings"), "{differs:?}");
    assert!(sinew(&["replay", &mine, "--diff", &mine]).stdout.contains("50 steps, all equal"));

    // Of another version, and with another hash at the last step.
    let mut bytes = std::fs::read(&mine).expect("it is there");
    let version = bytes.windows(5).position(|it| it == b"0.1.0").expect("the version is in it");
    bytes[version] = b'9';
    let tampered = folder.file("tampered.sinewrec", &bytes);
    assert_eq!(
        sinew(&["replay", &tampered, "--verify"]).code,
        Some(0),
        "the bits are those of this version all the same"
    );
    let hash = object["hash"].as_str().expect("a hash");
    let hash = u64::from_str_radix(hash, 16).expect("hexadecimal").to_le_bytes();
    let place = bytes.windows(8).position(|it| it == hash).expect("the last hash is in it");
    bytes[place] ^= 1;
    let tampered = folder.file("tampered.sinewrec", &bytes);
    let refused = sinew(&["replay", &tampered, "--verify"]);
    let line = refused.refusal(1);
    assert!(line.contains("version 9.1.0, and this is 0.1.0 (step 50)"), "{line}");
    let told = sinew(&["replay", &tampered]);
    assert!(told.stdout.contains("from step 50 on"), "{told:?}");
    let diff = sinew(&["replay", &mine, "--diff", &tampered]);
    assert!(diff.refusal(1).contains("though in the pose of no body"), "{diff:?}");
}

#[test]
fn what_cannot_be_recorded_or_replayed_is_a_line() {
    let folder = Folder::new("recordings-refused");
    let file = folder.file("no.sinewrec", "nothing");
    assert_eq!(sinew(&["replay", &file]).refusal(1), format!("error: {file}: is no recording (byte 0)"));
    assert_eq!(sinew(&["replay", "nowhere.sinewrec"]).refusal(1), "error: nowhere.sinewrec: no such file");
    assert!(sinew(&["record", "nix", "-o", "r.sinewrec"]).refusal(2).contains("no scene 'nix'"));
    assert_eq!(sinew(&["record", "stairs", "-o", "r.txt"]).code, Some(2));
}
