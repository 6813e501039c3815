//! Files outside the repository, if they are present.

use sinew_anim::{Channel, Clip, Interpolation, Joint, LocalTransform, Property, Rig};
use sinew_math::{Rotation, Vec3};
use std::path::{Path, PathBuf};

/// Returns the folder of test data beside the workspace, for tests with `needs_data`.
pub fn shared_data() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"))
}

/// Returns every file below `folder` with one of these extensions, in a fixed order.
pub fn files(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().and_then(|e| e.to_str()).is_some_and(|e| extensions.contains(&e)) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Extensions of glTF and its relatives.
pub const GLTF: [&str; 4] = ["glb", "gltf", "vrm", "vrma"];

/// Returns three joints in a row, one metre apart; the middle one rotates by a right angle in half a second.
pub fn bar() -> (Rig, Clip) {
    let joint = |name: &str, parent: Option<usize>, source| {
        let translation = if source == 0 { Vec3::ZERO } else { Vec3::Y };
        let rest = LocalTransform { translation, ..LocalTransform::default() };
        Joint { name: name.into(), parent, rest, source }
    };
    let joints = vec![joint("root", None, 0), joint("middle", Some(0), 1), joint("tip", Some(1), 2)];
    let turn = |angle: f32| {
        let r = Rotation::from_axis_angle(Vec3::X, angle.to_radians());
        [r.x, r.y, r.z, r.w]
    };
    let channel = Channel {
        joint: 1,
        property: Property::Rotation,
        interpolation: Interpolation::Linear,
        times: vec![0.0, 0.25, 0.5],
        values: [turn(0.0), turn(45.0), turn(90.0)].concat(),
    };
    (Rig { joints, ..Rig::default() }, Clip { name: "bend".into(), duration: 0.5, channels: vec![channel] })
}
