//! `sinew view`: pictures of scenes and worlds, with equal bytes on every machine.

use crate::contract::check_keys;
use crate::sinew::{Folder, Run, command, sinew};
use sinew::math::hash::hash_bytes;

#[test]
fn picture_has_equal_bytes_on_every_machine() {
    let folder = Folder::new("view-golden");
    let out = folder.path("pendulum.png");
    let arguments = ["view", "pendulum", "--picture", &out, "--at", "0", "--width", "160", "--height", "90"];
    let object = sinew(&[&arguments[..], &["--json"]].concat()).json();
    check_keys("view", &object);
    assert_eq!(object["outputs"][0], out.as_str());
    assert_eq!(object["at_s"], 0.0);
    assert!(object["seconds"].is_null(), "{object}");
    let bytes = std::fs::read(&out).expect("the picture exists");
    assert_eq!(format!("{:016x}", hash_bytes(&bytes)), "b1f3ac56c5a34763");
}

#[test]
fn a_setting_and_the_time_change_the_picture() {
    let folder = Folder::new("view-settings");
    let picture = |name: &str, extra: &[&str]| {
        let out = folder.path(name);
        let run = sinew(
            &[&["view", "pendulum", "--picture", &out, "--width", "64", "--height", "36"], extra].concat(),
        );
        assert_eq!(run.code, Some(0), "{run:?}");
        std::fs::read(&out).expect("the picture exists")
    };
    let one = picture("a.png", &["--at", "0.5"]);
    assert_eq!(picture("b.png", &["--at", "0.5"]), one);
    assert_ne!(picture("c.png", &["--at", "0.9"]), one);
    assert_ne!(picture("d.png", &["--at", "0.5", "--set", "amplitude=80"]), one);
    assert!(picture("e.webp", &["--at", "0.5"]).starts_with(b"RIFF"));
}

#[test]
fn movie_has_twenty_pictures_per_second() {
    let folder = Folder::new("view-movie");
    let out = folder.path("bounce.gif");
    let arguments =
        ["view", "bounce", "--movie", &out, "--seconds", "0.5", "--width", "64", "--height", "36"];
    let object = sinew(&[&arguments[..], &["--json"]].concat()).json();
    check_keys("view", &object);
    assert!(object["at_s"].is_null(), "{object}");
    let bytes = std::fs::read(&out).expect("the movie exists");
    assert!(bytes.starts_with(b"GIF89a"));
    // Each picture starts with a graphic control extension of four bytes.
    let pictures = bytes.windows(3).filter(|window| *window == [0x21, 0xf9, 4]).count();
    assert_eq!(pictures, 11);
}

#[test]
fn falling_world_file_is_drawn() {
    let folder = Folder::new("view-world");
    let text = r#"{"sinew": "world", "version": 1, "bodies": [
        {"shapes": [{"type": "half_space"}]},
        {"kind": "dynamic", "position": [0, 2, 0], "shapes": [{"type": "sphere", "radius": 0.3}]}]}"#;
    let file = folder.file("ball.json", text);
    let picture = |at: &str| {
        let out = folder.path("ball.png");
        let run = sinew(&["view", &file, "--picture", &out, "--at", at, "--width", "64", "--height", "36"]);
        assert_eq!(run.code, Some(0), "{run:?}");
        std::fs::read(&out).expect("the picture exists")
    };
    assert_ne!(picture("0"), picture("0.4"));
    let refused = sinew(&["view", &file, "--picture", &folder.path("x.png"), "--set", "a=1"]);
    assert_eq!(refused.refusal(2), "error: --set is for scenes; a world file has none");
    let missing = sinew(&["view", "nowhere.json", "--picture", &folder.path("x.png")]);
    assert_eq!(missing.refusal(1), "error: nowhere.json: no such file");
    assert_eq!(folder.names(), ["ball.json", "ball.png"]);
}

#[test]
fn undrawable_input_is_a_usage_error() {
    let line = |arguments: &[&str]| sinew(arguments).refusal(2).to_owned();
    let of_nothing = line(&["view", "--picture", "a.png"]);
    assert_eq!(of_nothing, "error: nothing to draw: name a scene or a file");
    let recording = line(&["view", "run.sinewrec", "--picture", "a.png"]);
    assert!(recording.contains("'sinew replay': run.sinewrec"), "{recording}");
    let missing = sinew(&["view", "fall.glb", "--picture", "a.png"]);
    assert_eq!(missing.refusal(1), "error: fall.glb: no such file");
    let unknown = line(&["view", "nix", "--picture", "a.png"]);
    assert!(unknown.starts_with("error: no scene 'nix'; the nearest of "), "{unknown}");
    assert!(unknown.ends_with("; 'sinew scenes' lists all"), "{unknown}");
    for wrong in [
        &["--picture", "a.bmp"][..],
        &["--picture", "a.png", "--at", "-1"],
        &["--picture", "a.png", "--at", "NaN"],
        &["--movie", "a.gif", "--seconds", "0"],
        &["--movie", "a.gif", "--at", "1"],
        &["--picture", "a.png", "--width", "0"],
    ] {
        let run = sinew(&[&["view", "pendulum"], wrong].concat());
        assert!(run.code == Some(2) && run.stdout.is_empty(), "{wrong:?}: {run:?}");
    }
}

/// Size of a file, bytes.
fn size(path: &str) -> u64 {
    std::fs::metadata(path).expect("the picture exists").len()
}

#[test]
fn a_character_is_drawn_with_its_clip() {
    let folder = Folder::new("view-character");
    let file = folder.mannequin();
    let draw = |name: &str, extra: &[&str]| {
        let out = folder.path(name);
        let arguments = ["view", &file, "--picture", &out, "--width", "160", "--height", "90", "--json"];
        let object = sinew(&[&arguments[..], extra].concat()).json();
        check_keys("view", &object);
        (object, std::fs::read(&out).expect("the picture exists"))
    };
    let (first, picture) = draw("a.png", &[]);
    assert_eq!(first["clip"], "Walk");
    assert!((first["at_s"].as_f64().expect("a time") - 32.0 / 60.0).abs() < 1e-3, "{first}");
    assert_eq!(draw("b.png", &["--clip", "walk"]).1, picture);
    assert_ne!(draw("c.png", &["--at", "0.2"]).1, picture);
    let run = sinew(&["view", &file, "--picture", &folder.path("d.png"), "--clip", "Dance"]);
    assert!(run.refusal(1).contains("Walk"), "{run:?}");
    let run = sinew(&["view", "pendulum", "--picture", &folder.path("e.png"), "--clip", "Walk"]);
    assert!(run.refusal(2).contains("--clip is for files"), "{run:?}");
    let run = sinew(&["view", &file, "--picture", &folder.path("f.png"), "--set", "a=1"]);
    assert!(run.refusal(2).contains("--set is for scenes"), "{run:?}");
}

#[test]
fn a_skeleton_without_a_mesh_is_drawn_as_bones() {
    let folder = Folder::new("view-bones");
    let (file, bvh) = (folder.mannequin(), folder.path("walk.bvh"));
    let run = sinew(&["convert", &file, &bvh]);
    assert_eq!(run.code, Some(0), "{run:?}");
    let small = ["--width", "160", "--height", "90"];
    let (movie, empty) = (folder.path("walk.gif"), folder.path("empty.png"));
    let object = sinew(&[&["view", &bvh, "--movie", &movie, "--json"], &small[..]].concat()).json();
    assert!((object["seconds"].as_f64().expect("a time") - 32.0 / 30.0).abs() < 0.02, "{object}");
    let bytes = std::fs::read(&movie).expect("the movie exists");
    let pictures = bytes.windows(3).filter(|window| *window == [0x21, 0xf9, 4]).count();
    assert_eq!(pictures, 22);
    let nothing = folder.file("nothing.gltf", r#"{"asset":{"version":"2.0"}}"#);
    let run = sinew(&["view", &nothing, "--picture", &empty]);
    assert!(run.refusal(1).contains("no skeleton, mesh or clip to draw"), "{run:?}");
}

#[test]
fn converted_motion_is_drawn() {
    let folder = Folder::new("convert-picture");
    let (file, bvh, gif) = (folder.mannequin(), folder.path("walk.bvh"), folder.path("walk.gif"));
    let object = sinew(&["convert", &file, &bvh, "--picture", &gif, "--json"]).json();
    assert_eq!(object["outputs"], serde_json::json!([bvh, gif]));
    // The picture shows the bones like a view of the written file.
    let viewed = folder.path("viewed.gif");
    sinew(&["view", &bvh, "--movie", &viewed, "--json"]).json();
    let [a, b] = [&gif, &viewed].map(|path| size(path));
    assert!(a.abs_diff(b) * 50 < a, "{a} and {b} bytes");
}

/// Without a window system, one line says so and names the alternative; an unknown scene is reported in one line as
/// well.
#[test]
fn window_without_a_display_fails_with_one_line() {
    for arguments in [&["view"][..], &["view", "pendulum"]] {
        let mut command = command(arguments);
        let run =
            Run::of(command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET"));
        let line = run.refusal(if cfg!(feature = "viewer") { 1 } else { 2 });
        assert!(line.contains("--picture OUT"), "{line}");
        let adds = format!("'cargo run --release --features viewer -- {}'", arguments.join(" "));
        assert_eq!(line.contains(&adds), !cfg!(feature = "viewer"), "{line}");
    }
    let mut command = command(&["view", "nix"]);
    let run = Run::of(command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY"));
    assert!(run.refusal(2).contains("no scene 'nix'"), "{run:?}");
}
