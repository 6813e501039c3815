//! `sinew scenes` and `sinew run`.

use crate::sinew::{Folder, sinew};

#[test]
fn scenes_are_listed_one_a_line_without_header() {
    let run = sinew(&["scenes"]);
    let object = sinew(&["scenes", "--json"]).json();
    let scenes = object["scenes"].as_array().expect("scenes");
    assert!(scenes.len() >= 8);
    let names: Vec<_> = run.stdout.lines().map(|line| line.split_whitespace().next()).collect();
    let expected: Vec<_> = scenes.iter().map(|scene| scene["name"].as_str()).collect();
    assert_eq!(names, expected);
}

#[test]
fn runs_repeat_exactly_on_any_threads() {
    let hash = |threads: &str| {
        let object =
            sinew(&["run", "zero_gravity_pile", "--steps", "60", "--threads", threads, "--json"]).json();
        assert_eq!(object["threads"].to_string(), threads);
        object["hash"].as_str().expect("a hash").to_owned()
    };
    let once = hash("1");
    assert!(once.len() == 16 && once.chars().all(|c| c.is_ascii_hexdigit()), "{once}");
    assert_eq!(hash("1"), once);
    assert_eq!(hash("2"), once);
}

#[test]
fn settings_change_the_result() {
    let angle = |set: &[&str]| {
        let arguments = [&["run", "pendulum", "--steps", "30", "--json"], set].concat();
        sinew(&arguments).json()["hash"].clone()
    };
    assert_ne!(angle(&["--set", "amplitude=30"]), angle(&["--set", "amplitude=31"]));
}

#[test]
fn unknown_names_are_usage_errors() {
    let line = |arguments: &[&str]| sinew(arguments).refusal(2).to_owned();
    let suggested = line(&["run", "pendulm"]);
    assert!(suggested.starts_with("error: no scene 'pendulm'; the nearest of "), "{suggested}");
    assert!(suggested.contains(" are pendulum, ") && suggested.ends_with("; 'sinew scenes' lists all"));
    assert!(line(&["view", "pendulm", "--picture", "x.png"]).contains(" are pendulum, "));
    assert!(line(&["run", "pendulum", "--set", "nix=1"]).starts_with("error: --set: no setting `nix`"));
    assert!(line(&["run", "pendulum", "--set", "amplitude"]).contains("is not key=value"));
}

#[test]
fn scene_with_a_file_setting_requires_a_valid_file() {
    let run = |set: &[&str]| sinew(&[&["run", "mjcf_drop", "--steps", "2"], set].concat());
    let missing = run(&[]);
    assert_eq!(missing.refusal(2), "error: --set: `file` is not set: it takes the path of a model in MJCF");
    let manifest = concat!("file=", env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
    assert!(
        run(&["--set", manifest])
            .refusal(1)
            .ends_with("Cargo.toml: not XML: unknown token (line 1 column 1)")
    );
    assert_eq!(run(&["--set", "file=nix.xml"]).refusal(1), "error: nix.xml: no such file");
}

#[test]
fn mjcf_model_is_dropped() {
    let folder = Folder::new("mjcf");
    let text = "<mujoco><worldbody><geom type='plane' size='0 0 1'/>
        <body pos='0 0 1'><freejoint/><geom size='.1'/></body></worldbody></mujoco>";
    let file = format!("file={}", folder.file("ball.xml", text));
    let object = sinew(&["run", "mjcf_drop", "--set", &file, "--set", "pose=1", "--json"]).json();
    let height = object["metrics"]["prone_rest_height_m"].as_f64().expect("a height");
    assert!((height - 0.1).abs() < 0.002, "{height}");
}

#[test]
fn scene_that_misses_its_bars_fails_with_its_report() {
    let run = sinew(&["run", "arch", "--json"]);
    assert_eq!(run.refusal(1), "error: arch misses its expectations: shift_max_m");
    let object: serde_json::Value =
        serde_json::from_str(&run.stdout).expect("a JSON object despite the failure");
    assert!(object["metrics"]["shift_max_m"].is_number());
    let run = sinew(&["run", "arch"]);
    assert!(run.code == Some(1) && run.stdout.matches("MISSED").count() == 1, "{run:?}");
    // For another number of steps there are no expectations.
    let run = sinew(&["run", "arch", "--steps", "1000"]);
    assert!(run.code == Some(0) && !run.stdout.contains("MISSED"), "{run:?}");
}
