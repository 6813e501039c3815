//! Output of the commands with `--json`, compared with `docs/contract.md`.

use crate::contract_table::{Row, parse, violations};
use crate::sinew::{Folder, sinew};
use serde_json::Value;

const TABLE: &str = include_str!("../../../../docs/contract.md");

fn rows() -> Vec<Row> {
    parse(TABLE).expect("docs/contract.md is well formed")
}

pub fn check_keys(command: &str, output: &Value) {
    let violations = violations(&rows(), command, output);
    assert!(violations.is_empty(), "{}\n{output:#}", violations.join("\n"));
    // A command without rows would accept any output.
    assert_ne!(
        crate::contract_table::violations(&rows(), command, &Value::Object(Default::default())).len(),
        0
    );
}

#[test]
fn errors() {
    let run = sinew(&["inspect", "nowhere.glb", "--json"]);
    assert_eq!(run.refusal(1), "error: nowhere.glb: no such file");
    let object = serde_json::from_str(&run.stdout).expect("stdout is one JSON object");
    check_keys("error", &object);
    assert_eq!(object["error"]["file"], "nowhere.glb");
    assert_eq!(object["error"]["what"], "no such file");
}

#[test]
fn scenes() {
    check_keys("scenes", &sinew(&["scenes", "--json"]).json());
}

#[test]
fn run() {
    check_keys("run", &sinew(&["run", "pendulum", "--steps", "10", "--json"]).json());
}

#[test]
fn inspect() {
    let folder = Folder::new("contract-inspect");
    let object = sinew(&["inspect", &folder.mannequin(), "--json"]).json();
    check_keys("inspect", &object);
    assert_eq!(object["clips"][0]["name"], "Walk");
    let joints = object["joints"].as_array().expect("joints");
    let hips = joints.iter().find(|joint| joint["role"] == "hips").expect("the mannequin has hips");
    assert_eq!((&hips["name"], &hips["has_body"]), (&Value::from("hips"), &Value::from(true)));
}

#[test]
fn ragdoll_build() {
    let folder = Folder::new("contract-build");
    let (file, out) = (folder.mannequin(), folder.path("ragdoll.json"));
    let object = sinew(&["ragdoll", "build", &file, "-o", &out, "--gate", "1", "--json"]).json();
    check_keys("ragdoll build", &object);
    assert_eq!(object["quality"]["gate"]["spawns"], 1);
    let bodies = object["bodies"].as_array().expect("bodies");
    assert!((13..=25).contains(&bodies.len()), "{} bodies", bodies.len());
    let written = std::fs::read(&out).expect("the definition is written");
    let def = sinew::formats::read_ragdoll(&written).expect("and can be read");
    assert_eq!(def.bodies.len(), bodies.len());
}
