//! Scenes of our own ragdolls for MuJoCo: the same humanoids and starts.

use serde_json::{Value, json};
use sinew::formats::write_mjcf;
use sinew::math::{Transform, Vec3};
use sinew::physics::{BodyKind, Shape};
use sinew_scenes::blueprint::{self, Blueprint};

/// Returns one humanoid as MJCF on a plane, the starts of the first bodies of all humanoids, and the surrounding boxes,
/// in the axes of the file: z up. Joints are at 0 in the file's pose, as in the blueprint's start.
pub fn mjcf(scene: &Blueprint) -> Value {
    let place = |at: &Transform| {
        let (p, r) = (at.translation, at.rotation);
        json!({ "pos": file_axes(p), "quat": [r.w, r.x, -r.z, r.y] })
    };
    let pose = |body: usize| Transform::new(scene.bodies[body].position, scene.bodies[body].rotation);
    let figures: Vec<Value> = blueprint::roots(scene).into_iter().map(|body| place(&pose(body))).collect();
    let walls = scene.bodies.iter().filter(|def| def.kind == BodyKind::Static);
    let walls = walls.filter_map(|def| match def.shapes.first().map(|part| &part.shape) {
        Some(&Shape::Box { half_extents: h }) => {
            let mut wall = place(&Transform::new(def.position, def.rotation));
            wall["size"] = json!([h.x, h.z, h.y]);
            Some(wall)
        }
        _ => None,
    });
    let friction = scene.bodies.iter().flat_map(|def| &def.shapes).map(|part| part.material.friction).next();
    let written = write_mjcf(&blueprint::humanoid(), scene.name);
    json!({
        "scene": scene.name,
        "steps": scene.steps,
        "bodies": scene.bodies.len(),
        "joints": scene.joints.len(),
        "friction": friction,
        "figures": figures,
        "walls": walls.collect::<Vec<_>>(),
        "mjcf": written.text,
        "notes": written.notes,
    })
}

fn file_axes(v: Vec3) -> [f32; 3] {
    [v.x, -v.z, v.y]
}
