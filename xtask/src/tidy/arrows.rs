//! Allowed dependencies between crates (design §1), and of crates on external ones.

use super::{Finding, Repo};
use serde_json::Value;

/// Each crate, and the crates that it may use; their dependencies are allowed, too. Has one row per crate of the
/// design, including crates that do not exist yet.
const ARROWS: &[(&str, &[&str])] = &[
    ("sinew_math", &[]),
    ("sinew_geometry", &["sinew_math"]),
    ("sinew_physics", &["sinew_geometry"]),
    ("sinew_anim", &["sinew_math"]),
    ("sinew_ragdoll", &["sinew_physics", "sinew_anim"]),
    ("sinew_formats", &["sinew_anim", "sinew_physics", "sinew_ragdoll"]),
    (
        "sinew",
        &["sinew_math", "sinew_geometry", "sinew_physics", "sinew_anim", "sinew_ragdoll", "sinew_formats"],
    ),
    ("sinew_scenes", &["sinew"]),
    ("sinew_picture", &["sinew"]),
    ("sinew_viewer", &["sinew_scenes", "sinew_picture"]),
    ("sinew_cli", &["sinew_scenes", "sinew_picture", "sinew_viewer"]),
    ("sinew_web", &["sinew_viewer"]),
    ("xtask", &[]),
    ("needs_data", &[]),
];

/// External crates (by the start of their name) that only some crates may use.
const RESERVED: &[(&str, &[&str], &str)] = &[
    ("wgpu", &["sinew_viewer", "sinew_web"], "only viewer and web use a GPU"),
    ("winit", &["sinew_viewer", "sinew_web"], "only viewer and web use a window"),
    ("egui", &["sinew_viewer", "sinew_web"], "only viewer and web use a window"),
    ("anyhow", &["sinew_cli", "xtask"], "libraries have typed errors"),
    ("rayon", &[], "threads come from a TaskRunner"),
];

/// Checks that every normal dependency between crates is allowed, and reserved crates are used only where allowed.
pub fn check(repo: &Repo) -> Vec<Finding> {
    repo.packages().flat_map(check_package).collect()
}

fn check_package(package: &Value) -> Vec<Finding> {
    let name = package["name"].as_str().unwrap_or_default();
    let manifest = match name {
        "xtask" => "xtask/Cargo.toml".into(),
        "needs_data" => "xtask/needs_data/Cargo.toml".into(),
        _ => format!("crates/{name}/Cargo.toml"),
    };
    if !ARROWS.iter().any(|&(row, _)| row == name) {
        return vec![Finding::new(&manifest, 1, format!("{name} has no row in xtask/src/tidy/arrows.rs"))];
    }
    let allowed = reachable(name);
    let mut findings = Vec::new();
    for dependency in package["dependencies"].as_array().into_iter().flatten() {
        // Tests may use anything, so only normal edges count; cargo writes those as null.
        if !dependency["kind"].is_null() {
            continue;
        }
        let wanted = dependency["name"].as_str().unwrap_or_default();
        let is_ours = ARROWS.iter().any(|&(row, _)| row == wanted);
        if is_ours && !allowed.contains(&wanted) {
            findings.push(Finding::new(
                &manifest,
                1,
                format!("{name} must not depend on {wanted} (design §1)"),
            ));
        }
        for (prefix, users, why) in RESERVED {
            if wanted.starts_with(prefix) && !users.contains(&name) {
                findings.push(Finding::new(
                    &manifest,
                    1,
                    format!("{name} must not depend on {wanted}: {why}"),
                ));
            }
        }
    }
    findings
}

/// Returns all crates that `name` may depend on.
fn reachable(name: &str) -> Vec<&'static str> {
    let direct = ARROWS.iter().find(|&&(row, _)| row == name).map_or(&[][..], |&(_, direct)| direct);
    direct.iter().flat_map(|&next| std::iter::once(next).chain(reachable(next))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn check_edge(from: &str, to: &str, kind: &Value) -> Vec<String> {
        let dependency = json!({ "name": to, "kind": kind });
        let repo = Repo::planted_packages(&json!([{ "name": from, "dependencies": [dependency] }]));
        check(&repo).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn forbidden_dependency_is_found() {
        let findings = check_edge("sinew_physics", "sinew_anim", &Value::Null);
        assert_eq!(
            findings,
            ["crates/sinew_physics/Cargo.toml:1: sinew_physics must not depend on sinew_anim (design §1)"]
        );
        assert_eq!(check_edge("sinew_math", "sinew", &Value::Null).len(), 1);
        assert_eq!(check_edge("sinew_formats", "sinew_scenes", &Value::Null).len(), 1);
    }

    #[test]
    fn allowed_dependencies_and_those_of_tests_pass() {
        assert!(check_edge("sinew_ragdoll", "sinew_anim", &Value::Null).is_empty());
        assert!(check_edge("sinew_cli", "sinew_math", &Value::Null).is_empty());
        assert!(check_edge("sinew_physics", "sinew_anim", &json!("dev")).is_empty());
    }

    #[test]
    fn gpu_or_untyped_errors_in_a_library_are_found() {
        assert_eq!(check_edge("sinew_picture", "wgpu", &Value::Null).len(), 1);
        assert_eq!(check_edge("sinew_formats", "anyhow", &Value::Null).len(), 1);
        assert!(check_edge("sinew_viewer", "wgpu", &Value::Null).is_empty());
    }

    #[test]
    fn crate_without_a_row_is_found() {
        assert_eq!(check_edge("sinew_helpers", "sinew", &Value::Null).len(), 1);
    }
}
