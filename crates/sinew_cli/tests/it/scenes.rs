//! `sinew scenes` and `sinew run`.

use crate::sinew::sinew;

#[test]
fn one_a_line_with_the_name_first_and_no_header() {
    let run = sinew(&["scenes"]);
    let object = sinew(&["scenes", "--json"]).json();
    let scenes = object["scenes"].as_array().expect("scenes");
    assert!(scenes.len() >= 8);
    let names: Vec<_> = run.stdout.lines().map(|line| line.split_whitespace().next()).collect();
    let expected: Vec<_> = scenes.iter().map(|scene| scene["name"].as_str()).collect();
    assert_eq!(names, expected);
}

#[test]
fn the_state_is_the_same_twice_and_on_two_threads() {
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
fn settings_change_the_outcome() {
    let angle = |set: &[&str]| {
        let arguments = [&["run", "pendulum", "--steps", "30", "--json"], set].concat();
        sinew(&arguments).json()["hash"].clone()
    };
    assert_ne!(angle(&["--set", "amplitude=30"]), angle(&["--set", "amplitude=31"]));
}

#[test]
fn what_is_not_there_is_bad_usage() {
    let line = |arguments: &[&str]| sinew(arguments).refusal(2).to_owned();
    assert_eq!(line(&["run", "nix"]), "error: no scene 'nix'; 'sinew scenes' lists what there is");
    assert!(line(&["run", "pendulum", "--set", "nix=1"]).starts_with("error: --set: no setting `nix`"));
    assert!(line(&["run", "pendulum", "--set", "amplitude"]).contains("is not key=value"));
}
